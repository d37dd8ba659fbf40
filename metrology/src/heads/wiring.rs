//! Connections of the limit inputs of a module.

use super::machine::AxisSettings;
use husillo_transports::nmc::{Homing, Reply, Status};
use std::fmt;

/// The connection of a limit input of a module.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wiring {
    /// A contact of the probe.
    Probe,
    /// An end switch of the axis.
    End(End),
    /// Both end switches of the axis. The direction of travel shows which of them is closed.
    Ends,
    /// Nothing. The input is ignored.
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
    /// The end to which a move by these counts leads.
    pub(super) const fn towards(counts: i64) -> Option<Self> {
        match counts {
            ..0 => Some(Self::Low),
            0 => None,
            1.. => Some(Self::High),
        }
    }

    /// Whether a move by these counts leads towards this end.
    pub(super) const fn is_ahead(self, counts: i64) -> bool {
        match self {
            Self::Low => counts < 0,
            Self::High => counts > 0,
        }
    }

    /// -1 for the low end, 1 for the high end.
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
    /// The end switches of the axis, with their events and status bits. `None`: both.
    fn ends(&self) -> impl Iterator<Item = (Option<End>, Homing, Status)> + use<> {
        let pairs = self.limits.into_iter().zip(INPUTS);
        pairs.filter_map(|(wiring, (event, bit))| match wiring {
            Wiring::End(end) => Some((Some(end), event, bit)),
            Wiring::Ends => Some((None, event, bit)),
            Wiring::Probe | Wiring::Nothing => None,
        })
    }

    /// Returns the end switch that homing uses. If there are two, it is the low one.
    #[must_use]
    pub fn end(&self) -> Option<End> {
        self.ends().next().map(|(end, ..)| end.unwrap_or(End::Low))
    }

    /// The events of the module that report a change of an end switch.
    pub(super) fn end_events(&self) -> Homing {
        let events = self.ends().map(|(_, event, _)| event);
        events.fold(Homing::default(), Homing::with)
    }

    /// Whether an end switch is closed.
    pub(super) fn is_end_closed(&self, reply: &Reply) -> bool {
        let mut ends = self.ends();
        ends.any(|(.., bit)| reply.status.contains(bit))
    }

    /// The end of the closed switch, if its input has only one switch.
    pub(super) fn wired_end(&self, reply: &Reply) -> Option<End> {
        let mut ends = self.ends();
        let closed = ends.find(|(.., bit)| reply.status.contains(*bit));
        closed.and_then(|(end, ..)| end)
    }

    /// The end of the travel that is nearer to this position, counts from home.
    pub(super) fn nearer_end(&self, counts: i32) -> End {
        let [low, high] = self.travel;
        match counts.abs_diff(low) <= counts.abs_diff(high) {
            true => End::Low,
            false => End::High,
        }
    }
}
