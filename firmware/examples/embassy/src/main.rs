//! Homes an axis on its index and reports its position over a link, in three tasks. One task runs
//! the servo, one is the far end of the link, and the main task awaits both.
//!
//! No task polls. The timer interrupt wakes them at each servo period, and a byte wakes the end
//! that it is for. In between the processor sleeps. At the end the program compares how often
//! tasks were woken with the periods and bytes.
//!
//! The crates do not depend on tasks. [`ready`] makes a future of any polling function. On your own
//! board, replace the motor with PWM and encoder, and let [`on_byte`] and a transmitter take the
//! place of [`WIRES`].
#![no_std]
#![no_main]

#[path = "../../block/src/motor.rs"]
mod motor;

use core::cell::RefCell;
use core::future::poll_fn;
use core::pin::pin;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use board::CriticalSection;
use embassy_executor::Spawner;
use embassy_futures::select::{Either, select};
use embassy_sync::blocking_mutex::{Mutex, raw::CriticalSectionRawMutex};
use embassy_sync::channel::Channel;
use embassy_sync::watch::{Receiver, Watch};
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
static WIRES: [Channel<CriticalSectionRawMutex, u8, 64>; 2] = [Channel::new(), Channel::new()];

/// The time of the last servo period in microseconds, for three tasks.
static TIME_US: Watch<CriticalSectionRawMutex, u32, 3> = Watch::new();

/// Microseconds from one servo period to the next, as of a PIC-SERVO.
const PERIOD_US: u32 = 512;

/// How often tasks were woken, and how many bytes were sent.
static WAKES: AtomicU32 = AtomicU32::new(0);
static BYTES: AtomicU32 = AtomicU32::new(0);

/// The timer interrupt: begins the next period, and wakes the tasks that wait for it.
#[unsafe(no_mangle)]
fn on_time(section: CriticalSection<'_>) {
    board::wait(PERIOD_US, section);
    let time = TIME_US.sender();
    time.send_modify(|now_us| *now_us = Some(now_us.unwrap_or(0).wrapping_add(PERIOD_US)));
}

/// The UART's interrupt. With a UART as the wire, it sends the byte to the second of [`WIRES`].
#[unsafe(no_mangle)]
fn on_byte(_: u8, _: CriticalSection<'_>) {}

/// The servo periods, for one task.
struct Periods(Receiver<'static, CriticalSectionRawMutex, u32, 3>);

impl Periods {
    fn new() -> Periods {
        Periods(TIME_US.receiver().expect("three tasks wait for them"))
    }

    /// Sleeps until the next period, and returns its time in microseconds.
    async fn next(&mut self) -> u32 {
        self.0.changed().await
    }
}

/// Adds to a count. Interrupts do not count, and there is one core.
fn count(total: &AtomicU32) {
    total.store(total.load(Relaxed).wrapping_add(1), Relaxed);
}

/// Counts how often a task is woken.
async fn counted<T>(task: impl Future<Output = T>) -> T {
    let mut task = pin!(task);
    poll_fn(|context| {
        count(&WAKES);
        task.as_mut().poll(context)
    })
    .await
}

/// Ends the program if something is wrong.
fn check(is_right: bool, what: &str) {
    if !is_right {
        println!("wrong: {what}");
        semihosting::process::exit(1)
    }
}

/// Waits until `poll` no longer returns `WouldBlock`. It polls once in each servo period.
async fn ready<T, E>(
    periods: &mut Periods,
    mut poll: impl FnMut() -> nb::Result<T, E>,
) -> Result<T, E> {
    loop {
        match poll() {
            Ok(value) => return Ok(value),
            Err(nb::Error::Other(error)) => return Err(error),
            Err(nb::Error::WouldBlock) => periods.next().await,
        };
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

/// Runs the servo.
#[embassy_executor::task]
async fn servo() {
    counted(async {
        let mut motor = Motor::default();
        let mut periods = Periods::new();
        loop {
            periods.next().await;
            motor.turn(axis(|axis| axis.tick(&motor.read())));
        }
    })
    .await
}

/// Serves an end of the link until `work` returns a value. `work` is called with each payload, and
/// in each servo period.
async fn serve<T>(
    end: &mut Peer<2>,
    [out, back]: [usize; 2],
    periods: &mut Periods,
    mut work: impl FnMut(&mut Peer<2>, Option<[u8; 4]>) -> Option<T>,
) -> T {
    let [out, back] = [&WIRES[out], &WIRES[back]];
    let mut now_us = 0;
    loop {
        while !out.is_full() {
            let Some(byte) = end.transmit(now_us) else {
                break;
            };
            count(&BYTES);
            out.try_send(byte).ok();
        }
        let payload = match select(back.receive(), periods.next()).await {
            Either::First(byte) => match end.push(byte, now_us) {
                Some(Received::Data(payload)) => <[u8; 4]>::try_from(payload).ok(),
                _ => None,
            },
            Either::Second(time_us) => {
                now_us = time_us;
                None
            }
        };
        if let Some(value) = work(end, payload) {
            return value;
        }
    }
}

/// The far end of the link: prints the position that it receives, and ends the program.
#[embassy_executor::task]
async fn far_end() {
    counted(async {
        let mut periods = Periods::new();
        let mut end = Peer::<2>::station(1, Timing::of(115_200));
        let payload = serve(&mut end, [1, 0], &mut periods, |_, payload| payload).await;
        let home = i32::from_le_bytes(payload);
        println!("told: {home}");
        check((INDEX..INDEX + 2).contains(&home), "the position");
        let now_us = periods.next().await;
        let (periods, bytes) = (now_us / PERIOD_US, BYTES.load(Relaxed));
        let wakes = WAKES.load(Relaxed);
        println!("periods: {periods}, bytes: {bytes}, wakes of tasks: {wakes}");
        // Each of the three tasks begins once.
        check(wakes <= 3 * periods + bytes + 3, "a task polls");
        semihosting::process::exit(0);
    })
    .await
}

#[cfg_attr(
    target_arch = "riscv32",
    embassy_executor::main(entry = "riscv_rt::entry")
)]
#[cfg_attr(target_arch = "arm", embassy_executor::main)]
async fn main(spawner: Spawner) {
    board::start();
    board::uninterrupted(|section| board::wait(PERIOD_US, section));
    spawner.spawn(servo()).expect("it is spawned once");
    spawner.spawn(far_end()).expect("it is spawned once");
    counted(report()).await
}

/// Homes the axis, sends its position, and serves the link.
async fn report() {
    let mut periods = Periods::new();
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
    let home = ready(&mut periods, || axis(|axis| axis.poll_search())).await;
    println!("home: {home:?}");
    check(home.is_ok(), "the index was not found");
    let mut end = Peer::<2>::caller(1, Timing::of(115_200));
    end.call();
    let mut home = home.ok();
    serve(&mut end, [0, 1], &mut periods, |end, _| {
        if end.is_up()
            && let Some(position) = home
            && end.poll_send(&position.to_le_bytes()).is_ok()
        {
            home = None;
        }
        None
    })
    .await
}
