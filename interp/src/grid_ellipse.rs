//! A circle on a grid whose axes have steps of different length: there it is an ellipse.

use crate::programmed_arc::{cross, product, size};
use crate::{ArcError, ConicMove, Direction, ProgrammedArc, Scale};

/// Number of bits of the larger of the coefficients A and C. The radius is below 2^21 steps, so
/// A x^2 + C y^2 and its differences are below 2^61.
const BITS: u32 = 38;
/// Largest radius, in the shorter steps.
const MAX_RADIUS_STEPS: u32 = (1 << 21) - 8;
/// Below this radius in the longer steps the arc is a line: the walk needs a curve between points.
const LEAST_RADIUS_STEPS: u32 = 3;
/// The sweep of an event is 2^51 over the steepest gradient, which has 22 to 30 bits.
pub(crate) const ROW_BITS: u32 = 51;
/// Fraction bits of centre and first point, in steps.
const FRACTION_BITS: u8 = 24;

/// A [`ProgrammedArc`] on the grid of two axes with steps of different length.
///
/// The circle is A (x - cx)^2 + C (y - cy)^2 = const with x and y in steps, and A : C as the
/// squares of the steps. [`Conic`](crate::Conic) follows it. It passes through the exact first
/// point: A, C and the centre are accurate to 2^-32 of their values and 2^-24 of a step.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GridEllipse {
    /// The curve, in steps from its first point.
    pub(crate) conic: ConicMove,
    /// Axes of the circle that the arc passes, as the exact ends have it.
    pub(crate) quadrants: u32,
    /// The steepest gradient of the curve has 30 bits after this shift to the right.
    pub(crate) shift: u8,
    /// Sweep per step of the first axis.
    pub(crate) radius: u64,
    radius_steps: u32,
}

impl GridEllipse {
    /// The radius in the shorter of the two steps, rounded; below 2^21.
    pub const fn radius_steps(&self) -> u32 {
        self.radius_steps
    }
}

impl ProgrammedArc {
    /// Converts the arc to a grid whose axes have these steps, with its first point at the origin.
    ///
    /// `steps` are the positions of the axes at both ends, normally [`Scale::nearest`] of both
    /// ends. The exact positions decide whether an arc with close ends is short or a whole turn.
    ///
    /// The path is a circle. Where the radii of the ends differ by more than half of the shorter
    /// step, the centre is moved to the nearest point with the same distance from both ends.
    ///
    /// # Errors
    /// - [`ArcError::Degenerate`]: the radius is below three of the longer steps, or
    ///   [`ProgrammedArc::as_circle`] says so. Use a line.
    /// - [`ArcError::TooLarge`]: the radius is 2^21 of the shorter steps or more, or a coordinate
    ///   of the centre is 2^38 steps or more.
    /// - [`ArcError::Unequal`]: one step is more than 256 times the other. Or
    ///   [`ProgrammedArc::as_circle`] says so.
    ///
    /// # Cost
    /// About thirty products and six divisions of 128 bits.
    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    pub fn on_grids(
        &self,
        scales: [Scale; 2],
        steps: [[i32; 2]; 2],
    ) -> Result<GridEllipse, ArcError> {
        let round = self.as_circle(scales)?;
        let [spoke, end] = round.spokes();
        let radius_nm = size(spoke) as i64; // below 2^63, as the spokes are
        let radii = scales.map(|scale| scale.nearest_fraction(radius_nm, 16));
        let [Some(radius_x), Some(radius_y)] = radii else {
            return Err(ArcError::TooLarge);
        };
        let (longest, shortest) = (radius_x.max(radius_y), radius_x.min(radius_y));
        if longest >= i64::from(MAX_RADIUS_STEPS) << 16 {
            return Err(ArcError::TooLarge);
        }
        if shortest < i64::from(LEAST_RADIUS_STEPS) << 16 {
            return Err(ArcError::Degenerate);
        }
        let [a, c] = squares(scales).ok_or(ArcError::Unequal)?;
        let [[from_x, from_y], [to_x, to_y]] = steps;
        let fraction = |at_nm: i64, scale: Scale, from: i32| {
            let at = scale.nearest_fraction(at_nm, FRACTION_BITS)?;
            at.checked_sub(i64::from(from) << FRACTION_BITS)
        };
        let [scale_x, scale_y] = scales;
        let ([centre_x, centre_y], [start_x, start_y]) = (round.centre, round.from);
        let centre = [
            fraction(centre_x, scale_x, from_x),
            fraction(centre_y, scale_y, from_y),
        ];
        let start = [
            fraction(start_x, scale_x, from_x),
            fraction(start_y, scale_y, from_y),
        ];
        let ([Some(cx), Some(cy)], [Some(ex), Some(ey)]) = (centre, start) else {
            return Err(ArcError::TooLarge);
        };
        // 2 A c: 2^39 times 2^(21 + 24). A e (2 c - e): below 2^38 2^25 2^46 = 2^109.
        let linear = |a: i64, c: i64| rounded(product(a.wrapping_mul(2), c), FRACTION_BITS);
        let constant = |a: i64, c: i64, e: i64| {
            let double = product(e, c.wrapping_mul(2).wrapping_sub(e));
            double.wrapping_mul(a.into())
        };
        let sum = constant(a, cx, ex).wrapping_add(constant(c, cy, ey));
        let conic = ConicMove {
            from: [0, 0],
            to: [to_x.wrapping_sub(from_x), to_y.wrapping_sub(from_y)],
            coefficients: [
                a,
                0,
                c,
                linear(a, cx).wrapping_neg(),
                linear(c, cy).wrapping_neg(),
                rounded(sum, 2 * FRACTION_BITS),
            ],
            direction: self.direction,
            turns: 0,
        };
        // The gradient is at most 2 A r, 2^60. It is scaled to 30 bits.
        let steepest = (product(a, radius_x).max(product(c, radius_y)) >> 15) as u64;
        let shift = 34_u32.saturating_sub(steepest.leading_zeros());
        // A row of y takes the angle s_y / X, and the gradient along x is 2 A X / s_x, with
        // A / s_x^2 = C / s_y^2. So a row or column takes 2 C s_x / s_y over the gradient, and the
        // sweep is 2^51 over the gradient. Their ratio times s_x / r is the sweep per step of x.
        let per_radius = product(c.wrapping_mul(2), radius_y).wrapping_shr(shift);
        let radius = (1_i128 << (ROW_BITS + 16)).checked_div(per_radius);
        Ok(GridEllipse {
            conic,
            quadrants: passed(spoke, end, self.direction)
                .checked_add(self.turns.checked_mul(4).ok_or(ArcError::TooLong)?)
                .ok_or(ArcError::TooLong)?,
            shift: shift as u8,
            radius: radius.unwrap_or(0) as u64,
            radius_steps: (longest >> 16) as u32,
        })
    }
}

