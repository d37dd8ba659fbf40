//! The G and M codes of the list, their modal groups, and the dialects that have them.

use crate::codes::dialect::Flavour;
use crate::codes::kind::Kind;
use crate::codes::letters::Letters;
use crate::features::EXTENDED;

/// The side of the contour on which the tool is, seen along the move.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Side {
    /// G41.
    Left,
    /// G42.
    Right,
}

/// One code of the list, by its function. One byte: the index of its row in [`ROWS`], from 1.
#[derive(Copy, Clone, Eq, PartialEq, PartialOrd, Debug)]
#[repr(u8)]
pub(crate) enum Code {
    // The basic list, that of Grbl and the micro mill. It starts at 1, so that zero bytes are no
    // codes.
    Rapid = 1,
    Linear,
    Clockwise,
    CounterClockwise,
    /// G38.2 to G38.5: towards or away from the contact, and with or without an error if it is
    /// missed.
    ProbeMust,
    Probe,
    ProbeAwayMust,
    ProbeAway,
    CancelMotion,
    Dwell,
    /// G10.
    SetData,
    Home,
    SecondHome,
    StoreHome,
    StoreSecondHome,
    MachineFrame,
    Shift,
    CancelShift,
    PlaneXy,
    PlaneZx,
    PlaneYz,
    Millimetres,
    Inches,
    G54,
    G55,
    G56,
    G57,
    G58,
    G59,
    ExactPath,
    Absolute,
    Incremental,
    IncrementalCentres,
    PerMinute,
    InverseTime,
    CancelCompensation,
    DirectToolLength,
    CancelToolLength,
    Stop,
    OptionalStop,
    End,
    EndAndRewind,
    SpindleOff,
    SpindleClockwise,
    SpindleCounterClockwise,
    ChangeTool,
    Mist,
    Flood,
    CoolantOff,
    // Initial states of some dialects that are not codes of the basic list.
    AbsoluteCentres,
    /// The unit of the micro mill, which has no code.
    Micrometres,
    ReturnToInitial,
    RadiusMode,
    /// Known from other controllers, in no dialect of this crate.
    Foreign,
    // The extended ones.
    G59_1,
    G59_2,
    G59_3,
    /// G5.
    Cubic,
    /// G5.1.
    Quadratic,
    /// G33.
    Thread,
    // The canned cycles, in the order of `Kind`.
    ChipBreakCycle,
    LeftTapCycle,
    ThreadCycle,
    DrillCycle,
    DrillDwellCycle,
    PeckCycle,
    TapCycle,
    BoreCycle,
    BoreStopCycle,
    BackBoreCycle,
    BoreManualCycle,
    BoreDwellCycle,
    TurnBoxCycle,
    ThreadBoxCycle,
    FaceBoxCycle,
    LathePeckCycle,
    /// G70 to G72 and their variants: they cut a contour of several blocks.
    G70,
    G71,
    G71_1,
    G71_2,
    G72,
    G72_1,
    G72_2,
    SuspendShift,
    RestoreShift,
    DiameterMode,
    ExactStop,
    Blend,
    PerRevolution,
    /// G41, G42, and with a diameter (G41.1, G42.1).
    CompensateLeft,
    CompensateRight,
    CompensateLeftDirect,
    CompensateRightDirect,
    ToolLength,
    /// G99.
    ReturnToRetract,
    SurfaceSpeed,
    SpindleSpeed,
    PalletStop,
    Orient,
    SetTool,
    /// M48 to M53.
    EnableOverrides,
    DisableOverrides,
    FeedOverride,
    SpindleOverride,
    AdaptiveFeed,
    FeedHold,
    /// M62 to M65: on or off with the next motion, on or off at once.
    OutputOnWithMotion,
    OutputOffWithMotion,
    OutputOn,
    OutputOff,
    WaitInput,
    /// M67, M68.
    AnalogWithMotion,
    Analog,
    /// G5.2, G5.3.
    Nurbs,
    NurbsEnd,
    /// G33.1.
    RigidTap,
    /// G52.
    LocalShift,
    /// M70 to M73: they need a `Program`.
    SaveModes,
    DropModes,
    RestoreModes,
    SaveModesOfCaller,
    /// M98, M99: they need a `Program`.
    CallProgram,
    Return,
    // Codes of 3D printers.
    /// M104, M109: of the extruder, without and with a wait.
    HeatExtruder,
    HeatExtruderAndWait,
    /// M140, M190.
    HeatBed,
    HeatBedAndWait,
    /// M141, M191.
    HeatChamber,
    HeatChamberAndWait,
    /// M106, M107.
    Fan,
    FanOff,
    /// M82, M83.
    ExtruderAbsolute,
    ExtruderRelative,
    /// M84.
    MotorsOff,
    /// G10, G11.
    Retract,
    Unretract,
}

