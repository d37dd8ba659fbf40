//! The numbers of codes.

use crate::arc::Plane;
use crate::code::{Code, EXTENDED, Side};
use crate::kind::Kind;

/// G codes by their number in tenths, in order, with the meaning they have in most dialects. What no dialect here has (NURBS,
/// plain plane joins, rigid tapping, local zeros, mirror, rotation, scaling, macros, ...) is foreign.
static G: [(u16, Code); 110] = kept([
    (0, Code::Rapid),
    (10, Code::Linear),
    (20, Code::Clockwise),
    (30, Code::CounterClockwise),
    (40, Code::Dwell),
    (50, Code::Cubic),
    (51, Code::Quadratic),
    (52, Code::Foreign),
    (53, Code::Foreign),
    (60, Code::Foreign),
    (62, Code::Foreign),
    (70, Code::Diameter(true)),
    (80, Code::Diameter(false)),
    (90, Code::Foreign),
    (100, Code::SetData),
    (150, Code::Foreign),
    (160, Code::Foreign),
    (170, Code::Plane(Plane::Xy)),
    (180, Code::Plane(Plane::Zx)),
    (190, Code::Plane(Plane::Yz)),
    (200, Code::Inches),
    (210, Code::Millimetres),
    (270, Code::Foreign),
    (280, Code::Home(0)),
    (281, Code::StoreHome(0)),
    (282, Code::Foreign),
    (283, Code::Foreign),
    (290, Code::Foreign),
    (300, Code::Home(1)),
    (301, Code::StoreHome(1)),
    (310, Code::Foreign),
    (330, Code::Thread),
    (331, Code::Foreign),
    (382, probe(false, true)),
    (383, probe(false, false)),
    (384, probe(true, true)),
    (385, probe(true, false)),
    (400, Code::CancelCompensation),
    (410, compensate(Side::Left, false)),
    (411, compensate(Side::Left, true)),
    (420, compensate(Side::Right, false)),
    (421, compensate(Side::Right, true)),
    (430, Code::ToolLength),
    (431, Code::DirectToolLength),
    (432, Code::Foreign),
    (490, Code::CancelToolLength),
    (500, Code::Foreign),
    (510, Code::Foreign),
    (520, Code::Foreign),
    (530, Code::MachineFrame),
    (540, Code::System(0)),
    (541, Code::Foreign),
    (550, Code::System(1)),
    (560, Code::System(2)),
    (570, Code::System(3)),
    (580, Code::System(4)),
    (590, Code::System(5)),
    (591, Code::System(6)),
    (592, Code::System(7)),
    (593, Code::System(8)),
    (600, Code::Foreign),
    (610, Code::ExactPath),
    (611, Code::ExactStop),
    (620, Code::Foreign),
    (630, Code::Foreign),
    (640, Code::Blend),
    (650, Code::Foreign),
    (660, Code::Foreign),
    (670, Code::Foreign),
    (680, Code::Foreign),
    (690, Code::Foreign),
    (700, Code::ContourCycle(0)),
    (710, Code::ContourCycle(10)),
    (711, Code::ContourCycle(11)),
    (712, Code::ContourCycle(12)),
    (720, Code::ContourCycle(20)),
    (721, Code::ContourCycle(21)),
    (722, Code::ContourCycle(22)),
    (730, Code::Cycle(Kind::ChipBreak)),
    (740, Code::Cycle(Kind::LeftTap)),
    (750, Code::Foreign),
    (760, Code::Cycle(Kind::Thread)),
    (770, Code::Cycle(Kind::TurnBox)),
    (780, Code::Cycle(Kind::ThreadBox)),
    (790, Code::Cycle(Kind::FaceBox)),
    (800, Code::CancelMotion),
    (810, Code::Cycle(Kind::Drill)),
    (820, Code::Cycle(Kind::DrillDwell)),
    (830, Code::Cycle(Kind::Peck)),
    (840, Code::Cycle(Kind::Tap)),
    (850, Code::Cycle(Kind::Bore)),
    (860, Code::Cycle(Kind::BoreStop)),
    (870, Code::Cycle(Kind::BackBore)),
    (880, Code::Cycle(Kind::BoreManual)),
    (890, Code::Cycle(Kind::BoreDwell)),
    (900, Code::Absolute),
    (901, Code::AbsoluteCentres),
    (910, Code::Incremental),
    (911, Code::IncrementalCentres),
    (920, Code::Shift),
    (921, Code::CancelShift),
    (922, Code::SuspendShift),
    (923, Code::RestoreShift),
    (930, Code::InverseTime),
    (940, Code::PerMinute),
    (950, Code::PerRevolution),
    (960, Code::SurfaceSpeed),
    (970, Code::SpindleSpeed),
    (980, Code::ReturnToInitial),
    (990, Code::ReturnToRetract),
]);

/// M codes by their number in tenths, in order. Clamps, tapping modes, parking, saved modes and subprograms are foreign.
static M: [(u16, Code); 37] = kept([
    (0, Code::Stop),
    (10, Code::OptionalStop),
    (20, Code::End),
    (30, Code::SpindleClockwise),
    (40, Code::SpindleCounterClockwise),
    (50, Code::SpindleOff),
    (60, Code::ChangeTool),
    (70, Code::Mist),
    (80, Code::Flood),
    (90, Code::CoolantOff),
    (100, Code::Foreign),
    (110, Code::Foreign),
    (190, Code::Orient),
    (290, Code::Foreign),
    (300, Code::EndAndRewind),
    (480, Code::EnableOverrides(true)),
    (490, Code::EnableOverrides(false)),
    (500, Code::FeedOverride),
    (510, Code::SpindleOverride),
    (520, Code::AdaptiveFeed),
    (530, Code::FeedHold),
    (560, Code::Foreign),
    (600, Code::PalletStop),
    (610, Code::SetTool),
    (620, output(true, true)),
    (630, output(false, true)),
    (640, output(true, false)),
    (650, output(false, false)),
    (660, Code::WaitInput),
    (670, Code::Analog { with_motion: true }),
    (680, Code::Analog { with_motion: false }),
    (700, Code::Foreign),
    (710, Code::Foreign),
    (720, Code::Foreign),
    (730, Code::Foreign),
    (980, Code::Foreign),
    (990, Code::Foreign),
]);

/// Without the codes that are compiled out: they are known, and of no dialect.
const fn kept<const COUNT: usize>(mut codes: [(u16, Code); COUNT]) -> [(u16, Code); COUNT] {
    let mut place = 0;
    while place < COUNT {
        let (_, code) = &mut codes[place];
        if !EXTENDED && !code.is_basic() {
            *code = Code::Foreign;
        }
        place += 1;
    }
    codes
}

/// The code of a letter (`G` or `M`) and a number in tenths; `None` for one nobody knows.
pub(crate) fn of_number(letter: u8, tenths: u16) -> Option<Code> {
    let codes: &[(u16, Code)] = if letter == b'M' { &M } else { &G };
    let place = codes
        .binary_search_by_key(&tenths, |&(number, _)| number)
        .ok()?;
    codes.get(place).map(|&(_, code)| code)
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
    fn numbers_are_in_order() {
        assert!(G.is_sorted_by(|a, b| a.0 < b.0) && M.is_sorted_by(|a, b| a.0 < b.0));
        assert_eq!(of_number(b'G', 20), Some(Code::Clockwise));
        assert_eq!(of_number(b'M', 20), Some(Code::End));
        assert_eq!(of_number(b'G', 11), None);
    }
}
