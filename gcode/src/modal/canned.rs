//! Canned cycles: the words of a block for them, and the words they keep.

use crate::blocks::block::Block;
use crate::blocks::fault::{Fault, Reason};
use crate::codes::code::{Code, Group};
use crate::codes::dialect::Flavour;
use crate::codes::kind::Kind;
use crate::codes::letters::{POLAR_RADIUS, axis_letter};
use crate::command::arc::Plane;
use crate::command::{PathMode, SpindleDirection};
use crate::cycles::cycle::{Cycle, Holes, PECK_CLEARANCE, Rectangle};
use crate::cycles::thread::{MOST_PASSES, Passes, tangent};
use crate::modal::commands::Commands;
use crate::modal::modes::{Distance, FeedMode, Sticky};
use crate::modal::settings::{unsigned, whole};
use crate::modal::{Modal, shifted};
use crate::values::nm::{Nm, coordinate};

/// Most pecks of one block, all its holes together.
const MOST_PECKS: u64 = 1 << 16;

impl<const N: usize> Modal<N> {
    /// Clears the values kept for a series of cycles after its end; the level of G98 only after a
    /// series of any cycles.
    pub(crate) fn leave_series(&mut self, mode: Code) {
        let before = self.active(Group::Motion);
        let keeps = before.cycle().is_some() || matches!(before, Code::Thread | Code::RigidTap);
        if keeps && before != mode {
            let initial = match mode.cycle() {
                Some(_) => self.modes.sticky.initial,
                None => None,
            };
            self.modes.sticky = Sticky {
                initial,
                ..Sticky::NONE
            };
        }
    }

    #[inline(never)]
    pub(crate) fn canned(
        &mut self,
        block: &Block,
        kind: Kind,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        if block.axes() & 0b111 == 0 {
            return Err(Fault::at_motion(Reason::NoAxisWords));
        }
        if let Some(axis) = (3..6).find(|&axis| block.axis(axis).is_some()) {
            let letter = axis_letter(axis);
            return Err(Fault::at(Reason::RotaryInCycle, letter));
        }
        if N < 3 {
            return Err(Fault::at_motion(Reason::NoAxisWords));
        }
        if matches!(
            kind,
            Kind::Thread | Kind::TurnBox | Kind::FaceBox | Kind::ThreadBox
        ) {
            self.check_not_rotated()?;
        }
        match kind {
            Kind::Thread => self.passes(block, commands),
            Kind::TurnBox | Kind::FaceBox | Kind::ThreadBox => {
                self.rectangle(block, kind, commands)
            }
            _ => self.holes(block, kind, commands),
        }
    }

    /// A length that is kept for the series, or the error that it is missing.
    fn kept(&self, block: &Block, letter: u8, before: Option<Nm>) -> Result<Nm, Fault> {
        match self.length_of(block, letter)? {
            Some(length) => Ok(length),
            None => before.ok_or_else(|| Fault::at_motion(Reason::MissingWord).of(letter)),
        }
    }

    /// G73, G74, G81 to G89. The cycle is built in place, in steps that each leave the stack before
    /// the next one.
    #[inline(never)]
    fn holes(
        &mut self,
        block: &Block,
        kind: Kind,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        if self.feed_mode() == FeedMode::InverseTime {
            return Err(Fault::at_motion(Reason::WrongFeedMode));
        }
        let Some(holes) = commands.holes() else {
            return Ok(());
        };
        holes.kind = kind;
        // A lathe drills along Z in any plane of its arcs.
        holes.plane = if self.modes.dialect.is_lathe() {
            Plane::Xy
        } else {
            self.check_plane_of_rotated()?;
            self.plane()
        };
        self.levels(block, holes)?;
        holes.left = match whole(block, b'L', u32::MAX)? {
            None => 1,
            Some(0) if self.modes.dialect.flavour != Flavour::Iso => {
                return Err(Fault::at(Reason::OutOfRange, b'L'));
            }
            Some(count) => count,
        };
        holes.peck = self.peck(block, holes)?;
        if kind == Kind::BackBore {
            self.back_bore(block, holes)?;
        }
        if let Some(value) = block.word(b'P') {
            self.modes.sticky.dwell_micros =
                unsigned(value, 6).ok_or_else(|| Fault::at(Reason::OutOfRange, b'P'))?;
        }
        holes.dwell_micros = self.modes.sticky.dwell_micros;
        holes.spindle = (self.spindle_direction(), self.modes.milli_rpm);
        // Without a tolerance only the speed in corners differs from G61, as in a program that has
        // none.
        let is_wide = |path: &PathMode| matches!(path, PathMode::Blend { tolerance: Some(_) });
        holes.path = Some(self.path()).filter(is_wide);
        self.check_cycle_spindle(kind)?;
        self.set_feed_of(commands)?;
        let feed = commands.feed;
        if let Some((holes, points)) = commands.holes_made() {
            holes.feed = feed;
            self.places(block, holes, points)?;
            if holes.left != 0 {
                commands.motion(Code::DrillCycle);
            }
        }
        Ok(())
    }

