//! `[axis.x.encoder]` of a machine file, and simulated losses to test it.

use crate::machines::table::Table;
use husillo_machine::{AxisEncoder, OnLoss};
use husillo_metrology::quantity::{Fraction, Quantity};
use std::str::FromStr;

/// The encoder of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderFile {
    /// The settings without their times, which depend on the timer of the machine.
    pub encoder: AxisEncoder,
    settle_us: u64,
}

impl EncoderFile {
    /// Reads the table of an axis with this step in nm and this largest rate.
    pub fn read(table: &mut Table<'_, '_>, step: Fraction, max_rate: u32) -> Option<Self> {
        let counts_per_mm = table.integer("counts_per_mm", 1..=1_000_000);
        if counts_per_mm.is_none() {
            table.missing("counts_per_mm");
        }
        let tolerance = table.quantity("tolerance", "steps or a length", |quantity| {
            let steps = match quantity {
                Quantity::Steps(steps) => steps.rounded(),
                Quantity::Length(length) => length.over(step)?,
                _ => return None,
            };
            u32::try_from(steps).ok().filter(|steps| *steps > 0)
        });
        if tolerance.is_none() {
            table.missing("tolerance");
        }
        let choices = [
            ("report", OnLoss::Report),
            ("stop", OnLoss::Stop),
            ("correct", OnLoss::Correct),
        ];
        let on_loss = table.choice("on_loss", &choices);
        let rate = table.quantity("correction_rate", "a rate as in \"100 Hz\"", |q| match q {
            Quantity::Rate(rate) => u32::try_from(rate.rounded()).ok().filter(|rate| *rate > 0),
            _ => None,
        });
        let settle = table.quantity(
            "settle",
            "a time as in \"20 ms\"",
            |quantity| match quantity {
                Quantity::Time(micros) => u64::try_from(micros.rounded()).ok(),
                _ => None,
            },
        );
        let attempts = table.integer("attempts", 1..=255);
        // Counts per step: counts_per_mm * step / 10^6 nm.
        let ratio = Fraction::new(
            i128::from(counts_per_mm?) * i128::from(step.num),
            i128::from(step.den) * 1_000_000,
        );
        let short = |number: i64| u32::try_from(number).ok().filter(|n| *n <= 1 << 20);
        let ratio = ratio.and_then(|ratio| Some((short(ratio.num)?, short(ratio.den)?)));
        let Some((counts, steps)) = ratio else {
            if let Some((_, span)) = table.value("counts_per_mm") {
                let label = "the ratio of counts to steps needs integers up to 2^20";
                table.wrong(span, "`counts_per_mm` does not fit the step", label);
            }
            return None;
        };
        Some(Self {
            encoder: AxisEncoder {
                counts,
                steps,
                tolerance_steps: tolerance?,
                on_loss: on_loss.unwrap_or(OnLoss::Report),
                correction_rate_hz: rate.unwrap_or(max_rate.div_ceil(2)),
                settle_ticks: 0,
                attempts: attempts.and_then(|n| u8::try_from(n).ok()).unwrap_or(3),
            },
            settle_us: settle.unwrap_or(20_000),
        })
    }

    /// The settings for a machine with this timer.
    pub fn encoder(&self, timer_hz: u32) -> AxisEncoder {
        let ticks = self.settle_us.saturating_mul(timer_hz.into()) / 1_000_000;
        AxisEncoder {
            settle_ticks: u32::try_from(ticks).unwrap_or(u32::MAX),
            ..self.encoder
        }
    }
}

/// A simulated loss: something pushes the motor of an axis before a step event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Push {
    /// 0 for X to 2 for Z.
    pub axis: usize,
    /// Number of the step event.
    pub event: u64,
    /// Steps that the motor is pushed, signed.
    pub steps: i32,
}

impl FromStr for Push {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split(':').collect();
        let push = match parts[..] {
            [axis, event, steps] => ["x", "y", "z"]
                .iter()
                .position(|letter| axis.eq_ignore_ascii_case(letter))
                .and_then(|axis| {
                    Some(Self {
                        axis,
                        event: event.parse().ok()?,
                        steps: steps.parse().ok()?,
                    })
                }),
            _ => None,
        };
        push.ok_or_else(|| "expected AXIS:EVENT:STEPS as in x:5000:-8".into())
    }
}
