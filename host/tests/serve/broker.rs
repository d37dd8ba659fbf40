//! A broker, and a host application that is connected to it. It reads and writes the protobuf by
//! itself.

use rumqttc::v5::mqttbytes::QoS;
use rumqttc::v5::mqttbytes::v5::Packet;
use rumqttc::v5::{Client, Event, MqttOptions};
use std::net::{TcpListener, TcpStream};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// Whatever is waited for has happened within this time, also on a busy computer.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// Mosquitto with a folder of its own, until it is dropped.
pub struct Broker {
    process: Option<Child>,
    pub folder: PathBuf,
    pub port: u16,
    rules: String,
}

impl Broker {
    /// `None`, with a message, where there is no mosquitto. `name` is for this test alone.
    pub fn new(name: &str) -> Option<Self> {
        Self::with(name, "allow_anonymous true\n")
    }

    /// The same with these lines of its configuration. `FOLDER` stands for its folder.
    pub fn with(name: &str, rules: &str) -> Option<Self> {
        let folder = std::env::temp_dir().join(format!("husillo-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let port = free();
        let rules = rules.replace("FOLDER", folder.to_str().unwrap());
        let mut broker = Self {
            process: None,
            folder,
            port,
            rules,
        };
        broker.start().then_some(broker)
    }

    /// Starts it at its port. Returns whether there is a mosquitto.
    pub fn start(&mut self) -> bool {
        let file = self.folder.join("mosquitto.conf");
        // An administrator's mosquitto would become another user, who cannot read its files.
        let user = "user root";
        let text = format!("{user}\nlistener {} 127.0.0.1\n{}", self.port, self.rules);
        std::fs::write(&file, text).unwrap();
        // Debian has it in a folder of the administrator.
        let path = format!("{}:/usr/sbin", std::env::var("PATH").unwrap_or_default());
        let started = Command::new("mosquitto")
            .env("PATH", path)
            .arg("-c")
            .arg(&file)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn();
        let Ok(process) = started else {
            eprintln!("skipped: there is no mosquitto");
            return false;
        };
        self.process = Some(process);
        let begun = Instant::now();
        while TcpStream::connect(("127.0.0.1", self.port)).is_err() {
            assert!(begun.elapsed() < PATIENCE, "mosquitto does not start");
            std::thread::sleep(Duration::from_millis(20));
        }
        true
    }

    /// Kills it.
    pub fn kill(&mut self) {
        if let Some(mut process) = self.process.take() {
            process.kill().unwrap();
            process.wait().unwrap();
        }
    }

    pub fn url(&self) -> String {
        format!("mqtt://127.0.0.1:{}", self.port)
    }

    /// The folder for the state of a server, as a variable of its environment.
    pub fn state(&self) -> [(&'static str, &str); 1] {
        [("XDG_STATE_HOME", self.folder.to_str().unwrap())]
    }
}

impl Drop for Broker {
    fn drop(&mut self) {
        self.kill();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// A free port of this computer.
pub fn free() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    listener.local_addr().unwrap().port()
}

/// A value of a metric.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Null,
    Number(f64),
    Is(bool),
    Text(String),
}

/// A message about a server or one of its machines.
#[derive(Clone, Debug)]
pub struct Message {
    /// `NBIRTH` and so on.
    pub kind: String,
    /// The rest of the topic: the server, or the server and the machine.
    pub about: String,
    pub seq: Option<u64>,
    pub metrics: Vec<(String, Value)>,
    pub at: Instant,
}

impl Message {
    pub fn value(&self, name: &str) -> Option<&Value> {
        let mut metrics = self.metrics.iter();
        metrics.find(|(of, _)| of == name).map(|(_, value)| value)
    }

    pub fn text(&self, name: &str) -> &str {
        match self.value(name) {
            Some(Value::Text(text)) => text,
            _ => "",
        }
    }

    pub fn number(&self, name: &str) -> f64 {
        match self.value(name) {
            Some(Value::Number(number)) => *number,
            _ => f64::NAN,
        }
    }
}

/// A host application.
pub struct Host {
    client: Client,
    messages: Receiver<Message>,
    /// All that it has received.
    pub all: Vec<Message>,
    /// Messages that a search has passed.
    seen: usize,
}

impl Host {
    pub fn new(broker: &Broker) -> Self {
        let port = broker.port;
        let mut options = MqttOptions::new(format!("host-{}", free()), "127.0.0.1", port);
        options.set_clean_start(true);
        let (client, mut connection) = Client::new(options, 100);
        let (to, messages) = channel();
        let (ready, is_ready) = channel();
        let subscriber = client.clone();
        std::thread::spawn(move || {
            for event in connection.iter() {
                match event {
                    Ok(Event::Incoming(Packet::ConnAck(_))) => {
                        let all = subscriber.try_subscribe("spBv1.0/#", QoS::AtLeastOnce);
                        all.unwrap();
                    }
                    Ok(Event::Incoming(Packet::SubAck(_))) => {
                        let _ = ready.send(());
                    }
                    Ok(Event::Incoming(Packet::Publish(message))) => {
                        let topic = std::str::from_utf8(&message.topic).unwrap();
                        // What hosts write.
                        if topic.contains("CMD/") {
                            continue;
                        }
                        if to.send(decoded(topic, &message.payload)).is_err() {
                            return;
                        }
                    }
                    Ok(_) => {}
                    // It is connected again by the next turn.
                    Err(_) => std::thread::sleep(Duration::from_millis(100)),
                }
            }
        });
        is_ready.recv_timeout(PATIENCE).unwrap();
        Self {
            client,
            messages,
            all: Vec::new(),
            seen: 0,
        }
    }

    /// The next message that fits, among those after the last one that was found.
    pub fn until(&mut self, what: &str, mut fits: impl FnMut(&Message) -> bool) -> Message {
        let begun = Instant::now();
        loop {
            while self.seen < self.all.len() {
                let message = &self.all[self.seen];
                self.seen += 1;
                if fits(message) {
                    return message.clone();
                }
            }
            let left = PATIENCE.checked_sub(begun.elapsed());
            let left = left.unwrap_or_else(|| panic!("{what}: {:#?}", self.all));
            if let Ok(message) = self.messages.recv_timeout(left) {
                self.all.push(message);
            }
        }
    }

    /// Receives for a time.
    pub fn pass(&mut self, time: Duration) {
        let end = Instant::now() + time;
        while let Some(left) = end.checked_duration_since(Instant::now()) {
            if let Ok(message) = self.messages.recv_timeout(left) {
                self.all.push(message);
            }
        }
    }

    /// The next report of a job with this state.
    pub fn until_job(&mut self, id: &str, state: &str) -> Message {
        self.until(&format!("job {id} {state}"), |message| {
            message.text("Job/Id") == id && message.text("Job/State") == state
        })
    }

    /// Publishes metrics, the values of which are texts.
    pub fn write(&self, topic: &str, texts: &[(&str, &str)], retain: bool) {
        let mut bytes = Vec::new();
        for (name, text) in texts {
            let mut metric = field(1, name.as_bytes());
            metric.extend([0x20, 12]);
            metric.extend(field(15, text.as_bytes()));
            bytes.extend(field(2, &metric));
        }
        self.write_bytes(topic, bytes, retain);
    }

    pub fn write_bytes(&self, topic: &str, bytes: Vec<u8>, retain: bool) {
        let client = &self.client;
        client
            .publish(topic, QoS::AtLeastOnce, retain, bytes)
            .unwrap();
    }

    /// Asks the server `mill` for all of its data.
    pub fn ask_for_births(&self) {
        let mut metric = field(1, b"Node Control/Rebirth");
        metric.extend([0x20, 11, 0x70, 1]);
        self.write_bytes("spBv1.0/husillo/NCMD/mill", field(2, &metric), false);
    }

    /// Sends a job to machine 1 of the server `mill`.
    pub fn job(&self, id: &str, program: &str) {
        let texts = [
            ("Job/Id", id),
            ("Job/Name", "part.nc"),
            ("Job/Program", program),
        ];
        self.write("spBv1.0/husillo/DCMD/mill/machine-1", &texts, false);
    }
}

/// A field of bytes, with a number below 16.
fn field(number: u8, bytes: &[u8]) -> Vec<u8> {
    let mut field = vec![(number << 3) | 2];
    let mut length = bytes.len();
    while length > 127 {
        field.push((length & 127) as u8 | 128);
        length >>= 7;
    }
    field.push(length as u8);
    field.extend(bytes);
    field
}

fn decoded(topic: &str, bytes: &[u8]) -> Message {
    let mut parts = topic.splitn(4, '/');
    assert_eq!(parts.next(), Some("spBv1.0"));
    parts.next().unwrap();
    let kind = parts.next().unwrap().to_owned();
    let about = parts.next().unwrap_or_default().to_owned();
    let mut message = Message {
        kind,
        about,
        seq: None,
        metrics: Vec::new(),
        at: Instant::now(),
    };
    for (number, field) in fields(bytes) {
        match (number, field) {
            (2, Field::Bytes(metric)) => message.metrics.push(metric_of(metric)),
            (3, Field::Number(seq)) => message.seq = Some(seq),
            _ => {}
        }
    }
    message
}

fn metric_of(bytes: &[u8]) -> (String, Value) {
    let (mut name, mut value) = (String::new(), Value::Null);
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    for (number, field) in fields(bytes) {
        match (number, field) {
            (1, Field::Bytes(bytes)) => name = text(bytes),
            (10 | 11, Field::Number(number)) => value = Value::Number(number as f64),
            (13, Field::Double(number)) => value = Value::Number(number),
            (14, Field::Number(is)) => value = Value::Is(is == 1),
            (15, Field::Bytes(bytes)) => value = Value::Text(text(bytes)),
            _ => {}
        }
    }
    (name, value)
}

enum Field<'a> {
    Number(u64),
    Double(f64),
    Bytes(&'a [u8]),
}

/// The fields of a message of protobuf.
fn fields(mut bytes: &[u8]) -> Vec<(u64, Field<'_>)> {
    fn number(bytes: &mut &[u8]) -> u64 {
        let (mut value, mut shift) = (0, 0);
        loop {
            let (byte, rest) = bytes.split_first().unwrap();
            *bytes = rest;
            value |= u64::from(byte & 127) << shift;
            shift += 7;
            if byte & 128 == 0 {
                return value;
            }
        }
    }
    let mut fields = Vec::new();
    while !bytes.is_empty() {
        let key = number(&mut bytes);
        let field = match key & 7 {
            0 => Field::Number(number(&mut bytes)),
            1 => {
                let (value, rest) = bytes.split_at(8);
                bytes = rest;
                Field::Double(f64::from_le_bytes(value.try_into().unwrap()))
            }
            2 => {
                let length = number(&mut bytes) as usize;
                let (value, rest) = bytes.split_at(length);
                bytes = rest;
                Field::Bytes(value)
            }
            kind => panic!("a field of the kind {kind}"),
        };
        fields.push((key >> 3, field));
    }
    fields
}
