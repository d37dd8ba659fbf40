//! One axis: field, rotor, screw and nut.
//!
//! Angles are 65536ths of an electrical cycle ("turns" of the field); a full step is a quarter of it, 16384. The rotor's
//! position is such an angle continued over all cycles, so `i64` holds 2^47 cycles.

use husillo_stepper::{Driver, Levels, PulseTiming};

use crate::loss::Cause;
use crate::model::{AxisModel, Stage};

/// A full step.
const FULL_STEP: i64 = 16384;

/// Table entry for levels that leave both coils without current; angles are below it.
const NO_CURRENT: u32 = 1 << 16;

#[derive(Clone, Debug)]
pub(crate) struct Axis {
    /// Equilibrium angle by levels; 8 bits of levels are 256 entries.
    equilibrium: Box<[u32; 256]>,
    levels: u8,
    reversed: bool,
    stage: Stage,
    pull_out_ticks: u64,
    /// When the levels changed last.
    changed_at: u64,
    rotor: i64,
    /// Field less rotor, continued: 0 while the rotor follows.
    slip: i64,
    /// The last jump of the field, for the sense of the next ambiguous one.
    last_jump: i16,
    nut: i64,
    lash: i64,
    /// Where the drive counts 0: the nominal angle of the first levels.
    zero: i64,
    step: i64,
    is_blocked: bool,
    pulse: Pulse,
    pub(crate) lost_steps: u64,
}

/// When the inputs of a step and direction driver changed last.
#[derive(Copy, Clone, Debug, Default)]
struct Pulse {
    turned_at: u64,
    rose_at: u64,
    fell_at: u64,
    /// The way of the rotor at the last rising edge; 0 where none was made.
    made: i64,
}

