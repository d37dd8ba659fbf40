//! Straight moves of all axes of a head.

use super::approach::Approach;
use super::head::{Head, is_done};
use super::port::Port;
use super::search::{Search, searches};
use super::servo::Servo;
use super::settling::SETTLING_US;
use super::wiring::End;
use crate::error::Error;
use husillo_planner::{ServoLine, Tangent};
use husillo_transports::nmc::{Command, EVERY_GROUP, Failure, Homing, Mode, Reply, Trajectory};

/// Number of times that a start command is sent if no module follows it.
const STARTS: u32 = 3;

/// A finished move of the axes.
#[derive(Debug)]
pub struct FinishedMove {
    /// The last reading of each axis.
    pub replies: Vec<Reply>,
    /// Whether an event has ended the move.
    pub is_found: bool,
}

/// Converts counts/s and counts/s^2 to the units of a module: 2^-16 counts per period and per
/// period^2. The results are at least 1.
pub(crate) fn per_period(rate: u32, acceleration: u64, period_s: f64) -> (u32, u32) {
    // No motor reaches 2^31, so it does not matter that the casts saturate.
    let velocity = (f64::from(rate) * period_s * 65536.0).round() as u32;
    let acceleration = (acceleration as f64 * period_s * period_s * 65536.0).round() as u32;
    (velocity.max(1), acceleration.max(1))
}

impl<P: Port> Head<P> {
    /// Moves along a straight path to `goal`, in counts, and waits until all axes are at rest. The
    /// speed is the highest that the axes can reach, but at most `rate` counts/s. With a `search`
    /// each module latches its position at the event and stops its axis, without the host. Without
    /// an event the move ends at its goal, even without the host. Without a search a contact is a
    /// collision.
    ///
    /// The trapezoids of all axes have the same ratio of time to path ([`ServoLine`]). They are
    /// loaded first and started by one command to the group.
    ///
    /// # Errors
    ///
    /// [`Error`]. All axes are stopped then.
    pub fn travel(
        &mut self,
        goal: &[i32],
        rate: Option<u32>,
        search: Option<Search>,
    ) -> Result<FinishedMove, Error> {
        let Some(search) = search else {
            return self.go(goal, rate, Approach::Rapid);
        };
        self.supervised(|head| {
            head.check_ends(goal)?;
            head.go_along(goal, rate, search)
        })
    }

    /// Moves outside of a search.
    pub(super) fn go(
        &mut self,
        goal: &[i32],
        rate: Option<u32>,
        approach: Approach,
    ) -> Result<FinishedMove, Error> {
        self.supervised(|head| {
            head.check_ends(goal)?;
            head.go_clear(goal, rate, approach)
        })
    }

    fn go_along(
        &mut self,
        goal: &[i32],
        rate: Option<u32>,
        search: Search,
    ) -> Result<FinishedMove, Error> {
        let mut watch = self.watch(goal);
        let Some(line) = self.line_to(goal, rate) else {
            let replies = self.stand(Some(goal))?;
            return Ok(FinishedMove {
                replies,
                is_found: false,
            });
        };
        self.arm(search)?;
        self.start_line(goal, &line, Some(search))?;
        let end_us = self.latest_end_us(&line);
        loop {
            let mut replies = self.read_moving(&watch)?;
            self.look_in_search(search, &mut watch, &replies)?;
            let found = search.found_by(&replies);
            if found.iter().any(|(_, is_found)| *is_found) {
                // Modules that were read before the event have detected it by now.
                replies = self.read_moving(&watch)?;
                let found = search.found_by(&replies);
                if let Some((index, _)) = found.iter().find(|(_, is_found)| !is_found) {
                    let axis = self.axes[*index].settings.letter;
                    return Err(Error::NotSeen { axis });
                }
                let replies = self.settle()?;
                // A single reading may be wrong and undetected. Two equal readings are right.
                if let Some(index) = replies.iter().position(searches) {
                    let axis = self.axes[index].settings.letter;
                    return Err(Error::NotSeen { axis });
                }
                self.look_in_search(search, &mut watch, &replies)?;
                return Ok(FinishedMove {
                    replies,
                    is_found: true,
                });
            }
            if replies.iter().all(is_done) {
                // The search ends here, so an event while the axes settle does not count.
                self.disarm(search)?;
                let replies = self.stand(Some(goal))?;
                return Ok(FinishedMove {
                    replies,
                    is_found: false,
                });
            }
            if self.line.elapsed_us() > end_us {
                return Err(self.late(Some(goal), goal, &replies));
            }
        }
    }

    /// Arms the search on the searching axes.
    pub(super) fn arm(&mut self, search: Search) -> Result<(), Error> {
        for (index, axis) in self.axes.iter_mut().enumerate() {
            if !search.is_for(index) {
                continue;
            }
            // The module detects any change of its end switch, also when it opens.
            axis.is_end_armed = !axis.is_at_end;
            let ends = match axis.is_end_armed {
                true => axis.settings.end_events(),
                false => Homing::default(),
            };
            let command = Command::SetHoming(search.events.with(ends).with(search.stop));
            let reply = self.line.command(axis.settings.module, command)?;
            if !searches(&reply) {
                // The module has received another command, and its latch belongs to another search.
                return Err(Error::Link {
                    module: self.line.name(axis.settings.module),
                    failure: Failure::Uncertain,
                });
            }
        }
        Ok(())
    }

