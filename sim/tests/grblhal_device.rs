//! The simulated mill with the protocol of grblHAL: tools, switches of the program, the lock.

use husillo_sim::device::Emulation;
use husillo_sim::device::grbl::Device;
use husillo_transports::grbl::Settings;

struct Session {
    device: Device,
}

impl Session {
    fn new() -> Self {
        let mut settings = Settings::DEFAULT;
        for number in 110..113 {
            settings.write(number, b"3000").unwrap();
            settings.write(number + 10, b"200").unwrap();
        }
        let mut session = Session {
            device: Device::grblhal(115_200, settings),
        };
        session.pass(100);
        session
    }

    /// What the device says in this time, ms.
    fn pass(&mut self, ms: usize) -> String {
        let bytes = (0..ms).flat_map(|_| self.device.tick()).collect();
        String::from_utf8(bytes).unwrap()
    }

    fn send(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.device.send(*byte));
    }

    /// Sends lines, one after the other is answered. Returns all that is said.
    fn ask(&mut self, lines: &[&str]) -> String {
        let mut all = String::new();
        for line in lines {
            self.send(line.as_bytes());
            self.send(b"\n");
            let mut said = String::new();
            for _ in 0..60_000 {
                said += &self.pass(1);
                // A report may follow at once.
                if said.contains("ok\r\n") || said.contains("error:") && said.ends_with('\n') {
                    break;
                }
            }
            all += &said;
        }
        all
    }

    /// A byte that takes effect immediately, and what is said until the machine is at rest.
    fn realtime(&mut self, byte: u8) -> String {
        self.send(&[byte]);
        self.pass(20_000)
    }

    fn status(&mut self) -> String {
        self.send(b"\x87");
        self.pass(30)
    }
}

/// The mode that measures: the first tool is the reference, the second one is a millimetre longer.
/// Afterwards the same line reaches the same place with the tip of the tool.
#[test]
fn the_length_of_a_tool_is_measured_after_its_change() {
    let mut mill = Session::new();
    let said = mill.ask(&["$341=3", "G10L2P9X4Y3Z-6", "G0X1Y2", "T1M6"]);
    assert_eq!(said, "ok\r\n".repeat(4));
    mill.pass(3000);
    assert!(mill.status().starts_with("<Tool|MPos:1.000,2.000,0.000"));
    let said = mill.realtime(b'~');
    assert!(said.contains("[PRB:4.000,3.000,-10.000:1]"), "{said}");
    let status = mill.status();
    assert!(
        status.starts_with("<Idle|MPos:1.000,2.000,0.000"),
        "{status}"
    );
    assert!(status.contains("|T:1|P:0|TLR:1|"), "{status}");
    assert_eq!(mill.ask(&["T2M6"]), "ok\r\n");
    mill.pass(3000);
    // The longer tool touches the plate a millimetre earlier.
    mill.device.control("push z -250");
    let said = mill.realtime(b'~');
    assert!(said.contains("[PRB:4.000,3.000,-9.000:1]"), "{said}");
    assert!(mill.ask(&["$#"]).contains("[TLO:0.000,0.000,1.000]"));
    let status = mill.status();
    assert!(status.contains("|WCO:0.000,0.000,1.000|"), "{status}");
    mill.ask(&["G0Z0"]);
    mill.pass(3000);
    assert!(mill.status().starts_with("<Idle|MPos:1.000,2.000,1.000"));
}

/// Lines behind M6 wait. After 0xA3 the sender can jog and measure, and the lines that have waited
/// are executed after the start button.
#[test]
fn the_operator_works_while_a_tool_is_changed() {
    let mut mill = Session::new();
    mill.ask(&["$341=1", "G0X3"]);
    assert_eq!(mill.ask(&["M6T7"]), "ok\r\n");
    mill.send(b"G0X5\n");
    assert_eq!(mill.pass(2000), "", "the line waits");
    mill.send(b"\xa3");
    mill.pass(10);
    assert_eq!(mill.ask(&["$J=G91Z-2F1000"]), "ok\r\n");
    mill.pass(2000);
    let status = mill.status();
    assert!(
        status.starts_with("<Tool|MPos:3.000,0.000,-2.000"),
        "{status}"
    );
    assert_eq!(mill.ask(&["G0X9"]), "error:40\r\n");
    let said = mill.ask(&["$TPW"]);
    assert!(said.contains("[PRB:3.000,0.000,-10.000:1]"), "{said}");
    assert!(mill.status().contains("<Tool|MPos:3.000,0.000,-2.000"));
    let said = mill.realtime(b'~');
    assert!(said.contains("ok\r\n"), "the line that has waited: {said}");
    let status = mill.status();
    assert!(status.starts_with("<Idle|MPos:5.000,0.000,"), "{status}");
    assert!(status.contains("|T:7|"), "{status}");
}

