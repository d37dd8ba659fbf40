//! The speed along the path: phases of constant acceleration and of constant speed.
//!
//! The path is counted in *grains*. On a line each event is a grain. On an arc each event has up to
//! 64 grains. Over a grain the squared speed changes by a constant gain, so a phase is described by
//! its number of grains. Squares are in units of 2^-(2 F) (nm/s)^2. F is the largest number for
//! which the highest speed of the move fits 32 bits.

use core::cmp::Ordering;

use crate::{
    quotient::quotient,
    ramp::{root::Root, slowness::Slowness},
};

/// Largest number of events of a piece.
pub(crate) const LONGEST: u32 = 1024;

/// The next part of the path.
#[derive(Copy, Clone, Debug)]
pub(crate) enum Part {
    /// Constant acceleration from a speed. It ends at the speed of the course.
    Ramp { count: u32, from: Root, gain: u64 },
    /// Constant speed.
    Level { count: u32 },
    /// A grain, or a part of it, in which the acceleration changes: the change of the squared
    /// speed, and the path as a gain in units of 2^`wide`.
    Corner { from: Root, change: u64, path: u64 },
    /// A hold stops the path here.
    Stop,
}

#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub(crate) enum Way {
    #[default]
    Level,
    Up,
    Down,
}

/// State of the path at the end of the present part, and its limits.
#[derive(Clone, Debug, Default)]
pub(crate) struct Course {
    /// Squared speed, and its root.
    pub(crate) square: u64,
    pub(crate) root: Root,
    /// Grains left in the move.
    pub(crate) left: u32,
    /// An event has 2^`parts` grains, at most 64.
    pub(crate) parts: u8,
    /// Change of the squared speed over a grain, rounded up, in units of 2^`wide`. It may exceed
    /// every squared speed.
    pub(crate) path: u64,
    pub(crate) wide: u8,
    pub(crate) slowness: Slowness,
    /// The level of acceleration that the path does not have now, see [`Course::switch`].
    pub(crate) other: Slope,
    pub(crate) is_upper: bool,
    /// Square of the speed between the levels; `u64::MAX` if there is one level only.
    pub(crate) knee: u64,
    pub(crate) is_held: bool,
    /// Whether each grain is an event, so that a hold stops the path before it.
    pub(crate) stops_whole: bool,
    /// Squares of the top speed, of the highest speed at the end of the move, and of the start/stop
    /// speed.
    pub(crate) top: u64,
    pub(crate) exit: u64,
    pub(crate) floor: u64,
    pub(crate) way: Way,
    /// Grains left in the phase.
    phase: u32,
    /// Grains from standstill to the present speed.
    run_up: u32,
    /// Whether the move ends at standstill at the end of this phase.
    stops: bool,
}

/// What depends on the acceleration: the fields of [`Course`] with the same names.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct Slope {
    pub(crate) path: u64,
    pub(crate) wide: u8,
    pub(crate) slowness: Slowness,
}

/// What a phase has to keep at its level of acceleration.
struct View {
    top: u64,
    exit: u64,
    /// Grains up to the place where the speed is `exit`.
    left: u32,
}

impl Course {
    /// Takes the acceleration of the upper or of the lower level.
    pub(crate) fn switch(&mut self, to_upper: bool) {
        if to_upper == self.is_upper {
            return;
        }
        self.is_upper = to_upper;
        let now = Slope {
            path: self.path,
            wide: self.wide,
            slowness: self.slowness,
        };
        let next = core::mem::replace(&mut self.other, now);
        self.path = next.path;
        self.wide = next.wide;
        self.slowness = next.slowness;
    }

    /// The limits at the present level, `left` grains before the end of the move. The upper level
    /// ends where braking at the lower one begins.
    fn view(&self, left: u32) -> View {
        let top = if self.is_held { 0 } else { self.top };
        let exit = self.exit.max(self.floor);
        if !self.is_upper {
            let top = top.min(self.knee);
            return View { top, exit, left };
        }
        let brake = match self.knee.checked_sub(exit) {
            Some(0) | None => 0,
            // Rounded up, and the grain in which the speed passes the level.
            Some(change) => divide(change, gain(self.other.path, self.other.wide).max(1))
                .0
                .saturating_add(2),
        };
        View {
            top,
            exit: exit.max(self.knee),
            left: left.saturating_sub(brake),
        }
    }

