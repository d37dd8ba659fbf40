//! Canned cycles: what a block says about them, and the words they keep.

use crate::arc::Plane;
use crate::block::{Block, axis_letter};
use crate::code::{Code, Group};
use crate::command::{PathMode, SpindleDirection};
use crate::commands::Commands;
use crate::cycle::{Cycle, Holes, PECK_CLEARANCE, Rectangle, State};
use crate::dialect::Flavour;
use crate::fault::{Fault, Reason};
use crate::kind::Kind;
use crate::modal::{Distance, FeedMode, Modal, Sticky, shifted};
use crate::nm::Nm;
use crate::settings::{unsigned, whole};
use crate::thread::{MOST_PASSES, Passes, tangent};

/// Most pecks of one block, all its holes together.
const MOST_PECKS: u64 = 1 << 16;

impl<const N: usize> Modal<N> {
    /// What a series of cycles keeps is forgotten behind it, the level of G98 behind a series of whatever cycles.
    pub(crate) fn leave_series(&mut self, mode: Code) {
        let before = self.active(Group::Motion);
        if (before.cycle().is_some() || before == Code::Thread) && before != mode {
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
        match kind {
            Kind::Thread => self.passes(block, commands),
            Kind::TurnBox | Kind::FaceBox | Kind::ThreadBox => {
                self.rectangle(block, kind, commands)
            }
            _ => self.holes(block, kind, commands),
        }
    }

    /// A length that stays for the series, or the error that it is missing.
    fn kept(&self, block: &Block, letter: u8, before: Option<Nm>) -> Result<Nm, Fault> {
        match self.length_of(block, letter)? {
            Some(length) => Ok(length),
            None => before.ok_or_else(|| Fault::at_motion(Reason::MissingWord).of(letter)),
        }
    }

    /// G73, G74, G81 to G89.
    fn holes(
        &mut self,
        block: &Block,
        kind: Kind,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        if self.feed_mode() == FeedMode::InverseTime {
            return Err(Fault::at_motion(Reason::WrongFeedMode));
        }
        // A lathe drills along Z, whatever the plane of its arcs.
        let plane = if self.modes.dialect.is_lathe() {
            Plane::Xy
        } else {
            self.plane()
        };
        let across = plane.across();
        let part = |point: &[Nm; N], axis: usize| point.get(axis).copied().unwrap_or_default();
        let height = part(&self.modes.position, across);
        let incremental = self.distance() == Distance::Incremental;
        let sum = |letter: u8, a: Nm, b: Nm| shifted(a, b, letter);
        let zero = self.zero_of(across);
        let peck_on_lathe = kind == Kind::LathePeck;
        if peck_on_lathe && block.axes() & !0b100 != 0 {
            let letter = block.letter_of(block.axes().trailing_zeros() as usize);
            return Err(Fault::at(Reason::UnusedWord, letter));
        }

        // The retract plane, or on a lathe how far a peck retracts.
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
        let retract = match (peck_on_lathe, incremental) {
            (true, _) => height,
            (false, true) => sum(b'R', initial, given)?,
            (false, false) => sum(b'R', zero, given)?,
        };
        self.modes.sticky.retract = Some(given);

        let depth_letter = block.letter_of(across);
        let depth = self.kept(block, depth_letter, self.modes.sticky.bottom)?;
        let bottom = match incremental || block.increment(across).is_some() {
            true => sum(depth_letter, retract, depth)?,
            false => sum(depth_letter, zero, depth)?,
        };
        self.modes.sticky.bottom = Some(depth);
        if retract < bottom || (peck_on_lathe && retract == bottom) {
            let letter = if peck_on_lathe { depth_letter } else { b'R' };
            return Err(match block.word(letter) {
                Some(_) => Fault::at(Reason::RetractBelowBottom, letter),
                None => Fault::at_motion(Reason::RetractBelowBottom),
            });
        }

        let left = match whole(block, b'L', u32::MAX)? {
            None => 1,
            Some(0) if self.modes.dialect.flavour != Flavour::Iso => {
                return Err(Fault::at(Reason::OutOfRange, b'L'));
            }
            Some(count) => count,
        };
        let peck = self.peck(block, kind, retract, bottom, left)?;
        let (offset, middle) = self.back_bore(block, kind, plane, [zero, bottom], incremental)?;
        if let Some(value) = block.word(b'P') {
            self.modes.sticky.dwell_micros =
                unsigned(value, 6).ok_or_else(|| Fault::at(Reason::OutOfRange, b'P'))?;
        }
        self.check_cycle_spindle(kind)?;
        self.set_feed_of(commands)?;
        let feed = commands.feed;

        let target = self.target(block)?;
        let axes = plane.axes();
        let hole = axes.map(|axis| part(&target, axis));
        let mut pitch = [Nm(0); 2];
        let mut last = hole;
        for ((axis, pitch), last) in axes.into_iter().zip(&mut pitch).zip(&mut last) {
            let here = part(&self.modes.position, axis);
            if incremental || block.increment(axis).is_some() {
                // Both within 2^50.
                pitch.0 = last.0.saturating_sub(here.0);
            }
            let letter = block.letter_of(axis);
            let more = pitch
                .0
                .checked_mul(i64::from(left.max(1)).saturating_sub(1))
                .ok_or_else(|| Fault::at(Reason::NumberTooLarge, letter))?;
            *last = sum(letter, *last, Nm(more))?;
        }
        let clear = if self.active(Group::Return) == Code::ReturnToRetract {
            retract
        } else {
            retract.max(initial)
        };
        if left == 0 {
            return Ok(());
        }
        let at = self.modes.position;
        for (axis, value) in axes.into_iter().zip(last).chain([(across, clear)]) {
            if let Some(entry) = self.modes.position.get_mut(axis) {
                *entry = value;
            }
        }
        commands.cycle(Cycle::Holes(Holes {
            kind,
            plane,
            at,
            hole,
            pitch,
            retract,
            bottom,
            clear,
            peck,
            clearance: if peck_on_lathe { given } else { PECK_CLEARANCE },
            offset,
            middle,
            dwell_micros: self.modes.sticky.dwell_micros,
            feed,
            spindle: (self.spindle_direction(), self.modes.milli_rpm),
            path: Some(self.path()).filter(|path| matches!(path, PathMode::Blend { .. })),
            left,
            state: State::Begin,
        }));
        Ok(())
    }

    /// The depth of a peck; not too many of them.
    fn peck(
        &mut self,
        block: &Block,
        kind: Kind,
        retract: Nm,
        bottom: Nm,
        left: u32,
    ) -> Result<Nm, Fault> {
        if !matches!(kind, Kind::Peck | Kind::ChipBreak | Kind::LathePeck) {
            if u64::from(left) > MOST_PECKS {
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
        let deep = retract.0.saturating_sub(bottom.0).unsigned_abs();
        let pecks = deep
            .checked_div(peck.0.unsigned_abs())
            .unwrap_or(0)
            .saturating_add(1);
        if pecks.saturating_mul(u64::from(left)) > MOST_PECKS {
            return Err(Fault::at_motion(Reason::TooManyPasses));
        }
        Ok(peck)
    }

    /// I, J and K of G87: the offset in the plane and the height to which it bores.
    fn back_bore(
        &mut self,
        block: &Block,
        kind: Kind,
        plane: Plane,
        [zero, bottom]: [Nm; 2],
        incremental: bool,
    ) -> Result<([Nm; 2], Nm), Fault> {
        if kind != Kind::BackBore {
            return Ok(([Nm(0); 2], Nm(0)));
        }
        let letters = plane.centre_letters();
        let across = match plane {
            Plane::Xy => b'K',
            Plane::Zx => b'J',
            Plane::Yz => b'I',
        };
        let before = self.modes.sticky.back_bore;
        let [i, j, k] = [0, 1, 2].map(|place| before.and_then(|kept| kept.get(place).copied()));
        let kept = [
            self.kept(block, letters[0], i)?,
            self.kept(block, letters[1], j)?,
            self.kept(block, across, k)?,
        ];
        self.modes.sticky.back_bore = Some(kept);
        let from = if incremental { bottom } else { zero };
        let middle = from
            .0
            .checked_add(kept[2].0)
            .and_then(|sum| Nm(sum).within_limit())
            .ok_or_else(|| Fault::at(Reason::NumberTooLarge, across))?;
        Ok(([kept[0], kept[1]], middle))
    }

    /// Taps turn their own way; bores that stop the spindle need it to turn.
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

    /// The turning, facing and threading cycles of lathes: X and Z of the far corner, `R` the taper.
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
