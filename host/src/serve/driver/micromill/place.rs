//! Where the tool is, and how fast it moves, by the steps that the controller reports.

use crate::serve::machine_state::MachineState;
use husillo_clients::micromill::{position, uncounted, work_zero};
use husillo_gcode::Nm;
use husillo_machine::Config;
use husillo_transports::micromill::{Order, State};
use std::collections::VecDeque;

/// Speeds are means over this time, us.
const MEAN_US: u32 = 400_000;
/// They need this time, us.
const LEAST_US: u32 = 50_000;
/// Full steps in a turn of a motor: `full_steps_per_turn` of its machine file.
const STEPS_PER_TURN: u32 = 28;

/// The place of the tool.
#[derive(Debug)]
pub(super) struct Place {
    config: Config<3>,
    /// The last report, and the steps since then. Without a report, from where the tool was first.
    state: State,
    /// Whether the controller reports where it is.
    is_reported: bool,
    /// The last report.
    before: State,
    /// Steps of each motor since then.
    net: [i64; 3],
    /// Steps of each motor since the begin: forward minus backward, and all.
    counts: [[i64; 3]; 2],
    /// Times, and the counts then.
    window: VecDeque<(u32, [[i64; 3]; 2])>,
    /// Turns per minute of the spindle.
    rpm: u16,
}

impl Place {
    /// At a reported place. `None`: the controller does not report it.
    pub(super) fn new(reported: Option<State>, config: Config<3>) -> Self {
        let state = reported.unwrap_or_default();
        Self {
            config,
            state,
            is_reported: reported.is_some(),
            before: state,
            net: [0; 3],
            counts: [[0; 3]; 2],
            window: VecDeque::new(),
            rpm: 0,
        }
    }

    /// Whether positions count from machine zero.
    pub(super) const fn is_homed(&self) -> bool {
        self.state.is_homed
    }

    /// Whether they did at the last report.
    pub(super) const fn was_homed(&self) -> bool {
        self.before.is_homed
    }

    /// The state as it is now.
    pub(super) const fn state(&self) -> &State {
        &self.state
    }

    /// The steps of the mill.
    pub(super) const fn config(&self) -> &Config<3> {
        &self.config
    }

    /// An order begins.
    pub(super) fn begin(&mut self, order: Order, now_us: u32) {
        use husillo_transports::micromill::Line;
        self.window.clear();
        self.window.push_back((now_us, self.counts));
        match order {
            // Until it is homed, the controller compensates no backlash.
            Order::Home => {
                self.state.is_homed = false;
                for axis in &mut self.state.axes {
                    axis.ahead_steps = 0;
                }
            }
            Order::Line(Line::Spindle { rpm, .. }) => self.rpm = rpm,
            Order::Line(Line::SpindleOff | Line::End) => self.rpm = 0,
            _ => {}
        }
    }

    /// A motor has made a step.
    pub(super) fn step(&mut self, axis: usize, is_forward: bool) {
        let by = if is_forward { 1 } else { -1 };
        let [net, all] = &mut self.counts;
        for (counts, by) in [(net, by), (all, 1), (&mut self.net, by)] {
            if let Some(count) = counts.get_mut(axis) {
                *count += by;
            }
        }
        let is_homed = self.state.is_homed;
        let Some(axis) = self.state.axes.get_mut(axis) else {
            return;
        };
        match is_forward {
            true if is_homed && axis.ahead_steps < axis.backlash_steps => axis.ahead_steps += 1,
            false if is_homed && axis.ahead_steps > 0 => axis.ahead_steps -= 1,
            _ => axis.load_steps += by as i32,
        }
    }

    /// It is this time, us.
    pub(super) fn passed(&mut self, now_us: u32, is_moving: bool) {
        if !is_moving {
            self.window.clear();
            return;
        }
        self.window.push_back((now_us, self.counts));
        while self.window.len() > 2
            && self
                .window
                .get(1)
                .is_some_and(|(then_us, _)| now_us.wrapping_sub(*then_us) >= MEAN_US)
        {
            self.window.pop_front();
        }
    }

