//! Machines with position-dependent backlash: a screw with that backlash is at its programmed
//! position.

mod common;

use common::config;
use husillo_backlash::{BacklashMap, Flank, MappedBacklash};
use husillo_interp::Path;
use husillo_machine::{AxisRamp, Config, Event, Machine, Origin};
use proptest::prelude::*;

type Map = BacklashMap<Vec<i32>, Vec<u32>>;
type Micromill = Machine<3, Path<3>, MappedBacklash<Vec<i32>, Vec<u32>>, 8>;

/// Nuts on screws whose backlash at the load position is that of the map.
struct Screws {
    maps: [Map; 3],
    motor: [i32; 3],
    tool: [i32; 3],
}

impl Screws {
    fn new(maps: &[Map; 3]) -> Self {
        Self {
            maps: maps.clone(),
            motor: [0; 3],
            tool: [0; 3],
        }
    }

    fn step(&mut self, delta: [i8; 3], load: [i32; 3]) {
        for (axis, delta) in delta.into_iter().enumerate() {
            self.motor[axis] += i32::from(delta);
            let play = self.maps[axis].steps([load[0], load[1]]) as i32;
            let low = self.motor[axis];
            self.tool[axis] = self.tool[axis].clamp(low, low + play);
        }
    }
}

/// Three by three points 300 steps apart, with differences of up to 75 steps.
fn map() -> impl Strategy<Value = Map> {
    (
        proptest::collection::vec(0u32..=75, 9),
        0u32..200,
        -600i32..100,
    )
        .prop_map(|(entries, base, first)| {
            let positions = vec![first, first + 300, first + 600];
            let steps = entries.into_iter().map(|steps| base + steps).collect();
            BacklashMap::new([0, 1], [positions.clone(), positions], steps).unwrap()
        })
}

fn mill(config: Config<3>, maps: &[Map; 3]) -> Micromill {
    let backlash = maps
        .clone()
        .map(|map| MappedBacklash::new(map, Flank::Positive));
    Micromill::with_backlash(config, backlash)
}

/// Lines and arcs within a few hundred steps of 140 nm.
fn block() -> impl Strategy<Value = String> {
    let position = || (-500i32..500).prop_map(|steps| format!("{:.5}", f64::from(steps) * 0.00014));
    prop_oneof![
        (position(), position()).prop_map(|(x, y)| format!("G1 X{x} Y{y} F1.2")),
        (position(), position()).prop_map(|(x, y)| format!("G0 X{x} Y{y}")),
        position().prop_map(|x| format!("G1 X{x} F0.9")),
        position().prop_map(|y| format!("G0 Y{y}")),
        (1i32..200).prop_map(|radius| {
            let radius = f64::from(radius) * 0.00014;
            format!("G3 I{radius:.5} J0 F1.0")
        }),
    ]
}

/// Observer of the events.
struct Watch {
    screws: Screws,
    load: [i32; 3],
    ticks: u64,
    /// Time of the last step of every motor.
    stepped: [Option<u64>; 3],
    /// Largest deviation of a tool in steps: after an abort during take-up, until that axis moves.
    most_off: i32,
}

impl Watch {
    fn new(maps: &[Map; 3]) -> Self {
        Self {
            screws: Screws::new(maps),
            load: [0; 3],
            ticks: 0,
            stepped: [None; 3],
            most_off: 0,
        }
    }

    fn event(&mut self, machine: &Micromill, event: &Event<3>, least_ticks: u64) {
        let Event::Step(step) = event else { return };
        self.ticks += u64::from(step.wait_ticks);
        let load = machine.position_steps();
        self.screws.step(step.delta, load);
        for axis in 0..3 {
            let off = self.screws.tool[axis] - load[axis];
            if load == self.load {
                // The first of two steps that an event needs, or of a take-up.
                assert!(off.abs() <= self.most_off.max(1), "{off} at {load:?}");
            } else {
                assert!(off.abs() <= self.most_off, "{off} at {load:?}");
            }
            if step.delta[axis] != 0 {
                let before = self.stepped[axis].replace(self.ticks);
                let interval = before.map_or(u64::MAX, |before| self.ticks - before);
                assert!(interval >= least_ticks, "{interval} ticks");
            }
        }
        self.load = load;
    }

