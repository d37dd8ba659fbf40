//! Rotated work frames (`R` of G10 L2) and polar coordinates (`@` and `^`).
//!
//! ```text
//! machine = zero of the frame + tool length + rotation of (program + shift of G92)
//! ```
//!
//! The rotation of a frame is about its zero, in X and Y, as in LinuxCNC.

use crate::blocks::block::Block;
use crate::blocks::block::given::POLAR;
use crate::blocks::fault::{Fault, Reason};
use crate::codes::letters::{AXES, POLAR_ANGLE, POLAR_RADIUS};
use crate::command::arc::{Arc, Plane};
use crate::cycles::cycle::Swing;
use crate::modal::Modal;
use crate::modal::frames::Terms;
use crate::values::circle::Turn;
use crate::values::nm::{Nm, coordinate};
use crate::values::wide::{divide, product, root, square};

/// The sum of two points; all are within a few times 2^50.
fn plus(a: [Nm; 2], b: [Nm; 2]) -> [Nm; 2] {
    let ([a, b], [c, d]) = (a, b);
    [Nm(a.0.saturating_add(c.0)), Nm(b.0.saturating_add(d.0))]
}

fn minus(a: [Nm; 2], b: [Nm; 2]) -> [Nm; 2] {
    plus(a, b.map(|at| Nm(at.0.saturating_neg())))
}

/// X and Y of a point.
fn plane<const N: usize>(point: &[Nm; N]) -> [Nm; 2] {
    [coordinate(point, 0), coordinate(point, 1)]
}

/// The part of the sum above that the words determine.
#[derive(Copy, Clone, Eq, PartialEq)]
enum Part {
    /// The end of a move; with increments from the position.
    Machine,
    Shift,
    System,
    Length,
}

impl<const N: usize> Modal<N> {
    /// Whether a block has polar coordinates.
    fn is_polar(&self, block: &Block) -> bool {
        block.has_any(POLAR) && self.modes.dialect.has_polar()
    }

    /// Whether X and Y of a block are not simply added to a zero.
    pub(crate) fn is_turned(&self, block: &Block, terms: Terms) -> bool {
        self.is_polar(block) || self.modes.is_rotated && terms != Terms::NONE
    }

    /// Sets whether the active work frame is rotated.
    pub(crate) fn note_rotation(&mut self) {
        let angle = self.angles.get(usize::from(self.work_system()));
        self.modes.is_rotated = angle.is_some_and(|&angle| angle != 0);
    }

    /// The rotation of a work frame.
    fn turn(&self, system: usize) -> Turn {
        let angle = self.angles.get(system).copied().unwrap_or(0);
        Turn::of(i64::from(angle).wrapping_mul(ANGLE))
    }

    /// A vector of a block, in the machine frame.
    pub(crate) fn turned(&self, vector: [Nm; 2]) -> [Nm; 2] {
        if self.modes.is_rotated {
            self.turn(usize::from(self.work_system())).applied(vector)
        } else {
            vector
        }
    }

    /// Refuses what is not possible in a rotated frame.
    pub(crate) fn check_not_rotated(&self) -> Result<(), Fault> {
        if self.modes.is_rotated {
            return Err(Fault::at_motion(Reason::RotatedFrame));
        }
        Ok(())
    }

    /// Refuses arcs and cycles in planes that a rotated frame does not keep.
    pub(crate) fn check_plane_of_rotated(&self) -> Result<(), Fault> {
        if self.plane() == Plane::Xy {
            return Ok(());
        }
        self.check_not_rotated()
    }

    /// The angle in `R` of G10, in billionths of a degree.
    pub(crate) fn angle_of(&self, block: &Block, has_angle: bool) -> Result<Option<u32>, Fault> {
        let Some(angle) = block.word(b'R') else {
            return Ok(None);
        };
        if !has_angle && !angle.is_zero() || N < 2 {
            return Err(Fault::at(Reason::OutOfRange, b'R'));
        }
        let angle = angle.scaled(1, 7);
        let angle = angle.ok_or(Fault::at(Reason::NumberTooLarge, b'R'))?;
        Ok(Some(turn_of(angle)))
    }

