//! Contour cycles of lathes: G71 and G72 rough and G70 finishes along a contour that is given on
//! other lines.
//!
//! ```text
//! G71 U2 R0.5                   depth of a cut, retract
//! G71 P10 Q40 U0.4 W0.1 F200    from N10 to N40, allowances  ──►  G0 X.. Z..  G1 Z..  G0 ..  cuts
//! N10 G0 X20                    ┐                                 G1, G2, G3         once along it
//! N20 G1 Z-20 F80               │ the contour                     G0 to the start
//! N30 G2 X40 Z-30 R10           │                                 goes on behind N40
//! N40 G1 X52                    ┘
//! G70 P10 Q40                                                ──►  N10 to N40, G0 to the start
//! ```
//!
//! A cycle becomes ordinary lines: blocks of plain moves, which [`Modal`] and all later stages take
//! as usual. [`Contours`] works on the whole text, borrowed.

mod passes;
mod reading;
mod shape;
mod text;
mod thread;
mod written;

use crate::blocks::block::Block;
use crate::blocks::fault::{Fault, Reason};
use crate::codes::code::{Code, Group};
use crate::codes::dialect::{Dialect, Flavour};
use crate::command::arc::Plane;
use crate::compensation::offset::minus;
use crate::error::{Error, ErrorKind};
use crate::modal::Modal;
use crate::modal::commands::Commands;
use crate::modal::modes::FeedMode;
use crate::program::line::Line;
use crate::values::nm::{Measure, Nm};
use crate::words::word::words;
use passes::{MOST_PASSES, Passes, Return};
use reading::{Read, Refused, point, read};
use shape::{Shape, Ways};
use text::{Place, count, find, line_at, number_of};
use thread::{Habits, Thread};

/// The retract where no `R` is given, as in LinuxCNC.
const RETRACT: Nm = Nm(500_000);

/// The code of G76, next to those of contour cycles.
const THREAD: u8 = 60;

/// Whether a line has a contour cycle, or a G76 of code system A. Its program must then be given as
/// a whole.
///
/// # Cost
/// One pass over the line, and none in dialects without such cycles.
pub fn needs_contours(line: &[u8], dialect: &Dialect) -> bool {
    if !dialect.is_lathe() {
        return false;
    }
    let mut words = words(line);
    words.any(|word| {
        word.is_ok_and(|word| {
            let code = (word.letter == b'G')
                .then(|| word.value.exactly(1))
                .flatten();
            match code {
                Some(700..=729) => true,
                Some(760) => dialect.flavour == Flavour::LatheA,
                _ => false,
            }
        })
    })
}

