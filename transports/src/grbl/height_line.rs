//! Lines that describe a height map.

use crate::grbl::place::{Units, length};
use crate::grbl::text::{Text, whole};

/// Most heights of one row.
pub const MOST_HEIGHTS: usize = 16;

/// A line of the answer to `$Z`: the grid of a height map, or the heights of one row. All lengths
/// are in millimetres, as in the commands that write them.
///
/// # Examples
///
/// ```
/// use husillo_transports::grbl::HeightLine;
///
/// let line = HeightLine::parse(b"[HEIGHTS:1,0.000,-0.025]").unwrap();
/// assert_eq!(line, HeightLine::row(1, [0, -25_000]));
/// assert_eq!(line.write().bytes(), b"[HEIGHTS:1,0.000,-0.025]");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum HeightLine {
    /// The grid: `[MAP:1,0.000,5.000,60.000,40.000,4,3]`.
    Grid {
        /// Whether Z follows the map.
        is_on: bool,
        /// X and Y of the first point in the present work frame, in nanometres.
        origin: [i64; 2],
        /// Distance of the last point from the first one, in nanometres.
        size: [i64; 2],
        /// Points along X and Y. 0: there is no map.
        points: [u8; 2],
    },
    /// The heights of one row, along X: `[HEIGHTS:1,0.000,-0.025]`.
    Row {
        /// The row, from 0 on.
        row: u8,
        /// Heights in nanometres, of which the first `count` count.
        nm: [i32; MOST_HEIGHTS],
        /// Number of heights.
        count: u8,
    },
}

impl HeightLine {
    /// Creates the line of a row. Heights beyond [`MOST_HEIGHTS`] are dropped.
    pub fn row<I: IntoIterator<Item = i32>>(row: u8, heights: I) -> Self {
        let (mut nm, mut count) = ([0; MOST_HEIGHTS], 0_u8);
        for (slot, height) in nm.iter_mut().zip(heights) {
            *slot = height;
            count = count.wrapping_add(1); // at most 16
        }
        HeightLine::Row { row, nm, count }
    }

    /// Returns the line, without its end.
    pub fn write(&self) -> Text {
        let mut text = Text::new();
        let put = |text: &mut Text, nm: i64| {
            text.put(b",");
            text.put_length(nm, Units::Millimetres);
        };
        match self {
            HeightLine::Grid {
                is_on,
                origin,
                size,
                points,
            } => {
                text.put(if *is_on { b"[MAP:1" } else { b"[MAP:0" });
                for nm in origin.iter().chain(size) {
                    put(&mut text, *nm);
                }
                for points in points {
                    text.put(b",");
                    text.put_number((*points).into());
                }
            }
            HeightLine::Row { row, nm, count } => {
                text.put(b"[HEIGHTS:");
                text.put_number((*row).into());
                for nm in nm.iter().take((*count).into()) {
                    put(&mut text, (*nm).into());
                }
            }
        }
        text.put(b"]");
        text
    }

    /// Reads a line without its end. Returns `None` if it is another one.
    pub fn parse(line: &[u8]) -> Option<HeightLine> {
        let text = line.strip_prefix(b"[")?.strip_suffix(b"]")?;
        let millimetres = |field: &[u8]| match length(field)? {
            (nm, Units::Millimetres) => Some(nm),
            (_, Units::Inches) => None,
        };
        if let Some(text) = text.strip_prefix(b"MAP:") {
            let mut fields = text.split(|byte| *byte == b',');
            let is_on = whole::<u8>(fields.next()?)? == 1;
            let mut nm = [0; 4];
            for slot in &mut nm {
                *slot = millimetres(fields.next()?)?;
            }
            let mut points = [0; 2];
            for slot in &mut points {
                *slot = whole(fields.next()?)?;
            }
            let [x, y, width, depth] = nm;
            return fields.next().is_none().then_some(HeightLine::Grid {
                is_on,
                origin: [x, y],
                size: [width, depth],
                points,
            });
        }
        let mut fields = text.strip_prefix(b"HEIGHTS:")?.split(|byte| *byte == b',');
        let row = whole(fields.next()?)?;
        let (mut nm, mut count) = ([0; MOST_HEIGHTS], 0_u8);
        for field in fields {
            *nm.get_mut(usize::from(count))? = i32::try_from(millimetres(field)?).ok()?;
            count = count.wrapping_add(1); // at most 16
        }
        Some(HeightLine::Row { row, nm, count })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_read_back() {
        let grid = HeightLine::Grid {
            is_on: true,
            origin: [-1_000_000, 5_500_000],
            size: [60_000_000, 40_000_000],
            points: [4, 3],
        };
        let text = grid.write();
        assert_eq!(text.bytes(), b"[MAP:1,-1.000,5.500,60.000,40.000,4,3]");
        assert_eq!(HeightLine::parse(text.bytes()), Some(grid));
        let row = HeightLine::row(15, [i32::MIN / 1000 * 1000; MOST_HEIGHTS]);
        assert_eq!(HeightLine::parse(row.write().bytes()), Some(row));
    }

    #[test]
    fn other_lines_are_not_read() {
        for line in [
            "ok",
            "[MAP:1,0.000]",
            "[MAP:1,0.000,0.000,1.000,1.000,2,2,2]",
            "[HEIGHTS:0,0.0000]",
            "[HEIGHTS:0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17]",
            "[PRB:0.000,0.000,0.000:1]",
        ] {
            assert_eq!(HeightLine::parse(line.as_bytes()), None, "{line}");
        }
    }
}