    /// The heights of a cycle.
    #[inline(never)]
    fn levels(&mut self, block: &Block, holes: &mut Holes<N>) -> Result<(), Fault> {
        let across = holes.plane.across();
        let height = coordinate(&self.modes.position, across);
        let incremental = self.distance() == Distance::Incremental;
        let zero = self.zero_of(across);
        let peck_on_lathe = holes.kind == Kind::LathePeck;
        if peck_on_lathe && block.axes() & !0b100 != 0 {
            let letter = block.letter_of(block.axes().trailing_zeros() as usize);
            return Err(Fault::at(Reason::UnusedWord, letter));
        }

        // The retract plane; on a lathe the retract of a peck.
        let given = if peck_on_lathe {
            let plain = self.length_of(block, b'R')?;
            plain
                .or(self.modes.sticky.retract)
                .unwrap_or(PECK_CLEARANCE)
        } else {
            self.kept(block, b'R', self.modes.sticky.retract)?
        };
        // Incremental retract planes count from the level before the series.
        let initial = *self.modes.sticky.initial.get_or_insert(height);
        holes.retract = match (peck_on_lathe, incremental) {
            (true, _) => height,
            (false, true) => shifted(initial, given, b'R')?,
            (false, false) => shifted(zero, given, b'R')?,
        };
        self.modes.sticky.retract = Some(given);
        holes.clearance = if peck_on_lathe { given } else { PECK_CLEARANCE };

        let depth_letter = block.letter_of(across);
        let depth = self.kept(block, depth_letter, self.modes.sticky.bottom)?;
        holes.bottom = match incremental || block.increment(across).is_some() {
            true => shifted(holes.retract, depth, depth_letter)?,
            false => shifted(zero, depth, depth_letter)?,
        };
        self.modes.sticky.bottom = Some(depth);
        if holes.retract < holes.bottom || (peck_on_lathe && holes.retract == holes.bottom) {
            let letter = if peck_on_lathe { depth_letter } else { b'R' };
            return Err(match block.word(letter) {
                Some(_) => Fault::at(Reason::RetractBelowBottom, letter),
                None => Fault::at_motion(Reason::RetractBelowBottom),
            });
        }
        holes.clear = if self.active(Group::Return) == Code::ReturnToRetract {
            holes.retract
        } else {
            holes.retract.max(initial)
        };
        Ok(())
    }

    /// The positions of the holes, and the end position of the cycle.
    #[inline(never)]
    fn places(
        &mut self,
        block: &Block,
        holes: &mut Holes<N>,
        points: &mut [[Nm; 2]; 4],
    ) -> Result<(), Fault> {
        // The end position of the cycle, if it has one.
        let mut end = self.modes.position;
        self.read_axes(block, self.terms(), &mut end)?;
        let incremental = self.distance() == Distance::Incremental;
        holes.at = self.modes.position;
        let axes = holes.plane.axes();
        for ((&axis, pitch), hole) in axes.iter().zip(&mut holes.pitch).zip(&mut holes.hole) {
            *hole = coordinate(&end, axis);
            *pitch = Nm(0);
            if incremental || block.increment(axis).is_some() {
                // Both within 2^50.
                pitch.0 = hole.0.saturating_sub(coordinate(&holes.at, axis).0);
            }
            let letter = block.letter_of(axis);
            let more = pitch
                .0
                .checked_mul(i64::from(holes.left.max(1)).saturating_sub(1))
                .ok_or_else(|| Fault::at(Reason::NumberTooLarge, letter))?;
            if let Some(end) = end.get_mut(axis) {
                *end = shifted(*hole, Nm(more), letter)?;
            }
        }
        if let Some(swing) = self.swing(block)? {
            (holes.swing, holes.pitch) = (1, [Nm(swing.turn), swing.stretch]);
            holes.hole = swing.place(1);
            let [centre, from, ..] = points;
            (*centre, *from) = (swing.centre, swing.from);
            for (end, last) in end.iter_mut().zip(swing.place(holes.left.max(1))) {
                *end = last
                    .within_limit()
                    .ok_or(Fault::at(Reason::NumberTooLarge, POLAR_RADIUS))?;
            }
        }
        if holes.left != 0 {
            if let Some(end) = end.get_mut(holes.plane.across()) {
                *end = holes.clear;
            }
            self.modes.position = end;
        }
        Ok(())
    }

