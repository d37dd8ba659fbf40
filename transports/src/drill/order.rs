//! The orders of the link to the machine.

/// An axis of the drill.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Axis {
    /// Along the board.
    X,
    /// Across the board.
    Y,
    /// Up and down, with the spindle. It has no position, only two sensors.
    Z,
}

/// An order for the machine. The next one follows when it is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Order {
    /// Home Z, then Y, then X at their switches. X and Y become 0 there.
    Home,
    /// Make the present position X 0, Y 0.
    Zero,
    /// Move X or Y to this position, in steps from 0.
    Move(Axis, u16),
    /// Move Z down to the lower sensor, then up to the upper one. The number is the Z word of the
    /// record. The original ignores it. With [`Rules::z_is_depth`](super::Rules::z_is_depth) it is
    /// a depth in steps, 0 for the whole stroke.
    Drill(u16),
    /// Move an axis by this many steps. X and Y stop at 0. Z is positive downwards.
    Jog(Axis, i16),
    /// Make the present position a hole of the program: see
    /// [`Device::teach`](super::Device::teach).
    Teach,
    /// Switch the spindle on or off.
    Spindle(bool),
}
