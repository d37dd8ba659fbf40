//! A square of four steps with backlash: the motor's steps, take-up in capitals.

use husillo_backlash::{Backlash, Compensator, Flank};

fn main() {
    let mut stage =
        Compensator::new([2, 3].map(|backlash| Backlash::new(backlash, Flank::Positive)));
    let mut load = [0, 0];
    for side in [[1, 0], [0, 1], [-1, 0], [0, -1]] {
        for _ in 0..4 {
            let owed = stage.before(&side, load);
            for (name, owed) in ["X", "Y"].into_iter().zip(owed) {
                print!("{}", name.repeat(owed as usize));
            }
            print!("{}", if side[0] == 0 { "y" } else { "x" });
            load = [load[0] + i32::from(side[0]), load[1] + i32::from(side[1])];
        }
    }
    println!();
}
