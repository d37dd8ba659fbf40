//! The events next to standstill, timed by a table of roots.
//!
//! From standstill the n-th event is due at t1 sqrt(n), where t1 is the time of the first one. The
//! table contains the intervals, so an event takes one product.

/// Number of events in the table.
pub(crate) const MOST: u32 = 64;

/// From this event on, the intervals are stored in finer units.
const FINER: usize = 16;

/// (sqrt(n + 1) - sqrt(n)) times 2^17 for n = 1 to 63, and times 2^19 from event [`FINER`] on. Sums
/// of these entries are rounded roots, so errors do not add up.
#[rustfmt::skip]
const INTERVALS: [u16; 63] = [
    54292, 41659, 35121, 30942, 27974, 25724, 23944, 22488, 21270,
    20231, 19330, 18540, 17840, 17213, 16648, 64543, 62671, 60952,
    59369, 57902, 56540, 55268, 54079, 52964, 51915, 50925, 49991,
    49106, 48267, 47468, 46709, 45984, 45293, 44632, 43998, 43391,
    42809, 42250, 41710, 41193, 40694, 40211, 39747, 39298, 38863,
    38443, 38037, 37642, 37260, 36889, 36530, 36179, 35840, 35510,
    35188, 34876, 34570, 34275, 33984, 33703, 33428, 33159, 32897,
];

/// The time t1 of the first event: `ticks` times 2^-`bits`.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct First {
    ticks: u32,
    bits: u8,
}

impl First {
    /// Converts ticks with 32 fraction bits. Returns `None` if they are too many.
    pub(crate) fn new(time: u64) -> Option<First> {
        // As many fraction bits as fit 32 bits, but at most 30, because an interval takes two more.
        let zeros = time.leading_zeros().min(30);
        let bits = zeros.checked_sub(1)?;
        Some(First {
            ticks: time.wrapping_shr(32_u32.wrapping_sub(bits)) as u32,
            bits: bits as u8,
        })
    }

    /// Whether the first event, which is the longest, takes less than 2^30 ticks.
    pub(crate) const fn is_quick(&self) -> bool {
        self.bits >= 2
    }

    /// Returns the interval before event `number` after a start, counted from 0, in ticks with 32
    /// fraction bits.
    #[inline]
    pub(crate) fn interval(&self, number: u32) -> u64 {
        let index = (number as usize).wrapping_sub(1);
        let Some(interval) = INTERVALS.get(index) else {
            return u64::from(self.ticks).wrapping_shl(32_u32.wrapping_sub(self.bits.into()));
        };
        let interval = u32::from(*interval);
        // Each product is below 2^32. The sum is below 2^32 because the interval is below t1 / 2.
        let high = (self.ticks >> 16).wrapping_mul(interval);
        let low = (self.ticks & 0xffff).wrapping_mul(interval) >> 16;
        let ticks = high.wrapping_add(low);
        // The product has 1 bit more (17 - 16), or 3 (19 - 16).
        let more = if index < FINER.wrapping_sub(1) { 1 } else { 3 };
        // From 0 to 31. Two shifts of 32 bits take less than one of 64.
        let shift = 32_u32.wrapping_sub(u32::from(self.bits).wrapping_add(more));
        let whole = (ticks >> 1).wrapping_shr(31_u32.wrapping_sub(shift));
        u64::from(whole) << 32 | u64::from(ticks.wrapping_shl(shift))
    }
}
