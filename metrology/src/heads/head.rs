//! The head of a measuring machine: one to three servo axes that move together along straight
//! paths.

mod positions;
mod supervision;

use super::approach::Approach;
use super::line::Line;
use super::machine::{Machine, ProbeSettings};
use super::memory::MARK;
use super::port::Port;
use super::prober::{Probed, Prober, Touched};
use super::servo::Servo;
use super::view::{Errors, View};
use crate::error::Error;
use crate::scale::Scale;
use husillo_probe::{Edge, UnitVector};
use husillo_transports::nmc::{
    CYCLE_US, Command, EVERY_GROUP, Group, Items, Reply, Reset, Status, Stop, StopMode,
};

/// The items of a reading of a module.
pub(super) const READ: Items = Items::POSITION.with(Items::HOME);

/// All axes of a machine with their servos on. Positions are amounts of the scale in the order X,
/// Y, Z. The position of a missing axis is always 0.
#[derive(Debug)]
pub struct Head<P> {
    pub(super) line: Line<P>,
    pub(crate) axes: Vec<Servo>,
    pub(super) probe: ProbeSettings,
    pub(super) scale: Scale,
    /// Converts readings to positions for messages.
    view: View,
    /// Period of the modules' profiles, s.
    pub(super) period_s: f64,
    /// Number of slow touches to average.
    pub(super) touches: u8,
    /// Whether a failure has stopped the axes, so that their held positions are unknown.
    is_astray: bool,
    /// The axis whose module has reported a fault, until its module receives a stop command.
    given_up: Option<usize>,
    /// First contact of a probe that is pressed now, counts.
    pub(super) contact_at: Option<Vec<i32>>,
    /// Whether there was a collision that is not forgotten.
    pub(super) has_collided: bool,
    /// Whether an axis has met an end switch.
    pub(super) has_met_end: bool,
}

impl<P: Port> Head<P> {
    /// Starts the line and the servos of all axes of the machine.
    ///
    /// # Errors
    ///
    /// There is no answer, a module is missing or of another kind, periods differ, a motor has no
    /// power, or the machine has no axes.
    pub fn start(line: Line<P>, machine: &Machine, touches: u8) -> Result<Self, Error> {
        let mut head = Self::of(line, machine, touches)?;
        let modules = machine.axes.iter().map(|axis| axis.module);
        let network = head.line.start_servos(machine.baud, modules)?;
        let versions = head.axes.iter().map(|axis| {
            let place = usize::from(axis.settings.module).wrapping_sub(1);
            let device = network.devices.get(place);
            device.map_or(u8::MAX, |(_, version)| *version)
        });
        let versions: Vec<u8> = versions.collect();
        head.set_period(&versions)?;
        // The reset has put all modules into this group. So the reset of the next session reaches
        // them, too.
        head.lead_group()?;
        for index in 0..head.axes.len() {
            head.switch_on(index)?;
        }
        Ok(head)
    }

    /// Creates a head whose line is not started.
    pub(super) fn of(mut line: Line<P>, machine: &Machine, touches: u8) -> Result<Self, Error> {
        if machine.axes.is_empty() {
            return Err(Error::NoAxis { axis: 'X' });
        }
        line.name_axes(machine);
        Ok(Self {
            line,
            axes: machine.axes.iter().copied().map(Servo::new).collect(),
            probe: machine.probe,
            scale: machine.scale,
            view: View::new(Errors::default()),
            period_s: 0.0,
            touches,
            is_astray: false,
            given_up: None,
            contact_at: None,
            has_collided: false,
            has_met_end: false,
        })
    }

    /// Sets the period of the profiles. `versions` are those of the modules of the axes.
    pub(super) fn set_period(&mut self, versions: &[u8]) -> Result<(), Error> {
        // Before version 10, a rate divisor slows the profile of a module. From version 10 on it
        // slows the derivative only.
        let pairs = self.axes.iter().zip(versions);
        let periods = pairs.map(|(axis, version)| match *version < 10 {
            true => axis.settings.gains.rate_divisor,
            false => 1,
        });
        let periods: Vec<u8> = periods.collect();
        if periods.windows(2).any(|pair| pair[0] != pair[1]) {
            return Err(Error::Periods);
        }
        let divisor = periods.first().copied().unwrap_or(1);
        self.period_s = f64::from(CYCLE_US) * 1e-6 * f64::from(divisor);
        Ok(())
    }

