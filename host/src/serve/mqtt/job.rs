//! A job of the broker: a program that a machine runs once.
//!
//! ```text
//! claim the id ─► take control ─► check, load ─► note "running" ─► start ─► give control back
//!       └ used: report its state                                        └► follow, note the line
//! ```
//!
//! The id is used before anything else happens. A job that is refused or that fails is not tried
//! again by anybody here, and a message that arrives again does nothing.

use super::job_folder::{Claim, JobFolder, Record};
use crate::serve::console_lines::From;
use crate::serve::machine::Machine;
use crate::serve::program_file;
use crate::serve::reply::Reply;
use crate::serve::request::Request;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::Mutex;
use tokio::sync::mpsc::{UnboundedSender, channel};
use tokio::time::{Instant, sleep, timeout};

/// The client that a job is in the control of a machine. Pages have numbers from 1.
pub const CELL: u64 = 0;
/// The driver answers within this time.
const ANSWER: Duration = Duration::from_secs(5);
/// The driver has started a program within this time. That of a mill checks it once more.
const START: Duration = Duration::from_secs(60);
/// Interval in which the line of a job is noted.
const NOTE: Duration = Duration::from_millis(500);
/// Interval in which a load is waited for, and a job is looked at. The next job, and the operator,
/// may change the program as soon as its end is shown.
const SHOWN: Duration = Duration::from_millis(20);
/// A machine with an interrupted job is looked at in this interval until it can be loaded.
const AGAIN: Duration = Duration::from_secs(1);

/// The state of a job.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum JobState {
    /// Its id is used. Nothing has moved.
    Accepted,
    /// It was not started, and will not be.
    Refused,
    /// It is being made.
    Running,
    /// All of it is made.
    Done,
    /// Somebody has stopped it.
    Stopped,
    /// The machine has refused a line, or was lost.
    Failed,
    /// This program or its computer has ended during it.
    Interrupted,
}

impl JobState {
    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Accepted => "accepted",
            Self::Refused => "refused",
            Self::Running => "running",
            Self::Done => "done",
            Self::Stopped => "stopped",
            Self::Failed => "failed",
            Self::Interrupted => "interrupted",
        }
    }
}

/// The report of a job.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq, Serialize)]
pub struct Report {
    /// Its id.
    pub id: String,
    /// Its state.
    pub state: JobState,
    /// Why, or the empty text.
    pub message: String,
    /// All lines before this one are made.
    pub line: Option<u64>,
}

/// A report of a machine.
#[derive(Clone, Debug)]
pub struct Told {
    /// Index of the machine.
    pub machine: usize,
    /// The report.
    pub report: Report,
    /// It is about the job that the machine has had last, not about one of before.
    pub is_last: bool,
}

/// A job, as it was sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Job {
    /// Its id.
    pub id: String,
    /// Name of its program.
    pub name: String,
    /// Its program.
    pub text: Vec<u8>,
}

/// The jobs of all machines.
#[derive(Debug)]
pub struct Jobs {
    folder: JobFolder,
    /// The name of this server.
    node: String,
    machines: Vec<Arc<Machine>>,
    /// Held while a job of a machine is begun: one at a time.
    beginning: Vec<Mutex<()>>,
    told: UnboundedSender<Told>,
}

impl Jobs {
    /// The jobs that are noted in this folder. Their reports go to `told`.
    pub fn new(
        folder: JobFolder,
        node: String,
        machines: Vec<Arc<Machine>>,
        told: UnboundedSender<Told>,
    ) -> Self {
        Self {
            folder,
            node,
            beginning: machines.iter().map(|_| Mutex::default()).collect(),
            machines,
            told,
        }
    }

    /// Carries out a job, if its id was never used.
    pub async fn carry_out(&self, index: usize, job: Job) {
        let (Some(machine), Some(beginning)) =
            (self.machines.get(index), self.beginning.get(index))
        else {
            return;
        };
        let mut record = Record {
            node: self.node.clone(),
            machine: machine.number,
            name: job.name.clone(),
            report: Report {
                id: job.id.clone(),
                state: JobState::Accepted,
                message: String::new(),
                line: None,
            },
        };
        let (folder, claimed) = (self.folder.clone(), record.clone());
        match blocking(move || folder.claim(&claimed)).await {
            Ok(Claim::First) => {}
            Ok(Claim::Used(report)) => return self.tell(index, &report, false),
            Err(why) => {
                record.report.state = JobState::Refused;
                record.report.message = why;
                return self.tell(index, &record.report, false);
            }
        }
        machine.tell(
            From::Server,
            format!("job {} of the broker: {}", job.id, job.name),
        );
        self.tell(index, &record.report, true);
        let begun = match beginning.try_lock() {
            Ok(_held) => self.begin(machine, job, &mut record).await,
            Err(_) => Err("another job is being started".into()),
        };
        match begun {
            Ok(load) => self.follow(index, machine, load, record).await,
            Err(why) => {
                machine.tell(From::Server, format!("job {}: {why}", record.report.id));
                record.report.state = JobState::Refused;
                record.report.message = why;
                self.note(index, &record).await;
            }
        }
    }

