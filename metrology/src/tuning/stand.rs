//! The axis on the test stand, with the limits that are watched during an experiment.

use super::rig::{Rig, Sample};
use crate::error::Error;
use crate::heads::AxisSettings;
use husillo_sim::text::position;
use husillo_transports::nmc::{Gains, Status};
use std::fmt;

/// A part of an experiment, to be drawn.
#[derive(Clone, Debug)]
pub struct Trace {
    /// Title of the drawing.
    pub title: String,
    /// Commanded position, counts. `None`: the motor was driven without the servo.
    pub target: Option<i32>,
    /// Start time, us.
    pub start_us: u64,
    /// Readings in order of time.
    pub samples: Vec<Sample>,
    /// Times in us and duties of a drive without the servo.
    pub drives: Vec<(u64, i16)>,
}

/// An axis with its limits.
pub struct Stand {
    rig: Box<dyn Rig>,
    /// Settings of the axis. The limits in its gains apply to all trials.
    pub settings: AxisSettings,
    /// Position around which the experiments are made, counts.
    pub centre: i32,
    /// The traces to be drawn.
    pub traces: Vec<Trace>,
    samples: u64,
    /// Time in which the samples were taken, us.
    sampled_us: u64,
}

impl fmt::Debug for Stand {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = out.debug_struct("Stand");
        text.field("settings", &self.settings)
            .field("centre", &self.centre);
        text.finish_non_exhaustive()
    }
}

impl Stand {
    /// A stand around the present position of the axis.
    ///
    /// # Errors
    ///
    /// The link fails.
    pub fn new(mut rig: Box<dyn Rig>, settings: AxisSettings) -> Result<Self, Error> {
        let centre = rig.sample()?.position;
        Ok(Self {
            rig,
            settings,
            centre,
            traces: Vec::new(),
            samples: 0,
            sampled_us: 0,
        })
    }

    /// Adds the limits of the machine file to gains.
    pub(super) fn gains(&self, proportional: u16, integral: u16, derivative: u16) -> Gains {
        Gains {
            proportional,
            integral,
            derivative,
            ..self.settings.gains
        }
    }

    /// Mean time between two readings, us.
    pub fn sample_us(&self) -> f64 {
        self.sampled_us as f64 / self.samples.max(1) as f64
    }

    /// Switches the servo on with these gains at the present position.
    ///
    /// # Errors
    ///
    /// The link fails.
    pub(super) fn engage(&mut self, gains: &Gains) -> Result<(), Error> {
        self.rig.set_gains(gains)?;
        self.rig.engage()
    }

    /// The present position, and a position `size` counts away in the direction of the centre. So
    /// steps back and forth between them stay near the centre.
    ///
    /// # Errors
    ///
    /// A limit is passed, or the link fails.
    pub(super) fn there_and_back(&mut self, size: i32) -> Result<[i32; 2], Error> {
        let from = self.sample(true)?.position;
        let there = if from > self.centre {
            from - size
        } else {
            from + size
        };
        Ok([from, there])
    }

    /// Commands a position without a profile and records the axis for `us` microseconds.
    ///
    /// # Errors
    ///
    /// A limit is passed, or the link fails.
    pub(super) fn step_to(&mut self, target: i32, us: u64) -> Result<Trace, Error> {
        let start_us = self.rig.now_us();
        self.rig.hold(target)?;
        let mut samples = Vec::new();
        while self.rig.now_us() < start_us + us {
            samples.push(self.sample(true)?);
        }
        Ok(Trace {
            title: String::new(),
            target: Some(target),
            start_us,
            samples,
            drives: Vec::new(),
        })
    }

