//! `husillo run`: events through the motors into the simulated machine, and what it does with them.

use crate::machines::encoder_file::Push;
use crate::machines::machine_file::MachineFile;
use crate::page::drawing::{Class, Drawing, Point};
use crate::page::report::{Ideal, Motor};
use crate::programs::deviation::{Deviation, Path};
use crate::programs::setup::{self, ClosedMicromill, Micromill};
use crate::programs::speed::{Circle, Move, Speed, Stop};
use crate::programs::symmetry::Symmetry;
use husillo_gcode::{Command, Direction, Feed, Nm, SpindleDirection};
use husillo_machine::{Event, Followed, Motors, Origin, Output, Segment, StepEvent};
use husillo_sim::Rig;
use husillo_stepper::Drive;
use std::io::{self, Write};

/// Most programmed moves kept for the picture.
const MOST_IDEAL: usize = 20_000;
/// Steps of each motor in the phase diagram.
const PHASE_STEPS: usize = 24;

/// Where an axis lost its first steps.
#[derive(Clone, Copy, Debug)]
pub struct FirstLoss {
    /// Number of the step event, from 1.
    pub event: u64,
    /// Seconds from the start.
    pub time_s: f64,
    /// Position of the machine then, nm of the machine frame.
    pub at_nm: [f64; 3],
}

/// A run under way, and its results.
pub struct Run<'a> {
    machine: &'a MachineFile,
    motors: Motors<3, Drive>,
    rig: Rig<3>,
    nm_per_step: [f64; 3],
    half_step_nm: f64,
    tool: [i32; 3],
    /// Smallest and largest position of the tool in steps.
    pub low: [i32; 3],
    /// See `low`.
    pub high: [i32; 3],
    /// Step events, take-up included.
    pub events: u64,
    /// Timer ticks of everything.
    pub ticks: u64,
    /// Timer ticks of take-up.
    pub take_up_ticks: u64,
    /// Take-ups of every axis.
    pub reversals: [u64; 3],
    /// Deviation of feed moves.
    pub deviation: Deviation,
    /// Picture of the path.
    pub drawing: Drawing,
    /// The programmed moves.
    pub ideal: Vec<Ideal>,
    /// Whether `ideal` has all of them.
    pub ideal_is_whole: bool,
    /// Speed along the path.
    pub speed: Speed,
    /// Currents of the first steps.
    pub phases: [Vec<(u64, [i16; 2])>; 3],
    phases_open: bool,
    segment: Option<Segment<3>>,
    path: Path,
    target: [i32; 3],
    arrived: bool,
    /// Programmed speed of the spindle in thousandths of a turn a minute; 0 where it stands.
    milli_rpm: u64,
    origin: Origin,
    take_up_axis: Option<usize>,
    trace: Option<Box<dyn Write>>,
    /// Losses to come, those of later events last.
    pushes: Vec<Push>,
    /// Steps lost so far, and where the first of them were.
    lost: [u64; 3],
    first_losses: [Option<FirstLoss>; 3],
    /// Axes that an encoder saw behind and that have not been corrected.
    behind: [bool; 3],
    /// What the encoders told.
    pub told: Vec<String>,
    /// Sides of the work, where they are compared.
    pub symmetry: Option<Symmetry>,
}

impl std::fmt::Debug for Run<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Run")
            .field("events", &self.events)
            .finish_non_exhaustive()
    }
}

