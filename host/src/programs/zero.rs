//! Where on the machine a program lies: `--zero`.

use crate::diagnostics::{Finding, Findings, Place};
use crate::machines::machine_file::MachineFile;
use crate::programs::explain::At;
use crate::programs::program::{self, Start};
use crate::programs::source::Source;
use husillo_gcode::{Dialect, Nm};
use husillo_machine::{Config, MoveError, extent};
use std::io;

/// Lowest and highest coordinate of every axis.
type Extent = [Option<[Nm; 2]>; 3];

/// How far a program reaches.
#[derive(Debug, Default)]
struct Reach {
    /// From work zero, in each axis that moves with it.
    part: Extent,
    /// Machine coordinates of moves that do not: G53, G28 and G30, work frames that the program
    /// sets itself.
    machine: Extent,
    /// Where the part first leaves the travel of each axis, and by what.
    part_leaves: [Option<(Place, MoveError)>; 3],
    /// The same of moves that work zero does not shift.
    machine_leaves: [Option<(Place, MoveError)>; 3],
    /// The axis whose travel the part leaves first of all.
    first: usize,
    /// Something else is wrong with the program: what is behind it was not seen.
    has_errors: bool,
}

/// Where the program is walked to tell what moves with work zero from what does not: 17 km off,
/// farther than any machine reaches, and well within [`Nm::LIMIT`].
const FAR: i64 = 1 << 44;

fn widen(extent: &mut Option<[Nm; 2]>, [low, high]: [Nm; 2]) {
    let [least, most] = extent.unwrap_or([low, high]);
    *extent = Some([least.min(low), most.max(high)]);
}

impl Reach {
    /// Of a program without errors other than those of travel, with work zero at `zero`.
    fn of(
        source: &mut Source,
        file: &str,
        dialect: Dialect,
        config: &Config<3>,
        zero: [Nm; 3],
    ) -> io::Result<Self> {
        let mut reach = Self::default();
        let far = [Nm(FAR); 3];
        let start = Start {
            dialect,
            zero: far,
            // Beside work zero, so that a move to it is seen; it is far less than a step.
            at: far.map(|Nm(nm)| Nm(nm + 1)),
        };
        // What is wrong with the program was reported when it was checked.
        let mut found = Findings::new(0);
        program::walk(
            source,
            file,
            start,
            &mut found,
            |meaning, command, from, _| {
                for (axis, span) in extent(&from, command).into_iter().enumerate() {
                    if let Some(span) = span {
                        reach.add(axis, span, config, zero[axis], &meaning.at);
                    }
                }
                Ok(())
            },
        )?;
        reach.has_errors = found.errors > 0;
        Ok(reach)
    }

    fn add(&mut self, axis: usize, span: [Nm; 2], config: &Config<3>, zero: Nm, at: &At<'_>) {
        // The end tells: a way from a machine coordinate begins far from the part.
        let is_part = span[1].0 > FAR / 2;
        let span = span.map(|Nm(nm)| if is_part { Nm(nm - FAR) } else { Nm(nm) });
        let there = span.map(|Nm(nm)| if is_part { Nm(nm + zero.0) } else { Nm(nm) });
        let beyond = there
            .into_iter()
            .find_map(|nm| config.check_travel(axis, nm).err());
        let is_first = self.part_leaves.iter().all(Option::is_none);
        let (extent, leaves) = if is_part {
            (&mut self.part[axis], &mut self.part_leaves[axis])
        } else {
            (&mut self.machine[axis], &mut self.machine_leaves[axis])
        };
        widen(extent, span);
        if let Some(beyond) = beyond.filter(|_| leaves.is_none()) {
            let letter = *b"XYZ".get(axis).unwrap_or(&b'?');
            *leaves = Some((at.word(letter), beyond));
            if is_first && is_part {
                self.first = axis;
            }
        }
    }

