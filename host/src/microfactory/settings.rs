//! What a machine file says of a microfactory.

use crate::machines::machine_file::MachineFile;
use husillo_controllers::MicrofactoryConfig;
use husillo_gcode::Nm;
use husillo_transports::microfactory::ByteTable;

/// Rates, lash and bytes of a machine.
#[derive(Clone, Debug)]
pub struct Settings {
    /// What its controller is made of.
    pub config: MicrofactoryConfig,
    /// The bytes of its link.
    pub table: ByteTable,
    /// The shortest interval of a motor's steps in ticks of the controller's timer.
    pub pull_out_ticks: u32,
    /// A step of X and of Z in nm, as numerator and denominator.
    steps: [[i128; 2]; 2],
}

impl Settings {
    /// Those of a machine; `None` where it has no `[bytes]`, and so is no microfactory.
    pub fn of(machine: &MachineFile) -> Option<Self> {
        let table = machine.bytes?;
        let [x, y, z] = &machine.axes;
        let small = |steps: u32| u16::try_from(steps).unwrap_or(u16::MAX);
        let pull_off = x.home.as_ref().map_or(200, |home| home.pull_off);
        let slowest = x.max_rate.min(y.max_rate).min(z.max_rate);
        Some(Self {
            config: MicrofactoryConfig {
                axis_rate_hz: small(slowest),
                lash_steps: [x, y, z].map(|axis| small(axis.lash_steps)),
                back_off_steps: small(pull_off),
                ..MicrofactoryConfig::ORIGINAL
            },
            table,
            pull_out_ticks: x.pull_out_ticks(MicrofactoryConfig::ORIGINAL.timer_hz),
            steps: [x, z].map(|axis| [axis.step.num, axis.step.den].map(i128::from)),
        })
    }

    /// The nearest step of a place in X and Z, halves away from zero.
    pub fn nearest(&self, place: [Nm; 2]) -> [i64; 2] {
        let mut steps = [0; 2];
        for ((steps, Nm(nm)), [num, den]) in steps.iter_mut().zip(place).zip(self.steps) {
            let half_up = (2 * i128::from(nm).abs() * den + num).div_euclid(2 * num);
            let signed = half_up * i128::from(nm.signum());
            *steps = i64::try_from(signed).unwrap_or(i64::MAX);
        }
        steps
    }

    /// Where so many steps of X and Z lead, to the nearest nanometre.
    pub fn place(&self, steps: [i64; 2]) -> [Nm; 2] {
        let mut place = [Nm(0); 2];
        for ((nm, steps), [num, den]) in place.iter_mut().zip(steps).zip(self.steps) {
            let rounded = (2 * i128::from(steps) * num + den).div_euclid(2 * den);
            *nm = Nm(i64::try_from(rounded).unwrap_or(i64::MAX));
        }
        place
    }
}
