//! The recorded backlash traces through real levels: sequencer, simulated motors, screw, tool.

use husillo_backlash::{Backlash, Compensator, Flank};
use husillo_sim::{AxisModel, Rig};
use husillo_stepper::{CoilDriver, Driver, Mode, Sequencer};
use serde_json::Value;

const PULL_OUT_TICKS: u32 = 2564;
const WAIT_TICKS: u32 = 5882;

fn decode(text: &str) -> Vec<[i8; 2]> {
    text.bytes()
        .map(|c| (c - b'0') as i8)
        .map(|code| [code / 3 - 1, code % 3 - 1])
        .collect()
}

fn pair(value: &Value) -> [i32; 2] {
    [0, 1].map(|axis| value[axis].as_i64().unwrap() as i32)
}

/// Two motors and the rig that they drive. The rig starts on the positive flank. Where a trace
/// starts on the negative flank, the axis is first moved there: by its backlash plus one step away;
/// positions are then measured from there.
struct Bench {
    motors: [Sequencer; 2],
    rig: Rig<2>,
    zero: [i32; 2],
}

impl Bench {
    fn new(driver: Driver, mode: Mode, backlash: [i32; 2], last: [i32; 2]) -> Bench {
        let motors = [Sequencer::new(driver, mode).unwrap(); 2];
        let model = |backlash: i32| {
            AxisModel::coils(driver, mode)
                .with_backlash(backlash as u32)
                .with_pull_out_ticks(PULL_OUT_TICKS)
        };
        let rig = Rig::new(backlash.map(model), motors.map(|motor| motor.levels()));
        let mut bench = Bench {
            motors,
            rig,
            zero: [0, 0],
        };
        for axis in 0..2 {
            if last[axis] < 0 {
                let mut delta = [0, 0];
                delta[axis] = -1;
                (0..=backlash[axis]).for_each(|_| bench.step(delta));
            }
        }
        bench.zero = bench.rig.tool();
        bench
    }

    fn step(&mut self, delta: [i8; 2]) {
        let levels = [self.motors[0].step(delta[0]), self.motors[1].step(delta[1])];
        self.rig.apply(&levels, WAIT_TICKS);
    }

    fn table(&self) -> [i32; 2] {
        let tool = self.rig.tool();
        [0, 1].map(|axis| tool[axis] - self.zero[axis])
    }
}

#[test]
fn the_tool_ends_where_the_traces_say() {
    let oracle: Value = serde_json::from_str(include_str!("data/backlash.json")).unwrap();
    let stages = [
        (Driver::Pbl3717a, Mode::Full),
        (Driver::Pbl3717a, Mode::Quarter),
        (Driver::Pbl3717a, Mode::QuarterLow),
        (Driver::A3988, Mode::Quarter),
        (Driver::L297, Mode::Half),
        (Driver::Unipolar, Mode::Full),
    ];
    for case in oracle["cases"].as_array().unwrap() {
        let name = case["name"].as_str().unwrap();
        let (backlash, last) = (pair(&case["B"]), pair(&case["last_dir"]));
        let logical = decode(case["logical"].as_str().unwrap());
        for (driver, mode) in stages {
            let mut bench = Bench::new(driver, mode, backlash, last);
            for &delta in &logical {
                bench.step(delta);
            }
            assert_eq!(
                bench.table(),
                pair(&case["table_end_without_compensation"]),
                "{name}, {driver:?} {mode:?}"
            );

            let mut bench = Bench::new(driver, mode, backlash, last);
            let flank = |axis: usize| Flank::towards(last[axis] as i8).unwrap_or_default();
            let mut stage = Compensator::new(
                [0, 1].map(|axis| Backlash::new(backlash[axis] as u32, flank(axis))),
            );
            let mut load = [0, 0];
            for &delta in &logical {
                for (axis, owed) in stage.before(&delta, load).into_iter().enumerate() {
                    let mut take_up = [0, 0];
                    take_up[axis] = delta[axis];
                    (0..owed).for_each(|_| bench.step(take_up));
                }
                assert_eq!(bench.table(), load, "{name}: the take-up moves no table");
                bench.step(delta);
                load = [0, 1].map(|axis| load[axis] + i32::from(delta[axis]));
                assert_eq!(bench.table(), load, "{name}, {driver:?} {mode:?}");
            }
            assert_eq!(bench.table(), pair(&case["table_end"]), "{name}");
            assert_eq!(bench.rig.lost_steps(), [0, 0], "{name}");
        }
    }
}
