//! The data items of a machine: what the agent is told, and what its file of devices says of it.

use serde_json::Value;

/// The value of an item that is not known.
pub const UNAVAILABLE: &str = "UNAVAILABLE";

/// The component to which an item belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Component {
    /// The whole machine.
    Device,
    /// Its controller.
    Controller,
    /// What the controller makes.
    Path,
    /// One of the axes.
    Axis,
    /// The spindle.
    Spindle,
}

/// A data item.
#[derive(Clone, Debug)]
pub struct Item {
    /// Its name, which is its key.
    pub key: String,
    /// Where it belongs.
    pub component: Component,
    /// Index of its axis.
    pub axis: usize,
    /// `EVENT`, `SAMPLE` or `CONDITION`.
    pub category: &'static str,
    /// Its type.
    pub kind: &'static str,
    /// Further attributes of its element.
    pub attributes: &'static [(&'static str, &'static str)],
    /// Its value in a state of the machine, with the index of the axis. `None`: it is not known.
    pub value: fn(&Value, usize) -> Option<String>,
}

impl Item {
    /// Whether it has several values. Such an item has a line of its own, because an agent ignores
    /// what follows it.
    pub fn is_alone(&self) -> bool {
        self.category == "CONDITION" || self.kind == "MESSAGE"
    }
}

/// The items of a machine that is described like this.
pub fn items(described: &Value) -> Vec<Item> {
    use Component::{Axis, Controller, Device, Path, Spindle};
    let item = |key: &str, component, category, kind, attributes, value| Item {
        key: key.to_owned(),
        component,
        axis: 0,
        category,
        kind,
        attributes,
        value,
    };
    const ACTUAL: (&str, &str) = ("subType", "ACTUAL");
    const PROGRAMMED: (&str, &str) = ("subType", "PROGRAMMED");
    const PERCENT: (&str, &str) = ("units", "PERCENT");
    let mut items = vec![
        item(
            "avail",
            Device,
            "EVENT",
            "AVAILABILITY",
            &[],
            avail as fn(&Value, usize) -> _,
        ),
        item("link", Controller, "CONDITION", "COMMUNICATIONS", &[], link),
        item("system", Controller, "CONDITION", "SYSTEM", &[], system),
        item("execution", Path, "EVENT", "EXECUTION", &[], execution),
        item("mode", Path, "EVENT", "CONTROLLER_MODE", &[], mode),
        item("program", Path, "EVENT", "PROGRAM", &[], program),
        item(
            "line",
            Path,
            "EVENT",
            "LINE_NUMBER",
            &[("subType", "ABSOLUTE")],
            line,
        ),
        item("message", Path, "EVENT", "MESSAGE", &[], message),
        item(
            "feed",
            Path,
            "SAMPLE",
            "PATH_FEEDRATE",
            &[ACTUAL, ("units", "MILLIMETER/SECOND")],
            feed,
        ),
        item(
            "feed_override",
            Path,
            "EVENT",
            "PATH_FEEDRATE_OVERRIDE",
            &[PROGRAMMED, PERCENT],
            |state, _| percent(state, "feed"),
        ),
        item(
            "rapid_override",
            Path,
            "EVENT",
            "PATH_FEEDRATE_OVERRIDE",
            &[("subType", "RAPID"), PERCENT],
            |state, _| percent(state, "rapid"),
        ),
        item(
            "spindle_override",
            Spindle,
            "EVENT",
            "ROTARY_VELOCITY_OVERRIDE",
            &[PERCENT],
            |state, _| percent(state, "spindle"),
        ),
        item(
            "spindle_speed",
            Spindle,
            "SAMPLE",
            "ROTARY_VELOCITY",
            &[("subType", "COMMANDED"), ("units", "REVOLUTION/MINUTE")],
            |state, _| up(state).and_then(|state| decimals(state["rpm"].as_f64()?)),
        ),
    ];
    for (axis, letter) in axes(described).into_iter().enumerate() {
        let letter = letter.to_lowercase();
        let position = |key: &str, attributes, value| Item {
            axis,
            ..item(
                &format!("{letter}_{key}"),
                Axis,
                "SAMPLE",
                "POSITION",
                attributes,
                value,
            )
        };
        items.push(position(
            "position",
            &[
                ACTUAL,
                ("units", "MILLIMETER"),
                ("coordinateSystem", "MACHINE"),
            ],
            |state, axis| up(state).and_then(|state| decimals(state["machine_mm"][axis].as_f64()?)),
        ));
        items.push(position(
            "work",
            &[
                ACTUAL,
                ("units", "MILLIMETER"),
                ("coordinateSystem", "WORK"),
            ],
            |state, axis| up(state).and_then(|state| decimals(state["work_mm"][axis].as_f64()?)),
        ));
    }
    items
}

/// The letters of the axes.
pub fn axes(described: &Value) -> Vec<&str> {
    let axes = described["axes"].as_array();
    axes.map_or_else(Vec::new, |axes| {
        axes.iter().filter_map(Value::as_str).collect()
    })
}

