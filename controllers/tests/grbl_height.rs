//! The height map of the Grbl controller: its dialogue, its measurement, and that Z follows it.

use husillo_controllers::{
    Controller, Grbl, GrblEvent, GrblInputs, GrblMemory, GrblOptions, Timed,
};
use husillo_transports::grbl::Settings;
use proptest::prelude::*;

/// Steps per millimetre of each axis.
const STEPS: f64 = 250.0;
/// Highest rate of Z, in mm/min.
const Z_RATE: u64 = 1200;

/// One event that moves motors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Step {
    us: u64,
    delta: [i8; 3],
}

/// A controller with its motors and a surface below the tool.
struct Driven {
    grbl: Grbl,
    motors: [i32; 3],
    us: u64,
    said: String,
    steps: Vec<Step>,
    stored: u32,
    /// Height of the surface in steps at a place in steps.
    surface: fn([i32; 3]) -> f64,
}

fn memory(changes: &[(u8, &str)]) -> GrblMemory {
    let mut settings = Settings::DEFAULT;
    for number in 110..113 {
        settings.write(number, b"3000").unwrap();
        settings.write(number + 10, b"300").unwrap();
    }
    settings.write(112, Z_RATE.to_string().as_bytes()).unwrap();
    for (number, value) in changes {
        settings.write(*number, value.as_bytes()).unwrap();
    }
    GrblMemory::FACTORY.with_settings(settings)
}

impl Driven {
    fn new(options: GrblOptions, memory: &GrblMemory) -> Self {
        let mut driven = Driven {
            grbl: Grbl::new(options, Some(memory)),
            motors: [0; 3],
            us: 0,
            said: String::new(),
            steps: Vec::new(),
            stored: 0,
            surface: |_| f64::NEG_INFINITY,
        };
        driven.run(None);
        driven.said.clear();
        driven
    }

    /// Makes all events, or those of a time.
    fn run(&mut self, us: Option<u64>) {
        let end = us.map(|us| self.us + us);
        while end.is_none_or(|end| self.us < end) {
            let said = std::iter::from_fn(|| self.grbl.transmit());
            self.said.extend(said.map(char::from));
            let inputs = GrblInputs {
                probe: f64::from(self.motors[2]) > (self.surface)(self.motors),
                ..GrblInputs::default()
            };
            let Some(event) = self.grbl.next_event(0, &inputs) else {
                return;
            };
            self.stored += u32::from(event == GrblEvent::Store);
            let Some(wait) = event.wait_ticks() else {
                continue;
            };
            self.us += u64::from(wait);
            if let GrblEvent::Step { delta, .. } = event {
                for (motor, delta) in self.motors.iter_mut().zip(delta) {
                    *motor += i32::from(delta);
                }
                self.steps.push(Step { us: self.us, delta });
            }
            self.grbl.made(0, 1);
            assert_eq!(self.grbl.position_steps(), self.motors);
        }
    }

    fn send(&mut self, text: &str) {
        for byte in text.bytes() {
            if self.grbl.receive(byte) {
                self.grbl.halted();
            }
        }
    }

    /// Sends lines, and returns what the controller says.
    fn ask(&mut self, lines: &str) -> String {
        // The inputs are read.
        self.run(None);
        self.said.clear();
        for line in lines.lines() {
            self.send(line);
            self.send("\n");
            self.run(None);
        }
        std::mem::take(&mut self.said).replace("\r\n", "\n")
    }

    /// The position that the controller reports, in steps.
    fn reported(&mut self) -> [i32; 3] {
        self.said.clear();
        self.us += 1000;
        self.send("?");
        self.run(Some(2000));
        let report = std::mem::take(&mut self.said);
        let fields = report.split("MPos:").nth(1).unwrap();
        let fields = fields.split('|').next().unwrap();
        let steps = fields.split(',').map(|mm| {
            let mm: f64 = mm.trim_end_matches(['>', '\r', '\n']).parse().unwrap();
            (mm * STEPS).round() as i32
        });
        steps.collect::<Vec<_>>().try_into().unwrap()
    }
}

/// A map with the corners at 0 and at 30 by 20 mm, and its heights in thousandths of a millimetre.
#[derive(Clone, Debug)]
struct Map {
    columns: usize,
    rows: usize,
    heights: Vec<i32>,
}

