//! A board as a G-code program: drill cycles or plain moves, routed slots.

use crate::slots::{self, SlotError, SlotHandling, overlapping};
use crate::{Board, board};
use husillo_excellon::{Hole, Path, Slot, Tool};
use husillo_gcode::Nm;
use std::io::{self, Write};

/// How a hole is drilled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cycle {
    /// One feed down.
    G81,
    /// In pecks.
    G83,
    /// One feed down, with G0 and G1 only.
    Moves,
}

/// Heights, feeds and cycles. Z 0 is the surface of the board.
#[derive(Clone, Copy, Debug)]
pub struct Work {
    /// Z of the bottom of the holes.
    pub bottom: Nm,
    /// Z between holes.
    pub clearance: Nm,
    /// Z for tool changes.
    pub safe: Nm,
    /// Depth of one peck.
    pub peck: Nm,
    /// Feed into the board, per minute.
    pub feed: Nm,
    /// Feed along slots, per minute.
    pub rout_feed: Nm,
    /// Spindle speed; `None` leaves it to the machine.
    pub speed: Option<u32>,
    /// How a hole is drilled.
    pub cycle: Cycle,
    /// How a slot is cut.
    pub slots: SlotHandling,
}

impl Work {
    /// Holes of a depth in nm with G81 at 60 mm/min, 2 mm above the board between them and 10 mm
    /// for tool changes. Slots are routed.
    pub const fn to_depth(depth_nm: i64) -> Self {
        Self {
            bottom: Nm(-depth_nm),
            clearance: Nm(2_000_000),
            safe: Nm(10_000_000),
            peck: Nm(500_000),
            feed: Nm(60_000_000),
            rout_feed: Nm(60_000_000),
            speed: None,
            cycle: Cycle::G81,
            slots: SlotHandling::Rout,
        }
    }

    /// Checks that the slots of a board can be cut.
    ///
    /// # Errors
    ///
    /// See [`SlotError`].
    pub fn check(&self, board: &Board) -> Result<(), SlotError> {
        slots::check(board, self.slots, true)
    }

    /// Writes the program: tool after tool, its holes, then its slots.
    ///
    /// # Errors
    ///
    /// A [`SlotError`] before anything is written, or the error of the writer.
    pub fn write(&self, board: &Board, name: &str, out: &mut impl Write) -> io::Result<()> {
        self.check(board).map_err(io::Error::other)?;
        let name: String = name
            .chars()
            .filter(|c| !c.is_control() && !matches!(c, '(' | ')'))
            .collect();
        let holes = board::count(board.holes.len(), "hole");
        let slots = board::count(board.slots.len(), "slot");
        writeln!(out, "({name}: {holes}, {slots})")?;
        writeln!(out, "G17 G21 G90 G94\nG0 Z{}", self.safe)?;
        for number in board.tools_in_use() {
            self.tool(board, number, out)?;
        }
        writeln!(out, "M5\nM30")
    }

    /// Holes and slots of one tool.
    fn tool(&self, board: &Board, number: u16, out: &mut impl Write) -> io::Result<()> {
        let is_of_tool = |tool: &Tool| tool.number == number;
        let holes = board.holes.iter().filter(|hole| is_of_tool(&hole.tool));
        let mut holes: Vec<_> = holes.copied().collect();
        let slots = board.slots.iter().filter(|slot| is_of_tool(&slot.tool));
        let mut slots: Vec<_> = slots.collect();
        let of_hole = holes.first().map(|hole| hole.tool);
        self.change(number, of_hole.or(slots.first().map(|slot| slot.tool)), out)?;
        if self.slots == SlotHandling::Drill {
            holes.extend(slots.drain(..).flat_map(overlapping));
        }
        self.drill(&holes, out)?;
        self.rout(&slots, out)?;
        writeln!(out, "G0 Z{}", self.safe)
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
