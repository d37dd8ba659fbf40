//! Where the tip is, what the probe has touched, and the last bytes of the line.

use super::routines::Routines;
use super::work::Touched;
use crate::serve::machine_state::MachineState;
use crate::serve::request::Frame;
use crate::serve::tool_path::{Motion, ToolPath};
use husillo_metrology::Scale;
use husillo_metrology::heads::{AxisPosition, Machine, Stylus};
use husillo_probe::UnitVector;
use serde_json::{Value, json};
use std::collections::VecDeque;
use std::fmt::Write as _;

/// Exchanges with a module that are shown.
const EXCHANGES: usize = 8;
/// A point of the path is drawn at this distance, amounts of the scale: 50 um or 10 counts.
const APART: [i64; 2] = [50_000, 10];
/// Lengths of paths are nm. A count of unknown length is drawn as this.
const COUNT_NM: i64 = 5_000;

/// What is known of the head.
#[derive(Debug)]
pub(super) struct Place {
    scale: Scale,
    letters: Vec<char>,
    /// Speeds of moves and of searches, amounts/s.
    speeds: [i64; 2],
    /// The axes when they stood last.
    axes: Vec<AxisPosition>,
    held: [i64; 3],
    /// The work position now.
    work: [i64; 3],
    target: Option<[i64; 3]>,
    is_pressed: bool,
    tip: Stylus,
    touched: Option<Touched>,
    exchanges: VecDeque<(Vec<u8>, Vec<u8>)>,
    drawn: Option<[i64; 3]>,
}

impl Place {
    pub(super) fn new(machine: &Machine) -> Self {
        let of = |counts: u32| machine.scale.of_counts(counts.into());
        let fastest = machine.axes.iter().map(|axis| axis.rate).max();
        Self {
            scale: machine.scale,
            letters: machine.axes.iter().map(|axis| axis.letter).collect(),
            speeds: [of(fastest.unwrap_or_default()), of(machine.probe.rate)],
            axes: Vec::new(),
            held: [0; 3],
            work: [0; 3],
            target: None,
            is_pressed: false,
            tip: machine.probe.stylus,
            touched: None,
            exchanges: VecDeque::new(),
            drawn: None,
        }
    }

    /// The path of the tip begins anew.
    pub(super) fn begin(&mut self, path: &ToolPath) {
        self.drawn = None;
        path.to(Motion::Begin, self.drawn_at());
    }

    /// Whether the probe is pressed.
    pub(super) fn set_pressed(&mut self, is_pressed: bool) {
        self.is_pressed = is_pressed;
    }

    /// A reading in motion. Returns whether the path of the tip has become longer.
    pub(super) fn at(&mut self, work: [i64; 3], motion: Motion, path: &ToolPath) -> bool {
        self.work = work;
        let at = self.machine_now();
        let [of_lengths, of_counts] = APART;
        let apart = match self.scale.count_mm() {
            Some(_) => of_lengths,
            None => of_counts,
        };
        let is_near = self.drawn.is_some_and(|last| {
            let mut parts = last.iter().zip(at);
            parts.all(|(last, now)| (last - now).abs() < apart)
        });
        if is_near {
            return false;
        }
        self.drawn = Some(at);
        path.to(motion, self.drawn_at())
    }

    /// The axes stand.
    pub(super) fn rests(&mut self, axes: Vec<AxisPosition>, held: [i64; 3]) {
        for axis in &axes {
            if let Some(work) = self.work.get_mut(axis.coordinate) {
                *work = axis.work;
            }
        }
        (self.axes, self.held) = (axes, held);
    }

    /// The commanded position when the axes stood last.
    pub(super) const fn held(&self) -> [i64; 3] {
        self.held
    }

    /// Whether every axis is homed.
    pub(super) fn is_homed(&self) -> bool {
        !self.axes.is_empty() && self.axes.iter().all(|axis| axis.machine.is_some())
    }

    /// The goal of a move, for the distance that is left.
    pub(super) fn set_target(&mut self, to: Option<(&[(usize, i64)], Frame)>) {
        self.target = to.map(|(to, frame)| {
            let mut goal = self.held;
            for (axis, amount) in to {
                let zero = if frame == Frame::Machine {
                    self.zero(*axis)
                } else {
                    0
                };
                if let Some(goal) = goal.get_mut(*axis) {
                    *goal = amount.saturating_sub(zero);
                }
            }
            goal
        });
    }

    pub(super) fn exchange(&mut self, exchange: (Vec<u8>, Vec<u8>)) {
        if self.exchanges.len() == EXCHANGES {
            self.exchanges.pop_front();
        }
        self.exchanges.push_back(exchange);
    }

