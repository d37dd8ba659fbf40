//! The Grbl controller under random input, and its memory in a flash.

#[path = "../../store/examples/flash/mod.rs"]
mod flash;

use flash::Flash;
use husillo_controllers::{
    Controller, Grbl, GrblEvent, GrblInputs, GrblMemory, GrblOptions, Timed,
};
use husillo_store::Store;
use husillo_transports::grbl::{HeightLine, Message, Settings};
use proptest::prelude::*;

/// A controller with its motors, as fast as it can.
struct Driven {
    grbl: Grbl,
    steps: [i32; 3],
    us: u64,
    said: Vec<u8>,
    stored: u32,
}

fn settings() -> Settings {
    let mut settings = Settings::DEFAULT;
    for number in 110..113 {
        settings.write(number, b"3000").unwrap();
        settings.write(number + 10, b"300").unwrap();
    }
    settings
}

impl Driven {
    fn new() -> Self {
        let memory = GrblMemory::FACTORY.with_settings(settings());
        let mut driven = Driven {
            grbl: Grbl::new(GrblOptions::FULL, Some(&memory)),
            steps: [0; 3],
            us: 0,
            said: Vec::new(),
            stored: 0,
        };
        driven.run(200_000);
        driven.said.clear();
        driven
    }

    /// Makes events for this time, or until there are none.
    fn run(&mut self, us: u64) {
        let end = self.us + us;
        while self.us < end {
            self.said
                .extend(std::iter::from_fn(|| self.grbl.transmit()));
            let Some(event) = self.grbl.next_event(0, &GrblInputs::default()) else {
                return;
            };
            match event {
                GrblEvent::Step { delta, .. } => {
                    for (steps, delta) in self.steps.iter_mut().zip(delta) {
                        *steps += i32::from(delta);
                    }
                }
                GrblEvent::Store => self.stored += 1,
                _ => {}
            }
            if let Some(wait) = event.wait_ticks() {
                self.us += u64::from(wait);
                self.grbl.made(0, 1);
            }
        }
    }

    fn send(&mut self, bytes: &[u8]) {
        for byte in bytes {
            if self.grbl.receive(*byte) {
                self.grbl.halted();
            }
        }
    }

    fn lines(&self) -> impl Iterator<Item = &[u8]> {
        let lines = self.said.split(|byte| *byte == b'\n');
        lines.map(|line| line.strip_suffix(b"\r").unwrap_or(line))
    }

    fn answers(&self) -> usize {
        let messages = self.lines().filter_map(Message::parse);
        messages.filter(Message::is_answer).count()
    }
}

