//! Supervision, which stops every axis after a failure: checked readings, stops, and the recovery
//! from a stop.

use super::{Head, READ, stop};
use crate::error::Error;
use crate::heads::port::Port;
use crate::heads::servo::Servo;
use crate::heads::settling::{SETTLING_US, STILL_READINGS};
use husillo_transports::nmc::{Command, Items, Reply, Stop, StopMode};

impl<P: Port> Head<P> {
    /// Reads all axes, and shows the operator what was read.
    fn readings(&mut self) -> Result<Vec<Reply>, Error> {
        let mut replies = Vec::with_capacity(self.axes.len());
        for axis in &self.axes {
            let module = axis.settings.module;
            replies.push(self.line.command(module, Command::ReadStatus(READ))?);
        }
        let position = self.view.position(self.place_of(&replies));
        let is_pressed = self.is_closed(&replies);
        self.line.operator().reads(position, is_pressed);
        Ok(replies)
    }

    /// Reads all axes.
    ///
    /// # Errors
    ///
    /// No answer, or an axis with a fault.
    pub(crate) fn read(&mut self) -> Result<Vec<Reply>, Error> {
        let replies = self.readings()?;
        for (index, (axis, reply)) in self.axes.iter().zip(&replies).enumerate() {
            let checked = axis.check(reply, || self.axis_text(index, reply.readings.position));
            if checked.is_err() {
                self.given_up = Some(index);
            }
            checked?;
        }
        self.look_at_ends(&replies)?;
        Ok(replies)
    }

    /// Reads the axes while nothing is to move, for [`Operator::reads`]. A fault is reported once:
    /// its axis stays without drive until the next motion, which clears the fault.
    ///
    /// # Errors
    ///
    /// No answer, an axis with a fault, or an end switch that has closed.
    ///
    /// [`Operator::reads`]: crate::heads::Operator::reads
    pub fn read_at_rest(&mut self) -> Result<(), Error> {
        if self.is_astray {
            return self.readings().map(drop);
        }
        let read = self.read().map(drop);
        self.is_astray = read.is_err();
        read
    }

    /// Whether the last motion was stopped or has failed: the commanded position is that of a goal
    /// that was not reached.
    #[must_use]
    pub const fn is_astray(&self) -> bool {
        self.is_astray
    }

    /// Waits until the axes, which are braking, stand. Their faults are not looked at.
    ///
    /// # Errors
    ///
    /// No answer, or an axis that does not come to rest.
    pub fn come_to_rest(&mut self) -> Result<(), Error> {
        let end_us = self.line.elapsed_us() + self.braking_us() + SETTLING_US;
        let (mut still, mut before): (u32, Option<Vec<i32>>) = (0, None);
        loop {
            let replies = self.readings()?;
            let at: Vec<i32> = replies.iter().map(|one| one.readings.position).collect();
            let is_still = before.as_ref().is_some_and(|before| {
                let mut pairs = self.axes.iter().zip(at.iter().zip(before));
                pairs.all(|(axis, (at, to))| axis.is_near(*at, *to))
            });
            still = if is_still { still + 1 } else { 0 };
            if still >= STILL_READINGS {
                return Ok(());
            }
            // As in `stand`: the last readings are made, even if the computer is late.
            if let Some(before) = before.as_deref().filter(|_| !is_still) {
                if self.line.elapsed_us() > end_us {
                    return Err(self.late(None, before, &replies));
                }
            }
            before = Some(at);
        }
    }

    /// Carries out `what`, which moves axes. After any failure, also of the link, and after a stop
    /// by the operator, all axes are commanded to stop. The next motion begins at the positions at
    /// which they came to rest.
    ///
    /// # Errors
    ///
    /// The errors of `what`, and the stop of the operator.
    pub(crate) fn supervised<T>(
        &mut self,
        what: impl FnOnce(&mut Self) -> Result<T, Error>,
    ) -> Result<T, Error> {
        self.line.operator().set_moving(true);
        let result = self
            .find_again()
            .and_then(|()| what(self))
            .and_then(|done| {
                // It is too late to stop this move, but no other move follows.
                if self.line.operator().is_stop_wanted() {
                    Err(Error::Interrupted)
                } else {
                    Ok(done)
                }
            });
        if let Err(error) = &result {
            self.is_astray = true;
            self.line.operator().stop_is_seen_to();
            let stop = match error {
                Error::Interrupted => StopMode::Smooth,
                _ => StopMode::Abrupt,
            };
            if self.stop(stop).is_err() {
                self.line.operator().stop_is_unanswered();
            }
        }
        self.line.operator().set_moving(false);
        result
    }

    /// Recovers after a failure: waits until the axes stand, clears their faults and holds them at
    /// their positions.
    pub(crate) fn find_again(&mut self) -> Result<(), Error> {
        if !self.is_astray {
            return Ok(());
        }
        for index in 0..self.axes.len() {
            let module = self.axes[index].settings.module;
            self.line.command(module, stop(StopMode::Abrupt))?;
            self.line.command(module, Command::ClearBits)?;
        }
        self.settle()?;
        self.is_astray = false;
        Ok(())
    }

    /// Reads all axes, which stand, until two readings of each agree. Reported and stored positions
    /// come from these readings.
    ///
    /// # Errors
    ///
    /// No answer, or readings that do not agree.
    pub(crate) fn read_twice(&mut self) -> Result<Vec<Reply>, Error> {
        let axes = self.axes.clone();
        axes.iter()
            .map(|axis| self.read_axis_twice(axis, READ))
            .collect()
    }

    pub(in crate::heads) fn read_axis_twice(
        &mut self,
        axis: &Servo,
        items: Items,
    ) -> Result<Reply, Error> {
        let jitter_counts = axis.settings.in_position.saturating_mul(2);
        self.line
            .read_twice(axis.settings.module, items, jitter_counts)
    }

    /// Commands a standing axis to hold `counts`, so that the length of the next move is known
    /// exactly.
    pub(crate) fn hold(&mut self, index: usize, counts: i32) -> Result<(), Error> {
        let module = self.axes[index].settings.module;
        self.line.command(module, stop(StopMode::Here(counts)))?;
        self.axes[index].held = counts;
        Ok(())
    }

    /// Stops all axes. Each is sent its command, whether or not the others answer. An axis with a
    /// fault stays without drive, because something blocks it or its motor current is too high.
    pub(crate) fn stop(&mut self, mode: StopMode) -> Result<(), Error> {
        let given_up = self.given_up.take();
        let mut result = Ok(());
        for (index, axis) in self.axes.iter().enumerate() {
            let command = if given_up == Some(index) {
                Command::StopMotor(Stop {
                    amplifier: false,
                    mode: Some(StopMode::Off),
                })
            } else {
                stop(mode)
            };
            let answer = self.line.command(axis.settings.module, command);
            result = result.and(answer.map(drop));
        }
        result
    }
}