impl Map {
    fn lines(&self) -> String {
        let mut lines = format!("$ZG=0,0,30,20,{},{}\n", self.columns, self.rows);
        for (number, height) in self.heights.iter().enumerate() {
            lines += &format!("$Z{number}={}\n", f64::from(*height) / 1000.0);
        }
        lines
    }

    /// The height in steps at a place in steps.
    fn steps(&self, x: i32, y: i32) -> f64 {
        let part = |at: i32, size: f64, points: usize| {
            let at = (f64::from(at) / STEPS / size).clamp(0.0, 1.0) * (points - 1) as f64;
            let cell = (at as usize).min(points - 2);
            (cell, at - cell as f64)
        };
        let (column, u) = part(x, 30.0, self.columns);
        let (row, v) = part(y, 20.0, self.rows);
        let height = |c: usize, r: usize| {
            f64::from(self.heights[(row + r) * self.columns + column + c]) / 1000.0 * STEPS
        };
        let low = height(0, 0) * (1.0 - u) + height(1, 0) * u;
        let high = height(0, 1) * (1.0 - u) + height(1, 1) * u;
        low * (1.0 - v) + high * v
    }
}

#[test]
fn a_map_is_written_shown_and_kept() {
    let mut mill = Driven::new(GrblOptions::FULL, &memory(&[]));
    assert_eq!(mill.ask("$Z"), "[MAP:0,0.000,0.000,0.000,0.000,0,0]\nok\n");
    assert_eq!(mill.ask("$Z=1"), "error:3\n");
    mill.ask("G10L20P1X-5Y-1");
    assert_eq!(mill.ask("$ZG=-5,-1,30,20,3,2"), "ok\n");
    assert_eq!(mill.ask("$Z1=0.05\n$Z5=-.025"), "ok\nok\n");
    let shown = "[MAP:0,-5.000,-1.000,30.000,20.000,3,2]\n\
                 [HEIGHTS:0,0.000,0.050,0.000]\n[HEIGHTS:1,0.000,0.000,-0.025]\nok\n";
    assert_eq!(mill.ask("$Z"), shown);
    let before = *mill.grbl.memory();
    for line in [
        "$Z6=1",
        "$Z-1=1",
        "$Z1",
        "$ZG=0,0,30,20,1,2",
        "$ZG=0,0,30,20,17,2",
        "$ZG=0,0,0,20,2,2",
        "$ZG=0,0,30,20,2",
        "$ZG=0,0,30,20,2,2,2",
        "$ZG=0,0,30,20,2.5,2",
        "$ZP=0,100",
        "$ZP=5,0",
        "$ZP=5",
        "$ZQ",
        "$Z=2",
        "$Z0=99999",
    ] {
        assert!(mill.ask(line).starts_with("error:"), "{line}");
        assert_eq!(*mill.grbl.memory(), before, "{line}");
    }
    // 7.5 mm from the first point, between 0 and 0.05.
    assert_eq!(mill.ask("G0X2.5Y-1\n$ZZ"), "ok\nok\n");
    assert!(mill.ask("$Z").contains("[HEIGHTS:0,-0.025,0.025,-0.025]\n"));
    // It is stored, but not switched on at the next start.
    let kept = GrblMemory::from_bytes(&mill.grbl.memory().to_bytes()).unwrap();
    let mut mill = Driven::new(GrblOptions::FULL, &kept);
    assert!(
        mill.ask("$Z")
            .contains("[MAP:0,-5.000,-1.000,30.000,20.000,3,2]\n")
    );
    assert_eq!(mill.ask("$ZC"), "ok\n");
    assert!(mill.ask("$Z").contains("[MAP:0,0.000,0.000,"));
    assert_eq!(mill.stored, 1);
}

