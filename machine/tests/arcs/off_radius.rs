//! Arcs whose ends have different distances from the centre.

use husillo_backlash::Backlash;
use husillo_interp::Path;
use husillo_machine::{Machine, Scale};

use crate::router::{accelerations, config, fine, trace};

/// The last programmed position of each axis in nm. All programs are absolute, in mm.
fn programmed_end(program: &str) -> [f64; 3] {
    let mut end = [0.0; 3];
    for word in program.split_whitespace() {
        for (letter, end) in ['X', 'Y', 'Z'].into_iter().zip(&mut end) {
            if let Some(number) = word.strip_prefix(letter) {
                *end = number.parse::<f64>().unwrap() * 1e6;
            }
        }
    }
    end
}

/// Arcs on and off their radius, from rest and at speed, on equal and unequal axes: no axis exceeds
/// its acceleration, and all end where they were programmed to.
#[test]
fn no_axis_exceeds_its_acceleration_on_arcs() {
    let programs = [
        // Whole circles, and parts of them that are tangents of each other.
        "G3 I3 F6000",
        "G3 X3 Y3 I0 J3 F6000\nG3 X0 Y6 I-3\nG2 X-2 Y8 J2",
        // Ends off the radius: inwards, outwards, clockwise, in other planes, as helices, over most
        // of a turn, and so short that the spiral would be steep.
        "G2 X3.4 Y3 I3 J0 F6000\nG3 X6 Y6 I0 J3",
        "G2 X3.4 Y3 I3 J0 F6000\nG2 X6 Y6 I0 J3",
        "G3 X3 Y2.6 I-0.1 J3 F6000\nG1 X2",
        "G18 G3 X2 Z2.5 I2.3 K0 F6000",
        "G19 G2 Y2 Z2.5 J2.3 K0 F6000",
        "G3 X2.6 Y3 Z1 I0 J3 F6000",
        "G2 X-2.6 Y3 Z1 I0 J3 F6000",
        "G3 X-3.3 Y3 I0 J3 F6000\nG3 X-3.3 Y3 I3",
        "G3 X0.2 Y0.1 I0 J3 F6000\nG1 X2",
        "G3 X0.2 Y0.2 I0 J0.5 F6000",
        "G2 X0.9 Y0.5 I0 J0.5 F6000\nG1 X2",
        "G1 X1 F6000\nG3 X1.5 Y1 I0 J0.6",
        "G1 X1 F6000\nG3 X1.1 Y0.4 I0 J0.6\nG1 X2",
        "G3 X2.6 Y3 I0 J3 P3 F6000\nG1 X2",
        // About a whole turn stays a spiral.
        "G3 X0 Y0.4 I0 J3 F6000\nG1 X2",
        "G3 X-0.3 Y-0.4 I0 J3 F6000\nG1 X2",
        "G1 X2 F6000\nG2 X2 Y-0.4 I0 J3 P4\nG1 X-2",
    ];
    let scales = [[100; 3], [100, 100, 125]];
    for (number, program) in programs.into_iter().enumerate() {
        for (limits, scales) in [[500, 500, 500], [700, 400, 300]].into_iter().zip(scales) {
            let config = fine(limits, scales);
            let trace = trace(config, program, &[]);
            let (_, last) = *trace.last().unwrap();
            for (axis, (at, end)) in last.into_iter().zip(programmed_end(program)).enumerate() {
                assert!(
                    (at - end).abs() <= 63.0,
                    "{number}, axis {axis}: {at} {end}"
                );
            }
            let found = accelerations(&trace, 0.004, 125.0);
            let shares: [f64; 3] =
                [0, 1, 2].map(|axis: usize| found[axis] / f64::from(limits[axis]));
            assert!(
                shares.iter().all(|share| *share < 1.03),
                "{number}: {shares:?}"
            );
        }
    }
}

/// An arc with a radius of 1.2 km on coarse steps is accepted, off its radius or not.
#[test]
fn a_large_arc_is_made() {
    let mut config = config([500; 3]);
    for axis in &mut config.axes {
        axis.scale = Scale::new(12_500, 1).unwrap();
    }
    for end in ["X5 Y0", "X5 Y0.3"] {
        let mut machine: Machine<3, Path<3>, Backlash, 32> = Machine::new(config);
        let line = format!("G3 {end} I2.5 J1200000 F6000");
        machine.line(line.as_bytes()).unwrap();
    }
}
