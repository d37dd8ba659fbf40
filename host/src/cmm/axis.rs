//! An axis behind a module: moves and touches.

use super::file::{AxisFile, CmmFile, ProbeFile};
use super::line::Line;
use super::scale::Scale;
use super::trouble::Trouble;
use husillo_probe::{Cycle, Edge, Failure, Input, Measurement, Plan, Request, UnitVector};
use husillo_transports::nmc::{
    CYCLE_US, Command, Homing, Items, Mode, Reply, Reset, Status, Stop, StopWay, Trajectory,
};

/// Longest time from the end of a profile until the axis stands, us.
const SETTLING_US: u64 = 2_000_000;

/// Readings in a row, all in position, before the axis stands.
const STILL_READINGS: u32 = 3;

/// An axis with its servo on.
pub struct Axis {
    line: Line,
    file: AxisFile,
    probe: ProbeFile,
    scale: Scale,
    /// Counts at reset less what the module calls the same place now.
    zero: i32,
}

/// A way of the axis.
struct Way {
    /// The last reading.
    reply: Reply,
    /// It was a contact that ended it.
    has_touched: bool,
}

impl Axis {
    /// Starts the line and the servo of the axis with this index in the file.
    ///
    /// # Errors
    ///
    /// No answer, fewer modules than the machine has, no motor power.
    pub fn start(mut line: Line, machine: &CmmFile, file: AxisFile) -> Result<Self, Trouble> {
        let modules = line.start_up(machine.baud)?.modules;
        if modules < file.module {
            return Err(Trouble::NoModule {
                wanted: file.module,
                modules,
            });
        }
        let mut axis = Self {
            line,
            file,
            probe: machine.probe,
            scale: machine.scale,
            zero: 0,
        };
        axis.command(Command::SetGain(file.gains))?;
        let on = Stop {
            amplifier: true,
            way: Some(StopWay::Abrupt),
        };
        axis.command(Command::StopMotor(on))?;
        axis.command(Command::ClearBits)?;
        let reply = axis.read()?;
        if !reply.status.contains(Status::POWER_ON) {
            return Err(Trouble::NoPower);
        }
        axis.check(&reply)?;
        // A reset has done it already, but not on every module.
        axis.command(Command::ResetPosition(Reset::Zero))?;
        Ok(axis)
    }

    /// What the module says of itself.
    ///
    /// # Errors
    ///
    /// No answer.
    pub fn status(&mut self) -> Result<Reply, Trouble> {
        let items = READ
            .with(Items::AUXILIARY)
            .with(Items::CURRENT)
            .with(Items::DEVICE);
        self.command(Command::ReadStatus(items))
    }

    /// Goes to a position in counts and returns where it stands.
    ///
    /// # Errors
    ///
    /// [`Trouble`]; outside of the travel nothing moves.
    pub fn go_to(&mut self, goal: i32) -> Result<i32, Trouble> {
        let [low, high] = self.travel();
        if !(low..=high).contains(&goal) {
            return Err(Trouble::OutsideTravel {
                goal: self.text(goal),
                travel: [self.text(low), self.text(high)],
            });
        }
        let way = self.travel_to(goal, self.file.rate, false)?;
        Ok(way.reply.readings.position)
    }

    /// Calls the present place 0.
    ///
    /// # Errors
    ///
    /// No answer.
    pub fn set_zero(&mut self) -> Result<(), Trouble> {
        let position = self.stand(None)?.readings.position;
        self.command(Command::ResetPosition(Reset::Zero))?;
        // Within the travel before, so far from the ends.
        self.zero = self.zero.saturating_add(position);
        Ok(())
    }

    /// Searches the work piece in a direction, touches it `touches` times slowly, and returns the mean of what was latched, in
    /// counts.
    ///
    /// # Errors
    ///
    /// [`Trouble`], the probing cycle's own among them.
    pub fn touch(&mut self, is_positive: bool, touches: u8) -> Result<Measurement, Trouble> {
        let start = self.read()?;
        let from = start.readings.position;
        let [low, high] = self.travel();
        let (direction, end) = if is_positive {
            (UnitVector::X, high)
        } else {
            (UnitVector::X.reversed(), low)
        };
        let approach = [i64::from(from), 0, 0];
        let mut cycle = Cycle::new(&Plan {
            approach,
            direction,
            search: end.abs_diff(from),
            over_travel: self.probe.over_travel,
            back_off: self.probe.back_off,
            touches,
            travel_speed: self.file.rate,
            probing_speed: self.probe.rate,
            slow_speed: self.probe.slow_rate,
            back_off_speed: self.probe.rate,
            until: Edge::Made,
        })
        .map_err(Trouble::Plan)?;
        let mut way = Way {
            reply: start,
            has_touched: false,
        };
        loop {
            let readings = way.reply.readings;
            let input = Input {
                position: [i64::from(readings.position), 0, 0],
                // A contact is told once; whether it lasts is the level.
                contact: way.has_touched || way.reply.status.contains(Status::LIMIT_1),
                latched: [i64::from(readings.home), 0, 0],
                // Each request is carried out before the next is asked for.
                still: true,
            };
            way.has_touched = false;
            match cycle.tick(&input) {
                Request::Move { target, speed } => {
                    let way_along = direction.length_along([target[0] - input.position[0], 0, 0]);
                    let is_search = target != approach && way_along > 0;
                    // Within the travel and the over-travel, both of 32 bits.
                    let goal = i32::try_from(target[0]).unwrap_or(end);
                    way = self.travel_to(goal, speed, is_search)?;
                }
                // The module stops by itself.
                Request::Stop | Request::Wait => {}
                Request::Done(measurement) => return Ok(measurement),
                Request::Failed(Failure::NoContact) => {
                    return Err(Trouble::NoContact {
                        from: self.text(from),
                        to: self.text(end),
                    });
                }
                Request::Failed(failure) => return Err(Trouble::Probe(failure)),
            }
        }
    }

