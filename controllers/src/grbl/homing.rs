//! Homing cycles: search, pull off, locate, pull off.

use husillo_gcode::{Command, Feed, Nm};
use husillo_transports::grbl::{Alarm, ErrorCode};

use super::lines::{Outcome, Task};
use super::recovery::After;
use super::{Grbl, Phase};

/// The axes of each homing cycle, bit 0 for X: Z first, then X and Y together.
const CYCLES: [u8; 2] = [0b100, 0b011];
/// Passes of a cycle. Passes with an odd number pull off.
const PASSES: u8 = 4;

/// State of homing.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Homing {
    /// Axes of the present cycle, and those that still move.
    axes: u8,
    moving: u8,
    /// Axes of the next cycle.
    later: u8,
    pass: u8,
    step: Step,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Step {
    /// No homing is in progress.
    #[default]
    Off,
    Moves,
    /// The axes rest while the switches settle. The number is the rest of this time, in
    /// microseconds.
    Settles(u32),
    /// The axes are homed. The stored lines and the answer follow.
    Startup,
}

impl Homing {
    pub(super) fn is_moving(&self) -> bool {
        self.step == Step::Moves
    }

    pub(super) fn is_answered_later(&self) -> bool {
        self.step == Step::Startup
    }

    pub(super) fn end(&mut self) {
        *self = Homing::default();
    }

    const fn is_approach(&self) -> bool {
        self.pass.is_multiple_of(2)
    }

    /// Returns the steps of the axes that still move.
    pub(super) fn kept(&self, delta: [i8; 3]) -> [i8; 3] {
        if !self.is_moving() {
            return delta;
        }
        let mut kept = delta;
        for (axis, delta) in (0_u32..).zip(&mut kept) {
            if self.moving.wrapping_shr(axis) & 1 == 0 {
                *delta = 0;
            }
        }
        kept
    }

    pub(super) const fn wait_us(&self) -> Option<u32> {
        match self.step {
            Step::Settles(left) => Some(left),
            _ => None,
        }
    }