/// The lines of a program with its contour cycles expanded.
///
/// Alone it returns the lines of a plain text. For a text with parameters and loops, combine it
/// with a [`Program`](crate::program::parameters::Program): pass it the lines of the program with
/// [`Contours::take`], [`Contours::next_of_cycle`] and [`Contours::resume`]. The lines of a contour
/// are plain in both cases.
///
/// # Words
/// G71 cuts along Z and steps down in X. G72 cuts along X and steps down in Z.
///
/// - `P` and `Q` are the numbers `N` of the first and the last block of the contour, which begins
///   directly after G71 or G72. Execution continues after it.
/// - `U` and `W` are the allowance in X (in the meaning of X: a diameter under G7) and Z. The whole
///   contour is shifted by it. Its sign points away from the material.
/// - The depth of a cut (a radius) and the retract are `D` and `R` next to `P`, or `U` (G72: `W`)
///   and `R` of a separate earlier line. They stay in effect. `R` is 0.5 mm if it is never given.
/// - `F`, `S` and `T` take effect with the cycle. Those in the contour count for G70 only.
/// - No other word is permitted.
///
/// # Roughing
/// The first move of the contour is straight and determines the downward direction. If it is G1,
/// the tool goes down at the feed. Every cut is at most `D` deep, and the last one is exactly at
/// the bottom. A cut ends where it meets the contour with its allowance, rounded to the nanometre
/// before it. The tool retracts at 45 degrees by `R` (less where the cut is shorter) and returns in
/// rapid. Then one pass follows the whole contour with its allowance, at the feed. At the end the
/// tool is at its start. Contours rise from start to end in both axes (type I): a pocket is
/// refused.
///
/// # Threading
/// In code system A G76 is given in two lines.
///
/// - The first has `P` with two digits each for the passes at full depth, the run-out at 45 degrees
///   in tenths of the lead, and the angle of the thread; `Q`, the least step; and `R`, the
///   allowance for the passes at full depth.
/// - The second has X and Z of the root at the end; `R`, the excess of its radius at the start;
///   `P`, the height; `Q`, the first depth; and `F`, the lead along Z.
///
/// `P` and `Q` without a decimal point count thousandths of a millimetre. The depth of pass n is
/// the first depth times the root of n. With `I`, `J` or `K` it is the one-line cycle of the other
/// dialects.
///
/// # Finishing
/// G70 returns the lines of the contour unchanged: the last ones before it with these numbers. Then
/// it returns to its start, out of the material first.
///
/// # Cost
/// About 5 moves per cut, each with one pass over the contour, and at most 2^16 cuts. `CAPACITY` is
/// the largest number of moves in a contour; 64 take 3 kB. A number is searched in the whole text.
///
/// # Source
/// The turning cycles of the FANUC lathe manuals, type I, by the description of their words. All
/// words and the order of moves are the same. Allowances towards the material, and unused words,
/// are refused here.
///
/// # Examples
/// ```
/// use husillo_gcode::{Dialect, Modal, contour::Contours};
///
/// let text = b"G0 X14 Z1\nF100\nG71 P1 Q3 D2 R0.5\nN1 G0 X6\nN2 G1 Z-4\nN3 X14\nG70 P1 Q3\n";
/// let mut contours: Contours = Contours::new(text, Dialect::LATHE_A);
/// let mut modal = Modal::<3>::new(Dialect::LATHE_A);
/// let mut printed = Vec::new();
/// while let Some(line) = contours.next_line(&modal) {
///     let (next, commands) = modal.plan(&line.block?)?;
///     printed.extend(commands.map(|command| format!("{}: {command}", line.number)));
///     modal = next;
/// }
/// assert_eq!(printed[1..7], [
///     "3: rapid X5 Y0 Z1",
///     "3: linear X5 Y0 Z-4 F100",
///     "3: rapid X5.5 Y0 Z-3.5",
///     "3: rapid X5.5 Y0 Z1",
///     "3: rapid X3 Y0 Z1",
///     "3: linear X3 Y0 Z-4 F100",
/// ]);
/// # Ok::<(), husillo_gcode::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Contours<'t, const CAPACITY: usize = 64> {
    text: &'t [u8],
    dialect: Dialect,
    next: Place,
    /// Depth of a cut and retract of the last cycle.
    depth: Option<Nm>,
    retract: Nm,
    habits: Habits,
    /// The line of the cycle, its code in it, and the position where the program continues.
    line: (Place, &'t [u8], Span),
    resume: Option<Place>,
    work: Work<CAPACITY>,
}

/// The bytes of a word.
type Span = (usize, usize);

/// Work in progress.
#[derive(Clone, Debug)]
enum Work<const CAPACITY: usize> {
    None,
    Rough(Passes<CAPACITY>),
    /// The lines from one position to another, then the return.
    Finish(Place, Place, Return),
    Back(Return),
    Thread(Thread),
}

impl<'t, const CAPACITY: usize> Contours<'t, CAPACITY> {
    /// Creates the reader of a program at its first line.
    pub const fn new(text: &'t [u8], dialect: Dialect) -> Self {
        Contours {
            text,
            dialect,
            next: Place { at: 0, number: 1 },
            depth: None,
            retract: RETRACT,
            habits: Habits::new(),
            line: (Place { at: 0, number: 1 }, b"", (0, 0)),
            resume: None,
            work: Work::None,
        }
    }

