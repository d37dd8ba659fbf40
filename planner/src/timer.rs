//! Sweep to timer ticks at constant speed.

/// Times the events of one move: each waits in proportion to its sweep, nothing is rounded away.
///
/// Set up with the ticks of the whole move; the waits of all its events then add up to exactly
/// those ticks (see [`Timer::new`]). An event costs a multiplication and an addition, two of each where the
/// move has more sweep than the rate is fine for; the divisions are all in the set-up.
///
/// ```
/// let mut timer = husillo_planner::Timer::new(1000, 3, 1);
/// assert_eq!([timer.wait(1), timer.wait(1), timer.wait(1)], [333, 333, 334]);
/// ```
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Timer {
    /// Ticks for one unit of sweep, times 2^`fraction_bits`.
    rate: u64,
    /// 32 more fraction bits of the rate.
    rate_low: u32,
    /// Fraction of a tick owed, below 2^`fraction_bits` between events.
    owed: u64,
    owed_low: u32,
    fraction_bits: u8,
    /// Those above the lower word, 0 to 29. More: there are fewer than 32, or the rate goes on below them.
    upper_bits: u8,
}

/// Products of rate and sweep stay below 2 to this: then adding what is owed cannot overflow.
const PRODUCT_BITS: u32 = 62;

impl Timer {
    /// The timer of a move that takes `ticks` for its whole `sweep`, of which no event has more
    /// than `largest_sweep`.
    ///
    /// The rate gets as many fraction bits as products with `largest_sweep` leave in 64 bits, and
    /// 32 more below them where `sweep` has more bits than those, rounded up: the sum of all waits
    /// is exactly `ticks` wherever `ticks * largest_sweep` is below 2^92, and after any number of
    /// events it is the true time so far, rounded down, or one tick more at most. The longest wait,
    /// `ticks / sweep * largest_sweep`, has to be below 2^61 ticks; beyond that waits are cut to it. A
    /// sweep of 0 is taken as 1.
    pub fn new(ticks: u64, sweep: u64, largest_sweep: u32) -> Timer {
        Timer::rounded_up(ticks, sweep, largest_sweep, 61, true)
    }

    /// [`Timer::new`] with no more than so many fraction bits, 61 at most, and always 32 more below them: for what adds up over many moves.
    pub(crate) fn with_most_bits(ticks: u64, sweep: u64, largest_sweep: u32, most: u8) -> Timer {
        Timer::rounded_up(ticks, sweep, largest_sweep, most, false)
    }

    /// With 32 bits more, or so many fewer as keep the whole within the last tick.
    fn rounded_up(
        ticks: u64,
        sweep: u64,
        largest_sweep: u32,
        most: u8,
        is_one_move: bool,
    ) -> Timer {
        let (sweep, largest_sweep) = (sweep.max(1), u64::from(largest_sweep));
        // The longest wait is below 2^(bits(ticks) - bits(sweep) + 1 + bits(largest)).
        let longest = bits(ticks)
            .wrapping_add(1)
            .wrapping_add(bits(largest_sweep))
            .saturating_sub(bits(sweep));
        // At most 61, so that 2^fraction_bits owed fits beside a product.
        let fraction_bits = PRODUCT_BITS
            .saturating_sub(longest)
            .min(most.min(61).into()) as u8;
        let (rate, rest) = scaled_quotient(ticks, sweep, fraction_bits);
        let (mut low, rest) = continue_quotient(0, rest, sweep, 32);
        // Up, so that the whole sweep reaches the last tick in spite of the cut.
        if rest != 0 {
            low = low.wrapping_add(1);
        }
        // By the rate alone, rounded up, 2^fraction_bits units of sweep are less than a tick too long.
        if is_one_move && low != 0 && bits(sweep) <= fraction_bits.into() {
            low = 1 << 32;
        }
        let rate = rate.saturating_add(low >> 32);
        let most = (1_u64 << PRODUCT_BITS)
            .checked_div(largest_sweep)
            .unwrap_or(u64::MAX);
        Timer::of(rate.min(most), low as u32, fraction_bits)
    }

