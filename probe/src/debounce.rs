//! One clean edge out of a contact that bounces.

/// What a contact did.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Edge {
    /// It closed: the stylus touches.
    Made,
    /// It opened: the stylus is free.
    Broken,
}

impl Edge {
    /// The level of the contact after this edge: `true` is closed.
    #[must_use]
    pub const fn level(self) -> bool {
        matches!(self, Edge::Made)
    }
}

/// A level that changes only after so many equal samples in a row.
///
/// A run that is cut short by one sample of the old level begins anew, so a disturbance shorter
/// than the run is never seen. The price is a delay of `samples - 1` samples, the same for every
/// edge: [`Latch`](crate::Latch) takes it back. One compare and one count a sample.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Debounce {
    samples: u8,
    run: u8,
    level: bool,
}

impl Debounce {
    /// A contact at `level` now, that changes after `samples` equal samples; 0 is taken as 1, which
    /// passes everything.
    #[must_use]
    pub const fn new(samples: u8, level: bool) -> Debounce {
        Debounce {
            samples: if samples == 0 { 1 } else { samples },
            run: 0,
            level,
        }
    }

    /// Takes one sample of the pin, `true` is closed; returns the edge in the sample that completes
    /// a run.
    pub const fn sample(&mut self, closed: bool) -> Option<Edge> {
        if closed == self.level {
            self.run = 0;
            return None;
        }
        // Below `samples` before, so it fits.
        self.run = self.run.saturating_add(1);
        if self.run < self.samples {
            return None;
        }
        self.run = 0;
        self.level = closed;
        Some(if closed { Edge::Made } else { Edge::Broken })
    }

    /// The level now, `true` is closed.
    #[must_use]
    pub const fn level(&self) -> bool {
        self.level
    }

    /// Samples between an edge of the pin and its report: one less than the run.
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

    /// `#` is closed, `.` open; the reported edges come out as `M` and `B`.
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
            "         M      B" // noise of one sample is not seen
        );
        assert_eq!(edges(1, "..#.##.."), "  MBM B ");
        assert_eq!(edges(0, "..#.##.."), "  MBM B ");
        assert_eq!(edges(2, "#.#.#.#."), "        ");
    }
}