    /// Replaces the zero of a work frame, so that the position reads the words of the block in it.
    pub(crate) fn read_system(
        &self,
        block: &Block,
        system: u32,
        to: &mut [Nm; N],
    ) -> Result<(), Fault> {
        self.check_not_polar(block)?;
        self.read_part(block, Terms::TO_SYSTEM, Part::System, system as usize, to)?;
        Ok(())
    }

    fn check_not_polar(&self, block: &Block) -> Result<(), Fault> {
        for letter in [POLAR_RADIUS, POLAR_ANGLE] {
            if self.is_polar(block) && block.has(letter) {
                return Err(Fault::at(Reason::UnusedWord, letter));
            }
        }
        Ok(())
    }

    /// Does [`Modal::read_axes`] in a rotated frame, or for polar coordinates. Returns the point
    /// from the zero of the frame, before it was rotated and rounded.
    #[inline(never)]
    pub(crate) fn read_turned(
        &self,
        block: &Block,
        terms: Terms,
        to: &mut [Nm; N],
    ) -> Result<[Nm; 2], Fault> {
        let part = match terms {
            Terms::WORK | Terms::INCREMENT => Part::Machine,
            _ => {
                self.check_not_polar(block)?;
                match terms {
                    Terms::TO_SHIFT => Part::Shift,
                    Terms::TO_LENGTH => Part::Length,
                    _ => {
                        // Machine coordinates, or the fixture of G59.3.
                        self.read_straight(block, terms, to)?;
                        return Ok(self.modes.more.unrotated);
                    }
                }
            }
        };
        self.read_part(block, terms, part, usize::from(self.work_system()), to)
    }

    /// Solves the sum for the part that the words determine. `to` is that part as it was before.
    fn read_part(
        &self,
        block: &Block,
        terms: Terms,
        part: Part,
        system: usize,
        to: &mut [Nm; N],
    ) -> Result<[Nm; 2], Fault> {
        for axis in (2..AXES).filter(|&axis| block.axes() & 1u16.wrapping_shl(axis as u32) != 0) {
            if let Some(to) = to.get_mut(axis) {
                self.read_any_axis(block, terms, axis, to)?;
            }
        }
        if block.axes() & 0b11 == 0 {
            return Ok(self.modes.more.unrotated);
        }
        let before = plane(to);
        let of = |this, value: &[Nm; N]| if part == this { before } else { plane(value) };
        let zero = self.offsets.get(system).copied().unwrap_or([Nm(0); N]);
        let (machine, shift) = (
            of(Part::Machine, &self.modes.position),
            of(Part::Shift, &self.modes.shift),
        );
        let (zero, length) = (
            of(Part::System, &zero),
            of(Part::Length, &self.modes.length),
        );
        let turn = self.turn(system);
        let rest = minus(minus(machine, zero), length);
        let from_zero = self.point_from_zero(turn, rest);
        let program = self.program_point(block, terms, minus(from_zero, shift))?;
        let wanted = plus(program, shift);
        let solved = match part {
            Part::Machine => plus(plus(zero, length), turn.applied(wanted)),
            Part::Shift => minus(from_zero, program),
            Part::System => minus(minus(machine, length), turn.applied(wanted)),
            Part::Length => minus(minus(machine, zero), turn.applied(wanted)),
        };
        for ((to, solved), axis) in to.iter_mut().zip(solved).zip(0usize..) {
            let letter = block.letter_of(axis);
            let solved = solved.within_limit();
            *to = solved.ok_or(Fault::at(Reason::NumberTooLarge, letter))?;
        }
        Ok(wanted)
    }

