//! Homes an axis on its index, touches a work piece, and sends the position over a link. Each of
//! these tasks is awaited with `nb::block!`. The state machines do not block. The body of the macro
//! does the work of each period.
//!
//! On your own board, replace [`motor`] and the loop at the end with timer, motor and UART.
#![no_std]
#![no_main]

mod motor;

use husillo_machine::{ServoAxis, ServoEvents, ServoStop};
use husillo_pid::{RateRule, ServoLaw, TotalLimit};
use husillo_planner::ServoMotion;
use husillo_probe::{Cycle, Edge, Input, Plan, Request, UnitVector};
use husillo_transports::link::{Peer, Received, Timing};
use motor::{GAINS, INDEX, Motor, PIECE};
use semihosting::{print, println};

#[cfg_attr(target_arch = "arm", cortex_m_rt::entry)]
#[cfg_attr(target_arch = "riscv32", riscv_rt::entry)]
fn main() -> ! {
    let mut motor = Motor::default();
    let mut axis = ServoAxis::new(ServoLaw::new(
        &GAINS,
        RateRule::Loop,
        TotalLimit::BeforeScaling,
    ));
    motor.turn(axis.tick(&motor.read()));

    let events = ServoEvents {
        index: true,
        ..ServoEvents::default()
    };
    axis.search(events, Some(ServoStop::Smooth));
    axis.load(to(5_000, 1 << 16));
    axis.start();
    let home = nb::block!({
        motor.turn(axis.tick(&motor.read()));
        axis.poll_search()
    });
    println!("home: {home:?}");
    assert!(home.is_ok_and(|home| (INDEX..INDEX + 2).contains(&home)));

    let touched = touch(&mut motor, &mut axis);
    println!("touched: {touched}");
    assert_eq!(touched, PIECE);

    send(&touched.to_le_bytes());
    semihosting::process::exit(0)
}

fn to(goal: i32, velocity: u32) -> ServoMotion {
    ServoMotion::Trapezoid {
        goal,
        velocity,
        acceleration: 1 << 10,
    }
}

/// Touches the work piece. Returns its position in counts.
fn touch(motor: &mut Motor, axis: &mut ServoAxis) -> i32 {
    let plan = Plan {
        approach: [2_000, 0, 0],
        direction: UnitVector::X,
        search: 1_000,
        over_travel: 200,
        back_off: 50,
        touches: 2,
        // Speeds in 2^-16 counts per period.
        travel_speed: 2 << 16,
        probing_speed: 1 << 15,
        slow_speed: 1 << 12,
        back_off_speed: 1 << 15,
        until: Edge::Made,
    };
    let Ok(mut cycle) = Cycle::new(&plan) else {
        panic!("a plan that cannot be carried out")
    };
    let mut latched = 0;
    let measured = nb::block!({
        let was_closed = axis.inputs().limit_1;
        motor.turn(axis.tick(&motor.read()));
        if axis.inputs().limit_1 && !was_closed {
            latched = axis.position();
        }
        let input = Input {
            position: [axis.position().into(), 0, 0],
            contact: axis.inputs().limit_1,
            latched: [latched.into(), 0, 0],
            still: axis.status().is_done,
        };
        cycle.poll(&input, |request| match request {
            Request::Move {
                target: [goal, ..],
                speed,
            } => {
                axis.load(to(goal as i32, speed));
                axis.start();
            }
            _ => axis.stop(ServoStop::Smooth),
        })
    });
    match measured {
        Ok(measured) => measured.touch.position[0] as i32,
        Err(failure) => panic!("{failure}"),
    }
}

/// Sends these bytes, one per payload, over a link with a window of two, and prints what arrives.
fn send(bytes: &[u8]) {
    let timing = Timing::of(115_200);
    let mut ends = [Peer::<2>::caller(1, timing), Peer::<2>::station(1, timing)];
    let mut now_us = 0;
    // This wire stands in for a UART.
    let mut exchange = |ends: &mut [Peer<2>; 2]| {
        now_us += 87;
        let [left, right] = ends;
        let received = left
            .transmit(now_us)
            .and_then(|byte| right.push(byte, now_us));
        if let Some(Received::Data(payload)) = received {
            print!("{payload:?} ");
        }
        if let Some(byte) = right.transmit(now_us) {
            left.push(byte, now_us);
        }
    };
    ends[0].call();
    while !ends[0].is_up() {
        exchange(&mut ends);
    }
    for byte in bytes {
        let sent = nb::block!({
            exchange(&mut ends);
            ends[0].poll_send(&[*byte])
        });
        assert!(sent.is_ok());
    }
    while ends[0].unacknowledged() > 0 {
        exchange(&mut ends);
    }
    println!();
}
