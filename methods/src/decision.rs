//! The decision matrix: rates the methods by weighted criteria.

use crate::comparison::Row;
use serde::Serialize;

/// Names of the criteria, in the order of the weights.
pub const CRITERIA: [&str; 4] = ["error", "iterations", "evenness", "work"];

/// Weights of the criteria: none negative, some positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights(pub [f64; CRITERIA.len()]);

/// Points of one method, from 0 to 100.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Points {
    /// Largest error of the best method, in per cent of that of this method.
    pub error: f64,
    /// Iterations of the best method, in per cent of those of this method.
    pub iterations: f64,
    /// 100 minus the ripple over 32 events, in per cent from slowest to fastest.
    pub evenness: f64,
    /// Work per event of the best method, in per cent of that of this method.
    pub work: f64,
    /// Weighted mean.
    pub total: f64,
}

impl Weights {
    /// Reads `3,3,3,1`. `None` if the text is not four numbers from 0 up, one of them above 0.
    pub fn parse(text: &str) -> Option<Self> {
        let weights: Result<Vec<f64>, _> = text
            .split(',')
            .map(|weight| weight.trim().parse())
            .collect();
        let weights: [f64; CRITERIA.len()] = weights.ok()?.try_into().ok()?;
        let is_fine = weights.iter().all(|w| (0.0..=1e6).contains(w))
            && weights.iter().any(|weight| *weight > 0.0);
        is_fine.then_some(Self(weights))
    }

    /// Weighted mean of four values.
    pub fn mean(self, values: [f64; CRITERIA.len()]) -> f64 {
        let sum: f64 = self.0.iter().zip(values).map(|(w, v)| w * v).sum();
        sum / self.0.iter().sum::<f64>()
    }
}

impl Points {
    /// The four values in the order of the weights.
    pub const fn values(&self) -> [f64; CRITERIA.len()] {
        [self.error, self.iterations, self.evenness, self.work]
    }
}

/// Work per event: instructions on a Cortex-M4F if all methods have a count, otherwise additions
/// and tests.
fn work(rows: &[Row]) -> Vec<f64> {
    let counted: Option<Vec<f64>> = rows.iter().map(|row| row.instructions.cortex_m4f).collect();
    counted.unwrap_or_else(|| {
        rows.iter()
            .map(|row| f64::from(row.additions + row.tests))
            .collect()
    })
}

/// Rates the rows of one shape.
pub fn rate(rows: &mut [Row], weights: Weights) {
    let column = |values: Vec<f64>| -> Vec<f64> {
        let best = values.iter().copied().fold(f64::INFINITY, f64::min);
        values
            .into_iter()
            .map(|value| {
                if value <= best {
                    100.0
                } else {
                    100.0 * best / value
                }
            })
            .collect()
    };
    let errors = column(rows.iter().map(|row| row.max_error_blu).collect());
    let iterations = column(rows.iter().map(|row| row.iterations as f64).collect());
    let work = column(work(rows));
    for (index, row) in rows.iter_mut().enumerate() {
        // A printed method is rated as it originally ran, with the same time for every pass.
        let even = match &row.vector_feed {
            Some(speed) if !row.method.ends_with("-printed") => speed,
            _ => &row.equal_time,
        };
        let ripple = even
            .ripple_percent_windows
            .iter()
            .find(|ripple| ripple.events == 32)
            .map_or(0.0, |ripple| ripple.high - ripple.low);
        let mut points = Points {
            error: errors[index],
            iterations: iterations[index],
            evenness: (100.0 - ripple).max(0.0),
            work: work[index],
            total: 0.0,
        };
        points.total = weights.mean(points.values());
        row.points = points;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_read_and_averaged() {
        assert_eq!(
            Weights::parse("3,3,3,1"),
            Some(Weights([3.0, 3.0, 3.0, 1.0]))
        );
        for text in ["", "1,2,3", "0,0,0,0", "1,1,1,-1", "1,1,1,nan", "1,2,3,4,5"] {
            assert!(Weights::parse(text).is_none(), "{text}");
        }
        assert_eq!(
            Weights([3.0, 3.0, 3.0, 1.0]).mean([100.0, 100.0, 100.0, 0.0]),
            90.0
        );
    }
}
