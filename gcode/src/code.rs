//! The G and M codes of the list, their modal groups, and the dialects that have them.

use crate::arc::Plane;
use crate::dialect::Flavour;
use crate::kind::Kind;

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
    /// G70 to G72: they cut a contour of several blocks.
    ContourCycle,
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
    /// The G code of this number in tenths, with the meaning it has in most dialects.
    const fn g(tenths: u16) -> Option<Code> {
        Some(match tenths {
            0 => Code::Rapid,
            10 => Code::Linear,
            20 => Code::Clockwise,
            30 => Code::CounterClockwise,
            40 => Code::Dwell,
            50 => Code::Cubic,
            51 => Code::Quadratic,
            70 => Code::Diameter(true),
            80 => Code::Diameter(false),
            100 => Code::SetData,
            170 => Code::Plane(Plane::Xy),
            180 => Code::Plane(Plane::Zx),
            190 => Code::Plane(Plane::Yz),
            200 => Code::Inches,
            210 => Code::Millimetres,
            280 => Code::Home(0),
            281 => Code::StoreHome(0),
            300 => Code::Home(1),
            301 => Code::StoreHome(1),
            330 => Code::Thread,
            382 => probe(false, true),
            383 => probe(false, false),
            384 => probe(true, true),
            385 => probe(true, false),
            400 => Code::CancelCompensation,
            410 => compensate(Side::Left, false),
            411 => compensate(Side::Left, true),
            420 => compensate(Side::Right, false),
            421 => compensate(Side::Right, true),
            430 => Code::ToolLength,
            431 => Code::DirectToolLength,
            490 => Code::CancelToolLength,
            530 => Code::MachineFrame,
            540 => Code::System(0),
            550 => Code::System(1),
            560 => Code::System(2),
            570 => Code::System(3),
            580 => Code::System(4),
            590 => Code::System(5),
            591 => Code::System(6),
            592 => Code::System(7),
            593 => Code::System(8),
            610 => Code::ExactPath,
            611 => Code::ExactStop,
            640 => Code::Blend,
            700 | 710 | 711 | 712 | 720 | 721 | 722 => Code::ContourCycle,
            730 => Code::Cycle(Kind::ChipBreak),
            740 => Code::Cycle(Kind::LeftTap),
            760 => Code::Cycle(Kind::Thread),
            770 => Code::Cycle(Kind::TurnBox),
            780 => Code::Cycle(Kind::ThreadBox),
            790 => Code::Cycle(Kind::FaceBox),
            800 => Code::CancelMotion,
            810 => Code::Cycle(Kind::Drill),
            820 => Code::Cycle(Kind::DrillDwell),
            830 => Code::Cycle(Kind::Peck),
            840 => Code::Cycle(Kind::Tap),
            850 => Code::Cycle(Kind::Bore),
            860 => Code::Cycle(Kind::BoreStop),
            870 => Code::Cycle(Kind::BackBore),
            880 => Code::Cycle(Kind::BoreManual),
            890 => Code::Cycle(Kind::BoreDwell),
            900 => Code::Absolute,
            901 => Code::AbsoluteCentres,
            910 => Code::Incremental,
            911 => Code::IncrementalCentres,
            920 => Code::Shift,
            921 => Code::CancelShift,
            922 => Code::SuspendShift,
            923 => Code::RestoreShift,
            930 => Code::InverseTime,
            940 => Code::PerMinute,
            950 => Code::PerRevolution,
            960 => Code::SurfaceSpeed,
            970 => Code::SpindleSpeed,
            980 => Code::ReturnToInitial,
            990 => Code::ReturnToRetract,
            // NURBS, plain plane joins, rigid tapping, local zeros, mirror, rotation, scaling, macros, ...
            52 | 53 | 60 | 62 | 90 | 150 | 160 | 270 | 282 | 283 | 290 | 310 | 331 | 432 | 500
            | 510 | 520 | 541 | 600 | 620 | 630 | 650 | 660 | 670 | 680 | 690 | 750 => {
                Code::Foreign
            }
            _ => return None,
        })
    }

    /// The M code of this number in tenths.
    const fn m(tenths: u16) -> Option<Code> {
        Some(match tenths {
            0 => Code::Stop,
            10 => Code::OptionalStop,
            20 => Code::End,
            30 => Code::SpindleClockwise,
            40 => Code::SpindleCounterClockwise,
            50 => Code::SpindleOff,
            60 => Code::ChangeTool,
            70 => Code::Mist,
            80 => Code::Flood,
            90 => Code::CoolantOff,
            190 => Code::Orient,
            300 => Code::EndAndRewind,
            480 => Code::EnableOverrides(true),
            490 => Code::EnableOverrides(false),
            500 => Code::FeedOverride,
            510 => Code::SpindleOverride,
            520 => Code::AdaptiveFeed,
            530 => Code::FeedHold,
            600 => Code::PalletStop,
            610 => Code::SetTool,
            620 => output(true, true),
            630 => output(false, true),
            640 => output(true, false),
            650 => output(false, false),
            660 => Code::WaitInput,
            670 => Code::Analog { with_motion: true },
            680 => Code::Analog { with_motion: false },
            // Clamps, tapping modes, parking, saved modes, subprograms.
            100 | 110 | 290 | 560 | 700 | 710 | 720 | 730 | 980 | 990 => Code::Foreign,
            _ => return None,
        })
    }

    /// The code of a letter (`G` or `M`) and a number in tenths, as a dialect means it; `None` for one nobody knows.
    pub(crate) const fn read(letter: u8, tenths: u16, flavour: Flavour) -> Option<Code> {
        match Code::meaning(letter, tenths, flavour) {
            Some(code) if !EXTENDED && !code.in_grbl() && !code.in_micromill() => {
                Some(Code::Foreign)
            }
            code => code,
        }
    }

    const fn meaning(letter: u8, tenths: u16, flavour: Flavour) -> Option<Code> {
        if letter == b'M' {
            return Code::m(tenths);
        }
        match (flavour, tenths) {
            (Flavour::Lathe | Flavour::LatheA, 740) => Some(Code::Cycle(Kind::LathePeck)),
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
            _ => Code::g(tenths),
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
            | Code::ContourCycle
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
            Flavour::Rs274 | Flavour::Iso => !matches!(
                self,
                Code::Foreign
                    | Code::Cycle(
                        Kind::TurnBox | Kind::ThreadBox | Kind::FaceBox | Kind::LathePeck
                    )
                    | Code::ContourCycle
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
    pub(crate) const fn letters(self) -> &'static [u8] {
        match self {
            Code::Dwell => b"P",
            Code::SetData => b"LPRIJQ",
            Code::Cubic => b"IJPQ",
            Code::Quadratic => b"IJ",
            Code::Thread => b"K",
            Code::Blend => b"PQ",
            Code::Compensate { .. } => b"D",
            Code::ToolLength => b"H",
            Code::SurfaceSpeed => b"D",
            Code::Orient => b"RPQ",
            Code::SetTool => b"Q",
            Code::FeedOverride
            | Code::SpindleOverride
            | Code::AdaptiveFeed
            | Code::FeedHold
            | Code::Output { .. } => b"P",
            Code::WaitInput => b"PELQ",
            Code::Analog { .. } => b"EQ",
            Code::Cycle(kind) => kind.letters(),
            _ => b"",
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

const fn probe(away: bool, must: bool) -> Code {
    Code::Probe { away, must }
}

const fn compensate(side: Side, direct: bool) -> Code {
    Code::Compensate { side, direct }
}

const fn output(on: bool, with_motion: bool) -> Code {
    Code::Output { on, with_motion }
}

#[cfg(test)]
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
