//! The machine of a program when the command line names none.

use super::Failure;
use super::job::Job;
use crate::cli::{Target, Zero};
use husillo_simulator::diagnostics::Findings;
use husillo_simulator::machines::machine_file::MachineFile;
use husillo_simulator::programs::check::Facts;

/// The machines that are tried in this order.
const TRIED: [&str; 5] = ["micromill", "router", "lathe", "router4", "printer"];
/// The machine of a program that no other machine accepts. It has no limits, so the errors are
/// those of the program.
const NONE: &str = "free";
/// A comment that names a machine is within this number of bytes from the start of a program.
const HEAD: usize = 4096;

/// The program, placed, with its machine: that of the command line, or that of a comment of the
/// program (`-m NAME`), or the first one that accepts the program without an error. In the last two
/// cases a line names the machine.
///
/// `limit` is the number of findings that are kept.
pub fn job(file: &str, target: &Target, zero: Option<Zero>, limit: u64) -> Result<Job, Failure> {
    let mut job = Job::new(file, target, TRIED[0])?;
    if target.machine.is_none() {
        job.keep_input()?;
        let machine = match named(&job.head(HEAD)?) {
            Some(machine) => machine,
            None => {
                for machine in TRIED {
                    let mut trial = job.on(machine, target)?;
                    if trial.accepts(zero, limit)? {
                        return Ok(trial);
                    }
                }
                let tried = TRIED.join(", ");
                let name = job.name();
                eprintln!(
                    "{name}: no machine of {tried} accepts this program; it is checked for \
                     {NONE}, which has no limits"
                );
                NONE
            }
        };
        job = job.on(machine, target)?;
    }
    job.place(zero)?;
    Ok(job)
}

impl Job {
    /// Whether the machine accepts the program without an error. If so, the result of the check is
    /// kept, and a line names the machine.
    fn accepts(&mut self, zero: Option<Zero>, limit: u64) -> Result<bool, Failure> {
        let Some(checked) = self.accepted(zero, limit)? else {
            return Ok(false);
        };
        let (name, machine, tried) = (self.name(), &self.machine.name, TRIED.join(", "));
        eprintln!(
            "{name}: {machine} is the first machine of {tried} that accepts this program; -m NAME \
             selects another"
        );
        for note in self.notes.drain(..) {
            eprintln!("{note}");
        }
        self.checked = Some(checked);
        Ok(true)
    }

    /// The result of the check, if the machine accepts the program without an error. Nothing is
    /// printed.
    fn accepted(
        &mut self,
        zero: Option<Zero>,
        limit: u64,
    ) -> Result<Option<(Facts, Findings)>, Failure> {
        self.is_trial = true;
        self.place(zero)?;
        let mut findings = Findings::new(limit).up_to_error();
        let facts = self.check(&mut findings)?;
        Ok((findings.errors == 0).then_some((facts, findings)))
    }
}

/// Prints which other machine accepts a program that was refused for what its machine lacks.
pub fn suggest(
    job: &Job,
    target: &Target,
    zero: Option<Zero>,
    refused: &Findings,
) -> Result<(), Failure> {
    let is_repeatable =
        job.input.is_some() || std::fs::metadata(&job.file).is_ok_and(|of| of.is_file());
    if !is_repeatable || !refused.concern_the_machine() {
        return Ok(());
    }
    let any = Target {
        machine: None,
        ..target.clone()
    };
    let others = TRIED.into_iter().filter(|name| *name != job.machine.name);
    for machine in others {
        let mut trial = job.on(machine, &any)?;
        if trial.accepted(zero, 1)?.is_some() {
            eprintln!(
                "{}: {machine} accepts this program: -m {machine}",
                job.name()
            );
            break;
        }
    }
    Ok(())
}

/// The machine that a comment names: `-m NAME`, as on the command line.
fn named(head: &[u8]) -> Option<&'static str> {
    let text = String::from_utf8_lossy(head);
    let comments = text.lines().filter_map(|line| {
        let begin = line.find(['(', ';'])?;
        line.get(begin..)
    });
    comments
        .flat_map(|comment| comment.split("-m ").skip(1))
        .find_map(|rest| {
            let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_');
            let word = rest.get(..end.unwrap_or(rest.len()))?;
            MachineFile::names().into_iter().find(|name| *name == word)
        })
}

#[cfg(test)]
mod tests {
    use super::named;

    #[test]
    fn a_comment_names_the_machine() {
        assert_eq!(named(b"(a part; for -m lathe)\nG0 X1\n"), Some("lathe"));
        assert_eq!(named(b"G0 X1 ; -m router, please\n"), Some("router"));
        assert_eq!(
            named(b"(-m nosuch) (husillo run -m free x)\n"),
            Some("free")
        );
        assert_eq!(named(b"G0 X1\n(-mlathe)\n"), None);
        assert_eq!(named(b"-m lathe\n"), None);
        assert_eq!(named(b"\xff\xfe(-m lathe"), Some("lathe"));
    }
}
