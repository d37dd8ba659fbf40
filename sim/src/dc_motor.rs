//! DC motor with gear, load and friction: voltage in, angle out.

/// Parameters of a motor, referred to the output shaft of its gear.
///
/// # Source
/// The two equations of a brushed motor, `u = R i + L di/dt + k w` and
/// `J dw/dt = k i - friction - load`.
#[derive(Copy, Clone, PartialEq, Debug)]
pub struct DcMotorModel {
    /// Supply voltage at full duty, V.
    pub supply_v: f64,
    /// Winding resistance, ohm.
    pub resistance_ohm: f64,
    /// Winding inductance, H.
    pub inductance_h: f64,
    /// Torque constant, N m/A; the same number is the voltage constant in V s/rad.
    pub constant_nm_per_a: f64,
    /// Moment of inertia of rotor and load, kg m^2.
    pub inertia_kg_m2: f64,
    /// Viscous friction, N m s.
    pub viscous_nm_s: f64,
    /// Coulomb friction, N m.
    pub coulomb_nm: f64,
    /// Breakaway torque, N m; at least `coulomb_nm`.
    pub stiction_nm: f64,
    /// Encoder counts per revolution, all edges.
    pub counts_per_revolution: u32,
    /// Position of the encoder's index mark within a revolution, in counts from the position of the
    /// motor at power-up.
    pub index_counts: u32,
}

impl DcMotorModel {
    /// Motor of the prototype of the measuring machine: 12 V, about 300 rpm without load, 400
    /// counts per revolution. Voltage, speed and counts are those of the machine. The other values
    /// are assumptions that are typical of a geared motor of this speed.
    pub const PROTOTYPE: DcMotorModel = DcMotorModel {
        supply_v: 12.0,
        resistance_ohm: 8.0,
        inductance_h: 4e-3,
        constant_nm_per_a: 0.35,
        inertia_kg_m2: 4e-4,
        viscous_nm_s: 4e-4,
        coulomb_nm: 0.02,
        stiction_nm: 0.03,
        counts_per_revolution: 400,
        index_counts: 0,
    };

    /// Speed without load at full voltage, revolutions/s.
    pub fn free_speed_hz(&self) -> f64 {
        let torque = self.supply_v / self.resistance_ohm * self.constant_nm_per_a - self.coulomb_nm;
        let slope = self.constant_nm_per_a.powi(2) / self.resistance_ohm + self.viscous_nm_s;
        torque / slope / std::f64::consts::TAU
    }
}

/// Longest integration step, s: a twentieth of the time constant `L / R` of the prototype.
const LONGEST_STEP_S: f64 = 25e-6;

/// A simulated DC motor.
///
/// # Examples
/// ```
/// use husillo_sim::{DcMotor, DcMotorModel};
///
/// let mut motor = DcMotor::new(DcMotorModel::PROTOTYPE);
/// motor.advance(1.0, 0.0, 1.0);
/// assert!((1900..2100).contains(&motor.counts()));
/// ```
#[derive(Clone, Debug)]
pub struct DcMotor {
    model: DcMotorModel,
    current_a: f64,
    speed_rad_s: f64,
    angle_rad: f64,
}

impl DcMotor {
    /// Creates a motor at rest at count 0.
    pub fn new(model: DcMotorModel) -> DcMotor {
        DcMotor {
            model,
            current_a: 0.0,
            speed_rad_s: 0.0,
            angle_rad: 0.0,
        }
    }

    /// Runs the motor for `seconds`. `duty` is the mean voltage of a fast PWM, -1 to 1 times the
    /// supply. `load_nm` is a torque in N m against positive rotation. The integration is
    /// semi-implicit Euler in steps of at most 25 us.
    pub fn advance(&mut self, duty: f64, load_nm: f64, seconds: f64) {
        let steps = (seconds / LONGEST_STEP_S).ceil().max(1.0);
        let step_s = seconds / steps;
        for _ in 0..steps as u64 {
            self.step(duty.clamp(-1.0, 1.0) * self.model.supply_v, load_nm, step_s);
        }
    }

