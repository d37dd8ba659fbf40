//! Events of the motors, and the time that passes.

use husillo_machine::Event;

use super::{Grbl, GrblEvent, LONGEST_WAIT_US, Phase, Task};

/// Silence of the line after which queued moves begin, in microseconds.
pub(super) const START_US: u32 = 3000;
/// The last part of this silence, in microseconds. During it, queued moves already count as motion.
const UNDERWAY_US: u32 = 1500;

/// Data that each move carries.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tag {
    /// N word of its block.
    pub(super) line: u32,
    /// Power of the laser.
    pub(super) milli_rpm: u64,
    /// Whether the power is proportional to the speed (M4).
    pub(super) is_dynamic: bool,
}

/// The next event of the motors.
pub(super) enum Next {
    Event(GrblEvent),
    /// A motion has ended, so there may be more to do.
    Stopped,
    Nothing,
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Whether the engine is to make steps.
    pub(super) fn moves(&self) -> bool {
        match self.phase {
            Phase::Run | Phase::Jog | Phase::Hold(true) => true,
            Phase::Door(step) => step.is_braking(),
            Phase::Home => self.homing.is_moving(),
            _ => false,
        }
    }

    /// Whether all moves are made.
    pub(super) fn is_drained(&self) -> bool {
        self.machine.queued() == 0 && self.rest.is_none() && !self.moves()
    }

    /// Whether queued moves are about to begin.
    pub(super) fn is_underway(&self) -> bool {
        self.machine.queued() > 0 && self.start_us <= UNDERWAY_US
    }

    /// Brakes immediately, or when the segments that Grbl has prepared are made.
    pub(super) fn brake(&mut self) {
        if self.options.has_accidents {
            self.brake_us = self.accidents.brakes_after_us(self.machine.executing_tag());
        } else {
            self.machine.hold();
        }
    }

    /// Returns the tag of the present move.
    pub(super) fn executing(&self) -> Option<Tag> {
        let slot = self.machine.executing_tag()?;
        self.tags.get(slot as usize).copied()
    }

    pub(super) fn motion(&mut self) -> Next {
        if self.phase == Phase::Idle && self.machine.queued() > 0 {
            let is_due = self.start_us == 0 || !self.machine.can_push() || self.task != Task::None;
            if is_due {
                self.start_us = 0;
                self.phase = Phase::Run;
            }
        }
        if !self.moves() {
            return Next::Nothing;
        }
        self.idle_us = None;
        self.drive_motors(true);
        if let Some(event) = self.events.pop() {
            return Next::Event(event);
        }
        let (wait, delta) = match self.rest.take() {
            Some(rest) => rest,
            None => match self.next_step() {
                Some(step) => step,
                None => {
                    #[cfg(feature = "height-map")]
                    if let Some(wait) = self.last_us() {
                        return Next::Event(self.made_later(wait.min(LONGEST_WAIT_US), [0; 3]));
                    }
                    self.stopped();
                    return Next::Stopped;
                }
            },
        };
        self.drive_laser();
        if let Some(event) = self.events.pop() {
            self.rest = Some((wait, delta));
            return Next::Event(event);
        }
        #[cfg(feature = "height-map")]
        if let Some(late) = self
            .late_us()
            .filter(|late| *late < wait.min(LONGEST_WAIT_US))
        {
            self.rest = Some((wait.wrapping_sub(late), delta));
            return Next::Event(self.made_later(late, [0; 3]));
        }
        if wait > LONGEST_WAIT_US {
            self.rest = Some((wait.wrapping_sub(LONGEST_WAIT_US), delta));
            return Next::Event(self.made_later(LONGEST_WAIT_US, [0; 3]));
        }
        let kept = self.homing.kept(delta);
        let event = self.made_later(wait, kept);
        if self.options.has_accidents {
            self.pending = Some((wait, delta));
        }
        Next::Event(event)
    }

    /// Returns the next step of the engine. Outputs of the engine are not used.
    fn next_step(&mut self) -> Option<(u32, [i8; 3])> {
        loop {
            match self.machine.next_event()? {
                Event::Step(step) => return Some((step.wait_ticks, step.delta)),
                Event::Dwell { wait_ticks } => return Some((wait_ticks, [0; 3])),
                _ => {}
            }
        }
    }

