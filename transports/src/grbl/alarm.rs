//! Alarms by number.

/// An alarm. The position may be wrong, or motion was interrupted. Motion is locked until the
/// operator unlocks it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Alarm {
    /// A limit switch has closed. Motion is locked until a reset.
    HardLimit = 1,
    /// A target is outside the travel. Motion is locked until a reset.
    SoftLimit = 2,
    /// A reset during motion.
    AbortCycle = 3,
    /// The probe was not in the expected state before its move.
    ProbeInitial = 4,
    /// The probe did not change.
    ProbeContact = 5,
    /// A reset during homing.
    HomingReset = 6,
    /// The safety door was opened during homing.
    HomingDoor = 7,
    /// The pull-off did not open the switch.
    HomingPullOff = 8,
    /// The search found no switch.
    HomingApproach = 9,
    /// The axes must be homed first. Only grblHAL has this alarm.
    HomingRequired = 11,
}

impl Alarm {
    /// All alarms by number.
    pub const ALL: [Alarm; 10] = [
        Alarm::HardLimit,
        Alarm::SoftLimit,
        Alarm::AbortCycle,
        Alarm::ProbeInitial,
        Alarm::ProbeContact,
        Alarm::HomingReset,
        Alarm::HomingDoor,
        Alarm::HomingPullOff,
        Alarm::HomingApproach,
        Alarm::HomingRequired,
    ];

    /// Returns its number.
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// Returns the alarm with this number.
    pub fn of(number: u8) -> Option<Alarm> {
        Alarm::ALL
            .into_iter()
            .find(|alarm| alarm.number() == number)
    }

    /// Returns a description.
    pub const fn text(self) -> &'static str {
        match self {
            Alarm::HardLimit => "a limit switch was touched",
            Alarm::SoftLimit => "the target is outside the travel",
            Alarm::AbortCycle => "reset during motion: the position may be wrong",
            Alarm::ProbeInitial => "the probe was not in the expected state",
            Alarm::ProbeContact => "the probe did not change",
            Alarm::HomingReset => "reset during homing",
            Alarm::HomingDoor => "the door was opened during homing",
            Alarm::HomingPullOff => "the pull-off did not open the switch",
            Alarm::HomingApproach => "homing found no switch",
            Alarm::HomingRequired => "the axes must be homed first",
        }
    }
}
