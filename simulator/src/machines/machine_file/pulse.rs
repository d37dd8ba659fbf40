//! `[axis.x.pulse]` of a machine file.

use super::driver::Driver;
use crate::machines::table::Table;
use husillo_metrology::quantity::{Fraction, Quantity};
use husillo_stepper::PulseNanoseconds;

/// Reads the pulse of a driver, and checks that it permits the largest rate.
pub(super) fn read(
    table: &mut Table<'_, '_>,
    driver: Driver,
    max_rate: u32,
    timer_hz: u32,
) -> PulseNanoseconds {
    let pulse = match driver {
        Driver::StepDirection => table.optional_table("pulse", read_pulse),
        _ => None,
    };
    let pulse = pulse.unwrap_or(PulseNanoseconds::A4988);
    let shortest_ticks = pulse.ticks(timer_hz).shortest_interval_ticks();
    let highest = timer_hz / shortest_ticks.max(1);
    if let (Driver::StepDirection, Some((_, span))) = (driver, table.value("max_rate")) {
        if max_rate > highest {
            let message = format!(
                "`max_rate` is {max_rate} Hz, but the pulses of the driver permit at most \
                 {highest} Hz"
            );
            table.wrong(
                span,
                &message,
                "lower it, or set the times of the driver in `pulse`",
            );
        }
    }
    pulse
}

/// Reads `[axis.x.pulse]`. Missing times are those of the A4988.
fn read_pulse(table: &mut Table<'_, '_>) -> PulseNanoseconds {
    let mut time = |key, default| {
        let expected = "a time up to 1 ms as in \"200 ns\" or \"1.9 us\"";
        let read = table.quantity(key, expected, |quantity| match quantity {
            Quantity::Time(us) => us
                .over(Fraction { num: 1, den: 1000 })
                .and_then(|ns| u32::try_from(ns).ok())
                .filter(|ns| *ns <= 1_000_000),
            _ => None,
        });
        read.unwrap_or(default)
    };
    let default = PulseNanoseconds::A4988;
    PulseNanoseconds {
        setup: time("setup", default.setup),
        hold: time("hold", default.hold),
        high: time("high", default.high),
        low: time("low", default.low),
    }
}
