//! Jogging: one axis runs for a given time.

use super::head::{Head, is_done, stop};
use super::port::Port;
use super::straight_move::per_period;
use crate::trouble::Trouble;
use husillo_transports::nmc::{Command, Mode, StopWay, Trajectory};

impl<P: Port> Head<P> {
    /// Runs an axis for some time and stops it smoothly. It runs at the speed of moves, or at that
    /// of a search if it `is_slow` or starts in contact. The jog is a move to the end of the travel
    /// that is stopped early. Without the host the module ends it there.
    ///
    /// # Errors
    ///
    /// [`Trouble`]. All axes are stopped then.
    pub fn jog(
        &mut self,
        coordinate: usize,
        is_positive: bool,
        seconds: f64,
        is_slow: bool,
    ) -> Result<(), Trouble> {
        let index = self.index(coordinate)?;
        self.supervised(|head| head.run(index, is_positive, seconds, is_slow))
    }

    fn run(
        &mut self,
        index: usize,
        is_positive: bool,
        seconds: f64,
        is_slow: bool,
    ) -> Result<(), Trouble> {
        let axis = self.axes[index];
        let [low, high] = axis.travel_counts();
        // The axis may stop this far beyond its goal.
        let slack = axis.settings.in_position as i32;
        let goal = if is_positive {
            high.saturating_sub(slack)
        } else {
            low.saturating_add(slack)
        };
        if (goal > axis.held) != is_positive || goal == axis.held {
            // The axis is at the end of the travel already.
            return Ok(());
        }
        let mut goals: Vec<i32> = self.axes.iter().map(|axis| axis.held).collect();
        goals[index] = goal;
        self.check_ends(&goals)?;
        let is_touching = self.is_touching()?;
        let axis = self.axes[index];
        let mut watch = self.watch(&goals);
        self.begin_watch(&mut watch, is_touching)?;
        let rate = if is_slow || is_touching {
            self.probe.rate.min(axis.settings.rate)
        } else {
            axis.rate(self.probe.rate)
        };
        self.announce(&goals);
        let (velocity, acceleration) =
            per_period(rate, axis.settings.acceleration.into(), self.period_s);
        self.line.command(
            axis.settings.module,
            Command::LoadTrajectory(Trajectory {
                position: Some(goal),
                velocity: Some(velocity),
                acceleration: Some(acceleration),
                mode: Mode::Trapezoid,
                start_now: true,
                ..Trajectory::default()
            }),
        )?;
        let end_us = self.line.elapsed_us() + (seconds * 1e6) as u64;
        while self.line.elapsed_us() < end_us {
            let replies = self.read_moving(&watch)?;
            self.look(&mut watch, &replies)?;
            let reply = &replies[index];
            if is_done(reply) && axis.is_near(reply.readings.position, goal) {
                break;
            }
        }
        self.line
            .command(axis.settings.module, stop(StopWay::Smooth))?;
        let was_armed = self.end_watch(&mut watch)?;
        let replies = self.settle()?;
        if was_armed && self.is_closed(&replies) {
            return Err(self.collision(&watch));
        }
        Ok(())
    }
}
