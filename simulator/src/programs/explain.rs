//! Explains the errors of a block to the user: labels, notes, help.

use crate::diagnostics::{Finding, Place, page};
use crate::programs::blocks;
use crate::programs::{explain_flow, explain_foreign};
use husillo_gcode::{Block, Dialect, Error, ErrorKind, Nm, words};
use husillo_sim::text::length;
use std::ops::Range;

/// The block of a program that a finding is about, with its line.
#[derive(Clone, Copy, Debug)]
pub struct At<'a> {
    /// Name of the file.
    pub file: &'a str,
    /// Number of the line, from 1.
    pub line: usize,
    /// The whole line.
    pub bytes: &'a [u8],
    /// Byte offset of the block in the line.
    pub block: usize,
    /// Length of the block, bytes.
    pub length: usize,
    /// The language of the program.
    pub dialect: Dialect,
}

impl At<'_> {
    /// The position in the file of a span of the block, which is in bytes of the block.
    pub fn place(&self, span: Range<usize>) -> Place {
        Place::new(
            self.file,
            self.line,
            self.bytes,
            self.block + span.start..self.block + span.end,
        )
    }

    /// The position in the file of the whole block, without blanks around it.
    pub fn whole(&self) -> Place {
        let text = self.text();
        let start = text
            .iter()
            .position(|b| !b.is_ascii_whitespace())
            .unwrap_or(0);
        let end = text
            .iter()
            .rposition(|b| !b.is_ascii_whitespace())
            .map_or(start, |at| at + 1);
        self.place(start..end)
    }

    /// The position in the file of the word with this letter, or of the whole block.
    pub fn word(&self, letter: u8) -> Place {
        match self.find(|word| word == letter) {
            Some(span) => self.place(span),
            None => self.whole(),
        }
    }

    /// The span of the first word whose letter satisfies a condition.
    pub fn find(&self, wanted: impl Fn(u8) -> bool) -> Option<Range<usize>> {
        words(self.text())
            .flatten()
            .find(|word| wanted(word.letter))
            .map(|word| word.at..word.end)
    }

    /// Whether the block has G2 or G3.
    fn has_arc(&self) -> bool {
        let mut all = words(self.text()).flatten();
        all.any(|word| word.letter == b'G' && matches!(word.value.whole(), Some(2 | 3)))
    }

    /// Converts a span of the block to a span of the displayed line. Bytes that are not text take
    /// more room there.
    fn drawn(&self, span: Range<usize>) -> Range<usize> {
        self.place(span).span()
    }

    /// The span to remove with a word: the word and the blank after it. If no blank follows, it
    /// includes the blank before it.
    fn removal(&self, span: Range<usize>) -> Range<usize> {
        let text = self.text();
        let blank = |at: Option<usize>| {
            let byte = at.and_then(|at| text.get(at));
            matches!(byte, Some(b' ' | b'\t'))
        };
        let (behind, before) = (blank(Some(span.end)), blank(span.start.checked_sub(1)));
        let start = span.start - usize::from(before && !behind);
        self.drawn(start..span.end + usize::from(behind))
    }

    /// The end of the block without trailing blanks.
    fn end(&self) -> usize {
        self.text().trim_ascii_end().len()
    }

    /// Whether no other comma, point or sign follows the digits after a comma. False for `1,234.5`.
    fn is_only_mark(&self, comma: usize) -> bool {
        let behind = self.text().get(comma + 1..).unwrap_or_default();
        let next = behind
            .iter()
            .find(|byte| !matches!(byte, b'0'..=b'9' | b' ' | b'\t'));
        !matches!(next, Some(b',' | b'.' | b'+' | b'-'))
    }

    /// Whether a comma follows the digits of a number. False after the digits of a parameter, and
    /// after a bracket.
    fn is_behind_digits(&self, comma: usize) -> bool {
        let before = self.text().get(..comma).unwrap_or_default();
        let mut others = before.iter().rev();
        let found = others.find(|byte| !matches!(byte, b'0'..=b'9' | b' ' | b'\t'));
        !matches!(found, Some(b'#' | b'.' | b']' | b'>'))
    }

    /// The text of the block.
    pub fn text(&self) -> &[u8] {
        let end = (self.block + self.length).min(self.bytes.len());
        self.bytes.get(self.block..end).unwrap_or_default()
    }

    /// The text of a span of the block.
    fn slice(&self, error: &Error) -> String {
        let text = self.text();
        let end = error.end.min(text.len());
        String::from_utf8_lossy(text.get(error.at..end).unwrap_or_default()).into_owned()
    }
}

