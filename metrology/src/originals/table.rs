//! A measured table beside its rebuilt values.

use serde::Serialize;

/// A value that was measured on an original machine.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What was measured.
    pub name: String,
    /// Unit of all numbers of the row.
    pub unit: &'static str,
    /// The measured value.
    pub measured: f64,
    /// The value of the simulated machine with the settings of the original; `None` if no
    /// simulation gives it.
    pub rebuilt: Option<f64>,
    /// The value with the compensation of today; `None` if nothing is compensated.
    pub today: Option<f64>,
    /// The programmed value; `None` if there is none.
    pub programmed: Option<f64>,
    /// Spread of the measured value in either direction.
    pub spread: f64,
}

impl Row {
    /// A row with only a measured value and its spread.
    pub fn new(name: impl Into<String>, unit: &'static str, measured: f64, spread: f64) -> Self {
        Self {
            name: name.into(),
            unit,
            measured,
            rebuilt: None,
            today: None,
            programmed: None,
            spread,
        }
    }

    /// Adds the rebuilt value.
    #[must_use]
    pub fn rebuilt(self, value: f64) -> Self {
        Self {
            rebuilt: Some(value),
            ..self
        }
    }

    /// Adds the value with the compensation of today, and the programmed one.
    #[must_use]
    pub fn today(self, value: f64, programmed: f64) -> Self {
        Self {
            today: Some(value),
            programmed: Some(programmed),
            ..self
        }
    }

    /// Measured minus rebuilt value: the part that the simulation does not explain.
    #[must_use]
    pub fn unexplained(&self) -> Option<f64> {
        Some(self.measured - self.rebuilt?)
    }

    /// Whether the rebuilt value lies within the spread; `None` without a rebuilt value.
    #[must_use]
    pub fn is_within(&self) -> Option<bool> {
        Some(self.unexplained()?.abs() <= self.spread * (1.0 + 1e-9))
    }
}

/// A number that a rebuilt table depends on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// What it is.
    pub name: String,
    /// Its value with its unit.
    pub value: String,
    /// Where it comes from.
    pub source: &'static str,
}

impl Parameter {
    /// A parameter with its source.
    pub fn new(name: impl Into<String>, value: String, source: &'static str) -> Self {
        Self {
            name: name.into(),
            value,
            source,
        }
    }
}

/// A measured table of an original machine beside its rebuilt values.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Table {
    /// Number of the table in the description of the original.
    pub number: &'static str,
    /// What it shows.
    pub title: &'static str,
    /// The meaning of the spread of the rows.
    pub spread: &'static str,
    /// The rows.
    pub rows: Vec<Row>,
    /// The parameters of the rebuilt values.
    pub parameters: Vec<Parameter>,
    /// Reasons for rows outside of their spread, and values that no simulation gives.
    pub notes: Vec<String>,
}

impl Table {
    /// Rows with a rebuilt value, and how many of these are within their spread.
    #[must_use]
    pub fn counts(&self) -> [usize; 2] {
        let all = || self.rows.iter().filter_map(Row::is_within);
        [all().count(), all().filter(|within| *within).count()]
    }

    /// Root mean square of the unexplained parts of the rows with this unit. `None` without such
    /// rows.
    #[must_use]
    pub fn rms(&self, unit: &str) -> Option<f64> {
        let rows = self.rows.iter().filter(|row| row.unit == unit);
        let left: Vec<f64> = rows.filter_map(Row::unexplained).collect();
        let squares: f64 = left.iter().map(|left| left * left).sum();
        (!left.is_empty()).then(|| (squares / left.len() as f64).sqrt())
    }

    /// Largest deviation from the programmed value, of the rows with this unit that have all
    /// values: measured, rebuilt, with the compensation of today.
    #[must_use]
    pub fn gain(&self, unit: &str) -> Option<[f64; 3]> {
        let rows = self.rows.iter().filter(|row| row.unit == unit);
        let off = rows.filter_map(|row| {
            let programmed = row.programmed?;
            let values = [row.measured, row.rebuilt?, row.today?];
            Some(values.map(|value| (value - programmed).abs()))
        });
        off.reduce(|most, off| std::array::from_fn(|index| most[index].max(off[index])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_unexplained_decides() {
        let row = |rebuilt| Row::new("left", "um", 12.0, 2.0).rebuilt(rebuilt);
        let table = Table {
            number: "0",
            title: "a trial",
            spread: "2 um",
            rows: vec![
                row(10.0).today(1.0, 0.0),
                row(15.0).today(-3.0, 0.0),
                Row::new("time", "min", 8.0, 1.0),
            ],
            parameters: vec![],
            notes: vec![],
        };
        assert_eq!(table.counts(), [2, 1]);
        assert_eq!(table.rows[1].unexplained(), Some(-3.0));
        assert!((table.rms("um").unwrap() - 6.5_f64.sqrt()).abs() < 1e-12);
        assert_eq!(table.rms("min"), None);
        assert_eq!(table.gain("um"), Some([12.0, 15.0, 3.0]));
    }
}
