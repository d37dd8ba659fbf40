//! When the lines of a program are made, by the simulation.

use husillo_sim::observers::recording::{Kind, Recorded};

/// Times of the lines of a program.
#[derive(Clone, Debug)]
pub struct Timetable {
    /// For each line number, from 0: the time in s at its end, and the part of it in rapids.
    ends: Vec<[f64; 2]>,
}

impl Timetable {
    /// The times of these moves, each with its line. A time without a move, such as a dwell,
    /// belongs to the line of the move before it.
    pub fn new(moves: &[Recorded], lines: &[u32], timer_hz: u32, total_s: f64) -> Self {
        let in_s = |ticks: u64| ticks as f64 / f64::from(timer_hz);
        let mut ends = vec![[0.0; 2]];
        let mut rapids = 0.0;
        for (one, line) in moves.iter().zip(lines) {
            if one.kind == Kind::Rapid {
                rapids += in_s(one.ticks[1].saturating_sub(one.ticks[0]));
            }
            let line = *line as usize;
            let last = ends.last().copied().unwrap_or_default();
            if line >= ends.len() {
                ends.resize(line + 1, last);
            }
            let end = in_s(one.ticks[1]).max(last[0]);
            // A move of a subroutine, line 0, belongs to the last line before it.
            if let Some(slot) = ends.last_mut() {
                *slot = [end, rapids];
            }
        }
        if let Some(last) = ends.last().copied() {
            ends.push([total_s.max(last[0]), last[1]]);
        }
        Self { ends }
    }

    /// The whole time, s.
    pub fn total_s(&self) -> f64 {
        self.ends.last().map_or(0.0, |end| end[0])
    }

    /// The time at the end of a line, s.
    pub fn end_s(&self, line: usize) -> f64 {
        self.at(line)[0]
    }

    /// The line that is made at this time, s.
    pub fn line_at(&self, s: f64) -> usize {
        let line = self.ends.partition_point(|end| end[0] <= s);
        line.min(self.ends.len().saturating_sub(1))
    }

    /// The time in s that is left after `done_s` of simulated time, while a line is made, at these
    /// overrides of feeds and rapids in percent.
    pub fn left_s(&self, line: usize, done_s: f64, feed: f64, rapid: f64) -> f64 {
        let (at, end) = (self.at(line), self.at(usize::MAX));
        let left = (end[0] - at[0], end[1] - at[1]);
        let share = if left.0 > 0.0 { left.1 / left.0 } else { 0.0 };
        let scale = share * 100.0 / rapid + (1.0 - share) * 100.0 / feed;
        (self.total_s() - done_s).max(0.0) * scale
    }

    fn at(&self, line: usize) -> [f64; 2] {
        let last = self.ends.len().saturating_sub(1);
        self.ends.get(line.min(last)).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use husillo_sim::observers::recording::Shape;

    fn recorded(kind: Kind, ticks: [u64; 2]) -> Recorded {
        Recorded {
            kind,
            from: [0; 6],
            to: [0; 6],
            shape: Shape::Line,
            ticks,
            feed: 0,
            milli_rpm: 0,
        }
    }

    #[test]
    fn what_is_left_is_scaled_by_the_overrides() {
        let moves = [
            recorded(Kind::Rapid, [0, 1000]),
            recorded(Kind::Feed, [1000, 3000]),
            recorded(Kind::Feed, [3000, 5000]),
        ];
        let times = Timetable::new(&moves, &[2, 3, 5], 1000, 6.0);
        assert_eq!(
            [1, 2, 3, 4, 5, 6].map(|line| times.end_s(line)),
            [0.0, 1.0, 3.0, 3.0, 5.0, 6.0]
        );
        assert_eq!(times.total_s(), 6.0);
        assert_eq!(
            [0.0, 0.9, 1.0, 4.0, 9.0].map(|s| times.line_at(s)),
            [2, 2, 3, 5, 6]
        );
        assert_eq!(times.left_s(3, 3.0, 100.0, 100.0), 3.0);
        assert_eq!(times.left_s(3, 3.0, 200.0, 25.0), 1.5);
        // One of the six seconds is a rapid.
        assert_eq!(times.left_s(0, 0.0, 100.0, 50.0), 7.0);
    }
}
