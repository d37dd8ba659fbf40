//! Time as a function of the path within a slice.

use crate::{Piece, Slice, quotient::quotient};

/// The whole of a slice in units of its length and of its time.
const ONE: u64 = 1 << 32;

/// A Newton step below this, a 2^16th part of a slice, is the last one: the error after it is a
/// 2^32th part, or a few of them where the speed changes by much.
const NEAR: u64 = 1 << 16;

/// Time as a function of the path within a slice. With x the part of the path, and m and n the
/// mean speed divided by the speeds at both ends, the time is
///
/// ```text
/// t = time x (m - x (2 (m - 1) + (n - 1) - x (m + n - 2)))
/// ```
///
/// where the speed changes little. Otherwise the path, a cubic of the time, is solved for the time.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct Law {
    slice: Slice,
    /// Path of the slice.
    pub(crate) length: u64,
    /// Time of the slice in 2^-32 tick.
    time: u64,
    /// Leading zeros of the length, and 2^63 divided by its 32 highest bits.
    zeros: u8,
    inverse: u32,
    /// The coefficients in units of 2^-31, where the speed changes little.
    cubic: Option<Cubic>,
}

#[derive(Copy, Clone, Debug)]
struct Cubic {
    linear: u32,
    square: i32,
    cube: i32,
}

impl Law {
    pub(crate) fn new(slice: &Slice, time: u64) -> Law {
        let length = slice.length();
        let zeros = length.leading_zeros().min(63);
        let divisor = (length.wrapping_shl(zeros) >> 32) as u32;
        let inverse = quotient(1 << 63, divisor).min(u32::MAX.into()) as u32;
        // A speed may have a bit more than the length.
        let part = |speed: u64| {
            let scaled = speed.wrapping_shl(zeros.saturating_sub(1)) >> 32;
            (scaled.wrapping_mul(inverse.into()) >> 31) as u32
        };
        Law {
            slice: *slice,
            length,
            time,
            zeros: zeros as u8,
            inverse,
            cubic: Cubic::new(slice, length, part),
        }
    }

    /// Whether the cubic holds.
    pub(crate) const fn is_smooth(&self) -> bool {
        self.cubic.is_some()
    }

    /// The part of the path, in units of 2^-32; below 2^32 and rounded down by less than 2.
    pub(crate) fn share(&self, path: u64) -> u32 {
        let path = path.wrapping_shl(self.zeros.into()) >> 32;
        // path < 2^64 / inverse 2^31.
        (path.wrapping_mul(self.inverse.into()) >> 31).min(u32::MAX.into()) as u32
    }

    /// Returns how many events of at most `event` fit in the slice after `passage`; up to one too
    /// few. `share` is the share of `event`.
    pub(crate) fn count(&self, passage: &Passage, event: u32, share: u32, most: u32) -> u32 {
        let path = self.length.wrapping_sub(passage.passed);
        // The share of the passed path was rounded down, by less than 2, and so was that of the
        // event.
        let room = !passage.share;
        let count = room.checked_div(share.saturating_add(2)).unwrap_or(0);
        let count = count.min(most);
        if u64::from(count).wrapping_mul(event.into()) > path {
            count.saturating_sub(1)
        } else {
            count
        }
    }

    /// Solves for the time, from a time before it. In units of 2^-32 slice, accurate to a few.
    fn solve(&self, path: u64, before: u64) -> u64 {
        let (mut low, mut high) = (before, ONE);
        // Newton steps converge from the end with the higher speed. From the last event they take
        // fewer steps, unless the path is next to standstill there.
        let mut time = if self.slice.end_speed() >> 1 > self.slice.speed {
            high
        } else {
            low
        };
        for _ in 0..40 {
            let (at, speed) = self.at(time);
            let step = ratio(at.abs_diff(path), speed);
            let is_last = step < NEAR;
            let next = if at > path {
                high = time;
                time.saturating_sub(step)
            } else {
                low = time;
                time.saturating_add(step)
            };
            if is_last {
                return next.max(low).min(high);
            }
            if high.saturating_sub(low) <= 1 {
                break;
            }
            // Next to standstill, halve instead.
            time = if next > low && next < high {
                next
            } else {
                low.wrapping_add(high) >> 1
            };
        }
        time
    }

