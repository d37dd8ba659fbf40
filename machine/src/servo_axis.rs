//! An axis under closed-loop control: a profile, the law that follows it, and the events that end a search.

use husillo_pid::{Drive, Regulator, ServoLaw};
use husillo_planner::{ServoMotion, ServoProfile};

/// What the axis reads once a servo period.
#[derive(Copy, Clone, Debug, Default, Eq, PartialEq)]
pub struct ServoInputs {
    /// The encoder, counts, modulo 2^32.
    pub counts: i32,
    /// Limit switch or probe contact 1, as a level.
    pub limit_1: bool,
    /// Limit switch or probe contact 2, as a level.
    pub limit_2: bool,
    /// The index of the encoder, as a level.
    pub index: bool,
    /// Motor current, in units of its converter.
    pub current: u8,
    /// Whether the motor has its supply.
    pub has_power: bool,
}

/// What ends a search and stores the home position: any of these.
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

/// How an axis is stopped.
#[derive(Copy, Clone, Debug, Eq, PartialEq)]
pub enum ServoStop {
    /// The servo off and the motor without drive.
    Off,
    /// The present position is held, at once.
    Abrupt,
    /// By the acceleration in force.
    Smooth,
    /// This position is held, at once and without a profile; counts.
    At(i32),
}

/// What an axis has to say of itself.
#[derive(Copy, Clone, Debug, Default, Eq, PartialEq)]
pub struct ServoStatus {
    /// No motion goes on.
    pub is_done: bool,
    /// The servo holds or follows a position.
    pub is_on: bool,
    /// A search for an event goes on.
    pub is_searching: bool,
    /// The motor has its supply.
    pub has_power: bool,
    /// The current was beyond its limit; stays until [`ServoAxis::clear`].
    pub over_current: bool,
    /// The position error was beyond its limit, or the servo off; stays until [`ServoAxis::clear`].
    pub position_error: bool,
    /// The position went round 2^32; stays until [`ServoAxis::clear`].
    pub wrapped: bool,
    /// The motion started last has stopped to accelerate.
    pub is_acceleration_done: bool,
    /// The motion started last has begun to decelerate towards its goal.
    pub is_slew_done: bool,
}

/// A position-controlled axis, the peer of a stepping one: [`tick`](Self::tick) once a servo period with what was read, and out
/// comes the drive of the motor. It does what a PIC-SERVO module does with its commands (J. R. Kerr, data sheet, 1999).
///
/// `R` is its law: [`ServoLaw`] of such a module unless another is chosen, a
/// [`Pid`](husillo_pid::Pid) for one.
///
/// Positions are counts of the encoder less the zero of [`set_position`](Self::set_position), modulo 2^32.
/// Cost: a division or three a period on ramps, see [`ServoProfile`], and three products.
#[derive(Copy, Clone, Debug, Eq, PartialEq)]
pub struct ServoAxis<R: Regulator = ServoLaw> {
    law: R,
    state: R::State,
    /// The error of the last sample, commanded less actual position, saturated.
    error_counts: i16,
    profile: ServoProfile,
    loaded: Option<ServoMotion>,
    /// Encoder counts at position 0.
    zero: i32,
    position: i32,
    /// Counts of the last period.
    velocity: i32,
    home: i32,
    search: Option<(ServoEvents, Option<ServoStop>)>,
    /// What was read last: events are changes.
    before: ServoInputs,
    /// Nothing has been read yet.
    is_new: bool,
    over_current: bool,
    position_error: bool,
    wrapped: bool,
}

impl<R: Regulator> ServoAxis<R> {
    /// After power-up: position 0, servo off, no search; [`ServoStatus::position_error`] is set, as the servo is off.
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

    /// Gains and limits from the next period on.
    pub fn set_law(&mut self, law: R) {
        self.law = law;
    }

    /// Calls the present position `position`, in counts; what is commanded moves with it, without a jump. `false`, and nothing
    /// done, while a motion has not come to its goal or its velocity.
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

    /// Keeps a motion for [`start`](Self::start).
    pub fn load(&mut self, motion: ServoMotion) {
        self.loaded = Some(motion);
    }

    /// The motion that waits for [`start`](Self::start).
    pub const fn loaded(&self) -> Option<ServoMotion> {
        self.loaded
    }

    /// Whether the command moves: a profile that is not at rest.
    pub const fn is_moving(&self) -> bool {
        self.profile.velocity() != 0
    }

    /// Starts the motion that was loaded; `false` where there is none. A servo that was off holds the present position first.
    pub fn start(&mut self) -> bool {
        let Some(motion) = self.loaded.take() else {
            return false;
        };
        if let ServoMotion::Pwm { .. } = motion {
            self.switch_off();
        } else if !self.profile.is_servo_on() {
            self.hold(self.position);
        }
        self.profile.start(motion);
        true
    }

    /// Stops. Abrupt and at a position switch the servo on; smooth does not.
    pub fn stop(&mut self, how: ServoStop) {
        match how {
            ServoStop::Off => self.switch_off(),
            ServoStop::Abrupt => self.hold(self.position),
            ServoStop::Smooth => self.profile.stop_smoothly(),
            ServoStop::At(position) => self.hold(position),
        }
    }

    /// Searches: the first of these events stores the home position, ends the search and stops as given. Without any event a
    /// search is given up.
    pub fn search(&mut self, events: ServoEvents, stop: Option<ServoStop>) {
        self.search = (events != ServoEvents::default()).then_some((events, stop));
    }

    /// Forgets over-current, position error and wrap. A servo that is off has its position error again in the next period.
    pub fn clear(&mut self) {
        (self.over_current, self.position_error, self.wrapped) = (false, false, false);
    }

    /// The present position becomes the home position.
    pub fn save_home(&mut self) {
        self.home = self.position;
    }

    /// The next period: reads, searches, moves the profile on and gives the drive.
    pub fn tick(&mut self, inputs: &ServoInputs) -> Drive {
        if self.is_new {
            // Position 0 is where it was switched on, or what it was called since.
            self.zero = inputs.counts.wrapping_sub(self.position);
        }
        let position = inputs.counts.wrapping_sub(self.zero);
        if !self.is_new {
            self.velocity = position.wrapping_sub(self.position);
            // Less than half a turn of 2^32 a period: the sum overflows where the sign lies.
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
                // A duty is 0 to 255 with its sign.
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
            // The error was beyond its limit.
            self.profile.switch_off();
        }
        drive
    }

    /// What changed since the last period, and what is beyond its limit.
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

    /// Where it is, counts.
    pub const fn position(&self) -> i32 {
        self.position
    }

    /// Where it is commanded to be, counts.
    pub const fn commanded(&self) -> i32 {
        self.profile.position()
    }

    /// Counts of the last period.
    pub const fn velocity(&self) -> i32 {
        self.velocity
    }

    /// The error of the last sample, commanded less actual position, counts, saturated.
    pub const fn error_counts(&self) -> i16 {
        self.error_counts
    }

    /// The position of the last event, or the last that was saved; counts.
    pub const fn home(&self) -> i32 {
        self.home
    }

    /// What was read in the last period.
    pub const fn inputs(&self) -> &ServoInputs {
        &self.before
    }

    /// What there is to know besides numbers.
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
