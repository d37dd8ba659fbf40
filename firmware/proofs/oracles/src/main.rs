//! Runs the oracle tests of the crates on a board. `cargo test` runs the same files. The build
//! script turns their tests into functions that can be called.
#![no_std]
#![no_main]

extern crate alloc;

// The heap needs the critical sections of this crate.
#[cfg(target_arch = "arm")]
use cortex_m as _;
use embedded_alloc::LlffHeap;
use semihosting::println;

/// Items that the tests import from `std` on a host.
mod surroundings {
    pub use alloc::format;
    pub use alloc::string::String;
    pub use alloc::vec;
    pub use alloc::vec::Vec;

    /// Functions of numbers that `core` does not have.
    pub trait Real {
        /// The square root.
        fn sqrt(self) -> Self;
        /// The sine of an angle in radians.
        fn sin(self) -> Self;
        /// The cosine of an angle in radians.
        fn cos(self) -> Self;
        /// The length of a vector.
        fn hypot(self, other: Self) -> Self;
        /// The angle of a vector, in radians.
        fn atan2(self, other: Self) -> Self;
        /// The remainder of a division, never negative.
        fn rem_euclid(self, divisor: Self) -> Self;
    }

    impl Real for f64 {
        fn sqrt(self) -> f64 {
            libm::sqrt(self)
        }

        fn sin(self) -> f64 {
            libm::sin(self)
        }

        fn cos(self) -> f64 {
            libm::cos(self)
        }

        fn hypot(self, other: f64) -> f64 {
            libm::hypot(self, other)
        }

        fn atan2(self, other: f64) -> f64 {
            libm::atan2(self, other)
        }

        fn rem_euclid(self, divisor: f64) -> f64 {
            let rest = libm::fmod(self, divisor);
            if rest < 0.0 {
                rest + libm::fabs(divisor)
            } else {
                rest
            }
        }
    }
}

include!(concat!(env!("OUT_DIR"), "/tests.rs"));

#[global_allocator]
static HEAP: LlffHeap = LlffHeap::empty();

/// Enough for a tree of the JSON values of the largest oracle file.
const HEAP_BYTES: usize = 3 << 20;

#[cfg_attr(target_arch = "arm", cortex_m_rt::entry)]
#[cfg_attr(target_arch = "riscv32", riscv_rt::entry)]
fn main() -> ! {
    // SAFETY: this is called once, before anything is allocated.
    unsafe {
        embedded_alloc::init!(HEAP, HEAP_BYTES);
    }
    for (name, test) in TESTS {
        test();
        println!("{name} ok");
    }
    println!("{} oracle tests passed", TESTS.len());
    semihosting::process::exit(0)
}
