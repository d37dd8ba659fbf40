//! The dialects: differences between the programs of different machines.

use crate::codes::axes::Axes;
use crate::codes::letters::Letters;
#[cfg(feature = "extended")]
use crate::codes::letters::bit;
use crate::features::EXTENDED;
use crate::text::framing::Framing;
#[cfg(feature = "extended")]
use crate::values::nm::Nm;

/// A dialect of G-code: plain data that is freely compared and copied.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Dialect {
    pub(crate) flavour: Flavour,
    block_delete: bool,
    /// Only machines with the extended codes have other axes than A, B and C. Without these fields
    /// all bytes of [`Dialect::RS274`] are zero but one, so a modal state needs no constant.
    #[cfg(feature = "extended")]
    words: Words,
    #[cfg(feature = "extended")]
    begins_in_rapid: bool,
    /// In nanometres; 0 is the rule of the dialect.
    #[cfg(feature = "extended")]
    arc_tolerance: u32,
}

/// The axes of a machine, and what follows from them.
#[cfg(feature = "extended")]
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Words {
    /// The letters other than G and M that can start a word and are stored under their own letter.
    letters: Letters,
    axes: Axes,
    /// Neither a wrapped axis nor the extruder of a printer: one look for the two.
    is_plain: bool,
}

#[cfg(feature = "extended")]
impl Words {
    const fn of(flavour: Flavour, axes: Axes) -> Words {
        let words = WORDS[flavour as usize];
        let has_more = words.0 & bit(b'A') != 0;
        let axes = if has_more { axes } else { Axes::XYZ };
        Words {
            letters: axes.words(words),
            is_plain: !axes.has_wrapped() && !matches!(flavour, Flavour::Printer),
            axes,
        }
    }
}

#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub(crate) enum Flavour {
    Rs274,
    Grbl,
    Micromill,
    Iso,
    Drill,
    // From here on numbers may have other meanings: `Flavour::has_own_numbers`.
    Lathe,
    LatheA,
    Printer,
}

impl Flavour {
    /// Whether a number may be another code than that of RS-274.
    pub(crate) const fn has_own_numbers(self) -> bool {
        EXTENDED && self as u8 >= Flavour::Lathe as u8
    }
}

/// The letters of words in each dialect, by its flavour.
static WORDS: [Letters; 8] = {
    let rs274 = Letters::ALL.without(b"OUVW");
    [
        rs274.and(b"O"),
        rs274.without(b"DEHQ"),
        rs274.without(b"DEHLQ"),
        rs274.and(b"O"),
        Letters::new(b"XY"),
        // U and W are words of the contour cycles only: `Modal::check_axes`.
        if EXTENDED { rs274.and(b"UW") } else { rs274 },
        if EXTENDED {
            rs274.and(b"OUW")
        } else {
            rs274.and(b"O")
        },
        rs274,
    ]
};

impl Dialect {
    /// RS-274 as NIST and LinuxCNC read it: millimetres or inches, one block per line, `;` starts a
    /// comment.
    ///
    /// Lines that start with `/` are skipped (block delete on, the default of LinuxCNC); see
    /// [`Dialect::with_block_delete`].
    pub const RS274: Dialect = Dialect::new(Flavour::Rs274, true, Axes::XYZABC);

    /// The strings of the link of the micro mill: micrometres and absolute arc centres; `;` ends a
    /// block.
    ///
    /// F is in 0.1 mm/min, and `G04 P` is in whole seconds. `G54` stores the present position as
    /// work zero, and `G28` goes straight to machine zero. Each string has its own code (motion is
    /// not modal) and at most 64 characters including its `;`. `Z` moves alone.
    pub const MICROMILL: Dialect = Dialect::new(Flavour::Micromill, true, Axes::XYZABC);

    /// Grbl 1.1: its list of codes, G0 as the initial motion mode, and G92 kept at the end of a
    /// program. There is no block delete: lines that start with `/` are executed.
    pub const GRBL: Dialect = Dialect::new(Flavour::Grbl, false, Axes::XYZABC);

    /// A turning machine with the numbers of RS-274 (code systems B and C of turning controls).
    ///
    /// X is a diameter and G18 the plane at the start. `G90`/`G91` and `G94`/`G95` have the same
    /// meaning as on a mill. The single turning, threading and facing cycles are `G77`, `G78`,
    /// `G79`.
    pub const LATHE: Dialect = Dialect::new(Flavour::Lathe, true, Axes::XYZABC);

