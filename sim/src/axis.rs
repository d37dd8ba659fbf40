//! One axis: the field of the coils, rotor, screw and nut.
//!
//! Angles are in 1/65536 of an electrical cycle. A full step is a quarter of a cycle, 16384. The
//! position of the rotor is an angle that counts on over all cycles. `i64` has room for 2^47
//! cycles.

use husillo_stepper::{Driver, Levels, PulseTiming};

use crate::loss::Cause;
use crate::model::{AxisModel, Stage};

/// A full step.
const FULL_STEP: i64 = 16384;

/// Table entry for levels without current in both coils. All angles are below it.
const NO_CURRENT: u32 = 1 << 16;

#[derive(Clone, Debug)]
pub(crate) struct Axis {
    /// The equilibrium angle of the rotor for every byte of levels.
    equilibrium: Box<[u32; 256]>,
    levels: u8,
    reversed: bool,
    stage: Stage,
    pull_out_ticks: u64,
    /// Time of the last change of levels.
    changed_at: u64,
    rotor: i64,
    /// Angle of the field minus that of the rotor, over all cycles. 0 while the rotor follows.
    slip: i64,
    /// Last jump of the field. It decides the direction of the next jump of half a cycle.
    last_jump: i16,
    nut: i64,
    backlash: i64,
    /// Zero of the step count: the nominal angle of the first levels.
    zero: i64,
    step: i64,
    is_blocked: bool,
    /// Lowest and highest position of the rotor, at the mechanical ends.
    ends: [i64; 2],
    pulse: Pulse,
    pub(crate) lost_steps: u64,
}

/// Times of the last changes at the inputs of a step and direction driver.
#[derive(Copy, Clone, Debug, Default)]
struct Pulse {
    turned_at: u64,
    rose_at: u64,
    fell_at: u64,
    /// Angle by which the rotor turned at the last rising edge; 0 if it made no step.
    made: i64,
}

impl Axis {
    /// Creates an axis whose rotor rests at the equilibrium of `levels` and whose nut is on its
    /// positive flank, both at 0.
    pub(crate) fn new(model: AxisModel, levels: Levels) -> Axis {
        let equilibrium = match model.stage {
            Stage::Coils(driver) => equilibria(driver, model.reversed),
            Stage::StepDirection(_) | Stage::StepToggle => Box::new([NO_CURRENT; 256]),
        };
        let start = i64::from(equilibrium[usize::from(levels.0)] & 0xFFFF);
        // Nominal angles are multiples of a quarter step. The real equilibria are only near them
        // (PBL3717A: 59.0 degrees instead of 67.5).
        let quarter = FULL_STEP / 4;
        let step = FULL_STEP / i64::from(model.steps_per_full);
        let [below, above] = model.ends_steps;
        Axis {
            equilibrium,
            levels: levels.0,
            reversed: model.reversed,
            stage: model.stage,
            pull_out_ticks: u64::from(model.pull_out_ticks),
            changed_at: 0,
            rotor: start,
            slip: 0,
            last_jump: 0,
            nut: start,
            backlash: i64::from(model.backlash_steps) * step,
            zero: (start + quarter / 2) / quarter * quarter,
            step,
            is_blocked: false,
            ends: [
                below.map_or(i64::MIN, |steps| start - i64::from(steps) * step),
                above.map_or(i64::MAX, |steps| start + i64::from(steps) * step),
            ],
            pulse: Pulse::default(),
            lost_steps: 0,
        }
    }

    /// Makes `steps` the step count of the present position.
    pub(crate) fn call(&mut self, steps: i32) {
        self.zero -= i64::from(steps) * self.step;
    }

    /// Blocks or releases the rotor. A blocked rotor does not follow the field.
    pub(crate) const fn block(&mut self, is_blocked: bool) {
        self.is_blocked = is_blocked;
    }

    /// Turns the rotor by about `steps`, to the nearest equilibrium, as a stronger load does.
    /// Returns the steps it turned.
    pub(crate) fn push(&mut self, steps: i32) -> i32 {
        let way = match self.stage {
            // Equilibria are one cycle apart.
            Stage::Coils(_) => {
                let cycles = (i64::from(steps) * self.step + 32768).div_euclid(65536);
                self.slip -= cycles * 65536;
                cycles * 65536
            }
            Stage::StepDirection(_) | Stage::StepToggle => i64::from(steps) * self.step,
        };
        self.turn(way);
        let made = way / self.step;
        self.lost_steps += made.unsigned_abs();
        // Rounded to the nearest multiple of a cycle.
        made as i32
    }

