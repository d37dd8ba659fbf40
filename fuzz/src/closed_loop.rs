//! Any commands to, and faults of, stepping axes with encoders.

use husillo_gcode::{Dialect, Nm};
use husillo_machine::{
    Axis, AxisEncoder, AxisRamp, ClosedLoop, Config, Equipment, Event, Followed, MAX_WAIT_TICKS,
    Machine, OnLoss, Refused, Scale,
};

use crate::bytes::Bytes;

/// More events than any input can request: beyond this it hangs.
const MOST_EVENTS: u32 = 400_000;
/// Backlash of the axes in steps.
const BACKLASH: i64 = 3;

/// Motors that are turned or blocked, and what was reported about them.
struct Bench {
    axes: ClosedLoop<2>,
    /// Encoder counts, and the motor steps they correspond to.
    ratio: [i64; 2],
    motor: [i64; 2],
    /// Positions of the motors without faults.
    should: [i64; 2],
    is_blocked: [bool; 2],
    /// Whether a motor was disturbed since the last step of the path.
    is_disturbed: bool,
    lost: [i64; 2],
    events: u32,
}

/// Lines, holds, aborts and overrides in any order while motors are turned and blocked.
///
/// - Nothing hangs, no wait is longer than documented, and the path stays within the travel.
/// - Re-emitted steps go no farther than across the backlash.
/// - Only a motor that was blocked or turned is reported as stalled.
/// - After release and resume, a motor that is corrected is at its expected position. For a motor
///   that is only observed, every missing step was reported.
pub fn closed_loop(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let Some(scale) = Scale::new(100_000, 1) else {
        return;
    };
    let ramp = AxisRamp {
        acceleration_hz_per_s: 2000,
        start_rate_hz: 0,
        jerk_hz_per_s2: None,
        junction_hz: Some(30),
    };
    let kind = bytes.byte();
    let axis = Axis {
        scale,
        travel: Some([Nm(-10_000_000), Nm(10_000_000)]),
        max_rate_hz: 1000,
        backlash_steps: BACKLASH as u32,
        ramp: (kind & 1 != 0).then_some(ramp),
    };
    let on_loss = [OnLoss::Report, OnLoss::Stop, OnLoss::Correct][usize::from(kind >> 1) % 3];
    let (counts, steps) =
        [(1, 1), (4, 1), (1000, 7), (1, 3), (3, 2)][usize::from(bytes.byte()) % 5];
    let encoder = AxisEncoder {
        counts,
        steps,
        tolerance_steps: 1 + u32::from(bytes.byte() % 8),
        on_loss,
        correction_rate_hz: 200,
        settle_ticks: 1000,
        attempts: bytes.byte() % 4,
    };
    let machine = Machine::new(Config {
        axes: [axis; 2],
        timer_hz: 1_000_000,
        dialect: Dialect::RS274,
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        corner_deviation: None,
        equipment: Equipment::NONE,
        spindle_counts: None,
    });
    let mut bench = Bench {
        axes: ClosedLoop::new(machine, [Some(encoder); 2]),
        ratio: [counts.into(), steps.into()],
        motor: [0; 2],
        should: [0; 2],
        is_blocked: [false; 2],
        is_disturbed: false,
        lost: [0; 2],
        events: 0,
    };
    // The present positions are the expected ones.
    bench.pull();
    for _ in 0..64 {
        if bytes.is_empty() {
            break;
        }
        bench.turn(&mut bytes);
    }
    bench.end(on_loss, encoder.attempts);
}

impl Bench {
    /// Makes a command or a fault, and then some events.
    fn turn(&mut self, bytes: &mut Bytes<'_>) {
        match bytes.byte() % 8 {
            0 => self.axes.hold(),
            1 => self.axes.resume(),
            2 => self.axes.abort(),
            3 => {
                let axis = usize::from(bytes.byte() & 1);
                self.motor[axis] += i64::from(bytes.byte() % 33) - 16;
                self.is_disturbed = true;
            }
            4 => {
                let flags = bytes.byte();
                self.is_blocked = [flags & 1 != 0, flags & 2 != 0];
                self.is_disturbed = true;
            }
            _ => self.line(bytes),
        }
        for _ in 0..bytes.byte() {
            if !self.pull() {
                break;
            }
        }
    }