    /// Drives the motor without the servo: `law` computes the duty from each reading of the
    /// position. Returns the trace, and the mean time in us from a reading to the end of its
    /// command.
    ///
    /// # Errors
    ///
    /// A limit is passed, or the link fails.
    pub(super) fn drive_by(
        &mut self,
        us: u64,
        mut law: impl FnMut(i32) -> i16,
    ) -> Result<(Trace, f64), Error> {
        // This switches the amplifier on and sets the current limit.
        let gains = self.settings.gains;
        self.engage(&gains)?;
        let start_us = self.rig.now_us();
        let [low, high] = self.settings.travel;
        let reach = i32::from(gains.error_limit);
        let (mut samples, mut drives) = (Vec::new(), Vec::new());
        let (mut duty, mut late_us) = (0, 0);
        while self.rig.now_us() < start_us + us {
            let sample = self.sample(false)?;
            let wanted = law(sample.position);
            if wanted != duty {
                let end = self.centre + if wanted > 0 { reach } else { -reach };
                self.rig.drive(wanted, end.clamp(low, high))?;
                duty = wanted;
                late_us += self.rig.now_us() - sample.us;
                drives.push((self.rig.now_us(), duty));
            }
            samples.push(sample);
        }
        self.rig.release()?;
        let late_us = late_us as f64 / drives.len().max(1) as f64;
        let trace = Trace {
            title: String::new(),
            target: None,
            start_us,
            samples,
            drives,
        };
        Ok((trace, late_us))
    }

    /// Starts a move with the rate and acceleration of the machine.
    ///
    /// # Errors
    ///
    /// The link fails.
    pub(super) fn start_move(&mut self, goal: i32) -> Result<(), Error> {
        self.rig
            .go_to(goal, self.settings.rate, self.settings.acceleration)
    }

    /// The next reading. Checks that the axis is within its limits.
    ///
    /// # Errors
    ///
    /// A limit is passed, or the link fails.
    pub(super) fn sample(&mut self, is_servo_on: bool) -> Result<Sample, Error> {
        let before_us = self.rig.now_us();
        let sample = self.rig.sample()?;
        self.samples += 1;
        self.sampled_us += sample.us.saturating_sub(before_us);
        let at = || counts(sample.position);
        let [low, high] = self.settings.travel;
        // Without the servo the module always reports a position error, and a drive needs twice the
        // limit of a module. So the limit is checked here.
        let is_lost = if is_servo_on {
            sample.status.contains(Status::POSITION_ERROR)
        } else {
            sample.position.abs_diff(self.centre) > u32::from(self.settings.gains.error_limit)
        };
        if !sample.status.contains(Status::POWER_ON) {
            Err(Error::NoPower {
                axis: self.settings.letter,
            })
        } else if sample.status.contains(Status::OVERCURRENT) {
            Err(Error::OverCurrent { at: at() })
        } else if is_lost {
            Err(Error::PositionError { at: at() })
        } else if !(low..=high).contains(&sample.position) {
            Err(Error::OutsideTravel {
                goal: at(),
                travel: [counts(low), counts(high)],
            })
        } else {
            Ok(sample)
        }
    }

    /// Switches the drive off. A failure is ignored, because a failed link was reported before.
    pub fn release(&mut self) {
        let _ = self.rig.release();
    }
}

impl Trace {
    /// Positions every `period_s` seconds from the start on, with linear interpolation between
    /// readings.
    pub fn positions(&self, period_s: f64) -> Vec<f64> {
        let time = |sample: &Sample| (sample.us.saturating_sub(self.start_us)) as f64 * 1e-6;
        let Some((first, last)) = self.samples.first().zip(self.samples.last()) else {
            return Vec::new();
        };
        let (mut before, mut rest) = (*first, self.samples.iter().peekable());
        let length = (time(last) / period_s + 1e-6) as usize;
        let at = |number: usize| number as f64 * period_s;
        let mut positions = Vec::with_capacity(length);
        for number in 0..=length {
            while let Some(next) = rest.next_if(|next| time(next) <= at(number)) {
                before = *next;
            }
            let position = f64::from(before.position);
            positions.push(match rest.peek() {
                Some(next) if time(next) > time(&before) && at(number) > time(&before) => {
                    let part = (at(number) - time(&before)) / (time(next) - time(&before));
                    position + part * (f64::from(next.position) - position)
                }
                _ => position,
            });
        }
        positions
    }
}

/// A number of counts as text: `1 count`, `12 counts`.
pub fn counts(number: i32) -> String {
    position(number, "count")
}
