//! Overrides of feeds and of rapids.

use husillo_planner::JerkWindow;

use crate::{
    checker::Checker,
    moves::{Move, line, machine},
};

/// A move of 60 mm at 80 mm/s, which is a rapid or a feed.
fn long(is_rapid: bool) -> Move {
    let mut one = line(60_000_000, 80_000_000, 0);
    one.stretch.obeys_override = !is_rapid;
    one
}

/// Runs a move, with a change after so many slices. Returns the seconds of it.
fn seconds(one: &Move, at: usize, change: impl Fn(&mut JerkWindow<(), 4>)) -> f64 {
    const HZ: u32 = 1_000_000_000;
    let limits = machine(1, 50);
    let mut window = JerkWindow::<(), 4>::new(&limits).unwrap();
    window.push(one.stretch, ()).unwrap();
    window.finish();
    let mut checker = Checker::new(
        limits,
        std::slice::from_ref(one),
        100,
        window.units_per_nm(),
    );
    for number in 0.. {
        if number == at {
            change(&mut window);
        }
        let Some(slice) = window.next_slice() else {
            break;
        };
        let ticks = window.slice_ticks_q32(HZ) as f64 / 2_f64.powi(32);
        checker.set_slice(ticks / f64::from(HZ));
        checker.pass(&slice);
    }
    assert!(
        checker.is_done() && !checker.seen.fault(),
        "{:?}",
        checker.seen
    );
    checker.seen.seconds
}

/// At a quarter of the speed the path takes about four times as long, whether the override comes
/// before the move or within it; it acts within a slice, and keeps acceleration and jerk.
#[test]
fn a_rapid_override_slows_rapids() {
    let rapid = long(true);
    let quarter = |window: &mut JerkWindow<(), 4>| window.set_rapid_override(25);
    let whole = seconds(&rapid, 0, |_| ());
    // 60 mm at 80 mm/s, the ramps and the window.
    assert!((0.87..0.89).contains(&whole), "{whole}");
    let slow = seconds(&rapid, 0, quarter);
    assert!((3.06..3.08).contains(&slow), "{slow}");
    // After 0.4 s 26.8 mm are made. The speed falls in 0.11 s and 5.5 mm; 27.7 mm are left.
    let late = seconds(&rapid, 128, quarter);
    assert!((1.90..1.96).contains(&late), "{late}");
}

/// And the override of the feed slows feeds only.
#[test]
fn each_override_has_its_moves() {
    let same = |is_rapid, change: fn(&mut JerkWindow<(), 4>)| {
        let one = long(is_rapid);
        assert_eq!(seconds(&one, 40, change), seconds(&one, 40, |_| ()));
    };
    same(false, |window| window.set_rapid_override(25));
    same(true, |window| window.set_override(25));
    let feed = seconds(&long(false), 0, |window| window.set_override(25));
    assert!((3.06..3.08).contains(&feed), "{feed}");
}

/// A rapid override ends as it began: the path speeds up again.
#[test]
fn a_rapid_override_ends() {
    let seconds = seconds(&long(true), 100, |window| {
        window.set_rapid_override(1);
        window.set_rapid_override(100);
    });
    assert!((0.87..0.89).contains(&seconds), "{seconds}");
}