    /// A turning machine with the numbers of code system A.
    ///
    /// `G90`, `G92` and `G94` are the turning, threading and facing cycles, not distance mode,
    /// shift and feed mode. `G98`/`G99` are feed per minute and per revolution, `G50` shifts the
    /// frame, `G32` cuts a thread, and increments are `U` and `W`. X is always a diameter.
    pub const LATHE_A: Dialect = Dialect::new(Flavour::LatheA, true, Axes::XYZABC);

    /// Programs of ISO 6983 controls: RS-274's list, and `O1234` alone as the number of a program.
    pub const ISO: Dialect = Dialect::new(Flavour::Iso, true, Axes::XYZABC);

    /// The language of the printed-circuit drill: `X` and `Y`, each block a hole.
    ///
    /// X moves to its end, then Y, and then the drill drills
    /// ([`Command::Drill`](crate::Command::Drill)). In a block with `G28`, which is not homing
    /// here, it does not drill. `G20`, `G21`, `G90` and `G91` have their usual meaning. `G92` sets
    /// the coordinates of the present position to its words, or to zero without words. There is
    /// nothing else: no Z, no feed, no M code.
    pub const DRILL: Dialect = Dialect::new(Flavour::Drill, true, Axes::XYZABC);

    /// Programs for 3D printers: RS-274 with checksums (`*98`) and numbered lines, as
    /// [`Framing::PRINTER`] checks them; see [`Dialect::framing`].
    pub const PRINTER: Dialect = Dialect::new(Flavour::Printer, true, Axes::XYZE);

    /// All dialects.
    pub const ALL: [Dialect; 8] = [
        Dialect::RS274,
        Dialect::GRBL,
        Dialect::MICROMILL,
        Dialect::LATHE,
        Dialect::LATHE_A,
        Dialect::ISO,
        Dialect::DRILL,
        Dialect::PRINTER,
    ];

    /// The dialect of this name: `rs274`, `grbl`, `micromill`, `lathe`, `lathe-a`, `iso`, `drill`
    /// or `printer`.
    pub fn by_name(name: &str) -> Option<Dialect> {
        Dialect::ALL
            .into_iter()
            .find(|dialect| dialect.name() == name)
    }

