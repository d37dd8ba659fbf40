//! Motion: the user of the axis words, G0 to G3, G53 and G38.

use crate::blocks::block::Block;
#[cfg(feature = "extended")]
use crate::blocks::block::given::POLAR;
use crate::blocks::fault::{Fault, Reason};
use crate::codes::code::{Code, Group};
use crate::codes::dialect::Flavour;
use crate::codes::letters::{AXES, Letters};
use crate::command::Feed;
#[cfg(feature = "extended")]
use crate::command::SpindleDirection;
use crate::command::arc::{self, Arc, Direction, Plane};
use crate::features::{EXTENDED, ROOMY};
use crate::modal::Modal;
use crate::modal::commands::Commands;
use crate::modal::frames::Terms;
use crate::modal::modes::{Distance, FeedMode, Units};
use crate::values::decimal::Decimal;
use crate::values::nm::Nm;
use crate::values::wide::Ratio;

impl<const N: usize> Modal<N> {
    /// The part of [`Modal::moves`] that remains for G0 to G3 in a block without other codes, after
    /// a move or no motion.
    ///
    /// There is no non-modal code, no cycle that ends, no drill (it has no motion codes) and
    /// nothing that compensation forbids.
    #[inline(always)]
    pub(crate) fn moves_on(
        &mut self,
        block: &Block,
        mode: Code,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        let coded = block.code(Group::Motion).is_some();
        let none = block.axes() == 0;
        self.check_words(block, mode, coded || !none)?;
        if !none {
            self.check_z_alone(block)?;
            self.aim_straight(block, self.terms(), commands)?;
            self.travel_on(block, mode, commands)?;
        } else if coded && mode.is_arc() {
            self.travel(block, mode, true, commands)?;
        } else {
            commands.before.position = self.modes.position;
        }
        commands.note_move(self.active(Group::Motion));
        if self.modes.dialect.flavour != Flavour::Micromill {
            self.set_active(Group::Motion, mode);
        }
        // There is no tail of a spline: the mode after one is not that of a plain move.
        Ok(())
    }

    /// The last stage before stops. It refuses words without a user, and then executes one of G10,
    /// G28, G30, G92 or the motion.
    #[inline(never)]
    pub(crate) fn moves(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        if self.modes.dialect.flavour == Flavour::Drill {
            return self.drill(block, commands);
        }
        let non_modal = block.code(Group::NonModal);
        let direct_length = block.code(Group::ToolLength) == Some(Code::DirectToolLength);
        let covets = direct_length || non_modal.is_some_and(Code::covets_axes);
        let code = block.code(Group::Motion);
        if covets && code.is_some_and(|code| code != Code::CancelMotion) {
            let group = if direct_length {
                Group::ToolLength
            } else {
                Group::NonModal
            };
            return Err(Fault::at_code(Reason::TwoUsersOfWords, group));
        }
        let mode = code.unwrap_or_else(|| self.active(Group::Motion));
        #[cfg(feature = "extended")]
        if mode.contour_cycle().is_some() {
            return Err(Fault::at_code(Reason::ContourOfBlocks, Group::Motion));
        }
        #[cfg(feature = "extended")]
        self.leave_series(mode);
        #[cfg(feature = "extended")]
        self.check_nurbs(block, mode)?;
        let mine = !covets && (block.axes() != 0 || code.is_some());
        self.check_words(block, mode, mine)?;
        #[cfg(feature = "extended")]
        self.check_compensation(block, if mine { mode } else { Code::CancelMotion })?;
        match non_modal {
            Some(Code::CancelShift) => {
                (self.modes.shift, self.modes.kept_shift) = ([Nm(0); N], [Nm(0); N])
            }
            #[cfg(feature = "extended")]
            Some(Code::SuspendShift) => self.modes.shift = [Nm(0); N],
            #[cfg(feature = "extended")]
            Some(Code::RestoreShift) => self.modes.shift = self.modes.kept_shift,
            _ => {}
        }
        match non_modal {
            Some(Code::SetData) => self.set_data(block, commands)?,
            Some(Code::Shift) => self.set_shift(block, commands)?,
            #[cfg(feature = "extended")]
            Some(Code::LocalShift) => self.set_local_shift(block, commands)?,
            Some(Code::Home | Code::SecondHome) => {
                let second = non_modal == Some(Code::SecondHome);
                self.go_home(block, second, commands)?;
            }
            _ if direct_length => {}
            _ => self.travel(block, mode, mine, commands)?,
        }
        // The mode stays for the next block, except on the link of the micro mill.
        if self.modes.dialect.flavour != Flavour::Micromill {
            let ends = EXTENDED && mode == Code::NurbsEnd;
            self.set_active(Group::Motion, if ends { Code::CancelMotion } else { mode });
        }
        #[cfg(feature = "extended")]
        if !matches!(mode, Code::Cubic | Code::Nurbs) {
            self.modes.more.tail = None;
        }
        Ok(())
    }

