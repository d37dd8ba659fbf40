//! Arcs use the whole acceleration of the axes, and no more.

use core::f64::consts::{FRAC_PI_2, TAU};

use proptest::prelude::*;

use crate::router::{Act, acceleration_in_plane, accelerations, config, fine, trace};

/// Limits of the axes in mm/s^2 and their steps in nm: equal axes, and unequal ones.
const AXES: [([u32; 3], [u32; 3]); 2] = [([500; 3], [100; 3]), ([700, 400, 300], [100, 125, 100])];

/// Window of the second differences, and the error of the positions that is taken from them: 1.1 %
/// of 500 mm/s^2. The bound is that of `Ramp` for a piece, 1.036.
const WINDOW_S: f64 = 0.008;
const ERROR_NM: f64 = 125.0;
const BOUND: f64 = 1.036;

/// The largest acceleration of each axis as a part of its limit. On equal axes every direction in
/// the plane of the arcs has the same limit, so the largest of them is counted for its axes.
fn shares(axes: usize, program: &str, acts: &[(usize, Act)]) -> [f64; 3] {
    let (limits, scales) = AXES[axes];
    let trace = trace(fine(limits, scales), program, acts);
    let mut found = accelerations(&trace, WINDOW_S, ERROR_NM);
    if axes == 0 {
        let plane = match &program[..3] {
            "G18" => [2, 0],
            "G19" => [1, 2],
            _ => [0, 1],
        };
        for axis in plane {
            found[axis] = acceleration_in_plane(&trace, plane, WINDOW_S, ERROR_NM);
        }
    }
    [0, 1, 2].map(|axis: usize| found[axis] / f64::from(limits[axis]))
}

/// Whole circles and helices reach 0.93 of the limit in at least one axis.
#[test]
fn whole_circles_use_the_acceleration() {
    for program in ["G3 I3 F6000", "G3 I3 Z2 P2 F6000", "G18 G2 I3 F6000"] {
        for axes in 0..AXES.len() {
            let shares = shares(axes, program, &[]);
            assert!(
                shares.iter().all(|share| *share < BOUND)
                    && shares.iter().any(|share| *share > 0.93),
                "{program}: {shares:?}"
            );
        }
    }
}

#[derive(Clone, Debug)]
struct Program {
    text: String,
    acts: Vec<(usize, Act)>,
}

/// Up to four arcs that continue each other, circles and helices in both directions. The operator
/// holds and changes the override in the middle.
fn programs() -> impl Strategy<Value = Program> {
    let arc = (
        0.3_f64..5.0,
        0.2_f64..6.2,
        -2.0_f64..2.0,
        any::<bool>(),
        any::<bool>(),
    );
    let act = (any::<prop::sample::Index>(), 0_u8..=200);
    (
        prop::collection::vec(arc, 1..5),
        1_000_u32..12_000,
        17_u8..=19,
        prop::collection::vec(act, 0..5),
    )
        .prop_map(|(arcs, feed, plane, acts)| {
            let mut text = format!("G{plane} G1 F{feed}\n");
            let names = match plane {
                17 => ["X", "Y", "Z", "I", "J"],
                18 => ["Z", "X", "Y", "K", "I"],
                _ => ["Y", "Z", "X", "J", "K"],
            };
            // The direction at the start of an arc is that at the end of the last one.
            let ([mut x, mut y, mut z], mut heading) = ([0.0_f64; 3], 0.0_f64);
            for (radius, turned, rise, is_left, is_helix) in arcs {
                let side = if is_left { 1.0 } else { -1.0 };
                let [i, j] = [
                    -side * radius * heading.sin(),
                    side * radius * heading.cos(),
                ];
                let to = heading + side * turned;
                let [ends_x, ends_y] = [
                    x + i + side * radius * to.sin(),
                    y + j - side * radius * to.cos(),
                ];
                let [first, second, third, of_first, of_second] = names;
                z += if is_helix { rise } else { 0.0 };
                text += &format!(
                    "G{} {first}{ends_x:.6} {second}{ends_y:.6} {third}{z:.6} {of_first}{i:.6} \
                     {of_second}{j:.6}\n",
                    if is_left { 3 } else { 2 }
                );
                [x, y, heading] = [ends_x, ends_y, to];
            }
            // About the number of events; an act after the end does nothing.
            let acts = acts.into_iter().map(|(at, percent)| {
                let act = match percent {
                    0..60 => Act::Hold,
                    _ => Act::Override(percent),
                };
                (1 + at.index(200_000), act)
            });
            Program {
                text,
                acts: acts.collect(),
            }
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// No axis exceeds its acceleration, whatever the radius, feed, hold and override.
    #[test]
    fn no_axis_exceeds_its_acceleration(program in programs(), axes in 0..AXES.len()) {
        let shares = shares(axes, &program.text, &program.acts);
        prop_assert!(shares.iter().all(|share| *share < BOUND), "{:?}", shares);
    }
}

fn seconds(program: &str) -> f64 {
    let (seconds, _) = *trace(config([500; 3]), program, &[]).last().unwrap();
    seconds
}

/// Chained quarter arcs of 1 to 2.8 mm, each circle tangent to the one before: at most 1.5 % above
/// the time in which the whole acceleration turns the path.
#[test]
fn a_chain_of_arcs_is_as_fast_as_its_axes() {
    let mut text = String::from("G1 X50 Y50 F3000\n");
    let mut least = 0.0;
    for number in 0..74 {
        let r = 1.0 + f64::from(number % 37) * 0.05;
        for quarter in 0..4 {
            let angle = |quarter: i32| f64::from(quarter - 1) * FRAC_PI_2;
            let at = |quarter: i32| {
                [
                    50.0 + r * angle(quarter).cos(),
                    50.0 + r + r * angle(quarter).sin(),
                ]
            };
            let ([x, y], [to_x, to_y]) = (at(quarter), at(quarter + 1));
            text += &format!(
                "G3 X{to_x:.3} Y{to_y:.3} I{:.3} J{:.3}\n",
                50.0 - x,
                50.0 + r - y
            );
        }
        least += TAU * r / (500.0 * r).sqrt();
    }
    let arcs = seconds(&text) - seconds("G1 X50 Y50 F3000");
    assert!(
        arcs < 1.015 * least && arcs > 0.99 * least,
        "{arcs} {least}"
    );
}
