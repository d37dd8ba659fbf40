//! The head of a measuring machine: one to three servo axes on a line, moved together in straight lines.

use super::file::{CmmFile, ProbeFile};
use super::line::Line;
use super::prober::{Prober, Touched};
use super::scale::Scale;
use super::servo::Servo;
use super::trouble::Trouble;
use husillo_probe::UnitVector;
use husillo_transports::nmc::{
    CYCLE_US, Command, EVERY_GROUP, Group, Items, Reply, Reset, Status, Stop, StopWay,
};

/// What is read of a module.
pub(super) const READ: Items = Items::POSITION.with(Items::HOME);

/// All axes of a machine with their servos on. Positions are amounts of the scale in the order X, Y, Z; an axis that is not there is
/// always at 0.
pub struct Head {
    pub(super) line: Line,
    pub(super) axes: Vec<Servo>,
    pub(super) probe: ProbeFile,
    pub(super) scale: Scale,
    /// Time of a step of the modules' profiles, s.
    pub(super) period_s: f64,
    /// Slow touches to average.
    pub(super) touches: u8,
}

impl Head {
    /// Starts the line and the servos of all axes of the machine.
    ///
    /// # Errors
    ///
    /// No answer, fewer modules than the machine has, no motor power.
    pub fn start(mut line: Line, machine: &CmmFile, touches: u8) -> Result<Self, Trouble> {
        let chain = line.start_up(machine.baud)?;
        let wanted = machine.modules();
        if chain.modules < wanted {
            let modules = chain.modules;
            return Err(Trouble::NoModule { wanted, modules });
        }
        let mut head = Self {
            line,
            axes: machine.axes.iter().copied().map(Servo::new).collect(),
            probe: machine.probe,
            scale: machine.scale,
            period_s: 0.0,
            touches,
        };
        // A divisor makes the profiles of old modules slower, but only the derivative of version 10.
        let periods = head.axes.iter().map(|axis| {
            let (_, version) = chain.devices[usize::from(axis.file.module) - 1];
            if version < 10 {
                axis.file.gains.rate_divisor
            } else {
                1
            }
        });
        let periods: Vec<u8> = periods.collect();
        if periods.windows(2).any(|pair| pair[0] != pair[1]) {
            return Err(Trouble::Periods);
        }
        head.period_s = f64::from(CYCLE_US) * 1e-6 * f64::from(periods[0]);
        if let [first, _, ..] = head.axes[..] {
            // All are in this group since the reset, and the reset of the next session still finds them there.
            let group = Group {
                address: EVERY_GROUP,
                is_leader: true,
            };
            let address = first.file.module;
            head.line
                .command(address, Command::SetAddress { address, group })?;
        }
        for index in 0..head.axes.len() {
            head.switch_on(index)?;
        }
        Ok(head)
    }

    fn switch_on(&mut self, index: usize) -> Result<(), Trouble> {
        let axis = self.axes[index];
        let module = axis.file.module;
        self.line
            .command(module, Command::SetGain(axis.file.gains))?;
        self.line.command(module, stop(StopWay::Abrupt))?;
        self.line.command(module, Command::ClearBits)?;
        // A reset has done it already, but not on every module.
        self.line
            .command(module, Command::ResetPosition(Reset::Zero))?;
        let reply = self.read_axis_twice(&axis, READ)?;
        axis.check(self.scale, &reply)?;
        self.hold(index, reply.readings.position)
    }

    /// What the module of a standing axis says of itself.
    ///
    /// # Errors
    ///
    /// No answer.
    pub fn status(&mut self, coordinate: usize) -> Result<Reply, Trouble> {
        let items = READ
            .with(Items::AUXILIARY)
            .with(Items::CURRENT)
            .with(Items::DEVICE);
        let axis = self.axes[self.index(coordinate)?];
        self.read_axis_twice(&axis, items)
    }

    /// Goes to a place in a straight line and returns where the axes stand.
    ///
    /// # Errors
    ///
    /// [`Trouble`]; outside of the travel nothing moves.
    pub fn go_to(&mut self, goal: [i64; 3]) -> Result<[i64; 3], Trouble> {
        let goal = self.counts(goal)?;
        self.check_travel(&goal)?;
        let way = self.travel(&goal, None, None)?;
        Ok(self.place_of(&way.replies))
    }

    /// Calls the place that an axis holds 0.
    ///
    /// # Errors
    ///
    /// There is no such axis.
    pub fn set_zero(&mut self, coordinate: usize) -> Result<(), Trouble> {
        let index = self.index(coordinate)?;
        self.axes[index].origin = self.axes[index].held;
        Ok(())
    }

    /// The place in the machine file of an axis, 0 for X to 2 for Z.
    pub(super) fn index(&self, coordinate: usize) -> Result<usize, Trouble> {
        let mut axes = self.axes.iter();
        let found = axes.position(|axis| axis.file.coordinate() == coordinate);
        found.ok_or(Trouble::NoAxis {
            axis: "XYZ".chars().nth(coordinate).unwrap_or('?'),
        })
    }

    /// Where the axes are to be.
    pub fn held(&self) -> [i64; 3] {
        self.place(|_, axis| axis.held)
    }

    /// Where the axes are by these replies.
    pub fn place_of(&self, replies: &[Reply]) -> [i64; 3] {
        self.place(|index, _| replies[index].readings.position)
    }

    /// Where the axes were by these replies when they found what they looked for.
    pub fn latched(&self, replies: &[Reply]) -> [i64; 3] {
        self.place(|index, _| replies[index].readings.home)
    }

