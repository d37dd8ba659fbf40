//! `husillo measure`: carries out actions on a machine and reports their results.

use super::action::Action;
use super::direction::Towards;
use super::memory_file::MemoryFile;
use super::result_row::{
    CalibrationFigures, Entry, Numbers, PlaceFigures, ResultRow, StatusFigures, TouchFigures,
};
use crate::cli::Measure;
use crate::console::sharing::share;
use crate::measuring::port::NetworkPort;
use husillo_backlash::Flank;
use husillo_metrology::calibration::{Body, Calibrated, Face, FoundProbe, is_by_axis, surface_nm};
use husillo_metrology::heads::{
    Approach, Head, Line, Machine, Memory, Port, Prober, Rejoined, Stylus, pre_travel_by_sign,
};
use husillo_metrology::simulated::{Contact, Mounted, SimulatedNetwork, SimulatedPort};
use husillo_metrology::{Error, Scale};
use husillo_probe::{Measurement, UnitVector};
use husillo_transports::nmc::{Auxiliary, Reply, Status};

/// The port of a machine: simulated or real.
pub type AnyPort = Box<dyn Port>;

/// A session with a machine: its settings, and the calibration of the probe so far.
pub struct Session {
    /// The unit of the machine.
    pub scale: Scale,
    /// The axis of an action that names none.
    axis: usize,
    machine: Machine,
    /// The axes that the machine has, of 0 for X to 2 for Z.
    axes: Vec<usize>,
    stylus: Stylus,
    reference: Option<i64>,
    /// Lengths of `where` are in inches.
    is_inch: bool,
    /// What the next session needs. The simulated port has no memory.
    memory: Option<MemoryFile>,
}

impl Session {
    /// Reads the arguments.
    ///
    /// # Errors
    ///
    /// A message about an argument that is not understood or does not fit the machine.
    pub fn new(args: &Measure, machine: &Machine) -> Result<Self, String> {
        let scale = machine.scale;
        let axis = machine.axis(args.axis)?.coordinate();
        let axes = machine.axes.iter().map(|axis| axis.coordinate()).collect();
        let reference = amount(scale, "--reference", args.reference.as_deref())?;
        let stylus = stylus(args, machine)?;
        Ok(Self {
            scale,
            axis,
            machine: machine.clone(),
            axes,
            stylus,
            reference,
            is_inch: args.inch,
            memory: MemoryFile::of(args, machine),
        })
    }

    /// The probe with its calibration so far.
    pub const fn stylus(&self) -> Stylus {
        self.stylus
    }

    /// Switches the servos on. Continues with the state in which the last session left the modules.
    /// If that is not possible, starts the line and reports what is lost.
    ///
    /// # Errors
    ///
    /// Those of [`Head::start`] and [`Head::rejoin`].
    pub fn begin(
        &self,
        mut line: Line<AnyPort>,
        args: &Measure,
    ) -> Result<Calibrated<Head<AnyPort>>, Error> {
        let (machine, touches) = (&self.machine, args.repeat);
        let errors = || machine.errors.clone();
        let mut was_left = false;
        let left = self.memory.as_ref().filter(|_| !args.reset);
        if let Some(mut memory) = left.and_then(MemoryFile::read) {
            match Head::rejoin(line, machine, touches, &memory)? {
                Rejoined::AsLeft(head) => {
                    if memory.in_use {
                        eprintln!(
                            "note: the program before was killed. All axes have been stopped where \
                             they were; zero and home are kept"
                        );
                        let axes = memory.axes.iter_mut();
                        axes.for_each(|axis| axis.flank = Flank::Unknown);
                    }
                    let mut head = Calibrated::new(*head, errors());
                    head.recall(&memory);
                    self.keep(&mut head);
                    return Ok(head);
                }
                Rejoined::Changed(same) => line = *same,
            }
            was_left = true;
        }
        let started = Head::start(line, machine, touches);
        if was_left {
            if matches!(started, Err(Error::NoModules)) {
                // Modules behind a pulled cable keep their counts. The next command compares them.
                return Err(Error::NoModules);
            }
            eprintln!("note: the modules were reset or moved, so zero and home are lost");
        }
        if let Some(memory) = &self.memory {
            memory.forget();
        }
        let mut head = Calibrated::new(started?, errors());
        self.keep(&mut head);
        Ok(head)
    }

    /// Keeps homes, zeros and positions in case the program is killed. Call it while the axes stand
    /// still.
    pub fn keep(&self, head: &mut Calibrated<Head<AnyPort>>) {
        if let Some(file) = &self.memory {
            // Without an answer the next action fails, too.
            if let Ok(memory) = head.memory() {
                let memory = Memory {
                    in_use: true,
                    ..memory
                };
                let _ = file.write(&memory);
            }
        }
    }

