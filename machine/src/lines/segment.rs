//! One move command, and its conversion to steps.

use husillo_gcode::{Command, Nm};
use husillo_interp::{ArcError, ArcMove, GridArc, GridEllipse, Moves, Totals, length};

use crate::lines::arc::in_plane;
use crate::lines::curve::chords_of;
use crate::{Config, MoveError};
use husillo_planner::mul_div;

/// Largest number of events of one arc: the range of `i32` steps and of the `u32` counts of the
/// interpolator.
const MAX_EVENTS: u64 = 1 << 31;

/// A move as it was programmed.
#[derive(Copy, Clone, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Segment<const N: usize> {
    /// Start position in the machine frame.
    pub from: [Nm; N],
    /// The command.
    pub command: Command<N>,
}

/// An arc on the grid of its axes.
enum OnGrid {
    /// It is too short for an arc.
    Line,
    Circle(GridArc),
    /// The steps of its axes differ.
    Ellipse(GridEllipse),
}

/// Where a command begins.
#[derive(Copy, Clone)]
pub(crate) struct Start<'a, const N: usize> {
    pub(crate) at: &'a [Nm; N],
    /// The steps nearest to this position, where they are known.
    pub(crate) steps: Option<[i32; N]>,
}

impl<'a, const N: usize> Start<'a, N> {
    const fn of(at: &'a [Nm; N]) -> Self {
        Start { at, steps: None }
    }
}

/// Distance of the chords from a curve whose extent is computed.
const EXTENT_TOLERANCE: Nm = Nm(100);

/// Lowest and highest coordinate of a move from `from` in the machine frame. For a line these are
/// those of its end, because it begins at the end of another move. `None` for an axis that does not
/// move.
#[must_use]
pub fn extent<const N: usize>(from: &[Nm; N], command: &Command<N>) -> [Option<[Nm; 2]>; N] {
    let mut extents = [None; N];
    if let Command::NurbsPoint { at, .. } = command {
        // The curve is within its control points.
        for (extent, at) in extents.iter_mut().zip(at) {
            *extent = Some([*at, *at]);
        }
    }
    let Some(to) = command.end() else {
        return extents;
    };
    for ((extent, from), to) in extents.iter_mut().zip(from).zip(to) {
        if *from != to {
            *extent = Some([to, to]);
        }
    }
    if let Command::Spline { spline, .. } = command {
        for (extent, at) in extents.iter_mut().zip(spline.to).take(2) {
            *extent = Some([at, at]);
        }
        for to in chords_of(spline, EXTENT_TOLERANCE) {
            for (extent, to) in extents.iter_mut().zip(to.map(Nm)) {
                if let Some([low, high]) = extent {
                    (*low, *high) = ((*low).min(to), (*high).max(to));
                }
            }
        }
    }
    if let Command::Arc { arc, .. } = command {
        for (axis, span) in arc
            .plane
            .axes()
            .into_iter()
            .zip(in_plane(from, arc).extent())
        {
            if let Some(extent) = extents.get_mut(axis) {
                *extent = Some(span.map(Nm));
            }
        }
    }
    extents
}

impl<const N: usize> Config<N> {
    /// Returns the steps nearest to a position in the machine frame.
    ///
    /// # Errors
    /// [`MoveError::Reach`] for the first axis that would be beyond 2^31 steps.
    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    pub fn nearest_steps(&self, at: &[Nm; N]) -> Result<[i32; N], MoveError> {
        let mut steps = [0; N];
        // Not `enumerate`: the compiler would assume that its count may overflow.
        let axes = self.axes.iter().zip(at).zip(&mut steps);
        for (number, ((axis, at), step)) in (0..N).zip(axes) {
            *step = axis
                .scale
                .nearest(at.0)
                .ok_or(MoveError::Reach { axis: number })?;
        }
        Ok(steps)
    }