/// Bytes that make sense now and then.
fn input() -> impl Strategy<Value = Vec<u8>> {
    let text = prop::sample::select(vec![
        "G1X1F500\n",
        "G0Y-2Z1\n",
        "G91\n",
        "G90\n",
        "G2X1Y1I.5J.5F900\n",
        "G4P.01\n",
        "M3S100\n",
        "M5\n",
        "M8\n",
        "M9\n",
        "G92X0\n",
        "G10L20P1X0\n",
        "$J=G91X3F900\n",
        "$$\n",
        "$#\n",
        "$G\n",
        "$X\n",
        "$C\n",
        "$H\n",
        "$22=1\n",
        "$22=0\n",
        "$100=80\n",
        "$100=250\n",
        "$32=1\n",
        "$32=0\n",
        "G38.2X4F300\n",
        "G38.3X-4F300\n",
        "$ZG=-1,-1,4,4,3,2\n",
        "$Z1=.4\n",
        "$ZP=2,300\n",
        "$ZZ\n",
        "$Z\n",
        "$Z=1\n",
        "$Z=0\n",
        "M0\n",
        "M30\n",
        "$SLP\n",
        "$N0=G21\n",
        "$RST=#\n",
        "G20\n",
        "?",
        "!",
        "~",
        "\x18",
        "\n",
        "G93G1X2F60\n",
        "G94\n",
        "G0",
    ]);
    let text = text.prop_map(|text| text.as_bytes().to_vec());
    let realtime = (0x80_u8..=0xa2).prop_map(|byte| vec![byte]);
    let any = prop::collection::vec(any::<u8>(), 1..4);
    prop_oneof![8 => text, 3 => realtime, 1 => any]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Whatever comes, no line is answered twice, every line that is said is a message of Grbl, and
    /// the position is the sum of the steps (homing sets it). A reset brings the controller back.
    #[test]
    fn any_input_is_answered_at_most_once(
        parts in prop::collection::vec((input(), 0_u64..300_000), 1..60),
    ) {
        let mut driven = Driven::new();
        let (mut ends, mut homes) = (0, false);
        for (bytes, us) in parts {
            ends += bytes.iter().filter(|byte| matches!(byte, b'\r' | b'\n')).count();
            homes |= bytes.contains(&b'H') || bytes.contains(&b'h');
            driven.send(&bytes);
            driven.run(us);
            prop_assert!(driven.answers() <= ends);
            if !homes {
                prop_assert_eq!(driven.grbl.position_steps(), driven.steps);
            }
        }
        for line in driven.lines() {
            let is_message = Message::parse(line).is_some() || HeightLine::parse(line).is_some();
            prop_assert!(is_message, "{:?}", String::from_utf8_lossy(line));
        }
        driven.run(90_000_000);
        driven.said.clear();
        driven.send(b"\x18");
        driven.run(2_000_000);
        driven.send(b"?");
        driven.run(10_000);
        let is_status = |line| matches!(Message::parse(line), Some(Message::Status(_)));
        prop_assert!(driven.lines().any(is_status));
    }

    /// Holds, overrides and reports at any moment change neither the path nor the answers of a
    /// program.
    #[test]
    fn disturbed_programs_end_in_the_same_place(
        targets in prop::collection::vec((-40_i32..40, -40_i32..40, any::<bool>()), 1..25),
        disturbances in prop::collection::vec((0_u64..150_000, 0_usize..8), 0..40),
    ) {
        let mut program = String::from("G90F1800\n");
        for (x, y, is_rapid) in &targets {
            let code = if *is_rapid { "G0" } else { "G1" };
            program += &format!("{code}X{}Y{}\n", f64::from(*x) / 10.0, f64::from(*y) / 10.0);
        }
        let mut driven = Driven::new();
        let mut disturbances = disturbances.into_iter();
        for line in program.lines() {
            driven.send(line.as_bytes());
            driven.send(b"\n");
            let answered = driven.answers() + 1;
            while driven.answers() < answered {
                driven.run(5000);
                if let Some((us, kind)) = disturbances.next() {
                    driven.run(us);
                    driven.send(&[b"!~?\x91\x92\x96\x95\x99"[kind]]);
                }
                // A hold would wait for ever.
                driven.run(300_000);
                driven.send(b"~");
            }
        }
        driven.send(b"~");
        for _ in 0..200 {
            driven.run(500_000);
            driven.send(b"~");
        }
        let (x, y, _) = targets[targets.len() - 1];
        prop_assert_eq!(driven.steps, [x * 25, y * 25, 0]);
        prop_assert_eq!(driven.answers(), targets.len() + 1);
        let has_errors = driven.lines().any(|line| line.starts_with(b"error"));
        prop_assert!(!has_errors);
    }
}

/// A loss of power during any write leaves the old memory or the new one.
#[test]
fn the_memory_survives_a_loss_of_power() {
    let mut flash = Flash::<8>::new(32, 256);
    let save = |flash: &mut Flash<8>, bytes: &[u8]| {
        let mut store = Store::open(flash, 0..8192).unwrap();
        let Ok(mut save) = store.save() else { return };
        if save.write(bytes).is_ok() {
            let _ = save.commit();
        }
    };
    let load = |flash: &mut Flash<8>| {
        let mut store = Store::open(flash, 0..8192).unwrap();
        let mut bytes = [0; GrblMemory::BYTES];
        store.read(0, &mut bytes).unwrap();
        GrblMemory::from_bytes(&bytes).unwrap()
    };
    let mut driven = Driven::new();
    let old = *driven.grbl.memory();
    save(&mut flash, &old.to_bytes());
    assert_eq!(load(&mut flash), old);
    driven.send(b"$110=1234\nG10L2P3X1.5\n$N1=G21G90\n");
    driven.run(1_000_000);
    assert_eq!(
        driven.stored, 1,
        "lines that come together are stored together"
    );
    let new = *driven.grbl.memory();
    assert_ne!(old, new);
    let (mut olds, mut news) = (0, 0);
    for operation in 0..400 {
        flash.power = Some((operation, 7));
        save(&mut flash, &new.to_bytes());
        flash.power = None;
        let found = load(&mut flash);
        assert!(found == old || found == new);
        olds += i32::from(found == old);
        news += i32::from(found == new);
        save(&mut flash, &old.to_bytes());
    }
    assert!(olds > 0 && news > 0, "{olds} {news}");
    // A damaged memory is noticed.
    assert_eq!(GrblMemory::from_bytes(&[0; GrblMemory::BYTES]), None);
    assert_eq!(GrblMemory::from_bytes(&new.to_bytes()[1..]), None);
}

