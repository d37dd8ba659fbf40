//! What the machines do, for an agent of MTConnect.
//!
//! The agent connects to this adapter and gets lines of SHDR: a time, then keys and values. At
//! first it gets all, then what changes. It may only ask whether the adapter is alive, so nothing
//! that it sends reaches a machine. Format: MTConnect Part 5, and the manual of the agent of the
//! MTConnect Institute.

mod devices;
mod items;

pub use devices::document;

use super::machine::Machine;
use items::{Item, UNAVAILABLE, items};
use jiff::Timestamp;
use serde_json::Value;
use std::fmt::Write as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio::time::{Instant, sleep_until, timeout};

/// Shortest interval between two rounds of lines.
const ROUND: Duration = Duration::from_millis(100);
/// An agent sends a ping after this time at most.
const HEARTBEAT: Duration = Duration::from_secs(10);
/// An agent that takes nothing for this time is closed.
const BLOCKED: Duration = Duration::from_secs(10);
/// Agents at a time.
const AGENTS: usize = 8;
/// Longest line of an agent, bytes.
const LINE: usize = 1024;

/// The name of a machine for others than pages.
pub fn device(machine: &Machine) -> String {
    format!("machine-{}", machine.number)
}

/// Serves agents. It ends with the runtime.
pub async fn serve(listener: TcpListener, machines: Vec<Arc<Machine>>, news: watch::Sender<u64>) {
    let agents = Arc::new(AtomicUsize::new(0));
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            // Too many files are open: try again later.
            tokio::time::sleep(ROUND).await;
            continue;
        };
        if agents.fetch_add(1, Ordering::Relaxed) >= AGENTS {
            agents.fetch_sub(1, Ordering::Relaxed);
            continue;
        }
        let machines = machines.clone();
        let (news, agents) = (news.subscribe(), Arc::clone(&agents));
        tokio::spawn(async move {
            agent(stream, &machines, news).await;
            agents.fetch_sub(1, Ordering::Relaxed);
        });
    }
}

/// Serves one agent until it closes, is silent, or reads nothing.
async fn agent(mut stream: TcpStream, machines: &[Arc<Machine>], mut news: watch::Receiver<u64>) {
    let mut sent: Vec<_> = machines.iter().map(|machine| Sent::new(machine)).collect();
    let mut received = Vec::new();
    // Only an agent that has sent a ping is expected to send more.
    let mut until = None;
    let (mut is_due, mut next) = (true, Instant::now());
    loop {
        let mut buffer = [0; 256];
        let lines = tokio::select! {
            read = stream.read(&mut buffer) => {
                let count = read.unwrap_or(0);
                received.extend_from_slice(buffer.get(..count).unwrap_or_default());
                let answers = answers(&mut received);
                if count == 0 || received.len() > LINE {
                    return;
                }
                if !answers.is_empty() {
                    until = Some(Instant::now() + 2 * HEARTBEAT);
                }
                answers
            }
            changed = news.changed(), if !is_due => {
                if changed.is_err() {
                    return;
                }
                is_due = true;
                continue;
            }
            () = sleep_until(next), if is_due => {
                is_due = false;
                next = Instant::now() + ROUND;
                let time = Timestamp::now().strftime("%Y-%m-%dT%H:%M:%S%.6fZ").to_string();
                let all = machines.iter().zip(&mut sent);
                all.map(|(machine, sent)| sent.lines(&time, machine)).collect()
            }
            () = sleep_until(until.unwrap_or(next)), if until.is_some() => return,
        };
        let written = timeout(BLOCKED, stream.write_all(lines.as_bytes())).await;
        if !matches!(written, Ok(Ok(()))) {
            return;
        }
    }
}

