//! The modes that a block may change, by name and as they are stored.

#[cfg(feature = "extended")]
use crate::codes::code::Side;
use crate::codes::code::{Code, Group};
use crate::codes::dialect::{Dialect, Flavour};
use crate::codes::kind::Kind;
#[cfg(feature = "extended")]
use crate::values::decimal::Decimal;
use crate::values::nm::Nm;

/// Motion mode: the motion of axis words without a code.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Motion {
    /// G0.
    Rapid,
    /// G1.
    Linear,
    /// G2.
    Clockwise,
    /// G3.
    CounterClockwise,
    /// G5.
    Cubic,
    /// G5.1.
    Quadratic,
    /// G5.2.
    Nurbs,
    /// G33.
    Thread,
    /// G33.1.
    Tap,
    /// G38.2 to G38.5.
    Probe {
        /// G38.4, G38.5.
        away: bool,
        /// G38.2, G38.4.
        must: bool,
    },
    /// A canned cycle.
    Cycle(Kind),
}

/// The unit of lengths.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Units {
    /// G21.
    Millimetres,
    /// G20; exactly 25.4 mm.
    Inches,
    /// The micromill dialect's.
    Micrometres,
}

impl Units {
    /// A unit in nanometres, as a factor and a power of ten; or half of it.
    pub(crate) const fn scale(self, half: bool) -> (u8, u8) {
        match (self, half) {
            (Units::Millimetres, false) => (1, 6),
            (Units::Millimetres, true) => (5, 5),
            (Units::Inches, false) => (254, 5),
            (Units::Inches, true) => (127, 5),
            (Units::Micrometres, false) => (1, 3),
            (Units::Micrometres, true) => (5, 2),
        }
    }

    /// Converts this many units to nanometres, rounded once, halves away from zero; `None` beyond
    /// [`Nm::LIMIT`].
    #[cfg(feature = "extended")]
    pub(crate) fn length(self, value: Decimal) -> Option<Nm> {
        let (factor, exponent) = self.scale(false);
        let scaled = value.scaled(i32::from(factor), exponent);
        scaled.and_then(|nm| Nm(nm).within_limit())
    }

    /// Half of that value, rounded once: a diameter as a radius.
    #[cfg(feature = "extended")]
    pub(crate) fn half(self, value: Decimal) -> Option<Nm> {
        let (factor, exponent) = self.scale(true);
        let scaled = value.scaled(i32::from(factor), exponent);
        scaled.and_then(|nm| Nm(nm).within_limit())
    }
}

/// Distance mode of coordinates (G90, G91) or of arc centres (G90.1, G91.1).
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Distance {
    /// In the work frame.
    Absolute,
    /// From the position before the move.
    Incremental,
}

/// Meaning of `F`.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FeedMode {
    /// G94: length per minute.
    PerMinute,
    /// G93: moves per minute; every feed move has its own `F`.
    InverseTime,
    /// G95: length per spindle revolution.
    PerRevolution,
}

/// The part of the state that a refused block has to restore; small enough for a backup.
#[derive(Copy, Clone, Debug, Eq, PartialEq)]
#[repr(C)]
pub(crate) struct Modes<const N: usize> {
    pub(crate) tool: u32,
    /// The tool in the spindle, set by M6 or M61.
    pub(crate) loaded: u32,
    /// The code in effect of each modal group.
    pub(crate) active: [Option<Code>; Group::MODAL],
    pub(crate) mist: bool,
    pub(crate) flood: bool,
    /// Whether the active work frame is rotated.
    #[cfg(feature = "extended")]
    pub(crate) is_rotated: bool,
    /// The dialect, which never changes.
    pub(crate) dialect: Dialect,
    /// Nanometres per minute or per revolution, or millionths of a move per minute; 0 without a
    /// feed.
    pub(crate) feed: u64,
    pub(crate) milli_rpm: u64,
    pub(crate) position: [Nm; N],
    /// The shift of all work frames by G92.
    pub(crate) shift: [Nm; N],
    /// The tool length in effect.
    pub(crate) length: [Nm; N],
    /// The shift G92.3 brings back.
    pub(crate) kept_shift: [Nm; N],
    #[cfg(feature = "extended")]
    pub(crate) sticky: Sticky,
    #[cfg(feature = "extended")]
    pub(crate) more: More,
}

impl<const N: usize> Modes<N> {
    /// All bytes are zero (unless the extended codes add others): no codes are in effect.
    pub(crate) const NONE: Self = Modes {
        dialect: Dialect::RS274.with_block_delete(false),
        active: [None; Group::MODAL],
        mist: false,
        flood: false,
        #[cfg(feature = "extended")]
        is_rotated: false,
        tool: 0,
        loaded: 0,
        feed: 0,
        milli_rpm: 0,
        position: [Nm(0); N],
        shift: [Nm(0); N],
        length: [Nm(0); N],
        kept_shift: [Nm(0); N],
        #[cfg(feature = "extended")]
        sticky: Sticky::NONE,
        #[cfg(feature = "extended")]
        more: More::NONE,
    };

