//! A program that does not fit at machine zero is moved, with few readings.

use crate::diagnostics::Findings;
use crate::job::{Job, Program};
use crate::machines::machine_file::MachineFile;
use std::cell::Cell;
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::rc::Rc;

/// A program that counts the bytes that are read from it.
#[derive(Debug)]
struct Counted {
    text: String,
    read: Rc<Cell<usize>>,
}

struct Counting(Cursor<Vec<u8>>, Rc<Cell<usize>>);

impl Read for Counting {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let length = self.0.read(buffer)?;
        self.1.set(self.1.get() + length);
        Ok(length)
    }
}

impl Program for Counted {
    fn name(&self) -> &str {
        "p.nc"
    }

    fn bytes(&self) -> io::Result<Box<dyn BufRead>> {
        let bytes = Cursor::new(self.text.clone().into_bytes());
        let counting = Counting(bytes, Rc::clone(&self.read));
        Ok(Box::new(BufReader::with_capacity(256, counting)))
    }
}

/// Checks a program. Returns its findings, notes, feed in mm, and how often it was read.
fn checked(text: &str) -> (Vec<String>, Vec<String>, f64, f64) {
    let program = Counted {
        text: text.to_owned(),
        read: Rc::default(),
    };
    let read = Rc::clone(&program.read);
    let router = MachineFile::built_in("router").unwrap();
    let mut job = Job::new(program, router, None).unwrap();
    job.place(None).unwrap();
    let mut findings = Findings::new(50);
    let facts = job.check(&mut findings).unwrap();
    let readings = read.get() as f64 / text.len() as f64;
    let feed_mm = facts.feed_nm / 1e6;
    (findings.short(), job.take_notes(), feed_mm, readings)
}

/// A program that leaves the travel of the router at zero in its first move.
fn program(more: &str) -> String {
    let lines = "G1 X-2 F900\nX1\n".repeat(1000);
    format!("G21 G90\n{lines}{more}M2\n")
}

#[test]
fn a_program_is_read_twice_before_it_is_moved() {
    let (findings, notes, feed_mm, readings) = checked(&program(""));
    assert_eq!(findings, [""; 0]);
    let placed = "p.nc: placed in the middle of router, as with --zero X150.5Y0Z0";
    assert_eq!(notes, [placed]);
    assert_eq!(feed_mm, 2.0 + 3.0 * 1999.0);
    // For the place, and for the check there. The first reading ends at the first move.
    assert!((2.0..2.1).contains(&readings), "{readings}");
}

#[test]
fn errors_after_the_first_move_beyond_are_found() {
    let (findings, notes, ..) = checked(&program("G1 Q\n"));
    assert_eq!((findings.len(), notes.len()), (1, 0));
    assert!(
        findings[0].starts_with("p.nc:2002:4: error"),
        "{findings:?}"
    );
    // It does not fit anywhere: what is wrong at zero is reported.
    let (findings, notes, ..) = checked(&program("X400\nG1 Q\n"));
    assert_eq!(notes, [""; 0]);
    let codes = |code: &str| findings.iter().filter(|one| one.contains(code)).count();
    assert_eq!((findings.len(), codes("E0401")), (2, 1), "{findings:?}");
}
