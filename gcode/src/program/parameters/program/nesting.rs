//! Nested subroutines and loops.

use super::flow::Order;
use super::{Place, Program, Raw};
use crate::error::parameters::Fault;
use crate::program::parameters::statement::{Keyword, Label, Statement};
use crate::program::parameters::value::Value;

/// A running subroutine.
#[derive(Copy, Clone, Debug)]
pub(super) struct Call<'t> {
    pub(super) label: Label<'t>,
    /// The line of its `sub`.
    pub(super) begin: Place,
    /// Position after the line of the call.
    pub(super) after: Place,
    /// Argument of [`Table::leave`].
    pub(super) locals: usize,
    /// Number of loops that ran outside.
    pub(super) loops: usize,
    /// Number of rounds of a subprogram (M98) that are left, this one included; `None` for other
    /// calls.
    pub(super) rounds: Option<u32>,
}

#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(super) enum Kind {
    While,
    Do,
    /// Number of remaining rounds, including this one.
    Repeat(i64),
}

impl Kind {
    /// The keyword of the line that ends it.
    const fn end(self) -> Keyword {
        match self {
            Kind::While => Keyword::EndWhile,
            Kind::Do => Keyword::While,
            Kind::Repeat(_) => Keyword::EndRepeat,
        }
    }
}

/// A running loop.
#[derive(Copy, Clone, Debug)]
pub(super) struct Loop<'t> {
    pub(super) label: Label<'t>,
    pub(super) kind: Kind,
    /// The line that opens it.
    pub(super) begin: Place,
    /// Position after that line.
    pub(super) body: Place,
}

