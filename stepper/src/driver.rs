//! The power stages, and the currents for their input levels.

use crate::Levels;

/// 100 % of a coil's current in [`Driver::currents`].
pub const FULL_CURRENT: i16 = 1000;

/// The power stage of one two-phase motor.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Driver {
    /// Two PBL3717A, one per phase: 100, 60, 20 and 0 % by I1 and I0 (data sheet: 420, 250 and 80
    /// mV at the comparator).
    Pbl3717a,
    /// Half an A3988: the same inputs, 100, 66.7, 33.3 and 0 %.
    A3988,
    /// An L297 sequencer with its H bridges: A B C D, INH1 and INH2, HOME.
    L297,
    /// A unipolar motor on four switches; coils 0 and 2 share a pole pair, as do 3 and 1.
    Unipolar,
    /// Two bridges of which only PH is driven, at full current: the micro mill's first controller.
    /// Full step only.
    PhasePair,
}

impl Driver {
    /// The currents of coils A and B in thousandths of the full current, for these input levels.
    ///
    /// It follows from the data sheets alone, not from a step table: every byte has currents.
    ///
    /// # Examples
    /// ```
    /// use husillo_stepper::{Driver, Levels};
    /// // PH of A high, I1 I0 = 00; PH of B low, I0 of B high: 60 % backwards.
    /// assert_eq!(Driver::Pbl3717a.currents(Levels(0b010_001)), [1000, -600]);
    /// ```
    #[must_use]
    pub const fn currents(self, levels: Levels) -> [i16; 2] {
        let bits = levels.0;
        match self {
            Driver::Pbl3717a => {
                let scale = [FULL_CURRENT, 600, 200, 0];
                [bridge(bits, scale), bridge(bits >> 3, scale)]
            }
            Driver::A3988 => {
                let scale = [FULL_CURRENT, 667, 333, 0];
                [bridge(bits, scale), bridge(bits >> 3, scale)]
            }
            Driver::L297 => [
                if bits & 0x10 == 0 {
                    0
                } else {
                    push_pull(bits, bits >> 1)
                },
                if bits & 0x20 == 0 {
                    0
                } else {
                    push_pull(bits >> 2, bits >> 3)
                },
            ],
            Driver::Unipolar => [push_pull(bits, bits >> 2), push_pull(bits >> 3, bits >> 1)],
            Driver::PhasePair => {
                // The inhibit line drives I0 and I1 of both bridges.
                let inhibit = if bits & 4 == 0 { 0 } else { 6 };
                let scale = [FULL_CURRENT, 0, 0, 0];
                [
                    bridge(bits & 1 | inhibit, scale),
                    bridge(bits >> 1 & 1 | inhibit, scale),
                ]
            }
        }
    }

    /// The names of the inputs, bit 0 first.
    #[must_use]
    pub const fn pins(self) -> &'static [&'static str] {
        match self {
            Driver::Pbl3717a | Driver::A3988 => &["PHA", "I0A", "I1A", "PHB", "I0B", "I1B"],
            Driver::L297 => &["A", "B", "C", "D", "INH1", "INH2", "HOME"],
            Driver::Unipolar => &["P0", "P1", "P2", "P3"],
            Driver::PhasePair => &["PHA", "PHB", "INHIBIT"],
        }
    }

    /// The number of inputs. HOME of the L297 is an output.
    #[must_use]
    pub const fn inputs(self) -> usize {
        match self {
            Driver::Pbl3717a | Driver::A3988 | Driver::L297 => 6,
            Driver::Unipolar => 4,
            Driver::PhasePair => 3,
        }
    }

    /// The names machine files use: `pbl3717a`, `a3988`, `l297`, `unipolar`, `phase-pair`.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Driver> {
        Some(match name {
            "pbl3717a" => Driver::Pbl3717a,
            "a3988" => Driver::A3988,
            "l297" => Driver::L297,
            "unipolar" => Driver::Unipolar,
            "phase-pair" => Driver::PhasePair,
            _ => return None,
        })
    }
}

/// One bridge with PH, I0 and I1 in bits 0, 1 and 2; `scale` by the number I1 I0.
const fn bridge(bits: u8, scale: [i16; 4]) -> i16 {
    // Two bits index four entries.
    let size = scale[(bits >> 1 & 3) as usize];
    // At most FULL_CURRENT, so the negation never wraps.
    if bits & 1 == 0 {
        size.wrapping_neg()
    } else {
        size
    }
}

/// A winding between two switches: bit 0 of `forward` against bit 0 of `backward`.
const fn push_pull(forward: u8, backward: u8) -> i16 {
    match (forward & 1, backward & 1) {
        (1, 0) => FULL_CURRENT,
        (0, 1) => -FULL_CURRENT,
        _ => 0,
    }
}
