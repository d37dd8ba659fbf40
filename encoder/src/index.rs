//! The index mark on the disc or scale.

use core::num::NonZeroU32;

/// The encoder passed its index.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Passage {
    /// Position in counts: the lower edge of the mark, in both directions of motion.
    pub position: i32,
    /// Number of surplus counts (or of lost ones, if negative) since the previous passage. 0 at the
    /// first one.
    pub error_counts: i32,
}

/// Watches the index: its position, and whether counts were lost since its last passage.
///
/// ```text
///     counts   7   8   9  10  11
///     index  __________|‾‾‾|______
///     upwards it rises in count 10, downwards it falls in count 10: always position 10
/// ```
///
/// The same edge of the mark counts in both directions, so that references from both sides are
/// equal. If the encoder reverses within the count in which the index changes, the passage may be
/// missed. It may also be off by the width of the mark, because the other edge is taken (1 count if
/// the encoder gates its index with A and B).
///
/// # Examples
/// ```
/// use husillo_encoder::Index;
///
/// let mut index = Index::new(400, false, 0);
/// let mut passages = (0..1000).filter_map(|count: i32| index.sample(count % 400 == 100, count));
/// assert_eq!(passages.next().unwrap().position, 100);
/// let second = passages.next().unwrap();
/// assert_eq!((second.position, second.error_counts), (500, 0));
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Index {
    counts_per_mark: Option<NonZeroU32>,
    level: bool,
    position: i32,
    is_backward: bool,
    last: Option<i32>,
}

impl Index {
    /// Creates it with the present level and position. `counts_per_mark` is the distance of marks
    /// in counts: the counts of a revolution, or 0 for the only mark of a scale.
    pub const fn new(counts_per_mark: u32, level: bool, position: i32) -> Self {
        Self {
            counts_per_mark: NonZeroU32::new(counts_per_mark),
            level,
            position,
            is_backward: false,
            last: None,
        }
    }

    /// Takes the level of the index and the position of the same sample. Returns the passage if
    /// this sample has one.
    #[inline]
    pub fn sample(&mut self, level: bool, position: i32) -> Option<Passage> {
        let moved = position.wrapping_sub(self.position);
        let before = core::mem::replace(&mut self.position, position);
        if moved != 0 {
            self.is_backward = moved < 0;
        }
        if core::mem::replace(&mut self.level, level) == level || self.is_backward == level {
            return None;
        }
        // In the downward direction the mark ended in the previous sample.
        let position = if self.is_backward { before } else { position };
        Some(self.pass(position))
    }

    fn pass(&mut self, position: i32) -> Passage {
        let since = self.last.map_or(0, |last| position.wrapping_sub(last));
        self.last = Some(position);
        Passage {
            position,
            error_counts: self
                .counts_per_mark
                .map_or(since, |pitch| nearest_rest(since, pitch)),
        }
    }

    /// Drops the last passage. Call it after the position was set.
    pub const fn set_position(&mut self, position: i32) {
        self.position = position;
        self.last = None;
    }
}

/// The difference of `counts` to the nearest multiple of `pitch`.
fn nearest_rest(counts: i32, pitch: NonZeroU32) -> i32 {
    // A divisor that is not 0: no remainder of unsigned numbers can fail.
    let rest = counts.unsigned_abs() % pitch;
    let rest = if rest > pitch.get() / 2 {
        // -2^31 < rest - pitch < 0 as pitch / 2 < rest < pitch
        rest.wrapping_sub(pitch.get()) as i32
    } else {
        // At most 2^31 - 1: the largest pitch halved.
        rest as i32
    };
    rest.wrapping_mul(counts.signum())
}