    /// Refuses words without a user. `mine` is whether the motion uses the axis words or has a
    /// code.
    #[inline]
    fn check_words(&self, block: &Block, mode: Code, mine: bool) -> Result<(), Fault> {
        if !block.has_claims() {
            return Ok(());
        }
        // A code of the block counts for itself.
        let letters = match mode {
            _ if !mine => Letters::NONE,
            Code::Clockwise | Code::CounterClockwise => {
                // Grbl ignores the offset perpendicular to the plane of an arc to a point in the
                // plane.
                let (_, ends) = self.plane().shape();
                let grbl = self.modes.dialect.flavour == Flavour::Grbl;
                // Others take a zero: posts for Grbl write `K0` into every arc.
                let aside = block.word(self.plane().offset_aside());
                let is_zero = EXTENDED && aside.is_some_and(|offset| offset.is_zero());
                if (grbl || is_zero) && block.has_any(ends) && !block.has(b'R') {
                    const { Letters::new(b"IJKP") }
                } else {
                    self.plane().arc_letters()
                }
            }
            mode if block.code(Group::Motion).is_none() => mode.letters(),
            _ => Letters::NONE,
        };
        block.check_users(letters)
    }

    /// The motion itself.
    #[cfg_attr(not(target_has_atomic = "32"), inline(always))]
    fn travel(
        &mut self,
        block: &Block,
        mode: Code,
        mine: bool,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        let mut terms = self.terms();
        if block.code(Group::NonModal) == Some(Code::MachineFrame) {
            let straight = matches!(mode, Code::Rapid | Code::Linear);
            if !straight || self.distance() == Distance::Incremental {
                return Err(Fault::at_code(Reason::MachineFrame, Group::NonModal));
            }
            terms = Terms::MACHINE;
        }
        let none = block.axes() == 0;
        match mode {
            // G0 and G1 without axis words only set the mode.
            Code::CancelMotion | Code::Rapid | Code::Linear if none => return Ok(()),
            Code::CancelMotion => return Err(Fault::at_axes(Reason::AxisWordsWithoutMotion)),
            _ if !mine => return Ok(()),
            #[cfg(feature = "extended")]
            mode if !mode.is_plain_move() && !mode.is_probe() => {
                return self.special(block, mode, commands);
            }
            _ => {}
        }
        if none && !(mode.is_arc() && block.has_any(self.plane().shape().0)) {
            return Err(Fault::at_code(Reason::NoAxisWords, Group::Motion));
        }
        self.travel_to(block, mode, terms, commands)
    }

    /// Makes the move, and sets its mode.
    #[inline(always)]
    fn travel_to(
        &mut self,
        block: &Block,
        mode: Code,
        terms: Terms,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        self.check_z_alone(block)?;
        self.aim(block, terms, commands)?;
        self.travel_on(block, mode, commands)
    }

