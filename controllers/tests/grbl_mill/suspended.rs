//! Dwells, pauses and changes of tools, with holds and an open door.

use husillo_controllers::GrblOptions;
use husillo_sim::GrblPin;

use crate::mill::Mill;

/// During a dwell, requests are handled every 50 ms: all of them, not only the first.
#[test]
fn a_dwell_takes_all_requests() {
    let mut mill: Mill = Mill::new(GrblOptions::FULL, &[]);
    mill.send("G4P5\n");
    // Not at a whole multiple of 50 ms.
    mill.pass(310_000);
    assert!(mill.answer("?", 60_000).starts_with("<Idle"));
    mill.pass(240_000);
    assert!(mill.answer("?", 60_000).starts_with("<Idle"));
    mill.pass(240_000);
    mill.send("!");
    mill.pass(100_000);
    assert!(mill.report().starts_with("<Hold:0"), "{}", mill.said);
    assert_eq!(mill.answer("~", 4_200_000), "ok\r\n", "it has 4 s left");
}

/// The time of a dwell stands while the door is open.
#[test]
fn a_dwell_waits_for_the_door() {
    let mut mill: Mill = Mill::new(GrblOptions::FULL, &[]);
    mill.send("G4P1\n");
    mill.pass(500_000);
    mill.send_bytes(&[0x84]);
    mill.pass(2_000_000);
    assert_eq!(mill.said, "[MSG:Check Door]\r\n");
    assert_eq!(mill.answer("~", 400_000), "");
    assert_eq!(mill.answer("", 200_000), "ok\r\n");
}

/// After an open door in M0, one start goes on with the program.
#[test]
fn a_pause_ends_after_an_open_door() {
    let mut mill: Mill = Mill::new(GrblOptions::FULL, &[]);
    mill.send("M0\nG0X1\n");
    mill.pass(100_000);
    mill.send_bytes(&[0x84]);
    mill.pass(100_000);
    mill.send("~");
    mill.pass(6_000_000);
    assert_eq!(mill.oks(), 2);
    assert_eq!(mill.rig().steps(), [250, 0, 0]);
}

/// The start button does not end the change of a tool while the door is open.
#[test]
fn a_tool_is_not_taken_with_an_open_door() {
    let mut mill: Mill = Mill::new(GrblOptions::HAL, &[]);
    mill.send("M3S500\nM6T2\n");
    mill.pass(1_000_000);
    assert!(mill.report().starts_with("<Tool"), "{}", mill.said);
    mill.rig().set_level(GrblPin::Door, false);
    mill.pass(100_000);
    mill.forget();
    mill.send("~");
    mill.pass(1_000_000);
    assert!(mill.duties().is_empty());
    assert!(mill.report().starts_with("<Tool"), "{}", mill.said);
    mill.rig().set_level(GrblPin::Door, true);
    mill.pass(100_000);
    mill.send("~");
    mill.pass(1_000_000);
    assert!(mill.duties().iter().any(|duty| *duty > 0));
    assert!(mill.report().starts_with("<Idle"), "{}", mill.said);
}