    /// Path and speed at a time.
    fn at(&self, time: u64) -> (u64, u64) {
        let Ok(share) = u32::try_from(time) else {
            return (self.length, self.slice.end_speed());
        };
        let times = |value: i64| signed_part(value, share);
        // Below 2^40.
        let Slice { speed, bend, twist } = self.slice;
        // With b and c for bend and twist: c x, (b + c x) x, and (2 b + 3 c x) x.
        let twisted = i64::from(twist).wrapping_mul(share.into()) >> 32;
        let bent = times(bend.wrapping_add(twisted));
        let slope = bent.wrapping_mul(2).wrapping_add(times(twisted));
        let speed = speed as i64;
        let path = times(speed.wrapping_add(bent));
        (path.max(0) as u64, speed.wrapping_add(slope).max(0) as u64)
    }
}

impl Cubic {
    /// The cubic, where the speed changes by at most a quarter. `part` returns a path in units of
    /// 2^-31 of the length of the slice.
    fn new(slice: &Slice, length: u64, part: impl Fn(u64) -> u32) -> Option<Cubic> {
        let [speed, end] = [slice.speed, slice.end_speed()];
        let is_even = |one: u64, other: u64| one.abs_diff(other) <= one.min(other) >> 2;
        // The speed may also change and change back within the slice.
        if !is_even(speed, end) || !is_even(length, speed) || !is_even(length, end) || speed == 0 {
            return None;
        }
        // The mean speed is 1, so these are 0.8 to 1.25, and their inverses too.
        let [first, last] = [speed, end].map(|speed| inverse_of(part(speed)));
        let excess = |ratio: u32| ratio.wrapping_sub(1 << 31) as i32;
        let [one, other] = [excess(first), excess(last)];
        let cube = one.wrapping_add(other);
        Some(Cubic {
            linear: first,
            square: cube.wrapping_add(one),
            cube,
        })
    }

    /// The time at a part of the path, in units of 2^-32 slice.
    fn time(&self, share: u32) -> u64 {
        let times = |value: i32| (i64::from(value).wrapping_mul(share.into()) >> 32) as i32;
        let slope = times(self.square.wrapping_sub(times(self.cube)));
        let mean = self.linear.wrapping_add_signed(slope.wrapping_neg());
        // Below 2^32 2^32.
        u64::from(mean).wrapping_mul(share.into()) >> 31
    }
}

impl Cubic {
    /// The time between two parts of the path that are `event` apart. `linear` is the time if the
    /// speed were the mean one.
    fn mean(&self, linear: u64, first: u32, event: u32, second: u64) -> u64 {
        // The sum of both parts in units of 2^-31, and first^2 + first second + second^2 in units
        // of 2^-30.
        let sum = u64::from(first).wrapping_add(second) >> 1;
        let product = u64::from(first).wrapping_mul(second) >> 32;
        let squared = u64::from(event).wrapping_mul(event.into()) >> 32;
        let squares = product.wrapping_mul(3).wrapping_add(squared) >> 2;
        let square = i64::from(self.square).wrapping_mul(sum as i64) >> 31;
        let cube = i64::from(self.cube).wrapping_mul(squares as i64) >> 30;
        let mean = i64::from(self.linear)
            .wrapping_sub(square)
            .wrapping_add(cube) as u64;
        // In units of 2^-31, about 1. The time is below 2^55.
        let low = (linear & 0xffff_ffff).wrapping_mul(mean) >> 31;
        (linear >> 32)
            .wrapping_mul(mean)
            .wrapping_mul(2)
            .wrapping_add(low)
    }
}

/// 1 / `value`, both in units of 2^-31, for values from 0.8 to 1.25. Accurate to 2^-22, and to
/// more for values near 1.
fn inverse_of(value: u32) -> u32 {
    // With d = 1 - value: (1 + d) (1 + d^2) (1 + d^4) (1 + d^8), where d^16 is below 2^-32.
    let one = 1_u32 << 31;
    let d = one.wrapping_sub(value) as i32;
    // At most 2^27. The powers above it fit in 32 bits.
    let second = (i64::from(d).wrapping_mul(d.into()) >> 31) as u32;
    let half = (second >> 11).min(0xffff);
    let fourth = half.wrapping_mul(half) >> 9;
    let half = fourth >> 8;
    let eighth = half.wrapping_mul(half) >> 15;
    let both = (fourth >> 8).wrapping_mul(eighth >> 8) >> 15;
    let rest = fourth.wrapping_add(eighth).wrapping_add(both);
    let times = |value: u32, power: u32| {
        let part = u64::from(value).wrapping_mul(power.into()) >> 31;
        // At most 1.25 in units of 2^-31.
        value.wrapping_add(part as u32)
    };
    times(times(one.wrapping_add_signed(d), second), rest)
}

/// How much of a slice has passed.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct Passage {
    pub(crate) passed: u64,
    /// The share of it, after an event in a slice with a cubic.
    share: u32,
    /// Time that was given, in 2^-32 tick.
    given: u64,
    /// Time of the last event in 2^-32 slice, where it was solved for.
    solved: u64,
}

