//! Closed-loop axis: a profile, the control law that follows it, and the events that end a search.

use husillo_pid::{Drive, Regulator, ServoLaw};
use husillo_planner::{ServoMotion, ServoProfile};

/// Inputs of the axis, read once per servo period.
#[derive(Copy, Clone, Debug, Default, Eq, PartialEq)]
pub struct ServoInputs {
    /// Encoder counts modulo 2^32.
    pub counts: i32,
    /// Level of limit switch or probe contact 1.
    pub limit_1: bool,
    /// Level of limit switch or probe contact 2.
    pub limit_2: bool,
    /// Level of the encoder index.
    pub index: bool,
    /// Motor current in units of its converter.
    pub current: u8,
    /// Whether the motor has supply power.
    pub has_power: bool,
}

/// Events that end a search and store the home position; any one of them suffices.
#[derive(Copy, Clone, Debug, Default, Eq, PartialEq)]
pub struct ServoEvents {
    /// A change of limit 1.
    pub limit_1: bool,
    /// A change of limit 2.
    pub limit_2: bool,
    /// A change of the index.
    pub index: bool,
    /// A position error beyond its limit.
    pub position_error: bool,
    /// A current beyond its limit.
    pub over_current: bool,
}

/// Ways to stop an axis.
#[derive(Copy, Clone, Debug, Eq, PartialEq)]
pub enum ServoStop {
    /// Switches the servo off, with no drive of the motor.
    Off,
    /// Holds the present position at once.
    Abrupt,
    /// Decelerates with the present acceleration.
    Smooth,
    /// Holds this position in counts at once, without a profile.
    At(i32),
}

/// Status of an axis.
#[derive(Copy, Clone, Debug, Default, Eq, PartialEq)]
pub struct ServoStatus {
    /// No motion is in progress.
    pub is_done: bool,
    /// The servo holds or follows a position.
    pub is_on: bool,
    /// A search for an event is in progress.
    pub is_searching: bool,
    /// The motor has supply power.
    pub has_power: bool,
    /// The current exceeded its limit; stays set until [`ServoAxis::clear`].
    pub over_current: bool,
    /// The position error exceeded its limit, or the servo is off; stays set until
    /// [`ServoAxis::clear`].
    pub position_error: bool,
    /// The position wrapped modulo 2^32; stays set until [`ServoAxis::clear`].
    pub wrapped: bool,
    /// The last motion has stopped accelerating.
    pub is_acceleration_done: bool,
    /// The last motion has begun to decelerate towards its goal.
    pub is_slew_done: bool,
}

/// A position-controlled axis with an encoder. Call [`tick`](Self::tick) once per servo period with
/// the inputs; it returns the drive of the motor. The axis reacts to commands as a PIC-SERVO module
/// does (J. R. Kerr, data sheet, 1999).
///
/// `R` is the control law: by default the [`ServoLaw`] of such a module; a
/// [`Pid`](husillo_pid::Pid) is another choice.
///
/// Positions are encoder counts relative to the zero of [`set_position`](Self::set_position),
/// modulo 2^32.
///
/// # Cost
/// Per period one to three divisions on ramps, see [`ServoProfile`], and three products.
#[derive(Copy, Clone, Debug, Eq, PartialEq)]
pub struct ServoAxis<R: Regulator = ServoLaw> {
    law: R,
    state: R::State,
    /// Position error of the last sample, commanded minus actual position, saturated.
    error_counts: i16,
    profile: ServoProfile,
    loaded: Option<ServoMotion>,
    /// Encoder counts at position 0.
    zero: i32,
    position: i32,
    /// Velocity in counts per period.
    velocity: i32,
    home: i32,
    search: Option<(ServoEvents, Option<ServoStop>)>,
    /// Inputs of the last period; events are changes of these.
    before: ServoInputs,
    /// Whether no input has been read yet.
    is_new: bool,
    over_current: bool,
    position_error: bool,
    wrapped: bool,
}