    /// Chooses the level for the next part. At the speed between them the upper one is taken while
    /// there are grains before braking.
    fn choose_level(&mut self) {
        if self.knee == u64::MAX {
            return;
        }
        self.switch(self.square >= self.knee);
        if self.square == self.knee && (self.top <= self.knee || self.view(self.left).left == 0) {
            self.switch(false);
        }
    }
    /// Returns the change of the squared speed over a grain, limited to 64 bits.
    #[inline]
    pub(crate) fn gain(&self) -> u64 {
        gain(self.path, self.wide)
    }

    /// Ends the phase, so that the next part chooses another one.
    pub(crate) fn look_again(&mut self) {
        self.phase = 0;
    }

    pub(crate) fn set_square(&mut self, square: u64) {
        self.square = square;
        self.root = Root::of(square);
        self.phase = 0;
    }

    /// Returns the next part. Next to standstill it has at most `most` events. At least one grain
    /// must be left.
    pub(crate) fn next(&mut self, most: u32) -> Part {
        let most = most.wrapping_shl(self.parts.into());
        if self.square < self.floor {
            self.set_square(self.floor);
        }
        if self.phase == 0 {
            self.choose();
        }
        let (from, square) = (self.root, self.square);
        if self.phase == 0 {
            return self.corner(self.gain(), self.path, self.left.saturating_sub(1), 1);
        }
        let count = match self.way {
            Way::Level => self.phase.min(LONGEST.wrapping_shl(self.parts.into())),
            Way::Up if square == 0 => most.min(self.phase),
            Way::Up => rising(self.run_up, self.phase, self.parts.into()),
            Way::Down => self.falling(most),
        };
        self.phase = self.phase.wrapping_sub(count);
        self.left = self.left.saturating_sub(count);
        // At most the larger of the two squares.
        let gain = self.gain().wrapping_mul(count.into());
        match self.way {
            Way::Level => return Part::Level { count },
            Way::Up => {
                self.run_up = self.run_up.saturating_add(count);
                self.square = square.saturating_add(gain);
            }
            Way::Down => {
                self.run_up = self.run_up.saturating_sub(count);
                self.square = square.saturating_sub(gain);
            }
        }
        self.root = Root::of(self.square);
        Part::Ramp { count, from, gain }
    }

    /// Returns the rest of a grain as the next part: `rest` times 2^-`bits` of it.
    pub(crate) fn next_rest(&mut self, rest: u64, bits: u32) -> Part {
        if self.square < self.floor {
            self.set_square(self.floor);
        }
        self.phase = 0;
        self.choose_level();
        // The rest is below 2^bits and 2^32.
        let share = |whole: u64| {
            let product = u128::from(whole).wrapping_mul(rest.into());
            product.wrapping_shr(bits) as u64
        };
        self.corner(
            share(self.gain()).max(1),
            share(self.path).max(1),
            self.left,
            0,
        )
    }

    /// Returns the number of grains of a piece that slows down. It depends on the run-up of its
    /// end.
    fn falling(&self, most: u32) -> u32 {
        if self.stops && self.phase <= most {
            return self.phase;
        }
        let room = if self.stops {
            self.phase.wrapping_sub(most)
        } else {
            self.phase
        };
        falling(self.run_up, room, self.parts.into())
    }

    /// Chooses the next phase and its number of grains. 0 means that the acceleration changes
    /// within the next grain.
    fn choose(&mut self) {
        self.choose_level();
        let (square, gain) = (self.square, self.gain());
        let View { top, exit, left } = self.view(self.left);
        let grains = |square: u64| divide(square, gain);
        self.stops = false;
        if square > top {
            let mut target = top.max(self.floor);
            if self.is_upper {
                target = target.max(self.knee);
            }
            // A hold brakes to the last grain that ends above the start/stop speed.
            let spare = square.saturating_sub(target);
            let spare = spare.saturating_sub(self.is_held.into());
            self.begin(Way::Down, grains(spare).0);
            return;
        }
        if self.is_held {
            // The path stands already.
            return;
        }
        // Grains that are not needed for braking from the present speed.
        let spare = match square.checked_sub(exit) {
            Some(above) => {
                let (brake, rest) = grains(above);
                if self.snaps(exit, left, brake, rest) || brake >= left {
                    self.begin(Way::Down, left);
                    // Only braking that fits exactly ends at rest.
                    self.stops = exit == 0 && self.square == gain.wrapping_mul(left.into());
                    return;
                }
                let brake = brake.wrapping_add(u32::from(rest != 0));
                left.wrapping_sub(brake)
            }
            None => left.saturating_add(grains(exit.wrapping_sub(square)).0),
        };
        if square == self.top {
            self.begin(Way::Level, spare);
        } else {
            let up = grains(top.wrapping_sub(square)).0;
            self.begin(Way::Up, up.min(spare >> 1));
        }
    }