/// Turns an error of a block into a finding. It offers no fix on a line with a checksum, because
/// the fix would make the checksum wrong.
pub fn finding(error: &Error, at: &At<'_>) -> Finding {
    let finding = described(error, at);
    let is_summed = blocks::has_sum(at.bytes, &at.dialect);
    let code = format!("E{:04}", error.kind.code());
    Finding {
        fix: finding.fix.filter(|_| !is_summed),
        help: finding
            .help
            .or_else(|| page::remedy(&code).map(str::to_owned)),
        ..finding
    }
}

/// Whether the program has this dialect. The axes of its machine do not matter.
fn is_of(at: &At<'_>, dialect: &Dialect) -> bool {
    at.dialect.name() == dialect.name()
}

fn described(error: &Error, at: &At<'_>) -> Finding {
    let code = format!("E{:04}", error.kind.code());
    // An error at the very end of the block points at its last character.
    let span = if error.at < error.end {
        error.at..error.end
    } else {
        error.at..error.at + 1
    };
    let place = at.place(span.clone());
    let message = message(error, at);
    let finding = Finding::error(&code, message, place);
    if let Some(advice) = explain_foreign::advice(error, at.text()) {
        let finding = finding.label(advice.label).help(advice.help);
        let finding = match error.kind {
            ErrorKind::UnknownCode(letter, tenths) => finding.note(unknown_code(letter, tenths)),
            _ => finding,
        };
        return match advice.fix {
            Some(fix) => finding.fix(at.drawn(span), fix),
            None => finding,
        };
    }
    match error.kind {
        // A word that moves an axis cannot be left out.
        ErrorKind::UnknownWord(letter @ (b'A' | b'B' | b'C' | b'E' | b'U' | b'V' | b'W')) => {
            finding
                .label(format!("this machine has no {} axis", char::from(letter)))
                .help("run it on a machine with this axis: `husillo machines` lists the axes")
        }
        ErrorKind::UnknownWord(letter) => finding
            .label(format!(
                "no axis or parameter named `{}` here",
                char::from(letter)
            ))
            .note(match letter {
                b'A'..=b'Z' => "grbl: `error:20`",
                _ => "grbl: `error:1`",
            })
            .help("remove the word")
            .fix(at.removal(span), ""),
        ErrorKind::NotALetter(b'$') if blocks::is_of_files(&at.dialect) => finding
            .label("a jog (`$J=`) is for the operator")
            .help("write G1, or send it by a Grbl sender"),
        ErrorKind::NotALetter(byte) => {
            let finding = finding
                .label("a word is a letter and a number")
                .note("grbl: `error:1`; LinuxCNC: \"Bad character used\"");
            match byte.is_ascii_graphic() {
                true => finding,
                false => finding.help("remove it; if the file is no text, name another file"),
            }
        }
        ErrorKind::MissingNumber(_) => finding
            .label("a number must follow the letter")
            .note("grbl: `error:2`"),
        ErrorKind::MalformedNumber => finding
            .label("the number is malformed here")
            .note("grbl reads the first part, then answers `error:1` at the rest"),
        ErrorKind::Expression => finding.label("this dialect does not have them").help(
            "choose another dialect with `--dialect`, or let the post-processor write plain \
             numbers",
        ),
        ErrorKind::Program(fault) => explain_flow::finding(fault, finding),
        ErrorKind::NumberTooLarge => finding
            .label("too large")
            .note("grbl keeps the first 8 digits and drops the rest without an error"),
        ErrorKind::TooManyDigits => finding.label("more digits than can be kept exactly"),
        ErrorKind::BlockTooLong(limit) => finding.label(format!(
            "the buffer of the controller ends after {limit} characters"
        )),
        ErrorKind::UnknownCode(letter, tenths) => finding
            .label("not in the list of codes")
            .note(unknown_code(letter, tenths)),
        ErrorKind::RepeatedWord(_) => finding
            .label("occurs a second time")
            .note("grbl: `error:25`"),
        ErrorKind::TwoCodesOfOneGroup => finding
            .label("only one of them can be in effect")
            .note("grbl: `error:21`")
            .help("write them on two lines"),
        ErrorKind::TwoUsersOfWords => finding
            .label("only one code can use the words")
            .note("grbl: `error:24`")
            .help("write them on two lines"),
        ErrorKind::AxisWordsWithoutMotion => finding
            .label("no code uses it")
            .note("grbl: `error:31`")
            .help("write G0 or G1 before the axis words"),
        ErrorKind::NoAxisWords => finding
            .label("needs at least one axis")
            .note("grbl: `error:26`; LinuxCNC: \"All axes missing with motion code\""),
        ErrorKind::UnusedWord(_) => {
            let finding = finding
                .label("nothing on this line uses it")
                .help("remove the word")
                .fix(at.removal(span), "");
            // Grbl checks the end and the centre of an arc first.
            match at.has_arc() {
                true => finding,
                false => finding.note("grbl: `error:36`"),
            }
        }
        ErrorKind::ZNotAlone => finding
            .label("this machine interpolates X and Y only")
            .help("move Z in a separate string, before or after"),
        ErrorKind::NoCentre
            if at
                .find(|letter| matches!(letter, b'I' | b'J' | b'K'))
                .is_some() =>
        {
            finding.label("the given centre is the start of the arc")
        }
        ErrorKind::NoCentre => finding
            .label("needs `I` and `J`, or `R`")
            .note("grbl: `error:35`; LinuxCNC: \"R i j k words all missing for arc\"")
            .help("add the centre as `I` and `J`, relative to the start, or the radius as `R`"),
        ErrorKind::HalfCentre => finding
            .label("an absolute centre takes both words of its plane")
            .note(
                "G90.1 and the micromill dialect give the centre itself, not its distance from \
                 the start",
            )
            .help("add the other centre word, or G91.1 for distances"),
        ErrorKind::EndOffArc(_) => finding
            .label("start and end have different distances from the centre")
            .note(match at.dialect.arc_tolerance() {
                Nm(0) => "LinuxCNC's rule: an error from 28 um (72 um in inches) and 0.1 % of the \
                          radius; Grbl's, with --dialect grbl: from 5 um and 0.1 %"
                    .to_owned(),
                Nm(most) => format!(
                    "the rule of this machine: an error from {} (`motion.arc_tolerance`)",
                    length(most as f64)
                ),
            })
            .help(
                "check the centre words; absolute centres need G90.1; `motion.arc_tolerance` of \
                 the machine file widens the rule",
            ),
        ErrorKind::RadiusAndCentre => finding
            .label("only one of them is allowed")
            .note("grbl: `error:36`; LinuxCNC: \"Mixed radius ijk format for arc\""),
        ErrorKind::RadiusTooSmall(_) => finding
            .label("does not reach the end")
            .note("grbl: `error:34`; LinuxCNC: \"Arc radius too small to reach end point\""),
        ErrorKind::RadiusToSamePoint => finding
            .label("a radius does not determine the centre of a full circle")
            .note("grbl: `error:33`")
            .help("write a full circle with `I` and `J`"),
        ErrorKind::NoEnd => finding
            .label("needs an end point in its plane")
            .note("grbl: `error:32`"),
        ErrorKind::NoFeed if at.find(|letter| letter == b'F').is_some() => finding
            .label("the feed rate is zero")
            .note("grbl: `error:22`; LinuxCNC: \"Cannot do g1 with zero feed rate\""),
        ErrorKind::NoFeed => finding
            .label("no `F` on this line or before it")
            .note("grbl: `error:22`; LinuxCNC: \"Cannot do g1 with zero feed rate\"")
            .help("add a feed rate, as in `F100`"),
        ErrorKind::NoInverseTime => finding
            .label("no `F` on this line")
            .note(
                "under G93 F is the inverse of the minutes of one move and does not apply to the \
                 next",
            )
            .help("add F, or G94 for feed rates that stay in effect"),
        ErrorKind::Negative(_) => finding
            .label("must not be negative")
            .note("grbl: `error:4`"),
        ErrorKind::NotOfDialect(letter, tenths) => {
            let finding = finding.label("this dialect has no such code");
            // These machines understand only their own language.
            if [Dialect::MICROMILL, Dialect::DRILL]
                .iter()
                .any(|one| is_of(at, one))
            {
                return finding.help("leave the code out: this machine has no such function");
            }
            let finding = match is_of(at, &Dialect::GRBL) {
                true => finding.note("grbl: `error:20`"),
                false => finding,
            };
            if letter == b'G' && ENDS_NOTHING.contains(&tenths) {
                return finding.help("leave the code out: it ends a mode that no program here has");
            }
            finding.help(match dialect_with(letter, tenths) {
                Some(name) => format!("`--dialect {name}` has it; or leave the code out"),
                None => "leave the code out: no dialect here has it".to_owned(),
            })
        }
        ErrorKind::MissingWord(letter) => {
            let finding = finding.label(format!("needs `{}`", char::from(letter)));
            // Grbl checks for the axis words of G10 first.
            let is_axis = |letter| matches!(letter, b'X' | b'Y' | b'Z');
            match is_of(at, &Dialect::GRBL) && at.find(is_axis).is_some() {
                true => finding.note("grbl: `error:28`"),
                false => finding,
            }
        }
        ErrorKind::NumberNotAlone => finding
            .label("must be alone on its line at the start of a program")
            .help("put the other words on a separate line"),
        ErrorKind::Checksum { .. } => finding
            .label("bytes of this line were lost or changed")
            .help("write the program again, or leave line numbers and checksums out"),
        ErrorKind::NoChecksum => finding.help("write `*` and the checksum after the line"),
        ErrorKind::LineNumber(_) => finding
            .label("a line is missing or occurs twice")
            .help("number the lines consecutively; `M110 N..` sets a new start"),
        ErrorKind::DecimalComma => {
            let finding = finding
                .label("the decimal separator is a point")
                .note("grbl: `error:1`; LinuxCNC: \"Bad character ',' used\"");
            if at.is_only_mark(span.start) && at.is_behind_digits(span.start) {
                let mark = at.drawn(span.start..span.start + 1);
                finding.help("write a point").fix(mark, ".")
            } else {
                finding.help("write at most one point, and no separator between thousands")
            }
        }
        ErrorKind::UnclosedComment => finding
            .label("extends to the end of the line")
            .note("LinuxCNC: \"Unclosed comment found\"")
            .help("close it")
            .fix(at.drawn(at.end()..at.end()), ")"),
        ErrorKind::OutOfRange(_) => finding.label("not a value this code takes"),
        ErrorKind::TooManyPasses => finding.label("more than 65536 pecks or passes"),
        ErrorKind::ToolTableFull => finding.label("the table holds at most eight tools"),
        ErrorKind::UnknownTool => finding
            .label("the radius of this tool is not known")
            .note("LinuxCNC: \"Requested tool not found in the tool table\"")
            .help(
                "set its radius first: `G10 L1 P<tool> R<radius>`, or `[[tool]]` of the machine \
                file",
            ),
        ErrorKind::SpindleStopped => finding
            .label("the spindle does not turn, or turns in the other direction")
            .note("LinuxCNC: \"Spindle not turning\"")
            .help("start it with M3 or M4 before"),
        ErrorKind::WrongFeedMode => finding
            .label("needs G94")
            .help("write G94 and a feed per minute before it"),
        ErrorKind::RetractBelowBottom => finding
            .label("`R` lies below the bottom of the hole")
            .note("LinuxCNC: \"R value less than Z value in canned cycle\""),
        ErrorKind::RotaryInCycle(_) => finding.label("move this axis on a separate line"),
        ErrorKind::ContourOfBlocks => finding.label("the contour is on other lines"),
        ErrorKind::NoContour(_) => finding
            .label("the contour is not found")
            .note("the contour of G71 and G72 follows the cycle; G70 takes the last one before it")
            .help("write N and this number at the start of its first (P) and its last (Q) block"),
        ErrorKind::NotOfContour => finding
            .label("a contour has lines and arcs of X and Z under G18, and begins with a line")
            .note("F, S, M3 to M9 and G40 to G42 are also allowed there"),
        ErrorKind::Pocket(_) => finding
            .label("the contour goes back here")
            .note("roughing cycles cut contours that rise monotonically in both axes (type I)")
            .help("turn the pocket in a separate cycle"),
        ErrorKind::ThreadStart => finding.label(
            "start and end of the cycle must be on the same side of the crest, outside of it, \
             and apart along it",
        ),
        ErrorKind::TooManyWaiting => finding
            .label("at most four commands can wait for the corner")
            .help(
                "move these commands before the compensation, or put a move in the plane between \
                 them",
            ),
        ErrorKind::ContourTooLong => finding.label("at most 1024 moves"),
        ErrorKind::ContourStart => finding
            .label(
                "the first move of the contour must go down from the start of the cycle, and its \
                 end must lie along the cut",
            )
            .note("G71 goes down in X and cuts along Z; G72 goes down in Z and cuts along X"),
        ErrorKind::SplinePlane => finding.label("needs G17, and only X and Y"),
        ErrorKind::NoProbeMove => finding.label("ends where it starts"),
        ErrorKind::UnderCompensation => finding.help("end the compensation with G40 first"),
        ErrorKind::CompensationEntry => {
            finding.label("the entry move must not be an arc or a move along the third axis")
        }
        ErrorKind::EntryTooShort(_) => finding
            .label("the tool has no room to reach the contour")
            .note(
                "LinuxCNC: \"Length of cutter compensation entry move is not greater than the \
                 tool radius\"",
            ),
        ErrorKind::Gouge => finding.label("too narrow for the tool").note(
            "LinuxCNC: \"Straight feed in concave corner cannot be reached by the tool \
                 without gouging\"",
        ),
        ErrorKind::ArcSmallerThanTool(_) => finding
            .label("the tool does not fit into this arc")
            .note("LinuxCNC: \"Arc radius too small to reach end point\" with compensation"),
        ErrorKind::NoDwellTime => finding
            .label("the time is missing")
            .note("grbl: `error:28`; LinuxCNC: \"Dwell time missing with g4\""),
        _ => finding,
    }
}

