//! The interval of each axis over the borders of moves, on a machine with ramps whose axes differ.

mod common;

use common::config;
use husillo_backlash::{Backlash, Flank};
use husillo_gcode::Command;
use husillo_interp::Path;
use husillo_machine::{Axis, AxisRamp, Config, Event, Machine, Origin, Scale, Segment};
use proptest::prelude::*;

const HZ: u32 = 16_000_000;

type Mill = Machine<3, Path<3>, Backlash, 8>;

/// Steps of 2.5 um, 2.5 um and 0.625 um; rates of 25, 20 and 6 kHz.
fn router(backlash_steps: [u32; 3], start_rate_hz: u32) -> Config<3> {
    let rates = [25_000, 20_000, 6_000];
    let accelerations = [200_000, 120_000, 160_000];
    let scales = [(2_500, 1), (2_500, 1), (625, 1)];
    let axes = [0, 1, 2].map(|number| Axis {
        scale: Scale::new(scales[number].0, scales[number].1).unwrap(),
        travel: None,
        max_rate_hz: rates[number],
        backlash_steps: backlash_steps[number],
        ramp: Some(AxisRamp {
            acceleration_hz_per_s: accelerations[number],
            start_rate_hz,
            jerk_hz_per_s2: None,
            junction_hz: Some(800),
        }),
    });
    Config {
        axes,
        timer_hz: HZ,
        ..config()
    }
}

/// A step of an axis.
#[derive(Copy, Clone, Debug)]
struct Seen {
    tick: u64,
    /// Number of its move, and what it is.
    of: u32,
    kind: Kind,
    /// Whether the axis is no slower than the longest one of its line.
    is_steady: bool,
}

#[derive(Copy, Clone, Debug, PartialEq)]
enum Kind {
    Line,
    Arc,
    TakeUp,
}

/// All steps of a run, by axis.
#[derive(Default)]
struct Watch {
    clock: u64,
    steps: [Vec<Seen>; 3],
    segment: Option<Segment<3>>,
    moves: u32,
}

impl Watch {
    fn see(&mut self, machine: &Mill, event: Event<3>) {
        if self.segment.as_ref() != machine.executing() {
            self.segment = machine.executing().copied();
            self.moves += 1;
        }
        let (wait, delta) = match event {
            Event::Step(step) => (step.wait_ticks, step.delta),
            Event::Dwell { wait_ticks } => (wait_ticks, [0; 3]),
            _ => return,
        };
        self.clock += u64::from(wait);
        let is_arc = self
            .segment
            .is_some_and(|it| matches!(it.command, Command::Arc { .. }));
        let kind = match machine.origin() {
            Origin::TakeUp => Kind::TakeUp,
            _ if is_arc => Kind::Arc,
            _ => Kind::Line,
        };
        let ways = self.segment.map_or([0; 3], |segment| {
            let to = segment.command.end().unwrap_or(segment.from);
            let [from, to] = [segment.from, to].map(|at| machine.config().nearest_steps(&at));
            let [from, to] = [from.unwrap(), to.unwrap()];
            [0, 1, 2].map(|axis: usize| from[axis].abs_diff(to[axis]))
        });
        for axis in (0..3).filter(|axis| delta[*axis] != 0) {
            self.steps[axis].push(Seen {
                tick: self.clock,
                of: self.moves,
                kind,
                is_steady: is_steady(machine.config(), &ways, axis),
            });
        }
    }

    /// Checks every interval, and the time of several intervals in a row.
    fn check(&self, config: &Config<3>) {
        for (number, (steps, axis)) in self.steps.iter().zip(&config.axes).enumerate() {
            let interval = f64::from(HZ) / f64::from(axis.max_rate_hz);
            // A move may have a part of a step too many: one in 64.
            let least = interval * (1.0 - 1.0 / 64.0) - 2.0;
            for pair in steps.windows(2) {
                let [before, after] = [pair[0], pair[1]];
                let is_first = before.of != after.of || before.kind == Kind::TakeUp;
                let allowed = match after.kind {
                    Kind::TakeUp => least,
                    Kind::Line if after.is_steady => least,
                    // At 45 degrees two steps share the length of the diagonal.
                    Kind::Arc if number < 2 => least * if is_first { 1.0 } else { 0.7 },
                    // Two events of a helix in a row differ by up to sqrt(2), and both together
                    // have more than the interval.
                    Kind::Arc => least / 2.42,
                    // Steps at events of another axis: at least the whole number of events below
                    // their ratio.
                    _ => least / 2.0,
                };
                let found = (after.tick - before.tick) as f64;
                assert!(
                    found >= allowed,
                    "axis {number}: {found} of {allowed}, {pair:?}"
                );
            }
            for count in [3, 8, 30] {
                for row in steps.windows(count + 1) {
                    let found = (row[count].tick - row[0].tick) as f64;
                    assert!(
                        found >= (count as f64 - 1.0) * least,
                        "axis {number}: {count} intervals in {found}, {row:?}"
                    );
                }
            }
        }
    }
}

