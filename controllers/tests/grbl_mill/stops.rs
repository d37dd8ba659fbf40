//! Motions that are cut short.

use husillo_controllers::GrblOptions;

use crate::mill::Mill;

/// A jog that waits for a slot of the queue is dropped as well when its motion is cancelled.
#[test]
fn a_cancelled_jog_leaves_nothing_behind() {
    for options in [GrblOptions::FULL, GrblOptions::STOCK] {
        // It brakes within the present jog, so that no slot becomes free.
        let mut mill: Mill = Mill::new(options, &[(110, "6000"), (120, "500")]);
        let mut sent = 0;
        let end = mill.emulated.now_us() + 2_000_000;
        while mill.emulated.now_us() < end || mill.oks() == sent {
            // The sender keeps one line under way.
            if mill.oks() == sent {
                mill.send("$J=G91X1F600\n");
                sent += 1;
            }
            mill.pass(1000);
        }
        assert_eq!(mill.oks() + 1, sent, "the queue is full");
        mill.send_bytes(&[0x85]);
        mill.pass(1_500_000);
        let at = mill.rig().steps();
        let oks = mill.oks();
        assert!(oks >= 16 && oks == sent, "{oks} of {sent}");
        mill.pass(30_000_000);
        assert_eq!(mill.rig().steps(), at);
        assert!(mill.report().starts_with("<Idle"), "{}", mill.said);
        assert_eq!(mill.answer("G90G0Y1\n", 5_000_000), "ok\r\n");
        assert_eq!(mill.rig().steps(), [at[0], 250, 0]);
    }
}

/// A sender that does not read what it has requested can still hold the machine.
#[test]
fn a_full_output_delays_no_hold() {
    let mut mill: Mill = Mill::new(GrblOptions::FULL, &[(120, "500")]);
    mill.send("G1X50F600\n");
    // At the top feed of 500 mm/min by `$110`.
    mill.pass(1_000_000);
    for _ in 0..20 {
        mill.send("?");
        mill.pass_unheard(5000);
    }
    let at = mill.rig().steps()[0];
    mill.send("!");
    mill.pass_unheard(1_000_000);
    let braked = mill.rig().steps()[0] - at;
    // 8.33 mm/s and 500 mm/s^2: 0.07 mm.
    assert!((1..20).contains(&braked), "{braked}");
    mill.pass(10_000);
    let lines: Vec<&str> = mill.said.lines().collect();
    let whole = |line: &&str| *line == "ok" || line.starts_with('<') && line.ends_with('>');
    assert!(lines.iter().all(whole), "{lines:?}");
    assert!(mill.report().starts_with("<Hold:0"), "{}", mill.said);
    mill.send("~");
    mill.pass(10_000_000);
    assert_eq!(mill.rig().steps(), [12_500, 0, 0]);
}
