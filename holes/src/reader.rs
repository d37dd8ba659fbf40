//! Drill files read line by line.

use crate::Board;
use crate::step_and_repeat::{Panel, Refused};
use husillo_excellon::{
    Digits, Doubt, Error, ErrorKind, Feature, Inference, Overrides, Reader, Reason, Settled, Units,
    Warning, WarningKind, Zeros, lines,
};
use husillo_gcode::Nm;

/// Tools that one file may have.
pub const MOST_TOOLS: usize = 1000;
/// Most holes and slots of a file. Repeats can give many from a short text.
pub const MOST_FEATURES: usize = 2_000_000;
/// The bytes before a text in UTF-8 of some editors.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// What replaces the declarations of a file, or is missing in it.
#[derive(Clone, Debug, Default)]
pub struct Setup {
    /// Units, zeros and digits.
    pub overrides: Overrides,
    /// Tools and their diameters.
    pub tools: Vec<(u16, Nm)>,
}

/// What is wrong with a file, or doubtful.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remark<'t> {
    /// A line, its number from 1, and its error.
    Error(usize, &'t [u8], Error),
    /// A line, its number from 1, and a warning.
    Warning(usize, &'t [u8], Warning),
    /// An error: a copy of step and repeat is out of reach. The line and its number from 1.
    CopyOutOfReach(usize, &'t [u8]),
    /// An error: more than [`MOST_FEATURES`]. The line and its number from 1.
    TooMany(usize, &'t [u8]),
    /// A warning: the file has no hole and no slot.
    Empty,
    /// A warning: the file does not declare its unit.
    UnitAssumed(Settled<Units>),
    /// A warning: the file does not declare which zeros are omitted.
    ZerosAssumed(Settled<Zeros>),
    /// A warning about its numbers, and their format.
    Doubt(Doubt, Settled<Digits>),
}

impl Remark<'_> {
    /// Whether the program cannot run.
    pub const fn is_error(&self) -> bool {
        matches!(
            self,
            Self::Error(..) | Self::CopyOutOfReach(..) | Self::TooMany(..)
        )
    }
}

/// Reads a drill file; `remark` gets all errors, warnings and doubts in their order.
///
/// # Examples
///
/// ```
/// use husillo_holes::{Remark, Setup, read};
///
/// let mut remarks = 0;
/// let board = read(b"M48\nT1C0.8\n%\nT1\nX1.0Y2.0\nM30\n", &Setup::default(), |remark| {
///     assert!(matches!(remark, Remark::UnitAssumed(_)));
///     remarks += 1;
/// });
/// assert_eq!((board.holes.len(), remarks), (1, 1));
/// ```
pub fn read<'t>(text: &'t [u8], setup: &Setup, mut remark: impl FnMut(Remark<'t>)) -> Board {
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    let mut inference = Inference::new();
    for (_, line) in lines(text) {
        inference.observe(line);
    }
    let settings = inference.settle(&setup.overrides);
    let mut reader = Reader::<MOST_TOOLS>::new(&settings).with_patterns();
    for (number, diameter) in &setup.tools {
        reader.set_tool(*number, diameter.0);
    }
    let mut has_errors = false;
    let mut report = |given: Remark<'t>| {
        has_errors |= given.is_error();
        remark(given);
    };
    let mut board = Board {
        settings,
        tools: Vec::new(),
        holes: Vec::new(),
        slots: Vec::new(),
    };
    read_lines(text, &mut reader, &mut board, &mut report);
    board.tools = reader.tools().iter().copied().collect();
    if !has_errors {
        doubts(&board, remark);
    }
    board
}

/// Reads holes and slots.
fn read_lines<'t>(
    text: &'t [u8],
    reader: &mut Reader<MOST_TOOLS>,
    board: &mut Board,
    report: &mut impl FnMut(Remark<'t>),
) {
    let Board { holes, slots, .. } = board;
    let mut panel = Panel::default();
    let mut warned_diameters = Vec::new();
    for (number, line) in lines(text) {
        let read = reader.read(line);
        if let Some(warning) = reader.warning() {
            // Once for each tool is enough.
            let again = matches!(warning.kind, WarningKind::NoDiameter(_))
                && warned_diameters.contains(&warning.kind);
            if !again {
                warned_diameters.push(warning.kind);
                report(Remark::Warning(number, line, warning));
            }
        }
        let features = match read {
            Ok(features) => features,
            Err(error) => {
                report(Remark::Error(number, line, error));
                if matches!(error.kind, ErrorKind::Gerber | ErrorKind::NotText(_)) {
                    break; // Nothing of such a file is a drill program.
                }
                continue;
            }
        };
        if holes.len() + slots.len() + features.len() > MOST_FEATURES {
            report(Remark::TooMany(number, line));
            break;
        }
        for feature in features {
            match feature {
                Feature::Hole(hole) => holes.push(hole),
                Feature::Slot(slot) => slots.push(slot),
            }
        }
        let Some(pattern) = reader.pattern() else {
            continue;
        };
        if let Err(why) = panel.take(&pattern, holes, slots, MOST_FEATURES) {
            report(match why {
                Refused::Reach => Remark::CopyOutOfReach(number, line),
                Refused::Many => Remark::TooMany(number, line),
            });
            break;
        }
    }
}

/// Doubts about the file as a whole.
fn doubts<'t>(board: &Board, mut remark: impl FnMut(Remark<'t>)) {
    let settings = &board.settings;
    if board.holes.is_empty() && board.slots.is_empty() {
        return remark(Remark::Empty);
    }
    if matches!(settings.units.reason, Reason::Default | Reason::Numbers(_)) {
        remark(Remark::UnitAssumed(settings.units));
    }
    if let (Reason::Numbers(_), true) = (settings.zeros.reason, settings.point_missing) {
        remark(Remark::ZerosAssumed(settings.zeros));
    }
    if let Some(doubt) = settings.doubt {
        remark(Remark::Doubt(doubt, settings.digits));
    }
}