fn is_steady(config: &Config<3>, ways: &[u32; 3], axis: usize) -> bool {
    let rates = config.axes.map(|axis| axis.max_rate_hz);
    let longest = (0..3).filter(|other| Some(&ways[*other]) == ways.iter().max());
    longest.map(|other| rates[other]).min() <= Some(rates[axis])
}

#[derive(Clone, Debug)]
enum Act {
    Line(String),
    Events(u16),
    Hold,
    Resume,
    Abort,
    Override(u8),
}

fn run(config: Config<3>, acts: &[Act]) -> Watch {
    let backlash = config
        .axes
        .map(|axis| Backlash::new(axis.backlash_steps, Flank::Positive));
    let mut machine = Mill::with_backlash(config, backlash);
    let mut watch = Watch::default();
    let mut pull = |machine: &mut Mill, most: usize| {
        for _ in 0..most {
            let Some(event) = machine.next_event() else {
                return false;
            };
            watch.see(machine, event);
        }
        true
    };
    for act in acts {
        match act {
            Act::Line(line) => {
                machine.resume();
                while !machine.has_room() && pull(&mut machine, 1) {}
                let _ = machine.line(line.as_bytes());
            }
            Act::Events(count) => {
                pull(&mut machine, usize::from(*count));
            }
            Act::Hold => machine.hold(),
            Act::Resume => machine.resume(),
            Act::Abort => machine.abort(),
            Act::Override(percent) => machine.set_feed_override(*percent),
        }
    }
    machine.resume();
    pull(&mut machine, usize::MAX);
    watch
}

fn way() -> impl Strategy<Value = i64> {
    prop_oneof![
        -300_i64..300,
        -4000_i64..4000,
        -2_000_000_i64..2_000_000,
        Just(0)
    ]
}

fn act() -> impl Strategy<Value = Act> {
    let mm = |nm: i64| nm as f64 / 1e6;
    let line = (0..12_u8, way(), way(), way(), 1..4000_u32).prop_map(move |(kind, x, y, z, f)| {
        let [x, y, z] = [x, y, z].map(mm);
        Act::Line(match kind {
            0 | 1 => format!("G91 G0 X{x:.6} Y{y:.6} Z{z:.6}"),
            2 => format!("G91 G0 Z{z:.6}"),
            3 => format!("G91 G1 X{x:.6} F{f}"),
            4 => format!("G4 P{:.6}", x.abs() / 100.0),
            5 => format!("G91 G2 X0 Y0 I{x:.6} J{y:.6} F{f}"),
            6 => format!(
                "G91 G3 X{:.6} Y{:.6} I{x:.6} J{y:.6} Z{z:.6} F{f}",
                2.0 * x,
                2.0 * y
            ),
            7 => format!("G91 G2 X{:.6} Y{:.6} I{x:.6} J{y:.6} F{f}", x - y, x + y),
            8 => "G64 P0.05".into(),
            _ => format!("G91 G1 X{x:.6} Y{y:.6} Z{z:.6} F{f}"),
        })
    });
    prop_oneof![
        12 => line,
        3 => (0_u16..200).prop_map(Act::Events),
        1 => Just(Act::Hold),
        1 => Just(Act::Resume),
        1 => Just(Act::Abort),
        1 => (10_u8..=200).prop_map(Act::Override),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 300,
        max_shrink_iters: 500,
        ..ProptestConfig::default()
    })]

    /// Whatever follows whatever: short moves, rapids, arcs, take-ups, holds, aborts, overrides.
    #[test]
    fn no_axis_is_faster_than_its_rate(
        acts in prop::collection::vec(act(), 1..40),
        backlash_steps in prop_oneof![Just([0_u32; 3]), Just([12, 7, 40])],
        start in prop_oneof![Just(0_u32), Just(500)],
    ) {
        let config = router(backlash_steps, start);
        run(config, &acts).check(&config);
    }
}

/// Ticks of all events, and the longest wait after the first `after` events and before the last.
fn waits(lines: &[&str], after: usize) -> (u64, u32) {
    let mut machine = Mill::new(router([0; 3], 0));
    for line in lines {
        machine.line(line.as_bytes()).unwrap();
    }
    let mut waits = Vec::new();
    while let Some(event) = machine.next_event() {
        if let Event::Step(step) = event {
            waits.push(step.wait_ticks);
        }
    }
    let inner = &waits[after..waits.len() - after];
    let longest = inner.iter().max().copied().unwrap();
    (waits.iter().map(|wait| u64::from(*wait)).sum(), longest)
}

/// Z steps at two of three events, so two of its steps are closer than at its highest rate. The
/// border of a move must not delay them, because X would stop at each of them.
#[test]
fn a_border_on_a_line_delays_nothing() {
    let (whole, longest) = waits(&["G1 X40 Z6.66 F6000"], 4000);
    let split = ["G1 X10 Z1.665 F6000", "G1 X20 Z3.33", "G1 X40 Z6.66"];
    let (parts, longest_of_parts) = waits(&split, 4000);
    assert!(parts.abs_diff(whole) < 4000, "{parts} {whole}");
    assert!(
        longest_of_parts <= longest + 1,
        "{longest_of_parts} {longest}"
    );
}
