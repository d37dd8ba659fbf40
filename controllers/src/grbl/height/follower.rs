//! The steps that Z makes to follow the surface.

use husillo_interp::Scale;
use husillo_machine::Axis;

use super::map::{HeightMap, MOST_POINTS};

/// Bits of a height in steps after the point.
const FRACTION_BITS: u8 = 8;
/// Largest area of a cell of the grid, in steps of X times steps of Y.
const MOST_AREA: i64 = 1 << 38;
/// Largest height in steps with [`FRACTION_BITS`] bits after the point.
const MOST_HEIGHT: i64 = 1 << 24;
/// Distance from the surface at which a step is due, in parts of a step with [`FRACTION_BITS`] bits
/// after the point: 5/8. It is more than one half, so a place between two steps makes none.
const DUE: i64 = 160;

/// Follows the surface: for each step of the engine, the step that the motor of Z makes.
#[derive(Clone, Debug)]
pub(super) struct Follower {
    /// The grid lines across X and Y, in steps.
    lines: [[i32; MOST_POINTS as usize]; 2],
    z: Scale,
    /// The present cell: its first column and row.
    cell: [u8; 2],
    cells: [u8; 2],
    /// Heights at the corners of the cell, along X first.
    corners: [i64; 4],
    /// Steps of the motor of Z beyond those of the program.
    correction: i32,
    /// Shortest time between two steps of Z, and the time since the last one, us.
    spacing_us: u32,
    since_us: u32,
    /// A step is due that had to wait.
    is_late: bool,
    /// What the event that was returned adds to the correction, and whether it steps Z.
    pending: (i8, bool),
}

impl Follower {
    /// Returns a follower of a map. `None` without a map, if a cell has no step or more than 2^38,
    /// or if a height has more than 2^16 steps.
    pub(super) fn new(map: &HeightMap, axes: &[Axis; 3]) -> Option<Follower> {
        if !map.exists() {
            return None;
        }
        let [x, y, z] = axes;
        let mut lines = [[0; MOST_POINTS as usize]; 2];
        let mut widest = [0_i64; 2];
        let along = lines.iter_mut().zip([x, y]).zip(&mut widest);
        for (axis, ((lines, scale), widest)) in (0_usize..2).zip(along) {
            let points = map.points.get(axis).copied().unwrap_or(0);
            let mut before: Option<i32> = None;
            for (number, line) in (0..points).zip(lines) {
                *line = scale.scale.nearest(map.line_nm(axis, number))?;
                if let Some(before) = before {
                    let width = i64::from(*line).wrapping_sub(before.into()); // 33 bits
                    if width < 1 {
                        return None;
                    }
                    *widest = width.max(*widest);
                }
                before = Some(*line);
            }
        }
        let [width, depth] = widest;
        if width.checked_mul(depth)? > MOST_AREA {
            return None;
        }
        for height in map.heights {
            let steps = z.scale.nearest_fraction(height.into(), FRACTION_BITS)?;
            if steps.unsigned_abs() >= MOST_HEIGHT.unsigned_abs() {
                return None;
            }
        }
        let mut follower = Follower {
            lines,
            z: z.scale,
            cell: [0; 2],
            cells: map.points.map(|points| points.saturating_sub(2)),
            corners: [0; 4],
            correction: 0,
            // Half of the shortest interval of the axis.
            spacing_us: 500_000_u32.checked_div(z.max_rate_hz).unwrap_or(0),
            since_us: u32::MAX,
            is_late: false,
            pending: (0, false),
        };
        follower.load_corners(map);
        Some(follower)
    }

    /// Returns the steps of the motor of Z beyond those of the program.
    pub(super) const fn correction(&self) -> i32 {
        self.correction
    }

    /// Takes the height at the present place as already reached, and returns it in steps.
    pub(super) fn begin(&mut self, map: &HeightMap, [x, y, _]: [i32; 3]) -> i32 {
        let (volume, area) = self.volume(map, x, y);
        let unit = area.wrapping_mul(1 << FRACTION_BITS);
        let rounded = volume.saturating_add(unit >> 1);
        // The height is below 2^16 steps.
        self.correction = rounded.checked_div_euclid(unit).unwrap_or(0) as i32;
        self.correction
    }

    /// Returns the step of the motor of Z for an event of the engine that ends at `xy` after
    /// `wait_us`, and steps Z by `delta` in the program.
    pub(super) fn step(&mut self, map: &HeightMap, xy: [i32; 2], delta: i8, wait_us: u32) -> i8 {
        let wanted = delta.saturating_add(self.due(map, xy));
        let mut step = wanted.clamp(-1, 1);
        if self.since_us.saturating_add(wait_us) < self.spacing_us {
            step = 0;
        }
        self.is_late = step != wanted;
        // At most 2 in size.
        self.pending = (step.saturating_sub(delta), step != 0);
        step
    }

