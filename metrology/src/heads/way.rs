//! Straight ways of all axes of a head.

use super::head::{Head, is_done};
use super::port::Port;
use super::search::{Search, searches};
use super::servo::Servo;
use super::standing::SETTLING_US;
use crate::trouble::Trouble;
use husillo_planner::{Direction, ServoLine};
use husillo_transports::nmc::{Command, EVERY_GROUP, Failure, Homing, Mode, Reply, Trajectory};

/// How often a start is sent that no module has followed.
const STARTS: u32 = 3;

/// A way of the axes, or the end of one.
#[derive(Debug)]
pub struct Way {
    /// The last reading of each.
    pub replies: Vec<Reply>,
    /// It was an event that ended it.
    pub is_found: bool,
}

/// Counts/s and counts/s^2 in the units of a module, 2^-16 counts a period and a period^2; at least
/// 1.
pub(super) fn per_period(rate: u32, acceleration: u64, period_s: f64) -> (u32, u32) {
    // 2^31 is beyond what any motor makes, so the casts' saturation does no harm.
    let velocity = (f64::from(rate) * period_s * 65536.0).round() as u32;
    let acceleration = (acceleration as f64 * period_s * period_s * 65536.0).round() as u32;
    (velocity.max(1), acceleration.max(1))
}

impl<P: Port> Head<P> {
    /// Goes in a straight line to `goal` in counts, as fast as the axes can but at most `rate`
    /// counts/s, and waits until all stand. With a `search` each module ends it at the event,
    /// latches where it was and stops, whatever the host does; without event and host the move ends
    /// at its goal. Without a search a contact is a collision.
    ///
    /// The trapezoids of the axes have one time law ([`ServoLine`]). They are loaded first and
    /// started by one command to the group.
    ///
    /// # Errors
    ///
    /// [`Trouble`]; all axes are stopped then.
    pub fn travel(
        &mut self,
        goal: &[i32],
        rate: Option<u32>,
        search: Option<Search>,
    ) -> Result<Way, Trouble> {
        self.guarded(|head| match search {
            Some(search) => head.go_along(goal, rate, search),
            None => head.go_clear(goal, rate),
        })
    }

    fn go_along(
        &mut self,
        goal: &[i32],
        rate: Option<u32>,
        search: Search,
    ) -> Result<Way, Trouble> {
        let mut watch = (!search.is_touch()).then(|| self.watch(goal));
        let Some(line) = self.line_to(goal, rate) else {
            let replies = self.stand(Some(goal))?;
            return Ok(Way {
                replies,
                is_found: false,
            });
        };
        self.arm(search)?;
        self.start_line(goal, &line, Some(search))?;
        let end_us = self.latest_end_us(&line);
        loop {
            let mut replies = self.read()?;
            if let Some(watch) = &mut watch {
                self.look_in_search(watch, &replies)?;
            }
            let found = search.found_by(&replies);
            if found.iter().any(|(_, is_found)| *is_found) {
                // Those that were read before it have seen it by now.
                replies = self.read()?;
                let found = search.found_by(&replies);
                if let Some((index, _)) = found.iter().find(|(_, is_found)| !is_found) {
                    let axis = self.axes[*index].settings.letter;
                    return Err(Trouble::NotSeen { axis });
                }
                let replies = self.settle()?;
                // One reading may be wrong and not show it; two alike are not.
                if let Some(index) = replies.iter().position(searches) {
                    let axis = self.axes[index].settings.letter;
                    return Err(Trouble::NotSeen { axis });
                }
                if let Some(watch) = &mut watch {
                    self.look_in_search(watch, &replies)?;
                }
                return Ok(Way {
                    replies,
                    is_found: true,
                });
            }
            if replies.iter().all(is_done) {
                // An event while it settles is none; the search is given up.
                self.disarm(search)?;
                let replies = self.stand(Some(goal))?;
                return Ok(Way {
                    replies,
                    is_found: false,
                });
            }
            if self.line.elapsed_us() > end_us {
                return Err(self.late(Some(goal), goal, &replies));
            }
        }
    }

    /// Arms the search of the axes that it is for.
    pub(super) fn arm(&mut self, search: Search) -> Result<(), Trouble> {
        for (index, axis) in self.axes.iter().enumerate() {
            if !search.is_for(index) {
                continue;
            }
            let command = Command::SetHoming(search.events.with(search.stop));
            let reply = self.line.command(axis.settings.module, command)?;
            if !searches(&reply) {
                // It has heard something else, and what it has latched is of another search.
                return Err(Trouble::Link(Failure::Uncertain));
            }
        }
        Ok(())
    }

    /// Gives the search up.
    pub(super) fn disarm(&mut self, search: Search) -> Result<(), Trouble> {
        for (index, axis) in self.axes.iter().enumerate() {
            if search.is_for(index) {
                let command = Command::SetHoming(Homing::default());
                self.line.command(axis.settings.module, command)?;
            }
        }
        Ok(())
    }

    /// The move from where the axes are held; `None` where there is no way.
    pub(super) fn line_to(&self, goal: &[i32], rate: Option<u32>) -> Option<ServoLine<3>> {
        let (mut ways, mut rates, mut accelerations) = ([0; 3], [u32::MAX; 3], [u64::MAX; 3]);
        for (axis, goal) in self.axes.iter().zip(goal) {
            let coordinate = axis.settings.coordinate();
            // Beyond 2^31 counts it would only be slower.
            ways[coordinate] = goal.saturating_sub(axis.held);
            rates[coordinate] = axis.settings.rate;
            accelerations[coordinate] = axis.settings.acceleration.into();
        }
        let direction = Direction::new(ways.map(i64::from))?;
        let rate = direction.speed_limit(&rates).min(rate.unwrap_or(u32::MAX));
        let acceleration = direction.acceleration_limit(&accelerations);
        let (velocity, acceleration) = per_period(rate, acceleration, self.period_s);
        ServoLine::new(ways, velocity, acceleration)
    }

    /// When a way that begins now is over at the latest, us.
    pub(super) fn latest_end_us(&self, line: &ServoLine<3>) -> u64 {
        let seconds = f64::from(line.duration_ticks) * self.period_s;
        self.line.elapsed_us() + (seconds * 1.5e6) as u64 + SETTLING_US
    }

    /// Loads the trapezoids and starts them all at once.
    pub(super) fn start_line(
        &mut self,
        goal: &[i32],
        line: &ServoLine<3>,
        search: Option<Search>,
    ) -> Result<(), Trouble> {
        let is_alone = self.axes.len() == 1;
        let fastest = |of: [u32; 3]| of.into_iter().max().unwrap_or(1);
        for (index, goal) in goal.iter().enumerate() {
            let axis = &mut self.axes[index];
            let of = |all: [u32; 3]| match all[axis.settings.coordinate()] {
                // Where there is no way: nothing that could last.
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

    /// One command for all. The leader alone answers it, so each is asked whether it has begun.
    fn start_group(&mut self, goal: &[i32], search: Option<Search>) -> Result<(), Trouble> {
        for _ in 0..STARTS {
            match self.line.command(EVERY_GROUP, Command::StartMotion) {
                // Without the leader's answer the others know.
                Ok(_) | Err(Trouble::Link(Failure::Uncertain)) => {}
                Err(trouble) => return Err(trouble),
            }
            let replies = self.read()?;
            // Of ways so short that it cannot be told the end will tell.
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
                // The others would leave the line.
                break;
            }
        }
        Err(Trouble::NotTogether)
    }
}