    /// Checks whether this machine can execute a command. Of a curve of several commands (G5.2,
    /// G5.3) this is only whether it has means for it; [`Checker`](crate::Checker) checks the rest.
    ///
    /// # Errors
    /// See [`MoveError`].
    pub fn check(&self, from: &[Nm; N], command: &Command<N>) -> Result<(), MoveError> {
        self.check_any(Start::of(from), command).map(drop)
    }

    /// Does [`Config::check`]. Returns the steps nearest to the end of a plain move.
    pub(crate) fn check_any(
        &self,
        from: Start<'_, N>,
        command: &Command<N>,
    ) -> Result<Option<[i32; N]>, MoveError> {
        let steps = self.check_grid::<true, _>(from, command, |_| true)?;
        match command {
            Command::Spline { spline, feed } => {
                self.check_curve(self.curve(*from.at, spline, *feed))?;
            }
            Command::Tap { bottom, to, lead } => {
                let turns = self.equipment.tapping_overrun_turns.unwrap_or(0);
                let [below, above] = self.beyond(to, bottom, *lead, turns);
                self.check_point(&below)?;
                self.check_point(&above)?;
                self.check_length(&below, &above)?;
            }
            _ => {}
        }
        Ok(steps)
    }

    /// Does [`Config::check`] for a machine without curves and taps. Returns the steps nearest to
    /// the end of a move.
    #[inline]
    pub(crate) fn check_moves<P: Moves<N>>(
        &self,
        from: Start<'_, N>,
        command: &Command<N>,
    ) -> Result<Option<[i32; N]>, MoveError> {
        if P::HAS_ELLIPSES {
            self.check_grid::<true, _>(from, command, |_| true)
        } else {
            self.check_grid::<false, _>(from, command, |_| true)
        }
    }

    /// Does [`Config::check`] for methods that cannot make every arc.
    ///
    /// # Errors
    /// In addition, [`MoveError::ArcTooLarge`] for an arc that does not fit, and
    /// [`MoveError::UnequalSteps`] for every arc in a plane of unequal steps.
    #[inline]
    pub fn check_arcs<F: Fn(&ArcMove) -> bool>(
        &self,
        from: &[Nm; N],
        command: &Command<N>,
        fits: F,
    ) -> Result<(), MoveError> {
        self.check_grid::<false, _>(Start::of(from), command, fits)
            .map(drop)
    }

    /// `ELLIPSES`: arcs in planes of unequal steps are possible. Firmware without them does not
    /// contain their code.
    #[inline]
    fn check_grid<const ELLIPSES: bool, F: Fn(&ArcMove) -> bool>(
        &self,
        from: Start<'_, N>,
        command: &Command<N>,
        fits: F,
    ) -> Result<Option<[i32; N]>, MoveError> {
        if let Some(means) = self
            .equipment
            .missing(command, self.spindle_counts.is_some())
        {
            return Err(MoveError::Unsupported(means));
        }
        let to = match command {
            Command::Rapid { to }
            | Command::Linear { to, .. }
            | Command::Thread { to, .. }
            | Command::Probe { to, .. } => to,
            Command::Arc { arc, .. } => &arc.to,
            _ => return Ok(None),
        };
        let end = self.check_point(to)?;
        let start = match from.steps {
            Some(start) => start,
            None => self.nearest_steps(from.at)?,
        };
        let longest = longest(&start, &end)?;
        if let Command::Arc { arc, .. } = command {
            let plane = arc.plane.axes();
            let mut flat = in_plane(from.at, arc);
            if ELLIPSES {
                flat = self.made_arc(&flat, arc)?.unwrap_or(flat);
            }
            for (number, [low, high]) in plane.into_iter().zip(flat.extent()) {
                self.check_travel(number, Nm(low))?;
                self.check_travel(number, Nm(high))?;
            }
            let mismatch = arc.mismatch;
            match self.arc_tolerance {
                Some(tolerance) if mismatch.0 > tolerance.0 => {
                    return Err(MoveError::ArcTolerance {
                        mismatch,
                        tolerance,
                    });
                }
                _ => {}
            }
            // A turn has fewer than 6 (r + 4) events; a helix has in addition as many as its
            // longest axis has steps.
            let radius_steps = match self.grid_arc::<ELLIPSES>(from.at, arc, start, end)? {
                OnGrid::Circle(grid) if !fits(&grid.arc) => return Err(MoveError::ArcTooLarge),
                OnGrid::Circle(grid) => Some(grid.radius_steps),
                OnGrid::Ellipse(grid) => Some(grid.radius_steps()),
                OnGrid::Line => None,
            };
            let events = radius_steps.map_or(0, |radius_steps| {
                u64::from(radius_steps)
                    .saturating_add(4)
                    .saturating_mul(6)
                    .saturating_mul(u64::from(arc.turns).saturating_add(1))
            });
            if events.saturating_add(longest) > MAX_EVENTS {
                return Err(MoveError::ArcTooLarge);
            }
        }
        Ok(Some(end))
    }