    /// A place for people.
    pub fn text(&self, place: [i64; 3]) -> String {
        let numbers = self.axes.iter().map(|axis| {
            let position = place[axis.file.coordinate()];
            match self.axes.len() {
                1 => self.scale.text(position),
                _ => format!("{} {}", axis.file.letter, self.scale.text(position)),
            }
        });
        numbers.collect::<Vec<_>>().join(", ")
    }

    fn place(&self, counts: impl Fn(usize, &Servo) -> i32) -> [i64; 3] {
        let mut place = [0; 3];
        for (index, axis) in self.axes.iter().enumerate() {
            place[axis.file.coordinate()] = axis.position(self.scale, counts(index, axis));
        }
        place
    }

    /// Counts of a place, an axis each.
    ///
    /// # Errors
    ///
    /// It is beside the axes of the machine.
    pub(super) fn counts(&self, place: [i64; 3]) -> Result<Vec<i32>, Trouble> {
        for (axis, position) in "XYZ".chars().zip(place) {
            if position != 0 && !self.axes.iter().any(|there| there.file.letter == axis) {
                return Err(Trouble::NoAxis { axis });
            }
        }
        let of = |axis: &Servo| axis.counts(self.scale, place[axis.file.coordinate()]);
        Ok(self.axes.iter().map(of).collect())
    }

    /// Whether all axes may go there.
    ///
    /// # Errors
    ///
    /// The first that may not.
    fn check_travel(&self, goal: &[i32]) -> Result<(), Trouble> {
        for (axis, goal) in self.axes.iter().zip(goal) {
            let [low, high] = axis.file.travel;
            if !(low..=high).contains(goal) {
                return Err(Trouble::OutsideTravel {
                    goal: axis.text(self.scale, *goal),
                    travel: axis.travel(self.scale).map(|end| self.scale.text(end)),
                });
            }
        }
        Ok(())
    }

    /// How far it is in a direction to the end of the travel.
    pub fn room(&self, direction: &UnitVector) -> u64 {
        let components = direction.components().map(|part| part.to_num::<f64>());
        let rooms = self.axes.iter().map(|axis| {
            let [low, high] = axis.travel(self.scale);
            let at = axis.position(self.scale, axis.held);
            // Travels are far below 2^53 nm, and 0 / 0 is no room to `min`.
            match components[axis.file.coordinate()] {
                part if part > 0.0 => (high - at) as f64 / part,
                part if part < 0.0 => (low - at) as f64 / part,
                _ => f64::INFINITY,
            }
        });
        // Nothing is left of a negative one.
        rooms.fold(f64::INFINITY, f64::min) as u64
    }

    /// Reads all axes.
    ///
    /// # Errors
    ///
    /// No answer, or an axis in trouble: then all are stopped.
    pub(super) fn read(&mut self) -> Result<Vec<Reply>, Trouble> {
        let mut replies = Vec::with_capacity(self.axes.len());
        for axis in &self.axes {
            let module = axis.file.module;
            replies.push(self.line.command(module, Command::ReadStatus(READ))?);
        }
        let mut pairs = self.axes.iter().zip(&replies);
        if let Err(trouble) = pairs.try_for_each(|(axis, reply)| axis.check(self.scale, reply)) {
            // The trouble comes first; that one of them cannot be stopped is no news then.
            let _ = self.stop();
            return Err(trouble);
        }
        Ok(replies)
    }

    /// Reads all axes, which stand, until two readings of each agree: what is told or kept comes from these.
    ///
    /// # Errors
    ///
    /// No answer, or readings that do not agree.
    pub(super) fn read_twice(&mut self) -> Result<Vec<Reply>, Trouble> {
        let axes = self.axes.clone();
        axes.iter()
            .map(|axis| self.read_axis_twice(axis, READ))
            .collect()
    }

    fn read_axis_twice(&mut self, axis: &Servo, items: Items) -> Result<Reply, Trouble> {
        let jitter_counts = axis.file.in_position.saturating_mul(2);
        self.line.read_twice(axis.file.module, items, jitter_counts)
    }

    /// Tells an axis that stands what to hold, so that the next way is known exactly.
    pub(super) fn hold(&mut self, index: usize, counts: i32) -> Result<(), Trouble> {
        let module = self.axes[index].file.module;
        self.line.command(module, stop(StopWay::Here(counts)))?;
        self.axes[index].held = counts;
        Ok(())
    }

    /// Stops all axes at once, where they are; each gets its command, whatever the others answer.
    pub(super) fn stop(&mut self) -> Result<(), Trouble> {
        let mut result = Ok(());
        for axis in &self.axes {
            let answer = self.line.command(axis.file.module, stop(StopWay::Abrupt));
            result = result.and(answer.map(drop));
        }
        result
    }
}

/// Whether no motion goes on.
pub(super) fn is_done(reply: &Reply) -> bool {
    reply.status.contains(Status::MOVE_DONE)
}

/// Stops, with the amplifier on.
pub(super) const fn stop(way: StopWay) -> Command {
    Command::StopMotor(Stop {
        amplifier: true,
        way: Some(way),
    })
}

impl Prober for Head {
    fn position(&mut self) -> Result<[i64; 3], Trouble> {
        let replies = self.read_twice()?;
        Ok(self.place_of(&replies))
    }

    fn go_to(&mut self, goal_nm: [i64; 3]) -> Result<[i64; 3], Trouble> {
        self.go_to(goal_nm)
    }

    fn touch(&mut self, direction: &UnitVector, way_nm: u64) -> Result<Touched, Trouble> {
        let measurement = self.touch(direction, way_nm)?;
        Ok(Touched {
            centre_nm: measurement.touch.position,
            touches: measurement.touches,
            spread_nm: measurement.spread,
        })
    }
}
