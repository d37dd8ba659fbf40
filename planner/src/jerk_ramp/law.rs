//! Time as a function of the path within a slice.

use crate::{Piece, Slice, quotient::quotient};

/// The whole of a slice in units of its length and of its time.
const ONE: u64 = 1 << 32;

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
        Law {
            slice: *slice,
            length,
            time,
            zeros: zeros as u8,
            inverse: quotient(1 << 63, divisor).min(u32::MAX.into()) as u32,
            cubic: Cubic::new(slice, length),
        }
    }

    /// Whether the cubic holds.
    pub(crate) const fn is_smooth(&self) -> bool {
        self.cubic.is_some()
    }

    /// The part of the path, in units of 2^-32; below 2^32.
    fn share(&self, path: u64) -> u32 {
        let path = path.wrapping_shl(self.zeros.into()) >> 32;
        // path < 2^64 / inverse 2^31.
        (path.wrapping_mul(self.inverse.into()) >> 31).min(u32::MAX.into()) as u32
    }

    /// Returns how many events of at most `event` fit in a path of the slice; up to one too few.
    pub(crate) fn count(&self, path: u64, event: u32, most: u32) -> u32 {
        // The shares are rounded down, by less than 2.
        let share = self.share(event.into()).saturating_add(2);
        let count = self.share(path).checked_div(share).unwrap_or(0).min(most);
        if u64::from(count).wrapping_mul(event.into()) > path {
            count.saturating_sub(1)
        } else {
            count
        }
    }

    /// Solves for the time, from a time before it. In units of 2^-32 slice.
    fn solve(&self, path: u64, before: u64) -> u64 {
        let (mut low, mut high) = (before, ONE);
        // Newton steps converge from the end with the higher speed.
        let mut time = if self.slice.end_speed() >= self.slice.speed {
            high
        } else {
            low
        };
        for _ in 0..40 {
            let (at, speed) = self.at(time);
            let step = ratio(at.abs_diff(path), speed);
            let next = if at > path {
                high = time;
                time.saturating_sub(step)
            } else {
                low = time;
                time.saturating_add(step)
            };
            if step == 0 || high.saturating_sub(low) <= 1 {
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
        let twist = i64::from(twist);
        let path = times((speed as i64).wrapping_add(times(bend.wrapping_add(times(twist)))));
        let twice = bend.wrapping_mul(2);
        let slope = times(twice.wrapping_add(times(twist.wrapping_mul(3))));
        let speed = (speed as i64).wrapping_add(slope);
        (path.max(0) as u64, speed.max(0) as u64)
    }
}

impl Cubic {
    /// The cubic, where the speed changes by at most a quarter.
    fn new(slice: &Slice, length: u64) -> Option<Cubic> {
        let [speed, end] = [slice.speed, slice.end_speed()];
        let is_even = speed.abs_diff(end) <= speed.min(end) >> 2;
        // The speed may also change and change back within the slice.
        if !is_even || length.abs_diff(speed) > speed >> 2 || speed == 0 {
            return None;
        }
        // 0.8 to 1.25, in units of 2^-31.
        let [first, last] = [speed, end].map(|speed| ratio(length, speed.wrapping_mul(2)));
        let excess = |ratio: u64| (ratio as i64).wrapping_sub(1 << 31) as i32;
        let [one, other] = [excess(first), excess(last)];
        let cube = one.wrapping_add(other);
        Some(Cubic {
            linear: first as u32,
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

/// How much of a slice has passed.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct Passage {
    pub(crate) passed: u64,
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
            return law.time;
        }
        let share = match &law.cubic {
            Some(cubic) => cubic.time(law.share(path)),
            None => {
                self.solved = law.solve(path, self.solved);
                self.solved
            }
        };
        u32::try_from(share).map_or(law.time, |share| part(law.time, share))
    }

    /// Passes `count` events, 1 to 1024, of about `event` in a slice with a cubic. Together they
    /// have this `path`.
    pub(crate) fn piece(&mut self, count: u32, event: u64, path: u64, law: &Law) -> Piece {
        let Some(cubic) = &law.cubic else {
            return Piece::default();
        };
        let first = law.share(self.passed);
        self.passed = self.passed.wrapping_add(path);
        let event = law.share(event);
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
    let triples = pairs.wrapping_mul(count.saturating_sub(2)) / 3;
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
