//! Programs of one dialect, written for another one.
//!
//! ```text
//! line ──► its commands ──┬─ the other dialect gives the same: the line stays, in normal form
//!                         └─ otherwise one line for each command; cycles and expressions are moves
//! ```

mod line;

use self::line::Text;
use crate::blocks::block::Block;
use crate::codes::dialect::{Dialect, Flavour};
use crate::command::{Command, PathMode};
use crate::compensation::Compensation;
use crate::error::{Error, ErrorKind};
use crate::modal::Modal;
use crate::program::format::formatted;
use crate::values::nm::Nm;
use crate::words::comment::comment_length;

/// Longest line of Grbl without blanks and comments.
const GRBL_LINE: usize = 79;

/// Writes the lines of a program for another dialect.
///
/// Each line is compared by its meaning: by its commands in both dialects. If the other dialect
/// does not have the line, or gives it another meaning, the line is written as the moves that it
/// makes. So cycles that the dialect lacks, loops, parameters and subroutines become moves, and
/// cutter compensation becomes the path of the tool. Such lines are in absolute millimetres, which
/// are exact. Later lines that depend on a different mode are rewritten, too.
///
/// Codes that only change the state of rewritten lines are left out. Path modes that the other
/// dialect lacks are left out, too.
///
/// # Examples
/// ```
/// use husillo_gcode::{Block, Dialect, Translator};
///
/// let mut translator = Translator::<3>::new(Dialect::RS274, Dialect::GRBL);
/// let mut text = Vec::new();
/// for line in ["G20 G90 (inches) F10", "G0 X1", "G98 G81 X2 Z-.1 R.1 (hole)", "X3", "M2"] {
///     let block = Block::parse(line.as_bytes(), &Dialect::RS274)?;
///     let done = translator.line(line.as_bytes(), &block, &mut |piece| text.extend(piece));
///     assert!(done.is_ok());
/// }
/// assert_eq!(String::from_utf8_lossy(&text), "G20 G90 (inches) F10\nG0 X1\nG21\nG0 Z2.54\n\
///     G0 X50.8\nG1 Z-2.54\nG0 Z2.54 (hole)\nG0 X76.2\nG1 Z-2.54\nG0 Z2.54\nM2\n");
/// # Ok::<(), husillo_gcode::Error>(())
/// ```
///
/// # Cost
/// Each line is read and planned twice, and each command of a rewritten line once more.
#[derive(Clone, Debug)]
pub struct Translator<const N: usize> {
    source: Modal<N>,
    target: Modal<N>,
    /// The path of the tool, for a dialect without cutter compensation.
    stage: Option<Compensation<N>>,
}

/// The form of a translated line.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub enum Translated {
    /// The line in normal form.
    Kept,
    /// Other lines, or only the comments of the line.
    Rewritten,
}

/// Why a line is not, or not completely, translated.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub enum Untranslated<const N: usize> {
    /// The line has an error in its own dialect. Nothing is written.
    Error(Error),
    /// The other dialect has no such command. The commands before and after it are written.
    Command(Command<N>),
}

impl<const N: usize> Translator<N> {
    /// Creates a translator at the start of a program.
    pub fn new(from: Dialect, to: Dialect) -> Self {
        let target = Modal::new(to);
        let compensates = Block::parse(b"G41.1 D1", &to).is_ok();
        Translator {
            source: Modal::new(from),
            stage: (!compensates).then(|| Compensation::new(target.position())),
            target,
        }
    }

    /// The state after the last line, for
    /// [`Program::next_line`](crate::parameters::Program::next_line).
    pub fn modal(&self) -> &Modal<N> {
        &self.source
    }

    /// The state of the other dialect after the lines that were written.
    pub fn target(&self) -> &Modal<N> {
        &self.target
    }

    /// Translates a line with its block. Passes the pieces of the lines of the other dialect to
    /// `out`. Each line ends with LF.
    ///
    /// # Errors
    /// The line has an error, or a command that the other dialect lacks: the first of them.
    pub fn line<Out: FnMut(&[u8])>(
        &mut self,
        text: &[u8],
        block: &Block,
        out: &mut Out,
    ) -> Result<Translated, Untranslated<N>> {
        let (next, commands) = self.source.plan(block).map_err(Untranslated::Error)?;
        // A copy, as a kept line has the commands of the block itself.
        let wanted = commands.clone();
        let made = match &mut self.stage {
            Some(stage) => {
                let (after, made) = stage.plan(commands).map_err(|kind| wrong(kind, text))?;
                *stage = after;
                Some(made)
            }
            None => None,
        };
        self.source = next;
        let compensates = self.stage.as_ref().is_some_and(Compensation::is_active);
        if !compensates {
            if let Some(kept) = self.kept(text, wanted.clone()) {
                self.target = kept;
                self.write_kept(text, out);
                return Ok(Translated::Kept);
            }
        }
        let mut comments = Comments::of(text);
        let done = match made {
            Some(made) => self.write_all(made, &mut comments, out),
            None => self.write_all(wanted, &mut comments, out),
        };
        comments.finish(out);
        done.map(|()| Translated::Rewritten)
    }

