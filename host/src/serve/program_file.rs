//! The program of a machine, as pages send and fetch it.

use super::drill_program::DrillProgram;
use super::loaded::{Loaded, Surroundings};
use super::machine::Machine;
use super::page::REPORT_POLICY;
use super::reply::Reply;
use super::request::Request;
use axum::body::Bytes;
use axum::http::StatusCode;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_SECURITY_POLICY, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use serde_json::{Value, json};
use std::sync::mpsc::sync_channel;
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};
use tokio::sync::mpsc::channel;

/// Longest program, bytes.
pub const MOST_BYTES: usize = 32 * 1024 * 1024;
/// The driver answers within this time.
const ANSWER: Duration = Duration::from_secs(5);
/// Grbl sends the work zero in one of thirty reports, and there are twenty in a second. A
/// controller that never sends it reports positions from the work zero.
const WORK_ZERO: Duration = Duration::from_secs(3);
/// Interval of the requests for the work zero.
const AGAIN: Duration = Duration::from_millis(50);

/// Checks, simulates and loads a program for its machine, as a page asks for it.
pub async fn load(machine: Arc<Machine>, client: u64, name: String, body: Bytes) -> Response {
    let name: String = name.chars().filter(|c| !c.is_control()).take(200).collect();
    if machine.control.operator() != Some(client) {
        return refused(StatusCode::FORBIDDEN, "take control first");
    }
    match place(&machine, client, &name, body.to_vec(), None).await {
        Ok(program) => {
            let report = program.report.to_string();
            ([(CONTENT_TYPE, "application/json")], report).into_response()
        }
        Err((status, why)) => refused(status, &why),
    }
}

/// Checks, simulates and loads a program. `resume` is the line with which it goes on, if it was
/// interrupted before.
///
/// # Errors
///
/// A sentence, and the status that a page gets.
pub async fn place(
    machine: &Arc<Machine>,
    client: u64,
    name: &str,
    text: Vec<u8>,
    resume: Option<usize>,
) -> Result<Arc<Loaded>, (StatusCode, String)> {
    if std::str::from_utf8(&text).is_err() && text.contains(&0) {
        return Err((StatusCode::BAD_REQUEST, "this file is not a text".into()));
    }
    let made = {
        let (machine, name) = (Arc::clone(machine), name.to_owned());
        tokio::task::spawn_blocking(move || checked(&machine, client, &name, text)).await
    };
    let mut program = match made {
        Ok(Ok(program)) => program,
        Ok(Err(why)) => return Err((StatusCode::BAD_REQUEST, why)),
        // The simulation of a program has a mistake of ours.
        Err(_) => {
            let why = "the check has failed".into();
            return Err((StatusCode::INTERNAL_SERVER_ERROR, why));
        }
    };
    program.resume_line = resume;
    let program = Arc::new(program);
    let (to, mut answers) = channel(1);
    let request = Request::Load(Arc::clone(&program));
    machine.ask(client, request, Reply::new(json!(0), to));
    let answer = tokio::time::timeout(ANSWER, answers.recv()).await;
    let answer: Value = match answer {
        Ok(Some(answer)) => serde_json::from_str(&answer).unwrap_or_default(),
        _ => {
            let why = "the machine does not answer".into();
            return Err((StatusCode::SERVICE_UNAVAILABLE, why));
        }
    };
    if answer["ok"] != true {
        let why = answer["error"].as_str().unwrap_or_default();
        return Err((StatusCode::CONFLICT, why.to_owned()));
    }
    *machine
        .program
        .lock()
        .unwrap_or_else(PoisonError::into_inner) = Some(Arc::clone(&program));
    Ok(program)
}

/// The text of the program.
pub fn text(machine: &Machine) -> Response {
    let program = machine
        .program
        .lock()
        .unwrap_or_else(PoisonError::into_inner);
    match &*program {
        Some(program) => {
            let plain = [(CONTENT_TYPE, "text/plain; charset=utf-8")];
            (plain, program.text.clone()).into_response()
        }
        None => refused(StatusCode::NOT_FOUND, "no program is loaded"),
    }
}

/// The scene of the program, for the viewer.
pub fn scene(machine: &Machine) -> Response {
    let program = machine
        .program
        .lock()
        .unwrap_or_else(PoisonError::into_inner);
    match program.as_ref().and_then(|program| program.scene.clone()) {
        Some(scene) => ([(CONTENT_TYPE, "text/plain")], scene).into_response(),
        None => refused(StatusCode::NOT_FOUND, "there is no picture of a program"),
    }
}

