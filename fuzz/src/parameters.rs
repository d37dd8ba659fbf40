//! Any program with parameters and O-words.

use husillo_gcode::parameters::{NoMachine, Program, Value};
use husillo_gcode::{Dialect, Modal};

/// Steps every program is given.
const STEPS: u64 = 2000;

/// Any text as an expression, and as a program: every program ends within its steps, every line is one of the text, every
/// place of an error lies inside its line, a value printed and read again is the same, and a machine beside it changes no
/// line but those that ask for it.
pub fn parameters(data: &[u8]) {
    check_value(data);
    for dialect in [Dialect::RS274, Dialect::LATHE_A] {
        let mut program: Program<'_, 8, 16, 4> = Program::new(data, dialect).with_steps(STEPS);
        let mut modal = Modal::<3>::new(dialect);
        let (mut lines, mut last) = (0, STEPS);
        while let Some(line) = program.next_line(&modal) {
            lines += 1;
            assert!(lines <= STEPS + 2, "more lines than steps");
            assert!(program.steps_left() <= last, "steps come back");
            last = program.steps_left();
            assert!(program.call_level() <= 4);
            let end = line.at + line.text.len();
            assert_eq!(
                data.get(line.at..end),
                Some(line.text),
                "a line of the text"
            );
            assert_eq!(
                data[..line.at]
                    .iter()
                    .filter(|byte| **byte == b'\n')
                    .count()
                    + 1,
                line.number
            );
            match line.block.and_then(|block| modal.plan(&block)) {
                Ok((next, _)) => modal = next,
                Err(error) => {
                    assert!(
                        error.at <= error.end && error.end <= line.text.len(),
                        "{error:?} in {} bytes",
                        line.text.len()
                    );
                    assert!(!error.to_string().is_empty());
                }
            }
        }
        assert!(
            program.next_line(&modal).is_none(),
            "what is over stays over"
        );
    }
}

/// The value of the first line as an expression.
fn value(expression: &[u8]) -> Option<Value> {
    let text = [b"#1=", expression].concat();
    let mut program: Program<'_, 4, 4, 1> = Program::new(&text, Dialect::RS274);
    let line = program.next_line(&NoMachine)?;
    line.block.ok()?;
    Some(program.parameter(1))
}

fn check_value(data: &[u8]) {
    let line = data.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let Some(first) = value(line) else { return };
    assert!(first.places() <= Value::MAX_PLACES);
    let printed = first.to_string();
    let again = value(printed.as_bytes()).unwrap_or_else(|| panic!("{printed} is not read"));
    assert_eq!(
        (first.digits(), first.places()),
        (again.digits(), again.places()),
        "{printed}"
    );
}
