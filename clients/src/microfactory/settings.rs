//! Settings of a microfactory.

use husillo_controllers::MicrofactoryConfig;
use husillo_gcode::Nm;
use husillo_transports::microfactory::ByteTable;

/// Rates, backlash and bytes of a machine.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Configuration of its controller.
    pub config: MicrofactoryConfig,
    /// The bytes of its link.
    pub table: ByteTable,
    /// Shortest interval between two steps that a motor can follow, in ticks of the controller.
    pub pull_out_ticks: u32,
    /// A step of X, Y and Z in nm, as numerator and denominator.
    pub steps: [[i128; 2]; 3],
}

impl Settings {
    /// The original: steps of 1.87 um, and motors that lose steps above 524.8 Hz of CLOCK.
    pub const ORIGINAL: Settings = Settings {
        config: MicrofactoryConfig::ORIGINAL,
        table: ByteTable::DEFAULT,
        pull_out_ticks: 1905,
        steps: [[1870, 1]; 3],
    };

    /// The steps of the axes of a figure.
    const fn figure_steps(&self) -> [[i128; 2]; 2] {
        let [x, _, z] = self.steps;
        [x, z]
    }

    /// The step nearest to a position in X and Z, halves rounded away from zero.
    pub fn nearest(&self, place: [Nm; 2]) -> [i64; 2] {
        let mut steps = [0; 2];
        for ((steps, Nm(nm)), [num, den]) in steps.iter_mut().zip(place).zip(self.figure_steps()) {
            let half_up = (2 * i128::from(nm).abs() * den + num).div_euclid(2 * num);
            let signed = half_up * i128::from(nm.signum());
            *steps = i64::try_from(signed).unwrap_or(i64::MAX);
        }
        steps
    }

    /// The position of these steps of X and Z, to the nearest nanometre.
    pub fn place(&self, steps: [i64; 2]) -> [Nm; 2] {
        let mut place = [Nm(0); 2];
        for ((nm, steps), [num, den]) in place.iter_mut().zip(steps).zip(self.figure_steps()) {
            *nm = length(steps, [num, den]);
        }
        place
    }
}

/// The length of a number of steps, to the nearest nanometre.
pub fn length(steps: i64, [num, den]: [i128; 2]) -> Nm {
    let rounded = (2 * i128::from(steps) * num + den).div_euclid(2 * den);
    Nm(i64::try_from(rounded).unwrap_or(i64::MAX))
}
