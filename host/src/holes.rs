//! Drill files: options, findings and lists of what `husillo_holes` reads.

pub mod drill_records;
pub mod made;
mod options;

use husillo_excellon::Slot;
use husillo_gcode::Nm;
use husillo_holes::{Board, Fit, SlotError};
use husillo_sim::text::counted;
use husillo_simulator::diagnostics::{Finding, Findings, Severity};
use husillo_simulator::machines::machine_file::{MachineFile, Travel};

pub use husillo_simulator::holes::{is_drill_file, listing};
pub use options::{Options, length, work};

/// Reads a drill file; `findings` gets all errors, warnings and reasons.
pub fn read(text: &[u8], file: &str, options: &Options, findings: &mut Findings) -> Board {
    husillo_simulator::holes::read(text, file, &options.setup, findings)
}

/// Keeps the requested tools, and places the board. Returns the fit to the measured holes.
///
/// # Errors
///
/// A tool without holes and slots, or a position that is out of reach.
pub fn apply(board: &mut Board, options: &Options) -> Result<Option<Fit>, String> {
    if !options.only.is_empty() {
        board
            .keep_only(&options.only)
            .map_err(|tool| format!("--only {tool}: the file makes nothing with that tool"))?;
    }
    let fit = options.placement.apply(board);
    fit.map_err(|error| options::explained(&error))
}

/// Why the slots of a board cannot be cut, with the option that mends it.
pub fn uncut(error: &SlotError) -> String {
    let option = match error {
        SlotError::Refused(_) => "see --slots rout and --slots drill",
        SlotError::NoDiameter => "see --tool",
        SlotError::Curved | SlotError::CannotRout => "see --slots rout",
    };
    format!("{error}: {option}")
}

/// Reports what is beyond the travel of a machine whose zero is that of the file.
pub fn check_travel(board: &Board, file: &str, machine: &MachineFile, findings: &mut Findings) {
    let Some([low, high]) = board.extent() else {
        return;
    };
    for (axis, name) in ["X", "Y"].into_iter().enumerate() {
        let Travel::Range([from, to]) = machine.axes[axis].travel else {
            continue;
        };
        let is_off = |at_nm: &[i64; 2]| !(from..=to).contains(&at_nm[axis]);
        let holes = board
            .holes
            .iter()
            .filter(|hole| is_off(&hole.at_nm))
            .count();
        let ends = |slot: &&Slot| is_off(&slot.from_nm) || is_off(&slot.to_nm);
        let slots = board.slots.iter().filter(ends).count();
        let off = match (holes, slots) {
            (0, 0) => continue,
            (_, 0) => counted(holes, "hole"),
            (0, _) => counted(slots, "slot"),
            _ => format!("{} and {}", counted(holes, "hole"), counted(slots, "slot")),
        };
        let message = format!("{off} of {file} beyond the travel of {name}");
        let note = format!(
            "{name} {} to {} mm; {} goes from {} to {} mm",
            low[axis],
            high[axis],
            machine.name,
            Nm(from),
            Nm(to)
        );
        let finding = Finding::general(Severity::Error, "E0401", message).note(note);
        let fits = high[axis].0 - low[axis].0 <= to - from;
        findings.add(finding.help(if fits {
            "it fits after a shift: see --shift of `husillo holes`"
        } else {
            "it is too large for a shift to help"
        }));
    }
}