    /// Changes the backlash, in steps. If it shrinks, a flank pushes the nut.
    pub(crate) fn set_backlash(&mut self, steps: f64) {
        self.backlash = (steps * self.step as f64).round() as i64;
        self.turn(0);
    }

    /// Nut position in steps, with a fraction.
    pub(crate) fn nut_steps(&self) -> f64 {
        (self.nut - self.zero) as f64 / self.step as f64
    }

    /// Applies new levels at time `now`. They differ from the old ones. Returns lost steps and
    /// their cause.
    #[inline]
    pub(crate) fn change(&mut self, levels: u8, now: u64) -> Option<(u32, Cause)> {
        if let Stage::StepDirection(timing) = self.stage {
            let before = std::mem::replace(&mut self.levels, levels);
            return self.pulse(before, timing, now);
        }
        let angle = self.equilibrium[usize::from(levels)];
        let jump = (angle as u16).wrapping_sub(self.rotor as u16) as i16;
        let is_held = self.is_held(i64::from(jump));
        let in_time = !is_held && now - self.changed_at >= self.pull_out_ticks;
        if in_time && angle < NO_CURRENT && jump != i16::MIN && self.slip == 0 {
            self.changed_at = now;
            self.levels = levels;
            self.last_jump = jump;
            self.turn(i64::from(jump));
            return None;
        }
        let before = std::mem::replace(&mut self.levels, levels);
        match self.stage {
            Stage::Coils(_) => self.stray(before, angle, in_time, now),
            Stage::StepDirection(timing) => self.pulse(before, timing, now),
            Stage::StepToggle => self.toggle(before, now),
        }
    }

    /// Whether the rotor cannot turn by `jump`.
    #[inline]
    const fn is_held(&self, jump: i64) -> bool {
        let [below, above] = self.ends;
        let to = self.rotor + jump;
        self.is_blocked || to < below || to > above
    }

    /// Turns the screw by `jump`; the nut follows outside its backlash.
    #[inline]
    fn turn(&mut self, jump: i64) {
        self.rotor += jump;
        self.nut = self.nut.max(self.rotor).min(self.rotor + self.backlash);
    }

    /// Handles a change of levels that the rotor does not follow directly.
    #[cold]
    fn stray(&mut self, before: u8, angle: u32, in_time: bool, now: u64) -> Option<(u32, Cause)> {
        let from = self.equilibrium[usize::from(before)];
        if angle >= NO_CURRENT {
            // Switching the current off is not a step. A change of levels without current is a step
            // that the motor does not make.
            return (from >= NO_CURRENT).then(|| self.lose(self.step, Cause::NoCurrent));
        }
        let off_before = from >= NO_CURRENT;
        // After a rest without current the field has no history: the rotor goes to the nearest
        // equilibrium.
        let field = if off_before {
            self.rotor
        } else {
            self.rotor + self.slip
        };
        let mut field_jump = i64::from((angle as u16).wrapping_sub(field as u16) as i16);
        if field_jump == i64::from(i16::MIN) && self.last_jump > 0 {
            // Both directions are equally near. The field continues in its last direction.
            field_jump = -field_jump;
        }
        let pull = (angle as u16).wrapping_sub(self.rotor as u16) as i16;
        let is_held = self.is_held(i64::from(pull));
        let in_time = in_time || (off_before && !is_held);
        self.changed_at = now;
        self.last_jump = field_jump.clamp(-32767, 32767) as i16;
        let follows = in_time && pull != i16::MIN;
        let slip_before = if off_before { 0 } else { self.slip };
        let moved = if follows { i64::from(pull) } else { 0 };
        self.turn(moved);
        self.slip = slip_before + field_jump - moved;
        let worse = self.slip.abs() - slip_before.abs();
        let cause = match (in_time, pull) {
            (false, _) if is_held => Cause::Blocked,
            (false, _) => Cause::TooFast,
            (true, i16::MIN) => Cause::HalfCycle,
            _ => Cause::Slipped,
        };
        (worse > 0).then(|| self.lose(worse, cause))
    }

