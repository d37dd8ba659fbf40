//! The interpolation methods on the moves of a job.

use super::{Job, JobError};
use crate::diagnostics::Findings;
use crate::programs::program::{self, Meaning};
use husillo_gcode::Command;
use husillo_methods::{Comparer, programmed};
use husillo_sim::observers::AXES;

impl Job {
    /// Adds every feed move of the program to a comparison of interpolation methods.
    ///
    /// # Errors
    ///
    /// The program cannot be read.
    pub fn compare(
        &self,
        comparer: &mut Comparer,
        findings: &mut Findings,
    ) -> Result<(), JobError> {
        let mut make = |command: &Command<AXES>, from| {
            let made = match command {
                Command::Linear { to, .. } => programmed::line(&self.config, from, *to),
                Command::Arc { arc, .. } => programmed::arc(&self.config, from, arc),
                _ => Ok(None),
            };
            match made {
                Ok(Some(one)) => comparer.add_common(&one),
                Ok(None) => {}
                Err(why) => comparer.note(why.to_owned()),
            }
        };
        let mut source = self.open()?;
        let each = |_: &Meaning<'_>, command: &_, from, _: &mut Findings| {
            make(command, from);
            Ok(())
        };
        program::walk(&mut source, self.name(), self.start, findings, each)?;
        Ok(())
    }
}
