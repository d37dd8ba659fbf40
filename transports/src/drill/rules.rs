//! Flaws of the original controller, each with a name.

/// The flaws of the original controller. `true` means that the flaw is corrected.
///
/// # Source
/// The assembly text of the original. Where its description contradicts the assembly text, the
/// assembly text is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Rules {
    /// When `b` arrives while the memory is full, the device runs what the memory holds, and then
    /// `b` begins a program. The original also stores the `b` as data, so every later record is off
    /// by one byte.
    pub begins_when_full: bool,
    /// `f` directly after `b` ends an empty program. The original takes this `f` for the first byte
    /// of a record.
    pub ends_when_empty: bool,
    /// While a full memory is run, the device receives `E` and answers it with `E` instead of the
    /// late echo. It ignores other bytes. The original receives nothing meanwhile, and later takes
    /// the first such byte as data.
    pub stops_at_border: bool,
    /// An advance of 0 steps is no move. In Z the original then makes 256 steps.
    pub zero_is_no_move: bool,
    /// The Z word of a record is a depth in steps. 0 is the whole stroke. The original ignores it.
    pub z_is_depth: bool,
    /// The spindle stops when the program has ended. The host has switched it on before the
    /// program, so otherwise it would keep turning if the host is lost. The original's controller
    /// stops it after each hole.
    pub stops_spindle: bool,
    /// Functions that the original reserved or lacked. `T` in the manual mode teaches a hole. `?`
    /// returns a help text. `n` reads records back and counts them. Outside of the manual mode,
    /// which homes, `O` and `S` switch the spindle. `M` enters the manual mode and keeps the
    /// program. `p` asks whether the program runs. The device reports faults and jogs that end
    /// early. The original does not answer these bytes, or only echoes them.
    pub has_extras: bool,
}

impl Rules {
    /// The rules of the original.
    pub const FAITHFUL: Rules = Rules {
        begins_when_full: false,
        ends_when_empty: false,
        stops_at_border: false,
        zero_is_no_move: false,
        z_is_depth: false,
        stops_spindle: false,
        has_extras: false,
    };

    /// All flaws are corrected.
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
