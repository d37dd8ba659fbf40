//! Any bytes on the project's own link, and any faults between its ends.

use husillo_transports::link::{Event, Master, Received, Receiver, Station, Timing};

use crate::bytes::Bytes;

const TIMING: Timing = Timing::of(115_200);

/// A master and two stations in virtual time, on a line that loses, adds and changes bytes; and the
/// bytes themselves as frames.
///
/// - A station receives the beginning of what was sent since its call, once and in order. When it
///   goes down, at most one payload is in doubt.
/// - A broadcast is received at most once by each station, and by all that are not named in the
///   check.
/// - A frame that was accepted can be written.
pub fn link(data: &[u8]) {
    let mut receiver = Receiver::new();
    for byte in data {
        if let Some(frame) = receiver.push(*byte) {
            assert!(frame.encode().is_some());
        }
    }
    let mut bytes = Bytes::new(data);
    let mut bus = Bus::new(bytes.i32() as u32);
    for _ in 0..300 {
        if bytes.is_empty() {
            break;
        }
        bus.act(&mut bytes);
        let fault = bytes.byte();
        for character in 0..16_u8 {
            bus.pass(fault, character);
            bus.poll();
            assert!(bus.heard.iter().all(|heard| *heard <= 1));
        }
    }
}

/// The line with its ends, and what each of them has sent and received.
struct Bus {
    now_us: u32,
    master: Master<2>,
    stations: [Station; 2],
    /// Payloads for each station since its last call.
    sent: [Vec<Vec<u8>>; 2],
    /// Payloads that each station has received.
    got: [Vec<Vec<u8>>; 2],
    was_up: [bool; 2],
    /// How often each station has received the last broadcast.
    heard: [u32; 2],
    /// Number of broadcasts.
    shouts: u32,
    /// Stations that need not receive the last broadcast.
    named: [bool; 2],
}

impl Bus {
    fn new(now_us: u32) -> Self {
        Self {
            now_us,
            master: Master::new(TIMING, [1, 2]),
            stations: [1, 2].map(|address| Station::new(address, TIMING)),
            sent: [const { Vec::new() }; 2],
            got: [const { Vec::new() }; 2],
            was_up: [false; 2],
            heard: [0; 2],
            shouts: 0,
            named: [false; 2],
        }
    }

    /// Sends, calls, or restarts a station.
    fn act(&mut self, bytes: &mut Bytes<'_>) {
        let act = bytes.byte();
        let place = usize::from(act & 1);
        match act >> 1 & 7 {
            0 => {
                let payload = vec![act; usize::from(bytes.byte() % 8)];
                if self.master.send(place, &payload).is_ok() {
                    self.sent[place].push(payload);
                }
            }
            1 => {
                let is_up = [0, 1].map(|station| self.master.is_up(station));
                if self.master.broadcast(&[act]).is_ok() {
                    self.shouts += 1;
                    (self.heard, self.named) = ([0; 2], is_up.map(|is_up| !is_up));
                }
            }
            2 => {
                self.master.call(place).expect("it is a station");
                (self.named[place], self.was_up[place]) = (true, false);
                self.sent[place].clear();
            }
            3 => {
                // A restarted station accepts nothing until it is called again.
                self.stations[place] = Station::new(place as u8 + 1, TIMING);
            }
            _ => {}
        }
    }

    /// The time of a character passes. What is on the line arrives, as far as the fault permits.
    fn pass(&mut self, fault: u8, character: u8) {
        self.now_us = self.now_us.wrapping_add(TIMING.character_us);
        let mut spoken = Vec::new();
        spoken.extend(self.master.transmit(self.now_us).map(|byte| (2, byte)));
        for (place, station) in self.stations.iter_mut().enumerate() {
            spoken.extend(station.transmit(self.now_us).map(|byte| (place, byte)));
        }
        for (speaker, byte) in spoken {
            let carried = match fault {
                0 => vec![],
                64..=79 if fault % 16 == character => vec![],
                80..=95 if fault % 16 == character => vec![byte, byte],
                96..=223 if fault % 16 == character => vec![byte ^ 1 << (fault / 16 % 8)],
                _ => vec![byte],
            };
            for byte in carried {
                self.arrive(speaker, byte);
            }
        }
    }

    /// A byte arrives at all ends but the one that sent it.
    fn arrive(&mut self, speaker: usize, byte: u8) {
        let told = match speaker {
            2 => None,
            _ => self.master.push(byte, self.now_us),
        };
        match told {
            Some(Event::Up { station }) => self.was_up[station] = true,
            Some(Event::Down {
                station,
                unacknowledged,
                ..
            }) => {
                check(&self.sent[station], &self.got[station], unacknowledged);
                (self.named[station], self.was_up[station]) = (true, false);
            }
            _ => {}
        }
        for (place, station) in self.stations.iter_mut().enumerate() {
            match station.push(byte, self.now_us) {
                Some(Received::Data(payload)) => self.got[place].push(payload.to_vec()),
                Some(Received::Broadcast(_)) => self.heard[place] += 1,
                // Data in flight at the time of the call belongs to the time before.
                Some(Received::Up) => self.got[place].clear(),
                None => {}
            }
        }
    }

    /// Checks what the master reports without a byte.
    fn poll(&mut self) {
        while let Some(event) = self.master.poll(self.now_us) {
            match event {
                Event::Down {
                    station,
                    unacknowledged,
                    ..
                } => {
                    if self.was_up[station] {
                        check(&self.sent[station], &self.got[station], unacknowledged);
                    }
                    (self.named[station], self.was_up[station]) = (true, false);
                }
                Event::Missed { station } => self.named[station] = true,
                Event::Checked => {
                    for (heard, named) in self.heard.iter().zip(&self.named) {
                        assert!(*named || *heard == 1, "{}", self.shouts);
                    }
                }
                Event::Up { .. } | Event::Data { .. } => unreachable!("these come with bytes"),
            }
        }
    }
}

fn check(sent: &[Vec<u8>], got: &[Vec<u8>], in_doubt: usize) {
    assert!(got.len() <= sent.len() && sent.len() <= got.len() + in_doubt);
    assert_eq!(*got, sent[..got.len()]);
}
