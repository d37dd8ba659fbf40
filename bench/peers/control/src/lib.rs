//! Other crates' controllers and decoders beside ours: the same input, the same flags, every result looked at.
//!
//! The same kernels run on simulated microcontrollers (`firmware/check counts --peers`) and on the host (`bench/peers/loops`), which also tests here that all of them do the same job.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod controllers;
pub mod decoders;

/// Takes a kernel's name, how many events it has, and what to run, any number of times.
pub type Count<'a> = &'a mut dyn FnMut(&str, u32, &mut dyn FnMut());

/// Hands every kernel to `count`, each group with ours first.
pub fn all(count: Count<'_>) {
    controllers::all(count);
    decoders::all(count);
}
