//! A measuring machine with one axis and its faults, without and with end switches.

use super::{Bench, Fault, State, Subject};
use husillo_metrology::Error;
use husillo_metrology::heads::{Head, Line, Machine, Port, Prober, Wiring};
use husillo_metrology::simulated::{SimulatedNetwork, SimulatedPort, one_axis};
use husillo_probe::UnitVector;
use husillo_sim::device::{Emulation, LineFault};
use husillo_transports::nmc::{Baud, Timing};
use std::cell::RefCell;
use std::io;
use std::rc::Rc;

/// Module of the axis.
const MODULE: usize = 1;
/// Counts of one revolution. Each revolution has an index.
const TURN: i64 = 400;
/// The counts of a short move, and of a long one.
const SHORT: i64 = 40;
const LONG: i64 = 2800;
/// A face in front of the probe.
const FACE: &str = "1:3018";
/// The end switches. Both are on one input of the module. The high one is at a position before the
/// end of the probe's over-travel.
const ENDS: [&str; 2] = ["1:..-600", "1:3100"];
/// The mechanical ends beyond them.
const STOPS: [i64; 2] = [-640, 3140];
/// Time without power during a reset, us.
const OUTAGE_US: u64 = 100_000;

/// The simulated line, and the lines of the panel that are due.
struct SimulatedLine {
    port: SimulatedPort,
    due: Vec<(u64, String)>,
    is_plugged: bool,
    counts: i64,
    /// The position after the last motion by more than four counts, and the time of that motion.
    rested: i64,
    moved_us: u64,
    /// Positions of the mechanical ends. The axis stays at an end until the fault is repaired.
    stops: Option<[i64; 2]>,
}

impl SimulatedLine {
    /// Simulates one period of the servos.
    fn tick(&mut self) -> Vec<u8> {
        let now_us = self.port.elapsed_us();
        let is_due = |(at_us, _): &mut (u64, String)| *at_us <= now_us;
        let due: Vec<_> = self.due.extract_if(.., is_due).collect();
        for (_, line) in due {
            match &*line {
                "plug" | "unplug" => self.is_plugged = line == "plug",
                "reset" => {
                    self.port.network.control("power off");
                    self.due.push((now_us + OUTAGE_US, "power on".into()));
                }
                // The operator turns the axis away from its mechanical end.
                "turn" => {
                    self.stops = None;
                    self.port.network.block(MODULE, false);
                }
                line => drop(self.port.network.control(line)),
            }
        }
        let bytes = self.port.receive(1).unwrap();
        let counts = self.port.network.motor(MODULE).unwrap().counts();
        self.counts = counts;
        // A held axis creeps by a few counts.
        if counts.abs_diff(self.rested) > 4 {
            self.rested = counts;
            self.moved_us = self.port.elapsed_us();
        }
        if (self.stops).is_some_and(|[low, high]| counts <= low || counts >= high) {
            self.port.network.block(MODULE, true);
        }
        if self.is_plugged { bytes } else { Vec::new() }
    }
}

/// The port of a head on the shared line.
#[derive(Clone)]
struct Shared(Rc<RefCell<SimulatedLine>>);

impl Port for Shared {
    fn timing(&self, baud: Baud) -> Timing {
        self.0.borrow().port.timing(baud)
    }

    fn elapsed_us(&self) -> u64 {
        self.0.borrow().port.elapsed_us()
    }

    fn set_baud(&mut self, baud: Baud) -> io::Result<()> {
        self.0.borrow_mut().port.set_baud(baud)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut bench = self.0.borrow_mut();
        match bench.is_plugged {
            true => bench.port.send(bytes),
            false => Ok(()),
        }
    }

    fn receive(&mut self, wait_us: u32) -> io::Result<Vec<u8>> {
        let mut bench = self.0.borrow_mut();
        let end_us = bench.port.elapsed_us() + u64::from(wait_us.max(1));
        while bench.port.elapsed_us() < end_us {
            let bytes = bench.tick();
            if !bytes.is_empty() {
                return Ok(bytes);
            }
        }
        Ok(Vec::new())
    }
}

impl Bench for Shared {
    fn schedule(&mut self, after_ms: u64, line: &str) {
        let mut line_of = self.0.borrow_mut();
        let at_us = line_of.port.elapsed_us() + after_ms * 1000;
        line_of.due.push((at_us, line.to_owned()));
    }

    /// The tests of this line's protocol disturb its bytes, so this does nothing.
    fn disturb(&mut self, _: Option<(u64, LineFault)>) {}

    fn pass(&mut self, ms: u64) {
        let end_us = self.elapsed_us() + ms * 1000;
        while self.elapsed_us() < end_us {
            self.0.borrow_mut().tick();
        }
    }

    fn now_ms(&self) -> u64 {
        self.elapsed_us() / 1000
    }

    fn last_step_ms(&mut self) -> u64 {
        self.0.borrow().moved_us / 1000
    }
}

/// With end switches, home is at the low one.
pub struct Cmm<const HAS_ENDS: bool> {
    head: Head<Shared>,
    bench: Shared,
}

fn machine(has_ends: bool) -> Machine {
    let mut machine = one_axis();
    if has_ends {
        machine.axes[0].limits = [Wiring::Probe, Wiring::Ends];
    }
    machine
}

fn switched_on(bench: &Shared, has_ends: bool) -> Result<Head<Shared>, Error> {
    Head::start(Line::new(bench.clone()), &machine(has_ends), 1)
}

