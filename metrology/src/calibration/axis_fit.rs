//! Scale and pitch errors of an axis from reference lengths.

use crate::least_squares::straight_line;
use husillo_backlash::{ErrorTable, Flank, Knot, TableError};
use std::collections::BTreeMap;

/// One reading of a reference length, both in nm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    /// The true length.
    pub nominal: i64,
    /// The length that the axis shows.
    pub reading: i64,
    /// The direction of approach. [`Flank::Unknown`] stands for both directions.
    pub flank: Flank,
}

/// The errors of an axis, found from readings.
#[derive(Clone, Debug)]
pub struct AxisFit {
    /// The table of errors. It is empty if the residuals are only noise.
    pub table: ErrorTable<Vec<Knot>>,
    /// Number of different lengths.
    pub lengths: usize,
    /// Largest minus smallest error of a reading, nm: without the table, with the scale alone, and
    /// with the whole table.
    pub spans: [f64; 3],
    /// Uncertainty of a mean of readings, nm.
    pub noise: f64,
}

/// Sum and number of the readings of one length, for positive, negative and unknown direction.
type Passes = [(f64, f64); 3];

impl AxisFit {
    /// Fits a straight line to the means of both directions by least squares, and puts the
    /// residuals into the table. `resolution` is the length of a count in nm. Readings are not more
    /// accurate than this.
    ///
    /// # Errors
    ///
    /// A sentence: there are too few lengths, or the errors are too large for any real screw or
    /// scale.
    pub fn new(readings: &[Reading], resolution: f64, no_table: bool) -> Result<Self, String> {
        let mut lengths: BTreeMap<i64, Passes> = BTreeMap::new();
        for reading in readings {
            let passes = lengths.entry(reading.nominal).or_default();
            let (sum, number) = &mut passes[index(reading.flank)];
            *sum += reading.reading as f64;
            *number += 1.0;
        }
        if lengths.len() < 2 {
            return Err("readings of at least two different lengths are needed".into());
        }
        let means: Vec<(f64, [f64; 2])> = lengths
            .iter()
            .map(|(nominal, passes)| (*nominal as f64, means(passes)))
            .collect();
        let points: Vec<(f64, f64)> = means
            .iter()
            .map(|(nominal, [positive, negative])| (0.5 * (positive + negative), *nominal))
            .collect();
        let (scale, offset) = straight_line(&points).ok_or(
            "all lengths have the same reading: does the axis move, and are the columns in the \
             right order?",
        )?;
        let scale_ppb = (scale * 1e9).round();
        if scale_ppb.abs() > 1e7 {
            return Err(format!(
                "the axis would be off by {:.1} %: are the columns in the right order, and in the \
                 same unit?",
                scale * 100.0
            ));
        }
        let scale_ppb = scale_ppb as i32;
        // The rounded scale is subtracted, so that the table contains the remainder.
        let scale = f64::from(scale_ppb) * 1e-9;
        let left = |nominal: f64, reading: f64| nominal - reading * (1.0 + scale) - offset;
        let knots: Vec<Knot> = means
            .iter()
            .map(|&(nominal, [positive, negative])| Knot {
                reading_nm: (0.5 * (positive + negative)).round() as i64,
                positive_nm: left(nominal, positive).round() as i32,
                negative_nm: left(nominal, negative).round() as i32,
            })
            .collect();
        let noise = noise(readings, &lengths, resolution);
        let squares = knots
            .iter()
            .flat_map(|knot| [knot.positive_nm, knot.negative_nm]);
        let squares: f64 = squares.map(|nm| f64::from(nm) * f64::from(nm)).sum();
        // With two lengths the means always lie on a line. Their residuals are backlash.
        let is_noise = squares / (2.0 * means.len() as f64) < (1.5 * noise).powi(2);
        let kept = if no_table || is_noise {
            Vec::new()
        } else {
            knots
        };
        let is_plain = |scale| ErrorTable::new(scale, Vec::new()).map_err(message);
        let table = ErrorTable::new(scale_ppb, kept).map_err(message)?;
        let spans = [
            span(readings, &is_plain(0)?),
            span(readings, &is_plain(scale_ppb)?),
            span(readings, &table),
        ];
        Ok(Self {
            table,
            lengths: means.len(),
            spans,
            noise,
        })
    }
}

/// Index of a direction in [`Passes`].
const fn index(flank: Flank) -> usize {
    match flank {
        Flank::Positive => 0,
        Flank::Negative => 1,
        Flank::Unknown => 2,
    }
}

/// Mean reading of each direction. A direction without a reading has the mean of the other one.
fn means([positive, negative, both]: &Passes) -> [f64; 2] {
    let mean = |one: (f64, f64), other: (f64, f64)| {
        let (sum, number) = (one.0 + both.0, one.1 + both.1);
        if number > 0.0 {
            sum / number
        } else {
            other.0 / other.1
        }
    };
    [mean(*positive, *negative), mean(*negative, *positive)]
}

/// Standard deviation of the mean reading of a length in one direction, from repeated readings. It
/// is at least the standard deviation of rounding to counts.
fn noise(readings: &[Reading], lengths: &BTreeMap<i64, Passes>, resolution: f64) -> f64 {
    let (mut squares, mut free) = (0.0, 0.0);
    for reading in readings {
        let (sum, number) = lengths[&reading.nominal][index(reading.flank)];
        squares += (reading.reading as f64 - sum / number).powi(2);
        free += (number - 1.0) / number;
    }
    let groups = lengths
        .values()
        .flatten()
        .filter(|(_, number)| *number > 0.0);
    let readings_a_group = readings.len() as f64 / groups.count() as f64;
    let spread = if free > 0.0 { squares / free } else { 0.0 };
    // Rounding is the same in every pass, so more passes do not reduce it.
    (spread / readings_a_group)
        .max(resolution * resolution / 12.0)
        .sqrt()
}

