//! One stepping axis: ends, limits, pulses and delays.

use husillo_machine::planner::RatesError;
use husillo_machine::stepper::{
    CoilDriver, Driver, Levels, Mode, PulseNanoseconds, PulseTiming, Sequencer, StepDirection,
};
use husillo_machine::{
    AccelerationLimits, AxisLimits, AxisProfile, JerkLimits, StepperAxis, StepperAxisError,
};
use proptest::prelude::*;

const TIMER_HZ: u32 = 1_000_000;

const LIMITS: AccelerationLimits = AccelerationLimits {
    timer_hz: TIMER_HZ,
    top_rate_hz: 2_000,
    acceleration_hz_per_s: 10_000,
};

const JERK: JerkLimits = JerkLimits {
    timer_hz: TIMER_HZ,
    top_rate_hz: 2_000,
    acceleration_hz_per_s: 10_000,
    jerk_hz_per_s2: 200_000,
};

/// A driver that keeps every delta in its low byte, so that a test sees the direction of a step.
#[derive(Clone, Debug, Default)]
struct Counter(u8);

impl CoilDriver for Counter {
    fn step(&mut self, delta: i8) -> Levels {
        self.0 = self.0.wrapping_add_signed(delta);
        self.levels()
    }

    fn levels(&self) -> Levels {
        Levels(self.0)
    }

    fn set_enabled(&mut self, _: bool) -> Levels {
        self.levels()
    }
}

/// Runs to the end, and returns the signed intervals: negative for a step backwards.
fn run<D: CoilDriver, L: AxisLimits>(axis: &mut StepperAxis<D, L>) -> Vec<i64> {
    let mut intervals = Vec::new();
    while let Some(interval) = step(axis) {
        intervals.push(interval);
    }
    intervals
}

/// Takes up to `count` steps, and returns their signed intervals.
fn take<D: CoilDriver, L: AxisLimits>(axis: &mut StepperAxis<D, L>, count: usize) -> Vec<i64> {
    (0..count).map_while(|_| step(axis)).collect()
}

/// Takes a step of a driver without pulses.
fn step<D: CoilDriver, L: AxisLimits>(axis: &mut StepperAxis<D, L>) -> Option<i64> {
    let before = axis.position();
    let change = axis.next_change()?;
    let delta = axis.position().wrapping_sub(before);
    assert_eq!(delta.abs(), 1);
    Some(i64::from(delta) * i64::from(change.ticks))
}

/// The first place where steps break the limits: the mean rates of neighbouring intervals differ by
/// at most the acceleration times the time between their middles. Steps may be `slack` ticks off.
fn fault(intervals: &[i64], limits: &AccelerationLimits, slack: f64) -> Option<String> {
    if intervals.is_empty() {
        return None;
    }
    let f = f64::from(limits.timer_hz);
    let acceleration = f64::from(limits.acceleration_hz_per_s);
    let shortest = f / f64::from(limits.top_rate_hz) - slack;
    if let Some(at) = intervals
        .iter()
        .position(|ticks| (ticks.abs() as f64) < shortest)
    {
        return Some(format!("rate at {at}: {}", intervals[at]));
    }
    // A step at standstill takes at least the square root of 2 / a before and after it.
    let slowest = f * (2.0 / acceleration).sqrt() - slack;
    let ends = [intervals.first(), intervals.last()].map(Option::unwrap);
    if ends.iter().any(|ticks| (ticks.abs() as f64) < slowest) {
        return Some(format!("a start or stop: {ends:?}"));
    }
    intervals.windows(2).enumerate().find_map(|(at, pair)| {
        let [one, other] = [pair[0].abs() as f64, pair[1].abs() as f64];
        if (pair[0] < 0) != (pair[1] < 0) {
            let is_sudden = one.min(other) < slowest;
            return is_sudden.then(|| format!("a turn at {at}: {one} {other}"));
        }
        let (short, long) = (one.min(other), one.max(other));
        let change = f / (short + slack) - f / (long - slack).max(0.5);
        let time = (one + other + 2.0 * slack) / 2.0 / f;
        (change > acceleration * time * (1.0 + 1e-6))
            .then(|| format!("acceleration at {at}: {one} {other}: {}", change / time))
    })
}

