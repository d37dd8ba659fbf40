//! Runs every kernel once, each within one call of [`counted`]. `bench/instructions` runs it under callgrind, which counts what
//! such a call executes, and reads the kernels' names here.

/// What callgrind looks for. Not inlined, so that it has a symbol.
#[inline(never)]
fn counted(work: &mut dyn FnMut()) {
    work();
}

fn main() {
    // The frame around the work.
    counted(&mut || ());
    println!("frame 1");
    kernels::all(&mut |name, events, work| {
        counted(work);
        println!("{name} {events}");
    });
}
