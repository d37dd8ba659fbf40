//! One master and three stations on a half-duplex line, with the link of husillo.

use husillo_transports::link::{Event, Master, Received, Station, Timing};

const ADDRESSES: [u8; 3] = [1, 2, 9];

/// The line: a byte arrives at every other end at the same time.
struct Line {
    master: Master<3>,
    stations: [Station; 3],
    now_us: u32,
    /// A station that hears nothing.
    deaf: Option<usize>,
    log: Vec<String>,
}

impl Line {
    fn new() -> Self {
        // ANCHOR: ends
        let timing = Timing::of(115_200);
        Line {
            master: Master::new(timing, ADDRESSES),
            stations: ADDRESSES.map(|address| Station::new(address, timing)),
            // ANCHOR_END: ends
            now_us: 0,
            deaf: None,
            log: Vec::new(),
        }
    }

    /// The loop of the master and of each station, in steps of one character.
    fn run(&mut self, milliseconds: u32) {
        let character_us = Timing::of(115_200).character_us;
        let end_us = self.now_us + 1000 * milliseconds;
        while self.now_us < end_us {
            self.now_us += character_us;
            // ANCHOR: master
            // The master: a byte to send, and events that are due because of the time.
            let byte = self.master.transmit(self.now_us);
            while let Some(event) = self.master.poll(self.now_us) {
                self.log.push(shown(event));
            }
            // ANCHOR_END: master
            if let Some(byte) = byte {
                for number in 0..3 {
                    self.hear(number, byte);
                }
            }
            // ANCHOR: station
            // A station: a byte to send, and whether the master is still there.
            for number in 0..3 {
                let station = &mut self.stations[number];
                let byte = station.transmit(self.now_us);
                if let Some(lost) = station.poll(self.now_us) {
                    self.log
                        .push(format!("station {number}: {lost:?}, stop the machine"));
                }
                // ANCHOR_END: station
                let Some(byte) = byte else { continue };
                if let Some(event) = self.master.push(byte, self.now_us) {
                    self.log.push(shown(event));
                }
                for other in (0..3).filter(|other| *other != number) {
                    self.hear(other, byte);
                }
            }
        }
    }

    fn hear(&mut self, number: usize, byte: u8) {
        if self.deaf == Some(number) {
            return;
        }
        // ANCHOR: received
        let station = &mut self.stations[number];
        let order = match station.push(byte, self.now_us) {
            Some(Received::Data(payload)) => Some(payload.to_vec()),
            Some(Received::Broadcast(payload)) => {
                self.log
                    .push(format!("station {number}: all do {}", text(payload)));
                None
            }
            Some(Received::Up) | None => None,
        };
        if let Some(order) = order {
            self.log.push(format!("station {number}: {}", text(&order)));
            // The answer waits until the master asks.
            station.send(b"done").expect("the last answer is fetched");
        }
        // ANCHOR_END: received
    }

    fn print(&mut self, heading: &str) {
        println!("{heading}");
        self.log.drain(..).for_each(|line| println!("  {line}"));
    }
}

fn text(payload: &[u8]) -> String {
    String::from_utf8_lossy(payload).into_owned()
}

fn shown(event: Event<'_>) -> String {
    match event {
        Event::Data { station, payload } => format!("from station {station}: {}", text(payload)),
        other => format!("{other:?}"),
    }
}

fn main() -> Result<(), husillo_transports::link::Refused> {
    let mut line = Line::new();
    // ANCHOR: use
    for station in 0..3 {
        line.master.call(station)?;
    }
    line.run(100);
    line.print("called:");

    for (station, order) in [b"load A", b"load B", b"load C"].iter().enumerate() {
        line.master.send(station, *order)?;
    }
    line.run(200);
    line.print("an order for each:");

    line.master.broadcast(b"start")?;
    line.run(200);
    line.print("all at once:");
    // ANCHOR_END: use

    // ANCHOR: deaf
    line.deaf = Some(1);
    line.master.broadcast(b"go on")?;
    line.run(1500);
    line.print("station 1 is unplugged:");
    // ANCHOR_END: deaf
    let up = [0, 1, 2].map(|station| line.master.is_up(station));
    assert_eq!(up, [true, false, true]);
    Ok(())
}
