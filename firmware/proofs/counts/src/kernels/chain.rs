//! From text to moves, and the whole chain after the text: path, take-up, timer.

use core::hint::black_box;

use husillo_backlash::Backlash;
use husillo_controllers::ServoModule;
use husillo_gcode::{Dialect, Nm};
use husillo_interp::Path;
use husillo_machine::{
    Axis, AxisEncoder, AxisRamp, ClosedLoop, Config, Equipment, Event, Followed, Machine, OnLoss,
    Scale, ServoInputs,
};
use husillo_transports::nmc::{Command, Gains, Mode, Stop, StopMode, Trajectory};

use crate::Count;

const EVENTS: u32 = 1000;

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
    for (name, text) in [
        ("machine_line_event", b"G1 X12.345 Y6.789 F60".as_slice()),
        ("machine_arc_event", b"G3 X0 Y0 I-0.15 J0 F60"),
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
    }
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
