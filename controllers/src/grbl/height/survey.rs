//! The measurement of the map: the machine probes each point of the grid.

use husillo_gcode::{Command, Feed, Nm};
use husillo_transports::grbl::{Alarm, ErrorCode};

use super::super::lines::{Outcome, Task};
use super::super::motion::Tag;
use super::super::recovery::After;
use super::super::{Grbl, Phase};
use super::map::HEIGHTS;

/// A measurement in progress.
#[derive(Clone, Debug)]
pub(super) struct Survey {
    step: Step,
    /// Points that are measured.
    count: u16,
    /// Position of Z between the points, the way down from it, and the feed, in nanometres.
    clear: Nm,
    depth: i64,
    feed: Nm,
    /// Contact of the first point, in nanometres.
    first: i64,
    /// Heights above the first contact, in the order of the map.
    heights: [i32; HEIGHTS],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Off,
    ToPoint,
    Down,
    Up,
}

impl Survey {
    pub(super) const NONE: Survey = Survey {
        step: Step::Off,
        count: 0,
        clear: Nm(0),
        depth: 0,
        feed: Nm(0),
        first: 0,
        heights: [0; HEIGHTS],
    };

    pub(super) fn end(&mut self) {
        self.step = Step::Off;
    }

    const fn is_measuring(&self) -> bool {
        matches!(self.step, Step::Up)
    }
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Begins to measure the grid from the present height of Z, down by `depth` at most.
    ///
    /// # Errors
    /// Fails if a point or the way down is beyond the travel.
    pub(super) fn begin_survey(&mut self, depth: i64, feed: i64) -> Result<Outcome, ErrorCode> {
        let [_, _, clear] = self.machine.end_position();
        let lowest = Nm(clear.0.saturating_sub(depth));
        let map = self.memory.map;
        let [columns, rows] = map.points.map(|points| points.saturating_sub(1));
        for (column, row) in [(0, 0), (columns, rows)] {
            let (x, y) = (map.line_nm(0, column), map.line_nm(1, row));
            if self.leaves_travel(&[Nm(x), Nm(y), lowest]) {
                return Err(ErrorCode::Travel);
            }
        }
        self.height.survey = Survey {
            step: Step::ToPoint,
            clear,
            depth,
            feed: Nm(feed),
            ..Survey::NONE
        };
        self.tag = Tag::default();
        self.task = Task::Survey;
        Ok(Outcome::Waits)
    }

    /// Whether the present probe move measures the grid.
    pub(in super::super) const fn is_surveying(&self) -> bool {
        self.height.survey.is_measuring()
    }

    /// Continues when the previous motion has ended. Returns whether there may be more to do.
    pub(in super::super) fn continue_survey(&mut self) -> bool {
        if self.phase != Phase::Idle || !self.is_drained() {
            return false;
        }
        let Survey {
            step,
            count,
            clear,
            depth,
            feed,
            ..
        } = self.height.survey;
        let Some([x, y]) = self.survey_place(count) else {
            self.take_survey();
            return true;
        };
        match step {
            Step::ToPoint => {
                self.height.survey.step = Step::Down;
                self.append(Command::Rapid { to: [x, y, clear] });
            }
            Step::Down if self.is_probe_closed() => {
                self.height.survey.end();
                self.fail_probe(Alarm::ProbeInitial, false);
            }
            Step::Down => {
                self.height.survey.step = Step::Up;
                let to = [x, y, Nm(clear.0.saturating_sub(depth))];
                let feed = Feed::PerMinute(feed);
                self.begin_probe(Command::Linear { to, feed }, false, true);
            }
            Step::Up => {
                self.height.survey.step = Step::ToPoint;
                self.height.survey.count = count.saturating_add(1);
                self.append(Command::Rapid { to: [x, y, clear] });
            }
            Step::Off => self.end_line(Ok(Outcome::Done)),
        }
        true
    }

    /// Takes the contact of the present point.
    pub(in super::super) fn take_height(&mut self) {
        let Some(steps) = self.contact else {
            self.height.survey.end();
            return self.fail_probe(Alarm::ProbeContact, true);
        };
        self.probe = (self.position_of(steps).map(|nm| nm.0), true);
        self.report_probe();
        let ([_, _, z], _) = self.probe;
        let at = self.survey_point(self.height.survey.count);
        let survey = &mut self.height.survey;
        if survey.count == 0 {
            survey.first = z;
        }
        // A way down is below 2^31 nm.
        let height = z.saturating_sub(survey.first) as i32;
        if let Some(slot) = survey.heights.get_mut(at) {
            *slot = height;
        }
        self.task = Task::Survey;
    }

    /// Ends a probe move with an alarm. The line is answered.
    fn fail_probe(&mut self, alarm: Alarm, has_moved: bool) {
        self.drop_moves();
        self.task = Task::ProbeFailed { has_moved };
        self.alarm(alarm, After::GoOn);
    }

    /// Ends the measurement: its heights are those of the map.
    fn take_survey(&mut self) {
        self.height.survey.end();
        self.memory.map.heights = self.height.survey.heights;
        self.store();
        let position: [Nm; 3] = self.machine.end_position();
        self.modal.set_position(position);
        self.end_line(Ok(Outcome::Done));
    }

    /// Returns the number in the map of the point that is measured as number `count`. Every second
    /// row is measured in the other direction.
    fn survey_point(&self, count: u16) -> usize {
        let columns = u16::from(self.memory.map.points[0]);
        let row = count.checked_div(columns).unwrap_or(0);
        let column = count.checked_rem(columns).unwrap_or(0);
        let column = if row.is_multiple_of(2) {
            column
        } else {
            columns.saturating_sub(column).saturating_sub(1)
        };
        usize::from(row.wrapping_mul(columns).wrapping_add(column)) // below 256
    }

    /// Returns the place of the point that is measured as number `count`, or `None` behind the
    /// last.
    fn survey_place(&self, count: u16) -> Option<[Nm; 2]> {
        let map = &self.memory.map;
        let [columns, _] = map.points;
        if usize::from(count) >= map.count() {
            return None;
        }
        let point = self.survey_point(count) as u8; // below 256
        let (row, column) = (point.checked_div(columns)?, point.checked_rem(columns)?);
        Some([Nm(map.line_nm(0, column)), Nm(map.line_nm(1, row))])
    }
}
