//! Any program with parameters and O-words.

use husillo_excellon::lines;
use husillo_gcode::parameters::{Line, Program, Value};
use husillo_gcode::{Dialect, ErrorKind, Modal};

/// Number of steps of every program.
const STEPS: u64 = 600;

/// Parameters that are compared.
const NUMBERS: [u16; 6] = [1, 2, 3, 4, 30, 31];
const NAMES: [&[u8]; 3] = [b"a", b"_a", b"_value"];

type Small<'t> = Program<'t, 8, 16, 4>;

/// Any text as a program. It ends within its steps. Every line is one of the text, and every error
/// has its columns inside its line. A wrong line assigns nothing. Calls stay within their depth. A
/// program that has ended stays ended. With CR LF or CR instead of LF the same lines come, with the
/// same meaning.
pub fn parameters(data: &[u8]) {
    for dialect in [Dialect::RS274, Dialect::LATHE_A] {
        let lines = run(data, dialect);
        if !data.contains(&b'\r') {
            for end in ["\r\n", "\r"] {
                let lines_of = data.split(|byte| *byte == b'\n');
                let other = lines_of.collect::<Vec<_>>().join(end.as_bytes());
                assert_eq!(run(&other, dialect), lines, "line ends do not matter");
            }
        }
    }
}

/// The number of each line in the order of execution, with the position of the machine after it or
/// its error.
type Trace = Vec<(usize, Result<[i64; 3], ErrorKind>)>;

fn run(text: &[u8], dialect: Dialect) -> Trace {
    let mut program = Small::new(text, dialect).with_steps(STEPS);
    let mut modal = Modal::<3>::new(dialect);
    let mut trace = Vec::new();
    let mut last = STEPS;
    loop {
        let before = parameters_of(&program);
        let level = program.call_level();
        let Some(line) = program.next_line(&modal) else {
            break;
        };
        check_line(text, &line);
        assert!(trace.len() as u64 <= STEPS + 2, "more lines than steps");
        assert!(program.steps_left() <= last, "steps come back");
        assert!(program.call_level() <= 4);
        last = program.steps_left();
        let number = line.number;
        let is_read = line.block.is_ok();
        let planned = line.block.and_then(|block| modal.plan(&block));
        if !is_read && program.call_level() == level {
            assert_eq!(
                parameters_of(&program),
                before,
                "a wrong line assigns nothing"
            );
        }
        match planned {
            Ok((next, _)) => {
                modal = next;
                trace.push((number, Ok(modal.position().map(|nm| nm.0))));
            }
            Err(error) => {
                assert!(
                    error.at <= error.end && error.end <= line.text.len(),
                    "{error:?} in {} bytes",
                    line.text.len()
                );
                assert!(!error.to_string().is_empty());
                trace.push((number, Err(error.kind)));
            }
        }
    }
    assert!(
        program.next_line(&modal).is_none(),
        "what is over stays over"
    );
    trace
}

fn check_line(text: &[u8], line: &Line<'_>) {
    assert_eq!(
        text.get(line.at..line.at + line.text.len()),
        Some(line.text),
        "a line of the text"
    );
    assert_eq!(lines(&text[..line.at]).count() + 1, line.number);
}

type Parts = (i64, u8);

/// Digits and places of the parameters that are compared.
fn parameters_of(program: &Small<'_>) -> ([Parts; 6], [Option<Parts>; 3]) {
    let parts = |value: Value| (value.digits(), value.places());
    (
        NUMBERS.map(|number| parts(program.parameter(number))),
        NAMES.map(|name| program.named_parameter(name).map(parts)),
    )
}
