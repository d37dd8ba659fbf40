//! One axis of a machine file.

use super::driver::Driver;
use super::home::Home;
use super::pulse;
use super::rates::{Rates, positive};
use super::step;
use super::step_mode::StepMode;
use super::travel::Travel;
use crate::machines::encoder_file::EncoderFile;
use crate::machines::power::Power;
use crate::machines::table::Table;
use husillo_metrology::quantity::{Fraction, Quantity};
use husillo_stepper::PulseNanoseconds;
use std::ops::Range;
use toml::de::DeValue;

/// One axis.
#[allow(dead_code)] // homing is not simulated yet
#[derive(Clone, Debug)]
pub struct AxisFile {
    /// `X`, `Y`, `Z`, or one of `A`, `B`, `C`, `U`, `V`, `W` and `E`.
    pub letter: u8,
    /// Whether its lengths are millionths of a degree, and its speeds those of an angle.
    pub is_rotary: bool,
    /// Whether absolute positions are less than a turn, and their sign is the direction.
    pub is_wrapped: bool,
    /// Nanometres per motor step.
    pub step: Fraction,
    /// Limits of the machine coordinate.
    pub travel: Travel,
    /// Span of the travel in the file, for messages.
    pub travel_span: Range<usize>,
    /// Backlash, whole motor steps.
    pub backlash_steps: u32,
    /// Rate at which a move may start, steps/s.
    pub start_rate: u32,
    /// Largest rate, steps/s.
    pub max_rate: u32,
    /// Rate above which the motor loses steps, steps/s; `None`: never.
    pub pull_out_rate: Option<u32>,
    /// Acceleration, steps/s^2; `None`: no ramps.
    pub acceleration: Option<u32>,
    /// Jerk, steps/s^3; `None`: no limit.
    pub jerk: Option<u32>,
    /// Largest change of the rate at a corner, steps/s; `None`: no limit.
    pub junction: Option<u32>,
    /// Motor driver.
    pub driver: Driver,
    /// Times of the pulses of a step and direction driver.
    pub pulse: PulseNanoseconds,
    /// Step mode of the driver.
    pub mode: StepMode,
    /// Homing, if the axis has a switch.
    pub home: Option<Home>,
    /// Winding, chopper, rotor and load, if they are known.
    pub power: Option<Power>,
    /// Encoder on the motor, if there is one.
    pub encoder: Option<EncoderFile>,
}

/// The value of a missing key.
const NONE: DeValue<'_> = DeValue::Boolean(false);

impl AxisFile {
    /// Reads the table of an axis of a machine with this timer.
    pub(super) fn read(table: &mut Table<'_, '_>, letter: u8, timer_hz: u32) -> Option<Self> {
        let kinds = [("linear", false), ("rotary", true)];
        let is_rotary = table.choice("kind", &kinds).unwrap_or(false);
        if is_rotary != matches!(letter, b'A' | b'B' | b'C') {
            let (_, span) = table.value("kind").unwrap_or((&NONE, table.span()));
            let message = format!(
                "axis {} is {}",
                char::from(letter),
                if is_rotary {
                    "linear"
                } else {
                    "rotary: `kind = \"rotary\"`"
                }
            );
            table.wrong(
                span,
                &message,
                "A, B and C are rotary, all others are linear",
            );
        }
        table.set_rotary(is_rotary);
        let is_wrapped = is_rotary && table.boolean("wrapped").unwrap_or(false);
        let step = step::read(table, is_rotary);
        let (travel, travel_span) = Travel::read(table, step);
        let backlash = table.quantity(
            "backlash",
            "a length as in \"204 um\", or steps",
            |quantity| match quantity {
                Quantity::Length(length) => length
                    .over(step)
                    .and_then(|steps| u32::try_from(steps).ok()),
                Quantity::Steps(steps) => u32::try_from(steps.rounded()).ok(),
                _ => None,
            },
        );
        let rates = Rates::read(table, step);
        let driver = Driver::read(table);
        let pulse = pulse::read(table, driver, rates.max, timer_hz);
        let acceleration = table.quantity(
            "acceleration",
            "as in \"300 mm/s^2\", \"300 deg/s^2\" or, in steps/s^2, \"2000 Hz/s\"",
            |quantity| match quantity {
                Quantity::Acceleration(value) => positive(value.rounded()),
                Quantity::AxisAcceleration(nm_per_s2) => nm_per_s2.over(step).and_then(positive),
                _ => None,
            },
        );
        Some(Self {
            letter,
            is_rotary,
            is_wrapped,
            step,
            travel,
            travel_span,
            backlash_steps: backlash.unwrap_or(0),
            // Without an acceleration there are no ramps.
            start_rate: rates.start.unwrap_or(match acceleration {
                Some(_) => 0,
                None => rates.max,
            }),
            max_rate: rates.max,
            pull_out_rate: rates.pull_out,
            acceleration,
            jerk: table.quantity(
                "jerk",
                "as in \"5000 mm/s^3\", \"5000 deg/s^3\" or, in steps/s^3, \"5000 Hz/s^2\"",
                |quantity| match quantity {
                    Quantity::Jerk(value) => positive(value.rounded()),
                    Quantity::AxisJerk(nm_per_s3) => nm_per_s3.over(step).and_then(positive),
                    _ => None,
                },
            ),
            junction: rates.junction,
            driver,
            pulse,
            mode: StepMode::read(table),
            home: table.optional_table("home", |home| Home::read(home, step)),
            power: table.optional_table("motor", Power::read).flatten(),
            encoder: table
                .optional_table("encoder", |table| EncoderFile::read(table, step, rates.max))
                .flatten(),
        })
    }

    /// The shortest interval between two steps that the motor follows, in timer ticks, rounded
    /// down. It follows from the pull-out rate, or from winding and load. 0: no limit is known.
    pub fn pull_out_ticks(&self, timer_hz: u32) -> u32 {
        let by_winding = || self.power.as_ref().and_then(Power::pull_out_hz);
        match self.pull_out_rate {
            Some(rate) => timer_hz / rate.max(1),
            // The cast saturates.
            None => by_winding().map_or(0, |hz| (f64::from(timer_hz) / hz) as u32),
        }
    }
}
