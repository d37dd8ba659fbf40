//! What an agent of MTConnect gets.

use super::emulated::Emulated;
use super::page::Served;
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::Command;
use std::time::{Duration, Instant};

/// Whatever is waited for has happened within this time, also on a busy computer.
const PATIENCE: Duration = Duration::from_secs(60);

/// An agent.
struct Agent {
    stream: TcpStream,
    received: String,
    /// The last value of each key.
    values: BTreeMap<String, String>,
    /// All values that each key has had.
    seen: BTreeSet<(String, String)>,
    answers: Vec<String>,
}

impl Agent {
    fn new(address: &str) -> Self {
        let begun = Instant::now();
        let stream = loop {
            match TcpStream::connect(address) {
                Ok(stream) => break stream,
                Err(error) => assert!(begun.elapsed() < PATIENCE, "{error}"),
            }
        };
        stream
            .set_read_timeout(Some(Duration::from_millis(10)))
            .unwrap();
        Self {
            stream,
            received: String::new(),
            values: BTreeMap::new(),
            seen: BTreeSet::new(),
            answers: Vec::new(),
        }
    }

    /// Receives for a moment. Returns whether the connection is open.
    fn receive(&mut self) -> bool {
        let mut buffer = [0; 4096];
        match self.stream.read(&mut buffer) {
            Ok(0) => return false,
            Ok(count) => {
                let text = std::str::from_utf8(&buffer[..count]).unwrap();
                self.received.push_str(text);
            }
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
            Err(_) => return false,
        }
        while let Some((line, rest)) = self.received.split_once('\n') {
            let (line, rest) = (line.to_owned(), rest.to_owned());
            self.received = rest;
            self.take(&line);
        }
        true
    }

    fn take(&mut self, line: &str) {
        if line.starts_with('*') {
            return self.answers.push(line.into());
        }
        let mut parts = line.split('|');
        let time = parts.next().unwrap();
        assert!(time.len() == 27 && time.ends_with('Z'), "{line}");
        let mut parts: Vec<_> = parts.collect();
        // A condition has four further values, and is alone in its line.
        let name = parts[0].split_once(':').unwrap().1;
        // So is a message, which has two values.
        let is_alone = name == "message" && parts.len() == 3;
        assert!(is_alone || !line.contains(":message|"), "{line}");
        if ["link", "system"].contains(&name) {
            assert_eq!(parts.len(), 6, "{line}");
            parts = vec![parts[0], line.splitn(3, '|').last().unwrap()];
        }
        let mut parts = parts.into_iter();
        while let Some(key) = parts.next() {
            let mut value = parts.next().unwrap();
            if key.ends_with(":message") {
                assert_eq!(value, "", "{line}");
                value = parts.next().unwrap();
            }
            self.values.insert(key.into(), value.into());
            self.seen.insert((key.into(), value.into()));
        }
    }

    fn until(&mut self, what: &str, mut is_so: impl FnMut(&Self) -> bool) {
        let begun = Instant::now();
        while !is_so(self) {
            assert!(self.receive(), "{what}: closed");
            assert!(begun.elapsed() < PATIENCE, "{what}: {:?}", self.values);
        }
    }

    fn until_value(&mut self, key: &str, value: &str) {
        self.until(&format!("{key} {value}"), |agent| {
            agent.values.get(key).is_some_and(|now| now == value)
        });
    }
}

/// A free port of this computer.
fn free() -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    listener.local_addr().unwrap().port().to_string()
}

fn served(options: &[&str]) -> (Served, String) {
    let port = free();
    let options = [options, &["--mtconnect", &port]].concat();
    (Served::new(&options), format!("127.0.0.1:{port}"))
}

#[test]
fn the_agent_gets_what_its_file_of_devices_has() {
    let two = ["--port", "sim", "--port", "sim"];
    let (_served, address) = served(&two);
    let begun = Instant::now();
    let mut agent = Agent::new(&address);
    agent.until("both machines", |agent| {
        let is_up = |key| agent.values.get(key).is_some_and(|now| now == "AVAILABLE");
        is_up("machine-1:avail") && is_up("machine-2:avail")
    });
    agent.until_value("machine-2:x_position", "0.000");
    let took = begun.elapsed();
    assert!(took < Duration::from_secs(5), "{took:?}");
    // The agent asks whether this adapter is alive.
    agent.stream.write_all(b"* PING\r\n").unwrap();
    agent.until("the answer", |agent| agent.answers == ["* PONG 10000"]);
    let printed = Command::new(env!("CARGO_BIN_EXE_husillo"))
        .arg("serve")
        .args(two)
        .arg("--mtconnect-devices")
        .output()
        .unwrap();
    let document = String::from_utf8(printed.stdout).unwrap();
    let ids: BTreeSet<_> = document
        .split("<DataItem id=\"")
        .skip(1)
        .map(|rest| rest.split('"').next().unwrap().to_owned())
        .collect();
    let sent: BTreeSet<_> = agent
        .values
        .keys()
        .map(|key| key.replace("machine-", "m").replace(':', "_"))
        .collect();
    assert_eq!(sent, ids);
    assert_eq!(document.matches("<Device ").count(), 2);
}

