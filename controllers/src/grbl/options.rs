//! What Grbl decides when it is compiled.

/// Options of a Grbl controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GrblOptions {
    /// Name and version of the banner.
    pub banner: &'static [u8],
    /// Version of `$I`.
    pub version: &'static [u8],
    /// M7 and 0xA1 switch mist coolant.
    pub has_mist: bool,
    /// `$HX`, `$HY` and `$HZ` home one axis.
    pub homes_axes: bool,
    /// There is a safety door.
    pub has_door: bool,
    /// Status reports have the line number of the executing block.
    pub reports_lines: bool,
    /// Time from a hold, a cancelled jog or a contact of the probe until braking begins. In Grbl it
    /// takes until the segments that it has prepared have run.
    pub brakes_after_us: u32,
    /// While nothing happens, the controller gives waits, so that its inputs are read. Without this
    /// an input that changes while the machine stands is seen at the next byte or move.
    pub reads_inputs: bool,
    /// Highest step rate in steps/s that settings may ask for.
    pub most_steps_per_s: Option<u32>,
}

impl GrblOptions {
    /// The stock build, and as late in braking.
    pub const STOCK: GrblOptions = GrblOptions {
        banner: b"Grbl 1.1h",
        version: b"1.1h.20190830",
        has_mist: false,
        homes_axes: false,
        has_door: false,
        reports_lines: false,
        brakes_after_us: 48_000,
        reads_inputs: false,
        most_steps_per_s: None,
    };

    /// Everything that senders ask for, and braking at once.
    pub const FULL: GrblOptions = GrblOptions {
        has_mist: true,
        homes_axes: true,
        has_door: true,
        reports_lines: true,
        brakes_after_us: 0,
        most_steps_per_s: None,
        ..GrblOptions::STOCK
    };

    /// Letters of `[OPT:`.
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