/// A command of a random program.
#[derive(Clone, Debug)]
enum Order {
    MoveTo(i32),
    MoveBy(i32),
    Run(i32),
    Rate(u32),
    Stop,
    SetPosition(i32),
}

fn orders() -> impl Strategy<Value = Vec<(Order, u16)>> {
    let order = prop_oneof![
        (-3000_i32..3000).prop_map(Order::MoveTo),
        (-300_i32..300).prop_map(Order::MoveBy),
        (-2500_i32..2500).prop_map(Order::Run),
        (0_u32..2500).prop_map(Order::Rate),
        Just(Order::Stop),
        (-3000_i32..3000).prop_map(Order::SetPosition),
    ];
    prop::collection::vec((order, 0_u16..600), 1..20)
}

/// Gives the orders to an axis, and checks what they promise. Returns the intervals of each motion
/// from rest to rest.
fn obey<L: AxisLimits + Clone>(limits: L, orders: &[(Order, u16)]) -> Vec<Vec<i64>> {
    let mut axis = StepperAxis::new(Counter::default(), limits).unwrap();
    let (mut motions, mut intervals) = (Vec::new(), Vec::new());
    let mut steps = |axis: &mut StepperAxis<Counter, L>, count: usize| {
        for _ in 0..count {
            let Some(interval) = step(axis) else {
                motions.push(std::mem::take(&mut intervals));
                assert_eq!(axis.goal(), Some(axis.position()));
                assert!(!axis.is_moving());
                assert_eq!(axis.rate_hz(), 0);
                return true;
            };
            intervals.push(interval);
        }
        false
    };
    for (order, count) in orders {
        let (goal, position) = (axis.goal(), axis.position());
        match *order {
            Order::MoveTo(at) => axis.move_to(at),
            Order::MoveBy(by) => axis.move_by(by),
            Order::Run(rate) => {
                let is_refused = axis.run(rate).is_err();
                assert_eq!(is_refused, rate.abs() > 2000);
                assert!(is_refused || rate == 0 || axis.goal().is_none());
            }
            Order::Rate(rate) => {
                assert_eq!(axis.set_rate(rate).is_err(), !(1..=2000).contains(&rate));
                assert_eq!(axis.goal(), goal);
            }
            Order::Stop => axis.stop(),
            Order::SetPosition(at) => {
                axis.set_position(at);
                assert_eq!(axis.goal(), goal.map(|goal| goal - position + at));
            }
        }
        steps(&mut axis, usize::from(*count));
    }
    axis.stop();
    assert!(steps(&mut axis, 20_000), "it does not stop");
    motions
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    /// Whatever is ordered and whenever: no step is faster than the limits, and every motion ends
    /// at its goal.
    #[test]
    fn no_order_breaks_the_limits(orders in orders()) {
        for intervals in obey(LIMITS, &orders) {
            prop_assert_eq!(fault(&intervals, &LIMITS, 2.5), None);
        }
    }

    /// The same with limited jerk.
    #[test]
    fn no_order_breaks_the_limits_of_s_curves(orders in orders()) {
        for intervals in obey(JERK, &orders) {
            prop_assert_eq!(fault(&intervals, &LIMITS, 2.5), None);
        }
    }

    /// No limits and no numbers panic, and every position is reached within the range of `i32`.
    #[test]
    fn any_numbers(
        timer_hz: u32,
        top_rate_hz: u32,
        acceleration_hz_per_s: u32,
        jerk_hz_per_s2: u32,
        shifts: [u8; 4],
        goals: Vec<i32>,
        timing: [u16; 4],
    ) {
        let cut = |value: u32, by: u8| value >> (by % 32);
        let (timer_hz, top_rate_hz) = (cut(timer_hz, shifts[0]), cut(top_rate_hz, shifts[1]));
        let acceleration_hz_per_s = cut(acceleration_hz_per_s, shifts[2]);
        let jerk_hz_per_s2 = cut(jerk_hz_per_s2, shifts[3]);
        let [setup_ticks, hold_ticks, high_ticks, low_ticks] = timing.map(u32::from);
        let pulse = PulseTiming { setup_ticks, hold_ticks, high_ticks, low_ticks };
        let driver = StepDirection::new(pulse);
        let straight = AccelerationLimits { timer_hz, top_rate_hz, acceleration_hz_per_s };
        let smooth = JerkLimits { timer_hz, top_rate_hz, acceleration_hz_per_s, jerk_hz_per_s2 };
        try_goals(StepperAxis::new(driver, straight), &goals);
        try_goals(StepperAxis::new(driver, smooth), &goals);
    }
}

