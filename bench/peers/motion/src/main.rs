//! Our methods and other crates' on the same input, in the same run, built with the same flags: time and accuracy.
//!
//! Times are CPU time of the thread, so that other programs count little; all candidates of a table take turns, many times, and the
//! median is taken of the ratios within a turn. Whatever a table says about accuracy is computed here as well.

mod circles;
mod jerk;
mod lines;
mod race;
mod ramps;

fn main() {
    println!("Times as multiples of the first row's. {}\n", VERSIONS);
    lines::two_axes();
    lines::three_axes();
    circles::whole();
    ramps::short();
    ramps::fast();
    jerk::limited();
}

const VERSIONS: &str = "line_drawing 1.0.1, bresenham 0.1.1, ramp-maker 0.2.0, rsruckig 3.0.1.";