    /// Where the part is in an axis, with work zero at `zero`.
    fn place(&self, axis: usize, zero: Nm, config: &Config<3>) -> InAxis {
        let (Some(travel @ [low, high]), Some(part)) = (config.axes[axis].travel, self.part[axis])
        else {
            return InAxis::Unknown;
        };
        let part = part.map(|at| Nm(at.0 + zero.0));
        let [least, most] = part;
        let mut ends = part.into_iter();
        let is_beyond = ends.any(|at| config.check_travel(axis, at).is_err());
        let [length, room] = [most.0 - least.0, high.0 - low.0].map(Nm);
        if is_beyond && length.0 > room.0 {
            return InAxis::TooLong { length, room };
        }
        let by = match (least.0 < low.0, most.0 > high.0) {
            _ if !is_beyond => 0,
            (true, _) => low.0 - least.0,
            (false, _) => high.0 - most.0,
        };
        InAxis::Fits {
            part,
            travel,
            by: Nm(by),
        }
    }
}

/// Where the part is in an axis, against its travel.
enum InAxis {
    /// Nothing to compare.
    Unknown,
    /// Longer than the travel.
    TooLong { length: Nm, room: Nm },
    /// Within it after a move, which is zero where it fits as it is.
    Fits {
        part: [Nm; 2],
        travel: [Nm; 2],
        by: Nm,
    },
}

/// Work zero where the part fits: X and Y in the middle of the table, its highest Z at the upper
/// end of Z. An axis without known limits keeps machine zero, and so does one that the part does
/// not move or is too small for it. `None` where the program has errors: nobody knows where its
/// part is, and the check tells them.
///
/// # Errors
///
/// The program cannot be read.
pub fn fitting(
    source: &mut Source,
    file: &str,
    dialect: Dialect,
    config: &Config<3>,
) -> io::Result<Option<[Nm; 3]>> {
    let reach = Reach::of(source, file, dialect, config, [Nm(0); 3])?;
    if reach.has_errors {
        return Ok(None);
    }
    let mut zero = [Nm(0); 3];
    for (axis, zero) in zero.iter_mut().enumerate() {
        let (Some([least, most]), Some([low, high])) = (reach.part[axis], config.axes[axis].travel)
        else {
            continue;
        };
        let room = (high.0 - low.0) - (most.0 - least.0);
        if room < 0 {
            continue;
        }
        let exact = match axis {
            2 => high.0 - most.0,
            _ => low.0 + room / 2 - least.0,
        };
        // A number that can be typed, where there is room for it.
        let even = exact.div_euclid(ROUND) * ROUND;
        *zero = Nm(if low.0 - least.0 <= even { even } else { exact });
    }
    Ok(Some(zero))
}

/// `fit` gives hundredths of a millimetre.
const ROUND: i64 = 10_000;

/// Reports where a program leaves the machine, as it does `first`: one error for the place of the
/// part, with the zero that cures it; one for each axis in which it is too large; one for each axis
/// whose machine coordinates are beyond.
///
/// # Errors
///
/// Reading fails.
pub fn report_beyond(
    source: &mut Source,
    file: &str,
    start: Start,
    machine: &MachineFile,
    config: &Config<3>,
    first: &(Place, MoveError),
    findings: &mut Findings,
) -> io::Result<()> {
    let reach = Reach::of(source, file, start.dialect, config, start.zero)?;
    let mut leaves = reach.part_leaves.iter().chain(&reach.machine_leaves);
    if leaves.all(Option::is_none) {
        // What does not move is there: machine zero is beyond a limit, and the program begins at
        // it.
        let (place, beyond) = first;
        let message = "an axis stands beyond its soft limit while another one moves";
        let finding = Finding::error("E0401", message, place.clone());
        findings.add(placed(finding, beyond, machine));
        return Ok(());
    }
    report_machine_frame(&reach, machine, config, findings);
    report_part(&reach, start.zero, machine, config, findings);
    Ok(())
}

