//! Motion by hand: homing, the manual mode and its keys, spindle, teaching, the work zero.

use super::Driver;
use super::bench::Work;
use super::stepping::Trouble;
use crate::serve::axes::Axes;
use crate::serve::console_lines::From;
use crate::serve::request::Frame;
use crate::serve::tool_path::Motion;
use husillo_transports::drill::{STEPS_PER_MM, Step};
use serde_json::{Value, json};

/// Most steps of one key, so that a STOP acts after a fifth of a second.
const MOST_STEPS: i64 = 50;
/// Most steps of one request: beyond the table.
const MOST: i64 = 30_000;

impl Driver<'_> {
    /// Homes Z, Y and X.
    pub(super) fn home(&mut self) -> Result<(), Trouble> {
        self.expect_free()?;
        let step = match self.bench.is_manual {
            true => Step::Key(b'r'),
            false => Step::Home,
        };
        self.bench.machine.tell(From::Host, "home");
        self.work(Work::Home, step)?;
        self.read_place()?;
        self.bench.begin_path();
        Ok(())
    }

    /// Enters the manual mode, which homes the drill, or leaves it.
    pub(super) fn manual(&mut self, on: bool) -> Result<(), Trouble> {
        self.expect_free()?;
        if !on {
            return self.idle();
        }
        if self.bench.is_manual {
            return Ok(());
        }
        let advance = MOST_STEPS as u8;
        self.bench.machine.tell(From::Host, "manual mode");
        self.work(Work::Home, Step::ManualKept(advance))?;
        (self.bench.is_manual, self.bench.advance) = (true, advance);
        self.read_place()?;
        self.bench.begin_path();
        Ok(())
    }

    /// Leaves the manual mode.
    pub(super) fn idle(&mut self) -> Result<(), Trouble> {
        if !std::mem::take(&mut self.bench.is_manual) {
            return Ok(());
        }
        self.bench.machine.tell(From::Host, "manual mode ends");
        self.step(Step::Quit)
    }

    /// Moves by lengths, one axis after the other.
    pub(super) fn step_mm(&mut self, by: &Axes) -> Result<(), Trouble> {
        let by = by.checked(3).map_err(Trouble::Refused)?;
        let steps = by.into_iter().map(|(axis, mm)| {
            let steps = (mm * f64::from(STEPS_PER_MM)).round();
            (axis, steps as i64)
        });
        self.move_steps(&steps.collect::<Vec<_>>())
    }

    /// Moves by steps of the motors, one axis after the other. Z is positive upwards.
    pub(super) fn steps(&mut self, by: &Axes) -> Result<(), Trouble> {
        let by = by.checked(3).map_err(Trouble::Refused)?;
        if by.iter().any(|(_, steps)| steps.fract() != 0.0) {
            return Err(Trouble::refused("steps are whole numbers"));
        }
        let steps = by.into_iter().map(|(axis, steps)| (axis, steps as i64));
        self.move_steps(&steps.collect::<Vec<_>>())
    }

    /// Moves to a position.
    pub(super) fn go(&mut self, to: &Axes, frame: Frame) -> Result<(), Trouble> {
        let to = to.checked(3).map_err(Trouble::Refused)?;
        if !self.bench.place.is_some_and(|place| place.machine.is_up) {
            return Err(Trouble::refused(
                "raise the bit first: it may be in the board",
            ));
        }
        let (at, zero) = (self.bench.at(), self.bench.zero());
        let mut by = Vec::new();
        for (axis, mm) in to {
            let (Some(at), Some(zero)) = (at.get(axis), zero.get(axis)) else {
                return Err(Trouble::refused("Z has no position of its own"));
            };
            let target = (mm * f64::from(STEPS_PER_MM)).round() as i64;
            let from = match frame {
                Frame::Work => 0,
                Frame::Machine => i64::from(*zero),
            };
            if target - from < 0 {
                return Err(Trouble::refused("this is beyond the zero"));
            }
            by.push((axis, target - from - i64::from(*at)));
        }
        self.move_steps(&by)
    }

    fn move_steps(&mut self, by: &[(usize, i64)]) -> Result<(), Trouble> {
        self.expect_free()?;
        self.bench.expect_manual().map_err(Trouble::Refused)?;
        if by.iter().any(|(_, steps)| steps.abs() > MOST) {
            return Err(Trouble::Refused(format!("{MOST} steps at most")));
        }
        let mut result = Ok(());
        for (axis, steps) in by.iter().filter(|(_, steps)| *steps != 0) {
            result = self.keys(*axis, *steps);
            if result.is_err() {
                break;
            }
        }
        match result {
            Err(Trouble::Lost(why)) => Err(Trouble::Lost(why)),
            result => self.read_place().and(result),
        }
    }

    /// Moves an axis by keys of the manual mode. Z is positive upwards.
    pub(super) fn keys(&mut self, axis: usize, steps: i64) -> Result<(), Trouble> {
        let key = match (axis, steps > 0) {
            (0, true) => b'D',
            (0, false) => b'I',
            (1, true) => b'F',
            (1, false) => b'R',
            (_, true) => b'U',
            (_, false) => b'L',
        };
        let mut left = steps.abs();
        while left > 0 {
            if self.bench.must_halt() {
                return Err(Trouble::Halted(self.bench.halting.unwrap_or("stopped")));
            }
            let part = left.min(MOST_STEPS);
            let advance = part as u8;
            if self.bench.advance != advance {
                self.work(Self::of_axis(axis), Step::Advance(advance))?;
                self.bench.advance = advance;
            }
            let from = self.bench.at().get(axis).copied().unwrap_or_default();
            self.work(Self::of_axis(axis), Step::Key(key))?;
            if axis < 2 {
                let to = i64::from(from) + part * steps.signum();
                let to = to.clamp(0, u16::MAX.into()) as u16;
                self.bench.moved(axis, to, Motion::Jog);
            }
            left -= part;
        }
        Ok(())
    }

    /// Switches the spindle by hand.
    pub(super) fn switch_spindle(&mut self, on: bool) -> Result<(), Trouble> {
        self.expect_free()?;
        self.spindle(on)
    }

    /// Switches the spindle.
    pub(super) fn spindle(&mut self, on: bool) -> Result<(), Trouble> {
        if self.bench.has_spindle == on {
            return Ok(());
        }
        let step = match (self.bench.is_manual, on) {
            (true, true) => Step::Key(b'O'),
            (true, false) => Step::Key(b'S'),
            (false, on) => Step::Spindle(on),
        };
        self.bench.has_spindle |= on;
        self.step(step)?;
        self.bench.has_spindle = on;
        Ok(())
    }

    /// Makes the present position a hole of the program in the memory.
    pub(super) fn teach(&mut self) -> Result<(), Trouble> {
        self.expect_free()?;
        self.bench.expect_manual().map_err(Trouble::Refused)?;
        self.step(Step::Teach)?;
        self.bench.taught.push(self.bench.at());
        let text = format!("hole {} is taught", self.bench.taught.len());
        self.bench.machine.tell(From::Server, text);
        self.read_place()
    }

    /// Makes the present position zero, and clears the memory.
    pub(super) fn zero(&mut self, at: &Axes) -> Result<(), Trouble> {
        self.expect_free()?;
        let at = at.checked(3).map_err(Trouble::Refused)?;
        let has = |wanted: usize| at.iter().any(|(axis, _)| *axis == wanted);
        if at.iter().any(|(_, mm)| *mm != 0.0) || !has(0) || !has(1) {
            return Err(Trouble::refused(
                "a drill sets the zero of X and Y at once, to 0",
            ));
        }
        let step = match self.bench.is_manual {
            true => Step::Key(b'c'),
            false => Step::Clear,
        };
        self.step(step)?;
        self.bench.taught.clear();
        self.read_place()
    }

    /// Tests the link. Returns the time of an answer.
    pub(super) fn test_link(&mut self) -> Result<Value, Trouble> {
        self.expect_free()?;
        let begun = self.client.elapsed();
        let step = match self.bench.is_manual {
            true => Step::Key(b'B'),
            false => Step::Test,
        };
        self.step(step)?;
        let ms = (self.client.elapsed() - begun).as_millis() as u64;
        let text = format!("the link works: answered within {ms} ms");
        self.bench.machine.tell(From::Server, text);
        Ok(json!({"ms": ms}))
    }

    pub(super) fn expect_free(&self) -> Result<(), Trouble> {
        self.bench.is_free().map_err(Trouble::Refused)
    }
}
