//! Arc by two coupled digital differential analysers (DDA).

use crate::counted::Counted;
use crate::lattice::Start;
use crate::method::interpolator;
use crate::quadrant::Quadrant;
use crate::{ArcError, ArcMove, Step};

/// A circular arc about a whole-step centre by two integrators. In every pass each register adds
/// the coordinate of the other axis; the axis steps when its register overflows R.
///
/// Every pass is an event and one BLU of path. Passes at equal times therefore give constant path
/// speed, which is the one advantage of the method. Passes without a step (idle passes,
/// `axes == 0`) are events too. [`ArcDda::new`] is the corrected form, [`ArcDda::printed`] the
/// original one.
///
/// | | |
/// | --- | --- |
/// | error, integer R | `new`: less than 0.97 BLU (measured, R up to 2000; limit 0.957); `printed`: up to 1.156 on whole circles (R = 15), more than 1 for 1873 of the radii up to 2000, and up to 1.6 where an end is not on an axis |
/// | events | about R times the angle: pi R / 2 + 0 to 2 per quadrant; 2 pi R per circle |
/// | speed ripple, equal times | mean 1.000; +-100 % from pass to pass, 12 % over 8 passes, 3 % over 32, 0.8 % over 128 |
/// | state | 80 bytes, words of 32 bits: two registers with their thresholds, the point and both ends; radius up to 2^28 BLU |
/// | cost | 75 instructions per event on Cortex-M0, 54 on Cortex-M4F, 29 on RV32IMAC |
/// | source | Koren, reference-pulse circular interpolators, J. Eng. Ind. 103 (1981) 131; `printed`: micromill, annex A.4 |
///
/// Faults of the printed program:
///
/// - Its registers start at 0 and its comparison is strict. Steps therefore come one pass late in
///   both axes; this is the excess of its error.
/// - It repeats idle passes at once instead of after a clock period. A circle runs 3 to 5 % too
///   fast, locally 35 %.
/// - It has no end test except for whole quadrants.
/// - Where one axis finishes first, the register of the other may never fill. Here that axis then
///   steps.
///
/// Here its idle passes are events as well; skip events with `axes == 0` for the original timing.
///
/// Quadrants end on the axes, as in the original, and the registers start anew there. The last
/// quadrant ends where one axis is level with the end. From there the walk goes straight to the
/// end, in a step or two.
///
/// The sweep of every event is 1, so `total_sweep` is the length of the path in BLU.
#[derive(Clone, Debug)]
pub struct ArcDda {
    counted: Counted<Walk>,
    radius: u32,
}

/// Variant of the registers of a DDA.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DdaRegisters {
    /// Value at the start of a quadrant in BLU; more than R is taken as R.
    pub start: u32,
    /// An axis steps where its register exceeds R; if `false`, also where the register equals R.
    pub is_strict: bool,
    /// The second axis adds the coordinate of the first after the step of the same pass; if
    /// `false`, before that step.
    pub is_sequential: bool,
}

#[derive(Clone, Debug)]
struct Walk {
    point: Quadrant,
    /// Register of v, to which u is added; v steps when it reaches the threshold.
    along_v: i32,
    /// Register of u, to which v is added.
    along_u: i32,
    radius: i32,
    /// R, or R + 1 where the comparison is strict.
    threshold: i32,
    begin: i32,
    is_sequential: bool,
}

