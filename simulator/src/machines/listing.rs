//! `husillo machines`: lists the machines and shows their figures.

use crate::machines::machine_file::{AxisFile, MEASURING, MachineFile, Travel, work};
use crate::machines::power::Power;
use husillo_gcode::Nm;
use husillo_metrology::calibration::backlash::Map;
use husillo_sim::text::counted;
use serde::Serialize;
use std::fmt::Write;

/// Electrical cycles per second at which the current of a winding is shown.
const CYCLES_HZ: [f64; 6] = [10.0, 30.0, 60.0, 100.0, 131.2, 200.0];

/// A machine as it is shown.
#[derive(Debug, Serialize)]
pub struct Shown {
    name: String,
    title: String,
    file: String,
    axes: Vec<ShownAxis>,
    /// The zeros of work frames that the file states.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    work: Vec<ShownFrame>,
}

/// The zero of a work frame.
#[derive(Debug, Serialize)]
struct ShownFrame {
    /// `G54` to `G59.3`.
    frame: String,
    /// Letter and position of each axis, nm or millionths of a degree.
    zero: Vec<(char, i64)>,
}

#[derive(Debug, Serialize)]
struct ShownAxis {
    axis: char,
    /// Whether its lengths are degrees. A nanometre then stands for a millionth of a degree.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    is_rotary: bool,
    /// nm per step.
    step_nm: f64,
    travel_mm: Option<[f64; 2]>,
    /// Programs cannot move this axis. The machine moves it by itself.
    is_fixed: bool,
    backlash_steps: u32,
    backlash_um: f64,
    /// Its backlash by position, if the file has a map.
    backlash_map: Option<ShownMap>,
    max_rate_hz: u32,
    max_speed_mm_per_min: f64,
    pull_out_rate_hz: Option<u32>,
    motor: Option<ShownMotor>,
}

#[derive(Debug, Serialize)]
struct ShownMotor {
    time_constant_ms: f64,
    /// Full steps per second.
    pull_out_full_steps_hz: Option<f64>,
    chopper: Option<ShownChopper>,
    filter_inductance_uh: f64,
    filter_capacitance_nf: f64,
    current: Vec<ShownCurrent>,
}

#[derive(Debug, Serialize)]
struct ShownChopper {
    off_us: f64,
    peak_a: f64,
}

#[derive(Debug, Serialize)]
struct ShownCurrent {
    cycle_hz: f64,
    supply_a: f64,
    rms_a: f64,
    peak_a: f64,
    torque_nm: f64,
}

/// Backlash by position.
#[derive(Debug, Serialize)]
struct ShownMap {
    /// Each axis of the map, with its number of positions.
    along: Vec<(char, usize)>,
    least_um: f64,
    most_um: f64,
}

/// Collects the figures of a machine.
pub fn show(machine: &MachineFile) -> Shown {
    Shown {
        name: machine.name.clone(),
        title: machine.title.clone(),
        file: machine.path.clone(),
        axes: (machine.axes.iter().enumerate())
            .map(|(index, file)| {
                let map = machine.backlash.maps.get(index);
                axis(file, map.and_then(Option::as_ref))
            })
            .collect(),
        work: frames(machine),
    }
}

fn frames(machine: &MachineFile) -> Vec<ShownFrame> {
    let stated = work::NAMES.iter().zip(machine.work);
    stated
        .filter_map(|(name, zero)| {
            let letters = machine.letters.letters().map(char::from);
            Some(ShownFrame {
                frame: name.to_ascii_uppercase().replace('_', "."),
                zero: letters.zip(zero?.map(|Nm(nm)| nm)).collect(),
            })
        })
        .collect()
}

