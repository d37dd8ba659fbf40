//! A simulated motor with its encoder, for a board without a motor at its pins.

/// The motor of the prototype, as in the simulator (`DcMotorModel::PROTOTYPE`), in fixed point. A
/// step is one servo period. The inductance of the winding is left out, because its effect ends
/// within a period.
///
/// Source: `J dw/dt = k i - friction`, `i = (u - k w) / R`, with speeds in counts per period times
/// 2^24.
pub struct Plant {
    /// In counts times 2^24.
    position: i64,
    /// In counts per period times 2^24; at most 2^25.
    speed: i32,
}

/// Speed gained per period by a PWM of 1/255: 0.525 N m over 4e-4 kg m^2, 63.66 counts per radian,
/// 512 us, so 0.0219 counts per period.
const GAIN: i32 = 1441;
/// Share of the speed lost per period, times 2^16, to the induced voltage and to the friction that
/// grows with the speed: 0.0157125 N m s over the same.
const LOSS: i32 = 1318;
/// Speed lost per period to dry friction: 0.02 N m.
const COULOMB: i32 = 13_997;
/// The largest gain of speed per period that does not start the motor: 0.03 N m.
const STICTION: i32 = 20_995;
/// Current that the voltage induced at one count per period takes away: 30.7 rad/s times 0.35 V s
/// over 8 ohm. A current of 255 is 3 A.
const BACK: i32 = 114;

impl Plant {
    /// At rest at count 0.
    pub const fn new() -> Self {
        Plant {
            position: 0,
            speed: 0,
        }
    }

    /// Advances by one period with a drive of -255 to 255.
    pub fn tick(&mut self, drive: i16) {
        // Below 2^19.
        let push = i32::from(drive).wrapping_mul(GAIN);
        if self.speed == 0 && push.wrapping_abs() <= STICTION {
            return;
        }
        let sense = if self.speed == 0 { push } else { self.speed }.signum();
        // The speed stays within 2^25, where push and loss balance. So products stay within 2^28.
        let loss = (self.speed >> 8).wrapping_mul(LOSS) >> 8;
        let gained = push
            .wrapping_sub(loss)
            .wrapping_sub(sense.wrapping_mul(COULOMB));
        let speed = self.speed.wrapping_add(gained);
        // Friction stops the motor, but does not reverse it.
        self.speed = if speed.signum() == -sense { 0 } else { speed };
        self.position = self.position.wrapping_add(self.speed.into());
    }

    /// The position in whole counts, rounded down.
    pub fn counts(&self) -> i32 {
        (self.position >> 24) as i32
    }

    /// The current at this drive, as the converter of a module reads it.
    pub fn current(&self, drive: i16) -> u8 {
        // A PWM of 255 at rest gives 1.5 A. Both terms are times 2^8 and stay within 2^15. The
        // product before the shift stays within 2^17 * 2^7.
        let back = (self.speed >> 8).wrapping_mul(BACK) >> 8;
        let current = (i32::from(drive) << 7).wrapping_sub(back) >> 8;
        current.unsigned_abs().min(255) as u8
    }
}
