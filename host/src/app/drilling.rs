//! `compile`, and the other commands on records of the drill.

use super::job::{displayed, whole};
use super::reporting::{MOST_PRINTED, count, with_some_findings};
use super::{ERRORS, Failure, OK};
use crate::cli::{Compile, DrillOrder, Drilling, Listing, Send};
use crate::console;
use crate::console::reporter::Reporter;
use crate::drill::{self, Translation};
use crate::holes;
use crate::holes::drill_records::{Compiler, Refusal};
use crate::input;
use crate::output::Outputs;
use husillo_clients::drill::{Part, lean, millimetres, seconds, spoken, travel_steps};
use husillo_gcode::{Dialect, Nm};
use husillo_holes::{Metric, ToolRecords};
use husillo_reports::board::{self, Board};
use husillo_sim::device::drill::STROKE_STEPS;
use husillo_simulator::programs::setup;
use husillo_simulator::text::json::{Millimetres, write_line};
use husillo_transports::drill::{Record, STEPS_PER_MM, Table};
use serde::Serialize;
use serde_json::json;
use std::io::{BufWriter, Write};

/// What is to be drilled.
pub(super) struct Job {
    /// Tool by tool.
    pub(super) parts: Vec<Part>,
    /// Steps of travel in the order of the file, if the order was changed.
    file_travel_steps: Option<u64>,
    /// It is a drill file, whose records get a manifest.
    is_drill_file: bool,
}

/// Reads a program, a drill file, records or a manifest; `None` if it has errors, which are
/// reported.
pub(super) fn load(
    file: &str,
    dialect: Option<&str>,
    args: &Drilling,
    out: &mut Reporter<'_>,
) -> Result<Option<Job>, Failure> {
    let lower = file.to_ascii_lowercase();
    let of_parts = |parts| Job {
        parts,
        file_travel_steps: None,
        is_drill_file: false,
    };
    let is_made = lower.ends_with(".toml") || lower.ends_with(".cod");
    if is_made && !args.is_default() {
        return Err(Failure::Usage(format!(
            "{file}: records have positions and depths already; use these options when you compile \
             them"
        )));
    }
    if lower.ends_with(".toml") {
        return Ok(Some(of_parts(drill::load_manifest(file)?)));
    }
    if lower.ends_with(".cod") {
        let part = Part {
            tool: 0,
            diameter: None,
            records: drill::load_records(file)?,
        };
        return Ok(Some(of_parts(vec![part])));
    }
    if holes::is_drill_file(dialect, file) {
        return of_drill_file(file, args, out);
    }
    let name = displayed(file);
    let dialect = match dialect {
        None if args.fixed => Dialect::RS274,
        None => Dialect::DRILL,
        some => setup::dialect(some, file, None)?,
    };
    let home_height = holes::length(&args.home_height)
        .ok_or_else(|| format!("--home-height {}: a length", args.home_height))?;
    let translation = Translation {
        dialect,
        table: table(args),
        home_height,
    };
    let mut source =
        input::program(file).map_err(|error| Failure::Usage(format!("{file}: {error}")))?;
    let (parts, findings) = with_some_findings(MOST_PRINTED, out.format(), |findings| {
        Ok(translation.read(&mut source, name, findings)?)
    })?;
    out.findings(name, &findings);
    Ok((findings.errors == 0).then(|| of_parts(parts)))
}

fn table(args: &Drilling) -> Table {
    if args.layout.unbounded {
        Table::UNBOUNDED
    } else {
        Table::DRILL
    }
}