    /// The positions this number of turns beyond the bottom and beyond the top of a tap.
    pub(crate) fn beyond(
        &self,
        top: &[Nm; N],
        bottom: &[Nm; N],
        lead: Nm,
        turns: u8,
    ) -> [[Nm; N]; 2] {
        let mut ways = [0; N];
        for (way, (top, bottom)) in ways.iter_mut().zip(top.iter().zip(bottom)) {
            *way = top.0.abs_diff(bottom.0);
        }
        let whole = length(&ways, 0).max(1);
        let over = lead.0.unsigned_abs().saturating_mul(turns.into());
        let mut beyond = [*bottom, *top];
        let [below, above] = &mut beyond;
        for ((below, above), way) in below.iter_mut().zip(above).zip(ways) {
            let share = mul_div(way, over, whole);
            // Beyond the range of coordinates it is beyond that of the axis.
            let share = i64::try_from(share).unwrap_or(i64::MAX);
            let share = if *below < *above {
                share
            } else {
                share.wrapping_neg()
            };
            below.0 = below.0.saturating_sub(share);
            above.0 = above.0.saturating_add(share);
        }
        beyond
    }

    /// The largest number of steps of one axis.
    pub(crate) fn check_length(&self, from: &[Nm; N], to: &[Nm; N]) -> Result<u64, MoveError> {
        longest(&self.nearest_steps(from)?, &self.nearest_steps(to)?)
    }

    /// Checks the travel of all axes at a position. Returns the steps nearest to it.
    pub(crate) fn check_point(&self, to: &[Nm; N]) -> Result<[i32; N], MoveError> {
        let steps = self.nearest_steps(to)?;
        for (number, at) in (0..N).zip(to) {
            self.check_travel(number, *at)?;
        }
        Ok(steps)
    }

    /// Checks that a position of an axis is within its travel in the machine frame. An axis without
    /// travel accepts every position, and so does an axis that does not exist.
    ///
    /// # Errors
    /// [`MoveError::Travel`] if the position is more than half a step beyond the travel.
    pub fn check_travel(&self, number: usize, position: Nm) -> Result<(), MoveError> {
        let Some([low, high]) = self.axes.get(number).and_then(|axis| axis.travel) else {
            return Ok(());
        };
        if low <= position && position <= high {
            return Ok(());
        }
        // Half a step, because rounding can move an arc that touches the limit.
        let slack = self.axes.get(number).map_or(0, |axis| {
            let step = axis.scale.nm().div_ceil(axis.scale.steps().max(1));
            i64::from(step.div_ceil(2))
        });
        let limit = if position < low { low } else { high };
        if position.0.abs_diff(limit.0) <= slack.unsigned_abs() {
            return Ok(());
        }
        Err(MoveError::Travel {
            axis: number,
            position,
            limit,
        })
    }

