//! What holds for every map of backlash and every walk over it.

use husillo_backlash::{BacklashMap, BacklashModel, Compensator, Flank, MapError, MappedBacklash};
use proptest::prelude::*;

type Map = BacklashMap<Vec<i32>, Vec<u32>>;

/// Rising positions, far enough apart for the largest change of backlash below.
fn positions() -> impl Strategy<Value = Vec<i32>> {
    (
        -200i32..200,
        proptest::collection::vec(MOST as i32 * 4..200, 0..4),
    )
        .prop_map(|(first, ways)| {
            let mut at = first;
            let rest = ways.into_iter().map(|way| {
                at += way;
                at
            });
            std::iter::once(first).chain(rest).collect()
        })
}

/// Largest backlash of these maps.
const MOST: u32 = 20;

fn map() -> impl Strategy<Value = Map> {
    (positions(), positions()).prop_flat_map(|(x, y)| {
        let entries = x.len() * y.len();
        proptest::collection::vec(0..MOST, entries)
            .prop_map(move |steps| BacklashMap::new([0, 1], [x.clone(), y.clone()], steps).unwrap())
    })
}

/// Straight pieces of some length, so that walks get across the map.
fn walk() -> impl Strategy<Value = Vec<[i8; 2]>> {
    proptest::collection::vec(([-1i8..=1, -1i8..=1], 1usize..120), 0..20).prop_map(|pieces| {
        pieces
            .into_iter()
            .flat_map(|(delta, length)| std::iter::repeat_n(delta, length))
            .collect()
    })
}

/// Bilinear interpolation in exact fractions, written down from its definition.
fn interpolated(x: &[i32], y: &[i32], steps: &[u32], at: [i32; 2]) -> i128 {
    let share = |positions: &[i32], at: i32| -> Vec<[i128; 2]> {
        // Weight of every position as numerator and denominator.
        let at = at.clamp(positions[0], positions[positions.len() - 1]);
        let hat = |index: usize| -> [i128; 2] {
            let here = positions[index];
            match at.cmp(&here) {
                std::cmp::Ordering::Equal => [1, 1],
                std::cmp::Ordering::Less if index > 0 && at > positions[index - 1] => {
                    let below = positions[index - 1];
                    [i128::from(at - below), i128::from(here - below)]
                }
                std::cmp::Ordering::Greater
                    if index + 1 < positions.len() && at < positions[index + 1] =>
                {
                    let above = positions[index + 1];
                    [i128::from(above - at), i128::from(above - here)]
                }
                _ => [0, 1],
            }
        };
        (0..positions.len()).map(hat).collect()
    };
    let (across, up) = (share(x, at[0]), share(y, at[1]));
    let (mut sum, mut whole) = (0, 1);
    for (row, [up_num, up_den]) in up.iter().enumerate() {
        for (column, [num, den]) in across.iter().enumerate() {
            let weight = [num * up_num, den * up_den];
            let term = i128::from(steps[row * x.len() + column]) * weight[0];
            if term != 0 {
                sum = sum * weight[1] + term * whole;
                whole *= weight[1];
            }
        }
    }
    // Nearest, halves up.
    (2 * sum + whole).div_euclid(2 * whole)
}

