//! The position of an axis in all coordinates.

/// The position of an axis. Positions are amounts of the scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisPosition {
    /// 0 for X to 2 for Z.
    pub coordinate: usize,
    /// The true position from home. `None`: the axis is not homed.
    pub machine: Option<i64>,
    /// The true position from the last zero. Without a zero it counts from home or, before homing,
    /// from the position at the reset.
    pub work: i64,
    /// The last zero, from home or, before homing, from the position at the reset.
    pub zero: i64,
    /// The counts of its module.
    pub counts: i32,
}
