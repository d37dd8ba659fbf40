//! The answers.

use crate::message::{Answer, Failed, Request};
use crate::options::Options;
use crate::runs::{self, Held};
use crate::{tables, tune};
use husillo_simulator::holes;
use husillo_simulator::job::{Instant, Options as RunOptions};
use husillo_simulator::machines::machine_file::{MachineFile, Travel};
use husillo_simulator::scene::Scene;
use husillo_simulator::text::json::{write_found, write_line};
use serde::Deserialize;
use serde_json::{Value, json};

/// Most entries of one call.
const MOST_ROWS: u32 = 1 << 22;

/// A call.
#[derive(Debug, Deserialize)]
#[serde(tag = "call", rename_all = "snake_case")]
enum Call {
    Machines,
    MachineText { name: String },
    Check(Options),
    Commands(Options),
    Simulate(Options),
    Scene { run: u32 },
    Rows { run: u32, from: u64, count: u32 },
    Csv { run: u32, levels: bool },
    At { run: u32, event: u64 },
    AtTicks { run: u32, ticks: u64 },
    Close { run: u32 },
    Compare(tables::Compared),
    Holes(tables::Holes),
    Tune(tune::Experiment),
}

/// The answer of a request, as bytes. It does not fail: the answer says what is wrong.
pub fn answer(request: &[u8]) -> Vec<u8> {
    let Some(request) = Request::new(request) else {
        return Failed::from("the request is cut off".to_owned())
            .answer()
            .bytes();
    };
    let made = match serde_json::from_slice(request.text) {
        Ok(call) => made(call, request.data),
        Err(error) => Err(Failed::from(format!("options: {error}"))),
    };
    made.unwrap_or_else(Failed::answer).bytes()
}

fn made(call: Call, data: &[u8]) -> Result<Answer, Failed> {
    match call {
        Call::Machines => machines(),
        Call::MachineText { name } => match MachineFile::text_of(&name) {
            Some(text) => Answer::of(&json!({"text": text})),
            None => Err(format!("no machine `{name}` is built in").into()),
        },
        Call::Check(options) => check(&options, data),
        Call::Commands(options) => commands(&options, data),
        Call::Simulate(options) => simulate(&options, data),
        Call::Scene { run } => of_run(run, |held| Answer::with(&json!({}), held.scene.clone())),
        Call::Rows { run, from, count } => of_run(run, |held| rows(held, from, count)),
        Call::Csv { run, levels } => of_run(run, |held| {
            let mut csv = Vec::new();
            held.job.write_steps(held.compensation, levels, &mut csv)?;
            Answer::with(&json!({}), csv)
        }),
        Call::At { run, event } => of_run(run, |held| {
            let axes = held.job.machine.axes.len();
            let at = held.steps()?.at(event)?;
            Answer::of(&json!({"at": at.map(|at| instant(&at, axes))}))
        }),
        Call::AtTicks { run, ticks } => of_run(run, |held| {
            let axes = held.job.machine.axes.len();
            let at = held.steps()?.at_ticks(ticks)?;
            Answer::of(&json!({"at": instant(&at, axes)}))
        }),
        Call::Close { run } => {
            runs::close(run);
            Answer::of(&json!({}))
        }
        Call::Compare(of) => tables::compare(&of, data),
        Call::Holes(of) => tables::holes(&of, data),
        Call::Tune(of) => tune::tune(&of),
    }
}

fn of_run(
    run: u32,
    of: impl FnOnce(&mut Held) -> Result<Answer, Failed>,
) -> Result<Answer, Failed> {
    runs::with(run, of).unwrap_or_else(|| Err("this run is closed".to_owned().into()))
}

fn machines() -> Result<Answer, Failed> {
    let named = |name| {
        let machine = MachineFile::built_in(name)?;
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
        Some(json!({"name": machine.name, "title": machine.title, "axes": axes}))
    };
    let all: Vec<Value> = MachineFile::names().into_iter().filter_map(named).collect();
    Answer::of(&json!({"machines": all}))
}