fn try_goals<L: AxisLimits>(
    axis: Result<StepperAxis<StepDirection, L>, StepperAxisError>,
    goals: &[i32],
) {
    let Ok(mut axis) = axis else { return };
    for goal in goals {
        axis.set_position(goal.wrapping_mul(3));
        axis.move_to(*goal);
        (0..50).all(|_| axis.next_change().is_some());
        let _ = axis.run(goal >> 7);
        (0..50).all(|_| axis.next_change().is_some());
        let _ = axis.set_rate(goal.unsigned_abs() >> 9);
        axis.move_by(*goal);
        (0..50).all(|_| axis.next_change().is_some());
        axis.stop();
        let _ = axis.rate_hz();
        (0..50).all(|_| axis.next_change().is_some());
        axis.halt();
    }
}

#[test]
fn a_move_is_the_trapezoid_of_the_planner() {
    let mut axis = StepperAxis::new(Counter::default(), LIMITS).unwrap();
    axis.move_to(1000);
    assert!(axis.is_moving());
    let intervals = run(&mut axis);
    let profile = LIMITS.profile(2_000, 1000).unwrap();
    assert_eq!(intervals, profile.map(i64::from).collect::<Vec<_>>());
    assert_eq!((axis.position(), axis.is_moving()), (1000, false));
    axis.move_by(-1);
    // Half a step up and half a step down: 2 sqrt(1 / a).
    assert_eq!(run(&mut axis), [-20_000]);
    assert_eq!(axis.position(), 999);
}

#[test]
fn a_goal_ahead_keeps_the_rate_and_a_goal_behind_returns() {
    let mut axis = StepperAxis::new(Counter::default(), LIMITS).unwrap();
    axis.move_to(2_000);
    let mut all = take(&mut axis, 1_000);
    assert_eq!((axis.position(), axis.rate_hz()), (1_000, 2_000));
    axis.move_to(1_500);
    assert_eq!(step(&mut axis), Some(500));
    // The braking distance is 200 steps.
    axis.move_to(1_100);
    assert_eq!(axis.goal(), Some(1_100));
    let intervals = run(&mut axis);
    assert_eq!(intervals.iter().filter(|ticks| **ticks > 0).count(), 200);
    assert_eq!(intervals.iter().filter(|ticks| **ticks < 0).count(), 101);
    assert_eq!(axis.position(), 1_100);
    all.extend(intervals);
    assert_eq!(fault(&all, &LIMITS, 2.0), None);
}

#[test]
fn a_run_changes_its_speed_and_reverses() {
    let mut axis = StepperAxis::new(Counter::default(), LIMITS).unwrap();
    axis.run(1_000).unwrap();
    let mut intervals = take(&mut axis, 500);
    assert_eq!((axis.rate_hz(), axis.goal()), (1_000, None));
    axis.run(2_000).unwrap();
    intervals.extend(take(&mut axis, 500));
    assert_eq!(axis.rate_hz(), 2_000);
    axis.run(-500).unwrap();
    intervals.extend(take(&mut axis, 500));
    assert_eq!(axis.rate_hz(), -500);
    axis.stop();
    // 500^2 / 20 000 = 12.5 steps.
    assert_eq!(axis.goal(), Some(axis.position() - 13));
    intervals.extend(run(&mut axis));
    assert_eq!(fault(&intervals, &LIMITS, 2.0), None);
    // A move has its own rate again.
    axis.move_by(1_000);
    take(&mut axis, 500);
    assert_eq!(axis.rate_hz(), 2_000);
    axis.set_rate(400).unwrap();
    take(&mut axis, 300);
    assert_eq!(axis.rate_hz(), 400);
}

