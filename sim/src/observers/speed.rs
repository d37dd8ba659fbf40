//! Path speed and acceleration over time, measured from the events. They are kept in a fixed number
//! of columns.
//!
//! The tool moves in whole steps, so its speed is meaningful only over a window. A window has at
//! least [`WINDOW_EVENTS`] events. If the machine has ramps, a window is also long enough for an
//! error of one step to change the measured acceleration by at most a twentieth. The length of a
//! window is a sum of chords. A chord on an arc counts as its arc.

/// Least number of events of a window. One step is then 3 % of its length.
pub const WINDOW_EVENTS: u32 = 32;
/// At the end of a motion, a window with fewer events joins the one before.
const LEAST_EVENTS: u32 = 16;
/// A move with fewer events does not end a chord. Otherwise the staircase of its steps would be
/// measured instead of the path.
const LEAST_MOVE_EVENTS: u32 = 8;
/// Number of columns: one or two per pixel of the picture.
const COLUMNS: usize = 2048;

/// Smallest and largest of several values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Smallest.
    pub low: f32,
    /// Largest; below `low` without any value.
    pub high: f32,
}

impl Band {
    const EMPTY: Self = Self {
        low: f32::INFINITY,
        high: f32::NEG_INFINITY,
    };

    /// Whether there is no value.
    pub fn is_empty(self) -> bool {
        self.high < self.low
    }

    /// The smallest band that contains both.
    pub fn with(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    fn of(value: f64) -> Self {
        Self {
            low: value as f32,
            high: value as f32,
        }
    }
}

/// The motion in one interval of time.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Path speed of rapid moves, nm/s.
    pub rapid: Band,
    /// Path speed of feed moves, nm/s.
    pub feed: Band,
    /// Programmed feed, nm/s.
    pub programmed: Band,
    /// Acceleration along the path, nm/s^2.
    pub acceleration: Band,
    /// Jerk along the path, nm/s^3.
    pub jerk: Band,
    /// Whether backlash was taken up.
    pub take_up: bool,
    /// Whether there was a dwell.
    pub dwell: bool,
}

impl Column {
    const EMPTY: Self = Self {
        rapid: Band::EMPTY,
        feed: Band::EMPTY,
        programmed: Band::EMPTY,
        acceleration: Band::EMPTY,
        jerk: Band::EMPTY,
        take_up: false,
        dwell: false,
    };

    fn with(self, other: Self) -> Self {
        Self {
            rapid: self.rapid.with(other.rapid),
            feed: self.feed.with(other.feed),
            programmed: self.programmed.with(other.programmed),
            acceleration: self.acceleration.with(other.acceleration),
            jerk: self.jerk.with(other.jerk),
            take_up: self.take_up || other.take_up,
            dwell: self.dwell || other.dwell,
        }
    }
}

/// Why the tool stands still.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// Backlash is taken up.
    TakeUp,
    /// A dwell, or a wait longer than one event can hold.
    Dwell,
}

/// The circle of an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Axes of its plane.
    pub plane: [usize; 2],
    /// Its radius, nm.
    pub radius: f64,
}

/// The properties of a move that its speed depends on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Move {
    /// `None` for a straight move.
    pub circle: Option<Circle>,
    /// Programmed speed along the path in nm/s; `None` for a rapid.
    pub programmed: Option<f64>,
}

#[derive(Clone, Copy, Debug)]
struct Window {
    begin: u64,
    end: u64,
    events: u32,
    length: f64,
    is_feed: bool,
}

/// Measures the speed of a run.
#[derive(Clone, Debug)]
pub struct Speed {
    timer_hz: f64,
    least_ticks: u64,
    columns: Vec<Column>,
    column_ticks: u64,
    now: u64,
    at: [f64; 3],
    on: Move,
    /// Time up to which the programmed feed is recorded in the columns.
    since: u64,
    /// The current window; `None` while the tool stands still.
    window: Option<Window>,
    chord: [f64; 3],
    chord_events: u32,
    /// Events of the move in earlier chords.
    ended_events: u32,
    /// The last full window. A short window at the end may still join it.
    full: Option<Window>,
    /// Middle and speed of the window before that.
    before: Option<(f64, f64)>,
    /// Middle and value of the last acceleration.
    accelerated: Option<(f64, f64)>,
}

