//! Backlash that varies over the work area, taken up and followed on a simulated screw.

use husillo_backlash::{BacklashMap, Compensator, Flank, MapError, MappedBacklash};

// ANCHOR: map
/// The backlash of X, measured at three positions of Y. It does not depend on X.
const Y_STEPS: [i32; 3] = [0, 200, 400];
const X_BACKLASH: [u32; 3] = [10, 30, 14];

type Axis = MappedBacklash<&'static [i32], &'static [u32]>;

fn axes() -> Result<[Axis; 2], MapError> {
    let x = BacklashMap::new([0, 1], [&[0][..], &Y_STEPS], &X_BACKLASH[..])?;
    let y = BacklashMap::new([0, 1], [&[0][..], &[0]], &[0][..])?; // none
    Ok([x, y].map(|map| MappedBacklash::new(map, Flank::Positive)))
}
// ANCHOR_END: map

/// The nut of X: the motor pushes it by one flank of the thread or the other.
struct Screw {
    motor: i32,
    nut: i32,
}

impl Screw {
    fn turn(&mut self, steps: i32, y: i32) {
        self.motor += steps;
        self.nut = self.nut.clamp(self.motor, self.motor + backlash_at(y));
    }
}

/// The true backlash: straight lines between the measured positions, to the nearest step.
fn backlash_at(y: i32) -> i32 {
    let share = |from: f64, to: f64, part: f64| (from + (to - from) * part + 0.5).floor() as i32;
    match f64::from(y) {
        y if y < 200.0 => share(10.0, 30.0, y / 200.0),
        y => share(30.0, 14.0, (y - 200.0) / 200.0),
    }
}

fn main() -> Result<(), MapError> {
    let mut screw = Screw { motor: 0, nut: 0 };
    let mut load = [0, 0];
    // ANCHOR: drive
    let mut stage = Compensator::new(axes()?);
    // Right, left: a take-up. Up, on the same flank: corrections. Right: another take-up.
    for (delta, events) in [([1, 0], 50), ([-1, 0], 20), ([0, 1], 300), ([1, 0], 20)] {
        let (mut taken_up, mut corrected) = (0, 0);
        for _ in 0..events {
            let [owed, _] = stage.before(&delta, load);
            let sign = i32::from(delta[0]);
            (0..owed).for_each(|_| screw.turn(sign, load[1]));
            taken_up += owed;
            // The event itself, together with the correction that is due at its end.
            load = [load[0] + sign, load[1] + i32::from(delta[1])];
            let [correction, _] = stage.follow(&load).unwrap_or_default();
            screw.turn(sign + correction, load[1]);
            corrected += correction;
            assert_eq!(screw.nut, load[0]); // at every event
        }
        println!(
            "{events:3} events of {delta:?}: take-up {taken_up}, corrections {corrected:3}, \
             motor at {}, nut at {}",
            screw.motor, screw.nut,
        );
    }
    // ANCHOR_END: drive
    assert_eq!((screw.motor, screw.nut), (50, 50));
    Ok(())
}