/// A sender that has got its answer may switch the power off.
#[test]
fn a_setting_is_stored_before_it_is_answered() {
    let mut driven = Driven::new();
    for line in ["$110=600\n", "$N0=G21\n", "G10L2P1X1\n"] {
        driven.send(line.as_bytes());
        assert_eq!(driven.grbl.transmit(), None, "{line}");
        assert!(driven.grbl.has_event());
        let inputs = GrblInputs::default();
        let event = driven.grbl.next_event(0, &inputs);
        assert_eq!(event, Some(GrblEvent::Store), "{line}");
        driven.run(1000);
        assert!(!driven.grbl.has_event());
        assert_eq!(driven.lines().next(), Some(&b"ok"[..]), "{line}");
        driven.said.clear();
    }
}

/// With braking at once, a hold in full motion stops within the distance of the acceleration.
#[test]
fn a_hold_brakes_at_once() {
    let mut driven = Driven::new();
    driven.send(b"G1X50F3000\n");
    driven.run(1_000_000);
    let at = driven.steps[0];
    driven.send(b"!");
    driven.run(1_000_000);
    // 50 mm/s and 300 mm/s^2: 4.17 mm, and the step that was under way.
    let braked = f64::from(driven.steps[0] - at) / 250.0;
    assert!((4.1..4.25).contains(&braked), "{braked}");
}

/// A line that changes on the way moves nothing, and a line that comes twice moves once.
#[test]
fn checked_lines_are_executed_once_and_in_order() {
    let mut driven = Driven::new();
    let mut answer = |line: &[u8]| {
        driven.said.clear();
        driven.send(line);
        driven.run(5_000_000);
        (
            String::from_utf8(driven.said.clone()).unwrap(),
            driven.steps[0],
        )
    };
    assert_eq!(answer(b"$L\n"), ("error:3\r\n".into(), 0));
    assert_eq!(answer(b"$L=1\n"), ("ok\r\n".into(), 0));
    assert_eq!(answer(b"$L\n"), ("[LINE:1]\r\nok\r\n".into(), 0));
    let first = ("ok N1*91\r\n".into(), 250);
    assert_eq!(answer(b"N1G91G0X1*46\n"), first);
    assert_eq!(answer(b"N1G91G0X1*46\n"), first, "the answer was lost");
    let again = ("resend N2*87\r\n".into(), 250);
    assert_eq!(answer(b"N2G0X2*98\n"), again, "one character was changed");
    assert_eq!(answer(b"G0X1\n"), again, "the number was lost");
    assert_eq!(answer(b"$J=X1F100\n"), again, "a jog moves as well");
    assert_eq!(answer(b"\n"), ("".into(), 250));
    assert_eq!(answer(b"N3G0X1*99\n"), again, "line 2 was lost");
    assert_eq!(answer(b"N2$J=X1F1000*1\n"), ("ok N2*88\r\n".into(), 500));
    assert_eq!(answer(b"N3G4*14\n"), ("error:28 N3*21\r\n".into(), 500));
    assert_eq!(
        answer(b"\x18"),
        ("\r\nGrbl 1.1h ['$' for help]\r\n".into(), 500)
    );
    assert_eq!(answer(b"G0X3\n"), ("ok\r\n".into(), 750));
}
