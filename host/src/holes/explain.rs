//! The findings about a drill file: errors, warnings, and the reasons of its settings.

use super::reader::MOST_TOOLS;
use crate::diagnostics::{Finding, Place};
use husillo_excellon::{Error, ErrorKind, Reason, Warning, WarningKind};

fn span(at: usize, end: usize) -> std::ops::Range<usize> {
    at..end.max(at + 1)
}

pub fn refused(error: &Error, file: &str, number: usize, line: &[u8]) -> Finding {
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

pub fn warned(warning: &Warning, file: &str, number: usize, line: &[u8]) -> Finding {
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
