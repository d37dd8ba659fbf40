//! Mechanics for a Grbl controller: three motors, switches, outputs.

use husillo_controllers::{GrblEvent, GrblInputs};

use crate::Plant;

/// An input of the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GrblPin {
    /// The limit switch of an axis, 0 to 2.
    Limit(usize),
    /// The probe.
    Probe,
    /// The safety door.
    Door,
    /// The hold button.
    Hold,
    /// The start button.
    Start,
    /// The reset button.
    Reset,
}

/// A switch that a slide actuates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SlideSwitch {
    /// The input that it closes.
    pub pin: GrblPin,
    /// The axis of the slide.
    pub axis: usize,
    /// Position from which on it is closed, in steps from the position at power-on.
    pub at_steps: i64,
    /// Whether it is closed at this position and above. Otherwise it is closed at this position and
    /// below.
    pub is_above: bool,
    /// Level of the input when it is closed.
    pub closed_level: bool,
}

/// Mechanics with three axes. A motor follows every step, unless it is blocked or the step follows
/// the previous one too soon.
#[derive(Clone, Debug, Default)]
pub struct GrblRig {
    steps: [i64; 3],
    pulses: [u64; 3],
    lost: [u64; 3],
    levels: GrblInputs,
    switches: Vec<SlideSwitch>,
    /// Inputs that are held by hand, and whether they are held closed.
    held: Vec<(GrblPin, bool)>,
    blocked: [bool; 3],
    /// Rise of the plate below the probe, in steps of Z per 1000 steps of X and of Y.
    tilt_per_mille: [i64; 2],
    /// Shortest interval between steps that a motor follows, us.
    pull_out_us: u64,
    now_us: u64,
    last_us: [Option<u64>; 3],
    /// The last level of each output.
    pub outputs: GrblOutputs,
}

/// Outputs of a Grbl controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GrblOutputs {
    /// Level of the pin that disables the motors.
    pub disable: bool,
    /// Level of the pin for the direction of the spindle: counter-clockwise.
    pub direction: bool,
    /// Duty cycle of the spindle, 0 to 255.
    pub duty: u8,
    /// Flood coolant.
    pub flood: bool,
    /// Mist coolant.
    pub mist: bool,
}

impl GrblRig {
    /// Creates axes at rest, with all inputs high.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the steps of each motor from its position at power-on.
    #[must_use]
    pub const fn steps(&self) -> [i64; 3] {
        self.steps
    }

    /// Returns the number of steps of each motor so far, in both directions.
    #[must_use]
    pub const fn pulses(&self) -> [u64; 3] {
        self.pulses
    }

    /// Returns the number of steps that each motor has not followed.
    #[must_use]
    pub const fn lost_steps(&self) -> [u64; 3] {
        self.lost
    }

    /// Sets the highest step rate that the motors follow, steps/s.
    pub fn set_pull_out_hz(&mut self, hz: u64) {
        self.pull_out_us = 1_000_000 / hz.max(1);
    }

    /// Holds an input closed or open, or releases it.
    pub fn hold(&mut self, pin: GrblPin, closed: Option<bool>) {
        self.held.retain(|(held, _)| *held != pin);
        self.held.extend(closed.map(|closed| (pin, closed)));
    }

    /// Blocks a motor, or releases it.
    pub fn block(&mut self, axis: usize, is_blocked: bool) {
        if let Some(blocked) = self.blocked.get_mut(axis) {
            *blocked = is_blocked;
        }
    }

    /// Tilts the plate below a probe that Z closes. It rises by these numbers of steps of Z per
    /// 1000 steps along X and along Y, from the position at power-on.
    pub const fn tilt(&mut self, per_mille: [i64; 2]) {
        self.tilt_per_mille = per_mille;
    }

    /// Returns the position at which a switch closes, at the present place.
    fn switch_steps(&self, switch: &SlideSwitch) -> i64 {
        if switch.pin != GrblPin::Probe || switch.axis != 2 {
            return switch.at_steps;
        }
        let places = self.steps.into_iter().zip(self.tilt_per_mille);
        let rise: i64 = places.map(|(at, per_mille)| at * per_mille).sum();
        switch.at_steps + rise.div_euclid(1000)
    }

    fn step(&mut self, delta: [i8; 3]) {
        for (axis, delta) in delta
            .into_iter()
            .enumerate()
            .filter(|(_, delta)| *delta != 0)
        {
            self.pulses[axis] += 1;
            let last_us = self.last_us[axis].replace(self.now_us);
            let is_late = last_us.is_none_or(|at| self.now_us - at >= self.pull_out_us);
            if is_late && !self.blocked[axis] {
                self.steps[axis] += i64::from(delta);
            } else {
                self.lost[axis] += 1;
            }
        }
    }

    /// Adds a switch. It replaces another switch at the same input.
    pub fn add_switch(&mut self, switch: SlideSwitch) {
        self.switches.retain(|old| old.pin != switch.pin);
        self.switches.push(switch);
    }

    /// Sets the level of an input that has no switch.
    pub fn set_level(&mut self, pin: GrblPin, is_high: bool) {
        set(&mut self.levels, pin, is_high);
    }

    /// Moves a slide by hand. Returns the steps that it moved.
    pub fn push(&mut self, axis: usize, steps: i32) -> i32 {
        match self.steps.get_mut(axis) {
            Some(place) => {
                *place += i64::from(steps);
                steps
            }
            None => 0,
        }
    }
}

fn set(levels: &mut GrblInputs, pin: GrblPin, is_high: bool) {
    let level = match pin {
        GrblPin::Limit(axis) => match levels.limits.get_mut(axis) {
            Some(level) => level,
            None => return,
        },
        GrblPin::Probe => &mut levels.probe,
        GrblPin::Door => &mut levels.door,
        GrblPin::Hold => &mut levels.hold,
        GrblPin::Start => &mut levels.start,
        GrblPin::Reset => &mut levels.reset,
    };
    *level = is_high;
}

impl Plant for GrblRig {
    type Inputs = GrblInputs;
    type Event = GrblEvent;

    fn inputs(&self) -> GrblInputs {
        let mut levels = self.levels;
        for switch in &self.switches {
            let at = self.steps.get(switch.axis).copied().unwrap_or(0);
            let closes_at = self.switch_steps(switch);
            let is_closed = if switch.is_above {
                at >= closes_at
            } else {
                at <= closes_at
            };
            set(&mut levels, switch.pin, is_closed == switch.closed_level);
        }
        for (pin, is_closed) in &self.held {
            set(&mut levels, *pin, !is_closed);
        }
        levels
    }

    fn apply(&mut self, event: &GrblEvent) {
        match *event {
            GrblEvent::Step { wait_ticks, delta } => {
                self.now_us += u64::from(wait_ticks);
                self.step(delta);
            }
            GrblEvent::Wait { wait_ticks } => self.now_us += u64::from(wait_ticks),
            GrblEvent::Disable { is_high } => self.outputs.disable = is_high,
            GrblEvent::SpindleDirection { is_high } => self.outputs.direction = is_high,
            GrblEvent::SpindleDuty { duty } => self.outputs.duty = duty,
            GrblEvent::Flood { is_on } => self.outputs.flood = is_on,
            GrblEvent::Mist { is_on } => self.outputs.mist = is_on,
            GrblEvent::Store => {}
        }
    }
}