    pub(super) const fn pass(&mut self, us: u32) {
        if let Step::Settles(left) = &mut self.step {
            *left = left.saturating_sub(us);
        }
    }
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Homes all axes (`$H`), or one axis (`$HX`) where the options permit it.
    pub(super) fn home(&mut self, axes: &[u8]) -> Result<Outcome, ErrorCode> {
        if !self.settings().is_set(22) {
            return Err(ErrorCode::HomingDisabled);
        }
        if self.is_door_open() {
            return Err(ErrorCode::DoorOpen);
        }
        let [first, second] = match axes {
            [] => CYCLES,
            b"X" if self.homes_axes() => [0b001, 0],
            b"Y" if self.homes_axes() => [0b010, 0],
            b"Z" if self.homes_axes() => [0b100, 0],
            _ => return Err(ErrorCode::InvalidStatement),
        };
        #[cfg(feature = "height-map")]
        self.drop_map();
        self.homing = Homing {
            axes: first,
            later: second,
            ..Homing::default()
        };
        self.phase = Phase::Home;
        self.task = Task::Home;
        self.begin_pass();
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            self.hal_homes(false);
        }
        Ok(Outcome::Waits)
    }

    /// Whether `$HX` homes one axis.
    fn homes_axes(&self) -> bool {
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            return self.hal_homing_has(1);
        }
        self.options.homes_axes
    }

    /// Begins a pass from the present position.
    fn begin_pass(&mut self) {
        self.drop_moves();
        let settings = *self.settings();
        let axes = self.homing.axes;
        let pull_off = i64::from(settings.milli(27)).wrapping_mul(1000);
        let travel = (0..3_u8)
            .filter(|axis| axes.wrapping_shr((*axis).into()) & 1 == 1)
            .map(|axis| settings.milli(130_u8.wrapping_add(axis)))
            .max();
        let travel = i64::from(travel.unwrap_or(0)).wrapping_mul(1500);
        let (distance, rate) = match self.homing.pass {
            0 => (travel, settings.milli(25)),
            2 => (pull_off.wrapping_mul(5), settings.milli(24)),
            _ => (pull_off.wrapping_neg(), settings.milli(25)),
        };
        let mut to = self.machine.end_position();
        for (axis, to) in (0_u32..).zip(&mut to) {
            if axes.wrapping_shr(axis) & 1 == 0 {
                continue;
            }
            let is_negative = settings.whole(23).wrapping_shr(axis) & 1 == 1;
            let distance = if is_negative {
                distance.wrapping_neg()
            } else {
                distance
            };
            *to = Nm(to.0.saturating_add(distance));
        }
        // Each axis moves at `rate`. The speed along the path is therefore `rate` times the square
        // root of the number of axes.
        let rate = u64::from(rate).wrapping_mul(1000);
        let square = u128::from(rate).wrapping_mul(u128::from(rate));
        let square = square.wrapping_mul(axes.count_ones().into());
        let feed = i64::try_from(square.isqrt()).unwrap_or(i64::MAX).max(1);
        self.homing.moving = axes;
        self.homing.step = Step::Moves;
        self.append(Command::Linear {
            to,
            feed: Feed::PerMinute(Nm(feed)),
        });
    }

    /// Stops each axis whose switch is closed.
    pub(super) fn watch_homing(&mut self) {
        if !self.homing.is_moving() || !self.homing.is_approach() {
            return;
        }
        for axis in 0..3_u32 {
            if self.is_limit_closed(axis as usize) {
                self.homing.moving &= !1_u8.wrapping_shl(axis);
            }
        }
        if self.homing.moving == 0 {
            self.end_pass();
        }
    }

    /// Handles the end of a pass whose steps are all made.
    pub(super) fn homing_stopped(&mut self) {
        if self.homing.is_approach() {
            self.fail_homing(Alarm::HomingApproach);
        } else {
            self.end_pass();
        }
    }

    fn fail_homing(&mut self, alarm: Alarm) {
        self.drop_moves();
        self.alarm(alarm, After::Boot);
    }

    fn end_pass(&mut self) {
        self.drop_moves();
        let debounce_us = self.settings().whole(26).wrapping_mul(1000);
        self.homing.step = Step::Settles(debounce_us);
    }

    /// Continues after a pass. Returns whether there may be more to do.
    pub(super) fn continue_homing(&mut self) -> bool {
        if self.homing.step != Step::Settles(0) {
            return false;
        }
        let axes = self.homing.axes;
        let closed = (0..3_u32)
            .any(|axis| axes.wrapping_shr(axis) & 1 == 1 && self.is_limit_closed(axis as usize));
        if !self.homing.is_approach() && closed {
            self.fail_homing(Alarm::HomingPullOff);
            return true;
        }
        self.homing.pass = self.homing.pass.wrapping_add(1); // at most 4
        if self.homing.pass < PASSES {
            self.begin_pass();
            return true;
        }
        self.set_home(axes);
        if self.homing.later != 0 {
            self.homing = Homing {
                axes: self.homing.later,
                ..Homing::default()
            };
            self.begin_pass();
            return true;
        }
        if core::mem::take(&mut self.flags.status) {
            self.report_status();
        }
        self.phase = Phase::Idle;
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            self.hal_homes(true);
        }
        self.rest_motors();
        self.homing.step = Step::Startup;
        self.task = Task::Startup(0);
        true
    }

    /// Sets the positions of homed axes, which are at their pull-off.
    fn set_home(&mut self, axes: u8) {
        let settings = *self.settings();
        let mut place = self.position();
        for (axis, place) in (0_u8..).zip(&mut place) {
            if axes.wrapping_shr(axis.into()) & 1 == 0 {
                continue;
            }
            let pull_off = i64::from(settings.milli(27)).wrapping_mul(1000);
            let travel = i64::from(settings.milli(130_u8.wrapping_add(axis))).wrapping_mul(1000);
            let is_negative = settings.whole(23).wrapping_shr(axis.into()) & 1 == 1;
            *place = Nm(if is_negative {
                pull_off.saturating_sub(travel)
            } else {
                pull_off.wrapping_neg()
            });
        }
        // The settings keep the position within the range of the axes. If the position is out of
        // range, the axes keep their positions.
        if let Ok(steps) = self.machine.config().nearest_steps(&place) {
            self.steps = steps;
        }
        self.drop_moves();
    }
}