#[test]
fn switching_moves_nothing_and_z_follows_from_the_next_move_on() {
    let mut mill = Driven::new(GrblOptions::FULL, &memory(&[]));
    mill.ask("$ZG=0,0,30,20,2,2\n$Z1=0.4\n$Z3=0.4\nG0X15Z2");
    let (motors, steps) = (mill.motors, mill.steps.len());
    assert_eq!(mill.ask("$Z=1"), "ok\n");
    assert_eq!((mill.motors, mill.steps.len()), (motors, steps));
    // 0.2 mm are 50 steps.
    assert_eq!(mill.reported(), [3750, 0, 450]);
    mill.ask("G0Z2");
    assert_eq!(mill.motors, [3750, 0, 550]);
    mill.ask("G1X30F600");
    assert_eq!(mill.motors, [7500, 0, 600]);
    assert_eq!(mill.reported(), [7500, 0, 500]);
    // Beyond the grid the height stays.
    mill.ask("G1X33");
    assert_eq!(mill.motors, [8250, 0, 600]);
    for line in ["$ZC", "$ZG=0,0,1,1,2,2", "$Z1=0", "$ZZ", "$ZP=1,100"] {
        assert_eq!(mill.ask(line), "error:8\n", "{line}");
    }
    assert_eq!(mill.ask("$Z=0"), "ok\n");
    assert_eq!(mill.reported(), [8250, 0, 600]);
}

/// A twisted and tilted board.
fn board([x, y, _]: [i32; 3]) -> f64 {
    let (x, y) = (f64::from(x) / STEPS, f64::from(y) / STEPS);
    (-8.0 + 0.01 * x - 0.004 * y + 0.0005 * x * y) * STEPS
}

#[test]
fn the_machine_measures_the_map() {
    let mut mill = Driven::new(GrblOptions::FULL, &memory(&[]));
    mill.surface = board;
    mill.ask("G0X2Y3Z-5");
    let answer = mill.ask("$ZG=0,0,30,20,4,3\n$ZP=6,150");
    assert_eq!(answer.matches("[PRB:").count(), 12, "{answer}");
    assert!(answer.ends_with("ok\n"));
    assert_eq!(mill.stored, 2);
    // The last point of the second change of direction, at the height of the start.
    assert_eq!(mill.motors, [7500, 5000, -1250]);
    let shown = mill.ask("$Z");
    for row in 0..3 {
        let name = format!("[HEIGHTS:{row},");
        let line = shown.split(&name).nth(1).unwrap();
        let line = line.split(']').next().unwrap();
        for (column, mm) in line.split(',').enumerate() {
            let place = [column as i32 * 2500, row * 2500, 0];
            let expected = (board(place) - board([0; 3])) / STEPS;
            let mm: f64 = mm.parse().unwrap();
            assert!(
                (mm - expected).abs() <= 1.01 / STEPS,
                "{row} {column}: {mm}"
            );
        }
    }
    // With Z zero on the surface at the first point, the tool stays on it. 2 steps: one of a
    // contact, and one of the follower.
    mill.ask("G0X0Y0\nG38.2Z-20F150\nG10L20P1Z0\nG0Z1");
    mill.surface = |_| f64::NEG_INFINITY;
    mill.ask("$Z=1\nG0Z.1\nG1Z0F300");
    for line in ["X30Y20", "X10Y18", "G2X20Y5I4J-9", "G1X0Y20", "X0Y0"] {
        mill.ask(line);
        let distance = f64::from(mill.motors[2]) - board(mill.motors);
        assert!(distance.abs() <= 2.5, "{line}: {distance}");
    }
}

#[test]
fn a_failed_measurement_keeps_the_map() {
    let mut mill = Driven::new(GrblOptions::FULL, &memory(&[]));
    mill.ask("$ZG=0,0,30,20,4,3\n$Z3=0.5");
    let kept = *mill.grbl.memory();
    mill.surface = |[x, _, _]| if x < 5000 { -100.0 } else { f64::NEG_INFINITY };
    let answer = mill.ask("$ZP=1,100");
    assert!(answer.contains("ALARM:5\n"), "{answer}");
    assert_eq!(*mill.grbl.memory(), kept);
    assert_eq!(mill.ask("$ZP=1,100"), "error:9\n");
    // The next probe move is an ordinary one.
    mill.surface = |_| f64::NEG_INFINITY;
    assert_eq!(mill.ask("$X"), "[MSG:Caution: Unlocked]\nok\n");
    assert!(mill.ask("G38.3Z-2F100").contains(":0]\nok\n"));
    // A probe that is closed before it moves.
    mill.ask("G0X0Y0Z0");
    mill.surface = |_| f64::INFINITY;
    assert!(mill.ask("$ZP=1,100").contains("ALARM:4\n"));
    mill.surface = |_| -100.0;
    mill.ask("$X");
    assert_eq!(mill.ask("G38.2Z-1F100"), "[PRB:0.000,0.000,-0.400:1]\nok\n");
    assert_eq!(*mill.grbl.memory(), kept);
    // A measurement that is reset.
    mill.ask("G0Z0");
    mill.send("$ZP=1,100\n");
    mill.run(Some(3_000_000));
    mill.send("\x18");
    mill.run(None);
    assert!(mill.said.contains("ALARM:3\r\n"), "{}", mill.said);
    assert_eq!(*mill.grbl.memory(), kept);
    mill.ask("$X\nG0Z0");
    assert!(mill.ask("G38.2Z-1F100").ends_with(":1]\nok\n"));
}

