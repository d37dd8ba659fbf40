//! The edge node of Sparkplug B while it is connected: births, data, and commands.

use super::job::{Job, JobState, Jobs, Report, Told, shown};
use super::metrics::{changed, of_commands, of_job, of_machine};
use super::payload::{Metric, Payload, Type, Value};
use crate::serve::console_lines::From;
use crate::serve::machine::Machine;
use crate::serve::mtconnect::device;
use jiff::Timestamp;
use prost::Message as _;
use rumqttc::v5::AsyncClient;
use rumqttc::v5::mqttbytes::QoS;
use rumqttc::v5::mqttbytes::v5::Publish;
use serde_json::Value as Json;
use std::sync::Arc;

/// The topics of this server.
#[derive(Clone, Debug)]
pub struct Topics {
    group: String,
    node: String,
}

impl Topics {
    /// Those of a server in a group.
    pub const fn new(group: String, node: String) -> Self {
        Self { group, node }
    }

    /// The topic of a message about this server.
    pub fn of_node(&self, kind: &str) -> String {
        format!("spBv1.0/{}/{kind}/{}", self.group, self.node)
    }

    /// The topic of a message about a machine. `+` stands for all of them.
    pub fn of_machine(&self, kind: &str, device: &str) -> String {
        format!("{}/{device}", self.of_node(kind))
    }
}

/// What the broker has of a machine.
#[derive(Debug)]
struct Born {
    machine: Arc<Machine>,
    device: String,
    axes: Vec<String>,
    /// The values that were sent. Empty: the broker takes the machine for dead.
    sent: Vec<Metric>,
    /// The last job.
    job: Option<Report>,
}

/// The node. It outlasts the connections.
#[derive(Debug)]
pub struct Node {
    topics: Topics,
    machines: Vec<Born>,
    /// Without them no job is taken.
    jobs: Option<Arc<Jobs>>,
    /// Number of the next message.
    seq: u8,
    /// Number of the present connection.
    session: u8,
}

impl Node {
    /// A node with these machines.
    pub fn new(topics: Topics, machines: &[Arc<Machine>], jobs: Option<Arc<Jobs>>) -> Self {
        let born = |machine: &Arc<Machine>| {
            let described = machine.described();
            let axes = described["axes"].as_array().into_iter().flatten();
            Born {
                machine: Arc::clone(machine),
                device: device(machine),
                axes: axes.filter_map(Json::as_str).map(str::to_owned).collect(),
                sent: Vec::new(),
                job: None,
            }
        };
        Self {
            topics,
            machines: machines.iter().map(born).collect(),
            jobs,
            seq: 0,
            session: 0,
        }
    }

    /// The will of a connection, which also is the message of an orderly end.
    pub fn death(session: u8) -> Vec<u8> {
        let payload = Payload {
            timestamp: Some(now_ms()),
            metrics: vec![session_metric(session)],
            seq: None,
        };
        payload.encode_to_vec()
    }

    /// A connection begins: all is told.
    pub async fn begin(&mut self, client: &AsyncClient, session: u8) {
        self.session = session;
        let (ncmd, dcmd) = (
            self.topics.of_node("NCMD"),
            self.topics.of_machine("DCMD", "+"),
        );
        // A connection that fails is noticed by its event loop.
        let _ = client.subscribe(ncmd, QoS::AtLeastOnce).await;
        let _ = client.subscribe(dcmd, QoS::AtLeastOnce).await;
        self.birth(client).await;
    }

    /// Tells all about this server and its machines.
    async fn birth(&mut self, client: &AsyncClient) {
        self.seq = 0;
        let takes_jobs = Some(Value::Boolean(self.jobs.is_some()));
        let version = Some(Value::Text(env!("CARGO_PKG_VERSION").into()));
        let metrics = vec![
            session_metric(self.session),
            Metric::new(
                "Node Control/Rebirth",
                Type::Boolean,
                Some(Value::Boolean(false)),
            ),
            Metric::new("Properties/Version", Type::String, version),
            Metric::new("Properties/Takes Jobs", Type::Boolean, takes_jobs),
        ];
        self.publish(client, self.topics.of_node("NBIRTH"), metrics)
            .await;
        for index in 0..self.machines.len() {
            if let Some(born) = self.machines.get_mut(index) {
                born.sent.clear();
            }
            self.look(client, index).await;
        }
    }

