//! The axis on the test stand: everything that is watched while an experiment goes on.

use super::rig::{Rig, Sample};
use crate::heads::AxisSettings;
use crate::trouble::Trouble;
use husillo_transports::nmc::{Gains, Status};
use std::fmt;

/// A stretch of an experiment, to be drawn.
#[derive(Clone, Debug)]
pub struct Trace {
    /// What it shows.
    pub title: String,
    /// What was commanded, counts; `None` where the motor was driven without the servo.
    pub target: Option<i32>,
    /// When it began, us.
    pub start_us: u64,
    /// In order of time.
    pub samples: Vec<Sample>,
    /// Times and duties of the drive, without the servo.
    pub drives: Vec<(u64, i16)>,
}

/// An axis with its limits.
pub struct Stand {
    rig: Box<dyn Rig>,
    /// What is known of the axis; its gains are the limits of all trials.
    pub settings: AxisSettings,
    /// Place of the experiments, counts.
    pub centre: i32,
    /// The stretches worth a picture.
    pub traces: Vec<Trace>,
    samples: u64,
    /// Time in which these were taken.
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
    /// Around where the axis is now.
    ///
    /// # Errors
    ///
    /// The link fails.
    pub fn new(mut rig: Box<dyn Rig>, settings: AxisSettings) -> Result<Self, Trouble> {
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

    /// The limits of the machine file with other gains.
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

    /// Servo on with these gains, where the axis is.
    ///
    /// # Errors
    ///
    /// The link fails.
    pub(super) fn engage(&mut self, gains: &Gains) -> Result<(), Trouble> {
        self.rig.set_gains(gains)?;
        self.rig.engage()
    }

    /// Where the axis is, and a place `size` counts away, towards the middle: steps to and fro stay
    /// about it.
    ///
    /// # Errors
    ///
    /// A limit is passed, or the link fails.
    pub(super) fn there_and_back(&mut self, size: i32) -> Result<[i32; 2], Trouble> {
        let from = self.sample(true)?.position;
        let there = if from > self.centre {
            from - size
        } else {
            from + size
        };
        Ok([from, there])
    }

    /// Commands a position at once and watches for some time.
    ///
    /// # Errors
    ///
    /// A limit is passed, or the link fails.
    pub(super) fn step_to(&mut self, target: i32, us: u64) -> Result<Trace, Trouble> {
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

    /// Drives the motor as no servo does: `law` makes the duty of a position, as often as the axis
    /// can be read. Returns the trace, and the mean time in us from a reading to the end of the
    /// command that follows from it.
    ///
    /// # Errors
    ///
    /// A limit is passed, or the link fails.
    pub(super) fn drive_by(
        &mut self,
        us: u64,
        mut law: impl FnMut(i32) -> i16,
    ) -> Result<(Trace, f64), Trouble> {
        // For the amplifier, and the current limit.
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

    /// Starts a move of the machine's own rate and acceleration.
    ///
    /// # Errors
    ///
    /// The link fails.
    pub(super) fn start_move(&mut self, goal: i32) -> Result<(), Trouble> {
        self.rig
            .go_to(goal, self.settings.rate, self.settings.acceleration)
    }

    /// The next reading, of an axis within its limits.
    ///
    /// # Errors
    ///
    /// A limit is passed, or the link fails.
    pub(super) fn sample(&mut self, is_servo_on: bool) -> Result<Sample, Trouble> {
        let before_us = self.rig.now_us();
        let sample = self.rig.sample()?;
        self.samples += 1;
        self.sampled_us += sample.us.saturating_sub(before_us);
        let at = || counts(sample.position);
        let [low, high] = self.settings.travel;
        // Without the servo the module always says so, and a drive needs twice the limit: what it
        // would not let pass is watched here.
        let is_lost = if is_servo_on {
            sample.status.contains(Status::POSITION_ERROR)
        } else {
            sample.position.abs_diff(self.centre) > u32::from(self.settings.gains.error_limit)
        };
        if !sample.status.contains(Status::POWER_ON) {
            Err(Trouble::NoPower {
                axis: self.settings.letter,
            })
        } else if sample.status.contains(Status::OVERCURRENT) {
            Err(Trouble::OverCurrent { at: at() })
        } else if is_lost {
            Err(Trouble::PositionError { at: at() })
        } else if !(low..=high).contains(&sample.position) {
            Err(Trouble::OutsideTravel {
                goal: at(),
                travel: [counts(low), counts(high)],
            })
        } else {
            Ok(sample)
        }
    }

    /// Motor without drive, whatever happened; a link that is gone has been told already.
    pub fn release(&mut self) {
        let _ = self.rig.release();
    }
}

impl Trace {
    /// Positions every `period_s` seconds from the start on, between readings on a straight line.
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

/// `1 count`, `12 counts`.
pub fn counts(number: i32) -> String {
    match number {
        1 | -1 => format!("{number} count"),
        _ => format!("{number} counts"),
    }
}
