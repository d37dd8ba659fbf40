//! `husillo check`: checks a program before anything moves.

use crate::diagnostics::{Finding, Findings, Place, Severity};
use crate::machines::machine_file::{MachineFile, Travel};
use crate::programs::explain::At;
use crate::programs::origins::Origins;
use crate::programs::program::{self, Meaning, Start};
use crate::programs::reversals::Turns;
use crate::programs::setup;
use crate::programs::source::Source;
use husillo_gcode::{Arc, Axes, Command, Feed, Nm};
use husillo_machine::{Config, MoveError};
use husillo_sim::geometry::nurbs::{NurbsPath, NurbsPoints};
use husillo_sim::geometry::path::Path;
use husillo_sim::observers::AXES;
use husillo_sim::text::counted;
use husillo_sim::text::duration;
use husillo_sim::text::length;
use husillo_sim::text::shortest;
use std::io;

/// The figures of a checked program.
#[derive(Debug)]
pub struct Facts {
    /// Length of all feed moves in nm.
    pub feed_nm: f64,
    /// Length of all rapid moves in nm.
    pub rapid_nm: f64,
    /// Approximate number of step events.
    pub events: f64,
    /// Reversals of each axis. A first motion in negative direction counts as one.
    pub reversals: [u64; AXES],
    /// The curves of several commands (G5.2, G5.3), in the order in which they are made.
    pub curves: Vec<NurbsPath>,
    /// The first move that leaves the travel of an axis. It is input of
    /// [`crate::programs::zero::report_beyond`].
    pub beyond: Option<(Place, MoveError)>,
    /// The lines of the moves.
    pub origins: Origins,
}

/// How much of a program is checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All of it.
    Whole,
    /// Up to the first move that leaves the travel of an axis. The figures end there.
    WithinTravel,
}

/// Checks the commands of a program one after the other: findings that are reported once per
/// program, and sums over its moves.
#[derive(Debug)]
pub struct Checker<'a> {
    machine: &'a MachineFile,
    config: &'a Config<AXES>,
    /// The checks of the engine, made for each command.
    checks: husillo_machine::Checker,
    turns: Turns,
    unknown_travel: [bool; AXES],
    three_axes: bool,
    warned_feed: Option<Nm>,
    feed_nm: f64,
    rapid_nm: f64,
    events: f64,
    points: NurbsPoints,
    curves: Vec<NurbsPath>,
    beyond: Option<(Place, MoveError)>,
}

/// Checks one program, or a part of it, against a machine. `findings` gets every finding, except
/// those about travel, which need a second reading.
///
/// # Errors
///
/// Reading or writing fails.
pub fn check(
    source: &mut Source,
    file: &str,
    start: Start,
    machine: &MachineFile,
    config: &Config<AXES>,
    part: Part,
    findings: &mut Findings,
) -> io::Result<Facts> {
    let mut checker = Checker::new(machine, config);
    let mut is_empty = true;
    let mut origins = Origins::default();
    program::walk(
        source,
        file,
        start,
        findings,
        |meaning, command, from, findings| {
            is_empty = false;
            origins.add(file, &meaning.at, command);
            checker.command(meaning, command, from, findings);
            if part == Part::WithinTravel && checker.beyond.is_some() {
                findings.end();
            }
            Ok(())
        },
    )?;
    if is_empty && findings.errors == 0 {
        let message = "no command in the program".to_string();
        let note = "nothing would move: the program is empty, has only comments, or is cut off"
            .to_string();
        findings.add(Finding::general(Severity::Warning, "W0602", message).note(note));
    }
    if let Some(finding) = checker.reversals() {
        findings.add(finding);
    }
    Ok(Facts {
        feed_nm: checker.feed_nm,
        rapid_nm: checker.rapid_nm,
        events: checker.events,
        reversals: checker.turns.reversals(),
        curves: checker.curves,
        beyond: checker.beyond,
        origins,
    })
}