/// The modal groups; a block has at most one code of each.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[repr(u8)]
pub(crate) enum Group {
    // Groups whose codes only stay in effect.
    Plane,
    Units,
    Diameter,
    System,
    Distance,
    CentreDistance,
    Return,
    // Groups that are checked, or that do more.
    Path,
    FeedMode,
    Motion,
    Spindle,
    SpindleMode,
    NonModal,
    Compensation,
    ToolLength,
    Stop,
    Tool,
    Coolant,
    Override,
    Io,
}

impl Group {
    pub(crate) const COUNT: usize = 20;

    /// The number of groups, from the first, that have a code in effect.
    pub(crate) const MODAL: usize = Group::SpindleMode as usize + 1;

    /// The number of groups, from the first, that a block sets only by its code.
    pub(crate) const PLAIN: usize = Group::Path as usize;
}

// Dialects, by the bit of their flavour.
const NONE: u8 = 0;
const GRBL: u8 = 1 << Flavour::Grbl as u8;
const MICROMILL: u8 = 1 << Flavour::Micromill as u8;
const DRILL: u8 = 1 << Flavour::Drill as u8;
const PRINTER: u8 = 1 << Flavour::Printer as u8;
const LATHES: u8 = 1 << Flavour::Lathe as u8 | 1 << Flavour::LatheA as u8;
const MILLS: u8 = 1 << Flavour::Rs274 as u8 | 1 << Flavour::Iso as u8 | 1 << Flavour::Printer as u8;
const BOTH: u8 = MILLS | LATHES;
const MOST: u8 = BOTH | GRBL;
/// Codes that 3D printers use differently, or not at all.
const NO_PRINTER: u8 = BOTH & !(1 << Flavour::Printer as u8);
/// Codes that the micro mill has as well.
const LINK: u8 = MOST | MICROMILL;

