//! Methods of husillo and of other crates on the same input, in the same run, built with the same
//! flags: time and accuracy.
//!
//! Times are CPU time of the thread, so that other programs have little influence. All candidates
//! of a table run in many rounds, and the result is the median of the ratios within a round. The
//! accuracy in the tables is also computed here.

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
    jerk::single_moves();
}

const VERSIONS: &str = "line_drawing 1.0.1, bresenham 0.1.1, ramp-maker 0.2.0, rsruckig 3.0.1.";
