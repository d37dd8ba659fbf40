//! `husillo calibrate circles`: the remaining backlash at the ends of circles, next to the values
//! measured on the original.

use super::bench::SimulatedBench;
use crate::cli::CirclesArgs;
use crate::console::reporter::Reporter;
use husillo_metrology::calibration::backlash::{CIRCLE_ENDS, left_at_ends};
use husillo_simulator::machines::machine_file::{MachineFile, Travel};
use husillo_simulator::programs::setup;
use serde_json::json;

/// Radius in mm, and the values measured at the ends of such a circle on the original, um, in the
/// order of [`CIRCLE_ENDS`].
///
/// # Source
///
/// Table 15 of the original: Ps is the top, Ei the left end, Pi the bottom, Ed the right end.
const MEASURED: [(f64, [f64; 4]); 3] = [
    (3.0, [8.0, 21.0, 30.0, 51.0]),
    (2.0, [9.0, 21.0, 13.0, 25.0]),
    (1.0, [9.0, 18.0, 3.0, 12.0]),
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
    out: &mut Reporter<'_>,
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
    let has_map = file.backlash.maps.iter().any(Option::is_some);
    let ends = CIRCLE_ENDS.join("  ");
    out.text(format_args!(
        "Remaining backlash at the ends of circles around X{:.1} Y{:.1}, um\n\n\
         radius  screws                 {ends}",
        centre[0], centre[1]
    ));
    for (radius, measured) in MEASURED {
        let mut rows = vec![("one value per axis", setup::one_value(file))];
        if has_map {
            rows.push(("the file's map", setup::maps(file)?));
        }
        for (name, maps) in rows {
            let left = left_at_ends(&mut SimulatedBench::new(file, maps)?, centre, radius)?;
            print_row(out, radius, name, left);
        }
        print_row(out, radius, "the original's", measured);
    }
    Ok(())
}

fn print_row(out: &mut Reporter<'_>, radius: f64, screws: &str, ends: [f64; 4]) {
    let [top, left, bottom, right] = ends;
    out.tell(
        format_args!("{radius:4} mm  {screws:20} {top:5.1} {left:5.1} {bottom:7.1} {right:6.1}"),
        || {
            json!({
                "radius_mm": radius,
                "screws": screws,
                "top_um": top,
                "left_um": left,
                "bottom_um": bottom,
                "right_um": right,
            })
        },
    );
}
