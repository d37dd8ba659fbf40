//! A device that is simulated behind a link.

/// Bytes in, bytes out, in periods of its own, and the panel that an operator has before him.
pub trait Emulation {
    /// A period of the simulation, ns.
    const PERIOD_NS: u64;

    /// A byte that a client sent.
    fn send(&mut self, byte: u8);

    /// A period passes: the bytes that the device sends in it.
    fn tick(&mut self) -> Vec<u8>;

    /// A line typed at the panel: what it says to it.
    fn control(&mut self, line: &str) -> String {
        let _ = line;
        "this device has no panel".into()
    }

    /// What the device has to tell since it was asked last, a line each.
    fn tell(&mut self) -> Vec<String> {
        Vec::new()
    }

    /// What it has made since it was asked last, in rows of CSV, where these are kept.
    fn made(&mut self) -> String {
        String::new()
    }
}