fn check(options: &Options, program: &[u8]) -> Result<Answer, Failed> {
    let mut findings = options.findings();
    if holes::is_drill_file(None, &options.name) {
        holes::read(
            program,
            &options.name,
            &holes::Setup::default(),
            &mut findings,
        );
        let body = json!({
            "file": options.name,
            "errors": findings.errors,
            "warnings": findings.warnings,
            "notes": [],
        });
        return found("husillo.check/1", &body, &findings);
    }
    let mut job = options.job(program)?;
    let facts = job.check(&mut findings)?;
    let body = json!({
        "file": job.name(),
        "machine": job.machine.name,
        "errors": findings.errors,
        "warnings": findings.warnings,
        "notes": job.take_notes(),
        "feed_nm": facts.feed_nm.round(),
        "rapid_nm": facts.rapid_nm.round(),
        "reversals": &facts.reversals[..job.machine.axes.len()],
    });
    found("husillo.check/1", &body, &findings)
}

/// An answer with its findings.
fn found(
    schema: &str,
    body: &Value,
    findings: &husillo_simulator::diagnostics::Findings,
) -> Result<Answer, Failed> {
    let mut text = Vec::new();
    write_found(schema, body, findings, &mut text)?;
    Ok(Answer {
        text,
        data: Vec::new(),
    })
}

/// The commands are the data: one JSON object a line.
fn commands(options: &Options, program: &[u8]) -> Result<Answer, Failed> {
    let mut findings = options.findings();
    let job = options.job(program)?;
    let mut lines = Vec::new();
    job.write_commands(true, &mut findings, &mut lines)?;
    let body = json!({"errors": findings.errors, "warnings": findings.warnings});
    let answer = found("husillo.commands/1", &body, &findings)?;
    Ok(Answer {
        data: lines,
        ..answer
    })
}

fn simulate(options: &Options, program: &[u8]) -> Result<Answer, Failed> {
    let mut job = options.job(program)?;
    let mut findings = options.findings();
    let mut facts = job.check(&mut findings)?;
    if findings.errors > 0 {
        return Err(Failed::refused(job.name(), &findings));
    }
    let run_options = RunOptions {
        compensation: options.compensation,
        worn: options.worn,
        ..RunOptions::default()
    };
    let simulated = job.simulate(&mut facts, run_options, || {})?;
    let results = simulated.results(&job, &facts);
    let scene = Scene::of(&job, &simulated, &facts, &findings)?.bytes();
    let axes: String = job
        .machine
        .axes
        .iter()
        .map(|axis| char::from(axis.letter))
        .collect();
    let mut body = serde_json::to_value(&results).map_err(std::io::Error::from)?;
    let more = json!({
        "file": job.name(),
        "machine": job.machine.name,
        "axes": axes,
        "warnings": findings.warnings,
        "notes": job.take_notes(),
        "ticks": simulated.run.mechanics.ticks(),
        "ticks_per_second": job.machine.timer_hz,
        "nm_per_step": &simulated.run.mechanics.nm_per_step()[..job.machine.axes.len()],
    });
    drop(simulated);
    let run = runs::keep(Held::new(job, scene, options.compensation, options.worn));
    if let (Value::Object(body), Value::Object(more)) = (&mut body, more) {
        body.extend(more);
        body.insert("run".to_owned(), run.into());
    }
    found("husillo.run/1", &body, &findings)
}

fn instant(at: &Instant, axes: usize) -> Value {
    json!({
        "event": at.event,
        "ticks": at.ticks,
        "commanded": &at.commanded[..axes],
        "tool": &at.tool[..axes],
        "levels": &at.levels[..axes],
        "is_take_up": at.is_take_up,
    })
}

/// The data: waits of 32 bits, least significant byte first, then the steps of all axes.
fn rows(held: &mut Held, from: u64, count: u32) -> Result<Answer, Failed> {
    let axes = held.job.machine.axes.len();
    let steps = held.steps()?;
    let rows = steps.rows(from, count.min(MOST_ROWS) as usize)?;
    let waits = rows.wait_ticks.iter().flat_map(|wait| wait.to_le_bytes());
    let deltas = rows.delta.iter().map(|delta| delta.to_le_bytes()[0]);
    let data: Vec<u8> = waits.chain(deltas).collect();
    let count = rows.wait_ticks.len();
    Answer::with(
        &json!({"count": count, "axes": axes, "entries": steps.entries()}),
        data,
    )
}

/// An object with its schema.
pub fn listed(schema: &str, body: &Value) -> Result<Answer, Failed> {
    let mut text = Vec::new();
    write_line(schema, body, &mut text)?;
    Ok(Answer {
        text,
        data: Vec::new(),
    })
}
