//! `husillo calibrate circles`: the remaining backlash at the ends of circles, next to the values
//! measured on the original.

use super::bench::SimulatedBench;
use crate::calibrating::CirclesArgs;
use crate::machines::machine_file::{MachineFile, Travel};
use crate::programs::setup;
use husillo_metrology::calibration::backlash::{CIRCLE_ENDS, left_at_ends};
use std::io::Write;

/// Radius in mm, and the values measured at the four ends of such a circle, um. The source does not
/// say which end is which.
const MEASURED: [(f64, [u32; 4]); 3] = [
    (3.0, [21, 51, 8, 30]),
    (2.0, [21, 25, 9, 13]),
    (1.0, [18, 12, 9, 3]),
];

/// Cuts the circles with one value per axis, and with the map of the file if it has one. Prints
/// both next to the measured values.
///
/// # Errors
///
/// The circles do not fit into the work area, or the machine has no simulated screws.
pub fn print_circles(
    args: &CirclesArgs,
    file: &MachineFile,
    out: &mut dyn Write,
) -> Result<(), String> {
    let mut centre = [0.0; 2];
    for (centre, axis) in centre.iter_mut().zip(&file.axes) {
        let Travel::Range([low, high]) = axis.travel else {
            return Err(format!(
                "{}: the travel of X and Y must be known",
                args.machine
            ));
        };
        *centre = (low + high) as f64 / 2e6;
    }
    let has_map = file.lash.maps.iter().any(Option::is_some);
    let failed = |error: std::io::Error| error.to_string();
    let ends = CIRCLE_ENDS.join("  ");
    writeln!(
        out,
        "Left at the ends of circles around X{:.1} Y{:.1}, um. The measured values are in the \
         order of their source, which does not name the ends\n\n\
         radius  screws                 {ends}   measured",
        centre[0], centre[1]
    )
    .map_err(failed)?;
    for (radius, measured) in MEASURED {
        let mut rows = vec![("one value per axis", setup::one_value(file))];
        if has_map {
            rows.push(("the file's map", setup::maps(file)?));
        }
        for (name, maps) in rows {
            let left = left_at_ends(&mut SimulatedBench::new(file, maps)?, centre, radius)?;
            let [top, at_left, bottom, right] = left;
            writeln!(
                out,
                "{radius:4} mm  {name:20} {top:5.1} {at_left:5.1} {bottom:7.1} {right:6.1}   {}",
                measured.map(|um| um.to_string()).join(", ")
            )
            .map_err(failed)?;
        }
    }
    Ok(())
}