impl Passage {
    /// Time that is left in the slice.
    pub(crate) fn rest(&self, law: &Law) -> u64 {
        law.time.saturating_sub(self.given)
    }

    /// Passes to `path`, which is in the slice. Returns the time since the last event.
    pub(crate) fn pass(&mut self, path: u64, law: &Law) -> u64 {
        self.passed = path;
        let time = self.time_at(path, law).max(self.given);
        let wait = time.wrapping_sub(self.given);
        self.given = time;
        wait
    }

    /// Speed in units per slice.
    pub(crate) fn speed(&self, law: &Law) -> u64 {
        let (_, speed) = law.at(ratio(self.given, law.time));
        speed
    }

    fn time_at(&mut self, path: u64, law: &Law) -> u64 {
        if path >= law.length {
            self.share = u32::MAX;
            return law.time;
        }
        let share = match &law.cubic {
            Some(cubic) => {
                self.share = law.share(path);
                cubic.time(self.share)
            }
            None => {
                self.solved = law.solve(path, self.solved);
                self.solved
            }
        };
        u32::try_from(share).map_or(law.time, |share| part(law.time, share))
    }

    /// Passes `count` events, 1 to 1024, of about this share of a slice with a cubic. Together they
    /// have this `path`.
    pub(crate) fn piece(&mut self, count: u32, event: u32, path: u64, law: &Law) -> Piece {
        let Some(cubic) = &law.cubic else {
            return Piece::default();
        };
        let first = self.share;
        self.passed = self.passed.wrapping_add(path);
        // The time of the slice times the part of the path of an event, its square and its cube.
        let linear = part(law.time, event);
        let square = part(linear, event);
        let cube = part(square, event);
        // Coefficients in units of 2^-28, below 8.
        let [two, six] = [
            i64::from(cubic.square) >> 2,
            i64::from(cubic.cube).wrapping_mul(3) >> 2,
        ];
        let second = u64::from(first).wrapping_add(event.into());
        let slope = (six.wrapping_mul(second as i64) >> 32).wrapping_sub(two);
        let piece = Piece {
            count,
            interval_q32: cubic.mean(linear, first, event, second),
            change_q32: product(square, slope),
            bend_q32: product(cube, six),
        };
        self.given = self.given.wrapping_add(time_of(&piece));
        piece
    }
}

/// The time of all events of a piece of at most 1024.
fn time_of(piece: &Piece) -> u64 {
    let count = piece.count.min(1024);
    // Below 2^20 and 2^30.
    let pairs = count.wrapping_mul(count.saturating_sub(1)) >> 1;
    // A product of three numbers in a row is divisible by 3, and this is 1 / 3 modulo 2^32.
    let triples = pairs
        .wrapping_mul(count.saturating_sub(2))
        .wrapping_mul(0xaaaa_aaab);
    u64::from(count)
        .wrapping_mul(piece.interval_q32)
        .wrapping_add(u64::from(pairs).wrapping_mul(piece.change_q32))
        .wrapping_add(u64::from(triples).wrapping_mul(piece.bend_q32))
}

/// `value` times `share` / 2^28, in two's complement.
fn product(value: u64, share: i64) -> u64 {
    // The share is below 2^31, and the value below 2^55 / 4^2.
    let times = share.unsigned_abs();
    let size = (value >> 32)
        .wrapping_mul(times)
        .wrapping_shl(4)
        .wrapping_add((value & 0xffff_ffff).wrapping_mul(times) >> 28);
    if share < 0 { size.wrapping_neg() } else { size }
}

/// `value`, below 2^63, times `share` / 2^32, rounded down.
fn part(value: u64, share: u32) -> u64 {
    signed_part(value as i64, share) as u64
}

/// `value` times `share` / 2^32, rounded down.
fn signed_part(value: i64, share: u32) -> i64 {
    let share = i64::from(share);
    // 31 and 32 bits, and 32 and 32 bits without sign.
    let low = (value & 0xffff_ffff) as u64;
    let low = low.wrapping_mul(share as u64) >> 32;
    (value >> 32).wrapping_mul(share).wrapping_add(low as i64)
}

/// `part` / `whole` times 2^32, at most 2^32 and accurate to 2^-31 of it.
fn ratio(part: u64, whole: u64) -> u64 {
    if part >= whole {
        return ONE;
    }
    let zeros = whole.leading_zeros();
    let divisor = (whole.wrapping_shl(zeros) >> 32) as u32;
    quotient(part.wrapping_shl(zeros), divisor).min(ONE)
}
