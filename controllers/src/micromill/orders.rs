//! Execution of strings: refuses or queues a line, begins a mode.

use husillo_transports::micromill::{Answer, Axis, AxisState, Line, Order, State};

use super::{
    Lease, Micromill,
    directions::Directions,
    entry::{Entry, nm},
    path::Flat,
    task::Task,
};

impl<const QUEUE: usize, const AHEAD: usize, const OUT: usize> Micromill<'_, QUEUE, AHEAD, OUT> {
    fn answer(&mut self, is_obeyed: bool, answer: Answer) {
        self.link
            .answer(if is_obeyed { answer } else { Answer::Refused });
    }

    pub(super) fn obey(&mut self, order: Order) {
        let is_free = !self.is_moving();
        match order {
            Order::Line(line) => self.take(line),
            Order::Faster => self.change_jog(1),
            Order::Slower => self.change_jog(-1),
            // The bytes of this string have already ended the silence.
            Order::Renew => {}
            Order::Lease(ms) => {
                self.lease = if ms == 0 { Lease::None } else { Lease::Ms(ms) };
                self.link.answer(Answer::Taken);
            }
            _ if !is_free => self.link.answer(Answer::Refused),
            Order::Jog(directions) => {
                self.task = Task::Jog {
                    directions: Directions::of(directions),
                    hz: self.config.jog_hz,
                };
            }
            Order::Run(axis, hz) => {
                let is_right = hz.unsigned_abs() <= self.config.top_hz;
                if is_right {
                    self.task = Task::Run {
                        directions: Directions::one(axis, hz > 0),
                        hz: hz.unsigned_abs(),
                    };
                } else {
                    self.link.answer(Answer::Refused);
                }
            }
            Order::Steps(axis, steps) => {
                if self.reaches(axis, steps) {
                    self.task = Task::Steps {
                        directions: Directions::one(axis, steps > 0),
                        left: steps.unsigned_abs(),
                    };
                } else {
                    self.link.answer(Answer::Refused);
                }
            }
            Order::Backlash(axis, um) => self.set_backlash(axis, um),
            Order::Home => {
                self.was_homed = core::mem::take(&mut self.is_homed);
                for play in &mut self.plays {
                    play.set_backlash(0);
                }
                self.task = Task::Leave {
                    axis: Axis::Z,
                    left: self.config.leave_steps,
                };
            }
            Order::Zero => {
                if self.is_homed {
                    self.zero = self.programmed;
                }
                self.answer(self.is_homed, Answer::Done);
            }
            Order::Report => self.send_state(),
            Order::Stop | Order::Stream(_) | Order::Every(_) => {}
        }
    }

    /// Sends the state.
    fn send_state(&mut self) {
        let mut state = State {
            is_homed: self.is_homed,
            ..State::default()
        };
        let zeros = self.backlash.iter().zip(&self.zero);
        let axes = state.axes.iter_mut().zip(&self.plays);
        for ((axis, play), (backlash, zero)) in axes.zip(zeros) {
            *axis = AxisState {
                load_steps: play.load(),
                ahead_steps: play.owed(false),
                backlash_steps: *backlash,
                zero_nm: *zero,
            };
        }
        self.link.report(&state);
    }

    /// Takes a line: refuses it or appends it to the queue.
    fn take(&mut self, line: Line) {
        let is_streaming = self.link.is_streaming();
        let is_free = if is_streaming {
            !self.owes_taken && !self.task.is_manual()
        } else {
            !self.is_moving()
        };
        let entry = if is_free { self.check(line) } else { None };
        let Some(entry) = entry else {
            return self.link.answer(Answer::Refused);
        };
        self.programmed = entry.to;
        if line == Line::Zero {
            self.zero = self.programmed;
        }
        self.queue.push(entry);
        if is_streaming {
            if self.queue.is_full() {
                self.owes_taken = true;
            } else {
                self.link.answer(Answer::Taken);
            }
        }
    }

    /// Converts the line. Returns `None` if it cannot be executed.
    #[inline(never)]
    fn check(&self, line: Line) -> Option<Entry> {
        let entry = Entry::new(line, self.programmed, self.zero)?;
        let needs_home = entry.moves() || line == Line::Zero;
        if needs_home && !self.is_homed {
            return None;
        }
        if entry.moves() {
            let command = entry.command(self.programmed)?;
            let from = nm(self.programmed);
            let machine = &self.config.machine;
            machine.check_arcs(&from, &command, Flat::fits).ok()?;
        }
        Some(entry)
    }

    fn change_jog(&mut self, direction: i16) {
        if let Task::Jog { hz, .. } = &mut self.task {
            let change = self.config.jog_change_hz;
            let top = self.config.top_hz.max(1);
            *hz = if direction > 0 {
                hz.saturating_add(change).min(top)
            } else {
                hz.saturating_sub(change).max(change.max(1)).min(top)
            };
        }
    }

    fn set_backlash(&mut self, axis: Axis, um: u16) {
        let axis = axis as usize;
        let config = self.config.machine.axes.get(axis);
        let state = self.backlash.get_mut(axis).zip(self.plays.get_mut(axis));
        if let Some((config, (backlash, play))) = config.zip(state) {
            let distance_nm = i64::from(um).wrapping_mul(1000);
            let steps = config.scale.nearest(distance_nm).unwrap_or(0);
            *backlash = steps.clamp(0, u16::MAX.into()) as u16;
            if self.is_homed {
                play.set_backlash(*backlash);
            }
        }
        self.link.answer(Answer::Done);
    }

    /// Whether an axis may move by this number of steps.
    fn reaches(&self, axis: Axis, steps: i16) -> bool {
        let axis = axis as usize;
        match self.config.machine.axes.get(axis).zip(self.plays.get(axis)) {
            Some((config, play)) => self.is_within(config, play, steps),
            None => false, // there is no other axis
        }
    }
}