    /// Returns the time until a step that had to wait may be made. `None`: no step is due.
    pub(super) fn late_us(&self) -> Option<u32> {
        let left = self.spacing_us.saturating_sub(self.since_us).max(1);
        self.is_late.then_some(left)
    }

    /// Looks whether a step is due at rest.
    pub(super) fn rest(&mut self, map: &HeightMap, xy: [i32; 2]) {
        self.is_late = self.due(map, xy) != 0;
    }

    /// Handles the end of the event of the last [`step`](Self::step), which has waited for `us`.
    pub(super) fn made(&mut self, us: u32) {
        let (more, steps) = core::mem::take(&mut self.pending);
        self.correction = self.correction.wrapping_add(more.into());
        self.since_us = if steps {
            0
        } else {
            self.since_us.saturating_add(us)
        };
    }

    /// Forgets the event of the last [`step`](Self::step), which is not made.
    pub(super) fn dropped(&mut self) {
        self.pending = (0, false);
    }

    /// Returns the direction of the step that the surface requires, or 0.
    fn due(&mut self, map: &HeightMap, [x, y]: [i32; 2]) -> i8 {
        let (volume, area) = self.volume(map, x, y);
        // Both are below 2^62 in size.
        let made = i64::from(self.correction).wrapping_mul(area.wrapping_mul(1 << FRACTION_BITS));
        let error = volume.wrapping_sub(made);
        let most = area.wrapping_mul(DUE);
        if error > most {
            1
        } else if error < most.wrapping_neg() {
            -1
        } else {
            0
        }
    }

    /// Returns the height at a place times the area of its cell, and this area. Outside the grid
    /// the height is that of the nearest place of its edge.
    fn volume(&mut self, map: &HeightMap, x: i32, y: i32) -> (i64, i64) {
        let [columns, rows] = &self.lines;
        let [column, row] = self.cell;
        let [last_column, last_row] = self.cells;
        let cell = [
            cell_of(columns, column, last_column, x),
            cell_of(rows, row, last_row, y),
        ];
        if cell != self.cell {
            self.cell = cell;
            self.load_corners(map);
        }
        let [columns, rows] = &self.lines;
        let [column, row] = self.cell;
        let (u, width) = within(columns, column, x);
        let (v, depth) = within(rows, row, y);
        let [first, second, third, fourth] = self.corners;
        // Each sum of two weights is the side of the cell, so the result is below 2^62.
        let low = blend(first, second, u, width);
        let high = blend(third, fourth, u, width);
        (blend(low, high, v, depth), width.wrapping_mul(depth))
    }

    fn load_corners(&mut self, map: &HeightMap) {
        let [column, row] = self.cell;
        let corner = |column: u8, row: u8| {
            let nm = map.height(column, row).into();
            self.z.nearest_fraction(nm, FRACTION_BITS).unwrap_or(0)
        };
        let (next_column, next_row) = (column.saturating_add(1), row.saturating_add(1));
        self.corners = [
            corner(column, row),
            corner(next_column, row),
            corner(column, next_row),
            corner(next_column, next_row),
        ];
    }
}

/// Returns `first * (whole - part) + second * part`.
const fn blend(first: i64, second: i64, part: i64, whole: i64) -> i64 {
    first
        .wrapping_mul(whole.wrapping_sub(part))
        .wrapping_add(second.wrapping_mul(part))
}

fn line(lines: &[i32; MOST_POINTS as usize], number: u8) -> i32 {
    lines.get(usize::from(number)).copied().unwrap_or(0)
}

/// Returns the cell of a place, from the cell of the place before it.
fn cell_of(lines: &[i32; MOST_POINTS as usize], cell: u8, last: u8, at: i32) -> u8 {
    let mut cell = cell;
    while cell < last && at >= line(lines, cell.saturating_add(1)) {
        cell = cell.saturating_add(1);
    }
    while cell > 0 && at < line(lines, cell) {
        cell = cell.saturating_sub(1);
    }
    cell
}

/// Returns the distance of a place from the first line of its cell, and the width of the cell.
fn within(lines: &[i32; MOST_POINTS as usize], cell: u8, at: i32) -> (i64, i64) {
    let (first, second) = (line(lines, cell), line(lines, cell.saturating_add(1)));
    let at = at.min(second).max(first);
    // 33 bits.
    let width = i64::from(second).wrapping_sub(first.into());
    (i64::from(at).wrapping_sub(first.into()), width)
}
