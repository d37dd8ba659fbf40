//! A simulated device behind a link.

/// A device that runs in simulated time: bytes in, bytes out, and an operator's panel.
pub trait Emulation {
    /// Length of a period of the simulation, ns.
    const PERIOD_NS: u64;

    /// Sets the rate of the client's port in bits/s, if it is known. A device whose line has no
    /// rate ignores it.
    fn set_host_rate(&mut self, bits_per_s: Option<u32>) {
        let _ = bits_per_s;
    }

    /// Takes a byte that a client sent.
    fn send(&mut self, byte: u8);

    /// Number of bytes that a client sent and the device has not received yet: they are on the
    /// line. A port accepts no further bytes of a client while this number is large.
    fn on_the_line(&self) -> usize;

    /// Simulates one period. Returns the bytes that the device sends in it.
    fn tick(&mut self) -> Vec<u8>;

    /// Carries out a line typed at the panel, and returns its reply.
    fn control(&mut self, line: &str) -> String {
        let _ = line;
        "this device has no panel".into()
    }

    /// Returns the reports of the device since the last call, one line each.
    fn take_reports(&mut self) -> Vec<String> {
        Vec::new()
    }

    /// Returns the step events since the last call as rows of CSV, if they are recorded.
    fn made(&mut self) -> String {
        String::new()
    }
}
