//! Resets of the Grbl controller: the position stays valid where no axis moves.

use husillo_controllers::{
    Controller, Grbl, GrblEvent, GrblInputs, GrblMemory, GrblOptions, Timed,
};

/// A controller with its motors.
struct Driven {
    grbl: Grbl,
    inputs: GrblInputs,
    motors: [i32; 3],
    us: u64,
    /// An event that is being made, and its time.
    present: Option<(GrblEvent, u64)>,
    said: String,
}

impl Driven {
    fn new(options: GrblOptions) -> Self {
        let mut driven = Driven {
            grbl: Grbl::new(options, Some(&GrblMemory::FACTORY)),
            inputs: GrblInputs::default(),
            motors: [0; 3],
            us: 0,
            present: None,
            said: String::new(),
        };
        driven.pass(1_000_000);
        driven
    }

    /// Makes the events of a time, or until there are none.
    fn pass(&mut self, us: u64) {
        let end = self.us + us;
        while self.us < end {
            let said = std::iter::from_fn(|| self.grbl.transmit());
            self.said.extend(said.map(char::from));
            let Some((event, at)) = self.present.take().or_else(|| self.next()) else {
                return;
            };
            if at > end {
                // It is still being made when the next byte arrives.
                self.present = Some((event, at));
                self.us = end;
                return;
            }
            self.us = at;
            if let GrblEvent::Step { delta, .. } = event {
                for (motor, delta) in self.motors.iter_mut().zip(delta) {
                    *motor += i32::from(delta);
                }
            }
            self.grbl.made(0, 1);
        }
    }

    /// Returns the next event with a wait, and its time.
    fn next(&mut self) -> Option<(GrblEvent, u64)> {
        loop {
            let event = self.grbl.next_event(0, &self.inputs)?;
            if let Some(wait) = event.wait_ticks() {
                return Some((event, self.us + u64::from(wait)));
            }
        }
    }

    fn send(&mut self, text: &str) {
        self.send_bytes(text.as_bytes());
    }

    fn send_bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            if self.grbl.receive(*byte) {
                self.present = None;
                self.grbl.halted();
            }
        }
    }

    /// Resets the controller. Returns what it says.
    fn reset(&mut self) -> String {
        self.said.clear();
        self.send("\x18");
        self.pass(2_000_000);
        std::mem::take(&mut self.said)
    }

    /// Moves to X-1 Y2 and asserts that the motors are there.
    fn is_exact(&mut self) {
        assert_eq!(self.grbl.position_steps(), self.motors);
        self.said.clear();
        self.send("G90G0X-1Y2Z0\n");
        self.pass(60_000_000);
        assert!(self.said.starts_with("ok"), "{}", self.said);
        assert_eq!(self.motors, [-250, 500, 0]);
    }
}

/// In none of these states does an axis move. No reset is an alarm, and the next move ends where it
/// would have ended without it.
#[test]
fn a_reset_without_motion_keeps_the_position() {
    type Prepare = fn(&mut Driven);
    let states: [(&str, Prepare); 8] = [
        ("idle", |_| {}),
        ("a move has not begun", |mill| mill.send("G0X3\n")),
        ("dwell", |mill| {
            mill.send("G0X1\nG4P30\n");
            mill.pass(20_000_000);
        }),
        ("M0", |mill| {
            mill.send("G1X1F300\nM0\n");
            mill.pass(20_000_000);
        }),
        ("a hold at rest", |mill| {
            mill.send("G1X9Z1F300\n");
            mill.pass(600_000);
            mill.send("!");
            mill.pass(1_000_000);
        }),
        ("a cancelled jog", |mill| {
            mill.send("$J=G91X9F300\n");
            mill.pass(600_000);
            mill.send_bytes(&[0x85]);
            mill.pass(1_000_000);
        }),
        ("check mode", |mill| {
            mill.send("$C\nG0X9\n");
            mill.pass(1_000_000);
        }),
        ("door", |mill| {
            mill.send("G1X9Z1F300\n");
            mill.pass(600_000);
            mill.inputs.door = false;
            mill.pass(5_000_000);
            mill.inputs.door = true;
            mill.pass(1000);
        }),
    ];
    for (name, prepare) in states {
        let mut mill = Driven::new(GrblOptions::FULL);
        prepare(&mut mill);
        let before = mill.motors;
        let said = mill.reset();
        assert!(said.contains("Grbl 1.1h"), "{name}: {said}");
        assert!(!said.contains("ALARM"), "{name}: {said}");
        assert_eq!(mill.motors, before, "{name}");
        mill.is_exact();
    }
}

/// The first step of a motion decides whether a reset is an alarm. Grbl reports one from its begin
/// on.
#[test]
fn a_reset_before_the_first_step_is_no_alarm() {
    for (options, alarms_at_once) in [(GrblOptions::FULL, false), (GrblOptions::STOCK, true)] {
        let (mut alarms, mut free) = (0, 0);
        for us in (3000..40_000).step_by(500) {
            let mut mill = Driven::new(options);
            mill.send("G1X9F300\n");
            mill.pass(us);
            let has_moved = mill.motors != [0; 3];
            let said = mill.reset();
            let is_alarm = said.contains("ALARM:3");
            assert!(is_alarm || !has_moved, "{us}: {said}");
            if !has_moved && !alarms_at_once {
                assert!(!is_alarm, "{us}: {said}");
            }
            alarms += i32::from(is_alarm);
            free += i32::from(!is_alarm);
            if is_alarm {
                mill.send("$X\n");
                mill.pass(1000);
            }
            mill.is_exact();
        }
        assert!(alarms > 0, "{options:?}");
        assert!(alarms_at_once || free > 0, "{options:?}");
    }
}

/// In motion it is an alarm, and the reported position is that of the steps made.
#[test]
fn a_reset_in_motion_is_an_alarm_with_the_position_of_the_steps() {
    for us in [100_000, 500_000, 900_000] {
        let mut mill = Driven::new(GrblOptions::FULL);
        mill.send("G1X9Z1F300\n");
        mill.pass(us);
        let before = mill.motors;
        assert!(mill.reset().contains("ALARM:3"));
        assert_eq!(mill.motors, before);
        mill.send("$X\n");
        mill.pass(1000);
        mill.is_exact();
    }
}
