//! Straight moves of three servo modules on one line: loaded one after the other, started as a
//! group.

mod common;

use common::{ask, send, switch_on};
use husillo_planner::{ServoLine, Tangent};
use husillo_sim::{DcMotorModel, SERVO_PERIOD_S, ServoNetwork};
use husillo_transports::nmc::{Command, EVERY_GROUP, Gains, Group, Mode, Trajectory};
use proptest::prelude::*;

/// Servos on, with the gains of the measuring machine, in one group.
fn started() -> ServoNetwork {
    let mut network = ServoNetwork::new(&[4; 3], DcMotorModel::PROTOTYPE);
    for address in 1..=3 {
        let group = Group {
            address: EVERY_GROUP,
            is_leader: address == 1,
        };
        ask(&mut network, 0, Command::SetAddress { address, group });
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
        switch_on(&mut network, address, gains);
    }
    network
}

/// Distance of a point from the line through `from` along `ways`, counts.
fn off_line(point: [f64; 3], from: [i32; 3], ways: [i32; 3]) -> f64 {
    let along = ways.map(f64::from);
    let off = [0, 1, 2].map(|axis| point[axis] - f64::from(from[axis]));
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let part = dot(off, along) / dot(along, along);
    let across = [0, 1, 2].map(|axis| off[axis] - part * along[axis]);
    dot(across, across).sqrt()
}

/// Observations of a move.
struct Seen {
    line: ServoLine<3>,
    /// Largest distance from the line of the commanded positions, and of the motors.
    commanded: f64,
    actual: f64,
    /// Last period of motion of each axis.
    ends: [u32; 3],
}

/// As fast as 1200 counts/s and 6000 counts/s^2 per axis allow.
fn go(network: &mut ServoNetwork, from: [i32; 3], goal: [i32; 3]) -> Option<Seen> {
    let ways = [0, 1, 2].map(|axis| goal[axis] - from[axis]);
    let direction = Tangent::new(ways.map(i64::from))?;
    let velocity = f64::from(direction.speed_limit(&[1200; 3])) * SERVO_PERIOD_S * 65536.0;
    let acceleration = direction.acceleration_limit(&[6000; 3]) as f64 * SERVO_PERIOD_S.powi(2);
    let line = ServoLine::new(ways, velocity as u32, (acceleration * 65536.0) as u32)?;
    for (axis, address) in (0..3).zip(1..) {
        let trajectory = Trajectory {
            position: Some(goal[axis]),
            velocity: Some(line.velocities[axis].max(1)),
            acceleration: Some(line.accelerations[axis].max(1)),
            mode: Mode::Trapezoid,
            ..Trajectory::default()
        };
        ask(network, address, Command::LoadTrajectory(trajectory));
    }
    send(network, EVERY_GROUP, Command::StartMotion);
    let axes = |network: &ServoNetwork| [0, 1, 2].map(|axis| *network.axis(axis).unwrap());
    let mut seen = Seen {
        line,
        commanded: 0.0,
        actual: 0.0,
        ends: [0; 3],
    };
    for period in 0..line.duration_ticks + line.skew_ticks() + 400 {
        network.tick();
        let axes = axes(network);
        for (end, axis) in seen.ends.iter_mut().zip(&axes) {
            if !axis.status().is_done {
                *end = period;
            }
        }
        let commanded = off_line(axes.map(|axis| axis.commanded().into()), from, ways);
        let actual = off_line(axes.map(|axis| axis.position().into()), from, ways);
        seen.commanded = seen.commanded.max(commanded);
        seen.actual = seen.actual.max(actual);
    }
    for (axis, goal) in axes(network).iter().zip(goal) {
        assert_eq!(axis.commanded(), goal);
        assert!((axis.position() - goal).abs() <= 1, "{}", axis.position());
    }
    Some(seen)
}

/// For all moves: the commanded path within the bound of the line, the ends within its skew, the
/// motors within 5 counts.
fn check(seen: &Seen, ways: [i32; 3]) {
    // Each of two axes may be off by the bound.
    let bound = seen.line.deviation() as f64 / 65536.0 * 2_f64.sqrt();
    assert!(seen.commanded <= bound, "{} of {bound}", seen.commanded);
    let moving = (0..3).filter(|axis| ways[*axis] != 0);
    let ends: Vec<u32> = moving.map(|axis| seen.ends[axis]).collect();
    let skew = ends.iter().max().unwrap() - ends.iter().min().unwrap();
    assert!(skew <= seen.line.skew_ticks(), "{ends:?}");
    assert!(seen.actual < 5.0, "{}", seen.actual);
}

#[test]
fn long_and_short_axes_stay_together() {
    let mut network = started();
    let mut from = [0; 3];
    let goals = [
        [750, -1000, 125],
        [0, 100, 130],
        [-1000, 1003, 1000],
        [-900, 1003, 0],
        [0, 0, 0],
        [3000, 4000, 0],
    ];
    for goal in goals {
        let ways = [0, 1, 2].map(|axis| goal[axis] - from[axis]);
        let seen = go(&mut network, from, goal).unwrap();
        println!(
            "{ways:?}: commanded {:.2}, actual {:.2} counts off the line, ends {:?}",
            seen.commanded, seen.actual, seen.ends
        );
        check(&seen, ways);
        from = goal;
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(24)
    })]

    #[test]
    fn any_straight_move_stays_on_its_line(goal in prop::array::uniform3(-1500..1500_i32)) {
        let mut network = started();
        if let Some(seen) = go(&mut network, [0; 3], goal) {
            check(&seen, goal);
        }
    }
}
