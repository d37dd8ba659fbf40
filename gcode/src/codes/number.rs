//! The numbers of codes.

use crate::codes::code::Code;
use crate::codes::dialect::Flavour;
use crate::features::EXTENDED;

/// G codes by their number in tenths, in order, with their meaning in most dialects. Codes of no
/// dialect here (plane joins, mirror, scaling, macros, ...) are foreign.
const G: [(u16, Code); 110] = [
    (0, Code::Rapid),
    (10, Code::Linear),
    (20, Code::Clockwise),
    (30, Code::CounterClockwise),
    (40, Code::Dwell),
    (50, Code::Cubic),
    (51, Code::Quadratic),
    (52, Code::Nurbs),
    (53, Code::NurbsEnd),
    (60, Code::Foreign),
    (62, Code::Foreign),
    (70, Code::DiameterMode),
    (80, Code::RadiusMode),
    (90, Code::Foreign),
    (100, Code::SetData),
    (150, Code::Foreign),
    (160, Code::Foreign),
    (170, Code::PlaneXy),
    (180, Code::PlaneZx),
    (190, Code::PlaneYz),
    (200, Code::Inches),
    (210, Code::Millimetres),
    (270, Code::Foreign),
    (280, Code::Home),
    (281, Code::StoreHome),
    (282, Code::Foreign),
    (283, Code::Foreign),
    (290, Code::Foreign),
    (300, Code::SecondHome),
    (301, Code::StoreSecondHome),
    (310, Code::Foreign),
    (330, Code::Thread),
    (331, Code::RigidTap),
    (382, Code::ProbeMust),
    (383, Code::Probe),
    (384, Code::ProbeAwayMust),
    (385, Code::ProbeAway),
    (400, Code::CancelCompensation),
    (410, Code::CompensateLeft),
    (411, Code::CompensateLeftDirect),
    (420, Code::CompensateRight),
    (421, Code::CompensateRightDirect),
    (430, Code::ToolLength),
    (431, Code::DirectToolLength),
    (432, Code::Foreign),
    (490, Code::CancelToolLength),
    (500, Code::Foreign),
    (510, Code::Foreign),
    (520, Code::LocalShift),
    (530, Code::MachineFrame),
    (540, Code::G54),
    (541, Code::Foreign),
    (550, Code::G55),
    (560, Code::G56),
    (570, Code::G57),
    (580, Code::G58),
    (590, Code::G59),
    (591, Code::G59_1),
    (592, Code::G59_2),
    (593, Code::G59_3),
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
    (700, Code::G70),
    (710, Code::G71),
    (711, Code::G71_1),
    (712, Code::G71_2),
    (720, Code::G72),
    (721, Code::G72_1),
    (722, Code::G72_2),
    (730, Code::ChipBreakCycle),
    (740, Code::LeftTapCycle),
    (750, Code::Foreign),
    (760, Code::ThreadCycle),
    (770, Code::TurnBoxCycle),
    (780, Code::ThreadBoxCycle),
    (790, Code::FaceBoxCycle),
    (800, Code::CancelMotion),
    (810, Code::DrillCycle),
    (820, Code::DrillDwellCycle),
    (830, Code::PeckCycle),
    (840, Code::TapCycle),
    (850, Code::BoreCycle),
    (860, Code::BoreStopCycle),
    (870, Code::BackBoreCycle),
    (880, Code::BoreManualCycle),
    (890, Code::BoreDwellCycle),
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
];

/// M codes by their number in tenths, in order. Clamps, tapping modes and parking are foreign.
const M: [(u16, Code); 37] = [
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
    (480, Code::EnableOverrides),
    (490, Code::DisableOverrides),
    (500, Code::FeedOverride),
    (510, Code::SpindleOverride),
    (520, Code::AdaptiveFeed),
    (530, Code::FeedHold),
    (560, Code::Foreign),
    (600, Code::PalletStop),
    (610, Code::SetTool),
    (620, Code::OutputOnWithMotion),
    (630, Code::OutputOffWithMotion),
    (640, Code::OutputOn),
    (650, Code::OutputOff),
    (660, Code::WaitInput),
    (670, Code::AnalogWithMotion),
    (680, Code::Analog),
    (700, Code::SaveModes),
    (710, Code::DropModes),
    (720, Code::RestoreModes),
    (730, Code::SaveModesOfCaller),
    (980, Code::CallProgram),
    (990, Code::Return),
];

