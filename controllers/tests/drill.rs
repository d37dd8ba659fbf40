//! Properties of the drill's controller for any bytes of its link and any levels of its switches.

use husillo_controllers::{
    Controller, Drill, DrillConfig, DrillEvent, DrillFault, DrillInputs, DrillReport,
};
use husillo_transports::drill::Rules;
use proptest::prelude::*;

fn config(rules: Rules) -> DrillConfig {
    DrillConfig {
        back_off_steps: 3,
        search_steps: 40,
        stroke_steps: 9,
        shortest_stroke_steps: rules.has_extras.then_some(6),
        upper_opens_steps: 3,
        travel_steps: [500, 400],
        spindle_by_hole: !rules.has_extras,
        rules,
        ..DrillConfig::FIXED
    }
}

fn inputs() -> impl Strategy<Value = DrillInputs> {
    // Mostly open, so that axes move.
    let switch = || prop::bool::weighted(0.1);
    (switch(), switch(), switch(), switch()).prop_map(|(x, y, is_up, is_down)| DrillInputs {
        home: [x, y],
        is_up,
        is_down,
    })
}

/// Mostly letters of the link.
fn byte() -> impl Strategy<Value = u8> {
    prop_oneof![
        prop::sample::select(&b"BcrebmXYZfwEDIFRULOSaTQn?"[..]),
        any::<u8>()
    ]
}

proptest! {
    /// One axis moves at a time, at its rate. Z never goes beyond a sensor that sees it. After
    /// homing, X and Y stay within the table, at the positions that the steps give.
    #[test]
    fn moves_are_within_bounds(
        faithful in any::<bool>(),
        course in prop::collection::vec((prop::option::weighted(0.3, byte()), inputs()), 1..3000),
    ) {
        let config = config(if faithful { Rules::FAITHFUL } else { Rules::FIXED });
        let mut drill = Drill::<24>::new(config);
        let mut spindle = true;
        // The distance of the axes beyond zero, while they search a switch that closes slightly
        // late.
        let mut beyond = [0; 2];
        for (byte, inputs) in course {
            if let Some(byte) = byte {
                drill.push(byte);
            }
            let before = drill.position_steps();
            let was_homed = drill.is_homed();
            match drill.next_event(&inputs) {
                DrillEvent::Step(step) => {
                    prop_assert_eq!(step.wait_ticks, 1_000_000 / 247);
                    let [dx, dy, dz] = step.delta;
                    prop_assert_eq!(dx.abs() + dy.abs() + dz.abs(), 1);
                    prop_assert!(!(inputs.is_down && dz > 0));
                    prop_assert!(!(inputs.is_up && dz < 0));
                    if was_homed {
                        let place = drill.position_steps();
                        for (axis, delta) in [(0, dx), (1, dy)] {
                            beyond[axis] += i32::from(place[axis]) - i32::from(
                                before[axis]
                            ) - i32::from(delta);
                            prop_assert!((0..=3).contains(&beyond[axis]));
                        }
                        prop_assert!(place[0] <= 500 && place[1] <= 400);
                    }
                }
                DrillEvent::Spindle(on) => {
                    prop_assert_ne!(on, spindle);
                    spindle = on;
                }
                DrillEvent::Dwell { wait_ticks } => prop_assert!(wait_ticks <= config.settle_ticks),
                DrillEvent::Report(_) | DrillEvent::Idle => {}
            }
            if !drill.is_homed() {
                beyond = [0; 2];
            }
            prop_assert_eq!(drill.spindle_turns(), spindle);
            while drill.transmit().is_some() {}
        }
    }

    /// After a reset in any state the spindle stops. With working switches the drill then homes and
    /// sends `B`.
    #[test]
    fn a_reset_leads_home(course in prop::collection::vec((byte(), inputs()), 0..300)) {
        let mut drill = Drill::<24>::new(config(Rules::FIXED));
        for (byte, inputs) in course {
            drill.push(byte);
            drill.next_event(&inputs);
        }
        while drill.transmit().is_some() {}
        drill.reset();
        let mut place = [7, 5, 4];
        for _ in 0..200 {
            let inputs = DrillInputs {
                home: [place[0] <= 0, place[1] <= 0],
                is_up: place[2] <= 0,
                is_down: place[2] >= 8,
            };
            if let DrillEvent::Step(step) = drill.next_event(&inputs) {
                for (place, delta) in place.iter_mut().zip(step.delta) {
                    *place += i32::from(delta);
                }
            }
        }
        prop_assert_eq!(place, [0; 3]);
        prop_assert!(drill.is_homed() && !drill.spindle_turns());
        prop_assert_eq!(drill.transmit(), Some(b'B'));
        prop_assert_eq!(drill.transmit(), None);
    }
}

