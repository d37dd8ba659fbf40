//! Sessions on a bad line: every move and every touch is right, or an error is reported.

use super::line::Line;
use super::machine::Machine;
use super::port::Port as _;
use crate::error::Error;
use crate::simulated::{Contact, SimulatedNetwork, SimulatedPort, three_axes};
use husillo_probe::UnitVector;
use husillo_sim::{Damage, Noise, Random};
use husillo_transports::nmc::{Baud, Command, Group};
use std::collections::BTreeMap;

type Head = super::Head<SimulatedPort>;

/// Position at which the probe closes, in both directions of every axis, counts.
const FACE: i64 = 3000;

/// Nanometres of a count.
const COUNT: i64 = 2000;

/// Largest error of a result, counts: one as on a good line, and one because a servo may move at
/// rest.
const TOLERANCE: i64 = 2;

/// The results of all sessions.
#[derive(Debug, Default)]
struct Tally {
    seconds: f64,
    sessions: u64,
    moves: u64,
    touches: u64,
    /// Wrong results without an error.
    wrong_moves: u64,
    wrong_touches: u64,
    /// Number of errors by their text.
    reported: BTreeMap<String, u64>,
    damage: Damage,
}

impl Tally {
    fn report(&mut self, error: &Error) {
        let text = error.to_string();
        // Without its numbers.
        let kind: String = text.chars().filter(|sign| !sign.is_ascii_digit()).collect();
        *self.reported.entry(kind).or_default() += 1;
    }

    fn errors(&self) -> u64 {
        self.reported.values().sum()
    }

    /// Number of reported collisions. In these sessions there are no real ones.
    fn collisions(&self) -> u64 {
        let errors = self.reported.iter();
        let collisions = errors.filter(|(words, _)| words.starts_with("collision"));
        collisions.map(|(_, count)| count).sum()
    }

    fn close(&mut self, mut port: SimulatedPort) {
        self.seconds += port.elapsed_us() as f64 * 1e-6;
        self.add_damage(port.network.servo_network().damage());
    }

    fn add_damage(&mut self, damage: Damage) {
        self.damage.wrong_bits += damage.wrong_bits;
        self.damage.replies += damage.replies;
        self.damage.pairs_in_halves += damage.pairs_in_halves;
        self.damage.damaged_replies += damage.damaged_replies;
        self.damage.unseen_replies += damage.unseen_replies;
        self.damage.unseen_commands += damage.unseen_commands;
    }

    /// The sum of both.
    fn and(mut self, other: Self) -> Self {
        self.seconds += other.seconds;
        self.sessions += other.sessions;
        self.moves += other.moves;
        self.touches += other.touches;
        self.wrong_moves += other.wrong_moves;
        self.wrong_touches += other.wrong_touches;
        self.add_damage(other.damage);
        for (words, count) in other.reported {
            *self.reported.entry(words).or_default() += count;
        }
        self
    }
}

/// The machine of three axes with only the first ones.
fn machine(modules: usize, baud: Baud) -> Machine {
    let mut machine = three_axes();
    machine.axes.truncate(modules);
    machine.baud = baud;
    machine
}

fn port(modules: usize, noise: Noise, seed: u64) -> SimulatedPort {
    let faces: Vec<Contact> = (1..=modules)
        .flat_map(|module| [format!("{module}:{FACE}"), format!("{module}:..-{FACE}")])
        .map(|face| face.parse().expect("a face"))
        .collect();
    let network = SimulatedNetwork::new(&vec![4; modules], &faces, None).expect("a network");
    SimulatedPort::new(network.with_faults(noise, seed))
}

/// True position of the motor of a module.
fn truth(port: &mut SimulatedPort, module: u8) -> i64 {
    let motor = port.network.servo_network().motor(usize::from(module - 1));
    motor.expect("a motor").counts()
}

/// True positions of the motors at 0 of the modules. A session may begin anywhere.
fn zeros(head: &mut Head) -> [i64; 3] {
    [0, 1, 2].map(|module| {
        let network = head.line.port().network.servo_network();
        let motor = network.motor(module).map_or(0, |motor| motor.counts());
        motor - i64::from(network.axis(module).map_or(0, |axis| axis.position()))
    })
}

/// The sessions to run.
#[derive(Copy, Clone)]
struct Plan {
    modules: usize,
    noise: Noise,
    /// Largest simulated time in s.
    seconds: f64,
    /// Largest number of sessions.
    sessions: u64,
    seed: u64,
    /// Whether one module fails once in every session.
    has_outages: bool,
}

