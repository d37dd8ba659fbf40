//! Programs with control flow: subroutines, loops, branches.

pub(super) mod files;
mod flow;
#[cfg(feature = "extended")]
mod modes;
mod nesting;
#[cfg(feature = "extended")]
mod subprogram;

use self::files::{File, Library};
#[cfg(feature = "extended")]
use self::modes::Saved;
use self::nesting::{Call, Loop};
use super::line::{Assignments, Evaluated};
use super::statement::{self, Keyword, Label};
use super::system::System;
use super::table::{self, Key, Table};
use super::value::Value;
use crate::blocks::block::Block;
use crate::codes::dialect::Dialect;
use crate::error::parameters::Fault;
use crate::error::{Error, ErrorKind};
use crate::program::line::{Line, first_line};

/// Number of subroutines whose position is cached. Others are searched in the text at each call.
const REMEMBERED: usize = 16;

/// A position between two lines.
#[derive(Copy, Clone, Debug)]
struct Place {
    /// 0 for the text of the program, otherwise the file of this number, from 1.
    file: u8,
    at: usize,
    /// Number of the line after it.
    number: usize,
}

/// The start of the program.
const START: Place = Place {
    file: 0,
    at: 0,
    number: 1,
};

/// A line of the text.
#[derive(Copy, Clone, Debug)]
struct Raw<'t> {
    place: Place,
    text: &'t [u8],
    after: Place,
}

/// A program with parameters, expressions and O-words. It returns its lines in the order of
/// execution, as blocks of plain numbers. The text stays in place (in flash, for example); loops
/// jump back in it.
///
/// `GLOBALS` and `LOCALS` are the numbers of parameters: those that every subroutine sees, and
/// those of all running subroutines together. `DEPTH` is the largest number of nested calls, and of
/// nested loops. `FILES` is the largest number of files with subroutines ([`Library`]). With the
/// defaults the whole takes at most 9.5 kB.
///
/// # Subprograms
/// `M98 P1234 L5` calls the lines from `O1234` (alone on its line) to `M99` five times, with the
/// same parameters. `M99 P20` continues at `N20` of the caller. In the main program M99 ends it, as
/// M2 does; a real control would begin again. In `iso` and `lathe-a`, if P has more than four
/// digits, the digits before the last four are the number of times.
///
/// # Saved modes
/// After M72, and at the end of a subroutine with M73, up to four more blocks of that line restore
/// the modes that M70 or M73 saved.
///
/// # Errors
/// An error on a line with control flow ends the program, and so does a lack of room. After any
/// other error the caller may continue, as after a wrong line of a plain program. The assignments
/// of that line are not made.
///
/// # Cost
/// A line costs one step, and another for every 64 bytes. Lines skipped in the search for an
/// `endif` or a subroutine cost the same. A program that has used up its steps ends with E0638, so
/// every program ends. The positions of the first 16 subroutines that are called are stored. A call
/// of another one costs a search from the start of the text.
///
/// # Examples
/// ```
/// use husillo_gcode::{Dialect, Modal, parameters::Program};
///
/// let text = b"#1 = 3\no1 while [#1 gt 0]\nG0 X[#1 * 0.5]\n#1 = [#1 - 1]\no1 endwhile\n";
/// let mut program: Program = Program::new(text, Dialect::RS274);
/// let mut modal = Modal::<3>::new(Dialect::RS274);
/// let mut printed = Vec::new();
/// while let Some(line) = program.next_line(&modal) {
///     let (next, commands) = modal.plan(&line.block?)?;
///     printed.extend(commands.map(|command| format!("{}: {command}", line.number)));
///     modal = next;
/// }
/// assert_eq!(printed, ["3: rapid X1.5 Y0 Z0", "3: rapid X1 Y0 Z0", "3: rapid X0.5 Y0 Z0"]);
/// # Ok::<(), husillo_gcode::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Program<
    't,
    const GLOBALS: usize = 64,
    const LOCALS: usize = 96,
    const DEPTH: usize = 10,
    const FILES: usize = 4,
