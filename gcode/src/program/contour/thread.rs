//! G76 of code system A: threading in passes, given in two lines.

use super::passes::Move;
use super::written::{counted_length, plain_length};
use crate::blocks::block::Block;
use crate::blocks::fault::{Fault, Reason};
use crate::compensation::offset::{Vector, length};
use crate::cycles::thread::tangent;
use crate::modal::Modal;
use crate::values::nm::Nm;
use crate::values::wide::{divide, root, shift_rounded};

/// Most passes of one cycle.
const MOST_PASSES: i64 = 1 << 16;

/// The values of the first line, kept for later cycles.
#[derive(Copy, Clone, Debug)]
pub(super) struct Habits {
    /// Passes at full depth, at least one.
    finishes: i64,
    /// Length of the run-out at 45 degrees, in tenths of the lead.
    run_out: i64,
    /// Tangent of half the angle of the thread, in 2^-30.
    slope: i64,
    /// Least increase of the depth from pass to pass.
    least: Nm,
    /// Allowance for the passes at full depth.
    allowance: Nm,
}

impl Habits {
    /// One pass at full depth, no run-out, straight in.
    pub(super) const fn new() -> Self {
        Habits {
            finishes: 1,
            run_out: 0,
            slope: 0,
            least: Nm(0),
            allowance: Nm(0),
        }
    }

    /// The first line: `P` with two digits each for finishes, run-out and angle, `Q` and `R`.
    pub(super) fn read<const N: usize>(
        mut self,
        block: &Block,
        modal: &Modal<N>,
    ) -> Result<Self, Fault> {
        block.check_alone(b"PQR")?;
        if let Some(value) = block.word(b'P') {
            let digits = value.whole().filter(|digits| *digits <= 999_999);
            let digits = digits.ok_or(Fault::at(Reason::NotWhole, b'P'))?;
            let two = |below: i64| digits.wrapping_div(below.max(1)).wrapping_rem(100);
            let angle = two(1);
            if angle > 80 {
                return Err(Fault::at(Reason::OutOfRange, b'P'));
            }
            (self.finishes, self.run_out) = (two(10_000).max(1), two(100));
            // Half the angle, in millionths of a degree.
            self.slope = tangent(angle.unsigned_abs().wrapping_mul(500_000));
        }
        if let Some(least) = counted_length(block, b'Q', modal)? {
            self.least = not_negative(least, b'Q')?;
        }
        if let Some(allowance) = plain_length(block, b'R', modal)? {
            self.allowance = not_negative(allowance, b'R')?;
        }
        Ok(self)
    }
}

fn not_negative(value: Nm, letter: u8) -> Result<Nm, Fault> {
    if value < Nm(0) {
        return Err(Fault::at(Reason::OutOfRange, letter));
    }
    Ok(value)
}

/// The passes of a thread; points are X as a radius, and Z.
#[derive(Clone, Debug)]
pub(super) struct Thread {
    habits: Habits,
    start: Vector,
    /// The root at the end of the thread, and the excess of its X at the start.
    end: Vector,
    taper: i64,
    height: i64,
    first: i64,
    /// Along the moves.
    lead: i64,
    run_out: i64,
    pass: i64,
    depth: i64,
    finishes: i64,
    state: u8,
}

impl Thread {
    /// The second line: X, Z, `R` taper, `P` height, `Q` depth of the first pass, `F` lead along Z.
    pub(super) fn read<const N: usize>(
        habits: Habits,
        block: &Block,
        modal: &Modal<N>,
    ) -> Result<Self, Fault> {
        block.check_alone(b"XZUWRPQF")?;
        modal.check_turning()?;
        let start = super::reading::point(&modal.position());
        let end = super::reading::point(&modal.target(block)?);
        let positive = |letter, value: Option<Nm>| match value {
            None => Err(Fault::at_motion(Reason::MissingWord).of(letter)),
            Some(Nm(value)) if value > 0 => Ok(value),
            Some(_) => Err(Fault::at(Reason::OutOfRange, letter)),
        };
        let height = positive(b'P', counted_length(block, b'P', modal)?)?;
        let first = positive(b'Q', counted_length(block, b'Q', modal)?)?;
        let lead = positive(b'F', plain_length(block, b'F', modal)?)?;
        let taper = plain_length(block, b'R', modal)?.unwrap_or_default().0;
        let way = end[1].abs_diff(start[1]);
        // The start is outside the crest, at both ends.
        let (room, far) = (
            start[0].saturating_sub(end[0]),
            start[0].saturating_sub(end[0].saturating_add(taper)),
        );
        let inside = |room: i64| room.saturating_abs() < height || (room < 0) != (far < 0);
        if way == 0 || inside(room) || inside(far) {
            return Err(Fault::at_motion(Reason::ThreadStart));
        }
        // Depths grow with the root of the pass number: (height / first)^2 passes, or height /
        // least.
        let passes = height.wrapping_div(first.max(1));
        let even = height.checked_div(habits.least.0).unwrap_or(i64::MAX);
        if passes > 255 && even > MOST_PASSES {
            return Err(Fault::at_motion(Reason::TooManyPasses));
        }
        // Converts the lead along Z to that along a slant; both factors are below 2^52.
        let slant = length([taper, way as i64]).unsigned_abs();
        let along = u128::from(lead.unsigned_abs()).wrapping_mul(u128::from(slant));
        let along = i64::try_from(divide(along, way)).unwrap_or(i64::MAX);
        let run_out = lead.saturating_mul(habits.run_out).wrapping_div(10);
        Ok(Thread {
            habits,
            start,
            end,
            taper,
            height,
            first,
            lead: along,
            // Not beyond the start, and not longer than the thread.
            run_out: run_out
                .min(room.saturating_abs().saturating_sub(height))
                .min(way as i64),
            pass: 0,
            depth: 0,
            finishes: habits.finishes,
            state: 0,
        })
    }

