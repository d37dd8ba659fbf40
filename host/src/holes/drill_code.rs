//! A drill file as G-code: drill cycles or plain moves, routed slots.

use crate::cli::{Cycle, Holes, SlotHandling};
use crate::holes::{Board, count, length};
use husillo_excellon::{Hole, Path, Slot, Tool};
use husillo_gcode::Nm;
use std::io::{self, Write};

/// Heights, feeds and cycles.
#[derive(Debug)]
pub struct Work {
    bottom: Nm,
    clearance: Nm,
    safe: Nm,
    peck: Nm,
    feed: Nm,
    rout_feed: Nm,
    speed: Option<u32>,
    cycle: Cycle,
    slots: SlotHandling,
}

impl Work {
    /// Reads the options.
    ///
    /// # Errors
    ///
    /// A sentence about the option that is missing or wrong.
    pub fn new(args: &Holes) -> Result<Self, String> {
        let read = |name: &str, text: &str| {
            length(text)
                .filter(|nm| nm.0 > 0)
                .ok_or_else(|| format!("--{name} {text}: a length above zero, as in 1.8 or 0.07in"))
        };
        let depth = args
            .depth
            .as_deref()
            .ok_or("--as gcode needs --depth, the depth of the holes below the board's surface")?;
        let feed = read("feed", &args.feed)?;
        let (clearance, safe) = (
            read("clearance", &args.clearance)?,
            read("safe", &args.safe)?,
        );
        if safe < clearance {
            return Err(format!("--safe {safe} is below --clearance {clearance}"));
        }
        Ok(Self {
            bottom: Nm(-read("depth", depth)?.0),
            clearance,
            safe,
            peck: read("peck", &args.peck)?,
            feed,
            rout_feed: match &args.rout_feed {
                Some(text) => read("rout-feed", text)?,
                None => feed,
            },
            speed: args.speed,
            cycle: args.cycle,
            slots: args.layout.slots.unwrap_or(SlotHandling::Rout),
        })
    }

    /// Writes the program: tool after tool, its holes, then its slots.
    ///
    /// # Errors
    ///
    /// A slot is refused or cannot be drilled; the outer error is that of the writer.
    pub fn write(
        &self,
        board: &Board,
        file: &str,
        out: &mut impl Write,
    ) -> io::Result<Result<(), String>> {
        if let Err(message) = self.refuse(board) {
            return Ok(Err(message));
        }
        let name: String = file
            .chars()
            .filter(|c| !c.is_control() && !matches!(c, '(' | ')'))
            .collect();
        let holes = count(board.holes.len(), "hole");
        let slots = count(board.slots.len(), "slot");
        writeln!(out, "({name}: {holes}, {slots})")?;
        writeln!(out, "G17 G21 G90 G94\nG0 Z{}", self.safe)?;
        for number in board.tools_in_use() {
            let of_tool = |tool: &Tool| tool.number == number;
            let mut holes: Vec<_> = board
                .holes
                .iter()
                .filter(|h| of_tool(&h.tool))
                .copied()
                .collect();
            let mut slots: Vec<_> = board.slots.iter().filter(|s| of_tool(&s.tool)).collect();
            self.change(
                number,
                holes
                    .first()
                    .map(|h| h.tool)
                    .or(slots.first().map(|s| s.tool)),
                out,
            )?;
            if self.slots == SlotHandling::Drill {
                holes.extend(slots.iter().flat_map(|slot| overlapping(slot)));
                slots.clear();
            }
            self.drill(&holes, out)?;
            self.rout(&slots, out)?;
            writeln!(out, "G0 Z{}", self.safe)?;
        }
        writeln!(out, "M5\nM30")?;
        Ok(Ok(()))
    }

    fn refuse(&self, board: &Board) -> Result<(), String> {
        let slots = &board.slots;
        match self.slots {
            SlotHandling::Rout => Ok(()),
            SlotHandling::Refuse if slots.is_empty() => Ok(()),
            SlotHandling::Refuse => Err(format!(
                "the file has {} slots: see --slots rout and --slots drill",
                slots.len()
            )),
            SlotHandling::Drill => {
                if slots.iter().any(|slot| slot.tool.diameter_nm.is_none()) {
                    return Err("a slot cannot be drilled without its diameter: see --tool".into());
                }
                if slots.iter().any(|slot| slot.path != Path::Straight) {
                    return Err("a curved slot cannot be drilled: see --slots rout".into());
                }
                Ok(())
            }
        }
    }

    fn change(&self, number: u16, tool: Option<Tool>, out: &mut impl Write) -> io::Result<()> {
        let diameter = tool.and_then(|tool| tool.diameter_nm).map(Nm);
        match diameter {
            Some(diameter) => writeln!(out, "(T{number}: {diameter} mm)")?,
            None => writeln!(out, "(T{number}: diameter unknown)")?,
        }
        writeln!(out, "M5\nT{number} M6")?;
        match self.speed {
            Some(speed) => writeln!(out, "M3 S{speed}"),
            None => writeln!(out, "M3"),
        }
    }

