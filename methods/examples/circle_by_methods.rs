//! Makes one circle with every method, and prints its iterations, its largest error and its points.
//!
//! ```sh
//! cargo run -p husillo-methods --example circle_by_methods -- 100
//! ```

use husillo_interp::Direction;
use husillo_methods::{Comparer, Move, Weights};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let radius = match std::env::args().nth(1) {
        Some(text) => text.parse()?,
        None => 30,
    };
    let circle = Move::circle(radius, Direction::CounterClockwise);
    let mut comparer = Comparer::new(None)?;
    comparer.add(&circle);
    let weights = Weights([3.0, 3.0, 3.0, 1.0]);
    let comparison = comparer.finish(format!("circle of radius {radius}"), None, weights);
    println!("{}", comparison.title);
    println!(
        "{:<22} {:>10} {:>8} {:>7}",
        "method", "iterations", "error", "points"
    );
    for row in &comparison.rows {
        println!(
            "{:<22} {:>10} {:>8.3} {:>7.1}",
            row.method, row.iterations, row.max_error_blu, row.points.total
        );
    }
    Ok(())
}