#[test]
fn resets_and_homing_switch_the_map_off() {
    let changes = [(22, "1"), (20, "1"), (130, "50"), (131, "50"), (132, "50")];
    let mut mill = Driven::new(GrblOptions::FULL, &memory(&changes));
    mill.ask("$X\nG10L2P1X-50Y-50Z-20");
    mill.ask("$ZG=0,0,30,20,2,2\n$Z0=0.3\n$Z1=0.2\n$Z2=-.5");
    // Axes that are not homed are at 0, where no corrected position may be.
    assert!(mill.ask("$Z=1\nG53G0X0Y0Z0").contains("ALARM:2"));
    mill.send("\x18");
    mill.run(None);
    assert!(mill.said.contains("[MSG:Height map off]"), "{}", mill.said);
    mill.ask("$X\nG53G0X-20Y-30Z-5\n$Z=1");
    assert!(mill.ask("$Z").starts_with("[MAP:1,"));
    let before = mill.motors;
    mill.send("\x18");
    mill.run(None);
    assert!(mill.said.contains("[MSG:Height map off]"));
    assert_eq!(mill.reported(), before);
    mill.ask("$X");
    assert!(mill.ask("$Z").starts_with("[MAP:0,"));
    mill.ask("$Z=1");
    mill.send("$H\n");
    mill.run(Some(500_000));
    assert!(mill.said.contains("[MSG:Height map off]"));
}

#[test]
fn soft_limits_hold_for_the_corrected_position() {
    let changes = [(22, "1"), (20, "1"), (130, "50"), (131, "50"), (132, "50")];
    let mut mill = Driven::new(GrblOptions::FULL, &memory(&changes));
    mill.ask("$X\nG53G0X-10Y-10Z-5\nG10L20P1X0Y0Z0");
    assert_eq!(mill.ask("$ZG=-30,-30,50,20,2,2"), "ok\n");
    assert_eq!(mill.ask("$ZP=5,100"), "error:15\n");
    mill.ask("$ZG=-30,-30,30,20,2,2");
    assert_eq!(mill.ask("$ZP=46,100"), "error:15\n");
    mill.ask("$Z0=0.3\n$Z1=-.5\n$Z2=0\n$Z=1");
    // From -50 + 0.5 to -0.3.
    assert_eq!(mill.ask("$J=G53Z-.31F900"), "ok\n");
    assert_eq!(mill.ask("$J=G53Z-.29F900"), "error:15\n");
    assert_eq!(mill.ask("$J=G53Z-49.4F900"), "ok\n");
    assert_eq!(mill.ask("$J=G53Z-49.6F900"), "error:15\n");
    assert_eq!(
        mill.ask("$Z=0\n$J=G53Z-.29F900\n$J=G53Z-49.6F900"),
        "ok\nok\nok\n"
    );
}

/// The engine's limits for a map keep Z within its own, and a changed setting keeps the map on.
#[test]
fn settings_may_change_while_the_map_is_on() {
    let mut mill = Driven::new(GrblOptions::FULL, &memory(&[]));
    mill.ask("$ZG=0,0,30,20,2,2\n$Z1=0.4\n$Z3=0.4\nG0X15\n$Z=1\nG0Z0");
    assert_eq!(mill.motors, [3750, 0, 50]);
    mill.ask("$110=1500\n$10=1");
    assert!(mill.ask("$Z").starts_with("[MAP:1,"));
    assert_eq!(mill.reported(), [3750, 0, 0]);
    mill.ask("G1X30F900");
    assert_eq!(mill.motors, [7500, 0, 100]);
    // A steep map is slow: 0.4 mm on 0.5 mm may take one quarter of the rate of Z.
    mill.ask("$Z=0\n$ZG=0,0,.5,20,2,2\n$Z1=0.4\n$Z3=0.4\n$Z=1\nG0X0");
    let (start, first) = (mill.us, mill.steps.len());
    mill.ask("G0X10");
    let fastest = mill.steps[first..]
        .windows(2)
        .map(|pair| pair[1].us - pair[0].us);
    let hz = 1_000_000 / fastest.min().unwrap();
    assert!(hz <= 2 * Z_RATE * 250 / 60, "{hz}");
    assert!(mill.us - start > 1_000_000);
}

