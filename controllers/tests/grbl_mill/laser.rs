//! The power of a laser, and the line number in reports, belong to the move that is being made.

use husillo_controllers::GrblOptions;

use crate::mill::Mill;

/// Sends as many moves as the queue takes, each with a number, and with a power of its own if the
/// laser is on.
fn send_moves(mill: &mut Mill<24>, has_power: bool) {
    for n in 1..=24 {
        let power = if has_power {
            format!("S{}", 10 * n)
        } else {
            String::new()
        };
        mill.send(&format!("N{n}G1X{n}{power}F600\n"));
        mill.hear();
    }
    mill.pass(50_000);
    assert_eq!(mill.oks(), 24);
}

#[test]
fn a_report_has_the_line_of_the_present_move() {
    let mut mill = Mill::<24>::new(GrblOptions::FULL, &[(110, "6000")]);
    send_moves(&mut mill, false);
    let report = mill.report();
    assert!(report.contains("|Ln:1|"), "{report}");
}

#[test]
fn the_power_is_that_of_the_present_move() {
    let settings = [(110, "6000"), (32, "1"), (30, "255")];
    let mut mill = Mill::<24>::new(GrblOptions::FULL, &settings);
    mill.send("M3S0\n");
    mill.pass(50_000);
    mill.forget();
    send_moves(&mut mill, true);
    assert_eq!(mill.duties(), [10]);
    mill.pass(60_000_000);
    let powers: Vec<u8> = (1..=24).map(|n| 10 * n).collect();
    assert_eq!(mill.duties()[..24], powers);
}

/// In inverse time mode the F word is no speed. The power is in proportion to the speed that this
/// time means.
#[test]
fn a_dynamic_power_knows_the_speed_of_inverse_time() {
    let settings = [(110, "6000"), (120, "100"), (32, "1"), (30, "255")];
    let mut mill: Mill = Mill::new(GrblOptions::FULL, &settings);
    // 10 mm in 1 s. The ramps take 0.1 s each.
    mill.send("G93M4S200G1X10F60\n");
    mill.pass(50_000);
    let begins = mill.duties();
    assert!(begins.iter().all(|duty| *duty < 150), "{begins:?}");
    mill.pass(450_000);
    assert_eq!(mill.duties().iter().max(), Some(&200));
    mill.forget();
    mill.pass(100_000);
    assert!(mill.duties().is_empty(), "the speed is constant");
}