/// A state in which the controller answers.
fn up(state: &Value) -> Option<&Value> {
    (state["link"] == "up").then_some(state)
}

fn avail(state: &Value, _: usize) -> Option<String> {
    up(state).map(|_| "AVAILABLE".to_owned())
}

fn link(state: &Value, _: usize) -> Option<String> {
    match state["link"].as_str()? {
        "up" => Some("NORMAL||||".to_owned()),
        "lost" => Some(condition(
            "FAULT",
            "",
            state["why"].as_str().unwrap_or_default(),
        )),
        _ => None,
    }
}

fn system(state: &Value, _: usize) -> Option<String> {
    let alarm = &up(state)?["alarm"];
    if alarm.is_null() {
        return Some("NORMAL||||".to_owned());
    }
    let code = alarm["number"].to_string();
    let text = alarm["text"].as_str().or(alarm.as_str());
    Some(condition("FAULT", &code, text.unwrap_or_default()))
}

/// Level, native code, native severity, qualifier and text.
fn condition(level: &str, code: &str, text: &str) -> String {
    format!("{level}|{}|||{}", plain(code), plain(text))
}

fn execution(state: &Value, _: usize) -> Option<String> {
    let state = up(state)?;
    let phase = state["program"]["phase"].as_str();
    let execution = match (state["state"].as_str()?, phase) {
        ("Alarm" | "Sleep", _) => "STOPPED",
        ("Hold", _) | (_, Some("held")) => "FEED_HOLD",
        ("Door" | "Tool", _) => "INTERRUPTED",
        (_, Some("waiting")) => "WAIT",
        ("Run" | "Jog" | "Home", _) | (_, Some("running" | "stopping")) => "ACTIVE",
        (_, Some("done")) => "PROGRAM_COMPLETED",
        (_, Some("stopped" | "failed")) => "STOPPED",
        _ => "READY",
    };
    Some(execution.to_owned())
}

fn mode(state: &Value, _: usize) -> Option<String> {
    let phase = up(state)?["program"]["phase"].as_str();
    let is_automatic = matches!(phase, Some("running" | "held" | "waiting" | "stopping"));
    Some(if is_automatic { "AUTOMATIC" } else { "MANUAL" }.to_owned())
}

fn program(state: &Value, _: usize) -> Option<String> {
    up(state)?["program"]["name"].as_str().map(plain)
}

fn line(state: &Value, _: usize) -> Option<String> {
    Some(up(state)?["program"]["line"].as_u64()?.to_string())
}

/// A native code, which is empty, and a text.
fn message(state: &Value, _: usize) -> Option<String> {
    let state = up(state)?;
    let text = state["program"]["message"]
        .as_str()
        .or(state["advice"].as_str());
    Some(format!("|{}", plain(text.unwrap_or_default())))
}

fn feed(state: &Value, _: usize) -> Option<String> {
    decimals(up(state)?["feed"].as_f64()? / 60.0)
}

fn percent(state: &Value, which: &str) -> Option<String> {
    Some(up(state)?["override"][which].as_f64()?.to_string())
}

fn decimals(value: f64) -> Option<String> {
    // A rounded negative zero is written as zero.
    Some(format!("{:.3}", (value * 1e3).round() / 1e3 + 0.0))
}

/// A text that does not end a value or a line.
fn plain(text: &str) -> String {
    let plain = |c: char| match c {
        '|' => '/',
        c if c.is_control() => ' ',
        c => c,
    };
    text.chars().map(plain).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn execution_follows_machine_and_program() {
        for (now, phase, expected) in [
            ("Idle", None, "READY"),
            ("Idle", Some("loaded"), "READY"),
            ("Run", Some("running"), "ACTIVE"),
            ("Idle", Some("running"), "ACTIVE"),
            ("Hold", Some("held"), "FEED_HOLD"),
            ("Idle", Some("waiting"), "WAIT"),
            ("Door", Some("running"), "INTERRUPTED"),
            ("Idle", Some("done"), "PROGRAM_COMPLETED"),
            ("Idle", Some("stopped"), "STOPPED"),
            ("Alarm", Some("failed"), "STOPPED"),
            ("Jog", Some("done"), "ACTIVE"),
        ] {
            let program = phase.map(|phase| json!({"phase": phase}));
            let mut state = json!({"link": "up", "state": now, "program": program});
            assert_eq!(execution(&state, 0).unwrap(), expected, "{now} {phase:?}");
            state["link"] = json!("lost");
            assert_eq!(execution(&state, 0), None);
        }
    }

    #[test]
    fn a_lost_controller_is_a_fault_of_the_link() {
        let state = json!({"link": "lost", "why": "unplugged"});
        assert_eq!(link(&state, 0).unwrap(), "FAULT||||unplugged");
        assert_eq!((system(&state, 0), avail(&state, 0)), (None, None));
    }
}
