//! An empty program: only the start-up code and the vectors.
#![no_std]
#![no_main]

mod port;

#[cortex_m_rt::entry]
fn main() -> ! {
    loop {
        port::send(port::receive().into());
    }
}