impl<'t, const GLOBALS: usize, const LOCALS: usize, const DEPTH: usize, const FILES: usize>
    Program<'t, GLOBALS, LOCALS, DEPTH, FILES>
{
    /// The `sub` line of a subroutine.
    ///
    /// It is searched in the text of its caller, in that of the program, and in a file of its own.
    fn subroutine(&mut self, caller: Place, label: Label<'t>) -> Result<Raw<'t>, Fault> {
        let is_known =
            |&&(file, known, _): &&(u8, Label<'_>, Place)| file == caller.file && known.is(label);
        let known = self.remembered.iter().flatten().find(is_known);
        if let Some(raw) = known.and_then(|&(_, _, place)| self.line_at(place)) {
            return Ok(raw);
        }
        let mut found = self.subroutine_in(self.first_of(caller), label)?;
        if found.is_none() && caller.file != 0 {
            found = self.subroutine_in(self.first, label)?;
        }
        let (raw, seen) = match found {
            Some(found) => found,
            None => {
                let file = self.open_file(label)?;
                let found = self.subroutine_in(file, label)?;
                found.ok_or(Fault::NoSuchSubroutine)?
            }
        };
        if let Some(slot) = self.remembered.get_mut(self.remembered_count) {
            *slot = Some((caller.file, seen.label, raw.place));
            self.remembered_count = self.remembered_count.wrapping_add(1);
        }
        Ok(raw)
    }

    fn subroutine_in(
        &mut self,
        first: Place,
        label: Label<'_>,
    ) -> Result<Option<(Raw<'t>, Statement<'t>)>, Fault> {
        self.find(first, label, |keyword| keyword == Keyword::Sub)
    }

    /// Begins a subroutine. A subroutine of the text precedes an outside one of the same name.
    pub(super) fn call(
        &mut self,
        raw: &Raw<'t>,
        order: &Order<'t>,
        is_outside: bool,
    ) -> Result<(), Fault> {
        let label = order.statement.label;
        let (begin, next, outside) = match self.subroutine(raw.place, label) {
            Ok(sub) => (sub.place, sub.after, None),
            Err(Fault::NoSuchSubroutine) if is_outside => (raw.place, raw.after, Some(order.count)),
            Err(fault) => return Err(fault),
        };
        let slot = self.calls.get_mut(self.call_count).ok_or(Fault::TooDeep)?;
        let arguments = order.arguments.get(..order.count).unwrap_or_default();
        *slot = Some(Call {
            label,
            begin,
            after: raw.after,
            locals: self.table.enter(arguments)?,
            loops: self.loop_count,
            rounds: None,
        });
        self.call_count = self.call_count.wrapping_add(1);
        self.next = next;
        self.outside = outside;
        Ok(())
    }

    pub(super) fn current_call(&self) -> Option<Call<'t>> {
        let last = self.call_count.checked_sub(1)?;
        self.calls.get(last).copied().flatten()
    }

    pub(super) fn leave(&mut self, raw: &Raw<'t>, order: &Order<'t>) -> Result<(), Fault> {
        let is_end = order.statement.keyword == Keyword::EndSub;
        let missing = if is_end {
            Fault::NotOpened
        } else {
            Fault::NoCall
        };
        let call = self.current_call().ok_or(missing)?;
        // A return may have any label, as in LinuxCNC.
        if is_end && !call.label.is(order.statement.label) || call.rounds.is_some() {
            return Err(missing);
        }
        #[cfg(feature = "extended")]
        self.saved.end(self.call_count, raw);
        #[cfg(not(feature = "extended"))]
        let _ = raw;
        self.drop_call(order.value);
        Ok(())
    }

    /// Ends the running subroutine and continues after its call.
    pub(super) fn drop_call(&mut self, returned: Option<Value>) {
        if let Some(call) = self.current_call() {
            self.returned = returned;
            if call.rounds.is_none() {
                self.table.leave(call.locals);
            }
            self.loop_count = call.loops;
            self.call_count = self.call_count.wrapping_sub(1);
            self.next = call.after;
        }
    }

    /// The innermost loop of this subroutine, if it is this one.
    pub(super) fn innermost(&self, label: Label<'t>, kind: Kind) -> Option<Loop<'t>> {
        let outside = self.current_call().map_or(0, |call| call.loops);
        let last = self
            .loop_count
            .checked_sub(1)
            .filter(|&last| last >= outside)?;
        let inner = self.loops.get(last).copied().flatten()?;
        let is_kind = core::mem::discriminant(&inner.kind) == core::mem::discriminant(&kind);
        (is_kind && inner.label.is(label)).then_some(inner)
    }

    pub(super) fn open(
        &mut self,
        raw: &Raw<'t>,
        label: Label<'t>,
        kind: Kind,
    ) -> Result<(), Fault> {
        let slot = self.loops.get_mut(self.loop_count).ok_or(Fault::TooDeep)?;
        *slot = Some(Loop {
            label,
            kind,
            begin: raw.place,
            body: raw.after,
        });
        self.loop_count = self.loop_count.wrapping_add(1);
        Ok(())
    }

    pub(super) fn drop_loop(&mut self) {
        self.loop_count = self.loop_count.saturating_sub(1);
    }

    /// `endrepeat`.
    pub(super) fn repeat(&mut self, label: Label<'t>) -> Result<(), Fault> {
        let inner = self
            .innermost(label, Kind::Repeat(0))
            .ok_or(Fault::NotOpened)?;
        self.drop_loop();
        let Kind::Repeat(rounds @ 2..) = inner.kind else {
            return Ok(());
        };
        self.next = inner.body;
        if let Some(slot) = self.loops.get_mut(self.loop_count) {
            *slot = Some(Loop {
                kind: Kind::Repeat(rounds.wrapping_sub(1)),
                ..inner
            });
            self.loop_count = self.loop_count.wrapping_add(1);
        }
        Ok(())
    }

    /// `break` and `continue`: ends all loops inside this one, then continues after its end or with
    /// its next round.
    pub(super) fn leave_loop(
        &mut self,
        raw: &Raw<'t>,
        label: Label<'t>,
        goes_on: bool,
    ) -> Result<(), Fault> {
        let outside = self.current_call().map_or(0, |call| call.loops);
        let inner = loop {
            let last = self
                .loop_count
                .checked_sub(1)
                .filter(|&last| last >= outside);
            let inner = self
                .loops
                .get(last.ok_or(Fault::NoLoop)?)
                .copied()
                .flatten();
            match inner {
                Some(inner) if inner.label.is(label) => break inner,
                _ => self.drop_loop(),
            }
        };
        if goes_on && inner.kind == Kind::While {
            self.drop_loop();
            self.next = inner.begin;
            return Ok(());
        }
        let closing = inner.kind.end();
        let found = self.find(raw.after, label, |keyword| keyword == closing)?;
        let (end, _) = found.ok_or(Fault::NotClosed)?;
        if goes_on {
            // The line that ends the loop decides.
            self.next = end.place;
        } else {
            self.drop_loop();
            self.next = end.after;
        }
        Ok(())
    }
}