/// The protocol of grblHAL has the same commands.
#[test]
fn grblhal_has_the_map() {
    let mut mill = Driven::new(GrblOptions::HAL, &memory(&[]));
    mill.ask("$zg=0, 0, 30, 20, 2, 2\n$Z1=0.4\n$Z3=0.4\nG0X15\n$Z=1\nG0Z0");
    assert_eq!(mill.motors, [3750, 0, 50]);
    assert!(mill.ask("$Z").starts_with("[MAP:1,0.000,"));
}

/// Without the option there is no map.
#[test]
fn grbl_as_it_is_distributed_has_no_map() {
    let mut mill = Driven::new(GrblOptions::STOCK, &memory(&[]));
    for line in ["$Z", "$Z=1", "$ZG=0,0,1,1,2,2"] {
        assert_eq!(mill.ask(line), "error:3\n");
    }
}

fn map() -> impl Strategy<Value = Map> {
    (2_usize..6, 2_usize..5, any::<bool>()).prop_flat_map(|(columns, rows, is_rough)| {
        let most = if is_rough { 1500 } else { 120 };
        prop::collection::vec(-most..=most, columns * rows).prop_map(move |heights| Map {
            columns,
            rows,
            heights,
        })
    })
}

/// A move of a program with absolute coordinates.
fn line() -> impl Strategy<Value = String> {
    let place = (-20..350_i32, -20..230_i32, -30..30_i32);
    let mm = |tenths: i32| f64::from(tenths) / 10.0;
    prop_oneof![
        (place.clone(), 200..3000_u32).prop_map(move |((x, y, z), feed)| {
            format!("G1X{}Y{}Z{}F{feed}", mm(x), mm(y), mm(z))
        }),
        place
            .clone()
            .prop_map(move |(x, y, _)| format!("G0X{}Y{}", mm(x), mm(y))),
        (
            10..60_i32,
            prop::sample::select(vec![17, 18, 19]),
            300..2000_u32
        )
            .prop_map(move |(radius, plane, feed)| {
                // A full circle.
                let letter = if plane == 17 { 'J' } else { 'K' };
                format!("G{plane}G3{letter}{}F{feed}\nG17", mm(radius))
            }),
        (-40..40_i32, -40..40_i32)
            .prop_map(move |(x, y)| { format!("$J=G91X{}Y{}F2500", mm(x), mm(y)) }),
    ]
}

/// The positions after each step of X or Y, for motors that start at 0, 0 and this Z.
fn places(steps: &[Step], z: i32) -> Vec<[i32; 3]> {
    let mut at = [0, 0, z];
    let mut places = Vec::new();
    for step in steps {
        for (at, delta) in at.iter_mut().zip(step.delta) {
            *at += i32::from(delta);
        }
        if step.delta[..2] != [0; 2] {
            places.push(at);
        }
    }
    places
}