/// A machine of a few steps, with the time of its events.
struct Bench {
    drill: Drill<64>,
    place: [i32; 3],
    now_us: u64,
    heard_us: u64,
    answers: Vec<u8>,
    drilled: usize,
    deepest: i32,
    /// A sensor of Z that sticks closed: 0 for the upper one, 1 for the lower one, the height at
    /// which it begins, and whether Z rises then.
    sticks: Option<(usize, i32, bool)>,
    is_stuck: bool,
}

impl Bench {
    const STROKE: i32 = 400;

    const BACK_OFF: i32 = 60;

    const UPPER_OPENS: i32 = 20;

    /// A drill whose power comes on with Z at a depth.
    fn switched_on(depth: i32) -> Self {
        let config = DrillConfig {
            back_off_steps: Self::BACK_OFF as u16,
            stroke_steps: 1000,
            shortest_stroke_steps: Some(Self::STROKE as u16 - 3),
            upper_opens_steps: Self::UPPER_OPENS as u16,
            ..DrillConfig::FIXED
        };
        Bench {
            drill: Drill::new(config),
            place: [30, 20, depth],
            now_us: 0,
            heard_us: 0,
            answers: Vec::new(),
            drilled: 0,
            deepest: 0,
            sticks: None,
            is_stuck: false,
        }
    }

    /// Repairs the sensor, presses the button R, and waits until the drill is idle.
    fn repair(&mut self) {
        (self.sticks, self.is_stuck) = (None, false);
        self.answers.clear();
        self.drill.reset();
        while self.go() {}
    }

    fn homed() -> Self {
        let mut bench = Self::switched_on(10);
        while bench.go() {}
        assert_eq!(bench.answers, b"B");
        bench.answers.clear();
        bench
    }

    fn inputs(&self) -> DrillInputs {
        let [x, y, z] = self.place;
        let sticks = |number| self.is_stuck && self.sticks.is_some_and(|(at, ..)| at == number);
        DrillInputs {
            home: [x <= 0, y <= 0],
            is_up: z <= 0 || sticks(0),
            is_down: z >= Self::STROKE || sticks(1),
        }
    }

    fn hear(&mut self, byte: u8) {
        self.heard_us = self.now_us;
        self.drill.push(byte);
        self.answers
            .extend(std::iter::from_fn(|| self.drill.transmit()));
    }

    /// Each byte is sent when the drill is done with the last one. Meanwhile the lease is renewed.
    fn say(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.hear(*byte);
            while self.go() {
                self.renew();
            }
        }
    }

    fn renew(&mut self) {
        if self.now_us > self.heard_us + 60_000 && self.drill.is_working() {
            self.hear(b'p');
        }
    }

    /// The next event, or the end of the lease before it. `false`: the drill is idle.
    fn go(&mut self) -> bool {
        self.event() != DrillEvent::Idle
    }

    fn event(&mut self) -> DrillEvent {
        let event = self.drill.next_event(&self.inputs());
        let wait_us = match event {
            DrillEvent::Step(step) => u64::from(step.wait_ticks),
            DrillEvent::Dwell { wait_ticks } => u64::from(wait_ticks),
            _ => 0,
        };
        let over_us = (self.drill.lease_us()).map(|lease_us| self.heard_us + u64::from(lease_us));
        if over_us.is_some_and(|over_us| over_us <= self.now_us + wait_us) {
            // The event that was given is made.
            assert!(!Controller::expire(&mut self.drill));
        }
        self.now_us += wait_us;
        if let DrillEvent::Step(step) = event {
            for (place, delta) in self.place.iter_mut().zip(step.delta) {
                *place += i32::from(delta);
            }
            let [.., z] = self.place;
            self.is_stuck |= self.sticks.is_some_and(|(_, at, rises)| match step.delta {
                [.., 1] => !rises && z >= at,
                [.., -1] => rises && z <= at,
                _ => false,
            });
        }
        self.deepest = self.deepest.max(self.place[2]);
        self.drilled += usize::from(matches!(
            event,
            DrillEvent::Report(DrillReport::Drilled { .. })
        ));
        self.answers
            .extend(std::iter::from_fn(|| self.drill.transmit()));
        event
    }
}

