//! The blocks of a program in the order of execution.

use crate::programs::library::Subroutines;
use crate::programs::reading::Reading;
use crate::programs::source::Source;
use husillo_gcode::contour::{Contours, needs_contours};
use husillo_gcode::parameters::{Fault, Program, needs_program};
use husillo_gcode::{
    Block, Dialect, Error, ErrorKind, Framing, FramingError, Receiver, Rule, words,
};
use std::fmt::{self, Debug, Write};
use std::hash::{DefaultHasher, Hasher};
use std::io;
use std::ops::ControlFlow;

/// A program that is kept in memory. Its capacities for parameters and calls are far larger than
/// those of a controller.
type Whole<'t> = Program<'t, 4096, 2048, 128, 64>;

/// The expander of turning cycles, with its capacity for the moves of a contour.
type Turned<'t> = Contours<'t, 1024>;

/// A block and its position in the file.
#[derive(Clone, Copy, Debug)]
pub struct Given<'a> {
    /// The file of a subroutine that the line is in; `None` for the program itself.
    pub file: Option<&'a str>,
    /// Number of the line, from 1.
    pub number: usize,
    /// The whole line.
    pub bytes: &'a [u8],
    /// Byte offset of the block in the line.
    pub at: usize,
    /// The text of the block.
    pub text: &'a [u8],
    /// Whether the line is too long and this is the last block that was read from it.
    pub overlong: bool,
    /// Whether the line may be executed again, because the program has loops or subroutines.
    pub repeats: bool,
}

/// The `%` before and after a program.
#[derive(Debug, Default)]
struct Percent {
    begun: bool,
    inside: bool,
}

impl Percent {
    /// Whether the program ends at this line. As in LinuxCNC, a program that begins with `%` ends
    /// at the second `%`. Grbl ignores all of them.
    fn ends(&mut self, line: &[u8], dialect: &Dialect) -> bool {
        let line = line.trim_ascii();
        let is_percent = line.first() == Some(&b'%') && dialect.name() != Dialect::GRBL.name();
        let ends = is_percent && self.inside;
        self.inside |= is_percent && !self.begun;
        self.begun |= !line.is_empty();
        ends
    }

    /// Returns a line up to the `%` that ends the program.
    fn before<'a>(&self, line: &'a [u8]) -> &'a [u8] {
        let before = before_percent(line).filter(|_| self.inside);
        before.unwrap_or(line)
    }

    /// Returns a text up to the `%` that ends the program.
    fn before_all<'a>(&self, text: &'a [u8]) -> &'a [u8] {
        let mut start = 0;
        for line in text.split_inclusive(|&byte| byte == b'\n') {
            let before = self.before(line);
            if before.len() < line.len() {
                return &text[..start + before.len()];
            }
            start += line.len();
        }
        text
    }
}

/// The part of a line before the `%` that follows M2 or M30, as in `M30%`.
pub fn before_percent(line: &[u8]) -> Option<&[u8]> {
    let before = line.trim_ascii_end().strip_suffix(b"%")?;
    let last = |wanted: u8| before.iter().rposition(|&byte| byte == wanted);
    let is_comment = before.contains(&b';') || last(b'(') > last(b')');
    (!is_comment && ends_program(before)).then_some(before)
}

/// Whether a line has M2 or M30.
pub fn ends_program(line: &[u8]) -> bool {
    words(line)
        .flatten()
        .any(|word| word.letter == b'M' && matches!(word.value.whole(), Some(2 | 30)))
}

/// Checks number and checksum of a line, and returns its text without them. After an error the
/// receiver expects the number that follows this line's.
pub fn unframed<'a>(receiver: &mut Receiver, line: &'a [u8]) -> Result<&'a [u8], Error> {
    receiver.check(line).map_err(|error| {
        if let FramingError::Number { given, .. } = error {
            receiver.expect(given.wrapping_add(1));
        } else {
            receiver.expect(receiver.expected().wrapping_add(1));
        }
        let end = line.trim_ascii_end().len();
        let star = line.iter().rposition(|&byte| byte == b'*');
        let at = match error {
            FramingError::Checksum { .. } | FramingError::MalformedChecksum => star.unwrap_or(0),
            _ => 0,
        };
        Error {
            kind: error.into(),
            at,
            end,
        }
    })
}

/// Longest line that Grbl accepts, without blanks and comments. Its LINE_BUFFER_SIZE is 80,
/// including the terminating zero.
const GRBL_LINE: u8 = 79;