    /// Its name, as [`Dialect::by_name`] takes it.
    pub const fn name(&self) -> &'static str {
        match self.flavour {
            Flavour::Rs274 => "rs274",
            Flavour::Grbl => "grbl",
            Flavour::Micromill => "micromill",
            Flavour::Lathe => "lathe",
            Flavour::LatheA => "lathe-a",
            Flavour::Iso => "iso",
            Flavour::Drill => "drill",
            Flavour::Printer => "printer",
        }
    }

    /// The same dialect with the block delete switch on (lines with `/` are skipped) or off (they
    /// are executed).
    pub const fn with_block_delete(self, on: bool) -> Dialect {
        Dialect {
            block_delete: on,
            ..self
        }
    }

    /// Whether lines that start with `/` are skipped.
    pub const fn block_delete(&self) -> bool {
        self.block_delete
    }

    /// Length of the longest block, without blanks and including its `;`; `None` without a limit.
    pub const fn buffer(&self) -> Option<u8> {
        match self.flavour {
            Flavour::Micromill => Some(64),
            _ => None,
        }
    }

    /// The checks of a [`Receiver`](crate::Receiver) on each line before its words are read; `None`
    /// if the lines of the dialect have no checksums.
    pub const fn framing(&self) -> Option<Framing> {
        match self.flavour {
            Flavour::Printer => Some(Framing::PRINTER),
            _ => None,
        }
    }

    /// Whether lines are strings of a link: `;` ends a block, and there are no blanks.
    pub(crate) const fn has_strings(&self) -> bool {
        matches!(self.flavour, Flavour::Micromill)
    }

    #[cfg(feature = "extended")]
    const fn new(flavour: Flavour, block_delete: bool, axes: Axes) -> Dialect {
        Dialect {
            flavour,
            block_delete,
            words: Words::of(flavour, axes),
            begins_in_rapid: matches!(flavour, Flavour::Grbl),
            arc_tolerance: 0,
        }
    }

    #[cfg(not(feature = "extended"))]
    const fn new(flavour: Flavour, block_delete: bool, _axes: Axes) -> Dialect {
        Dialect {
            flavour,
            block_delete,
        }
    }

    /// The same dialect for a machine with these axes. Words of axes that the machine does not have
    /// are refused as unknown letters (E0201).
    ///
    /// U, V and W remain increments of X, Y and Z in the lathe dialects.
    ///
    /// # Examples
    /// ```
    /// use husillo_gcode::{Axes, Block, Dialect, Modal};
    ///
    /// let axes = Axes::new(b"XYZB").unwrap();
    /// let dialect = Dialect::RS274.with_axes(axes);
    /// let block = Block::parse(b"G20 G0 X1 B90", &dialect)?;
    /// let (_, mut commands) = Modal::<4>::new(dialect).plan(&block)?;
    /// let text = commands.next().map(|command| command.shown(axes).to_string());
    /// assert_eq!(text.as_deref(), Some("rapid X25.4 Y0 Z0 B90"));
    /// # Ok::<(), husillo_gcode::Error>(())
    /// ```
    #[cfg(feature = "extended")]
    pub const fn with_axes(self, axes: Axes) -> Dialect {
        Dialect {
            words: Words::of(self.flavour, axes),
            ..self
        }
    }

    /// The same dialect with G0 in effect at the start (`true`, as in [`Dialect::GRBL`]), or no
    /// motion mode. Without one, axis words before the first motion code are an error (E0206).
    ///
    /// # Examples
    /// ```
    /// use husillo_gcode::{Block, Dialect, Modal};
    ///
    /// let block = Block::parse(b"X1", &Dialect::RS274)?;
    /// assert!(Modal::<3>::new(Dialect::RS274).plan(&block).is_err());
    /// let starts = Dialect::RS274.with_rapid_start(true);
    /// let (_, mut commands) = Modal::<3>::new(starts).plan(&block)?;
    /// let text = commands.next().map(|command| command.to_string());
    /// assert_eq!(text.as_deref(), Some("rapid X1 Y0 Z0"));
    /// # Ok::<(), husillo_gcode::Error>(())
    /// ```
    #[cfg(feature = "extended")]
    pub const fn with_rapid_start(self, on: bool) -> Dialect {
        Dialect {
            begins_in_rapid: on,
            ..self
        }
    }

    /// The same dialect, which also accepts arcs whose radii differ by at most this length, in
    /// addition to those that the rule of the dialect accepts (E0302). `None` restores the rule
    /// alone. A machine that needs a stricter limit checks [`Arc::mismatch`](crate::Arc::mismatch).
    ///
    /// A negative length is 0, and one above 4 mm is 4.29 mm.
    ///
    /// # Examples
    /// ```
    /// use husillo_gcode::{Block, Dialect, Modal, Nm};
    ///
    /// let block = Block::parse(b"G2 X2.0 I1.1 F9", &Dialect::RS274)?;
    /// let refused = Modal::<3>::new(Dialect::RS274).plan(&block).map(drop);
    /// assert_eq!(refused.unwrap_err().kind.code(), 302);
    /// let wide = Dialect::RS274.with_arc_tolerance(Some(Nm(200_000)));
    /// assert!(Modal::<3>::new(wide).plan(&block).is_ok());
    /// # Ok::<(), husillo_gcode::Error>(())
    /// ```
    #[cfg(feature = "extended")]
    pub const fn with_arc_tolerance(self, most: Option<Nm>) -> Dialect {
        let arc_tolerance = match most {
            Some(Nm(most)) if most > u32::MAX as i64 => u32::MAX,
            Some(Nm(most)) if most > 0 => most as u32,
            _ => 0,
        };
        Dialect {
            arc_tolerance,
            ..self
        }
    }

    /// The length of [`Dialect::with_arc_tolerance`]; zero for the rule of the dialect.
    #[cfg(feature = "extended")]
    pub const fn arc_tolerance(&self) -> Nm {
        Nm(self.arc_tolerance as i64)
    }

    /// Whether G0 is in effect at the start.
    pub(crate) const fn begins_in_rapid(&self) -> bool {
        #[cfg(feature = "extended")]
        return self.begins_in_rapid;
        #[cfg(not(feature = "extended"))]
        return matches!(self.flavour, Flavour::Grbl);
    }

    /// The axes of the machine.
    #[cfg(feature = "extended")]
    pub const fn axes(&self) -> &Axes {
        &self.words.axes
    }

    /// The axes of the machine: those of every dialect.
    #[cfg(not(feature = "extended"))]
    pub const fn axes(&self) -> &Axes {
        &Axes::XYZABC
    }

    /// Whether the words of all axes are only added to a zero.
    #[inline(always)]
    pub(crate) const fn has_plain_axes(&self) -> bool {
        #[cfg(feature = "extended")]
        return self.words.is_plain;
        #[cfg(not(feature = "extended"))]
        return true;
    }

    /// The letters other than G and M that can start a word in this dialect and are stored under
    /// their own letter. The words of other axes have the slot of [`Axes::slot`].
    #[inline(always)]
    pub(crate) const fn letters(&self) -> Letters {
        #[cfg(feature = "extended")]
        return self.words.letters;
        #[cfg(not(feature = "extended"))]
        return WORDS[self.flavour as usize];
    }

    /// Whether points may be given by polar coordinates, `@` and `^`.
    pub(crate) const fn has_polar(&self) -> bool {
        EXTENDED && matches!(self.flavour, Flavour::Rs274)
    }

    /// Whether lines may have parameters `#` and expressions `[ ]`.
    #[cfg(feature = "program")]
    pub const fn has_parameters(&self) -> bool {
        !matches!(
            self.flavour,
            Flavour::Grbl | Flavour::Micromill | Flavour::Drill | Flavour::Printer
        )
    }

    /// Whether an `O` controls the flow of the program, and is not the number of a program.
    #[cfg(feature = "program")]
    pub(crate) const fn has_flow(&self) -> bool {
        matches!(self.flavour, Flavour::Rs274 | Flavour::Lathe)
    }

    /// Whether G80 is permitted with another motion code.
    pub(crate) const fn joins_cancel(&self) -> bool {
        !matches!(self.flavour, Flavour::Grbl | Flavour::Micromill)
    }

    /// Whether X is a diameter at the start.
    pub(crate) const fn is_lathe(&self) -> bool {
        matches!(self.flavour, Flavour::Lathe | Flavour::LatheA)
    }

    /// The blocks of one physical line, each with its offset in the line.
    ///
    /// For RS-274 it is the line itself. For micromill they are the strings before each `;`, and
    /// the text after the last `;` unless it is blank (the end of a line ends a string too).
    pub fn blocks<'a>(&self, line: &'a [u8]) -> Blocks<'a> {
        Blocks {
            rest: Some(line),
            at: 0,
            split: self.has_strings(),
        }
    }
}

