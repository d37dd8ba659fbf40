//! The port of a simulated measuring machine whose time passes as on a real one.

use husillo_metrology::heads::Port;
use husillo_metrology::simulated::{SimulatedNetwork, SimulatedPort};
use husillo_transports::nmc::{Baud, Timing};
use std::io;
use std::time::{Duration, Instant};

/// A computer that was busy for longer than this does not make up for it.
const MOST_BEHIND: Duration = Duration::from_secs(1);

/// A simulated port in real time, or a multiple of it.
#[derive(Debug)]
pub(super) struct PacedPort {
    port: SimulatedPort,
    /// The time of the machine is 0 here.
    begun: Instant,
    speed: f64,
    /// Bytes that are received and not yet read.
    heard: Vec<u8>,
}

impl PacedPort {
    /// The port of a network whose time passes `speed` times as fast as real time.
    pub(super) fn new(network: SimulatedNetwork, speed: f64) -> Self {
        Self {
            port: SimulatedPort::new(network),
            begun: Instant::now(),
            speed,
            heard: Vec::new(),
        }
    }

    /// The time that has passed for the machine by the clock, us.
    fn clock_us(&self) -> u64 {
        (self.begun.elapsed().as_secs_f64() * self.speed * 1e6) as u64
    }

    /// The machine has gone on while nobody listened.
    fn catch_up(&mut self) -> io::Result<()> {
        let behind = self.clock_us().saturating_sub(self.port.elapsed_us());
        let behind = Duration::from_micros((behind as f64 / self.speed) as u64);
        if let Some(too_far) = behind.checked_sub(MOST_BEHIND) {
            self.begun += too_far;
        }
        let now_us = self.clock_us();
        while self.port.elapsed_us() < now_us {
            let wait_us = now_us - self.port.elapsed_us();
            // A second of a machine that is a thousand times as fast fits.
            let heard = self.port.receive(wait_us.min(u32::MAX.into()) as u32)?;
            self.heard.extend(heard);
        }
        Ok(())
    }
}

impl Port for PacedPort {
    fn timing(&self, baud: Baud) -> Timing {
        self.port.timing(baud)
    }

    fn elapsed_us(&self) -> u64 {
        self.port.elapsed_us()
    }

    fn set_baud(&mut self, baud: Baud) -> io::Result<()> {
        self.port.set_baud(baud)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.catch_up()?;
        self.port.send(bytes)
    }

    fn receive(&mut self, wait_us: u32) -> io::Result<Vec<u8>> {
        if !self.heard.is_empty() {
            return Ok(std::mem::take(&mut self.heard));
        }
        let heard = self.port.receive(wait_us)?;
        let ahead_us = self.port.elapsed_us().saturating_sub(self.clock_us());
        std::thread::sleep(Duration::from_micros((ahead_us as f64 / self.speed) as u64));
        Ok(heard)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_passes_as_on_a_real_machine() {
        let network = SimulatedNetwork::new(&[4], &[], None).unwrap();
        let mut port = PacedPort::new(network, 2.0);
        let begun = Instant::now();
        assert!(port.receive(100_000).unwrap().is_empty());
        assert!(begun.elapsed() >= Duration::from_millis(49));
        // And while nobody listens.
        std::thread::sleep(Duration::from_millis(50));
        port.send(&[]).unwrap();
        assert!(port.elapsed_us() >= 198_000, "{} us", port.elapsed_us());
    }
}