    fn drain(&mut self, machine: &mut Micromill, most: usize, least_ticks: u64) {
        for _ in 0..most {
            let Some(event) = machine.next_event() else {
                return;
            };
            self.event(machine, &event, least_ticks);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 2 } else { 200 }))]

    /// The tool is at the reported position after every step of every path, and no motor exceeds
    /// its highest rate.
    #[test]
    fn the_tool_is_where_it_was_sent(
        maps in [map(), map(), map()], blocks in proptest::collection::vec(block(), 1..8),
    ) {
        let mut machine = mill(config(), &maps);
        let mut watch = Watch::new(&maps);
        for block in blocks {
            machine.line(block.as_bytes()).unwrap();
            watch.drain(&mut machine, usize::MAX, 1_000_000 / 170);
        }
        prop_assert_eq!(watch.screws.tool, machine.position_steps());
    }

    /// The same with ramps, and with an abort at any event: during a take-up, or between the two
    /// steps of an event.
    #[test]
    fn an_abort_forgets_nothing(
        maps in [map(), map(), map()],
        blocks in proptest::collection::vec((block(), 0usize..900), 1..8),
    ) {
        let mut config = config();
        for axis in &mut config.axes {
            axis.max_rate_hz = 20_000;
            axis.ramp = Some(AxisRamp {
                acceleration_hz_per_s: 100_000,
                start_rate_hz: 0,
                jerk_hz_per_s2: None,
                junction_hz: None,
            });
        }
        let mut machine = mill(config, &maps);
        let mut watch = Watch::new(&maps);
        for (block, events) in blocks {
            machine.line(block.as_bytes()).unwrap();
            watch.drain(&mut machine, events, 49);
            machine.abort();
            watch.most_off = 75;
            watch.drain(&mut machine, 10, 49);
        }
        for line in ["G1 X-0.1 Y-0.1 F9", "G1 X0.01 Y0.01"] {
            machine.line(line.as_bytes()).unwrap();
            watch.drain(&mut machine, usize::MAX, 49);
        }
        // Every axis that moved is at its position again.
        let [x, y, _] = watch.screws.tool;
        prop_assert_eq!([x, y], [71, 71]);
    }
}

/// Along X the backlash of both axes grows by one step in ten. X makes two steps there, and Y makes
/// a step while it stands.
#[test]
fn backlash_that_grows_on_the_way() {
    let map = |steps: [u32; 2]| {
        let positions = [vec![-100, 0], vec![0]];
        BacklashMap::new([0, 1], positions, steps.to_vec()).unwrap()
    };
    let free = BacklashMap::new([0, 1], [vec![0], vec![0]], vec![0]).unwrap();
    let mut machine = mill(config(), &[map([12, 2]), map([13, 3]), free]);
    let mut made = [0_i32; 3];
    let mut take_ups = 0;
    let mut doubled = 0;
    machine.line(b"G0 X-0.00014 Y-0.00014").unwrap();
    machine.line(b"G1 X-0.014 F0.5").unwrap();
    while let Some(event) = machine.next_event() {
        let Event::Step(step) = event else { continue };
        let delta = step.delta.map(i32::from);
        made = [0, 1, 2].map(|axis| made[axis] + delta[axis]);
        take_ups += i32::from(machine.origin() == Origin::TakeUp);
        doubled += i32::from(step.wait_ticks < 16_800 && machine.origin() == Origin::Feed);
    }
    assert_eq!(take_ups, 5);
    assert_eq!(machine.position_steps(), [-100, -1, 0]);
    assert_eq!(made, [-112, -14, 0]);
    // Ten steps of X in two events of half the time each.
    assert_eq!(doubled, 20);
}

/// Backlash that jumps by more than a step is taken up while the path stands, as at a reversal.
#[test]
fn backlash_that_jumps() {
    struct Stair {
        is_negative: bool,
        held: i32,
    }
    impl husillo_backlash::BacklashModel<3> for Stair {
        const VARIES: bool = true;
        fn take_up(&mut self, _: usize, direction: i8, _: &[i32; 3]) -> u32 {
            let turned = self.is_negative != (direction < 0);
            self.is_negative = direction < 0;
            if turned { self.held.unsigned_abs() } else { 0 }
        }
        fn follow(&mut self, load: &[i32; 3]) -> i32 {
            let backlash = if load[0] <= -5 { 7 } else { 4 };
            match self.is_negative {
                true => std::mem::replace(&mut self.held, backlash) - backlash,
                false => 0,
            }
        }
    }
    let backlash = [(); 3].map(|()| Stair {
        is_negative: false,
        held: 4,
    });
    let mut machine: Machine<3, Path<3>, Stair> = Machine::with_backlash(config(), backlash);
    machine.line(b"G0 X-0.0014").unwrap();
    let mut trace = String::new();
    while let Some(Event::Step(step)) = machine.next_event() {
        assert_eq!(step.delta[0], -1);
        trace.push(if machine.origin() == Origin::TakeUp {
            't'
        } else {
            'x'
        });
    }
    assert_eq!(trace, "ttttxxxxtttxxxxxx");
}
