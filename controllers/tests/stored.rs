//! A controller without a host: at start-up it reads backlash, work zero and program from its
//! store, as the strings that a host would send.

#[path = "../../store/examples/flash/mod.rs"]
mod flash;

use flash::Flash;
use husillo_controllers::{Micromill, MicromillConfig, MicromillEvent, MicromillInputs};
use husillo_store::Store;

const BACKLASH: &str = "BX020;BY030;";
const PROGRAM: &str = "G00X00500.00Y00300.00;G54;G02X00000.00Y00000.00I-0050.00J00000.00F12;M30;";

/// Takes a byte as from the line and makes all its events.
fn take(mill: &mut Micromill, byte: u8, steps: &mut Vec<[i8; 3]>) {
    if mill.receive(byte) {
        mill.halted();
    }
    while let Some(event) = mill.next_event(&MicromillInputs::default()) {
        if let MicromillEvent::Step(step) = event {
            steps.push(step.deltas());
            mill.made(1);
        }
        while mill.transmit().is_some() {}
    }
    while let Some(byte) = mill.transmit() {
        assert!(!matches!(byte, 0x8b..=0x8e), "{byte:x}");
    }
}

/// Returns the steps that a mill makes for the content of its flash.
fn starts_up(flash: &mut Flash<8>) -> Vec<[i8; 3]> {
    let mut store = Store::open(flash, 0..1024).unwrap();
    let mut mill = Micromill::homed(&MicromillConfig::MICROMILL);
    let mut steps = Vec::new();
    let mut at = 0;
    // Reads a few bytes at a time, because RAM is small.
    while at < store.len().unwrap_or(0) {
        let mut window = [0; 16];
        let count = 16.min(store.len().unwrap() - at);
        let window = &mut window[..count as usize];
        store.read(at, window).unwrap();
        window
            .iter()
            .for_each(|byte| take(&mut mill, *byte, &mut steps));
        at += count;
    }
    steps
}

fn said(strings: &str) -> Vec<[i8; 3]> {
    let mut mill = Micromill::homed(&MicromillConfig::MICROMILL);
    let mut steps = Vec::new();
    strings
        .bytes()
        .for_each(|byte| take(&mut mill, byte, &mut steps));
    steps
}

fn save(flash: &mut Flash<8>, strings: &[&str]) -> bool {
    let mut store = Store::open(flash, 0..1024).unwrap();
    let Ok(mut save) = store.save() else {
        return false;
    };
    strings
        .iter()
        .all(|string| save.write(string.as_bytes()).is_ok())
        && save.commit().is_ok()
}

/// The steps equal those for a host that sends the same strings. A power failure while another
/// program is stored leaves the old one intact.
#[test]
fn a_program_runs_without_a_host() {
    let mut flash = Flash::<8>::new(4, 256);
    assert_eq!(starts_up(&mut flash), [[0; 3]; 0]);
    assert!(save(&mut flash, &[BACKLASH, PROGRAM]));
    let steps = said(&[BACKLASH, PROGRAM].concat());
    assert!(steps.len() > 3000);
    assert_ne!(steps, said(PROGRAM), "its backlash has an effect");
    assert!(starts_up(&mut flash) == steps);
    for operation in 0..7 {
        flash.power = Some((operation, 77));
        assert!(!save(&mut flash, &["PY+0100;PY-0100;PY+0100;"]));
        flash.power = None;
        assert!(starts_up(&mut flash) == steps);
    }
    assert!(save(&mut flash, &["PY+0003;"]));
    assert_eq!(starts_up(&mut flash), [[0, 1, 0]; 3]);
}
