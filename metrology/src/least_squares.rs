//! Linear least squares with few unknowns.

/// Fits `y = x (1 + scale) + offset` to the points `(x, y)` by least squares. Returns scale and
/// offset. `None`: all `x` are equal.
pub fn straight_line(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let count = points.len() as f64;
    let middle = points.iter().map(|(x, _)| x).sum::<f64>() / count;
    let error = points.iter().map(|(x, y)| y - x).sum::<f64>() / count;
    let (mut along, mut across) = (0.0, 0.0);
    for (x, y) in points {
        along += (x - middle).powi(2);
        across += (x - middle) * (y - x - error);
    }
    let scale = (along > 0.0).then(|| across / along)?;
    Some((scale, error - scale * middle))
}

/// Finds the change of the free unknowns that minimises the sum of squares of
/// `row . change - left`. `rows` yields `(row, left)`. The change of an unknown that is not free is
/// 0. `None`: the rows do not determine the change.
///
/// Solves the normal equations by Gauss-Jordan elimination. The columns are normalised first, so
/// the unknowns may have very different magnitudes.
pub fn least_squares<const N: usize>(
    rows: impl Iterator<Item = ([f64; N], f64)>,
    free: [bool; N],
) -> Option<[f64; N]> {
    let mut normal = [[0.0; N]; N];
    let mut right = [0.0; N];
    let mut count = 0;
    for (row, left) in rows {
        count += 1;
        for ((line, side), a) in normal.iter_mut().zip(&mut right).zip(row) {
            for (sum, b) in line.iter_mut().zip(row) {
                *sum += a * b;
            }
            *side += a * left;
        }
    }
    if count < free.iter().filter(|free| **free).count() {
        return None;
    }
    let scale: [f64; N] = std::array::from_fn(|i| normal[i][i].max(f64::MIN_POSITIVE).sqrt());
    for i in 0..N {
        for j in 0..N {
            normal[i][j] /= scale[i] * scale[j];
            if !(free[i] && free[j]) {
                normal[i][j] = f64::from(u8::from(i == j));
            }
        }
        right[i] = if free[i] { right[i] / scale[i] } else { 0.0 };
    }
    eliminate(&mut normal, &mut right)?;
    Some(std::array::from_fn(|i| right[i] / scale[i]))
}

/// Gauss-Jordan elimination: `right` becomes the solution. The matrix is positive definite with a
/// diagonal of 1, so its diagonal provides the pivots. `None`: a pivot vanishes.
fn eliminate<const N: usize>(normal: &mut [[f64; N]; N], right: &mut [f64; N]) -> Option<()> {
    for i in 0..N {
        let pivot = normal[i][i];
        if pivot < 1e-6 {
            return None;
        }
        let line = normal[i].map(|value| value / pivot);
        let part = right[i] / pivot;
        for (j, (other, side)) in normal.iter_mut().zip(right.iter_mut()).enumerate() {
            let factor = other[i];
            for (value, part) in other.iter_mut().zip(line) {
                *value = if j == i { part } else { *value - factor * part };
            }
            *side = if j == i { part } else { *side - factor * part };
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_through_points() {
        // y = 3 + 2 x, with one point 0.3 too high. The mean is a third of that too high.
        let points = [(-1.0, 1.0), (0.0, 3.3), (1.0, 5.0)];
        let rows = points.map(|(x, y)| ([1.0, x], y));
        let [offset, slope] = least_squares(rows.into_iter(), [true; 2]).unwrap();
        assert!((offset - 3.1).abs() < 1e-12 && (slope - 2.0).abs() < 1e-12);
        // Without a slope the result is the mean. Unknowns of very different magnitudes are found
        // as exactly.
        let [mean, none] = least_squares(rows.into_iter(), [true, false]).unwrap();
        assert!((mean - 3.1).abs() < 1e-12 && none == 0.0);
        let rows = points.map(|(x, y)| ([1e-9, 1e9 * x], y));
        let [offset, slope] = least_squares(rows.into_iter(), [true; 2]).unwrap();
        assert!((offset * 1e-9 - 3.1).abs() < 1e-9 && (slope * 1e9 - 2.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_not_determined_is_none() {
        let rows = [([1.0, 2.0], 1.0), ([2.0, 4.0], 2.0)];
        assert_eq!(least_squares(rows.into_iter(), [true; 2]), None);
        assert_eq!(least_squares(rows.into_iter().take(1), [true; 2]), None);
    }
}