    /// Makes the module of the first of several axes the leader of the group of all modules.
    pub(super) fn lead_group(&mut self) -> Result<(), Error> {
        if let [first, _, ..] = self.axes[..] {
            let group = Group {
                address: EVERY_GROUP,
                is_leader: true,
            };
            let address = first.settings.module;
            self.line
                .command(address, Command::SetAddress { address, group })?;
        }
        Ok(())
    }

    fn switch_on(&mut self, index: usize) -> Result<(), Error> {
        let axis = self.axes[index];
        let module = axis.settings.module;
        self.line
            .command(module, Command::SetGain(axis.settings.gains))?;
        self.line.command(module, stop(StopMode::Abrupt))?;
        self.line.command(module, Command::ClearBits)?;
        self.line.command(module, Command::DefineStatus(MARK))?;
        // Not every module sets its position to 0 at a reset.
        self.line
            .command(module, Command::ResetPosition(Reset::Zero))?;
        self.hold_checked(index)
    }

    /// Holds a standing axis at its position.
    ///
    /// # Errors
    ///
    /// No answer, or a fault of the axis.
    pub(super) fn hold_checked(&mut self, index: usize) -> Result<(), Error> {
        let axis = self.axes[index];
        let reply = self.read_axis_twice(&axis, READ)?;
        let at = reply.readings.position;
        axis.check(&reply, || self.axis_text(index, at))?;
        let axis = &mut self.axes[index];
        axis.is_at_end = false;
        if axis.settings.is_end_closed(&reply) {
            axis.meet_end(&reply);
        }
        self.hold(index, reply.readings.position)
    }

    /// The settings of the probe.
    pub const fn probe(&self) -> &ProbeSettings {
        &self.probe
    }

    /// Sets the number of slow touches to average from now on, at least 1.
    pub fn set_touches(&mut self, touches: u8) {
        self.touches = touches.max(1);
    }

    /// Status of the module of a standing axis.
    ///
    /// # Errors
    ///
    /// No such axis, or no answer.
    pub fn status(&mut self, coordinate: usize) -> Result<Reply, Error> {
        let items = READ
            .with(Items::AUXILIARY)
            .with(Items::CURRENT)
            .with(Items::DEVICE);
        let axis = self.axes[self.index(coordinate)?];
        self.read_axis_twice(&axis, items)
    }

    /// Moves to a position along a straight path. Returns the position at which the axes come to
    /// rest.
    ///
    /// # Errors
    ///
    /// [`Error`]. If the goal is outside of the travel, nothing moves.
    pub fn go_to(&mut self, goal: [i64; 3]) -> Result<[i64; 3], Error> {
        self.go_at(goal, None, Approach::Rapid)
    }

    /// Moves to a position in a guarded move: see [`Approach::Guarded`].
    ///
    /// # Errors
    ///
    /// Those of [`go_to`](Self::go_to).
    pub fn guarded_to(&mut self, goal: [i64; 3]) -> Result<[i64; 3], Error> {
        self.go_at(goal, None, Approach::Guarded)
    }

    /// Moves to a position with at most `rate` counts/s.
    fn go_at(
        &mut self,
        goal: [i64; 3],
        rate: Option<u32>,
        approach: Approach,
    ) -> Result<[i64; 3], Error> {
        let meant = goal;
        let goal = self.counts(goal)?;
        self.check_travel(&goal, meant)?;
        let finished = self.go(&goal, rate, approach)?;
        Ok(self.place_of(&finished.replies))
    }

    /// A speed in amounts of the scale per minute as counts/s, rounded down, at least 1.
    fn rate(&self, per_min: u64) -> u32 {
        let per_min = i64::try_from(per_min).unwrap_or(i64::MAX);
        let rate = self.scale.to_counts(per_min) / 60;
        // Not negative.
        u32::try_from(rate.max(1)).unwrap_or(u32::MAX)
    }

    /// Index of an axis in the machine file. `coordinate` is 0 for X to 2 for Z.
    pub(crate) fn index(&self, coordinate: usize) -> Result<usize, Error> {
        let mut axes = self.axes.iter();
        let found = axes.position(|axis| axis.settings.coordinate() == coordinate);
        found.ok_or(Error::NoAxis {
            axis: "XYZ".chars().nth(coordinate).unwrap_or('?'),
        })
    }
}

/// Whether the profile has ended.
pub(super) fn is_done(reply: &Reply) -> bool {
    reply.status.contains(Status::MOVE_DONE)
}