    /// The arc on the grid.
    fn grid_arc<const ELLIPSES: bool>(
        &self,
        from: &[Nm; N],
        arc: &husillo_gcode::Arc<N>,
        start: [i32; N],
        end: [i32; N],
    ) -> Result<OnGrid, MoveError> {
        let plane = arc.plane.axes();
        let [Some(first), Some(second)] = plane.map(|number| self.axes.get(number)) else {
            return Err(MoveError::UnequalSteps);
        };
        let is_equal = first.scale == second.scale;
        if !is_equal && !ELLIPSES {
            return Err(MoveError::UnequalSteps);
        }
        let steps = [start, end].map(|at| plane.map(|axis| at.get(axis).copied().unwrap_or(0)));
        let mut flat = in_plane(from, arc);
        // Firmware without arcs on unequal steps does not contain the code that moves a centre.
        if ELLIPSES {
            let Some(made) = self.made_arc(&flat, arc)? else {
                return Ok(OnGrid::Line);
            };
            flat = made;
        }
        let grid = if is_equal {
            flat.on_grid(first.scale, steps).map(OnGrid::Circle)
        } else {
            let scales = [first.scale, second.scale];
            flat.on_grids(scales, steps).map(OnGrid::Ellipse)
        };
        match grid {
            Err(ArcError::Degenerate) => Ok(OnGrid::Line),
            Err(ArcError::Unequal) => Err(MoveError::UnequalSteps),
            grid => grid.map_err(|_| MoveError::ArcTooLarge),
        }
    }

    /// Returns the path of a move that has passed [`Config::check`].
    ///
    /// `start` and `end` are the steps of the axes at both ends; the path begins exactly at `from`.
    pub fn path<P: Moves<N>>(&self, segment: &Segment<N>, start: [i32; N], end: [i32; N]) -> P {
        self.path_again(segment, start, end, None)
    }

    /// Does [`Config::path`] for a move whose path was made before. `totals` are the
    /// [`Moves::totals_of_arc`] of that path.
    pub(crate) fn path_again<P: Moves<N>>(
        &self,
        segment: &Segment<N>,
        start: [i32; N],
        end: [i32; N],
        totals: Option<Totals>,
    ) -> P {
        let mut delta = [0; N];
        for ((delta, start), end) in delta.iter_mut().zip(start).zip(end) {
            *delta = end.wrapping_sub(start);
        }
        if let Command::Arc { arc, .. } = &segment.command {
            let plane = arc.plane.axes();
            let grid = if P::HAS_ELLIPSES {
                self.grid_arc::<true>(&segment.from, arc, start, end)
            } else {
                self.grid_arc::<false>(&segment.from, arc, start, end)
            };
            match grid {
                Ok(OnGrid::Circle(grid)) => {
                    // Returned from here: each copy of a path takes 264 bytes of stack.
                    let path = match totals {
                        Some(totals) => P::arc_again(&grid.arc, plane, delta, totals),
                        None => P::arc(&grid.arc, plane, delta),
                    };
                    if let Ok(path) = path {
                        return path;
                    }
                }
                Ok(OnGrid::Ellipse(grid)) if P::HAS_ELLIPSES => {
                    if let Ok(path) = P::ellipse(&grid, plane, delta) {
                        return path;
                    }
                }
                _ => {}
            }
        }
        // The interpolator reports an arc that is too small, which becomes a line. After `check`
        // there is no other reason: the radius, the events and the plane were verified.
        P::line(delta)
    }
}

/// The largest number of steps of one axis between two positions.
fn longest<const N: usize>(start: &[i32; N], end: &[i32; N]) -> Result<u64, MoveError> {
    let mut longest = 0;
    for (axis, (start, end)) in (0..N).zip(start.iter().zip(end)) {
        let steps = end.checked_sub(*start).ok_or(MoveError::Reach { axis })?;
        longest = u64::from(steps.unsigned_abs()).max(longest);
    }
    Ok(longest)
}
