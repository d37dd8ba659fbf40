//! Extension of a hardware counter to more bits.

/// A position of 64 (or 32) bits from the readings of a counter with `BITS` bits, 1 to 32, that
/// wraps.
///
/// It is exact if less than half the range of the counter passes between readings: -128 to 127
/// counts for 8 bits, -32768 to 32767 for 16. The difference modulo 2^`BITS` counts as a signed
/// number, as in the comparison of sequence numbers (RFC 1982).
///
/// # Cost
/// 10 instructions on a Cortex-M4F, with the loop. 16 bytes.
///
/// # Examples
/// ```
/// use husillo_encoder::Extended;
///
/// let mut position = Extended::<16>::new(65_530);
/// assert_eq!(position.update(4), 10);
/// assert_eq!(position.update(65_534), -6);
/// assert_eq!(position.position(), 4);
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Extended<const BITS: u32> {
    position: i64,
    reading: u32,
}

impl<const BITS: u32> Extended<BITS> {
    /// The shift that puts the sign of a difference into the top bit.
    const SPARE_BITS: u32 = {
        assert!(1 <= BITS && BITS <= 32);
        32 - BITS
    };

    /// Creates it at position 0 with the present reading. Bits beyond `BITS` are ignored.
    pub const fn new(reading: u32) -> Self {
        Self {
            position: 0,
            reading,
        }
    }

    /// Takes a reading and returns the counts since the last one.
    #[inline]
    pub fn update(&mut self, reading: u32) -> i32 {
        let difference = reading.wrapping_sub(self.reading);
        self.reading = reading;
        // SPARE_BITS is at most 31.
        let counts = difference.wrapping_shl(Self::SPARE_BITS) as i32;
        let counts = counts.wrapping_shr(Self::SPARE_BITS);
        // 2^63 counts are 292 years at 1 GHz.
        self.position = self.position.wrapping_add(counts.into());
        counts
    }

    /// Returns the counts from the last set position.
    pub const fn position(&self) -> i64 {
        self.position
    }

    /// Returns the same in 32 bits, wrapping.
    pub const fn position_32(&self) -> i32 {
        self.position as i32
    }

    /// Sets the position of the last reading.
    pub const fn set_position(&mut self, position: i64) {
        self.position = position;
    }
}
