//! The G and M codes of the list, their modal groups, and the dialects that have them.

use crate::arc::Plane;
use crate::block::Letters;
use crate::dialect::Flavour;
use crate::kind::Kind;
use crate::number::of_number;

/// The side of the contour on which the tool is, seen along the move.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub enum Side {
    /// G41.
    Left,
    /// G42.
    Right,
}

/// One code of the list, by what it does.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(crate) enum Code {
    Rapid,
    Linear,
    Clockwise,
    CounterClockwise,
    /// G5.
    Cubic,
    /// G5.1.
    Quadratic,
    /// G33.
    Thread,
    /// G38.2 to G38.5: away from the contact, and whether missing it is an error.
    Probe {
        away: bool,
        must: bool,
    },
    Cycle(Kind),
    /// G70 to G72 and their variants, in tenths above G70: they cut a contour of several blocks.
    ContourCycle(u8),
    CancelMotion,
    Dwell,
    /// G10.
    SetData,
    /// G28 and G30: 0 and 1.
    Home(u8),
    /// G28.1 and G30.1.
    StoreHome(u8),
    MachineFrame,
    Shift,
    CancelShift,
    SuspendShift,
    RestoreShift,
    Plane(Plane),
    Inches,
    Millimetres,
    Diameter(bool),
    /// G54 to G59.3: 0 to 8.
    System(u8),
    ExactPath,
    ExactStop,
    Blend,
    Absolute,
    Incremental,
    AbsoluteCentres,
    IncrementalCentres,
    InverseTime,
    PerMinute,
    PerRevolution,
    CancelCompensation,
    /// G41, G42; direct (G41.1, G42.1) with a diameter.
    Compensate {
        side: Side,
        direct: bool,
    },
    ToolLength,
    DirectToolLength,
    CancelToolLength,
    /// G98, G99.
    ReturnToInitial,
    ReturnToRetract,
    SurfaceSpeed,
    SpindleSpeed,
    Stop,
    OptionalStop,
    End,
    EndAndRewind,
    PalletStop,
    SpindleClockwise,
    SpindleCounterClockwise,
    SpindleOff,
    Orient,
    ChangeTool,
    SetTool,
    Mist,
    Flood,
    CoolantOff,
    /// M48 to M53.
    EnableOverrides(bool),
    FeedOverride,
    SpindleOverride,
    AdaptiveFeed,
    FeedHold,
    /// M62 to M65: on, and with the next motion.
    Output {
        on: bool,
        with_motion: bool,
    },
    WaitInput,
    /// M67, M68.
    Analog {
        with_motion: bool,
    },
    /// Known from other controllers, in no dialect here.
    Foreign,
}

/// The modal groups: of each, a block has at most one code.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(crate) enum Group {
    NonModal,
    Motion,
    Plane,
    Distance,
    CentreDistance,
    FeedMode,
    Units,
    Compensation,
    ToolLength,
    Return,
    System,
    Path,
    SpindleMode,
    Diameter,
    Stop,
    Tool,
    Spindle,
    Coolant,
    Override,
    Io,
}

/// Whether the codes beyond Grbl's list are there.
pub(crate) const EXTENDED: bool = cfg!(feature = "extended");

impl Group {
    pub(crate) const COUNT: usize = 20;
}

impl Code {
    /// The code of a letter (`G` or `M`) and a number in tenths, as a dialect means it; `None` for one nobody knows.
    pub(crate) fn read(letter: u8, tenths: u16, flavour: Flavour) -> Option<Code> {
        let lathe = EXTENDED && matches!(flavour, Flavour::Lathe | Flavour::LatheA);
        if !lathe || letter == b'M' {
            return of_number(letter, tenths);
        }
        match (flavour, tenths) {
            (_, 740) => Some(Code::Cycle(Kind::LathePeck)),
            // Code system A of turning machines.
            (Flavour::LatheA, 900) => Some(Code::Cycle(Kind::TurnBox)),
            (Flavour::LatheA, 920) => Some(Code::Cycle(Kind::ThreadBox)),
            (Flavour::LatheA, 940) => Some(Code::Cycle(Kind::FaceBox)),
            (Flavour::LatheA, 980) => Some(Code::PerMinute),
            (Flavour::LatheA, 990) => Some(Code::PerRevolution),
            // Shift of the work frame, which G92 is not there.
            (Flavour::LatheA, 500) => Some(Code::Shift),
            (Flavour::LatheA, 320) => Some(Code::Thread),
            (
                Flavour::LatheA,
                770 | 780 | 790 | 910 | 921 | 922 | 923 | 930 | 950 | 330 | 70 | 80,
            ) => Some(Code::Foreign),
            _ => of_number(letter, tenths),
        }
    }

