//! The manifest of a board: one file of records for each tool.

use husillo_clients::drill::Part;
use husillo_gcode::Nm;
use husillo_sim::text::counted;
use husillo_transports::drill::{Record, records};
use serde::{Deserialize, Serialize};
use std::path::Path;

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Manifest {
    schema: u32,
    /// What it was made of.
    program: String,
    tool: Vec<Tool>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Tool {
    number: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    diameter_mm: Option<f64>,
    /// Beside the manifest.
    file: String,
    holes: usize,
    bytes: usize,
}

/// The names of the files of these parts: `NAME.cod`, or `NAME.T1.cod` and so on for several
/// parts.
pub fn file_names(output: &str, parts: &[Part]) -> Vec<String> {
    let stem = output.strip_suffix(".cod").unwrap_or(output);
    match parts {
        [_] => vec![output.to_owned()],
        _ => parts
            .iter()
            .enumerate()
            .map(|(place, part)| {
                // A tool may come twice.
                let again = parts[..place]
                    .iter()
                    .filter(|p| p.tool == part.tool)
                    .count();
                let again = if again > 0 {
                    format!("-{}", again + 1)
                } else {
                    String::new()
                };
                format!("{stem}.T{}{again}.cod", part.tool)
            })
            .collect(),
    }
}

/// The name of the manifest.
pub fn name(output: &str) -> String {
    format!("{}.toml", output.strip_suffix(".cod").unwrap_or(output))
}

/// The text of a manifest.
///
/// # Errors
///
/// A sentence.
pub fn text(program: &str, parts: &[Part], files: &[String]) -> Result<String, String> {
    let tools = parts.iter().zip(files).map(|(part, file)| {
        let name = Path::new(file).file_name();
        Tool {
            number: part.tool,
            diameter_mm: part.diameter.map(|nm| nm.0 as f64 / 1e6),
            file: name.map_or(file.clone(), |name| name.to_string_lossy().into_owned()),
            holes: part.holes(),
            bytes: part.bytes().len(),
        }
    });
    let manifest = Manifest {
        schema: 1,
        program: program.to_owned(),
        tool: tools.collect(),
    };
    let body = toml::to_string(&manifest).map_err(|error| error.to_string())?;
    Ok(format!(
        "# Records for the circuit-board drill, one file per tool: husillo send takes this \
             file.\n{body}"
    ))
}

/// Reads a manifest and the files it names.
///
/// # Errors
///
/// A sentence about what is missing or does not fit.
pub fn load(file: &str) -> Result<Vec<Part>, String> {
    let text = crate::input::read_to_string(file).map_err(|error| format!("{file}: {error}"))?;
    let manifest: Manifest = toml::from_str(&text).map_err(|error| {
        format!(
            "{file} is no manifest of drill records: {}",
            error.message()
        )
    })?;
    if manifest.schema != 1 {
        return Err(format!(
            "{file}: schema {}; this program reads schema 1",
            manifest.schema
        ));
    }
    let folder = Path::new(file).parent().unwrap_or(Path::new(""));
    let parts = manifest.tool.into_iter().map(|tool| {
        let path = folder.join(&tool.file);
        let path = path.to_string_lossy();
        let part = Part {
            tool: tool.number,
            diameter: tool.diameter_mm.map(|mm| Nm((mm * 1e6).round() as i64)),
            records: load_records(&path)?,
        };
        if tool.diameter_mm.is_some_and(|mm| !(mm > 0.0 && mm < 100.0)) {
            return Err(format!("{file}: tool {} has no diameter", tool.number));
        }
        if part.bytes().len() != tool.bytes {
            return Err(format!(
                "{path} has {}, and {file} says {}: compile it again",
                counted(part.bytes().len(), "byte"),
                tool.bytes
            ));
        }
        if part.holes() != tool.holes {
            return Err(format!(
                "{path} has {}, and {file} says {}: compile it again",
                counted(part.holes(), "hole"),
                tool.holes
            ));
        }
        Ok(part)
    });
    parts.collect()
}

/// Reads a file of records.
///
/// # Errors
///
/// A sentence with the position of the first wrong byte.
pub fn load_records(file: &str) -> Result<Vec<Record>, String> {
    let bytes = crate::input::read(file).map_err(|error| format!("{file}: {error}"))?;
    if bytes.is_empty() {
        return Err(format!(
            "{file}: an empty file, without records: compile it again"
        ));
    }
    let all: Result<Vec<_>, _> = records(&bytes).collect();
    all.map_err(|error| {
        let at = error.at;
        format!("{file}, byte {at}: {error}: name a file of `husillo compile -m drill`")
    })
}