impl Speed {
    /// Starts at rest at zero. `acceleration` is the largest of all axes in steps/s^2, if there are
    /// ramps.
    pub fn new(timer_hz: u32, acceleration: Option<u32>) -> Self {
        let hz = f64::from(timer_hz);
        // Each of three positions has an error of at most half a step. The error of the
        // acceleration, 2 steps / t^2, is then a twentieth of it.
        let seconds = acceleration.map_or(0.0, |a| (40.0 / f64::from(a.max(1))).sqrt());
        Self {
            timer_hz: hz,
            least_ticks: (seconds * hz) as u64,
            columns: vec![Column::EMPTY; COLUMNS],
            column_ticks: 1,
            now: 0,
            at: [0.0; 3],
            on: Move::default(),
            since: 0,
            window: None,
            chord: [0.0; 3],
            chord_events: 0,
            ended_events: 0,
            full: None,
            before: None,
            accelerated: None,
        }
    }

    /// Takes a step of the tool to `at`, in nm, at `now` ticks.
    #[inline]
    pub fn advance(&mut self, now: u64, at: &[f64; 3]) {
        let Some(window) = &mut self.window else {
            self.start();
            return self.advance(now, at);
        };
        window.events += 1;
        self.chord_events += 1;
        (self.now, self.at) = (now, *at);
        if self.chord_events >= WINDOW_EVENTS {
            let is_full = window.events >= WINDOW_EVENTS && now - window.begin >= self.least_ticks;
            self.end_chord();
            if is_full {
                self.end_window();
            }
        }
    }

    /// A new move begins at the present position.
    pub fn turn(&mut self, to: Move) {
        if to == self.on {
            return;
        }
        if self.chord_events + self.ended_events >= LEAST_MOVE_EVENTS {
            self.end_chord();
            self.ended_events = 0;
        }
        self.record_programmed();
        self.on = to;
        if let Some(window) = &mut self.window {
            let is_feed = to.programmed.is_some();
            if is_feed != window.is_feed {
                if window.events >= LEAST_MOVE_EVENTS {
                    self.end_window();
                } else {
                    window.is_feed = is_feed;
                }
            }
        }
    }

    /// The tool stands still until `now`.
    pub fn stand(&mut self, now: u64, stop: Stop) {
        self.rest();
        self.cover(self.now, now, |column| match stop {
            Stop::TakeUp => column.take_up = true,
            Stop::Dwell => column.dwell = true,
        });
        (self.now, self.since) = (now, now);
    }

    /// The tool stops here, for any time.
    pub fn rest(&mut self) {
        self.end_chord();
        self.record_programmed();
        let last = match (self.full.take(), self.window.take()) {
            (Some(full), Some(rest))
                if rest.events < LEAST_EVENTS && rest.is_feed == full.is_feed =>
            {
                Some(Window {
                    end: self.now,
                    events: full.events + rest.events,
                    length: full.length + rest.length,
                    ..full
                })
            }
            (full, rest) => {
                if let Some(full) = full {
                    self.record(full);
                }
                rest.filter(|rest| rest.events > 0).map(|rest| Window {
                    end: self.now,
                    ..rest
                })
            }
        };
        if let Some(last) = last {
            self.record(last);
        }
        if let Some((middle, speed)) = self.before.take() {
            self.accelerate(middle, speed, self.now as f64, 0.0);
        }
        self.accelerated = None;
    }

    /// The columns so far, and the seconds per column.
    pub fn columns(&self) -> (&[Column], f64) {
        let used = usize::try_from(self.now.div_ceil(self.column_ticks)).unwrap_or(COLUMNS);
        (
            self.columns.get(..used.clamp(1, COLUMNS)).unwrap_or(&[]),
            self.column_ticks as f64 / self.timer_hz,
        )
    }

    /// Seconds so far.
    pub fn seconds(&self) -> f64 {
        self.now as f64 / self.timer_hz
    }

    /// Least duration of a window, s; 0 if only its events count.
    pub fn least_seconds(&self) -> f64 {
        self.least_ticks as f64 / self.timer_hz
    }

    #[cold]
    fn start(&mut self) {
        self.window = Some(Window {
            begin: self.now,
            end: self.now,
            events: 0,
            length: 0.0,
            is_feed: self.on.programmed.is_some(),
        });
        (self.chord, self.chord_events) = (self.at, 0);
    }

