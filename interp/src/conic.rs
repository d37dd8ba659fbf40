//! Arcs of ellipses, parabolas and hyperbolas in a plane.

use crate::conic_move::{ConicError, ConicMove, EllipseMove, Pace, Start, Toward};
use crate::counted::Counted;
use crate::grid_ellipse::ROW_BITS;
use crate::interpolator::Totals;
use crate::method::interpolator;
use crate::{ArcError, GridEllipse, Step};

/// Sweep per BLU of path, in bits, for curves other than circles.
const UNIT_BITS: u32 = 15;
/// Residue and first differences may each reach 2.5 2^60; the sum of three is then below 2^63.
const MAX_STATE: u64 = 5 << 59;
/// Largest distance of the walk from its end, in BLU per axis.
const MAX_REACH: u32 = 1 << 22;

/// An arc of any curve of the second degree, F(x, y) = 0. Each event goes to the nearest of the
/// three neighbours ahead. The arc ends exactly at `to`.
///
/// The state is that of the circle: the residue F, its two first differences, and constant second
/// differences. A quadrant ends where the first difference towards the inside changes its sign.
///
/// | | |
/// | --- | --- |
/// | curves | ellipse (also rotated), parabola, one branch of a hyperbola; not a pair of lines |
/// | error | upright ellipse: 1/2 BLU + 1/(10 b) for the smaller semi-axis b. Others: 1/2 + 1/(4 rho) for the least radius of curvature rho of at least 2 BLU, or for the half axis a of a hyperbola where that is smaller (sharper ones are walked or refused as [`ConicError::Astray`]). The first point and the run-off to the last point are rounded (0.7071) |
/// | events | one per row or column, as many as the nearest points need: max(&#124;dx&#124;, &#124;dy&#124;) of each octant |
/// | speed ripple | circle: 1/R, as [`Arc`](crate::Arc); others: 1/rho + 0.05 % for the radius of curvature rho |
/// | state | 64 bits; axis-parallel ellipses up to semi-axes of 2^20 (in 2^-f BLU), others while F and its differences stay below 2^61; 104 bytes, because F has two first and three second differences of 64 bits each |
/// | cost | instructions per event on Cortex-M4F / M0: circle 210 / 271, others 302 / 932, a circle on unequal steps 275 / 561. The difference is the length of the gradient (a root and a division of 32 bits) |
/// | source | Danielsson 1970 and Jordan, Lennon, Holm 1973 (neighbours and quadrants), Pitteway 1967 (midpoint test for conics) |
///
/// The midpoint test is exact on the axis that steps less. For a quadratic F the mean of two
/// neighbours exceeds the value midway by a quarter of half the second difference. That is the bias
/// of the test. Where the order of the three neighbours is not that of their residues (only near
/// the quadrant changes of a rotated curve), the smallest |F| is taken.
///
/// `sweep` is the projection of the step on the tangent, in units of [`Conic::unit`]. For a circle
/// it is exactly |P x step|, as in [`Arc`](crate::Arc). It is at least half a unit.
///
/// # Examples
/// ```
/// use husillo_interp::{Conic, Direction, EllipseMove};
///
/// let ellipse = Conic::ellipse(&EllipseMove {
///     from: [4, 0],
///     to: [0, 2],
///     centre: [0, 0],
///     semi_axes: [4, 2],
///     fraction_bits: 0,
///     direction: Direction::CounterClockwise,
///     turns: 0,
/// })?;
/// let deltas: Vec<[i8; 2]> = ellipse.map(|step| step.deltas()).collect();
/// assert_eq!(deltas, [[-1, 1], [-1, 1], [-1, 0], [-1, 0]]);
/// # Ok::<(), husillo_interp::ConicError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Conic {
    counted: Counted<Walk>,
    radius: u64,
}

impl Conic {
    /// Creates an arc of an ellipse with axes parallel to those of the plane. Walks it once to
    /// count its events.
    ///
    /// # Errors
    /// See [`ConicError`].
    pub fn ellipse(ellipse: &EllipseMove) -> Result<Conic, ConicError> {
        Conic::prepare(&Start::of_ellipse(ellipse)?)
    }

