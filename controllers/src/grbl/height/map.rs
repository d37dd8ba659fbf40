//! A grid of heights.

use husillo_transports::grbl::MOST_HEIGHTS;

/// Most points along X, and along Y.
pub(super) const MOST_POINTS: u8 = MOST_HEIGHTS as u8;
/// Heights that are kept.
pub(super) const HEIGHTS: usize = MOST_POINTS as usize * MOST_POINTS as usize;

/// Heights of a surface at the points of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) struct HeightMap {
    /// The first point, along X and Y in the machine frame, in nanometres.
    pub(super) origin: [i64; 2],
    /// Distance of the last point from the first one, in nanometres. It is above 0.
    pub(super) size: [i64; 2],
    /// Points along X and Y, 2 to [`MOST_POINTS`]. 0: there is no map.
    pub(super) points: [u8; 2],
    /// Heights in nanometres, along X first.
    pub(super) heights: [i32; HEIGHTS],
}

impl HeightMap {
    /// Length of the stored form.
    pub(in super::super) const BYTES: usize = 4 * 8 + 2 + HEIGHTS * 4;

    pub(in super::super) const NONE: HeightMap = HeightMap {
        origin: [0; 2],
        size: [0; 2],
        points: [0; 2],
        heights: [0; HEIGHTS],
    };

    /// Returns a level grid. `None` if it has too few or too many points, or no extent.
    pub(super) fn level(origin: [i64; 2], size: [i64; 2], points: [i64; 2]) -> Option<HeightMap> {
        let range = 2..=i64::from(MOST_POINTS);
        let fits =
            size.iter().all(|size| *size > 0) && points.iter().all(|points| range.contains(points));
        // The points are at most 16.
        fits.then_some(HeightMap {
            origin,
            size,
            points: points.map(|points| points as u8),
            heights: [0; HEIGHTS],
        })
    }

    pub(super) const fn exists(&self) -> bool {
        let [columns, rows] = self.points;
        columns > 1 && rows > 1
    }

    /// Returns the number of points.
    pub(super) fn count(&self) -> usize {
        let [columns, rows] = self.points;
        usize::from(columns).wrapping_mul(rows.into()) // at most 256
    }

    /// Returns the position of the grid line `number` across an axis, 0 for X and 1 for Y.
    pub(super) fn line_nm(&self, axis: usize, number: u8) -> i64 {
        let of = |values: &[i64; 2]| values.get(axis).copied().unwrap_or(0);
        let points = self.points.get(axis).copied().unwrap_or(0);
        let spaces = i64::from(points).saturating_sub(1);
        let product = of(&self.size).saturating_mul(number.into());
        of(&self.origin).saturating_add(product.checked_div(spaces).unwrap_or(0))
    }

    /// Returns the height of a point. Beyond the last point it is that of the last one.
    pub(super) fn height(&self, column: u8, row: u8) -> i32 {
        let [columns, rows] = self.points.map(|points| points.saturating_sub(1));
        let (column, row) = (column.min(columns), row.min(rows));
        let at = usize::from(row)
            .wrapping_mul(usize::from(columns).wrapping_add(1))
            .wrapping_add(column.into()); // below 256
        self.heights.get(at).copied().unwrap_or(0)
    }

    /// Returns the height at a place in the machine frame, in nanometres. Its error is below one
    /// millionth of the rise of the cell.
    pub(super) fn height_at(&self, [x, y]: [i64; 2]) -> i32 {
        let (column, u) = self.part(0, x);
        let (row, v) = self.part(1, y);
        let (next_column, next_row) = (column.saturating_add(1), row.saturating_add(1));
        let along = |row: u8| {
            let (first, second) = (self.height(column, row), self.height(next_column, row));
            between(first.into(), second.into(), u)
        };
        // It is between two heights.
        between(along(row), along(next_row), v) as i32
    }