/// A probe that is not found, or already closed, ends the measurement with an alarm.
#[test]
fn a_tool_without_contact_gives_an_alarm() {
    let mut mill = Session::new();
    mill.ask(&["$341=1", "$342=3"]);
    let said = mill.ask(&["$TPW"]);
    assert!(said.starts_with("ALARM:5\r\n"), "{said}");
    assert!(said.ends_with("ok\r\n"), "{said}");
    assert_eq!(mill.ask(&["$X"]), "[MSG:Caution: Unlocked]\r\nok\r\n");
    mill.device.control("close probe");
    mill.pass(5);
    let said = mill.ask(&["$TPW"]);
    assert!(said.starts_with("ALARM:4\r\n"), "{said}");
}

/// A measurement that fails during the change of a tool leaves the change as it was. The byte 0x19
/// ends everything, also a line that waits.
#[test]
fn a_failed_measurement_does_not_end_the_change() {
    let mut mill = Session::new();
    mill.ask(&["$341=1", "$342=3", "M6T2"]);
    mill.pass(2000);
    mill.send(b"G0X5\n\xa3");
    mill.pass(20);
    assert!(mill.ask(&["$TPW"]).starts_with("ALARM:5\r\n"));
    assert!(mill.status().starts_with("<Alarm|"));
    mill.ask(&["$X"]);
    assert!(mill.status().starts_with("<Tool|"));
    mill.send(b"\x19");
    assert_eq!(mill.pass(50), "[MSG:Stop]\r\n");
    assert!(mill.status().starts_with("<Idle|"));
    assert_eq!(mill.ask(&["G0X1"]), "ok\r\n", "nothing is refused any more");
    mill.pass(2000);
    // A line waits behind a dwell, and another one behind it.
    mill.send(b"G4P5\nG0X9\n");
    mill.pass(100);
    mill.send(b"\x19");
    assert_eq!(mill.pass(7000), "[MSG:Stop]\r\nok\r\n");
    assert!(mill.status().starts_with("<Idle|MPos:1.000,"));
    // A motion brakes, and what is queued behind it is dropped.
    mill.ask(&["G1X20F3000", "X30"]);
    mill.pass(200);
    mill.send(b"\x19");
    mill.pass(3000);
    let status = mill.status();
    let x: f64 = status[11..].split(',').next().unwrap().parse().unwrap();
    assert!(
        status.starts_with("<Idle|") && x > 2.0 && x < 20.0,
        "{status}"
    );
}

/// The table of tools, G59.1 and the shift of G92 are kept while the power is off.
#[test]
fn tools_and_frames_are_kept() {
    let mut mill = Session::new();
    assert_eq!(mill.ask(&["G43H3"]), "error:20\r\n", "there are no tools");
    let lines = ["", "G10L1P3Z5R1.5", "G10L2P7X2", "G92Y1", "G43H3"];
    assert_eq!(mill.ask(&lines), "ok\r\n".repeat(5));
    let said = mill.ask(&["$G"]);
    assert!(said.contains(" G92 ") && said.contains(" G43 "), "{said}");
    mill.device.control("power off");
    mill.pass(50);
    mill.device.control("power on");
    mill.pass(100);
    let said = mill.ask(&["$#"]);
    assert!(said.contains("[T:3|0.000,0.000,5.000|1.500]"), "{said}");
    assert!(said.contains("[G59.1:2.000,0.000,0.000]"), "{said}");
    assert!(said.contains("[G92:0.000,-1.000,0.000]"), "{said}");
    assert_eq!(mill.ask(&["G43H3", "G43H4"]), "ok\r\nerror:38\r\n");
}

/// `$22=5` locks the machine until it is homed.
#[test]
fn homing_can_be_required() {
    let mut mill = Session::new();
    mill.ask(&["$22=5", "$24=100", "$25=1200", "$26=25"]);
    mill.device.control("power off");
    mill.pass(50);
    mill.device.control("power on");
    let said = mill.pass(100);
    assert!(
        said.contains("ALARM:11\r\n[MSG:Homing cycle required]\r\n"),
        "{said}"
    );
    assert_eq!(mill.ask(&["$X", "G0X1"]), "error:46\r\nerror:9\r\n");
    let said = mill.ask(&["$H"]);
    assert!(
        said.starts_with("<Home|") && said.ends_with("ok\r\n"),
        "{said}"
    );
    assert!(mill.status().contains("|H:1|"));
    assert_eq!(mill.ask(&["G0X-3"]), "ok\r\n");
}

