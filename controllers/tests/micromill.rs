//! Tests of the micro mill's controller: its modes, and the steps of a program compared with those
//! of `Machine`.

use husillo_backlash::{Backlash, BacklashModel, Play};
use husillo_controllers::{Micromill, MicromillConfig, MicromillEvent, MicromillInputs};
use husillo_gcode::{Nm, SpindleDirection};
use husillo_interp::Path;
use husillo_machine::{Event, Machine, Output};
use husillo_transports::micromill::{AxisState, State, StateDigits};
use proptest::prelude::*;

const CONFIG: MicromillConfig = MicromillConfig::MICROMILL;

/// A controller with its switches and motors. It records the events that were made, with their
/// times.
struct Bench {
    mill: Micromill<'static>,
    /// Motor steps.
    motors: [i32; 3],
    /// Load steps of the screws, and motor steps ahead of the loads.
    loads: [i32; 3],
    ahead: [i32; 3],
    /// Positions at which the switches close, in load steps.
    switches: [i32; 3],
    now_ticks: u64,
    /// When the last byte arrived.
    heard_ticks: u64,
    steps: Vec<(u64, [i8; 3])>,
    spindle: Vec<(SpindleDirection, u16)>,
    /// Answers without steps and echoes.
    answers: Vec<u8>,
    reported: [i32; 3],
    /// Digits of the state since it was asked for.
    digits: StateDigits,
}

static STATIC: MicromillConfig = CONFIG;

impl Bench {
    fn new(mill: Micromill<'static>) -> Self {
        Bench {
            mill,
            motors: [0; 3],
            loads: [0; 3],
            ahead: [0; 3],
            switches: [i32::MIN; 3],
            now_ticks: 0,
            heard_ticks: 0,
            steps: Vec::new(),
            spindle: Vec::new(),
            answers: Vec::new(),
            reported: [0; 3],
            digits: StateDigits::new(),
        }
    }

    fn homed() -> Self {
        let mut bench = Bench::new(Micromill::homed(&STATIC));
        bench.ahead = [1457, 1271, 0];
        bench
    }

    fn backlash(axis: usize) -> i32 {
        [1457, 1271, 0][axis]
    }

    fn hear(&mut self) {
        while let Some(byte) = self.mill.transmit() {
            match byte {
                0x80..=0x85 => {
                    self.reported[usize::from(byte & 6) / 2] += i32::from(byte & 1) * 2 - 1;
                }
                0x90..=0x9f => self.digits.push(byte & 15),
                0x86.. => self.answers.push(byte),
                _ => {}
            }
        }
    }

    fn say(&mut self, string: &str) {
        self.heard_ticks = self.now_ticks;
        for byte in string.bytes() {
            if self.mill.receive(byte) {
                self.mill.halted();
            }
            self.hear();
        }
    }

    /// Makes the next event immediately, if there is one.
    fn go(&mut self) -> bool {
        let inputs = MicromillInputs {
            home: (0..3).fold(0, |home, axis| {
                home | u8::from(self.loads[axis] <= self.switches[axis]) << axis
            }),
        };
        let Some(event) = self.mill.next_event(&inputs) else {
            self.hear();
            return false;
        };
        match event {
            MicromillEvent::Step(step) => {
                let silence_ticks = self.now_ticks + u64::from(step.wait_ticks) - self.heard_ticks;
                let lease_us = self.mill.lease_us().map(u64::from);
                if let Some(lease_us) = lease_us.filter(|lease_us| silence_ticks > *lease_us) {
                    self.now_ticks = self.heard_ticks + lease_us;
                    assert!(self.mill.expire());
                    self.mill.halted();
                    self.hear();
                    return true;
                }
                self.now_ticks += u64::from(step.wait_ticks);
                for (axis, delta) in step.deltas().into_iter().enumerate() {
                    let delta = i32::from(delta);
                    self.motors[axis] += delta;
                    let ahead = self.ahead[axis] + delta;
                    if (0..=Self::backlash(axis)).contains(&ahead) {
                        self.ahead[axis] = ahead;
                    } else {
                        self.loads[axis] += delta;
                    }
                }
                if step.axes != 0 {
                    self.steps.push((self.now_ticks, step.deltas()));
                }
                self.mill.made(1);
            }
            MicromillEvent::Spindle { direction, rpm } => self.spindle.push((direction, rpm)),
            MicromillEvent::Tool { .. } => {}
        }
        self.hear();
        true
    }

    fn run(&mut self) {
        while self.go() {}
    }

