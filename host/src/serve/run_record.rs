//! What became of a program on a machine, for its report.

use super::loaded::Loaded;
use super::machine::ReportPage;
use husillo_reports::operation::Operation;
use husillo_reports::text::duration;
use jiff::Timestamp;
use std::sync::Arc;
use std::time::Instant;

/// Events that are kept.
const MOST_EVENTS: usize = 1000;

/// A run of a program.
#[derive(Clone, Debug)]
pub struct RunRecord {
    /// The program.
    pub program: Arc<Loaded>,
    /// The line at which it was started, if not at the first one.
    from: Option<usize>,
    begun: Timestamp,
    begun_at: Instant,
    ended: Timestamp,
    /// Time from start to end, and time of motion, s.
    seconds: [f64; 2],
    /// How it has ended.
    result: String,
    /// Lines that the controller has accepted, and all that it was to get.
    lines: [usize; 2],
    stops: usize,
    alarms: usize,
    /// Seconds from the start, and what happened.
    events: Vec<(f64, String)>,
    further: usize,
}

impl RunRecord {
    /// A run that begins now.
    pub fn new(program: Arc<Loaded>, from: Option<usize>) -> Self {
        Self {
            program,
            from,
            begun: Timestamp::now(),
            begun_at: Instant::now(),
            ended: Timestamp::now(),
            seconds: [0.0; 2],
            result: String::new(),
            lines: [0; 2],
            stops: 0,
            alarms: 0,
            events: Vec::new(),
            further: 0,
        }
    }

    /// Something has happened.
    pub fn event(&mut self, what: impl Into<String>) {
        match self.events.len() < MOST_EVENTS {
            true => (self.events).push((self.begun_at.elapsed().as_secs_f64(), what.into())),
            false => self.further += 1,
        }
    }

    /// A hold or a STOP.
    pub fn stop(&mut self, what: impl Into<String>) {
        self.stops += 1;
        self.event(what);
    }

    /// An alarm.
    pub fn alarm(&mut self, what: impl Into<String>) {
        self.alarms += 1;
        self.event(what);
    }

    /// The run has ended like this, after lines of all lines, with this time of motion in s.
    pub fn end(&mut self, result: &str, lines: [usize; 2], moved_s: f64) {
        self.ended = Timestamp::now();
        self.seconds = [self.begun_at.elapsed().as_secs_f64(), moved_s];
        self.lines = lines;
        result.clone_into(&mut self.result);
        self.event(result);
    }

    /// The name of the file of its report.
    pub fn file_name(&self) -> String {
        ReportPage::name_of(&self.program.name, self.begun)
    }

    /// As a report has it.
    pub fn operation(&self) -> Operation {
        let utc = |time: Timestamp| time.strftime("%Y-%m-%d %H:%M:%S UTC").to_string();
        let [made, all] = self.lines;
        let (what, from) = match (&self.program.holes, &self.program.figure) {
            (Some(_), _) => ("holes drilled", "from hole"),
            (_, Some(_)) => ("moves cut", "from move"),
            (None, None) => ("lines accepted", "from line"),
        };
        let mut figures = vec![
            ("started", utc(self.begun)),
            ("ended", utc(self.ended)),
            ("duration", duration(self.seconds[0])),
            ("in motion", duration(self.seconds[1])),
            (what, format!("{made} of {all}")),
            ("stops", self.stops.to_string()),
            ("alarms", self.alarms.to_string()),
            ("result", self.result.clone()),
        ];
        if let Some(number) = self.from {
            figures.insert(0, (from, number.to_string()));
        }
        let events = self.events.iter();
        Operation {
            figures,
            events: events
                .map(|(s, what)| (duration(*s), what.clone()))
                .collect(),
            further: self.further,
        }
    }
}