    /// Adds the path since the last chord to the window.
    fn end_chord(&mut self) {
        if let Some(window) = &mut self.window {
            window.length += length(self.chord, self.at, self.on.circle);
        }
        self.ended_events = self.ended_events.saturating_add(self.chord_events);
        (self.chord, self.chord_events) = (self.at, 0);
    }

    fn end_window(&mut self) {
        if let Some(full) = self.full.take() {
            self.record(full);
        }
        self.full = self.window.take().map(|window| Window {
            end: self.now,
            ..window
        });
        self.start();
    }

    fn record(&mut self, window: Window) {
        let ticks = window.end - window.begin;
        if ticks == 0 {
            return;
        }
        let speed = window.length * self.timer_hz / ticks as f64;
        self.cover(window.begin, window.end, |column| {
            let band = if window.is_feed {
                &mut column.feed
            } else {
                &mut column.rapid
            };
            *band = band.with(Band::of(speed));
        });
        let middle = 0.5 * (window.begin as f64 + window.end as f64);
        let (since, from) = self.before.unwrap_or((window.begin as f64, 0.0));
        self.accelerate(since, from, middle, speed);
        self.before = Some((middle, speed));
    }

    fn record_programmed(&mut self) {
        if let Some(programmed) = self.on.programmed {
            self.cover(self.since, self.now, |column| {
                column.programmed = column.programmed.with(Band::of(programmed));
            });
        }
        self.since = self.now;
    }

    fn accelerate(&mut self, since: f64, from: f64, until: f64, to: f64) {
        let value = (to - from) * self.timer_hz / (until - since).max(1.0);
        let middle = 0.5 * (since + until);
        if let Some((before, last)) = self.accelerated.replace((middle, value)) {
            let jerk = Band::of((value - last) * self.timer_hz / (middle - before).max(1.0));
            self.cover(before as u64, middle as u64, |column| {
                column.jerk = column.jerk.with(jerk);
            });
        }
        let acceleration = Band::of(value);
        self.cover(since as u64, until as u64, |column| {
            column.acceleration = column.acceleration.with(acceleration);
        });
    }

    /// Changes every column that overlaps the time from `begin` to `end`.
    fn cover(&mut self, begin: u64, end: u64, change: impl Fn(&mut Column)) {
        if end <= begin {
            return;
        }
        while end > self.column_ticks * COLUMNS as u64 {
            self.fold();
        }
        let first = (begin / self.column_ticks) as usize;
        let last = ((end - 1) / self.column_ticks) as usize;
        for column in self.columns.iter_mut().take(last + 1).skip(first) {
            change(column);
        }
    }

    /// Merges pairs of columns, which frees half of them.
    #[cold]
    fn fold(&mut self) {
        for index in 0..COLUMNS / 2 {
            self.columns[index] = self.columns[2 * index].with(self.columns[2 * index + 1]);
        }
        self.columns[COLUMNS / 2..].fill(Column::EMPTY);
        self.column_ticks *= 2;
    }
}