    /// Where the tool is, nm.
    pub(super) fn at_nm(&self) -> [i64; 3] {
        position(&self.state, &self.config).map(|Nm(nm)| nm)
    }

    /// Takes over a report after an order. Returns a sentence if it differs from the steps.
    pub(super) fn report(&mut self, reported: Option<State>, order: Order) -> Option<String> {
        let state = reported?;
        // After homing or with another backlash, the steps count from another place.
        let is_same = !matches!(order, Order::Home | Order::Backlash(..))
            && self.before.is_homed == state.is_homed;
        let apart = match is_same {
            true => uncounted(&self.before, &self.net, &state),
            false => None,
        };
        (self.state, self.before) = (state, state);
        self.net = [0; 3];
        apart
    }

    /// The work zero, mm. `None`: the mill is not homed.
    pub(super) fn zero_mm(&self) -> Option<Vec<f64>> {
        self.is_homed().then(|| in_mm(work_zero(&self.state)))
    }

    /// Where the tool is from machine zero, mm. `None`: the mill is not homed.
    pub(super) fn machine_mm(&self) -> Option<Vec<f64>> {
        let at = position(&self.state, &self.config);
        self.is_homed().then(|| in_mm(at))
    }

    /// Shows place and speeds.
    pub(super) fn show(&self, state: &mut MachineState) {
        state.machine_mm = self.machine_mm();
        state.zero_mm = self.zero_mm();
        let both = state
            .machine_mm
            .iter()
            .flatten()
            .zip(state.zero_mm.iter().flatten());
        let work: Vec<_> = both.map(|(at, zero)| at - zero).collect();
        state.work_mm = (!work.is_empty()).then_some(work);
        let (feed, hz) = self.speeds();
        state.feed = feed;
        state.rpm = self.rpm.into();
        let Some(mill) = &mut state.mill else { return };
        mill.is_homed = self.is_homed();
        mill.motor_steps = self.is_reported.then(|| self.state.motor_steps());
        let um = |axis: usize, steps: u16| {
            let scale = self.config.axes.get(axis).map(|axis| axis.scale);
            scale.map_or(0, |scale| (scale.position(steps.into()) + 500) / 1000)
        };
        mill.backlash_um = self.is_reported.then(|| {
            let [x, y, z] = self.state.axes.map(|axis| axis.backlash_steps);
            [um(0, x), um(1, y), um(2, z)]
        });
        mill.step_hz = hz;
        mill.motor_rpm = hz * 60 / STEPS_PER_TURN;
    }

    /// The speed along the path in mm/min, and the steps per second of the fastest motor.
    fn speeds(&self) -> (f64, u32) {
        let ends = self.window.front().zip(self.window.back());
        let Some(((from_us, before), (to_us, now))) = ends else {
            return (0.0, 0);
        };
        let us = to_us.wrapping_sub(*from_us);
        if us < LEAST_US {
            return (0.0, 0);
        }
        let seconds = f64::from(us) / 1e6;
        let [net, all] = [0, 1].map(|which: usize| {
            let pairs = now[which].iter().zip(&before[which]);
            pairs
                .map(|(now, before)| (now - before) as f64)
                .collect::<Vec<_>>()
        });
        let axes = net.iter().zip(&self.config.axes);
        let path = axes.map(|(steps, axis)| steps * axis.scale.position(1000) as f64 / 1e9);
        let feed = path.map(|mm| mm * mm).sum::<f64>().sqrt() / seconds * 60.0;
        let hz = all.iter().copied().fold(0.0, f64::max) / seconds;
        // Hundredths, so that a state does not change without need.
        ((feed * 100.0).round() / 100.0, hz.round() as u32)
    }
}

fn in_mm(nm: [Nm; 3]) -> Vec<f64> {
    nm.iter().map(|Nm(nm)| *nm as f64 / 1e6).collect()
}
