//! The circle test: measures the error that remains where an axis reverses.

use super::bench::Bench;
use std::f64::consts::FRAC_1_SQRT_2;

/// Names of the ends of a circle, in the order in which a circle that begins at 45 degrees passes
/// them.
pub const CIRCLE_ENDS: [&str; 4] = ["top", "left", "bottom", "right"];

/// The axis that reverses at each end, and its direction before the end.
const TURNS: [(usize, f64); 4] = [(1, 1.0), (0, -1.0), (1, -1.0), (0, 1.0)];

/// Cuts a circle, and returns the error that remains at each of its ends, um. This is the error of
/// the tool after an end minus the error before it, along the axis that reverses there.
///
/// # Errors
///
/// The machine refuses a move.
pub fn left_at_ends(
    bench: &mut dyn Bench,
    centre_mm: [f64; 2],
    radius_mm: f64,
) -> Result<[f64; 4], String> {
    let [x, y] = centre_mm;
    let reach = radius_mm * FRAC_1_SQRT_2;
    let (start, below) = ([x + reach, y + reach], [x + reach - 0.1, y + reach - 0.1]);
    bench.make(
        &format!("G0 X{:.5} Y{:.5}", below[0], below[1]),
        &mut |_| {},
    )?;
    bench.make(
        &format!("G0 X{:.5} Y{:.5}", start[0], start[1]),
        &mut |_| {},
    )?;
    // A tenth of the radius before an end the axis is on its old flank. A tenth after the end it is
    // on the new one.
    let near = 0.9 * radius_mm;
    let mut off = [[None; 2]; 4];
    bench.make(
        &format!(
            "G3 X{:.5} Y{:.5} I{:.5} J{:.5} F1",
            start[0], start[1], -reach, -reach
        ),
        &mut |moment| {
            let at = [0, 1].map(|axis| moment.sent_nm[axis] / 1e6 - centre_mm[axis]);
            for (off, (axis, side)) in off.iter_mut().zip(TURNS) {
                if at[axis] * side < near {
                    continue;
                }
                // Counter-clockwise: X falls at the top, Y falls at the left.
                let way = if axis == 1 { -at[0] } else { at[1] } * side;
                let behind = usize::from(way > 0.0);
                let value = (moment.tool_nm[axis] - moment.sent_nm[axis]) / 1e3;
                // Keeps the first error before an end, and the last one after it.
                if behind == 1 || off[0].is_none() {
                    off[behind] = Some(value);
                }
            }
        },
    )?;
    Ok(off.map(|[before, behind]| match (before, behind) {
        (Some(before), Some(behind)) => f64::abs(behind - before),
        _ => 0.0,
    }))
}