    /// Ends the search.
    pub(super) fn disarm(&mut self, search: Search) -> Result<(), Error> {
        for (index, axis) in self.axes.iter_mut().enumerate() {
            if search.is_for(index) {
                axis.is_end_armed = false;
                let command = Command::SetHoming(Homing::default());
                self.line.command(axis.settings.module, command)?;
            }
        }
        Ok(())
    }

    /// Computes the move from the held positions. `None`: the axes are at the goal.
    pub(super) fn line_to(&self, goal: &[i32], rate: Option<u32>) -> Option<ServoLine<3>> {
        let (mut distances, mut rates, mut accelerations) = ([0; 3], [u32::MAX; 3], [u64::MAX; 3]);
        for (axis, goal) in self.axes.iter().zip(goal) {
            let coordinate = axis.settings.coordinate();
            // A saturated distance only makes the move slower.
            distances[coordinate] = goal.saturating_sub(axis.held);
            rates[coordinate] = axis.rate(self.probe.rate);
            accelerations[coordinate] = axis.settings.acceleration.into();
        }
        let direction = Tangent::new(distances.map(i64::from))?;
        let rate = direction.speed_limit(&rates).min(rate.unwrap_or(u32::MAX));
        let acceleration = direction.acceleration_limit(&accelerations);
        let (velocity, acceleration) = per_period(rate, acceleration, self.period_s);
        ServoLine::new(distances, velocity, acceleration)
    }

    /// Latest end of a move that begins now, us.
    pub(super) fn latest_end_us(&self, line: &ServoLine<3>) -> u64 {
        let seconds = f64::from(line.duration_ticks) * self.period_s;
        self.line.elapsed_us() + (seconds * 1.5e6) as u64 + SETTLING_US
    }

    /// Informs the operator, once per axis, that a moving axis is not homed.
    pub(super) fn announce(&mut self, goal: &[i32]) {
        for (axis, goal) in self.axes.iter_mut().zip(goal) {
            if axis.is_homed || axis.is_announced || axis.held == *goal {
                continue;
            }
            axis.is_announced = true;
            let rate = self.scale.text_of_rate(axis.rate(self.probe.rate).into());
            let operator = self.line.operator();
            operator.moves_without_home(axis.settings.letter, &rate);
        }
    }

    /// Loads the trapezoids and starts all of them together.
    pub(super) fn start_line(
        &mut self,
        goal: &[i32],
        line: &ServoLine<3>,
        search: Option<Search>,
    ) -> Result<(), Error> {
        self.announce(goal);
        self.head_for(goal);
        let is_alone = self.axes.len() == 1;
        let fastest = |of: [u32; 3]| of.into_iter().max().unwrap_or(1);
        for (index, goal) in goal.iter().enumerate() {
            let axis = &mut self.axes[index];
            let of = |all: [u32; 3]| match all[axis.settings.coordinate()] {
                // An axis that does not move has the highest rate, so that its profile ends
                // immediately.
                0 => fastest(all),
                part => part,
            };
            let trajectory = Trajectory {
                position: Some(*goal),
                velocity: Some(of(line.velocities)),
                acceleration: Some(of(line.accelerations)),
                mode: Mode::Trapezoid,
                start_now: is_alone,
                ..Trajectory::default()
            };
            let module = axis.settings.module;
            self.line
                .command(module, Command::LoadTrajectory(trajectory))?;
        }
        if !is_alone {
            self.start_group(goal, search)?;
        }
        for (axis, goal) in self.axes.iter_mut().zip(goal) {
            axis.held = *goal;
        }
        Ok(())
    }

    /// Registers the end to which each axis is about to move.
    pub(super) fn head_for(&mut self, goal: &[i32]) {
        for (axis, goal) in self.axes.iter_mut().zip(goal) {
            axis.heading = End::towards(i64::from(*goal) - i64::from(axis.held));
        }
    }

    /// Starts all axes by one command. Only the leader answers, so each module is asked whether it
    /// has begun.
    fn start_group(&mut self, goal: &[i32], search: Option<Search>) -> Result<(), Error> {
        for _ in 0..STARTS {
            match self.line.command(EVERY_GROUP, Command::StartMotion) {
                // If the answer of the leader is missing, the following readings show whether the
                // move has begun.
                Ok(_)
                | Err(Error::Link {
                    failure: Failure::Uncertain,
                    ..
                }) => {}
                Err(error) => return Err(error),
            }
            let replies = self.read()?;
            // In a short move the readings do not show the start. Such moves are checked at their
            // end.
            let is_long = |(axis, (_, goal)): &(&Servo, (&Reply, &i32))| {
                goal.abs_diff(axis.held) > 4 * axis.settings.in_position
            };
            let has_begun = |(axis, (reply, goal)): (&Servo, (&Reply, &i32))| {
                let at = reply.readings.position;
                !is_done(reply)
                    || search.is_some_and(|search| search.is_found(reply))
                    || at.abs_diff(*goal) < at.abs_diff(axis.held)
            };
            let pairs = self.axes.iter().zip(replies.iter().zip(goal));
            let begun: Vec<bool> = pairs.filter(is_long).map(has_begun).collect();
            if !begun.contains(&false) {
                return Ok(());
            }
            if begun.contains(&true) {
                // If some axes begin later, the path is no longer straight.
                break;
            }
        }
        Err(Error::NotTogether)
    }
}