    /// Asks for the state.
    fn state(&mut self) -> State {
        self.digits = StateDigits::new();
        assert_eq!(self.does("I;"), [0x8c]);
        self.digits.state().unwrap()
    }

    /// Sends a string and makes all events. Returns the answers since.
    fn does(&mut self, string: &str) -> Vec<u8> {
        self.answers.clear();
        self.say(string);
        self.run();
        std::mem::take(&mut self.answers)
    }
}

#[test]
fn homes_z_then_x_then_y_and_backs_off() {
    let mut bench = Bench::new(Micromill::new(&STATIC));
    bench.switches = [-300, -200, -100];
    assert_eq!(bench.does("G00X00001;"), [0x88, 0x8b], "not homed");
    assert_eq!(bench.does("H;"), [0x8f]);
    // The loads are now 400 steps above each switch, and every positive flank is engaged.
    assert_eq!(bench.loads, [100, 200, 300]);
    assert_eq!(bench.ahead, [1457, 1271, 0]);
    assert_eq!(bench.reported, bench.motors, "every step is reported");
    let axes: Vec<usize> = bench
        .steps
        .iter()
        .map(|(_, delta)| delta.iter().position(|way| *way != 0).unwrap())
        .collect();
    let mut order = axes.clone();
    order.dedup();
    assert_eq!(order, [2, 0, 1]);
    assert_eq!(bench.mill.position_steps(), [0; 3]);
    assert!(bench.mill.is_homed());
    assert_eq!(bench.does("G00X00001;"), [0x8f]);
    // Homing again from another position ends at the same position.
    assert_eq!(bench.does("G00X01000Y01000;"), [0x8f]);
    assert_eq!(bench.does("H;"), [0x8f]);
    assert_eq!(bench.loads, [100, 200, 300]);
}

#[test]
fn a_missing_switch_ends_homing() {
    let mut bench = Bench::new(Micromill::new(&STATIC));
    assert_eq!(bench.does("H;"), [0x88, 0x89]);
    assert_eq!(bench.motors, [0, 0, -80_000]);
    assert!(!bench.mill.is_homed());
}

/// A search does not go far beyond what is possible: from a known position a little beyond machine
/// zero, away from a closed switch as deep as an axis may stand in it.
#[test]
fn homing_with_a_stuck_switch_is_short() {
    let homed = || {
        let mut bench = Bench::new(Micromill::new(&STATIC));
        bench.switches = [-300, -200, -100];
        assert_eq!(bench.does("H;"), [0x88, 0x8f]);
        assert_eq!(bench.does("G00X01400Y01400;"), [0x8f]);
        bench
    };
    // X at 10 000 load steps, ahead by its backlash. Its switch does not close any more.
    let mut bench = homed();
    let before = bench.motors[0];
    bench.switches[0] = i32::MIN;
    assert_eq!(bench.does("H;"), [0x89]);
    assert_eq!(bench.motors[0], before - 10_000 - 5000);
    assert!(!bench.mill.is_homed());
    // The position is not known any more: the next search is as long as the travel.
    let before = bench.motors[0];
    assert_eq!(bench.does("H;"), [0x89]);
    assert_eq!(bench.motors[0], before - 80_000);
    // Y is the shorter axis.
    let mut bench = Bench::new(Micromill::new(&STATIC));
    bench.switches = [-300, i32::MIN, -100];
    assert_eq!(bench.does("H;"), [0x88, 0x89]);
    assert_eq!(bench.motors[1], -58_000);

    // A switch that sticks closed.
    let mut bench = homed();
    let before = bench.motors[0];
    bench.switches[0] = i32::MAX;
    assert_eq!(bench.does("H;"), [0x89]);
    assert_eq!(bench.motors[0], before + 5000);
}

/// An axis that lost steps within half a millimetre finds its switch nevertheless.
#[test]
fn homing_finds_a_switch_after_lost_steps() {
    for lost in [-3000, 0, 3000] {
        let mut bench = Bench::new(Micromill::new(&STATIC));
        bench.switches = [-300, -200, -100];
        assert_eq!(bench.does("H;"), [0x88, 0x8f]);
        assert_eq!(bench.does("G00X01400Y01400;"), [0x8f]);
        bench.loads[0] += lost;
        assert_eq!(bench.does("H;"), [0x8f], "{lost}");
        assert_eq!(bench.loads, [100, 200, 300]);
    }
}

