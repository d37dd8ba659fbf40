//! Heights stay within their bits, however many moves pass.

use husillo_planner::{LookAhead, Stretch};

const LONGEST: Stretch = Stretch {
    length_nm: 1 << 44,
    top_nm_per_s: u32::MAX,
    ceiling_nm_per_s: u32::MAX,
    obeys_override: false,
    acceleration_nm_per_s2: 1 << 40,
    start_nm_per_s: 0,
    upper: None,
    entry_limit_nm_per_s: u32::MAX,
};

/// The sum of 2 a L over the moves has more bits than a height. A last short move still has to
/// brake.
#[test]
fn the_longest_moves_do_not_wear_out_the_queue() {
    let mut moves = LookAhead::<u32, 4>::new();
    for number in 0..3 {
        moves.push(LONGEST, number).unwrap();
    }
    for number in 3..10_000 {
        // Behind the first move there is room to brake from any speed: the limit is the junction.
        let highest = u64::from(u32::MAX);
        assert_eq!(moves.limits().exit_squared, highest * highest, "{number}");
        moves.push(LONGEST, number).unwrap();
        assert_eq!(moves.pop().unwrap().1, number - 3);
    }
    let short = Stretch {
        length_nm: 1000,
        acceleration_nm_per_s2: 500,
        ..LONGEST
    };
    moves.push(short, 0).unwrap();
    for _ in 0..2 {
        moves.pop().unwrap();
    }
    assert_eq!(moves.limits().exit_squared, 2 * 500 * 1000);
}

/// The bytes that the README names.
#[test]
#[cfg(target_pointer_width = "64")]
fn the_queue_has_the_size_of_the_readme() {
    assert_eq!(size_of::<LookAhead<u32, 16>>(), 1440);
}
