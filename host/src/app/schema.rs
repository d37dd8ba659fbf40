//! `husillo schema`: what the JSON of the commands consists of.

use super::{Failure, OK};
use crate::console;
use std::io::Write;

/// The schemas and their names.
const SCHEMAS: [(&str, &str); 16] = [
    ("check", include_str!("../../schemas/check.json")),
    ("commands", include_str!("../../schemas/commands.json")),
    (
        "commands.records",
        include_str!("../../schemas/commands.records.json"),
    ),
    ("compare", include_str!("../../schemas/compare.json")),
    ("error", include_str!("../../schemas/error.json")),
    ("holes", include_str!("../../schemas/holes.json")),
    (
        "holes.records",
        include_str!("../../schemas/holes.records.json"),
    ),
    (
        "interpolate",
        include_str!("../../schemas/interpolate.json"),
    ),
    ("machines", include_str!("../../schemas/machines.json")),
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
