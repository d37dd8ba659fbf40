//! Latch: the position of the axes at the contact.

use crate::{Debounce, Edge};

/// A reported edge and the position of the axes at it.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Latched<P> {
    /// The edge of the contact.
    pub edge: Edge,
    /// The position at the first sample of the run that made the edge, or earlier by the look-back.
    pub position: P,
}

/// Error of a look-back that is longer than the history.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TooFarBack;

impl core::fmt::Display for TooFarBack {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("run of the debounce plus look-back is longer than the history")
    }
}

impl core::error::Error for TooFarBack {}

/// A debounced contact that latches the position at the instant of contact, not at the instant of
/// its report.
///
/// Each sample stores the position in a ring of `DEPTH` entries. An edge is reported `samples - 1`
/// samples after the pin changed, so the latch looks back by this number. It looks back by
/// `look_back_samples` more for delays in front of the pin: a filter, a bounce on closing, the
/// signal path. `P` is any position: `[i64; 3]` in nm, `[i32; 1]` in counts.
///
/// ```text
/// pin       . . . # . # # # # #       samples = 3
/// sample    0 1 2 3 4 5 6 7 8 9
///                     ^   ^ reported
///                     +---- latched
/// ```
///
/// With `look_back_samples = 2` sample 3 is latched, the first touch of the bounce.
///
/// The remaining error is the distance travelled in one sample period.
#[derive(Copy, Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Latch<P, const DEPTH: usize> {
    contact: Debounce,
    positions: [P; DEPTH],
    newest: usize,
    back: usize,
}

impl<P: Copy, const DEPTH: usize> Latch<P, DEPTH> {
    /// Creates a latch on `contact` with the axes at `position`.
    ///
    /// # Errors
    /// Fails with [`TooFarBack`] unless the run minus one plus `look_back_samples` is below
    /// `DEPTH`.
    pub const fn new(
        contact: Debounce,
        look_back_samples: u8,
        position: P,
    ) -> Result<Latch<P, DEPTH>, TooFarBack> {
        // Two u8: at most 510.
        let back = (contact.delay_samples() as usize).wrapping_add(look_back_samples as usize);
        if back >= DEPTH {
            return Err(TooFarBack);
        }
        Ok(Latch {
            contact,
            positions: [position; DEPTH],
            newest: 0,
            back,
        })
    }

    /// Takes one simultaneous sample of pin and position. Returns the edge in the sample that
    /// completes it.
    pub fn sample(&mut self, closed: bool, position: P) -> Option<Latched<P>> {
        // `newest < DEPTH` holds always, so nothing wraps here or below.
        let next = self.newest.wrapping_add(1);
        self.newest = if next >= DEPTH { 0 } else { next };
        if let Some(slot) = self.positions.get_mut(self.newest) {
            *slot = position;
        }
        let edge = self.contact.sample(closed)?;
        let then = if self.newest >= self.back {
            self.newest.wrapping_sub(self.back)
        } else {
            self.newest.wrapping_add(DEPTH).wrapping_sub(self.back)
        };
        let position = self.positions.get(then).copied().unwrap_or(position);
        Some(Latched { edge, position })
    }

    /// Returns the current level of the contact. `true` is closed.
    #[must_use]
    pub const fn level(&self) -> bool {
        self.contact.level()
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    /// Returns the latched positions for samples at positions 0, 1, 2, ...
    fn latched(samples: u8, look_back: u8, pin: &str) -> Vec<(Edge, i32)> {
        let mut latch = Latch::<[i32; 1], 8>::new(Debounce::new(samples, false), look_back, [-1])
            .expect("within the history");
        (0..)
            .zip(pin.chars())
            .filter_map(|(x, c)| latch.sample(c == '#', [x]))
            .map(|latched| (latched.edge, latched.position[0]))
            .collect()
    }

    #[test]
    fn the_instant_of_contact_is_latched() {
        assert_eq!(latched(1, 0, "...##"), [(Edge::Made, 3)]);
        assert_eq!(latched(3, 0, "...#.#####"), [(Edge::Made, 5)]);
        assert_eq!(latched(3, 2, "...#.#####"), [(Edge::Made, 3)]);
        assert_eq!(
            latched(4, 0, "##########################...."),
            [(Edge::Made, 0), (Edge::Broken, 26)]
        );
        // Before the first sample only the position at set-up is stored.
        assert_eq!(latched(1, 7, "#"), [(Edge::Made, -1)]);
    }

    #[test]
    fn history_must_reach() {
        assert!(Latch::<i32, 8>::new(Debounce::new(4, false), 4, 0).is_ok());
        assert_eq!(
            Latch::<i32, 8>::new(Debounce::new(4, false), 5, 0).err(),
            Some(TooFarBack)
        );
        assert!(Latch::<i32, 0>::new(Debounce::new(1, false), 0, 0).is_err());
    }
}