/// Reports the axes whose machine coordinates are beyond.
fn report_machine_frame(
    reach: &Reach,
    machine: &MachineFile,
    config: &Config<3>,
    findings: &mut Findings,
) {
    for (axis, leaves) in reach.machine_leaves.iter().enumerate() {
        let (Some((place, beyond)), Some(extent)) = (leaves, reach.machine[axis]) else {
            continue;
        };
        let name = char::from(machine.axes[axis].letter);
        let message = format!(
            "machine coordinates of {name} reach {}, and {} has {}",
            span(extent),
            machine.name,
            config.axes[axis].travel.map_or_else(String::new, span)
        );
        let finding = Finding::error("E0401", message, place.clone()).note(
            "G53, G28 and G30, or a work frame that the program sets: --zero does not move it",
        );
        findings.add(placed(finding, beyond, machine));
    }
}

/// What the place of the part asks for.
#[derive(Default)]
struct Remedy {
    /// Where the part is beyond, axis by axis.
    parts: Vec<String>,
    /// The travel of these axes.
    travels: Vec<String>,
    /// By how much they must move at least.
    moves: Vec<String>,
    /// The zero that does it, as it is typed.
    zero: String,
}

/// Reports where the part is beyond, and the zero with which it is not.
fn report_part(
    reach: &Reach,
    zero: [Nm; 3],
    machine: &MachineFile,
    config: &Config<3>,
    findings: &mut Findings,
) {
    let mut remedy = Remedy::default();
    for (axis, zero) in zero.into_iter().enumerate() {
        let name = char::from(machine.axes[axis].letter);
        match reach.place(axis, zero, config) {
            InAxis::Unknown => remedy.zero += &worded(name, zero),
            InAxis::TooLong { length, room } => {
                let machine_name = &machine.name;
                let message = format!(
                    "the part is {length} mm long in {name}, and {machine_name} has {room} mm: \
                     it does not fit"
                );
                if let Some((place, beyond)) = &reach.part_leaves[axis] {
                    let finding = Finding::error("E0401", message, place.clone());
                    findings.add(placed(finding, beyond, machine));
                }
            }
            InAxis::Fits { part, travel, by } => {
                remedy.zero += &worded(name, Nm(zero.0 + by.0));
                if by != Nm(0) {
                    remedy.parts.push(format!("{name} {}", span(part)));
                    remedy.travels.push(format!("{name} {}", span(travel)));
                    remedy.moves.push(format!("{name} {by}"));
                }
            }
        }
    }
    let Some((place, beyond)) = reach.part_leaves[reach.first].as_ref() else {
        return;
    };
    if remedy.parts.is_empty() {
        return;
    }
    let message = format!(
        "the part reaches {}, and {} {}: move zero by at least {}",
        remedy.parts.join(", "),
        machine.name,
        remedy.travels.join(", "),
        remedy.moves.join(", ")
    );
    let cure = remedy.zero;
    let help = format!("`--zero {cure}` puts it there, `--zero fit` in the middle of the table");
    let finding = Finding::error("E0401", message, place.clone())
        .help(help)
        .note("grbl would start the job and stop here with `ALARM:2`");
    findings.add(placed(finding, beyond, machine));
}

/// An axis word; nothing for 0.
fn worded(name: char, at: Nm) -> String {
    match at {
        Nm(0) => String::new(),
        at => format!("{name}{at}"),
    }
}

fn span([low, high]: [Nm; 2]) -> String {
    format!("{low} to {high} mm")
}

/// What is beyond at the place of a finding, and where the limit stands.
fn placed(finding: Finding, beyond: &MoveError, machine: &MachineFile) -> Finding {
    let MoveError::Travel {
        axis,
        position,
        limit,
    } = *beyond
    else {
        return finding;
    };
    let name = char::from(machine.axes[axis.min(2)].letter);
    let mut finding = finding.label(format!(
        "machine {name} = {position} mm; limit is {limit} mm"
    ));
    if let Some(place) = machine.travel_place(axis) {
        finding.elsewhere = Some((place, "limit set here".to_owned()));
    }
    finding
}
