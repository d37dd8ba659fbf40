//! Curves (G5, G5.1, G5.2) as short straight moves.

use husillo_gcode::{Command, Feed, Nm, Spline};
use husillo_interp::{Chords, Nurbs, length};

use crate::{Config, MoveError, Segment};
use husillo_planner::mul_div;

/// A curve in progress: the ends of its chords, with the feed.
///
/// The steps are those of lines between the steps nearest to these ends. A chord is at most a
/// quarter of a step from the curve, so they are within 1.46 steps of it.
#[derive(Clone, Debug)]
pub struct Curve<const N: usize> {
    /// The curve as programmed.
    pub(crate) segment: Segment<N>,
    chords: Chords,
    to: [Nm; N],
    feed: Feed,
    /// Largest distance of a chord from the curve.
    pub(crate) tolerance: Nm,
}

impl<const N: usize> Curve<N> {
    /// Converts an inverse time of the curve to a path speed.
    fn timed(mut self) -> Self {
        if let Feed::InverseTime { micro_per_minute } = self.feed {
            let mut before = self.segment.from;
            let mut whole = 0_u64;
            for to in self.clone().map(|(to, _)| to) {
                let mut ways = [0; N];
                for (way, (from, to)) in ways.iter_mut().zip(before.iter().zip(to)) {
                    *way = to.0.abs_diff(from.0);
                }
                whole = whole.saturating_add(length(&ways, 0));
                before = to;
            }
            let rate = mul_div(whole, micro_per_minute, 1_000_000).max(1);
            self.feed = Feed::PerMinute(Nm(i64::try_from(rate).unwrap_or(i64::MAX)));
        }
        self
    }

    /// Whether no chord has been taken.
    pub(crate) const fn is_first(&self) -> bool {
        self.chords.remaining() == self.chords.total()
    }
}

impl<const N: usize> Iterator for Curve<N> {
    type Item = ([Nm; N], Feed);

    fn next(&mut self) -> Option<Self::Item> {
        let at = self.chords.next()?;
        let mut point = self.to;
        if self.chords.remaining() > 0 {
            for (point, at) in point.iter_mut().zip(at) {
                *point = Nm(at);
            }
        }
        Some((point, self.feed))
    }
}

/// The chords of a curve from `from` that are at most `tolerance` from it.
pub(crate) fn chords_of<const N: usize>(spline: &Spline<N>, tolerance: Nm) -> Chords {
    let points = spline.points.map(|point| point.map(|at| at.0));
    Chords::of_cubic(points, tolerance.0.unsigned_abs())
}

impl<const N: usize> Config<N> {
    /// A curve on this machine: its chords are at most a quarter of the shorter step from it.
    pub(crate) fn curve(&self, from: [Nm; N], spline: &Spline<N>, feed: Feed) -> Curve<N> {
        let command = Command::Spline {
            spline: *spline,
            feed,
        };
        let tolerance = self.chord_tolerance();
        Curve {
            segment: Segment { from, command },
            chords: chords_of(spline, tolerance),
            to: spline.to,
            feed,
            tolerance,
        }
        .timed()
    }

    fn chord_tolerance(&self) -> Nm {
        let steps = self.axes.iter().take(2).map(|axis| {
            let step = axis.scale.nm() / axis.scale.steps().max(1);
            i64::from(step / 4)
        });
        Nm(steps.min().unwrap_or(1).max(1))
    }

    /// Checks a curve, as [`Config::check`] does, along its whole length.
    pub(crate) fn check_curve(&self, curve: Curve<N>) -> Result<(), MoveError> {
        let mut before = curve.segment.from;
        for (to, _) in curve {
            self.check_point(&to)?;
            self.check_length(&before, &to)?;
            before = to;
        }
        Ok(())
    }
}

/// A NURBS (G5.2) whose control points come one by one.
#[derive(Clone, Debug)]
pub(crate) struct ControlPoints {
    nurbs: Nurbs,
    feed: Feed,
}

impl ControlPoints {
    pub(crate) const NONE: ControlPoints = ControlPoints {
        nurbs: Nurbs::new(3),
        feed: Feed::PerMinute(Nm(1)),
    };

    /// Takes a command of a curve that begins at `from`. Returns the curve with its last command.
    ///
    /// # Errors
    /// [`MoveError::TooManyPoints`] for more than 64 control points.
    pub(crate) fn take<const N: usize>(
        &mut self,
        config: &Config<N>,
        from: &[Nm; N],
        command: &Command<N>,
    ) -> Result<Option<Curve<N>>, MoveError> {
        match *command {
            Command::NurbsBegin {
                order,
                micro_weight,
                feed,
            } => {
                (self.nurbs, self.feed) = (Nurbs::new(order), feed);
                let mut at = [Nm(0); 2];
                for (at, from) in at.iter_mut().zip(from) {
                    *at = *from;
                }
                self.add(at, micro_weight)?;
            }
            Command::NurbsPoint { at, micro_weight } => self.add(at, micro_weight)?,
            Command::NurbsEnd { to } => {
                let tolerance = config.chord_tolerance();
                let curve = Curve {
                    segment: Segment {
                        from: *from,
                        command: *command,
                    },
                    chords: Chords::of_nurbs(&self.nurbs, tolerance.0.unsigned_abs()),
                    to,
                    feed: self.feed,
                    tolerance,
                };
                return Ok(Some(curve.timed()));
            }
            _ => {}
        }
        Ok(None)
    }

    fn add(&mut self, at: [Nm; 2], micro_weight: u64) -> Result<(), MoveError> {
        let added = self.nurbs.push(at.map(|at| at.0), micro_weight);
        added.map_err(|_| MoveError::TooManyPoints)
    }
}

/// Checks the commands of a program one after the other: [`Config::check`], also for curves that
/// take several commands (G5.2, G5.3).
#[derive(Clone, Debug)]
pub struct Checker {
    points: ControlPoints,
}

impl Default for Checker {
    fn default() -> Self {
        Self::new()
    }
}

impl Checker {
    /// No command has been checked.
    pub const fn new() -> Self {
        Checker {
            points: ControlPoints::NONE,
        }
    }

    /// Checks whether the machine can execute a command that begins at `from`.
    ///
    /// # Errors
    /// See [`MoveError`].
    pub fn check<const N: usize>(
        &mut self,
        config: &Config<N>,
        from: &[Nm; N],
        command: &Command<N>,
    ) -> Result<(), MoveError> {
        config.check(from, command)?;
        match self.points.take(config, from, command)? {
            Some(curve) => config.check_curve(curve),
            None => Ok(()),
        }
    }
}
