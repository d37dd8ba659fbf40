//! The kinds of canned cycles.

use crate::codes::letters::Letters;

/// The kind of a canned cycle.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Kind {
    /// G73: peck, with a short retract that breaks the chip.
    ChipBreak,
    /// G74: tapping, left hand.
    LeftTap,
    /// G76: threading in passes.
    Thread,
    /// G81.
    Drill,
    /// G82: drill, with a dwell at the bottom.
    DrillDwell,
    /// G83: peck, with a full retract.
    Peck,
    /// G84: tapping, right hand.
    Tap,
    /// G85: bore, feed out.
    Bore,
    /// G86: bore, spindle stopped, rapid out.
    BoreStop,
    /// G87: bore from below.
    BackBore,
    /// G88: bore, stop for the operator.
    BoreManual,
    /// G89: bore, dwell, feed out.
    BoreDwell,
    /// Turning cycle of lathes: G77, or G90 of code system A.
    TurnBox,
    /// Threading cycle of lathes: G78, or G92 of code system A.
    ThreadBox,
    /// Facing cycle of lathes: G79, or G94 of code system A.
    FaceBox,
    /// G74 of lathes: peck along Z.
    LathePeck,
}

impl Kind {
    /// Letters other than the axes that the cycle uses.
    pub(crate) const fn letters(self) -> Letters {
        match self {
            Kind::Drill | Kind::Bore => const { Letters::new(b"RL") },
            Kind::ChipBreak | Kind::Peck => const { Letters::new(b"RLQ") },
            Kind::DrillDwell | Kind::BoreStop | Kind::BoreManual | Kind::BoreDwell => {
                const { Letters::new(b"RLP") }
            }
            Kind::Tap | Kind::LeftTap => const { Letters::new(b"RLP") },
            Kind::BackBore => const { Letters::new(b"RLIJK") },
            Kind::Thread => const { Letters::new(b"PIJRKQHEL") },
            Kind::TurnBox | Kind::FaceBox => const { Letters::new(b"R") },
            Kind::ThreadBox => const { Letters::new(b"RK") },
            Kind::LathePeck => const { Letters::new(b"RQ") },
        }
    }
}