impl<'a> Run<'a> {
    /// A homed machine at rest, with the lash of its file or, worn, with that of `[simulated_lash]`; every step goes to `trace` too.
    ///
    /// # Errors
    ///
    /// A driver that has not the step mode of the machine file, or nothing of how worn it is.
    pub fn new(
        machine: &'a MachineFile,
        is_worn: bool,
        trace: Option<Box<dyn Write>>,
    ) -> Result<Self, String> {
        let motors = setup::motors(machine)?;
        let mut rig = setup::rig(machine, &motors);
        if is_worn {
            let steps = machine.axes.each_ref().map(|axis| axis.step);
            let field = machine.lash.field(steps).ok_or_else(|| {
                format!(
                    "{}: no [simulated_lash]: nobody says how worn it is",
                    machine.path
                )
            })?;
            rig = rig.with_lash_field(field);
        }
        let nm_per_step = machine
            .axes
            .each_ref()
            .map(|axis| axis.step.num as f64 / axis.step.den as f64);
        let mut run = Self {
            machine,
            rig,
            motors,
            nm_per_step,
            half_step_nm: 0.5 * nm_per_step[0],
            tool: [0; 3],
            low: [0; 3],
            high: [0; 3],
            events: 0,
            ticks: 0,
            take_up_ticks: 0,
            reversals: [0; 3],
            deviation: Deviation::default(),
            drawing: Drawing::new(),
            ideal: Vec::new(),
            ideal_is_whole: true,
            speed: Speed::new(
                machine.timer_hz,
                machine
                    .axes
                    .iter()
                    .filter_map(|axis| axis.acceleration)
                    .max(),
            ),
            phases: [const { Vec::new() }; 3],
            phases_open: true,
            segment: None,
            path: Path::line([0.0; 3], [0.0; 3]),
            target: [0; 3],
            arrived: true,
            milli_rpm: 0,
            origin: Origin::Rest,
            take_up_axis: None,
            trace,
            pushes: Vec::new(),
            lost: [0; 3],
            first_losses: [None; 3],
            behind: [false; 3],
            told: Vec::new(),
            symmetry: None,
        };
        run.phases = [0, 1, 2].map(|axis| vec![(0, run.currents(axis))]);
        if let Some(trace) = &mut run.trace {
            trace
                .write_all(b"event,t_us,x_nm,y_nm,z_nm,kind\n")
                .map_err(|error| error.to_string())?;
        }
        Ok(run)
    }

    /// The tool was brought to these steps before.
    pub fn start_at(&mut self, steps: [i32; 3]) {
        self.rig = self.rig.clone().with_tool_at(steps);
        self.tool = self.rig.tool();
        self.low = self.tool;
        self.high = self.tool;
        self.target = self.tool;
    }

    /// Motors are pushed at these events.
    pub fn set_pushes(&mut self, pushes: &[Push]) {
        self.pushes = pushes.to_vec();
    }

    /// Takes one entry of a machine with encoders, and returns where these are then.
    ///
    /// # Errors
    ///
    /// The trace cannot be written.
    pub fn followed(
        &mut self,
        machine: &ClosedMicromill,
        entry: &Followed<3>,
    ) -> io::Result<[i64; 3]> {
        let letter = |axis: usize| char::from(self.machine.axes[axis].letter);
        let after = format!("after {} step events", self.events);
        match *entry {
            Followed::Event(Event::Step(step)) if machine.is_correcting() => {
                self.apply(&step);
            }
            Followed::Event(ref event) => self.event(machine.machine(), event)?,
            Followed::Lost { axis, steps } => {
                self.behind[axis] = true;
                let letter = letter(axis);
                self.told
                    .push(format!("{letter} is {steps} steps behind, {after}"));
            }
            Followed::Corrected { axis } => {
                self.behind[axis] = false;
                let letter = letter(axis);
                self.told.push(format!("{letter} is right again, {after}"));
            }
            Followed::Stalled { axis, steps } => {
                self.behind[axis] = true;
                let letter = letter(axis);
                self.told.push(format!(
                    "{letter} is stalled, {steps} steps behind, {after}"
                ));
            }
        }
        Ok(self.counts())
    }

    /// What the encoders read, from the homed position on.
    pub fn counts(&self) -> [i64; 3] {
        let motor = self.rig.motor();
        [0, 1, 2].map(|axis| match &self.machine.axes[axis].encoder {
            None => 0,
            Some(file) => {
                let counts = i64::from(motor[axis]) * i64::from(file.encoder.counts);
                counts.div_euclid(file.encoder.steps.into())
            }
        })
    }