/// Checks that a line fits into the buffer of Grbl.
fn fits(text: &[u8], dialect: &Dialect) -> Result<(), Error> {
    if dialect.name() != Dialect::GRBL.name() || text.len() <= usize::from(GRBL_LINE) {
        return Ok(());
    }
    let (mut comments, mut length) = (0_usize, 0);
    for (at, byte) in text.iter().enumerate() {
        match byte {
            b')' => comments = comments.saturating_sub(1),
            b'(' => comments += 1,
            _ if comments > 0 => {}
            b';' => break,
            b'/' | 0..=b' ' => {}
            _ => length += 1,
        }
        if length > GRBL_LINE {
            return Err(Error {
                kind: ErrorKind::BlockTooLong(GRBL_LINE),
                at,
                end: text.trim_ascii_end().len(),
            });
        }
    }
    Ok(())
}

/// Whether programs of a dialect are text files, not the strings of one machine's link.
pub fn is_of_files(dialect: &Dialect) -> bool {
    ![Dialect::MICROMILL, Dialect::DRILL]
        .iter()
        .any(|other| other.name() == dialect.name())
}

/// Returns the text before the checksum of a line such as `N3 G1 X1*98`, in a dialect whose lines
/// need no checksum. `None` for any other line.
pub fn summed<'a>(line: &'a [u8], dialect: &Dialect) -> Option<Result<&'a [u8], Error>> {
    let text = line.trim_ascii();
    let tail = text.iter().rev().skip_while(|byte| byte.is_ascii_digit());
    let has_sum = tail.clone().next() == Some(&b'*') && text.last().is_some_and(u8::is_ascii_digit);
    let is_numbered = text
        .first()
        .is_some_and(|byte| byte.eq_ignore_ascii_case(&b'N'));
    // A star in an expression multiplies.
    let is_plain = !text
        .iter()
        .any(|byte| matches!(byte, b'#' | b'[' | b'(' | b';'));
    if !(has_sum && is_numbered && is_plain) || dialect.framing().is_some() || !is_of_files(dialect)
    {
        return None;
    }
    let mut receiver = Receiver::new(Framing {
        checksum: Rule::WhereGiven,
        number: Rule::Never,
    });
    Some(unframed(&mut receiver, line))
}

/// Whether a line has a checksum. If the line is changed, its checksum becomes wrong.
pub fn has_sum(line: &[u8], dialect: &Dialect) -> bool {
    summed(line, dialect).is_some() || dialect.framing().is_some() && line.contains(&b'*')
}

/// Replaces the checksums of a text with blanks, so that columns stay the same.
fn without_sums(text: &mut [u8], dialect: &Dialect) {
    for line in text.split_mut(|byte| matches!(byte, b'\r' | b'\n')) {
        let kept = match summed(line, dialect) {
            Some(Ok(text)) => text.len(),
            _ => continue,
        };
        line[kept..].fill(b' ');
    }
}

/// Whether a line is a `$` command of Grbl, as in files of settings. Always false in a dialect
/// whose programs are not text files, and for a jog (`$J=`), because it moves the tool.
pub fn is_grbl_command(text: &[u8], dialect: &Dialect) -> bool {
    let mut bytes = text.iter().filter(|byte| !byte.is_ascii_whitespace());
    is_of_files(dialect)
        && bytes.next() == Some(&b'$')
        && !bytes
            .next()
            .is_some_and(|byte| byte.eq_ignore_ascii_case(&b'j'))
}

/// Whether a line sets the number of the next one: M110.
pub fn is_numbering(text: &[u8]) -> bool {
    let mut words = words(text).filter_map(Result::ok);
    words.any(|word| word.letter == b'M' && word.value.whole() == Some(110))
}