    /// Loads and starts a job. Returns the number of its load.
    async fn begin(
        &self,
        machine: &Arc<Machine>,
        job: Job,
        record: &mut Record,
    ) -> Result<u64, String> {
        machine.control.take(CELL, false)?;
        let load = self.start(machine, job, record).await;
        // A page may take control while it runs.
        machine.control.give(CELL);
        load
    }

    async fn start(
        &self,
        machine: &Arc<Machine>,
        job: Job,
        record: &mut Record,
    ) -> Result<u64, String> {
        let before = number(&shown(machine)["program"]["load"]);
        let folder = self.folder.clone();
        let (id, text) = (job.id, job.text.clone());
        blocking(move || folder.keep_program(&id, &text)).await?;
        let placed = program_file::place(machine, CELL, &job.name, job.text, None).await;
        let program = placed.map_err(|(_, why)| why)?;
        if program.errors > 0 {
            let first = &program.report["findings"][0];
            let what = first["message"]
                .as_str()
                .unwrap_or("the program has errors");
            return Err(format!("line {}: {what}", first["line"]));
        }
        let load = loaded(machine, before).await?;
        // STOP takes control away from a job that has not started.
        if machine.control.operator() != Some(CELL) {
            return Err("STOP was pressed, or a page has taken control".into());
        }
        // If this program is killed from here on, the job may have been started.
        record.report.state = JobState::Running;
        let (folder, noted) = (self.folder.clone(), record.clone());
        blocking(move || folder.note(&noted)).await?;
        let (to, mut answers) = channel(1);
        let run = Request::Run {
            confirmed: true,
            from: None,
        };
        machine.ask(CELL, run, Reply::new(json!(0), to));
        let answer = timeout(START, answers.recv()).await;
        let answer = answer.ok().flatten().ok_or("the machine does not answer")?;
        let answer: Value = serde_json::from_str(&answer).unwrap_or_default();
        match answer["ok"] == true {
            true => Ok(load),
            false => Err(answer["error"].as_str().unwrap_or_default().to_owned()),
        }
    }

    /// Follows a job until it ends.
    async fn follow(&self, index: usize, machine: &Machine, load: u64, mut record: Record) {
        self.tell(index, &record.report, true);
        let mut noted_at = Instant::now();
        loop {
            sleep(SHOWN).await;
            let state = shown(machine);
            let program = &state["program"];
            // The state is one of before the load. Without a program, it was taken away since.
            if !program.is_null() && number(&program["load"]) < load {
                continue;
            }
            let mut report = record.report.clone();
            report.state = match program["phase"].as_str() {
                Some("done") => JobState::Done,
                Some("stopped") => JobState::Stopped,
                Some("failed") => JobState::Failed,
                _ => JobState::Running,
            };
            if number(&program["load"]) > load || program.is_null() {
                report.state = JobState::Stopped;
                report.message = "another program was loaded".into();
            } else if report.state != JobState::Running {
                report.message = program["message"].as_str().unwrap_or_default().to_owned();
            }
            let line = program["resume_line"].as_u64();
            report.line = match report.state {
                JobState::Done => None,
                JobState::Running => program["line"].as_u64(),
                _ => line.or(report.line),
            };
            let is_due = noted_at.elapsed() >= NOTE || report.state != JobState::Running;
            if is_due && report != record.report {
                noted_at = Instant::now();
                record.report = report;
                self.note(index, &record).await;
            }
            if record.report.state != JobState::Running {
                return;
            }
        }
    }

