//! `husillo schema`: what the JSON of the commands consists of.

use super::{Failure, OK};
use crate::console;
use std::io::Write;

/// The schemas and their names.
const SCHEMAS: [(&str, &str); 31] = [
    (
        "calibrate.axis",
        include_str!("../../schemas/calibrate.axis.json"),
    ),
    (
        "calibrate.backlash",
        include_str!("../../schemas/calibrate.backlash.json"),
    ),
    (
        "calibrate.circles",
        include_str!("../../schemas/calibrate.circles.json"),
    ),
    (
        "calibrate.squareness",
        include_str!("../../schemas/calibrate.squareness.json"),
    ),
    ("check", include_str!("../../schemas/check.json")),
    ("commands", include_str!("../../schemas/commands.json")),
    (
        "commands.records",
        include_str!("../../schemas/commands.records.json"),
    ),
    ("compare", include_str!("../../schemas/compare.json")),
    (
        "compare.motion",
        include_str!("../../schemas/compare.motion.json"),
    ),
    ("compile", include_str!("../../schemas/compile.json")),
    ("emulate", include_str!("../../schemas/emulate.json")),
    ("error", include_str!("../../schemas/error.json")),
    ("explain", include_str!("../../schemas/explain.json")),
    ("format", include_str!("../../schemas/format.json")),
    ("holes", include_str!("../../schemas/holes.json")),
    (
        "holes.records",
        include_str!("../../schemas/holes.records.json"),
    ),
    (
        "interpolate",
        include_str!("../../schemas/interpolate.json"),
    ),
    ("jog", include_str!("../../schemas/jog.json")),
    ("machines", include_str!("../../schemas/machines.json")),
    (
        "machines.file",
        include_str!("../../schemas/machines.file.json"),
    ),
    (
        "machines.measuring",
        include_str!("../../schemas/machines.measuring.json"),
    ),
    (
        "machines.show",
        include_str!("../../schemas/machines.show.json"),
    ),
    ("measure", include_str!("../../schemas/measure.json")),
    (
        "measure.run",
        include_str!("../../schemas/measure.run.json"),
    ),
    ("reproduce", include_str!("../../schemas/reproduce.json")),
    ("run", include_str!("../../schemas/run.json")),
    ("send", include_str!("../../schemas/send.json")),
    ("serve", include_str!("../../schemas/serve.json")),
    ("steps", include_str!("../../schemas/steps.json")),
    ("stop", include_str!("../../schemas/stop.json")),
    ("tune", include_str!("../../schemas/tune.json")),
];

/// Prints a schema, or the names of all.
///
/// # Errors
///
/// There is no such schema.
pub(super) fn print(name: Option<&str>) -> Result<u8, Failure> {
    let out = &mut console::stdout();
    let Some(name) = name else {
        for (name, _) in SCHEMAS {
            writeln!(out, "{name}")?;
        }
        return Ok(OK);
    };
    let found = SCHEMAS.iter().find(|(there, _)| *there == name);
    let (_, schema) = found.ok_or_else(|| {
        let names = SCHEMAS.map(|(name, _)| name).join(", ");
        Failure::Usage(format!("no schema `{name}`: there are {names}"))
    })?;
    out.write_all(schema.as_bytes())?;
    Ok(OK)
}