/// All codes in order, with their group and the dialects that have them (for Grbl those of 1.1,
/// with M7 compiled in).
const ROWS: &[(Code, Group, u8)] = &[
    (Code::Rapid, Group::Motion, LINK),
    (Code::Linear, Group::Motion, LINK),
    (Code::Clockwise, Group::Motion, LINK),
    (Code::CounterClockwise, Group::Motion, LINK),
    (Code::ProbeMust, Group::Motion, MOST),
    (Code::Probe, Group::Motion, MOST),
    (Code::ProbeAwayMust, Group::Motion, MOST),
    (Code::ProbeAway, Group::Motion, MOST),
    (Code::CancelMotion, Group::Motion, MOST),
    (Code::Dwell, Group::NonModal, LINK),
    (Code::SetData, Group::NonModal, MOST),
    (Code::Home, Group::NonModal, LINK | DRILL),
    (Code::SecondHome, Group::NonModal, MOST),
    (Code::StoreHome, Group::NonModal, MOST),
    (Code::StoreSecondHome, Group::NonModal, MOST),
    (Code::MachineFrame, Group::NonModal, MOST),
    (Code::Shift, Group::NonModal, MOST | DRILL),
    (Code::CancelShift, Group::NonModal, MOST),
    (Code::PlaneXy, Group::Plane, MOST),
    (Code::PlaneZx, Group::Plane, MOST),
    (Code::PlaneYz, Group::Plane, MOST),
    (Code::Millimetres, Group::Units, MOST | DRILL),
    (Code::Inches, Group::Units, MOST | DRILL),
    (Code::G54, Group::System, LINK),
    (Code::G55, Group::System, MOST),
    (Code::G56, Group::System, MOST),
    (Code::G57, Group::System, MOST),
    (Code::G58, Group::System, MOST),
    (Code::G59, Group::System, MOST),
    (Code::ExactPath, Group::Path, MOST),
    (Code::Absolute, Group::Distance, LINK | DRILL),
    (Code::Incremental, Group::Distance, MOST | DRILL),
    (Code::IncrementalCentres, Group::CentreDistance, MOST),
    (Code::PerMinute, Group::FeedMode, MOST),
    (Code::InverseTime, Group::FeedMode, MOST),
    (Code::CancelCompensation, Group::Compensation, MOST),
    (Code::DirectToolLength, Group::ToolLength, MOST),
    (Code::CancelToolLength, Group::ToolLength, MOST),
    (Code::Stop, Group::Stop, MOST),
    (Code::OptionalStop, Group::Stop, MOST),
    (Code::End, Group::Stop, MOST),
    (Code::EndAndRewind, Group::Stop, LINK),
    (Code::SpindleOff, Group::Spindle, LINK),
    (Code::SpindleClockwise, Group::Spindle, LINK),
    (Code::SpindleCounterClockwise, Group::Spindle, LINK),
    (Code::ChangeTool, Group::Tool, BOTH | MICROMILL),
    (Code::Mist, Group::Coolant, MOST),
    (Code::Flood, Group::Coolant, MOST),
    (Code::CoolantOff, Group::Coolant, MOST),
    (Code::AbsoluteCentres, Group::CentreDistance, BOTH),
    (Code::Micrometres, Group::Units, NONE),
    (Code::ReturnToInitial, Group::Return, BOTH),
    (Code::RadiusMode, Group::Diameter, BOTH),
    (Code::Foreign, Group::NonModal, NONE),
    (Code::G59_1, Group::System, BOTH),
    (Code::G59_2, Group::System, BOTH),
    (Code::G59_3, Group::System, BOTH),
    (Code::Cubic, Group::Motion, MILLS),
    (Code::Quadratic, Group::Motion, MILLS),
    (Code::Thread, Group::Motion, BOTH),
    (Code::ChipBreakCycle, Group::Motion, BOTH),
    (Code::LeftTapCycle, Group::Motion, MILLS),
    (Code::ThreadCycle, Group::Motion, BOTH),
    (Code::DrillCycle, Group::Motion, BOTH),
    (Code::DrillDwellCycle, Group::Motion, BOTH),
    (Code::PeckCycle, Group::Motion, BOTH),
    (Code::TapCycle, Group::Motion, BOTH),
    (Code::BoreCycle, Group::Motion, BOTH),
    (Code::BoreStopCycle, Group::Motion, BOTH),
    (Code::BackBoreCycle, Group::Motion, BOTH),
    (Code::BoreManualCycle, Group::Motion, BOTH),
    (Code::BoreDwellCycle, Group::Motion, BOTH),
    (Code::TurnBoxCycle, Group::Motion, LATHES),
    (Code::ThreadBoxCycle, Group::Motion, LATHES),
    (Code::FaceBoxCycle, Group::Motion, LATHES),
    (Code::LathePeckCycle, Group::Motion, LATHES),
    (Code::G70, Group::Motion, LATHES),
    (Code::G71, Group::Motion, LATHES),
    (Code::G71_1, Group::Motion, LATHES),
    (Code::G71_2, Group::Motion, LATHES),
    (Code::G72, Group::Motion, LATHES),
    (Code::G72_1, Group::Motion, LATHES),
    (Code::G72_2, Group::Motion, LATHES),
    (Code::SuspendShift, Group::NonModal, BOTH),
    (Code::RestoreShift, Group::NonModal, BOTH),
    (Code::DiameterMode, Group::Diameter, BOTH),
    (Code::ExactStop, Group::Path, BOTH),
    (Code::Blend, Group::Path, BOTH),
    (Code::PerRevolution, Group::FeedMode, BOTH),
    (Code::CompensateLeft, Group::Compensation, BOTH),
    (Code::CompensateRight, Group::Compensation, BOTH),
    (Code::CompensateLeftDirect, Group::Compensation, BOTH),
    (Code::CompensateRightDirect, Group::Compensation, BOTH),
    (Code::ToolLength, Group::ToolLength, BOTH),
    (Code::ReturnToRetract, Group::Return, BOTH),
    (Code::SurfaceSpeed, Group::SpindleMode, BOTH),
    (Code::SpindleSpeed, Group::SpindleMode, BOTH),
    (Code::PalletStop, Group::Stop, BOTH),
    (Code::Orient, Group::Spindle, BOTH),
    (Code::SetTool, Group::Tool, BOTH),
    (Code::EnableOverrides, Group::Override, BOTH),
    (Code::DisableOverrides, Group::Override, BOTH),
    (Code::FeedOverride, Group::Override, BOTH),
    (Code::SpindleOverride, Group::Override, BOTH),
    (Code::AdaptiveFeed, Group::Override, BOTH),
    (Code::FeedHold, Group::Override, BOTH),
    (Code::OutputOnWithMotion, Group::Io, BOTH),
    (Code::OutputOffWithMotion, Group::Io, BOTH),
    (Code::OutputOn, Group::Io, BOTH),
    (Code::OutputOff, Group::Io, BOTH),
    (Code::WaitInput, Group::Io, BOTH),
    (Code::AnalogWithMotion, Group::Io, BOTH),
    (Code::Analog, Group::Io, BOTH),
    (Code::Nurbs, Group::Motion, MILLS),
    (Code::NurbsEnd, Group::Motion, MILLS),
    (Code::RigidTap, Group::Motion, BOTH),
    (Code::LocalShift, Group::NonModal, BOTH),
    (Code::SaveModes, Group::Override, NO_PRINTER),
    (Code::DropModes, Group::Override, NO_PRINTER),
    (Code::RestoreModes, Group::Override, NO_PRINTER),
    (Code::SaveModesOfCaller, Group::Override, NO_PRINTER),
    (Code::CallProgram, Group::Stop, NO_PRINTER),
    (Code::Return, Group::Stop, NO_PRINTER),
    (Code::HeatExtruder, Group::Io, PRINTER),
    (Code::HeatExtruderAndWait, Group::Io, PRINTER),
    (Code::HeatBed, Group::Io, PRINTER),
    (Code::HeatBedAndWait, Group::Io, PRINTER),
    (Code::HeatChamber, Group::Io, PRINTER),
    (Code::HeatChamberAndWait, Group::Io, PRINTER),
    (Code::Fan, Group::Io, PRINTER),
    (Code::FanOff, Group::Io, PRINTER),
    (Code::ExtruderAbsolute, Group::Io, PRINTER),
    (Code::ExtruderRelative, Group::Io, PRINTER),
    (Code::MotorsOff, Group::Io, PRINTER),
    (Code::Retract, Group::Io, PRINTER),
    (Code::Unretract, Group::Io, PRINTER),
];

