//! Controllers and decoders of other crates compared with those of husillo: the same input, the
//! same flags, every result checked.
//!
//! The same kernels run on simulated microcontrollers (`firmware/check counts --peers`) and on the
//! host (`bench/peers/loops`). The tests here verify that all of them do the same task.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod controllers;
pub mod decoders;

/// Takes the name of a kernel, its number of events, and the work to run, any number of times.
pub type Count<'a> = &'a mut dyn FnMut(&str, u32, &mut dyn FnMut());

/// Passes every kernel to `count`; in each group the one of husillo comes first.
pub fn all(count: Count<'_>) {
    controllers::all(count);
    decoders::all(count);
}
