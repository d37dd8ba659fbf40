//! Stepping axes with encoders on motors that lose steps: every loss is reported, and corrected
//! moves end exactly.

use husillo_encoder::Extended;
use husillo_gcode::Dialect;
use husillo_machine::{
    Axis, AxisEncoder, AxisRamp, ClosedLoop, Config, Equipment, Event, Followed, Machine, OnLoss,
    Scale,
};
use husillo_sim::{AxisModel, Rig};
use husillo_stepper::{Drive, Driver, Idle, Mode, Motors, Sequencer};
use proptest::prelude::*;

const BACKLASH: u32 = 5;

/// Two axes of 1 um per full step, with encoders, in simulated time.
struct Stand {
    loop_: ClosedLoop<2>,
    motors: Motors<2, Drive>,
    rig: Rig<2>,
    counters: [Extended<16>; 2],
    ratio: [i64; 2],
    /// Sum of the reported losses.
    lost: [i32; 2],
    seen: Vec<Followed<2>>,
    events: u32,
}

impl Stand {
    fn new(encoder: AxisEncoder, ramp: Option<AxisRamp>, pull_out_ticks: u32) -> Stand {
        let axis = Axis {
            scale: Scale::new(1000, 1).unwrap(),
            travel: None,
            max_rate_hz: 1000,
            backlash_steps: BACKLASH,
            ramp,
        };
        let machine = Machine::new(Config {
            axes: [axis; 2],
            timer_hz: 1_000_000,
            dialect: Dialect::RS274,
            arc_tolerance: None,
            rapid: None,
            top_feed: None,
            corner_deviation: None,
            equipment: Equipment::NONE,
            spindle_counts: None,
        });
        let drive = || Drive::Coils(Sequencer::new(Driver::Pbl3717a, Mode::Full).unwrap());
        let motors = Motors::new([drive(), drive()], Idle::Hold);
        let model = AxisModel::coils(Driver::Pbl3717a, Mode::Full)
            .with_backlash(BACKLASH)
            .with_pull_out_ticks(pull_out_ticks);
        let rig = Rig::new([model; 2], *motors.levels());
        Stand {
            loop_: ClosedLoop::new(machine, [Some(encoder); 2]),
            motors,
            rig,
            counters: [Extended::new(0); 2],
            ratio: [encoder.counts.into(), encoder.steps.into()],
            lost: [0; 2],
            seen: Vec::new(),
            events: 0,
        }
    }

    /// The encoder counts, from a 16-bit counter each.
    fn counts(&mut self) -> [i64; 2] {
        let [counts, steps] = self.ratio;
        let motor = self.rig.motor();
        for (counter, motor) in self.counters.iter_mut().zip(motor) {
            counter.update((i64::from(motor) * counts).div_euclid(steps) as u32);
        }
        self.counters.map(|counter| counter.position())
    }

    /// Runs until no event is left, with `before` called before each event.
    fn run(&mut self, mut before: impl FnMut(&mut Stand)) {
        loop {
            before(self);
            let counts = self.counts();
            let Some(entry) = self.loop_.next_event(&counts) else {
                return;
            };
            match entry {
                Followed::Event(Event::Step(step)) => {
                    let rig = &mut self.rig;
                    self.motors
                        .step(step.wait_ticks, &step.delta, |wait_ticks, levels| {
                            rig.apply(levels, wait_ticks);
                        });
                    self.events += 1;
                }
                Followed::Event(Event::Dwell { wait_ticks }) => self.rig.wait(wait_ticks.into()),
                Followed::Event(_) => {}
                Followed::Lost { axis, steps } => {
                    self.lost[axis] += steps;
                    self.seen.push(entry);
                }
                Followed::Corrected { .. } | Followed::Stalled { .. } => self.seen.push(entry),
            }
            assert!(self.events < 2_000_000, "hangs");
        }
    }

    /// Takes lines and executes them.
    fn program(&mut self, lines: &[String], mut before: impl FnMut(&mut Stand)) {
        for line in lines {
            while !self.loop_.machine().has_room() {
                self.run(&mut before);
            }
            self.loop_.machine_mut().line(line.as_bytes()).unwrap();
        }
        self.run(&mut before);
    }
}

fn encoder(on_loss: OnLoss, counts: u32, steps: u32) -> AxisEncoder {
    AxisEncoder {
        counts,
        steps,
        tolerance_steps: 3,
        on_loss,
        correction_rate_hz: 200,
        settle_ticks: 20_000,
        attempts: 3,
    }
}