/// How many of the rows are compiled in.
const KEPT: usize = if EXTENDED {
    ROWS.len()
} else {
    Code::Foreign as usize
};

/// The columns of the rows, one byte each.
static COLUMNS: ([Group; KEPT], [u8; KEPT]) = {
    let (mut groups, mut dialects) = ([Group::NonModal; KEPT], [NONE; KEPT]);
    let mut place = 0;
    while place < KEPT {
        assert!(ROWS[place].0 as usize == place + 1);
        (groups[place], dialects[place]) = (ROWS[place].1, ROWS[place].2);
        place += 1;
    }
    (groups, dialects)
};

/// The kinds of the canned cycles, in the order of their codes.
const KINDS: [Kind; 16] = [
    Kind::ChipBreak,
    Kind::LeftTap,
    Kind::Thread,
    Kind::Drill,
    Kind::DrillDwell,
    Kind::Peck,
    Kind::Tap,
    Kind::Bore,
    Kind::BoreStop,
    Kind::BackBore,
    Kind::BoreManual,
    Kind::BoreDwell,
    Kind::TurnBox,
    Kind::ThreadBox,
    Kind::FaceBox,
    Kind::LathePeck,
];

impl Code {
    pub(crate) fn group(self) -> Group {
        let group = COLUMNS.0.get(self.row()).copied();
        group.unwrap_or(Group::NonModal)
    }

