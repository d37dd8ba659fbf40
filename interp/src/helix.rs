//! Helix: an arc in one plane with linear motion of the other axes in proportion to the swept area.

use crate::interpolator::Totals;
use crate::method::{Method, interpolator};
use crate::{Arc, ArcError, ArcMove, Conic, GridEllipse, Interpolator, Run, Step};

/// An arc in the plane of two axes while the other axes move linearly in proportion to the swept
/// area. (In proportion to the count of events they would be 0.5 % off.)
///
/// Where an axis has more steps than the events of the plane can carry, events of the other axes
/// alone are inserted evenly before an event of the plane and share its sweep.
///
/// `A` is the method in the plane: [`Arc`], or [`Conic`] where the steps of its axes differ.
///
/// | | |
/// | --- | --- |
/// | error | in the plane that of [`Arc`]; other axes within one step of their share of the sweep (1/2 where they have fewer steps than the plane has events), and exact at the end |
/// | events | those of the arc, and of axes that have more steps than it |
/// | speed ripple | that of the arc; events between two events of the plane share its sweep |
/// | state | that of the arc, plus 24 bytes per axis and 40; 2^31 events |
/// | cost | in three axes 189 instructions per event on Cortex-M0, 89 on Cortex-M4F, 105 on RV32IMAC: the product of rate and sweep has 64 bits |
/// | source | our derivation: the swept area is proportional to the angle |
#[derive(Clone, Debug)]
pub struct Helix<const N: usize, A = Arc> {
    arc: A,
    axes: [Slave; N],
    pace: Pace,
    events: u32,
    left: u32,
    largest_sweep: u32,
    /// Sweeps of a dense helix are in units 2^lift times finer, so that they can be divided.
    lift: u8,
    burst: Burst,
}

/// Motion of the other axes.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
enum Pace {
    /// No motion.
    Flat,
    /// At most one step per event of the plane.
    Sparse,
    /// Possibly several steps per event of the plane.
    Dense,
}

/// One axis outside the plane.
#[derive(Copy, Clone, Debug)]
struct Slave {
    /// Its steps times the sweep so far, modulo the total sweep; starts at half of it for rounding.
    phase: u64,
    rate: u32,
    is_negative: bool,
    /// Steps in the present burst, and their distribution over its events.
    due: u32,
    due_phase: u32,
}

/// The events for one event of the plane: `of` events, the last one with the step of the plane.
#[derive(Copy, Clone, Debug)]
struct Burst {
    left: u32,
    of: u32,
    step: Step,
    /// Sweep of each event.
    share: u32,
    /// Number of events that have one more unit of sweep.
    longer: u32,
}

impl<const N: usize> Helix<N> {
    /// Creates the arc `arc` of the axes `plane` with `along` steps of the other axes. Entries for
    /// the axes of the plane and for axes above the eighth are ignored.
    ///
    /// # Errors
    /// [`ArcError::Plane`], the errors of [`Arc::new`], and [`ArcError::TooLong`] above 2^31
    /// events.
    pub fn new(arc: &ArcMove, plane: [usize; 2], along: [i32; N]) -> Result<Self, ArcError> {
        let arc = Arc::in_plane(arc, axes_of::<N>(plane)?, false)?;
        Self::around(arc, plane, along)
    }

    /// Creates a helix that was created before, without walking its arc. `totals` are its
    /// [`totals_of_arc`](Self::totals_of_arc).
    ///
    /// # Errors
    /// As [`Helix::new`].
    pub fn again(
        arc: &ArcMove,
        plane: [usize; 2],
        along: [i32; N],
        totals: Totals,
    ) -> Result<Self, ArcError> {
        let arc = Arc::with_totals(arc, axes_of::<N>(plane)?, totals)?;
        Self::around(arc, plane, along)
    }

    /// The totals for [`again`](Self::again). `None` for a helix with more events than its arc,
    /// whose totals are not those of the arc.
    pub fn totals_of_arc(&self) -> Option<Totals> {
        (self.pace != Pace::Dense).then(|| self.totals())
    }