    /// The depth of a peck; there may not be too many pecks.
    fn peck(&mut self, block: &Block, holes: &Holes<N>) -> Result<Nm, Fault> {
        if !matches!(holes.kind, Kind::Peck | Kind::ChipBreak | Kind::LathePeck) {
            if u64::from(holes.left) > MOST_PECKS {
                return Err(Fault::at(Reason::TooManyPasses, b'L'));
            }
            return Ok(Nm(0));
        }
        let peck = self.kept(block, b'Q', self.modes.sticky.peck)?;
        if peck <= Nm(0) {
            return Err(Fault::at(Reason::OutOfRange, b'Q'));
        }
        self.modes.sticky.peck = Some(peck);
        // bottom <= retract, both within 2^51.
        let deep = holes.retract.0.saturating_sub(holes.bottom.0);
        let pecks = deep
            .unsigned_abs()
            .checked_div(peck.0.unsigned_abs())
            .unwrap_or(0)
            .saturating_add(1);
        if pecks.saturating_mul(u64::from(holes.left)) > MOST_PECKS {
            return Err(Fault::at_motion(Reason::TooManyPasses));
        }
        Ok(peck)
    }

    /// I, J and K of G87: the offset in the plane and the end height of the boring.
    #[inline(never)]
    fn back_bore(&mut self, block: &Block, holes: &mut Holes<N>) -> Result<(), Fault> {
        let [i, j] = holes.plane.centre_letters();
        let across = match holes.plane {
            Plane::Xy => b'K',
            Plane::Zx => b'J',
            Plane::Yz => b'I',
        };
        let before = self.modes.sticky.back_bore;
        let mut kept = before.unwrap_or_default();
        for (kept, &letter) in kept.iter_mut().zip(&[i, j, across]) {
            *kept = self.kept(block, letter, before.map(|_| *kept))?;
        }
        self.modes.sticky.back_bore = Some(kept);
        let from = if self.distance() == Distance::Incremental {
            holes.bottom
        } else {
            self.zero_of(holes.plane.across())
        };
        let [i, j, height] = kept;
        holes.offset = self.turned([i, j]);
        holes.middle = shifted(from, height, across)?;
        Ok(())
    }

    /// Taps need the spindle to turn in their direction; bores that stop the spindle need it to
    /// turn.
    fn check_cycle_spindle(&self, kind: Kind) -> Result<(), Fault> {
        let right = match kind {
            Kind::Tap => self.spindle_direction() == SpindleDirection::Clockwise,
            Kind::LeftTap => self.spindle_direction() == SpindleDirection::CounterClockwise,
            Kind::BoreStop | Kind::BackBore | Kind::BoreManual => {
                self.spindle_direction() != SpindleDirection::Off
            }
            _ => true,
        };
        if right {
            Ok(())
        } else {
            Err(Fault::at_motion(Reason::SpindleStopped))
        }
    }

