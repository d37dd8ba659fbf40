//! Sweep to timer ticks at constant speed.

use crate::Waits;

/// Times the events of one move at constant speed. Each event waits in proportion to its sweep, and
/// remainders are carried.
///
/// Created with the ticks of the whole move. The waits of all its events add up to exactly those
/// ticks (see [`Timer::new`]).
///
/// # Cost
/// An event takes one multiplication and one addition; it takes two of each where the move has more
/// sweep than the resolution of the rate covers. All divisions are in the set-up.
///
/// # Examples
/// ```
/// let mut timer = husillo_planner::Timer::new(1000, 3, 1);
/// assert_eq!([timer.wait(1), timer.wait(1), timer.wait(1)], [333, 333, 334]);
/// ```
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Timer {
    /// Ticks per unit of sweep, times 2^`fraction_bits`.
    rate: u64,
    /// 32 more fraction bits of the rate.
    rate_low: u32,
    /// Carried fraction of a tick, below 2^`fraction_bits` between events.
    owed: u64,
    owed_low: u32,
    fraction_bits: u8,
    /// Number of fraction bits above the lower word, 0 to 29. A larger value means that there are
    /// fewer than 32 fraction bits, or that the rate continues below them.
    upper_bits: u8,
}

/// Products of rate and sweep stay below 2 to this, so the carried part can be added without
/// overflow.
const PRODUCT_BITS: u32 = 62;

impl Timer {
    /// Creates the timer of a move that takes `ticks` for its whole `sweep`. No event has more
    /// sweep than `largest_sweep`.
    ///
    /// The rate has as many fraction bits as products with `largest_sweep` leave in 64 bits, and 32
    /// more below them where `sweep` has more bits than those; it is rounded up. The sum of all
    /// waits is exactly `ticks` wherever `ticks * largest_sweep` is below 2^92. After any number of
    /// events it is the true time so far, rounded down, or at most one tick more. The longest wait,
    /// `ticks / sweep * largest_sweep`, has to be below 2^61 ticks; longer waits are cut to it. A
    /// sweep of 0 is taken as 1.
    pub fn new(ticks: u64, sweep: u64, largest_sweep: u32) -> Timer {
        Timer::rounded_up(ticks, sweep, largest_sweep.into(), 61, true)
    }

    /// Does [`Timer::new`] with at most `most` fraction bits (limited to 61), and always 32 more
    /// below them: for times that add up over many moves.
    pub(crate) fn with_most_bits(ticks: u64, sweep: u64, largest_sweep: u64, most: u8) -> Timer {
        Timer::rounded_up(ticks, sweep, largest_sweep, most, false)
    }

    /// Uses 32 more bits, or none where the rate alone keeps the whole move within its last tick.
    fn rounded_up(
        ticks: u64,
        sweep: u64,
        largest_sweep: u64,
        most: u8,
        is_one_move: bool,
    ) -> Timer {
        let sweep = sweep.max(1);
        // The longest wait is below 2^(bits(ticks) - bits(sweep) + 1 + bits(largest)).
        let longest = bits(ticks)
            .wrapping_add(1)
            .wrapping_add(bits(largest_sweep))
            .saturating_sub(bits(sweep));
        // At most 61, so that a carried 2^fraction_bits fits next to a product.
        let fraction_bits = PRODUCT_BITS
            .saturating_sub(longest)
            .min(most.min(61).into()) as u8;
        let (rate, rest) = scaled_quotient(ticks, sweep, fraction_bits);
        let (mut low, rest) = continue_quotient(0, rest, sweep, 32);
        // Rounded up, so that the whole sweep reaches the last tick in spite of the cut.
        if rest != 0 {
            low = low.wrapping_add(1);
        }
        // With the rate alone rounded up, 2^fraction_bits units of sweep are less than a tick too
        // long.
        if is_one_move && low != 0 && bits(sweep) <= u32::from(fraction_bits) {
            low = 1 << 32;
        }
        let rate = rate.saturating_add(low >> 32);
        let most = (1_u64 << PRODUCT_BITS)
            .checked_div(largest_sweep)
            .unwrap_or(u64::MAX);
        Timer::of(rate.min(most), low as u32, fraction_bits)
    }