/// A program of two holes.
const PROGRAM: &[u8] = b"bX\x00\x04Y\x00\x02Z\0\0X\0\x08Z\0\0f";

/// What is sent before, and what moves.
const MOTIONS: [(&[u8], &[u8]); 7] = [
    (PROGRAM, b"e"),
    (b"", b"r"),
    (b"", b"M\xff"),
    (b"M\xff", b"D"),
    (b"M\xff", b"L"),
    (b"M\xffDFT", b"r"),
    (b"M\xffDFTL", b"e"),
];

/// With a lease everything that moves ends when the host is silent: X and Y within the lease and a
/// step, Z above the board. Until then `p` continues each motion. The positions stay known, a hole
/// counts only if it is whole, and the lease has ended.
#[test]
fn every_motion_has_a_lease() {
    const LEASE_US: u64 = 250_000;
    const STEP_US: u64 = 1_000_000 / 247 + 1;
    const LIFT_US: u64 = (Bench::STROKE as u64 + 3) * STEP_US;
    for (before, begins) in MOTIONS {
        let context = format!("{before:x?} {begins:x?}");
        let (mut ended, mut done) = (0, 0);
        for renewed_us in (0..30_000_000).step_by(70_001) {
            let mut bench = Bench::homed();
            bench.say(b"Ot\x05");
            bench.say(before);
            bench.answers.clear();
            let (last, first) = begins.split_last().unwrap();
            bench.say(first);
            bench.hear(*last);
            let silent_at = bench.now_us + renewed_us;
            while bench.now_us < silent_at && bench.go() {
                bench.renew();
            }
            if !bench.drill.is_working() {
                // Done, with a lease all the time.
                assert!(!bench.answers.contains(&b'>'), "{context}");
                done += 1;
                break;
            }
            ended += 1;
            bench.hear(b'p');
            assert_eq!(bench.answers.last(), Some(&b'*'), "{context}");
            let (heard_us, mut moved_us) = (bench.now_us, 0);
            let (mut place, mut is_down) = (bench.place, false);
            while bench.go() {
                if bench.place[..2] != place[..2] {
                    moved_us = bench.now_us;
                }
                is_down |= bench.place[2] > 0;
                place = bench.place;
            }
            let silent_us = bench.now_us - heard_us;
            if bench.answers.last() != Some(&b'>') {
                assert!(silent_us <= LEASE_US, "{context}: done before its end");
                continue;
            }
            assert!(moved_us <= heard_us + LEASE_US + STEP_US, "{context}");
            let longest_us = LEASE_US + 3 * STEP_US + if is_down { LIFT_US } else { 0 };
            assert!(silent_us <= longest_us, "{context}: {silent_us}");
            assert!(!bench.drill.spindle_turns(), "{context}");
            let is_jog = begins == b"L";
            assert!(
                is_jog || bench.place[2] == 0,
                "{context}: {:?}",
                bench.place
            );
            let [x, y] = bench.drill.position_steps().map(i32::from);
            assert!(bench.drill.is_homed() || matches!(begins, b"r" | b"M\xff"));
            assert!(
                !bench.drill.is_homed() || [x, y] == bench.place[..2],
                "{context}"
            );
            // It rests; the next work needs no host, and is done.
            bench.say(b"Q");
            bench.answers.clear();
            bench.say(b"n\xff\xff");
            assert_eq!(usize::from(bench.answers[4]), bench.drilled, "{context}");
            bench.answers.clear();
            bench.hear(b'r');
            assert_eq!(bench.drill.lease_us(), None);
            while bench.go() {}
            assert_eq!(bench.answers, b"r", "{context}");
        }
        assert!(ended > 1 && done == 1, "{context}: {ended} {done}");
    }
}

