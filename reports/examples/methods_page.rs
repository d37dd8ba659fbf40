//! Writes the page that compares all methods on one arc: table, charts, pictures of the steps.
//!
//! ```sh
//! cargo run -p husillo-reports --example methods_page -- methods.html
//! ```

use husillo_interp::Direction;
use husillo_methods::{Comparer, Move, Weights};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = match std::env::args_os().nth(1) {
        Some(file) => file.into(),
        None => std::env::temp_dir().join("husillo-methods.html"),
    };
    let circle = Move::circle(12, Direction::Clockwise);
    let mut comparer = Comparer::new(None)?;
    comparer.add(&circle);
    let title = "Circle of radius 12".to_owned();
    let comparison = comparer.finish(title, Some(circle), Weights([3.0, 3.0, 3.0, 1.0]));
    std::fs::write(&file, husillo_reports::methods::html(&comparison))?;
    println!("{}", file.display());
    Ok(())
}