/// Calls `each` with every block until `each` breaks, or the program ends.
///
/// Lines are read one at a time, up to the first one with a parameter, an expression, an O-word or
/// a cycle along a contour. From that line on the program is kept in memory. `reading`
/// returns the state of the machine, which expressions may read.
///
/// # Errors
///
/// Reading fails, or `each` does.
pub fn each_block<C, const N: usize>(
    source: &mut Source,
    dialect: Dialect,
    context: &mut C,
    reading: impl Fn(&C) -> Reading<'_, N>,
    mut each: impl FnMut(&mut C, &Given<'_>, Result<Block, Error>) -> io::Result<ControlFlow<()>>,
) -> io::Result<()> {
    let mut percent = Percent::default();
    let mut give = |given: &Given<'_>, block| each(context, given, block);
    let Some(first) = by_lines(source, dialect, &mut percent, &mut give)? else {
        return Ok(());
    };
    let mut text = source.rest()?;
    without_sums(&mut text, &dialect);
    let text = Text {
        bytes: percent.before_all(&text),
        first,
        subroutines: source.take_subroutines(),
    };
    as_a_whole(&text, dialect, &mut percent, context, reading, each)
}

/// Passes on the blocks of lines that do not depend on other lines. Stops before the first line
/// that does, and returns its number. Returns `None` at the end of the program.
fn by_lines(
    source: &mut Source,
    dialect: Dialect,
    percent: &mut Percent,
    give: &mut impl FnMut(&Given<'_>, Result<Block, Error>) -> io::Result<ControlFlow<()>>,
) -> io::Result<Option<usize>> {
    let mut receiver = dialect.framing().map(Receiver::new);
    loop {
        let Some(line) = source.next_line()? else {
            return Ok(None);
        };
        if percent.ends(line.bytes, &dialect) {
            return Ok(None);
        }
        if needs_program(line.bytes, &dialect) || needs_contours(line.bytes, &dialect) {
            return Ok(Some(line.number));
        }
        let whole = Given {
            file: None,
            number: line.number,
            bytes: line.bytes,
            at: 0,
            text: line.bytes,
            overlong: line.overlong,
            repeats: false,
        };
        let text = match &mut receiver {
            None => match summed(line.bytes, &dialect) {
                None => percent.before(line.bytes),
                Some(Ok(text)) => text,
                Some(Err(error)) => {
                    if give(&whole, Err(error))?.is_break() {
                        return Ok(None);
                    }
                    continue;
                }
            },
            Some(receiver) => match unframed(receiver, line.bytes) {
                // The receiver has already used the number.
                Ok(text) if is_numbering(text) => continue,
                Ok(text) => text,
                Err(error) => {
                    if give(&whole, Err(error))?.is_break() {
                        return Ok(None);
                    }
                    continue;
                }
            },
        };
        let mut blocks = dialect.blocks(text).peekable();
        while let Some((at, text)) = blocks.next() {
            let given = Given {
                at,
                text,
                overlong: line.overlong && blocks.peek().is_none(),
                ..whole
            };
            let block = if is_grbl_command(text, &dialect) {
                Ok(Block::new())
            } else {
                fits(text, &dialect).and_then(|()| Block::parse(text, &dialect))
            };
            if give(&given, block)?.is_break() {
                return Ok(None);
            }
        }
    }
}

/// A program that is kept in memory.
struct Text<'a> {
    bytes: &'a [u8],
    /// Number of its first line.
    first: usize,
    /// Where the files of its subroutines are.
    subroutines: Subroutines,
}

/// Passes on the blocks of a text in the order of execution.
fn as_a_whole<C, const N: usize>(
    text: &Text<'_>,
    dialect: Dialect,
    percent: &mut Percent,
    context: &mut C,
    reading: impl Fn(&C) -> Reading<'_, N>,
    mut each: impl FnMut(&mut C, &Given<'_>, Result<Block, Error>) -> io::Result<ControlFlow<()>>,
) -> io::Result<()> {
    let program = Whole::new(text.bytes, dialect).with_first_line(text.first);
    let mut program = Box::new(program.with_library(&text.subroutines));
    let mut contours = Box::new(Turned::new(text.bytes, dialect));
    let mut repetition = Repetition::default();
    loop {
        let state = reading(context);
        let line = match contours.next_of_cycle(state.modal) {
            Some(line) => line,
            None => {
                let Some(line) = program.next_line(&state) else {
                    return Ok(());
                };
                if percent.ends(line.text, &dialect) {
                    return Ok(());
                }
                let line = contours.take(line, state.modal);
                if let Some((at, number)) = contours.resume() {
                    program.go_to(at, number);
                }
                line
            }
        };
        let given = Given {
            file: line.file.and_then(|name| std::str::from_utf8(name).ok()),
            number: line.number,
            bytes: line.text,
            at: 0,
            text: line.text,
            overlong: false,
            repeats: true,
        };
        let state = || state_of(&(program.clone().with_steps(0), &contours, reading(context)));
        if repetition.is_endless(line.number, state) {
            let endless = Error {
                kind: ErrorKind::Program(Fault::OutOfSteps),
                at: 0,
                end: line.text.trim_ascii_end().len(),
            };
            return each(context, &given, Err(endless)).map(drop);
        }
        let block = match summed(line.text, &dialect) {
            Some(Err(error)) => Err(error),
            _ if is_grbl_command(line.text, &dialect) => Ok(Block::new()),
            _ => line.block,
        };
        if each(context, &given, block)?.is_break() {
            return Ok(());
        }
    }
}

/// Detects a program that returns to the same line in the same state. Such a program never ends,
/// because each state determines the next one.
#[derive(Default)]
struct Repetition {
    /// Lines so far.
    lines: u64,
    /// A line, and the hash of the state after it.
    before: Option<(usize, u64)>,
    /// Comparisons with this state that are still to be made.
    looks: u8,
}

impl Repetition {
    /// A program is examined from this number of executed lines on.
    const SUSPECT: u64 = 1 << 12;
    /// Comparisons with one state. Hashing the state of a large program takes milliseconds.
    const LOOKS: u8 = 4;

    /// Counts a line. Returns whether the state after it equals the state after an earlier
    /// execution of it.
    fn is_endless(&mut self, line: usize, state: impl FnOnce() -> u64) -> bool {
        self.lines += 1;
        // From time to time a newer state replaces the old one, because the repetition may begin
        // late.
        if self.lines >= Self::SUSPECT && self.lines.is_power_of_two() {
            self.before = Some((line, state()));
            self.looks = Self::LOOKS;
            return false;
        }
        match self.before {
            Some((there, before)) if there == line && self.looks > 0 => {
                self.looks -= 1;
                state() == before
            }
            _ => false,
        }
    }
}

/// A hash of a state. Two different states have the same one once in 2^64.
fn state_of(state: &impl Debug) -> u64 {
    struct Sum(DefaultHasher);
    impl fmt::Write for Sum {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            self.0.write(text.as_bytes());
            Ok(())
        }
    }
    let mut sum = Sum(DefaultHasher::new());
    // The sum takes every text.
    let _ = write!(sum, "{state:?}");
    sum.0.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::programs::reading::Results;
    use husillo_gcode::Modal;

    /// The files of some systems end with `M30%`.
    #[test]
    fn a_percent_may_follow_the_last_word() {
        for text in [
            "%\nG0 X1\nM30%\n",
            "%\n#1=1\nG0 X#1\nM2 % ",
            "%\n#1=1\nM30%\r\nrubbish\n",
        ] {
            let mut source = Source::from_reader(Box::new(text.as_bytes()));
            let mut context = Modal::<3>::new(Dialect::RS274);
            let error = |_: &mut _, given: &Given<'_>, block: Result<Block, Error>| {
                assert!(block.is_ok(), "line {} of {text:?}", given.number);
                Ok(ControlFlow::Continue(()))
            };
            each_block(
                &mut source,
                Dialect::RS274,
                &mut context,
                |modal| Reading {
                    modal,
                    results: Results::NONE,
                },
                error,
            )
            .unwrap();
        }
    }

    /// The numbers of the lines whose blocks are passed on.
    fn lines(dialect: Dialect, text: &'static str) -> Vec<usize> {
        let mut source = Source::from_reader(Box::new(text.as_bytes()));
        let mut context = (Modal::<3>::new(dialect), Vec::new());
        each_block(
            &mut source,
            dialect,
            &mut context,
            |context| Reading {
                modal: &context.0,
                results: Results::NONE,
            },
            |context, given, _| {
                context.1.push(given.number);
                Ok(ControlFlow::Continue(()))
            },
        )
        .unwrap();
        context.1
    }

    #[test]
    fn the_second_percent_ends_a_program() {
        let rs274 = |text| lines(Dialect::RS274, text);
        assert_eq!(rs274("\n%\nG0 X1\n % \nG0 X2\n"), [1, 2, 3]);
        assert_eq!(rs274("%\n#1=1\nG0 X#1\n%\nG0 X2\n"), [1, 2, 3]);
        assert_eq!(rs274("G0 X1\n%\nG0 X2\n%\n"), [1, 2, 3, 4]);
        assert_eq!(lines(Dialect::GRBL, "%\nG0 X1\n%\nG0 X2\n"), [1, 2, 3, 4]);
    }
}