    /// Whether braking must begin here, apart from the rounding of the gain. If so, the squared
    /// speed is changed by at most one unit per grain, so that braking fits exactly.
    fn snaps(&mut self, exit: u64, left: u32, brake: u32, rest: u64) -> bool {
        let slack = u64::from(left);
        let is_near = brake == left && rest <= slack
            || brake.wrapping_add(1) == left && self.gain().wrapping_sub(rest) <= slack;
        if is_near {
            // The result is near the squared speed, so nothing overflows.
            self.square = exit.wrapping_add(self.gain().wrapping_mul(slack));
        }
        is_near
    }

    fn begin(&mut self, way: Way, count: u32) {
        self.way = way;
        self.phase = count.min(self.left);
        self.run_up = match way {
            Way::Level => 0,
            _ => divide(self.square, self.gain()).0,
        };
    }

    /// Makes a part over this gain. `left` grains follow it.
    fn corner(&mut self, gain: u64, path: u64, left: u32, grains: u32) -> Part {
        let before = self.square;
        let view = self.view(left);
        let top = view.top;
        let line = |exit: u64, left: u32| {
            let rise = self.gain().checked_mul(left.into());
            rise.and_then(|rise| rise.checked_add(exit))
                .unwrap_or(u64::MAX)
        };
        let line = match view.left {
            // The grain in which the speed passes the level: braking goes on.
            0 if self.is_upper => line(self.exit, left).min(view.exit),
            _ => line(view.exit, view.left),
        };
        let least = before.saturating_sub(gain);
        let after = before.saturating_add(gain).min(top).min(line).max(least);
        if self.is_held && self.stops_whole && after <= self.floor {
            self.set_square(0);
            return Part::Stop;
        }
        let from = self.root;
        self.left = self.left.saturating_sub(grains);
        let after = after.max(self.floor);
        self.way = match after.cmp(&before) {
            Ordering::Less => Way::Down,
            Ordering::Equal => Way::Level,
            Ordering::Greater => Way::Up,
        };
        let change = after.abs_diff(before);
        if change != 0 {
            self.set_square(after);
        } else if after == self.top {
            return Part::Level { count: grains };
        }
        if change == gain {
            let count = grains;
            return Part::Ramp { count, from, gain };
        }
        Part::Corner { from, change, path }
    }

    /// Returns the root of half the gain of a path.
    fn peak(&self, path: u64) -> u64 {
        let wide = u32::from(self.wide);
        // The root takes out an even number of bits.
        let odd = wide & 1;
        let root = Root::of(path.wrapping_shr(1_u32.wrapping_sub(odd)));
        u64::from(root.speed).wrapping_shl(wide.wrapping_sub(odd) >> 1)
    }

    /// Returns the time of a corner: its path divided by the mean of its end speeds.
    pub(crate) fn corner_time(&self, from: &Root, path: u64) -> u64 {
        let mut speeds = u64::from(from.speed).wrapping_add(self.root.speed.into());
        let peak = self.peak(path);
        if speeds < peak {
            // It starts and ends nearly at rest, and the speed rises and falls within it. The mean
            // speed is half of the peak speed sqrt(a s), which is the root of half the gain.
            let top = u64::from(Root::of(self.top).speed).wrapping_mul(2);
            speeds = speeds.max(peak.min(top));
        }
        // The time of a change of speed by path / speeds. The divisor has 32 bits, the quotient at
        // least 31.
        let narrow = u32::from(speeds > u64::from(u32::MAX));
        let divisor = (speeds.wrapping_shr(narrow) as u32).max(1);
        let shift = path.leading_zeros();
        let change = quotient(path.wrapping_shl(shift), divisor);
        let bits = shift.wrapping_add(narrow).wrapping_sub(self.wide.into());
        self.slowness.time_of(change, bits as i32)
    }
}