    /// A step of the motors.
    #[inline]
    fn apply(&mut self, step: &StepEvent<3>) {
        self.events += 1;
        self.ticks += u64::from(step.wait_ticks);
        if !self.pushes.is_empty() {
            self.push();
        }
        let rig = &mut self.rig;
        self.motors
            .step(step.wait_ticks, &step.delta, |wait_ticks, levels| {
                rig.apply(levels, wait_ticks);
            });
        self.tool = self.rig.tool();
        if self.rig.lost_steps() != self.lost {
            self.lose();
        }
    }

    /// Keeps where each axis lost its first steps.
    #[cold]
    fn lose(&mut self) {
        let lost = self.rig.lost_steps();
        let here = FirstLoss {
            event: self.events,
            time_s: self.ticks as f64 / f64::from(self.machine.timer_hz),
            at_nm: self.tool_nm(),
        };
        for ((first, before), now) in self.first_losses.iter_mut().zip(self.lost).zip(lost) {
            if before != now && first.is_none() {
                *first = Some(here);
            }
        }
        self.lost = lost;
    }

    /// The losses of this event.
    #[cold]
    fn push(&mut self) {
        let events = self.events;
        let (now, later) = self.pushes.iter().partition(|push| push.event <= events);
        self.pushes = later;
        let now: Vec<Push> = now;
        for push in now {
            self.rig.push(push.axis, push.steps);
        }
    }

    /// Takes one event of the machine.
    ///
    /// # Errors
    ///
    /// The trace cannot be written.
    #[inline]
    pub fn event(&mut self, machine: &Micromill, event: &Event<3>) -> io::Result<()> {
        match event {
            Event::Step(step) => self.step(machine, step),
            Event::Dwell { wait_ticks } => {
                self.ticks += u64::from(*wait_ticks);
                self.speed.stand(self.ticks, Stop::Dwell);
                let rig = &mut self.rig;
                // The driver sees what idling changes at the end of the rest.
                self.motors.rest(*wait_ticks, |wait_ticks, levels| {
                    rig.apply(levels, wait_ticks);
                });
                Ok(())
            }
            Event::Output(Output::Spindle {
                direction,
                milli_rpm,
            }) => {
                let is_on = *direction != SpindleDirection::Off;
                self.milli_rpm = if is_on { *milli_rpm } else { 0 };
                Ok(())
            }
            _ => Ok(()),
        }
    }

    #[inline]
    fn step(&mut self, machine: &Micromill, step: &StepEvent<3>) -> io::Result<()> {
        self.apply(step);
        let tool = self.tool;
        for ((low, high), tool) in self.low.iter_mut().zip(&mut self.high).zip(tool) {
            *low = tool.min(*low);
            *high = tool.max(*high);
        }
        let origin = machine.origin();
        let at = self.tool_nm();
        if self.arrived || origin != self.origin {
            self.turn_to(machine, origin, at);
        }
        if origin == Origin::TakeUp {
            self.speed.stand(self.ticks, Stop::TakeUp);
        } else {
            self.speed.step(self.ticks, &at);
        }
        match origin {
            Origin::Feed => {
                let squared = self.path.distance_squared(&at);
                self.deviation.add(squared);
                if let Some(symmetry) = &mut self.symmetry {
                    let sent = machine.position_steps();
                    let sent = [0, 1].map(|axis| f64::from(sent[axis]) * self.nm_per_step[axis]);
                    symmetry.add(sent, [at[0], at[1]]);
                }
                self.arrived = machine.position_steps() == self.target;
            }
            Origin::TakeUp => self.take_up(step, at),
            Origin::Rapid | Origin::Rest => self.arrived = machine.position_steps() == self.target,
        }
        if self.drawing.wants(self.flat(at)) && origin != Origin::TakeUp {
            self.drawing.add(self.point(at));
        }
        if self.phases_open {
            self.phase(step);
        }
        if self.trace.is_some() {
            self.write_trace(origin)?;
        }
        Ok(())
    }

