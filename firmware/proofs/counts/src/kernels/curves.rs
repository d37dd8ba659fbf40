//! Helices, ellipses, conics and Bezier curves.

use husillo_interp::{
    Bezier, Conic, ConicMove, Direction, EllipseMove, Helix, ProgrammedArc, Scale,
};

use crate::arcs::CIRCLE;
use crate::{Count, walk};

#[inline(never)]
pub fn all(count: Count<'_>) {
    if let Ok(helix) = Helix::<3>::new(&CIRCLE, [0, 1], [0, 0, 500]) {
        walk(count, "helix_3_axes", &helix);
    }
    circle_on_unequal_steps(count);
    let ellipse = EllipseMove {
        from: [1000, 0],
        to: [1000, 0],
        centre: [0, 0],
        semi_axes: [1000, 600],
        fraction_bits: 0,
        direction: Direction::CounterClockwise,
        turns: 0,
    };
    if let Ok(ellipse) = Conic::ellipse(&ellipse) {
        walk(count, "ellipse", &ellipse);
    }
    // y = x^2 / 1000.
    let parabola = ConicMove {
        from: [-1000, 1000],
        to: [1000, 1000],
        coefficients: [1, 0, 0, 0, -1000, 0],
        direction: Direction::CounterClockwise,
        turns: 0,
    };
    if let Ok(parabola) = Conic::new(&parabola) {
        walk(count, "parabola", &parabola);
    }
    let control = [[0, 0], [100, 300], [300, -100], [400, 200]];
    if let Ok(curve) = Bezier::cubic(control, 0) {
        walk(count, "bezier_2_axes", &curve);
    }
    let [first, second, third, last] = control.map(|[x, y]| [x, y, x - y]);
    if let Ok(curve) = Bezier::cubic([first, second, third, last], 0) {
        walk(count, "bezier_3_axes", &curve);
    }
}

/// A whole circle of 1000 by 2000 steps.
fn circle_on_unequal_steps(count: Count<'_>) {
    let circle = ProgrammedArc {
        from: [2_500_000, 0],
        to: [2_500_000, 0],
        centre: [0, 0],
        direction: Direction::CounterClockwise,
        turns: 0,
        mismatch_nm: 0,
    };
    let (Some(coarse), Some(fine)) = (Scale::new(2500, 1), Scale::new(1250, 1)) else {
        return;
    };
    let grid = circle.on_grids([coarse, fine], [[1000, 0]; 2]);
    if let Ok(Ok(helix)) = grid.map(|grid| Helix::<2, _>::of_ellipse(&grid, [0, 1], [0, 0])) {
        walk(count, "circle_on_unequal_steps", &helix);
    }
}
