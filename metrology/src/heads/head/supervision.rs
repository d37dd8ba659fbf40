//! Supervision, which stops every axis after a failure: checked readings, stops, and the recovery
//! from a stop.

use super::{Head, READ, stop};
use crate::error::Error;
use crate::heads::port::Port;
use crate::heads::servo::Servo;
use husillo_transports::nmc::{Command, Items, Reply, Stop, StopMode};

impl<P: Port> Head<P> {
    /// Reads all axes.
    ///
    /// # Errors
    ///
    /// No answer, or an axis with a fault.
    pub(crate) fn read(&mut self) -> Result<Vec<Reply>, Error> {
        let mut replies = Vec::with_capacity(self.axes.len());
        for axis in &self.axes {
            let module = axis.settings.module;
            replies.push(self.line.command(module, Command::ReadStatus(READ))?);
        }
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