    /// Makes the move to the stored end.
    #[inline(always)]
    fn travel_on(
        &mut self,
        block: &Block,
        mode: Code,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        // Printers know no rapids: G0 is G1.
        #[cfg(feature = "extended")]
        let mode = match mode {
            Code::Rapid if self.is_printer() && self.modes.feed != 0 => Code::Linear,
            mode => mode,
        };
        match mode {
            Code::Rapid => {}
            Code::Linear => self.set_feed_of(commands)?,
            Code::Clockwise | Code::CounterClockwise => {
                // One after the other, so that they share their stack.
                self.shape_arc(block, mode, commands)?;
                if block.has(b'R') {
                    self.arc_by_radius(block, &mut commands.arc)?;
                } else {
                    self.read_centre(block, &mut commands.arc)?;
                }
                self.finish_arc(block, commands)?;
            }
            _ => {
                if commands.arc.to == self.modes.position {
                    return Err(Fault::at_axes(Reason::NoProbeMove));
                }
                if self.feed_mode() != FeedMode::PerMinute
                    && self.modes.dialect.flavour != Flavour::Grbl
                {
                    return Err(Fault::at_motion(Reason::WrongFeedMode));
                }
                self.set_feed_of(commands)?;
            }
        }
        commands.before.position = self.modes.position;
        self.go(mode, commands);
        Ok(())
    }

    /// Applies the axis words of the block to the position and stores the result as the end of the
    /// move.
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    pub(crate) fn aim(
        &mut self,
        block: &Block,
        terms: Terms,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        #[cfg(feature = "extended")]
        if self.is_turned(block, terms) {
            commands.arc.to = self.modes.position;
            self.modes.more.unrotated = self.read_turned(block, terms, &mut commands.arc.to)?;
            return Ok(());
        }
        self.aim_straight(block, terms, commands)
    }

    /// The same for words that are only added to a zero: no polar coordinates, and no rotated
    /// frame.
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    fn aim_straight(
        &self,
        block: &Block,
        terms: Terms,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        // Only code system A has increments (U, V, W), and there X is always a diameter.
        // They, and wrapped axes, take the longer path.
        if ROOMY && self.modes.dialect.has_plain_axes() && !self.is_diameter() {
            if N > AXES {
                commands.arc.to = self.modes.position; // Axes without a letter stay.
            }
            return self.read_end(block, terms, &mut commands.arc.to);
        }
        commands.arc.to = self.modes.position;
        self.read_straight(block, terms, &mut commands.arc.to)
    }

    /// Ends a block with a move to the stored end.
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    pub(crate) fn go(&mut self, motion: Code, commands: &mut Commands<N>) {
        self.modes.position = commands.arc.to;
        commands.motion(motion);
    }

    /// Refuses codes that are forbidden while the contour is compensated.
    #[cfg(feature = "extended")]
    fn check_compensation(&self, block: &Block, mode: Code) -> Result<(), Fault> {
        if self.compensation().is_none() {
            return Ok(());
        }
        if let Some(code) = block.code(Group::NonModal) {
            if code != Code::Dwell {
                return Err(Fault::at_code(Reason::UnderCompensation, Group::NonModal));
            }
        }
        if mode.is_plain_move() || mode == Code::CancelMotion {
            Ok(())
        } else {
            Err(Fault::at_motion(Reason::UnderCompensation))
        }
    }

    /// Modes other than lines, arcs and probing.
    #[cfg(feature = "extended")]
    fn special(
        &mut self,
        block: &Block,
        mode: Code,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        match mode {
            Code::Cubic => self.cubic(block, commands),
            Code::Quadratic => self.quadratic(block, commands),
            Code::Nurbs => self.nurbs(block, commands),
            Code::NurbsEnd => self.end_nurbs(block, commands),
            Code::Thread => self.thread(block, commands),
            Code::RigidTap => self.rigid_tap(block, commands),
            _ => match mode.cycle() {
                Some(kind) => self.canned(block, kind, commands),
                None => Ok(()),
            },
        }
    }

