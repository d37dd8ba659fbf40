//! Half a turn of the field forward and back on a PBL3717A, as a table of its input levels.

use husillo_stepper::{CoilDriver, Driver, Mode, Sequencer, Unsupported};

fn main() -> Result<(), Unsupported> {
    let mut motor = Sequencer::new(Driver::Pbl3717a, Mode::Half)?;
    println!("{}   A     B", motor.driver().pins().join(" "));
    for delta in [0, 1, 1, 1, 1, -1, -1, -1, -1] {
        let levels = motor.step(delta);
        for bit in 0..6 {
            print!(" {}  ", u8::from(levels.is_high(bit)));
        }
        let [a, b] = motor.driver().currents(levels);
        println!("{a:5} {b:5}");
    }
    Ok(())
}
