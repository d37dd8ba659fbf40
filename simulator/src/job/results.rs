//! The results of a run, and how `--format json` prints them.

use super::Job;
use crate::diagnostics::Findings;
use crate::programs::check::Facts;
use crate::simulation::run::Run;
use crate::text::json::write_found;
use husillo_gcode::Nm;
use husillo_machine::Probed;
use husillo_sim::observers::AXES;
use husillo_sim::observers::symmetry::{Difference, Symmetry};
use serde::Serialize;
use std::io::{self, Write};

/// The figures of a run: what `husillo run --format json` prints.
#[derive(Debug, Default, Serialize)]
pub struct Results {
    /// Step events, those of take-ups included.
    pub events: u64,
    /// Time from the first event to the last, s.
    pub duration_s: f64,
    /// Last position of the tool from work zero, nm, by axis.
    pub end_nm: Vec<i64>,
    /// Its lowest position.
    pub min_nm: Vec<i64>,
    /// Its highest position.
    pub max_nm: Vec<i64>,
    /// Largest distance of the tool from the programmed path in a feed move, nm.
    pub max_deviation_nm: f64,
    /// Root of the mean square of that distance, nm.
    pub rms_deviation_nm: f64,
    /// Take-ups of backlash, by axis.
    pub reversals: Vec<u64>,
    /// Steps that the motors did not follow, all axes.
    pub lost_steps: u64,
    /// A sentence about each axis that lost steps.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub losses: Vec<String>,
    /// What `--order mirrored` has done.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order: Option<Order>,
    /// Distance of the two sides of the work, if they are compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_right: Option<Difference>,
    /// What the encoders reported, one sentence each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub encoders: Vec<String>,
    /// What the probe has found.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<Touch>,
    /// Length of all feed moves, nm.
    pub feed_nm: i64,
    /// Length of all rapids, nm.
    pub rapid_nm: i64,
    /// Errors of the check, or sentences in `losses`.
    pub errors: u64,
    /// Warnings of the check.
    pub warnings: u64,
}

/// The results and what they are about.
#[derive(Serialize)]
struct Document<'a> {
    file: &'a str,
    machine: &'a str,
    #[serde(flatten)]
    results: &'a Results,
}

/// What a probe has found.
#[derive(Clone, Debug, Serialize)]
pub struct Touch {
    /// Whether the contact changed.
    pub is_touched: bool,
    /// The position in the work frame of the move, or the end of a move without contact.
    pub position_nm: Vec<i64>,
    /// The same in machine coordinates.
    pub machine_nm: Vec<i64>,
}

/// What `--order mirrored` has done.
#[derive(Clone, Debug, Serialize)]
pub struct Order {
    /// Contours cut in halves.
    pub mirrored: usize,
    /// Closed contours cut as they were.
    pub whole: usize,
    /// Reversals of every axis in the order of the file.
    pub reversals_of_file: Vec<u64>,
    /// The same in the order that was cut.
    pub reversals: Vec<u64>,
}

impl Results {
    /// The results of a program with errors: nothing moved.
    pub fn refused(findings: &Findings, axes: usize) -> Self {
        Self {
            end_nm: vec![0; axes],
            min_nm: vec![0; axes],
            max_nm: vec![0; axes],
            reversals: vec![0; axes],
            errors: findings.errors,
            warnings: findings.warnings,
            ..Self::default()
        }
    }

    /// The results of a completed run with its work zero at `offset_nm` of the machine.
    pub fn new(job: &Job, run: &Run, facts: &Facts, offset_nm: [i64; AXES]) -> Self {
        let axes = job.machine.axes.len();
        let nm = |steps: [i32; AXES]| -> Vec<i64> {
            let ends = steps.into_iter().zip(offset_nm).take(axes).enumerate();
            ends.map(|(axis, (steps, offset))| in_nm(job, axis, steps) - offset)
                .collect()
        };
        let seen = &run.observers;
        Self {
            events: run.mechanics.events(),
            duration_s: run.mechanics.seconds(),
            end_nm: nm(run.mechanics.tool()),
            min_nm: nm(seen.statistics.low),
            max_nm: nm(seen.statistics.high),
            max_deviation_nm: rounded(seen.deviation.largest_nm()),
            rms_deviation_nm: rounded(seen.deviation.rms_nm()),
            reversals: seen.statistics.reversals[..axes].to_vec(),
            lost_steps: run.mechanics.losses().lost().iter().sum(),
            losses: Vec::new(),
            encoders: run.encoders.sentences.clone(),
            probes: run
                .probed
                .iter()
                .map(|probed| touch(probed, axes))
                .collect(),
            order: None,
            left_right: seen.symmetry.as_ref().and_then(Symmetry::difference),
            feed_nm: facts.feed_nm.round() as i64,
            rapid_nm: facts.rapid_nm.round() as i64,
            errors: 0,
            warnings: 0,
        }
    }

    /// Writes them as JSON, with the findings of the check.
    ///
    /// # Errors
    ///
    /// Writing fails.
    pub fn write_json(
        &self,
        job: &Job,
        findings: &Findings,
        out: &mut impl Write,
    ) -> io::Result<()> {
        let body = Document {
            file: job.name(),
            machine: &job.machine.name,
            results: self,
        };
        write_found("husillo.run/1", &body, findings, out)
    }
}

fn touch(probed: &Probed<AXES>, axes: usize) -> Touch {
    let nm = |at: [Nm; AXES]| at.into_iter().take(axes).map(|Nm(nm)| nm).collect();
    Touch {
        is_touched: probed.is_touched,
        position_nm: nm(probed.in_work),
        machine_nm: nm(probed.at),
    }
}

/// A position of an axis in nm, to the nearest.
fn in_nm(job: &Job, axis: usize, steps: i32) -> i64 {
    let step = job.machine.axes[axis].step;
    let exact = i128::from(steps) * i128::from(step.num);
    let nearest = (2 * exact + i128::from(step.den)).div_euclid(2 * i128::from(step.den));
    i64::try_from(nearest).unwrap_or(i64::MAX)
}

/// Thousandths of a nanometre are more than enough.
fn rounded(nm: f64) -> f64 {
    (nm * 1e3).round() / 1e3
}