    /// The axes of the next events, as a mask, and those of them that step backwards, for
    /// [`fill`](Self::fill). They are the same up to the end of the quadrant. `None` where the
    /// iterator has to be called for the next event: at the last point, in a helix with more
    /// events than its arc, and in an arc with a state of 64 bits.
    pub fn directions(&mut self) -> Option<[u8; 2]> {
        let [mut axes, mut negative] = match self.pace {
            Pace::Dense => return None,
            _ => self.arc.directions()?,
        };
        let mut bit = 1_u8;
        for axis in &self.axes {
            if axis.rate != 0 {
                axes |= bit;
                negative |= if axis.is_negative { bit } else { 0 };
            }
            bit = bit.wrapping_shl(1);
        }
        Some([axes, negative])
    }

    /// Writes the sweeps and the steps of the next events, as the iterator returns them. Ends where
    /// [`directions`](Self::directions) does not hold any longer, where the places end, or after
    /// the event with which the sweeps add up to more than `room`.
    ///
    /// # Cost
    /// Of a flat arc of 32-bit words 40 instructions per event on Cortex-M4F.
    ///
    /// # Examples
    /// ```
    /// # use husillo_interp::{ArcMove, Direction, Helix, Rim};
    /// # let quarter = ArcMove {
    /// #     from: [0, 3],
    /// #     to: [3, 0],
    /// #     centre: [0, 0],
    /// #     fraction_bits: 0,
    /// #     direction: Direction::Clockwise,
    /// #     turns: 0,
    /// #     rim: Rim::Spiral,
    /// # };
    /// let mut helix = Helix::<2>::new(&quarter, [0, 1], [0, 0])?;
    /// let (mut sweeps, mut deltas) = ([0; 3], [[0; 2]; 3]);
    /// let run = helix.fill(sweeps.iter_mut().zip(&mut deltas), u32::MAX);
    /// assert_eq!((run.events, run.steps), (3, [3, 2]));
    /// assert_eq!(deltas, [[1, 0], [1, -1], [1, -1]]);
    /// # Ok::<(), husillo_interp::ArcError>(())
    /// ```
    pub fn fill<'a>(
        &mut self,
        places: impl Iterator<Item = (&'a mut u32, &'a mut [i8; N])>,
        room: u32,
    ) -> Run<N> {
        match self.pace {
            Pace::Dense => Run::NONE,
            Pace::Flat => self.arc.fill(places, room, |_, _| ()),
            Pace::Sparse => self.fill_sparse(places, room),
        }
    }

    /// Does [`fill`](Self::fill) where other axes move as well.
    fn fill_sparse<'a>(
        &mut self,
        places: impl Iterator<Item = (&'a mut u32, &'a mut [i8; N])>,
        room: u32,
    ) -> Run<N> {
        let total = self.arc.total_sweep();
        let mut others = [0_u32; N];
        let axes = &mut self.axes;
        let mut run = self.arc.fill(places, room, |sweep, delta| {
            for (axis, (delta, steps)) in axes.iter_mut().zip(delta.iter_mut().zip(&mut others)) {
                if axis.rate != 0 && axis.is_due(sweep, total) {
                    *delta = if axis.is_negative { -1 } else { 1 };
                    // At most the number of events.
                    *steps = steps.wrapping_add(1);
                }
            }
        });
        for (steps, other) in run.steps.iter_mut().zip(others) {
            *steps |= other;
        }
        run
    }

    /// Radius in the unit of the sweep: `total_sweep / radius` is the length of the arc in its
    /// plane.
    pub const fn radius(&self) -> u64 {
        self.arc.radius().wrapping_shl(self.lift as u32)
    }
}

