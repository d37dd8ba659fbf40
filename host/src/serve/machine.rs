//! A machine as the pages and its driver share it.

use super::console_lines::{ConsoleLines, From};
use super::control::Control;
use super::family::Family;
use super::lease::Lease;
use super::loaded::Loaded;
use super::macros::MacroFile;
use super::reply::Reply;
use super::request::Request;
use super::run_record::RunRecord;
use super::tool_path::ToolPath;
use axum::extract::ws::Utf8Bytes;
use husillo_clients::StopRequests;
use jiff::Timestamp;
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::watch;

/// Requests that wait for the driver.
const WAITING: usize = 64;

/// The answer to an emergency stop without a controller.
pub const EMERGENCY_WAITS: &str = "the controller is lost, so the emergency stop is not made: it \
                                   acts when the controller answers again. Use the button at the \
                                   machine";

/// An emergency stop.
#[derive(Debug, Default)]
struct Emergency {
    /// It is asked for, and not confirmed.
    is_asked: bool,
    /// Who waits for its answer.
    replies: Vec<Reply>,
}

/// A request for the driver of a machine.
#[derive(Debug)]
pub struct Asked {
    /// The client that asks.
    pub client: u64,
    /// What it asks for.
    pub request: Request,
    /// Where the answer goes.
    pub reply: Reply,
}

/// A report that is made.
#[derive(Debug)]
pub struct ReportPage {
    /// The name of its file.
    pub name: String,
    /// HTML.
    pub text: String,
}

impl ReportPage {
    /// The name of the file of a report about a program or a routine.
    pub fn name_of(program: &str, time: Timestamp) -> String {
        let stem = program.rsplit_once('.').map_or(program, |(stem, _)| stem);
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
        let stem: String = stem.chars().map(plain).collect();
        format!("{stem}-{}.html", time.strftime("%Y%m%d-%H%M%S"))
    }
}

/// A machine.
#[derive(Debug)]
pub struct Machine {
    /// Its number, from 1.
    pub number: u32,
    /// The name of its family.
    pub family: &'static str,
    /// Its description, which pages and other readers get first.
    described: Value,
    /// Requests to stop it.
    pub stop: StopRequests,
    /// Its console.
    pub console: ConsoleLines,
    /// Its operator.
    pub control: Control,
    /// The lease of a jog.
    pub lease: Lease,
    /// The path of its tool, as far as its controller reports steps.
    pub path: ToolPath,
    /// The loaded program.
    pub program: Mutex<Option<Arc<Loaded>>>,
    /// The last run of a program that has ended.
    pub run: Mutex<Option<Arc<RunRecord>>>,
    /// The report of the last routine.
    pub report: Mutex<Option<Arc<ReportPage>>>,
    /// The macros, which all machines share.
    pub macros: Arc<MacroFile>,
    requests: SyncSender<Asked>,
    published: Mutex<Published>,
    news: watch::Sender<u64>,
    clients: AtomicU64,
    /// The operator has gone: a motion by hand ends.
    is_left: AtomicBool,
    emergency: Mutex<Emergency>,
    /// The controller answers.
    is_up: AtomicBool,
    is_ending: AtomicBool,
    is_ended: AtomicBool,
}

/// The last state, as its frame.
#[derive(Clone, Debug, Default)]
pub struct Published {
    /// Its number. 0: there is none.
    pub number: u64,
    /// Its frame.
    pub frame: Utf8Bytes,
}

/// The description of a machine, which pages and other readers get first.
pub fn described(number: u32, family: &Family, port: &str) -> Value {
    json!({
        "machine": number,
        "family": family.name(),
        "offers": family.offers(),
        "travel_mm": family.travel_mm(),
        "name": port,
        "port": port,
        "is_simulated": port == "sim",
        "axes": family.axes(),
    })
}

impl Machine {
    /// A machine, and the requests for its driver. The number behind `news` changes with each new
    /// state or line of a console.
    pub fn new(
        number: u32,
        family: &Family,
        port: &str,
        watch_only: bool,
        macros: Arc<MacroFile>,
        news: watch::Sender<u64>,
    ) -> (Self, Receiver<Asked>) {
        let (requests, asked) = sync_channel(WAITING);
        let machine = Self {
            number,
            family: family.name(),
            described: described(number, family, port),
            stop: StopRequests::default(),
            console: ConsoleLines::new(),
            control: Control::new(watch_only),
            lease: Lease::default(),
            path: ToolPath::default(),
            program: Mutex::default(),
            run: Mutex::default(),
            report: Mutex::default(),
            macros,
            requests,
            published: Mutex::default(),
            news,
            clients: AtomicU64::new(0),
            is_left: AtomicBool::new(false),
            emergency: Mutex::default(),
            is_up: AtomicBool::new(false),
            is_ending: AtomicBool::new(false),
            is_ended: AtomicBool::new(false),
        };
        (machine, asked)
    }