    /// X and Y of a block in the frame of the program; `from` is the position there.
    fn program_point(&self, block: &Block, terms: Terms, from: [Nm; 2]) -> Result<[Nm; 2], Fault> {
        if self.is_polar(block) {
            return self.polar_point(block, terms == Terms::INCREMENT, from);
        }
        let mut point = from;
        for (axis, to) in (0..2usize).zip(&mut point) {
            let letter = block.letter_of(axis);
            if block.word(letter).is_none() {
                continue;
            }
            let is_increment = block.increment(axis).is_some();
            if is_increment && block.axis(axis).is_some() {
                return Err(Fault::at(Reason::TwoUsersOfWords, letter));
            }
            if !is_increment && terms != Terms::INCREMENT {
                *to = Nm(0);
            }
            self.add_word(block, letter, to)?;
        }
        Ok(point)
    }

    /// The words of polar coordinates: a radius and an angle in billionths of a degree.
    fn polar_words(&self, block: &Block) -> Result<(Option<Nm>, Option<i64>), Fault> {
        for letter in [b'X', b'Y'] {
            if block.has(letter) {
                return Err(Fault::at(Reason::TwoUsersOfWords, letter));
            }
        }
        if N < 2 {
            return Err(Fault::at_motion(Reason::NoAxisWords));
        }
        let angle = match block.word(POLAR_ANGLE) {
            None => None,
            Some(angle) => {
                let angle = angle.scaled(1, 9);
                Some(angle.ok_or(Fault::at(Reason::NumberTooLarge, POLAR_ANGLE))?)
            }
        };
        Ok((self.length_of(block, POLAR_RADIUS)?, angle))
    }

    /// The point of polar coordinates. With increments both count from the position.
    fn polar_point(
        &self,
        block: &Block,
        is_increment: bool,
        from: [Nm; 2],
    ) -> Result<[Nm; 2], Fault> {
        let (radius, angle) = self.polar_words(block)?;
        let is_centre = from == [Nm(0); 2];
        if angle.is_none() && is_centre {
            // The direction is not known.
            return Err(Fault::at_axes(Reason::MissingWord).of(b'^'));
        }
        let swing = match (is_increment, radius, angle) {
            (true, radius, angle) => Swing {
                from,
                turn: angle.unwrap_or(0),
                stretch: radius.unwrap_or(Nm(0)),
                ..Swing::NONE
            },
            (false, Some(radius), Some(angle)) => Swing {
                turn: angle,
                stretch: radius,
                ..Swing::NONE
            },
            (false, Some(radius), None) => Swing {
                from,
                stretch: Nm(radius.0.saturating_sub(length_of(from))),
                ..Swing::NONE
            },
            (false, None, angle) => Swing {
                turn: angle.unwrap_or(0),
                stretch: Nm(length_of(from)),
                ..Swing::NONE
            },
        };
        Ok(swing.at(1))
    }

    /// The holes of a cycle with incremental polar coordinates; `None` for others.
    pub(crate) fn swing(&self, block: &Block) -> Result<Option<Swing>, Fault> {
        if !self.is_polar(block) || self.terms() != Terms::INCREMENT {
            return Ok(None);
        }
        let (radius, angle) = self.polar_words(block)?;
        let centre = plus(self.turned_zero(), self.turned(plane(&self.modes.shift)));
        Ok(Some(Swing {
            centre,
            from: minus(plane(&self.modes.position), centre),
            turn: angle.unwrap_or(0),
            stretch: radius.unwrap_or(Nm(0)),
        }))
    }

    /// The centre of an arc in a rotated frame.
    pub(crate) fn read_turned_centre(
        &self,
        block: &Block,
        is_absolute: bool,
        arc: &mut Arc<N>,
    ) -> Result<(), Fault> {
        let mut words = [Nm(0); 2];
        for (word, letter) in words.iter_mut().zip(*b"IJ") {
            self.add_word(block, letter, word)?;
        }
        let from = if is_absolute {
            words = plus(words, plane(&self.modes.shift));
            self.turned_zero()
        } else {
            plane(&self.modes.position)
        };
        let centre = plus(from, self.turned(words));
        for (to, centre) in arc.centre.iter_mut().zip(centre) {
            let centre = centre.within_limit();
            *to = centre.ok_or(Fault::at(Reason::NumberTooLarge, b'I'))?;
        }
        Ok(())
    }

