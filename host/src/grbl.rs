//! Grbl controllers: the settings of a machine file, and `husillo jog -m grbl`.

use crate::by_hand;
use crate::cli::Jog;
use crate::console::reporter::Reporter;
use crate::console::sharing::share;
use crate::console::stop::stop_requests;
use husillo_clients::grbl::{Action, BAUD, Hand, open};
use husillo_gcode::Dialect;
use husillo_simulator::machines::machine_file::MachineFile;
use husillo_simulator::programs::setup;
use husillo_transports::grbl::Settings;

/// The settings of a mill: steps, rates, ramps and travel of its axes.
///
/// # Errors
///
/// The machine has no travel or ramps that Grbl's settings can hold.
pub fn settings(file: &MachineFile) -> Result<Settings, String> {
    let config = setup::config(file, Dialect::GRBL)?;
    let mut settings = Settings::DEFAULT;
    // Grbl has X, Y and Z.
    for (number, axis) in (0_u8..3).zip(config.axes) {
        let mm_per_step = f64::from(axis.scale.nm()) / f64::from(axis.scale.steps()) / 1e6;
        let travel = axis
            .travel
            .map(|[least, most]| (most.0 - least.0) as f64 / 1e6);
        let acceleration = axis
            .ramp
            .map(|ramp| f64::from(ramp.acceleration_hz_per_s) * mm_per_step);
        let values = [
            (100, Some(1.0 / mm_per_step)),
            (110, Some(f64::from(axis.max_rate_hz) * mm_per_step * 60.0)),
            (120, acceleration),
            (130, travel),
        ];
        for (first, value) in values {
            let Some(value) = value else { continue };
            let text = format!("{value:.3}");
            settings
                .write(first + number, text.as_bytes())
                .map_err(|error| {
                    format!(
                        "{}: ${} = {text}: {}",
                        file.path,
                        first + number,
                        error.text()
                    )
                })?;
        }
    }
    Ok(settings)
}

/// `husillo jog`. Returns whether all actions succeeded.
///
/// # Errors
///
/// A sentence about a wrong action, before anything moves.
pub fn jog(args: &Jog, out: &mut Reporter<'_>) -> Result<bool, String> {
    let actions = Action::parse(&args.actions)?;
    let [name] = &args.port[..] else {
        return Err("a Grbl controller is driven alone: one --port".into());
    };
    if args.figure.is_some() || args.without_answers || args.inch {
        return Err("--figure, --without-answers and --inch are not for a Grbl controller".into());
    }
    if args.lease.is_some_and(|ms| ms > 0) {
        return Err("a Grbl controller has no lease: leave --lease out".into());
    }
    let baud = args.baud.unwrap_or(BAUD);
    let stop = stop_requests()?;
    let wire = open(name, baud)?;
    share("grbl", name, baud);
    let mut hand = match Hand::new(wire, stop) {
        Ok(hand) => hand,
        Err(sentence) => {
            out.failed(name, &sentence);
            return Ok(false);
        }
    };
    Ok(by_hand::carry_out(name, &actions, &mut hand, out))
}