#[test]
fn jogs_until_a_byte_and_remembers_where() {
    let mut bench = Bench::homed();
    bench.say("&X+Y+;");
    for _ in 0..100 {
        assert!(bench.go());
    }
    assert_eq!(bench.loads, [100, 100, 0]);
    assert_eq!(bench.steps[9], (10 * 5883, [1, 1, 0]));
    assert_eq!(bench.does("?"), [0x8d]);
    assert_eq!(bench.mill.position_steps(), [100, 100, 0]);
    assert_eq!(bench.does(";"), [0x8e]);
    // The way back takes up the backlash of each axis first, one axis at a time.
    bench.say("&X-Y-;");
    for _ in 0..1457 + 1271 + 100 {
        assert!(bench.go());
    }
    assert_eq!(bench.loads, [0; 3]);
    // This is the end of the travel.
    bench.run();
    assert_eq!(bench.loads, [0; 3]);
    assert_eq!(bench.answers, [0x8d]);
    assert_eq!(bench.does("A;"), [0x8c]);
}

#[test]
fn a_jog_is_faster_slower_and_mortal() {
    let mut bench = Bench::homed();
    assert_eq!(bench.does("L0500;"), [0x88, 0x8c]);
    bench.say("JX+;");
    bench.run();
    // 84 steps of 5883 us fit half a second, 85 do not.
    assert_eq!(
        (bench.loads[0], bench.answers.as_slice()),
        (84, &[0x8d_u8][..])
    );
    bench.answers.clear();
    bench.say("JX+;");
    for _ in 0..200 {
        assert!(bench.go());
        bench.say("L;");
    }
    let interval = |bench: &mut Bench| {
        let before = bench.now_ticks;
        assert!(bench.go());
        bench.say("L;");
        bench.now_ticks - before
    };
    bench.say("W;W;");
    assert_eq!(interval(&mut bench), 1_000_000_u64.div_ceil(190));
    bench.say("V;V;V;");
    assert_eq!(interval(&mut bench), 1_000_000_u64.div_ceil(160));
    (0..100).for_each(|_| bench.say("W;"));
    assert_eq!(interval(&mut bench), 1_000_000_u64.div_ceil(390));
    (0..100).for_each(|_| bench.say("V;"));
    assert_eq!(interval(&mut bench), 100_000);
    assert_eq!(bench.does("A;"), [0x8d, 0x8c]);
}

/// With a lease every motion ends on its own, with the spindle, when the host has gone. `L;`
/// continues each of them.
#[test]
fn every_motion_has_a_lease() {
    const LEASE_TICKS: u64 = 250_000;
    for (mode, string) in [
        ("S0;", "G01X01000F14;"),
        ("S1;", "G01X01000F14;"),
        ("S1;", "G01X01000F14;G01X02000F14;"),
        ("S0;", "G02X02000Y00000I01000J00000F14;"),
        ("S0;", "G01X00100F01;"),
        ("S0;", "G04P9;"),
        ("S0;", "PX+9999;"),
        ("S0;", "FY+100;"),
        ("S0;", "JX+;"),
        ("S0;", "H;"),
    ] {
        let mut bench = Bench::homed();
        bench.does(mode);
        bench.does("L0250;");
        bench.answers.clear();
        bench.say(string);
        let start = bench.now_ticks;
        // Renewed, it continues for five times the lease. A dwell is one event of the bench.
        let is_dwell = string.starts_with("G04");
        while !is_dwell && bench.now_ticks < start + 5 * LEASE_TICKS {
            assert!(bench.go(), "{string}");
            bench.say("L;");
        }
        assert!(
            !bench.answers.contains(&0x8d),
            "{string}: {:x?}",
            bench.answers
        );
        let renewed = bench.now_ticks;
        bench.run();
        assert_eq!(
            bench.answers.last(),
            Some(&0x8d),
            "{string}: {:x?}",
            bench.answers
        );
        assert_eq!(
            bench.spindle.last(),
            Some(&(SpindleDirection::Off, 0)),
            "{string}"
        );
        let silence = bench.now_ticks - renewed;
        assert_eq!(silence, LEASE_TICKS, "{string}");
        assert!(!bench.mill.is_moving());
        assert_eq!(bench.reported, bench.motors, "{string}");
        // The lease holds for the next motion as well.
        bench.answers.clear();
        assert_eq!(bench.does("S0;JX+;").last(), Some(&0x8d), "{string}");
        // The next order works, and needs no lease any more where there is none.
        assert!(bench.does("L0000;").ends_with(&[0x8c]));
        assert_eq!(bench.does("S0;PZ+0100;"), [0x8c, 0x8f], "{string}");
    }
}

