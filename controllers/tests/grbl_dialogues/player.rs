//! Plays one recorded dialogue against the controller in simulated time.

use husillo_controllers::{Grbl, GrblEvent, GrblMemory, GrblOptions};
use husillo_sim::{Emulated, GrblPin, GrblRig, SlideSwitch};
use serde_json::Value;
use std::collections::VecDeque;

/// Time of a byte at 115200 bits/s, us.
const BYTE_US: u64 = 87;
/// A reply that takes longer does not come, us.
const PATIENCE_US: u64 = 90_000_000;

/// What the controller did.
#[derive(Clone, Debug)]
pub enum Deed {
    /// A line, with its end.
    Line(String),
    /// An output and its level.
    Output(&'static str, i64),
    /// A text that was sent to the controller.
    Sent(String),
}

/// Record of a played dialogue.
#[derive(Default)]
pub struct Played {
    /// Time in us, and deed.
    pub deeds: Vec<(u64, Deed)>,
    pub net: [i64; 3],
    pub pulses: [u64; 3],
    /// Time of the first and of the last step, us.
    pub steps_us: Option<[u64; 2]>,
    /// Highest rate over eight steps of each axis, steps/s.
    pub peak: [f64; 3],
    /// A reply that did not come.
    pub missing: Option<String>,
}

pub struct Player {
    emulated: Emulated<Grbl, GrblRig>,
    options: GrblOptions,
    /// Time of the last power-on, us.
    base_us: u64,
    now_us: u64,
    /// Bytes that the controller has not received yet.
    there: VecDeque<(u64, u8)>,
    free_us: u64,
    partial: Vec<u8>,
    answers: usize,
    last_us: u64,
    recent: [VecDeque<u64>; 3],
    played: Played,
    /// A toggled input is closed.
    toggled: bool,
}

fn number(record: &Value, key: &str) -> f64 {
    record[key].as_f64().unwrap_or(0.0)
}

fn us(ms: f64) -> u64 {
    (ms * 1000.0).round() as u64
}

fn options(build: &str) -> GrblOptions {
    match build {
        "options" => GrblOptions {
            has_mist: true,
            homes_axes: true,
            has_door: true,
            reports_lines: true,
            most_steps_per_s: Some(30_000),
            ..GrblOptions::STOCK
        },
        "grblHAL" => GrblOptions::HAL,
        _ => GrblOptions::STOCK,
    }
}

/// Bytes of a recorded text: one per character.
fn bytes(text: &str) -> Vec<u8> {
    text.chars().map(|character| character as u8).collect()
}

impl Player {
    pub fn play(records: &[Value]) -> Played {
        let header = &records[0];
        let options = options(header["build"].as_str().unwrap_or("grblHAL"));
        let memory = (header["start"] == "factory").then_some(GrblMemory::FACTORY);
        let mut player = Player {
            emulated: Emulated::new(Grbl::new(options, memory.as_ref()), vec![GrblRig::new()]),
            options,
            base_us: 0,
            now_us: 0,
            there: VecDeque::new(),
            free_us: 0,
            partial: Vec::new(),
            answers: 0,
            last_us: 0,
            recent: Default::default(),
            played: Played::default(),
            toggled: false,
        };
        let mut is_on = false;
        let mut done_us = 0;
        let mut asked_us = None;
        let mut last_ms = 0.0;
        for (last, record) in records.iter().zip(&records[1..]) {
            last_ms = last["t_ms"].as_f64().unwrap_or(last_ms);
            if record["power"] == "on" {
                if is_on {
                    player.cycle_power();
                }
                is_on = true;
                player.run_until(player.now_us + 600_000);
                done_us = player.now_us;
            } else if let Some(text) = record["send"].as_str() {
                let bytes = bytes(text);
                let at_us = match record["after"].as_str() {
                    Some("ms") => done_us + us(number(record, "ms")),
                    Some("reply") => {
                        let polite = asked_us.map_or(0, |at| at + 14_000);
                        (done_us + 2000).max(polite)
                    }
                    _ => player.now_us,
                };
                player.run_until(at_us);
                let sent = Deed::Sent(text.to_owned());
                player.played.deeds.push((at_us, sent));
                player.send(&bytes);
                if bytes.contains(&b'?') {
                    asked_us = Some(player.now_us);
                }
                if record["after"] == "reply" {
                    let ends = bytes.iter().filter(|byte| matches!(byte, b'\n' | b'\r'));
                    let wanted = player.answers + ends.count();
                    player.await_answers(wanted, text);
                }
                done_us = player.now_us;
            } else if let Some(lines) = record["stream"].as_array() {
                player.stream(lines, number(record, "max_unacknowledged") as usize);
                done_us = player.now_us;
            } else if record["wait"] == "quiet" {
                let quiet_us = us(number(record, "quiet_ms"));
                let limit_us = player.now_us + PATIENCE_US;
                player.last_us = player.now_us;
                while player.now_us < player.last_us + quiet_us && player.now_us < limit_us {
                    player.run_until(player.now_us + 1000);
                }
                done_us = player.now_us;
            } else if let Some(wait) = record["wait_ms"].as_f64() {
                player.run_until(player.now_us.max(done_us) + us(wait));
                done_us = player.now_us;
            } else if let Some(name) = record["pin"].as_str() {
                if record["after"] == "ms" {
                    player.run_until(done_us + us(number(record, "ms")));
                }
                let pin = player.pin(name);
                let is_high = record["level"] == 1;
                player.rig().set_level(pin, is_high);
                player.run_until(player.now_us + 1);
                done_us = player.now_us;
            } else if let Some(name) = record["pin_toggled"].as_str() {
                player.run_until(player.now_us + us(number(record, "t_ms") - last_ms));
                let pin = player.pin(name);
                let closed = player.toggled;
                player.toggled = !closed;
                player.rig().set_level(pin, closed);
                player.run_until(player.now_us + 1);
                done_us = player.now_us;
            } else if let Some(name) = record["switch"].as_str() {
                let switch = SlideSwitch {
                    pin: player.pin(name),
                    axis: "XYZ".find(record["axis"].as_str().unwrap()).unwrap(),
                    at_steps: (number(record, "closes_at_mm") * 250.0).round() as i64,
                    is_above: record["side"] == "ge",
                    closed_level: record["closed_level"] == 1,
                };
                player.rig().add_switch(switch);
            }
        }
        // Replies that are under way.
        player.run_until(player.now_us + 30_000);
        let rig = player.rig();
        let (net, pulses) = (rig.steps(), rig.pulses());
        Played {
            net,
            pulses,
            ..player.played
        }
    }

