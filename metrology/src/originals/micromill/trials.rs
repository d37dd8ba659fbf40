//! The original leaves some choices open. All other choices have larger residuals than the ones
//! that are used.

use super::measured::{CIRCLES, Choice, backlash_values, mark_width_um};
use super::part_tables::PARTS;
use super::{LAST_TAKE_UP_UM, Screws, scale};
use std::f64::consts::PI;

/// Standard deviation of a backlash and of a length, um.
const PLAY_UM: f64 = 10.0;
const LENGTH_UM: f64 = 12.0;

/// The error on the negative flank of an axis, um.
fn left_um(screws: &Screws, axis: usize, from_mm: [f64; 2]) -> f64 {
    let [own, other] = [from_mm[axis], from_mm[1 - axis]];
    screws.axes()[axis].backlash_um(own, other) - LAST_TAKE_UP_UM[axis] * scale()
}

/// The deviation of the tool from a clockwise circle, in a direction, um.
fn off_um(screws: &Screws, radius_mm: f64, angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    let at_mm = [radius_mm * cos, radius_mm * sin];
    // X moves backward in the lower half, and Y in the right half. An end is reached on the old
    // flank.
    let (is_low, is_right) = (sin < -1e-9, cos > 1e-9);
    let is_left_end = sin.abs() < 1e-9 && cos < 0.0;
    let is_bottom = cos.abs() < 1e-9 && sin < 0.0;
    let of = |axis, is_back: bool| {
        if is_back {
            left_um(screws, axis, at_mm)
        } else {
            0.0
        }
    };
    [of(0, is_low || is_left_end), of(1, is_right || is_bottom)]
}

/// Sum of squares of the residuals of the diameters, with the best order and the best squareness,
/// um^2.
fn diameters(screws: &Screws) -> f64 {
    let orders = (0..8).flat_map(|first| [1.0, -1.0].map(|sense| (f64::from(first), sense)));
    let left = orders.map(|(first, sense)| {
        let pairs = CIRCLES.iter().flat_map(|circle| {
            (0_u8..8).map(move |index| {
                let angle = (first + sense * f64::from(index)) * PI / 8.0;
                // From an angle below X to one above it: a diameter has no direction.
                let angle = angle.rem_euclid(PI);
                let there = off_um(screws, circle.radius_mm, angle);
                let back = off_um(screws, circle.radius_mm, angle + PI);
                let (sin, cos) = angle.sin_cos();
                let play_um = (there[0] - back[0]) * cos + (there[1] - back[1]) * sin;
                let made_um = 2e3 * circle.radius_mm * scale() + play_um;
                let measured_um = 1e3 * circle.diameters_mm[usize::from(index)];
                let per_skew = circle.radius_mm * (2.0 * angle).sin();
                (per_skew, measured_um - made_um)
            })
        });
        let pairs: Vec<(f64, f64)> = pairs.collect();
        let [along, square] = pairs.iter().fold([0.0; 2], |sum, (per_skew, left)| {
            [sum[0] + per_skew * left, sum[1] + per_skew * per_skew]
        });
        let skew = along / square;
        let squares = pairs.iter().map(|(a, left)| (left - skew * a).powi(2));
        squares.sum::<f64>()
    });
    left.fold(f64::MAX, f64::min)
}

/// Sum of squares of the residuals of the sizes of the parts in the middle of the work area, um^2.
/// The height of the larger logo is an outlier with every choice.
fn sizes(screws: &Screws) -> f64 {
    let sizes = PARTS.iter().flat_map(|part| [(part, 0), (part, 1)]);
    let sizes = sizes.filter(|(part, axis)| (part.number, *axis) != ("19", 1));
    let left = sizes.map(|(part, axis)| {
        let mut from_mm = [0.0; 2];
        from_mm[axis] = -part.programmed_mm[axis] / 2.0;
        let made_um = 1e3 * part.programmed_mm[axis] * scale() - left_um(screws, axis, from_mm);
        1e3 * part.measured_mm[axis] - made_um - mark_width_um()
    });
    left.map(|left| left * left).sum()
}

/// Sum of squares of the residuals of the backlash values, um^2.
fn plays_left(screws: &Screws, choice: &Choice) -> f64 {
    let left = backlash_values(choice).into_iter().map(|play| {
        let [own, other] = [play.at_mm[play.axis], play.at_mm[1 - play.axis]];
        screws.axes()[play.axis].backlash_um(own, other) - play.backlash_um
    });
    left.map(|left| left * left).sum()
}

#[test]
fn the_choice_leaves_least() {
    let sign = |bits: u32, bit: u32| if bits >> bit & 1 == 0 { 1.0 } else { -1.0 };
    let choices = (0..64).map(|bits| Choice {
        signs: [0, 1, 2, 3].map(|bit| sign(bits, bit)),
        thirds: [4, 5].map(|bit| sign(bits, bit)),
    });
    let mut costs: Vec<(f64, Choice)> = choices
        .map(|choice| {
            let screws = Screws::of(&choice);
            let lengths = diameters(&screws) + sizes(&screws);
            let plays = plays_left(&screws, &choice);
            let cost = lengths / LENGTH_UM.powi(2) + plays / PLAY_UM.powi(2);
            (cost, choice)
        })
        .collect();
    costs.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert_eq!(costs[0].1, Choice::BEST, "{:?}", &costs[..4]);
    // No other choice is as good.
    assert!(costs[1].0 > costs[0].0 + 3.0, "{:?}", &costs[..4]);
}