    /// Tells what has changed in all machines.
    pub async fn look_at_all(&mut self, client: &AsyncClient) {
        for index in 0..self.machines.len() {
            self.look(client, index).await;
        }
    }

    async fn look(&mut self, client: &AsyncClient, index: usize) {
        let takes_jobs = self.jobs.is_some();
        let Some(born) = self.machines.get_mut(index) else {
            return;
        };
        let state = shown(&born.machine);
        // A controller that has just been reached has no state yet.
        let is_up = state["link"] == "up" && !state["state"].is_null();
        let now = of_machine(&state, &born.axes);
        let (kind, metrics) = match (born.sent.is_empty(), is_up) {
            (true, false) => return,
            (true, true) => {
                let mut all = now.clone();
                all.extend(of_job(born.job.as_ref()));
                all.extend(takes_jobs.then(of_commands).into_iter().flatten());
                ("DBIRTH", all)
            }
            (false, false) => ("DDEATH", Vec::new()),
            (false, true) => ("DDATA", changed(&now, &born.sent)),
        };
        if kind == "DDATA" && metrics.is_empty() {
            return;
        }
        born.sent = if is_up { now } else { Vec::new() };
        let topic = self.topics.of_machine(kind, &born.device);
        self.publish(client, topic, metrics).await;
    }

    /// Sends the report of a job.
    pub async fn tell(&mut self, client: Option<&AsyncClient>, told: Told) {
        let Some(born) = self.machines.get_mut(told.machine) else {
            return;
        };
        if told.is_last {
            born.job = Some(told.report.clone());
        }
        // The birth of a machine has the last job.
        if let (Some(client), false) = (client, born.sent.is_empty()) {
            let topic = self.topics.of_machine("DDATA", &born.device);
            self.publish(client, topic, of_job(Some(&told.report)).into())
                .await;
        }
    }

    /// Carries out a command.
    pub async fn command(&mut self, client: &AsyncClient, message: &Publish) {
        let topic = String::from_utf8_lossy(&message.topic).into_owned();
        let Ok(payload) = Payload::decode(&message.payload[..]) else {
            return;
        };
        // A message that the broker keeps is not meant for now.
        if message.retain {
            return;
        }
        if topic == self.topics.of_node("NCMD") {
            if payload.value("Node Control/Rebirth") == Some(&Value::Boolean(true)) {
                self.birth(client).await;
            }
            return;
        }
        let of = |born: &Born| topic == self.topics.of_machine("DCMD", &born.device);
        let Some(index) = self.machines.iter().position(of) else {
            return;
        };
        let Some(id) = payload.text("Job/Id") else {
            return;
        };
        let refused = |why: &str| Told {
            machine: index,
            report: Report {
                id: id.to_owned(),
                state: JobState::Refused,
                message: why.into(),
                line: None,
            },
            is_last: false,
        };
        let Some(jobs) = self.jobs.clone() else {
            let told = refused("this server takes no jobs: it was started without --mqtt-jobs");
            if let Some(born) = self.machines.get(index) {
                born.machine
                    .tell(From::Server, "a job of the broker was refused");
            }
            return self.tell(Some(client), told).await;
        };
        let Some(text) = payload.text("Job/Program") else {
            return self
                .tell(Some(client), refused("Job/Program is missing"))
                .await;
        };
        let job = Job {
            id: id.to_owned(),
            name: payload.text("Job/Name").unwrap_or("program.nc").to_owned(),
            text: text.as_bytes().to_vec(),
        };
        tokio::spawn(async move { jobs.carry_out(index, job).await });
    }

    async fn publish(&mut self, client: &AsyncClient, topic: String, metrics: Vec<Metric>) {
        let now = now_ms();
        let stamped = metrics.into_iter().map(|metric| Metric {
            timestamp: Some(now),
            ..metric
        });
        let payload = Payload {
            timestamp: Some(now),
            metrics: stamped.collect(),
            seq: Some(self.seq.into()),
        };
        self.seq = self.seq.wrapping_add(1);
        // A connection that fails is noticed by its event loop.
        let _ = client
            .publish(topic, QoS::AtMostOnce, false, payload.encode_to_vec())
            .await;
    }
}

fn session_metric(session: u8) -> Metric {
    Metric::new("bdSeq", Type::Int64, Some(Value::Long(session.into())))
}

fn now_ms() -> u64 {
    u64::try_from(Timestamp::now().as_millisecond()).unwrap_or(0)
}