    /// Passes on the last move of a program that ends under cutter compensation.
    ///
    /// # Errors
    /// As [`Translator::line`].
    pub fn finish<Out: FnMut(&[u8])>(&mut self, out: &mut Out) -> Result<(), Untranslated<N>> {
        match self.stage.clone() {
            Some(stage) if stage.is_active() => {
                self.write_all(stage.finish(), &mut Comments::of(b""), out)
            }
            _ => Ok(()),
        }
    }

    /// The state of the other dialect after the same line, if it has the same commands there.
    fn kept(&self, text: &[u8], mut wanted: impl Iterator<Item = Command<N>>) -> Option<Modal<N>> {
        let to = self.target.dialect();
        let is_grbl = to.flavour == Flavour::Grbl;
        if is_grbl && (text.contains(&b'%') || length(text) > GRBL_LINE) {
            return None;
        }
        if has_nested(text) {
            return None; // Grbl ends a comment at its first `)`, and LinuxCNC refuses this one.
        }
        let is_iso = to.flavour == Flavour::Iso;
        if is_iso && text.contains(&b';') {
            return None;
        }
        let block = Block::parse(text, to).ok()?;
        let (next, mut given) = self.target.plan(&block).ok()?;
        if is_grbl && block.axes() == 0 && given.clone().any(|made| made.end().is_some()) {
            return None; // Grbl needs axis words for a full circle; G28 is written as its moves.
        }
        loop {
            match (given.next(), wanted.next()) {
                (None, None) => return Some(next),
                (Some(Command::Arc { arc, .. }), _) if is_grbl && arc.turns != 0 => return None,
                (Some(given), Some(wanted)) if is_same(&given, &wanted) => {}
                _ => return None,
            }
        }
    }

    fn write_kept(&self, text: &[u8], out: &mut impl FnMut(&[u8])) {
        match formatted(text, self.target.dialect()) {
            Ok(pieces) => pieces.for_each(&mut *out),
            Err(_) => out(text.trim_ascii_end()),
        }
        out(b"\n");
    }

    /// Writes lines for commands. Goes on after one that the dialect lacks.
    fn write_all(
        &mut self,
        commands: impl Iterator<Item = Command<N>>,
        comments: &mut Comments<'_>,
        out: &mut impl FnMut(&[u8]),
    ) -> Result<(), Untranslated<N>> {
        let mut done = Ok(());
        let mut last: Option<Text> = None;
        for command in commands {
            if self.is_idle(&command) {
                continue;
            }
            match self.write(&command, &mut last, out) {
                Some(()) => {}
                None if self.may_lack(&command) => {}
                None => done = done.and(Err(Untranslated::Command(command))),
            }
        }
        if let Some(last) = last {
            out(last.bytes());
            comments.append(out);
            out(b"\n");
        }
        done
    }

    /// Whether a command changes nothing.
    fn is_idle(&self, command: &Command<N>) -> bool {
        match command {
            Command::Rapid { to } | Command::Linear { to, .. } => *to == self.target.position(),
            Command::ToolLength { offset, .. } => *offset == self.target.tool_length(),
            // Grbl passes all corners alike.
            Command::Path { .. } => self.target.dialect().flavour == Flavour::Grbl,
            // The moves are those of the tool already.
            Command::Compensation { .. } => self.stage.is_some(),
            _ => false,
        }
    }

    /// Whether a command may be left out in a dialect that lacks it: how corners are passed.
    fn may_lack(&self, command: &Command<N>) -> bool {
        matches!(
            command,
            Command::Path {
                mode: PathMode::ExactPath | PathMode::ExactStop | PathMode::Blend { .. }
            }
        )
    }

