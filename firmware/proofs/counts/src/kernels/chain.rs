//! From text to moves, and the whole chain after the text: path, take-up, timer.

use core::hint::black_box;

use husillo_backlash::Backlash;
use husillo_controllers::ServoModule;
use husillo_gcode::{Dialect, Nm};
use husillo_interp::Path;
use husillo_machine::{
    Axis, AxisEncoder, AxisRamp, ClosedLoop, Config, Equipment, Event, Followed, Machine, OnLoss,
    Scale, ServoInputs, StepEvent,
};
use husillo_transports::nmc::{Command, Gains, Mode, Stop, StopMode, Trajectory};

use crate::Count;

const EVENTS: u32 = 1000;

/// A place in the queue of three axes has at most 208 bytes on a 32-bit processor.
#[cfg(target_pointer_width = "32")]
const _: () = {
    const fn bytes<const QUEUE: usize>() -> usize {
        size_of::<Machine<3, Path<3>, Backlash, QUEUE>>()
    }
    assert!(bytes::<24>().wrapping_sub(bytes::<23>()) <= 208);
};

pub fn all(count: Count<'_>) {
    machine(count);
    closed_loop(count);
    servo_module(count);
}

fn config() -> Option<Config<3>> {
    let scale = Scale::new(140, 1)?;
    let axis = Axis {
        scale,
        travel: None,
        max_rate_hz: 170,
        backlash_steps: 1457,
        ramp: None,
    };
    Some(Config {
        axes: [axis; 3],
        timer_hz: 1_000_000,
        dialect: Dialect::RS274,
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        corner_deviation: None,
        equipment: Equipment::NONE,
        spindle_counts: None,
    })
}

#[inline(never)]
fn machine(count: Count<'_>) {
    let Some(config) = config() else { return };
    for (name, filled, text) in [
        (
            "machine_line_event",
            "machine_fill_line_event",
            b"G1 X12.345 Y6.789 F60".as_slice(),
        ),
        (
            "machine_arc_event",
            "machine_fill_arc_event",
            b"G3 X0 Y0 I-0.15 J0 F60",
        ),
    ] {
        // With a queue of two moves, the machine fits in the RAM of a microbit. An arc is walked
        // once before the count, when it begins.
        let mut machine = Machine::<3, Path<3>, Backlash, 2>::new(config);
        let taken = machine.line(text);
        assert!(taken.is_ok(), "the line means a move");
        machine.next_event();
        count(name, EVENTS, &mut || {
            for _ in 0..EVENTS {
                black_box(machine.next_event());
            }
        });
        let mut steps = [StepEvent::default(); 32];
        count(filled, EVENTS, &mut || {
            let mut left = EVENTS as usize;
            while left != 0 {
                let room = steps.len().min(left);
                let rest = steps.get_mut(..room).unwrap_or_default();
                left = left.saturating_sub(machine.fill(rest).steps.max(1));
                black_box(&steps);
            }
        });
    }
}

/// Lines of the programs of `husillo-bench`: chords of 0.2 mm, quarter circles and a helix, and
/// everything. A machine takes as many of them as its queue has room for.
const PROGRAMS: [(&str, &str, &[&[u8]]); 3] = [
    (
        "machine_seg_event",
        "machine_fill_seg_event",
        &[
            b"G1 X54.996 Y50.200 Z-0.583 F3000",
            b"X54.984 Y50.400 Z-0.659",
            b"X54.964 Y50.599 Z-0.723",
            b"X54.936 Y50.797 Z-0.770",
            b"X54.900 Y50.993 Z-0.796",
            b"X54.857 Y51.189 Z-0.798",
        ],
    ),
    (
        "machine_arc_event_of_ramps",
        "machine_fill_arc_event_of_ramps",
        &[
            b"G3 X56.000 Y51.000 I0.000 J1.000 F3000",
            b"G3 X55.000 Y52.000 I-1.000 J0.000",
            b"G3 X54.000 Y51.000 I0.000 J-1.000",
            b"G3 X55.000 Y50.000 Z-0.600 I1.000 J0.000",
        ],
    ),
    (
        "machine_mix_event",
        "machine_fill_mix_event",
        &[
            b"G0 X55.5 Y50.2",
            b"G1 Z-0.600 F800",
            b"X56.5 F3000",
            b"G2 X57.5 Y49.2 I0 J-1",
            b"G1 Y48.7",
            b"X55.3",
        ],
    ),
];

/// Counts the events of moves on ramps, from the first move to the end of the last one: their
/// beginning, their ramps, their end. Checking and planning of the lines is not counted.
#[inline(never)]
pub fn programs(count: Count<'_>) {
    let Some(config) = router() else { return };
    let mut machine = Machine::<3, Path<3>, Backlash, 7>::new(config);
    let mut steps = [StepEvent::default(); 32];
    for (one, many, lines) in PROGRAMS {
        let take = |machine: &mut Machine<3, Path<3>, Backlash, 7>| {
            let taken = machine.line(b"G0 X55 Y50 Z-0.5");
            assert!(taken.is_ok(), "the way back");
            while machine.next_event().is_some() {}
            for line in lines {
                assert!(machine.line(line).is_ok(), "the queue has room");
            }
        };
        take(&mut machine);
        let mut events = 0;
        while machine.next_event().is_some() {
            events += 1;
        }
        take(&mut machine);
        count(one, events, &mut || {
            while let Some(event) = machine.next_event() {
                black_box(event);
            }
        });
        take(&mut machine);
        count(many, events, &mut || {
            while machine.fill(&mut steps).steps != 0 {
                black_box(&steps);
            }
        });
    }
}

