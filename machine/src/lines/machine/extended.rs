//! The commands of an extended machine: probing, outputs in time with moves, inputs, constant
//! surface speed.

use husillo_backlash::BacklashModel;
use husillo_gcode::{Command, Nm, SpindleDirection, Switch};
use husillo_interp::Moves;
use husillo_planner::SurfaceSpeed;
#[cfg(feature = "extended")]
use husillo_probe::Tip;

use super::Machine;
#[cfg(feature = "extended")]
use crate::Extended;
use crate::lines::curve::ControlPoints;
use crate::lines::extension::Extension;
use crate::lines::path_ramp::{MoveQueue, PathRamp};
use crate::lines::state::{Probed, Probing};
use crate::{Alarm, Event, MoveError, Output, Pause};

impl<
    const N: usize,
    P: Moves<N>,
    L: BacklashModel<N>,
    const QUEUE: usize,
    E: Extension<N>,
    R: PathRamp,
> Machine<N, P, L, QUEUE, E, R>
{
    /// Whether a later line has to wait for the end of a probing move, a curve or an input.
    pub(super) fn is_busy(&self) -> bool {
        let waits = matches!(
            self.waiting,
            Some(Command::Probe { .. } | Command::Wait { .. } | Command::Tap { .. })
        );
        // An alarm drops the lines before it, so no line may come before the alarm is given.
        let is_raised = matches!(self.signals.last(), Some(Some(Event::Alarm(_))));
        self.extension
            .state()
            .is_some_and(|state| waits || is_raised || state.is_busy())
    }

    /// Whether an input was requested and its answer has not come.
    pub(super) fn is_awaiting(&self) -> bool {
        self.extension.state().is_some_and(|state| state.is_awaited)
    }

    /// Whether the queue takes nothing before a probing move or an input has ended.
    pub(super) fn stands(&self) -> bool {
        self.extension.state().is_some_and(|state| {
            state.probing.is_some() || state.tapping.is_some() || state.is_awaited
        })
    }

    /// Checks a curve of several commands. `points` are the control points that these commands
    /// add to those already taken.
    pub(super) fn check_nurbs(
        &self,
        points: &mut Option<ControlPoints>,
        from: &[Nm; N],
        command: &Command<N>,
    ) -> Result<(), MoveError> {
        let (
            Some(state),
            Command::NurbsBegin { .. } | Command::NurbsPoint { .. } | Command::NurbsEnd { .. },
        ) = (self.extension.state(), command)
        else {
            return Ok(());
        };
        let points = points.get_or_insert_with(|| state.points.clone());
        match points.take(&self.config, from, command)? {
            Some(curve) => self.config.check_curve(curve),
            None => Ok(()),
        }
    }

    /// Takes a command that a plain machine does not have. Returns `false` for one that has to
    /// wait, and for a plain move.
    pub(super) fn take_extended(&mut self, command: &Command<N>) -> bool {
        let moves = self.schedule.moves.len();
        let from = self.schedule.programmed();
        let Some(state) = self.extension.state_mut() else {
            return false;
        };
        match *command {
            Command::Spline { spline, feed } => {
                state.curve = Some(self.config.curve(from, &spline, feed));
                true
            }
            Command::NurbsBegin { .. } | Command::NurbsPoint { .. } | Command::NurbsEnd { .. } => {
                // `accept` has checked it.
                if let Ok(Some(curve)) = state.points.take(&self.config, &from, command) {
                    state.curve = Some(curve);
                }
                true
            }
            Command::Probe { .. } | Command::Tap { .. } => {
                self.waiting = Some(*command);
                true
            }
            Command::Output {
                number,
                on: is_on,
                with_motion: true,
            } => state.add(Output::Digital { number, is_on }, moves),
            Command::Analog {
                number,
                micro,
                with_motion: true,
            } => state.add(Output::Analog { number, micro }, moves),
            _ => false,
        }
    }

    /// Appends the next chord of a curve to the queue, which has room. Returns `false` if there is
    /// no curve.
    pub(super) fn push_chord(&mut self, has_backlash: [bool; N]) -> bool {
        let Some(state) = self.extension.state_mut() else {
            return false;
        };
        let Some(curve) = &mut state.curve else {
            return false;
        };
        let inner = (!curve.is_first()).then_some(curve.tolerance);
        match curve.next() {
            None => state.curve = None,
            Some((to, feed)) => {
                let chord = Command::Linear { to, feed };
                self.schedule
                    .push_chord(&curve.segment, inner, &self.config, &chord, has_backlash);
            }
        }
        true
    }

    /// Begins a command that a plain machine does not have. Returns `false` for another one.
    pub(super) fn begin_extended(&mut self, command: &Command<N>) -> bool {
        let Some(state) = self.extension.state_mut() else {
            return false;
        };
        let event = match *command {
            Command::Probe { to, away, must, .. } => {
                self.begin_probe(*command, to, away, must);
                return true;
            }
            Command::Tap { bottom, to, lead } => {
                self.begin_tap(bottom, to, lead);
                return true;
            }
            Command::Surface {
                direction,
                speed,
                most_milli_rpm,
            } => {
                let most = self.config.equipment.surface_milli_rpm.unwrap_or(0).into();
                let most = most_milli_rpm.map_or(most, |milli_rpm| milli_rpm.min(most));
                let turns = u64::from(direction != SpindleDirection::Off);
                let nm_per_min = speed.0.unsigned_abs().wrapping_mul(turns);
                state.surface = Some((direction, SurfaceSpeed::new(nm_per_min, most)));
                let milli_rpm = self.surface_speed().unwrap_or(0);
                self.note_spindle(direction, milli_rpm);
                let output = Output::Spindle {
                    direction,
                    milli_rpm,
                };
                self.signal([Some(Event::Output(output)), None]);
                return true;
            }
            Command::Spindle {
                direction,
                milli_rpm,
            } => {
                state.surface = None;
                state.spindle = (direction, milli_rpm);
                return false;
            }
            Command::Switch { what, on } => {
                match what {
                    Switch::Overrides | Switch::FeedOverride => state.permits_override = on,
                    Switch::AdaptiveFeed => state.adapts = on,
                    Switch::FeedHold => state.permits_stop = on,
                    Switch::SpindleOverride => {}
                }
                self.act_on_override();
                self.act_on_holds();
                return true;
            }
            Command::Wait {
                input,
                until,
                timeout_micros,
            } => {
                state.is_awaited = true;
                Event::Await {
                    input,
                    until,
                    timeout_micros,
                }
            }
            Command::Output { number, on, .. } => {
                Event::Output(Output::Digital { number, is_on: on })
            }
            Command::Analog { number, micro, .. } => {
                Event::Output(Output::Analog { number, micro })
            }
            Command::Orient {
                micro_degrees,
                direction,
            } => Event::Output(Output::Orient {
                micro_degrees,
                direction,
            }),
            Command::Pallet => Event::Pause(Pause::Pallet),
            _ => return false,
        };
        self.signal([Some(event), None]);
        true
    }

    /// Notes the spindle, which a tap reverses.
    fn note_spindle(&mut self, direction: SpindleDirection, milli_rpm: u64) {
        if let Some(state) = self.extension.state_mut() {
            state.spindle = (direction, milli_rpm);
        }
    }

    /// Begins a probing move; all moves before it have been made.
    fn begin_probe(&mut self, command: Command<N>, to: [Nm; N], is_away: bool, must: bool) {
        let from = self.schedule.programmed();
        let Some(state) = self.extension.state_mut() else {
            return;
        };
        if state.is_touching != is_away {
            self.raise(Alarm::ContactAtStart);
            return;
        }
        state.probing = Some(Probing {
            from,
            to,
            is_away,
            must,
            contact: None,
        });
        let has_backlash = self.take_up.stops();
        self.schedule.push(&self.config, &command, has_backlash);
        self.schedule.moves.finish();
    }

    /// Ends a probing move that has stopped after the contact, or at its end. Returns whether there
    /// was one.
    pub(super) fn end_probe(&mut self) -> bool {
        let is_over = self.run.is_none() && self.schedule.moves.is_empty();
        let Some(state) = self.extension.state_mut() else {
            return false;
        };
        let Some(probing) = state.probing else {
            return false;
        };
        if probing.contact.is_none() && !is_over {
            return false;
        }
        state.probing = None;
        if probing.contact.is_none() && probing.must {
            self.raise(Alarm::NoContact);
            return true;
        }
        self.run = None;
        self.held = None;
        self.take_up.abort();
        self.ramp.stop();
        self.act_on_holds();
        let here = self.position(&self.load);
        let here = if probing.contact.is_some() {
            here
        } else {
            probing.to
        };
        self.schedule.clear(here, self.load);
        self.schedule.set_mode(self.mode);
        self.modal.set_position(here);
        self.extension.restart(here);
        self.store_probed(&probing);
        let is_touched = probing.contact.is_some();
        self.signal([Some(Event::Probed { is_touched }), None]);
        self.refill();
        true
    }

    /// Stores the result of a probing move.
    fn store_probed(&mut self, probing: &Probing<N>) {
        let mut at = probing
            .contact
            .map_or(probing.to, |contact| self.position(&contact));
        // Away from the work piece there is no travel before the contact, and no surface.
        if probing.contact.is_some() && !probing.is_away {
            at = self.extension.touched([&probing.from, &probing.to], at);
        }
        let [zero, length] = [self.modal.work_offset(), self.modal.tool_length()];
        let mut in_work = at;
        for (in_work, (zero, length)) in in_work.iter_mut().zip(zero.iter().zip(length)) {
            in_work.0 = in_work.0.saturating_sub(zero.0).saturating_sub(length.0);
        }
        let Some(state) = self.extension.state_mut() else {
            return;
        };
        state.probed = Probed {
            at,
            in_work,
            is_touched: probing.contact.is_some(),
        };
    }

    /// Drops all lines and stops; the last event is the alarm.
    pub(super) fn raise(&mut self, alarm: Alarm) {
        self.abort();
        if let Some(last) = self.signals.last_mut() {
            *last = Some(Event::Alarm(alarm));
        }
    }

    /// The output that acts with the beginning of the first move.
    pub(super) fn output_due(&mut self) -> Option<Event<N>> {
        self.extension.state_mut()?.due().map(Event::Output)
    }

    /// The speed of the spindle, if it has to follow the diameter.
    pub(super) fn surface_event(&mut self) -> Option<Event<N>> {
        let (direction, _) = self.extension.state()?.surface?;
        let milli_rpm = self.surface_speed()?;
        self.note_spindle(direction, milli_rpm);
        Some(Event::Output(Output::Spindle {
            direction,
            milli_rpm,
        }))
    }

    /// The speed of the spindle at the present diameter, if it has to change.
    fn surface_speed(&mut self) -> Option<u64> {
        let (x, axis) = (*self.load.first()?, self.config.axes.first()?);
        let (_, surface) = self.extension.state_mut()?.surface.as_mut()?;
        let [zero, length] = [self.modal.work_offset(), self.modal.tool_length()];
        let zero = zero.first()?.0.saturating_add(length.first()?.0);
        surface.at(x, axis.scale.position(x).abs_diff(zero))
    }
}