    /// The offsets of axis words in the present modes.
    pub(crate) fn terms(&self) -> Terms {
        match self.distance() {
            Distance::Absolute => Terms::WORK,
            Distance::Incremental => Terms::INCREMENT,
        }
    }

    /// The position with the axis words of the block applied.
    #[cfg(feature = "extended")]
    pub(crate) fn target(&self, block: &Block) -> Result<[Nm; N], Fault> {
        let mut target = self.modes.position;
        self.read_axes(block, self.terms(), &mut target)?;
        Ok(target)
    }

    /// The feed in effect, for a feed move of this block.
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    pub(crate) fn set_feed_of(&self, commands: &mut Commands<N>) -> Result<(), Fault> {
        let rate = self.modes.feed as i64;
        let mode = self.feed_mode();
        if rate <= 0 {
            return Err(Fault::at_motion(if mode == FeedMode::InverseTime {
                Reason::NoInverseTime
            } else {
                Reason::NoFeed
            }));
        }
        commands.feed = match mode {
            #[cfg(feature = "extended")]
            FeedMode::PerRevolution => {
                self.check_turning()?;
                Feed::PerRevolution(Nm(rate))
            }
            FeedMode::InverseTime => Feed::InverseTime {
                micro_per_minute: rate as u64,
            },
            _ => Feed::PerMinute(Nm(rate)),
        };
        Ok(())
    }

    /// Refuses a move that needs a turning spindle when the spindle stands.
    #[cfg(feature = "extended")]
    pub(crate) fn check_turning(&self) -> Result<(), Fault> {
        if self.spindle_direction() == SpindleDirection::Off {
            return Err(Fault::at_motion(Reason::SpindleStopped));
        }
        Ok(())
    }

    /// On the micro mill Z moves alone, and never in an arc.
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    pub(crate) fn check_z_alone(&self, block: &Block) -> Result<(), Fault> {
        const Z: u16 = 0b100;
        if self.modes.dialect.flavour != Flavour::Micromill {
            return Ok(());
        }
        let axes = block.axes();
        let arc = block.code(Group::Motion).is_some_and(Code::is_arc);
        if axes & Z != 0 && (axes != Z || arc) {
            return Err(Fault::at(Reason::ZNotAlone, b'Z'));
        }
        Ok(())
    }

    /// G2 and G3 to the stored end: determines the arc.
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    fn shape_arc(
        &self,
        block: &Block,
        mode: Code,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        let plane = self.plane();
        // A plane needs two axes; a machine without them has no such arc.
        if N < 3 && plane != Plane::Xy || N < 2 {
            return Err(Fault::at_motion(Reason::NoCentre));
        }
        #[cfg(feature = "extended")]
        self.check_plane_of_rotated()?;
        let arc = &mut commands.arc;
        arc.plane = plane;
        arc.direction = if mode == Code::Clockwise {
            Direction::Clockwise
        } else {
            Direction::CounterClockwise
        };
        arc.centre = self.modes.position;
        (arc.radius, arc.mismatch) = (None, Nm(0));
        let (_, ends) = plane.shape();
        if block.has(b'R') {
            if block.has_any(plane.centre()) {
                return Err(Fault::at(Reason::RadiusAndCentre, b'R'));
            }
            #[cfg(feature = "extended")]
            let ends = match self.modes.dialect.has_polar() {
                true => Letters(ends.0 | POLAR.0),
                false => ends,
            };
            if !block.has_any(ends) {
                return Err(Fault::at_motion(Reason::NoEnd));
            }
        }
        Ok(())
    }