#[test]
fn counted_steps_frequency_and_backlash() {
    let mut bench = Bench::homed();
    assert_eq!(bench.does("PX+1000;"), [0x88, 0x8f]);
    assert_eq!((bench.loads, bench.motors), ([1000, 0, 0], [1000, 0, 0]));
    assert_eq!(bench.does("PX-0010;"), [0x8f]);
    assert_eq!((bench.loads[0], bench.motors[0]), (990, 990 - 1457));
    assert_eq!(bench.does("PX-0991;"), [0x8b], "beyond the travel");
    assert_eq!(bench.does("PY+0000;"), [0x8f]);
    assert_eq!(
        bench.does("FX+391;"),
        [0x8b],
        "faster than the motor follows"
    );
    bench.say("FX-390;");
    let before = bench.now_ticks;
    assert!(bench.go());
    assert_eq!(bench.now_ticks - before, 1_000_000_u64.div_ceil(390));
    assert_eq!(bench.does("A;"), [0x8d, 0x8c]);
    // The set backlash is less than the real one: 20 um are 143 steps.
    assert_eq!(bench.does("BX020;"), [0x8f]);
    let motor = bench.motors[0];
    assert_eq!(bench.does("PX+0001;"), [0x8f]);
    assert_eq!(bench.motors[0], motor + 143 + 1);
}

/// A string that is wrong, beyond the travel or not an arc has no effect.
#[test]
fn refused_strings_change_nothing() {
    let mut bench = Bench::homed();
    bench.does("G00X01000Y01000;");
    let before = bench.motors;
    for (string, answer) in [
        ("G00X11000;", 0x8b),
        ("G01Y-00001F08;", 0x8b),
        ("G02X02000Y02000I05000J01000F08;", 0x8b),
        ("G02X01000Y01000I00000J00000F08;", 0x8b),
        ("G01X02000F00;", 0x8e),
        ("G99;", 0x8e),
        ("PX-9999;", 0x8b),
    ] {
        assert_eq!(bench.does(string), [answer], "{string}");
        assert_eq!(bench.motors, before, "{string}");
    }
    assert_eq!(bench.does("G00X01000Y01000;"), [0x8f]);
    assert_eq!(bench.motors, before, "the motors have not moved");
}

#[test]
fn outputs_come_between_the_moves() {
    let mut bench = Bench::homed();
    for string in [
        "M03S800;",
        "G01X00100F10;",
        "M04S0900;",
        "M05;",
        "M06T02;",
        "G04P02;",
        "M30;",
    ] {
        assert_eq!(bench.does(string).last(), Some(&0x8f), "{string}");
    }
    use SpindleDirection::{Clockwise, CounterClockwise, Off};
    assert_eq!(
        bench.spindle,
        [
            (Clockwise, 800),
            (CounterClockwise, 900),
            (Off, 0),
            (Off, 0)
        ]
    );
    assert_eq!(bench.now_ticks, 60_000_000 / 10 + 2_000_000);
}

/// The mill accepts lines ahead, and sixteen wait. A stop drops the events that were not made, and
/// the position is right.
#[test]
fn streams_and_stops() {
    let mut bench = Bench::homed();
    assert_eq!(bench.does("S1;"), [0x88, 0x8c]);
    for number in 0..17 {
        bench.say(&format!("G01X{:05}F14;", (number + 1) * 10));
        // The first line is executed at once, so sixteen more fill the queue.
        if number == 0 {
            assert!(bench.go());
        }
    }
    assert_eq!(bench.answers, [0x8c; 16], "the last one waits for its slot");
    bench.say("G90;");
    assert_eq!(bench.answers.pop(), Some(0x8b), "no line was requested");
    bench.answers.clear();
    for _ in 0..100 {
        assert!(bench.go());
    }
    // 10 um are 71 steps: one line is made, and there is room for the last one.
    assert_eq!(bench.answers, [0x8f, 0x8c]);
    // Three events are given and not made.
    let made = bench.loads;
    for _ in 0..3 {
        assert!(bench.mill.next_event(&MicromillInputs::default()).is_some());
    }
    assert_eq!(bench.does("G01X0A"), [0x8d]);
    assert_eq!(bench.does(";"), [0x8c]);
    assert_eq!(bench.mill.position_steps(), made);
    assert_eq!(bench.does("G00X00000;"), [0x8c, 0x8f]);
    assert_eq!(bench.loads, [0; 3]);
    assert_eq!(bench.reported, bench.motors);
}

