//! What the link wants of the machine.

/// An axis of the drill.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Axis {
    /// Along the board.
    X,
    /// Across the board.
    Y,
    /// The spindle's; it has no position, only two sensors.
    Z,
}

/// One thing to do; the next one is asked for when it is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Order {
    /// Z, then Y, then X to their switches; X and Y are 0 there.
    Home,
    /// Call the present place X 0, Y 0.
    Zero,
    /// An axis, X or Y, to this place, steps from 0.
    Move(Axis, u16),
    /// Down to the lower sensor, then up to the upper one. The number is the Z word of the record.
    /// The original ignores it. With [`Rules::z_is_depth`](super::Rules::z_is_depth) it is a depth
    /// in steps, 0 for the whole stroke.
    Drill(u16),
    /// So many steps; X and Y end at 0. Z is positive downwards.
    Jog(Axis, i16),
    /// The present position becomes a hole of the program: see
    /// [`Device::teach`](super::Device::teach).
    Teach,
    /// The spindle's motor.
    Spindle(bool),
}
