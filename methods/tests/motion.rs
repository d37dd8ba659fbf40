//! Rules of motion on small programs whose figures are known.

use husillo_gcode::{Block, Dialect, Modal, Nm};
use husillo_machine::{
    Axis, AxisRamp, Config, Equipment, Event, Machine, Scale, SmoothRamp, backlash::Backlash,
    interp::Path,
};
use husillo_methods::motion::{Course, Figures, Piece, Profile, Rule, Settings};

const ACCELERATION: f64 = 500.0;

/// Steps of 2.5 um, 500 mm/s^2, 200 mm/s, corners by 10 um.
fn config() -> Config<3> {
    let axis = Axis {
        scale: Scale::new(2_500, 1).unwrap(),
        travel: None,
        max_rate_hz: 80_000,
        backlash_steps: 0,
        ramp: Some(AxisRamp {
            acceleration_hz_per_s: 200_000,
            start_rate_hz: 0,
            jerk_hz_per_s2: None,
            junction_hz: None,
        }),
    };
    Config {
        axes: [axis; 3],
        timer_hz: 1_000_000,
        dialect: Dialect::GRBL,
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        spindle_counts: None,
        corner_deviation: Some(Nm(10_000)),
        equipment: Equipment::NONE,
    }
}

fn course(lines: &[&str]) -> Course<3> {
    course_of(config(), lines)
}

fn course_of(config: Config<3>, lines: &[&str]) -> Course<3> {
    let mut course = Course::new(config, [Nm(0); 3]).unwrap();
    let mut modal = Modal::<3>::new(Dialect::GRBL);
    for line in lines {
        let block = Block::parse(line.as_bytes(), &Dialect::GRBL).unwrap();
        let (after, commands) = modal.plan(&block).unwrap();
        modal = after;
        for command in commands {
            course.push(&command);
        }
    }
    course
}

fn figures(lines: &[&str], rule: Rule) -> (Figures, Profile) {
    let profile = course(lines).profile(rule, &Settings::default()).unwrap();
    (Figures::of(rule, &profile), profile)
}

/// Path of a profile in mm.
fn path(profile: &Profile) -> f64 {
    let pieces = profile.pieces.iter();
    pieces
        .map(|piece| {
            let time = piece.seconds;
            time * (piece.speed + time * (piece.acceleration / 2.0 + piece.jerk * time / 6.0))
        })
        .sum()
}

const PART: [&str; 7] = [
    "G1 X30 F6000",
    "G1 Y20",
    "G3 X20 Y30 I-10 J0",
    "G1 X0",
    "G2 X-4 Y34 I0 J4",
    "G1 X-4.02 Y34.5",
    "G0 X0 Y0",
];

#[test]
fn every_rule_makes_the_whole_path() {
    // Lines of 30, 20, 20, 0.50 and 34.73 mm, and quarters of circles of 10 and 4 mm.
    let quarters = 14.0 * std::f64::consts::FRAC_PI_2;
    let lines = 70.0 + 0.02_f64.hypot(0.5) + 4.02_f64.hypot(34.5);
    let exact = lines + quarters;
    for rule in Rule::ALL {
        let (_, profile) = figures(&PART, rule);
        let path = path(&profile);
        let most = match rule {
            Rule::Trapezoid | Rule::Jerk => 1e-4,
            // Chords are shorter than arcs.
            _ => 0.1,
        };
        assert!((path - exact).abs() < most, "{rule:?}: {path} {exact}");
        let end = profile.pieces.last().unwrap();
        assert!(end.speed_at(end.seconds).abs() < 1e-3, "{rule:?}");
    }
}

/// The trapezoid takes the time of the events of the machine.
#[test]
fn the_trapezoid_is_that_of_the_machine() {
    let mut machine: Machine<3> = Machine::new(config());
    for line in PART {
        machine.line(line.as_bytes()).unwrap();
    }
    let events = std::iter::from_fn(|| machine.next_event());
    let ticks: u64 = events
        .map(|event| match event {
            Event::Step(step) => u64::from(step.wait_ticks),
            _ => 0,
        })
        .sum();
    let (figures, _) = figures(&PART, Rule::Trapezoid);
    let seconds = ticks as f64 / 1e6;
    let ratio = figures.seconds / seconds;
    assert!((ratio - 1.0).abs() < 2e-3, "{} {seconds}", figures.seconds);
}

