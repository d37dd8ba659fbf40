//! Random walks of several motors at their pins: every time of every driver is kept, and a driver
//! that counts rising edges ends where the steps do.
#![cfg(feature = "embedded-hal-async")]

mod scope;

use core::future::Future;
use core::pin::pin;
use core::task::{Context, Poll, Waker};
use std::convert::Infallible;

use husillo_stepper::{
    Idle, Motors, Port, PortBits, PortPins, PulseNanoseconds, StepDirection, StepDirectionPins,
    StepPulses,
};
use proptest::prelude::*;
use scope::{Broken, Clock, Pin, Scope, position};

/// Pins of three drivers: STEP, DIR and ENABLE of each.
const PINS: [[usize; 3]; 3] = [[0, 1, 2], [3, 4, 5], [6, 7, 8]];

/// A delay that a task awaits: each is pending once.
struct Timer<'a>(&'a Scope);

impl embedded_hal_async::delay::DelayNs for Timer<'_> {
    async fn delay_ns(&mut self, ns: u32) {
        let mut is_over = false;
        core::future::poll_fn(|context| {
            if std::mem::replace(&mut is_over, true) {
                self.0.pass(ns);
                return Poll::Ready(());
            }
            context.waker().wake_by_ref();
            Poll::Pending
        })
        .await;
    }
}

/// Runs a future to its end, and returns how often it was pending.
fn run<T>(future: impl Future<Output = T>) -> (T, u32) {
    let mut future = pin!(future);
    let mut pending = 0;
    loop {
        match future
            .as_mut()
            .poll(&mut Context::from_waker(Waker::noop()))
        {
            Poll::Ready(value) => return (value, pending),
            Poll::Pending => pending += 1,
        }
    }
}

/// Polls a future so often and then drops it.
fn run_for(future: impl Future, polls: u32) {
    let mut future = pin!(future);
    for _ in 0..polls {
        let mut context = Context::from_waker(Waker::noop());
        if future.as_mut().poll(&mut context).is_ready() {
            return;
        }
    }
}

/// A port whose pins are channels of the scope: one write is one time.
struct ScopePort<'a>(&'a Scope);

impl Port for ScopePort<'_> {
    type Error = Infallible;

    fn write(&mut self, high: u32, low: u32) -> Result<(), Infallible> {
        use embedded_hal::digital::OutputPin;
        for number in 0..9 {
            let mut pin = Pin::<Infallible>::new(number, self.0);
            if high & 1 << number != 0 {
                pin.set_high()?;
            }
            if low & 1 << number != 0 {
                pin.set_low()?;
            }
        }
        Ok(())
    }
}

type Drivers<'a> = (
    StepDirectionPins<Pin<'a, Infallible>, Pin<'a, Broken>, Pin<'a, Infallible>>,
    StepDirectionPins<Pin<'a, Broken>, Pin<'a, Broken>, Pin<'a, Infallible>>,
    StepDirectionPins<Pin<'a, Infallible>, Pin<'a, Infallible>, Pin<'a, Broken>>,
);

/// Three drivers on pins of different types.
fn drivers(scope: &Scope) -> Drivers<'_> {
    let pin = |number| Pin::new(number, scope);
    let other = |number| scope.other_pin(number);
    (
        StepDirectionPins::active_low(pin(0), other(1), pin(2)),
        StepDirectionPins::active_low(other(3), other(4), pin(5)),
        StepDirectionPins::active_low(pin(6), pin(7), other(8)),
    )
}

fn port(scope: &Scope) -> PortPins<ScopePort<'_>, 3> {
    let bits = PINS.map(|pins| {
        let [step, direction, enable] = pins.map(|pin| 1 << pin);
        PortBits::active_low(step, direction, enable)
    });
    PortPins::new(ScopePort(scope), bits)
}

fn times() -> impl Strategy<Value = [PulseNanoseconds; 3]> {
    let one = [0_u32..3000, 0_u32..9000, 1_u32..3000, 1_u32..3000];
    let one = one.prop_map(|[setup, hold, high, low]| PulseNanoseconds {
        setup,
        hold,
        high,
        low,
    });
    [one.clone(), one.clone(), one]
}

/// Steps, and sometimes a change of ENABLE.
fn walk() -> impl Strategy<Value = Vec<(bool, [i8; 3])>> {
    let event = (proptest::bool::weighted(0.1), [-1..=1_i8, -1..=1, -1..=1]);
    proptest::collection::vec(event, 1..60)
}

fn check(scope: &Scope, walk: &[(bool, [i8; 3])], times: [PulseNanoseconds; 3], enable_ns: u32) {
    let edges = scope.all();
    for axis in 0..3 {
        let made: i64 = walk.iter().map(|(_, delta)| i64::from(delta[axis])).sum();
        let steps = walk.iter().filter(|(_, delta)| delta[axis] != 0).count();
        assert_eq!(position(&edges, PINS[axis], times[axis], enable_ns), made);
        assert_eq!(scope.rising_edges(PINS[axis][0]), steps);
    }
}

