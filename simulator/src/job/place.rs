//! The position of a program on its machine.

use super::{Job, JobError, LETTERS, Zero};
use crate::diagnostics::Findings;
use crate::machines::machine_file::MachineFile;
use crate::programs::check::{Facts, Part};
use crate::programs::program::Start;
use crate::programs::zero::{self, Lie, Placing};
use husillo_gcode::Nm;
use husillo_sim::observers::AXES;

impl Job {
    /// Puts work zero where it is asked for, and the tool to it, as far as the travel goes. Without
    /// a zero the program begins at machine zero, and [`check`](Self::check) may move it.
    ///
    /// # Errors
    ///
    /// The machine has no such axis, or the program cannot be read.
    pub fn place(&mut self, zero: Option<Zero>) -> Result<(), JobError> {
        let lie = match zero {
            None => {
                self.may_move = self.start.frames[0].is_none();
                return Ok(());
            }
            Some(Zero::At(zero)) => {
                self.start.frames[0] = None;
                self.put(of_letters(&zero, &self.machine)?);
                return Ok(());
            }
            Some(Zero::Fit) => Lie::Middle,
            Some(Zero::Centre) => Lie::ZeroInMiddle,
            Some(Zero::Corner) => Lie::ZeroAtCorner,
        };
        self.start.frames[0] = None;
        let placing = self.placing(lie)?;
        if placing.is_certain {
            let zero = placing.zero;
            let note = format!("{}: --zero {}", self.name(), self.typed(zero));
            self.notes.push(note);
            self.put(zero);
        }
        Ok(())
    }

    fn placing(&self, lie: Lie) -> Result<Placing, JobError> {
        let mut source = self.open()?;
        Ok(zero::placing(
            &mut source,
            self.name(),
            self.start,
            &self.config,
            lie,
        )?)
    }

    /// A work zero as the user types it. X, Y and Z are always there.
    fn typed(&self, zero: [Nm; AXES]) -> String {
        let letters = self.machine.letters.letters().map(char::from);
        let axes = letters.zip(zero).enumerate();
        axes.filter(|(axis, (_, at))| *axis < 3 || *at != Nm(0))
            .map(|(_, (letter, at))| format!("{letter}{at}"))
            .collect()
    }

    /// The tool stands `at` this position, and work zero is at `zero`.
    pub fn stand(&mut self, zero: [Nm; AXES], at: [Nm; AXES]) {
        self.start = Start {
            zero,
            at,
            ..self.start
        };
        self.is_placed = true;
    }

    /// Puts work zero here.
    fn put(&mut self, zero: [Nm; AXES]) {
        let mut at = zero;
        for (at, axis) in at.iter_mut().zip(&self.config.axes) {
            if let Some([low, high]) = axis.travel {
                *at = (*at).clamp(low, high);
            }
        }
        self.stand(zero, at);
    }

    /// Moves the program to the middle of the table. `None`: it does not fit there either, or its
    /// zero was asked for.
    pub(super) fn check_moved(
        &mut self,
        before: &Findings,
    ) -> Result<Option<(Facts, Findings)>, JobError> {
        if !self.may_move {
            return Ok(None);
        }
        let Placing { zero, is_certain } = self.placing(Lie::Middle)?;
        let start = self.start;
        self.put(zero);
        let mut findings = before.restarted();
        let facts = self.check_here(Part::Whole, &mut findings)?;
        if facts.beyond.is_some() {
            self.start = start;
            self.is_placed = false;
            return Ok(None);
        }
        // With other errors nothing runs, and the position of the part is not one of them.
        if is_certain {
            let (name, machine, zero) = (self.name(), &self.machine.name, self.typed(zero));
            let note = format!("{name}: placed in the middle of {machine}, as with --zero {zero}");
            self.notes.push(note);
        }
        Ok(Some((facts, findings)))
    }
}

/// The requested work zero on the axes of a machine.
fn of_letters(
    zero: &[Option<Nm>; LETTERS.len()],
    machine: &MachineFile,
) -> Result<[Nm; AXES], JobError> {
    let mut wanted = [Nm(0); AXES];
    for (letter, at) in LETTERS.bytes().zip(zero) {
        let Some(at) = at else { continue };
        let axis = machine.letters.index(letter).ok_or_else(|| {
            let letter = char::from(letter);
            format!("--zero: {} has no axis {letter}", machine.name)
        })?;
        wanted[axis] = *at;
    }
    Ok(wanted)
}

#[cfg(test)]
mod tests;
