//! The tangent at compile time.

/// The tangent of an angle from 0 to below a right angle, to 1e-14 of itself.
///
/// The angle is halved until the series of sine and cosine are short; `tan 2x = 2 t / (1 - t^2)`
/// doubles it again.
pub(super) const fn tangent(angle: f64) -> f64 {
    // At most 1.6 / 8 = 0.2.
    let part = angle / 8.0;
    let square = part * part;
    let sine = part
        * (1.0
            - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0))));
    let cosine = 1.0
        - square / 2.0
            * (1.0
                - square / 12.0
                    * (1.0 - square / 30.0 * (1.0 - square / 56.0 * (1.0 - square / 90.0))));
    let mut tangent = sine / cosine;
    let mut doubled = 0;
    while doubled < 3 {
        tangent = 2.0 * tangent / (1.0 - tangent * tangent);
        doubled += 1;
    }
    tangent
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_is_that_of_the_library() {
        for sixteenth in 0..1608_u32 {
            let angle = f64::from(sixteenth) / 1024.0;
            let (ours, theirs) = (super::tangent(angle), angle.tan());
            // The condition number of the tangent grows next to the right angle.
            let near = 1.0 + theirs.abs();
            assert!(
                (ours - theirs).abs() <= 1e-14 * near * near,
                "{angle}: {ours} {theirs}"
            );
        }
    }
}