    /// Keeps homes, zeros and positions for the next session, and reports whether the servos still
    /// hold.
    pub fn end(&self, head: &mut Calibrated<Head<AnyPort>>) {
        let Some(file) = &self.memory else { return };
        let memory = match head.memory() {
            Ok(memory) => memory,
            Err(error) => {
                eprintln!("warning: zero and home are not kept for the next command: {error}");
                return;
            }
        };
        if let Err(error) = file.write(&memory) {
            eprintln!("warning: zero and home are not kept for the next command: {error}");
            return;
        }
        let free = memory.axes.iter().filter(|axis| !axis.is_held);
        let free: Vec<_> = free.map(|axis| axis.letter.to_string()).collect();
        match free.is_empty() {
            true => eprintln!("note: the servos stay on and hold; zero and home are kept"),
            false => {
                let free = free.join(", ");
                eprintln!("note: {free} without drive; zero and home are kept");
            }
        }
    }

    /// Reads words such as `goto X12 Y3 touch -z`.
    ///
    /// # Errors
    ///
    /// A message about the first action that is not understood, or that the machine cannot do.
    pub fn actions(&self, words: &[String]) -> Result<Vec<Action>, String> {
        let actions = Action::parse(words, self.scale, self.axis)?;
        for letter in letters(&actions.iter().flat_map(Action::axes).collect::<Vec<_>>()).chars() {
            self.machine.axis(letter)?;
        }
        let calibrates = |action: &Action| matches!(action, Action::Calibrate { .. });
        if self.reference.is_none() && actions.iter().any(calibrates) {
            return Err("`calibrate` needs --reference, the position of the face".into());
        }
        Ok(actions)
    }

    /// Calibrates the probe on the face of `--reference`, if it is given.
    fn calibrate_on_face(
        &mut self,
        towards: &Towards,
        measurement: &Measurement,
        head: &mut Calibrated<Head<AnyPort>>,
    ) -> Result<(), Error> {
        if let (Some(axis), Some(position)) = (towards.axis, self.reference) {
            let face = Face { axis, position };
            let over_travel = head.inner().probe().over_travel;
            self.stylus = face.calibrate(self.stylus, measurement, self.scale, over_travel)?;
        }
        Ok(())
    }

    /// Reports the status of axes, one row per axis.
    fn status(
        &self,
        axes: &[usize],
        row: &ResultRow,
        head: &mut Calibrated<Head<AnyPort>>,
        report: &mut impl FnMut(&ResultRow),
    ) -> Result<(), Error> {
        for axis in axes.iter().copied() {
            let reply: Reply = head.inner().status(axis)?;
            let (held, position) = (head.held()[axis], head.position()?);
            report(&ResultRow {
                action: "status",
                axis: letters(&[axis]),
                position: self.numbers(position, &[axis]),
                status: Some(StatusFigures {
                    held: self.scale.number(held),
                    position_error: self.scale.number(held - position[axis]),
                    current: reply.readings.current,
                    bits: names(reply.status),
                    auxiliary: auxiliary(reply.readings.auxiliary),
                    version: reply.readings.version,
                }),
                ..row.clone()
            });
        }
        Ok(())
    }

    /// Reports the positions of axes, one row per axis.
    fn axis_positions(
        &self,
        axes: &[usize],
        head: &mut Calibrated<Head<AnyPort>>,
        report: &mut impl FnMut(&ResultRow),
    ) -> Result<(), Error> {
        let has_length = self.scale.unit() == "mm";
        let (unit, divisor) = match has_length && self.is_inch {
            true => ("in", 25.4),
            false => (self.scale.unit(), 1.0),
        };
        let number = |amount| self.scale.number(amount) / divisor;
        for axis in head.axis_positions()? {
            if !axes.contains(&axis.coordinate) {
                continue;
            }
            report(&ResultRow {
                action: "where",
                axis: letters(&[axis.coordinate]),
                unit,
                position: Numbers(vec![number(axis.work)]),
                place: Some(PlaceFigures {
                    machine: axis.machine.map(number),
                    work: number(axis.work),
                    steps: axis.counts,
                    is_homed: axis.machine.is_some(),
                    has_length,
                }),
                ..ResultRow::default()
            });
        }
        Ok(())
    }