#[test]
fn any_byte_stops_a_line_within_a_take_up() {
    let mut bench = Bench::homed();
    bench.does("G00X01000;");
    bench.say("G00X00000;");
    for _ in 0..700 {
        assert!(bench.go());
    }
    assert_eq!(bench.does("x;"), [0x8d, 0x8e]);
    let load = bench.loads[0];
    assert_eq!(bench.does("PX+0001;"), [0x8f]);
    assert_eq!(bench.loads[0], load + 1, "the take-up is undone");
    assert_eq!(bench.does("G00X00000;"), [0x8f]);
    assert_eq!(bench.loads, [0; 3]);
}

/// What only the controller knows.
#[test]
fn position_backlash_zero_and_homing_are_reported() {
    let mut bench = Bench::new(Micromill::new(&STATIC));
    bench.switches = [-30, -20, -10];
    bench.hear();
    let backlash = [1457, 1271, 0];
    let before = bench.state();
    assert!(!before.is_homed);
    assert_eq!(before.axes.map(|axis| axis.backlash_steps), backlash);
    bench.does("PX-0025;");
    let moved = bench.state().axes;
    assert_eq!(moved.map(|axis| axis.load_steps), [-25, 0, 0]);
    assert_eq!(moved.map(|axis| axis.ahead_steps), [0; 3]);
    assert_eq!(bench.does("Q;"), [0x8b]);
    assert_eq!(bench.does("H;").last(), Some(&0x8f));
    let homed = bench.state();
    assert!(homed.is_homed);
    assert_eq!(homed.axes.map(|axis| axis.load_steps), [0; 3]);
    assert_eq!(homed.axes.map(|axis| axis.ahead_steps), backlash);
    for string in ["PX+0700;", "PY+0300;", "PY-0001;", "Q;", "BX200;"] {
        assert_eq!(bench.does(string), [0x8f], "{string}");
    }
    let [x, y, z] = bench.state().axes;
    assert_eq!(
        (x.load_steps, x.zero_nm, x.backlash_steps, x.ahead_steps),
        (700, 98_000, 1429, 1429)
    );
    assert_eq!(
        (y.load_steps, y.zero_nm, y.backlash_steps, y.ahead_steps),
        (299, 41_860, 1271, 0)
    );
    assert_eq!(z, AxisState::default());
    assert_eq!(x.motor_steps(true), 700);
    assert_eq!(y.motor_steps(true), 299 - 1271);
    // While it moves nothing is reported: the string stops the motion, as any other.
    bench.say("PX+0100;");
    assert!(bench.go());
    bench.digits = StateDigits::new();
    assert_eq!(bench.does("I;"), [0x8d, 0x8c]);
    assert_eq!(bench.digits.state().unwrap().axes[0].load_steps, 701);
    // Between streamed lines it is refused, and nothing stops.
    assert_eq!(bench.does("S1;"), [0x8c]);
    bench.say("G00X00001.00;");
    bench.answers.clear();
    bench.say("I;");
    assert_eq!(bench.answers, [0x8b]);
}

/// The steps of `Machine` for the same strings, each with its time.
struct Peer<L: BacklashModel<3> = Backlash>(Machine<3, Path<3>, L>, u64, Vec<(u64, [i8; 3])>);

impl Peer<Play> {
    /// A machine in the state that a controller reports.
    fn of(state: &State) -> Self {
        let plays = state
            .axes
            .map(|axis| Play::at(axis.backlash_steps, axis.ahead_steps, axis.load_steps));
        let mut machine = Machine::with_backlash(CONFIG.machine, plays);
        let at = state.axes.map(|axis| Nm(140 * i64::from(axis.load_steps)));
        let zero = state.axes.map(|axis| Nm(axis.zero_nm.into()));
        machine.place(zero, at).unwrap();
        Peer(machine, 0, Vec::new())
    }
}

impl<L: BacklashModel<3>> Peer<L> {
    fn does(&mut self, string: &str) -> bool {
        if self
            .0
            .line(string.trim_end_matches(';').as_bytes())
            .is_err()
        {
            return false;
        }
        while let Some(event) = self.0.next_event() {
            match event {
                Event::Step(step) => {
                    self.1 += u64::from(step.wait_ticks);
                    self.2.push((self.1, step.delta));
                }
                Event::Dwell { wait_ticks } => self.1 += u64::from(wait_ticks),
                Event::Output(Output::Spindle { .. }) => {}
                _ => {}
            }
        }
        true
    }
}

