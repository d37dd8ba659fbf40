//! The pieces of a board in the form in which they are sent.

use super::duration::{seconds, travel_s};
use super::part::Part;
use husillo_transports::drill::{MEMORY_BYTES, Record};

/// Records that the memory of the drill holds.
pub(super) const MEMORY_RECORDS: usize = MEMORY_BYTES / 3;

/// A part in the form in which it is sent.
pub(super) struct Load {
    pub(super) bytes: Vec<u8>,
    /// Seconds of each drilling, and of the move home after all of them.
    pub(super) seconds: Vec<f64>,
    pub(super) back_s: f64,
    /// For each drilling: whether it deepens the hole of the drilling before it.
    pub(super) pecks: Vec<bool>,
    /// The number of holes before its first hole, in all parts.
    pub(super) before: usize,
    /// The number of its part, and whether this load is the first or the last one of that part.
    pub(super) part: usize,
    pub(super) is_first: bool,
    pub(super) is_last: bool,
}

impl Load {
    /// Converts numbers of finished and begun drillings to numbers of holes.
    pub(super) fn holes(&self, [done, begun]: [usize; 2]) -> [usize; 2] {
        let starts = |drillings: usize| {
            let first = self.pecks.iter().take(drillings);
            first.filter(|is_peck| !**is_peck).count()
        };
        // A hole is not done while the next drilling deepens it.
        let is_open = self.pecks.get(done) == Some(&true);
        [starts(done) - usize::from(is_open), starts(begun)]
    }

    /// Seconds of the drillings whose records are complete within the first `bytes` bytes.
    pub(super) fn run_s(&self, bytes: usize) -> f64 {
        let drillings = self.drillings(bytes);
        self.seconds.iter().take(drillings).sum()
    }

    /// Number of drillings whose records are complete within the first `bytes` bytes.
    pub(super) fn drillings(&self, bytes: usize) -> usize {
        let bytes = self.bytes.get(..bytes.min(self.bytes.len()));
        let records = bytes.unwrap_or_default().chunks_exact(3);
        records
            .filter(|record| record.first() == Some(&b'Z'))
            .count()
    }
}

/// The holes from hole `from` on, in pieces. Each piece ends at home, so that `c` keeps the zero
/// and the switches reveal lost steps.
pub(super) fn loads_from(parts: &[Part], from: usize, most_records: usize) -> Vec<Load> {
    let mut before = 0;
    let mut loads = Vec::new();
    for (number, part) in parts.iter().enumerate() {
        let all = part.holes();
        let skipped = from.saturating_sub(before);
        let mut done = skipped;
        while done < all {
            // Two records move home.
            let most = most_records.saturating_sub(2);
            let (mut piece, holes) = part.rest_behind(done).first_holes(most);
            let seconds = seconds(&piece, [0; 2]);
            let pecks = piece.pecks().collect();
            let last = piece.stops().last().map_or([0; 2], |stop| stop.at);
            piece.records.extend([Record::X(0), Record::Y(0)]);
            loads.push(Load {
                bytes: piece.bytes(),
                seconds,
                back_s: travel_s(last, [0; 2]),
                pecks,
                before: before + done,
                part: number,
                is_first: done == skipped,
                is_last: done + holes == all,
            });
            done += holes;
        }
        before += all;
    }
    loads
}

/// The time estimate of the whole job.
pub(super) struct Estimate {
    /// Estimated seconds that have passed, and estimated seconds of the whole job.
    pub(super) behind_s: f64,
    pub(super) all_s: f64,
    /// Ratio of the real to the estimated time of a run.
    pub(super) pace: f64,
}

impl Estimate {
    /// Estimates the time of all these loads. `byte_s` is the time of a byte and its echo.
    pub(super) fn of(loads: &[Load], byte_s: f64) -> Self {
        let load_s = |load: &Load| {
            let drilling_s: f64 = load.seconds.iter().sum();
            drilling_s + load.back_s + byte_s * load.bytes.len() as f64
        };
        Self {
            behind_s: 0.0,
            all_s: loads.iter().map(load_s).sum(),
            pace: 1.0,
        }
    }

    pub(super) fn share(&self) -> f64 {
        self.behind_s / self.all_s.max(1e-9)
    }

    /// Remaining seconds after `passed_s` of the present run.
    pub(super) fn left_s(&self, passed_s: f64) -> f64 {
        (self.all_s - self.behind_s - passed_s).max(0.0) * self.pace
    }
}