/// The command to stop with the amplifier on.
pub(super) const fn stop(mode: StopMode) -> Command {
    Command::StopMotor(Stop {
        amplifier: true,
        mode: Some(mode),
    })
}

impl<P: Port> Prober for Head<P> {
    fn position(&mut self) -> Result<[i64; 3], Error> {
        let replies = self.read_twice()?;
        Ok(self.place_of(&replies))
    }

    fn go_to(&mut self, goal_nm: [i64; 3]) -> Result<[i64; 3], Error> {
        self.go_to(goal_nm)
    }

    fn guarded_to(&mut self, goal_nm: [i64; 3]) -> Result<[i64; 3], Error> {
        self.guarded_to(goal_nm)
    }

    fn feed_to(&mut self, goal_nm: [i64; 3], nm_per_min: u64) -> Result<[i64; 3], Error> {
        self.go_at(goal_nm, Some(self.rate(nm_per_min)), Approach::Rapid)
    }

    fn probe_to(
        &mut self,
        goal_nm: [i64; 3],
        nm_per_min: u64,
        until: Edge,
    ) -> Result<Probed, Error> {
        self.search_to(goal_nm, self.rate(nm_per_min), until)
    }

    fn has_collided(&self) -> bool {
        self.has_collided()
    }

    fn see_as(&mut self, view: &View) {
        self.view = view.clone();
    }

