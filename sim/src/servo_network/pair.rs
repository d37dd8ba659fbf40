//! A pair of wires with noise. It carries bytes and silence.

use crate::{Noise, NoisyLine};

/// A pair of wires. Silence is counted in whole bits, and the fraction is carried.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    line: NoisyLine,
    /// Carried fraction of a bit of silence.
    due: f64,
}

impl Pair {
    /// A pair with noise; the same seed gives the same noise.
    pub(super) fn new(noise: Noise, seed: u64) -> Pair {
        Pair {
            line: NoisyLine::new(noise, seed),
            due: 0.0,
        }
    }

    /// Carries a byte; returns what arrives.
    pub(super) fn carry(&mut self, byte: u8) -> Vec<u8> {
        self.due -= 10.0;
        self.line.carry(byte)
    }

    /// Lets a time of this number of bits pass. The bits that [`carry`](Self::carry) took are part
    /// of this time, and the rest is silence. Returns the bytes that arrive, and the number of bits
    /// of silence.
    pub(super) fn pass(&mut self, bits: f64) -> (Vec<u8>, u64) {
        self.due += bits;
        let silence = self.due.floor().max(0.0);
        self.due -= silence;
        (self.line.rest(silence as u64), silence as u64)
    }

    pub(super) fn wrong_bits(&self) -> u64 {
        self.line.wrong_bits()
    }
}