    /// Moves to a goal at a speed in counts/s and waits until the axis stands. A search ends at a contact: the module latches
    /// where it was and stops smoothly, and with neither contact nor host the move ends at the goal.
    fn travel_to(&mut self, goal: i32, rate: u32, is_search: bool) -> Result<Way, Trouble> {
        let from = self.read()?.readings.position;
        if is_search {
            self.command(Command::SetHoming(Homing::LIMIT_1.with(Homing::SMOOTH)))?;
        }
        // 16.16 counts a servo cycle; 2^31 is beyond what any motor makes, so the casts' saturation does no harm.
        let cycle_s = f64::from(CYCLE_US) * 1e-6 * f64::from(self.file.gains.rate_divisor);
        let velocity = (f64::from(rate) * cycle_s * 65536.0).round() as u32;
        let acceleration = f64::from(self.file.acceleration) * cycle_s * cycle_s * 65536.0;
        self.command(Command::LoadTrajectory(Trajectory {
            position: Some(goal),
            velocity: Some(velocity.max(1)),
            acceleration: Some((acceleration.round() as u32).max(1)),
            mode: Mode::Trapezoid,
            start_now: true,
            ..Trajectory::default()
        }))?;
        let way_s = f64::from(goal.abs_diff(from)) / f64::from(rate);
        let ramps_s = 2.0 * f64::from(rate) / f64::from(self.file.acceleration);
        let end_us = self.line.elapsed_us() + ((way_s + ramps_s) * 1.5e6) as u64 + SETTLING_US;
        loop {
            let reply = self.read()?;
            self.check(&reply)?;
            let has_touched = is_search && !reply.status.contains(Status::HOME_IN_PROGRESS);
            if has_touched {
                self.stand(None)?;
                // What was latched counts: read until two readings agree.
                let jitter_counts = self.file.in_position.saturating_mul(2);
                let reply = self
                    .line
                    .read_twice(self.file.module, READ, jitter_counts)?;
                return Ok(Way { reply, has_touched });
            }
            if reply.status.contains(Status::MOVE_DONE) {
                let stood = self.stand(Some(goal))?;
                if is_search {
                    // A contact while it settled is none; the search is given up.
                    self.command(Command::SetHoming(Homing::default()))?;
                }
                return Ok(Way {
                    reply: stood,
                    has_touched,
                });
            }
            if self.line.elapsed_us() > end_us {
                return Err(self.not_there(goal, &reply));
            }
        }
    }

    /// Waits until the axis stands: at the goal, or where it stops.
    fn stand(&mut self, goal: Option<i32>) -> Result<Reply, Trouble> {
        let end_us = self.line.elapsed_us() + SETTLING_US;
        let (mut still, mut before) = (0, None);
        loop {
            let reply = self.read()?;
            self.check(&reply)?;
            let position = reply.readings.position;
            let is_near = |to: i32| position.abs_diff(to) <= self.file.in_position;
            let is_still = reply.status.contains(Status::MOVE_DONE)
                && goal.is_none_or(is_near)
                && before.is_some_and(is_near);
            still = if is_still { still + 1 } else { 0 };
            before = Some(position);
            if still >= STILL_READINGS {
                return Ok(reply);
            }
            if self.line.elapsed_us() > end_us {
                return Err(self.not_there(goal.unwrap_or(position), &reply));
            }
        }
    }

    fn check(&self, reply: &Reply) -> Result<(), Trouble> {
        let at = || self.text(reply.readings.position);
        if !reply.status.contains(Status::POWER_ON) {
            Err(Trouble::NoPower)
        } else if reply.status.contains(Status::OVERCURRENT) {
            Err(Trouble::OverCurrent { at: at() })
        } else if reply.status.contains(Status::POSITION_ERROR) {
            Err(Trouble::PositionError { at: at() })
        } else {
            Ok(())
        }
    }

    fn not_there(&self, goal: i32, reply: &Reply) -> Trouble {
        Trouble::NotThere {
            goal: self.text(goal),
            at: self.text(reply.readings.position),
        }
    }

    fn read(&mut self) -> Result<Reply, Trouble> {
        self.command(Command::ReadStatus(READ))
    }

    fn command(&mut self, command: Command) -> Result<Reply, Trouble> {
        self.line.command(self.file.module, command)
    }

    /// The travel as the module counts now.
    fn travel(&self) -> [i32; 2] {
        self.file.travel.map(|end| end.saturating_sub(self.zero))
    }

    fn text(&self, counts: i32) -> String {
        self.scale.text(self.scale.of_counts(counts.into()))
    }
}

const READ: Items = Items::POSITION.with(Items::HOME);