impl Axis {
    /// The rotor rests at the equilibrium of `levels`, the nut on its positive flank, both at 0.
    pub(crate) fn new(model: AxisModel, levels: Levels) -> Axis {
        let equilibrium = match model.stage {
            Stage::Coils(driver) => equilibria(driver, model.reversed),
            Stage::StepDirection(_) | Stage::StepToggle => Box::new([NO_CURRENT; 256]),
        };
        let start = i64::from(equilibrium[usize::from(levels.0)] & 0xFFFF);
        // Nominal angles are quarter steps; currents come near them only (PBL3717A: 59.0 degrees for 67.5).
        let quarter = FULL_STEP / 4;
        let step = FULL_STEP / i64::from(model.steps_per_full);
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
            lash: i64::from(model.lash_steps) * step,
            zero: (start + quarter / 2) / quarter * quarter,
            step,
            is_blocked: false,
            pulse: Pulse::default(),
            lost_steps: 0,
        }
    }

    /// The drive counts so many steps where the axis is now.
    pub(crate) fn call(&mut self, steps: i32) {
        self.zero -= i64::from(steps) * self.step;
    }

    /// Whether something holds the rotor: then no change of the field turns it.
    pub(crate) const fn block(&mut self, is_blocked: bool) {
        self.is_blocked = is_blocked;
    }

    /// Turns the rotor by about so many steps, as the load may when it is stronger: to where it stays. How many.
    pub(crate) fn push(&mut self, steps: i32) -> i32 {
        let way = match self.stage {
            // Equilibria are a cycle apart.
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
        // As near as a cycle to what was asked.
        made as i32
    }

    /// Another play, in steps: where there is less of it, a flank pushes the nut.
    pub(crate) fn set_lash(&mut self, steps: f64) {
        self.lash = (steps * self.step as f64).round() as i64;
        self.turn(0);
    }

    /// The nut in steps, with fractions.
    pub(crate) fn nut_steps(&self) -> f64 {
        (self.nut - self.zero) as f64 / self.step as f64
    }

    /// The levels the driver sees.
    #[inline]
    pub(crate) fn levels(&self) -> u8 {
        self.levels
    }

    /// New levels at time `now`, different from the old ones. What was lost, if anything.
    #[inline]
    pub(crate) fn change(&mut self, levels: u8, now: u64) -> Option<(u32, Cause)> {
        let in_time = !self.is_blocked && now - self.changed_at >= self.pull_out_ticks;
        let angle = self.equilibrium[usize::from(levels)];
        let jump = (angle as u16).wrapping_sub(self.rotor as u16) as i16;
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

    /// The screw turns by `jump`, the nut follows outside its play.
    #[inline]
    fn turn(&mut self, jump: i64) {
        self.rotor += jump;
        self.nut = self.nut.max(self.rotor).min(self.rotor + self.lash);
    }

    /// A change the rotor cannot simply follow.
    #[cold]
    fn stray(&mut self, before: u8, angle: u32, in_time: bool, now: u64) -> Option<(u32, Cause)> {
        let from = self.equilibrium[usize::from(before)];
        if angle >= NO_CURRENT {
            // Going off is no step; changing while off is one that nobody made.
            return (from >= NO_CURRENT).then(|| self.lose(self.step, Cause::NoCurrent));
        }
        let off_before = from >= NO_CURRENT;
        // From rest without current the field has no past: the rotor goes to the nearest equilibrium.
        let field = if off_before {
            self.rotor
        } else {
            self.rotor + self.slip
        };
        let mut field_jump = i64::from((angle as u16).wrapping_sub(field as u16) as i16);
        if field_jump == i64::from(i16::MIN) && self.last_jump > 0 {
            field_jump = -field_jump; // as near either way; it went on the way it went before
        }
        let in_time = in_time || (off_before && !self.is_blocked);
        self.changed_at = now;
        self.last_jump = field_jump.clamp(-32767, 32767) as i16;
        let pull = (angle as u16).wrapping_sub(self.rotor as u16) as i16;
        let follows = in_time && pull != i16::MIN;
        let slip_before = if off_before { 0 } else { self.slip };
        let moved = if follows { i64::from(pull) } else { 0 };
        self.turn(moved);
        self.slip = slip_before + field_jump - moved;
        let worse = self.slip.abs() - slip_before.abs();
        let cause = match (in_time, pull) {
            (false, _) if self.is_blocked => Cause::Blocked,
            (false, _) => Cause::TooFast,
            (true, i16::MIN) => Cause::HalfCycle,
            _ => Cause::Slipped,
        };
        (worse > 0).then(|| self.lose(worse, cause))
    }

    /// A change at the inputs of a driver that counts rising edges.
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

    /// The last step was none: its pulse was too short, or DIR changed too early.
    fn take_back(&mut self) -> Option<(u32, Cause)> {
        let made = std::mem::take(&mut self.pulse.made);
        if made == 0 {
            return None;
        }
        self.turn(-made);
        Some(self.lose(self.step, Cause::Pulse))
    }

    /// A change at the inputs of a driver that counts both edges.
    fn toggle(&mut self, before: u8, now: u64) -> Option<(u32, Cause)> {
        let is_edge = (before ^ self.levels) & Levels::STEP.0 != 0;
        is_edge.then(|| self.count(now)).flatten()
    }

    /// An edge of STEP that counts.
    fn count(&mut self, now: u64) -> Option<(u32, Cause)> {
        let in_time = !self.is_blocked && now - self.changed_at >= self.pull_out_ticks;
        self.changed_at = now;
        if self.levels & Levels::ENABLE.0 == 0 {
            return Some(self.lose(self.step, Cause::NoCurrent));
        }
        if !in_time {
            let cause = if self.is_blocked {
                Cause::Blocked
            } else {
                Cause::TooFast
            };
            return Some(self.lose(self.step, cause));
        }
        let positive = (self.levels & Levels::DIR.0 != 0) != self.reversed;
        self.turn(if positive { self.step } else { -self.step });
        None
    }

    fn lose(&mut self, angle: i64, cause: Cause) -> (u32, Cause) {
        // At most a few cycles at once, and at least one step.
        let steps = ((angle + self.step / 2) / self.step).max(1) as u32;
        self.lost_steps += u64::from(steps);
        (steps, cause)
    }

    /// Nut position in steps of the drive.
    #[inline]
    pub(crate) fn tool(&self) -> i32 {
        self.steps(self.nut)
    }

    /// Rotor position in steps of the drive.
    #[inline]
    pub(crate) fn motor(&self) -> i32 {
        self.steps(self.rotor)
    }

    /// The nearest whole step; `i32` steps are what the programs have.
    #[inline]
    fn steps(&self, at: i64) -> i32 {
        // A power of two, so a shift.
        ((at - self.zero + self.step / 2) >> self.step.trailing_zeros()) as i32
    }
}

/// The angle at which the rotor rests, for every byte of levels.
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