/// Formats a number for a word.
fn word(letter: char, at: i32) -> String {
    let sign = if at < 0 { "-" } else { "" };
    let at = at.abs();
    format!("{letter}{sign}{:05}.{:02}", at / 100, at % 100)
}

fn any_line() -> impl Strategy<Value = Vec<String>> {
    // Mostly within the table of 10 x 7 mm, in units of 10 nm; sometimes moves of a few steps.
    let at = || prop_oneof![0..=650_000_i32, 0..=100, -50_000..=1_100_000];
    prop_oneof![
        (at(), at()).prop_map(|(x, y)| vec![format!("G00{}{};", word('X', x), word('Y', y))]),
        (at(), 1..=99_u8).prop_map(|(x, feed)| vec![format!("G01{}F{feed:02};", word('X', x))]),
        (at(), at(), 1..=14_u8).prop_map(|(x, y, feed)| vec![format!(
            "G01{}{}F{feed:02};",
            word('X', x),
            word('Y', y)
        )]),
        (at(), 5..=14_u8)
            .prop_map(|(z, feed)| vec![format!("G01{}F{feed:02};", word('Z', z / 100))]),
        // A whole turn, a half, a quarter, and any other arc from a known position.
        (
            100_000..400_000_i32,
            100_000..400_000_i32,
            -20_000..20_000_i32,
            -20_000..20_000_i32,
            any::<bool>(),
            0..4_u8
        )
            .prop_map(|(x, y, i, j, clockwise, kind)| {
                let code = if clockwise { "G02" } else { "G03" };
                let (end_x, end_y) = match kind {
                    0 => (x, y),
                    1 => (x + 2 * i, y + 2 * j),
                    2 => (x + i + j, y + j - i),
                    _ => (x + i, y + j + f64::from(i).hypot(j.into()).round() as i32),
                };
                let arc = format!(
                    "{code}{}{}{}{}F10;",
                    word('X', end_x),
                    word('Y', end_y),
                    word('I', x + i),
                    word('J', y + j)
                );
                vec![format!("G00{}{};", word('X', x), word('Y', y)), arc]
            }),
        prop::sample::select(vec![
            "G54;", "G90;", "G04P01;", "G28X0Y0;", "G28Z0;", "M03S100;", "M05;", "M30;"
        ])
        .prop_map(|line| vec![line.to_owned()]),
    ]
}

/// The time of a move too short for a step is added to the next step, also across a line without
/// effect.
#[test]
fn time_is_carried_over_lines_that_do_nothing() {
    let mut bench = Bench::homed();
    let mut peer = Peer(Machine::new(CONFIG.machine), 0, Vec::new());
    for line in [
        "G00X00000.21Y00000.00;",
        "G01Z00000.01F05;",
        "G90;",
        "G01X00000.00Y00000.00F01;",
    ] {
        bench.does(line);
        assert!(peer.does(line), "{line}");
    }
    assert_eq!(bench.steps, peer.2);
}

