//! What the machines do, for a broker of MQTT; and jobs, if that is permitted.
//!
//! This server is an edge node of Sparkplug B, its machines are its devices. It reads the states
//! that pages get. Nothing that moves or stops a machine waits for the broker.
//!
//! ```text
//! machine ──► node ──► client ──► event loop ──► broker
//!    ▲         └◄── commands ◄────────┘
//!    └── jobs ◄┘   (only with --mqtt-jobs)
//! ```

mod broker;
mod job;
mod job_folder;
mod metrics;
mod node;
mod payload;

use super::console_lines::From;
use super::host_name;
use super::machine::Machine;
use crate::cli::Cell;
use crate::measuring::memory_file;
pub use job::CELL;
use job::{Jobs, Told};
use job_folder::JobFolder;
use node::{Node, Topics};
use rumqttc::v5::mqttbytes::QoS;
use rumqttc::v5::mqttbytes::v5::{LastWill, Packet, Publish};
use rumqttc::v5::{AsyncClient, Event, EventLoop, MqttOptions};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::sync::watch;
use tokio::time::{Instant, sleep_until, timeout};

/// Shortest interval between two rounds of data.
const ROUND: Duration = Duration::from_millis(200);
/// A lost broker is tried again after this time.
const RETRY: Duration = Duration::from_secs(1);
/// A connection in which nothing was sent or received for this time is lost. There is a ping every
/// ten seconds.
const SILENCE: Duration = Duration::from_secs(30);
/// Messages that wait for the network.
const WAITING: usize = 1024;
/// Longest time to report the end of this program to the broker.
const END: Duration = Duration::from_secs(1);

/// The link to the broker.
#[derive(Debug)]
pub struct Link {
    ending: watch::Sender<bool>,
    task: tokio::task::JoinHandle<()>,
}

impl Link {
    /// Connects to the broker, again and again until [`end`](Self::end).
    ///
    /// # Errors
    ///
    /// A sentence about an argument, or about the folder of the jobs. That the broker is not there
    /// is no error.
    pub fn start(
        url: &str,
        cell: &Cell,
        machines: &[Arc<Machine>],
        news: &watch::Sender<u64>,
    ) -> Result<Self, String> {
        let name = cell.mqtt_node.clone().unwrap_or_else(host_name);
        let client = format!("husillo-{}-{name}", cell.mqtt_group);
        let options = broker::options(url, &client, cell)?;
        let (to, told) = unbounded_channel();
        let jobs = match cell.mqtt_jobs {
            true => {
                let folder = memory_file::folder();
                let folder = folder.ok_or("where the state is kept is not known: set HOME")?;
                let folder = JobFolder::new(folder.join("jobs"))?;
                // Before a job can arrive: one that runs is not an interrupted one.
                let open = folder.open(&name)?;
                let jobs = Jobs::new(folder, name.clone(), machines.to_vec(), to.clone());
                let jobs = Arc::new(jobs);
                let offering = Arc::clone(&jobs);
                tokio::spawn(async move { offering.offer(open).await });
                Some(jobs)
            }
            false => None,
        };
        let topics = Topics::new(cell.mqtt_group.clone(), name);
        let (ending, ends) = watch::channel(false);
        let cell = Connected {
            node: Node::new(topics.clone(), machines, jobs),
            machines: machines.to_vec(),
            topics,
            told,
            _keeps_open: to,
            news: news.subscribe(),
            ends,
            why: String::new(),
        };
        let task = tokio::spawn(cell.connect(options));
        Ok(Self { ending, task })
    }

    /// Tells the broker that this server ends.
    pub async fn end(self) {
        self.ending.send_replace(true);
        let _ = timeout(END, self.task).await;
    }
}

/// What a connection has heard.
#[derive(Debug)]
enum Heard {
    Connected,
    Message(Box<Publish>),
    Lost(String),
}

/// What goes on from one connection to the next.
#[derive(Debug)]
struct Connected {
    node: Node,
    machines: Vec<Arc<Machine>>,
    topics: Topics,
    told: UnboundedReceiver<Told>,
    /// Without jobs there is no other sender.
    _keeps_open: UnboundedSender<Told>,
    news: watch::Receiver<u64>,
    ends: watch::Receiver<bool>,
    /// Why the broker is not reached, as the consoles have it.
    why: String,
}

