//! A motor with its encoder, where there is none at the pins.

/// The motor of the prototype, as in the simulator (`DcMotorModel::PROTOTYPE`), one servo period
/// per step, in fixed point and without the inductance of its winding, whose effect ends within a
/// period.
///
/// Source: `J dw/dt = k i - friction`, `i = (u - k w) / R`, with speeds in counts per period times
/// 2^24.
pub struct Plant {
    /// Counts times 2^24.
    position: i64,
    /// Counts a period times 2^24; at most 2^25.
    speed: i32,
}

/// Speed gained per period by one of 255 PWM: 0.525 N m over 4e-4 kg m^2, 63.66 counts per radian,
/// 512 us, so 0.0219 counts per period.
const GAIN: i32 = 1441;
/// Share of the speed lost per period, times 2^16, to the induced voltage and to the friction that
/// grows with the speed: 0.0157125 N m s over the same.
const LOSS: i32 = 1318;
/// Lost to friction in a period: 0.02 N m.
const COULOMB: i32 = 13_997;
/// What does not move it: 0.03 N m.
const STICTION: i32 = 20_995;
/// Current that a speed of one count per period takes away: 30.7 rad/s times 0.35 V s over 8 ohm,
/// of 255 for 3 A.
const BACK: i32 = 114;

impl Plant {
    /// At rest at count 0.
    pub const fn new() -> Self {
        Plant {
            position: 0,
            speed: 0,
        }
    }

    /// A period with a drive of -255 to 255.
    pub fn tick(&mut self, drive: i16) {
        // Below 2^19.
        let push = i32::from(drive).wrapping_mul(GAIN);
        if self.speed == 0 && push.wrapping_abs() <= STICTION {
            return;
        }
        let sense = if self.speed == 0 { push } else { self.speed }.signum();
        // Speeds stay within 2^25, where push and loss are the same: products within 2^28.
        let loss = (self.speed >> 8).wrapping_mul(LOSS) >> 8;
        let gained = push
            .wrapping_sub(loss)
            .wrapping_sub(sense.wrapping_mul(COULOMB));
        let speed = self.speed.wrapping_add(gained);
        // Friction stops; it does not turn back.
        self.speed = if speed.signum() == -sense { 0 } else { speed };
        self.position = self.position.wrapping_add(self.speed.into());
    }

    /// Whole counts below where it is.
    pub fn counts(&self) -> i32 {
        (self.position >> 24) as i32
    }

    /// What a module's converter reads of the current at this drive.
    pub fn current(&self, drive: i16) -> u8 {
        // 255 PWM at rest are 1.5 A. Both times 2^8: within 2^15, and 2^17 * 2^7 on the way.
        let back = (self.speed >> 8).wrapping_mul(BACK) >> 8;
        let current = (i32::from(drive) << 7).wrapping_sub(back) >> 8;
        current.unsigned_abs().min(255) as u8
    }
}
