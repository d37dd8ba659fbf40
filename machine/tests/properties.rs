//! Properties of every line.

mod common;

use common::{Screw, config, drain};
use husillo_machine::{Machine, Scale};
use proptest::prelude::*;

fn coordinate() -> std::ops::Range<i64> {
    // Within 30 um, in nanometres: about 200 steps.
    -30_000i64..30_000
}

fn word(letter: char, nm: i64) -> String {
    let sign = if nm < 0 { "-" } else { "" };
    let nm = nm.unsigned_abs();
    format!("{letter}{sign}{}.{:06}", nm / 1_000_000, nm % 1_000_000)
}

/// Lines, arcs by centre and arcs by radius, rapids; some of them wrong.
fn line() -> impl Strategy<Value = String> {
    let point = (coordinate(), coordinate(), coordinate());
    prop_oneof![
        (0..2, point.clone()).prop_map(|(g, (x, y, z))| format!(
            "G{g} {} {} {}",
            word('X', x),
            word('Y', y),
            word('Z', z)
        )),
        (2..4, point.clone(), coordinate(), coordinate()).prop_map(|(g, (x, y, _), i, j)| {
            format!(
                "G{g} {} {} {} {}",
                word('X', x),
                word('Y', y),
                word('I', i),
                word('J', j)
            )
        }),
        (2..4, point, 10_000i64..60_000).prop_map(|(g, (x, y, z), r)| {
            format!(
                "G{g} {} {} {} {}",
                word('X', x),
                word('Y', y),
                word('Z', z),
                word('R', r)
            )
        }),
        // A whole turn from any position.
        (2..4, coordinate(), coordinate()).prop_map(|(g, i, j)| format!(
            "G91 G{g} X0 {} {} P2\nG90",
            word('I', i),
            word('J', j)
        )),
    ]
}

proptest! {
    /// The tool, behind a screw with backlash, is at the reported position after every step of the
    /// path. Every accepted move ends on the step nearest to its target. A refused line moves
    /// nothing.
    #[test]
    fn tool_follows_the_machine(lines in prop::collection::vec(line(), 1..12)) {
        let mut machine: Machine<3> = Machine::new(config());
        let mut screw = Screw::new();
        machine.line(b"G21 G90 G94 F1.2").unwrap();
        drain(&mut machine, &mut screw);
        for line in lines.iter().flat_map(|lines| lines.lines()) {
            let before = machine.position_steps();
            match machine.line(line.as_bytes()) {
                Ok(()) => {
                    drain(&mut machine, &mut screw);
                    let scale = Scale::new(140, 1).unwrap();
                    let target = machine.modal().position().map(|at| scale.nearest(at.0).unwrap());
                    prop_assert_eq!(machine.position_steps(), target, "{}", line);
                }
                Err(_) => {
                    prop_assert_eq!(machine.next_event(), None);
                    prop_assert_eq!(machine.position_steps(), before);
                }
            }
        }
    }

    /// No input makes the machine panic, and a refused line moves nothing.
    #[test]
    fn any_bytes(lines in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..40), 1..8)) {
        let mut machine: Machine<3> = Machine::new(config());
        for line in &lines {
            if machine.line(line).is_err() {
                prop_assert_eq!(machine.next_event(), None);
            }
            for _ in 0..1000 {
                if machine.next_event().is_none() {
                    break;
                }
            }
            machine.abort();
            while machine.next_event().is_some() {}
        }
    }

    /// The step nearest to the position of a step is that step, for any scale of at least 1 nm per
    /// step.
    #[test]
    fn scales_invert(nm in 1u32..2_000_000, steps in 1u32..2000, step in -1_000_000i32..1_000_000) {
        prop_assume!(nm >= 2 * steps);
        let scale = Scale::new(nm, steps).unwrap();
        prop_assert_eq!(scale.nearest(scale.position(step)), Some(step));
        prop_assert_eq!(scale.nearest(0), Some(0));
    }
}