#[cfg(feature = "extended")]
impl<const N: usize, P: Moves<N>, L: BacklashModel<N>, const QUEUE: usize, R: PathRamp>
    Machine<N, P, L, QUEUE, Extended<N>, R>
{
    /// Sets the level of the probe's input: whether the probe is in contact. Call it before
    /// [`Machine::next_event`], after the events before have been carried out.
    ///
    /// A change that ends a probing move latches the position of the axes. They then brake along
    /// the path within their acceleration, and the next line begins where they stop.
    ///
    /// # Cost
    /// Constant time; a copy of the position at the contact.
    pub fn set_probe(&mut self, is_touching: bool) {
        let state = &mut self.extension.state;
        state.is_touching = is_touching;
        let Some(probing) = &mut state.probing else {
            return;
        };
        if probing.contact.is_none() && is_touching != probing.is_away {
            probing.contact = Some(self.load);
            self.ramp.hold();
        }
    }

    /// Whether a probing move is being made.
    pub const fn is_probing(&self) -> bool {
        self.extension.state.probing.is_some()
    }

    /// Whether the level of the probe's input matters: a probing move is being made or waits for
    /// the moves before it. Otherwise [`set_probe`](Machine::set_probe) need not be called.
    pub const fn needs_probe(&self) -> bool {
        self.is_probing() || matches!(self.waiting, Some(Command::Probe { .. }))
    }

    /// Sets the tip of the probe. Reported positions are then points of the surface, which is taken
    /// to be square to the move. `None` (as on a new machine): positions of the axes at the
    /// contact.
    pub fn set_tip(&mut self, tip: Option<Tip<6>>) {
        self.extension.tip = tip;
    }

    /// The result of the last probing move; all zero before the first one.
    pub const fn probed(&self) -> &Probed<N> {
        &self.extension.state.probed
    }

    /// Answers [`Event::Await`]: the value of the input in millionths, 1 000 000 for a high level.
    /// `None`: the condition was not met in time.
    pub fn answer(&mut self, micro: Option<i64>) {
        if self.extension.state.is_awaited {
            self.extension.state.is_awaited = false;
            self.extension.input_micro = micro.unwrap_or(-1_000_000);
            self.refill();
        }
    }

    /// The last answer in millionths, -1 000 000 for one that did not come in time (#5399).
    pub const fn input_micro(&self) -> i64 {
        self.extension.input_micro
    }

    /// Writes a tool into the table, as G10 L1 does. Returns `false`, with no effect, for tool 0
    /// and when the table is full.
    pub fn set_tool(&mut self, number: u32, tool: husillo_gcode::Tool<N>) -> bool {
        self.modal.set_tool(number, tool)
    }
}
