//! What the start of a program and its vectors take.
#![no_std]
#![no_main]

mod port;

#[cortex_m_rt::entry]
fn main() -> ! {
    loop {
        port::send(port::receive().into());
    }
}
