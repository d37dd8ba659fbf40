//! What holds for every table of errors, and for every lean of the axes.

use husillo_backlash::{Calibration, ErrorTable, Flank, Knot, Squareness, TableError};
use proptest::prelude::*;

fn flank() -> impl Strategy<Value = Flank> {
    prop_oneof![
        Just(Flank::Unknown),
        Just(Flank::Positive),
        Just(Flank::Negative)
    ]
}

/// Any table that is one: ways from 1 nm to a metre, corrections as steep as they may be.
fn table() -> impl Strategy<Value = ErrorTable<Vec<Knot>>> {
    let way = prop_oneof![1i64..100, 1i64..1_000_000, 1i64..1_000_000_000];
    let knots = proptest::collection::vec((way, -1.0f64..=1.0, -1.0f64..=1.0), 0..12);
    let scale = prop_oneof![-10_000_000i32..=10_000_000, -100_000i32..100_000];
    (scale, -500_000_000i64..500_000_000, knots).prop_map(|(scale, start, steps)| {
        let mut knot = Knot {
            reading_nm: start,
            ..Knot::default()
        };
        let knots: Vec<Knot> = steps
            .into_iter()
            .map(|(way, positive, negative)| {
                knot.reading_nm += way;
                let change = |nm: i32, part: f64| {
                    let most = (way / 16) as f64;
                    (nm + (part * most) as i32).clamp(-(1 << 21), 1 << 21)
                };
                knot.positive_nm = change(knot.positive_nm, positive);
                knot.negative_nm = change(knot.negative_nm, negative);
                knot
            })
            .collect();
        ErrorTable::new(scale, knots).unwrap()
    })
}

/// Places on the table, at its ends, and far from it.
fn place() -> impl Strategy<Value = i64> {
    prop_oneof![
        -1_000i64..1_000,
        -2_000_000_000i64..2_000_000_000,
        -(1i64 << 36)..1 << 36
    ]
}