/// Iterator over the blocks of a line; see [`Dialect::blocks`].
#[derive(Clone, Debug)]
pub struct Blocks<'a> {
    rest: Option<&'a [u8]>,
    at: usize,
    split: bool,
}

impl<'a> Iterator for Blocks<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let rest = self.rest.take()?;
        let at = self.at;
        if !self.split {
            return Some((at, rest));
        }
        let mut parts = rest.splitn(2, |&byte| byte == b';');
        let text = parts.next()?;
        self.rest = parts.next();
        if self.rest.is_none() && text.iter().all(u8::is_ascii_whitespace) {
            return None;
        }
        // An offset inside the line, because text.len() < line.len() when a `;` follows.
        self.at = at.wrapping_add(text.len()).wrapping_add(1);
        Some((at, text))
    }
}

impl core::iter::FusedIterator for Blocks<'_> {}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec;
    use std::vec::Vec;

    #[test]
    fn splits_lines_into_blocks() {
        let blocks = |dialect: Dialect, line: &'static str| -> Vec<(usize, &[u8])> {
            dialect.blocks(line.as_bytes()).collect()
        };
        assert_eq!(
            blocks(Dialect::RS274, "G0 X1;a"),
            vec![(0, &b"G0 X1;a"[..])]
        );
        assert_eq!(
            blocks(Dialect::MICROMILL, "G90;G00X1Y2; M05 \r\n"),
            vec![
                (0, &b"G90"[..]),
                (4, &b"G00X1Y2"[..]),
                (12, &b" M05 \r\n"[..])
            ]
        );
        assert_eq!(
            blocks(Dialect::MICROMILL, "G90; \r\n"),
            vec![(0, &b"G90"[..])]
        );
        assert_eq!(blocks(Dialect::MICROMILL, ""), vec![]);
    }

    #[test]
    fn has_names() {
        for dialect in Dialect::ALL {
            assert_eq!(Dialect::by_name(dialect.name()), Some(dialect));
        }
        assert_eq!(Dialect::by_name("excellon"), None);
    }
}
