//! Start of a command after all previous motion: a move of the queue, an output, a pause.

use husillo_backlash::BacklashModel;
use husillo_gcode::{Command, SpindleDirection};
use husillo_interp::{Moves, Totals};
use husillo_planner::Timer;

use super::{Machine, Run};
use crate::lines::extension::Extension;
use crate::lines::kept::Kept;
use crate::lines::path_ramp::{MoveQueue, PathRamp};
use crate::lines::schedule::Figure;
use crate::{Event, MAX_WAIT_TICKS, Output, Pause, Segment};

impl<
    const N: usize,
    P: Moves<N>,
    L: BacklashModel<N>,
    const QUEUE: usize,
    E: Extension<N>,
    R: PathRamp,
> Machine<N, P, L, QUEUE, E, R>
{
    /// Begins the first move of the queue, if there is one.
    pub(super) fn begin_move(&mut self) -> Option<()> {
        let (stretch, work) = self.schedule.moves.front()?;
        let (stretch, events) = (*stretch, work.events);
        let segment = work.kept.segment(self.schedule.start());
        self.segment = Some(segment);
        let heading = work.heading;
        let percent = self.schedule.moves.percent();
        let ticks = self.guard.ticks(&work.pace, percent, events);
        self.guard
            .watch(work.figure != Figure::Straight, events, work.steady);
        if self.schedule.has_ramps() && stretch.length_nm != 0 {
            let sweeps = [work.sweep.max(1), work.largest_sweep.max(1).into()];
            let time_q16 = work.time_q16;
            self.ramp
                .begin(&stretch, sweeps, time_q16, &self.schedule.moves);
        } else if events == 0 {
            self.ramp.stop();
            self.carried_ticks = self.carried_ticks.saturating_add(ticks);
        }
        let timed = match work.follows {
            true => Some(work.time_q16),
            false => (!self.schedule.has_ramps()).then_some(ticks),
        };
        let is_indexed = work.is_indexed;
        let totals = (work.figure == Figure::Known).then_some(Totals {
            events,
            total_sweep: work.sweep,
            largest_sweep: work.largest_sweep,
        });
        // All moves before it have been made, so it begins where the load is.
        self.run = Some(Run {
            path: self
                .config
                .path_again(&segment, self.load, work.end, totals),
            timer: timed.map(|whole| Timer::new(whole, work.sweep, work.largest_sweep)),
            left: events,
            next: None,
            follows: work.follows,
        });
        if self.is_following() {
            self.signal([is_indexed.then_some(Event::Index), None]);
        }
        self.take_up.turn(&heading, self.load, &self.config);
        Some(())
    }

    /// Begins a command that is not a move; all moves before it have been made.
    pub(super) fn begin(&mut self, command: Command<N>) {
        let from = self.schedule.programmed();
        self.segment = Some(Segment { from, command });
        self.ramp.stop();
        self.guard.rest();
        self.schedule.end_thread();
        if E::IS_EXTENDED && self.begin_extended(&command) {
            return;
        }
        match command {
            Command::Dwell { micros } => {
                // A dwell of 2^64 us lasts half a million years, so saturating is acceptable.
                let ticks =
                    husillo_planner::mul_div(micros, u64::from(self.config.timer_hz), 1_000_000);
                self.carried_ticks = self.carried_ticks.saturating_add(ticks);
                self.flush_wait();
            }
            Command::Spindle {
                direction,
                milli_rpm,
            } => {
                self.signal([
                    Some(Event::Output(Output::Spindle {
                        direction,
                        milli_rpm,
                    })),
                    None,
                ]);
            }
            Command::Coolant { mist, flood } => {
                self.signal([Some(Event::Output(Output::Coolant { mist, flood })), None]);
            }
            Command::Heat {
                heater,
                milli_celsius,
                wait,
            } if E::IS_EXTENDED => {
                let output = Output::Heater {
                    heater,
                    milli_celsius,
                    wait,
                };
                self.signal([Some(Event::Output(output)), None]);
            }
            Command::Fan { number, per_mille } if E::IS_EXTENDED => {
                let output = Output::Fan { number, per_mille };
                self.signal([Some(Event::Output(output)), None]);
            }
            Command::MotorsOff if E::IS_EXTENDED => {
                self.signal([Some(Event::Output(Output::MotorsOff)), None]);
            }
            Command::Drill => self.signal([Some(Event::Output(Output::Drill)), None]),
            Command::Tool { number } => self.signal([
                Some(Event::Pause(Pause::ToolChange)),
                Some(Event::Output(Output::Tool { number })),
            ]),
            Command::Stop { optional: false } => {
                self.signal([Some(Event::Pause(Pause::Program)), None])
            }
            Command::Stop { optional: true } => {
                self.signal([Some(Event::Pause(Pause::Optional)), None])
            }
            Command::End { rewind } => {
                self.signals = safe();
                if let Some(last) = self.signals.last_mut() {
                    *last = Some(Event::Pause(Pause::End { rewind }));
                }
                self.flush_wait();
            }
            _ => {}
        }
    }

    /// Queues signals, which act when all preceding time has passed.
    pub(super) fn signal(&mut self, [first, second]: [Option<Event<N>>; 2]) {
        self.signals = [None, first, second, None];
        self.flush_wait();
    }

    /// Turns carried time into a separate wait. It is below [`MAX_WAIT_TICKS`], or the time of a
    /// dwell.
    fn flush_wait(&mut self) {
        let short = self.carried_ticks % u64::from(MAX_WAIT_TICKS);
        match self.signals.first_mut() {
            Some(first) if short > 0 => {
                self.carried_ticks = self.carried_ticks.wrapping_sub(short);
                *first = Some(Event::Dwell {
                    wait_ticks: short as u32,
                });
            }
            _ => {}
        }
    }
}

/// Spindle and coolant off.
pub(super) fn safe<const N: usize>() -> [Option<Event<N>>; 4] {
    [
        None,
        Some(Event::Output(Output::Spindle {
            direction: SpindleDirection::Off,
            milli_rpm: 0,
        })),
        Some(Event::Output(Output::Coolant {
            mist: false,
            flood: false,
        })),
        None,
    ]
}