/// Any path of straight lines within 0.6 mm, and its end in steps.
fn program() -> impl Strategy<Value = (Vec<String>, [i32; 2])> {
    proptest::collection::vec((-300i32..300, -300i32..300, any::<bool>()), 1..6).prop_map(|moves| {
        let line = |&(x, y, rapid): &(i32, i32, bool)| {
            let code = if rapid { "G0" } else { "G1 F20" };
            format!(
                "{code} X{:.3} Y{:.3}",
                f64::from(x) / 1e3,
                f64::from(y) / 1e3
            )
        };
        let end = moves.last().map_or([0; 2], |&(x, y, _)| [x, y]);
        (moves.iter().map(line).collect(), end)
    })
}

/// Events before which an axis is turned by several cycles.
fn pushes() -> impl Strategy<Value = Vec<(u32, usize, i32)>> {
    proptest::collection::vec(
        (1u32..900, 0usize..2, prop_oneof![-2i32..=-1, 1i32..=2]),
        0..5,
    )
}

fn ramp() -> impl Strategy<Value = Option<AxisRamp>> {
    prop_oneof![
        Just(None),
        Just(Some(AxisRamp {
            acceleration_hz_per_s: 2000,
            start_rate_hz: 0,
            jerk_hz_per_s2: None,
            junction_hz: Some(100),
        }))
    ]
}

/// Encoders finer and coarser than a step, and uneven ratios.
fn ratio() -> impl Strategy<Value = (u32, u32)> {
    prop_oneof![
        Just((1, 1)),
        Just((4, 1)),
        Just((1000, 7)),
        Just((1, 3)),
        Just((3, 2))
    ]
}

/// Largest error of a position at rest, in steps: none where a count is no longer than a step, less
/// than two counts otherwise.
fn two_counts(counts: u32, steps: u32) -> i32 {
    2 * (steps.div_ceil(counts) as i32 - 1)
}

fn push_at(pushes: &[(u32, usize, i32)]) -> impl FnMut(&mut Stand) + '_ {
    let mut left = pushes.to_vec();
    move |stand| {
        left.retain(|&(event, axis, cycles)| {
            let is_now = stand.events >= event;
            if is_now {
                stand.rig.push(axis, 4 * cycles);
            }
            !is_now
        });
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    /// Every loss is reported, and the program runs to its end. The reported steps are exact where
    /// a count is no longer than a step. Otherwise they are within two counts: a motor at rest may
    /// be off by less than one count, and the encoder resolves its position to one count.
    #[test]
    fn nothing_is_lost_unreported(
        (lines, end) in program(), pushes in pushes(), ramp in ramp(), (counts, steps) in ratio(),
    ) {
        let mut stand = Stand::new(encoder(OnLoss::Report, counts, steps), ramp, 0);
        // The positions without disturbance.
        let mut ideal = Stand::new(encoder(OnLoss::Report, counts, steps), ramp, 0);
        ideal.program(&lines, |_| {});
        prop_assert_eq!(ideal.rig.tool(), end);
        prop_assert_eq!(&ideal.seen, &[]);
        stand.program(&lines, push_at(&pushes));
        let slack = two_counts(counts, steps);
        for axis in 0..2 {
            let behind = ideal.rig.motor()[axis] - stand.rig.motor()[axis];
            let lost = stand.lost[axis];
            prop_assert!((lost - behind).abs() <= slack, "{lost} of {behind}");
        }
    }

    /// Lost steps are re-emitted: motors and tool end exactly at their expected positions (within
    /// two counts, where a count is longer than a step). Every loss is reported as lost and as
    /// corrected.
    #[test]
    fn corrected_moves_end_exactly(
        (lines, end) in program(), pushes in pushes(), ramp in ramp(), (counts, steps) in ratio(),
    ) {
        let mut stand = Stand::new(encoder(OnLoss::Correct, counts, steps), ramp, 0);
        let mut ideal = Stand::new(encoder(OnLoss::Correct, counts, steps), ramp, 0);
        ideal.program(&lines, |_| {});
        stand.program(&lines, push_at(&pushes));
        let slack = two_counts(counts, steps);
        // If the motor is pushed onwards, the nut stays within its backlash until the axis
        // reverses.
        let is_pushed_on = |axis: usize| pushes.iter().any(|push| push.1 == axis);
        for (axis, end) in end.into_iter().enumerate() {
            let off = stand.rig.motor()[axis].abs_diff(ideal.rig.motor()[axis]);
            prop_assert!(off <= slack as u32, "motor {off}");
            let off = (stand.rig.tool()[axis] - end).abs();
            let is_right = off <= slack || is_pushed_on(axis) && off <= slack + BACKLASH as i32;
            prop_assert!(is_right, "tool {off}");
        }
        let lost = stand.seen.iter().filter(|seen| matches!(seen, Followed::Lost { .. })).count();
        let right = stand
            .seen
            .iter()
            .filter(|seen| matches!(seen, Followed::Corrected { .. }))
            .count();
        prop_assert_eq!(lost, right);
        prop_assert!(!stand.loop_.is_stopped());
    }

    /// An axis that is blocked for good ends with a report, and nothing hangs. After it is released
    /// and resumed it ends exactly (within two counts, where a count is longer than a step).
    #[test]
    fn a_blocked_axis_is_reported(
        (lines, _) in program(),
        at in 0u32..200,
        axis in 0usize..2,
        ramp in ramp(),
        (counts, steps) in ratio(),
    ) {
        let mut stand = Stand::new(encoder(OnLoss::Correct, counts, steps), ramp, 0);
        let mut ideal = Stand::new(encoder(OnLoss::Correct, counts, steps), ramp, 0);
        ideal.program(&lines, |_| {});
        for line in &lines {
            stand.loop_.machine_mut().line(line.as_bytes()).unwrap();
        }
        stand.run(|stand| if stand.events >= at { stand.rig.block(axis, true) });
        let slack = steps.div_ceil(counts) - 1;
        let (now, end) = (stand.rig.motor(), ideal.rig.motor());
        let is_behind = (0..2).any(|axis| now[axis].abs_diff(end[axis]) > slack);
        if is_behind {
            let last = stand.seen.last();
            let stalled =
                matches!(last, Some(Followed::Stalled { axis: there, .. }) if *there == axis);
            prop_assert!(stalled && stand.loop_.is_stopped(), "{:?}", stand.seen);
        }
        stand.rig.block(axis, false);
        stand.loop_.resume();
        stand.run(|_| {});
        let slack = two_counts(counts, steps) as u32;
        for axis in 0..2 {
            prop_assert!(stand.rig.motor()[axis].abs_diff(ideal.rig.motor()[axis]) <= slack);
        }
    }

    /// A stop lasts until the operator resumes. Then the lost steps are re-emitted and the program
    /// ends exactly.
    #[test]
    fn a_stop_waits_for_the_operator((lines, _) in program(), pushes in pushes(), ramp in ramp()) {
        let mut stand = Stand::new(encoder(OnLoss::Stop, 4, 1), ramp, 0);
        let mut ideal = Stand::new(encoder(OnLoss::Stop, 4, 1), ramp, 0);
        ideal.program(&lines, |_| {});
        for line in &lines {
            stand.loop_.machine_mut().line(line.as_bytes()).unwrap();
        }
        let mut push = push_at(&pushes);
        let mut stops = 0;
        stand.run(&mut push);
        while stand.loop_.is_stopped() {
            stops += 1;
            prop_assert!(stops < 20);
            let counts = stand.counts();
            prop_assert_eq!(stand.loop_.next_event(&counts), None);
            stand.loop_.resume();
            stand.run(&mut push);
        }
        prop_assert_eq!(stand.rig.motor(), ideal.rig.motor());
    }
}

