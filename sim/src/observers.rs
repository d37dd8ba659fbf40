//! Observers of a simulated run, and the state of the machine that they receive after each step.
//!
//! They compare the motion of the tool with the programmed path, which the simulated machine does
//! not know.

pub mod deviation;
pub mod drawing;
pub mod encoders;
pub mod largest;
pub mod losses;
pub mod moves;
mod pace;
pub mod phases;
pub mod picture;
pub mod recording;
pub mod speed;
pub mod statistics;
pub mod symmetry;
pub mod trace;

use crate::geometry::path::Path;
use husillo_gcode::Nm;
use husillo_machine::{Origin, Segment, StepEvent};
use husillo_stepper::Levels;
use std::io;

/// The most axes of a machine that is observed. Axes that a machine does not have stand at zero.
pub const AXES: usize = 6;

/// A step, and the state of the machine after it.
#[derive(Clone, Copy, Debug)]
pub struct Now<'a> {
    /// The step that was made.
    pub step: &'a StepEvent<AXES>,
    /// The kind of motion that it belongs to.
    pub origin: Origin,
    /// Whether it begins a move or a take-up, or follows a take-up.
    pub is_turn: bool,
    /// Whether it begins the take-up of an axis.
    pub begins_take_up: bool,
    /// Number of the step event, from 1.
    pub event: u64,
    /// Timer ticks from the start.
    pub ticks: u64,
    /// Position of the tool, steps.
    pub tool: [i32; AXES],
    /// Position of the tool, nm of the machine frame; of a rotary axis millionths of a degree.
    pub tool_nm: [f64; AXES],
    /// Commanded position, steps.
    pub sent: [i32; AXES],
    /// Inputs of the drivers.
    pub levels: &'a [Levels; AXES],
}

impl Now<'_> {
    /// Position of the tool in X, Y and Z, nm of the machine frame.
    #[inline]
    pub const fn place(&self) -> [f64; 3] {
        let [x, y, z, ..] = self.tool_nm;
        [x, y, z]
    }
}

/// A programmed move that begins.
#[derive(Clone, Copy, Debug)]
pub struct Begun<'a> {
    /// Its start and its command.
    pub segment: &'a Segment<AXES>,
    /// Its end in the machine frame.
    pub to: [Nm; AXES],
    /// Its exact path in X, Y and Z.
    pub path: &'a Path,
    /// Programmed spindle speed in thousandths of a turn per minute; 0 if the spindle is off.
    pub milli_rpm: u64,
}

/// Observes a run. Its methods are called in the order of the events.
pub trait Observer {
    /// A programmed move begins. The next step is its first, or belongs to a take-up before it.
    fn begin(&mut self, _begun: &Begun<'_>) {}

    /// A step was made.
    ///
    /// # Errors
    ///
    /// The output of the observer cannot be written.
    fn step(&mut self, now: &Now<'_>) -> io::Result<()>;

    /// The machine has waited. `ticks` is the time at the end of the wait, from the start of the
    /// run.
    fn dwell(&mut self, _ticks: u64) {}

    /// The run has ended.
    ///
    /// # Errors
    ///
    /// The output of the observer cannot be written.
    fn finish(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// An optional observer.
impl<O: Observer> Observer for Option<O> {
    fn begin(&mut self, begun: &Begun<'_>) {
        if let Some(observer) = self {
            observer.begin(begun);
        }
    }

    #[inline]
    fn step(&mut self, now: &Now<'_>) -> io::Result<()> {
        match self {
            Some(observer) => observer.step(now),
            None => Ok(()),
        }
    }

    fn dwell(&mut self, ticks: u64) {
        if let Some(observer) = self {
            observer.dwell(ticks);
        }
    }

    fn finish(&mut self) -> io::Result<()> {
        self.as_mut().map_or(Ok(()), Observer::finish)
    }
}

/// An observer of another crate.
impl<O: Observer + ?Sized> Observer for Box<O> {
    fn begin(&mut self, begun: &Begun<'_>) {
        (**self).begin(begun);
    }

    fn step(&mut self, now: &Now<'_>) -> io::Result<()> {
        (**self).step(now)
    }

    fn dwell(&mut self, ticks: u64) {
        (**self).dwell(ticks);
    }

    fn finish(&mut self) -> io::Result<()> {
        (**self).finish()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A step of X, 1000 ticks after the one before.
    pub const STEP: StepEvent<AXES> = StepEvent {
        wait_ticks: 1000,
        delta: [1, 0, 0, 0, 0, 0],
    };

    /// The machine after step number `event` of a feed along X, with 1 um and 1000 ticks per step.
    /// Tests change the fields that they are about.
    pub fn now(event: u64) -> Now<'static> {
        let tool = [event as i32, 0, 0, 0, 0, 0];
        Now {
            step: &STEP,
            origin: Origin::Feed,
            is_turn: event == 1,
            begins_take_up: false,
            event,
            ticks: 1000 * event,
            tool,
            tool_nm: tool.map(|steps| 1000.0 * f64::from(steps)),
            sent: tool,
            levels: &[Levels(0); AXES],
        }
    }

    /// Counts its calls.
    #[derive(Default)]
    struct Counter([u32; 4]);

    impl Observer for Counter {
        fn begin(&mut self, _: &Begun<'_>) {
            self.0[0] += 1;
        }

        fn step(&mut self, _: &Now<'_>) -> io::Result<()> {
            self.0[1] += 1;
            Ok(())
        }

        fn dwell(&mut self, _: u64) {
            self.0[2] += 1;
        }

        fn finish(&mut self) -> io::Result<()> {
            self.0[3] += 1;
            Ok(())
        }
    }

    #[test]
    fn an_optional_observer_gets_all_calls() {
        let mut observer = Some(Counter::default());
        let segment = line(Nm(1000));
        let path = Path::line([0.0; 3], [1000.0, 0.0, 0.0]);
        observer.begin(&begun(&segment, &path));
        observer.step(&now(1)).unwrap();
        observer.dwell(1000);
        observer.finish().unwrap();
        assert_eq!(observer.unwrap().0, [1; 4]);
    }

    /// A feed along X from zero, at 60 mm/min.
    pub fn line(to: Nm) -> Segment<AXES> {
        Segment {
            from: [Nm(0); AXES],
            command: husillo_gcode::Command::Linear {
                to: [to, Nm(0), Nm(0), Nm(0), Nm(0), Nm(0)],
                feed: husillo_gcode::Feed::PerMinute(Nm(60_000_000)),
            },
        }
    }

    /// A move without a spindle.
    pub fn begun<'a>(segment: &'a Segment<AXES>, path: &'a Path) -> Begun<'a> {
        Begun {
            segment,
            to: segment.command.end().unwrap(),
            path,
            milli_rpm: 0,
        }
    }
}
