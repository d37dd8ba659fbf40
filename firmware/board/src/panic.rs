//! There is no panic: whatever could, does not link.

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn a_panic_is_left_in_the_firmware() -> !;
    }
    // Safety: nobody defines this function, so no program that contains this call links.
    unsafe { a_panic_is_left_in_the_firmware() }
}
