//! The port of a simulated network, in simulated time.

use super::network::{PERIOD_NS, SimulatedNetwork};
use crate::heads::Port;
use husillo_transports::nmc::{Baud, Timing};
use std::io;

/// A port to a network of simulated modules. Time passes only while the port waits for bytes.
#[derive(Clone, Debug)]
pub struct SimulatedPort {
    /// The simulated network.
    pub network: SimulatedNetwork,
    /// Time since the port was opened, ns.
    elapsed_ns: u64,
}

impl SimulatedPort {
    /// The port of a network, at time 0 and at the rate after power-up.
    #[must_use]
    pub fn new(mut network: SimulatedNetwork) -> Self {
        network.set_host_rate(Some(Baud::default().bits_per_s()));
        Self {
            network,
            elapsed_ns: 0,
        }
    }
}

impl Port for SimulatedPort {
    fn timing(&self, baud: Baud) -> Timing {
        Timing::prompt(baud, 512)
    }

    fn elapsed_us(&self) -> u64 {
        self.elapsed_ns / 1000
    }

    fn set_baud(&mut self, baud: Baud) -> io::Result<()> {
        self.network.set_host_rate(Some(baud.bits_per_s()));
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        bytes.iter().for_each(|byte| self.network.send(*byte));
        Ok(())
    }

    fn receive(&mut self, wait_us: u32) -> io::Result<Vec<u8>> {
        let end_ns = self.elapsed_ns + u64::from(wait_us.max(1)) * 1000;
        while self.elapsed_ns < end_ns {
            self.elapsed_ns += PERIOD_NS;
            let bytes = self.network.tick();
            if !bytes.is_empty() {
                return Ok(bytes);
            }
        }
        Ok(Vec::new())
    }
}
