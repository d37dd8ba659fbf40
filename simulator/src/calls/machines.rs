//! The machines that are built in.

use super::{Answer, Failed, Options};
use crate::machines::machine_file::{MachineFile, Travel};
use serde_json::{Value, json};

/// The built-in machines with their axes.
///
/// # Errors
///
/// The answer cannot be written as JSON.
pub fn machines() -> Result<Answer, Failed> {
    let named = |name| Some(described(&MachineFile::built_in(name)?));
    let all: Vec<Value> = MachineFile::names().into_iter().filter_map(named).collect();
    Answer::of(&json!({"machines": all}))
}

/// The machine of the options, with its axes and the text of its file.
///
/// # Errors
///
/// There is no such machine, or its file has mistakes.
pub fn machine(options: &Options) -> Result<Answer, Failed> {
    let machine = options.machine()?;
    let mut described = described(&machine);
    described["text"] = machine.text.as_ref().into();
    Answer::of(&described)
}

/// The text of the file of a built-in machine.
///
/// # Errors
///
/// There is no such machine.
pub fn machine_text(name: &str) -> Result<Answer, Failed> {
    match MachineFile::text_of(name) {
        Some(text) => Answer::of(&json!({"text": text})),
        None => Err(format!("no machine `{name}` is built in").into()),
    }
}

/// A machine with its axes.
fn described(machine: &MachineFile) -> Value {
    let axes = machine.axes.iter().map(|axis| {
        let travel = match axis.travel {
            Travel::Range(range) => Some(range),
            Travel::Unknown | Travel::Unlimited => None,
        };
        json!({
            "letter": char::from(axis.letter),
            "step_nm": axis.step.num as f64 / axis.step.den as f64,
            "travel_nm": travel,
        })
    });
    let axes: Vec<Value> = axes.collect();
    json!({
        "name": machine.name,
        "title": machine.title,
        "ticks_per_second": machine.timer_hz,
        "axes": axes,
    })
}