    /// Keeps a touch, and describes it for the console.
    pub(super) fn touched(&mut self, touched: &Touched) -> String {
        self.touched = Some(touched.clone());
        let text = |place: [i64; 3]| {
            let axes = self.letters.iter().zip(place);
            let axes = axes.map(|(letter, amount)| format!("{letter} {}", self.scale.text(amount)));
            axes.collect::<Vec<_>>().join(", ")
        };
        let (trigger, contact) = (text(touched.trigger), text(touched.contact));
        format!("touched: trigger {trigger}; contact {contact}")
    }

    pub(super) fn tip(&mut self, tip: Stylus) {
        self.tip = tip;
    }

    pub(super) const fn stylus(&self) -> Stylus {
        self.tip
    }

    /// What is added to a work coordinate for that from home, or from switching on.
    fn zero(&self, axis: usize) -> i64 {
        let found = self.axes.iter().find(|one| one.coordinate == axis);
        found.map_or(0, |axis| axis.zero)
    }

    fn machine_now(&self) -> [i64; 3] {
        [0, 1, 2].map(|axis: usize| self.work[axis].saturating_add(self.zero(axis)))
    }

    /// The place of the tip in the path, nm.
    fn drawn_at(&self) -> [i64; 3] {
        let at = self.machine_now();
        match self.scale.count_mm() {
            Some(_) => at,
            None => at.map(|counts| counts.saturating_mul(COUNT_NM)),
        }
    }

    /// Shows all of it.
    pub(super) fn show(&self, state: &mut MachineState, routines: &Routines) {
        let number = |amount| self.scale.number(amount);
        let has_length = self.scale.count_mm().is_some();
        let count = self.letters.len();
        let work: Vec<_> = self.work.iter().take(count).map(|at| number(*at)).collect();
        let target = self.target.unwrap_or(self.held);
        let axes: Vec<Value> = self
            .axes
            .iter()
            .map(|axis| self.axis(axis, target))
            .collect();
        if has_length {
            state.zero_mm = Some((0..count).map(|axis| number(self.zero(axis))).collect());
            let machine = self.machine_now();
            state.machine_mm = self
                .is_homed()
                .then(|| machine.iter().take(count).map(|at| number(*at)).collect());
            state.work_mm = Some(work);
        }
        let along = |way: &UnitVector| number(self.tip.pre_travel.along(way).into());
        let [rapid, search] = self.speeds.map(number);
        state.switches = if self.is_pressed {
            vec!["P"]
        } else {
            Vec::new()
        };
        state.measuring = Some(json!({
            "unit": self.scale.unit(),
            "count_mm": self.scale.count_mm(),
            "axes": axes,
            "is_pressed": self.is_pressed,
            "speeds": {"fast": rapid, "slow": search},
            "tip": {
                "pre_travel": [along(&UnitVector::X), along(&UnitVector::X.reversed())],
                "ball": number(self.tip.radius_nm.into()),
            },
            "touch": self.touched.as_ref().map(|touched| self.touch(touched)),
            "line": self.exchanges.iter().map(|(sent, received)| {
                json!({"sent": hex(sent), "received": hex(received)})
            }).collect::<Vec<_>>(),
            "routine": routines.shown(),
        }));
    }

    fn axis(&self, axis: &AxisPosition, target: [i64; 3]) -> Value {
        let number = |amount| self.scale.number(amount);
        let at = axis.coordinate;
        let now = self.work.get(at).copied().unwrap_or_default();
        let since = now - axis.work;
        let target = target.get(at).copied().unwrap_or_default();
        json!({
            "letter": "XYZ".chars().nth(at),
            "work": number(now),
            "machine": axis.machine.map(|machine| number(machine + since)),
            "counts": i64::from(axis.counts) + self.scale.to_counts(since),
            "target": number(target),
            "error": number(target - now),
        })
    }

    fn touch(&self, touched: &Touched) -> Value {
        let number = |amount| self.scale.number(amount);
        let count = self.letters.len();
        let place = |of: [i64; 3]| {
            of.iter()
                .take(count)
                .map(|at| number(*at))
                .collect::<Vec<_>>()
        };
        json!({
            "trigger": place(touched.trigger),
            "contact": place(touched.contact),
            "pre_travel": number(touched.pre_travel),
            "touches": touched.touches,
            "spread": number(touched.spread),
            "over_travel": number(touched.over_travel),
        })
    }
}

/// Bytes in hexadecimal digits.
fn hex(bytes: &[u8]) -> String {
    let mut text = String::new();
    for byte in bytes {
        let space = if text.is_empty() { "" } else { " " };
        // Writing to a text does not fail.
        let _ = write!(text, "{space}{byte:02x}");
    }
    text
}