    /// Creates a timer with a given number of fraction bits (0 to 61) and none below them: rate =
    /// round(`ticks` 2^q / `sweep`), limited to 2^64 - 1.
    ///
    /// The caller guarantees that rate times sweep fits in 63 bits. `ticks` may be ticks per BLU
    /// and `sweep` the radius, as in `timing.json`.
    pub fn with_fraction_bits(ticks: u64, sweep: u64, q: u8) -> Timer {
        let sweep = sweep.max(1);
        let fraction_bits = q.min(61);
        let (rate, rest) = scaled_quotient(ticks, sweep, fraction_bits);
        // Rounds half up; rest < sweep.
        let is_up = rest >= sweep.wrapping_sub(rest);
        Timer::of(rate.saturating_add(is_up.into()), 0, fraction_bits)
    }

    const fn of(rate: u64, rate_low: u32, fraction_bits: u8) -> Timer {
        Timer {
            rate,
            rate_low,
            owed: 0,
            owed_low: 0,
            fraction_bits,
            upper_bits: if rate_low == 0 {
                fraction_bits.wrapping_sub(32)
            } else {
                u8::MAX
            },
        }
    }

    /// Ticks to wait before an event of this `sweep`. The fraction of a tick is carried to the next
    /// event.
    #[inline]
    pub fn wait(&mut self, sweep: u32) -> u64 {
        let sweep = u64::from(sweep);
        if self.fits_upper() {
            self.split_upper(self.rate.wrapping_mul(sweep))
        } else {
            self.split(sweep)
        }
    }

    /// [`wait`](Timer::wait) of an event of sweep 1, which all events of a
    /// [line](https://docs.rs/husillo-interp) have.
    ///
    /// Where 32-bit processors need not shift 64-bit words, it saves the multiplication: 50
    /// instructions on a Cortex-M0.
    #[inline]
    pub fn wait_one(&mut self) -> u64 {
        if self.fits_upper() {
            self.split_upper(self.rate)
        } else {
            self.split(1)
        }
    }

    /// Writes the waits before the next events of sweep 1, as [`wait_one`](Timer::wait_one) returns
    /// them. There are as many as there are places, or fewer where a wait is longer than 2^31
    /// ticks.
    pub fn fill<'a>(&mut self, places: impl Iterator<Item = &'a mut u32>) -> Waits {
        let (mut timer, mut waits) = (self.clone(), Waits::NONE);
        for place in places {
            if !waits.add(timer.wait_one(), place) {
                break;
            }
        }
        *self = timer;
        waits
    }

    /// Whether a 32-bit processor can avoid shifts of 64-bit words. It can where waits are below
    /// 2^28 and the sweep of the move is below 2^32.
    #[inline]
    const fn fits_upper(&self) -> bool {
        cfg!(target_pointer_width = "32") && self.upper_bits < 32
    }

    /// Whole ticks of a product and of the carried fraction; all shifts are within the upper word.
    #[inline]
    const fn split_upper(&mut self, product: u64) -> u64 {
        // At most 2^62 + 2^32, and owed < 2^61.
        let sum = self.owed.wrapping_add(product);
        let ticks = ((sum >> 32) as u32).wrapping_shr(self.upper_bits as u32);
        let whole = ticks.wrapping_shl(self.upper_bits as u32) as u64;
        self.owed = sum.wrapping_sub(whole << 32);
        ticks as u64
    }

    /// Whole ticks of an event and of the carried fraction, with all its bits.
    #[cfg_attr(target_pointer_width = "32", inline(never))]
    #[cfg_attr(not(target_pointer_width = "32"), inline)]
    fn split(&mut self, sweep: u64) -> u64 {
        // At most 2^62 + 2^32, and owed < 2^61.
        let sum = self.product(sweep).wrapping_add(self.owed);
        let ticks = sum.wrapping_shr(self.fraction_bits.into());
        self.owed = sum.wrapping_sub(ticks.wrapping_shl(self.fraction_bits.into()));
        ticks
    }

    /// The time of an event with all its fraction bits; nothing of it is carried here.
    #[inline]
    pub(crate) fn product(&mut self, sweep: u64) -> u64 {
        // sweep < 2^32: (2^32 - 1)^2 + 2^32 - 1 fits.
        let low = u64::from(self.rate_low)
            .wrapping_mul(sweep)
            .wrapping_add(self.owed_low.into());
        self.owed_low = low as u32;
        // rate sweep <= 2^62, low >> 32 < 2^32.
        self.rate.wrapping_mul(sweep).wrapping_add(low >> 32)
    }

    /// Does [`product`](Self::product) for the sweep of many events, below 2^63.
    pub(crate) fn product_of_many(&mut self, sweep: u64) -> u64 {
        let [upper, lower] = [sweep >> 32, sweep & 0xffff_ffff];
        let lower = self.product(lower);
        let low = u64::from(self.rate_low).wrapping_mul(upper);
        lower
            .wrapping_add(self.rate.wrapping_mul(upper << 32))
            .wrapping_add(low)
    }

    /// Number of fraction bits of the rate.
    pub const fn fraction_bits(&self) -> u8 {
        self.fraction_bits
    }

    /// Ticks per unit of sweep, times 2^[`fraction_bits`](Timer::fraction_bits). Rounded up where
    /// no bits are kept below, otherwise down.
    pub const fn rate(&self) -> u64 {
        self.rate
    }
}