    #[inline]
    fn tool_nm(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| f64::from(self.tool[axis]) * self.nm_per_step[axis])
    }

    /// Where the tool is, in steps.
    pub const fn tool_steps(&self) -> [i32; 3] {
        self.tool
    }

    fn point(&self, at: [f64; 3]) -> Point {
        let ideal = self.path.nearest(at);
        Point {
            tool: self.flat(at),
            ideal: self.flat(ideal),
        }
    }

    /// A point as the pictures show it.
    #[inline]
    const fn flat(&self, at: [f64; 3]) -> [f64; 2] {
        let [right, up] = self.machine.view;
        [at[right], at[up]]
    }

    /// Another move begins, or take-up does, or it ends.
    #[cold]
    fn turn_to(&mut self, machine: &Micromill, origin: Origin, at: [f64; 3]) {
        let executing = machine.executing().copied();
        if executing != self.segment {
            self.segment = executing;
            if let Some(segment) = executing {
                self.begin(machine, &segment);
            }
        }
        self.arrived = false;
        if origin != Origin::TakeUp {
            self.take_up_axis = None;
            let class = if origin == Origin::Feed {
                Class::Feed
            } else {
                Class::Rapid
            };
            if self
                .drawing
                .strokes
                .last()
                .is_none_or(|stroke| stroke.class != class)
            {
                self.drawing.begin(class, self.point(at));
            }
        }
        self.origin = origin;
    }

    fn begin(&mut self, machine: &Micromill, segment: &Segment<3>) {
        let Some(path) = Path::programmed(segment.from, &segment.command, self.half_step_nm) else {
            return;
        };
        self.path = path;
        self.speed.turn(self.pace(segment));
        let to = crate::programs::program::target(&segment.command).unwrap_or(segment.from);
        for (axis, target) in self.target.iter_mut().enumerate() {
            *target = machine.config().axes[axis]
                .scale
                .nearest(to[axis].0)
                .unwrap_or(0);
        }
        self.keep_ideal(segment, to);
    }

    /// Speed and curve of the move in `path`.
    fn pace(&self, segment: &Segment<3>) -> Move {
        let circle = match &self.path {
            Path::Arc(arc) => Some(Circle {
                plane: arc.plane,
                radius: 0.5 * (arc.radii[0] + arc.radii[1]),
            }),
            Path::Line { .. } => None,
        };
        let by_turns = |lead: Nm| lead.0 as f64 * self.milli_rpm as f64 / 60e3;
        let programmed = match &segment.command {
            Command::Thread { lead, .. } => Some(by_turns(*lead)),
            Command::Linear { feed, .. } | Command::Arc { feed, .. } => Some(match *feed {
                Feed::PerMinute(rate) => rate.0 as f64 / 60.0,
                Feed::InverseTime { micro_per_minute } => {
                    self.path.length() * micro_per_minute as f64 / 60e6
                }
                Feed::PerRevolution(lead) => by_turns(lead),
            }),
            _ => None,
        };
        Move { circle, programmed }
    }

    fn keep_ideal(&mut self, segment: &Segment<3>, to: [Nm; 3]) {
        if self.ideal.len() >= MOST_IDEAL {
            self.ideal_is_whole = false;
            return;
        }
        let flat = |p: [Nm; 3]| self.flat(p.map(|Nm(nm)| nm as f64));
        let (from, to) = (flat(segment.from), flat(to));
        let [right, up] = self.machine.view;
        let is_seen_flat = |axes: [usize; 2]| axes == [right, up] || axes == [up, right];
        match &segment.command {
            Command::Linear { .. } | Command::Thread { .. } => {
                self.ideal.push(Ideal::Line(from, to));
            }
            Command::Arc { arc, .. } if is_seen_flat(arc.plane.axes()) => {
                let whole = arc.turns > 0 || from == to;
                let end = if whole { from } else { to };
                let counter_clockwise = arc.direction == Direction::CounterClockwise;
                // From behind, it turns the other way.
                let from_behind = arc.plane.axes() != self.machine.view;
                let seen = counter_clockwise != from_behind;
                let arc = Ideal::Arc(from, end, flat(arc.centre), seen);
                self.ideal.push(arc);
            }
            // Seen from the side: the points of the drawing show it.
            Command::Arc { .. } => self.ideal_is_whole = false,
            _ => {}
        }
    }

    fn take_up(&mut self, step: &StepEvent<3>, at: [f64; 3]) {
        self.take_up_ticks += u64::from(step.wait_ticks);
        let axis = step.delta.iter().position(|delta| *delta != 0);
        if axis != self.take_up_axis {
            self.take_up_axis = axis;
            if let Some(count) = axis.and_then(|axis| self.reversals.get_mut(axis)) {
                *count += 1;
            }
            self.drawing.take_up(self.flat(at));
        }
    }

    fn currents(&self, axis: usize) -> [i16; 2] {
        let levels = self.motors.levels()[axis];
        match setup::driver(self.machine.axes[axis].driver) {
            Some(driver) => driver.currents(levels),
            // Step and direction, drawn as two rows of levels.
            None => [0, 1].map(|bit| if levels.is_high(bit) { 1000 } else { 0 }),
        }
    }

    #[cold]
    fn phase(&mut self, step: &StepEvent<3>) {
        let micros = self.ticks.saturating_mul(1_000_000) / u64::from(self.machine.timer_hz);
        for axis in 0..3 {
            if step.delta[axis] != 0 && self.phases[axis].len() <= PHASE_STEPS {
                let currents = self.currents(axis);
                if let [first] = self.phases[axis].as_mut_slice() {
                    first.0 = micros.saturating_sub(
                        u64::from(step.wait_ticks) * 1_000_000 / u64::from(self.machine.timer_hz),
                    );
                }
                self.phases[axis].push((micros, currents));
            }
        }
        // Motors that never turn must not keep this going for ever.
        self.phases_open =
            self.events < 100_000 && self.phases.iter().any(|phases| phases.len() <= PHASE_STEPS);
    }

    #[cold]
    fn write_trace(&mut self, origin: Origin) -> io::Result<()> {
        let micros = u128::from(self.ticks) * 1_000_000 / u128::from(self.machine.timer_hz);
        let at = self.tool_nm().map(|nm| nm.round() as i64);
        let kind = match origin {
            Origin::TakeUp => "take-up",
            Origin::Rapid => "rapid",
            Origin::Feed => "feed",
            Origin::Rest => "rest",
        };
        match &mut self.trace {
            Some(trace) => writeln!(
                trace,
                "{},{micros},{},{},{},{kind}",
                self.events, at[0], at[1], at[2]
            ),
            None => Ok(()),
        }
    }

    /// Steps the motors did not follow.
    pub fn lost_steps(&self) -> [u64; 3] {
        self.rig.lost_steps()
    }

    /// Where each axis lost its first steps.
    pub fn first_losses(&self) -> [Option<FirstLoss>; 3] {
        self.first_losses
    }

    /// Axes that are behind by what they lost, as their encoders have it.
    pub const fn behind(&self) -> [bool; 3] {
        self.behind
    }

    /// Writes what is left of the trace.
    ///
    /// # Errors
    ///
    /// The trace cannot be written.
    pub fn finish(&mut self) -> io::Result<()> {
        self.speed.rest();
        self.trace.as_mut().map_or(Ok(()), |trace| trace.flush())
    }

    /// The motors' first steps for the report.
    pub fn motors(&mut self) -> Vec<Motor> {
        let phases = std::mem::take(&mut self.phases);
        self.machine
            .axes
            .iter()
            .zip(phases)
            .map(|(axis, steps)| {
                let coils = setup::driver(axis.driver).is_some();
                Motor {
                    letter: char::from(axis.letter),
                    driver: format!("{:?}, {:?}", axis.driver, axis.mode).to_lowercase(),
                    rows: if coils {
                        ["coil A", "coil B"]
                    } else {
                        ["STEP", "DIR"]
                    },
                    steps,
                }
            })
            .collect()
    }
}

#[cfg(test)]
mod tests;
