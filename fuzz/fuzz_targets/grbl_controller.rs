#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| husillo_fuzz::grbl_controller(data));
