//! `husillo calibrate circles`: what is left at the ends of circles, beside what was measured on the original.

use super::bench::Bench;
use crate::calibrating::CirclesArgs;
use crate::machines::machine_file::{MachineFile, Travel};
use crate::programs::setup;
use std::f64::consts::FRAC_1_SQRT_2;
use std::io::Write;

/// Radius in mm, and what was measured at the four ends of such a circle, um. Which end is which was not written down.
const MEASURED: [(f64, [u32; 4]); 3] = [
    (3.0, [21, 51, 8, 30]),
    (2.0, [21, 25, 9, 13]),
    (1.0, [18, 12, 9, 3]),
];

/// Ends in the order in which a circle that begins at 45 degrees passes them: name, axis that turns round there, and which way it
/// went before.
const ENDS: [(&str, usize, f64); 4] = [
    ("top", 1, 1.0),
    ("left", 0, -1.0),
    ("bottom", 1, -1.0),
    ("right", 0, 1.0),
];

/// Cuts the circles with one value an axis, and with the file's map where it has one, and prints both beside the measured ones.
///
/// # Errors
///
/// A sentence: a work area that the circles do not fit, or no simulated screws.
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
    let ends = ENDS.map(|(name, ..)| name).join("  ");
    writeln!(
        out,
        "Left at the ends of circles around X{:.1} Y{:.1}, um; measured: in the order of the description, which does not name the ends\n\n\
         radius  screws                 {ends}   measured",
        centre[0], centre[1]
    )
    .map_err(failed)?;
    for (radius, measured) in MEASURED {
        let mut rows = vec![("one value an axis", setup::one_value(file))];
        if has_map {
            rows.push(("the file's map", setup::maps(file)?));
        }
        for (name, maps) in rows {
            let left = ends_of(&mut Bench::new(file, maps)?, centre, radius)?;
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

/// What is left at each end of a circle: how far the tool is off along the axis that turned round there, on its one flank and on the other.
fn ends_of(bench: &mut Bench, centre_mm: [f64; 2], radius_mm: f64) -> Result<[f64; 4], String> {
    let [x, y] = centre_mm;
    let reach = radius_mm * FRAC_1_SQRT_2;
    let (start, below) = ([x + reach, y + reach], [x + reach - 0.1, y + reach - 0.1]);
    bench.make(&format!("G0 X{:.5} Y{:.5}", below[0], below[1]), |_| {})?;
    bench.make(&format!("G0 X{:.5} Y{:.5}", start[0], start[1]), |_| {})?;
    // A tenth of the radius before an end and behind it the axis has its flank.
    let near = 0.9 * radius_mm;
    let mut off = [[None; 2]; 4];
    bench.make(
        &format!(
            "G3 X{:.5} Y{:.5} I{:.5} J{:.5} F1",
            start[0], start[1], -reach, -reach
        ),
        |moment| {
            let at = [0, 1].map(|axis| moment.sent_nm[axis] / 1e6 - centre_mm[axis]);
            for (off, (_, axis, side)) in off.iter_mut().zip(ENDS) {
                if at[axis] * side < near {
                    continue;
                }
                // Counter-clockwise: at the top X falls, at the left Y.
                let way = if axis == 1 { -at[0] } else { at[1] } * side;
                let behind = usize::from(way > 0.0);
                let value = (moment.tool_nm[axis] - moment.sent_nm[axis]) / 1e3;
                // The first before an end, the last behind it.
                if behind == 1 || off[0].is_none() {
                    off[behind] = Some(value);
                }
            }
        },
    )?;
    Ok(off.map(|[before, behind]| match (before, behind) {
        (Some(before), Some(behind)) => f64::abs(behind - before),
        _ => 0.0,
    }))
}
