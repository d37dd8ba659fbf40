//! The G and M codes of the list, and their modal groups.

/// One code of the list, by what it does.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(crate) enum Code {
    Rapid,
    Linear,
    Clockwise,
    CounterClockwise,
    CancelMotion,
    Dwell,
    Home,
    StoreHome,
    MachineFrame,
    Shift,
    CancelShift,
    PlaneXy,
    PlaneZx,
    PlaneYz,
    Inches,
    Millimetres,
    /// G54 to G59: 0 to 5.
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
    Stop,
    OptionalStop,
    End,
    EndAndRewind,
    SpindleClockwise,
    SpindleCounterClockwise,
    SpindleOff,
    ChangeTool,
    Mist,
    Flood,
    CoolantOff,
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
    System,
    Path,
    Stop,
    Tool,
    Spindle,
    Coolant,
}

impl Group {
    pub(crate) const COUNT: usize = 13;
}

impl Code {
    /// The G code of this number in tenths.
    pub(crate) const fn g(tenths: u16) -> Option<Code> {
        Some(match tenths {
            0 => Code::Rapid,
            10 => Code::Linear,
            20 => Code::Clockwise,
            30 => Code::CounterClockwise,
            40 => Code::Dwell,
            170 => Code::PlaneXy,
            180 => Code::PlaneZx,
            190 => Code::PlaneYz,
            200 => Code::Inches,
            210 => Code::Millimetres,
            280 => Code::Home,
            281 => Code::StoreHome,
            530 => Code::MachineFrame,
            540 => Code::System(0),
            550 => Code::System(1),
            560 => Code::System(2),
            570 => Code::System(3),
            580 => Code::System(4),
            590 => Code::System(5),
            610 => Code::ExactPath,
            611 => Code::ExactStop,
            640 => Code::Blend,
            800 => Code::CancelMotion,
            900 => Code::Absolute,
            901 => Code::AbsoluteCentres,
            910 => Code::Incremental,
            911 => Code::IncrementalCentres,
            920 => Code::Shift,
            921 => Code::CancelShift,
            930 => Code::InverseTime,
            940 => Code::PerMinute,
            _ => return None,
        })
    }

    /// The M code of this number in tenths.
    pub(crate) const fn m(tenths: u16) -> Option<Code> {
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
            300 => Code::EndAndRewind,
            _ => return None,
        })
    }

    pub(crate) const fn group(self) -> Group {
        match self {
            Code::Rapid
            | Code::Linear
            | Code::Clockwise
            | Code::CounterClockwise
            | Code::CancelMotion => Group::Motion,
            Code::Dwell
            | Code::Home
            | Code::StoreHome
            | Code::MachineFrame
            | Code::Shift
            | Code::CancelShift => Group::NonModal,
            Code::PlaneXy | Code::PlaneZx | Code::PlaneYz => Group::Plane,
            Code::Inches | Code::Millimetres => Group::Units,
            Code::System(_) => Group::System,
            Code::ExactPath | Code::ExactStop | Code::Blend => Group::Path,
            Code::Absolute | Code::Incremental => Group::Distance,
            Code::AbsoluteCentres | Code::IncrementalCentres => Group::CentreDistance,
            Code::InverseTime | Code::PerMinute => Group::FeedMode,
            Code::Stop | Code::OptionalStop | Code::End | Code::EndAndRewind => Group::Stop,
            Code::SpindleClockwise | Code::SpindleCounterClockwise | Code::SpindleOff => {
                Group::Spindle
            }
            Code::ChangeTool => Group::Tool,
            Code::Mist | Code::Flood | Code::CoolantOff => Group::Coolant,
        }
    }

    /// Whether the micromill's link protocol has this code.
    pub(crate) const fn in_micromill(self) -> bool {
        matches!(
            self,
            Code::Rapid
                | Code::Linear
                | Code::Clockwise
                | Code::CounterClockwise
                | Code::Dwell
                | Code::Home
                | Code::System(0)
                | Code::Absolute
                | Code::SpindleClockwise
                | Code::SpindleCounterClockwise
                | Code::SpindleOff
                | Code::ChangeTool
                | Code::EndAndRewind
        )
    }
}