    /// Creates an arc of the curve with the given coefficients. Walks it once to count its events
    /// and to verify that it reaches its end.
    ///
    /// # Errors
    /// See [`ConicError`].
    pub fn new(conic: &ConicMove) -> Result<Conic, ConicError> {
        Conic::prepare(&Start::of_conic(conic)?)
    }

    /// Creates a circle in a plane of axes whose steps differ. The sweep of an event is then the
    /// angle of a row or a column of it. Walks it once to count its events.
    pub(crate) fn on_grid(ellipse: &GridEllipse, plane: [u32; 2]) -> Result<Conic, ArcError> {
        let start = Start::on_grid(ellipse, plane).and_then(|start| Conic::prepare(&start));
        match start {
            Ok(mut conic) => {
                conic.radius = ellipse.radius;
                Ok(conic)
            }
            Err(ConicError::TooLong) => Err(ArcError::TooLong),
            Err(ConicError::TooLarge) => Err(ArcError::TooLarge),
            Err(_) => Err(ArcError::Degenerate),
        }
    }

    /// Sweep per step of the first axis; see [`Conic::on_grid`].
    pub(crate) const fn radius(&self) -> u64 {
        self.radius
    }

    fn prepare(start: &Start) -> Result<Conic, ConicError> {
        let walk = Walk { now: *start };
        let totals = walk.clone().check()?;
        let mut conic = Conic {
            counted: Counted::with_totals(walk, totals),
            radius: 0,
        };
        conic.radius = conic.unit().into();
        Ok(conic)
    }

    /// Number of events of the whole arc, at most 2^31.
    pub const fn events(&self) -> u32 {
        self.counted.events()
    }

    /// Sweep per BLU of path: `total_sweep / unit` is the length of the arc in BLU. It is the
    /// radius in 2^-f BLU for a circle and 2^15 otherwise.
    pub const fn unit(&self) -> u32 {
        match self.counted.walk.now.pace {
            Pace::Circle { radius } => radius,
            _ => 1 << UNIT_BITS,
        }
    }

    /// Quadrant changes still to come; at each of them an axis reverses.
    pub const fn quadrants(&self) -> u32 {
        self.counted.walk.now.quadrants
    }
}

interpolator!(Conic, counted);

/// The axes of the quadrant that step, by -1, 0 or +1.
#[derive(Copy, Clone)]
struct Choice {
    u: i64,
    v: i64,
}

/// State of the walk. `u` is the step towards the inside of the curve, `v` the step outwards. The
/// curve turns left, from v to u, and F is negative inside.
#[derive(Clone, Debug)]
struct Walk {
    now: Start,
}

impl Walk {
    /// Whether the point is inside the curve and the next point outwards is nearer. This occurs in
    /// a tip sharper than a BLU when the walk is already on its axis.
    #[cold]
    fn is_before_tip(&self) -> bool {
        let now = &self.now;
        let doubled = now.residue.wrapping_add(now.residue);
        now.residue < 0 && now.dv > 0 && doubled.wrapping_add(now.dv) < now.dvv >> 2
    }

    /// Goes on to the next quadrant: the inward step becomes the outward step.
    #[cold]
    fn turn(&mut self) {
        let now = &mut self.now;
        (now.du, now.dv) = (now.dvv.wrapping_sub(now.dv), now.du);
        (now.duu, now.dvv) = (now.dvv, now.duu);
        now.duv = now.duv.wrapping_neg();
        (now.u_left, now.v_left) = (now.v_left.wrapping_neg(), now.u_left);
        (now.toward_u, now.toward_v) = (now.toward_v.opposite(), now.toward_u);
        now.quadrants = now.quadrants.wrapping_sub(1);
    }

