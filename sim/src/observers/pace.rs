//! The programmed speed and the curve of a move, and the observer that measures the speed.

use crate::geometry::path::Path;
use crate::observers::speed::{Circle, Move, Speed, Stop};
use crate::observers::{Begun, Now, Observer};
use husillo_gcode::{Command, Feed, Nm};
use husillo_machine::Origin;
use std::io;

/// Speed and curve of a move.
fn pace(begun: &Begun<'_>) -> Move {
    let circle = match begun.path {
        Path::Arc(arc) => Some(Circle {
            plane: arc.plane,
            radius: 0.5 * (arc.radii[0] + arc.radii[1]),
        }),
        Path::Line { .. } | Path::Curve(_) | Path::Nurbs(_) => None,
    };
    let by_turns = |lead: Nm| lead.0 as f64 * begun.milli_rpm as f64 / 60e3;
    let programmed = match &begun.segment.command {
        Command::Thread { lead, .. } => Some(by_turns(*lead)),
        Command::Linear { feed, .. }
        | Command::Probe { feed, .. }
        | Command::Spline { feed, .. }
        | Command::Arc { feed, .. } => Some(match *feed {
            Feed::PerMinute(rate) => rate.0 as f64 / 60.0,
            Feed::InverseTime { micro_per_minute } => {
                begun.path.length() * micro_per_minute as f64 / 60e6
            }
            Feed::PerRevolution(lead) => by_turns(lead),
        }),
        _ => None,
    };
    Move { circle, programmed }
}

impl Observer for Speed {
    fn begin(&mut self, begun: &Begun<'_>) {
        self.turn(pace(begun));
    }

    #[inline]
    fn step(&mut self, now: &Now<'_>) -> io::Result<()> {
        if now.origin == Origin::TakeUp {
            self.stand(now.ticks, Stop::TakeUp);
        } else {
            self.advance(now.ticks, &now.place());
        }
        Ok(())
    }

    fn dwell(&mut self, ticks: u64) {
        self.stand(ticks, Stop::Dwell);
    }

    fn finish(&mut self) -> io::Result<()> {
        self.rest();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observers::tests::{begun, line, now};

    #[test]
    fn feed_dwell_and_take_up_are_recorded() {
        let mut speed = Speed::new(1_000_000, None);
        let (segment, path) = (line(Nm(1_000_000)), Path::line([0.0; 3], [1e6, 0.0, 0.0]));
        speed.begin(&begun(&segment, &path));
        for event in 1..=1000 {
            speed.step(&now(event)).unwrap();
        }
        speed.dwell(1_100_000);
        let seen = Now {
            origin: Origin::TakeUp,
            ticks: 1_200_000,
            ..now(1001)
        };
        speed.step(&seen).unwrap();
        speed.finish().unwrap();
        let (columns, _) = speed.columns();
        // A step of 1 um per millisecond, as programmed.
        let first = columns[0];
        assert_eq!((first.feed.high, first.programmed.high), (1e6, 1e6));
        let has = |what: fn(&crate::observers::speed::Column) -> bool| columns.iter().any(what);
        assert!(has(|column| column.dwell) && has(|column| column.take_up));
    }
}
