//! The simulated machine: from coil levels to the tool position. One element is one event.

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use husillo_machine::Event;
use husillo_sim::{AxisModel, Rig};
use husillo_stepper::{CoilDriver, Driver, Levels, Mode, Sequencer};

use crate::machine::{micromill, run};

pub fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sim");
    let (driver, mode) = (Driver::Pbl3717a, Mode::Full);
    let mut motors = [Sequencer::new(driver, mode).expect("the PBL3717A makes full steps"); 3];
    let home = motors.map(|motor| motor.levels());
    // The levels are computed beforehand, so that only the simulator is measured.
    let mut trace: Vec<([Levels; 3], u32)> = Vec::new();
    run(&mut micromill(), &["G3 X0 Y0 I-1.5 F1.4"], |event| {
        if let Event::Step(step) = event {
            let mut levels = home;
            for ((motor, levels), delta) in motors.iter_mut().zip(&mut levels).zip(step.delta) {
                *levels = motor.step(delta);
            }
            trace.push((levels, step.wait_ticks));
        }
    });
    let model = AxisModel::coils(driver, mode);
    group.throughput(Throughput::Elements(trace.len() as u64));
    group.bench_function("circle", |bencher| {
        bencher.iter(|| {
            let mut rig = Rig::new(
                [model.with_backlash(1457), model.with_backlash(1271), model],
                home,
            );
            for (levels, wait_ticks) in &trace {
                rig.apply(levels, *wait_ticks);
                black_box(rig.tool());
            }
        });
    });
    group.finish();
}