    /// The turning, facing and threading cycles of lathes: X and Z of the far corner, `R` the
    /// taper.
    #[inline(never)]
    fn rectangle(
        &mut self,
        block: &Block,
        kind: Kind,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        let lead = if kind == Kind::ThreadBox {
            self.check_turning()?;
            Some(self.lead(block)?)
        } else {
            None
        };
        let feed = match lead {
            // Not used: both cuts are synchronised or rapid.
            Some(lead) => crate::command::Feed::PerRevolution(lead),
            None => {
                self.set_feed_of(commands)?;
                commands.feed
            }
        };
        if let Some(taper) = self.length_of(block, b'R')? {
            self.modes.sticky.taper = taper;
        }
        let start = self.modes.position;
        let target = self.target(block)?;
        let given = block.axes();
        let mut far = start;
        let kept = self.modes.sticky.corner;
        for (place, axis) in [(0usize, 0usize), (1, 2)] {
            let value = if given & 1u16.wrapping_shl(axis as u32) != 0 {
                target.get(axis).copied()
            } else {
                kept.and_then(|kept| kept.get(place).copied())
            };
            let value =
                value.ok_or_else(|| Fault::at_motion(Reason::MissingWord).of(axis_letter(axis)))?;
            if let Some(entry) = far.get_mut(axis) {
                *entry = value;
            }
        }
        let part = |point: &[Nm; N], axis: usize| point.get(axis).copied().unwrap_or_default();
        self.modes.sticky.corner = Some([part(&far, 0), part(&far, 2)]);
        let place = |x: Nm, z: Nm| {
            let mut point = start;
            for (axis, value) in [(0, x), (2, z)] {
                if let Some(entry) = point.get_mut(axis) {
                    *entry = value;
                }
            }
            point
        };
        // All within a few times 2^50.
        let taper = |at: Nm| Nm(at.0.saturating_add(self.modes.sticky.taper.0));
        let corners = if kind == Kind::FaceBox {
            [
                place(part(&start, 0), taper(part(&far, 2))),
                far,
                place(part(&far, 0), part(&start, 2)),
                start,
            ]
        } else {
            [
                place(taper(part(&far, 0)), part(&start, 2)),
                far,
                place(part(&start, 0), part(&far, 2)),
                start,
            ]
        };
        commands.cycle(Cycle::Rectangle(Rectangle {
            corners,
            feed,
            lead,
            next: 0,
        }));
        Ok(())
    }

    /// G76, with the words of LinuxCNC; I, J and K are diameters under G7.
    #[inline(never)]
    fn passes(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        self.check_turning()?;
        let needs = |letter| Fault::at_motion(Reason::MissingWord).of(letter);
        let range = |letter| Fault::at(Reason::OutOfRange, letter);
        if block.axes() & !0b100 != 0 {
            let letter = block.letter_of(block.axes().trailing_zeros() as usize);
            return Err(Fault::at(Reason::UnusedWord, letter));
        }
        let radial = |letter: u8| {
            let value = block.word(letter).ok_or_else(|| needs(letter))?;
            let length = if self.is_diameter() {
                self.units().half(value)
            } else {
                self.units().length(value)
            };
            length.ok_or_else(|| Fault::at(Reason::NumberTooLarge, letter))
        };
        let (peak, first, full) = (radial(b'I')?, radial(b'J')?, radial(b'K')?);
        let lead = self.length_of(block, b'P')?.ok_or_else(|| needs(b'P'))?;
        for (letter, value) in [(b'P', lead), (b'J', first), (b'K', full)] {
            if value <= Nm(0) {
                return Err(range(letter));
            }
        }
        let degression_micro = match block.word(b'R') {
            None => 1_000_000,
            Some(value) => unsigned(value, 6)
                .filter(|micro| (1_000_000..=100_000_000).contains(micro))
                .ok_or_else(|| range(b'R'))?,
        };
        let angle = match block.word(b'Q') {
            None => 0,
            Some(value) => unsigned(value, 6)
                .filter(|&micro| micro <= 80_000_000)
                .ok_or_else(|| range(b'Q'))?,
        };
        let springs = whole(block, b'H', u16::MAX)?.unwrap_or(0);
        let taper = self.length_of(block, b'E')?.unwrap_or(Nm(0));
        if taper < Nm(0) {
            return Err(range(b'E'));
        }
        let taper_ends = match whole(block, b'L', u8::MAX)? {
            Some(ends @ 0..=3) if taper > Nm(0) => ends,
            Some(0..=3) | None => 0,
            Some(_) => return Err(range(b'L')),
        };
        let to = self.target(block)?;
        let end_z = to.get(2).copied().unwrap_or_default();
        let start_z = self.modes.position.get(2).copied().unwrap_or_default();
        let slope = tangent(angle);
        let passes = Passes {
            start: self.modes.position,
            end_z,
            lead,
            peak,
            first,
            full,
            degression_micro,
            slope: if end_z < start_z {
                slope.wrapping_neg()
            } else {
                slope
            },
            springs: u32::from(springs).saturating_add(1),
            taper,
            taper_ends,
            pass: 1,
            at: self.modes.position,
            state: 0,
        };
        if passes.depth(MOST_PASSES) < full {
            return Err(Fault::at(Reason::TooManyPasses, b'J'));
        }
        self.modes.position = to;
        commands.cycle(Cycle::Passes(passes));
        Ok(())
    }
}