fn circle_words(lines: &[String]) -> String {
    // A circle needs a word of its plane.
    lines
        .iter()
        .map(|line| match line.split_once("G3") {
            Some((plane, rest)) => {
                let axis = if plane == "G19" { 'Y' } else { 'X' };
                format!("{plane}G91G3{axis}0{rest}\nG90\n")
            }
            None => format!("{line}\n"),
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// X and Y make the steps of the program. Z is within 2 steps of the surface at each of them,
    /// and within 0.7 at rest. Steps of Z keep their distance in time.
    #[test]
    fn z_follows_the_surface(map in map(), lines in prop::collection::vec(line(), 1..8)) {
        let lines = circle_words(&lines);
        let mut plain = Driven::new(GrblOptions::FULL, &memory(&[]));
        plain.ask(&lines);
        let mut mill = Driven::new(GrblOptions::FULL, &memory(&[]));
        mill.ask(&map.lines());
        prop_assert!(mill.ask("$Z=1\nG0Z0").ends_with("ok\n"));
        let (first, start) = (mill.steps.len(), mill.motors[2]);
        prop_assert!((f64::from(start) - map.steps(0, 0)).abs() <= 0.7);
        let mut last_us = None;
        for line in lines.lines() {
            let before = mill.steps.len();
            mill.ask(line);
            for step in &mill.steps[before..] {
                if step.delta[2] != 0 {
                    let spacing = last_us.map_or(u64::MAX, |last| step.us - last);
                    prop_assert!(spacing >= 500_000 / (Z_RATE * 250 / 60), "{spacing} us");
                    last_us = Some(step.us);
                }
            }
            let [x, y, z] = mill.reported();
            prop_assert_eq!([x, y], [mill.motors[0], mill.motors[1]]);
            let error = f64::from(mill.motors[2] - z) - map.steps(x, y);
            prop_assert!(error.abs() <= 0.7, "{} off after {}", error, line);
        }
        prop_assert_eq!(mill.reported(), plain.reported());
        // The program's Z at each step of X or Y is that of the run without a map.
        let (program, corrected) = (places(&plain.steps, 0), places(&mill.steps[first..], start));
        prop_assert_eq!(program.len(), corrected.len());
        for ([x, y, program_z], [at_x, at_y, z]) in program.into_iter().zip(corrected) {
            prop_assert_eq!([x, y], [at_x, at_y]);
            let error = f64::from(z - program_z) - map.steps(x, y);
            prop_assert!(error.abs() <= 2.0, "{} off at {} {}", error, x, y);
        }
    }

    /// While only X and Y move, the motor of Z alone shows the surface.
    #[test]
    fn z_is_on_the_surface_after_every_step(
        map in map(),
        places in prop::collection::vec((-20..350_i32, -20..230_i32), 1..6),
    ) {
        let mut mill = Driven::new(GrblOptions::FULL, &memory(&[]));
        mill.ask(&map.lines());
        mill.ask("$Z=1\nG0Z0");
        let (mut at, first) = (mill.motors, mill.steps.len());
        for (x, y) in places {
            mill.send(&format!("G0X{}Y{}\n", f64::from(x) / 10.0, f64::from(y) / 10.0));
        }
        mill.run(None);
        for step in &mill.steps[first..] {
            for (at, delta) in at.iter_mut().zip(step.delta) {
                *at += i32::from(delta);
            }
            let error = f64::from(at[2]) - map.steps(at[0], at[1]);
            prop_assert!(error.abs() <= 1.7, "{} off at {:?}", error, at);
        }
    }

    /// A level map changes no step and no time.
    #[test]
    fn a_level_map_changes_nothing(lines in prop::collection::vec(line(), 1..10)) {
        let lines = circle_words(&lines);
        let [mut plain, mut mill] =
            [(); 2].map(|()| Driven::new(GrblOptions::FULL, &memory(&[])));
        mill.ask("$ZG=0,0,30,20,3,3\n$Z=1");
        for driven in [&mut plain, &mut mill] {
            driven.us = 0;
            driven.ask(&lines);
        }
        prop_assert_eq!(plain.steps, mill.steps);
    }

    /// Holds and resets at any time lose no step: what is reported is the program's position.
    #[test]
    fn the_position_stays_known(map in map(), at_ms in 1..900_u64, resets in any::<bool>()) {
        let mut mill = Driven::new(GrblOptions::FULL, &memory(&[]));
        mill.ask(&map.lines());
        mill.ask("$Z=1\nG0Z0");
        mill.send("G1X30Y20F2800\n");
        mill.run(Some(at_ms * 1000));
        if resets {
            mill.send("\x18");
            mill.run(None);
            let motors = mill.motors;
            prop_assert_eq!(mill.reported(), motors);
            return Ok(());
        }
        mill.send("!");
        mill.run(Some(400_000));
        let [x, y, z] = mill.reported();
        let error = f64::from(mill.motors[2] - z) - map.steps(x, y);
        prop_assert!(error.abs() <= 0.7, "{}", error);
        mill.send("~");
        mill.run(None);
        prop_assert_eq!(mill.reported(), [7500, 5000, 0]);
    }
}
