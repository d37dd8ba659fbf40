//! The machine of a program when the command line names none.

use super::Failure;
use super::job::Job;
use crate::cli::{Target, Zero};
use crate::console::shown;
use crate::diagnostics::Findings;
use crate::machines::machine_file::MachineFile;

/// The machines that are tried in this order.
const TRIED: [&str; 5] = ["micromill", "router", "lathe", "router4", "printer"];
/// The machine of a program that no other machine accepts. It has no limits, so the errors are
/// those of the program.
const NONE: &str = "free";
/// A comment that names a machine is within this number of bytes from the start of a program.
const HEAD: usize = 4096;

/// The program with its machine: that of the command line, or that of a comment of the program (`-m
/// NAME`), or the first one that accepts the program without an error. In the last two cases a line
/// names the machine.
pub fn job(file: &str, target: &Target, zero: Option<Zero>) -> Result<Job, Failure> {
    if target.machine.is_some() {
        return Job::new(file, target, NONE);
    }
    let mut job = Job::new(file, target, TRIED[0])?;
    job.keep_input()?;
    let mut machines = TRIED.iter();
    let named = named(&job.head(HEAD)?);
    if let Some(machine) = named {
        return job.on(machine, target);
    }
    let fitting = loop {
        let Some(machine) = machines.next() else {
            break None;
        };
        let mut trial = job.on(machine, target)?;
        if trial.takes(zero)? {
            break Some(machine);
        }
    };
    let name = shown(job.name());
    match fitting {
        Some(machine) => eprintln!(
            "{name}: for {machine}, the first of {} that accepts it; -m NAME selects another",
            TRIED.join(", ")
        ),
        None => eprintln!(
            "{name}: none of {} accepts it; for {NONE}, which has no limits",
            TRIED.join(", ")
        ),
    }
    job.on(fitting.unwrap_or(&NONE), target)
}

impl Job {
    /// Whether the machine accepts the program without an error.
    fn takes(&mut self, zero: Option<Zero>) -> Result<bool, Failure> {
        self.is_trial = true;
        self.place(zero)?;
        let mut findings = Findings::new(0);
        self.check(&mut findings)?;
        Ok(findings.errors == 0)
    }
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
