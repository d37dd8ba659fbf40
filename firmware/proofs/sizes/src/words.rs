//! Reads a line into words.
#![no_std]
#![no_main]

use husillo_gcode::words;

mod port;

#[cortex_m_rt::entry]
fn main() -> ! {
    let mut line = [0; 64];
    loop {
        for byte in &mut line {
            *byte = port::receive();
        }
        for word in words(&line) {
            match word {
                Ok(word) => {
                    port::send(word.letter.into());
                    port::send(word.value.digits() as u32);
                    port::send(word.value.places().into());
                }
                Err(error) => port::send(error.kind.code().into()),
            }
        }
    }
}