    fn touch(&mut self, direction: &UnitVector, distance_nm: u64) -> Result<Touched, Error> {
        let measurement = self.touch(direction, distance_nm)?;
        Ok(Touched {
            centre_nm: measurement.touch.position,
            touches: measurement.touches,
            spread_nm: measurement.spread,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::Calibrated;
    use crate::heads::operator::Operator as _;
    use crate::heads::operator::StopButton;
    use crate::simulated::{SimulatedNetwork, SimulatedPort, three_axes};
    use husillo_probe::Failure;
    use husillo_transports::nmc::{Mode, Trajectory};
    use std::cell::RefCell;
    use std::rc::Rc;

    type Head = super::Head<SimulatedPort>;

    const MM: i64 = 1_000_000;

    /// The machine of three axes with a face at Z -4 mm.
    fn head() -> Head {
        started("3:..-2000", StopButton::default())
    }

    /// The machine of three axes with a face.
    fn started(face: &str, button: StopButton) -> Head {
        let network = SimulatedNetwork::new(&[4; 3], &[face.parse().unwrap()], None).unwrap();
        let line = Line::new(SimulatedPort::new(network)).with_operator(button);
        let mut head = Head::start(line, &three_axes(), 1).unwrap();
        // Homed where it stands.
        head.axes.iter_mut().for_each(|axis| axis.is_homed = true);
        head
    }

    /// A position, and whether the probe is pressed there.
    type Reading = ([i64; 3], bool);

    /// What the operator sees of a machine.
    #[derive(Clone, Debug, Default)]
    struct Seen(Rc<RefCell<Vec<Reading>>>);

    impl crate::heads::Operator for Seen {
        fn reads(&self, position: [i64; 3], is_pressed: bool) {
            self.0.borrow_mut().push((position, is_pressed));
        }
    }

    #[test]
    fn an_operator_sees_the_positions_while_the_axes_move() {
        let seen = Seen::default();
        let network =
            SimulatedNetwork::new(&[4; 3], &["3:..-2000".parse().unwrap()], None).unwrap();
        let line = Line::new(SimulatedPort::new(network)).with_operator(seen.clone());
        let mut head = Head::start(line, &three_axes(), 1).unwrap();
        seen.0.take();
        head.go_to([MM, 0, 0]).unwrap();
        let way: Vec<_> = seen.0.take().iter().map(|(at, _)| at[0]).collect();
        let between = way.iter().filter(|x| (100_000..900_000).contains(*x));
        assert!(between.count() > 20, "{way:?}");
        // Pressed, in a move that ends in a collision, and still pressed at rest.
        head.go_to([MM, 0, -5 * MM]).unwrap_err();
        head.come_to_rest().unwrap();
        seen.0.take();
        head.read_at_rest().unwrap();
        let now = seen.0.take();
        let [(at, true)] = now[..] else {
            panic!("{now:?}")
        };
        assert!(at[2] <= -4 * MM);
    }

    /// The next move of some axes does not go on to the goal that was not reached.
    #[test]
    fn after_a_collision_the_axes_are_held_where_they_stand() {
        let mut head = Calibrated::new(head(), three_axes().errors);
        head.go_to([20 * MM, 0, -5 * MM]).unwrap_err();
        assert!(head.inner().is_astray());
        let [x, y, z] = head.hold().unwrap();
        assert!((15 * MM..17 * MM).contains(&x), "{x}");
        assert!((-43 * MM / 10..=-39 * MM / 10).contains(&z), "{z}");
        head.go_to([x, y, 0]).unwrap();
        let [now, ..] = head.position().unwrap();
        assert!(now.abs_diff(x) <= 6_000, "{now} {x}");
    }

    /// A failure that the corrections have not seen, such as a fault at rest.
    #[test]
    fn after_a_failure_the_goal_before_it_is_given_up() {
        let mut head = Calibrated::new(head(), three_axes().errors);
        head.go_to([MM, 0, 0]).unwrap();
        head.inner().go_to([20 * MM, 0, -5 * MM]).unwrap_err();
        let [x, ..] = head.hold().unwrap();
        assert!((15 * MM..17 * MM).contains(&x), "{x}");
    }

    /// Another program has left a module with a long move.
    #[test]
    fn an_axis_that_does_not_come_to_rest_is_reported() {
        let mut head = head();
        head.come_to_rest().unwrap();
        let far = Trajectory {
            position: Some(50_000),
            velocity: Some(30_000),
            acceleration: Some(300),
            mode: Mode::Trapezoid,
            start_now: true,
            ..Trajectory::default()
        };
        let module = head.axes[0].settings.module;
        head.line
            .command(module, Command::LoadTrajectory(far))
            .unwrap();
        (0..1000).for_each(|_| drop(head.line.port().network.tick()));
        let late = head.come_to_rest();
        let Err(Error::StillMoving { at }) = &late else {
            panic!("{late:?}")
        };
        assert!(at.starts_with("X "), "{at}");
    }

    /// Before homing an axis moves as slowly as in a search. The travel counts from home.
    #[test]
    fn an_axis_that_is_not_homed_moves_slowly_and_then_has_its_travel() {
        let mut head = head();
        head.axes[0].is_homed = false;
        head.axes[1].is_homed = false;
        head.axes[0].settings.travel = [-1000, 1000];
        let (time, _) = seconds(&mut head, |head| head.go_to([MM, 0, 0]).unwrap());
        // 1 mm at 0.4 mm/s, and the time to come to rest.
        assert!((2.5..2.9).contains(&time), "{time} s");
        let (time, _) = seconds(&mut head, |head| head.jog(0, true, 2.0, false).unwrap());
        assert!((2.0..2.4).contains(&time), "{time} s");
        assert!(
            head.held()[0].abs_diff(1_800_000) < 60_000,
            "{:?}",
            head.held()
        );
        // The travel is 2 mm to each side of the first position.
        let beyond = head.go_to([2_100_000, 0, 0]);
        assert!(matches!(beyond, Err(Error::OutsideTravel { .. })));
        // The next index is at 1200 counts. From there the travel is 2 mm to each side.
        head.axes[0].settings.travel = [-2000, 2000];
        head.home(0).unwrap();
        head.axes[0].settings.travel = [-1000, 1000];
        assert_eq!(head.axes[0].origin / 400 * 400, head.axes[0].origin);
        let (time, _) = seconds(&mut head, |head| head.go_to([1_900_000, 0, 0]).unwrap());
        assert!((0.9..1.5).contains(&time), "{time} s");
        let beyond = head.go_to([2_100_000, 0, 0]);
        assert!(matches!(beyond, Err(Error::OutsideTravel { .. })));
        assert_eq!(head.axes[0].travel_counts()[1], head.axes[0].origin + 1000);
    }

    /// The result of `what`, and its time in s.
    fn seconds<T>(head: &mut Head, what: impl FnOnce(&mut Head) -> T) -> (f64, T) {
        let before = head.line.elapsed_us();
        let result = what(head);
        ((head.line.elapsed_us() - before) as f64 / 1e6, result)
    }

    #[test]
    fn a_feed_is_the_speed_of_the_path() {
        let mut head = head();
        // 3 mm at 45 mm/min: 4 s, the ramps, and the time to come to rest.
        let goal = [2 * MM, 2 * MM, MM];
        let (time, _) = seconds(&mut head, |head| head.feed_to(goal, 45_000_000).unwrap());
        assert!((4.06..4.3).contains(&time), "{time} s");
        // The machine's own speed is the limit.
        let (most, _) = seconds(&mut head, |head| head.go_to([0; 3]).unwrap());
        let (time, _) = seconds(&mut head, |head| head.feed_to(goal, u64::MAX).unwrap());
        assert!(
            (time - most).abs() < 0.1 && most < 2.0,
            "{time} s, {most} s"
        );
    }

    /// Positions of the motors, now and a second later.
    fn motors(head: &mut Head) -> [[i64; 3]; 2] {
        let network = &mut head.line.port().network;
        let mut at =
            || [0, 1, 2].map(|module| network.servo_network().motor(module).unwrap().counts());
        let before = at();
        for _ in 0..2000 {
            network.tick();
        }
        let mut at =
            || [0, 1, 2].map(|module| network.servo_network().motor(module).unwrap().counts());
        [before, at()]
    }

    #[test]
    fn a_module_that_is_gone_stops_the_others() {
        let mut head = head();
        // Without supply from 1 s to 1.5 s. The move takes 3 s.
        head.line.port().network.interrupt(1, 3000);
        let gone = head.go_to([6 * MM, 6 * MM, 0]);
        assert!(gone.is_err(), "{gone:?}");
        motors(&mut head);
        let [at, later] = motors(&mut head);
        for axis in [0, 2] {
            assert!(at[axis].abs_diff(later[axis]) <= 1, "{at:?} {later:?}");
        }
        assert!((100..2900).contains(&at[0]), "{at:?}");
    }

    #[test]
    fn an_interrupted_move_ends_before_its_goal_and_another_may_follow() {
        let button = StopButton::default();
        let mut head = started("3:..-2000", button.clone());
        head.line.port().network.ask_after(2000, button.clone());
        let ended = head.go_to([6 * MM, 6 * MM, 0]);
        assert!(matches!(ended, Err(Error::Interrupted)), "{ended:?}");
        assert!(button.has_stopped() && !button.is_stop_wanted());
        motors(&mut head);
        let [at, later] = motors(&mut head);
        assert!((100..2900).contains(&at[0]), "{at:?}");
        assert!((0..3).all(|axis| at[axis].abs_diff(later[axis]) <= 1));
        // The head holds the axes at their positions, so this is a straight move.
        let there = head.go_to([5 * MM, 2 * MM, MM]).unwrap();
        let wanted = [5 * MM, 2 * MM, MM];
        assert!((0..3).all(|axis| there[axis].abs_diff(wanted[axis]) <= 2_000));
        // The same with a jog.
        head.line.port().network.ask_after(1000, button);
        assert!(head.jog(0, true, 60.0, false).is_err());
        motors(&mut head);
        let [at, later] = motors(&mut head);
        assert!(at[0].abs_diff(later[0]) <= 1, "{at:?} {later:?}");
    }

    /// A jog that is not stopped ends at the end of the travel, not beyond it.
    #[test]
    fn a_jog_that_nobody_stops_ends_at_the_end_of_the_travel() {
        let mut head = head();
        head.axes[0].settings.travel = [-1000, 1000];
        head.jog(0, true, 60.0, false).unwrap();
        assert!((998..=1000).contains(&head.axes[0].held));
        // Already there.
        head.jog(0, true, 60.0, false).unwrap();
        let [at, _] = motors(&mut head);
        assert!((998..=1000).contains(&at[0]), "{at:?}");
    }

    /// The face is at -4 mm, which is -2000 counts.
    #[test]
    fn a_contact_during_a_move_stops_all_axes_and_is_left_slowly() {
        let mut head = head();
        let met = head.go_to([6 * MM, 0, -12 * MM]);
        let Err(Error::Collision {
            axes,
            at,
            speed,
            beyond,
        }) = met
        else {
            panic!("{met:?}")
        };
        assert_eq!((axes, beyond.is_some()), ("XZ".into(), true));
        assert!(at.contains("Z -4.000"), "{at}");
        // 2.4 mm/s on Z, half of it on X.
        let speed: f64 = speed.unwrap().trim_end_matches(" mm/s").parse().unwrap();
        assert!((2.5..2.9).contains(&speed), "{speed}");
        assert!(head.has_collided());
        let [at, later] = motors(&mut head);
        // The motor runs on by 50 um, as the host repeats the stop.
        assert!(at[2].abs_diff(-2000) <= 25, "{at:?}");
        assert!((0..3).all(|axis| at[axis].abs_diff(later[axis]) <= 1));

        // The probe may be pressed deeper step by step, but not beyond its over-travel of 100
        // counts.
        let mut depth = 0;
        let stopped = loop {
            depth += 1;
            match head.go_to([2 * MM, 0, -4 * MM - depth * MM / 10]) {
                Ok(_) => assert!(depth < 9, "nothing stops it"),
                Err(error) => break error,
            }
        };
        assert!(matches!(stopped, Error::Collision { .. }), "{stopped}");
        let [at, _] = motors(&mut head);
        assert!((-2130..=-2096).contains(&at[2]), "{at:?}");

        // Off the surface: 0.32 mm of the 4.4 mm at 0.4 mm/s, the rest at 2.4 mm/s.
        let (time, there) = seconds(&mut head, |head| head.go_to([2 * MM, 0, 0]));
        assert!(there.unwrap()[2].abs_diff(0) <= 2_000);
        assert!((2.2..3.8).contains(&time), "{time} s");
        assert!(head.go_to([0, 0, -3 * MM]).is_ok());
        // A jog detects the contact, too.
        let met = head.jog(2, false, 60.0, false);
        assert!(matches!(met, Err(Error::Collision { .. })), "{met:?}");
        let [at, _] = motors(&mut head);
        assert!(at[2].abs_diff(-2000) <= 25, "{at:?}");
    }

    /// The face is before the index of Z.
    #[test]
    fn homing_against_a_face_is_a_collision() {
        let mut head = started("3:150", StopButton::default());
        head.go_to([0, 0, MM / 10]).unwrap();
        let met = head.home(2);
        assert!(matches!(met, Err(Error::Collision { .. })), "{met:?}");
        let [at, _] = motors(&mut head);
        assert!(at[2].abs_diff(150) <= 4, "{at:?}");
        // Homing does not begin while the probe is in contact.
        let begun = head.home(2);
        assert!(
            matches!(begun, Err(Error::Probe(Failure::ContactAtStart))),
            "{begun:?}"
        );
    }

    #[test]
    fn to_the_contact_and_off_it_at_the_feed() {
        let mut head = head();
        head.go_to([0, 0, -3 * MM]).unwrap();
        // 1 mm at 12 mm/min: 5 s.
        let down = |head: &mut Head, feed| head.probe_to([0, 0, -9 * MM], feed, Edge::Made);
        let up = |head: &mut Head, feed| head.probe_to([0, 0, -3 * MM], feed, Edge::Broken);
        let (time, made) = seconds(&mut head, |head| down(head, 12_000_000).unwrap());
        assert!((5.0..5.3).contains(&time), "{time} s");
        let [.., z] = made.changed_nm.unwrap();
        assert!(z.abs_diff(-4 * MM) <= 2_000, "{made:?}");
        // The probe stays pressed: it does not back off.
        assert!((z - 20_000..=z).contains(&made.at_nm[2]), "{made:?}");
        assert!(matches!(
            down(&mut head, 12_000_000),
            Err(Error::Probe(Failure::ContactAtStart))
        ));
        let broken = up(&mut head, 12_000_000).unwrap();
        let [.., z] = broken.changed_nm.unwrap();
        assert!(
            z.abs_diff(-4 * MM) <= 2_000 && broken.at_nm[2] >= z,
            "{broken:?}"
        );
        assert!(matches!(up(&mut head, 12_000_000), Err(Error::NotTouching)));

        // The speed of a search, 0.4 mm/s, is the limit of the feed: 2.5 s and the time to come to
        // rest.
        head.go_to([0, 0, -3 * MM]).unwrap();
        let (time, made) = seconds(&mut head, |head| down(head, u64::MAX).unwrap());
        assert!((2.5..2.8).contains(&time), "{time} s");
        // A move along the face keeps the contact.
        let at = made.at_nm;
        let ended = head
            .probe_to([MM, 0, at[2]], 24_000_000, Edge::Broken)
            .unwrap();
        assert_eq!(ended.changed_nm, None);
        assert!(ended.at_nm[0].abs_diff(MM) <= 2_000, "{ended:?}");
        // Beyond the travel nothing moves.
        let beyond = head.probe_to([0, 0, 900 * MM], 24_000_000, Edge::Broken);
        assert!(matches!(beyond, Err(Error::OutsideTravel { .. })));
        assert_eq!(head.held()[0], MM);
    }
}
