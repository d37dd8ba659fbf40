//! Replaces events that wait for the spindle by events that wait for the clock. A simulated spindle
//! gives the times.

use husillo_gcode::SpindleDirection;
use husillo_machine::{Event, FollowEvent, MAX_WAIT_TICKS, Output, StepEvent};
use husillo_sim::Spindle;
use husillo_sim::observers::AXES;
use std::io;

/// The simulated spindle of a machine whose moves can follow it.
#[derive(Debug)]
pub struct Turning {
    spindle: Spindle,
    counts_per_turn: f64,
    timer_hz: f64,
    /// Ticks since the last update of the spindle.
    passed: u64,
    /// Turns of the spindle at which the last event was due.
    due: f64,
    is_following: bool,
    is_on: bool,
}

impl Turning {
    /// A spindle at rest.
    pub fn new(counts_per_turn: u32, timer_hz: u32) -> Self {
        Self {
            spindle: Spindle::new(counts_per_turn, timer_hz),
            counts_per_turn: f64::from(counts_per_turn),
            timer_hz: f64::from(timer_hz),
            passed: 0,
            due: 0.0,
            is_following: false,
            is_on: false,
        }
    }

    /// Converts an event to one that waits for the clock.
    ///
    /// # Errors
    ///
    /// A move follows a spindle that is at rest or turns too slowly.
    pub fn timed(&mut self, event: &Event<AXES>) -> io::Result<Event<AXES>> {
        match *event {
            Event::Follow(FollowEvent {
                wait_counts_q16,
                delta,
                // The encoder counts up in both directions, so waits need no direction.
                turns_back: _,
            }) => {
                if !self.is_following {
                    self.catch_up();
                    self.due = self.spindle.turns();
                    self.is_following = true;
                }
                self.due += f64::from(wait_counts_q16) / 65536.0 / self.counts_per_turn;
                let wait_ticks = self.wait()?;
                Ok(if delta == [0; AXES] {
                    Event::Dwell { wait_ticks }
                } else {
                    Event::Step(StepEvent { wait_ticks, delta })
                })
            }
            Event::Index => {
                self.catch_up();
                self.due = self.spindle.turns().floor() + 1.0;
                self.is_following = true;
                Ok(Event::Dwell {
                    wait_ticks: self.wait()?,
                })
            }
            Event::Step(StepEvent { wait_ticks, .. }) | Event::Dwell { wait_ticks } => {
                self.passed += u64::from(wait_ticks);
                self.is_following = false;
                Ok(*event)
            }
            Event::Output(Output::Spindle {
                direction,
                milli_rpm,
            }) => {
                self.catch_up();
                self.is_on = direction != SpindleDirection::Off && milli_rpm > 0;
                // The encoder counts up in both directions.
                self.spindle.set_target_rpm(match direction {
                    SpindleDirection::Off => 0.0,
                    _ => milli_rpm as f64 / 1000.0,
                });
                Ok(*event)
            }
            _ => Ok(*event),
        }
    }

    fn catch_up(&mut self) {
        // At most 10 ms at a time and 10 s in all. The spindle has reached its speed by then.
        let step = (self.timer_hz / 100.0) as u64 + 1;
        let mut left = self.passed.min(1000 * step);
        while left > 0 {
            let part = left.min(step);
            self.spindle.advance(part as u32);
            left -= part;
        }
        self.passed = 0;
    }

    /// Turns the spindle until the event is due. Returns the ticks that this takes.
    fn wait(&mut self) -> io::Result<u32> {
        let longest = (self.timer_hz / 1000.0).max(1.0);
        let mut ticks = 0_u64;
        while self.spindle.turns() < self.due {
            if !self.is_on && self.spindle.rpm() < 0.1 {
                return Err(io::Error::other(
                    "a move follows the spindle, but the spindle does not turn",
                ));
            }
            let ticks_a_turn = 60.0 * self.timer_hz / self.spindle.rpm().max(1e-3);
            let left = (self.due - self.spindle.turns()) * ticks_a_turn;
            let part = left.floor().clamp(1.0, longest) as u32;
            self.spindle.advance(part);
            ticks += u64::from(part);
            if ticks > u64::from(MAX_WAIT_TICKS) {
                return Err(io::Error::other(
                    "a move follows the spindle, but the spindle turns too slowly",
                ));
            }
        }
        Ok(ticks as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_follow_the_spindle() {
        let mut turning = Turning::new(1000, 1_000_000);
        let on = Event::Output(Output::Spindle {
            direction: SpindleDirection::Clockwise,
            milli_rpm: 600_000,
        });
        turning.timed(&on).unwrap();
        // The spindle has two seconds to reach the speed.
        turning
            .timed(&Event::Dwell {
                wait_ticks: 2_000_000,
            })
            .unwrap();
        let Event::Dwell { wait_ticks } = turning.timed(&Event::Index).unwrap() else {
            panic!("a wait")
        };
        assert!(wait_ticks <= 100_000);
        for _ in 0..1000 {
            // A thousandth of a turn, which takes 0.1 s.
            let follow = Event::Follow(FollowEvent {
                wait_counts_q16: 65_536,
                delta: [0, 0, 1, 0, 0, 0],
                turns_back: false,
            });
            let Event::Step(step) = turning.timed(&follow).unwrap() else {
                panic!("a step")
            };
            assert!(step.wait_ticks.abs_diff(100) <= 2, "{}", step.wait_ticks);
        }
    }

    #[test]
    fn a_spindle_at_rest_is_an_error() {
        assert!(Turning::new(1000, 1_000_000).timed(&Event::Index).is_err());
    }
}
