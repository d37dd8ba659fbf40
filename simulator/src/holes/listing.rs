//! A board as tables for people and as JSON for programs.

use super::because;
use crate::diagnostics::Findings;
use crate::text::json::{self, Millimetres};
use husillo_excellon::{Hole, Path, Reason, Slot, Tool, Zeros};
use husillo_gcode::Nm;
use husillo_holes::{Board, Metric};
use husillo_sim::text::counted;
use serde::{Serialize, Serializer};
use std::io::{self, Write};

/// Writes the tables for people.
///
/// # Errors
///
/// The error of the writer.
pub fn print(board: &Board, file: &str, out: &mut impl Write) -> io::Result<()> {
    let (holes, slots) = (board.holes.len(), board.slots.len());
    writeln!(
        out,
        "{file}: {}, {}",
        counted(holes, "hole"),
        counted(slots, "slot")
    )?;
    print_settings(board, out)?;
    print_tools(board, out)?;
    if let Some([low, high]) = board.extent() {
        let size = [0, 1].map(|axis: usize| Nm(high[axis].0 - low[axis].0));
        writeln!(
            out,
            "\n  extent   X {} to {} mm, Y {} to {} mm ({} x {} mm, middles of holes and ends \
             of slots)",
            low[0], high[0], low[1], high[1], size[0], size[1]
        )?;
        writeln!(
            out,
            "  travel   {:.1} mm from the origin over all holes",
            board.travel_nm(Metric::Straight) / 1e6
        )?;
    }
    Ok(())
}

fn print_settings(board: &Board, out: &mut impl Write) -> io::Result<()> {
    let settings = &board.settings;
    let row = |out: &mut dyn Write, name: &str, value: String, reason: Reason| {
        writeln!(out, "  {name:<8} {value:<26} {}", because(reason))
    };
    row(
        out,
        "units",
        settings.units.value.to_string(),
        settings.units.reason,
    )?;
    if settings.point_missing {
        row(
            out,
            "zeros",
            settings.zeros.value.to_string(),
            settings.zeros.reason,
        )?;
        row(
            out,
            "digits",
            settings.digits.value.to_string(),
            settings.digits.reason,
        )?;
    } else {
        writeln!(
            out,
            "  zeros and digits do not matter: all coordinates have a point"
        )?;
    }
    Ok(())
}

fn print_tools(board: &Board, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "\n  tool   diameter mm  plated    holes    slots")?;
    for tool in &board.tools {
        let holes = board
            .holes
            .iter()
            .filter(|hole| hole.tool.number == tool.number);
        let slots = board
            .slots
            .iter()
            .filter(|slot| slot.tool.number == tool.number);
        let diameter = tool
            .diameter_nm
            .map_or("?".to_owned(), |nm| Nm(nm).to_string());
        let plated = match tool.plated {
            Some(true) => "yes",
            Some(false) => "no",
            None => "?",
        };
        let name = format!("T{}", tool.number);
        let (holes, slots) = (holes.count(), slots.count());
        writeln!(
            out,
            "  {name:<6} {diameter:>11}  {plated:<6} {holes:>8} {slots:>8}"
        )?;
    }
    Ok(())
}

/// Writes the JSON object for programs: exact millimetres.
///
/// # Errors
///
/// The error of the writer.
pub fn print_json(board: &Board, findings: &Findings, out: &mut impl Write) -> io::Result<()> {
    let settings = &board.settings;
    let listing = Listing {
        holes: &board.holes,
        slots: &board.slots,
        tools: board.tools.iter().map(ListedTool::new).collect(),
        units: settings.units.value.to_string(),
        units_reason: because(settings.units.reason),
        zeros: match settings.zeros.value {
            Zeros::Leading => "leading",
            Zeros::Trailing => "trailing",
        },
        zeros_reason: because(settings.zeros.reason),
        digits: settings.digits.value.to_string(),
        digits_reason: because(settings.digits.reason),
        errors: findings.errors,
        warnings: findings.warnings,
    };
    json::write_found("husillo.holes/1", &listing, findings, out)
}

/// What `--format json` prints; lengths in mm.
#[derive(Serialize)]
struct Listing<'a> {
    #[serde(serialize_with = "holes")]
    holes: &'a [Hole],
    #[serde(serialize_with = "slots")]
    slots: &'a [Slot],
    tools: Vec<ListedTool>,
    units: String,
    units_reason: String,
    zeros: &'static str,
    zeros_reason: String,
    digits: String,
    digits_reason: String,
    errors: u64,
    warnings: u64,
}

#[derive(Serialize)]
struct ListedTool {
    number: u16,
    diameter: Option<Millimetres>,
    plated: Option<bool>,
}

impl ListedTool {
    fn new(tool: &Tool) -> Self {
        Self {
            number: tool.number,
            diameter: tool.diameter_nm.map(Millimetres),
            plated: tool.plated,
        }
    }
}

/// A slot: a straight one as its ends and its diameter.
#[derive(Serialize)]
#[serde(untagged)]
enum ListedSlot {
    Straight(
        Millimetres,
        Millimetres,
        Millimetres,
        Millimetres,
        Option<Millimetres>,
    ),
    Curved {
        from: [Millimetres; 2],
        to: [Millimetres; 2],
        diameter: Option<Millimetres>,
        direction: &'static str,
        #[serde(flatten)]
        about: About,
    },
}

/// What a curved slot goes around.
#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
enum About {
    Radius(Millimetres),
    Centre([Millimetres; 2]),
}

/// Each hole as X, Y and diameter, written one by one: there may be millions.
fn holes<S: Serializer>(holes: &[Hole], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(holes.iter().map(|hole| {
        let [x, y] = hole.at_nm.map(Millimetres);
        (x, y, hole.tool.diameter_nm.map(Millimetres))
    }))
}

fn slots<S: Serializer>(slots: &[Slot], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(slots.iter().map(ListedSlot::new))
}

impl ListedSlot {
    fn new(slot: &Slot) -> Self {
        let [from, to] = [slot.from_nm, slot.to_nm].map(|at_nm| at_nm.map(Millimetres));
        let diameter = slot.tool.diameter_nm.map(Millimetres);
        let (is_clockwise, about) = match slot.path {
            Path::Straight => {
                let ([x, y], [to_x, to_y]) = (from, to);
                return Self::Straight(x, y, to_x, to_y, diameter);
            }
            Path::Radius {
                clockwise,
                radius_nm,
            } => (clockwise, About::Radius(Millimetres(radius_nm))),
            Path::Centre {
                clockwise,
                centre_nm,
            } => (clockwise, About::Centre(centre_nm.map(Millimetres))),
        };
        Self::Curved {
            from,
            to,
            diameter,
            direction: if is_clockwise { "cw" } else { "ccw" },
            about,
        }
    }
}
