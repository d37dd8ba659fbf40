//! What is counted: every method of the crates, walked as an interrupt would walk it.
//!
//! A stream is moved into a local and walked to its end: `for step in stream { black_box(masks) }`. So a count has the loop in it, the test
//! for the end of the move and what every so many events comes on top; setting up is not in it. The same kernels run on
//! simulated microcontrollers (the program `count`) and on the host (`husillo-bench`).
#![no_std]
#![forbid(unsafe_code)]

mod arcs;
mod chain;
mod curves;
mod encoder;
mod lines;
mod pid;
mod planning;
mod probe;
mod profiles;
mod stages;
mod transports;
mod words;

use core::hint::black_box;

use husillo_interp::Step;

/// Takes a kernel's name, how many events it has, and what to run, once.
pub type Count<'a> = &'a mut dyn FnMut(&str, u32, &mut dyn FnMut());

/// Hands every kernel to `count`.
pub fn all(count: Count<'_>) {
    methods(count);
    text(count);
}

/// Interpolation, planning and the stages behind them. The groups are not inlined: their moves would all be on the stack at once.
pub fn methods(count: Count<'_>) {
    lines::all(count);
    arcs::all(count);
    curves::all(count);
    profiles::all(count);
    planning::all(count);
    stages::all(count);
    encoder::all(count);
    pid::all(count);
    probe::all(count);
}

/// From text to events. With the methods it is more than a microbit holds.
pub fn text(count: Count<'_>) {
    words::all(count);
    words::line(count);
    chain::all(count);
    transports::all(count);
}

/// A move from its first event to its end.
fn walk<I: Iterator<Item = Step> + Clone>(count: Count<'_>, name: &str, path: &I) {
    let events = path.clone().map(|_| 1).sum();
    count(name, events, &mut || {
        for step in black_box(path.clone()) {
            black_box((step.axes, step.negative));
        }
    });
}

/// A speed profile from its first interval to its last.
fn time<I: Iterator<Item = u32> + Clone>(count: Count<'_>, name: &str, profile: &I) {
    let events = profile.clone().map(|_| 1).sum();
    count(name, events, &mut || {
        for ticks in black_box(profile.clone()) {
            black_box(ticks);
        }
    });
}