/// Runs sessions as `husillo measure` does. Each starts the line again and makes a few moves and
/// touches until it is done or an error is reported.
fn sessions(plan: Plan) -> Tally {
    let Plan {
        modules,
        noise,
        seconds,
        ..
    } = plan;
    let mut random = Random::new(plan.seed | 1);
    let mut tally = Tally::default();
    let mut open = None;
    while tally.seconds < seconds && tally.sessions < plan.sessions {
        let mut port = open
            .take()
            .unwrap_or_else(|| port(modules, noise, random.below(1 << 31)));
        tally.sessions += 1;
        let machine = machine(
            modules,
            [Baud::B19200, Baud::B115200][random.below(2) as usize],
        );
        if plan.has_outages {
            let module = random.below(modules as u64) as usize;
            let periods = 1000 + random.below(40_000);
            port.network.interrupt(module, periods);
        }
        let touches = 1 + random.below(2) as u8;
        match Head::start(Line::new(port), &machine, touches) {
            Ok(mut head) => {
                // Homed where it stands, so that it moves at full speed.
                head.axes.iter_mut().for_each(|axis| axis.is_homed = true);
                if let Err(error) = session(&mut head, &mut random, &mut tally) {
                    tally.report(&error);
                }
                let port = head.line.into_port();
                // The next session continues this simulation, for at most an hour.
                let end_us = seconds.min(3600.0) * 1e6;
                if (port.elapsed_us() as f64) < end_us {
                    open = Some(port);
                } else {
                    tally.close(port);
                }
            }
            // The port is lost with the line, so its time does not count.
            Err(error) => tally.report(&error),
        }
    }
    open.into_iter().for_each(|port| tally.close(port));
    tally
}

fn session(head: &mut Head, random: &mut Random, tally: &mut Tally) -> Result<(), Error> {
    let (axes, zeros) = (head.axes.len(), zeros(head));
    for _ in 0..10 {
        let (axis, side) = (
            random.below(axes as u64) as usize,
            [-1, 1][random.below(2) as usize],
        );
        let mut goal = [0; 3];
        for goal in goal.iter_mut().take(axes) {
            *goal = random.below(600) as i64 - 300;
        }
        goal[axis] = side * (FACE - 20 - random.below(100) as i64);
        let of = |counts: [i64; 3]| [0, 1, 2].map(|axis| (counts[axis] - zeros[axis]) * COUNT);
        head.go_to(of(goal))?;
        tally.moves += 1;
        let off = (0..axes).map(|axis| truth(head.line.port(), axis as u8 + 1) - goal[axis]);
        let is_off = off.map(i64::abs).max() > Some(TOLERANCE);
        tally.wrong_moves += u64::from(is_off);

        let along = [UnitVector::X, UnitVector::Y, UnitVector::Z][axis];
        let direction = if side > 0 { along } else { along.reversed() };
        let touch = head.touch(&direction, u64::MAX)?.touch;
        tally.touches += 1;
        let off = touch.position[axis] / COUNT + zeros[axis] - side * FACE;
        tally.wrong_touches += u64::from(off.abs() > TOLERANCE);
    }
    Ok(())
}

/// Prints the plan and its results.
fn show(plan: &Plan, tally: &Tally) {
    let damage = &tally.damage;
    let pairs = damage.pairs_in_halves as f64 / 2.0 * plan.noise.bit_errors.powi(2);
    println!(
        "{} modules, {:?}: {:.2} h, {} sessions, {} moves, {} touches; {} wrong bits; {} replies, \
         {} damaged, {} unseen ({pairs:.1} pairs \
         computed), {} commands wrong and unseen; {} errors reported, {} moves and {} touches \
         silently wrong",
        plan.modules,
        plan.noise,
        tally.seconds / 3600.0,
        tally.sessions,
        tally.moves,
        tally.touches,
        damage.wrong_bits,
        damage.replies,
        damage.damaged_replies,
        damage.unseen_replies,
        damage.unseen_commands,
        tally.errors(),
        tally.wrong_moves,
        tally.wrong_touches,
    );
    for (words, count) in &tally.reported {
        println!("  {count} {words}");
    }
}

const NOISY: Plan = Plan {
    modules: 2,
    noise: Noise {
        bit_errors: 1e-4,
        lost: 0.0,
        doubled: 0.0,
    },
    seconds: 1200.0,
    sessions: u64::MAX,
    seed: 5,
    has_outages: false,
};

