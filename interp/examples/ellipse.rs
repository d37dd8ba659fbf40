//! Draws an ellipse of 18 by 7 steps, marks the points of the path, and prints its length.

use husillo_interp::{Conic, ConicError, Direction, EllipseMove, Interpolator};

fn main() -> Result<(), ConicError> {
    let ellipse = Conic::ellipse(&EllipseMove {
        from: [18, 0],
        to: [18, 0],
        centre: [0, 0],
        semi_axes: [18, 7],
        fraction_bits: 0,
        direction: Direction::CounterClockwise,
        turns: 0,
    })?;
    println!(
        "{} events, {:.2} steps long",
        ellipse.events(),
        ellipse.total_sweep() as f64 / f64::from(ellipse.unit())
    );
    let mut picture = [[' '; 37]; 15];
    let (mut x, mut y) = (36_usize, 7_usize);
    for step in ellipse {
        x = x.saturating_add_signed(step.delta(0).into());
        y = y.saturating_add_signed(step.delta(1).into());
        picture[14 - y][x] = '#';
    }
    for row in picture {
        println!("{}", row.iter().collect::<String>().trim_end());
    }
    Ok(())
}
