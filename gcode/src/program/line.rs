//! One line of a program, with its block.

use crate::blocks::block::Block;
use crate::error::Error;

/// One line of a program, in the order of execution.
#[derive(Clone, Debug)]
pub struct Line<'t> {
    /// Its number in the text, from 1.
    pub number: usize,
    /// Its first byte in the text.
    pub at: usize,
    /// The file that the line is in; `None` for the text of the program itself.
    pub file: Option<&'t [u8]>,
    /// The line, without its end.
    pub text: &'t [u8],
    /// The line as a block of plain numbers, or its error; columns are those of the line. The block
    /// is empty for an O-word, and a move where a contour cycle is expanded.
    pub block: Result<Block, Error>,
}

/// Splits the first line off a text, without its end (CR, LF or CR LF; none at the end of the
/// text). Returns it and the rest; `None` for an empty text. All code that splits a text into lines
/// uses this rule.
pub(crate) fn first_line(text: &[u8]) -> Option<(&[u8], &[u8])> {
    if text.is_empty() {
        return None;
    }
    let end = text.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
    let (line, rest) = text.split_at_checked(end.unwrap_or(text.len()))?;
    let behind = match rest {
        [b'\r', b'\n', behind @ ..] | [_, behind @ ..] => behind,
        [] => rest,
    };
    Some((line, behind))
}
