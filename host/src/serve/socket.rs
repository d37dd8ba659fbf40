//! The socket of one page.
//!
//! One half reads requests, the other writes states. A page that does not read holds neither the
//! machines nor its own requests up: a stop arrives all the same.

use super::console_lines::From;
use super::lease::LEASE;
use super::machine::Machine;
use super::mqtt::CELL;
use super::reply::Reply;
use super::request::Request;
use super::site::Site;
use super::tool_path::PathSeen;
use axum::extract::ws::{CloseFrame, Message, Utf8Bytes, WebSocket};
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt as _, StreamExt as _};
use serde::Deserialize as _;
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::mpsc::{Receiver, Sender, channel};
use tokio::time::timeout;

/// Interval of the pings. A browser answers them by itself.
const PING: Duration = Duration::from_secs(10);
/// Interval of the frames that tell a page that its link is up. A page does not see pings.
const ALIVE: Duration = Duration::from_secs(1);
/// A client that has sent nothing for this time, not even the answer to a ping, is gone.
const SILENCE: Duration = Duration::from_secs(30);
/// A client that does not take a frame within this time is closed.
const BLOCKED: Duration = Duration::from_secs(15);
/// Shortest interval between two rounds of states, so that a page gets 60 a second.
const ROUND: Duration = Duration::from_millis(12);
/// The last wait for a client before it is closed.
const GRACE: Duration = Duration::from_millis(33);
/// Answers that wait for a client.
const ANSWERS: usize = 256;
/// Codes with which a socket is closed.
const TOO_SLOW: u16 = 4001;

/// Serves a client until its socket is closed.
pub async fn serve(site: &Arc<Site>, client: u64, socket: WebSocket) {
    for machine in &site.machines {
        machine.enter();
    }
    let (sink, stream) = socket.split();
    let (answers, queue) = channel(ANSWERS);
    tokio::select! {
        () = write(site, client, sink, queue) => {}
        () = read(site, client, stream, answers) => {}
    }
    for machine in &site.machines {
        machine.leave(client);
    }
}

/// Reads requests until the socket is closed or silent.
async fn read(
    site: &Site,
    client: u64,
    mut stream: SplitStream<WebSocket>,
    answers: Sender<Utf8Bytes>,
) {
    while let Ok(Some(Ok(message))) = timeout(SILENCE, stream.next()).await {
        match message {
            Message::Text(text) => asked(site, client, &text, &answers),
            Message::Binary(_) => {
                Reply::new(Value::Null, answers.clone()).error("frames are text");
            }
            Message::Ping(_) | Message::Pong(_) => {}
            Message::Close(_) => return,
        }
        // A client that asks faster than it reads is closed by the other half.
        if answers.capacity() == 0 {
            tokio::time::sleep(GRACE).await;
            if answers.capacity() == 0 {
                return;
            }
        }
    }
}

/// Carries out one frame.
fn asked(site: &Site, client: u64, text: &str, answers: &Sender<Utf8Bytes>) {
    let frame: Value = match serde_json::from_str(text) {
        Ok(frame) => frame,
        Err(error) => {
            let reply = Reply::new(Value::Null, answers.clone());
            return reply.error(format!("this frame is no JSON: {error}"));
        }
    };
    let id = match frame.get("id") {
        Some(Value::Number(number)) => Value::Number(number.clone()),
        _ => Value::Null,
    };
    let reply = Reply::new(id, answers.clone());
    let number = frame.get("machine").and_then(Value::as_u64);
    let request = match Request::deserialize(&frame) {
        Ok(request) => request,
        Err(error) => return reply.error(format!("this request is not understood: {error}")),
    };
    let mut machines = site.machines.iter();
    if matches!(request, Request::Stop) && frame.get("machine").is_none() {
        machines.for_each(|machine| stop(machine, client));
        return reply.ok();
    }
    let machine = machines.find(|machine| Some(u64::from(machine.number)) == number);
    match machine {
        Some(machine) => asked_of(machine, client, request, reply),
        None => reply.error("`machine` is not the number of a machine"),
    }
}

/// Carries out a request about a machine, or passes it on to the driver.
fn asked_of(machine: &Machine, client: u64, request: Request, reply: Reply) {
    if request.needs_control() && machine.control.operator() != Some(client) {
        return reply.error("take control first");
    }
    match request {
        Request::Stop => {
            stop(machine, client);
            reply.ok();
        }
        Request::Emergency if machine.family == "microfactory" => {
            machine.control.give(CELL);
            machine.tell(From::Server, format!("EMERGENCY STOP by client {client}"));
            machine.request_emergency(reply);
        }
        Request::Emergency => reply.error("this machine has no emergency stop of its own: STOP it"),
        Request::Take { force } => match machine.control.take(client, force) {
            Ok(is_anothers) => {
                if is_anothers {
                    machine.abandon();
                }
                machine.tell(From::Server, format!("client {client} is in control"));
                reply.ok();
            }
            Err(why) => reply.error(why),
        },
        Request::Give => {
            machine.control.give(client);
            machine.abandon();
            machine.tell(
                From::Server,
                format!("client {client} has given control back"),
            );
            reply.ok();
        }
        Request::Renew { jog } => machine.lease.renew(client, jog, Instant::now()),
        Request::Release { jog } => {
            machine.lease.release(client, jog);
            reply.ok();
        }
        Request::Jog { jog, .. } => {
            machine.lease.begin(client, jog, Instant::now());
            machine.ask(client, request, reply);
        }
        Request::Macros | Request::MacroSave { .. } | Request::MacroDelete { .. } => {
            // A file may be slow, and a stop must not wait for it.
            let macros = Arc::clone(&machine.macros);
            tokio::task::spawn_blocking(move || reply.result(macros.carry_out(&request)));
        }
        _ => machine.ask(client, request, reply),
    }
}

