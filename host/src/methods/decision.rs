//! The decision matrix: methods against weighted criteria.

use crate::methods::compare::Row;
use serde::Serialize;

/// Names of the criteria, in the order of the weights.
pub const CRITERIA: [&str; 4] = ["error", "iterations", "evenness", "work"];
/// What that machine's builders got, with criteria they did not pass on.
pub const ORIGINAL: &str = "With the same weights and criteria of their own the micro mill's \
     builders gave direct search 90.5, \
     DDA 84.4 and the staircase 72.1 points.";

/// Weights of the criteria: none negative, some positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights(pub [f64; CRITERIA.len()]);

/// Points of one method, 0 to 100 each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Points {
    /// Smallest largest error by its own.
    pub error: f64,
    /// Fewest iterations by its own.
    pub iterations: f64,
    /// 100 less the ripple over 32 events, in per cent from slowest to fastest.
    pub evenness: f64,
    /// Least work of an event by its own.
    pub work: f64,
    /// Weighted mean.
    pub total: f64,
}

impl Weights {
    /// Reads `3,3,3,1`.
    ///
    /// # Errors
    ///
    /// A sentence about the text.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wrong =
            || format!("--weights: `{text}` is not four numbers from 0 up, one of them above 0");
        let weights: Vec<f64> = text
            .split(',')
            .map(|weight| weight.trim().parse().map_err(|_| wrong()))
            .collect::<Result<_, _>>()?;
        let weights: [f64; CRITERIA.len()] = weights.try_into().map_err(|_| wrong())?;
        let is_fine = weights.iter().all(|w| (0.0..=1e6).contains(w))
            && weights.iter().any(|weight| *weight > 0.0);
        is_fine.then_some(Self(weights)).ok_or_else(wrong)
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

/// Gives the rows of one shape their points.
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
        // As printed means as it ran: every pass with the same time.
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
    fn weights() {
        assert_eq!(Weights::parse("3,3,3,1"), Ok(Weights([3.0, 3.0, 3.0, 1.0])));
        for text in ["", "1,2,3", "0,0,0,0", "1,1,1,-1", "1,1,1,nan", "1,2,3,4,5"] {
            assert!(Weights::parse(text).is_err(), "{text}");
        }
        assert_eq!(
            Weights([3.0, 3.0, 3.0, 1.0]).mean([100.0, 100.0, 100.0, 0.0]),
            90.0
        );
    }
}
