//! What the limit inputs of a module are wired to.

use super::machine::AxisSettings;
use husillo_transports::nmc::{Homing, Reply, Status};
use std::fmt;

/// What a limit input of a module is wired to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wiring {
    /// A contact of the probe.
    Probe,
    /// An end switch of the axis.
    End(End),
    /// Nothing: the input is not looked at.
    #[default]
    Nothing,
}

/// An end of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// At the least position.
    Low,
    /// At the largest position.
    High,
}

impl End {
    /// Whether a move by these counts leads towards this end.
    pub(super) const fn is_ahead(self, counts: i64) -> bool {
        match self {
            Self::Low => counts < 0,
            Self::High => counts > 0,
        }
    }

    /// -1 for the low end, 1 for the high one.
    pub(super) const fn sign(self) -> i32 {
        match self {
            Self::Low => -1,
            Self::High => 1,
        }
    }
}

impl fmt::Display for End {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Low => "low",
            Self::High => "high",
        })
    }
}

/// Event and status bit of each input.
const INPUTS: [(Homing, Status); 2] = [
    (Homing::LIMIT_1, Status::LIMIT_1),
    (Homing::LIMIT_2, Status::LIMIT_2),
];

impl AxisSettings {
    /// The end switches of the axis, with their events and status bits.
    fn ends(&self) -> impl Iterator<Item = (End, Homing, Status)> + use<> {
        let pairs = self.limits.into_iter().zip(INPUTS);
        pairs.filter_map(|(wiring, (event, bit))| match wiring {
            Wiring::End(end) => Some((end, event, bit)),
            Wiring::Probe | Wiring::Nothing => None,
        })
    }

    /// The end switch that home is searched from.
    #[must_use]
    pub fn end(&self) -> Option<End> {
        self.ends().next().map(|(end, ..)| end)
    }

    /// The events of the module that are a change of an end switch.
    pub(super) fn end_events(&self) -> Homing {
        let events = self.ends().map(|(_, event, _)| event);
        events.fold(Homing::default(), Homing::with)
    }

    /// The end switch that is closed.
    pub(super) fn closed_end(&self, reply: &Reply) -> Option<End> {
        let mut ends = self.ends();
        let closed = ends.find(|(.., bit)| reply.status.contains(*bit));
        closed.map(|(end, ..)| end)
    }
}