/// The messages of other programs for an unknown code.
fn unknown_code(letter: u8, tenths: Option<u16>) -> String {
    let small = char::from(letter.to_ascii_lowercase());
    let linuxcnc = format!("LinuxCNC: \"Unknown {small} code used\"");
    // Grbl's answer to a fraction depends on the whole number before it. Of an M code Grbl keeps
    // eight bits.
    match tenths {
        Some(tenths) if tenths % 10 == 0 && (letter == b'G' || tenths < 2560) => {
            format!("grbl: `error:20`; {linuxcnc}")
        }
        _ => linuxcnc,
    }
}

/// Numbers, times ten, of G codes that end polar coordinates, scaling, mirroring and rotation on
/// other machines. Many programs have them in their first lines.
const ENDS_NOTHING: [u16; 5] = [150, 500, 501, 511, 690];

/// The first dialect that has a code. `tenths` is ten times its number.
fn dialect_with(letter: u8, tenths: u16) -> Option<&'static str> {
    let code = format!("{}{}.{}", char::from(letter), tenths / 10, tenths % 10);
    let has = |dialect: &Dialect| {
        let error = Block::parse(code.as_bytes(), dialect).map_err(|error| error.kind);
        !matches!(
            error,
            Err(ErrorKind::NotOfDialect(..) | ErrorKind::UnknownCode(..))
        )
    };
    Dialect::ALL
        .iter()
        .find(|dialect| has(dialect))
        .map(Dialect::name)
}