    /// Returns the cell of a place along an axis, and the place in it in parts of 2^20.
    fn part(&self, axis: usize, at: i64) -> (u8, i64) {
        let points = self.points.get(axis).copied().unwrap_or(0);
        let last = points.saturating_sub(2);
        let mut cell = 0_u8;
        while cell < last && at >= self.line_nm(axis, cell.saturating_add(1)) {
            cell = cell.saturating_add(1);
        }
        let first = self.line_nm(axis, cell);
        let width = self
            .line_nm(axis, cell.saturating_add(1))
            .saturating_sub(first);
        let inside = at.saturating_sub(first).min(width).max(0);
        (
            cell,
            inside
                .saturating_mul(1 << 20)
                .checked_div(width)
                .unwrap_or(0),
        )
    }

    /// Returns the lowest and the highest height in nanometres.
    pub(super) fn range(&self) -> [i64; 2] {
        let heights = self.heights.iter().take(self.count());
        let start = i64::from(self.height(0, 0));
        heights.fold([start; 2], |[least, most], nm| {
            [least.min((*nm).into()), most.max((*nm).into())]
        })
    }

    /// Returns the stored form.
    pub(in super::super) fn bytes(&self) -> impl Iterator<Item = u8> + '_ {
        let numbers = self.origin.into_iter().chain(self.size);
        let heights = self.heights.iter().flat_map(|nm| nm.to_le_bytes());
        let numbers = numbers.flat_map(i64::to_le_bytes);
        numbers.chain(self.points).chain(heights)
    }

    /// Reads the stored form from the front of `rest`. A grid that cannot be is no map.
    pub(in super::super) fn take(rest: &mut &[u8]) -> Option<HeightMap> {
        let mut map = HeightMap::NONE;
        for slot in map.origin.iter_mut().chain(&mut map.size) {
            let (bytes, others) = rest.split_first_chunk()?;
            *slot = i64::from_le_bytes(*bytes);
            *rest = others;
        }
        let (points, others) = rest.split_first_chunk()?;
        (map.points, *rest) = (*points, others);
        for slot in &mut map.heights {
            let (bytes, others) = rest.split_first_chunk()?;
            *slot = i32::from_le_bytes(*bytes);
            *rest = others;
        }
        let grid = HeightMap::level(map.origin, map.size, map.points.map(i64::from));
        Some(grid.map_or(HeightMap::NONE, |grid| HeightMap {
            heights: map.heights,
            ..grid
        }))
    }
}

/// Returns the value at a part of 2^20 between two values of 32 bits.
fn between(first: i64, second: i64, part: i64) -> i64 {
    let rise = second.saturating_sub(first).saturating_mul(part);
    first.saturating_add(rise.saturating_add(1 << 19) >> 20)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_has_its_lines_and_its_stored_form() {
        let mut map = HeightMap::level([-5, 7], [10_000_000, 9], [4, 2]).unwrap();
        assert_eq!(
            [0, 1, 2, 3].map(|line| map.line_nm(0, line)),
            [-5, 3_333_328, 6_666_661, 9_999_995]
        );
        assert_eq!([0, 1].map(|line| map.line_nm(1, line)), [7, 16]);
        map.heights[..8].copy_from_slice(&[1, 2, 3, 4, -5, 6, 7, 8]);
        assert_eq!((map.height(3, 0), map.height(0, 1)), (4, -5));
        assert_eq!((map.height(9, 9), map.range()), (8, [-5, 8]));
        let bytes: Vec<u8> = map.bytes().collect();
        assert_eq!(bytes.len(), HeightMap::BYTES);
        assert_eq!(HeightMap::take(&mut &bytes[..]), Some(map));
        assert_eq!(HeightMap::take(&mut &bytes[1..]), None);
    }

    #[test]
    fn a_grid_has_an_extent_and_2_to_16_points() {
        let grid = |size, points| HeightMap::level([0; 2], size, points).is_some();
        assert!(grid([1, 1], [2, 16]));
        assert!(!grid([0, 1], [2, 2]));
        assert!(!grid([1, 1], [1, 2]));
        assert!(!grid([1, 1], [2, 17]));
        let mut bytes: Vec<u8> = HeightMap::NONE.bytes().collect();
        bytes[32] = 200;
        assert_eq!(HeightMap::take(&mut &bytes[..]), Some(HeightMap::NONE));
    }

    extern crate std;
    use std::vec::Vec;
}