fn axis(file: &AxisFile, map: Option<&Map>) -> ShownAxis {
    let step_nm = file.step.num as f64 / file.step.den as f64;
    let travel = match file.travel {
        Travel::Range(range) => Some(range.map(|nm| nm as f64)),
        Travel::Unknown | Travel::Unlimited => None,
    };
    let is_fixed = travel.is_some_and(|[low, high]| high - low < step_nm);
    ShownAxis {
        axis: char::from(file.letter),
        is_rotary: file.is_rotary,
        step_nm,
        travel_mm: travel
            .filter(|_| !is_fixed)
            .map(|range| range.map(|nm| nm / 1e6)),
        is_fixed,
        backlash_steps: file.backlash_steps,
        backlash_um: f64::from(file.backlash_steps) * step_nm / 1e3,
        backlash_map: map.map(|map| {
            let um = |steps: Option<&u32>| f64::from(*steps.unwrap_or(&0)) * step_nm / 1e3;
            let axes = map.axes().into_iter().zip(map.positions());
            ShownMap {
                along: axes
                    .filter(|(_, positions)| positions.len() > 1)
                    .map(|(axis, positions)| (char::from(b"XYZ"[axis]), positions.len()))
                    .collect(),
                least_um: um(map.entries().iter().min()),
                most_um: um(map.entries().iter().max()),
            }
        }),
        max_rate_hz: file.max_rate,
        max_speed_mm_per_min: f64::from(file.max_rate) * step_nm * 60.0 / 1e6,
        pull_out_rate_hz: file.pull_out_rate,
        motor: file.power.as_ref().map(motor),
    }
}

fn motor(power: &Power) -> ShownMotor {
    let [inductance_h, capacitance_f] = power.filter();
    let current = CYCLES_HZ.map(|cycle_hz| {
        let current = power.winding.current(cycle_hz);
        ShownCurrent {
            cycle_hz,
            supply_a: current.supply_a + power.bridges_a,
            rms_a: current.rms_a,
            peak_a: current.peak_a,
            torque_nm: power.winding.torque(&power.rotor, cycle_hz),
        }
    });
    ShownMotor {
        time_constant_ms: power.winding.time_constant_s() * 1e3,
        pull_out_full_steps_hz: power.pull_out_hz(),
        chopper: power.winding.chopper.map(|chopper| ShownChopper {
            off_us: chopper.off_s * 1e6,
            peak_a: chopper.peak_a,
        }),
        filter_inductance_uh: inductance_h * 1e6,
        filter_capacitance_nf: capacitance_f * 1e9,
        current: current.into(),
    }
}

impl Shown {
    /// Lines for people.
    pub fn text(&self) -> String {
        let mut text = format!("{}: {} ({})\n", self.name, self.title, self.file);
        for axis in &self.axes {
            // Writing to a string never fails.
            let _ = axis.write(&mut text);
        }
        if !self.work.is_empty() {
            text.push_str("\n  work offsets\n");
        }
        for ShownFrame { frame, zero } in &self.work {
            let zero = zero
                .iter()
                .map(|(letter, nm)| format!("{letter}{}", Nm(*nm)))
                .collect::<Vec<_>>();
            let _ = writeln!(text, "  {frame:5}  {}", zero.join(" "));
        }
        text
    }
}

impl ShownAxis {
    fn write(&self, out: &mut String) -> std::fmt::Result {
        let (step, unit) = match self.is_rotary {
            true => (self.step_nm / 1e6, "degrees"),
            false => (self.step_nm / 1e3, "um"),
        };
        write!(out, "\n  {}  {step:.4} {unit} per step", self.axis)?;
        let unit = if self.is_rotary { "degrees" } else { "mm" };
        if let Some([low, high]) = self.travel_mm {
            write!(out, ", travel {low} to {high} {unit}")?;
        }
        if self.is_fixed {
            write!(out, ", moved only by the machine, from sensor to sensor")?;
        }
        if let Some(map) = &self.backlash_map {
            let along = map
                .along
                .iter()
                .map(|(axis, places)| format!("{} along {axis}", counted(places, "position")));
            write!(
                out,
                ", backlash by position: {:.1} to {:.1} um, {}",
                map.least_um,
                map.most_um,
                along.collect::<Vec<_>>().join(" and ")
            )?;
        } else if self.backlash_steps > 0 {
            write!(
                out,
                ", backlash {} ({:.1} um)",
                counted(self.backlash_steps, "step"),
                self.backlash_um
            )?;
        }
        let speed = self.max_speed_mm_per_min;
        writeln!(
            out,
            "\n     at most {} Hz, {speed:.2} {unit}/min",
            self.max_rate_hz
        )?;
        if let Some(rate) = self.pull_out_rate_hz {
            writeln!(out, "     loses steps above {rate} Hz without a ramp")?;
        }
        match &self.motor {
            Some(motor) => motor.write(out),
            None => Ok(()),
        }
    }
}

