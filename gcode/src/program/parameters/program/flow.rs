//! Lines with O-words: their meaning, and where the program continues.

use super::nesting::Kind;
use super::{Place, Program, Raw};
use crate::error::Error;
use crate::error::parameters::Fault;
use crate::program::parameters::expression::Reader;
use crate::program::parameters::statement::{self, Keyword, Label, Statement};
use crate::program::parameters::system::System;
use crate::program::parameters::value::Value;

/// Largest number of arguments of a call.
const ARGUMENTS: usize = 30;

/// A line with an O-word, with its values evaluated.
pub(super) struct Order<'t> {
    pub(super) statement: Statement<'t>,
    /// The condition, the number of rounds or the returned value.
    pub(super) value: Option<Value>,
    pub(super) arguments: [Value; ARGUMENTS],
    pub(super) count: usize,
    /// Position after the last word.
    pub(super) end: usize,
}

impl<'t, const GLOBALS: usize, const LOCALS: usize, const DEPTH: usize, const FILES: usize>
    Program<'t, GLOBALS, LOCALS, DEPTH, FILES>
{
    /// Reads a line with an O-word.
    pub(super) fn order(
        &self,
        raw: &Raw<'t>,
        at: usize,
        system: &impl System,
    ) -> Result<Order<'t>, Error> {
        let lookup = self.lookup_at(raw.place.number, system);
        let mut reader = Reader::new(raw.text, at, lookup);
        let statement = statement::read(&mut reader)?;
        let mut order = Order {
            statement,
            value: None,
            arguments: [Value::ZERO; ARGUMENTS],
            count: 0,
            end: statement.end,
        };
        reader.pass_comments()?;
        match statement.keyword {
            // Reached after a branch that was taken: its condition is irrelevant.
            Keyword::ElseIf if !self.is_choosing => return Ok(order),
            Keyword::If | Keyword::ElseIf | Keyword::While | Keyword::Repeat => {
                order.value = Some(reader.bracketed()?);
            }
            Keyword::Return | Keyword::EndSub if reader.peek() == Some(b'[') => {
                order.value = Some(reader.value()?);
            }
            Keyword::Call => {
                while reader.peek() == Some(b'[') {
                    let value = reader.value()?;
                    let Some(slot) = order.arguments.get_mut(order.count) else {
                        return Err(reader.error(Fault::TooManyArguments, statement.at));
                    };
                    *slot = value;
                    order.count = order.count.wrapping_add(1);
                    reader.pass_comments()?;
                }
            }
            _ => {}
        }
        order.end = reader.end();
        reader.pass_comments()?;
        match reader.peek() {
            None | Some(b';') => Ok(order),
            _ => Err(reader.error_here(Fault::NotAlone)),
        }
    }

    /// Executes a line with an O-word.
    pub(super) fn obey(
        &mut self,
        raw: &Raw<'t>,
        order: &Order<'t>,
        is_outside: bool,
    ) -> Result<(), Fault> {
        let label = order.statement.label;
        let is_true = order.value.is_some_and(|value| !value.is_zero());
        let was_choosing = core::mem::replace(&mut self.is_choosing, false);
        match order.statement.keyword {
            Keyword::Sub => self.pass(label, Keyword::EndSub),
            Keyword::EndSub | Keyword::Return => self.leave(raw, order),
            Keyword::Call => self.call(raw, order, is_outside),
            Keyword::If if is_true => Ok(()),
            Keyword::ElseIf if was_choosing && is_true => Ok(()),
            Keyword::If => self.choose(label),
            Keyword::ElseIf if was_choosing => self.choose(label),
            Keyword::ElseIf | Keyword::Else => self.pass(label, Keyword::EndIf),
            Keyword::EndIf => Ok(()),
            Keyword::While => match self.innermost(label, Kind::Do) {
                Some(inner) if is_true => {
                    self.next = inner.body;
                    Ok(())
                }
                Some(_) => {
                    self.drop_loop();
                    Ok(())
                }
                None if is_true => self.open(raw, label, Kind::While),
                None => self.pass(label, Keyword::EndWhile),
            },
            Keyword::EndWhile => match self.innermost(label, Kind::While) {
                Some(inner) => {
                    self.drop_loop();
                    self.next = inner.begin;
                    Ok(())
                }
                None => Err(Fault::NotOpened),
            },
            Keyword::Do => self.open(raw, label, Kind::Do),
            Keyword::Repeat => {
                let rounds = order.value.unwrap_or(Value::ZERO).rounded_half().digits();
                match rounds {
                    1.. => self.open(raw, label, Kind::Repeat(rounds)),
                    _ => self.pass(label, Keyword::EndRepeat),
                }
            }
            Keyword::EndRepeat => self.repeat(label),
            Keyword::Break => self.leave_loop(raw, label, false),
            Keyword::Continue => self.leave_loop(raw, label, true),
        }
    }

    /// The first line from here on with this label and one of the wanted keywords.
    pub(super) fn find(
        &mut self,
        from: Place,
        label: Label<'_>,
        wanted: impl Fn(Keyword) -> bool,
    ) -> Result<Option<(Raw<'t>, Statement<'t>)>, Fault> {
        let passes_delete = !self.dialect.block_delete();
        let mut place = from;
        while let Some(raw) = self.line_at(place) {
            self.pay(raw.text)?;
            if let Some(seen) = statement::seen(raw.text, passes_delete) {
                if seen.label.is(label) && wanted(seen.keyword) {
                    return Ok(Some((raw, seen)));
                }
            }
            place = raw.after;
        }
        Ok(None)
    }

    /// Continues after the closing line.
    fn pass(&mut self, label: Label<'t>, closing: Keyword) -> Result<(), Fault> {
        // A subroutine must not begin inside another.
        let found = if closing == Keyword::EndSub {
            self.find_end_of_sub(label)?
        } else {
            self.find(self.next, label, |keyword| keyword == closing)?
        };
        let (raw, _) = found.ok_or(Fault::NotClosed)?;
        self.next = raw.after;
        Ok(())
    }

    fn find_end_of_sub(
        &mut self,
        label: Label<'t>,
    ) -> Result<Option<(Raw<'t>, Statement<'t>)>, Fault> {
        let passes_delete = !self.dialect.block_delete();
        let mut place = self.next;
        while let Some(raw) = self.line_at(place) {
            self.pay(raw.text)?;
            match statement::seen(raw.text, passes_delete) {
                Some(seen) if seen.keyword == Keyword::EndSub && seen.label.is(label) => {
                    return Ok(Some((raw, seen)));
                }
                Some(seen) if seen.keyword == Keyword::Sub => return Err(Fault::NestedSubroutine),
                _ => {}
            }
            place = raw.after;
        }
        Ok(None)
    }

    /// An `if` whose condition is false: continues at its next `elseif`, or after its `else` or
    /// `endif`.
    fn choose(&mut self, label: Label<'t>) -> Result<(), Fault> {
        let wanted = |keyword| matches!(keyword, Keyword::ElseIf | Keyword::Else | Keyword::EndIf);
        let found = self.find(self.next, label, wanted)?;
        let (branch, seen) = found.ok_or(Fault::NotClosed)?;
        self.is_choosing = seen.keyword == Keyword::ElseIf;
        self.next = if self.is_choosing {
            branch.place
        } else {
            branch.after
        };
        Ok(())
    }
}
