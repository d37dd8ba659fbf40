#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| husillo_fuzz::grblhal_controller(data));