/// Limits whose profiles are short, like one that has nearly run out after billions of steps.
#[derive(Clone, Debug)]
struct NearlyOver;

impl AxisLimits for NearlyOver {
    type Profile = <AccelerationLimits as AxisLimits>::Profile;

    fn timer_hz(&self) -> u32 {
        LIMITS.timer_hz()
    }

    fn top_rate_hz(&self) -> u32 {
        LIMITS.top_rate_hz()
    }

    fn profile(&self, top_rate_hz: u32, steps: u32) -> Result<Self::Profile, RatesError> {
        LIMITS.profile(top_rate_hz, steps.min(1_000))
    }
}

#[test]
fn a_run_does_not_end_with_its_profile() {
    let mut axis = StepperAxis::new(Counter::default(), NearlyOver).unwrap();
    axis.set_position(i32::MAX - 500);
    axis.run(2_000).unwrap();
    take(&mut axis, 1_000);
    assert_eq!((axis.rate_hz(), axis.position()), (2_000, i32::MIN + 499));
}

#[test]
fn a_halt_makes_no_further_step() {
    let mut axis = StepperAxis::new(Counter::default(), LIMITS).unwrap();
    axis.move_to(500);
    take(&mut axis, 300);
    axis.halt();
    assert_eq!(axis.next_change(), None);
    assert_eq!((axis.position(), axis.goal()), (300, Some(300)));
    axis.move_to(301);
    assert_eq!(run(&mut axis).len(), 1);
}

#[test]
fn limits_and_rates_are_checked() {
    let slow = StepDirection::new(PulseNanoseconds::A4988.ticks(TIMER_HZ));
    let fast = AccelerationLimits {
        top_rate_hz: 400_000,
        acceleration_hz_per_s: 1_000_000,
        ..LIMITS
    };
    assert_eq!(
        StepperAxis::new(slow, fast).err(),
        Some(StepperAxisError::DriverTooSlow)
    );
    let none = AccelerationLimits {
        acceleration_hz_per_s: 0,
        ..LIMITS
    };
    assert!(matches!(
        StepperAxis::new(slow, none).err(),
        Some(StepperAxisError::Rates(_))
    ));
    let mut axis = StepperAxis::new(slow, LIMITS).unwrap();
    assert_eq!(axis.run(2_001), Err(StepperAxisError::AboveLimit));
    assert_eq!(axis.run(i32::MIN), Err(StepperAxisError::AboveLimit));
    assert!(axis.set_rate(0).is_err());
    assert!(!axis.is_moving());
}

/// The rising edges of STEP: their times, and the level of DIR.
fn edges<L: AxisLimits>(
    axis: &mut StepperAxis<StepDirection, L>,
    timing: PulseTiming,
    changes: usize,
) -> Vec<(u64, bool)> {
    let (mut now, mut before) = (0_u64, axis.levels());
    let (mut rise, mut fall, mut turn) = (None, None, None);
    let [setup, hold, high, low] = [
        timing.setup_ticks,
        timing.hold_ticks,
        timing.high_ticks,
        timing.low_ticks,
    ]
    .map(u64::from);
    let mut edges = Vec::new();
    for _ in 0..changes {
        let Some(change) = axis.next_change() else {
            break;
        };
        now += u64::from(change.ticks);
        let changed = Levels(before.0 ^ change.levels.0);
        let since = |time: Option<u64>| time.map_or(u64::MAX, |time| now - time);
        if changed.contains(Levels::DIR) {
            assert!(since(rise) >= hold);
            assert!(!change.levels.contains(Levels::STEP));
            turn = Some(now);
        }
        if changed.contains(Levels::STEP) && change.levels.contains(Levels::STEP) {
            assert!(since(turn) >= setup);
            assert!(since(fall) >= low);
            rise = Some(now);
            edges.push((now, change.levels.contains(Levels::DIR)));
        } else if changed.contains(Levels::STEP) {
            assert!(since(rise) >= high);
            fall = Some(now);
        }
        before = change.levels;
    }
    edges
}

