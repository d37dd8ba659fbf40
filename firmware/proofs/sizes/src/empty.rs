//! An empty program: its start-up code and its vectors.
#![no_std]
#![no_main]

mod port;

#[cortex_m_rt::entry]
fn main() -> ! {
    loop {
        port::send(port::receive().into());
    }
}