/// Largest minus smallest error of the readings with a table.
fn span(readings: &[Reading], table: &ErrorTable<Vec<Knot>>) -> f64 {
    let errors = readings.iter().map(|reading| {
        let position = table.position_nm(reading.reading, reading.flank);
        (position - reading.nominal) as f64
    });
    let ends = errors.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], error| {
        [low.min(error), high.max(error)]
    });
    ends[1] - ends[0]
}

fn message(error: TableError) -> String {
    format!(
        "{error}: is a line of the readings wrong? Entries are sorted by length and count from 0"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_pitch_and_play_are_found() {
        // A scale error of 50 um/m, a pitch error of 3 um with a period of 80 mm, and 2 um of
        // backlash. The readings have an error of 10 nm in each of two passes.
        let truth = |reading: f64, flank| {
            let play = if flank == Flank::Positive {
                1000.0
            } else {
                -1000.0
            };
            let turn = std::f64::consts::TAU * reading / 80e6;
            reading * (1.0 + 50e-6) + 3000.0 * turn.sin() + play + 12_345.0
        };
        let mut readings = Vec::new();
        for step in -40..=40 {
            for flank in [Flank::Positive, Flank::Negative] {
                let nominal = step * 5_000_000;
                let mut reading = nominal as f64;
                for _ in 0..20 {
                    reading -= truth(reading, flank) - nominal as f64;
                }
                for noise in [-10, 10] {
                    readings.push(Reading {
                        nominal,
                        reading: reading.round() as i64 + noise,
                        flank,
                    });
                }
            }
        }
        let fit = AxisFit::new(&readings, 10.0, false).unwrap();
        assert_eq!((fit.lengths, fit.table.knots().len()), (81, 81));
        assert!(fit.spans[0] > 20_000.0 && fit.spans[1] > 7_000.0, "{fit:?}");
        assert!(fit.spans[2] < 50.0, "{fit:?}");
        // The table is right between the lengths, too.
        let shift =
            truth(0.0, Flank::Unknown) + 1000.0 - fit.table.position_nm(0, Flank::Unknown) as f64;
        for step in -390..=390 {
            for flank in [Flank::Positive, Flank::Negative] {
                let reading = step * 512_345;
                let error = fit.table.position_nm(reading, flank) as f64 + shift
                    - truth(reading as f64, flank);
                assert!(error.abs() < 150.0, "{error} nm at {reading}");
            }
        }
    }

    #[test]
    fn noise_makes_no_table() {
        let readings: Vec<_> = (-20..=20)
            .map(|step: i64| {
                let nominal = step * 10_000_000;
                // Counts of 2 um.
                let reading = (nominal as f64 * (1.0 - 50e-6) / 2000.0).round() as i64 * 2000;
                Reading {
                    nominal,
                    reading,
                    flank: Flank::Unknown,
                }
            })
            .collect();
        let fit = AxisFit::new(&readings, 2000.0, false).unwrap();
        assert!(fit.table.knots().is_empty(), "{fit:?}");
        assert!(fit.table.scale_ppb().abs_diff(50_000) < 2_500, "{fit:?}");
    }

    #[test]
    fn two_lengths_show_the_play() {
        let reading = |nominal, reading, flank| Reading {
            nominal,
            reading,
            flank,
        };
        let readings = [
            reading(0, 0, Flank::Positive),
            reading(20_000_000, 20_000_000, Flank::Positive),
            reading(0, 20_000, Flank::Negative),
            reading(20_000_000, 20_020_000, Flank::Negative),
        ];
        let fit = AxisFit::new(&readings, 2000.0, false).unwrap();
        let ends: Vec<[i32; 2]> = fit
            .table
            .knots()
            .iter()
            .map(|knot| [knot.positive_nm, knot.negative_nm])
            .collect();
        assert_eq!(ends, [[10_000, -10_000]; 2]);
        assert!(fit.spans[2] < 10.0, "{fit:?}");
        // Without backlash the table has no knots.
        let fit = AxisFit::new(&readings[..2], 2000.0, false).unwrap();
        assert!(fit.table.knots().is_empty());
    }

    #[test]
    fn nonsense_is_refused() {
        let reading = |nominal, reading| Reading {
            nominal,
            reading,
            flank: Flank::Unknown,
        };
        let why = |readings: &[Reading]| AxisFit::new(readings, 1.0, false).unwrap_err();
        assert!(why(&[reading(5, 5), reading(5, 6)]).contains("two different lengths"));
        assert!(why(&[reading(0, 0), reading(1_000_000, 2_000_000)]).contains("50.0 %"));
        assert!(why(&[reading(0, 0), reading(10_000_000, 0)]).contains("does the axis move"));
        let jump = [
            reading(0, 0),
            reading(1_000_000, 1_000_000),
            reading(2_000_000, 2_000_000),
            reading(2_000_100, 2_000_020),
            reading(100_000_000, 100_000_000),
        ];
        assert!(why(&jump).contains("too steep"));
    }
}
