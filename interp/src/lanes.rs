//! A byte for each of eight axes, in two words.

/// The bytes of the first four axes, and of the other four. Without axes above the fourth the
/// compiler drops the second word.
#[derive(Copy, Clone, Default)]
pub(crate) struct Lanes([u32; 2]);

impl Lanes {
    /// 1 in the bytes of these axes.
    #[inline(always)]
    pub(crate) const fn of(axes: u8) -> Lanes {
        // Four bits to the bits 0, 8, 16 and 24; their copies do not overlap.
        const fn spread(bits: u8) -> u32 {
            (bits as u32 & 15).wrapping_mul(0x0020_4081) & 0x0101_0101
        }
        Lanes([spread(axes), spread(axes >> 4)])
    }

    /// Sets the byte of an axis below 8 to 1.
    #[inline(always)]
    pub(crate) const fn set(&mut self, axis: u32) {
        let [low, high] = self.0;
        let bit = 1_u32.wrapping_shl((axis & 3).wrapping_mul(8));
        self.0 = if axis < 4 {
            [low | bit, high]
        } else {
            [low, high | bit]
        };
    }

    /// Adds to every byte.
    #[inline(always)]
    pub(crate) const fn add(&mut self, other: Lanes) {
        let ([low, high], [more_low, more_high]) = (self.0, other.0);
        self.0 = [low.wrapping_add(more_low), high.wrapping_add(more_high)];
    }

    /// The bytes of the first axes.
    #[inline(always)]
    pub(crate) fn bytes<const N: usize>(self) -> [u8; N] {
        let [low, high] = self.0.map(u32::to_le_bytes);
        core::array::from_fn(|axis| {
            let half = if axis < 4 { low } else { high };
            half.get(axis & 3).copied().unwrap_or(0)
        })
    }

    /// -1 in the bytes of these axes, and 1 in all others.
    #[inline(always)]
    pub(crate) fn signs(negative: u8) -> Lanes {
        let [low, high] = Lanes::of(negative).0;
        Lanes([low, high].map(|ones| ones.wrapping_mul(254) | 0x0101_0101))
    }

    /// These signs for the axes that step, as 1 in their bytes says. Returns those of the first
    /// axes.
    #[inline(always)]
    pub(crate) fn of_steps<const N: usize>(self, due: Lanes) -> [i8; N] {
        let ([low, high], [due_low, due_high]) = (self.0, due.0);
        // All bits of the bytes that are due.
        let signs = [
            low & due_low.wrapping_mul(255),
            high & due_high.wrapping_mul(255),
        ];
        Lanes(signs).bytes().map(u8::cast_signed)
    }
}
