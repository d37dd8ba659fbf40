//! One line of a program, with what it says.

use crate::block::Block;
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
    /// The line as a block of plain numbers (empty where an O-word steers, a move where a contour cycle is worked out),
    /// or what is wrong with it; columns are those of the line.
    pub block: Result<Block, Error>,
}
