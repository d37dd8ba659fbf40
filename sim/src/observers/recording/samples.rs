//! The position of the tool at equal intervals of time. Memory is bounded: if there are too many
//! samples, every second one is left out.

use crate::observers::AXES;

/// Most samples kept.
const MOST: usize = 32_768;

/// Positions at one instant, steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sample {
    /// Of the tool.
    pub tool: [i32; AXES],
    /// As commanded.
    pub sent: [i32; AXES],
}

/// Samples at equal intervals.
#[derive(Clone, Debug)]
pub struct Samples {
    /// The samples. The first is that of the start.
    pub all: Vec<Sample>,
    /// Ticks between two samples.
    pub interval: u64,
    next: u64,
    last: Sample,
}

impl Samples {
    /// Starts at zero.
    pub const fn new(interval: u64) -> Self {
        Self {
            all: Vec::new(),
            interval,
            next: 0,
            last: Sample {
                tool: [0; AXES],
                sent: [0; AXES],
            },
        }
    }

    /// Puts the tool at these steps before the run.
    pub const fn start_at(&mut self, steps: [i32; AXES]) {
        self.last = Sample {
            tool: steps,
            sent: steps,
        };
    }

    /// Takes the positions that begin at `ticks`.
    #[inline]
    pub fn take(&mut self, ticks: u64, tool: [i32; AXES], sent: [i32; AXES]) {
        if self.next < ticks {
            self.fill(ticks);
        }
        self.last = Sample { tool, sent };
    }

    /// The positions stay as they are up to `ticks`, which is included.
    pub fn stay(&mut self, ticks: u64) {
        self.fill(ticks.saturating_add(1));
    }

    /// Adds the samples before `ticks`.
    fn fill(&mut self, ticks: u64) {
        while self.next < ticks {
            self.all.push(self.last);
            if self.all.len() > MOST {
                let mut is_kept = false;
                self.all.retain(|_| {
                    is_kept = !is_kept;
                    is_kept
                });
                self.interval = self.interval.saturating_mul(2);
            }
            // There are at most MOST samples, of an interval of at most 2^64 / MOST.
            self.next = (self.all.len() as u64).saturating_mul(self.interval);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_even_and_bounded() {
        let mut samples = Samples::new(10);
        for step in 1..=1_000_000 {
            let at = [step as i32, 0, 0, 0, 0, 0];
            samples.take(step * 7, at, at);
        }
        samples.stay(7_000_000);
        assert!((MOST / 2..=MOST).contains(&samples.all.len()));
        assert_eq!(samples.interval, 320);
        for (index, sample) in (0..).zip(&samples.all) {
            assert_eq!(sample.tool[0], (index * 320 / 7).min(1_000_000));
        }
    }
}