    /// Writes the lines of a command. The last one is kept in `last`, as comments may follow it.
    /// `None`, with nothing written, if the dialect lacks it.
    fn write(
        &mut self,
        command: &Command<N>,
        last: &mut Option<Text>,
        out: &mut impl FnMut(&[u8]),
    ) -> Option<()> {
        let mut state = self.target.clone();
        let mut lines = [const { None }; line::MOST];
        let count = line::write(command, &mut state, &mut lines)?;
        self.target = state;
        for text in lines.into_iter().take(count).flatten() {
            if let Some(before) = last.replace(text) {
                out(before.bytes());
                out(b"\n");
            }
        }
        Some(())
    }
}

fn wrong<const N: usize>(kind: ErrorKind, text: &[u8]) -> Untranslated<N> {
    Untranslated::Error(Error {
        kind,
        at: 0,
        end: text.trim_ascii_end().len(),
    })
}

/// The length of a line without blanks and comments.
fn length(text: &[u8]) -> usize {
    let (mut depth, mut length) = (0usize, 0usize);
    for byte in text {
        match byte {
            b'(' => depth = depth.wrapping_add(1), // at most the length
            b')' => depth = depth.saturating_sub(1),
            b';' if depth == 0 => break,
            b' ' | b'\t' | b'\r' => {}
            _ if depth == 0 => length = length.wrapping_add(1), // at most that of the text
            _ => {}
        }
    }
    length
}

/// Whether a comment has a parenthesis inside.
fn has_nested(text: &[u8]) -> bool {
    let mut is_comment = false;
    for byte in text {
        match byte {
            b'(' if is_comment => return true,
            b'(' => is_comment = true,
            b')' => is_comment = false,
            b';' if !is_comment => return false,
            _ => {}
        }
    }
    false
}

/// Whether two commands have the same effect: numbers in tables, and the digits that the words of
/// an arc were printed with, do not matter.
pub(crate) fn is_same<const N: usize>(a: &Command<N>, b: &Command<N>) -> bool {
    match (a, b) {
        (
            Command::Arc { arc: a, feed },
            Command::Arc {
                arc: b,
                feed: other,
            },
        ) => {
            let shape = |arc: &crate::Arc<N>| (arc.to, arc.plane, arc.direction, arc.turns);
            // The centre of an arc by its radius is rounded.
            let near = |a: &Nm, b: &Nm| a.0.abs_diff(b.0) <= 1;
            let centres = a.centre.iter().zip(&b.centre);
            shape(a) == shape(b) && feed == other && centres.into_iter().all(|(a, b)| near(a, b))
        }
        (Command::ToolLength { offset: a, .. }, Command::ToolLength { offset: b, .. }) => a == b,
        _ => a == b,
    }
}

/// The comments of a line that is written anew.
struct Comments<'t> {
    text: &'t [u8],
}

impl<'t> Comments<'t> {
    fn of(text: &'t [u8]) -> Self {
        Comments { text }
    }

    /// The next comment, without its signs.
    fn next(&mut self) -> Option<&'t [u8]> {
        let start = self
            .text
            .iter()
            .position(|byte| matches!(byte, b'(' | b';'))?;
        let rest = self.text.get(start..)?;
        let inside = rest.get(1..).unwrap_or_default();
        if rest.first() == Some(&b';') {
            self.text = &[];
            return Some(inside.trim_ascii());
        }
        let length = comment_length(rest).unwrap_or(rest.len());
        self.text = rest.get(length..).unwrap_or_default();
        // Without the parenthesis at its end.
        inside.get(..length.saturating_sub(2))
    }

    /// Writes all comments behind a line. Parentheses within them become brackets.
    fn append(&mut self, out: &mut impl FnMut(&[u8])) {
        while let Some(comment) = self.next() {
            out(b" (");
            self.piece(comment, out);
        }
    }

    /// Writes the comments that are left as a line of their own.
    fn finish(&mut self, out: &mut impl FnMut(&[u8])) {
        let mut is_first = true;
        while let Some(comment) = self.next() {
            out(if is_first { b"(" } else { b" (" });
            is_first = false;
            self.piece(comment, out);
        }
        if !is_first {
            out(b"\n");
        }
    }

    fn piece(&self, comment: &[u8], out: &mut impl FnMut(&[u8])) {
        let is_parenthesis = |byte: &u8| matches!(byte, b'(' | b')');
        let mut rest = comment;
        while let Some(end) = rest.iter().position(is_parenthesis) {
            out(rest.get(..end).unwrap_or_default());
            let is_opening = rest.get(end) == Some(&b'(');
            out(if is_opening { b"[" } else { b"]" });
            // Below the length.
            rest = rest.get(end.wrapping_add(1)..).unwrap_or_default();
        }
        out(rest);
        out(b")");
    }
}
