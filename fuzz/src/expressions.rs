//! Values and expressions.

use husillo_gcode::Dialect;
use husillo_gcode::parameters::{NoMachine, Program, Value};

use crate::bytes::Bytes;

/// With an odd first byte, the rest is any text as an expression. With an even one, the rest
/// chooses an expression of whole numbers.
///
/// - A value printed and read again is the same; an error has its columns inside the line.
/// - Blanks, case and surrounding brackets change no value. An expression minus itself is zero. It
///   equals itself, and is between its `FIX` and its `FUP`.
/// - Operators have the precedence of the language: expressions of whole numbers have the value of
///   an independent evaluator.
pub fn expressions(data: &[u8]) {
    match data.split_first() {
        Some((first, rest)) if first % 2 == 0 => check_whole(rest),
        Some((_, text)) => check_text(
            text.split(|byte| matches!(byte, b'\n' | b'\r'))
                .next()
                .unwrap_or(&[]),
        ),
        None => {}
    }
}

/// The value of an expression.
fn value(expression: &[u8]) -> Option<Value> {
    let text = [b"#1=", expression].concat();
    let mut program: Program<'_, 4, 4, 1> = Program::new(&text, Dialect::RS274);
    let line = program.next_line(&NoMachine)?;
    if let Err(error) = line.block {
        assert!(error.at <= error.end && error.end <= line.text.len());
        assert!(!error.to_string().is_empty());
        return None;
    }
    Some(program.parameter(1))
}

/// Digits and places.
fn parts(value: Option<Value>) -> Option<(i64, u8)> {
    value.map(|value| (value.digits(), value.places()))
}

fn check_text(text: &[u8]) {
    let Some(first) = value(text) else { return };
    assert!(first.places() <= Value::MAX_PLACES);
    let printed = first.to_string();
    assert_eq!(
        parts(value(printed.as_bytes())),
        parts(Some(first)),
        "{printed}"
    );

    let wide: Vec<u8> = text.iter().flat_map(|&byte| [byte, b' ']).collect();
    assert_eq!(parts(value(&wide)), parts(Some(first)), "blanks");
    for other in [text.to_ascii_uppercase(), text.to_ascii_lowercase()] {
        assert_eq!(parts(value(&other)), parts(Some(first)), "case");
    }

    // Text followed by more (an assignment, a comment) cannot be put in brackets.
    let within = |before: &str, between: &str, behind: &str| {
        let (before, between, behind) = (before.as_bytes(), between.as_bytes(), behind.as_bytes());
        if between.is_empty() {
            value(&[before, text, behind].concat())
        } else {
            value(&[before, text, between, text, behind].concat())
        }
    };
    if within("[", "", "]").is_none() {
        return;
    }
    // The nested forms may be too deep and then have no value.
    let inner = parts(within("[", "", "]"));
    assert!(parts(within("[[", "", "]]")).is_none_or(|outer| Some(outer) == inner));
    for (before, between, behind, expected) in [
        ("[[", "]-[", "]]", 0),
        ("[[", "]eq[", "]]", 1),
        ("[[", "]ne[", "]]", 0),
        ("[[", "]xor[", "]]", 0),
        ("[fix[", "]le[", "]]", 1),
        ("[fup[", "]ge[", "]]", 1),
        ("[0 le abs[", "", "]]", 1),
    ] {
        if let Some(found) = within(before, between, behind) {
            assert_eq!(found.whole(), Some(expected), "{before}x{between}x{behind}");
        }
    }
}

/// Operators on whole numbers, from the lowest precedence: spelling, precedence, and function.
type Operator = (&'static str, u8, fn(i64, i64) -> i64);

const OPERATORS: [Operator; 12] = [
    ("and", 0, |a, b| (a != 0 && b != 0).into()),
    ("or", 0, |a, b| (a != 0 || b != 0).into()),
    ("xor", 0, |a, b| ((a != 0) != (b != 0)).into()),
    ("eq", 1, |a, b| (a == b).into()),
    ("ne", 1, |a, b| (a != b).into()),
    ("gt", 1, |a, b| (a > b).into()),
    ("ge", 1, |a, b| (a >= b).into()),
    ("lt", 1, |a, b| (a < b).into()),
    ("le", 1, |a, b| (a <= b).into()),
    ("+", 2, |a, b| a + b),
    ("-", 2, |a, b| a - b),
    ("*", 3, |a, b| a * b),
];

/// Largest count of numbers: the product of nine numbers of two digits is below 2^63.
const NUMBERS: usize = 9;

fn check_whole(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let number = |bytes: &mut Bytes<'_>| i64::from(bytes.byte() as i8) % 100;
    let mut numbers = vec![number(&mut bytes)];
    let mut operators = Vec::new();
    let mut text = format!("[{}", numbers[0]);
    while !bytes.is_empty() && numbers.len() < NUMBERS {
        let operator = OPERATORS[usize::from(bytes.byte()) % OPERATORS.len()];
        let right = number(&mut bytes);
        text += &format!(" {} {right}", operator.0);
        operators.push(operator);
        numbers.push(right);
    }
    text.push(']');
    // One precedence after the other, from the left.
    for strength in (0..=3).rev() {
        while let Some(at) = operators.iter().position(|operator| operator.1 == strength) {
            let (_, _, apply) = operators.remove(at);
            let right = numbers.remove(at + 1);
            numbers[at] = apply(numbers[at], right);
        }
    }
    let found = value(text.as_bytes()).and_then(Value::whole);
    assert_eq!(found, Some(numbers[0]), "{text}");
}
