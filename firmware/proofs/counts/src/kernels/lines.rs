//! Straight moves.

use husillo_interp::{Line, LineDda, LineDdaExact};

use crate::{Count, walk};

#[inline(never)]
pub fn all(count: Count<'_>) {
    walk(count, "line_2_axes", &Line::new([10_000, -5_000]));
    walk(count, "line_3_axes", &Line::new([10_000, -5_000, 7]));
    let delta = [10_000, -5_000, 7, 3_333, 0, 9_999];
    walk(count, "line_6_axes", &Line::new(delta));
    if let Some(line) = LineDda::new([10_000, -5_000]) {
        walk(count, "line_dda_2_axes", &line);
    }
    if let Some(line) = LineDda::new([10_000, -5_000, 7]) {
        walk(count, "line_dda_3_axes", &line);
    }
    if let Some(line) = LineDda::printed([10_000, -5_000]) {
        walk(count, "line_dda_printed_2_axes", &line);
    }
    if let Some(line) = LineDdaExact::new([10_000, -5_000]) {
        walk(count, "line_dda_exact_2_axes", &line);
    }
}
