//! Outputs and stored settings: the last word counts, and nothing is stored twice.

use husillo_controllers::{GrblEvent, GrblOptions};

use crate::mill::Mill;

fn reading() -> GrblOptions {
    GrblOptions {
        reads_inputs: true,
        ..GrblOptions::FULL
    }
}

/// However many changes come during one wait, the outputs are those of the last one.
#[test]
fn the_last_change_of_an_output_is_not_lost() {
    let mut mill: Mill = Mill::new(reading(), &[]);
    let speeds: String = (2..20).map(|n| format!("S{}\n", 10 * n)).collect();
    mill.send(&format!("M3S10\n{speeds}M5\n"));
    mill.pass(100_000);
    assert_eq!(mill.oks(), 20);
    assert!(!mill.rig().outputs.flood && mill.rig().outputs.duty == 0);
    mill.send("M3S500\n");
    mill.pass(100_000);
    let duty = mill.rig().outputs.duty;
    // Overrides take effect at their bytes.
    mill.send_bytes(&[0x9a; 10]);
    mill.send_bytes(&[0x9b; 10]);
    mill.send_bytes(&[0x9d]);
    mill.pass(100_000);
    let slower = mill.rig().outputs.duty;
    assert!(slower < duty && duty - slower < 8, "{slower} {duty}");
    for _ in 0..24 {
        mill.send_bytes(&[0xa0, 0xa1]);
        mill.hear();
    }
    mill.send_bytes(&[0xa0]);
    mill.pass(100_000);
    let outputs = mill.rig().outputs;
    assert!(outputs.flood && !outputs.mist, "{outputs:?}");
}

#[test]
fn settings_that_come_together_are_stored_once() {
    let mut mill: Mill = Mill::new(reading(), &[]);
    mill.send("$110=600\n$111=600\n");
    mill.pass(100_000);
    assert_eq!(mill.oks(), 2);
    let is_store = |(_, event): &&(u64, GrblEvent)| *event == GrblEvent::Store;
    assert_eq!(mill.events.iter().filter(is_store).count(), 1);
}

/// `$RST=$` restores all settings, and `$RST=#` all places and tools.
#[test]
fn defaults_are_restored_completely() {
    let mut mill: Mill = Mill::new(GrblOptions::HAL, &[]);
    let second = 1_000_000;
    mill.answer("$341=2\n", second);
    assert_eq!(mill.answer("$341\n", second), "$341=2\r\nok\r\n");
    mill.answer("G10L1P3Z5\nG10L2P9X7\nG92Y3\n", second);
    let places = mill.answer("$#\n", second);
    assert!(places.contains("[T:3|"), "{places}");
    assert!(places.contains("[G59.3:7.000,"), "{places}");
    assert!(places.contains("[G92:0.000,-3.000"), "{places}");
    mill.answer("$RST=$\n", second);
    assert_eq!(mill.answer("$341\n", second), "$341=0\r\nok\r\n");
    let kept = mill.answer("$#\n", second);
    assert_eq!(kept, places);
    mill.answer("$RST=#\n", second);
    let places = mill.answer("$#\n", second);
    assert!(!places.contains("[T:3|"), "{places}");
    assert!(places.contains("[G59.3:0.000,0.000"), "{places}");
    assert!(places.contains("[G92:0.000,0.000"), "{places}");
}

/// Motors that are off stay off when the level of their pin is restored.
#[test]
fn the_enable_pin_follows_the_defaults() {
    let mut mill: Mill = Mill::new(GrblOptions::FULL, &[(4, "1")]);
    mill.pass(100_000);
    assert!(!mill.rig().outputs.disable);
    mill.forget();
    mill.send("$RST=$\n");
    mill.pass(1_000_000);

    let events: Vec<GrblEvent> = mill.events.iter().map(|(_, event)| *event).collect();
    assert!(
        events.contains(&GrblEvent::Disable { is_high: true }),
        "{events:?}"
    );
    assert!(mill.rig().outputs.disable);
}