#[test]
fn our_rules_keep_the_limits() {
    let (trapezoid, _) = figures(&PART, Rule::Trapezoid);
    // Along the last line, which is oblique, the axes allow more.
    let limit = ACCELERATION * 4.02_f64.hypot(34.5) / 34.5;
    let limit = limit * 1.000_1;
    assert!(trapezoid.whole_acceleration < limit, "{trapezoid:?}");
    assert_eq!(trapezoid.jerk, None);
    let (jerk, _) = figures(&PART, Rule::Jerk);
    assert!(jerk.whole_acceleration < limit, "{jerk:?}");
    // The least acceleration is that along an arc, 0.866 of the whole.
    let most = 0.8661 * ACCELERATION / Settings::default().window.unwrap();
    assert!(jerk.jerk.is_some_and(|jerk| jerk < most), "{jerk:?} {most}");
    assert!(
        jerk.seconds < 1.3 * trapezoid.seconds,
        "{jerk:?} {trapezoid:?}"
    );
}

/// Grbl does not limit the speed on arcs. At 100 mm/s on 4 mm it has 5 times the acceleration.
#[test]
fn grbl_exceeds_the_acceleration_on_arcs() {
    let circle = ["G1 X30 F6000", "G3 X30 Y8 I0 J4", "G1 X0"];
    let (grbl, _) = figures(&circle, Rule::Grbl);
    assert!(grbl.whole_acceleration > 2.0 * ACCELERATION, "{grbl:?}");
    let (ours, _) = figures(&circle, Rule::Trapezoid);
    assert!(ours.whole_acceleration < 1.001 * ACCELERATION, "{ours:?}");
}

#[test]
fn corners_follow_the_published_formulas() {
    let corner = ["G1 X30 F6000", "G1 Y30"];
    // v^2 = a d s / (1 - s), s = sin 45 degrees; along the diagonal the axes give a sqrt(2).
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let diagonal = 2.0_f64.sqrt();
    let speed = (ACCELERATION * diagonal * 0.01 * half / (1.0 - half)).sqrt();
    let (grbl, _) = figures(&corner, Rule::Grbl);
    assert!(
        (grbl.corner_jump - speed * diagonal).abs() < 1e-6,
        "{grbl:?}"
    );
    // A right angle is passed at the square corner velocity.
    let (klipper, _) = figures(&corner, Rule::Klipper);
    assert!(
        (klipper.corner_jump - 5.0 * diagonal).abs() < 1e-6,
        "{klipper:?}"
    );
    assert_eq!((klipper.junctions, klipper.dips, klipper.stops), (1, 1, 0));
}

/// The figure of limited jerk is what a machine with this jerk makes of the program.
#[test]
fn the_jerk_is_that_of_the_machine() {
    let mut config = config();
    for axis in &mut config.axes {
        axis.ramp.as_mut().unwrap().jerk_hz_per_s2 = Some(8_660_000); // a window of 20 ms
    }
    let mut machine: Machine<3, Path<3>, Backlash, 16, (), SmoothRamp> = Machine::new(config);
    for line in PART {
        machine.line(line.as_bytes()).unwrap();
    }
    let events = std::iter::from_fn(|| machine.next_event());
    let ticks: u64 = events
        .map(|event| match event {
            Event::Step(step) => u64::from(step.wait_ticks),
            _ => 0,
        })
        .sum();
    let own = Settings {
        window: None,
        ..Settings::default()
    };
    let profile = course_of(config, &PART).profile(Rule::Jerk, &own).unwrap();
    let seconds = ticks as f64 / 1e6;
    let ratio = profile.seconds() / seconds;
    assert!(
        (ratio - 1.0).abs() < 1e-5,
        "{} {seconds}",
        profile.seconds()
    );
    // The same window, given in place of the jerk.
    let (given, _) = figures(&PART, Rule::Jerk);
    assert!(
        (given.seconds / seconds - 1.0).abs() < 1e-5,
        "{}",
        given.seconds
    );
}

/// A picture has no gaps: every column from the start to the end has the values of its time.
#[test]
fn every_column_has_values() {
    let ramp = Piece {
        seconds: 0.7,
        acceleration: 10.0,
        ..Piece::default()
    };
    let cruise = Piece {
        seconds: 3.1,
        speed: 7.0,
        ..Piece::default()
    };
    let profile = Profile {
        pieces: vec![ramp, cruise],
        ..Profile::default()
    };
    for count in 1..500 {
        let width = profile.seconds() / count as f64;
        for (number, column) in profile.columns(count, width).iter().enumerate() {
            let (begin, end) = (number as f64 * width, (number + 1) as f64 * width);
            let [low, high] = [begin, end].map(|at| 10.0 * at.min(0.7));
            assert!((column[0].low - low).abs() < 1e-9, "{count}: {number}");
            assert!((column[0].high - high).abs() < 1e-9, "{count}: {number}");
            assert!(column[1].low <= column[1].high && column[2].low <= column[2].high);
        }
    }
}