    /// Goes straight to the end once the walk is level with it in one axis. The curve is monotonic
    /// within its quadrant, so it stays between this point and the end.
    #[cold]
    fn run_off(&mut self) -> Option<Step> {
        let choice = Choice {
            u: self.now.u_left.signum().into(),
            v: self.now.v_left.signum().into(),
        };
        (choice.u != 0 || choice.v != 0).then(|| self.take(choice))
    }

    #[inline]
    fn take(&mut self, choice: Choice) -> Step {
        let sweep = self.sweep(choice);
        let Choice { u, v } = choice;
        let now = &mut self.now;
        // u and v are -1, 0 or 1. F(P - u) - F(P) is duu - du.
        let residue_u = now.du.wrapping_sub(if u < 0 { now.duu } else { 0 });
        let residue_v = now.dv.wrapping_sub(if v < 0 { now.dvv } else { 0 });
        now.residue = now
            .residue
            .wrapping_add(u.wrapping_mul(residue_u))
            .wrapping_add(v.wrapping_mul(residue_v))
            .wrapping_add(u.wrapping_mul(v).wrapping_mul(now.duv));
        now.du = now
            .du
            .wrapping_add(u.wrapping_mul(now.duu))
            .wrapping_add(v.wrapping_mul(now.duv));
        now.dv = now
            .dv
            .wrapping_add(v.wrapping_mul(now.dvv))
            .wrapping_add(u.wrapping_mul(now.duv));
        now.u_left = now.u_left.wrapping_sub(u as i32);
        now.v_left = now.v_left.wrapping_sub(v as i32);
        let (toward_u, toward_v) = (now.toward_u.times(u), now.toward_v.times(v));
        Step {
            axes: toward_u.axes | toward_v.axes,
            negative: toward_u.negative | toward_v.negative,
            sweep,
        }
    }

    /// The projection of the step on the tangent, which is the gradient turned left: (-F_v, F_u).
    #[inline]
    fn sweep(&self, Choice { u, v }: Choice) -> u32 {
        let now = &self.now;
        let along_u = now.dv.wrapping_sub(now.dvv >> 1);
        let along_v = (now.duu >> 1).wrapping_sub(now.du);
        if let Pace::Circle { radius } = now.pace {
            // Twice the coordinates, below 2^23.
            let cross = u
                .wrapping_mul(along_u)
                .wrapping_add(v.wrapping_mul(along_v))
                >> 1;
            return (cross.max(0) as u32).max(radius / 2).max(1);
        }
        if let Pace::Angle { shift } = now.pace {
            // In the rows of one axis the gradient along the other one is steeper. Of its 22 to 30
            // bits 11 to 19 are kept, so a word divides: 2^43 2^8 = 2^51. At least 2^10 keeps the
            // quotient below 2^22; only a circle of a few steps has less.
            let steepest = along_u.unsigned_abs().max(along_v.unsigned_abs());
            let half = 1_u64.wrapping_shl(u32::from(shift).wrapping_add(10));
            let steepest = steepest
                .saturating_add(half)
                .wrapping_shr(u32::from(shift).wrapping_add(11));
            let steepest = (steepest as u32).max(1 << 10);
            let rows = u32::MAX.checked_div(steepest).unwrap_or(0);
            return rows.wrapping_shl(ROW_BITS - 43);
        }
        // The larger one is scaled to 15 bits and a sign; the sum of the squares is at most 2^31.
        let largest = along_u.unsigned_abs() | along_v.unsigned_abs();
        let shift = largest.leading_zeros().saturating_sub(1);
        let along_u = (along_u.wrapping_shl(shift) >> 48) as i32;
        let along_v = (along_v.wrapping_shl(shift) >> 48) as i32;
        let square = along_u
            .wrapping_mul(along_u)
            .wrapping_add(along_v.wrapping_mul(along_v));
        let cross = (u as i32)
            .wrapping_mul(along_u)
            .wrapping_add((v as i32).wrapping_mul(along_v));
        // cross <= 2^16, so it fits. Without a gradient there is no tangent.
        (cross.max(0) as u32)
            .wrapping_shl(UNIT_BITS)
            .checked_div((square as u32).isqrt())
            .unwrap_or(0)
            .max(1 << (UNIT_BITS - 1))
    }

