//! The exact path of a NURBS, and the distance of a point from it.

use super::chords_length;
use husillo_gcode::{Command, Nm};

/// A NURBS in XY with the knots of LinuxCNC: the first and the last as often as the order, and
/// whole numbers between them. Z stays where the curve ends.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsPath {
    degree: usize,
    /// Control points, each with its weight.
    points: Vec<[f64; 3]>,
    z: f64,
    /// Parameter of the last point.
    u: f64,
}

/// The control points of a curve that is not complete.
#[derive(Clone, Debug, Default)]
pub struct NurbsPoints(Option<NurbsPath>);

/// Parts of a span for its length, and for the search of the nearest point of the whole curve.
const PARTS: u32 = 256;

/// Largest order of a curve, as `gcode` has it.
const MOST_ORDER: usize = 16;

/// The nearest point is searched within this distance of the previous one, in spans.
const REACH: f64 = 0.125;

/// Number of steps of a search. Each makes the interval 1.6 times smaller.
const HALVINGS: u32 = 40;

impl NurbsPoints {
    /// Takes a command that begins at `from`. Returns the curve with its last command.
    pub fn take<const N: usize>(
        &mut self,
        from: &[Nm; N],
        command: &Command<N>,
    ) -> Option<NurbsPath> {
        let nm = |at: Option<&Nm>| at.map_or(0.0, |Nm(nm)| *nm as f64);
        let point = |at: &[Nm], weight: u64| [nm(at.first()), nm(at.get(1)), weight as f64];
        match command {
            Command::NurbsBegin {
                order,
                micro_weight,
                ..
            } => {
                self.0 = Some(NurbsPath {
                    degree: usize::from(*order).saturating_sub(1),
                    points: vec![point(from, *micro_weight)],
                    z: 0.0,
                    u: 0.0,
                });
            }
            Command::NurbsPoint { at, micro_weight } => {
                if let Some(curve) = &mut self.0 {
                    curve.points.push(point(at, *micro_weight));
                }
            }
            Command::NurbsEnd { to } => {
                let mut curve = self.0.take()?;
                curve.z = nm(to.get(2));
                return (curve.points.len() > curve.degree).then_some(curve);
            }
            _ => {}
        }
        None
    }
}

impl NurbsPath {
    /// Number of spans, which is the largest parameter.
    fn spans(&self) -> f64 {
        (self.points.len() - self.degree) as f64
    }

    /// The point at a parameter: the algorithm of de Boor in homogeneous coordinates.
    ///
    /// # Source
    ///
    /// C. de Boor, "On calculating with B-splines", 1972.
    fn at(&self, u: f64) -> [f64; 2] {
        let spans = self.points.len() - self.degree;
        let span = (u as usize).min(spans - 1);
        let knot = |number: usize| number.saturating_sub(self.degree).min(spans) as f64;
        let mut active = [[0.0; 3]; MOST_ORDER];
        for (active, [x, y, weight]) in active.iter_mut().zip(&self.points[span..]) {
            *active = [x * weight, y * weight, *weight];
        }
        for level in 1..=self.degree {
            for place in (level..=self.degree).rev() {
                let (low, high) = (
                    knot(span + place),
                    knot(span + place + self.degree + 1 - level),
                );
                let share = (u - low) / (high - low);
                let before = active[place - 1];
                for (at, before) in active[place].iter_mut().zip(before) {
                    *at = before + share * (*at - before);
                }
            }
        }
        let [x, y, weight] = active[self.degree];
        [x / weight, y / weight]
    }

    /// Square of the distance of a point in the plane from the curve at `u`.
    fn off(&self, p: [f64; 2], u: f64) -> f64 {
        let [x, y] = self.at(u);
        (x - p[0]) * (x - p[0]) + (y - p[1]) * (y - p[1])
    }

    /// Parameter of the nearest point between two parameters, by golden-section search.
    fn nearest_between(&self, p: [f64; 2], low: f64, high: f64) -> f64 {
        const GOLDEN: f64 = 0.618_033_988_749_895;
        let (mut low, mut high) = (low.max(0.0), high.min(self.spans()));
        for _ in 0..HALVINGS {
            let [a, b] = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
            match self.off(p, a) < self.off(p, b) {
                true => high = b,
                false => low = a,
            }
        }
        0.5 * (low + high)
    }

