//! `--zero`: the position of a program on the machine.

use crate::diagnostics::{Finding, Findings, Place};
use crate::machines::machine_file::MachineFile;
use crate::programs::explain::At;
use crate::programs::program::{self, Start};
use crate::programs::source::Source;
use husillo_gcode::Nm;
use husillo_machine::{Config, MoveError, extent};
use husillo_sim::observers::AXES;
use std::io;

/// Lowest and highest coordinate of every axis.
type Extent = [Option<[Nm; 2]>; AXES];

/// The extent of a program.
#[derive(Debug, Default)]
struct Reach {
    /// Extent, from work zero, of the moves that work zero shifts: the part.
    part: Extent,
    /// Extent in machine coordinates of the moves that work zero does not shift: G53, G28 and G30,
    /// and work frames that the program sets itself.
    machine: Extent,
    /// For each axis, the first line at which the part leaves its travel, and the error.
    part_leaves: [Option<(Place, MoveError)>; AXES],
    /// The same for moves that work zero does not shift.
    machine_leaves: [Option<(Place, MoveError)>; AXES],
    /// The axis whose travel the part leaves first.
    first: usize,
    /// Whether the program has other errors, which may hide moves.
    has_errors: bool,
}

/// Work zero of the walk, in all axes. It is 17 km away, farther than any machine reaches, and well
/// within [`Nm::LIMIT`]. So the coordinates show which moves work zero shifts.
const FAR: i64 = 1 << 44;

/// Widens an extent. Returns whether it became wider.
fn widen(extent: &mut Option<[Nm; 2]>, [low, high]: [Nm; 2]) -> bool {
    let before = *extent;
    let [least, most] = before.unwrap_or([low, high]);
    let after = Some([least.min(low), most.max(high)]);
    *extent = after;
    after != before
}