/// Answers to the pings in what was received. What follows the last line stays.
fn answers(received: &mut Vec<u8>) -> String {
    let mut answers = String::new();
    while let Some(end) = received.iter().position(|byte| *byte == b'\n') {
        let line: Vec<_> = received.drain(..=end).collect();
        if line.trim_ascii() == b"* PING" {
            // Writing to a text does not fail.
            let _ = writeln!(answers, "* PONG {}", HEARTBEAT.as_millis());
        }
    }
    answers
}

/// What an agent has of a machine.
#[derive(Debug)]
struct Sent {
    /// Number of the state.
    state: u64,
    items: Vec<Item>,
    /// The value of each item.
    values: Vec<String>,
}

impl Sent {
    fn new(machine: &Machine) -> Self {
        let items = items(&machine.described());
        Self {
            state: 0,
            values: vec![String::new(); items.len()],
            items,
        }
    }

    /// Lines with the values that have changed.
    fn lines(&mut self, time: &str, machine: &Machine) -> String {
        let published = machine.published();
        if published.number == self.state && published.number > 0 {
            return String::new();
        }
        self.state = published.number;
        // Before the first state there is none.
        let state = serde_json::from_str(&published.frame).unwrap_or(Value::Null);
        self.changed(time, &device(machine), &state)
    }

    fn changed(&mut self, time: &str, device: &str, state: &Value) -> String {
        let (mut line, mut alone) = (String::new(), String::new());
        for (item, before) in self.items.iter().zip(&mut self.values) {
            let value = match (item.value)(state, item.axis) {
                Some(value) => value,
                None => item.unavailable(),
            };
            if value == *before {
                continue;
            }
            // An item with several values has a line of its own.
            let key = &item.key;
            let _ = match item.is_alone() {
                true => writeln!(alone, "{time}|{device}:{key}|{value}"),
                false => write!(line, "|{device}:{key}|{value}"),
            };
            *before = value;
        }
        match line.is_empty() {
            true => alone,
            false => format!("{time}{line}\n{alone}"),
        }
    }
}

impl Item {
    /// Its value when none is known.
    fn unavailable(&self) -> String {
        match (self.category, self.kind) {
            ("CONDITION", _) => format!("{UNAVAILABLE}||||"),
            (_, "MESSAGE") => format!("|{UNAVAILABLE}"),
            _ => UNAVAILABLE.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn only_what_has_changed_is_sent() {
        let items = items(&json!({"axes": ["X", "Y", "Z"]}));
        let mut sent = Sent {
            state: 0,
            values: vec![String::new(); items.len()],
            items,
        };
        let first = sent.changed("T", "m", &Value::Null);
        assert!(first.starts_with("T|m:avail|UNAVAILABLE|m:"), "{first}");
        assert!(first.contains("\nT|m:system|UNAVAILABLE||||\n"), "{first}");
        let mut state = json!({
            "link": "up", "state": "Idle", "machine_mm": [1.0, -2.5, 0.0], "feed": 600.0,
        });
        let lines = sent.changed("T", "m", &state);
        assert!(lines.contains("|m:avail|AVAILABLE|"), "{lines}");
        assert!(lines.contains("|m:y_position|-2.500|"), "{lines}");
        assert!(lines.contains("|m:feed|10.000"), "{lines}");
        assert!(lines.contains("T|m:system|NORMAL||||\n"), "{lines}");
        assert_eq!(sent.changed("T", "m", &state), "");
        state["machine_mm"][1] = json!(-2.4);
        assert_eq!(sent.changed("T", "m", &state), "T|m:y_position|-2.400\n");
        state["state"] = json!("Alarm");
        state["alarm"] = json!({"number": 2, "text": "beyond | the\nlimits"});
        let lines = sent.changed("T", "m", &state);
        let fault = "T|m:system|FAULT|2|||beyond / the limits\n";
        assert!(lines.ends_with(fault), "{lines}");
    }

    #[test]
    fn pings_are_answered() {
        let mut received = b"* PING\r\n* device: x\n* PI".to_vec();
        assert_eq!(answers(&mut received), "* PONG 10000\n");
        assert_eq!(received, b"* PI");
    }
}
