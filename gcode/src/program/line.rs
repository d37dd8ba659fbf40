//! One line of a program, with what it says.

use crate::blocks::block::Block;
use crate::error::Error;

/// One line of a program, in the order of execution.
#[derive(Clone, Debug)]
pub struct Line<'t> {
    /// Its number in the text, from 1.
    pub number: usize,
    /// Its first byte in the text.
    pub at: usize,
    /// The line, without its end.
    pub text: &'t [u8],
    /// The line as a block of plain numbers (empty where an O-word steers, a move where a contour
    /// cycle is worked out), or what is wrong with it; columns are those of the line.
    pub block: Result<Block, Error>,
}

/// The first line of a text without its end (CR, LF or CR LF; none at the end of the text), and
/// what stands behind it; `None` for an empty text. The one rule for all who cut a text into lines.
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
