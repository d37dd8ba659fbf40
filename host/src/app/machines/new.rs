//! `husillo machines new`.

use super::super::{Failure, OK};
use super::write_new;
use crate::cli::NewMachine;
use crate::console::typed::typed_line;
use husillo_simulator::machines::new_machine::{Axis, Figure, by_axis, checked, text};

/// The figures that the options give, in the order of [`Figure::ALL`].
type Given = [Option<Vec<(char, String)>>; Figure::ALL.len()];

/// Asks for the figures that no option gives, checks them and writes the machine file.
pub fn make(args: &NewMachine) -> Result<u8, Failure> {
    let options = [
        &args.steps,
        &args.max_rate,
        &args.acceleration,
        &args.start_rate,
        &args.pull_out,
        &args.travel,
    ];
    let mut given = Given::default();
    for (given, option) in given.iter_mut().zip(options) {
        *given = option.as_deref().map(by_axis).transpose()?;
    }
    let letters = args.axes.to_ascii_uppercase();
    if husillo_gcode::Axes::new(letters.as_bytes()).is_none() {
        let why = "X, Y, Z, and up to three of A, B, C, U, V, W and E";
        return Err(Failure::Usage(format!("--axes {}: {why}", args.axes)));
    }
    for (letter, _) in given.iter().flatten().flatten() {
        if !letters.contains(*letter) {
            return Err(Failure::Usage(format!("--axes {letters} has no {letter}")));
        }
    }
    let axes: Result<Vec<Axis>, Failure> =
        letters.chars().map(|letter| axis(letter, &given)).collect();
    let text = checked(text(&args.name, &axes?)?)?;
    let file = match args.file.as_deref() {
        Some(file) => file.to_owned(),
        None => format!("{}.toml", args.name),
    };
    write_new(&args.name, &file, &text, args.format)?;
    Ok(OK)
}

/// The figures of an axis without a mistake. An axis whose figures were typed is asked for again.
fn axis(letter: char, given: &Given) -> Result<Axis, Failure> {
    loop {
        let mut axis = Axis {
            letter,
            ..Axis::default()
        };
        let mut was_typed = false;
        for (index, figure) in Figure::ALL.into_iter().enumerate() {
            let question = figure.question(letter, axis.unit());
            axis.figures[index] = match &given[index] {
                Some(values) => {
                    let own = values.iter().find(|(known, _)| *known == letter);
                    match own {
                        None if !figure.is_optional() => {
                            return Err(Failure::Usage(format!("missing: {question}")));
                        }
                        own => own.map_or_else(String::new, |(_, value)| value.clone()),
                    }
                }
                None => {
                    eprintln!("{question}:");
                    match typed_line(0) {
                        Some(line) => {
                            was_typed = true;
                            line.trim().to_owned()
                        }
                        None if figure.is_optional() => String::new(),
                        None => {
                            return Err(Failure::Usage(format!("missing: {question}")));
                        }
                    }
                }
            };
        }
        let mistakes = axis.mistakes();
        if mistakes.is_empty() {
            return Ok(axis);
        }
        if !was_typed {
            return Err(Failure::Usage(mistakes.join("\n")));
        }
        for mistake in mistakes {
            eprintln!("error: {mistake}");
        }
    }
}
