//! Programs for the parser, shaped like the output of CAM systems. There is no randomness: the text
//! is the same in every run.

use std::f64::consts::FRAC_PI_2;
use std::fmt::Write as _;

const HEAD: &str =
    "G21 G17 G90 G94\nG54\nG0 X50.000 Y50.000 Z2.000\nM3 S1000\nG1 Z-0.500 F300\nF3000\n";
const TAIL: &str = "G0 Z5\nM5\nM2\n";

/// Appends one line; writing to a string cannot fail.
fn line(program: &mut String, text: std::fmt::Arguments<'_>) {
    let _ = program.write_fmt(text);
    program.push('\n');
}

/// About `bytes` bytes of short three-axis moves: a spiral with a ripple in Z, chords of 0.2 mm.
pub fn segments(bytes: usize) -> String {
    let mut program = String::from(HEAD);
    let mut angle = 0.0_f64;
    while program.len() < bytes {
        let radius = 5.0 + 35.0 * (0.5 - 0.5 * (angle / 157.0).cos());
        angle += 0.2 / radius;
        let (x, y) = (50.0 + radius * angle.cos(), 50.0 + radius * angle.sin());
        let z = -0.5 - 0.3 * (7.0 * angle).sin();
        line(&mut program, format_args!("G1 X{x:.3} Y{y:.3} Z{z:.3}"));
    }
    program.push_str(TAIL);
    program
}

/// About `bytes` bytes of circles of 1 to 3 mm, each of four quarter arcs with I and J. The last
/// arc of every fourth circle is a helix.
pub fn arcs(bytes: usize) -> String {
    let mut program = String::from(HEAD);
    let mut circle = 0_u32;
    program.push_str("G1 X50 Y50\n");
    while program.len() < bytes {
        let radius = 1.0 + f64::from(circle % 37) * 0.05;
        let centre = [50.0, 50.0 + radius];
        for quarter in 0..4_u32 {
            let from = f64::from(quarter) * FRAC_PI_2 - FRAC_PI_2;
            let to = from + FRAC_PI_2;
            let [i, j] = [-radius * from.cos(), -radius * from.sin()];
            let (x, y) = (centre[0] + radius * to.cos(), centre[1] + radius * to.sin());
            let depth = -0.5 - f64::from((circle / 4) % 2) * 0.1;
            if circle % 4 == 3 && quarter == 3 {
                line(
                    &mut program,
                    format_args!("G3 X{x:.3} Y{y:.3} Z{depth:.3} I{i:.3} J{j:.3}"),
                );
            } else {
                line(
                    &mut program,
                    format_args!("G3 X{x:.3} Y{y:.3} I{i:.3} J{j:.3}"),
                );
            }
        }
        circle += 1;
    }
    program.push_str(TAIL);
    program
}

/// About `bytes` bytes of everything: line numbers, comments, rapids, both forms of arcs, modal
/// lines, incremental moves, changes of feed and spindle.
pub fn mixed(bytes: usize) -> String {
    let mut program = String::from(HEAD);
    let mut pocket = 0_u32;
    let mut number = 10_u32;
    while program.len() < bytes {
        let angle = f64::from(pocket) * 0.37;
        // In thousandths, so that the arcs below start exactly at the printed position.
        let x = (1000.0 * (50.0 + 30.0 * angle.cos())).round() / 1000.0;
        let y = (1000.0 * (50.0 + 30.0 * angle.sin())).round() / 1000.0;
        line(&mut program, format_args!("(pocket {pocket})"));
        line(&mut program, format_args!("N{number} G0 X{x:.3} Y{y:.3}"));
        line(
            &mut program,
            format_args!("N{} Z1.000 ; rapid down", number + 10),
        );
        let depth = 0.1 + f64::from(pocket % 10) * 0.05;
        line(
            &mut program,
            format_args!("N{} G1 Z-{depth:.3} F{}", number + 20, 120 + pocket % 50),
        );
        line(
            &mut program,
            format_args!(
                "N{} F{} S{}",
                number + 30,
                800 + pocket * 7 % 400,
                900 + pocket % 100
            ),
        );
        line(&mut program, format_args!("X{:.4}", x + 1.0));
        line(&mut program, format_args!("Y{:.4}", y + 1.0));
        line(
            &mut program,
            format_args!("G2 X{x:.3} Y{:.3} I-0.500 J0", y + 1.0),
        );
        line(&mut program, format_args!("G3 X{x:.3} Y{y:.3} R1.5"));
        line(&mut program, format_args!("G1 X{x:.3} Y{y:.3} Z-0.5"));
        line(&mut program, format_args!("G91 G1 X0.125 Y-0.250"));
        line(&mut program, format_args!("G90"));
        line(&mut program, format_args!("G0 Z2"));
        pocket += 1;
        number += 40;
    }
    program.push_str(TAIL);
    program
}