/// Steps that come too fast are really lost, and they are reported.
#[test]
fn a_motor_that_is_too_slow_is_reported() {
    let lines = ["G0 X0.4".to_owned(), "G1 F6 X0.1 Y0.05".to_owned()];
    let mut ideal = Stand::new(encoder(OnLoss::Report, 4, 1), None, 0);
    ideal.program(&lines, |_| {});
    // 1 kHz, for a motor that follows up to 800 Hz.
    let mut stand = Stand::new(encoder(OnLoss::Report, 4, 1), None, 1250);
    stand.program(&lines, |_| {});
    assert!(
        stand.rig.lost_steps()[0] > 100,
        "{:?}",
        stand.rig.lost_steps()
    );
    let behind = ideal.rig.motor()[0] - stand.rig.motor()[0];
    assert!(
        behind != 0 && stand.lost[0] == behind,
        "{} of {behind}",
        stand.lost[0]
    );
    // At most the tolerance plus one event at a time.
    let most = stand.seen.iter().map(|seen| match seen {
        Followed::Lost { steps, .. } => steps.abs(),
        _ => 0,
    });
    assert!(most.max().unwrap() <= 3 + 4, "{:?}", stand.seen);
}

/// After an abort, missing steps are re-emitted before the next line moves; outputs are switched
/// off first.
#[test]
fn an_abort_puts_the_axes_right() {
    let mut stand = Stand::new(encoder(OnLoss::Stop, 4, 1), None, 0);
    stand.loop_.machine_mut().line(b"G1 F6 X0.1 Y0.02").unwrap();
    stand.run(|stand| {
        if stand.events == 40 {
            stand.rig.push(0, -8);
            stand.events += 1
        }
    });
    assert!(stand.loop_.is_stopped());
    stand.loop_.abort();
    stand.loop_.machine_mut().line(b"G0 X0.05 Y0").unwrap();
    stand.run(|_| {});
    assert_eq!(stand.rig.tool(), [50, 0]);
}
