//! Flaws of the original controller, each with a name.

/// What the controller does where the original is flawed: `true` is mended.
///
/// Sources: the original's assembly text, which its description contradicts in places; the text of the program wins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Rules {
    /// `b` while the memory is full: what is in it is run first, and `b` begins a program. The original stores the `b` as data as well, so
    /// that every record after it is off by a byte.
    pub begins_when_full: bool,
    /// `f` directly behind `b` ends an empty program. The original takes it for the first byte of a record.
    pub ends_when_empty: bool,
    /// `E` is heard while a full memory is run, and answered by `E` instead of the late echo; other bytes are ignored. The original
    /// hears nothing and finds the first such byte afterwards, as data.
    pub stops_at_border: bool,
    /// An advance of 0 steps is no move. The original makes 256 steps of it in Z.
    pub zero_is_no_move: bool,
    /// The Z word of a record is a depth in steps, 0 being the whole way. The original ignores it.
    pub z_is_depth: bool,
    /// The spindle, which the host switches on before a program, stops when the program has ended:
    /// one that is left to itself does not leave it turning. The original's controller stops it
    /// after each hole.
    pub stops_spindle: bool,
    /// What the original reserved or lacked: teach-in by `T` in the manual mode, help by `?`, records read back and counted by `n`, the
    /// spindle by `O` and `S` outside of the manual mode, which homes, the manual mode with the program kept by `M`, whether a program runs by
    /// `p`; a fault and a jog that ends early are told. The original does not answer such bytes, or only echoes them.
    pub has_extras: bool,
}

impl Rules {
    /// As the original.
    pub const FAITHFUL: Rules = Rules {
        begins_when_full: false,
        ends_when_empty: false,
        stops_at_border: false,
        zero_is_no_move: false,
        z_is_depth: false,
        stops_spindle: false,
        has_extras: false,
    };

    /// All mended.
    pub const FIXED: Rules = Rules {
        begins_when_full: true,
        ends_when_empty: true,
        stops_at_border: true,
        zero_is_no_move: true,
        z_is_depth: true,
        stops_spindle: true,
        has_extras: true,
    };
}