    /// Carries out the actions in turn. `report` receives each result.
    ///
    /// # Errors
    ///
    /// The first action that fails. The actions after it are not carried out.
    pub fn run(
        &mut self,
        actions: &[Action],
        head: &mut Calibrated<Head<AnyPort>>,
        mut report: impl FnMut(&ResultRow),
    ) -> Result<(), Error> {
        for action in actions.iter().copied() {
            let mut axes = action.axes();
            if axes.is_empty() {
                axes.clone_from(&self.axes);
            }
            let mut row = ResultRow {
                axis: letters(&axes),
                unit: self.scale.unit(),
                ..ResultRow::default()
            };
            match action {
                Action::Where(_) => self.axis_positions(&axes, head, &mut report)?,
                Action::Status(_) => self.status(&axes, &row, head, &mut report)?,
                _ => {
                    self.carry_out(action, &axes, head, &mut row)?;
                    row.position = self.numbers(head.position()?, &axes);
                    report(&row);
                }
            }
        }
        Ok(())
    }

    /// Carries out an action with one result.
    fn carry_out(
        &mut self,
        action: Action,
        axes: &[usize],
        head: &mut Calibrated<Head<AnyPort>>,
        row: &mut ResultRow,
    ) -> Result<(), Error> {
        match action {
            Action::GoTo(goal, approach) => {
                row.action = "goto";
                // An axis without a goal stays where it is, also after a move that has failed.
                let held = head.hold()?;
                let goal = [0, 1, 2].map(|axis| goal[axis].unwrap_or(held[axis]));
                match approach {
                    Approach::Rapid => head.go_to(goal)?,
                    Approach::Guarded => head.guarded_to(goal)?,
                };
            }
            Action::Zero(_) => {
                row.action = "zero";
                axes.iter().try_for_each(|axis| head.set_zero(*axis))?;
                self.keep(head);
            }
            Action::Home(axis) => {
                row.action = "home";
                head.home(axis)?;
                self.keep(head);
            }
            Action::Jog {
                towards,
                seconds,
                is_slow,
            } => {
                row.action = "jog";
                let is_positive = towards.text() == "+";
                head.jog(
                    towards.axis.unwrap_or_default(),
                    is_positive,
                    seconds,
                    is_slow,
                )?;
            }
            Action::Touch(towards) => {
                row.action = "touch";
                let measurement = head.measure(&towards.direction, u64::MAX)?;
                row.touch = Some(self.figures(&measurement, &towards, axes));
            }
            Action::Calibrate(towards) => {
                row.action = "calibrate";
                let measurement = head.measure(&towards.direction, u64::MAX)?;
                self.calibrate_on_face(&towards, &measurement, head)?;
                row.touch = Some(TouchFigures {
                    table: self.table(),
                    ..self.figures(&measurement, &towards, axes)
                });
            }
            Action::CalibrateOn(body) => {
                row.action = "calibrate";
                // Four times the distance that the axis moves back after a touch.
                let clearance = self
                    .scale
                    .of_counts(i64::from(head.inner().probe().back_off) * 4);
                let found = body.calibrate(head, self.stylus.radius_nm, clearance)?;
                self.stylus = found.stylus;
                row.calibration = Some(self.found(&found, body.body));
            }
            Action::Where(_) | Action::Status(_) => {}
        }
        Ok(())
    }

    /// The pre-travel by direction. `None` if it has only the directions of the axes.
    fn table(&self) -> Option<Vec<Entry>> {
        let entry = |(direction, nm): &(UnitVector, i32)| Entry {
            direction: direction
                .components()
                .map(|part| (part.to_num::<f64>() * 1e6).round() as i64),
            length: self.scale.number(i64::from(*nm)),
        };
        let entries = self.stylus.pre_travel.entries();
        (!is_by_axis(&self.stylus)).then(|| entries.iter().map(entry).collect())
    }

    fn figures(
        &self,
        measurement: &Measurement,
        towards: &Towards,
        axes: &[usize],
    ) -> TouchFigures {
        let pre_travel = self.stylus.pre_travel.along(&towards.direction);
        TouchFigures {
            direction: towards.text(),
            trigger: self.numbers(measurement.touch.position, axes),
            corrected: self.numbers(surface_nm(&self.stylus, measurement), axes),
            pre_travel: self.scale.number(pre_travel.into()),
            touches: measurement.touches,
            spread: (measurement.touches > 1).then(|| self.scale.number(measurement.spread)),
            over_travel: self.scale.number(measurement.over_travel),
            table: None,
        }
    }

    fn found(&self, found: &FoundProbe, body: Body) -> CalibrationFigures {
        let number = |amount: i64| self.scale.number(amount);
        let count = found.table.len().max(1) as i64;
        let sum: i64 = found.table.iter().map(|(_, nm)| i64::from(*nm)).sum();
        CalibrationFigures {
            body: match body {
                Body::Sphere => "sphere",
                Body::Ring => "ring",
            },
            centre: Numbers(found.centre.map(number).to_vec()),
            touches: found.residuals.points,
            form: number(found.residuals.form_nm),
            ball_radius: number(found.stylus.radius_nm.into()),
            effective_radius: number(i64::from(found.stylus.radius_nm) - sum / count),
            table: found
                .table
                .iter()
                .map(|(direction, nm)| Entry {
                    direction: *direction,
                    length: number((*nm).into()),
                })
                .collect(),
        }
    }