    /// The depth of the next pass below the crest; `None` after the last one.
    fn deeper(&mut self) -> Option<i64> {
        if self.depth >= self.height {
            // At full depth: repeat as often as requested.
            self.finishes = self.finishes.saturating_sub(1);
            return (self.finishes > 0).then_some(self.height);
        }
        let rough = self.height.saturating_sub(self.habits.allowance.0);
        if self.depth >= rough {
            return Some(self.height);
        }
        // At most 2^17 passes.
        self.pass = self.pass.saturating_add(1);
        let square = u128::from(self.first.unsigned_abs());
        // first <= 2^50 and the number is below 2^17, so the product is below 2^117.
        let square = square
            .wrapping_mul(square)
            .wrapping_mul(u128::from(self.pass.unsigned_abs()));
        let by_root = i64::try_from(root(square)).unwrap_or(i64::MAX);
        let at_least = self.depth.saturating_add(self.habits.least.0.max(1));
        Some(by_root.max(at_least).min(rough))
    }

    /// The next move.
    pub(super) fn next(&mut self) -> Option<Move> {
        if self.state == 0 {
            match self.deeper() {
                Some(depth) => self.depth = depth,
                None => {
                    self.state = 6;
                    return Some(Move::Rapid(self.start));
                }
            }
        }
        let out = if self.start[0] > self.end[0] { 1 } else { -1 };
        let onward = if self.end[1] > self.start[1] { 1 } else { -1 };
        // With growing depth the tool moves along the flank, so that one side of it cuts.
        let depth = i128::from(self.depth);
        let aside = shift_rounded(depth.wrapping_mul(i128::from(self.habits.slope)), 30) as i64;
        let begin = self.start[1].saturating_add(aside.wrapping_mul(onward));
        let above = self.height.saturating_sub(self.depth).wrapping_mul(out);
        let x_at = |z: i64| {
            // The taper at a position: |taper| and the differences are below 2^52.
            let (part, way) = (self.end[1].abs_diff(z), self.end[1].abs_diff(self.start[1]));
            let product = u128::from(self.taper.unsigned_abs()).wrapping_mul(u128::from(part));
            let share = divide(product, way) as i64;
            let taper = if self.taper < 0 {
                share.wrapping_neg()
            } else {
                share
            };
            self.end[0].saturating_add(taper).saturating_add(above)
        };
        let state = self.state;
        self.state = state.saturating_add(1);
        let lead = self.lead;
        match state {
            0 => Some(Move::Rapid([self.start[0], begin])),
            1 => Some(Move::Rapid([x_at(begin), begin])),
            2 => {
                let z = self.end[1].saturating_sub(self.run_out.wrapping_mul(onward));
                if self.run_out == 0 {
                    self.state = 4;
                }
                let to = [x_at(z), z];
                Some(Move::Thread { to, lead })
            }
            3 => {
                let x = x_at(self.end[1]).saturating_add(self.run_out.wrapping_mul(out));
                let to = [x, self.end[1]];
                Some(Move::Thread { to, lead })
            }
            4 => {
                self.state = 0;
                Some(Move::Rapid([self.start[0], self.end[1]]))
            }
            _ => None,
        }
    }
}

/// Whether a line belongs to a two-line G76: it has no words of the one-line cycle.
pub(super) fn is_two_line(block: &Block) -> bool {
    b"IJK".iter().all(|&letter| block.word(letter).is_none())
}

/// Whether it is the first of the two lines.
pub(super) fn is_first(block: &Block) -> bool {
    b"XZUWF".iter().all(|&letter| block.word(letter).is_none())
}
