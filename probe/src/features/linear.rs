//! Small symmetric matrices.

use super::vector::{dot, exceeds, length};

/// Solves `matrix x = right` for a symmetric positive definite matrix. Returns `None` if a pivot is
/// below `tolerance` of the largest diagonal element: the unknowns then cannot be separated.
///
/// Gaussian elimination without exchange of rows, which is stable for such matrices (G. Golub, C.
/// Van Loan, "Matrix computations", 4.2).
pub(crate) fn solve<const N: usize>(
    mut matrix: [[f64; N]; N],
    mut right: [f64; N],
    tolerance: f64,
) -> Option<[f64; N]> {
    let largest = (0..N)
        .zip(&matrix)
        .filter_map(|(k, row)| row.get(k))
        .fold(0.0_f64, |largest, element| largest.max(*element));
    for k in 0..N {
        let (row, value) = (*matrix.get(k)?, *right.get(k)?);
        let pivot = *row.get(k)?;
        if !exceeds(pivot, tolerance * largest) {
            return None;
        }
        let below = matrix.iter_mut().zip(&mut right).skip(k.wrapping_add(1));
        for (other, other_value) in below {
            let factor = *other.get(k)? / pivot;
            other
                .iter_mut()
                .zip(row)
                .for_each(|(element, above)| *element -= factor * above);
            *other_value -= factor * value;
        }
    }
    let mut solution = [0.0; N];
    for k in (0..N).rev() {
        let row = *matrix.get(k)?;
        // Unknowns that are not solved yet are 0 and add nothing.
        let value = (*right.get(k)? - dot(row, solution)) / *row.get(k)?;
        *solution.get_mut(k)? = value;
    }
    Some(solution)
}

pub(crate) fn trace(matrix: &[[f64; 3]; 3]) -> f64 {
    let [[a, ..], [_, b, _], [.., c]] = matrix;
    a + b + c
}

/// Returns the adjugate of a symmetric matrix. It has the same eigenvectors, and its largest
/// eigenvalue belongs to the smallest of `matrix`.
pub(crate) fn adjugate(matrix: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let [a, b, c] = *matrix;
    [cross(b, c), cross(c, a), cross(a, b)]
}

pub(crate) fn cross([ax, ay, az]: [f64; 3], [bx, by, bz]: [f64; 3]) -> [f64; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

/// Returns the unit eigenvector of the largest eigenvalue of a symmetric matrix without negative
/// eigenvalues. Returns `None` unless this eigenvalue is larger than the next by at least 2^-12.
///
/// The matrix is squared and divided by its trace repeatedly. Each step squares the ratio of the
/// eigenvalues, until only `v v^T` is left (power iteration with doubled exponent).
pub(crate) fn largest_eigenvector(mut matrix: [[f64; 3]; 3]) -> Option<[f64; 3]> {
    // (1 - 2^-12)^(2^18) = e^-64.
    for _ in 0..18 {
        let scale = trace(&matrix);
        if !exceeds(scale, 0.0) {
            return None;
        }
        let rows = matrix.map(|row| row.map(|element| element / scale));
        // The matrix is symmetric: columns equal rows.
        matrix = rows.map(|row| rows.map(|column| dot(row, column)));
    }
    let scale = trace(&matrix);
    let rows = matrix.map(|row| row.map(|element| element / scale));
    // A matrix has rank one if the trace of its square equals the square of its trace.
    let square: f64 = rows.map(|row| dot(row, row)).iter().sum();
    if !exceeds(square, 1.0 - 1e-9) {
        return None;
    }
    // The longest row is the vector times its largest component, which is at least 1 / sqrt 3.
    let [a, b, c] = rows;
    let longer = if dot(a, a) >= dot(b, b) { a } else { b };
    let longest = if dot(longer, longer) >= dot(c, c) {
        longer
    } else {
        c
    };
    let size = length(longest);
    Some(longest.map(|component| component / size))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves() {
        let matrix = [[4.0, 2.0, -2.0], [2.0, 5.0, 1.0], [-2.0, 1.0, 6.0]];
        let solution = solve(matrix, [2.0, 14.0, 19.0], 1e-9).unwrap();
        for (row, value) in matrix.into_iter().zip([2.0, 14.0, 19.0]) {
            assert!((dot(row, solution) - value).abs() < 1e-12);
        }
        assert_eq!(solve([[1.0, 1.0], [1.0, 1.0]], [1.0, 1.0], 1e-9), None);
        assert_eq!(solve([[f64::NAN]], [1.0], 1e-9), None);
    }

    #[test]
    fn eigenvectors() {
        // Eigenvalues 9 along (1, 2, 2) / 3, 1 and 0.25 across.
        let (v, w) = ([1.0, 2.0, 2.0].map(|c| c / 3.0), [2.0, 1.0, -2.0]);
        let w = w.map(|c| c / 3.0);
        let third = cross(v, w);
        let mut matrix = [[0.0; 3]; 3];
        for (value, vector) in [(9.0, v), (1.0, w), (0.25, third)] {
            crate::features::outer(&mut matrix, value, vector, vector);
        }
        assert!((dot(largest_eigenvector(matrix).unwrap(), v).abs() - 1.0).abs() < 1e-15);
        let smallest = largest_eigenvector(adjugate(&matrix)).unwrap();
        assert!((dot(smallest, third).abs() - 1.0).abs() < 1e-15);
        assert_eq!(largest_eigenvector([[0.0; 3]; 3]), None);
        let ball = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(largest_eigenvector(ball), None);
    }
}