fn message(error: &Error, at: &At<'_>) -> String {
    match error.kind {
        ErrorKind::MalformedNumber => {
            let text = at.text();
            let word = words_around(text, error.at);
            format!("malformed number `{}`", String::from_utf8_lossy(word))
        }
        ErrorKind::UnknownCode(_, None) => format!("unknown code `{}`", at.slice(error)),
        _ => error.to_string(),
    }
}

/// The digits, signs and points around a byte.
fn words_around(text: &[u8], at: usize) -> &[u8] {
    let part = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'+' | b'-');
    let at = at.min(text.len());
    let start = text[..at]
        .iter()
        .rposition(|b| !part(b))
        .map_or(0, |before| before + 1);
    let end = text[at..]
        .iter()
        .position(|b| !part(b))
        .map_or(text.len(), |length| at + length);
    &text[start..end]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dialect_that_has_the_code_is_found() {
        assert_eq!(dialect_with(b'G', 410), Some("rs274"));
        assert_eq!(dialect_with(b'G', 711), Some("lathe"));
        assert_eq!(dialect_with(b'M', 60), Some("rs274"));
        assert_eq!(dialect_with(b'G', 69), None);
    }

    #[test]
    fn a_word_is_removed_with_one_blank() {
        let removed = |bytes: &str, letter| {
            let at = At {
                file: "p",
                line: 1,
                bytes: bytes.as_bytes(),
                block: 0,
                length: bytes.len(),
                dialect: Dialect::RS274,
            };
            let span = at.find(|word| word == letter).unwrap();
            let mut text = bytes.to_owned();
            text.replace_range(at.removal(span), "");
            text
        };
        assert_eq!(removed("G0 X1 P3", b'P'), "G0 X1");
        assert_eq!(removed("G0 P3 X1", b'P'), "G0 X1");
        assert_eq!(removed("P3 G0", b'P'), "G0");
        assert_eq!(removed("G0 X1 P3(c)", b'P'), "G0 X1(c)");
        assert_eq!(removed("G0X1P3", b'P'), "G0X1");
        assert_eq!(removed("P3", b'P'), "");
    }
}
