//! The reported state of the controller as text.

use husillo_gcode::Nm;
use husillo_machine::Config;
use husillo_transports::micromill::State;
use std::fmt::Write as _;

/// Unit of printed positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthUnit {
    /// Millimetres with six decimals, which show nanometres.
    Millimetres,
    /// Inches with seven decimals. The last one is 2.54 nm.
    Inches,
}

/// How positions are printed.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// The steps of the mill.
    pub config: Config<3>,
    /// The unit of lengths.
    pub unit: LengthUnit,
}

impl LengthUnit {
    fn text(self, nm: i64) -> String {
        // The length is below 2.2 m, so the quotient is exact to the last printed digit.
        let (value, decimals) = match self {
            Self::Millimetres => (nm as f64 / 1e6, 6),
            Self::Inches => (nm as f64 / 25.4e6, 7),
        };
        let text = format!("{value:.decimals$}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        // A value that is rounded to zero has no sign.
        match text {
            "-0" => "0".into(),
            _ => text.into(),
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Millimetres => "mm",
            Self::Inches => "inch",
        }
    }

    fn row(self, name: &str, nm: [i64; 3]) -> String {
        let [x, y, z] = nm.map(|nm| self.text(nm));
        format!("  {name:<9} X {x} Y {y} Z {z} {}\n", self.name())
    }
}

/// Positions of the loads from machine zero, on the grid of the steps of `config`.
pub fn position(state: &State, config: &Config<3>) -> [Nm; 3] {
    let mut position = [Nm(0); 3];
    let axes = state.axes.iter().zip(&config.axes);
    for (position, (state, axis)) in position.iter_mut().zip(axes) {
        *position = Nm(axis.scale.position(state.load_steps));
    }
    position
}

/// The zero of the part, from machine zero.
pub fn work_zero(state: &State) -> [Nm; 3] {
    state.axes.map(|axis| Nm(axis.zero_nm.into()))
}

/// The position of the motors, and the point from which it counts.
pub fn motors(state: &State) -> String {
    let [x, y, z] = state.motor_steps();
    let from = match state.is_homed {
        true => "",
        false => " from the position at power-on",
    };
    format!("motors at x {x} y {y} z {z}{from}")
}

/// Compares the position of the motors with the steps reported since `before`. Returns a sentence
/// if they differ.
pub fn uncounted(before: &State, steps: &[i64; 3], now: &State) -> Option<String> {
    let differences = apart(before, steps, now);
    let [x, y, z] = differences;
    (differences != [0; 3]).then(|| {
        format!("the controller is x {x:+} y {y:+} z {z:+} steps from where its reported steps end")
    })
}

/// Difference between the position of the motors and the one to which `before` and the steps since
/// then lead.
fn apart(before: &State, steps: &[i64; 3], now: &State) -> [i64; 3] {
    let mut differences = [0; 3];
    let motors = before.motor_steps().into_iter().zip(now.motor_steps());
    for (difference, ((before, now), steps)) in differences.iter_mut().zip(motors.zip(steps)) {
        *difference = i64::from(now) - i64::from(before) - steps;
    }
    differences
}

/// A stepping motor loses steps in multiples of four, because four steps are a turn of its field.
const LEAST_LOSS_STEPS: i64 = 4;

/// Compares where the home switches of a mill closed with where they closed before. `steps` are the
/// steps reported during homing. `now` is the state after homing. Returns a sentence if steps were
/// lost since the last homing. Without encoders nothing else shows lost steps. `None` if the mill
/// was not homed before.
///
/// After homing the motor is always at the same position, whatever the real backlash is.
pub fn lost(before: &State, steps: &[i64; 3], now: &State) -> Option<String> {
    if !before.is_homed || !now.is_homed {
        return None;
    }
    let [x, y, z] = apart(before, steps, now);
    let is_lost = [x, y, z].iter().any(|lost| lost.abs() >= LEAST_LOSS_STEPS);
    is_lost.then(|| {
        format!(
            "before homing the motors were x {x:+} y {y:+} z {z:+} steps from where they were \
             reported: since the last homing steps were lost, or another backlash was set. Measure \
             what was made in between"
        )
    })
}

/// Machine and work coordinates, work zero, steps and backlash, each in a row.
pub fn report(state: &State, Frame { config, unit }: &Frame) -> String {
    let mut text = String::new();
    let zero = work_zero(state).map(|nm| nm.0);
    if state.is_homed {
        let machine = position(state, config).map(|nm| nm.0);
        let mut work = machine;
        for (work, zero) in work.iter_mut().zip(zero) {
            *work -= zero;
        }
        text += &unit.row("machine", machine);
        text += &unit.row("work", work);
        text += &unit.row("work zero", zero);
    } else {
        text += "  machine   unknown: not homed\n  work      unknown: not homed\n";
        text += &unit.row("work zero", zero);
    }
    let [x, y, z] = state.axes.map(|axis| axis.load_steps);
    let [of_x, of_y, of_z] = state.axes.map(|axis| axis.backlash_steps);
    // Writing to a string does not fail.
    let _ = write!(
        text,
        "  steps     x {x} y {y} z {z}, {}\n  backlash  x {of_x} y {of_y} z {of_z} steps",
        motors(state)
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use husillo_controllers::MicromillConfig;
    use husillo_transports::micromill::AxisState;

    #[test]
    fn a_report_has_all_frames() {
        let axis = |load_steps, ahead_steps, backlash_steps, zero_nm| AxisState {
            load_steps,
            ahead_steps,
            backlash_steps,
            zero_nm,
        };
        let state = State {
            axes: [
                axis(700, 1429, 1429, 420_000),
                axis(299, 0, 1271, 0),
                axis(-1, 0, 0, 0),
            ],
            is_homed: true,
        };
        let config = MicromillConfig::MICROMILL.machine;
        let unit = LengthUnit::Millimetres;
        let frame = Frame { config, unit };
        assert_eq!(
            report(&state, &frame),
            "  machine   X 0.098 Y 0.04186 Z -0.00014 mm\n  work      X -0.322 Y 0.04186 Z \
             -0.00014 mm\n  work zero X 0.42 Y 0 Z 0 mm\n  steps     x 700 y 299 z -1, motors at x \
             700 y -972 z -1\n  backlash  x 1429 y 1271 z 0 steps"
        );
        let unit = LengthUnit::Inches;
        let inches = report(&state, &Frame { config, unit });
        assert!(
            inches.starts_with("  machine   X 0.0038583 Y 0.001648 Z -0.0000055 inch\n"),
            "{inches}"
        );
        let lost = State {
            is_homed: false,
            ..state
        };
        let unknown = report(&lost, &frame);
        assert!(
            unknown.starts_with("  machine   unknown: not homed\n  work      unknown: not homed\n"),
            "{unknown}"
        );
        assert!(
            unknown.contains("z -1 from the position at power-on\n"),
            "{unknown}"
        );
    }
}