/// A home switch that sticks closed is no home, wherever it sticks on the way to it: the axis finds
/// that it does not open again.
#[test]
fn a_home_switch_that_sticks_is_no_home() {
    for (axis, start) in [(0, 30), (1, 20)] {
        for stuck_at in 0..start {
            let mut drill = Drill::<64>::new(DrillConfig::FIXED);
            let mut place = [30, 20, 10];
            let mut sticks = false;
            let fault = loop {
                sticks |= place[axis] <= stuck_at;
                let mut home = [place[0] <= 0, place[1] <= 0];
                home[axis] |= sticks;
                let inputs = DrillInputs {
                    home,
                    is_up: place[2] <= 0,
                    is_down: false,
                };
                match drill.next_event(&inputs) {
                    DrillEvent::Step(step) => {
                        for (place, delta) in place.iter_mut().zip(step.delta) {
                            *place += i32::from(delta);
                        }
                    }
                    DrillEvent::Report(DrillReport::Fault(fault)) => break fault,
                    DrillEvent::Report(DrillReport::Homed) => panic!("homed at {stuck_at}"),
                    _ => {}
                }
            };
            let number = axis as u8;
            assert_eq!(fault, DrillFault::StillClosed { axis: number });
            assert!(!drill.is_homed());
        }
    }
}

/// A sensor of Z that sticks closed at any height is found. X and Y never move with the bit deep,
/// no hole counts that is not whole, and a reset without a repair moves neither X nor Y.
#[test]
fn a_sensor_of_z_that_sticks_is_found() {
    let heights = (0..=Bench::STROKE).flat_map(|at| [(at, false), (at, true)]);
    for (sensor, (at, rises)) in [0, 1]
        .into_iter()
        .flat_map(|n| heights.clone().map(move |h| (n, h)))
    {
        let context = format!("sensor {sensor} at {at}, rises: {rises}");
        let mut bench = Bench::homed();
        bench.say(PROGRAM);
        bench.sticks = Some((sensor, at, rises));
        bench.hear(b'e');
        let (mut faults, mut drilled) = (0, 0);
        loop {
            let event = bench.event();
            match event {
                DrillEvent::Idle => break,
                DrillEvent::Step(step) if step.delta[2] == 0 => {
                    assert!(
                        bench.place[2] <= Bench::BACK_OFF,
                        "{context}: {:?}",
                        bench.place
                    );
                }
                DrillEvent::Report(DrillReport::Fault(_)) => faults += 1,
                DrillEvent::Report(DrillReport::Drilled { .. }) => {
                    assert!(
                        bench.deepest >= Bench::STROKE - 3,
                        "{context}: {}",
                        bench.deepest
                    );
                    (bench.deepest, drilled) = (0, drilled + 1);
                }
                _ => {}
            }
        }
        assert!(
            faults == 1 && drilled < 2,
            "{context}: {faults} faults, {drilled} holes"
        );
        assert!(
            !bench.drill.spindle_turns() && !bench.drill.is_homed(),
            "{context}"
        );
        assert_eq!(bench.answers.last(), Some(&b'!'), "{context}");
        // The button alone repairs nothing.
        let table = bench.place[..2].to_vec();
        bench.answers.clear();
        bench.drill.reset();
        while bench.go() {}
        assert_eq!(bench.place[..2], table, "{context}");
        assert!(!bench.drill.is_homed(), "{context}");
        bench.repair();
        assert_eq!(bench.place, [0; 3], "{context}");
        assert_eq!(bench.answers, b"B", "{context}");
    }
}

