//! The simulated mill with a Grbl controller: its switches, its probe, its panel.

use husillo_sim::device::Emulation;
use husillo_sim::device::grbl::Device;
use husillo_transports::grbl::Settings;

struct Session {
    device: Device,
}

impl Session {
    fn new() -> Self {
        let mut settings = Settings::DEFAULT;
        for setting in [
            "22=1", "24=100", "25=1200", "26=25", "110=3000", "111=3000", "112=3000",
        ] {
            let (number, value) = setting.split_once('=').unwrap();
            settings
                .write(number.parse().unwrap(), value.as_bytes())
                .unwrap();
        }
        for number in 120..123 {
            settings.write(number, b"200").unwrap();
        }
        let mut session = Session {
            device: Device::new(115_200, settings),
        };
        session.pass(100);
        session
    }

    /// What the device says in this time, ms.
    fn pass(&mut self, ms: usize) -> String {
        let bytes = (0..ms).flat_map(|_| self.device.tick()).collect();
        String::from_utf8(bytes).unwrap()
    }

    /// Sends a text. Returns all that is said until an answer, or in 60 s.
    fn ask(&mut self, text: &str) -> String {
        text.bytes().for_each(|byte| self.device.send(byte));
        let mut said = String::new();
        for _ in 0..60_000 {
            said += &self.pass(1);
            if said.ends_with("ok\r\n") || said.contains("error:") && said.ends_with('\n') {
                break;
            }
        }
        said
    }

    /// A status report.
    fn status(&mut self) -> String {
        self.device.send(b'?');
        self.pass(20)
    }
}

/// The mill homes at its switches, and the probe finds the plate with the position of the contact.
#[test]
fn it_homes_and_probes() {
    let mut session = Session::new();
    assert!(session.status().starts_with("<Alarm|"));
    assert_eq!(session.ask("G0X1\n"), "error:9\r\n");
    assert_eq!(session.ask("$H\n"), "ok\r\n");
    assert!(
        session
            .status()
            .starts_with("<Idle|MPos:-1.000,-1.000,-1.000|")
    );
    let rig = session.device.rig(0).unwrap();
    // The switches are 20, 20 and 10 mm above the first place.
    assert_eq!(rig.steps(), [19 * 250, 19 * 250, 9 * 250]);
    assert_eq!(
        session.ask("G38.2 Z-40 F300\n"),
        "[PRB:-1.000,-1.000,-20.000:1]\r\nok\r\n"
    );
    let status = session.status();
    assert!(status.contains("|Pn:P"), "{status}");
    assert_eq!(session.ask("G38.2 Z-40 F300\n"), "ALARM:4\r\nok\r\n");
}

/// A switch that the operator closes ends the motion where hard limits are on. A reset and `$X`
/// bring the mill back, at the place where it is.
#[test]
fn a_hard_limit_stops_at_once() {
    let mut session = Session::new();
    session.ask("$X\n");
    session.ask("$21=1\n");
    session.ask("G1 X-50 F1500\n");
    session.pass(500);
    assert_eq!(session.device.control("close x"), "x is held closed");
    let at = session.device.rig(0).unwrap().steps()[0];
    assert_eq!(session.pass(100), "ALARM:1\r\n");
    let stood = session.device.rig(0).unwrap().steps()[0];
    // The inputs are read before each step.
    assert!((stood - at).abs() <= 1, "{at} {stood}");
    assert!(session.pass(600).contains("[MSG:Reset to continue]"));
    assert_eq!(session.device.control("free x"), "x is free");
    let said = session.ask("\x18\n");
    assert!(said.contains("to unlock]"), "{said}");
    assert_eq!(session.ask("$X\n"), "[MSG:Caution: Unlocked]\r\nok\r\n");
    let place = format!("MPos:{:.3},0.000,0.000", stood as f64 / 250.0);
    assert!(session.status().contains(&place));
}

/// A blocked motor loses its steps, and the panel counts them. The settings survive a loss of
/// power, the position does not.
#[test]
fn the_panel_blocks_motors_and_cuts_power() {
    let mut session = Session::new();
    session.ask("$X\n");
    session.device.control("block x");
    session.ask("G0 X1\n");
    session.pass(1000);
    assert!(session.device.control("where").contains("250 steps lost"));
    session.device.control("power off");
    session.pass(50);
    session.device.control("power on");
    let said = session.pass(200);
    assert!(said.contains("Grbl 1.1h"), "{said}");
    assert!(session.status().contains("MPos:0.000,0.000,0.000"));
    assert!(session.ask("$$\n").contains("$110=3000.000\r\n"));
}

/// The mill measures a plate that is tilted, and its tool then keeps its distance.
#[test]
fn it_measures_a_height_map_and_follows_it() {
    let mut session = Session::new();
    assert!(session.device.control("tilt 10 -4").contains("10 steps"));
    assert_eq!(session.ask("$H\n"), "ok\r\n");
    assert_eq!(session.ask("G0X-41Y-31Z-8\n"), "ok\r\n");
    assert_eq!(session.ask("G10L20P1X0Y0\n"), "ok\r\n");
    assert_eq!(session.ask("$ZG=0,0,30,20,3,2\n"), "ok\r\n");
    let said = session.ask("$ZP=20,300\n");
    assert_eq!(said.matches("[PRB:").count(), 6, "{said}");
    // 15 mm rise by 0.15 mm, and 20 mm fall by 0.08 mm. A step is 0.004 mm.
    assert_eq!(
        session.ask("$Z\n"),
        "[MAP:0,0.000,0.000,30.000,20.000,3,2]\r\n[HEIGHTS:0,0.000,0.152,0.300]\r\n\
         [HEIGHTS:1,-0.080,0.072,0.220]\r\nok\r\n"
    );
    assert_eq!(session.ask("$Z=1\n"), "ok\r\n");
    assert_eq!(session.ask("G0Z-8\n"), "ok\r\n");
    for (line, [dx, dy, dz]) in [
        ("G0X0Y0\n", [0, 0, 0]),
        ("G0X30\n", [7500, 0, 75]),
        ("G0Y20\n", [7500, 5000, 55]),
        ("G2X0Y20R15F2000\n", [0, 5000, -20]),
        ("G0X0Y0\n", [0, 0, 0]),
    ] {
        session.ask(line);
        // The work zero of X and Y, and the height of the travel between the points.
        let at = [19 * 250 - 40 * 250, 19 * 250 - 30 * 250, 9 * 250 - 7 * 250];
        let expected = [at[0] + dx, at[1] + dy, at[2] + dz];
        session.pass(3000);
        let steps = session.device.rig(0).unwrap().steps();
        assert_eq!(steps[..2], expected[..2], "{line}");
        assert!((steps[2] - expected[2]).abs() <= 1, "{line}: {steps:?}");
        assert!(session.status().contains("-8.000|"), "{line}");
    }
}