impl Connected {
    async fn connect(mut self, mut options: MqttOptions) {
        // The number of a connection. The will has the same one as the birth.
        for session in (0..=u8::MAX).cycle() {
            let topic = self.topics.of_node("NDEATH");
            let will = LastWill::new(topic, Node::death(session), QoS::AtLeastOnce, false, None);
            options.set_last_will(will);
            let (client, events) = AsyncClient::new(options.clone(), WAITING);
            let (to, heard) = unbounded_channel();
            // Messages of a lost connection are not sent in the next one: it begins with a birth.
            let polling = tokio::spawn(poll(events, to));
            let ended = self.serve(&client, heard, session).await;
            match ended {
                None => {
                    drop(client);
                    let _ = polling.await;
                    return;
                }
                Some(now) if now != self.why => {
                    self.say(&format!(
                        "the broker is not reached: {now}; the machines go on"
                    ));
                    self.why = now;
                }
                Some(_) => {}
            }
            polling.abort();
            let mut ends = self.ends.clone();
            let next = Instant::now() + RETRY;
            loop {
                tokio::select! {
                    () = sleep_until(next) => break,
                    Some(told) = self.told.recv() => self.node.tell(None, told).await,
                    _ = ends.changed() => return,
                }
            }
        }
    }

    /// Serves a connection. Returns why it was lost, or `None` when this program ends.
    async fn serve(
        &mut self,
        client: &AsyncClient,
        mut heard: UnboundedReceiver<Heard>,
        session: u8,
    ) -> Option<String> {
        let (mut is_connected, mut is_due, mut next) = (false, true, Instant::now());
        loop {
            tokio::select! {
                heard = heard.recv() => match heard {
                    Some(Heard::Connected) => {
                        is_connected = true;
                        self.why.clear();
                        self.say("the broker is reached");
                        self.node.begin(client, session).await;
                    }
                    Some(Heard::Message(message)) => self.node.command(client, &message).await,
                    Some(Heard::Lost(why)) => return Some(why),
                    None => return Some("the connection has ended".into()),
                },
                Some(told) = self.told.recv() => {
                    self.node.tell(is_connected.then_some(client), told).await;
                }
                changed = self.news.changed(), if is_connected && !is_due => {
                    is_due = changed.is_ok();
                }
                () = sleep_until(next), if is_connected && is_due => {
                    is_due = false;
                    next = Instant::now() + ROUND;
                    self.node.look_at_all(client).await;
                }
                _ = self.ends.changed() => {
                    if is_connected {
                        // Without this message the will would be sent only after an error.
                        let topic = self.topics.of_node("NDEATH");
                        let death = Node::death(session);
                        let _ = client.publish(topic, QoS::AtLeastOnce, false, death).await;
                        let _ = client.disconnect().await;
                        // Until the broker has closed the connection.
                        while let Some(Heard::Connected | Heard::Message(_)) = heard.recv().await {}
                    }
                    return None;
                }
            }
        }
    }

    fn say(&self, text: &str) {
        for machine in &self.machines {
            machine.tell(From::Server, text);
        }
    }
}

/// Moves the connection on until it is lost. What was heard waits without a bound: a reader that
/// waits for this function to send must not hold it up.
async fn poll(mut events: EventLoop, to: UnboundedSender<Heard>) {
    loop {
        let heard = match timeout(SILENCE, events.poll()).await {
            Ok(Ok(Event::Incoming(Packet::ConnAck(_)))) => Heard::Connected,
            Ok(Ok(Event::Incoming(Packet::Publish(message)))) => Heard::Message(Box::new(message)),
            Ok(Ok(_)) => continue,
            Ok(Err(error)) => Heard::Lost(error.to_string()),
            Err(_) => Heard::Lost("it takes no data".into()),
        };
        let is_lost = matches!(heard, Heard::Lost(_));
        if to.send(heard).is_err() || is_lost {
            return;
        }
    }
}
