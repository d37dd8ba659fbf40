//! Subprograms (M98, M99), and the codes that save modes (M70 to M73).

use super::nesting::Call;
use super::{Place, Program, Raw};
use crate::blocks::block::Block;
use crate::blocks::fault::{Fault as BlockFault, Reason};
use crate::codes::code::{Code, Group};
use crate::codes::dialect::Flavour;
use crate::error::parameters::Fault;
use crate::error::{Error, ErrorKind};
use crate::program::parameters::statement::{self, Label};
use crate::program::parameters::system::System;
use crate::values::nm::{Measure, Nm};

/// A number of a word of a flow code.
fn number(block: &mut Block, letter: u8) -> Result<Option<u32>, Error> {
    let range = |block: &Block| {
        let fault = BlockFault::at(Reason::OutOfRange, letter);
        block.error(fault, Measure::of(Nm(0)))
    };
    match block.word(letter) {
        None => Ok(None),
        Some(value) => {
            let whole = value.whole().and_then(|value| u32::try_from(value).ok());
            let number = whole.ok_or_else(|| range(block))?;
            block.take_word(letter);
            Ok(Some(number))
        }
    }
}

impl<'t, const GLOBALS: usize, const LOCALS: usize, const DEPTH: usize, const FILES: usize>
    Program<'t, GLOBALS, LOCALS, DEPTH, FILES>
{
    /// Executes the code of a block that needs the lines around it, and removes it and its words.
    /// The rest of the block is executed before the line at which the program continues.
    pub(super) fn follow(
        &mut self,
        raw: &Raw<'t>,
        mut block: Block,
        system: &impl System,
    ) -> Result<Block, Error> {
        let Some((code, group)) = block.flow_code() else {
            return Ok(block);
        };
        // The columns of the code, for its errors.
        let place = block.error(
            BlockFault::at_code(Reason::NeedsProgram, group),
            Measure::of(Nm(0)),
        );
        let modes = match code {
            Code::SaveModes | Code::SaveModesOfCaller => system.modes(),
            _ => None,
        };
        let level = self.call_count;
        let done = match code {
            Code::CallProgram => {
                let (number, rounds) = self.subprogram_words(&mut block)?;
                block.set_code(group, None);
                self.call_program(raw, number, rounds)
            }
            Code::Return => {
                let line = number(&mut block, b'P')?;
                let ends = self.current_call().is_none();
                block.set_code(group, ends.then_some(Code::End));
                if ends {
                    Ok(())
                } else {
                    self.end_program(raw, line)
                }
            }
            _ => {
                block.set_code(group, None);
                match code {
                    Code::SaveModes => self.saved.save(level, modes, false),
                    Code::SaveModesOfCaller => self.saved.save(level, modes, true),
                    Code::RestoreModes => self.saved.restore(level, raw),
                    _ => {
                        self.saved.forget(level);
                        Ok(())
                    }
                }
            }
        };
        done.map_err(|fault| {
            self.is_over = true;
            Error {
                kind: ErrorKind::Program(fault),
                ..place
            }
        })?;
        Ok(block)
    }

    /// The number of the subprogram that M98 calls, and the number of times.
    fn subprogram_words(&self, block: &mut Block) -> Result<(u32, u32), Error> {
        let rounds = number(block, b'L')?;
        let Some(program) = number(block, b'P')? else {
            let fault = BlockFault::at_code(Reason::MissingWord, Group::Stop).of(b'P');
            return Err(block.error(fault, Measure::of(Nm(0))));
        };
        let packed = matches!(self.dialect.flavour, Flavour::Iso | Flavour::LatheA);
        Ok(match rounds {
            None if packed && program > 9999 => (program % 10_000, program / 10_000),
            rounds => (program, rounds.unwrap_or(1)),
        })
    }

    /// M98.
    fn call_program(&mut self, raw: &Raw<'t>, number: u32, rounds: u32) -> Result<(), Fault> {
        let begin = self.subprogram(raw.place, number)?;
        if rounds == 0 {
            return Ok(());
        }
        let slot = self.calls.get_mut(self.call_count).ok_or(Fault::TooDeep)?;
        *slot = Some(Call {
            label: Label::Number(number),
            begin: begin.place,
            after: raw.after,
            // A subprogram has the parameters of its caller.
            locals: 0,
            loops: self.loop_count,
            rounds: Some(rounds),
        });
        self.call_count = self.call_count.wrapping_add(1);
        self.next = begin.after;
        Ok(())
    }

    /// The line `O1234` of a subprogram: in the text of its caller, in that of the program, or in a
    /// file of its own.
    fn subprogram(&mut self, caller: Place, number: u32) -> Result<Raw<'t>, Fault> {
        let wanted = |text: &[u8]| statement::program_number(text) == Some(number);
        let mut found = self.line_with(self.first_of(caller), wanted)?;
        if found.is_none() && caller.file != 0 {
            found = self.line_with(self.first, wanted)?;
        }
        if found.is_none() {
            let file = self.open_file(Label::Number(number))?;
            found = self.line_with(file, wanted)?;
        }
        found.ok_or(Fault::NoSuchSubroutine)
    }

    /// The first line from a position on that is wanted.
    fn line_with(
        &mut self,
        mut place: Place,
        wanted: impl Fn(&[u8]) -> bool,
    ) -> Result<Option<Raw<'t>>, Fault> {
        while let Some(raw) = self.line_at(place) {
            self.pay(raw.text)?;
            if wanted(raw.text) {
                return Ok(Some(raw));
            }
            place = raw.after;
        }
        Ok(None)
    }

    /// M99 of a subprogram. `line` is the number of the line at which the caller continues.
    fn end_program(&mut self, raw: &Raw<'t>, line: Option<u32>) -> Result<(), Fault> {
        let call = self.current_call().ok_or(Fault::NoCall)?;
        let rounds = call.rounds.ok_or(Fault::NoCall)?;
        if let Some(line) = line {
            let first = self.first_of(call.after);
            let wanted = |text: &[u8]| statement::line_number(text) == Some(line);
            let found = self.line_with(first, wanted)?.ok_or(Fault::NoSuchLine)?;
            self.end_call(raw);
            self.next = found.place;
            return Ok(());
        }
        match rounds.checked_sub(1) {
            None | Some(0) => self.end_call(raw),
            Some(left) => {
                let last = self.call_count.wrapping_sub(1);
                if let Some(Some(call)) = self.calls.get_mut(last) {
                    call.rounds = Some(left);
                }
                self.loop_count = call.loops;
                let begin = self.line_at(call.begin).ok_or(Fault::NoCall)?;
                self.next = begin.after;
            }
        }
        Ok(())
    }

    fn end_call(&mut self, raw: &Raw<'t>) {
        self.saved.end(self.call_count, raw);
        let returned = self.returned;
        self.drop_call(returned);
    }
}
