//! The commands of moves that wait in the queue.

use core::fmt::Debug;

use husillo_gcode::{Arc, Command, Direction, Feed, Nm, Plane};

use crate::Segment;

/// A move as its place in the queue keeps it.
pub trait Kept<const N: usize>: Clone + Debug {
    /// Keeps a move, which is a part of `whole` if there is one.
    fn of(segment: &Segment<N>, whole: Option<&Segment<N>>) -> Self;
    /// The move as it was programmed, or the whole of which it is a part. It begins at `from`.
    fn segment(&self, from: [Nm; N]) -> Segment<N>;
    /// Whether it is a thread.
    fn is_thread(&self) -> bool;
}

/// The commands of any move.
impl<const N: usize> Kept<N> for Segment<N> {
    fn of(segment: &Segment<N>, whole: Option<&Segment<N>>) -> Self {
        *whole.unwrap_or(segment)
    }

    fn segment(&self, _: [Nm; N]) -> Segment<N> {
        *self
    }

    fn is_thread(&self) -> bool {
        matches!(self.command, Command::Thread { .. })
    }
}

/// The commands that a machine without equipment makes as moves. A command takes half the bytes:
/// its start is the end of the move before it, and a line has no centre.
#[derive(Clone, Debug)]
pub struct Compact<const N: usize> {
    to: [Nm; N],
    /// Centre in the plane, and `R` if it is not 0.
    centre: [Nm; 2],
    radius: Nm,
    /// Value of the feed; lead of a thread.
    feed: u64,
    /// In nm: a fraction of a millimetre, and at most an inch.
    mismatch: u32,
    resolution: u32,
    turns: u32,
    kind: Kind,
    feed_kind: FeedKind,
    plane: Plane,
    direction: Direction,
}

#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Kind {
    Rapid,
    Linear,
    Arc,
    Thread,
    Probe(Probing),
}

/// Whether a probing moves away, and whether it must meet the contact. In this form a [`Kind`] has
/// one byte.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Probing {
    Toward,
    TowardMust,
    Away,
    AwayMust,
}

impl Probing {
    const fn of(away: bool, must: bool) -> Probing {
        match (away, must) {
            (false, false) => Probing::Toward,
            (false, true) => Probing::TowardMust,
            (true, false) => Probing::Away,
            (true, true) => Probing::AwayMust,
        }
    }

    const fn is_away(self) -> bool {
        matches!(self, Probing::Away | Probing::AwayMust)
    }

    const fn is_must(self) -> bool {
        matches!(self, Probing::TowardMust | Probing::AwayMust)
    }
}

#[derive(Copy, Clone, Debug)]
enum FeedKind {
    PerMinute,
    InverseTime,
    PerRevolution,
}

impl FeedKind {
    /// The kind and the value of a feed.
    const fn of(feed: &Feed) -> (FeedKind, u64) {
        match *feed {
            Feed::PerMinute(Nm(rate)) => (FeedKind::PerMinute, rate as u64),
            Feed::InverseTime { micro_per_minute } => (FeedKind::InverseTime, micro_per_minute),
            Feed::PerRevolution(Nm(lead)) => (FeedKind::PerRevolution, lead as u64),
        }
    }

    const fn feed(self, value: u64) -> Feed {
        match self {
            FeedKind::PerMinute => Feed::PerMinute(Nm(value as i64)),
            FeedKind::InverseTime => Feed::InverseTime {
                micro_per_minute: value,
            },
            FeedKind::PerRevolution => Feed::PerRevolution(Nm(value as i64)),
        }
    }
}

impl<const N: usize> Kept<N> for Compact<N> {
    fn of(segment: &Segment<N>, _: Option<&Segment<N>>) -> Self {
        let mut kept = Compact {
            // Without equipment every move has an end.
            to: segment.command.end().unwrap_or(segment.from),
            centre: [Nm(0); 2],
            radius: Nm(0),
            mismatch: 0,
            feed: 0,
            resolution: 0,
            turns: 0,
            kind: Kind::Rapid,
            feed_kind: FeedKind::PerMinute,
            plane: Plane::Xy,
            direction: Direction::Clockwise,
        };
        let (kind, feed) = match &segment.command {
            Command::Linear { feed, .. } => (Kind::Linear, feed),
            Command::Probe {
                feed, away, must, ..
            } => (Kind::Probe(Probing::of(*away, *must)), feed),
            Command::Arc { arc, feed } => {
                kept.keep_arc(arc);
                (Kind::Arc, feed)
            }
            Command::Thread { lead, .. } => (Kind::Thread, &Feed::PerRevolution(*lead)),
            _ => return kept,
        };
        kept.kind = kind;
        (kept.feed_kind, kept.feed) = FeedKind::of(feed);
        kept
    }

    fn segment(&self, from: [Nm; N]) -> Segment<N> {
        let (to, feed) = (self.to, self.feed_kind.feed(self.feed));
        let command = match self.kind {
            Kind::Rapid => Command::Rapid { to },
            Kind::Linear => Command::Linear { to, feed },
            Kind::Arc => Command::Arc {
                arc: self.arc(&from),
                feed,
            },
            Kind::Thread => Command::Thread {
                to,
                lead: Nm(self.feed as i64),
            },
            Kind::Probe(probing) => Command::Probe {
                to,
                feed,
                away: probing.is_away(),
                must: probing.is_must(),
            },
        };
        Segment { from, command }
    }

    fn is_thread(&self) -> bool {
        self.kind == Kind::Thread
    }
}

impl<const N: usize> Compact<N> {
    fn keep_arc(&mut self, arc: &Arc<N>) {
        for (kept, axis) in self.centre.iter_mut().zip(arc.plane.axes()) {
            *kept = arc.centre.get(axis).copied().unwrap_or(Nm(0));
        }
        (self.plane, self.direction, self.turns) = (arc.plane, arc.direction, arc.turns);
        self.radius = arc.radius.unwrap_or(Nm(0));
        let short = |length: Nm| u32::try_from(length.0).unwrap_or(u32::MAX);
        (self.mismatch, self.resolution) = (short(arc.mismatch), short(arc.resolution));
    }

    fn arc(&self, from: &[Nm; N]) -> Arc<N> {
        let mut centre = *from;
        for (axis, kept) in self.plane.axes().into_iter().zip(self.centre) {
            if let Some(centre) = centre.get_mut(axis) {
                *centre = kept;
            }
        }
        Arc {
            to: self.to,
            centre,
            plane: self.plane,
            direction: self.direction,
            turns: self.turns,
            radius: Some(self.radius).filter(|radius| radius.0 != 0),
            mismatch: Nm(self.mismatch.into()),
            resolution: Nm(self.resolution.into()),
        }
    }
}