fn of_drill_file(
    file: &str,
    args: &Drilling,
    out: &mut Reporter<'_>,
) -> Result<Option<Job>, Failure> {
    let options = holes::Options::new(&args.layout)?;
    let depth = match &args.depth {
        None => 0,
        Some(text) => steps_of(text)
            .filter(|steps| *steps <= STROKE_STEPS)
            .ok_or_else(|| {
                format!(
                    "--depth {text}: a length above zero, up to 35 mm, where the lower sensor is"
                )
            })?,
    };
    let name = displayed(file);
    let text = whole(file)?;
    let (mut board, findings) = with_some_findings(MOST_PRINTED, out.format(), |findings| {
        Ok(holes::read(&text, name, &options, findings))
    })?;
    out.findings(name, &findings);
    if findings.errors > 0 {
        return Ok(None);
    }
    if let Some(fit) = holes::apply(&mut board, &options)? {
        eprintln!("{name}: {fit}");
    }
    let compiler = Compiler::new(&args.layout);
    let mut compile = |board: &husillo_holes::Board| match compiler.compile(board, name) {
        Ok(tools) => Ok(Some(tools)),
        Err(Refusal::Usage(message)) => Err(Failure::Usage(message)),
        Err(Refusal::Finding(finding)) => {
            let ((), findings) = with_some_findings(MOST_PRINTED, out.format(), |findings| {
                findings.add(*finding);
                Ok(())
            })?;
            out.findings(name, &findings);
            Ok(None)
        }
    };
    let parts = |tools: Vec<ToolRecords>| -> Vec<Part> {
        let to_depth = |record: Record| match record {
            Record::Drill(_) => Record::Drill(depth),
            other => other,
        };
        let part = |tool: ToolRecords| {
            let records: Vec<_> = tool.records.into_iter().map(to_depth).collect();
            Part {
                tool: tool.tool.number.into(),
                diameter: tool.tool.diameter_nm.map(Nm),
                records: lean(&records),
            }
        };
        tools.into_iter().map(part).collect()
    };
    let Some(tools) = compile(&board)? else {
        return Ok(None);
    };
    let mut job = Job {
        parts: parts(tools),
        file_travel_steps: None,
        is_drill_file: true,
    };
    if args.layout.order == DrillOrder::Shortest {
        job.file_travel_steps = Some(job.parts.iter().map(travel_steps).sum());
        board.sort_shortest(Metric::AxisByAxis);
        if let Some(tools) = compile(&board)? {
            job.parts = parts(tools);
        }
    }
    Ok(Some(job))
}

/// A depth in steps.
fn steps_of(text: &str) -> Option<u16> {
    let Nm(nm) = holes::length(text)?;
    let steps = (i128::from(nm) * i128::from(STEPS_PER_MM) + 500_000).div_euclid(1_000_000);
    u16::try_from(steps).ok().filter(|steps| *steps > 0)
}

/// Checks that the machine is the drill. The error is a sentence.
pub(super) fn expect_drill(machine: Option<&str>) -> Result<(), Failure> {
    match machine {
        None | Some("drill") => Ok(()),
        Some(other) => Err(Failure::Usage(format!(
            "{other} has no controller that this command knows: name micromill, drill or \
             microfactory with -m"
        ))),
    }
}

pub(super) fn compile(args: &Compile) -> Result<u8, Failure> {
    expect_drill(args.target.machine.as_deref())?;
    let name = displayed(&args.file);
    let dialect = args.target.dialect.as_deref();
    let stdout = &mut console::stdout();
    let mut out = Reporter::new(stdout, args.format, "husillo.compile/1");
    let Some(job) = load(&args.file, dialect, &args.drilling, &mut out)? else {
        return Ok(nothing_made(name, "written", &out));
    };
    let parts = &job.parts;
    if parts.is_empty() {
        return Err(Failure::Usage(format!(
            "{name}: no hole, and a program needs one record"
        )));
    }
    let mut outputs = Outputs::new();
    let files = args
        .output
        .as_ref()
        .map(|output| drill::file_names(output, parts));
    for (place, part) in parts.iter().enumerate() {
        let file = files.as_ref().and_then(|files| files.get(place));
        tell_part(part, file.map(String::as_str), &mut out);
        if let Some(file) = file {
            outputs.write(file, &part.bytes())?;
        }
    }
    if let Some(steps) = job.file_travel_steps {
        let travel: u64 = parts.iter().map(travel_steps).sum();
        let [travel, file] = [travel, steps].map(|steps| steps as f64 / f64::from(STEPS_PER_MM));
        out.tell(
            format_args!(
                "travel {travel:.1} mm, in the order of the file {file:.1} mm: {:.0} % less",
                100.0 * (1.0 - travel / file.max(0.1))
            ),
            || json!({"kind": "travel", "mm": travel, "in_the_order_of_the_file_mm": file}),
        );
    }
    if let (Some(output), Some(files)) = (&args.output, &files) {
        if job.is_drill_file || parts.len() > 1 {
            let manifest = drill::manifest_name(output);
            let text = drill::manifest_text(name, parts, files)?;
            outputs.write(&manifest, text.as_bytes())?;
            out.tell(
                format_args!("{manifest}: the tools and their files"),
                || json!({"kind": "file", "output": manifest, "lines": text.lines().count()}),
            );
        }
    }
    if let Some(report) = &args.report {
        let page = board::html(&Board {
            name,
            parts,
            table: table(&args.drilling),
            file_travel_steps: job.file_travel_steps,
            operation: None,
        });
        outputs.write(report, page.as_bytes())?;
        out.tell(
            format_args!("{report}: the board"),
            || json!({"kind": "file", "output": report, "lines": page.lines().count()}),
        );
    }
    outputs.finish()?;
    if args.output.is_none() && args.report.is_none() {
        eprintln!("nothing written: see -o and --report");
    }
    Ok(OK)
}