    /// X and Y of the position from the zero of a rotated frame: the exact point, as long as it is
    /// that of the position.
    fn point_from_zero(&self, turn: Turn, rest: [Nm; 2]) -> [Nm; 2] {
        let kept = self.modes.more.unrotated;
        if turn.applied(kept) == rest {
            kept
        } else {
            turn.back().applied(rest)
        }
    }

    /// The zero of the active frame with the tool length, in X and Y.
    fn turned_zero(&self) -> [Nm; 2] {
        let zero = self.offsets.get(usize::from(self.work_system()));
        plus(zero.map_or([Nm(0); 2], plane), plane(&self.modes.length))
    }

    /// X and Y of the active work zero, without the tool length.
    pub(crate) fn turned_offset(&self) -> [Nm; 2] {
        let shift = self.turned(plane(&self.modes.shift));
        minus(plus(self.turned_zero(), shift), plane(&self.modes.length))
    }

    /// X and Y of the position in the active frame.
    pub(crate) fn turned_position(&self) -> [Nm; 2] {
        let turn = self.turn(usize::from(self.work_system()));
        let rest = minus(plane(&self.modes.position), self.turned_zero());
        minus(self.point_from_zero(turn, rest), plane(&self.modes.shift))
    }

    /// The rotation of a work frame about its zero, 0 (G54) to 8 (G59.3), in ten-millionths of a
    /// degree, counter-clockwise, below a whole turn. It turns X and Y.
    pub fn rotation(&self, system: u8) -> Option<u32> {
        self.angles.get(usize::from(system)).copied()
    }

    /// Sets the rotation of a work frame, as `R` of G10 L2 does. Returns `false`, with no effect,
    /// for another number.
    pub fn set_rotation(&mut self, system: u8, ten_millionths: i64) -> bool {
        let Some(angle) = self.angles.get_mut(usize::from(system)) else {
            return false;
        };
        *angle = turn_of(ten_millionths);
        self.note_rotation();
        true
    }
}

/// Billionths of a degree in a ten-millionth.
const ANGLE: i64 = 100;

/// An angle in ten-millionths of a degree without its whole turns.
fn turn_of(angle: i64) -> u32 {
    // Below 3.6 * 10^9 < 2^32.
    angle.rem_euclid(3_600_000_000) as u32
}

/// The length of a vector, rounded.
fn length_of([x, y]: [Nm; 2]) -> i64 {
    // Components below 2^52, so twice them is below 2^53 and the root below 2^54.
    let twice = root(square(x.0.wrapping_mul(2), y.0.wrapping_mul(2)));
    (twice.wrapping_add(1) >> 1) as i64
}

impl Swing {
    /// The point of this number from the centre.
    pub(crate) fn at(&self, number: u32) -> [Nm; 2] {
        let count = i64::from(number);
        let turn = Turn::of(count.wrapping_mul(self.turn.rem_euclid(360_000_000_000)));
        let stretch = self.stretch.0.saturating_mul(count);
        let vector = if self.from == [Nm(0); 2] {
            [Nm(stretch), Nm(0)]
        } else if stretch == 0 {
            self.from
        } else {
            stretched(self.from, stretch)
        };
        turn.applied(vector)
    }
}

/// A vector that is longer by this, in its own direction.
fn stretched(vector: [Nm; 2], by: i64) -> [Nm; 2] {
    // In 2^-8 nm: components below 2^60, the root below 2^61.
    let [x, y] = vector.map(|at| at.0.wrapping_shl(8));
    let long = root(square(x, y));
    vector.map(|at| {
        // Below 2^52 times 2^60; the quotient is the part of `by` along this axis.
        let share = product(at.0.unsigned_abs(), by.unsigned_abs().wrapping_shl(8));
        let share = divide(share.wrapping_add(u128::from(long >> 1)), long.max(1)) as i64;
        let negative = (at.0 < 0) != (by < 0);
        Nm(at.0.saturating_add(if negative {
            share.wrapping_neg()
        } else {
            share
        }))
    })
}
