//! Probe moves that are disturbed, or leave the travel.

use husillo_controllers::GrblOptions;
use husillo_sim::{GrblPin, SlideSwitch};

use crate::mill::Mill;

fn add_switch(mill: &mut Mill, pin: GrblPin, axis: usize, at_steps: i64) {
    let is_above = pin != GrblPin::Probe;
    mill.rig().add_switch(SlideSwitch {
        pin,
        axis,
        at_steps,
        is_above,
        closed_level: false,
    });
}

/// A hold or an open door that comes while the axes brake after a contact does not resume the move
/// into the plate.
#[test]
fn a_contact_ends_the_move_also_after_a_hold() {
    for stop in [b'!', 0x84] {
        let mut mill: Mill = Mill::new(GrblOptions::FULL, &[(122, "10")]);
        add_switch(&mut mill, GrblPin::Probe, 2, -1500);
        mill.send("G38.2Z-20F300\n");
        while mill.rig().steps()[2] > -1500 {
            mill.pass(1000);
        }
        mill.pass(5000);
        mill.send_bytes(&[stop]);
        mill.pass(2_000_000);
        let at = mill.rig().steps();
        mill.forget();
        mill.send("~");
        mill.pass(10_000_000);
        assert_eq!(mill.said, "[PRB:0.000,0.000,-6.000:1]\r\nok\r\n");
        assert_eq!(mill.rig().steps(), at);
        assert!(mill.report().starts_with("<Idle"), "{}", mill.said);
    }
}

/// As in Grbl, a probe move that leaves the travel is an alarm before its first step.
#[test]
fn soft_limits_hold_for_probe_moves() {
    let settings = [(22, "1"), (20, "1"), (24, "500"), (25, "500"), (27, "1")];
    for options in [GrblOptions::FULL, GrblOptions::HAL] {
        let mut mill: Mill = Mill::new(options, &settings);
        for axis in 0..3 {
            add_switch(&mut mill, GrblPin::Limit(axis), axis, 500);
        }
        mill.send("$H\n");
        mill.pass(60_000_000);
        assert_eq!(mill.oks(), 1, "{}", mill.said);
        let at = mill.rig().steps();
        let said = mill.answer("G38.2Z-500F300\n", 2_000_000);
        assert!(said.starts_with("ALARM:2\r\n"), "{said}");
        assert_eq!(mill.rig().steps(), at);
        mill.answer("\x18", 1_000_000);
        let said = mill.answer("$X\nG90G38.3Z-5F300\n", 60_000_000);
        assert!(said.contains("[PRB:") && !said.contains("ALARM"), "{said}");
        assert_eq!(mill.rig().steps()[2], at[2] - 4 * 250);
    }
}

/// A door that opens again and again while nobody reads does not take the room of the answer.
#[test]
fn notes_leave_room_for_the_contact() {
    let mut mill: Mill = Mill::new(GrblOptions::FULL, &[(122, "1000")]);
    add_switch(&mut mill, GrblPin::Probe, 2, -1500);
    mill.send("G38.2Z-20F300\n");
    for _ in 0..80 {
        mill.pass_unheard(40_000);
        mill.send_bytes(&[0x84]);
        mill.pass_unheard(40_000);
        mill.send("~");
    }
    assert!((-1510..=-1500).contains(&mill.rig().steps()[2]));
    mill.hear();
    let (notes, rest): (Vec<&str>, Vec<&str>) = mill
        .said
        .lines()
        .partition(|line| *line == "[MSG:Check Door]");
    assert!(notes.len() > 40, "the output was full: {}", notes.len());
    assert_eq!(rest, ["[PRB:0.000,0.000,-6.000:1]", "ok"]);
}