    /// Whether a dialect has this code.
    pub(crate) fn is_in(self, flavour: Flavour) -> bool {
        let dialects = COLUMNS.1.get(self.row()).copied();
        dialects.unwrap_or(NONE).wrapping_shr(flavour as u32) & 1 != 0
    }

    /// The meaning of a code in dialects that do not have it: mills take the `G70` and `G71` of
    /// Mach3 and older controls as units.
    #[cold]
    pub(crate) const fn alias(self, flavour: Flavour) -> Option<Code> {
        match (self, flavour) {
            (Code::G70, Flavour::Rs274 | Flavour::Iso | Flavour::Printer) => Some(Code::Inches),
            (Code::G71, Flavour::Rs274 | Flavour::Iso | Flavour::Printer) => {
                Some(Code::Millimetres)
            }
            _ => None,
        }
    }

    /// Whether this code exists without the extended ones.
    pub(crate) const fn is_basic(self) -> bool {
        (self as u8) < Code::AbsoluteCentres as u8
    }

    /// The row of this code, in the width of an index: no instruction is spent on cutting it to
    /// eight bits.
    #[inline(always)]
    const fn row(self) -> usize {
        (self as usize).wrapping_sub(Code::Rapid as usize)
    }

    /// The distance of this code from an earlier one of a series; large for one before it.
    pub(crate) const fn since(self, first: Code) -> u8 {
        (self as u8).wrapping_sub(first as u8)
    }

    /// G0 to G3.
    pub(crate) const fn is_plain_move(self) -> bool {
        self as u8 <= Code::CounterClockwise as u8
    }

    /// G2 and G3.
    pub(crate) const fn is_arc(self) -> bool {
        matches!(self, Code::Clockwise | Code::CounterClockwise)
    }

    /// G38.2 to G38.5.
    pub(crate) const fn is_probe(self) -> bool {
        self.since(Code::ProbeMust) <= Code::ProbeAway.since(Code::ProbeMust)
    }

    /// For a probing code: whether it moves away from the contact, and whether missing it is an
    /// error.
    pub(crate) const fn probe(self) -> (bool, bool) {
        let way = self.since(Code::ProbeMust);
        (way & 2 != 0, way & 1 == 0)
    }

    /// For a cutting cycle along a contour: its number above G70 in tenths.
    pub(crate) const fn contour_cycle(self) -> Option<u8> {
        Some(match self {
            Code::G70 => 0,
            Code::G71 => 10,
            Code::G71_1 => 11,
            Code::G71_2 => 12,
            Code::G72 => 20,
            Code::G72_1 => 21,
            Code::G72_2 => 22,
            _ => return None,
        })
    }

    /// Whether the code needs the lines around its own: M70 to M73, M98, M99.
    #[cfg(feature = "extended")]
    pub(crate) const fn needs_program(self) -> bool {
        self.since(Code::SaveModes) <= Code::Return.since(Code::SaveModes)
    }

    /// Whether it is one of the codes that only printers have.
    #[cfg(feature = "extended")]
    pub(crate) const fn is_of_printer(self) -> bool {
        self.since(Code::HeatExtruder) <= Code::Unretract.since(Code::HeatExtruder)
    }

    /// A canned cycle.
    pub(crate) fn cycle(self) -> Option<Kind> {
        if !EXTENDED {
            return None;
        }
        KINDS
            .get(usize::from(self.since(Code::ChipBreakCycle)))
            .copied()
    }

