//! The two-line test: a line is cut after the axis came from below, and a second one next to it
//! after the axis came from above.

use super::bench::Bench;
use super::line_pair::LinePair;

/// Run-up of the axis to a line if its backlash is taken up, mm. It is more than the remaining
/// backlash.
pub const RUN_UP_MM: f64 = 0.05;
/// Run-up without take-up, mm. It is more than any backlash of these screws.
pub const WHOLE_RUN_UP_MM: f64 = 0.4;
/// Length of a line, mm.
const LINE_MM: f64 = 0.02;
/// Distance from one line to the other, mm.
const APART_MM: f64 = 0.3;

/// Cuts the two lines of an axis (0 or 1) near a position and measures their distance.
///
/// # Errors
///
/// The machine refuses a move.
fn cut(
    bench: &mut dyn Bench,
    axis: usize,
    position_mm: [f64; 2],
    travel_mm: [[f64; 2]; 2],
    run_up_mm: f64,
) -> Result<LinePair, String> {
    let other = 1 - axis;
    let [low, high] = travel_mm[axis];
    // As near to the end of the travel as the run-up from above allows.
    let from_above = position_mm[axis].min(high - run_up_mm);
    let from_below = if from_above - APART_MM - run_up_mm < low {
        from_above + APART_MM
    } else {
        from_above - APART_MM
    };
    let begin = (position_mm[other] - LINE_MM / 2.0)
        .clamp(travel_mm[other][0], travel_mm[other][1] - LINE_MM);
    let line = |bench: &mut dyn Bench, start: f64, at: f64| -> Result<f64, String> {
        let names = ["X", "Y"];
        let (own, across) = (names[axis], names[other]);
        bench.make(
            &format!("G0 {own}{start:.4} {across}{begin:.4}"),
            &mut |_| {},
        )?;
        bench.make(&format!("G0 {own}{at:.4}"), &mut |_| {})?;
        let (mut sum, mut steps) = (0.0, 0_u32);
        bench.make(
            &format!("G1 {across}{:.4} F1", begin + LINE_MM),
            &mut |moment| {
                sum += moment.tool_nm[axis];
                steps += 1;
            },
        )?;
        Ok(sum / f64::from(steps.max(1)))
    };
    let below = line(bench, from_below - run_up_mm, from_below)?;
    let above = line(bench, from_above + run_up_mm, from_above)?;
    let mut position = position_mm;
    position[axis] = from_above;
    position[other] = begin + LINE_MM / 2.0;
    // The machine moves in whole steps, but the operator knows only the commanded distance.
    Ok(LinePair {
        axis,
        position_mm: position.map(Some),
        programmed_nm: ((from_above - from_below) * 1e6).round(),
        measured_nm: above - below,
    })
}

/// Cuts pairs for X and Y over the whole travel, at most `every_mm` apart, which is above 0.
/// `run_up_mm` is [`RUN_UP_MM`] if backlash is taken up, else [`WHOLE_RUN_UP_MM`].
///
/// # Errors
///
/// The machine refuses a move.
pub fn cut_all(
    bench: &mut dyn Bench,
    every_mm: f64,
    travel_mm: [[f64; 2]; 2],
    run_up_mm: f64,
) -> Result<Vec<LinePair>, String> {
    let positions = travel_mm.map(|[low, high]| {
        let count = ((high - low) / every_mm).ceil().max(1.0) as u32;
        let part = move |index| low + (high - low) * f64::from(index) / f64::from(count);
        (0..=count).map(part).collect::<Vec<f64>>()
    });
    let mut pairs = Vec::new();
    for axis in 0..2 {
        for (row, y) in positions[1].iter().enumerate() {
            let mut row_of: Vec<f64> = positions[0].clone();
            if row % 2 == 1 {
                row_of.reverse();
            }
            for x in row_of {
                pairs.push(cut(bench, axis, [x, *y], travel_mm, run_up_mm)?);
            }
        }
    }
    Ok(pairs)
}