/// Returns the number of grains of a piece that speeds up. Its events are at most 0.03 of an
/// interval off, see `Ramp`.
///
/// Let g be the change of the square over a piece as a part of its lower square, and v and w its
/// end speeds. Then r = (w - v) / (w + v) = (q - 1) / (q + 1) with q^2 = 1 + g. A piece may be
/// longer by an eighth ([`fitted`]), so g is at most 9/16 where the speed rises and 0.6 where it
/// falls, and r at most 0.117. The acceleration of the cubic t(x) is -t'' / (2 r t'^3) of the
/// limit, with t in units of the time of the piece: at most 1.036. From a run-up of 300 events on g
/// is at most 0.39 and the acceleration at most 1.018. `acceleration_of_the_cubic` evaluates it.
fn rising(run_up: u32, room: u32, parts: u32) -> u32 {
    let count = match run_up.wrapping_shr(parts) {
        0..192 => run_up >> 1,
        192..768 => run_up.wrapping_mul(85) >> 8,
        768..2560 => run_up >> 2,
        _ => run_up >> 3,
    };
    fitted(count, room, parts)
}

/// Does the same for a piece that slows down. The run-up of its end counts.
fn falling(run_up: u32, room: u32, parts: u32) -> u32 {
    let count = match run_up.wrapping_shr(parts) {
        // From below: a third, a quarter, a fifth, a ninth.
        0..288 => run_up.wrapping_mul(85) >> 8,
        288..1024 => run_up >> 2,
        1024..3200 => run_up.wrapping_mul(51) >> 8,
        _ => (run_up >> 4).wrapping_add(run_up >> 5),
    };
    fitted(count, room, parts)
}

/// Limits a number of grains to 1..=`room`, and avoids that a small piece is left.
fn fitted(count: u32, room: u32, parts: u32) -> u32 {
    let longest = LONGEST.wrapping_shl(parts);
    let count = count.min(longest).max(1);
    if room <= count.wrapping_add(count >> 3).min(longest) {
        room
    } else {
        count
    }
}

/// Returns `dividend / divisor` and the remainder. The quotient is limited to 2^32 - 1, and the
/// divisor is not 0.
fn divide(dividend: u64, divisor: u64) -> (u32, u64) {
    if dividend < divisor {
        return (0, dividend);
    }
    // The estimate is too small by 2^-31 of the quotient, so one more round finds the remainder.
    let shift = 32_u32.saturating_sub(divisor.leading_zeros());
    let high = (divisor.wrapping_shr(shift) as u32)
        .saturating_add(u32::from(shift != 0))
        .max(1);
    let (mut whole, mut rest) = (0_u64, dividend);
    while rest >= divisor {
        let more = quotient(rest.wrapping_shr(shift), high).max(1);
        whole = whole.wrapping_add(more);
        rest = rest.wrapping_sub(more.wrapping_mul(divisor));
    }
    (whole.min(u32::MAX.into()) as u32, rest)
}

/// A change of the square of `path` 2^`wide`; limited to 64 bits, above all squares.
fn gain(path: u64, wide: u8) -> u64 {
    match wide {
        0 => path,
        // The path has 62 bits.
        1 | 2 => path.wrapping_shl(wide.into()),
        _ => u64::MAX,
    }
}

#[cfg(test)]
mod tests {
    use super::{falling, rising};

    /// Largest acceleration within a piece whose square grows by the part `g`, in limits.
    fn largest(g: f64) -> f64 {
        let q = (1.0 + g).sqrt();
        let r = (q - 1.0) / (q + 1.0);
        let bow = r / (1.0 - r * r);
        let skew = r * bow;
        (0..=1000).fold(0.0, |most, x| {
            let x = f64::from(x) / 1000.0;
            let slope = 1.0 + bow * (1.0 - 2.0 * x) + skew * (1.0 - 6.0 * x + 6.0 * x * x);
            let bend = 2.0 * bow + skew * (6.0 - 12.0 * x);
            f64::max(most, bend / (2.0 * r * slope * slope * slope))
        })
    }

    /// The bounds that the documentation of `Ramp` states, over all lengths of pieces.
    #[test]
    fn acceleration_of_the_cubic() {
        for run_up in 64..20_000_u32 {
            let bound = if run_up < 300 { 1.036 } else { 1.018 };
            for longer in 0..=8 {
                let room = |count: u32| count + count * longer / 64;
                let count = rising(run_up, room(rising(run_up, u32::MAX, 0)), 0);
                let up = f64::from(count) / f64::from(run_up);
                // A piece that slows down ends at its lower speed.
                let count = falling(run_up, room(falling(run_up, u32::MAX, 0)), 0);
                let down = f64::from(count) / f64::from(run_up - count);
                for found in [largest(up), largest(down)] {
                    assert!(found <= bound, "{run_up} {longer}: {found}");
                }
            }
        }
    }
}
