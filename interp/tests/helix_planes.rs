//! A helix is the same in any plane and with any number of turns.

use husillo_interp::{ArcMove, Direction, Helix, Interpolator, Rim, Step};
use proptest::prelude::*;

fn circle(radius: i32, turns: u32, direction: Direction) -> ArcMove {
    ArcMove {
        from: [radius, 0],
        to: [radius, 0],
        centre: [0, 0],
        fraction_bits: 0,
        direction,
        turns,
        rim: Rim::Spiral,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The events in any two of four axes are those in the first two, with the axes renamed.
    #[test]
    fn any_plane_makes_the_same_helix(
        [first, second] in [0_usize..4, 0_usize..4],
        radius in 2_i32..120,
        turns in 0_u32..4,
        along in [-900_i32..900, -900_i32..900],
        is_clockwise in any::<bool>(),
    ) {
        prop_assume!(first != second);
        let others: Vec<usize> = (0..4).filter(|axis| *axis != first && *axis != second).collect();
        let direction = if is_clockwise {
            Direction::Clockwise
        } else {
            Direction::CounterClockwise
        };
        let arc = circle(radius, turns, direction);
        let plain = Helix::<4>::new(&arc, [0, 1], [0, 0, along[0], along[1]]).unwrap();
        let mut renamed = [0; 4];
        renamed[others[0]] = along[0];
        renamed[others[1]] = along[1];
        let helix = Helix::<4>::new(&arc, [first, second], renamed).unwrap();
        prop_assert_eq!(plain.total_sweep(), helix.total_sweep());
        prop_assert_eq!(plain.largest_sweep(), helix.largest_sweep());
        let name = |step: Step| {
            let axes = [first, second, others[0], others[1]];
            (axes.map(|axis| step.delta(axis)), step.sweep)
        };
        let plain: Vec<([i8; 4], u32)> = plain.map(|step| (step.deltas(), step.sweep)).collect();
        let helix: Vec<([i8; 4], u32)> = helix.map(name).collect();
        prop_assert_eq!(plain, helix);
    }

    /// Several turns rise evenly: each turn of a full circle has the same length and rises by its
    /// share, within a step.
    #[test]
    fn each_turn_rises_its_share(radius in 3_i32..200, turns in 1_u32..6, rise in -2000_i32..2000) {
        let arc = circle(radius, turns, Direction::CounterClockwise);
        let helix = Helix::<3>::new(&arc, [0, 1], [0, 0, rise]).unwrap();
        let total = helix.total_sweep() as f64;
        let (mut swept, mut height) = (0.0, 0_i32);
        for step in helix {
            swept += f64::from(step.sweep);
            height += i32::from(step.delta(2));
            let share = f64::from(rise) * swept / total;
            prop_assert!((f64::from(height) - share).abs() <= 1.001, "{height} {share}");
        }
        prop_assert_eq!(height, rise);
    }
}