fn squareness() -> impl Strategy<Value = Squareness> {
    let lean = || prop_oneof![-10_000_000i32..=10_000_000, -200_000i32..200_000];
    (lean(), lean(), lean()).prop_map(|(xy_ppb, xz_ppb, yz_ppb)| Squareness {
        xy_ppb,
        xz_ppb,
        yz_ppb,
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// From a reading to its position and back is within 1 nm, and that position comes back
    /// exactly.
    #[test]
    fn a_reading_comes_back(table in table(), reading in place(), flank in flank()) {
        let position = table.position_nm(reading, flank);
        let back = table.reading_nm(position, flank);
        prop_assert!(back.abs_diff(reading) <= 1, "{reading} came back as {back}");
        prop_assert_eq!(table.position_nm(back, flank), position);
    }

    /// A target is reached within 1 nm.
    #[test]
    fn a_target_is_reached(table in table(), target in place(), flank in flank()) {
        let reached = table.position_nm(table.reading_nm(target, flank), flank);
        prop_assert!(reached.abs_diff(target) <= 1, "{reached} instead of {target}");
    }

    /// Near its knots, where the slope changes, it is the same.
    #[test]
    fn knots_come_back(table in table(), flank in flank(), beside in -3i64..=3) {
        for knot in table.knots() {
            let reading = knot.reading_nm + beside;
            let position = table.position_nm(reading, flank);
            let back = table.reading_nm(position, flank);
            prop_assert!(back.abs_diff(reading) <= 1);
            prop_assert_eq!(table.position_nm(back, flank), position);
        }
    }

    /// Farther by reading is never nearer in truth.
    #[test]
    fn positions_rise_with_readings(
        table in table(),
        reading in place(),
        way in 1i64..100,
        flank in flank(),
    ) {
        prop_assert!(table.position_nm(reading + way, flank) >= table.position_nm(reading, flank));
    }

    /// At a knot the correction is the knot's and the scale's, and between two it lies on the line
    /// between them, within half a nanometre and the two roundings of a sixteenth before it.
    #[test]
    fn the_correction_is_the_line(table in table(), part in 0.0f64..=1.0) {
        for pair in table.knots().windows(2) {
            let [low, high] = pair else { unreachable!() };
            let way = high.reading_nm - low.reading_nm;
            let done = (way as f64 * part) as i64;
            let reading = low.reading_nm + done;
            let scale = reading as f64 * f64::from(table.scale_ppb()) * 1e-9;
            for (flank, ends) in [
                (Flank::Positive, [low.positive_nm, high.positive_nm]),
                (Flank::Negative, [low.negative_nm, high.negative_nm]),
            ] {
                let [from, to] = ends.map(f64::from);
                let exact = scale + from + (to - from) * done as f64 / way as f64;
                let given = table.correction_nm(reading, flank) as f64;
                prop_assert!(
                    (given - exact).abs() <= 0.5 + 2.0 / 16.0 + 1e-4,
                    "{given} for {exact}",
                );
            }
        }
    }

    /// Any numbers, the ends of their types too, give a table or an error, and a table a position.
    #[test]
    fn nothing_is_too_much(
        scale in any::<i32>(), knots in proptest::collection::vec(any::<(i64, i32, i32)>(), 0..6),
        at in any::<i64>(),
        flank in flank(),
        leans in any::<[i32; 3]>(),
        place in any::<[i64; 3]>(),
    ) {
        let knots: Vec<Knot> = knots
            .into_iter()
            .map(
                |(reading_nm, positive_nm, negative_nm)| Knot {
                    reading_nm,
                    positive_nm,
                    negative_nm,
                }
            )
            .collect();
        if let Ok(table) = ErrorTable::new(scale, knots) {
            let _ = table.position_nm(at, flank);
            let _ = table.reading_nm(at, flank);
        }
        let [xy_ppb, xz_ppb, yz_ppb] = leans;
        let frame = Squareness { xy_ppb, xz_ppb, yz_ppb };
        prop_assert_eq!(frame.reading_nm(frame.position_nm(place)), place);
        prop_assert_eq!(frame.position_nm(frame.reading_nm(place)), place);
    }

    /// Three axes together keep to 1 nm in every coordinate, both ways.
    #[test]
    fn three_axes_come_back(
        axes in [
            table(),
            table(),
            table(),
        ], squareness in squareness(), flanks in [flank(), flank(), flank()],
        place in [place(), place(), place()],
    ) {
        let machine = Calibration { axes, squareness };
        let near = |a: [i64; 3], b: [i64; 3]| a.into_iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 1);
        let back = machine.reading_nm(machine.position_nm(place, flanks), flanks);
        prop_assert!(near(back, place), "{place:?} came back as {back:?}");
        let reached = machine.position_nm(machine.reading_nm(place, flanks), flanks);
        prop_assert!(near(reached, place), "{reached:?} instead of {place:?}");
    }
}

/// What is refused is refused for its reason.
#[test]
fn tables_that_are_none() {
    let knot = |reading_nm, positive_nm| Knot {
        reading_nm,
        positive_nm,
        negative_nm: 0,
    };
    let refused = |scale, knots: &[Knot]| ErrorTable::new(scale, knots.to_vec()).err();
    assert_eq!(refused(10_000_001, &[]), Some(TableError::Scale));
    assert_eq!(refused(0, &[knot(0, 1 << 22)]), Some(TableError::Range(0)));
    assert_eq!(
        refused(0, &[knot(0, 0), knot(1 << 36, 0)]),
        Some(TableError::Range(1))
    );
    assert_eq!(
        refused(0, &[knot(5, 0), knot(5, 0)]),
        Some(TableError::Order(1))
    );
    assert_eq!(
        refused(0, &[knot(0, 0), knot(31, 2)]),
        Some(TableError::Steep(1))
    );
    assert_eq!(refused(0, &[knot(0, 0), knot(32, 2)]), None);
}

/// Beyond its ends a table corrects as at them, and the scale goes on.
#[test]
fn beyond_the_ends() {
    let knot = |reading_nm, correction| Knot {
        reading_nm,
        positive_nm: correction,
        negative_nm: correction,
    };
    let table = ErrorTable::new(1_000_000, [knot(0, 100), knot(1_000_000, 300)]).unwrap();
    assert_eq!(table.correction_nm(-1_000_000, Flank::Positive), 100 - 1000);
    assert_eq!(table.correction_nm(2_000_000, Flank::Negative), 300 + 2000);
}