    fn rig(&mut self) -> &mut GrblRig {
        self.emulated.plant_mut(0).unwrap()
    }

    fn pin(&self, name: &str) -> GrblPin {
        match name {
            "limit_x" => GrblPin::Limit(0),
            "limit_y" => GrblPin::Limit(1),
            "limit_z" => GrblPin::Limit(2),
            "probe" => GrblPin::Probe,
            "reset" => GrblPin::Reset,
            "feed_hold" if self.options.has_door => GrblPin::Door,
            "feed_hold" => GrblPin::Hold,
            _ => GrblPin::Start,
        }
    }

    /// Off for 50 ms. What was stored is kept, as its stored form.
    fn cycle_power(&mut self) {
        self.run_until(self.now_us + 15_000);
        let stored = self.emulated.controller().memory().to_bytes();
        let memory = GrblMemory::from_bytes(&stored);
        let rig = self.rig().clone();
        self.now_us += 50_000;
        self.base_us = self.now_us;
        self.there.clear();
        self.partial.clear();
        self.emulated = Emulated::new(Grbl::new(self.options, memory.as_ref()), vec![rig]);
    }

    /// Sends bytes, and waits until the last one has arrived.
    fn send(&mut self, bytes: &[u8]) {
        for byte in bytes {
            let last = self.there.back().map_or(0, |(at, _)| *at);
            self.there
                .push_back((last.max(self.now_us) + BYTE_US, *byte));
        }
        let arrival = self.there.back().map_or(0, |(at, _)| *at);
        self.run_until(arrival);
    }