    /// The timer with a given number of fraction bits (0 to 61) and nothing below them:
    /// rate = round(`ticks` 2^q / `sweep`), 2^64 - 1 where that is more. The caller sees to it that
    /// rate times sweep fits 63 bits. Ticks per BLU over the radius, both as `timing.json` has them.
    pub fn with_fraction_bits(ticks: u64, sweep: u64, q: u8) -> Timer {
        let sweep = sweep.max(1);
        let fraction_bits = q.min(61);
        let (rate, rest) = scaled_quotient(ticks, sweep, fraction_bits);
        // Half or more goes up; rest < sweep.
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

    /// Ticks to wait before an event of this `sweep`; what is less than a tick is owed to the next.
    #[inline]
    pub fn wait(&mut self, sweep: u32) -> u64 {
        let sweep = u64::from(sweep);
        if self.fits_upper() {
            self.split_upper(self.rate.wrapping_mul(sweep))
        } else {
            self.split(sweep)
        }
    }

    /// [`wait`](Timer::wait) of an event of sweep 1, as all of a [line](https://docs.rs/husillo-interp) have: where chips of 32 bits need not shift
    /// words of 64, without its multiplication, which takes a Cortex-M0 50 instructions.
    #[inline]
    pub fn wait_one(&mut self) -> u64 {
        if self.fits_upper() {
            self.split_upper(self.rate)
        } else {
            self.split(1)
        }
    }

    /// Whether a chip of 32 bits need not shift words of 64: so it is where waits are below 2^28 and the move's sweep is below 2^32.
    #[inline]
    const fn fits_upper(&self) -> bool {
        cfg!(target_pointer_width = "32") && self.upper_bits < 32
    }

    /// Whole ticks of a product and of what was owed before it; all shifts are within the upper word.
    #[inline]
    const fn split_upper(&mut self, product: u64) -> u64 {
        // At most 2^62 + 2^32, and owed < 2^61.
        let sum = self.owed.wrapping_add(product);
        let ticks = ((sum >> 32) as u32).wrapping_shr(self.upper_bits as u32);
        let whole = ticks.wrapping_shl(self.upper_bits as u32) as u64;
        self.owed = sum.wrapping_sub(whole << 32);
        ticks as u64
    }

    /// Whole ticks of an event and of what was owed before it, with all its bits.
    #[cfg_attr(target_pointer_width = "32", inline(never))]
    #[cfg_attr(not(target_pointer_width = "32"), inline)]
    fn split(&mut self, sweep: u64) -> u64 {
        // At most 2^62 + 2^32, and owed < 2^61.
        let sum = self.product(sweep).wrapping_add(self.owed);
        let ticks = sum.wrapping_shr(self.fraction_bits.into());
        self.owed = sum.wrapping_sub(ticks.wrapping_shl(self.fraction_bits.into()));
        ticks
    }

    /// The time of an event with all its fraction bits, of which nothing is owed here.
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

    /// Fraction bits of the rate.
    pub const fn fraction_bits(&self) -> u8 {
        self.fraction_bits
    }

    /// Ticks for one unit of sweep, times 2^[`fraction_bits`](Timer::fraction_bits), rounded up where nothing is kept below that, otherwise down.
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

/// Appends `count` more bits to a quotient: long division in digits of as many bits as `sweep`
/// leaves free in 64, so 64-bit division is enough. Saturates.
fn continue_quotient(quotient: u64, rest: u64, sweep: u64, count: u32) -> (u64, u64) {
    let (mut quotient, mut rest, mut count) = (quotient, rest, count);
    while count != 0 {
        let digit_bits = sweep.leading_zeros().min(count);
        if digit_bits == 0 {
            // sweep >= 2^63: one bit; doubling rest may carry out of 64 bits.
            let carries = rest >> 63 != 0;
            rest = rest.wrapping_shl(1);
            let digit = carries || rest >= sweep;
            if digit {
                rest = rest.wrapping_sub(sweep);
            }
            quotient = append(quotient, 1, digit.into());
            count = count.wrapping_sub(1);
        } else {
            // rest < sweep < 2^(64 - digit_bits): the shift loses nothing.
            let scaled = rest.wrapping_shl(digit_bits);
            let digit = scaled.checked_div(sweep).unwrap_or(0);
            rest = scaled.wrapping_sub(digit.wrapping_mul(sweep));
            quotient = append(quotient, digit_bits, digit);
            count = count.wrapping_sub(digit_bits);
        }
    }
    (quotient, rest)
}

/// `quotient` 2^`count` + `digit`, `u64::MAX` where that does not fit.
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
        /// What chips of 32 bits reckon in the upper word is what words of 64 give.
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
