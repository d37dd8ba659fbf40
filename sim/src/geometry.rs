//! The exact geometry of programmed moves: paths, and distances from them.
//!
//! The path of a simulated machine is compared with it. No simulated machine uses it, and it is
//! independent of the integer interpolators.

mod curve;
pub mod nurbs;
pub mod path;
pub mod turn;

/// Length of the chords through the points 0 to `parts` of a curve.
fn chords_length(parts: u32, point: impl Fn(u32) -> [f64; 2]) -> f64 {
    let chord = |part: u32| {
        let [[a, b], [c, d]] = [point(part), point(part + 1)];
        (c - a).hypot(d - b)
    };
    (0..parts).map(chord).sum()
}
