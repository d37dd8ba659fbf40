//! The panic handler. A program in which anything can panic does not link.
//!
//! The USB crates can panic, so a program with the feature `usb` links, as does one with `panics`.
//! A panic ends the steps, and switches the motors' pins, the other outputs and the PWM off. The
//! host then receives nothing more.

#[cfg(not(any(feature = "usb", feature = "panics")))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn a_panic_is_left_in_the_firmware() -> !;
    }
    // Safety: nothing defines this function, so no program that contains this call links.
    unsafe { a_panic_is_left_in_the_firmware() }
}

#[cfg(any(feature = "usb", feature = "panics"))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    crate::uninterrupted(|_| {
        // Mist coolant may be one of the motors' pins.
        crate::chosen::write(0);
        crate::chosen::switch(0);
        crate::chosen::drive(0);
        loop {
            crate::wfi();
        }
    })
}
