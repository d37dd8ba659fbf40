//! A program for a 3D printer, shaped like the output of a slicer.

use std::fmt::Write as _;

/// About `bytes` bytes of layers: `;TYPE:` comments, short moves with extrusion, travel, fan and
/// progress codes. The text is the same in every run.
pub fn printed(bytes: usize) -> String {
    let mut program = String::from(";FLAVOR:Marlin\nM104 S210\nG28 ;home\nG92 E0\nM82\n");
    let (mut layer, mut extruded) = (0_u32, 0.0_f64);
    while program.len() < bytes {
        let height = 0.2 + f64::from(layer) * 0.15;
        let _ = write!(
            program,
            ";LAYER:{layer}\nM73 P{}\nG0 F9000 X{:.3} Y{:.3} Z{height:.2}\n;TYPE:WALL-OUTER\n\
             M204 S500\nG1 F1800\n",
            layer % 100,
            100.0 + f64::from(layer % 7),
            100.0
        );
        for point in 0..120_u32 {
            let angle = f64::from(point) * 0.0524;
            extruded += 0.08138;
            let (x, y) = (117.0 + 20.0 * angle.cos(), 104.0 + 17.5 * angle.sin());
            let _ = match point % 10 {
                9 => writeln!(program, "G0 X{x:.3} Y{y:.3}"),
                _ => writeln!(program, "G1 X{x:.3} Y{y:.3} E{extruded:.5}"),
            };
        }
        let _ = writeln!(program, ";TYPE:FILL\nM106 S{}", layer % 255);
        layer += 1;
    }
    program.push_str("M107\nM84\n");
    program
}
