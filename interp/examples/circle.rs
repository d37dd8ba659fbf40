//! Prints the 168 steps of a circle of radius 30, one digit each: (dx + 1) * 3 + (dy + 1).

use husillo_interp::{Arc, ArcError, ArcMove, Direction, Rim};

fn main() -> Result<(), ArcError> {
    let arc = Arc::new(&ArcMove {
        from: [0, 30],
        to: [0, 30],
        centre: [0, 0],
        fraction_bits: 0,
        direction: Direction::Clockwise,
        turns: 0,
        rim: Rim::Spiral,
    })?;
    let steps: String = arc
        .map(|step| {
            let [dx, dy] = step.deltas();
            char::from(b'4'.wrapping_add_signed(3 * dx + dy))
        })
        .collect();
    println!("{steps}");
    Ok(())
}
