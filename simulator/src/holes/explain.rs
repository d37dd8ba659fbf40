//! The findings about a drill file: errors, warnings, and the reasons of its settings.

use crate::diagnostics::{Finding, Place, Severity};
use husillo_excellon::{Doubt, Error, ErrorKind, Reason, Warning, WarningKind};
use husillo_holes::{MOST_FEATURES, MOST_TOOLS, Remark};

fn span(at: usize, end: usize) -> std::ops::Range<usize> {
    at..end.max(at + 1)
}

fn refused(error: &Error, file: &str, number: usize, line: &[u8]) -> Finding {
    let place = Place::new(file, number, line, span(error.at, error.end));
    let code = format!("E{:04}", error.kind.code());
    let finding = Finding::error(&code, error.to_string(), place);
    match error.kind {
        ErrorKind::NotALetter(_) => finding.label("a word is a letter and a number"),
        ErrorKind::NotText(_) => finding
            .label("no text from here on")
            .note("old Protel programs write binary (EIA) drill files beside the text ones"),
        ErrorKind::Gerber => finding
            .label("a command of Gerber")
            .help("take the drill file of the layout, often .drl, .xln, .exc or .txt"),
        ErrorKind::MissingNumber(_) => finding.label("a number must follow the letter"),
        ErrorKind::MalformedNumber => finding.label("the number is malformed from here on"),
        ErrorKind::TooManyDigits => finding.label("at most 18 digits"),
        ErrorKind::NumberTooLarge => finding
            .label("too large")
            .help("other units or digits? See --units and --format-digits"),
        ErrorKind::UnknownCode(..) | ErrorKind::UnknownName | ErrorKind::UnknownWord(_) => {
            finding.label("unknown in drill files")
        }
        ErrorKind::RepeatedWord(_) => finding.label("given a second time"),
        ErrorKind::NoTool => finding
            .label("no tool is selected")
            .help("select a tool before it, as in `T1`"),
        ErrorKind::NoDiameter => finding.label("must be above zero"),
        ErrorKind::StepAndRepeat => finding
            .label("a pattern is repeated by M02 between M01 and M08")
            .help(
                "see the order of step and repeat: M25, holes, M01, M02X..Y.. for each copy, M08",
            ),
        ErrorKind::PatternOrder => finding
            .label("not here")
            .help("the order is M25, the pattern, M01, M02X..Y.. for each copy, M08"),
        ErrorKind::TooManyTools => finding.label(format!("at most {MOST_TOOLS}")),
        ErrorKind::HalfSlot => finding.label("needs a point before it and one after it"),
        ErrorKind::Origin => finding.help("let the layout program write absolute coordinates"),
        ErrorKind::NoCentre => finding.label("needs `A`, or `I` and `J`"),
        _ => finding,
    }
}

fn warned(warning: &Warning, file: &str, number: usize, line: &[u8]) -> Finding {
    let place = Place::new(file, number, line, span(warning.at, warning.end));
    let code = format!("W{:04}", warning.kind.code());
    let finding = Finding::warning(&code, warning.to_string(), place);
    match warning.kind {
        WarningKind::NoDiameter(tool) => {
            finding.help(format!("give it in millimetres: --tool {tool}=0.8"))
        }
        WarningKind::HeaderNotEnded => finding.label("a `%` or `M95` is missing before this line"),
        WarningKind::ToolUp => finding.help("write `M15` before the rout"),
        _ => finding,
    }
}

/// The finding of a remark on a file.
pub fn finding(remark: &Remark<'_>, file: &str) -> Finding {
    let whole_line = |number: usize, line: &[u8]| Place::new(file, number, line, 0..line.len());
    match *remark {
        Remark::Error(number, line, error) => refused(&error, file, number, line),
        Remark::Warning(number, line, warning) => warned(&warning, file, number, line),
        Remark::CopyOutOfReach(number, line) => {
            let message = "the copy is out of reach";
            Finding::error("E0103", message, whole_line(number, line))
        }
        Remark::TooMany(number, line) => {
            let message = format!("more than {MOST_FEATURES} holes");
            Finding::error("E0910", message, whole_line(number, line))
        }
        Remark::Empty => doubtful("W0602", format!("no hole in {file}")),
        Remark::UnitAssumed(units) => {
            let message = format!(
                "{file} does not declare its unit: {} is assumed",
                units.value
            );
            let finding = doubtful("W0928", message).note(because(units.reason));
            finding.help("--units inch or --units mm sets it")
        }
        Remark::ZerosAssumed(zeros) => {
            let message = format!(
                "{file} does not declare which zeros are omitted: {} is assumed",
                zeros.value
            );
            let finding = doubtful("W0929", message).note(because(zeros.reason));
            finding.help("--zeros leading or --zeros trailing sets which are kept")
        }
        Remark::Doubt(Doubt::LongNumber(line, digits), format) => {
            let message = format!(
                "line {line} of {file} has a number of {digits} digits, the format {} has {}",
                format.value,
                format.value.all()
            );
            let finding = doubtful("W0930", message).note(because(format.reason));
            finding.help("--format-digits sets the position of the point, as in 4.4")
        }
        Remark::Doubt(Doubt::MixedPoints(line), format) => {
            let message =
                format!("some coordinates of {file} have a point, and one of line {line} has none");
            let note = format!(
                "without a point it is read with the format {}",
                format.value
            );
            doubtful("W0931", message).note(note)
        }
    }
}

/// A warning about the file as a whole.
fn doubtful(code: &str, message: String) -> Finding {
    Finding::general(Severity::Warning, code, message)
}

/// A reason as a sentence.
pub fn because(reason: Reason) -> String {
    match reason {
        Reason::Given => "given on the command line".to_owned(),
        Reason::Declared(line) => format!("declared in line {line}"),
        Reason::Comment(line) => format!("declared by the comment in line {line}"),
        Reason::Numbers(line) => format!("from the form of the numbers, first in line {line}"),
        Reason::Profile => "of the tango profile".to_owned(),
        Reason::Default => "the default, as the file does not declare it".to_owned(),
    }
}
