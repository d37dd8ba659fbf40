//! A board in the form that the options ask for.

use super::drill_records::{Compiler, Refusal};
use super::{listing, uncut, work};
use crate::cli::{DrillOutput, Holes, Output};
use husillo_holes::{Board, Work};
use husillo_simulator::diagnostics::Findings;

/// Makes a list, G-code or records of the drill.
pub struct Maker<'a> {
    args: &'a Holes,
    /// For G-code.
    work: Option<Work>,
}

impl<'a> Maker<'a> {
    /// Reads the options.
    ///
    /// # Errors
    ///
    /// The options of the G-code are wrong.
    pub fn new(args: &'a Holes) -> Result<Self, String> {
        let work = match args.make {
            DrillOutput::Gcode => Some(work(args)?),
            DrillOutput::List | DrillOutput::Drill => None,
        };
        Ok(Maker { args, work })
    }

    /// The bytes of the output. A list contains the findings, if it is JSON.
    ///
    /// # Errors
    ///
    /// A slot cannot be cut, or the board does not fit in the records.
    pub fn make(&self, board: &Board, name: &str, findings: &Findings) -> Result<Vec<u8>, Refusal> {
        let mut made = Vec::new();
        let format = self.args.format;
        match (&self.work, self.args.make) {
            (Some(work), _) => {
                work.check(board).map_err(|error| uncut(&error))?;
                work.write(board, name, &mut made)?;
            }
            (None, DrillOutput::Drill) => {
                let compiler = Compiler::new(&self.args.layout);
                let tools = compiler.compile(board, name)?;
                match format {
                    Output::Text => made = compiler.bytes(&tools, name)?,
                    Output::Json => compiler.print_json(&tools, &mut made)?,
                }
            }
            (None, _) => match format {
                Output::Text => listing::print(board, name, &mut made)?,
                Output::Json => listing::print_json(board, findings, &mut made)?,
            },
        }
        Ok(made)
    }
}
