#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| husillo_fuzz::closed_loop(data));
