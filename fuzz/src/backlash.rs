//! Any walk with any backlash, as one value or as a map.

use husillo_backlash::{Backlash, BacklashMap, Compensator, Flank, MappedBacklash};

use crate::bytes::Bytes;

/// A nut with backlash, pushed by the compensated motor, reaches every commanded point. The load
/// position of a motor target is the target.
pub fn backlash(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    check_targets(&mut bytes);
    check_map(&mut bytes);
    let flank = if bytes.byte() & 1 == 0 {
        Flank::Positive
    } else {
        Flank::Negative
    };
    let play = [0; 2].map(|_| i64::from(bytes.byte()));
    let mut stage = Compensator::new(play.map(|play| Backlash::new(play as u32, flank)));
    // The motor pushes the nut with the engaged flank: `nut` may be from `motor` to `motor + play`.
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
    let backlash = bytes.i32().unsigned_abs();
    let mut axis = Backlash::new(backlash, Flank::Unknown);
    for _ in 0..4 {
        let load = bytes.i32();
        let motor = axis.motor_target(load);
        assert_eq!(axis.load_position(motor), load);
    }
}

/// A nut with the backlash of a map reaches every commanded point, also while other axes move.
/// Invalid maps are refused.
fn check_map(bytes: &mut Bytes<'_>) {
    let shape = bytes.byte();
    let positions = [shape & 3, shape >> 2 & 3].map(|count| {
        let mut at = -i32::from(bytes.byte());
        let mut next = || {
            at = at.saturating_add(bytes.i32() >> (shape >> 4));
            at
        };
        (0..count).map(|_| next()).collect::<Vec<_>>()
    });
    let entries = positions[0].len() * positions[1].len();
    let steps: Vec<u32> = (0..entries).map(|_| bytes.byte().into()).collect();
    let Ok(map) = BacklashMap::new([0, 1], positions, steps) else {
        return;
    };
    let play = |load: [i32; 2]| map.steps(load) as i32;
    let mut stage =
        Compensator::new([(); 2].map(|()| MappedBacklash::new(map.clone(), Flank::Positive)));
    let (mut motor, mut nut, mut load) = ([0_i32; 2], [0_i32; 2], [0_i32; 2]);
    for _ in 0..64 {
        let chosen = bytes.byte();
        let delta = [chosen, chosen >> 2].map(|bits| (bits & 3) as i8 % 3 - 1);
        for _ in 0..(chosen >> 4) * 16 + 1 {
            let owed = stage.before(&delta, load);
            let to = [0, 1].map(|axis| load[axis] + i32::from(delta[axis]));
            let follows = stage.follow(&to).unwrap_or_default();
            for axis in 0..2 {
                motor[axis] += i32::from(delta[axis]) * owed[axis] as i32;
                let taken_up = nut[axis].clamp(motor[axis], motor[axis] + play(load));
                assert_eq!(taken_up, nut[axis], "take-up moves no nut");
                assert!(follows[axis].abs() <= 1, "an event owes a step at most");
                motor[axis] += i32::from(delta[axis]) + follows[axis];
                nut[axis] = nut[axis].clamp(motor[axis], motor[axis] + play(to));
                assert_eq!(nut[axis], to[axis], "the nut is where it was sent");
            }
            load = to;
        }
    }
}