    /// Walks to the end, checks every state on the way, and returns the sums.
    ///
    /// The walk ends: within a quadrant every event advances u or v and never goes back. Each has
    /// at most 2^23 steps within reach, so a quadrant has at most 2^24 events, and the number of
    /// quadrants is known. In the last quadrant u_left + v_left (in the run-off: their magnitudes)
    /// shrinks at every event.
    fn check(mut self) -> Result<Totals, ConicError> {
        let mut totals = Totals::default();
        loop {
            let now = &self.now;
            let largest = now
                .residue
                .unsigned_abs()
                .max(now.du.unsigned_abs())
                .max(now.dv.unsigned_abs());
            if largest > MAX_STATE {
                return Err(ConicError::TooLarge);
            }
            let is_level = now.quadrants == 0 && (now.u_left <= 0 || now.v_left <= 0);
            if now.u_left.unsigned_abs().max(now.v_left.unsigned_abs()) > MAX_REACH
                // The last quadrant advances in the u of this quadrant.
                || (now.is_open && now.quadrants == 1 && now.u_left < -3)
                // The tips of upright ellipses of a BLU or two are lines; the end of a quadrant may
                // be anywhere on them.
                || (is_level && (now.is_open || now.duv != 0) && now.u_left.min(now.v_left) < -3)
                || (!is_level && totals.events > 3 && now.is_off())
            {
                return Err(ConicError::Astray);
            }
            let Some(step) = self.next() else {
                return Ok(totals);
            };
            if totals.events >= 1 << 31 {
                return Err(ConicError::TooLong);
            }
            totals.add(step.sweep);
        }
    }
}

impl Iterator for Walk {
    type Item = Step;

    /// Arithmetic wraps in name only: [`Walk::check`] found every state of this walk below
    /// `MAX_STATE`, so the sum of three is below 2^63.
    #[inline]
    fn next(&mut self) -> Option<Step> {
        let now = &self.now;
        if now.quadrants == 0 && (now.u_left <= 0 || now.v_left <= 0) {
            return self.run_off();
        }
        let after_u = now.residue.wrapping_add(now.du);
        let after_v = now.residue.wrapping_add(now.dv);
        let dv_beside = now.dv.wrapping_add(now.duv);
        let after_both = after_u.wrapping_add(dv_beside);
        let (takes_u, takes_v) = if now.quadrants != 0 && now.du >= 0 {
            // Within a sharp tip, on its axis: see `turn`.
            (false, true)
        } else if dv_beside >= 0 && now.du.wrapping_add(now.duv) <= 0 {
            // after_u <= after_both <= after_v. The sign of after_both leaves two candidates, and F
            // midway between them tells on which side the curve is.
            if after_both >= 0 {
                (true, after_both <= (now.dvv >> 2).wrapping_sub(after_u))
            } else {
                (
                    after_both >= ((now.duu.wrapping_add(3)) >> 2).wrapping_sub(after_v),
                    true,
                )
            }
        } else {
            let (size_u, size_v) = (after_u.unsigned_abs(), after_v.unsigned_abs());
            let size_both = after_both.unsigned_abs();
            if size_both <= size_u && size_both <= size_v {
                (true, true)
            } else {
                (size_u < size_v, size_u >= size_v)
            }
        };
        let step = self.take(Choice {
            u: takes_u.into(),
            v: takes_v.into(),
        });
        while self.now.quadrants != 0 && self.now.du >= 0 && !self.is_before_tip() {
            self.turn();
        }
        Some(step)
    }
}

impl Toward {
    /// This step times -1, 0 or +1.
    #[inline]
    fn times(self, factor: i64) -> Toward {
        match factor {
            0 => Toward::default(),
            1.. => self,
            _ => self.opposite(),
        }
    }
}