proptest! {
    #[test]
    fn steps_at_pins_of_any_types_keep_all_times(
        walk in walk(), times in times(), enable_ns in 0_u32..100_000
    ) {
        let scope = Scope::default();
        let mut motors = StepPulses::new(drivers(&scope), times).with_enable_ns(enable_ns);
        let mut clock = Clock(&scope);
        for (turns_off, delta) in &walk {
            if *turns_off {
                motors.set_enabled(false, &mut clock).unwrap();
            }
            motors.step(delta, &mut clock).unwrap();
        }
        check(&scope, &walk, times, enable_ns);
    }

    #[test]
    fn tasks_make_the_same_edges_and_wait_at_each(
        walk in walk(), times in times(), enable_ns in 0_u32..100_000
    ) {
        let (blocking, awaited) = (Scope::default(), Scope::default());
        let mut motors = StepPulses::new(port(&blocking), times).with_enable_ns(enable_ns);
        let mut tasks = StepPulses::new(port(&awaited), times).with_enable_ns(enable_ns);
        let (mut clock, mut timer) = (Clock(&blocking), Timer(&awaited));
        for (turns_off, delta) in &walk {
            if *turns_off {
                motors.set_enabled(false, &mut clock).unwrap();
                run(tasks.set_enabled_async(false, &mut timer)).0.unwrap();
            }
            let (taken_ns, pending) = run(tasks.step_async(delta, &mut timer));
            prop_assert_eq!(taken_ns, motors.step(delta, &mut clock));
            prop_assert_eq!(pending >= 2, delta.iter().any(|delta| *delta != 0));
        }
        prop_assert_eq!(awaited.all(), blocking.all());
        check(&blocking, &walk, times, enable_ns);
    }

    /// The time that a dropped future has not waited passes at the next call.
    #[test]
    fn dropped_futures_cut_no_time_short(
        walk in walk(), drops in proptest::collection::vec(0_u32..8, 60), times in times(),
        enable_ns in 0_u32..100_000
    ) {
        let scope = Scope::default();
        let mut motors = StepPulses::new(port(&scope), times).with_enable_ns(enable_ns);
        let mut timer = Timer(&scope);
        let mut made = [0; 3];
        for ((turns_off, delta), polls) in walk.iter().zip(drops) {
            if *turns_off {
                run(motors.set_enabled_async(false, &mut timer)).0.unwrap();
                run_for(motors.set_enabled_async(true, &mut timer), polls % 2 + 1);
            }
            let rises = || PINS.map(|[step, ..]| scope.rising_edges(step));
            let before = rises();
            run_for(motors.step_async(delta, &mut timer), polls);
            for (axis, after) in rises().into_iter().enumerate() {
                made[axis] += i64::from(delta[axis]) * (after - before[axis]) as i64;
            }
        }
        run(motors.step_async(&[1; 3], &mut timer)).0.unwrap();
        for (axis, made) in made.into_iter().enumerate() {
            prop_assert_eq!(position(&scope.all(), PINS[axis], times[axis], enable_ns), made + 1);
        }
    }

    /// `Motors` gives the times in ticks, `StepPulses` the rest.
    #[test]
    fn a_stream_of_events_keeps_all_times(
        walk in walk(), times in times(), wait_ticks in 1_u32..200, enable_ns in 0_u32..100_000
    ) {
        // Ticks of 100 ns.
        let drivers = times.map(|times| StepDirection::new(times.ticks(10_000_000)));
        let mut motors = Motors::new(drivers, Idle::Hold);
        let (blocking, awaited) = (Scope::default(), Scope::default());
        let mut pins = StepPulses::new(port(&blocking), times).with_enable_ns(enable_ns);
        let mut tasks = StepPulses::new(port(&awaited), times).with_enable_ns(enable_ns);
        let mut present = |ticks, levels: &_| {
            blocking.pass(100 * ticks);
            awaited.pass(100 * ticks);
            pins.write(levels, &mut Clock(&blocking)).unwrap();
            run(tasks.write_async(levels, &mut Timer(&awaited))).0.unwrap();
        };
        for (turns_off, delta) in &walk {
            if *turns_off {
                motors.end_pulses(&mut present);
                motors.set_enabled(false);
                present(0, motors.levels());
            }
            motors.step(wait_ticks, delta, &mut present);
        }
        motors.end_pulses(&mut present);
        prop_assert_eq!(awaited.all(), blocking.all());
        check(&blocking, &walk, times, enable_ns);
    }
}