    /// Offers the programs of these jobs, which were interrupted. None of them is started.
    pub async fn offer(&self, records: Vec<Record>) {
        let offers = records.into_iter().filter_map(|mut record| {
            let machines = self.machines.iter();
            let index = machines
                .enumerate()
                .find(|(_, one)| one.number == record.machine)?
                .0;
            let report = &mut record.report;
            (report.state, report.message) = match (report.state, report.line) {
                (JobState::Accepted, _) => {
                    let why = "the server ended before the job was started";
                    (JobState::Refused, why.into())
                }
                (_, Some(line)) => {
                    let why = format!("interrupted: all lines before line {line} are made");
                    (JobState::Interrupted, why)
                }
                (_, None) => {
                    let why = "interrupted before a line was noted as made";
                    (JobState::Interrupted, why.into())
                }
            };
            Some(self.offer_one(index, record))
        });
        futures_util::future::join_all(offers).await;
    }

    /// Loads the program of an interrupted job as soon as its machine answers, with the line at
    /// which it goes on.
    async fn offer_one(&self, index: usize, record: Record) {
        self.note(index, &record).await;
        if record.report.state == JobState::Refused {
            return;
        }
        let (Some(machine), Some(beginning)) =
            (self.machines.get(index), self.beginning.get(index))
        else {
            return;
        };
        let (id, name) = (&record.report.id, &record.name);
        machine.tell(
            From::Server,
            format!("job {id}, {name}: {}", record.report.message),
        );
        let (folder, key) = (self.folder.clone(), id.clone());
        let Ok(text) = blocking(move || folder.program(&key)).await else {
            return;
        };
        let line = record
            .report
            .line
            .and_then(|line| usize::try_from(line).ok());
        loop {
            let held = beginning.lock().await;
            let state = shown(machine);
            if !state["program"].is_null() {
                // Somebody has loaded a program meanwhile.
                return;
            }
            if state["link"] == "up" {
                let before = number(&state["program"]["load"]);
                let offered = program_file::place(machine, CELL, name, text, line).await;
                let load = match offered {
                    Ok(_) => loaded(machine, before).await,
                    Err((_, why)) => Err(why),
                };
                drop(held);
                match load {
                    Ok(load) => self.until_taken(machine, load, id).await,
                    Err(why) => machine.tell(From::Server, format!("job {id}: {why}")),
                }
                return;
            }
            drop(held);
            sleep(AGAIN).await;
        }
    }

    /// Waits until the operator has started an offered program or has put it away. Then it is not
    /// offered again after the next restart.
    async fn until_taken(&self, machine: &Machine, load: u64, id: &str) {
        loop {
            sleep(AGAIN).await;
            let state = shown(machine);
            let program = &state["program"];
            if number(&program["load"]) != load || program["phase"] != "loaded" {
                let (folder, id) = (self.folder.clone(), id.to_owned());
                let forgotten = blocking(move || {
                    folder.forget_program(&id);
                    Ok(())
                });
                let _ = forgotten.await;
                return;
            }
        }
    }

    /// Notes and reports the state of a job.
    async fn note(&self, index: usize, record: &Record) {
        let (folder, noted) = (self.folder.clone(), record.clone());
        if let (Err(why), Some(machine)) = (
            blocking(move || folder.note(&noted)).await,
            self.machines.get(index),
        ) {
            machine.tell(From::Server, format!("job {}: {why}", record.report.id));
        }
        self.tell(index, &record.report, true);
    }

    fn tell(&self, machine: usize, report: &Report, is_last: bool) {
        // Without a receiver this program ends.
        let _ = self.told.send(Told {
            machine,
            report: report.clone(),
            is_last,
        });
    }
}

/// The number of a load after this one, when the machine shows it.
async fn loaded(machine: &Machine, before: u64) -> Result<u64, String> {
    let begun = Instant::now();
    while begun.elapsed() < ANSWER {
        let load = number(&shown(machine)["program"]["load"]);
        if load > before {
            return Ok(load);
        }
        sleep(SHOWN).await;
    }
    Err("the machine does not answer".into())
}

/// What a machine shows at present.
pub fn shown(machine: &Machine) -> Value {
    serde_json::from_str(&machine.published().frame).unwrap_or_default()
}

fn number(value: &Value) -> u64 {
    value.as_u64().unwrap_or(0)
}

/// Does something with files in another thread: a stop must not wait for it.
async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, String> + Send + 'static,
) -> Result<T, String> {
    let done = tokio::task::spawn_blocking(work).await;
    done.unwrap_or_else(|error| Err(error.to_string()))
}