    /// Letters other than the axes that this code uses, without those of arcs. F, S, T and N need
    /// no code.
    pub(crate) fn letters(self) -> Letters {
        match self {
            Code::Dwell => const { Letters::new(b"P") },
            Code::SetData => const { Letters::new(b"LPRIJQ") },
            _ if EXTENDED => self.letters_of_extended(),
            _ => Letters::NONE,
        }
    }

    fn letters_of_extended(self) -> Letters {
        match self {
            Code::Cubic => const { Letters::new(b"IJPQ") },
            Code::Quadratic => const { Letters::new(b"IJ") },
            Code::Thread | Code::RigidTap => const { Letters::new(b"K") },
            Code::Nurbs => const { Letters::new(b"PL") },
            Code::CallProgram => const { Letters::new(b"PL") },
            Code::Return => const { Letters::new(b"P") },
            Code::Blend => const { Letters::new(b"PQ") },
            Code::CompensateLeft
            | Code::CompensateRight
            | Code::CompensateLeftDirect
            | Code::CompensateRightDirect => const { Letters::new(b"D") },
            Code::ToolLength => const { Letters::new(b"H") },
            Code::SurfaceSpeed => const { Letters::new(b"D") },
            Code::Orient => const { Letters::new(b"RPQ") },
            Code::SetTool => const { Letters::new(b"Q") },
            Code::FeedOverride
            | Code::SpindleOverride
            | Code::AdaptiveFeed
            | Code::FeedHold
            | Code::OutputOnWithMotion
            | Code::OutputOffWithMotion
            | Code::OutputOn
            | Code::OutputOff => const { Letters::new(b"P") },
            Code::HeatExtruderAndWait | Code::HeatBedAndWait | Code::HeatChamberAndWait => {
                const { Letters::new(b"R") }
            }
            Code::Fan | Code::FanOff => const { Letters::new(b"P") },
            Code::WaitInput => const { Letters::new(b"PELQ") },
            Code::Analog | Code::AnalogWithMotion => const { Letters::new(b"EQ") },
            _ => self.cycle().map_or(Letters::NONE, Kind::letters),
        }
    }

    /// Whether the code uses the axis words of the block.
    pub(crate) const fn covets_axes(self) -> bool {
        matches!(
            self,
            Code::Home | Code::SecondHome | Code::Shift | Code::SetData | Code::DirectToolLength
        ) || EXTENDED && matches!(self, Code::LocalShift)
    }
}

#[cfg(all(test, feature = "extended"))]
mod tests {
    use super::*;

    #[test]
    fn dialects_have_their_codes() {
        let has = |letter, tenths, flavour| {
            Code::read(letter, tenths, flavour).is_some_and(|code| code.is_in(flavour))
        };
        assert!(has(b'G', 810, Flavour::Rs274) && !has(b'G', 810, Flavour::Grbl));
        assert!(has(b'G', 382, Flavour::Grbl) && !has(b'G', 901, Flavour::Grbl));
        assert!(!has(b'M', 60, Flavour::Grbl) && has(b'M', 60, Flavour::Rs274));
        assert!(has(b'G', 770, Flavour::Lathe) && !has(b'G', 770, Flavour::Rs274));
        assert_eq!(Code::read(b'G', 330, Flavour::LatheA), Some(Code::Foreign));
        assert_eq!(
            Code::read(b'G', 980, Flavour::LatheA),
            Some(Code::PerMinute)
        );
        for tenths in [0, 10, 11, 12, 20, 21, 22] {
            let code = Code::read(b'G', 700 + u16::from(tenths), Flavour::Lathe);
            assert_eq!(code.and_then(Code::contour_cycle), Some(tenths));
        }
        assert_eq!(Code::read(b'G', 999, Flavour::Rs274), None);
    }

    #[test]
    fn cycles_have_their_kinds() {
        assert_eq!(Code::DrillCycle.cycle(), Some(Kind::Drill));
        assert_eq!(Code::LathePeckCycle.cycle(), Some(Kind::LathePeck));
        assert_eq!((Code::G70.cycle(), Code::Thread.cycle()), (None, None));
    }
}
