//! Any walk with any lash.

use husillo_backlash::{Backlash, Compensator, Flank};

use crate::bytes::Bytes;

/// A nut with play, pushed by the compensated motor, stands on every commanded point; and the load position of a motor
/// target is the target.
pub fn backlash(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    check_targets(&mut bytes);
    let flank = if bytes.byte() & 1 == 0 {
        Flank::Positive
    } else {
        Flank::Negative
    };
    let play = [0; 2].map(|_| i64::from(bytes.byte()));
    let mut stage = Compensator::new(play.map(|play| Backlash::new(play as u32, flank)));
    // The motor pushes the nut with the flank engaged: `nut` may lie from `motor` to `motor + play`.
    let mut motor = play.map(|play| if flank == Flank::Positive { 0 } else { -play });
    let (mut nut, mut load) = ([0_i64; 2], [0_i32; 2]);
    while !bytes.is_empty() {
        let chosen = bytes.byte();
        let delta = [chosen, chosen >> 2].map(|bits| (bits & 3) as i8 % 3 - 1);
        let owed = stage.before(&delta, load);
        for axis in 0..2 {
            let step = i64::from(delta[axis]);
            motor[axis] += step * i64::from(owed[axis]);
            let taken_up = nut[axis].clamp(motor[axis], motor[axis] + play[axis]);
            assert_eq!(taken_up, nut[axis], "take-up moves no nut");
            motor[axis] += step;
            nut[axis] = nut[axis].clamp(motor[axis], motor[axis] + play[axis]);
            load[axis] += i32::from(delta[axis]);
            assert_eq!(
                nut[axis],
                i64::from(load[axis]),
                "the nut is where it was sent"
            );
        }
    }
}

fn check_targets(bytes: &mut Bytes<'_>) {
    let lash = bytes.i32().unsigned_abs();
    let mut axis = Backlash::new(lash, Flank::Unknown);
    for _ in 0..4 {
        let load = bytes.i32();
        let motor = axis.motor_target(load);
        assert_eq!(axis.load_position(motor), load);
    }
}