    /// Completes the values of an arc other than its geometry.
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    fn finish_arc(&self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        let arc = &mut commands.arc;
        // One unit of the finest last digit of these words; there is at least one.
        let (shape, _) = arc.plane.shape();
        let (factor, exponent) = self.units().scale(false);
        let last = Decimal::new(1, block.most_places(shape));
        let resolution = last.and_then(|value| value.scaled(i32::from(factor), exponent));
        arc.resolution = Nm(resolution.unwrap_or(0));
        // For a stretched radius the difference is already known.
        if arc.mismatch == Nm(0) {
            let (from, axes) = (&self.modes.position, arc.plane.axes());
            // A program without zeros at the end has fewer digits than it is exact.
            let one_and_a_half = (arc.resolution.0.wrapping_mul(3) >> 1).min(arc::SLACK_DIGITS);
            let slack = match (self.modes.dialect.flavour, self.units()) {
                (Flavour::Grbl, _) | (_, Units::Micrometres) => arc::SLACK_NARROW,
                (_, units) => arc::slack(units).max(one_and_a_half),
            };
            #[cfg(feature = "extended")]
            let slack = slack.max(self.modes.dialect.arc_tolerance().0);
            arc::with_centre(from, &arc.to, &arc.centre, axes, slack, &mut arc.mismatch)?;
        }
        arc.turns = 1;
        if block.whole(b'P', u32::MAX, &mut arc.turns).is_err() || arc.turns == 0 {
            return Err(Fault::at(Reason::NotWhole, b'P'));
        }
        arc.turns = arc.turns.wrapping_sub(1);
        self.set_feed_of(commands)
    }

    /// Computes the centre from a radius. The radius is kept unless it has to be stretched.
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    fn arc_by_radius(&self, block: &Block, arc: &mut Arc<N>) -> Result<(), Fault> {
        const TOO_LARGE: Fault = Fault::at(Reason::NumberTooLarge, b'R');
        let mut radius = Nm(0);
        self.add_word(block, b'R', &mut radius)?;
        let left = (arc.direction == Direction::CounterClockwise) != (radius.0 < 0);
        radius = Nm(radius.0.wrapping_abs());
        let axes = arc.plane.axes();
        let mut way = [0; 2];
        if !arc::between(&self.modes.position, &arc.to, axes, &mut way) {
            return Err(TOO_LARGE);
        }
        let mut ratio = Ratio::NONE;
        arc::beside(&way, radius, &mut arc.mismatch, &mut ratio)?;
        arc::turn(&mut way, &ratio, left);
        if arc.mismatch == Nm(0) {
            arc.radius = Some(radius);
        }
        for (&axis, &way) in axes.iter().zip(&way) {
            if let Some(centre) = arc.centre.get_mut(axis) {
                // Below 2^52: a sum that wraps is beyond the limit as well.
                let moved = Nm(centre.0.wrapping_add(way));
                *centre = moved.within_limit().ok_or(TOO_LARGE)?;
            }
        }
        Ok(())
    }

    /// Reads the centre from its words: offsets from the start, or coordinates in the work frame
    /// (both are then needed).
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    fn read_centre(&self, block: &Block, arc: &mut Arc<N>) -> Result<(), Fault> {
        let absolute = self.centre_distance() == Distance::Absolute;
        let letters = arc.plane.centre_letters();
        if !block.has_any(arc.plane.centre()) {
            return Err(Fault::at_motion(Reason::NoCentre));
        }
        if absolute && !block.has_all(arc.plane.centre()) {
            return Err(Fault::at_motion(Reason::HalfCentre));
        }
        #[cfg(feature = "extended")]
        if self.modes.is_rotated {
            return self.read_turned_centre(block, absolute, arc);
        }
        for (&axis, &letter) in arc.plane.axes().iter().zip(&letters) {
            if let Some(centre) = arc.centre.get_mut(axis) {
                if absolute {
                    *centre = self.zero_of(axis);
                }
                self.add_word(block, letter, centre)?;
            }
        }
        Ok(())
    }
}