/// A and C, in proportion to the squares of the steps. The larger one has 38 bits. `None` where
/// one step is more than 256 times the other.
fn squares([x, y]: [Scale; 2]) -> Option<[i64; 2]> {
    let times = |nm: u32, steps: u32| u64::from(nm).wrapping_mul(steps.into());
    let (p, q) = (times(x.nm(), y.steps()), times(y.nm(), x.steps()));
    if p.max(q) > p.min(q).saturating_mul(256) {
        return None;
    }
    let [p, q] = [p, q].map(|step| u128::from(step).wrapping_mul(step.into()));
    let most = p.max(q);
    let bits = 128_u32.wrapping_sub(most.leading_zeros());
    // Rounded to nearest: 2^38 at most, and 2^22 at least.
    let scaled = |square: u128| match bits.checked_sub(BITS) {
        None | Some(0) => square.wrapping_shl(BITS.wrapping_sub(bits)) as i64,
        Some(down) => {
            let half = 1_u128.wrapping_shl(down.wrapping_sub(1));
            square.saturating_add(half).wrapping_shr(down) as i64
        }
    };
    Some([p, q].map(scaled))
}

/// Number of axes of the circle that an arc between these spokes passes in its direction; 4 for a
/// whole turn.
fn passed([sx, sy]: [i64; 2], [ex, ey]: [i64; 2], direction: Direction) -> u32 {
    let (sy, ey) = match direction {
        Direction::CounterClockwise => (sy, ey),
        Direction::Clockwise => (sy.wrapping_neg(), ey.wrapping_neg()),
    };
    let quadrant = |x: i64, y: i64| match (x.signum(), y.signum()) {
        (1, 0 | 1) => 0_u32,
        (0 | -1, 1) => 1,
        (-1, 0 | -1) => 2,
        _ => 3,
    };
    match quadrant(ex, ey).wrapping_sub(quadrant(sx, sy)) & 3 {
        0 if cross([sx, sy], [ex, ey]) <= 0 => 4,
        passed => passed,
    }
}

/// Rounds off this number of bits, to nearest.
fn rounded(value: i128, bits: u8) -> i64 {
    let half = 1_i128.wrapping_shl(u32::from(bits).wrapping_sub(1));
    value.wrapping_add(half).wrapping_shr(bits.into()) as i64
}