fn stop(machine: &Machine, client: u64) {
    // A job that is being checked does not start afterwards.
    machine.control.give(CELL);
    machine.lease.end();
    machine.stop.request();
    machine.tell(From::Server, format!("STOP by client {client}"));
}

/// Writes the states, the consoles and the answers until the socket fails.
async fn write(
    site: &Site,
    client: u64,
    mut sink: SplitSink<WebSocket, Message>,
    mut answers: Receiver<Utf8Bytes>,
) {
    let mut news = site.news.subscribe();
    let mut ping = tokio::time::interval(PING);
    let mut alive = tokio::time::interval(ALIVE);
    let mut seen = vec![Seen::default(); site.machines.len()];
    let welcome = json!({
        "kind": "welcome",
        "protocol": 1,
        "version": env!("CARGO_PKG_VERSION"),
        "client": client,
        "lease_ms": LEASE.as_millis() as u64,
        "renew_ms": 80,
        "machines": site.described(),
    });
    let mut frames = vec![welcome.to_string().into()];
    news.mark_changed();
    loop {
        for frame in frames.drain(..) {
            if !sent(&mut sink, frame).await {
                return close(sink).await;
            }
        }
        tokio::select! {
            changed = news.changed() => {
                if changed.is_err() {
                    return;
                }
                for (machine, seen) in site.machines.iter().zip(&mut seen) {
                    frames.extend(seen.update(machine));
                }
                // More lines of a console follow in the next round.
                if site.machines.iter().zip(&seen).any(|(machine, seen)| seen.has_more(machine)) {
                    news.mark_changed();
                }
                for frame in frames.drain(..) {
                    if !sent(&mut sink, frame).await {
                        return close(sink).await;
                    }
                }
                // Answers do not wait for the next round of states.
                let mut round = std::pin::pin!(tokio::time::sleep(ROUND));
                loop {
                    tokio::select! {
                        () = &mut round => break,
                        answer = answers.recv() => {
                            let Some(answer) = answer else { return };
                            if !sent(&mut sink, answer).await {
                                return close(sink).await;
                            }
                        }
                    }
                }
            }
            answer = answers.recv() => match answer {
                Some(answer) => frames.push(answer),
                None => return,
            },
            _ = alive.tick() => frames.push(json!({"kind": "alive"}).to_string().into()),
            _ = ping.tick() => {
                let pinged = timeout(BLOCKED, sink.send(Message::Ping(Vec::new().into()))).await;
                if !matches!(pinged, Ok(Ok(()))) {
                    return close(sink).await;
                }
            }
        }
    }
}

/// Sends a frame. Returns whether the client has taken it.
async fn sent(sink: &mut SplitSink<WebSocket, Message>, frame: Utf8Bytes) -> bool {
    let sent = timeout(BLOCKED, sink.send(Message::Text(frame))).await;
    matches!(sent, Ok(Ok(())))
}

/// Tells a client that it is too slow, if it still takes that.
async fn close(mut sink: SplitSink<WebSocket, Message>) {
    let frame = CloseFrame {
        code: TOO_SLOW,
        reason: "this page does not read".into(),
    };
    let _ = timeout(GRACE, sink.send(Message::Close(Some(frame)))).await;
}

/// What a client has of a machine.
#[derive(Clone, Debug, Default)]
struct Seen {
    state: u64,
    line: u64,
    path: PathSeen,
}

impl Seen {
    /// The frames that the client does not have yet.
    fn update(&mut self, machine: &Machine) -> Vec<Utf8Bytes> {
        let mut frames = Vec::new();
        let published = machine.published();
        if published.number != self.state {
            self.state = published.number;
            frames.push(published.frame);
        }
        if let Some(lines) = machine.console.after(self.line) {
            self.line = lines.lines.last().map_or(self.line, |last| last.number);
            let frame = json!({
                "kind": "console",
                "machine": machine.number,
                "missed": lines.missed,
                "lines": lines.lines,
            });
            frames.push(frame.to_string().into());
        }
        if let Some(part) = machine.path.after(&mut self.path) {
            let frame = json!({
                "kind": "path",
                "machine": machine.number,
                "from": part.from,
                "points": part.points,
            });
            frames.push(frame.to_string().into());
        }
        frames
    }

    fn has_more(&self, machine: &Machine) -> bool {
        machine.console.after(self.line).is_some() || machine.path.has_more(self.path)
    }
}
