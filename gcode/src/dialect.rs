//! What differs between the programs of different machines.

/// A dialect of G-code: plain data, compared and copied freely.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub struct Dialect {
    pub(crate) flavour: Flavour,
    block_delete: bool,
}

#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(crate) enum Flavour {
    Rs274,
    Micromill,
}

impl Dialect {
    /// RS-274 as NIST and LinuxCNC read it: millimetres or inches, one block a line, `;` starts a comment.
    ///
    /// Lines that start with `/` are skipped (block delete on, LinuxCNC's default); see [`Dialect::with_block_delete`].
    pub const RS274: Dialect = Dialect {
        flavour: Flavour::Rs274,
        block_delete: true,
    };

    /// The strings of the micro mill's link: micrometres, absolute arc centres, `;` ends a block, feed in 0.1 mm/min,
    /// `G04 P` in whole seconds, `G54` stores the present position as work zero, `G28` goes straight to machine zero,
    /// each string has its own code (motion is not modal), at most 64 characters with its `;`, and `Z` alone.
    pub const MICROMILL: Dialect = Dialect {
        flavour: Flavour::Micromill,
        block_delete: true,
    };

    /// The dialect of this name: `rs274` or `micromill`.
    pub fn by_name(name: &str) -> Option<Dialect> {
        match name {
            "rs274" => Some(Dialect::RS274),
            "micromill" => Some(Dialect::MICROMILL),
            _ => None,
        }
    }

    /// Its name, as [`Dialect::by_name`] takes it.
    pub const fn name(&self) -> &'static str {
        match self.flavour {
            Flavour::Rs274 => "rs274",
            Flavour::Micromill => "micromill",
        }
    }

    /// The same dialect with the block delete switch on (lines with `/` are skipped) or off (they are executed).
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

    /// The longest block, blanks not counted, its `;` counted; `None` without limit.
    pub const fn buffer(&self) -> Option<u8> {
        match self.flavour {
            Flavour::Rs274 => None,
            Flavour::Micromill => Some(64),
        }
    }

    /// The blocks of one physical line, each with its offset in it.
    ///
    /// For RS-274 that is the line itself; for micromill the strings before each `;`, and what stands behind the last
    /// `;` unless it is blank (the end of a line ends a string too).
    pub fn blocks<'a>(&self, line: &'a [u8]) -> Blocks<'a> {
        Blocks {
            rest: Some(line),
            at: 0,
            split: self.flavour == Flavour::Micromill,
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
        // An offset inside the line: text.len() < line.len() when a `;` follows.
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
        for dialect in [Dialect::RS274, Dialect::MICROMILL] {
            assert_eq!(Dialect::by_name(dialect.name()), Some(dialect));
        }
        assert_eq!(Dialect::by_name("excellon"), None);
    }
}