    fn drill(&self, holes: &[Hole], out: &mut impl Write) -> io::Result<()> {
        let (bottom, clearance) = (self.bottom, self.clearance);
        let Some((first, rest)) = holes.split_first() else {
            return Ok(());
        };
        let [x, y] = first.at_nm.map(Nm);
        let code = match self.cycle {
            Cycle::Moves => {
                writeln!(out, "F{}", self.feed)?;
                for hole in holes {
                    let [x, y] = hole.at_nm.map(Nm);
                    writeln!(
                        out,
                        "G0 X{x} Y{y}\nG0 Z{clearance}\nG1 Z{bottom}\nG0 Z{clearance}"
                    )?;
                }
                return Ok(());
            }
            Cycle::G81 => "G81".to_owned(),
            Cycle::G83 => format!("G83 Q{}", self.peck),
        };
        writeln!(out, "G0 X{x} Y{y}\nG0 Z{clearance}")?;
        writeln!(
            out,
            "G99 {code} X{x} Y{y} Z{bottom} R{clearance} F{}",
            self.feed
        )?;
        for hole in rest {
            let [x, y] = hole.at_nm.map(Nm);
            writeln!(out, "X{x} Y{y}")?;
        }
        writeln!(out, "G80")
    }

    /// Slots in turn. If one begins at the end of the previous one, the tool stays down.
    fn rout(&self, slots: &[&Slot], out: &mut impl Write) -> io::Result<()> {
        let (bottom, clearance) = (self.bottom, self.clearance);
        let mut down_at = None;
        for slot in slots {
            if down_at != Some(slot.from_nm) {
                let [x, y] = slot.from_nm.map(Nm);
                if down_at.is_some() {
                    writeln!(out, "G0 Z{clearance}")?;
                }
                writeln!(
                    out,
                    "G0 X{x} Y{y}\nG0 Z{clearance}\nG1 Z{bottom} F{}",
                    self.feed
                )?;
            }
            let [x, y] = slot.to_nm.map(Nm);
            let arc = |clockwise| if clockwise { "G2" } else { "G3" };
            match slot.path {
                Path::Straight => write!(out, "G1 X{x} Y{y}")?,
                Path::Radius {
                    clockwise,
                    radius_nm,
                } => {
                    write!(out, "{} X{x} Y{y} R{}", arc(clockwise), Nm(radius_nm))?;
                }
                Path::Centre {
                    clockwise,
                    centre_nm: [centre_x, centre_y],
                } => {
                    let i = Nm(centre_x - slot.from_nm[0]);
                    let j = Nm(centre_y - slot.from_nm[1]);
                    write!(out, "{} X{x} Y{y} I{i} J{j}", arc(clockwise))?;
                }
            }
            writeln!(out, " F{}", self.rout_feed)?;
            down_at = Some(slot.to_nm);
        }
        if down_at.is_some() {
            writeln!(out, "G0 Z{clearance}")?;
        }
        Ok(())
    }
}

/// The two ends of a straight slot and holes between them, no further apart than 0.7 of its width.
pub fn overlapping(slot: &Slot) -> Vec<Hole> {
    let [dx, dy] = [0, 1].map(|axis: usize| i128::from(slot.to_nm[axis] - slot.from_nm[axis]));
    let width = slot
        .tool
        .diameter_nm
        .map_or(1, |nm| nm.max(1))
        .unsigned_abs();
    let length = ((dx * dx + dy * dy).unsigned_abs()).isqrt() + 1;
    let pieces = (10 * length)
        .div_ceil(7 * u128::from(width))
        .clamp(1, 10_000) as i128;
    // Both ends first: a drill is guided where the position of the slot matters.
    let between = 1..pieces;
    [0, pieces]
        .into_iter()
        .chain(between)
        .map(|piece| {
            let along = |from: i64, way: i128| {
                // To the nearest nanometre, halves up.
                let part = (2 * way * piece + pieces).div_euclid(2 * pieces);
                from + part as i64
            };
            Hole {
                at_nm: [along(slot.from_nm[0], dx), along(slot.from_nm[1], dy)],
                tool: slot.tool,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drilled_slot_has_its_ends_and_overlaps() {
        let tool = Tool {
            number: 1,
            diameter_nm: Some(1_000_000),
            plated: None,
        };
        let slot = Slot {
            from_nm: [0, 0],
            to_nm: [3_000_000, -4_000_000],
            path: Path::Straight,
            tool,
        };
        let mut at: Vec<_> = overlapping(&slot).iter().map(|hole| hole.at_nm).collect();
        assert_eq!(at[..2], [slot.from_nm, slot.to_nm]);
        at.sort();
        assert_eq!(at.len(), 9);
        for pair in at.windows(2) {
            let [dx, dy] = [0, 1].map(|axis: usize| pair[1][axis] - pair[0][axis]);
            assert!(dx * dx + dy * dy <= 700_000_i64.pow(2));
        }
        let point = Slot {
            to_nm: slot.from_nm,
            ..slot
        };
        assert_eq!(overlapping(&point).len(), 2);
    }
}