    /// Square of the distance of `tool` from the curve. Points must come in order.
    pub fn distance_squared(&mut self, tool: &[f64; 3]) -> f64 {
        let p = [tool[0], tool[1]];
        self.u = self.nearest_between(p, self.u - REACH, self.u + REACH);
        let rise = tool[2] - self.z;
        self.off(p, self.u) + rise * rise
    }

    /// The point of the curve nearest to `tool`.
    pub fn nearest(&self, tool: [f64; 3]) -> [f64; 3] {
        let p = [tool[0], tool[1]];
        let part = 1.0 / f64::from(PARTS);
        let parts = (self.spans() * f64::from(PARTS)) as u32;
        let begin = (0..=parts)
            .map(|number| f64::from(number) * part)
            .min_by(|a, b| self.off(p, *a).total_cmp(&self.off(p, *b)))
            .unwrap_or(0.0);
        let [x, y] = self.at(self.nearest_between(p, begin - part, begin + part));
        [x, y, self.z]
    }

    /// The point at a part of the range of parameters, from 0 to 1.
    pub fn place(&self, part: f64) -> [f64; 3] {
        let [x, y] = self.at(part * self.spans());
        [x, y, self.z]
    }

    /// Length of the curve.
    pub fn length(&self) -> f64 {
        let parts = (self.spans() * f64::from(PARTS)) as u32;
        chords_length(parts, |part| self.at(f64::from(part) / f64::from(PARTS)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use husillo_gcode::Feed;

    const FEED: Feed = Feed::PerMinute(Nm(1));

    /// A curve through its commands, the first point at zero.
    fn curve(order: u8, first_weight: u64, more: &[([i64; 2], u64)], to: [i64; 2]) -> NurbsPath {
        let mut points = NurbsPoints::default();
        let from = [Nm(0); 3];
        let begin = Command::NurbsBegin {
            order,
            micro_weight: first_weight,
            feed: FEED,
        };
        assert!(points.take(&from, &begin).is_none());
        for (at, micro_weight) in more {
            let point = Command::NurbsPoint {
                at: at.map(Nm),
                micro_weight: *micro_weight,
            };
            assert!(points.take(&from, &point).is_none());
        }
        let end = Command::NurbsEnd {
            to: [Nm(to[0]), Nm(to[1]), Nm(7)],
        };
        points.take(&from, &end).unwrap()
    }

    /// Three points with the weights of a circle are a quarter of it.
    #[test]
    fn a_quarter_of_a_circle_is_exact() {
        let half = 707_107;
        let points = [([1_000_000, 0], half), ([1_000_000, 1_000_000], 1_000_000)];
        let mut quarter = curve(3, 1_000_000, &points, [1_000_000, 1_000_000]);
        let length = std::f64::consts::FRAC_PI_2 * 1e6;
        assert!(
            (quarter.length() - length).abs() < 5.0,
            "{}",
            quarter.length()
        );
        for part in 0..=100 {
            let angle = f64::from(part) / 100.0 * std::f64::consts::FRAC_PI_2;
            let (x, y) = (1e6 * angle.sin(), 1e6 * (1.0 - angle.cos()));
            let off = quarter.distance_squared(&[x, y, 7.0]).sqrt();
            assert!(off < 0.5, "{part}: {off}");
            let farther = [x + 3e3 * angle.sin(), y - 3e3 * angle.cos(), 7.0];
            let [near_x, near_y, z] = quarter.nearest(farther);
            assert!((near_x - x).hypot(near_y - y) < 1.0 && z == 7.0, "{part}");
        }
    }

    /// Points on a line make a line, whatever their weights, over several spans.
    #[test]
    fn a_straight_curve_is_a_line() {
        let points = [
            ([1000, 0], 2_000_000),
            ([2000, 0], 500_000),
            ([3000, 0], 1_000_000),
            ([4000, 0], 1_000_000),
        ];
        let mut line = curve(3, 1_000_000, &points, [4000, 0]);
        assert!((line.length() - 4000.0).abs() < 1e-6);
        for x in 0..=400 {
            let x = f64::from(x) * 10.0;
            let off = line.distance_squared(&[x, 3.0, 7.0]);
            assert!((off - 9.0).abs() < 1e-3, "{x}: {off}");
        }
    }
}
