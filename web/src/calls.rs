//! The answers: those of [`husillo_simulator::calls`], and those about a run that is kept.

use crate::message::{self, Request};
use crate::runs::{self, Held};
use husillo_simulator::calls::{self, Answer, Failed, Options, Ready};
use husillo_simulator::job::Instant;
use husillo_simulator::scene::Scene;
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
    Compare(calls::Compared),
    Holes(calls::Holes),
    Tune(calls::Experiment),
}

/// The answer of a request, as bytes. It does not fail: the answer says what is wrong.
pub fn answer(request: &[u8]) -> Vec<u8> {
    let made = match Request::new(request) {
        None => Err(Failed::from("the request is cut off".to_owned())),
        Some(request) => match serde_json::from_slice(request.text) {
            Ok(call) => made(call, request.data),
            Err(error) => Err(Failed::from(format!("options: {error}"))),
        },
    };
    message::bytes(made.unwrap_or_else(Failed::answer))
}

/// The answer that says why a call has ended.
pub fn failure(why: String) -> Vec<u8> {
    message::bytes(Failed::from(why).answer())
}

fn made(call: Call, data: &[u8]) -> Result<Answer, Failed> {
    match call {
        Call::Machines => calls::machines(),
        Call::MachineText { name } => calls::machine_text(&name),
        Call::Check(options) => calls::check(&options, data),
        Call::Commands(options) => calls::commands(&options, data),
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
        Call::Compare(of) => calls::compare(&of, data),
        Call::Holes(of) => calls::holes(&of, data),
        Call::Tune(of) => calls::tune(&of),
    }
}

fn of_run(
    run: u32,
    of: impl FnOnce(&mut Held) -> Result<Answer, Failed>,
) -> Result<Answer, Failed> {
    runs::with(run, of).unwrap_or_else(|| Err("this run is closed".to_owned().into()))
}

fn simulate(options: &Options, program: &[u8]) -> Result<Answer, Failed> {
    let mut ready = Ready::new(options, program)?;
    let simulated = ready.simulate(None)?;
    let scene = Scene::of(&ready.job, &simulated, &ready.facts, &ready.findings)?.bytes();
    let (compensation, worn) = (options.compensation, options.worn);
    let run = runs::keep(Held::new(ready.job.clone(), scene, compensation, worn));
    ready.answer(&simulated, json!({"run": run}))
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