    /// What a page is told about it at first.
    pub fn described(&self) -> Value {
        self.described.clone()
    }

    /// Passes a request on to the driver.
    pub fn ask(&self, client: u64, request: Request, reply: Reply) {
        let asked = Asked {
            client,
            request,
            reply,
        };
        if let Err(error) = self.requests.try_send(asked) {
            use std::sync::mpsc::TrySendError::{Disconnected, Full};
            let (Full(asked) | Disconnected(asked)) = error;
            asked.reply.error("too many requests wait: try again");
        }
    }

    /// Whether a request may still be carried out. Its client may have lost control meanwhile.
    pub fn permits(&self, client: u64, request: &Request) -> bool {
        let is_own = matches!(request, Request::Load(_) | Request::Surroundings(_));
        is_own || !request.needs_control() || self.control.operator() == Some(client)
    }

    /// Appends a line to the console.
    pub fn tell(&self, from: From, text: impl Into<String>) {
        self.console.push(from, text);
        self.news
            .send_modify(|number| *number = number.wrapping_add(1));
    }

    /// The path of the tool has changed.
    pub fn drawn(&self) {
        self.news
            .send_modify(|number| *number = number.wrapping_add(1));
    }

    /// Publishes a state. `frame` makes its frame from its number.
    pub fn publish(&self, frame: impl FnOnce(u64) -> String) {
        let mut published = self
            .published
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        published.number += 1;
        published.frame = frame(published.number).into();
        drop(published);
        self.news
            .send_modify(|number| *number = number.wrapping_add(1));
    }

    /// The last state.
    pub fn published(&self) -> Published {
        let published = self
            .published
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        published.clone()
    }

    /// A client has come.
    pub fn enter(&self) {
        self.clients.fetch_add(1, Ordering::Relaxed);
    }

    /// A client has gone. If it was in control, a motion by hand ends.
    pub fn leave(&self, client: u64) {
        self.clients.fetch_sub(1, Ordering::Relaxed);
        if self.control.give(client) {
            self.abandon();
        }
    }

    /// A motion by hand ends, because its operator has gone or has lost control.
    pub fn abandon(&self) {
        self.lease.end();
        self.is_left.store(true, Ordering::Relaxed);
    }

    /// Whether the operator has gone since the last call.
    pub fn take_left(&self) -> bool {
        self.is_left.swap(false, Ordering::Relaxed)
    }

    /// Asks for an emergency stop. It does not wait behind other requests. The driver answers, and
    /// asks for it again until the controller confirms it.
    pub fn request_emergency(&self, reply: Reply) {
        self.lease.end();
        let mut emergency = self.emergency();
        emergency.is_asked = true;
        match self.is_up.load(Ordering::Relaxed) {
            true => emergency.replies.push(reply),
            false => reply.error(EMERGENCY_WAITS),
        }
    }

    /// Whether an emergency stop is asked for, and not confirmed.
    pub fn is_emergency_asked(&self) -> bool {
        self.emergency().is_asked
    }

    /// The controller has confirmed the emergency stop.
    pub fn emergency_made(&self) {
        let Emergency { replies, .. } = std::mem::take(&mut *self.emergency());
        replies.into_iter().for_each(Reply::ok);
    }

    /// The emergency stop is not confirmed. It stays asked for.
    pub fn emergency_waits(&self, why: &str) {
        let replies = std::mem::take(&mut self.emergency().replies);
        replies.into_iter().for_each(|reply| reply.error(why));
    }

    fn emergency(&self) -> std::sync::MutexGuard<'_, Emergency> {
        self.emergency
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether the controller answers.
    pub fn set_up(&self, is_up: bool) {
        self.is_up.store(is_up, Ordering::Relaxed);
    }

    /// Number of clients.
    pub fn clients(&self) -> u64 {
        self.clients.load(Ordering::Relaxed)
    }

    /// Stops the machine and ends its driver.
    pub fn end(&self) {
        self.is_ending.store(true, Ordering::Relaxed);
    }

    /// Whether the driver shall end.
    pub fn is_ending(&self) -> bool {
        self.is_ending.load(Ordering::Relaxed)
    }

    /// The driver has ended.
    pub fn set_ended(&self) {
        self.is_ended.store(true, Ordering::Relaxed);
    }

    /// Whether the driver has ended.
    pub fn is_ended(&self) -> bool {
        self.is_ended.load(Ordering::Relaxed)
    }
}