impl<R: Regulator> ServoAxis<R> {
    /// State after power-up: position 0, servo off, no search. [`ServoStatus::position_error`] is
    /// set, because the servo is off.
    pub fn new(law: R) -> Self {
        let mut profile = ServoProfile::new(0);
        profile.switch_off();
        Self {
            state: law.begin(),
            error_counts: 0,
            law,
            profile,
            loaded: None,
            zero: 0,
            position: 0,
            velocity: 0,
            home: 0,
            search: None,
            before: ServoInputs::default(),
            is_new: true,
            over_current: false,
            position_error: true,
            wrapped: false,
        }
    }

    /// Sets the control law with its gains and limits from the next period on.
    pub fn set_law(&mut self, law: R) {
        self.law = law;
    }

    /// Sets the present position to `position` in counts. The commanded position moves with it,
    /// without a jump. Returns `false`, with no effect, while a motion has not reached its goal or
    /// its velocity.
    pub fn set_position(&mut self, position: i32) -> bool {
        let status = self.status();
        if status.is_on && !status.is_done {
            return false;
        }
        // All modulo 2^32.
        let lead = self.profile.position().wrapping_sub(self.position);
        self.zero = self.zero.wrapping_add(self.position).wrapping_sub(position);
        self.position = position;
        self.profile.set_position(position.wrapping_add(lead));
        true
    }

    /// Stores a motion for [`start`](Self::start).
    pub fn load(&mut self, motion: ServoMotion) {
        self.loaded = Some(motion);
    }

    /// The motion that waits for [`start`](Self::start).
    pub const fn loaded(&self) -> Option<ServoMotion> {
        self.loaded
    }

    /// Whether the commanded position moves.
    pub const fn is_moving(&self) -> bool {
        self.profile.velocity() != 0
    }

    /// Starts the loaded motion; returns `false` if there is none. If the servo was off, it first
    /// holds the present position.
    pub fn start(&mut self) -> bool {
        let Some(motion) = self.loaded.take() else {
            return false;
        };
        if let ServoMotion::Pwm { .. } = motion {
            self.switch_off();
            // At once: the reply to the command has it already.
            self.position_error = true;
        } else if !self.profile.is_servo_on() {
            self.hold(self.position);
        }
        self.profile.start(motion);
        true
    }

    /// Stops. `Abrupt` and `At` switch the servo on; `Smooth` does not.
    pub fn stop(&mut self, how: ServoStop) {
        match how {
            ServoStop::Off => {
                self.switch_off();
                self.position_error = true;
            }
            ServoStop::Abrupt => self.hold(self.position),
            ServoStop::Smooth => self.profile.stop_smoothly(),
            ServoStop::At(position) => self.hold(position),
        }
    }

    /// Starts a search: the first of these events stores the home position, ends the search and
    /// stops the axis as given by `stop`. A search without any event cancels the present search.
    pub fn search(&mut self, events: ServoEvents, stop: Option<ServoStop>) {
        self.search = (events != ServoEvents::default()).then_some((events, stop));
    }

    /// Clears over-current, position error and wrap. If the servo is off, the position error is set
    /// again in the next period.
    pub fn clear(&mut self) {
        (self.over_current, self.position_error, self.wrapped) = (false, false, false);
    }

    /// Stores the present position as the home position.
    pub fn save_home(&mut self) {
        self.home = self.position;
    }

    /// Runs the next period: evaluates the inputs and the search, advances the profile and returns
    /// the drive.
    pub fn tick(&mut self, inputs: &ServoInputs) -> Drive {
        if self.is_new {
            // Position 0 is the position at power-up, unless `set_position` has changed it.
            self.zero = inputs.counts.wrapping_sub(self.position);
        }
        let position = inputs.counts.wrapping_sub(self.zero);
        if !self.is_new {
            self.velocity = position.wrapping_sub(self.position);
            // Less than half of 2^32 per period: the sum overflows where the position wraps.
            self.wrapped |= self.position.checked_add(self.velocity).is_none();
        }
        self.position = position;
        let happened = self.changes(inputs);
        (self.before, self.is_new) = (*inputs, false);
        if !inputs.has_power {
            self.switch_off();
        }
        self.end_search(happened);
        let drive = self.drive(inputs.current);
        self.over_current |= self.law.is_over_current(&self.state);
        self.position_error |= !self.profile.is_servo_on();
        drive
    }