fn begun(bench: &Shared, has_ends: bool) -> Result<Head<Shared>, Error> {
    let mut head = switched_on(bench, has_ends)?;
    // With an end switch, home is found from any position, unless the probe touches.
    if has_ends && head.home(0).is_ok() {
        head.go_to([SHORT, 0, 0])?;
        return Ok(head);
    }
    // The operator moves back from the face slowly. At first the probe may touch once more.
    for _ in 0..4 {
        let _ = head.jog(0, false, 3.0, true);
    }
    head.home(0)?;
    head.go_to([SHORT, 0, 0])?;
    Ok(head)
}

/// The faults of a machine without end switches.
const FAULTS: &[Fault] = &[
    LINE,
    RESET,
    POWER,
    CONTACT_OPEN,
    CONTACT_CLOSED,
    ENCODER,
    MOTOR,
];
/// The faults of a machine with end switches. The operator turns an axis by hand if it was at its
/// mechanical end.
const FAULTS_WITH_ENDS: &[Fault] = &[
    LINE,
    RESET,
    POWER,
    CONTACT_OPEN,
    CONTACT_CLOSED,
    Fault::new(
        "end switch stuck open",
        "open end 1",
        &["free end 1", "turn"],
    ),
    Fault::new("end switch stuck closed", "close end 1", &["free end 1"]),
    Fault {
        ends: &["encoder 1 on", "turn"],
        ..ENCODER
    },
    Fault {
        ends: &["unblock 1", "turn"],
        ..MOTOR
    },
];
const CONTACT_OPEN: Fault = Fault::new("contact stuck open", "open probe", &["free probe"]);
const CONTACT_CLOSED: Fault =
    Fault::new("contact stuck closed", "close probe", &["free probe"]).ends_within(1000);
/// The time to the limit of the position error at the slowest rate.
const ENCODER: Fault =
    Fault::new("encoder silent", "encoder 1 off", &["encoder 1 on"]).ends_within(11_000);
const MOTOR: Fault = Fault::new("motor stalled", "block 1", &["unblock 1"]).ends_within(1000);
/// The move ends at its goal.
const LINE: Fault = Fault::new("host killed, cable pulled", "unplug", &["plug"]);
/// Without a drive the axis coasts.
const RESET: Fault = Fault::new("module reset", "reset", &["plug"]).ends_within(300);
const POWER: Fault = Fault::new("power lost", "power off", &["power on"]).ends_within(300);

impl<const HAS_ENDS: bool> Subject for Cmm<HAS_ENDS> {
    const MACHINE: &'static str = match HAS_ENDS {
        true => "Measuring machine with end switches",
        false => "Measuring machine",
    };
    const REST_MS: u64 = 20_000;
    const STATES: &'static [(State, u64)] = &[
        (State::Idle, 0),
        (State::FirstHoming, 700),
        (State::Homing, 700),
        (State::Jog, 800),
        (State::Program, 1000),
        (State::Guarded, 1500),
        (State::Probing, 6000),
    ];
    const FAULTS: &'static [Fault] = match HAS_ENDS {
        true => FAULTS_WITH_ENDS,
        false => FAULTS,
    };

    fn new(state: State) -> Self {
        let contacts = [FACE.parse().unwrap()];
        let network = SimulatedNetwork::of_machine(&machine(HAS_ENDS), &contacts, None).unwrap();
        let ends = ENDS.map(|end| end.parse().unwrap());
        let network = match HAS_ENDS {
            true => network.with_ends(&ends).unwrap(),
            false => network,
        };
        let bench = Shared(Rc::new(RefCell::new(SimulatedLine {
            port: SimulatedPort::new(network),
            due: Vec::new(),
            is_plugged: true,
            counts: 0,
            rested: 0,
            moved_us: 0,
            stops: HAS_ENDS.then_some(STOPS),
        })));
        let head = match state {
            State::FirstHoming => switched_on(&bench, HAS_ENDS),
            _ => begun(&bench, HAS_ENDS),
        };
        Self {
            head: head.unwrap(),
            bench,
        }
    }

    fn bench(&mut self) -> &mut dyn Bench {
        &mut self.bench
    }

    fn act(&mut self, state: State) -> Result<String, String> {
        let done = match state {
            State::Idle => self.head.go_to([2 * SHORT, 0, 0]).map(drop),
            State::FirstHoming | State::Homing => self.head.home(0),
            State::Jog => self.head.jog(0, true, 2.0, false),
            State::Program => self.head.go_to([LONG, 0, 0]).map(drop),
            State::Guarded => self.head.guarded_to([LONG, 0, 0]).map(drop),
            State::Probing => self.head.touch(&UnitVector::X, 4000).map(drop),
        };
        done.map(|()| "done".into())
            .map_err(|error| error.to_string())
    }

    fn is_true(&mut self) -> bool {
        let Ok([position, ..]) = self.head.position() else {
            return true; // it reports that it does not know
        };
        // Home is at an index, so only the position within a revolution is compared.
        let counts = self.bench.0.borrow().counts;
        let off = (counts - position).rem_euclid(TURN);
        off.min(TURN - off) <= 2
    }

    fn begin_again(mut self) -> Result<(Self, String), String> {
        self.head = begun(&self.bench, HAS_ENDS).map_err(|error| error.to_string())?;
        Ok((self, "homed".into()))
    }
}
