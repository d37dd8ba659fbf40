//! A server in the background, and pages that are connected to it.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tungstenite::{Message, WebSocket};

/// Whatever is waited for has happened within this time, also on a busy computer.
const PATIENCE: Duration = Duration::from_secs(60);

/// The program, until it is dropped.
pub struct Served {
    pub process: Child,
    /// HOST:PORT.
    pub address: String,
    pub token: String,
}

impl Served {
    /// A server with these options, on a free port.
    pub fn new(options: &[&str]) -> Self {
        Self::with(options, &[])
    }

    /// The same with these variables of the environment.
    pub fn with(options: &[&str], variables: &[(&str, &str)]) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_husillo"))
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .args(["serve", "--listen", "127.0.0.1:0", "--for", "4000"])
            .args(options)
            .envs(variables.iter().copied())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut first = String::new();
        let mut output = BufReader::new(process.stdout.take().unwrap());
        output.read_line(&mut first).unwrap();
        let link = first.trim().strip_prefix("Open http://").unwrap();
        let (address, token) = link.split_once("/#").unwrap();
        Self {
            address: address.into(),
            token: token.into(),
            process,
        }
    }

    /// The answer to an HTTP request with these lines, as text.
    pub fn http(&self, request: &str) -> String {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// The same for `GET` with these further headers.
    pub fn get(&self, path: &str, headers: &str) -> String {
        let host = &self.address;
        self.http(&format!(
            "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n{headers}\r\n"
        ))
    }

    /// Loads a program as this client. Returns the status, and the report or the reason.
    pub fn load(&self, client: u64, name: &str, text: &str) -> (u16, Value) {
        let (host, token, length) = (&self.address, &self.token, text.len());
        let answer = self.http(&format!(
            "POST /machines/1/program?name={name} HTTP/1.1\r\nHost: {host}\r\n\
             Authorization: Bearer {token}\r\nX-Husillo-Client: {client}\r\n\
             Content-Length: {length}\r\nConnection: close\r\n\r\n{text}"
        ));
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        let body = serde_json::from_str(body).unwrap_or_else(|_| Value::from(body));
        (status, body)
    }

    /// A page that watches.
    pub fn page(&self) -> Page {
        let stream = TcpStream::connect(&self.address).unwrap();
        let step = Some(Duration::from_millis(20));
        let url = format!("ws://{}/socket?token={}", self.address, self.token);
        let (socket, _) = tungstenite::client(url, stream).unwrap();
        socket.get_ref().set_read_timeout(step).unwrap();
        let mut page = Page {
            socket,
            client: 0,
            states: Vec::new(),
            lines: Vec::new(),
            path: Vec::new(),
            answers: Vec::new(),
            next: 1,
        };
        page.until("a welcome", |page| (page.client > 0).then_some(()));
        page.until("states", |page| {
            // A mill that is not homed has no position.
            let are_up = |state: &Value| {
                let own = ["mill", "factory", "measuring"];
                let has_own = own.iter().any(|own| state[*own].is_object());
                state["link"] == "up" && (!state["work_mm"].is_null() || has_own)
            };
            let is_complete = !page.states.is_empty() && page.states.iter().all(are_up);
            is_complete.then_some(())
        });
        page
    }

    /// A page in control of machine 1.
    pub fn in_control(&self) -> Page {
        let mut page = self.page();
        page.done(json!({"do": "take"}));
        page
    }

    /// A page in control of machine 1, which is unlocked.
    pub fn operator(&self) -> Page {
        let mut page = self.in_control();
        page.done(json!({"do": "unlock"}));
        page.until_state("Idle");
        page
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A page.
pub struct Page {
    pub socket: WebSocket<TcpStream>,
    pub client: u64,
    /// The last state of each machine.
    pub states: Vec<Value>,
    /// All lines of the consoles.
    pub lines: Vec<Value>,
    /// The points of the way of machine 1.
    pub path: Vec<Value>,
    answers: Vec<Value>,
    next: u64,
}

impl Page {
    /// Receives what has arrived, or waits for a short time. Returns whether the socket is open.
    pub fn receive(&mut self) -> bool {
        match self.socket.read() {
            Ok(Message::Text(text)) => self.take(serde_json::from_str(&text).unwrap()),
            Ok(Message::Close(_)) => return false,
            Ok(_) => {}
            Err(tungstenite::Error::Io(error)) => {
                use std::io::ErrorKind::{TimedOut, WouldBlock};
                return matches!(error.kind(), TimedOut | WouldBlock);
            }
            Err(_) => return false,
        }
        true
    }

    fn take(&mut self, mut frame: Value) {
        match frame["kind"].as_str() {
            Some("welcome") => {
                assert_eq!(frame["protocol"], 1);
                self.client = frame["client"].as_u64().unwrap();
                let machines = frame["machines"].as_array().unwrap().len();
                self.states = vec![Value::Null; machines];
            }
            Some("state") => {
                let machine = frame["machine"].as_u64().unwrap() as usize;
                self.states[machine - 1] = frame;
            }
            Some("console") => {
                let lines = frame["lines"].as_array_mut().unwrap();
                self.lines.append(lines);
            }
            Some("path") => {
                if frame["from"] == 0 {
                    self.path.clear();
                }
                let points = frame["points"].as_array_mut().unwrap();
                self.path.append(points);
            }
            Some("answer") => self.answers.push(frame),
            Some("alive") => {}
            kind => panic!("a frame of the kind {kind:?}"),
        }
    }

    /// Receives until there is something.
    pub fn until<T>(&mut self, what: &str, mut find: impl FnMut(&mut Self) -> Option<T>) -> T {
        let begun = Instant::now();
        loop {
            if let Some(found) = find(self) {
                return found;
            }
            assert!(self.receive(), "{what}: the socket is closed");
            assert!(
                begun.elapsed() < PATIENCE,
                "{what}: {:?}\n{:?}",
                self.states,
                self.lines
            );
        }
    }

    /// Receives until machine 1 is in this state.
    pub fn until_state(&mut self, state: &str) {
        self.until(state, |page| {
            (page.states[0]["state"] == state).then_some(())
        });
    }

    /// Receives until the program of machine 1 is in this phase.
    pub fn until_phase(&mut self, phase: &str) {
        self.until(phase, |page| {
            (page.states[0]["program"]["phase"] == phase).then_some(())
        });
    }

    /// Renews a jog for a time.
    pub fn hold(&mut self, jog: u64, time: Duration) {
        let begun = Instant::now();
        while begun.elapsed() < time {
            self.say(json!({"do": "renew", "jog": jog}));
            self.pass(Duration::from_millis(60));
        }
    }

    /// Receives for a time.
    pub fn pass(&mut self, time: Duration) {
        let begun = Instant::now();
        while begun.elapsed() < time {
            assert!(self.receive());
        }
    }

    /// Sends a request to machine 1 that needs no answer.
    pub fn say(&mut self, mut request: Value) {
        if request["machine"].is_null() {
            request["machine"] = json!(1);
        }
        self.socket
            .send(Message::text(request.to_string()))
            .unwrap();
    }

    /// Sends a request. Returns the number of its answer.
    pub fn begin(&mut self, mut request: Value) -> u64 {
        let id = self.next;
        self.next += 1;
        request["id"] = json!(id);
        self.say(request);
        id
    }

    /// Sends a request and waits for its answer.
    pub fn ask(&mut self, request: Value) -> Result<Value, String> {
        let id = self.begin(request);
        self.answer(id)
    }

    /// Waits for the answer with this number.
    pub fn answer(&mut self, id: u64) -> Result<Value, String> {
        self.until("an answer", |page| {
            let at = page.answers.iter().position(|answer| answer["id"] == id)?;
            let mut answer = page.answers.swap_remove(at);
            Some(match answer["ok"] == true {
                true => Ok(answer["data"].take()),
                false => Err(answer["error"].as_str().unwrap().to_owned()),
            })
        })
    }

    /// Sends a request that is carried out.
    pub fn done(&mut self, request: Value) -> Value {
        let asked = request.to_string();
        self.ask(request)
            .unwrap_or_else(|why| panic!("{asked}: {why}"))
    }

    /// Sends a request that is refused.
    pub fn refused(&mut self, request: Value) -> String {
        let asked = request.to_string();
        self.ask(request).expect_err(&asked)
    }

    /// A coordinate of machine 1, mm: `work_mm` or `machine_mm`.
    pub fn at(&self, frame: &str, axis: usize) -> f64 {
        self.states[0][frame][axis].as_f64().unwrap()
    }

    /// Receives until an axis of machine 1 is there.
    pub fn until_at(&mut self, frame: &str, axis: usize, mm: f64) {
        self.until(&format!("{frame} {axis} at {mm}"), |page| {
            ((page.at(frame, axis) - mm).abs() < 0.006).then_some(())
        });
    }

    /// Whether a console has had a line with this text.
    pub fn has_line(&self, text: &str) -> bool {
        let mut lines = self.lines.iter();
        lines.any(|line| line["text"].as_str().unwrap().contains(text))
    }
}
