//! No axis exceeds its highest step rate across the boundaries of moves.

mod common;

use common::{axis, config};
use husillo_backlash::Backlash;
use husillo_gcode::Command;
use husillo_interp::Path;
use husillo_machine::{AxisRamp, Config, Event, Machine, Segment};
use proptest::prelude::*;

/// Least ticks between two steps of each axis, and the total ticks.
struct Intervals<const N: usize> {
    clock: u64,
    /// Tick of the last step of each axis, and the index of its move.
    last: [Option<(u64, u32)>; N],
    least: [u64; N],
    /// Between two steps of the same arc.
    least_in_arc: [u64; N],
    segment: Option<Segment<N>>,
    moves: u32,
}

impl<const N: usize> Intervals<N> {
    fn new() -> Self {
        Intervals {
            clock: 0,
            last: [None; N],
            least: [u64::MAX; N],
            least_in_arc: [u64::MAX; N],
            segment: None,
            moves: 0,
        }
    }

    fn see(&mut self, event: Event<N>, segment: Option<&Segment<N>>) {
        if self.segment.as_ref() != segment {
            self.segment = segment.copied();
            self.moves += 1;
        }
        let is_arc = segment.is_some_and(|it| matches!(it.command, Command::Arc { .. }));
        let (wait, delta) = match event {
            Event::Step(step) => (step.wait_ticks, step.delta),
            Event::Dwell { wait_ticks } => (wait_ticks, [0; N]),
            _ => return,
        };
        self.clock += u64::from(wait);
        for (axis, _) in (0..).zip(delta).filter(|(_, delta)| *delta != 0) {
            if let Some((last, number)) = self.last[axis] {
                let least = if is_arc && number == self.moves {
                    &mut self.least_in_arc[axis]
                } else {
                    &mut self.least[axis]
                };
                *least = (*least).min(self.clock - last);
            }
            self.last[axis] = Some((self.clock, self.moves));
        }
    }
}

/// An action between the lines.
#[derive(Clone, Debug)]
enum Act {
    Line(String),
    /// Requests this many events.
    Events(u16),
    Hold,
    Resume,
    Abort,
    Override(u8),
}

fn run(config: Config<3>, acts: &[Act]) -> Intervals<3> {
    let mut machine = Machine::<3, Path<3>, Backlash, 8>::new(config);
    let mut seen = Intervals::new();
    for act in acts {
        match act {
            Act::Line(line) => {
                machine.resume();
                while !machine.has_room() {
                    let Some(event) = machine.next_event() else {
                        break;
                    };
                    seen.see(event, machine.executing());
                }
                let _ = machine.line(line.as_bytes());
            }
            Act::Events(count) => {
                for _ in 0..*count {
                    let Some(event) = machine.next_event() else {
                        break;
                    };
                    seen.see(event, machine.executing());
                }
            }
            Act::Hold => machine.hold(),
            Act::Resume => machine.resume(),
            Act::Abort => machine.abort(),
            Act::Override(percent) => machine.set_feed_override(*percent),
        }
    }
    machine.resume();
    while let Some(event) = machine.next_event() {
        seen.see(event, machine.executing());
    }
    seen
}

fn lines(text: &str) -> Vec<Act> {
    text.lines().map(|line| Act::Line(line.into())).collect()
}

fn assert_allowed(config: &Config<3>, seen: &Intervals<3>) {
    for (number, axis) in config.axes.iter().enumerate() {
        let interval = u64::from(config.timer_hz / axis.max_rate_hz);
        // Ends lie between steps, so a move of 64 steps or more may have a fraction of a step too
        // many.
        let allowed = interval - interval / 64;
        let least = seen.least[number];
        assert!(
            least >= allowed,
            "axis {number}: {least} ticks, {allowed} are the least"
        );
        // At 45 degrees two steps share the length of the diagonal.
        let (least, allowed) = (seen.least_in_arc[number], allowed * 70 / 100);
        assert!(
            least >= allowed,
            "axis {number} in an arc: {least} ticks, {allowed} are the least"
        );
    }
}

/// X, Y and Z with ramps, as on a small router.
fn with_ramps(backlash_steps: u32) -> Config<3> {
    let config = config();
    let axes = config.axes.map(|_| husillo_machine::Axis {
        ramp: Some(AxisRamp {
            acceleration_hz_per_s: 300,
            start_rate_hz: 40,
            jerk_hz_per_s2: None,
            junction_hz: Some(60),
        }),
        ..axis(backlash_steps)
    });
    Config { axes, ..config }
}

#[test]
fn a_move_of_two_nanometres_does_not_fire_its_step_behind_the_last_one() {
    let program = "G21 G90\nG1 X0.010149 F1.4\nX0.010151\nX0.020\nM2";
    for config in [config(), with_ramps(0)] {
        assert_allowed(&config, &run(config, &lines(program)));
    }
}

#[test]
fn moves_shorter_than_a_step_take_their_programmed_time() {
    // 3000 moves of 7 nm at 0.5 mm/min: 21 um take 2.52 s.
    let mut text = String::from("G21 G90 G1 F0.5\n");
    for number in 1..=3000 {
        text += &format!("X{:.6}\n", f64::from(number) * 7e-6);
    }
    text += "M2";
    let seen = run(config(), &lines(&text));
    assert_allowed(&config(), &seen);
    assert!(seen.clock.abs_diff(2_520_000) <= 2, "{}", seen.clock);
}

fn short() -> impl Strategy<Value = i64> {
    prop_oneof![-20_i64..20, -300_i64..300, -3000_i64..3000, Just(0)]
}

fn act() -> impl Strategy<Value = Act> {
    let mm = |nm: i64| nm as f64 / 1e6;
    let line =
        (0..12_u8, short(), short(), short(), 1..200_u32).prop_map(move |(kind, x, y, z, feed)| {
            let feed = f64::from(feed) / 100.0;
            let [x, y, z] = [x, y, z].map(mm);
            Act::Line(match kind {
                0 | 1 => format!("G91 G0 X{x:.6} Y{y:.6} Z{z:.6}"),
                2 => format!("G91 G0 X{x:.6}"),
                3 => format!("G91 G1 X{x:.6} F{feed}"),
                4 => format!("G4 P{:.6}", x.abs()),
                5 => format!("G91 G2 X0 Y0 I{x:.6} J{y:.6} F{feed}"),
                6 => format!(
                    "G91 G3 X{:.6} Y{:.6} I{x:.6} J{y:.6} F{feed}",
                    2.0 * x,
                    2.0 * y
                ),
                7 => format!("G91 G2 X{:.6} Y{:.6} I{x:.6} J{y:.6} F{feed}", x - y, x + y),
                _ => format!("G91 G1 X{x:.6} Y{y:.6} Z{z:.6} F{feed}"),
            })
        });
    prop_oneof![
        12 => line,
        3 => (0_u16..40).prop_map(Act::Events),
        1 => Just(Act::Hold),
        1 => Just(Act::Resume),
        1 => Just(Act::Abort),
        1 => (10_u8..=200).prop_map(Act::Override),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { max_shrink_iters: 2000, ..ProptestConfig::default() })]

    #[test]
    fn no_axis_is_stepped_faster_than_its_rate(
        acts in prop::collection::vec(act(), 1..40),
        has_ramps: bool,
        backlash_steps in prop_oneof![Just(0_u32), 1_u32..6],
    ) {
        let mut config = if has_ramps { with_ramps(backlash_steps) } else { config() };
        for axis in &mut config.axes {
            axis.backlash_steps = backlash_steps;
        }
        assert_allowed(&config, &run(config, &acts));
    }
}
