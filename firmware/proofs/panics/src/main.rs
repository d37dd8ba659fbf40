//! Proves that no public function of the leaves, of `machine` and of `controllers` can panic. This
//! program links only if no function can reach a panic.
//!
//! Each module lists the functions of one crate and takes their addresses, so that each function is
//! compiled for any argument and any state. If a function can panic, the panic handler stays in the
//! program. The handler calls a symbol that nothing defines, so the program does not link. Generic
//! functions are proved for the instances named. With `--profile release-checked`, an overflow is
//! also a panic.
#![no_std]
#![no_main]

mod backlash;
mod controllers;
mod encoder;
mod excellon;
mod gcode;
mod interp;
mod machine;
mod pid;
mod planner;
mod probe;
mod stepper;
mod store;
mod transports;

/// The linker's entry point. It never runs.
#[unsafe(no_mangle)]
extern "C" fn _start() -> ! {
    gcode::keep();
    excellon::keep();
    interp::keep();
    planner::keep();
    stepper::keep();
    backlash::keep();
    encoder::keep();
    pid::keep();
    probe::keep();
    transports::keep();
    store::keep();
    machine::keep();
    controllers::keep();
    loop {
        core::hint::spin_loop();
    }
}

#[cfg(not(feature = "show"))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn a_public_function_can_panic() -> !;
    }
    // Safety: nothing defines this function, so no program that contains this call links.
    unsafe { a_public_function_can_panic() }
}

/// Uses the location of the panic, so that calls from different locations are not merged into one.
#[cfg(feature = "show")]
#[panic_handler]
fn panic(information: &core::panic::PanicInfo<'_>) -> ! {
    core::hint::black_box(information.location());
    loop {
        core::hint::spin_loop();
    }
}
