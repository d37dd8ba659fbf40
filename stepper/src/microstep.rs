//! Microsteps: coil currents on a circle.

#[cfg(feature = "micromath")]
use crate::sine::AMPLITUDE;
use crate::sine::sine;

/// A sequencer with `PER_FULL` microsteps per full step: 1, 2, 4, ... 256.
///
/// It starts at 45 degrees with both coils at 71 %, as sine drives do after power-up. Currents are
/// in 1/32767 of full current and exact to half a unit. With the feature `micromath` they are
/// computed, with an error below 1.1e-3 of full current (36 units, tested against the table).
///
/// # Examples
/// ```
/// use husillo_stepper::Microstep;
/// let mut motor = Microstep::<16>::new();
/// for _ in 0..8 {
///     motor.step(1);
/// }
/// # #[cfg(not(feature = "micromath"))]
/// assert_eq!(motor.currents(), [0, 32767]); // half a full step on: coil B alone
/// ```
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Microstep<const PER_FULL: u16> {
    /// 1024ths of the electrical cycle, 0 to 1023.
    angle: u16,
}

impl<const PER_FULL: u16> Microstep<PER_FULL> {
    /// 1024ths of a cycle per microstep.
    const STRIDE: i16 = {
        assert!(
            PER_FULL.is_power_of_two() && PER_FULL <= 256,
            "microsteps per full step: a power of two, at most 256"
        );
        (256 / PER_FULL) as i16
    };

    /// Creates a motor at 45 degrees.
    #[must_use]
    pub const fn new() -> Self {
        Microstep { angle: 128 }
    }

    /// Moves by `delta` microsteps and returns the currents of coils A and B.
    pub fn step(&mut self, delta: i8) -> [i16; 2] {
        // |delta| * 256 <= 32768, taken modulo 1024. That divides 65536, so wrapping loses nothing.
        let turn = i16::from(delta).wrapping_mul(Self::STRIDE);
        self.angle = self.angle.wrapping_add_signed(turn) & 1023;
        self.currents()
    }

    /// Returns the currents of coils A and B: cosine and sine of the electrical angle.
    #[must_use]
    pub fn currents(&self) -> [i16; 2] {
        [wave(self.angle.wrapping_add(256)), wave(self.angle)]
    }

    /// Returns the electrical angle in 1024ths of a cycle.
    #[must_use]
    pub const fn angle(&self) -> u16 {
        self.angle
    }
}

impl<const PER_FULL: u16> Default for Microstep<PER_FULL> {
    fn default() -> Self {
        Microstep::new()
    }
}

#[cfg(not(feature = "micromath"))]
fn wave(angle: u16) -> i16 {
    sine(angle)
}

#[cfg(feature = "micromath")]
fn wave(angle: u16) -> i16 {
    use micromath::F32Ext;
    // Named in full: where std is linked, f32 has methods of these names.
    // The quarter positions are exact, so that a coil that should be off is off.
    if angle & 255 == 0 {
        return sine(angle);
    }
    let radians = f32::from(angle & 1023) * (core::f32::consts::TAU / 1024.0);
    // A cast from float saturates. The approximation may exceed 1 by its error.
    F32Ext::round(F32Ext::sin(radians) * f32::from(AMPLITUDE)) as i16
}
