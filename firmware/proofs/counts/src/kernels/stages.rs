//! Take-up of backlash and motor phases.

use core::hint::black_box;

use husillo_backlash::{Backlash, BacklashMap, Compensator, Flank, MappedBacklash};
use husillo_stepper::{CoilDriver, Driver, Mode, Sequencer};

use crate::Count;

const EVENTS: u32 = 1000;

#[inline(never)]
pub fn all(count: Count<'_>) {
    count("sequencer_step", EVENTS, &mut || {
        let Ok(mut motor) = black_box(Sequencer::new(Driver::A3988, Mode::Half)) else {
            return;
        };
        for _ in 0..EVENTS {
            black_box(motor.step(black_box(1)));
        }
    });
    let axis = Backlash::new(1457, Flank::Positive);
    count("compensator_straight_on", EVENTS, &mut || {
        let mut stage = black_box(Compensator::new([axis, axis, axis]));
        for _ in 0..EVENTS {
            black_box(stage.before(black_box(&[1, 1, 0]), black_box([10, 20, 30])));
        }
    });
    count("compensator_reversal", EVENTS, &mut || {
        let mut stage = black_box(Compensator::new([axis, axis, axis]));
        let mut delta = [1_i8, 1, 0];
        for _ in 0..EVENTS {
            delta[0] = -delta[0];
            black_box(stage.before(black_box(&delta), black_box([10, 20, 30])));
        }
    });
    // A map of the micro mill's area with four by three positions. X has reversed, so every event
    // is looked up in the map.
    let along_x: &[i32] = &[0, 23_810, 47_619, 71_429];
    let along_y: &[i32] = &[0, 25_000, 50_000];
    let backlash: &[u32] = &[
        1457, 1690, 1460, 1225, 1457, 1222, 1454, 1690, 1457, 1690, 1460, 1225,
    ];
    let Ok(map) = BacklashMap::new([0, 1], [along_x, along_y], backlash) else {
        return;
    };
    count("compensator_map", EVENTS, &mut || {
        let axis = MappedBacklash::new(map, Flank::Negative);
        let mut stage = black_box(Compensator::new([axis, axis, axis]));
        let mut load = [60_000, 20_000, 0];
        for _ in 0..EVENTS {
            for load in load.iter_mut().take(2) {
                *load -= 1;
            }
            black_box(stage.before(black_box(&[-1, -1, 0]), black_box(load)));
            black_box(stage.follow(black_box(&load)));
        }
    });
}