    /// Sends a valid line; a refused one changes nothing.
    fn line(&mut self, bytes: &mut Bytes<'_>) {
        let place = |bytes: &mut Bytes<'_>| f64::from(bytes.byte() as i8) / 10.0;
        let (x, y) = (place(bytes), place(bytes));
        let text = match bytes.byte() % 6 {
            0 => format!("G0 X{x}"),
            1 => format!("G1 F600 Y{y}"),
            2 => format!("G3 F900 I{x} J{y}"),
            3 => "G4 P0.01".to_owned(),
            4 => "S100 M3".to_owned(),
            _ => format!("G1 F1200 X{x} Y{y}"),
        };
        let machine = self.axes.machine_mut();
        let before = format!("{:?}", machine.modal());
        match machine.line(text.as_bytes()) {
            Ok(()) | Err(Refused::Busy) => {}
            Err(_) => assert_eq!(before, format!("{:?}", machine.modal())),
        }
        if bytes.byte().is_multiple_of(8) {
            machine.set_feed_override(bytes.byte());
        }
    }

    /// Takes one entry; returns whether there was one.
    fn pull(&mut self) -> bool {
        let [counts, steps] = self.ratio;
        let read = self.motor.map(|motor| (motor * counts).div_euclid(steps));
        let Some(entry) = self.axes.next_event(&read) else {
            return false;
        };
        self.events += 1;
        assert!(self.events < MOST_EVENTS, "hangs");
        match entry {
            Followed::Event(Event::Step(step)) => {
                assert!(step.wait_ticks <= MAX_WAIT_TICKS);
                self.step(step.delta);
            }
            Followed::Event(Event::Dwell { wait_ticks }) => assert!(wait_ticks <= MAX_WAIT_TICKS),
            Followed::Event(_) => {}
            Followed::Lost { axis, steps } => self.lost[axis] += i64::from(steps),
            Followed::Corrected { .. } => {}
            Followed::Stalled { axis, .. } => {
                assert!(self.axes.is_stopped());
                assert!(self.off(axis) != 0, "it stands where it should");
            }
        }
        true
    }

    fn step(&mut self, delta: [i8; 2]) {
        assert!(delta != [0; 2] && delta.iter().all(|delta| delta.abs() <= 1));
        let before = [0, 1].map(|axis| self.off(axis));
        for ((motor, is_blocked), delta) in self.motor.iter_mut().zip(self.is_blocked).zip(delta) {
            if !is_blocked {
                *motor += i64::from(delta);
            }
        }
        if self.axes.is_correcting() {
            for (axis, before) in before.into_iter().enumerate() {
                let most = before.max(BACKLASH + self.slack() + 1);
                assert!(self.is_disturbed || self.off(axis) <= most, "too far");
            }
        } else {
            for (should, delta) in self.should.iter_mut().zip(delta) {
                *should += i64::from(delta);
            }
            self.is_disturbed = false;
        }
        let within = self.axes.machine().position_steps();
        // Half a step of rounding; the nearest point of an arc may be one step off it.
        assert!(within.iter().all(|at| at.abs() <= 101), "{within:?}");
    }

    /// Distance of a motor from its expected position.
    fn off(&self, axis: usize) -> i64 {
        (self.should[axis] - self.motor[axis]).abs()
    }

    /// Slack for counts coarser than a step: a motor may be anywhere within its count, and the
    /// count within one of the expected one.
    fn slack(&self) -> i64 {
        let [counts, steps] = self.ratio;
        2 * ((steps + counts - 1) / counts - 1)
    }

    /// Ends all disturbances and resumes.
    fn end(&mut self, on_loss: OnLoss, attempts: u8) {
        self.is_blocked = [false; 2];
        self.is_disturbed = true;
        self.axes.machine_mut().set_feed_override(100);
        for _ in 0..8 {
            self.axes.resume();
            while self.pull() {}
            if !self.axes.is_stopped() {
                break;
            }
        }
        // Without attempts no step is re-emitted.
        if attempts == 0 && on_loss != OnLoss::Report {
            return;
        }
        assert!(!self.axes.is_stopped(), "freed, it goes on");
        for axis in 0..2 {
            let off = match on_loss {
                OnLoss::Report => (self.should[axis] - self.motor[axis] - self.lost[axis]).abs(),
                OnLoss::Stop | OnLoss::Correct => self.off(axis),
            };
            assert!(off <= self.slack(), "{on_loss:?}: axis {axis} off by {off}");
        }
    }
}