impl<const N: usize> Helix<N, Conic> {
    /// Creates an arc in a plane whose axes have steps of different length, with `along` steps of
    /// the other axes. Entries for the axes of the plane and for axes above the eighth are ignored.
    ///
    /// # Errors
    /// [`ArcError::Plane`]; [`ArcError::TooLong`] above 2^31 events; [`ArcError::Degenerate`] where
    /// no step is left between the ends.
    ///
    /// # Cost
    /// The arc is walked once to count its events.
    pub fn of_ellipse(
        ellipse: &GridEllipse,
        plane: [usize; 2],
        along: [i32; N],
    ) -> Result<Self, ArcError> {
        let arc = Conic::on_grid(ellipse, axes_of::<N>(plane)?)?;
        Self::around(arc, plane, along)
    }

    /// Radius in the unit of the sweep: `total_sweep / radius` is the length of the arc in steps of
    /// the first axis of its plane.
    pub const fn radius(&self) -> u64 {
        self.arc.radius().wrapping_shl(self.lift as u32)
    }
}

/// The numbers of the axes of a plane.
fn axes_of<const N: usize>([first, second]: [usize; 2]) -> Result<[u32; 2], ArcError> {
    if first == second || first >= N.min(8) || second >= N.min(8) {
        return Err(ArcError::Plane);
    }
    Ok([first as u32, second as u32])
}

impl<const N: usize, A: Interpolator> Helix<N, A> {
    /// Adds the motion of the other axes to an arc that has not begun.
    fn around(arc: A, [first, second]: [usize; 2], along: [i32; N]) -> Result<Self, ArcError> {
        let total = arc.total_sweep();
        let mut fastest = 0_u32;
        let mut axes = along.map(|steps| Slave {
            phase: total / 2,
            rate: steps.unsigned_abs(),
            is_negative: steps < 0,
            due: 0,
            due_phase: 0,
        });
        for (index, axis) in (0..N).zip(&mut axes) {
            if index == first || index == second || index > 7 {
                axis.rate = 0;
            }
            fastest = fastest.max(axis.rate);
        }
        // rate <= 2^31 and a sweep is below 2^32, so the product fits.
        let most = u64::from(fastest).wrapping_mul(arc.largest_sweep().into());
        let pace = match fastest {
            0 => Pace::Flat,
            _ if most <= total => Pace::Sparse,
            _ => Pace::Dense,
        };
        let mut helix = Helix {
            events: arc.remaining(),
            left: arc.remaining(),
            largest_sweep: arc.largest_sweep(),
            axes,
            pace,
            lift: 0,
            burst: Burst {
                left: 0,
                of: 0,
                step: Step::default(),
                share: 0,
                longer: 0,
            },
            arc,
        };
        if pace == Pace::Dense {
            // One event gets about total / fastest, which is scaled to 2^30 units. total 2^lift
            // stays within fastest 2^32 <= 2^63, and the share of one event below 2^32. Neither is
            // 0 here, so the logarithms exist.
            let per_step = 30_u32.wrapping_add(fastest.checked_ilog2().unwrap_or(0));
            helix.lift = per_step.saturating_sub(total.checked_ilog2().unwrap_or(0)) as u8;
            helix.dry_pass()?;
        }
        Ok(helix)
    }

    /// Dry pass of a dense helix: one round per event of the plane.
    fn dry_pass(&mut self) -> Result<(), ArcError> {
        let mut dry = self.clone();
        let (mut events, mut largest) = (0_u64, 0_u32);
        while dry.load().is_some() {
            events = events.saturating_add(u64::from(dry.burst.of));
            let longer = dry.burst.longer.min(1);
            largest = largest.max(dry.burst.share.saturating_add(longer));
        }
        if events > 1 << 31 {
            return Err(ArcError::TooLong);
        }
        self.events = events as u32;
        self.left = self.events;
        self.largest_sweep = largest;
        Ok(())
    }