    /// Drives the motor for `seconds` while something blocks it. The current rises, and the rotor
    /// does not turn.
    pub fn push_against_a_stop(&mut self, duty: f64, seconds: f64) {
        self.speed_rad_s = 0.0;
        let m = &self.model;
        let voltage = duty.clamp(-1.0, 1.0) * m.supply_v;
        self.current_a = (self.current_a + seconds / m.inductance_h * voltage)
            / (1.0 + seconds * m.resistance_ohm / m.inductance_h);
    }

    fn step(&mut self, voltage: f64, load_nm: f64, step_s: f64) {
        let m = &self.model;
        // The current is integrated implicitly, which is stable for any step.
        let back = m.constant_nm_per_a * self.speed_rad_s;
        self.current_a = (self.current_a + step_s / m.inductance_h * (voltage - back))
            / (1.0 + step_s * m.resistance_ohm / m.inductance_h);
        let drive = m.constant_nm_per_a * self.current_a - load_nm;
        if self.speed_rad_s == 0.0 && drive.abs() <= m.stiction_nm {
            return;
        }
        let sense = if self.speed_rad_s == 0.0 {
            drive.signum()
        } else {
            self.speed_rad_s.signum()
        };
        let torque = drive - sense * m.coulomb_nm - m.viscous_nm_s * self.speed_rad_s;
        let speed = self.speed_rad_s + step_s / m.inertia_kg_m2 * torque;
        // Friction stops the motor but does not reverse it.
        self.speed_rad_s = if speed * sense < 0.0 { 0.0 } else { speed };
        self.angle_rad += step_s * self.speed_rad_s;
    }

    /// Stops the motor at once at its present position, as a hard stop does.
    pub fn stall(&mut self) {
        self.speed_rad_s = 0.0;
    }

    /// Angle in encoder counts, rounded down to whole edges.
    pub fn counts(&self) -> i64 {
        self.position_counts().floor() as i64
    }

    /// Level of the encoder index: high for one count in each revolution.
    pub fn is_at_index(&self) -> bool {
        let turn = i64::from(self.model.counts_per_revolution.max(1));
        (self.counts() - i64::from(self.model.index_counts)).rem_euclid(turn) == 0
    }

    /// Angle in encoder counts with a fraction, which the encoder does not report.
    pub fn position_counts(&self) -> f64 {
        let turns = self.angle_rad / std::f64::consts::TAU;
        turns * f64::from(self.model.counts_per_revolution)
    }

    /// Speed in encoder counts/s.
    pub fn counts_per_s(&self) -> f64 {
        self.speed_rad_s / std::f64::consts::TAU * f64::from(self.model.counts_per_revolution)
    }

    /// Winding current, A.
    pub fn current_a(&self) -> f64 {
        self.current_a
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_speed_is_that_of_the_equations() {
        let mut motor = DcMotor::new(DcMotorModel::PROTOTYPE);
        motor.advance(1.0, 0.0, 2.0);
        let wanted = DcMotorModel::PROTOTYPE.free_speed_hz() * 400.0;
        assert!(
            (motor.counts_per_s() - wanted).abs() < 1.0,
            "{}",
            motor.counts_per_s()
        );
        assert!((4.5..5.5).contains(&DcMotorModel::PROTOTYPE.free_speed_hz()));
    }

    #[test]
    fn stiction_holds_and_friction_stops() {
        let mut motor = DcMotor::new(DcMotorModel::PROTOTYPE);
        // 0.03 N m need 0.0857 A, that is 0.686 V or 5.7 % of the supply.
        motor.advance(0.056, 0.0, 1.0);
        assert_eq!((motor.counts(), motor.counts_per_s()), (0, 0.0));
        motor.advance(0.060, 0.0, 1.0);
        assert!(motor.counts() > 0);
        motor.advance(0.0, 0.0, 1.0);
        let rest = motor.counts();
        motor.advance(0.0, 0.0, 1.0);
        assert_eq!((motor.counts(), motor.counts_per_s()), (rest, 0.0));
    }

    #[test]
    fn a_blocked_motor_draws_the_current_of_its_winding() {
        let mut motor = DcMotor::new(DcMotorModel::PROTOTYPE);
        for _ in 0..2000 {
            motor.advance(1.0, 0.0, 1e-5);
            motor.stall();
        }
        assert!(
            (motor.current_a() - 1.5).abs() < 0.01,
            "{}",
            motor.current_a()
        );
    }
}