    /// The coordinates of these axes.
    fn numbers(&self, position: [i64; 3], axes: &[usize]) -> Numbers {
        let of = |axis: &usize| self.scale.number(position[*axis]);
        Numbers(axes.iter().map(of).collect())
    }
}

/// `XZ` of 0 and 2.
fn letters(axes: &[usize]) -> String {
    let letter = |axis: &usize| "XYZ".chars().nth(*axis);
    axes.iter().filter_map(letter).collect()
}

/// The probe of the machine, with the ball and the pre-travel of the arguments.
///
/// # Errors
///
/// A message about an argument that is not understood or does not fit.
pub fn stylus(args: &Measure, machine: &Machine) -> Result<Stylus, String> {
    let mut stylus = machine.probe.stylus;
    if let Some(amount) = amount(machine.scale, "--pretravel", args.pretravel.as_deref())? {
        let amount = i32::try_from(amount);
        let amount = amount.map_err(|_| "--pretravel: too long for a probe")?;
        stylus.pre_travel = pre_travel_by_sign([amount; 2]);
    }
    if let Some(amount) = amount(machine.scale, "--ball", args.ball.as_deref())? {
        let radius = i32::try_from(amount).ok().filter(|radius| *radius >= 0);
        stylus.radius_nm = radius.ok_or("--ball: a radius from 0 to 2 m")?;
    }
    Ok(stylus)
}

/// The length given with an option, as an amount of the scale.
fn amount(scale: Scale, option: &str, text: Option<&str>) -> Result<Option<i64>, String> {
    let Some(text) = text else { return Ok(None) };
    match scale.parse(text).map(|length| scale.amount(length)) {
        Ok(Some(amount)) => Ok(Some(amount)),
        Ok(None) => Err(format!(
            "{option} {text}: lengths of this machine are in {}",
            scale.unit()
        )),
        Err(why) => Err(format!("{option}: {why}")),
    }
}

/// Opens the port of the arguments.
///
/// # Errors
///
/// The port cannot be opened, or arguments of the simulation are given for a real port.
pub fn open(
    args: &Measure,
    machine: &Machine,
    piece: Option<Mounted>,
) -> Result<Line<AnyPort>, String> {
    let contacts: &[Contact] = &args.contact;
    let port: AnyPort = if args.port == "sim" {
        let network = SimulatedNetwork::of_machine(machine, contacts, piece)?;
        let network = network.with_ends(&args.end)?;
        Box::new(SimulatedPort::new(network.with_noise(args.noise)))
    } else if contacts.is_empty() && args.end.is_empty() && piece.is_none() && args.noise == 0.0 {
        let port = NetworkPort::open(&args.port);
        let port = port.map_err(|error| format!("{}: {error}", args.port))?;
        share(
            args.machine.as_deref().unwrap_or("cmm"),
            &args.port,
            machine.baud.bits_per_s(),
        );
        Box::new(port)
    } else {
        return Err(
            "--contact, --end, --piece and --noise are for --port sim; `husillo emulate` has these \
             options too"
                .into(),
        );
    };
    Ok(Line::new(port))
}

/// The names of the status bits that are set.
fn names(status: Status) -> Vec<&'static str> {
    let names = [
        (Status::MOVE_DONE, "move done"),
        (Status::OVERCURRENT, "over-current"),
        (Status::POWER_ON, "power on"),
        (Status::POSITION_ERROR, "position error"),
        (Status::LIMIT_1, "limit 1"),
        (Status::LIMIT_2, "limit 2"),
        (Status::HOME_IN_PROGRESS, "homing"),
    ];
    let set = names.into_iter().filter(|(bit, _)| status.contains(*bit));
    set.map(|(_, name)| name).collect()
}

/// The names of the bits of an auxiliary status that are set.
fn auxiliary(auxiliary: Auxiliary) -> Vec<&'static str> {
    let names = [
        (Auxiliary::INDEX, "index"),
        (Auxiliary::POSITION_WRAP, "position wrapped"),
        (Auxiliary::SERVO_ON, "servo on"),
        (Auxiliary::ACCELERATION_DONE, "acceleration done"),
        (Auxiliary::SLEW_DONE, "slew done"),
        (Auxiliary::SERVO_OVERRUN, "servo overrun"),
        (Auxiliary::PATH_MODE, "path mode"),
    ];
    let set = names
        .into_iter()
        .filter(|(bit, _)| auxiliary.contains(*bit));
    set.map(|(_, name)| name).collect()
}
