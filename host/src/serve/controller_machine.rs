//! The machine behind a controller, as its settings describe it.

use husillo_simulator::machines::machine_file::MachineFile;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Ticks of the simulated timer in a second.
const TIMER_HZ: u32 = 8_000_000;

/// Reads a setting.
fn number(settings: &BTreeMap<u16, String>, number: u16, default: f64) -> f64 {
    let value = settings.get(&number).and_then(|text| text.parse().ok());
    value
        .filter(|value: &f64| value.is_finite() && *value > 0.0)
        .unwrap_or(default)
}

/// The machine. Its axes have limits of travel if the controller has soft limits.
///
/// # Errors
///
/// The settings have no sense for a machine.
pub fn machine(settings: &BTreeMap<u16, String>) -> Result<MachineFile, String> {
    let mut text = format!(
        "schema = 1\nname = \"controller\"\ntitle = \"Machine of the controller\"\n\
         timer_hz = {TIMER_HZ}\n"
    );
    let mut fastest: f64 = 0.0;
    for (axis, letter) in (0_u16..).zip(["x", "y", "z"]) {
        let step_um = 1000.0 / number(settings, 100 + axis, 250.0);
        let rate = number(settings, 110 + axis, 500.0);
        let acceleration = number(settings, 120 + axis, 10.0);
        let travel = match number(settings, 20, 0.0) > 0.0 {
            true => format!(
                "[\"{:.3} mm\", \"0 mm\"]",
                -number(settings, 130 + axis, 200.0)
            ),
            false => "\"unlimited\"".to_owned(),
        };
        fastest = fastest.max(rate);
        // Writing to a text does not fail.
        let _ = write!(
            text,
            "\n[axis.{letter}]\nstep = \"{step_um:.6} um\"\ntravel = {travel}\n\
             backlash = \"0 um\"\nmax_rate = \"{rate:.3} mm/min\"\n\
             acceleration = \"{acceleration:.3} mm/s^2\"\ndriver = \"step-direction\"\n"
        );
    }
    let deviation_um = number(settings, 11, 0.01) * 1000.0;
    let _ = write!(
        text,
        "\n[motion]\ncorner_deviation = \"{deviation_um:.3} um\"\nrapid = \"{fastest:.3} mm/min\"\n\
         top_feed = \"{fastest:.3} mm/min\"\n\n[idle]\npolicy = \"hold\"\n\n[probe]\n"
    );
    MachineFile::parse("controller", &text).map_err(|findings| {
        let all: Vec<_> = findings.iter().map(|one| one.message.as_str()).collect();
        format!("the settings of the controller: {}", all.join("; "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(pairs: &[(u16, &str)]) -> BTreeMap<u16, String> {
        let pairs = pairs.iter();
        pairs
            .map(|(number, value)| (*number, (*value).to_owned()))
            .collect()
    }

    #[test]
    fn settings_make_a_machine() {
        let of = [(20, "1"), (100, "400.000"), (110, "6000"), (130, "300.000")];
        let machine = machine(&settings(&of)).unwrap();
        assert_eq!(machine.axes.len(), 3);
        let step = machine.axes[0].step;
        assert_eq!(step.num as f64 / step.den as f64, 2500.0);
        use husillo_simulator::machines::machine_file::Travel;
        let Travel::Range(range) = machine.axes[0].travel else {
            panic!("no travel");
        };
        assert_eq!(range, [-300_000_000, 0]);
    }

    #[test]
    fn missing_settings_are_those_of_the_factory() {
        let machine = machine(&BTreeMap::new()).unwrap();
        assert!(machine.axes[2].acceleration.is_some());
    }
}