/// Twenty minutes on a line with ten times as many wrong bits as on a bad one.
#[test]
fn a_noisy_line_gives_right_results_or_errors() {
    let tally = sessions(NOISY);
    show(&NOISY, &tally);
    assert!(tally.damage.wrong_bits > 5_000 && tally.moves > 100 && tally.touches > 100);
    assert_eq!((tally.wrong_moves, tally.wrong_touches), (0, 0));
    assert_eq!(tally.collisions(), 0);
}

/// Some bytes are lost, and some arrive twice.
#[test]
fn lost_and_doubled_bytes_give_right_results_or_errors() {
    let plan = Plan {
        noise: Noise {
            bit_errors: 0.0,
            lost: 5e-4,
            doubled: 5e-4,
        },
        seconds: 600.0,
        ..NOISY
    };
    let tally = sessions(plan);
    show(&plan, &tally);
    assert!(tally.damage.damaged_replies > 100 && tally.touches > 20);
    assert_eq!((tally.wrong_moves, tally.wrong_touches), (0, 0));
    assert_eq!(tally.collisions(), 0);
}

/// A module loses its supply for half a second at a random moment of a session.
#[test]
fn a_module_that_fails_is_reported() {
    let plan = Plan {
        noise: Noise::default(),
        sessions: 60,
        has_outages: true,
        ..NOISY
    };
    let tally = sessions(plan);
    show(&plan, &tally);
    assert!(tally.errors() > 30, "{}", tally.errors());
    assert_eq!((tally.wrong_moves, tally.wrong_touches), (0, 0));
}

/// A second module takes the address of the first one, by a packet that this host did not send.
/// Then both answer, and a low bit of one wins over a high bit of the other. No such mixture is
/// taken for the position of an axis.
#[test]
fn two_modules_that_answer_are_reported() {
    let mut random = Random::new(3);
    let (mut reported, mut right) = (0, 0);
    for seed in 0..40 {
        let line = Line::new(port(2, Noise::default(), seed));
        let machine = machine(1, Baud::B115200);
        let mut head = Head::start(line, &machine, 1).expect("a good line");
        let mut goal = || [(random.below(800) as i64 - 400) * COUNT, 0, 0];
        head.go_to(goal()).expect("a good line");
        let same = Command::SetAddress {
            address: 1,
            group: Group::NONE,
        };
        let port = head.line.port();
        port.send(same.frame(2).bytes()).expect("simulated");
        port.receive(100_000).expect("simulated");
        for _ in 0..5 {
            match head.status(0).and_then(|_| head.go_to(goal())) {
                Err(_) => reported += 1,
                Ok(position) => {
                    let off = truth(head.line.port(), 1) - position[0] / COUNT;
                    assert!(off.abs() <= TOLERANCE, "{off} counts off");
                    right += 1;
                }
            }
        }
    }
    println!("two answering: {reported} reported, {right} right");
    assert!(reported > 100, "{reported}");
}

/// A day with one wrong bit in 10^5, as four lines of six hours in parallel. Run all three days
/// with `cargo test --release -p husillo-metrology -- --ignored --nocapture hours`. `HOURS=6`
/// before the command makes each day shorter.
fn day(modules: usize) {
    const LINES: u64 = 4;
    let hours = std::env::var("HOURS").map_or(24.0, |hours| hours.parse().expect("HOURS=6"));
    let plan = Plan {
        modules,
        noise: Noise::of_bits(1e-5),
        seconds: hours * 3600.0 / LINES as f64,
        seed: 72 + modules as u64,
        ..NOISY
    };
    let lines = (0..LINES).map(|line| {
        let seed = plan.seed + 100 * line;
        std::thread::spawn(move || sessions(Plan { seed, ..plan }))
    });
    let lines: Vec<_> = lines.collect();
    let tallies = lines.into_iter().map(|line| line.join().expect("no panic"));
    let tally = tallies.fold(Tally::default(), Tally::and);
    show(&plan, &tally);
    let least = (hours * 200.0) as u64;
    assert!(tally.moves > least && tally.touches > least);
    assert_eq!((tally.wrong_moves, tally.wrong_touches), (0, 0));
}

#[test]
#[ignore = "takes a quarter of an hour, optimised"]
fn twenty_four_hours_of_one_module() {
    day(1);
}

#[test]
#[ignore = "takes a quarter of an hour, optimised"]
fn twenty_four_hours_of_two_modules() {
    day(2);
}

#[test]
#[ignore = "takes half an hour, optimised"]
fn twenty_four_hours_of_three_modules() {
    day(3);
}