/// A router of 2.5 um with ramps.
fn router() -> Option<Config<3>> {
    let mut config = config()?;
    for axis in &mut config.axes {
        axis.scale = Scale::new(2_500, 1)?;
        axis.max_rate_hz = 40_000;
        axis.backlash_steps = 0;
        axis.ramp = Some(AxisRamp {
            start_rate_hz: 0,
            acceleration_hz_per_s: 200_000,
            jerk_hz_per_s2: None,
            junction_hz: None,
        });
    }
    config.timer_hz = 16_000_000;
    config.corner_deviation = Some(Nm(10_000));
    Some(config)
}

/// Counts short lines of a machine with ramps from their text to their places in the queue: read,
/// checked, planned and joined to the moves before. An event is a line.
#[inline(never)]
pub fn planned(count: Count<'_>) {
    const TEXTS: [&[u8]; 7] = [
        b"X12.365 Y-6.781",
        b"X12.384 Y-6.772",
        b"X12.402 Y-6.763",
        b"X12.421 Y-6.755",
        b"X12.441 Y-6.749",
        b"X12.460 Y-6.745",
        b"X12.480 Y-6.742",
    ];
    let Some(mut config) = config() else { return };
    for axis in &mut config.axes {
        axis.travel = Some([Nm(-100_000_000), Nm(100_000_000)]);
        axis.max_rate_hz = 100_000;
        axis.backlash_steps = 0;
        axis.ramp = Some(AxisRamp {
            start_rate_hz: 10,
            acceleration_hz_per_s: 1_000_000,
            jerk_hz_per_s2: None,
            junction_hz: None,
        });
    }
    config.corner_deviation = Some(Nm(10_000));
    let mut machine = Machine::<3, Path<3>, Backlash, 8>::new(config);
    let mut take = |text: &[u8]| {
        let taken = machine.line(black_box(text));
        assert!(taken.is_ok(), "the line means a move");
    };
    take(b"G1 X12.345 Y-6.789 F600");
    count("machine_line", TEXTS.len() as u32, &mut || {
        TEXTS.into_iter().for_each(&mut take);
    });
}

/// A machine with an encoder on every motor. The returned machine is copied on the stack, and the
/// stack of a microbit is small. So the queue has one move, and no line is read here.
#[inline(never)]
fn watched(config: Config<3>) -> ClosedLoop<3, Path<3>, Backlash, 1> {
    let encoder = AxisEncoder {
        counts: 2,
        steps: 1,
        tolerance_steps: 4,
        on_loss: OnLoss::Correct,
        correction_rate_hz: 80,
        settle_ticks: 20_000,
        attempts: 3,
    };
    ClosedLoop::new(Machine::new(config), [Some(encoder); 3])
}

/// Counts the line of `machine_line_event` with an encoder on every motor.
#[inline(never)]
fn closed_loop(count: Count<'_>) {
    let Some(config) = config() else { return };
    let mut machine = watched(config);
    let taken = machine.machine_mut().line(b"G1 X12.345 Y6.789 F60");
    assert!(taken.is_ok(), "the line means a move");
    let mut counts = [0_i64; 3];
    let mut event = || {
        let event = machine.next_event(&counts);
        if let Some(Followed::Event(Event::Step(step))) = black_box(event) {
            for (counts, delta) in counts.iter_mut().zip(step.delta) {
                *counts += 2 * i64::from(delta);
            }
        }
    };
    event();
    count("machine_watched_event", EVENTS, &mut || {
        for _ in 0..EVENTS {
            event();
        }
    });
}

/// Counts a servo module on a trapezoid of 4000 counts, of which a quarter are ramps. The motor
/// follows one period late. This is the whole work of the servo interrupt, except the pins.
#[inline(never)]
fn servo_module(count: Count<'_>) {
    let mut module = ServoModule::new(4);
    module.link().set_enabled(true);
    let mut inputs = ServoInputs {
        has_power: true,
        ..ServoInputs::default()
    };
    let gains = Gains {
        proportional: 2000,
        integral: 50,
        derivative: 16_000,
        integration_limit: 8000,
        output_limit: 255,
        error_limit: 400,
        rate_divisor: 1,
        ..Gains::default()
    };
    let on = Stop {
        amplifier: true,
        mode: Some(StopMode::Abrupt),
    };
    let trajectory = Trajectory {
        position: Some(4000),
        velocity: Some(0x0005_0000),     // 5 counts per period
        acceleration: Some(0x0000_0a3d), // 125 periods to that speed
        mode: Mode::Trapezoid,
        start_now: true,
        ..Trajectory::default()
    };
    for command in [
        Command::SetGain(gains),
        Command::StopMotor(on),
        Command::LoadTrajectory(trajectory),
    ] {
        for byte in command.frame(0).bytes() {
            module.link().push(*byte);
        }
        module.tick(&inputs);
    }
    count("servo_module_tick", EVENTS, &mut || {
        for _ in 0..EVENTS {
            black_box(module.tick(black_box(&inputs)));
            inputs.counts = module.axis().commanded();
        }
    });
    assert!(module.axis().status().is_done, "the move ends");
}