> {
    text: &'t [u8],
    library: Option<&'t dyn Library>,
    files: [Option<File<'t>>; FILES],
    dialect: Dialect,
    first: Place,
    next: Place,
    table: Table<'t, GLOBALS, LOCALS>,
    calls: [Option<Call<'t>>; DEPTH],
    call_count: usize,
    loops: [Option<Loop<'t>>; DEPTH],
    loop_count: usize,
    /// The text of the caller, the label and the position of a subroutine.
    remembered: [Option<(u8, Label<'t>, Place)>; REMEMBERED],
    remembered_count: usize,
    steps_left: u64,
    /// `#<_value>`, if the last subroutine returned one.
    returned: Option<Value>,
    /// Number of arguments of the call that the last line passed to the caller.
    outside: Option<usize>,
    /// Whether the next line is an `elseif` whose condition counts.
    is_choosing: bool,
    is_over: bool,
    #[cfg(feature = "extended")]
    saved: Saved<'t>,
}

impl<'t, const GLOBALS: usize, const LOCALS: usize, const DEPTH: usize, const FILES: usize>
    Program<'t, GLOBALS, LOCALS, DEPTH, FILES>
{
    /// The default number of steps of a program.
    pub const STEPS: u64 = 10_000_000;

    /// Creates a program at its first line. In dialects without parameters it returns the lines
    /// unchanged.
    pub const fn new(text: &'t [u8], dialect: Dialect) -> Self {
        Program {
            text,
            library: None,
            files: [None; FILES],
            dialect,
            first: START,
            next: START,
            table: Table::new(),
            calls: [None; DEPTH],
            call_count: 0,
            loops: [None; DEPTH],
            loop_count: 0,
            remembered: [None; REMEMBERED],
            remembered_count: 0,
            steps_left: Self::STEPS,
            returned: None,
            outside: None,
            is_choosing: false,
            is_over: false,
            #[cfg(feature = "extended")]
            saved: Saved::NONE,
        }
    }

    /// Sets the number of steps.
    pub const fn with_steps(mut self, steps: u64) -> Self {
        self.steps_left = steps;
        self
    }

    /// Sets the number of the first line, for a text that is part of a longer one.
    pub const fn with_first_line(mut self, number: usize) -> Self {
        self.first.number = number;
        self.next.number = number;
        self
    }

    /// Continues with another line: the byte where it begins, and its number. For a caller that has
    /// already returned the lines between, as [`Contours`](crate::program::contour::Contours) does;
    /// running loops and calls stay.
    pub fn go_to(&mut self, at: usize, number: usize) {
        self.next = Place {
            file: 0,
            at,
            number,
        };
    }

    /// Number of steps left.
    pub const fn steps_left(&self) -> u64 {
        self.steps_left
    }

    /// The name of the subroutine that the last line calls, if the [`System`] has it (`bore` of
    /// `o<bore> call`), and the number of its arguments. Until the next line the arguments are the
    /// [`parameter`](Program::parameter)s #1, #2, ... The block of the line is empty; the caller
    /// executes the subroutine before it asks for the next line.
    pub fn outside_call(&self) -> Option<(&'t [u8], usize)> {
        let count = self.outside?;
        match self.current_call()?.label {
            Label::Name(name) => Some((name, count)),
            Label::Number(_) => None,
        }
    }

    /// Number of running subroutines.
    pub const fn call_level(&self) -> usize {
        self.call_count
    }

    /// The present value of a numbered parameter; zero before its first assignment. System
    /// parameters are not included.
    pub fn parameter(&self, number: u16) -> Value {
        self.table.get(Key::Number(number)).unwrap_or(Value::ZERO)
    }

    /// The value of a named parameter (`b"_depth"`), `None` before its first assignment.
    pub fn named_parameter(&self, name: &[u8]) -> Option<Value> {
        self.table.get(Key::Name(name))
    }

    /// Sets a numbered parameter (1 to 5602), as an assignment would.
    ///
    /// # Errors
    /// The number is out of range, or there is no room.
    pub fn set_parameter(&mut self, number: u16, value: Value) -> Result<(), Fault> {
        let key = Key::numbered(Value::from(i32::from(number))).ok_or(Fault::NoSuchParameter)?;
        self.table.set(key, value)
    }

    /// Sets a named parameter, as an assignment would.
    ///
    /// # Errors
    /// There is no room.
    pub fn set_named_parameter(&mut self, name: &'t [u8], value: Value) -> Result<(), Fault> {
        self.table.set(Key::Name(name), value)
    }

    /// Returns the next line; `None` after the end of the text, and after an error that ends the
    /// program.
    ///
    /// `system` provides positions and other state of the machine: a [`Modal`](crate::Modal) that
    /// has planned all lines before, or [`NoMachine`](super::NoMachine). M2 and M30 do not end the
    /// program here; the caller sees their command.
    ///
    /// # Cost
    /// One pass over the line. O-words that jump forward pass over the lines between.
    pub fn next_line<S: System>(&mut self, system: &S) -> Option<Line<'t>> {
        if self.is_over {
            return None;
        }
        if self.outside.take().is_some() {
            self.drop_call(None);
        }
        #[cfg(feature = "extended")]
        if let Some((raw, block)) = self.restored(system.modes()) {
            return Some(self.given(&raw, Ok(block)));
        }
        let Some(raw) = self.line_at(self.next) else {
            return self.end();
        };
        self.next = raw.after;
        let block = self.execute(&raw, system);
        Some(self.given(&raw, block))
    }

    fn given(&self, raw: &Raw<'t>, block: Result<Block, Error>) -> Line<'t> {
        Line {
            number: raw.place.number,
            at: raw.place.at,
            file: self.name_of(raw.place.file),
            text: raw.text,
            block,
        }
    }

    /// The first line of the text that a position is in.
    fn first_of(&self, place: Place) -> Place {
        match place.file {
            0 => self.first,
            file => Place { file, ..START },
        }
    }

    /// The line after a position.
    fn line_at(&self, place: Place) -> Option<Raw<'t>> {
        let whole = self.text_of(place.file)?;
        let (text, behind) = first_line(whole.get(place.at..)?)?;
        Some(Raw {
            place,
            text,
            after: Place {
                file: place.file,
                // `behind` is the end of the text.
                at: whole.len().wrapping_sub(behind.len()),
                number: place.number.wrapping_add(1),
            },
        })
    }

    /// Counts the steps of a line.
    fn pay(&mut self, text: &[u8]) -> Result<(), Fault> {
        let steps = (text.len() as u64 >> 6).wrapping_add(1);
        match self.steps_left.checked_sub(steps) {
            Some(left) => self.steps_left = left,
            None => {
                self.steps_left = 0;
                return Err(Fault::OutOfSteps);
            }
        }
        Ok(())
    }

    fn execute(&mut self, raw: &Raw<'t>, system: &impl System) -> Result<Block, Error> {
        if let Err(fault) = self.pay(raw.text) {
            self.is_over = true;
            return Err(whole(fault, raw.text));
        }
        if self.dialect.has_parameters() {
            let passes_delete = !self.dialect.block_delete();
            if let Some(at) = statement::place(raw.text, passes_delete) {
                if !self.dialect.has_flow() {
                    return self.numbered(raw);
                }
                if let Err(error) = self.steer(raw, at, system) {
                    self.is_over = true;
                    return Err(error);
                }
                return Block::from_words([], &self.dialect);
            }
            if statement::needs_program(raw.text, &self.dialect) {
                let (block, assignments) = self.evaluate(raw, system)?;
                #[cfg(feature = "extended")]
                let block = self.follow(raw, block, system)?;
                // A subprogram has the parameters of its caller, so a call may come first.
                self.assign(&assignments)?;
                return Ok(block);
            }
        }
        Block::parse(raw.text, &self.dialect)
    }

    /// A line with an `O` in a dialect where that is a program number.
    fn numbered(&self, raw: &Raw<'t>) -> Result<Block, Error> {
        match statement::seen(raw.text, !self.dialect.block_delete()) {
            Some(seen) => Err(Error {
                kind: ErrorKind::Program(Fault::FlowNotOfDialect),
                at: seen.at,
                end: seen.end,
            }),
            None => Block::parse(raw.text, &self.dialect),
        }
    }

    /// Executes a line with an O-word.
    fn steer(&mut self, raw: &Raw<'t>, at: usize, system: &impl System) -> Result<(), Error> {
        let order = self.order(raw, at, system)?;
        // Queried here, so that the code of control flow exists once for all systems.
        let is_outside = match (order.statement.keyword, order.statement.label) {
            (Keyword::Call, Label::Name(name)) => system.has_subroutine(name),
            _ => false,
        };
        self.obey(raw, &order, is_outside).map_err(|fault| Error {
            kind: ErrorKind::Program(fault),
            at: order.statement.at,
            end: order.end,
        })
    }

    /// Evaluates a line of words and assignments, which are permitted and not made yet.
    fn evaluate(
        &self,
        raw: &Raw<'t>,
        system: &impl System,
    ) -> Result<(Block, Assignments<'t>), Error> {
        let mut assignments = Assignments::NONE;
        let block = {
            let lookup = self.lookup_at(raw.place.number, system);
            let mut line = Evaluated::new(raw.text, &mut assignments, lookup);
            let words = core::iter::from_fn(|| line.word().transpose());
            Block::from_words(words, &self.dialect)?
        };
        for assignment in assignments.iter() {
            let fault = |fault| Error {
                kind: ErrorKind::Program(fault),
                at: assignment.at,
                end: assignment.end,
            };
            if self.is_read_only(assignment.key, system) {
                return Err(fault(Fault::ReadOnly));
            }
        }
        Ok((block, assignments))
    }

    /// Makes the assignments of a line. Without room for one the program ends.
    fn assign(&mut self, assignments: &Assignments<'t>) -> Result<(), Error> {
        for assignment in assignments.iter() {
            if let Err(fault) = self.table.set(assignment.key, assignment.value) {
                self.is_over = true;
                return Err(Error {
                    kind: ErrorKind::Program(fault),
                    at: assignment.at,
                    end: assignment.end,
                });
            }
        }
        Ok(())
    }

    /// [`Program::lookup`] as a function of one type for all readers of values, so that their code
    /// exists once.
    fn lookup_at<S: System>(&self, line: usize, system: &S) -> impl Fn(Key<'t>) -> Option<Value> {
        move |key| self.lookup(key, line, system)
    }

    /// The value of a parameter on a line.
    fn lookup(&self, key: Key<'_>, line: usize, system: &impl System) -> Option<Value> {
        let known = match key {
            Key::Number(number) if number > table::LAST_USER => system.numbered(number),
            Key::Name(name) => match table::predefined(name) {
                Some(name) => self
                    .own(name.bytes(), line)
                    .or_else(|| system.named(name.bytes())),
                None => None,
            },
            Key::Number(_) => None,
        };
        known.or_else(|| self.table.get(key))
    }

    fn is_read_only(&self, key: Key<'_>, system: &impl System) -> bool {
        match key {
            Key::Number(number) => number > table::LAST_USER && system.numbered(number).is_some(),
            Key::Name(name) => table::predefined(name).is_some_and(|name| {
                self.own(name.bytes(), 0).is_some() || system.named(name.bytes()).is_some()
            }),
        }
    }

    /// The predefined names whose values the program itself has.
    fn own(&self, name: &[u8], line: usize) -> Option<Value> {
        let number = |number: usize| Value::new(i64::try_from(number).ok()?, 0);
        match name {
            b"VALUE" => Some(self.returned.unwrap_or(Value::ZERO)),
            b"VALUE_RETURNED" => Some(Value::truth(self.returned.is_some())),
            b"LINE" => number(line),
            b"CALL_LEVEL" => number(self.call_count),
            _ => None,
        }
    }

    /// The end of the text: nothing, or an error about the line that is still open.
    fn end(&mut self) -> Option<Line<'t>> {
        self.is_over = true;
        let inner = self
            .loop_count
            .checked_sub(1)
            .and_then(|last| self.loops.get(last).copied().flatten());
        let open = match (self.current_call(), inner) {
            (Some(call), _) => call.begin,
            (None, Some(inner)) => inner.begin,
            (None, None) => return None,
        };
        let raw = self.line_at(open)?;
        let error = whole(Fault::NotClosed, raw.text);
        Some(self.given(&raw, Err(error)))
    }
}

/// An error about a whole line.
fn whole(fault: Fault, text: &[u8]) -> Error {
    let blank = text.len().wrapping_sub(text.trim_ascii_start().len());
    Error {
        kind: ErrorKind::Program(fault),
        at: blank,
        end: blank.wrapping_add(text.trim_ascii().len()),
    }
}
