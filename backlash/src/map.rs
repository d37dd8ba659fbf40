//! Backlash by position: a grid over two axes, or a table along one.

use core::fmt;

/// Largest backlash of an entry, in motor steps.
const MOST_STEPS: u32 = (1 << 20) - 1;

/// Largest number of steps from one grid position to the next.
const MOST_WAY: u32 = 1 << 22;

/// Backlash of one axis over a machine's work area, in motor steps.
///
/// Between grid positions the backlash is interpolated bilinearly and rounded to the nearest step.
/// Outside the grid it is that of the nearest edge. If an axis has one position only, the backlash
/// does not depend on this axis. So bands across X are a grid with one position in Y, and the table
/// of a lead screw is a grid along its own axis.
///
/// From one grid position to the next the backlash changes by at most a quarter of the distance. So
/// an event changes it by at most one step.
///
/// # Cost
/// Two binary searches, two 64-bit divisions and a few products per look-up. The 64-bit arithmetic
/// is exact, because entries are below 2^20 and distances below 2^22.
///
/// # Examples
/// ```
/// use husillo_backlash::BacklashMap;
///
/// // Three bands of Y, measured in their middles.
/// let x = BacklashMap::new([0, 1], [&[0][..], &[8000, 25000, 42000]], [1357, 1436, 1336])?;
/// assert_eq!(x.steps([-5, 8000]), 1357);
/// assert_eq!(x.steps([70_000, 16_500]), 1397);
/// assert_eq!(x.steps([0, 50_000]), 1336);
/// # Ok::<(), husillo_backlash::MapError>(())
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BacklashMap<K, V> {
    axes: [usize; 2],
    positions: [K; 2],
    steps: V,
}

/// Why a map is not valid.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MapError {
    /// There is no entry, or not one for every grid position.
    Entries,
    /// Along the first (0) or the second axis (1) this position, counted from 0, is not above the
    /// previous one, or more than 2^22 steps above it.
    Order {
        /// 0 or 1.
        axis: usize,
        /// Index of the position.
        position: usize,
    },
    /// This entry, counted from 0, is 2^20 steps or more.
    Range(usize),
    /// From a neighbour to this entry the backlash changes by more than a quarter of the distance.
    Steep(usize),
}

impl fmt::Display for MapError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Entries => f.write_str("the map needs exactly one entry for each position"),
            Self::Order { position, .. } => {
                write!(f, "the positions do not rise at position {position}")
            }
            Self::Range(entry) => write!(f, "entry {entry} is 2^20 steps or more"),
            Self::Steep(entry) => write!(f, "the backlash is too steep at entry {entry}"),
        }
    }
}

impl core::error::Error for MapError {}

impl<K: AsRef<[i32]>, V: AsRef<[u32]>> BacklashMap<K, V> {
    /// Creates a map over two `axes` of the machine, given by their numbers. `positions` are rising
    /// positions along each of them in load steps. `steps` are the backlash values in motor steps:
    /// all positions of the first axis at the first position of the second, and so on.
    ///
    /// # Errors
    /// [`MapError`], in the order of its variants.
    pub fn new(axes: [usize; 2], positions: [K; 2], steps: V) -> Result<Self, MapError> {
        let [first, second] = positions.each_ref().map(|positions| positions.as_ref());
        let entries = first.len().checked_mul(second.len());
        if entries == Some(0) || entries != Some(steps.as_ref().len()) {
            return Err(MapError::Entries);
        }
        check_order(0, first)?;
        check_order(1, second)?;
        let map = BacklashMap {
            axes,
            positions,
            steps,
        };
        map.check_entries()?;
        Ok(map)
    }

    /// Returns the backlash at a position along the two axes of the map.
    #[must_use]
    pub fn steps(&self, at: [i32; 2]) -> u32 {
        self.look_up(at).0
    }

    /// Returns the numbers of the two axes of the machine.
    pub const fn axes(&self) -> [usize; 2] {
        self.axes
    }

    /// Returns the positions along them, in steps.
    pub fn positions(&self) -> [&[i32]; 2] {
        self.positions
            .each_ref()
            .map(|positions| positions.as_ref())
    }

    /// Returns the backlash at all of them: those along the first axis at the first position of the
    /// second, and so on.
    pub fn entries(&self) -> &[u32] {
        self.steps.as_ref()
    }

    /// Whether there is no backlash anywhere.
    pub fn is_free(&self) -> bool {
        self.steps.as_ref().iter().all(|steps| *steps == 0)
    }

    /// Returns the two coordinates of a position for the map. An axis that the machine lacks is at
    /// 0.
    pub(crate) fn position<const N: usize>(&self, load: &[i32; N]) -> [i32; 2] {
        self.axes
            .map(|axis| load.get(axis).copied().unwrap_or_default())
    }

