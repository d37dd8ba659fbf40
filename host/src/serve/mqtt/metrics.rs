//! The values of a machine that the broker gets.

use super::job::Report;
use super::payload::{Metric, Type, Value};
use serde_json::Value as Json;

/// The values of a machine in a state. They are always the same ones, in the same order.
pub fn of_machine(state: &Json, axes: &[String]) -> Vec<Metric> {
    let program = &state["program"];
    let alarm = &state["alarm"];
    let mut metrics = vec![
        text("State", &state["state"]),
        boolean("Alarm/Active", !alarm.is_null()),
        natural("Alarm/Number", &alarm["number"]),
        text("Alarm/Text", &alarm["text"]),
        text("Advice", &state["advice"]),
        boolean(
            "Operated",
            state["operator"].as_u64().is_some_and(|client| client > 0),
        ),
    ];
    for (axis, letter) in axes.iter().enumerate() {
        let names = [("Machine", "machine_mm"), ("Work", "work_mm")];
        metrics.extend(names.map(|(frame, key)| {
            real(
                &format!("Position/{frame}/{letter}"),
                &state[key][axis],
                "mm",
            )
        }));
    }
    metrics.extend([
        real("Feed", &state["feed"], "mm/min"),
        real("Spindle Speed", &state["rpm"], "rpm"),
        real("Override/Feed", &state["override"]["feed"], "%"),
        real("Override/Rapid", &state["override"]["rapid"], "%"),
        real("Override/Spindle", &state["override"]["spindle"], "%"),
        text("Program/Name", &program["name"]),
        text("Program/Phase", &program["phase"]),
        natural("Program/Line", &program["line"]),
        natural("Program/Lines", &program["lines"]),
        real("Program/Progress", &program["progress"], "1"),
        real("Program/Remaining", &program["remaining_s"], "s"),
        text("Program/Message", &program["message"]),
        natural("Program/Resume Line", &program["resume_line"]),
    ]);
    metrics
}

/// The values of a job.
pub fn of_job(report: Option<&Report>) -> [Metric; 4] {
    let string = |name, value: Option<&str>| {
        Metric::new(
            name,
            Type::String,
            value.map(|text| Value::Text(text.into())),
        )
    };
    let line = report.and_then(|report| u32::try_from(report.line?).ok());
    [
        string("Job/Id", report.map(|report| &*report.id)),
        string("Job/State", report.map(|report| report.state.name())),
        string("Job/Message", report.map(|report| &*report.message)),
        Metric::new("Job/Line", Type::UInt32, line.map(Value::Int)),
    ]
}

/// What a job is given with. They have no values: they can only be written.
pub fn of_commands() -> [Metric; 2] {
    ["Job/Name", "Job/Program"].map(|name| Metric::new(name, Type::String, None))
}

/// Those that differ from the values before.
pub fn changed(now: &[Metric], before: &[Metric]) -> Vec<Metric> {
    let pairs = now.iter().zip(before);
    let differing = pairs.filter(|(now, before)| now.value != before.value);
    // The unit was told at the birth of the machine.
    let bare = |(metric, _): (&Metric, _)| Metric {
        properties: None,
        ..metric.clone()
    };
    differing.map(bare).collect()
}

fn text(name: &str, value: &Json) -> Metric {
    let value = value.as_str().map(|text| Value::Text(text.into()));
    Metric::new(name, Type::String, value)
}

fn boolean(name: &str, value: bool) -> Metric {
    Metric::new(name, Type::Boolean, Some(Value::Boolean(value)))
}

fn natural(name: &str, value: &Json) -> Metric {
    let value = value.as_u64().and_then(|value| u32::try_from(value).ok());
    Metric::new(name, Type::UInt32, value.map(Value::Int))
}

fn real(name: &str, value: &Json, unit: &str) -> Metric {
    let value = value.as_f64().map(Value::Double);
    Metric::new(name, Type::Double, value).with_unit(unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn only_what_has_changed_is_told() {
        let axes = ["X".to_owned(), "Y".to_owned()];
        let mut state = json!({"state": "Idle", "work_mm": [1.0, 2.0], "alarm": null});
        let before = of_machine(&state, &axes);
        assert_eq!(changed(&of_machine(&state, &axes), &before), []);
        state["work_mm"][1] = json!(2.5);
        state["alarm"] = json!({"number": 2, "text": "beyond the limits"});
        let told = changed(&of_machine(&state, &axes), &before);
        let names: Vec<_> = told.iter().filter_map(|one| one.name.as_deref()).collect();
        let expected = [
            "Alarm/Active",
            "Alarm/Number",
            "Alarm/Text",
            "Position/Work/Y",
        ];
        assert_eq!(names, expected);
        assert_eq!(told[3].value, Some(Value::Double(2.5)));
        // A state of which nothing is known has the same values.
        assert_eq!(of_machine(&Json::Null, &axes).len(), before.len());
    }
}