    /// Handles a change at the inputs of a driver that counts rising edges.
    fn pulse(&mut self, before: u8, timing: PulseTiming, now: u64) -> Option<(u32, Cause)> {
        let changed = before ^ self.levels;
        let is_high = self.levels & Levels::STEP.0 != 0;
        let mut lost = None;
        if changed & Levels::DIR.0 != 0 {
            self.pulse.turned_at = now;
            if now - self.pulse.rose_at < u64::from(timing.hold_ticks) {
                lost = self.take_back();
            }
        }
        if changed & Levels::STEP.0 == 0 {
            return lost;
        }
        if !is_high {
            self.pulse.fell_at = now;
            if now - self.pulse.rose_at < u64::from(timing.high()) {
                lost = self.take_back().or(lost);
            }
            return lost;
        }
        self.pulse.rose_at = now;
        self.pulse.made = 0;
        let is_kept = now - self.pulse.fell_at >= u64::from(timing.low())
            && now - self.pulse.turned_at >= u64::from(timing.setup_ticks);
        if !is_kept {
            return Some(self.lose(self.step, Cause::Pulse));
        }
        let at = self.rotor;
        let lost = self.count(now).or(lost);
        self.pulse.made = self.rotor - at;
        lost
    }

    /// Cancels the last step: its pulse was too short, or DIR changed too early.
    fn take_back(&mut self) -> Option<(u32, Cause)> {
        let made = std::mem::take(&mut self.pulse.made);
        if made == 0 {
            return None;
        }
        self.turn(-made);
        Some(self.lose(self.step, Cause::Pulse))
    }

    /// Handles a change at the inputs of a driver that counts both edges.
    fn toggle(&mut self, before: u8, now: u64) -> Option<(u32, Cause)> {
        let is_edge = (before ^ self.levels) & Levels::STEP.0 != 0;
        is_edge.then(|| self.count(now)).flatten()
    }

    /// Handles an edge of STEP that counts.
    fn count(&mut self, now: u64) -> Option<(u32, Cause)> {
        let positive = (self.levels & Levels::DIR.0 != 0) != self.reversed;
        let jump = if positive { self.step } else { -self.step };
        let is_held = self.is_held(jump);
        let in_time = !is_held && now - self.changed_at >= self.pull_out_ticks;
        self.changed_at = now;
        if self.levels & Levels::ENABLE.0 == 0 {
            return Some(self.lose(self.step, Cause::NoCurrent));
        }
        if !in_time {
            let cause = if is_held {
                Cause::Blocked
            } else {
                Cause::TooFast
            };
            return Some(self.lose(self.step, cause));
        }
        self.turn(jump);
        None
    }

    fn lose(&mut self, angle: i64, cause: Cause) -> (u32, Cause) {
        // The angle is at most a few cycles. At least one step is lost.
        let steps = ((angle + self.step / 2) / self.step).max(1) as u32;
        self.lost_steps += u64::from(steps);
        (steps, cause)
    }

    /// Nut position in drive steps.
    #[inline]
    pub(crate) fn tool(&self) -> i32 {
        self.steps(self.nut)
    }

    /// Rotor position in drive steps.
    #[inline]
    pub(crate) fn motor(&self) -> i32 {
        self.steps(self.rotor)
    }

    /// The nearest whole step. Programs have `i32` steps.
    #[inline]
    fn steps(&self, at: i64) -> i32 {
        // A power of two, so a shift.
        ((at - self.zero + self.step / 2) >> self.step.trailing_zeros()) as i32
    }
}

/// Table of the rest angle of the rotor for every byte of levels.
fn equilibria(driver: Driver, reversed: bool) -> Box<[u32; 256]> {
    let mut table = Box::new([NO_CURRENT; 256]);
    for (bits, entry) in (0..=255).zip(table.iter_mut()) {
        let [a, b] = driver.currents(Levels(bits));
        if (a, b) != (0, 0) {
            let cycles = f64::from(b).atan2(f64::from(a)) / std::f64::consts::TAU;
            let cycles = if reversed { -cycles } else { cycles };
            *entry = u32::from((cycles * 65536.0).round() as i32 as u16);
        }
    }
    table
}