/// M1 stops unless it is switched off, and single blocks stop after each move.
#[test]
fn the_operator_steps_through_a_program() {
    let mut mill = Session::new();
    mill.send(b"M1\n");
    mill.pass(50);
    assert!(mill.status().starts_with("<Hold:0|"));
    assert_eq!(mill.realtime(b'~'), "[MSG:]\r\nok\r\n");
    mill.send(b"\x88\x89");
    assert_eq!(mill.ask(&["M1"]), "ok\r\n");
    mill.send(b"G0X1\nG0X2\n");
    assert_eq!(mill.pass(3000), "ok\r\n", "the second block waits");
    let status = mill.status();
    assert!(status.starts_with("<Hold:0|MPos:1.000,"), "{status}");
    assert!(status.contains("|Pn:TQ|"), "{status}");
    assert!(mill.realtime(b'~').contains("ok\r\n"));
    assert!(mill.status().starts_with("<Hold:0|MPos:2.000,"));
}

/// A reset brakes, so the position stays valid, and there is no alarm.
#[test]
fn a_reset_brakes() {
    let mut mill = Session::new();
    mill.ask(&["G1X20F3000"]);
    mill.pass(500);
    mill.send(b"\x18");
    let said = mill.pass(2000);
    assert!(said.starts_with("\r\nGrblHAL 1.1f"), "{said}");
    let status = mill.status();
    assert!(status.starts_with("<Idle|MPos:"), "{status}");
    let place = mill.device.control("where");
    let x = |text: &str, before: &str| -> i64 {
        let at = text.find(before).unwrap() + before.len();
        text[at..].split(' ').next().unwrap().parse().unwrap()
    };
    let steps = x(&place, "x ");
    assert_eq!(steps, x(&place, "stand at "), "{place}");
    let mm: f64 = status[11..].split(',').next().unwrap().parse().unwrap();
    assert_eq!((mm * 250.0).round() as i64, steps);
    assert!(steps > 250, "{place}");
}

/// Canned cycles and modes that are saved.
#[test]
fn codes_beyond_grbl_are_executed() {
    let mut mill = Session::new();
    let lines = [
        "G0Z2",
        "G99G81X1Z-3R1F600",
        "X2",
        "G80",
        "M70",
        "G91G20",
        "M72",
    ];
    assert_eq!(mill.ask(&lines), "ok\r\n".repeat(7));
    let said = mill.ask(&["$G"]);
    assert!(
        said.starts_with("[GC:G80 G54 G17 G21 G90 G94 G40 G49 G99"),
        "{said}"
    );
    mill.pass(5000);
    let status = mill.status();
    assert!(
        status.starts_with("<Idle|MPos:2.000,0.000,1.000|"),
        "{status}"
    );
    // The feed override has no effect while M50 P0 is in effect.
    mill.ask(&["M50P0"]);
    mill.send(b"\x91");
    mill.ask(&["G1X20F600"]);
    mill.pass(600);
    let status = mill.status();
    assert!(
        status.contains("|FS:600,0|") && status.contains("|Ov:110,"),
        "{status}"
    );
}

/// The jog ends at the limits, where `$40` is set; reports come by themselves with `$481`.
#[test]
fn settings_beyond_grbl_take_effect() {
    let mut mill = Session::new();
    mill.ask(&[
        "$22=3", "$24=100", "$25=1200", "$26=25", "$130=30", "$H", "$20=1",
    ]);
    assert_eq!(mill.ask(&["$J=X-90F3000"]), "error:15\r\n");
    assert_eq!(mill.ask(&["$40=1", "$J=X-90F3000"]), "ok\r\nok\r\n");
    mill.pass(5000);
    assert!(mill.status().contains("MPos:-30.000,"));
    assert_eq!(mill.ask(&["$HX"]).matches("ok").count(), 1);
    let said = mill.ask(&["$481=50", "$481=200"]);
    assert!(said.starts_with("error:52\r\nok\r\n"), "{said}");
    let reports = mill.pass(2000).matches('<').count();
    assert!((9..=10).contains(&reports), "{reports}");
    assert_eq!(mill.ask(&["$62=0", "$SLP"]).lines().last(), Some("error:3"));
}