    /// Copies it field by field. A copy of the whole would link a function that the basic codes
    /// need nowhere else.
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    pub(crate) fn write_to(&self, to: &mut Self) {
        (to.dialect, to.active) = (self.dialect, self.active);
        (to.mist, to.flood) = (self.mist, self.flood);
        (to.tool, to.loaded) = (self.tool, self.loaded);
        (to.feed, to.milli_rpm) = (self.feed, self.milli_rpm);
        to.position = self.position;
        to.shift = self.shift;
        to.length = self.length;
        to.kept_shift = self.kept_shift;
        #[cfg(feature = "extended")]
        {
            to.sticky = self.sticky;
            to.more = self.more;
            to.is_rotated = self.is_rotated;
        }
    }
}

/// State that the extended codes leave to the next block, apart from the canned cycles.
#[cfg(feature = "extended")]
#[derive(Copy, Clone, Debug, Eq, PartialEq)]
pub(crate) struct More {
    /// G96: surface speed per minute and the largest speed in thousandths of a revolution per
    /// minute; `None` under G97.
    pub(crate) surface: Option<(Nm, Option<u64>)>,
    /// G5: the reversed vector from the end of the curve to its second control point. G5.2: the
    /// last control point.
    pub(crate) tail: Option<[Nm; 2]>,
    /// G5.2: order and number of control points of the NURBS that is not ended yet; 0 without one.
    pub(crate) nurbs: (u8, u32),
    /// X and Y of the position in a rotated work frame, from the zero of the frame. They count only
    /// as long as they give the position, so nothing else has to keep them up to date.
    pub(crate) unrotated: [Nm; 2],
    pub(crate) compensation: Option<Side>,
    /// `P` of G64.
    pub(crate) tolerance: Option<Nm>,
    /// M83: words of the extruder are increments.
    pub(crate) feeds_increments: bool,
    /// G10 of printers: the filament is drawn back.
    pub(crate) is_retracted: bool,
}

#[cfg(feature = "extended")]
impl More {
    const NONE: More = More {
        surface: None,
        tail: None,
        nurbs: (0, 0),
        unrotated: [Nm(0); 2],
        compensation: None,
        tolerance: None,
        feeds_increments: false,
        is_retracted: false,
    };
}

/// Values that a canned cycle keeps for the next block of its series, with lengths as programmed.
#[cfg(feature = "extended")]
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(crate) struct Sticky {
    pub(crate) retract: Option<Nm>,
    pub(crate) bottom: Option<Nm>,
    pub(crate) peck: Option<Nm>,
    pub(crate) dwell_micros: u64,
    pub(crate) back_bore: Option<[Nm; 3]>,
    /// Height before the series in the machine frame, to which G98 returns.
    pub(crate) initial: Option<Nm>,
    /// The far corner of a turning cycle, X and Z, machine frame.
    pub(crate) corner: Option<[Nm; 2]>,
    /// The taper of a turning cycle, and the lead of a thread.
    pub(crate) taper: Nm,
    pub(crate) lead: Nm,
}

#[cfg(feature = "extended")]
impl Sticky {
    pub(crate) const NONE: Sticky = Sticky {
        retract: None,
        bottom: None,
        peck: None,
        dwell_micros: 0,
        back_bore: None,
        initial: None,
        corner: None,
        taper: Nm(0),
        lead: Nm(0),
    };
}

/// The codes in effect at the start of a program.
#[inline(always)]
pub(crate) fn initial(dialect: Dialect) -> [Option<Code>; Group::MODAL] {
    let micromill = dialect.flavour == Flavour::Micromill;
    let lathe = dialect.is_lathe();
    // In the order of the groups.
    [
        Some(if lathe { Code::PlaneZx } else { Code::PlaneXy }),
        Some(if micromill {
            Code::Micrometres
        } else {
            Code::Millimetres
        }),
        Some(if lathe {
            Code::DiameterMode
        } else {
            Code::RadiusMode
        }),
        Some(Code::G54),
        Some(Code::Absolute),
        Some(if micromill {
            Code::AbsoluteCentres
        } else {
            Code::IncrementalCentres
        }),
        Some(Code::ReturnToInitial),
        Some(Code::Blend),
        Some(Code::PerMinute),
        Some(if dialect.begins_in_rapid() {
            Code::Rapid
        } else {
            Code::CancelMotion
        }),
        Some(Code::SpindleOff),
        Some(Code::SpindleSpeed),
    ]
}