    pub(crate) const fn group(self) -> Group {
        match self {
            Code::Rapid
            | Code::Linear
            | Code::Clockwise
            | Code::CounterClockwise
            | Code::Cubic
            | Code::Quadratic
            | Code::Thread
            | Code::Probe { .. }
            | Code::Cycle(_)
            | Code::ContourCycle(_)
            | Code::CancelMotion => Group::Motion,
            Code::Dwell
            | Code::SetData
            | Code::Home(_)
            | Code::StoreHome(_)
            | Code::MachineFrame
            | Code::Shift
            | Code::CancelShift
            | Code::SuspendShift
            | Code::RestoreShift
            | Code::Foreign => Group::NonModal,
            Code::Plane(_) => Group::Plane,
            Code::Inches | Code::Millimetres => Group::Units,
            Code::Diameter(_) => Group::Diameter,
            Code::System(_) => Group::System,
            Code::ExactPath | Code::ExactStop | Code::Blend => Group::Path,
            Code::Absolute | Code::Incremental => Group::Distance,
            Code::AbsoluteCentres | Code::IncrementalCentres => Group::CentreDistance,
            Code::InverseTime | Code::PerMinute | Code::PerRevolution => Group::FeedMode,
            Code::CancelCompensation | Code::Compensate { .. } => Group::Compensation,
            Code::ToolLength | Code::DirectToolLength | Code::CancelToolLength => Group::ToolLength,
            Code::ReturnToInitial | Code::ReturnToRetract => Group::Return,
            Code::SurfaceSpeed | Code::SpindleSpeed => Group::SpindleMode,
            Code::Stop | Code::OptionalStop | Code::End | Code::EndAndRewind | Code::PalletStop => {
                Group::Stop
            }
            Code::SpindleClockwise
            | Code::SpindleCounterClockwise
            | Code::SpindleOff
            | Code::Orient => Group::Spindle,
            Code::ChangeTool | Code::SetTool => Group::Tool,
            Code::Mist | Code::Flood | Code::CoolantOff => Group::Coolant,
            Code::EnableOverrides(_)
            | Code::FeedOverride
            | Code::SpindleOverride
            | Code::AdaptiveFeed
            | Code::FeedHold => Group::Override,
            Code::Output { .. } | Code::WaitInput | Code::Analog { .. } => Group::Io,
        }
    }

    /// Whether a dialect has this code.
    pub(crate) const fn is_in(self, flavour: Flavour) -> bool {
        match flavour {
            Flavour::Rs274 | Flavour::Printer | Flavour::Iso => !matches!(
                self,
                Code::Foreign
                    | Code::Cycle(
                        Kind::TurnBox | Kind::ThreadBox | Kind::FaceBox | Kind::LathePeck
                    )
                    | Code::ContourCycle(_)
            ),
            Flavour::Lathe | Flavour::LatheA => !matches!(
                self,
                Code::Foreign | Code::Cycle(Kind::LeftTap) | Code::Cubic | Code::Quadratic
            ),
            Flavour::Grbl => self.in_grbl(),
            Flavour::Micromill => self.in_micromill(),
            Flavour::Drill => matches!(
                self,
                Code::Inches
                    | Code::Millimetres
                    | Code::Home(0)
                    | Code::Absolute
                    | Code::Incremental
                    | Code::Shift
            ),
        }
    }

    /// Whether this code is there without the extended ones.
    pub(crate) const fn is_basic(self) -> bool {
        self.in_grbl() || self.in_micromill()
    }

    /// Whether the micromill's link protocol has this code.
    const fn in_micromill(self) -> bool {
        matches!(
            self,
            Code::Rapid
                | Code::Linear
                | Code::Clockwise
                | Code::CounterClockwise
                | Code::Dwell
                | Code::Home(0)
                | Code::System(0)
                | Code::Absolute
                | Code::SpindleClockwise
                | Code::SpindleCounterClockwise
                | Code::SpindleOff
                | Code::ChangeTool
                | Code::EndAndRewind
        )
    }

    /// Whether Grbl 1.1 has this code (its `gcode.c`, with M7 compiled in).
    const fn in_grbl(self) -> bool {
        matches!(
            self,
            Code::Rapid
                | Code::Linear
                | Code::Clockwise
                | Code::CounterClockwise
                | Code::Probe { .. }
                | Code::CancelMotion
                | Code::Dwell
                | Code::SetData
                | Code::Home(_)
                | Code::StoreHome(_)
                | Code::MachineFrame
                | Code::Shift
                | Code::CancelShift
                | Code::Plane(_)
                | Code::Inches
                | Code::Millimetres
                | Code::System(0..=5)
                | Code::ExactPath
                | Code::Absolute
                | Code::Incremental
                | Code::IncrementalCentres
                | Code::InverseTime
                | Code::PerMinute
                | Code::CancelCompensation
                | Code::DirectToolLength
                | Code::CancelToolLength
                | Code::Stop
                | Code::OptionalStop
                | Code::End
                | Code::EndAndRewind
                | Code::SpindleClockwise
                | Code::SpindleCounterClockwise
                | Code::SpindleOff
                | Code::Mist
                | Code::Flood
                | Code::CoolantOff
        )
    }

    /// Letters beside the axes that this code uses, without those of arcs; F, S, T and N need no code.
    pub(crate) const fn letters(self) -> Letters {
        match self {
            Code::Dwell => const { Letters::new(b"P") },
            Code::SetData => const { Letters::new(b"LPRIJQ") },
            Code::Cubic => const { Letters::new(b"IJPQ") },
            Code::Quadratic => const { Letters::new(b"IJ") },
            Code::Thread => const { Letters::new(b"K") },
            Code::Blend => const { Letters::new(b"PQ") },
            Code::Compensate { .. } => const { Letters::new(b"D") },
            Code::ToolLength => const { Letters::new(b"H") },
            Code::SurfaceSpeed => const { Letters::new(b"D") },
            Code::Orient => const { Letters::new(b"RPQ") },
            Code::SetTool => const { Letters::new(b"Q") },
            Code::FeedOverride
            | Code::SpindleOverride
            | Code::AdaptiveFeed
            | Code::FeedHold
            | Code::Output { .. } => const { Letters::new(b"P") },
            Code::WaitInput => const { Letters::new(b"PELQ") },
            Code::Analog { .. } => const { Letters::new(b"EQ") },
            Code::Cycle(kind) => kind.letters(),
            _ => Letters::NONE,
        }
    }

    /// Whether the code wants the axis words of the block for itself.
    pub(crate) const fn covets_axes(self) -> bool {
        matches!(
            self,
            Code::Home(_) | Code::Shift | Code::SetData | Code::DirectToolLength
        )
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
        assert_eq!(Code::read(b'G', 999, Flavour::Rs274), None);
    }
}
