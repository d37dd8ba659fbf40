//! Waiting until the axes come to rest.

use super::head::{Head, is_done};
use super::port::Port;
use crate::error::Error;
use husillo_transports::nmc::Reply;

/// Longest time from the end of a profile until the axes are at rest, us.
pub const SETTLING_US: u64 = 2_000_000;

/// The axes are at rest after this number of consecutive readings in position.
pub const STILL_READINGS: u32 = 3;

impl<P: Port> Head<P> {
    /// Waits until all axes are at rest, at the goal or at the position where they have stopped.
    pub(super) fn stand(&mut self, goal: Option<&[i32]>) -> Result<Vec<Reply>, Error> {
        let end_us = self.line.elapsed_us() + self.braking_us() + SETTLING_US;
        let (mut still, mut before): (u32, Option<Vec<i32>>) = (0, None);
        loop {
            let replies = self.read()?;
            let at: Vec<i32> = replies.iter().map(|one| one.readings.position).collect();
            let is_near = |to: &[i32]| {
                let mut pairs = self.axes.iter().zip(at.iter().zip(to));
                pairs.all(|(axis, (at, to))| axis.is_near(*at, *to))
            };
            let is_still = replies.iter().all(is_done)
                && goal.is_none_or(is_near)
                && before.as_deref().is_some_and(is_near);
            still = if is_still { still + 1 } else { 0 };
            if still >= STILL_READINGS {
                return Ok(replies);
            }
            // If the axes are in position at the last reading, the remaining readings are still
            // made, even if the computer is busy and late.
            if let Some(before) = before.as_deref().filter(|_| still == 0) {
                if self.line.elapsed_us() > end_us {
                    return Err(self.late(goal, before, &replies));
                }
            }
            before = Some(at);
        }
    }

    /// Waits until the axes have stopped, reads them until two readings agree, and holds them at
    /// their positions.
    pub(super) fn settle(&mut self) -> Result<Vec<Reply>, Error> {
        self.stand(None)?;
        let replies = self.read_twice()?;
        for (index, reply) in replies.iter().enumerate() {
            self.hold(index, reply.readings.position)?;
        }
        Ok(replies)
    }

    /// Longest braking time of an axis, us. In an oblique move all axes brake for the same time.
    /// The limits of one of the axes determine it, so it is at most the longest of their braking
    /// times.
    pub(super) fn braking_us(&self) -> u64 {
        let axes = self.axes.iter().map(|axis| {
            // No acceleration in a machine file is 0. The result is at most 2^32 s.
            u64::from(axis.settings.rate) * 1_000_000 / u64::from(axis.settings.acceleration.max(1))
        });
        axes.max().unwrap_or_default()
    }

    /// The error of axes that are not at rest in time. It names an axis that still moves, or the
    /// axis that is farthest from its goal. Without a goal it names the axis that is farthest from
    /// its position `before`.
    pub(super) fn late(&self, goal: Option<&[i32]>, before: &[i32], replies: &[Reply]) -> Error {
        let meant = goal.unwrap_or(before);
        let far = |index: &usize| replies[*index].readings.position.abs_diff(meant[*index]);
        let farthest = (0..self.axes.len()).max_by_key(far).unwrap_or_default();
        let moving = replies.iter().position(|reply| !is_done(reply));
        let index = moving.unwrap_or(farthest);
        let at = self.axis_text(index, replies[index].readings.position);
        match (moving, goal) {
            (None, Some(goal)) => Error::NotThere {
                goal: self.axis_text(index, goal[index]),
                at,
            },
            _ => Error::StillMoving { at },
        }
    }
}