#[test]
fn an_a4988_counts_one_rising_edge_for_each_step() {
    let timing = PulseNanoseconds::A4988.ticks(10_000_000);
    let limits = AccelerationLimits {
        timer_hz: 10_000_000,
        ..LIMITS
    };
    let mut axis = StepperAxis::new(StepDirection::new(timing), limits).unwrap();
    axis.move_to(200);
    let there = edges(&mut axis, timing, usize::MAX);
    // STEP rises at the times of the profile.
    let mut now = 0;
    let times = limits.profile(2_000, 200).unwrap().map(|ticks| {
        now += u64::from(ticks);
        (now, true)
    });
    assert_eq!(there, times.collect::<Vec<_>>());
    axis.move_to(1_000);
    let mut edges_seen = edges(&mut axis, timing, 600);
    axis.move_to(0);
    edges_seen.extend(edges(&mut axis, timing, usize::MAX));
    let [forward, backward] = [true, false].map(|is_forward| {
        edges_seen
            .iter()
            .filter(|edge| edge.1 == is_forward)
            .count() as i32
    });
    assert_eq!((200 + forward - backward, axis.position()), (0, 0));
}

/// Between the turn of DIR and the edge, a step has not been made: without current it is taken
/// back. An edge that was made is counted.
#[test]
fn current_off_counts_the_edges_that_were_made() {
    let timing = PulseNanoseconds::A4988.ticks(10_000_000);
    for changes in 0..12 {
        let mut axis = StepperAxis::new(StepDirection::new(timing), LIMITS).unwrap();
        axis.move_to(10);
        let made = edges(&mut axis, timing, changes).len();
        axis.set_enabled(false);
        assert_eq!(axis.position(), made as i32);
        axis.move_to(3);
        assert_eq!(edges(&mut axis, timing, usize::MAX).len(), 0);
        axis.set_enabled(true);
        let edges = edges(&mut axis, timing, usize::MAX).len();
        assert_eq!((axis.position(), edges), (3, made.abs_diff(3)));
    }
}

/// The sizes in the README.
#[test]
fn an_axis_is_small() {
    let sizes = [
        size_of::<StepperAxis<StepDirection, AccelerationLimits>>(),
        size_of::<StepperAxis<StepDirection, JerkLimits>>(),
    ];
    assert!(sizes[0] <= 192 && sizes[1] <= 256, "{sizes:?}");
}

#[test]
fn coils_turn_with_the_steps() {
    let motor = Sequencer::new(Driver::Unipolar, Mode::Full).unwrap();
    let mut axis = StepperAxis::new(motor, JERK).unwrap();
    axis.move_to(4);
    let levels: Vec<u8> = std::iter::from_fn(|| axis.next_change())
        .map(|change| change.levels.0)
        .collect();
    assert_eq!(levels, [9, 12, 6, 3]);
}

/// Limits of one's own, with a profile of one's own: at constant rate, without ramps.
#[derive(Clone, Debug)]
struct Constant(u32);

#[derive(Clone, Debug)]
struct Even {
    ticks: u32,
    left: u32,
}

impl AxisLimits for Constant {
    type Profile = Even;

    fn timer_hz(&self) -> u32 {
        TIMER_HZ
    }

    fn top_rate_hz(&self) -> u32 {
        self.0
    }