    /// Returns the next line; `None` after the end of the text. `modal` has planned all lines
    /// before.
    ///
    /// An error of a contour is returned with its own line, and no part of the cycle is made. If
    /// the caller reads further lines, it continues after the contour.
    pub fn next_line<const N: usize>(&mut self, modal: &Modal<N>) -> Option<Line<'t>> {
        if let Some(line) = self.next_of_cycle(modal) {
            return Some(line);
        }
        let place = self.next;
        let (text, after) = line_at(self.text, place)?;
        self.next = after;
        let line = self.take(
            Line {
                number: place.number,
                at: place.at,
                file: None,
                text,
                block: Block::parse(text, &self.dialect),
            },
            modal,
        );
        if let Some((at, number)) = self.resume() {
            self.next = Place { at, number };
        }
        Some(line)
    }

    /// Returns the next line of the cycle in progress; `None` without one. Its moves have the
    /// number of the cycle; those of G70 are the lines of the contour.
    pub fn next_of_cycle<const N: usize>(&mut self, modal: &Modal<N>) -> Option<Line<'t>> {
        let wanted = match &mut self.work {
            Work::None => None,
            Work::Rough(passes) => passes.next(),
            Work::Back(back) => back.next(),
            Work::Thread(thread) => thread.next(),
            Work::Finish(place, last, back) => {
                let here = *place;
                let found = line_at(self.text, here).filter(|_| here.at <= last.at);
                match found {
                    Some((text, after)) => {
                        *place = after;
                        return Some(Line {
                            number: here.number,
                            at: here.at,
                            file: None,
                            text,
                            block: Block::parse(text, &self.dialect),
                        });
                    }
                    None => {
                        let mut back = *back;
                        back.at = point(&modal.position());
                        let first = back.next();
                        self.work = Work::Back(back);
                        first
                    }
                }
            }
        };
        let Some(wanted) = wanted else {
            self.work = Work::None;
            return None;
        };
        Some(self.line(written::block(wanted, modal, self.line.2)))
    }

    /// Begins the cycle of a line, and returns the rest of the line: its F, S and T. Lines without
    /// a cycle are returned unchanged. A cycle in progress is dropped.
    pub fn take<const N: usize>(&mut self, line: Line<'t>, modal: &Modal<N>) -> Line<'t> {
        (self.work, self.resume) = (Work::None, None);
        if line.file.is_some() {
            return line; // The contour would be in another text.
        }
        let Ok(block) = &line.block else { return line };
        let code = match block.code(Group::Motion) {
            Some(Code::ThreadCycle) if self.is_thread(block) => THREAD,
            code => match code.and_then(Code::contour_cycle) {
                Some(code) => code,
                None => return line,
            },
        };
        let place = block.error(
            Fault::at_motion(Reason::ContourOfBlocks),
            Measure::of(Nm(0)),
        );
        self.line = (
            Place {
                at: line.at,
                number: line.number,
            },
            line.text,
            (place.at, place.end),
        );
        match self.begin(code, block, modal) {
            Ok(block) => self.line(Ok(block)),
            Err(refused) => {
                self.work = Work::None;
                Line {
                    number: refused.place.number,
                    at: refused.place.at,
                    file: None,
                    text: refused.text,
                    block: Err(refused.error),
                }
            }
        }
    }

    /// The line with which the program continues after the last one, if this is not the next line:
    /// its first byte, and its number. It is returned once, after all lines of the cycle.
    pub fn resume(&mut self) -> Option<(usize, usize)> {
        self.resume.take().map(|place| (place.at, place.number))
    }

    /// Reads and checks a cycle. The returned block is the rest of the line.
    fn begin<const N: usize>(
        &mut self,
        code: u8,
        block: &Block,
        modal: &Modal<N>,
    ) -> Result<Block, Refused<'t>> {
        let (place, text, _) = self.line;
        let wrong = |error| Refused { place, text, error };
        let refused = |fault| wrong(block.error(fault, Measure::of(Nm(0))));
        let facing = match code {
            0 => None,
            10 => Some(false),
            20 => Some(true),
            THREAD => {
                self.thread(block, modal).map_err(refused)?;
                return Block::from_words([], &self.dialect).map_err(wrong);
            }
            // The form of LinuxCNC, along a subroutine.
            _ => {
                let fault = Fault::at_motion(Reason::ContourOfBlocks);
                let kind = ErrorKind::NotOfDialect(b'G', u16::from(code).wrapping_add(700));
                return Err(wrong(Error {
                    kind,
                    ..block.error(fault, Measure::of(Nm(0)))
                }));
            }
        };
        match facing {
            Some(facing) if block.word(b'P').is_none() && block.word(b'Q').is_none() => {
                let letter = if facing { b'W' } else { b'U' };
                block.check_alone(&[letter, b'R']).map_err(refused)?;
                self.set_cuts(block, letter, modal).map_err(refused)?;
                return Block::from_words([], &self.dialect).map_err(wrong);
            }
            Some(_) => block.check_alone(b"PQUWDRFST").map_err(refused)?,
            None => block.check_alone(b"PQFST").map_err(refused)?,
        }
        let (first, last) = self.contour(block, facing.is_some()).map_err(refused)?;
        let outputs = written::part(block, b"FST", modal).map_err(wrong)?;
        let mut modal = modal.clone();
        modal.apply(&outputs, &mut Commands::new()).map_err(wrong)?;
        match facing {
            None => self.finish(first, last, &modal)?,
            Some(facing) => {
                self.set_cuts(block, b'D', &modal).map_err(refused)?;
                check_state(&modal).map_err(refused)?;
                self.rough(block, facing, (first, last), &modal)?;
            }
        }
        Ok(outputs)
    }

    /// Whether a G76 is one of two lines.
    fn is_thread(&self, block: &Block) -> bool {
        self.dialect.flavour == Flavour::LatheA && thread::is_two_line(block)
    }

    /// G76 of code system A: the first line, or the second.
    fn thread<const N: usize>(&mut self, block: &Block, modal: &Modal<N>) -> Result<(), Fault> {
        if modal.compensation().is_some() {
            return Err(Fault::at_motion(Reason::UnderCompensation));
        }
        if thread::is_first(block) {
            self.habits = self.habits.read(block, modal)?;
        } else {
            self.work = Work::Thread(Thread::read(self.habits, block, modal)?);
        }
        Ok(())
    }

    /// Sets the depth of a cut and the retract where they are given.
    fn set_cuts<const N: usize>(
        &mut self,
        block: &Block,
        letter: u8,
        modal: &Modal<N>,
    ) -> Result<(), Fault> {
        let depth = written::plain_length(block, letter, modal)?;
        let retract = written::plain_length(block, b'R', modal)?;
        if depth.is_some_and(|depth| depth <= Nm(0)) {
            return Err(Fault::at(Reason::OutOfRange, letter));
        }
        if retract.is_some_and(|retract| retract < Nm(0)) {
            return Err(Fault::at(Reason::OutOfRange, b'R'));
        }
        self.depth = depth.or(self.depth);
        self.retract = retract.unwrap_or(self.retract);
        Ok(())
    }

    /// The first and the last line of a contour: directly after the cycle, or for G70 the last one
    /// before it, if any.
    fn contour(&mut self, block: &Block, is_next: bool) -> Result<(Place, Place), Fault> {
        let number = |letter| match block.word(letter) {
            None => Err(Fault::at_motion(Reason::MissingWord).of(letter)),
            Some(value) => value
                .whole()
                .ok_or_else(|| Fault::at(Reason::NotWhole, letter)),
        };
        let (p, q) = (number(b'P')?, number(b'Q')?);
        let missing = |letter| Fault::at(Reason::NoContour, letter);
        let place = self.line.0;
        let behind = line_at(self.text, place).map_or(place, |(_, after)| after);
        let dialect = &self.dialect;
        let (first, until) = if is_next {
            let first = self.behind(behind, p).ok_or_else(|| missing(b'P'))?;
            (first, self.text.len())
        } else {
            let before = self.text.get(..place.at).unwrap_or_default();
            let start = Place {
                at: 0,
                number: place.number.wrapping_sub(count(before)),
            };
            match find(self.text, start, place.at, p, true, dialect) {
                Some(first) => (first, place.at),
                None => {
                    let end = self.text.len();
                    let first = find(self.text, behind, end, p, false, dialect);
                    (first.ok_or_else(|| missing(b'P'))?, end)
                }
            }
        };
        let last = find(self.text, first, until, q, false, dialect);
        let last = last.ok_or_else(|| missing(b'Q'))?;
        if first.at > place.at {
            self.resume = line_at(self.text, last).map(|(_, after)| after);
        }
        Ok((first, last))
    }

    /// The line with this number, if all before it are empty.
    fn behind(&self, from: Place, number: i64) -> Option<Place> {
        let mut place = from;
        loop {
            let (line, after) = line_at(self.text, place)?;
            if number_of(line, &self.dialect) == Some(number) {
                return Some(place);
            }
            let block = Block::parse(line, &self.dialect).ok()?;
            if !block.is_empty() {
                return None;
            }
            place = after;
        }
    }

    /// G70.
    fn finish<const N: usize>(
        &mut self,
        first: Place,
        last: Place,
        modal: &Modal<N>,
    ) -> Result<(), Refused<'t>> {
        let (mut approach, start) = (None, point(&modal.position()));
        read(self.text, first, last, modal, |read| {
            approach = approach.or(Some(read));
            Ok(())
        })?;
        // Where the first move is along one axis, the tool enters in its direction, and leaves in
        // the opposite one.
        let ways = approach.and_then(|read: Read| {
            let [x, z] = minus(read.segment.to, read.from);
            ((x == 0) != (z == 0)).then_some(Ways {
                facing: x == 0,
                deep_up: x > 0 || z > 0,
                far_up: true,
            })
        });
        let back = Return {
            ways,
            start,
            at: start,
        };
        self.work = Work::Finish(first, last, back);
        Ok(())
    }

    /// G71 and G72.
    fn rough<const N: usize>(
        &mut self,
        block: &Block,
        facing: bool,
        (first, last): (Place, Place),
        modal: &Modal<N>,
    ) -> Result<(), Refused<'t>> {
        let (place, text, _) = self.line;
        let wrong = |error| Refused { place, text, error };
        let refused = |fault| wrong(block.error(fault, Measure::of(Nm(0))));
        let at_code = |reason| refused(Fault::at_motion(reason));
        let depth = self
            .depth
            .ok_or(Fault::at_motion(Reason::MissingWord).of(b'D'))
            .map_err(refused)?;
        let start = point(&modal.position());
        let mut shape = None;
        let mut approach = None;
        read(self.text, first, last, modal, |read| match &mut shape {
            None if read.segment.arc.is_some() => Err(ErrorKind::NotOfContour),
            None => {
                approach = Some(read);
                shape = Some(Shape::<CAPACITY>::new(read.segment.to));
                Ok(())
            }
            Some(shape) => {
                let taken = shape.push(read.segment);
                taken.then_some(()).ok_or(ErrorKind::ContourTooLong)
            }
        })?;
        let (Some(shape), Some(approach)) = (shape, approach) else {
            return Err(at_code(Reason::ContourStart));
        };
        let up = Ways {
            facing,
            deep_up: true,
            far_up: true,
        };
        let deep = up.course(minus(approach.segment.to, start))[0];
        let far = up.course(minus(shape.end(), start))[1];
        if deep == 0 || far == 0 {
            return Err(at_code(Reason::ContourStart));
        }
        let ways = Ways {
            facing,
            deep_up: deep > 0,
            far_up: far > 0,
        };
        self.check_for_pockets(ways, (first, last), modal)?;
        let [u, w] = [b'U', b'W'].map(|letter| modal.length_of(block, letter));
        let x = u.map_err(refused)?.unwrap_or_default().0;
        let z = w.map_err(refused)?.unwrap_or_default().0;
        let shift = ways.course([x, z]);
        let words = if facing { *b"WU" } else { *b"UW" };
        for (letter, part) in words.into_iter().zip(shift) {
            if part > 0 {
                return Err(refused(Fault::at(Reason::OutOfRange, letter)));
            }
        }
        let mut passes = Passes::new(ways, shape, start);
        (passes.shift, passes.depth, passes.retract) = (shift, depth.0, self.retract.0);
        passes.feeds_in = !approach.is_rapid;
        if !passes.starts_free() {
            let letter = words[0];
            return Err(refused(Fault::at(Reason::OutOfRange, letter)));
        }
        if passes.count() > MOST_PASSES {
            return Err(at_code(Reason::TooManyPasses));
        }
        self.work = Work::Rough(passes);
        Ok(())
    }

    /// Reads a contour once more to determine where it goes back, which is refused.
    fn check_for_pockets<const N: usize>(
        &self,
        ways: Ways,
        (first, last): (Place, Place),
        modal: &Modal<N>,
    ) -> Result<(), Refused<'t>> {
        let mut is_first = true;
        let [_, far_letter] = ways.letters();
        read(self.text, first, last, modal, |read| {
            let back = if core::mem::replace(&mut is_first, false) {
                let far = ways.course(minus(read.segment.to, read.from))[1];
                (far < 0).then_some(far_letter)
            } else {
                ways.goes_back(read.from, &read.segment)
            };
            back.map_or(Ok(()), |letter| Err(ErrorKind::Pocket(letter)))
        })
    }

    /// A line with the number of the cycle.
    fn line(&self, block: Result<Block, Error>) -> Line<'t> {
        let (place, text, _) = &self.line;
        Line {
            number: place.number,
            at: place.at,
            file: None,
            text,
            block,
        }
    }
}

/// Checks that a contour can be roughed in this state.
fn check_state<const N: usize>(modal: &Modal<N>) -> Result<(), Fault> {
    let reason = if modal.compensation().is_some() {
        Reason::UnderCompensation
    } else if modal.plane() != Plane::Zx {
        Reason::NotOfContour
    } else if modal.feed_mode() == FeedMode::InverseTime {
        Reason::WrongFeedMode
    } else {
        return modal.set_feed_of(&mut Commands::new());
    };
    Err(Fault::at_motion(reason))
}
