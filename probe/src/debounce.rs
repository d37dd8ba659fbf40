//! Debounce: one edge for each change of a bouncing contact.

/// An edge of a contact.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Edge {
    /// The contact closed: the stylus touches.
    Made,
    /// The contact opened: the stylus is free.
    Broken,
}

impl Edge {
    /// Returns the level of the contact after this edge. `true` is closed.
    #[must_use]
    pub const fn level(self) -> bool {
        matches!(self, Edge::Made)
    }
}

/// A debounced level. It changes after a set number of equal samples in a row.
///
/// One sample of the old level restarts the count, so a disturbance shorter than the run has no
/// effect. The delay is `samples - 1` samples for every edge; [`Latch`](crate::Latch) compensates
/// it.
///
/// # Cost
/// One comparison and one count per sample.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Debounce {
    samples: u8,
    run: u8,
    level: bool,
}

impl Debounce {
    /// Creates a contact that is at `level` and changes after `samples` equal samples. 0 counts as
    /// 1, which passes every change.
    #[must_use]
    pub const fn new(samples: u8, level: bool) -> Debounce {
        Debounce {
            samples: if samples == 0 { 1 } else { samples },
            run: 0,
            level,
        }
    }

    /// Takes one sample of the pin (`true` is closed). Returns the edge in the sample that
    /// completes a run.
    pub const fn sample(&mut self, closed: bool) -> Option<Edge> {
        if closed == self.level {
            self.run = 0;
            return None;
        }
        // The count was below `samples`, so the sum fits.
        self.run = self.run.saturating_add(1);
        if self.run < self.samples {
            return None;
        }
        self.run = 0;
        self.level = closed;
        Some(if closed { Edge::Made } else { Edge::Broken })
    }

    /// Returns the current level. `true` is closed.
    #[must_use]
    pub const fn level(&self) -> bool {
        self.level
    }

    /// Returns the number of samples between an edge of the pin and its report, one less than the
    /// run.
    #[must_use]
    pub const fn delay_samples(&self) -> u8 {
        self.samples.saturating_sub(1)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::String;

    /// `#` is closed and `.` is open. The result shows reported edges as `M` and `B`.
    fn edges(samples: u8, pin: &str) -> String {
        let mut contact = Debounce::new(samples, false);
        pin.chars()
            .map(|c| match contact.sample(c == '#') {
                Some(Edge::Made) => 'M',
                Some(Edge::Broken) => 'B',
                None => ' ',
            })
            .collect()
    }

    #[test]
    fn bounce_gives_one_edge() {
        assert_eq!(
            edges(3, "..#.##.#####.#..."),
            "         M      B" // noise of one sample has no effect
        );
        assert_eq!(edges(1, "..#.##.."), "  MBM B ");
        assert_eq!(edges(0, "..#.##.."), "  MBM B ");
        assert_eq!(edges(2, "#.#.#.#."), "        ");
    }
}
