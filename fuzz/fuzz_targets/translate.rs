#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};

fuzz_target!(|data: &[u8]| husillo_fuzz::translate(data));

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    // Every other mutation is that of libFuzzer.
    match seed % 2 {
        0 => fuzzer_mutate(data, size, max_size),
        _ => husillo_fuzz::mutate(data, size, max_size, seed, include_str!("../gcode.dict")),
    }
});
