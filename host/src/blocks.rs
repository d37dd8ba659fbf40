//! The blocks of a program in the order of execution.

use crate::source::Source;
use husillo_gcode::contour::{Contours, needs_contours};
use husillo_gcode::parameters::{Program, needs_program};
use husillo_gcode::{Block, Dialect, Error, Modal};
use std::io;
use std::ops::ControlFlow;

/// Room for parameters and calls: far more than a controller has.
type Whole<'t> = Program<'t, 4096, 2048, 128>;

/// Room for the contour of a turning cycle.
type Turned<'t> = Contours<'t, 1024>;

/// A block's place in the file.
#[derive(Clone, Copy, Debug)]
pub struct Given<'a> {
    /// Number of the line, from 1.
    pub number: usize,
    /// The whole line.
    pub bytes: &'a [u8],
    /// Where in it the block stands.
    pub at: usize,
    /// The text of the block.
    pub text: &'a [u8],
    /// Whether the line goes on behind what was read of it, and this is its last block.
    pub overlong: bool,
    /// Whether the line may come again: the program has loops or subroutines.
    pub repeats: bool,
}

/// Calls `each` with every block until it breaks, or the program ends.
///
/// Lines are read one at a time until one has a parameter, an expression, an O-word or a cycle along a contour; from that line
/// on the program is kept in memory, and `modal` tells the state of the machine that its expressions may ask for.
///
/// # Errors
///
/// Those of reading and of `each`.
pub fn each_block<C>(
    source: &mut Source,
    dialect: Dialect,
    context: &mut C,
    modal: impl Fn(&C) -> &Modal<3>,
    mut each: impl FnMut(&mut C, &Given<'_>, Result<Block, Error>) -> io::Result<ControlFlow<()>>,
) -> io::Result<()> {
    let first = loop {
        let Some(line) = source.next_line()? else {
            return Ok(());
        };
        if needs_program(line.bytes, &dialect) || needs_contours(line.bytes, &dialect) {
            break line.number;
        }
        let mut blocks = dialect.blocks(line.bytes).peekable();
        while let Some((at, text)) = blocks.next() {
            let given = Given {
                number: line.number,
                bytes: line.bytes,
                at,
                text,
                overlong: line.overlong && blocks.peek().is_none(),
                repeats: false,
            };
            if each(context, &given, Block::parse(text, &dialect))?.is_break() {
                return Ok(());
            }
        }
    };
    let text = source.rest()?;
    let mut program = Box::new(Whole::new(&text, dialect).with_first_line(first));
    let mut contours = Box::new(Turned::new(&text, dialect));
    loop {
        let state = modal(context);
        let line = match contours.next_of_cycle(state) {
            Some(line) => line,
            None => {
                let Some(line) = program.next_line(state) else {
                    return Ok(());
                };
                let line = contours.take(line, state);
                if let Some((at, number)) = contours.resume() {
                    program.go_to(at, number);
                }
                line
            }
        };
        let given = Given {
            number: line.number,
            bytes: line.text,
            at: 0,
            text: line.text,
            overlong: false,
            repeats: true,
        };
        if each(context, &given, line.block)?.is_break() {
            return Ok(());
        }
    }
}
