//! The bytes with named bits.

/// Status byte, the first one of every reply.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Status(pub u8);

impl Status {
    /// The module is idle, the move is finished, or the servo is off. This bit is clear during a
    /// trapezoid, and in velocity mode until the goal velocity is reached.
    pub const MOVE_DONE: Status = Status(0x01);
    /// The packet just received was damaged, and nothing was executed.
    pub const CHECKSUM_ERROR: Status = Status(0x02);
    /// The current limit was exceeded. This bit stays set until Clear Bits.
    pub const OVERCURRENT: Status = Status(0x04);
    /// The motor supply is present.
    pub const POWER_ON: Status = Status(0x08);
    /// The position error exceeded its limit, or the servo was off. This bit stays set until Clear
    /// Bits.
    pub const POSITION_ERROR: Status = Status(0x10);
    /// Level of the input LIMIT1.
    pub const LIMIT_1: Status = Status(0x20);
    /// Level of the input LIMIT2.
    pub const LIMIT_2: Status = Status(0x40);
    /// Set Homing Mode waits for its event.
    pub const HOME_IN_PROGRESS: Status = Status(0x80);

    /// Whether all bits of `other` are set.
    pub const fn contains(self, other: Status) -> bool {
        self.0 & other.0 == other.0
    }
}

/// Auxiliary status byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Auxiliary(pub u8);

impl Auxiliary {
    /// Index input of the encoder.
    pub const INDEX: Auxiliary = Auxiliary(0x01);
    /// The 32-bit position has wrapped. This bit stays set until Clear Bits.
    pub const POSITION_WRAP: Auxiliary = Auxiliary(0x02);
    /// The position servo is on.
    pub const SERVO_ON: Auxiliary = Auxiliary(0x04);
    /// The acceleration of the move is over. The next start clears this bit.
    pub const ACCELERATION_DONE: Auxiliary = Auxiliary(0x08);
    /// The constant speed of the move is over. The next start clears this bit.
    pub const SLEW_DONE: Auxiliary = Auxiliary(0x10);
    /// A servo cycle was not finished in time. This bit stays set until Clear Bits.
    pub const SERVO_OVERRUN: Auxiliary = Auxiliary(0x20);
    /// The axis follows path points (version 5 and later).
    pub const PATH_MODE: Auxiliary = Auxiliary(0x40);

    /// Whether all bits of `other` are set.
    pub const fn contains(self, other: Auxiliary) -> bool {
        self.0 & other.0 == other.0
    }
}

/// The items of a reply after its status byte, in the order of their bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Items(pub u8);

impl Items {
    /// No item. The reply is then the status byte twice.
    pub const NONE: Items = Items(0x00);
    /// Position, `i32` counts.
    pub const POSITION: Items = Items(0x01);
    /// Motor current, `u8` of the converter.
    pub const CURRENT: Items = Items(0x02);
    /// Velocity, `i16` counts per servo cycle.
    pub const VELOCITY: Items = Items(0x04);
    /// [`Auxiliary`] status.
    pub const AUXILIARY: Items = Items(0x08);
    /// Home position, `i32` counts.
    pub const HOME: Items = Items(0x10);
    /// Kind and version of the module.
    pub const DEVICE: Items = Items(0x20);
    /// Position error, `i16` counts (version 5 and later).
    pub const POSITION_ERROR: Items = Items(0x40);
    /// Path points in the buffer (version 5 and later).
    pub const PATH_POINTS: Items = Items(0x80);

    /// Whether all bits of `other` are set.
    pub const fn contains(self, other: Items) -> bool {
        self.0 & other.0 == other.0
    }

    /// Returns the items of both.
    pub const fn with(self, other: Items) -> Items {
        Items(self.0 | other.0)
    }

    /// Returns the items that a module of this version sends. Before version 5 the upper two bits
    /// have no meaning.
    pub const fn of_version(self, version: u8) -> Items {
        if version < 5 {
            Items(self.0 & 0x3F)
        } else {
            self
        }
    }

    /// Returns the number of bytes of the items in a reply, 0 to 17. The reply has two more bytes.
    pub const fn length(self) -> usize {
        const BYTES: [u8; 8] = [4, 1, 2, 1, 4, 2, 2, 1];
        let mut bits = self.0;
        let mut length = 0;
        let mut rest: &[u8] = &BYTES;
        while let [bytes, next @ ..] = rest {
            if bits & 1 != 0 {
                length += *bytes as usize; // 17 in all
            }
            bits >>= 1;
            rest = next;
        }
        length
    }
}

/// The events that end homing, and how the motor then stops. If no event is set, homing is
/// cancelled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Homing(pub u8);

impl Homing {
    /// On any change of LIMIT1.
    pub const LIMIT_1: Homing = Homing(0x01);
    /// On any change of LIMIT2.
    pub const LIMIT_2: Homing = Homing(0x02);
    /// The motor is switched off when the event occurs.
    pub const MOTOR_OFF: Homing = Homing(0x04);
    /// On a change of the index.
    pub const INDEX: Homing = Homing(0x08);
    /// The motor stops abruptly when the event occurs.
    pub const ABRUPT: Homing = Homing(0x10);
    /// The motor stops smoothly when the event occurs.
    pub const SMOOTH: Homing = Homing(0x20);
    /// On excessive position error.
    pub const POSITION_ERROR: Homing = Homing(0x40);
    /// On overcurrent.
    pub const OVERCURRENT: Homing = Homing(0x80);
    /// All the events.
    pub const EVENTS: Homing = Homing(0xCB);

    /// Whether all bits of `other` are set.
    pub const fn contains(self, other: Homing) -> bool {
        self.0 & other.0 == other.0
    }

    /// Returns the bits of both.
    pub const fn with(self, other: Homing) -> Homing {
        Homing(self.0 | other.0)
    }

    /// Whether no event is set, which cancels homing.
    pub const fn is_cancel(self) -> bool {
        self.0 & Homing::EVENTS.0 == 0
    }
}