impl Reach {
    /// The extent of a program whose only errors are those of travel, with work zero at `zero`.
    fn of(
        source: &mut Source,
        file: &str,
        start: Start,
        config: &Config<AXES>,
        zero: [Nm; AXES],
    ) -> io::Result<Self> {
        let mut reach = Self::default();
        let far = [Nm(FAR); AXES];
        let start = Start {
            zero: far,
            // The walk begins 1 nm from work zero, far less than a step, so that a move to work
            // zero counts.
            at: far.map(|Nm(nm)| Nm(nm + 1)),
            ..start
        };
        // The check has already reported other errors.
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

    fn add(&mut self, axis: usize, span: [Nm; 2], config: &Config<AXES>, zero: Nm, at: &At<'_>) {
        // Only the end counts: a move may begin at a machine coordinate, far from the part.
        let is_part = span[1].0 > FAR / 2;
        let span = span.map(|Nm(nm)| if is_part { Nm(nm - FAR) } else { Nm(nm) });
        let there = span.map(|Nm(nm)| if is_part { Nm(nm + zero.0) } else { Nm(nm) });
        let is_first = self.part_leaves.iter().all(Option::is_none);
        let (extent, leaves) = if is_part {
            (&mut self.part[axis], &mut self.part_leaves[axis])
        } else {
            (&mut self.machine[axis], &mut self.machine_leaves[axis])
        };
        // What is within the extent so far was compared with the travel.
        if !widen(extent, span) || leaves.is_some() {
            return;
        }
        let mut ends = there.into_iter();
        if let Some(beyond) = ends.find_map(|nm| config.check_travel(axis, nm).err()) {
            let letter = config.dialect.axes().letter(axis).unwrap_or(b'?');
            *leaves = Some((at.word(letter), beyond));
            if is_first && is_part {
                self.first = axis;
            }
        }
    }

    /// Compares the part with the travel of an axis, with work zero at `zero`.
    fn place(&self, axis: usize, zero: Nm, config: &Config<AXES>) -> InAxis {
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

/// The part compared with the travel of an axis.
enum InAxis {
    /// The travel is not known, or the part does not move the axis.
    Unknown,
    /// The part is longer than the travel.
    TooLong { length: Nm, room: Nm },
    /// The part fits after a shift by `by`, which is zero if it fits already.
    Fits {
        part: [Nm; 2],
        travel: [Nm; 2],
        by: Nm,
    },
}

/// Where on the table a part without a stated work zero lies. Its highest Z is at the top of Z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lie {
    /// The part is in the middle of the table.
    Middle,
    /// Work zero is in the middle of the table.
    ZeroInMiddle,
    /// Work zero is at the low ends of X and Y.
    ZeroAtCorner,
}

/// The position of a part.
#[derive(Debug)]
pub struct Placing {
    /// Work zero.
    pub zero: [Nm; AXES],
    /// Whether the extent of the part is known: false if the program has errors, which may hide
    /// moves. The check reports these errors.
    pub is_certain: bool,
}

/// Computes the work zero that gives a part the wanted position. An axis keeps machine zero if its
/// limits are not known, if the part does not move it, or if it is too short for the part.
///
/// # Errors
///
/// The program cannot be read.
pub fn placing(
    source: &mut Source,
    file: &str,
    start: Start,
    config: &Config<AXES>,
    lie: Lie,
) -> io::Result<Placing> {
    let reach = Reach::of(source, file, start, config, [Nm(0); AXES])?;
    let mut zero = [Nm(0); AXES];
    for (axis, zero) in zero.iter_mut().enumerate() {
        let Some([low, high]) = config.axes[axis].travel else {
            continue;
        };
        *zero = match (axis, lie) {
            (0 | 1, Lie::ZeroInMiddle) => Nm(low.0 + (high.0 - low.0) / 2),
            (0 | 1, Lie::ZeroAtCorner) => low,
            _ => match reach.part[axis] {
                Some(part) => middle(axis, part, [low, high]),
                None => continue,
            },
        };
    }
    Ok(Placing {
        zero,
        is_certain: !reach.has_errors,
    })
}

/// The zero that puts the part in the middle of the travel, or in Z at its upper end.
fn middle(axis: usize, [least, most]: [Nm; 2], [low, high]: [Nm; 2]) -> Nm {
    let room = (high.0 - low.0) - (most.0 - least.0);
    if room < 0 {
        return Nm(0);
    }
    let exact = match axis {
        2 => high.0 - most.0,
        _ => low.0 + room / 2 - least.0,
    };
    // A short number, if the part still fits with it.
    let even = exact.div_euclid(ROUND) * ROUND;
    Nm(if low.0 - least.0 <= even { even } else { exact })
}

/// A position in the middle is rounded to hundredths of a millimetre, nm.
const ROUND: i64 = 10_000;

/// Reports where a program leaves the travel. `first` is the first such move. One error is about
/// the position of the part, with a zero that corrects it. One error is about each axis in which
/// the part is too large, and one about each axis whose machine coordinates are beyond its travel.
///
/// # Errors
///
/// Reading fails.
pub fn report_beyond(
    source: &mut Source,
    file: &str,
    start: Start,
    machine: &MachineFile,
    config: &Config<AXES>,
    first: &(Place, MoveError),
    findings: &mut Findings,
) -> io::Result<()> {
    let reach = Reach::of(source, file, start, config, start.zero)?;
    let mut leaves = reach.part_leaves.iter().chain(&reach.machine_leaves);
    if leaves.all(Option::is_none) {
        // An axis that does not move is beyond its travel: the program begins at machine zero,
        // which is outside its limits.
        let (place, beyond) = first;
        let message = "an axis is beyond its soft limit while another one moves";
        let finding = Finding::error("E0401", message, place.clone());
        findings.add(placed(finding, beyond, machine));
        return Ok(());
    }
    report_machine_frame(&reach, machine, config, findings);
    report_part(&reach, start.zero, machine, config, findings);
    Ok(())
}

/// The finding of one move beyond the travel, if the rest of the program is not known.
pub fn move_beyond((place, error): &(Place, MoveError), machine: &MachineFile) -> Finding {
    let message = "the move ends beyond the travel";
    placed(
        Finding::error("E0401", message, place.clone()),
        error,
        machine,
    )
}

/// Reports the axes whose machine coordinates are beyond their travel.
fn report_machine_frame(
    reach: &Reach,
    machine: &MachineFile,
    config: &Config<AXES>,
    findings: &mut Findings,
) {
    for (axis, leaves) in reach.machine_leaves.iter().enumerate() {
        let (Some((place, beyond)), Some(extent)) = (leaves, reach.machine[axis]) else {
            continue;
        };
        let name = char::from(machine.letter(axis));
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

/// The correction of work zero, in words.
#[derive(Default)]
struct Remedy {
    /// Extent of the part in each axis in which it is beyond the travel.
    parts: Vec<String>,
    /// The travel of these axes.
    travels: Vec<String>,
    /// The smallest shifts that correct them.
    moves: Vec<String>,
    /// The corrected zero, as the user types it.
    zero: String,
}

/// Reports where the part is beyond the travel, and the zero that corrects it.
fn report_part(
    reach: &Reach,
    zero: [Nm; AXES],
    machine: &MachineFile,
    config: &Config<AXES>,
    findings: &mut Findings,
) {
    let mut remedy = Remedy::default();
    for (axis, zero) in zero.into_iter().enumerate().take(machine.axes.len()) {
        let name = char::from(machine.letter(axis));
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

/// An axis word; empty for 0.
fn worded(name: char, at: Nm) -> String {
    match at {
        Nm(0) => String::new(),
        at => format!("{name}{at}"),
    }
}

fn span([low, high]: [Nm; 2]) -> String {
    format!("{low} to {high} mm")
}

/// Adds the position that is beyond the travel, and the line of the limit in the machine file.
fn placed(finding: Finding, beyond: &MoveError, machine: &MachineFile) -> Finding {
    let MoveError::Travel {
        axis,
        position,
        limit,
    } = *beyond
    else {
        return finding;
    };
    let name = char::from(machine.letter(axis));
    let mut finding = finding.label(format!(
        "machine {name} = {position} mm; limit is {limit} mm"
    ));
    if let Some(place) = machine.travel_place(axis) {
        finding.elsewhere = Some((place, "limit set here".to_owned()));
    }
    finding
}