/// Prints what the records of a tool do.
fn tell_part(part: &Part, file: Option<&str>, out: &mut Reporter<'_>) {
    let travel_mm = travel_steps(part) as f64 / f64::from(STEPS_PER_MM);
    let duration_s: f64 = seconds(part, [0; 2]).iter().sum();
    let bytes = part.bytes().len();
    let to = file.map_or(String::new(), |file| format!("{file}: "));
    out.tell(
        format_args!(
            "{to}{}, {}, {}, {travel_mm:.1} mm in X and Y, about {}",
            part.name(),
            count(part.holes() as u64, "hole"),
            count(bytes as u64, "byte"),
            spoken(duration_s)
        ),
        || {
            json!({
                "kind": "tool",
                "output": file,
                "tool": part.tool,
                "diameter_mm": part.diameter.map(|Nm(nm)| Millimetres(nm)),
                "holes": part.holes(),
                "bytes": bytes,
                "travel_mm": travel_mm,
                "duration_s": duration_s,
            })
        },
    );
}

/// The exit status of a command on a program with errors. Objects have said so.
fn nothing_made(name: &str, done: &str, out: &Reporter<'_>) -> u8 {
    if !out.is_json() {
        eprintln!("{name}: errors; nothing {done}");
    }
    ERRORS
}

/// `send`.
pub(super) fn send(args: &Send, out: &mut Reporter<'_>) -> Result<u8, Failure> {
    expect_drill(args.target.machine.as_deref())?;
    let (file, _) = args.alone()?;
    let name = displayed(file);
    let dialect = args.target.dialect.as_deref();
    let Some(job) = load(file, dialect, &args.drilling, out)? else {
        return Ok(nothing_made(name, "sent", out));
    };
    if job.parts.is_empty() {
        return Err(Failure::Usage(format!("{name}: no hole")));
    }
    let is_well = drill::send(args, &job.parts, out)?;
    Ok(if is_well { OK } else { ERRORS })
}

/// A record as `commands --format json` prints it.
#[derive(Serialize)]
struct ListedRecord {
    record: usize,
    kind: &'static str,
    steps: u16,
    nm: i64,
}

/// `commands` of a file of records.
pub(super) fn list(file: &str, format: Listing) -> Result<u8, Failure> {
    let records = drill::load_records(file)?;
    let mut out = BufWriter::new(console::stdout());
    match format {
        Listing::Gcode => out.write_all(drill::program_text(&records)?.as_bytes())?,
        Listing::Text => {
            for (number, record) in records.iter().enumerate() {
                let to = match record {
                    Record::X(steps) | Record::Y(steps) => {
                        format!("{} mm", millimetres(*steps))
                    }
                    Record::Drill(0) => "to the lower sensor".into(),
                    Record::Drill(steps) => format!("{} mm deep", millimetres(*steps)),
                };
                writeln!(out, "{:>6}  {:<12} {to}", number + 1, record.to_string())?;
            }
        }
        Listing::Json => {
            for (number, record) in records.iter().enumerate() {
                let (kind, steps) = match *record {
                    Record::X(steps) => ("x", steps),
                    Record::Y(steps) => ("y", steps),
                    Record::Drill(steps) => ("drill", steps),
                };
                let listed = ListedRecord {
                    record: number + 1,
                    kind,
                    steps,
                    nm: millimetres(steps).0,
                };
                write_line("husillo.commands.records/1", &listed, &mut out)?;
            }
        }
    }
    out.flush()?;
    Ok(OK)
}
