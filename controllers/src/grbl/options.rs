//! The options of a Grbl controller.

use husillo_gcode::Dialect;

/// The protocol that a controller speaks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Protocol {
    /// That of Grbl 1.1.
    #[default]
    Grbl,
    /// That of grblHAL: reports with more fields, settings that describe themselves, tools.
    #[cfg(feature = "grblhal")]
    GrblHal,
}

/// Options that Grbl fixes when it is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GrblOptions {
    /// The protocol.
    pub protocol: Protocol,
    /// Name and version in the banner.
    pub banner: &'static [u8],
    /// Version in the answer to `$I`.
    pub version: &'static [u8],
    /// Whether M7 and 0xA1 switch mist coolant.
    pub has_mist: bool,
    /// Whether `$HX`, `$HY` and `$HZ` home one axis.
    pub homes_axes: bool,
    /// Whether there is a safety door.
    pub has_door: bool,
    /// Whether status reports contain the line number of the present block.
    pub reports_lines: bool,
    /// Whether `$L=1` switches on numbers and checksums of lines.
    pub has_checked_lines: bool,
    /// Whether `$Z` commands define, measure and switch on a height map.
    #[cfg(feature = "height-map")]
    pub has_height_map: bool,
    /// Whether accidents of Grbl's implementation are imitated. After a hold, a cancelled jog or a
    /// probe contact, Grbl first makes the segments that it has already prepared: motion goes on
    /// for 40 to 50 ms. Equal override bytes that arrive together count once. An axis that waits
    /// for the others at its switch counts their steps until homing ends.
    pub has_accidents: bool,
    /// Whether the controller gives waits while nothing happens, so that its inputs are read.
    /// Without this, an input that changes while the machine is at rest is read only at the next
    /// byte or move.
    pub reads_inputs: bool,
    /// Highest step rate that the settings may request, in steps per second. `None`: no limit.
    pub most_steps_per_s: Option<u32>,
}

impl GrblOptions {
    /// Grbl as it is distributed, with its accidents.
    pub const STOCK: GrblOptions = GrblOptions {
        protocol: Protocol::Grbl,
        banner: b"Grbl 1.1h",
        version: b"1.1h.20190830",
        has_mist: false,
        homes_axes: false,
        has_door: false,
        reports_lines: false,
        has_checked_lines: false,
        #[cfg(feature = "height-map")]
        has_height_map: false,
        has_accidents: true,
        reads_inputs: false,
        most_steps_per_s: None,
    };

    /// Every option that senders use. Braking begins immediately.
    pub const FULL: GrblOptions = GrblOptions {
        has_mist: true,
        homes_axes: true,
        has_door: true,
        reports_lines: true,
        has_checked_lines: true,
        #[cfg(feature = "height-map")]
        has_height_map: true,
        has_accidents: false,
        most_steps_per_s: None,
        ..GrblOptions::STOCK
    };

    /// Every option, with the protocol of grblHAL.
    #[cfg(feature = "grblhal")]
    pub const HAL: GrblOptions = GrblOptions {
        protocol: Protocol::GrblHal,
        banner: b"GrblHAL 1.1f",
        version: b"1.1f.20260101",
        ..GrblOptions::FULL
    };

    /// Returns the dialect of the lines.
    pub(super) const fn dialect(&self) -> Dialect {
        match self.protocol {
            Protocol::Grbl => Dialect::GRBL,
            #[cfg(feature = "grblhal")]
            Protocol::GrblHal => Dialect::RS274,
        }
    }

    /// Whether a reset brakes the axes. Otherwise it stops them immediately.
    pub(super) const fn brakes_at_reset(&self) -> bool {
        match self.protocol {
            Protocol::Grbl => false,
            #[cfg(feature = "grblhal")]
            Protocol::GrblHal => true,
        }
    }

    /// Returns the letters of `[OPT:`.
    pub(super) fn letters(&self) -> ([u8; 5], usize) {
        let mut letters = (*b"V    ", 1);
        for (has, letter) in [
            (self.reports_lines, b'N'),
            (self.has_mist, b'M'),
            (self.homes_axes, b'H'),
            (self.has_door, b'+'),
        ] {
            if let (true, Some(slot)) = (has, letters.0.get_mut(letters.1)) {
                *slot = letter;
                letters.1 = letters.1.wrapping_add(1); // at most 5
            }
        }
        letters
    }
}