pub(crate) const fn bits(value: u64) -> u32 {
    64_u32.wrapping_sub(value.leading_zeros())
}

/// floor(`ticks` 2^`fraction_bits` / `sweep`) and the remainder; `sweep` is not 0.
pub(crate) fn scaled_quotient(ticks: u64, sweep: u64, fraction_bits: u8) -> (u64, u64) {
    let whole = ticks.checked_div(sweep).unwrap_or(0);
    let rest = ticks.wrapping_sub(whole.wrapping_mul(sweep));
    continue_quotient(whole, rest, sweep, fraction_bits.into())
}

/// Appends `count` more bits to a quotient. This is long division in digits of as many bits as
/// `sweep` leaves free in 64, so 64-bit division is enough. Saturates.
fn continue_quotient(quotient: u64, rest: u64, sweep: u64, count: u32) -> (u64, u64) {
    let (mut quotient, mut rest, mut count) = (quotient, rest, count);
    while count != 0 {
        let digit_bits = sweep.leading_zeros().min(count);
        if digit_bits == 0 {
            // sweep >= 2^63, so one bit at a time; doubling rest may carry out of 64 bits.
            let carries = rest >> 63 != 0;
            rest = rest.wrapping_shl(1);
            let digit = carries || rest >= sweep;
            if digit {
                rest = rest.wrapping_sub(sweep);
            }
            quotient = append(quotient, 1, digit.into());
            count = count.wrapping_sub(1);
        } else {
            // rest < sweep < 2^(64 - digit_bits), so the shift loses nothing.
            let scaled = rest.wrapping_shl(digit_bits);
            let digit = scaled.checked_div(sweep).unwrap_or(0);
            rest = scaled.wrapping_sub(digit.wrapping_mul(sweep));
            quotient = append(quotient, digit_bits, digit);
            count = count.wrapping_sub(digit_bits);
        }
    }
    (quotient, rest)
}

/// `quotient` 2^`count` + `digit`; `u64::MAX` on overflow.
fn append(quotient: u64, count: u32, digit: u64) -> u64 {
    if quotient.leading_zeros() < count && quotient != 0 {
        u64::MAX
    } else {
        quotient.wrapping_shl(count) | digit
    }
}

#[cfg(test)]
mod tests {
    use super::Timer;
    use proptest::prelude::*;

    proptest! {
        /// The arithmetic of 32-bit processors in the upper word gives the results of 64-bit words.
        #[test]
        fn upper_words_are_enough(
            ticks in 0_u64..1 << 31,
            total in 1_u64 << 8..1 << 40,
            sweeps in prop::collection::vec(prop_oneof![Just(1_u32), 1..1_u32 << 20], 1..100),
        ) {
            let mut timer = Timer::new(ticks, total, 1 << 20);
            prop_assume!(timer.upper_bits < 32);
            let mut other = timer.clone();
            for sweep in sweeps {
                let sweep = u64::from(sweep);
                let product = timer.rate * sweep;
                prop_assert_eq!(timer.split_upper(product), other.split(sweep));
                prop_assert_eq!(&timer, &other);
            }
        }
    }
}