/// The holes of a program of the drill, for the board view.
pub fn board(machine: &Machine) -> Response {
    match with_holes(machine, |holes| holes.board().to_string()) {
        Some(board) => ([(CONTENT_TYPE, "application/json")], board).into_response(),
        None => refused(StatusCode::NOT_FOUND, "no program of a drill is loaded"),
    }
}

/// The records of a tool of a program of the drill, as `husillo compile` writes them.
pub fn records(machine: &Machine, tool: usize) -> Response {
    let made = with_holes(machine, |holes| {
        let part = holes.parts.get(tool).filter(|_| !holes.holes.is_empty())?;
        Some((part.tool, part.bytes()))
    });
    let Some((number, bytes)) = made.flatten() else {
        return refused(StatusCode::NOT_FOUND, "there are no records of this tool");
    };
    let name = format!("attachment; filename=\"T{number}.cod\"");
    let headers = [
        (CONTENT_TYPE, "application/octet-stream"),
        (CONTENT_DISPOSITION, name.as_str()),
    ];
    (headers, bytes).into_response()
}

/// What the loaded program of a drill gives.
fn with_holes<T>(machine: &Machine, give: impl FnOnce(&DrillProgram) -> T) -> Option<T> {
    let program = machine
        .program
        .lock()
        .unwrap_or_else(PoisonError::into_inner);
    program.as_ref()?.holes.as_ref().map(give)
}

/// The report of the last run.
pub async fn report(machine: &Machine) -> Response {
    let made = {
        let made = machine
            .report
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        made.clone()
    };
    if let Some(made) = made {
        let name = format!("inline; filename=\"{}\"", made.name);
        let headers = [
            (CONTENT_TYPE, "text/html; charset=utf-8"),
            (CONTENT_DISPOSITION, name.as_str()),
            (CONTENT_SECURITY_POLICY, REPORT_POLICY),
        ];
        return (headers, made.text.clone()).into_response();
    }
    let run = {
        let run = machine.run.lock().unwrap_or_else(PoisonError::into_inner);
        run.clone()
    };
    let Some(run) = run else {
        return refused(StatusCode::NOT_FOUND, "no run has ended yet");
    };
    let name = format!("inline; filename=\"{}\"", run.file_name());
    let made = tokio::task::spawn_blocking(move || run.program.page(run.operation())).await;
    match made {
        Ok(Ok(page)) => {
            let headers = [
                (CONTENT_TYPE, "text/html; charset=utf-8"),
                (CONTENT_DISPOSITION, name.as_str()),
                (CONTENT_SECURITY_POLICY, REPORT_POLICY),
            ];
            (headers, page).into_response()
        }
        Ok(Err(why)) => refused(StatusCode::INTERNAL_SERVER_ERROR, &why),
        Err(_) => refused(StatusCode::INTERNAL_SERVER_ERROR, "the report has failed"),
    }
}

/// Checks and simulates a program in a thread of its own.
fn checked(machine: &Machine, client: u64, name: &str, text: Vec<u8>) -> Result<Loaded, String> {
    // A controller that has just been connected has not yet told all.
    let end = Instant::now() + WORK_ZERO;
    let mut around = surroundings(machine, client)?;
    while !around.are_complete() && Instant::now() < end {
        std::thread::sleep(AGAIN);
        around = surroundings(machine, client)?;
    }
    Loaded::new(name, text, &around)
}

/// What a program is checked against, from the driver.
fn surroundings(machine: &Machine, client: u64) -> Result<Surroundings, String> {
    let (to, around) = sync_channel(1);
    let (refusal, mut refused) = channel(1);
    let request = Request::Surroundings(to);
    machine.ask(client, request, Reply::new(Value::Null, refusal));
    around.recv_timeout(ANSWER).map_err(|_| {
        let answer: Option<Value> = refused
            .try_recv()
            .ok()
            .and_then(|answer| serde_json::from_str(&answer).ok());
        let why = answer.and_then(|answer| answer["error"].as_str().map(str::to_owned));
        why.unwrap_or_else(|| "the machine does not answer".into())
    })
}

fn refused(status: StatusCode, why: &str) -> Response {
    (status, format!("{why}\n")).into_response()
}