    fn await_answers(&mut self, wanted: usize, text: &str) {
        let limit_us = self.now_us + PATIENCE_US;
        while self.answers < wanted {
            if self.now_us > limit_us {
                self.played.missing.get_or_insert_with(|| text.to_owned());
                // The following lines count from here.
                self.answers = wanted;
                return;
            }
            self.run_until(self.now_us + 500);
        }
    }

    fn stream(&mut self, lines: &[Value], most: usize) {
        let mut sent = VecDeque::new();
        let mut answered = self.answers;
        for line in lines {
            let bytes = bytes(line.as_str().unwrap());
            loop {
                while answered < self.answers {
                    answered += 1;
                    sent.pop_front();
                }
                if sent.iter().sum::<usize>() + bytes.len() <= most {
                    break;
                }
                self.run_until(self.now_us + 100);
            }
            sent.push_back(bytes.len());
            self.send(&bytes);
        }
        let left = sent.len() - (self.answers - answered);
        self.await_answers(self.answers + left, "stream");
    }

    fn run_until(&mut self, end_us: u64) {
        while self.now_us < end_us {
            let mut next_us = end_us.min(self.now_us + 1000);
            if let Some((at_us, _)) = self.there.front() {
                next_us = next_us.min((*at_us).max(self.now_us));
            }
            if self.free_us > self.now_us {
                next_us = next_us.min(self.free_us);
            }
            self.pass(next_us - self.now_us);
            self.now_us = next_us;
            while self.there.front().is_some_and(|(at, _)| *at <= next_us) {
                let (_, byte) = self.there.pop_front().unwrap();
                self.emulated.receive(byte);
            }
            while self.free_us <= self.now_us {
                let Some(byte) = self.emulated.transmit() else {
                    break;
                };
                self.free_us = self.now_us + BYTE_US;
                self.take(byte);
            }
        }
    }

    fn pass(&mut self, us: u64) {
        let (played, recent, base_us) = (&mut self.played, &mut self.recent, self.base_us);
        let last_us = &mut self.last_us;
        self.emulated.pass(us, |_, at_us, event, _| {
            let at_us = base_us + at_us;
            let output = match *event {
                GrblEvent::Step { delta, .. } => {
                    *last_us = at_us;
                    let first = played.steps_us.map_or(at_us, |[first, _]| first);
                    played.steps_us = Some([first, at_us]);
                    for (axis, delta) in delta.iter().enumerate() {
                        if *delta != 0 {
                            count(&mut recent[axis], at_us, &mut played.peak[axis]);
                        }
                    }
                    return;
                }
                GrblEvent::Disable { is_high } => ("stepper_disable", is_high.into()),
                GrblEvent::SpindleDirection { is_high } => ("spindle_dir", is_high.into()),
                GrblEvent::SpindleDuty { duty } => ("spindle_pwm", duty.into()),
                GrblEvent::Flood { is_on } => ("flood", is_on.into()),
                GrblEvent::Mist { is_on } => ("mist", is_on.into()),
                GrblEvent::Wait { .. } | GrblEvent::Store => return,
            };
            played.deeds.push((at_us, Deed::Output(output.0, output.1)));
        });
    }

    fn take(&mut self, byte: u8) {
        self.partial.push(byte);
        if byte != b'\n' {
            return;
        }
        let line = String::from_utf8(std::mem::take(&mut self.partial)).unwrap();
        if line == "ok\r\n" || line.starts_with("error:") {
            self.answers += 1;
        }
        self.last_us = self.now_us;
        self.played.deeds.push((self.free_us, Deed::Line(line)));
    }
}

fn count(recent: &mut VecDeque<u64>, at_us: u64, peak: &mut f64) {
    recent.push_back(at_us);
    if recent.len() > 8 {
        let first = recent.pop_front().unwrap();
        *peak = peak.max(8e6 / (at_us - first).max(1) as f64);
    }
}