/// A line is done when its last step is made, even if the step took the last slot. No later byte
/// stops it.
#[test]
fn a_line_ends_with_its_last_step() {
    let mut fills = 0;
    for to in 1..40 {
        let mut mill: Micromill = Micromill::homed(&STATIC);
        for byte in format!("G01X{to:05}F0100;").bytes() {
            assert!(!mill.receive(byte));
        }
        let mut said = Vec::new();
        while mill.is_moving() {
            let given = std::iter::from_fn(|| mill.next_event(&MicromillInputs::default())).count();
            assert_ne!(given, 0, "{to}: all was made, and it is not done");
            mill.made(given);
            said.extend(std::iter::from_fn(|| mill.transmit()));
            fills += usize::from(given == 8 && !mill.is_moving());
        }
        assert_eq!(said.last(), Some(&0x8f));
        assert!(!mill.receive(b'A'));
    }
    assert_ne!(fills, 0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// For any program both refuse the same strings, and all steps have the directions and times of
    /// `Machine`.
    #[test]
    fn steps_are_those_of_the_machine(lines in prop::collection::vec(any_line(), 1..6)) {
        let mut bench = Bench::homed();
        let mut peer = Peer(Machine::new(CONFIG.machine), 0, Vec::new());
        bench.hear();
        for line in lines.into_iter().flatten() {
            let answers = bench.does(&line);
            let taken = answers.last() == Some(&0x8f);
            prop_assert!(taken || answers.last() == Some(&0x8b), "{}: {:?}", line, answers);
            prop_assert_eq!(peer.does(&line), taken, "{}", line);
            // Both dwell for moves too short for a step at the end. `Machine` does so at once.
            prop_assert_eq!(bench.steps.len(), peer.2.len());
            let differs = bench.steps.iter().zip(&peer.2).find(|(ours, theirs)| ours != theirs);
            prop_assert_eq!(differs, None, "{}", line);
        }
        prop_assert_eq!(bench.loads, peer.0.position_steps());
    }

    /// An arc whose ends have different radii is a spiral. It ends where it is told, and no axis is
    /// faster than its rate, except that the steps nearest to a circle are uneven: at 45 degrees by
    /// the root of 2, and on small circles a little more.
    #[test]
    fn no_axis_is_too_fast_on_a_spiral(
        i in -3_000..3_000_i32,
        j in -3_000..3_000_i32,
        clockwise: bool,
    ) {
        let mut bench = Bench::homed();
        bench.hear();
        bench.does("G00X01000.00Y01000.00;");
        let (before, code) = (bench.steps.len(), if clockwise { "G02" } else { "G03" });
        let (x, y) = (100_000 + i, 100_000);
        let arc = format!(
            "{code}{}{}{}{}F1000;", word('X', x), word('Y', y), word('I', x), word('J', y + j)
        );
        let is_taken = bench.does(&arc).last() == Some(&0x8f);
        let end = if is_taken { x } else { 100_000 };
        prop_assert_eq!(bench.loads, [(end + 7) / 14, 7143, 0]);
        for axis in 0..2 {
            let steps = bench.steps[before..].iter().filter(|(_, delta)| delta[axis] != 0);
            let times: Vec<u64> = steps.map(|(ticks, _)| *ticks).collect();
            let least = times.windows(2).map(|pair| pair[1] - pair[0]).min().unwrap_or(9999);
            prop_assert!(least * 170 * 3 >= 1_000_000 * 2, "{axis}: {least} ticks");
        }
    }

    /// A controller that is stopped anywhere, with any zero and backlash, reports all that its next
    /// steps depend on: `Machine` in that state makes the same ones. Their times also depend on
    /// when the last step was made.
    #[test]
    fn the_reported_state_decides_the_next_steps(
        before in prop::collection::vec(any_line(), 1..3),
        events in 0..4000_usize,
        backlash_um in 0..=300_u16,
        is_zeroed: bool,
        lines in prop::collection::vec(any_line(), 1..3),
    ) {
        let mut bench = Bench::homed();
        bench.hear();
        prop_assert_eq!(bench.does(&format!("BX{backlash_um:03};")), [0x8f]);
        let (last, whole) = before.split_last().unwrap();
        for line in whole.iter().flatten() {
            bench.does(line);
        }
        bench.say(&last[0]);
        (0..events).all(|_| bench.go());
        bench.does("A;");
        if is_zeroed {
            prop_assert_eq!(bench.does("Q;"), [0x8f]);
        }
        let state = bench.state();
        prop_assert!(state.is_homed);
        bench.does("A;");
        let mut peer = Peer::of(&state);
        (bench.now_ticks, bench.steps) = (0, Vec::new());
        for line in lines.into_iter().flatten() {
            let is_taken = bench.does(&line).last() == Some(&0x8f);
            prop_assert_eq!(peer.does(&line), is_taken, "{}", line);
            prop_assert_eq!(bench.steps.len(), peer.2.len());
            let pairs = bench.steps.iter().zip(&peer.2);
            let differs = pairs.map(|(ours, theirs)| (ours.1, theirs.1)).find(|(a, b)| a != b);
            prop_assert_eq!(differs, None, "{}", line);
        }
        let position = bench.state().axes.map(|axis| axis.load_steps);
        prop_assert_eq!(position, peer.0.position_steps());
    }

    /// For any bytes the loads stay within their travel, and homing finds the same zero afterwards.
    #[test]
    fn hostile_bytes_stay_within_the_travel(strings in prop::collection::vec(prop_oneof![
        prop::collection::vec(any::<u8>(), 0..12),
        prop::sample::select(
            vec![
                &b"JX-;"[..],
                b"&X-Y-;",
                b"JX+;",
                b"PX-9999;",
                b"PY+9999;",
                b"FY-390;",
                b"G00X10000Y07000;",
                b"G28X0Y0;",
                b"H;",
                b"S1;",
                b"G01X00100F99;",
                b"W;",
                b"A;",
            ]
        )
            .prop_map(|string| string.to_vec()),
    ], 1..20), events in 0..3000_usize) {
        let mut bench = Bench::homed();
        bench.switches = [-400, -400, -400];
        for string in strings {
            for byte in string {
                let stops = bench.mill.stops();
                if bench.mill.receive(byte) {
                    prop_assert!(
                        stops.takes(byte) || b"WVL;".contains(&byte),
                        "{:?} {}",
                        stops,
                        byte,
                    );
                    bench.mill.halted();
                }
                bench.hear();
            }
            for _ in 0..events {
                if !bench.go() {
                    break;
                }
                let least = if bench.mill.is_homed() { 0 } else { -401 };
                prop_assert!(bench.loads[0] >= least && bench.loads[1] >= least);
                prop_assert!(
                    bench.loads[0] <= 71_429 && bench.loads[1] <= 50_000,
                    "{:?}",
                    bench.loads,
                );
            }
        }
        bench.say("A;A;");
        bench.run();
        bench.answers.clear();
        let answers = bench.does("H;");
        prop_assert_eq!(answers.last(), Some(&0x8f));
        prop_assert_eq!(bench.loads, [0; 3]);
        prop_assert_eq!(bench.reported, bench.motors);
    }

    /// Eight events wait when a byte that stops arrives. The interrupt that receives it holds them,
    /// and the foreground is late. No further event is made, and the mill reports the positions of
    /// the loads.
    #[test]
    fn a_stop_acts_before_the_next_event(
        is_streaming in any::<bool>(),
        made in 1..560_usize,
        late in 0..4_usize,
    ) {
        let mut bench = Bench::homed();
        if is_streaming {
            bench.does("S1;");
        }
        bench.say("G01X00080Y00050F14;");
        let inputs = MicromillInputs::default();
        let mut waiting = std::collections::VecDeque::new();
        let (mut motors, mut is_held) = ([0; 3], false);
        for count in 0..made + late {
            while let Some(MicromillEvent::Step(step)) = bench.mill.next_event(&inputs) {
                waiting.push_back(step.deltas());
            }
            prop_assert_eq!(waiting.len(), 8, "the line has 571 events");
            is_held |= count >= made && bench.mill.stops().takes(b'A');
            if !is_held {
                let delta = waiting.pop_front().unwrap_or_default();
                motors = std::array::from_fn(|axis| motors[axis] + i32::from(delta[axis]));
                bench.mill.made(1);
            }
            bench.hear();
        }
        let before = motors;
        prop_assert!(bench.mill.receive(b'A'));
        bench.mill.halted();
        bench.hear();
        prop_assert_eq!(bench.reported, before);
        prop_assert_eq!(bench.mill.position_steps(), motors, "no backlash was taken up");
        prop_assert!(bench.mill.next_event(&inputs).is_none());
        prop_assert_eq!(bench.answers.last(), Some(&0x8d));
    }

    /// Events reported together cause the same reports as events reported one by one, whichever
    /// steps are reported. The position after a stop of the other events is also the same.
    #[test]
    fn events_are_followed_together(
        every in prop::sample::select(vec!["R000;", "R001;", "R003;"]),
        together in 2..9_usize,
        made in 0..2600_usize,
    ) {
        let [one_by_one, several] = [1, together].map(|together| {
            let mut mill: Micromill = Micromill::homed(&STATIC);
            let mut said = Vec::new();
            // Forwards, and backwards with take-ups.
            for string in ["S1;", every, "G01X00080Y00050F14;", "G01X00020F14;"] {
                for byte in string.bytes() {
                    assert!(!mill.receive(byte));
                    said.extend(std::iter::from_fn(|| mill.transmit()));
                }
            }
            let (mut waiting, mut left) = (0, made);
            loop {
                while let Some(MicromillEvent::Step(_)) = mill.next_event(
                    &MicromillInputs::default()
                ) {
                    waiting += 1;
                }
                let now = waiting.min(left).min(together);
                if now == 0 {
                    break;
                }
                mill.made(now);
                (waiting, left) = (waiting - now, left - now);
                said.extend(std::iter::from_fn(|| mill.transmit()));
            }
            // If all is done, there is nothing to stop.
            if mill.receive(b'A') {
                mill.halted();
            }
            said.extend(std::iter::from_fn(|| mill.transmit()));
            // A slot in the queue is confirmed earlier if more events are given.
            (
                said.into_iter().filter(|byte| *byte != 0x8c).collect::<Vec<_>>(),
                mill.position_steps(),
            )
        });
        prop_assert_eq!(one_by_one, several);
    }
}
