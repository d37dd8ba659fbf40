//! Drives a screw with three steps of backlash forward and back, and prints the dead band of every
//! reversal.

use husillo_sim::{AxisModel, Rig};
use husillo_stepper::{CoilDriver, Driver, Mode, Sequencer, Unsupported};

fn main() -> Result<(), Unsupported> {
    let mut motor = Sequencer::new(Driver::Pbl3717a, Mode::Full)?;
    let model = AxisModel::coils(Driver::Pbl3717a, Mode::Full)
        .with_backlash(3)
        .with_pull_out_ticks(2564);
    let mut rig = Rig::new([model], [motor.levels()]);
    println!("motor tool");
    for delta in [1, 1, 1, 1, 1, -1, -1, -1, -1, -1] {
        rig.apply(&[motor.step(delta)], 5882);
        println!("{:5} {:4}", rig.motor()[0], rig.tool()[0]);
    }
    println!("lost: {}", rig.lost_steps()[0]);
    Ok(())
}
