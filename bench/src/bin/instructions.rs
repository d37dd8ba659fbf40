//! Runs every kernel once, each within one call of [`counted`]. `bench/instructions` runs it under
//! callgrind, which counts the instructions of such a call, and reads the names of the kernels from
//! its output.

/// The function that callgrind looks for. Not inlined, so that it has a symbol.
#[inline(never)]
fn counted(work: &mut dyn FnMut()) {
    work();
}

fn main() {
    // The overhead of the call.
    counted(&mut || ());
    println!("frame 1");
    kernels::all(&mut |name, events, work| {
        counted(work);
        println!("{name} {events}");
    });
}
