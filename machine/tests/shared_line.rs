//! Three machines on one half-duplex line. Their queues are filled through `transports::link`, and
//! a broadcast starts them together.

mod common;

use std::iter;

use husillo_machine::{Config, Event, Machine, Refused};
use husillo_transports::link::{Event as Told, Master, Received, Station, Timing};

/// More retries than usual: three damaged exchanges in a row do occur on a line as bad as that of
/// the test below.
const TIMING: Timing = Timing {
    tries: 8,
    ..Timing::of(115_200)
};

/// A machine without backlash, fast enough for tests.
fn config() -> Config<3> {
    let mut config = common::config();
    for axis in &mut config.axes {
        (axis.backlash_steps, axis.max_rate_hz) = (0, 5_000);
    }
    config
}

/// One controller. A payload is a line of G-code; answers are `k` taken, `b` busy, `r` refused. `~`
/// starts, `!` holds.
struct Controller {
    station: Station,
    machine: Machine<3>,
    /// End of the last event.
    free_us: u64,
    steps: Vec<[i8; 3]>,
    started_us: Option<u64>,
}

impl Controller {
    fn new(address: u8) -> Controller {
        let mut machine = Machine::new(config());
        machine.hold();
        Controller {
            station: Station::new(address, TIMING),
            machine,
            free_us: 0,
            steps: Vec::new(),
            started_us: None,
        }
    }

    fn push(&mut self, byte: u8, now_us: u64) {
        let answer = match self.station.push(byte, now_us as u32) {
            None => return,
            // The master has restarted; it has to repeat its commands.
            Some(Received::Up) => return self.machine.hold(),
            Some(Received::Broadcast(b"~")) => {
                self.free_us = now_us;
                self.started_us.get_or_insert(now_us);
                return self.machine.resume();
            }
            Some(Received::Broadcast(_)) => return self.machine.hold(),
            Some(Received::Data(line)) => match self.machine.line(line) {
                Ok(()) => b"k",
                Err(Refused::Busy) => b"b",
                Err(_) => b"r",
            },
        };
        // One answer per question, so there is room.
        self.station.send(answer).unwrap();
    }

    fn tick(&mut self, now_us: u64) {
        if self.station.poll(now_us as u32).is_some() {
            self.machine.hold();
        }
        while self.free_us <= now_us {
            match self.machine.next_event() {
                Some(Event::Step(step)) => {
                    self.free_us += u64::from(step.wait_ticks);
                    self.steps.push(step.delta);
                }
                Some(_) => {}
                None => return,
            }
        }
    }
}

/// The steps of a program run without the serial line.
fn alone(lines: &[String]) -> Vec<[i8; 3]> {
    let mut machine: Machine<3> = Machine::new(config());
    let mut steps = Vec::new();
    for line in lines {
        machine.line(line.as_bytes()).unwrap();
        steps.extend(
            iter::from_fn(|| machine.next_event()).filter_map(|event| match event {
                Event::Step(step) => Some(step.delta),
                _ => None,
            }),
        );
    }
    steps
}

/// A program of short moves for the n-th machine, more than its queue holds.
fn program(n: usize) -> Vec<String> {
    let at = |k: usize| format!("G1 X{}.{:03} Y0.0{:02} F30", 0, 2 * k + n, (k * 7) % 40);
    (0..40).map(at).collect()
}

/// Runs the three programs over a line that applies `fault` to each byte on its way to a receiver.
/// Returns the controllers and the number of broadcasts that were needed.
fn run(mut fault: impl FnMut(u8) -> Vec<u8>) -> ([Controller; 3], Vec<usize>) {
    let mut master = Master::new(TIMING, [1, 2, 3]);
    let mut controllers = [1, 2, 3].map(Controller::new);
    let programs = [0, 1, 2].map(program);
    (0..3).for_each(|station| master.call(station).unwrap());
    let (mut next, mut asked) = ([0; 3], [false; 3]);
    let (mut is_started, mut missed) = (false, Vec::new());
    let mut is_full = [false; 3];
    for character in 0..1_000_000_u64 {
        let now_us = character * u64::from(TIMING.character_us);
        let mut spoken = Vec::new();
        spoken.extend(master.transmit(now_us as u32).map(|byte| (3, byte)));
        for (place, controller) in controllers.iter_mut().enumerate() {
            spoken.extend(
                controller
                    .station
                    .transmit(now_us as u32)
                    .map(|byte| (place, byte)),
            );
        }
        assert!(spoken.len() < 2, "two speak at once");
        for (speaker, byte) in spoken {
            for (place, controller) in controllers.iter_mut().enumerate() {
                if place != speaker {
                    fault(byte)
                        .into_iter()
                        .for_each(|byte| controller.push(byte, now_us));
                }
            }
            for byte in if speaker == 3 { vec![] } else { fault(byte) } {
                match master.push(byte, now_us as u32) {
                    Some(Told::Data { station, payload }) => {
                        asked[station] = false;
                        is_full[station] |= payload == b"b";
                        next[station] += usize::from(payload == b"k");
                        assert_ne!(payload, b"r");
                    }
                    Some(Told::Down { .. }) => panic!("down"),
                    _ => {}
                }
            }
        }
        while let Some(told) = master.poll(now_us as u32) {
            match told {
                Told::Missed { station } => missed.push(station),
                Told::Checked => {}
                _ => panic!("{told:?}"),
            }
        }
        for station in 0..3 {
            if let (Some(line), false) = (programs[station].get(next[station]), asked[station]) {
                asked[station] = master.send(station, line.as_bytes()).is_ok();
            }
        }
        if !is_started && is_full == [true; 3] {
            is_started = master.broadcast(b"~").is_ok();
        }
        controllers
            .iter_mut()
            .for_each(|controller| controller.tick(now_us));
        let is_done =
            |place: usize| controllers[place].steps.len() == alone(&programs[place]).len();
        if character % 10_000 == 0 && next == [40; 3] && (0..3).all(is_done) {
            break;
        }
    }
    (controllers, missed)
}

#[test]
fn three_machines_are_fed_and_started_together() {
    let (controllers, missed) = run(|byte| vec![byte]);
    assert!(
        controllers
            .iter()
            .all(|controller| controller.steps.len() > 500)
    );
    assert!(missed.is_empty());
    for (place, controller) in controllers.iter().enumerate() {
        assert!(
            controller.steps == alone(&program(place)),
            "machine {place}"
        );
    }
    // All of them received the last byte of the broadcast at the same time.
    let started = controllers.map(|controller| controller.started_us.unwrap());
    assert_eq!(started, [started[0]; 3]);
}

/// One byte in two thousand is lost, doubled or changed at each receiver. Every line is executed
/// exactly once.
#[test]
fn a_bad_line_makes_them_slower_and_nothing_else() {
    let mut random = 0x9E37_79B9_7F4A_7C15_u64;
    let (controllers, missed) = run(|byte| {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        match random % 16_000 {
            0 => vec![],
            1 => vec![byte, byte],
            bit @ 2..8 => vec![byte ^ 1 << bit],
            _ => vec![byte],
        }
    });
    for (place, controller) in controllers.iter().enumerate() {
        let is_deaf = missed.contains(&place);
        let expected = if is_deaf {
            vec![]
        } else {
            alone(&program(place))
        };
        assert!(controller.steps == expected, "machine {place}");
    }
}