    fn made_later(&mut self, wait_ticks: u32, delta: [i8; 3]) -> GrblEvent {
        self.pending = Some((wait_ticks, delta));
        #[cfg(feature = "height-map")]
        let delta = self.follow(delta, wait_ticks);
        if delta == [0; 3] {
            return GrblEvent::Wait { wait_ticks };
        }
        let mut motors = delta;
        let inverted = self.settings().whole(3);
        for (bit, delta) in (0_u32..).zip(&mut motors) {
            if inverted.wrapping_shr(bit) & 1 == 1 {
                *delta = delta.wrapping_neg();
            }
        }
        GrblEvent::Step {
            wait_ticks,
            delta: motors,
        }
    }

    /// Handles the end of a motion: the engine has no further step.
    fn stopped(&mut self) {
        #[cfg(feature = "grblhal")]
        if self.is_hal() && self.flags.reset && self.phase != Phase::Home {
            // The reset follows.
            self.phase = Phase::Idle;
            return;
        }
        match self.phase {
            Phase::Home => self.homing_stopped(),
            Phase::Door(_) => self.door_stopped(),
            Phase::Hold(_) => self.hold_stopped(),
            _ => match self.task {
                Task::Probe { .. } => self.probe_stopped(),
                Task::SoftLimit => self.soft_limit(),
                _ => self.end_motion(),
            },
        }
    }

    /// Ends a motion, or a cancelled jog.
    pub(super) fn end_motion(&mut self) {
        if self.is_cancelling || self.machine.is_held() {
            // A jog may wait for a slot of the queue.
            self.next = None;
            self.commands.clear();
            self.drop_moves();
            self.is_cancelling = false;
        }
        self.phase = Phase::Idle;
        #[cfg(feature = "grblhal")]
        if self.hal.is_changing_by_hand() && self.machine.queued() == 0 {
            self.phase = Phase::Tool;
        }
        self.rest_motors();
        self.drive_laser();
        if self.flags.door {
            self.open_door();
        }
    }

    /// Handles axes that have come to rest: starts the time after which the motors are switched
    /// off.
    pub(super) fn rest_motors(&mut self) {
        self.has_stepped = false;
        let delay = self.settings().whole(1);
        self.idle_us = (delay != 255).then_some(delay.wrapping_mul(1000));
        if self.idle_us == Some(0) {
            self.idle_us = None;
            self.drive_motors(false);
        }
    }

    /// Returns the time until something is due, at most [`LONGEST_WAIT_US`].
    pub(super) fn wait_us(&self) -> Option<u32> {
        let start = self.machine.queued() > 0 && self.phase == Phase::Idle;
        let start = start.then_some(self.start_us);
        let waits = [
            self.recovery.wait_us(),
            self.homing.wait_us(),
            self.door_wait_us(),
            self.idle_us,
            Some(self.brake_us),
            Some(self.merge_us),
            Some(self.accidents.wait_us()),
            self.dwell_wait_us(),
            start,
        ];
        #[cfg(feature = "grblhal")]
        let waits = {
            let [
                first,
                second,
                third,
                fourth,
                fifth,
                sixth,
                seventh,
                eighth,
                ninth,
            ] = waits;
            let report = self.hal_wait_us();
            [
                first, second, third, fourth, fifth, sixth, seventh, eighth, ninth, report,
            ]
        };
        let idle = self.options.reads_inputs.then_some(LONGEST_WAIT_US);
        let waits = waits.into_iter().chain([idle]).flatten();
        let least = waits.filter(|wait| *wait > 0).min()?;
        Some(least.min(LONGEST_WAIT_US))
    }

    /// Advances the times of Grbl's accidents.
    fn pass_accidents(&mut self, us: u32) {
        let tag = self.machine.executing_tag().filter(|_| self.moves());
        self.accidents.pass(us, tag);
        if self.brake_us > 0 {
            self.brake_us = self.brake_us.saturating_sub(us);
            if self.brake_us == 0 && self.moves() {
                self.machine.hold();
            }
        }
    }

    /// Advances all times by `us`.
    pub(super) fn pass(&mut self, us: u32) {
        self.recovery.pass(us);
        self.homing.pass(us);
        self.pass_door(us);
        self.start_us = self.start_us.saturating_sub(us);
        self.merge_us = self.merge_us.saturating_sub(us);
        if self.options.has_accidents {
            self.pass_accidents(us);
        }
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            self.hal_pass(us);
        }
        if self.is_dwelling() {
            self.dwell_us = self.dwell_us.saturating_sub(us.into());
        }
        if let Some(left) = self.idle_us {
            let left = left.saturating_sub(us);
            self.idle_us = Some(left);
            if left == 0 {
                self.idle_us = None;
                self.drive_motors(false);
            }
        }
    }
}