impl<'a> Checker<'a> {
    /// Starts before the first command.
    pub fn new(machine: &'a MachineFile, config: &'a Config<AXES>) -> Self {
        Self {
            machine,
            config,
            checks: husillo_machine::Checker::new(),
            turns: Turns::new(
                // `run` reports a backlash that is out of range.
                setup::maps(machine).unwrap_or_else(|_| setup::no_backlash()),
                machine.each(1.0, |axis| axis.step.num as f64 / axis.step.den as f64),
            ),
            unknown_travel: [false; AXES],
            three_axes: false,
            warned_feed: None,
            feed_nm: 0.0,
            rapid_nm: 0.0,
            events: 0.0,
            points: NurbsPoints::default(),
            curves: Vec::new(),
            beyond: None,
        }
    }

    /// Returns the first move that leaves the travel, once.
    pub const fn take_beyond(&mut self) -> Option<(Place, MoveError)> {
        self.beyond.take()
    }
}

impl Checker<'_> {
    /// Checks a command that begins at `from`.
    pub fn command(
        &mut self,
        meaning: &Meaning<'_>,
        command: &Command<AXES>,
        from: [Nm; AXES],
        findings: &mut Findings,
    ) {
        let end = command.end();
        match self.checks.check(self.config, &from, command) {
            Ok(()) => {}
            // All moves beyond the travel may have the same cause. So they are reported together,
            // later.
            Err(error @ MoveError::Travel { axis, .. }) => {
                if self.beyond.is_none() {
                    let letter = self.machine.letter(axis);
                    self.beyond = Some((meaning.at.word(letter), error));
                }
            }
            Err(error) => findings.add(self.limit(&error, &meaning.at, command)),
        }
        let curve = self.points.take(&from, command);
        let Some(to) = end else {
            return;
        };
        let axes = self.machine.axes.len();
        let mut moves = [false; AXES];
        for (axis, moved) in moves.iter_mut().enumerate().take(axes) {
            *moved = from[axis] != to[axis];
            if *moved
                && self.machine.axes[axis].travel == Travel::Unknown
                && !self.unknown_travel[axis]
            {
                self.unknown_travel[axis] = true;
                findings.add(self.travel_unknown(axis, &meaning.at));
            }
        }
        let count = moves.iter().filter(|moved| **moved).count();
        if count > self.machine.simultaneous_axes as usize && !self.three_axes {
            self.three_axes = true;
            findings.add(self.too_many_axes(&meaning.at, count));
        }
        let length = match command {
            Command::Arc { arc, .. } => {
                self.arc(arc, &meaning.at, findings);
                self.turns.arc(from, arc);
                arc_length(from, arc)
            }
            Command::Spline { .. } => {
                self.turns.line(from, to);
                Path::programmed(from, command, 0.0).map_or(0.0, |path| path.length())
            }
            Command::NurbsEnd { .. } => {
                self.turns.line(from, to);
                curve.as_ref().map_or(0.0, NurbsPath::length)
            }
            _ => {
                self.turns.line(from, to);
                fed_length(command, from, self.config.dialect.axes())
            }
        };
        self.curves.extend(curve);
        self.events += length / self.step_nm();
        match command {
            Command::Rapid { .. } => self.rapid_nm += length,
            Command::Thread { .. } | Command::NurbsEnd { .. } => self.feed_nm += length,
            Command::Linear { feed, .. }
            | Command::Probe { feed, .. }
            | Command::Spline { feed, .. }
            | Command::Arc { feed, .. } => {
                self.feed_nm += length;
                self.feed(feed, command, from, to, length, &meaning.at, findings);
            }
            _ => {}
        }
    }

    fn step_nm(&self) -> f64 {
        let step = self.machine.axes[0].step;
        step.num as f64 / step.den as f64
    }

    fn limit(&self, error: &MoveError, at: &At<'_>, command: &Command<AXES>) -> Finding {
        let letter = |axis: usize| self.machine.letter(axis);
        match *error {
            MoveError::Reach { axis } => {
                let name = char::from(letter(axis));
                let most = i64::from(i32::MAX) as f64 * self.step_nm() / 1e6;
                Finding::error(
                    "E0103",
                    format!("number too large for axis {name}"),
                    at.word(letter(axis)),
                )
                .label(format!("largest magnitude is {most:.3} mm (i32 steps)"))
                .note("grbl keeps the first 8 digits and drops the rest without an error")
            }
            MoveError::ArcTolerance {
                mismatch,
                tolerance,
            } => {
                let message = format!(
                    "the end point is not on the arc: radius differs by {}",
                    length(mismatch.0 as f64)
                );
                Finding::error("E0302", message, at.whole())
                    .label("start and end have different distances from the centre")
                    .note(format!(
                        "the rule of {}: an error from {} (`motion.arc_tolerance`)",
                        self.machine.name,
                        length(tolerance.0 as f64)
                    ))
                    .help("check the centre words; a larger `motion.arc_tolerance` takes the arc")
            }
            MoveError::Unsupported(means) => {
                let name = means.name();
                let message = format!("{} has no means for {name}", self.machine.name);
                Finding::error("E0404", message, at.whole())
                    .label("understood, but this machine cannot do it")
                    .note("`husillo commands` prints its meaning")
                    .help(
                        "choose a machine that has it, or add it to the machine file: \
                         `husillo machines write`",
                    )
            }
            _ => {
                let code = if matches!(command, Command::Arc { .. }) {
                    "E0307"
                } else {
                    "E0103"
                };
                Finding::error(code, error.to_string(), at.whole())
            }
        }
    }

    fn travel_unknown(&self, axis: usize, at: &At<'_>) -> Finding {
        let letter = self.machine.axes[axis].letter;
        let name = char::from(letter);
        let message = format!("the travel of {name} is unknown: its limits are not checked");
        let mut finding = Finding::warning("W0402", message, at.word(letter))
            .label("moves here for the first time");
        if let Some(place) = self.machine.travel_place(axis) {
            finding.elsewhere = Some((place, "declared here".to_owned()));
        }
        finding
    }

    fn too_many_axes(&self, at: &At<'_>, count: usize) -> Finding {
        let most = self.machine.simultaneous_axes;
        let message = format!(
            "{count} axes move at once; {} was built for {most}",
            self.machine.name
        );
        Finding::warning("W0403", message, at.whole())
            .label("the move is made as programmed")
            .note("reported once for the whole program")
    }

    fn arc(&self, arc: &Arc<AXES>, at: &At<'_>, findings: &mut Findings) {
        let [a, _] = arc.plane.axes();
        let step = self.machine.axes[a].step;
        let mismatch = i128::from(arc.mismatch.0);
        // No finding up to 2 steps, or 1.5 units of the last printed digit, compared without
        // rounding.
        let silent = mismatch * i128::from(step.den) <= 2 * i128::from(step.num)
            || 2 * mismatch <= 3 * i128::from(arc.resolution.0);
        if silent {
            return;
        }
        // Rounded to nearest: 559 nm are 4 steps of 140 nm.
        let steps = (2 * mismatch * i128::from(step.den) / i128::from(step.num) + 1) / 2;
        let message = format!(
            "the end point is not on the arc: radius differs by {} ({})",
            length(arc.mismatch.0 as f64),
            counted(steps, "step")
        );
        let end = at
            .find(|letter| matches!(letter, b'X' | b'Y' | b'Z'))
            .map_or(at.whole(), |span| at.place(span));
        let finding = Finding::warning("W0302", message, end)
            .label("start and end have different distances from the centre")
            .note("the path passes both ends: on a circle with another centre, or on a spiral")
            .note(format!(
                "no warning up to 2 steps ({}) or 1.5 units of the last digit; \
                 `motion.arc_tolerance` sets the limit",
                length(2.0 * step.num as f64 / step.den as f64)
            ));
        findings.add(finding);
    }

    #[allow(clippy::too_many_arguments)]
    fn feed(
        &mut self,
        feed: &Feed,
        command: &Command<AXES>,
        from: [Nm; AXES],
        to: [Nm; AXES],
        length: f64,
        at: &At<'_>,
        findings: &mut Findings,
    ) {
        let Feed::PerMinute(rate) = *feed else {
            return;
        };
        if self.warned_feed == Some(rate) || length <= 0.0 {
            return;
        }
        // The path speed at which the first axis is at its limit.
        let mut reached = self
            .machine
            .top_feed
            .map_or(f64::INFINITY, |top| top as f64);
        for (axis, facts) in self.config.axes.iter().enumerate() {
            let share = match command {
                Command::Arc { arc, .. } if arc.plane.axes().contains(&axis) => 1.0,
                _ => from[axis].0.abs_diff(to[axis].0) as f64 / length,
            };
            if share > 0.0 {
                reached = reached.min(facts.max_feed_nm_per_min() as f64 / share);
            }
        }
        if rate.0 as f64 <= reached * 1.000_001 {
            return;
        }
        self.warned_feed = Some(rate);
        let message = format!(
            "feed {} mm/min is above the limit of the axes here",
            shortest(rate.0 as f64 / 1e6, 3)
        );
        let finding = Finding::warning("W0503", message, at.word(b'F'))
            .label(format!(
                "this move is made at {} mm/min",
                shortest(reached / 1e6, 3)
            ))
            .note("reported once for each feed rate; grbl and LinuxCNC limit it silently");
        findings.add(finding);
    }

    fn reversals(&self) -> Option<Finding> {
        let mut seconds = 0.0;
        let mut parts = Vec::new();
        let mut reversals = 0;
        let turns = self
            .turns
            .reversals()
            .into_iter()
            .zip(self.turns.taken_up());
        for (axis, (count, taken_up)) in self.machine.axes.iter().zip(turns) {
            if taken_up.steps > 0 {
                let all = taken_up.steps as f64 / f64::from(axis.max_rate);
                seconds += all;
                reversals += count;
                let step_nm = axis.step.num as f64 / axis.step.den as f64;
                let [least, most] =
                    [taken_up.least, taken_up.most].map(|steps| length(step_nm * f64::from(steps)));
                let by_place = if least == most {
                    least
                } else {
                    format!("{least} to {most} by position")
                };
                parts.push(format!(
                    "{count} on {} at {:.2} s ({by_place})",
                    char::from(axis.letter),
                    all / count as f64,
                ));
            }
        }
        if reversals == 0 {
            return None;
        }
        let plural = if reversals == 1 { "s" } else { "" };
        let message = format!(
            "{} cost{plural} {} of backlash take-up",
            counted(reversals, "direction reversal"),
            duration(seconds)
        );
        let note = format!("{}; mirroring the part may save some", parts.join(" and "));
        Some(Finding::general(Severity::Warning, "W0601", message).note(note))
    }
}

/// Length of a move along the axes to which its feed applies, in nm or millionths of a degree; see
/// [`Axes::fed`].
pub fn fed_length(command: &Command<AXES>, from: [Nm; AXES], axes: &Axes) -> f64 {
    if let Command::Arc { arc, .. } = command {
        return arc_length(from, arc);
    }
    let to = command.end().unwrap_or(from);
    let ways: [u64; AXES] = std::array::from_fn(|axis| to[axis].0.abs_diff(from[axis].0));
    let fed = axes.fed(&ways);
    let squares = ways
        .iter()
        .enumerate()
        .map(|(axis, way)| match fed >> axis & 1 {
            0 => 0.0,
            _ => (*way as f64).powi(2),
        });
    squares.sum::<f64>().sqrt()
}

/// Length of an arc in nm.
pub fn arc_length(from: [Nm; AXES], arc: &Arc<AXES>) -> f64 {
    Path::programmed(
        from,
        &Command::Arc {
            arc: *arc,
            feed: Feed::PerMinute(Nm(1)),
        },
        0.0,
    )
    .map_or(0.0, |path| path.length())
}