    /// Takes the next event of the plane and distributes it.
    fn load(&mut self) -> Option<()> {
        let step = self.arc.next()?;
        let total = self.arc.total_sweep();
        let mut of = 1_u32;
        for axis in &mut self.axes {
            // rate sweep < 2^63 and phase < total < 2^63; total is positive, because there was an
            // event.
            let phase = axis
                .phase
                .wrapping_add(u64::from(axis.rate).wrapping_mul(step.sweep.into()));
            // All due steps together are `rate`, so each count fits.
            axis.due = phase.checked_div(total).unwrap_or(0) as u32;
            axis.phase = phase.wrapping_sub(u64::from(axis.due).wrapping_mul(total));
            of = of.max(axis.due);
        }
        for axis in &mut self.axes {
            axis.due_phase = of / 2;
        }
        let sweep = u64::from(step.sweep).wrapping_shl(self.lift.into());
        let share = sweep.checked_div(of.into()).unwrap_or(0);
        self.burst = Burst {
            left: of,
            of,
            step,
            // Below 2^32, see `new`.
            share: share as u32,
            longer: sweep.wrapping_sub(share.wrapping_mul(of.into())) as u32,
        };
        Some(())
    }

    /// Next event of a dense helix.
    fn next_of_burst(&mut self) -> Option<Step> {
        if self.burst.left == 0 {
            self.load()?;
        }
        let burst = &mut self.burst;
        burst.left = burst.left.wrapping_sub(1);
        let mut step = Step::default();
        let mut bit = 1_u8;
        for axis in &mut self.axes {
            // phase < of and due <= of <= 2^31, so the sum fits.
            axis.due_phase = axis.due_phase.wrapping_add(axis.due);
            if axis.due_phase >= burst.of {
                axis.due_phase = axis.due_phase.wrapping_sub(burst.of);
                axis.add_to(&mut step, bit);
            }
            bit = bit.wrapping_shl(1);
        }
        if burst.left == 0 {
            step.axes |= burst.step.axes;
            step.negative |= burst.step.negative;
        }
        step.sweep = burst.share.wrapping_add((burst.left < burst.longer).into());
        self.left = self.left.wrapping_sub(1);
        Some(step)
    }

    /// The arc in its plane.
    pub const fn arc(&self) -> &A {
        &self.arc
    }

    /// Number of events of the whole move.
    pub const fn events(&self) -> u32 {
        self.events
    }
}

impl Slave {
    /// Passes the sweep of an event, of `total` in all. Returns whether a step is due. It makes at
    /// most one step per event.
    #[inline(always)]
    fn is_due(&mut self, sweep: u32, total: u64) -> bool {
        // rate sweep <= total < 2^63 and phase < total: the sum fits, and one subtraction is
        // enough.
        let phase = u64::from(self.rate).wrapping_mul(sweep.into());
        self.phase = self.phase.wrapping_add(phase);
        let is_due = self.phase >= total;
        if is_due {
            self.phase = self.phase.wrapping_sub(total);
        }
        is_due
    }

    /// Adds a step of this axis, whose mask is `bit`.
    #[inline]
    fn add_to(&self, step: &mut Step, bit: u8) {
        step.axes |= bit;
        if self.is_negative {
            step.negative |= bit;
        }
    }
}

impl<const N: usize, A: Interpolator> Method for Helix<N, A> {
    #[inline]
    fn next_step(&mut self) -> Option<Step> {
        if self.pace == Pace::Dense {
            return self.next_of_burst();
        }
        let mut step = self.arc.next()?;
        if self.pace == Pace::Sparse {
            let total = self.arc.total_sweep();
            let mut bit = 1_u8;
            for axis in &mut self.axes {
                if axis.rate != 0 && axis.is_due(step.sweep, total) {
                    axis.add_to(&mut step, bit);
                }
                bit = bit.wrapping_shl(1);
            }
        }
        Some(step)
    }

    #[inline]
    fn left(&self) -> u32 {
        match self.pace {
            Pace::Dense => self.left,
            _ => self.arc.remaining(),
        }
    }

    #[inline]
    fn totals(&self) -> Totals {
        Totals {
            events: self.events,
            total_sweep: self.arc.total_sweep().wrapping_shl(self.lift.into()),
            largest_sweep: self.largest_sweep,
        }
    }
}

interpolator!(#[inline] [const N: usize, A: Interpolator] Helix<N, A>);