    /// Returns the backlash at a position, and a lower bound of the distance that each of the two
    /// axes may move while the backlash stays the same.
    pub(crate) fn look_up(&self, at: [i32; 2]) -> (u32, u32) {
        let [x, y] = self
            .positions
            .each_ref()
            .map(|positions| positions.as_ref());
        let [at_x, at_y] = at;
        let (x, y) = (Between::new(x, at_x), Between::new(y, at_y));
        let entry = |column, row| u64::from(self.entry(column, row));
        let (low_low, high_low) = (entry(x.low, y.low), entry(x.high, y.low));
        let (low_high, high_high) = (entry(x.low, y.high), entry(x.high, y.high));
        let along_x = |low: u64, high: u64| {
            let rest = x.distance.wrapping_sub(x.offset);
            low.wrapping_mul(rest)
                .wrapping_add(high.wrapping_mul(x.offset))
        };
        // Entries below 2^20, weights of each axis adding up to 2^22 at most: below 2^64 with half
        // of the whole, too.
        let whole = x.distance.wrapping_mul(y.distance);
        let weighted = along_x(low_low, high_low)
            .wrapping_mul(y.distance.wrapping_sub(y.offset))
            .wrapping_add(along_x(low_high, high_high).wrapping_mul(y.offset))
            .wrapping_add(whole >> 1);
        let steps = weighted.checked_div(whole).unwrap_or(0);
        let above = weighted.wrapping_sub(steps.wrapping_mul(whole));
        // Largest change of the weighted sum by a step along each axis, anywhere between these
        // positions.
        let change = |pairs: [[u64; 2]; 2], other: u64| {
            let [one, two] = pairs.map(|[low, high]| low.abs_diff(high));
            one.max(two).wrapping_mul(other)
        };
        let rate = change([[low_low, high_low], [low_high, high_high]], y.distance).wrapping_add(
            change([[low_low, low_high], [high_low, high_high]], x.distance),
        );
        let margin = above.min(whole.wrapping_sub(above).wrapping_sub(1));
        let quiet = match margin.checked_div(rate) {
            Some(quiet) => u32::try_from(quiet).unwrap_or(u32::MAX),
            None => u32::MAX,
        };
        (steps as u32, quiet.min(x.room).min(y.room))
    }

    fn entry(&self, column: usize, row: usize) -> u32 {
        let [columns, _] = self
            .positions
            .each_ref()
            .map(|positions| positions.as_ref().len());
        // Below the number of entries, which is a length.
        let index = row.wrapping_mul(columns).wrapping_add(column);
        self.steps.as_ref().get(index).copied().unwrap_or_default()
    }

    /// Ranges and slopes.
    fn check_entries(&self) -> Result<(), MapError> {
        let [columns, rows] = self
            .positions
            .each_ref()
            .map(|positions| positions.as_ref());
        let entries =
            (0..rows.len()).flat_map(|row| (0..columns.len()).map(move |column| (column, row)));
        for (column, row) in entries {
            // Below the number of entries, which is a length.
            let index = row.wrapping_mul(columns.len()).wrapping_add(column);
            let here = self.entry(column, row);
            if here > MOST_STEPS {
                return Err(MapError::Range(index));
            }
            let left = column
                .checked_sub(1)
                .map(|left| (distance(columns, left), self.entry(left, row)));
            let below = row
                .checked_sub(1)
                .map(|below| (distance(rows, below), self.entry(column, below)));
            for (distance, there) in [left, below].into_iter().flatten() {
                // Both below 2^22.
                if here.abs_diff(there).saturating_mul(4) > distance {
                    return Err(MapError::Steep(index));
                }
            }
        }
        Ok(())
    }
}

/// Steps from a position to the next one above it.
fn distance(positions: &[i32], from: usize) -> u32 {
    let mut ends = positions.iter().skip(from);
    match (ends.next(), ends.next()) {
        (Some(low), Some(high)) => high.abs_diff(*low),
        _ => 1,
    }
}

fn check_order(axis: usize, positions: &[i32]) -> Result<(), MapError> {
    let pairs = positions.iter().zip(positions.iter().skip(1));
    for (position, (low, high)) in (1..positions.len()).zip(pairs) {
        if high <= low || high.abs_diff(*low) > MOST_WAY {
            return Err(MapError::Order { axis, position });
        }
    }
    Ok(())
}

/// A position between two grid positions of one axis.
struct Between {
    /// Indices of the grid positions below and above it. Outside of the grid they are equal.
    low: usize,
    high: usize,
    /// Steps between them, at least 1, and from the lower one to the position.
    distance: u64,
    offset: u64,
    /// Steps to the nearer of them, or back to the edge.
    room: u32,
}

impl Between {
    /// `positions` has at least one entry.
    fn new(positions: &[i32], at: i32) -> Between {
        let above = positions.partition_point(|position| *position <= at);
        let position = |index: usize| positions.get(index).copied();
        let low = above.checked_sub(1);
        match (low.and_then(position), position(above)) {
            (Some(below), Some(next)) => {
                let (offset, rest) = (at.abs_diff(below), next.abs_diff(at));
                Between {
                    low: low.unwrap_or(0),
                    high: above,
                    distance: next.abs_diff(below).into(),
                    offset: offset.into(),
                    room: offset.min(rest),
                }
            }
            (edge, next) => {
                let index = low.unwrap_or(0);
                let is_alone = positions.len() == 1;
                let edge = edge.or(next).unwrap_or(at);
                Between {
                    low: index,
                    high: index,
                    distance: 1,
                    offset: 0,
                    room: if is_alone {
                        u32::MAX
                    } else {
                        edge.abs_diff(at)
                    },
                }
            }
        }
    }
}