#[test]
fn it_follows_the_machine() {
    let (served, address) = served(&["--speed", "10"]);
    let mut agent = Agent::new(&address);
    let locked = "FAULT|0|||locked: where the axes are is not known";
    agent.until_value("machine-1:system", locked);
    agent.until_value("machine-1:execution", "STOPPED");
    let mut page = served.operator();
    agent.until_value("machine-1:system", "NORMAL||||");
    agent.until_value("machine-1:execution", "READY");
    agent.until_value("machine-1:mode", "MANUAL");
    page.done(json!({"do": "line", "text": "G1 X3 F1200"}));
    page.until_at("machine_mm", 0, 3.0);
    let begun = Instant::now();
    agent.until_value("machine-1:x_position", "3.000");
    let took = begun.elapsed();
    assert!(took < Duration::from_secs(1), "{took:?}");
    page.done(json!({"do": "zero", "at_mm": {"x": 10}}));
    agent.until_value("machine-1:x_work", "10.000");
    page.done(json!({"do": "override", "what": "feed", "percent": 90}));
    agent.until_value("machine-1:feed_override", "90");
    let text = "G21 G90\nG1 X20 F600\nX10\n";
    assert_eq!(served.load(page.client, "a|part.nc", text).0, 200);
    agent.until_value("machine-1:program", "a/part.nc");
    page.done(json!({"do": "run", "confirmed": true}));
    agent.until_value("machine-1:execution", "PROGRAM_COMPLETED");
    for (key, value) in [
        ("execution", "ACTIVE"),
        ("mode", "AUTOMATIC"),
        ("line", "2"),
    ] {
        let had = (format!("machine-1:{key}"), value.to_owned());
        assert!(agent.seen.contains(&had), "{had:?} {:?}", agent.seen);
    }
    agent.until_value("machine-1:mode", "MANUAL");
}

#[test]
fn a_lost_controller_is_not_available() {
    let device = Emulated::listening("grbl", &[]);
    let (_served, address) = served(&["--port", device.port()]);
    let mut agent = Agent::new(&address);
    agent.until_value("machine-1:avail", "AVAILABLE");
    agent.until_value("machine-1:link", "NORMAL||||");
    drop(device);
    agent.until_value("machine-1:avail", "UNAVAILABLE");
    agent.until("a fault of the link", |agent| {
        agent.values["machine-1:link"].starts_with("FAULT||||")
    });
    for key in ["x_position", "execution", "feed"] {
        agent.until_value(&format!("machine-1:{key}"), "UNAVAILABLE");
    }
    agent.until_value("machine-1:system", "UNAVAILABLE||||");
}

/// Nothing that an agent sends reaches a machine, and no agent takes the place of others.
#[test]
fn agents_are_bounded() {
    let (served, address) = served(&[]);
    let mut endless = Agent::new(&address);
    endless.until("data", |agent| !agent.values.is_empty());
    let sent = endless.stream.write_all(&[b'x'; 4096]);
    let begun = Instant::now();
    while sent.is_ok() && endless.receive() {
        assert!(
            begun.elapsed() < PATIENCE,
            "a line without an end was taken"
        );
    }
    let mut agents: Vec<_> = (0..8).map(|_| Agent::new(&address)).collect();
    for agent in &mut agents {
        agent.until("data", |agent| !agent.values.is_empty());
    }
    let mut ninth = Agent::new(&address);
    while ninth.receive() {
        assert!(ninth.values.is_empty() && begun.elapsed() < PATIENCE);
    }
    agents.pop();
    let begun = Instant::now();
    loop {
        let mut again = Agent::new(&address);
        while again.values.is_empty() && again.receive() {}
        if !again.values.is_empty() {
            break;
        }
        assert!(begun.elapsed() < PATIENCE);
    }
    // The machine is as it was.
    assert_eq!(served.page().states[0]["state"], "Alarm");
}

#[test]
#[ignore = "takes twenty seconds"]
fn an_agent_that_has_gone_silent_is_closed() {
    let (_served, address) = served(&[]);
    let (mut silent, mut never) = (Agent::new(&address), Agent::new(&address));
    silent.stream.write_all(b"* PING\n").unwrap();
    let begun = Instant::now();
    while silent.receive() {
        assert!(begun.elapsed() < PATIENCE);
    }
    assert!(begun.elapsed() > Duration::from_secs(19));
    // This one has no heartbeat at all.
    assert!(never.receive());
}
