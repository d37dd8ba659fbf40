//! Drill files read line by line.

use super::explain::{because, refused, warned};
use super::step_and_repeat::{Panel, Refused};
use super::{Board, Options};
use crate::diagnostics::{Finding, Findings, Place, Severity};
use crate::input::BYTE_ORDER_MARK;
use husillo_excellon::{Doubt, ErrorKind, Feature, Inference, Reader, Reason, WarningKind, lines};

/// Tools that one file may have.
pub const MOST_TOOLS: usize = 1000;
/// Most holes and slots of a file. Repeats can give many from a short text.
const MOST_FEATURES: usize = 2_000_000;

/// Reads a drill file; `findings` gets all errors, warnings and reasons.
pub fn read(text: &[u8], file: &str, options: &Options, findings: &mut Findings) -> Board {
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    let mut inference = Inference::new();
    for (_, line) in lines(text) {
        inference.observe(line);
    }
    let settings = inference.settle(&options.overrides);
    let mut reader = Reader::<MOST_TOOLS>::new(&settings).with_patterns();
    for (number, diameter) in &options.tools {
        reader.set_tool(*number, diameter.0);
    }
    let (mut holes, mut slots) = (Vec::new(), Vec::new());
    let mut panel = Panel::default();
    let errors_before = findings.errors;
    let mut warned_diameters = Vec::new();
    for (number, line) in lines(text) {
        let read = reader.read(line);
        if let Some(warning) = reader.warning() {
            // Once for each tool is enough.
            let again = matches!(warning.kind, WarningKind::NoDiameter(_))
                && warned_diameters.contains(&warning.kind);
            if !again {
                warned_diameters.push(warning.kind);
                findings.add(warned(&warning, file, number, line));
            }
        }
        let features = match read {
            Ok(features) => features,
            Err(error) => {
                findings.add(refused(&error, file, number, line));
                if matches!(error.kind, ErrorKind::Gerber | ErrorKind::NotText(_)) {
                    break; // Nothing of such a file is a drill program.
                }
                continue;
            }
        };
        if holes.len() + slots.len() + features.len() > MOST_FEATURES {
            let place = Place::new(file, number, line, 0..line.len());
            let message = format!("more than {MOST_FEATURES} holes");
            findings.add(Finding::error("E0910", message, place));
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
        if let Err(why) = panel.take(&pattern, &mut holes, &mut slots, MOST_FEATURES) {
            let place = Place::new(file, number, line, 0..line.len());
            let (code, message) = match why {
                Refused::Reach => ("E0103", "the copy is out of reach".to_owned()),
                Refused::Many => ("E0910", format!("more than {MOST_FEATURES} holes")),
            };
            findings.add(Finding::error(code, message, place));
            break;
        }
    }
    let board = Board {
        settings,
        tools: reader.tools().iter().copied().collect(),
        holes,
        slots,
    };
    if findings.errors == errors_before {
        doubts(&board, file, findings);
    }
    board
}

/// Warnings about the file as a whole.
fn doubts(board: &Board, file: &str, findings: &mut Findings) {
    let general = |code, message: String| Finding::general(Severity::Warning, code, message);
    let settings = &board.settings;
    let is_empty = board.holes.is_empty() && board.slots.is_empty();
    if is_empty {
        let message = format!("no hole in {file}");
        findings.add(general("W0602", message));
        return;
    }
    if matches!(settings.units.reason, Reason::Default | Reason::Numbers(_)) {
        let message = format!(
            "{file} does not declare its unit: {} is assumed",
            settings.units.value
        );
        let finding = general("W0928", message).note(because(settings.units.reason));
        findings.add(finding.help("--units inch or --units mm sets it"));
    }
    if let (Reason::Numbers(_), true) = (settings.zeros.reason, settings.point_missing) {
        let message = format!(
            "{file} does not declare which zeros are omitted: {} is assumed",
            settings.zeros.value
        );
        let finding = general("W0929", message).note(because(settings.zeros.reason));
        findings.add(finding.help("--zeros leading or --zeros trailing sets which are kept"));
    }
    match settings.doubt {
        Some(Doubt::LongNumber(line, digits)) => {
            let format = settings.digits.value;
            let message = format!(
                "line {line} of {file} has a number of {digits} digits, the format {format} has {}",
                format.all()
            );
            let finding = general("W0930", message).note(because(settings.digits.reason));
            let help = "--format-digits sets the position of the point, as in 4.4";
            findings.add(finding.help(help));
        }
        Some(Doubt::MixedPoints(line)) => {
            let message =
                format!("some coordinates of {file} have a point, and one of line {line} has none");
            let format = settings.digits.value;
            let note = format!("without a point it is read with the format {format}");
            findings.add(general("W0931", message).note(note));
        }
        None => {}
    }
}