/// The rows of a list, each with the distance of its number from that of the previous row: two
/// bytes. Codes that are not compiled in are known but of no dialect.
const fn packed<const COUNT: usize>(rows: &[(u16, Code); COUNT]) -> [(u8, Code); COUNT] {
    let mut packed = [(0, Code::Foreign); COUNT];
    let (mut place, mut before) = (0, 0);
    while place < COUNT {
        let (number, code) = rows[place];
        assert!(number - before < 256);
        packed[place].0 = (number - before) as u8;
        if EXTENDED || code.is_basic() {
            packed[place].1 = code;
        }
        before = number;
        place += 1;
    }
    packed
}

static OF_G: [(u8, Code); G.len()] = packed(&G);
static OF_M: [(u8, Code); M.len()] = packed(&M);

/// Above the largest number, in tenths.
const NUMBERS: usize = 1000;

/// The same indexed by the number itself: one kilobyte, for processors with enough flash.
const fn spread<const COUNT: usize>(rows: &[(u8, Code); COUNT]) -> [Option<Code>; NUMBERS] {
    let mut spread = [None; NUMBERS];
    let (mut place, mut number) = (0, 0);
    while place < COUNT {
        number += rows[place].0 as usize;
        spread[number] = Some(rows[place].1);
        place += 1;
    }
    spread
}

static BY_G: [Option<Code>; NUMBERS] = spread(&packed(&G));
static BY_M: [Option<Code>; NUMBERS] = spread(&packed(&M));

impl Code {
    /// The code of a letter (`G` or `M`) and a number in tenths in a dialect; `None` for an unknown
    /// one.
    pub(crate) fn read(letter: u8, tenths: u16, flavour: Flavour) -> Option<Code> {
        if flavour.has_own_numbers() {
            Code::read_own(letter, tenths, flavour)
        } else {
            of_number(letter, tenths)
        }
    }

    /// The same in a dialect where numbers may have other meanings.
    #[inline(never)]
    fn read_own(letter: u8, tenths: u16, flavour: Flavour) -> Option<Code> {
        #[cfg(feature = "extended")]
        if flavour == Flavour::Printer {
            let own = crate::codes::printer::of_printer(letter, tenths);
            return own.or_else(|| of_number(letter, tenths));
        }
        if letter == b'M' {
            return of_number(letter, tenths);
        }
        match (flavour, tenths) {
            (_, 740) => Some(Code::LathePeckCycle),
            // Code system A of turning machines.
            (Flavour::LatheA, 900) => Some(Code::TurnBoxCycle),
            (Flavour::LatheA, 920) => Some(Code::ThreadBoxCycle),
            (Flavour::LatheA, 940) => Some(Code::FaceBoxCycle),
            (Flavour::LatheA, 980) => Some(Code::PerMinute),
            (Flavour::LatheA, 990) => Some(Code::PerRevolution),
            // Shift of the work frame; G92 has another meaning there.
            (Flavour::LatheA, 500) => Some(Code::Shift),
            (Flavour::LatheA, 320) => Some(Code::Thread),
            (
                Flavour::LatheA,
                770 | 780 | 790 | 910 | 921 | 922 | 923 | 930 | 950 | 330 | 70 | 80,
            ) => Some(Code::Foreign),
            _ => of_number(letter, tenths),
        }
    }
}

/// The code of a letter (`G` or `M`) and a number in tenths; `None` for an unknown one.
fn of_number(letter: u8, tenths: u16) -> Option<Code> {
    if cfg!(target_has_atomic = "32") {
        let codes = if letter == b'M' { &BY_M } else { &BY_G };
        codes.get(usize::from(tenths)).copied().flatten()
    } else {
        of_row(letter, tenths)
    }
}

/// The same by a linear search of the rows.
fn of_row(letter: u8, tenths: u16) -> Option<Code> {
    let rows: &[(u8, Code)] = if letter == b'M' { &OF_M } else { &OF_G };
    let mut left = tenths;
    // From the first row, because most codes are G0 to G3.
    for &(ahead, code) in rows {
        left = left.checked_sub(u16::from(ahead))?;
        if left == 0 {
            return Some(code);
        }
    }
    None
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

    #[test]
    fn both_ways_know_the_same_numbers() {
        for tenths in (0..1100).chain([u16::MAX]) {
            for letter in [b'G', b'M'] {
                assert_eq!(of_number(letter, tenths), of_row(letter, tenths));
            }
        }
    }
}
