//! The port of a simulated measuring machine whose time passes as on a real one.

use husillo_metrology::heads::Port;
use husillo_metrology::simulated::{SimulatedNetwork, SimulatedPort};
use husillo_transports::nmc::{Baud, Timing};
use std::io;
use std::time::{Duration, Instant};

/// If nobody listens for longer than this, the time of the machine stands meanwhile: no reply comes
/// late because this computer was busy. At rest nothing changes by that.
const MOST_BEHIND: Duration = Duration::from_millis(50);

/// A simulated port in real time, or a multiple of it. Its time passes only while somebody listens.
#[derive(Debug)]
pub(super) struct PacedPort {
    port: SimulatedPort,
    /// The time of the machine is 0 here.
    begun: Instant,
    speed: f64,
}

impl PacedPort {
    /// The port of a network whose time passes `speed` times as fast as real time.
    pub(super) fn new(network: SimulatedNetwork, speed: f64) -> Self {
        Self {
            port: SimulatedPort::new(network),
            begun: Instant::now(),
            speed,
        }
    }

    /// The time of the machine, as a time of the clock.
    fn passed(&self) -> Duration {
        Duration::from_secs_f64(self.port.elapsed_us() as f64 * 1e-6 / self.speed)
    }

    /// Waits until the clock has come as far as the machine.
    fn wait(&mut self) {
        let (passed, clock) = (self.passed(), self.begun.elapsed());
        if let Some(ahead) = passed.checked_sub(clock) {
            std::thread::sleep(ahead);
        } else if let Some(lost) = (clock - passed).checked_sub(MOST_BEHIND) {
            self.begun += lost + MOST_BEHIND;
        }
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
        self.port.send(bytes)
    }

    fn receive(&mut self, wait_us: u32) -> io::Result<Vec<u8>> {
        let heard = self.port.receive(wait_us)?;
        self.wait();
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
        // While nobody listens it stands, and goes on at its speed then.
        let before_us = port.elapsed_us();
        std::thread::sleep(Duration::from_millis(200));
        assert_eq!(port.elapsed_us(), before_us);
        port.receive(1).unwrap();
        let begun = Instant::now();
        assert!(port.receive(100_000).unwrap().is_empty());
        assert!(begun.elapsed() >= Duration::from_millis(48));
    }
}