impl ArcDda {
    /// Creates the corrected DDA: registers start half full, steps occur at R. Where the arc does
    /// not begin on an axis, the registers also hold the distance of the first point from the
    /// curve.
    ///
    /// # Errors
    /// [`ArcError`]: `Centre` where the centre is not a whole step, `OffRim` where an end is more
    /// than about two BLU from the circle through (or about) the first.
    pub fn new(arc: &ArcMove) -> Result<ArcDda, ArcError> {
        let start = Start::new(arc)?;
        let registers = DdaRegisters {
            start: start.radius / 2,
            is_strict: false,
            is_sequential: true,
        };
        let mut walk = Walk::new(&start, registers);
        let (u, v) = (i64::from(start.quadrant.u), i64::from(start.quadrant.v));
        let radius = i64::from(start.radius);
        // Registers hold R times the fraction of a step. The integrators follow u^2 + v^2 + u v / R
        // = R^2, which is a quarter of a BLU inside the circle between the axes. Products are below
        // 5 R^2, and R <= 2^28 + 2.
        let between = u.wrapping_mul(v).checked_div(radius).unwrap_or(0);
        let excess = i64::from(start.residue).wrapping_add(between);
        let share = |coordinate: i64| {
            let share = coordinate.wrapping_mul(excess) / 2;
            share.checked_div(radius).unwrap_or(0) as i32
        };
        // At most 3 R.
        walk.along_v = walk.along_v.wrapping_sub(share(v));
        walk.along_u = walk.along_u.wrapping_add(share(u));
        ArcDda::of(walk, &start)
    }

    /// Creates the DDA of micromill A.4: registers start empty, steps occur above R.
    ///
    /// # Errors
    /// As [`ArcDda::new`].
    pub fn printed(arc: &ArcMove) -> Result<ArcDda, ArcError> {
        let registers = DdaRegisters {
            start: 0,
            is_strict: true,
            is_sequential: true,
        };
        ArcDda::with_registers(arc, registers)
    }

    /// Creates any other variant, for comparison.
    ///
    /// # Errors
    /// As [`ArcDda::new`].
    pub fn with_registers(arc: &ArcMove, registers: DdaRegisters) -> Result<ArcDda, ArcError> {
        let start = Start::new(arc)?;
        ArcDda::of(Walk::new(&start, registers), &start)
    }

    fn of(walk: Walk, start: &Start) -> Result<ArcDda, ArcError> {
        Ok(ArcDda {
            counted: Counted::new(walk).ok_or(ArcError::TooLong)?,
            radius: start.radius,
        })
    }

    /// Number of events of the whole arc, idle ones included.
    pub const fn events(&self) -> u32 {
        self.counted.events()
    }

    /// Radius rounded to the nearest BLU, at which the registers overflow.
    pub const fn radius(&self) -> u32 {
        self.radius
    }
}

impl Walk {
    fn new(start: &Start, registers: DdaRegisters) -> Walk {
        // At most 2^28 + 2.
        let radius = start.radius as i32;
        let begin = registers.start.min(start.radius) as i32;
        Walk {
            point: start.quadrant.clone(),
            along_v: begin,
            along_u: begin,
            radius,
            threshold: radius.wrapping_add(registers.is_strict.into()),
            begin,
            is_sequential: registers.is_sequential,
        }
    }
}

interpolator!(ArcDda, counted);

impl Iterator for Walk {
    type Item = Step;

    #[inline]
    fn next(&mut self) -> Option<Step> {
        let point = &mut self.point;
        if point.is_level() {
            let step = point.straight(true)?;
            return Some(Step { sweep: 1, ..step });
        }
        let (u_goal, v_goal) = if point.left == 0 {
            (point.u_end, point.v_end)
        } else {
            (0, self.radius)
        };
        // The register of an axis that has reached its end keeps growing: by u, which falls with
        // every pass from at most sqrt(8 R), or by v for the few passes that v lacks. It stays
        // below 8 R.
        self.along_v = self.along_v.wrapping_add(point.u);
        let is_short = point.v < v_goal;
        // Where u is 0 nothing more would be added.
        let takes_v = is_short && (self.along_v >= self.threshold || point.u <= 0);
        let added = if self.is_sequential && takes_v {
            point.v.wrapping_add(1)
        } else {
            point.v
        };
        self.along_u = self.along_u.wrapping_add(added);
        let takes_u = point.u > u_goal && self.along_u >= self.threshold;
        if takes_v {
            self.along_v = self.along_v.wrapping_sub(self.radius);
        }
        if takes_u {
            self.along_u = self.along_u.wrapping_sub(self.radius);
        }
        let step = point.take(takes_u, takes_v);
        if point.is_over() && point.v >= self.radius {
            point.turn();
            (self.along_v, self.along_u) = (self.begin, self.begin);
        }
        Some(Step { sweep: 1, ..step })
    }
}
