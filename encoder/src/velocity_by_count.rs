//! Velocity from the counts in a time.

/// Velocity by count: the counts of the last `WINDOW` samples, which are taken at equal intervals.
///
/// It is for high speeds. Its resolution is one count in the window, 1/`WINDOW` counts per sample,
/// and its error is below that. The value is the mean over the window, so its age is `WINDOW`/2
/// samples.
///
/// # Examples
/// ```
/// use husillo_encoder::VelocityByCount;
///
/// let mut velocity = VelocityByCount::<8>::new(0);
/// let last = (1..=20).map(|sample| velocity.update(sample * 5 / 2)).last();
/// assert_eq!(last, Some(0x2_8000)); // 2.5 counts per sample
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct VelocityByCount<const WINDOW: usize> {
    /// Positions of the last samples. `oldest` is the index of the oldest one.
    positions: [i32; WINDOW],
    oldest: usize,
}

impl<const WINDOW: usize> VelocityByCount<WINDOW> {
    const SAMPLES: i64 = {
        assert!(WINDOW > 0 && WINDOW <= 1 << 20);
        WINDOW as i64
    };

    /// Creates it at rest at this position.
    pub const fn new(position: i32) -> Self {
        Self {
            positions: [position; WINDOW],
            oldest: 0,
        }
    }

    /// Takes the position of this sample and returns the velocity in 2^-16 counts per sample,
    /// rounded to zero and limited to 32 bits.
    ///
    /// # Cost
    /// A division by a constant, or a shift and an addition if `WINDOW` is a power of two.
    #[inline]
    pub fn update(&mut self, position: i32) -> i32 {
        let Some(oldest) = self.positions.get_mut(self.oldest) else {
            return 0;
        };
        let before = core::mem::replace(oldest, position);
        self.oldest = match self.oldest.wrapping_add(1) {
            next if next < WINDOW => next,
            _ => 0,
        };
        let counts = i64::from(position.wrapping_sub(before));
        // 48 bits; SAMPLES is not 0.
        let velocity = (counts << 16).checked_div(Self::SAMPLES).unwrap_or(0);
        velocity.clamp(i32::MIN.into(), i32::MAX.into()) as i32
    }
}
