//! Homes an axis on its index and reports its position over a link, in three tasks. One task runs
//! the servo, one is the far end of the link, and the main task awaits both.
//!
//! The crates do not depend on tasks. [`ready`] makes a future of any polling function. On your own
//! board, replace the loop of [`servo`] with a timer and [`WIRES`] with a UART.
#![no_std]
#![no_main]

#[path = "../../block/src/motor.rs"]
mod motor;

use core::cell::RefCell;
#[cfg(target_arch = "arm")]
use cortex_m as _;
use embassy_executor::Spawner;
use embassy_futures::yield_now;
use embassy_sync::blocking_mutex::{Mutex, raw::CriticalSectionRawMutex};
use embassy_sync::channel::Channel;
use husillo_machine::{ServoAxis, ServoEvents, ServoStop};
use husillo_pid::{RateRule, ServoLaw, TotalLimit};
use husillo_planner::ServoMotion;
use husillo_transports::link::{Peer, Received, Timing};
use motor::{GAINS, INDEX, Motor};
use semihosting::println;

/// A value that two tasks share.
type Held<T> = Mutex<CriticalSectionRawMutex, RefCell<Option<T>>>;

static AXIS: Held<ServoAxis> = Mutex::new(RefCell::new(None));

/// The bytes from the main task to the far end, and back.
static WIRES: [Channel<CriticalSectionRawMutex, u8, 4>; 2] = [Channel::new(), Channel::new()];

/// Time of a byte at 115 200 bits per second.
const BYTE_US: u32 = 87;

/// Waits until `poll` no longer returns `WouldBlock`.
async fn ready<T, E>(mut poll: impl FnMut() -> nb::Result<T, E>) -> Result<T, E> {
    loop {
        match poll() {
            Ok(value) => return Ok(value),
            Err(nb::Error::Other(error)) => return Err(error),
            Err(nb::Error::WouldBlock) => yield_now().await,
        }
    }
}

/// Gives access to the axis.
fn axis<R>(work: impl FnOnce(&mut ServoAxis) -> R) -> R {
    AXIS.lock(|axis| {
        let mut axis = axis.borrow_mut();
        let law = || ServoLaw::new(&GAINS, RateRule::Loop, TotalLimit::BeforeScaling);
        work(axis.get_or_insert_with(|| ServoAxis::new(law())))
    })
}

/// Runs the servo: one period each time all other tasks have run.
#[embassy_executor::task]
async fn servo() {
    let mut motor = Motor::default();
    loop {
        motor.turn(axis(|axis| axis.tick(&motor.read())));
        yield_now().await;
    }
}

/// Polls an end of the link: sends its next byte, and passes it a byte that has arrived.
fn exchange(end: &mut Peer<2>, [out, back]: [usize; 2], now_us: u32) -> Option<[u8; 4]> {
    let [out, back] = [&WIRES[out], &WIRES[back]];
    let next = if out.is_full() {
        None
    } else {
        end.transmit(now_us)
    };
    if let Some(byte) = next {
        out.try_send(byte).ok();
    }
    let byte = back.try_receive().ok()?;
    match end.push(byte, now_us)? {
        Received::Data(payload) => <[u8; 4]>::try_from(payload).ok(),
        _ => None,
    }
}

/// The far end of the link: prints the position that it receives, and ends the program.
#[embassy_executor::task]
async fn far_end() {
    let mut end = Peer::<2>::station(1, Timing::of(115_200));
    let mut now_us = 0;
    loop {
        if let Some(payload) = exchange(&mut end, [1, 0], now_us) {
            let home = i32::from_le_bytes(payload);
            println!("told: {home}");
            assert!((INDEX..INDEX + 2).contains(&home));
            semihosting::process::exit(0);
        }
        now_us += BYTE_US;
        yield_now().await;
    }
}

#[cfg_attr(
    target_arch = "riscv32",
    embassy_executor::main(entry = "riscv_rt::entry")
)]
#[cfg_attr(target_arch = "arm", embassy_executor::main)]
async fn main(spawner: Spawner) {
    spawner.spawn(servo()).expect("it is spawned once");
    spawner.spawn(far_end()).expect("it is spawned once");
    let events = ServoEvents {
        index: true,
        ..ServoEvents::default()
    };
    axis(|axis| {
        axis.search(events, Some(ServoStop::Smooth));
        axis.load(ServoMotion::Trapezoid {
            goal: 5_000,
            velocity: 1 << 16,
            acceleration: 1 << 10,
        });
        axis.start();
    });
    let home = ready(|| axis(|axis| axis.poll_search())).await;
    println!("home: {home:?}");
    let Ok(home) = home else {
        panic!("the index was not found")
    };
    let mut end = Peer::<2>::caller(1, Timing::of(115_200));
    let mut now_us = 0;
    end.call();
    let sent = ready(|| {
        now_us += BYTE_US;
        exchange(&mut end, [0, 1], now_us);
        if end.is_up() {
            end.poll_send(&home.to_le_bytes())
        } else {
            Err(nb::Error::WouldBlock)
        }
    });
    assert!(sent.await.is_ok());
    loop {
        now_us += BYTE_US;
        exchange(&mut end, [0, 1], now_us);
        yield_now().await;
    }
}