proptest! {
    /// Between its positions the map is the bilinear interpolation, rounded once; outside that of
    /// the nearest edge.
    #[test]
    fn the_map_interpolates(
        x in positions(), y in positions(), seed in proptest::collection::vec(0..MOST, 16), at in [
            -400i32..1000,
            -400i32..1000,
        ],
    ) {
        let steps: Vec<u32> = seed.into_iter().cycle().take(x.len() * y.len()).collect();
        let map = BacklashMap::new([0, 1], [x.clone(), y.clone()], steps.clone()).unwrap();
        prop_assert_eq!(i128::from(map.steps(at)), interpolated(&x, &y, &steps, at));
    }

    /// A nut with that much play at every position stands on the commanded point after every event,
    /// whatever moved, and no event owes more than a step.
    #[test]
    fn the_nut_is_where_it_was_sent(maps in [map(), map()], walk in walk()) {
        let axes = maps.clone().map(|map| MappedBacklash::new(map, Flank::Positive));
        let mut stage = Compensator::new(axes);
        let (mut motor, mut nut, mut load) = ([0i32; 2], [0i32; 2], [0i32; 2]);
        for delta in walk {
            let owed = stage.before(&delta, load);
            for axis in 0..2 {
                motor[axis] += i32::from(delta[axis]) * owed[axis] as i32;
                let before = nut[axis];
                nut[axis] = nut[axis].clamp(
                    motor[axis],
                    motor[axis] + maps[axis].steps(load) as i32,
                );
                prop_assert_eq!(nut[axis], before, "take-up moves no nut");
            }
            let to = [0, 1].map(|axis| load[axis] + i32::from(delta[axis]));
            let follows = stage.follow(&to).unwrap_or_default();
            for axis in 0..2 {
                prop_assert!(follows[axis].abs() <= 1);
                motor[axis] += follows[axis] + i32::from(delta[axis]);
                let play = maps[axis].steps(to) as i32;
                nut[axis] = nut[axis].clamp(motor[axis], motor[axis] + play);
                prop_assert_eq!(nut[axis], to[axis]);
                prop_assert_eq!(stage.backlash()[axis].load_position(motor[axis]), to[axis]);
                if stage.backlash()[axis].flank() == Flank::Negative {
                    prop_assert_eq!(
                        motor[axis],
                        to[axis] - play,
                        "the negative flank stays engaged",
                    );
                } else {
                    prop_assert_eq!(motor[axis], to[axis]);
                }
            }
            load = to;
        }
    }

    /// Where the map has one value it owes what one value owes.
    #[test]
    fn a_flat_map_is_a_value(backlash in [0u32..50, 0u32..50], walk in walk()) {
        let map = |backlash| BacklashMap::new([0, 1], [vec![0], vec![0]], vec![backlash]).unwrap();
        let mut mapped = Compensator::new(
            backlash.map(|backlash| MappedBacklash::new(map(backlash), Flank::Unknown))
        );
        let mut flat = Compensator::new(
            backlash.map(|backlash| husillo_backlash::Backlash::new(backlash, Flank::Unknown))
        );
        let mut load = [0; 2];
        for delta in walk {
            prop_assert_eq!(mapped.before(&delta, load), flat.before(&delta, load));
            load = [0, 1].map(|axis| load[axis] + i32::from(delta[axis]));
            prop_assert_eq!(mapped.follow(&load), None);
        }
        prop_assert_eq!(BacklashModel::<2>::is_free(&mapped.backlash()[0]), backlash[0] == 0);
    }
}

#[test]
fn maps_that_are_none() {
    let new = |x: &[i32], y: &[i32], steps: &[u32]| {
        BacklashMap::new([0, 1], [x.to_vec(), y.to_vec()], steps.to_vec()).err()
    };
    assert_eq!(new(&[], &[0], &[]), Some(MapError::Entries));
    assert_eq!(new(&[0, 9], &[0], &[1]), Some(MapError::Entries));
    let order = |axis, position| Some(MapError::Order { axis, position });
    assert_eq!(new(&[0, 0], &[0], &[1, 1]), order(0, 1));
    assert_eq!(new(&[0], &[0, 5, 4], &[1, 1, 1]), order(1, 2));
    assert_eq!(new(&[i32::MIN, i32::MAX], &[0], &[1, 1]), order(0, 1));
    assert_eq!(new(&[0], &[0], &[1 << 20]), Some(MapError::Range(0)));
    assert_eq!(new(&[0, 40], &[0], &[0, 10]), None);
    assert_eq!(new(&[0, 39], &[0], &[0, 10]), Some(MapError::Steep(1)));
    assert_eq!(
        new(&[0, 400], &[0, 39], &[0, 0, 0, 10]),
        Some(MapError::Steep(3))
    );
}

/// The largest map there may be does not overflow, at its corners and between them.
#[test]
fn the_widest_cell() {
    let way = 1 << 22;
    let most = (1 << 20) - 1;
    let map = BacklashMap::new([0, 1], [[0, way], [0, way]], [most, most, most, most - 4]).unwrap();
    assert_eq!(map.steps([0, 0]), most);
    assert_eq!(map.steps([way, way]), most - 4);
    assert_eq!(map.steps([way / 2, way / 2]), most - 1);
    assert_eq!(map.steps([i32::MAX, i32::MIN]), most);
}