impl ShownMotor {
    fn write(&self, out: &mut String) -> std::fmt::Result {
        writeln!(
            out,
            "     winding  time constant {:.3} ms",
            self.time_constant_ms
        )?;
        if let Some(ShownChopper { off_us, peak_a }) = self.chopper {
            writeln!(
                out,
                "     chopper  T_off {off_us:.1} us, I_peak {peak_a:.3} A"
            )?;
        }
        let (inductance, capacitance) = (self.filter_inductance_uh, self.filter_capacitance_nf);
        writeln!(
            out,
            "     filter   L {inductance:.0} uH, C {capacitance:.1} nF"
        )?;
        match self.pull_out_full_steps_hz {
            Some(hz) => writeln!(
                out,
                "     pull-out {hz:.0} full steps per second under its load"
            )?,
            None => writeln!(out, "     pull-out none: the motor does not turn the load")?,
        }
        writeln!(out, "     cycles/s  supply A   rms A  peak A  torque mN m")?;
        for row in &self.current {
            writeln!(
                out,
                "     {:8.1}  {:8.3}  {:6.3}  {:6.3}  {:11.3}",
                row.cycle_hz,
                row.supply_a,
                row.rms_a,
                row.peak_a,
                row.torque_nm * 1e3
            )?;
        }
        Ok(())
    }
}

/// A built-in machine.
#[derive(Debug, Serialize)]
pub struct Listed {
    name: &'static str,
    title: String,
}

/// The built-in machines.
///
/// # Errors
///
/// The file of a built-in machine has a mistake.
pub fn machines() -> Result<Vec<Listed>, String> {
    let mut machines = Vec::new();
    for name in MachineFile::names() {
        let machine =
            MachineFile::built_in(name).ok_or_else(|| format!("{name}: its file is wrong"))?;
        let title = machine.title;
        machines.push(Listed { name, title });
    }
    for (name, _, file) in MEASURING {
        let table: toml::Table =
            toml::from_str(file).map_err(|error| format!("{name}: {error}"))?;
        let title = table.get("title").and_then(toml::Value::as_str);
        let title = title.unwrap_or_default().to_owned();
        machines.push(Listed { name, title });
    }
    Ok(machines)
}

/// The built-in machines, one per line.
///
/// # Errors
///
/// The file of a built-in machine has a mistake. The message names the machine.
pub fn list() -> Result<String, String> {
    let line = |Listed { name, title }| format!("{name:14}{title}\n");
    Ok(machines()?.into_iter().map(line).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use husillo_metrology::originals::microfactory::Coils;

    /// The currents equal those of the model that was fitted to measured ones. The machine lost
    /// steps above 131.2 Hz.
    #[test]
    fn current_and_pull_out_of_the_microfactory_equal_the_measured_ones() {
        let machine = MachineFile::built_in("microfactory").unwrap();
        let motor = show(&machine).axes.remove(0).motor.unwrap();
        let coils = Coils::fitted();
        for row in &motor.current {
            let fitted_a = coils.amperes(4.0 * row.cycle_hz);
            assert!((row.supply_a / fitted_a - 1.0).abs() < 0.003, "{fitted_a}");
        }
        let pull_out = motor.pull_out_full_steps_hz.unwrap();
        assert!((pull_out / 524.8 - 1.0).abs() < 0.01, "{pull_out}");
    }

    /// The formulas of the power stage, calculated by hand: 0.69 * 56 k * 0.82 n, 0.083 * 5 / 1, a
    /// tenth of 10 mH, 4e-10 / 1 mH.
    #[test]
    fn chopper_and_filter_equal_a_calculation_by_hand() {
        let machine = MachineFile::built_in("micromill").unwrap();
        let text = show(&machine).text();
        for part in ["T_off 31.7 us, I_peak 0.415 A", "L 1800 uH, C 222.2 nF"] {
            assert!(text.contains(part), "{part} in {text}");
        }
    }
}
