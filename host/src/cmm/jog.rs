//! An axis at a velocity.

use super::head::{Head, stop};
use super::trouble::Trouble;
use super::way::per_period;
use husillo_transports::nmc::{Command, Mode, StopWay, Trajectory};

impl Head {
    /// Runs an axis for some time, at the speed of moves or at that of a search, and stops it smoothly; before the end of the travel
    /// in any case. It runs as long as nobody stops it, so this is the one motion for which the host has to stay alive.
    ///
    /// # Errors
    ///
    /// [`Trouble`]; an axis in trouble stops the others.
    pub fn jog(
        &mut self,
        coordinate: usize,
        is_positive: bool,
        seconds: f64,
        is_slow: bool,
    ) -> Result<(), Trouble> {
        let index = self.index(coordinate)?;
        let axis = self.axes[index];
        let rate = if is_slow {
            self.probe.rate.min(axis.file.rate)
        } else {
            axis.file.rate
        };
        let (velocity, acceleration) =
            per_period(rate, axis.file.acceleration.into(), self.period_s);
        self.line.command(
            axis.file.module,
            Command::LoadTrajectory(Trajectory {
                velocity: Some(velocity),
                acceleration: Some(acceleration),
                mode: Mode::Velocity,
                reverse: !is_positive,
                start_now: true,
                ..Trajectory::default()
            }),
        )?;
        // The way to rest, v^2 / 2 a, and a tenth of a second of it for the line.
        let rate = f64::from(rate);
        let rest = rate * rate / 2.0 / f64::from(axis.file.acceleration) + rate / 10.0;
        let [low, high] = axis.file.travel.map(f64::from);
        let end_us = self.line.elapsed_us() + (seconds * 1e6) as u64;
        while self.line.elapsed_us() < end_us {
            let at = f64::from(self.read()?[index].readings.position);
            if is_positive && at + rest >= high || !is_positive && at - rest <= low {
                break;
            }
        }
        self.line.command(axis.file.module, stop(StopWay::Smooth))?;
        self.settle().map(drop)
    }
}
