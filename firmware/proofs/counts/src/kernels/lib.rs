//! The kernels that are counted. Each iterates a method of the crates as an interrupt would.
//!
//! A stream is moved into a local variable and iterated to its end: `for step in stream {
//! black_box(masks) }`. So a count includes the loop, the test for the end of the move, and work
//! that is not done at every event. It does not include the set-up. The same kernels run on
//! emulated microcontrollers (the programs `counts`, `counts-text`, `counts-events` and
//! `counts-line`) and on the host (`husillo-bench`).
#![no_std]
#![forbid(unsafe_code)]

mod arcs;
mod chain;
mod curves;
mod encoder;
mod jerk;
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

/// Takes the name of a kernel, its number of events, and the work to run once.
pub type Count<'a> = &'a mut dyn FnMut(&str, u32, &mut dyn FnMut());

/// Passes every kernel to `count`.
pub fn all(count: Count<'_>) {
    methods(count);
    commands(count);
    events(count);
    line(count);
}

/// Interpolation, planning and the stages after them. The groups are not inlined: otherwise the
/// moves of all groups would be on the stack at once.
pub fn methods(count: Count<'_>) {
    lines::all(count);
    arcs::all(count);
    curves::all(count);
    profiles::all(count);
    planning::all(count);
    jerk::all(count);
    stages::all(count);
    encoder::all(count);
    pid::all(count);
    probe::all(count);
}

/// From text to commands. Together with the methods, or with the events, this would not fit in a
/// microbit.
pub fn commands(count: Count<'_>) {
    words::all(count);
    words::line(count);
}

/// From commands, and from messages, to events at constant speed.
pub fn events(count: Count<'_>) {
    chain::all(count);
    transports::all(count);
}

/// From a line to its place in the queue of a machine with ramps. The queue fills the RAM of a
/// microbit.
pub fn line(count: Count<'_>) {
    chain::planned(count);
    chain::programs(count);
}

/// Counts a move from its first event to its end.
fn walk<I: Iterator<Item = Step> + Clone>(count: Count<'_>, name: &str, path: &I) {
    let events = path.clone().map(|_| 1).sum();
    count(name, events, &mut || {
        for step in black_box(path.clone()) {
            black_box((step.axes, step.negative));
        }
    });
}

/// Counts a speed profile from its first interval to its last.
fn time<I: Iterator<Item = u32> + Clone>(count: Count<'_>, name: &str, profile: &I) {
    let events = profile.clone().map(|_| 1).sum();
    count(name, events, &mut || {
        for ticks in black_box(profile.clone()) {
            black_box(ticks);
        }
    });
}
