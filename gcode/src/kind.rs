//! Which canned cycles there are.

/// Which cycle.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
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
    /// Letters beside the axes that the cycle uses.
    pub(crate) const fn letters(self) -> &'static [u8] {
        match self {
            Kind::Drill | Kind::Bore => b"RL",
            Kind::ChipBreak | Kind::Peck => b"RLQ",
            Kind::DrillDwell | Kind::BoreStop | Kind::BoreManual | Kind::BoreDwell => b"RLP",
            Kind::Tap | Kind::LeftTap => b"RLP",
            Kind::BackBore => b"RLIJK",
            Kind::Thread => b"PIJRKQHEL",
            Kind::TurnBox | Kind::FaceBox => b"R",
            Kind::ThreadBox => b"RK",
            Kind::LathePeck => b"RQ",
        }
    }
}