    fn drive(&mut self, current: u8) -> Drive {
        if !self.profile.is_servo_on() {
            let duty = self.profile.duty();
            let drive = Drive {
                // A duty is from 0 to 255 with a sign.
                pwm: duty.unsigned_abs() as u8,
                is_reverse: duty < 0,
            };
            return self.law.open_loop(&mut self.state, drive, current);
        }
        let is_sample = self.law.is_due(&self.state);
        if is_sample {
            self.profile.tick();
        }
        let command = self.profile.position();
        if is_sample {
            let error = command.wrapping_sub(self.position);
            self.error_counts = error.clamp(i16::MIN.into(), i16::MAX.into()) as i16;
        }
        let drive = self
            .law
            .regulate(&mut self.state, command, self.position, current);
        if self.law.has_given_up(&self.state) {
            // The error exceeded its limit.
            self.profile.switch_off();
        }
        drive
    }

    /// Inputs that changed since the last period, and values beyond their limits.
    fn changes(&self, inputs: &ServoInputs) -> ServoEvents {
        let changed = |now, before| !self.is_new && now != before;
        ServoEvents {
            limit_1: changed(inputs.limit_1, self.before.limit_1),
            limit_2: changed(inputs.limit_2, self.before.limit_2),
            index: changed(inputs.index, self.before.index),
            position_error: self.position_error,
            over_current: self.over_current,
        }
    }

    fn end_search(&mut self, happened: ServoEvents) {
        let Some((wanted, stop)) = self.search else {
            return;
        };
        let is_over = wanted.limit_1 && happened.limit_1
            || wanted.limit_2 && happened.limit_2
            || wanted.index && happened.index
            || wanted.position_error && happened.position_error
            || wanted.over_current && happened.over_current;
        if is_over {
            self.home = self.position;
            self.search = None;
            if let Some(stop) = stop {
                self.stop(stop);
            }
        }
    }

    fn hold(&mut self, position: i32) {
        if !self.profile.is_servo_on() {
            self.forget();
        }
        self.profile.stop_at(position);
    }

    fn switch_off(&mut self) {
        self.profile.switch_off();
        self.forget();
    }

    fn forget(&mut self) {
        self.state = self.law.begin();
        self.error_counts = 0;
    }

    /// Actual position in counts.
    pub const fn position(&self) -> i32 {
        self.position
    }

    /// Commanded position in counts.
    pub const fn commanded(&self) -> i32 {
        self.profile.position()
    }

    /// Velocity in counts per period.
    pub const fn velocity(&self) -> i32 {
        self.velocity
    }

    /// Position error of the last sample, commanded minus actual position, in counts, saturated.
    pub const fn error_counts(&self) -> i16 {
        self.error_counts
    }

    /// Home position in counts: that of the last event, or the last one saved.
    pub const fn home(&self) -> i32 {
        self.home
    }

    /// Inputs of the last period.
    pub const fn inputs(&self) -> &ServoInputs {
        &self.before
    }

    /// Status flags.
    pub const fn status(&self) -> ServoStatus {
        ServoStatus {
            is_done: self.profile.is_done(),
            is_on: self.profile.is_servo_on(),
            is_searching: self.search.is_some(),
            has_power: self.before.has_power,
            over_current: self.over_current,
            position_error: self.position_error,
            wrapped: self.wrapped,
            is_acceleration_done: self.profile.is_acceleration_done(),
            is_slew_done: self.profile.is_slew_done(),
        }
    }
}