/// Length of the path between two points on it.
fn length(from: [f64; 3], to: [f64; 3], circle: Option<Circle>) -> f64 {
    let square = |axis: usize| (to[axis] - from[axis]).powi(2);
    let Some(Circle { plane, radius }) = circle else {
        return (square(0) + square(1) + square(2)).sqrt();
    };
    let chord = (square(plane[0]) + square(plane[1])).sqrt();
    let across = square(3 - plane[0] - plane[1]);
    let part = (0.5 * chord / radius.max(1.0)).min(1.0);
    let arc = 2.0 * radius.max(1.0) * part.asin();
    (arc * arc + across).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight(speed: &mut Speed, steps: u64, wait: u64) {
        for _ in 0..steps {
            let at = [speed.at[0] + 1000.0, 0.0, 0.0];
            speed.advance(speed.now + wait, &at);
        }
    }

    const FEED: Move = Move {
        circle: None,
        programmed: Some(1e6),
    };

    #[test]
    fn constant_speed_is_measured_as_constant() {
        let mut speed = Speed::new(1_000_000, None);
        speed.turn(FEED);
        straight(&mut speed, 5000, 1000);
        speed.rest();
        let (columns, _) = speed.columns();
        let band = columns
            .iter()
            .fold(Band::EMPTY, |band, c| band.with(c.feed));
        assert!(
            (band.low - 1e6).abs() < 1.0 && (band.high - 1e6).abs() < 1.0,
            "{band:?}"
        );
        assert!(columns.iter().all(|c| !c.take_up && c.rapid.is_empty()));
    }

    #[test]
    fn corners_do_not_shorten_the_path() {
        let mut speed = Speed::new(1_000_000, None);
        let mut at = [0.0; 3];
        for leg in 0..40_u32 {
            speed.turn(Move {
                programmed: Some(1e6 + f64::from(leg)),
                ..FEED
            });
            for _ in 0..103 {
                at[(leg % 2) as usize] += 1000.0;
                speed.advance(speed.now + 1000, &at);
            }
        }
        speed.rest();
        let (columns, _) = speed.columns();
        let band = columns
            .iter()
            .fold(Band::EMPTY, |band, c| band.with(c.feed));
        assert!(
            (band.low - 1e6).abs() < 1.0 && (band.high - 1e6).abs() < 1.0,
            "{band:?}"
        );
    }

    #[test]
    fn stops_are_recorded_and_memory_is_bounded() {
        let mut speed = Speed::new(1_000_000, Some(1000));
        speed.turn(FEED);
        for k in 0..2000 {
            straight(&mut speed, 500, 10 + k % 7);
            speed.stand(speed.now + 20_000, Stop::TakeUp);
        }
        speed.stand(speed.now + 100_000_000, Stop::Dwell);
        let (columns, seconds) = speed.columns();
        assert_eq!(speed.columns.len(), COLUMNS);
        assert!(columns.len() > COLUMNS / 2);
        assert!((columns.len() as f64 * seconds - speed.seconds()).abs() <= seconds);
        assert!(columns[0].take_up && columns.last().is_some_and(|c| c.dwell && c.feed.is_empty()));
    }

    #[test]
    fn a_ramp_has_its_acceleration() {
        let mut speed = Speed::new(1_000_000, Some(1000));
        speed.turn(FEED);
        // 1000 steps/s^2 with steps of 1 um: s = t^2 / 2 gives the time of each step.
        for step in 1..=5000_u64 {
            let now = (2.0 * step as f64 / 1000.0).sqrt() * 1e6;
            speed.advance(now as u64, &[1000.0 * step as f64, 0.0, 0.0]);
        }
        let (columns, _) = speed.columns();
        let band = columns
            .iter()
            .fold(Band::EMPTY, |band, c| band.with(c.acceleration));
        assert!(band.low > 0.93e6 && band.high < 1.07e6, "{band:?}");
    }

    #[test]
    fn a_constant_jerk_is_measured() {
        let mut speed = Speed::new(1_000_000, Some(1000));
        speed.turn(FEED);
        // 10,000 steps/s^3 with steps of 1 um: s = j t^3 / 6 gives the time of each step.
        for step in 1..=20_000_u64 {
            let now = (6.0 * step as f64 / 10_000.0).cbrt() * 1e6;
            speed.advance(now as u64, &[1000.0 * step as f64, 0.0, 0.0]);
        }
        let (columns, _) = speed.columns();
        // At the start a window is longer than the speed is constant.
        let columns = &columns[columns.len() / 4..];
        let band = columns
            .iter()
            .fold(Band::EMPTY, |band, c| band.with(c.jerk));
        assert!(band.low > 0.7e7 && band.high < 1.3e7, "{band:?}");
    }

    #[test]
    fn small_circles_have_their_full_length() {
        let mut speed = Speed::new(1_000_000, None);
        let circle = Circle {
            plane: [0, 1],
            radius: 30_000.0,
        };
        speed.at = [30_000.0, 0.0, 0.0];
        speed.turn(Move {
            circle: Some(circle),
            ..FEED
        });
        for k in 1..=1000_u32 {
            let angle = f64::from(k) * 0.04;
            let at = [30_000.0 * angle.cos(), 30_000.0 * angle.sin(), 0.0];
            speed.advance(u64::from(k) * 1200, &at);
        }
        let (columns, _) = speed.columns();
        let band = columns
            .iter()
            .fold(Band::EMPTY, |band, c| band.with(c.feed));
        assert!(
            (band.low - 1e6).abs() < 10.0 && (band.high - 1e6).abs() < 10.0,
            "{band:?}"
        );
    }
}