    fn profile(&self, top_rate_hz: u32, left: u32) -> Result<Even, RatesError> {
        let ticks = TIMER_HZ.checked_div(top_rate_hz).ok_or(RatesError::Zero)?;
        Ok(Even { ticks, left })
    }
}

impl Iterator for Even {
    type Item = u32;

    fn next(&mut self) -> Option<u32> {
        self.left = self.left.checked_sub(1)?;
        Some(self.ticks)
    }
}

impl AxisProfile for Even {
    fn set_remaining(&mut self, steps: u32) -> bool {
        self.left = steps;
        true
    }

    fn stop(&mut self) -> u32 {
        self.left = 0;
        0
    }

    fn set_top_rate(&mut self, rate_hz: u32) {
        self.ticks = TIMER_HZ / rate_hz;
    }

    fn steps_left(&self) -> u32 {
        self.left
    }

    fn rate_hz(&self) -> u32 {
        if self.left == 0 {
            0
        } else {
            TIMER_HZ / self.ticks
        }
    }
}

#[test]
fn a_profile_of_ones_own_runs_the_axis() {
    let mut axis = StepperAxis::new(Counter::default(), Constant(1_000)).unwrap();
    axis.move_to(3);
    assert_eq!(step(&mut axis), Some(1_000));
    axis.move_to(-1);
    assert_eq!(run(&mut axis), [-1_000, -1_000]);
    axis.run(500).unwrap();
    assert_eq!(step(&mut axis), Some(2_000));
    axis.stop();
    assert_eq!((axis.next_change(), axis.position()), (None, 0));
}

#[cfg(feature = "embedded-hal-async")]
mod delays {
    use super::*;
    use core::future::Future;
    use core::pin::pin;
    use core::task::{Context, Poll, Waker};

    /// Adds up the delays. The async one is pending at its first poll.
    #[derive(Default)]
    struct Clock(u64);

    impl embedded_hal::delay::DelayNs for Clock {
        fn delay_ns(&mut self, ns: u32) {
            self.0 += u64::from(ns);
        }
    }

    impl embedded_hal_async::delay::DelayNs for Clock {
        async fn delay_ns(&mut self, ns: u32) {
            let mut is_pending = true;
            core::future::poll_fn(|_| {
                if core::mem::take(&mut is_pending) {
                    Poll::Pending
                } else {
                    Poll::Ready(())
                }
            })
            .await;
            self.0 += u64::from(ns);
        }
    }

    #[test]
    fn a_loop_waits_for_the_time_of_the_move() {
        let mut axis = StepperAxis::new(Counter::default(), LIMITS).unwrap();
        let mut clock = Clock::default();
        axis.move_to(200);
        while axis.wait(&mut clock).is_some() {}
        let ticks: u32 = LIMITS.profile(2_000, 200).unwrap().sum();
        assert_eq!(clock.0, u64::from(ticks) * 1_000);
    }

    /// Every second future is dropped at its first poll; no change is lost.
    #[test]
    fn a_dropped_wait_loses_no_change() {
        let timing = PulseNanoseconds::A4988.ticks(TIMER_HZ);
        let mut axis = StepperAxis::new(StepDirection::new(timing), LIMITS).unwrap();
        let mut clock = Clock::default();
        axis.move_to(20);
        axis.next_change().unwrap();
        let mut context = Context::from_waker(Waker::noop());
        let (mut edges, mut high) = (0, false);
        'all: loop {
            let _ = pin!(axis.wait_async(&mut clock)).poll(&mut context);
            let mut wait = pin!(axis.wait_async(&mut clock));
            loop {
                match wait.as_mut().poll(&mut context) {
                    Poll::Pending => {}
                    Poll::Ready(None) => break 'all,
                    Poll::Ready(Some(levels)) => {
                        let is_high = levels.contains(Levels::STEP);
                        edges += u32::from(is_high && !high);
                        high = is_high;
                        break;
                    }
                }
            }
        }
        assert_eq!((edges, axis.position()), (20, 20));
    }
}