/// The power comes on with the bit in the board, at any depth, and the upper sensor sticks closed
/// while Z rises, at any height, or was closed before. X and Y do not move, and the bit goes down a
/// little only, never beyond the lower sensor.
#[test]
fn the_first_homing_finds_an_upper_sensor_that_sticks() {
    let heights = (0..=Bench::STROKE).flat_map(|from| {
        let below = (1..from).step_by(7).chain([from - 1, from]);
        below.filter(|at| *at > 0).map(move |at| (from, at))
    });
    for (from, at) in heights {
        let context = format!("from {from}, sticks at {at}");
        let mut bench = Bench::switched_on(from);
        bench.sticks = Some((0, at, true));
        bench.is_stuck = at == from;
        let [x, y, _] = bench.place;
        while bench.event() != DrillEvent::Idle {
            assert_eq!(bench.place[..2], [x, y], "{context}");
            let lowest = (at + Bench::UPPER_OPENS).min(Bench::STROKE).max(from);
            assert!(bench.place[2] <= lowest, "{context}: {:?}", bench.place);
        }
        assert_eq!(bench.answers, b"!", "{context}");
        // The button alone repairs nothing.
        bench.answers.clear();
        bench.drill.reset();
        while bench.go() {}
        assert_eq!(bench.place[..2], [x, y], "{context}");
        assert_eq!(bench.answers, b"!", "{context}");
        bench.repair();
        assert_eq!(bench.place, [0; 3], "{context}");
        assert_eq!(bench.answers, b"B", "{context}");
    }
}

/// An upper sensor that works is seen to open and to close again before X or Y moves, wherever Z
/// stands first and however far below the closing point it opens. Z goes no deeper than that.
#[test]
fn the_first_homing_leaves_the_upper_sensor_and_finds_it_again() {
    let starts = (-3..30).flat_map(|from| [0, 1, 16].map(|play| (from, play)));
    for (from, play) in starts {
        let mut bench = Bench::switched_on(from);
        let (mut deepest, mut is_up, mut closings) = (from, from <= 0, 0);
        loop {
            let z = bench.place[2];
            let was_up = is_up;
            is_up = z <= if was_up { play } else { 0 };
            closings += u32::from(is_up && !was_up);
            deepest = deepest.max(z);
            let mut inputs = bench.inputs();
            inputs.is_up = is_up;
            match bench.drill.next_event(&inputs) {
                DrillEvent::Step(step) => {
                    let is_sure = closings >= if from > 0 { 2 } else { 1 };
                    assert!(
                        step.delta[2] != 0 || is_sure,
                        "from {from}: X or Y moves first"
                    );
                    for (place, delta) in bench.place.iter_mut().zip(step.delta) {
                        *place += i32::from(delta);
                    }
                }
                DrillEvent::Report(DrillReport::Homed) => break,
                DrillEvent::Report(report) => panic!("{report:?} from {from}, play {play}"),
                _ => {}
            }
        }
        assert_eq!(bench.place, [0; 3], "from {from}, play {play}");
        assert_eq!(
            closings,
            if from > 0 { 2 } else { 1 },
            "from {from}, play {play}"
        );
        assert_eq!(deepest, from.max(play + 1), "from {from}, play {play}");
    }
}

/// A jog of Z finds a sensor that sticks closed.
#[test]
fn a_jog_finds_a_sensor_of_z_that_sticks() {
    for (before, begins, sticks) in [
        (&b"M\xff"[..], b'L', (0, 30, false)),
        (b"M\xff", b'L', (1, 100, false)),
        (b"M\xffL", b'U', (0, 150, true)),
        (b"M\xffLL", b'U', (1, 200, true)),
    ] {
        let mut bench = Bench::homed();
        bench.say(before);
        bench.sticks = Some(sticks);
        bench.hear(begins);
        while bench.go() {}
        assert_eq!(bench.answers.last(), Some(&b'!'), "{sticks:?}");
    }
}
