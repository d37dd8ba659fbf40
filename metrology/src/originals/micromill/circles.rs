//! Table 15: three concentric circles with eight diameters each.

use super::cutting::{approach, cut};
use super::measured::{self, CIRCLES, ENDS, SIGNS};
use super::{LAST_TAKE_UP_UM, LEFT_UM, MIDDLE_MM, Settings, Shop, nm, parameters};
use crate::calibration::backlash::{Bench, Moment};
use crate::least_squares::least_squares;
use crate::originals::{Parameter, Row, Table};
use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

/// Angle from the end of a circle to where the play there is read, radians. The nut has met its
/// flank by then: 50 um are 10 degrees of a radius of 3 mm.
const BEHIND: f64 = 20.0 * PI / 180.0;
/// Spread of a time, min: begin and end are read in whole minutes.
const CLOCK_MIN: f64 = 1.0;
/// Rate of steps between moves and in take-ups, Hz.
const TAKE_UP_HZ: f64 = 170.0;

/// A circle that was cut.
#[derive(Clone, Debug)]
pub struct Circle {
    /// Its diameters D1 to D8, mm.
    pub diameters_mm: [f64; 8],
    /// Play that the take-up left at the ends left, right, top, bottom, um.
    pub ends_um: [f64; 4],
    /// Time, min.
    pub minutes: f64,
    /// Radii that were cut at every half degree from +X anticlockwise, mm.
    pub radii_mm: Vec<f64>,
}

/// Directions of radii per turn.
const DIRECTIONS: usize = 720;

impl Circle {
    /// Mean of the diameters, mm, and their standard deviation, um.
    #[must_use]
    pub fn mean_and_sigma(&self) -> (f64, f64) {
        let mean = self.diameters_mm.iter().sum::<f64>() / 8.0;
        let squares = self.diameters_mm.iter().map(|d| (d - mean).powi(2));
        (mean, 1e3 * (squares.sum::<f64>() / 7.0).sqrt())
    }

    /// The same circle on axes that are not square, with its diameters in an order.
    fn on(&self, frame: &Frame, radius_mm: f64) -> Self {
        let turned = self.radii_mm.iter().enumerate().map(|(index, radius)| {
            let angle = TAU * index as f64 / DIRECTIONS as f64;
            radius + frame.skew * radius_mm * angle.sin() * angle.cos()
        });
        let radii_mm: Vec<f64> = turned.collect();
        let diameter = |index: usize| {
            let at = frame.order.direction(index);
            radii_mm[at] + radii_mm[(at + DIRECTIONS / 2) % DIRECTIONS]
        };
        Self {
            diameters_mm: std::array::from_fn(diameter),
            radii_mm,
            ..self.clone()
        }
    }
}

/// Where D1 lies and which way the others follow, 22.5 degrees apart.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Order {
    /// Direction of D1 from +X, in steps of 22.5 degrees.
    first: usize,
    is_clockwise: bool,
}

impl Order {
    /// Number of the direction of a diameter.
    const fn direction(self, index: usize) -> usize {
        const STEP: usize = DIRECTIONS / 16;
        let turn = if self.is_clockwise { 16 - index } else { index };
        (self.first + turn) % 16 * STEP
    }
}

/// How the circles were measured.
#[derive(Clone, Copy, Debug)]
struct Frame {
    order: Order,
    /// How far X moves per distance along Y beside what it should: the error of squareness.
    skew: f64,
    /// What the diameters leave unexplained, mm (RMS).
    rms_mm: f64,
}

impl Frame {
    /// The order, of all sixteen, and the squareness that leave least of the measured diameters.
    fn fitted(made: &[Circle]) -> Self {
        let orders = (0..8).flat_map(|first| {
            [false, true].map(|is_clockwise| Order {
                first,
                is_clockwise,
            })
        });
        let frames = orders.map(|order| {
            let pairs = CIRCLES.iter().zip(made).flat_map(|(measured, circle)| {
                let straight = Frame {
                    order,
                    skew: 0.0,
                    rms_mm: 0.0,
                };
                let circle = circle.on(&straight, measured.radius_mm);
                (0..8).map(move |index| {
                    let angle = TAU * order.direction(index) as f64 / DIRECTIONS as f64;
                    let per_skew = measured.radius_mm * (2.0 * angle).sin();
                    let left = measured.diameters_mm[index] - circle.diameters_mm[index];
                    (per_skew, left)
                })
            });
            let pairs: Vec<(f64, f64)> = pairs.collect();
            let [skew] =
                least_squares(pairs.iter().map(|(a, b)| ([*a], *b)), [true]).unwrap_or_default();
            let squares = pairs.iter().map(|(a, b)| (b - skew * a).powi(2));
            Frame {
                order,
                skew,
                rms_mm: (squares.sum::<f64>() / pairs.len() as f64).sqrt(),
            }
        });
        let best = frames.min_by(|a, b| a.rms_mm.total_cmp(&b.rms_mm));
        best.unwrap_or_else(|| unreachable!("there are sixteen orders"))
    }

    fn parameters(&self) -> [Parameter; 2] {
        let way = if self.order.is_clockwise {
            "clockwise"
        } else {
            "anticlockwise"
        };
        [
            Parameter::new(
                "directions of D1 to D8",
                format!(
                    "D1 at {} degrees from X, the others {way}",
                    22.5 * self.order.first as f64
                ),
                "fitted: the best of all sixteen orders; the original states none",
            ),
            Parameter::new(
                "squareness",
                format!("{:.1} um of X per mm of Y", 1e3 * self.skew),
                "fitted to the 24 diameters",
            ),
        ]
    }
}

/// Cuts the circles with the last take-up of the original, then with the map of today. Returns the
/// table, and the circles of both in the order a, b, c.
///
/// # Errors
///
/// The machine refuses a move.
pub fn circles(shop: &Shop<'_>) -> Result<(Table, Vec<[Circle; 2]>), String> {
    let original = Settings::original(LAST_TAKE_UP_UM);
    let make = |settings: &Settings| -> Result<Vec<Circle>, String> {
        let scale = nm(settings.step) / nm(super::TRUE_STEP);
        let cut = |circle: &measured::Circle| {
            cut_circle(&mut *shop.mill(settings)?, circle.radius_mm, scale)
        };
        CIRCLES.iter().map(cut).collect()
    };
    let (original, today) = (make(&original)?, make(&shop.today)?);
    let frame = Frame::fitted(&original);
    let mut rows = Vec::new();
    let mut made = Vec::new();
    for (measured, both) in CIRCLES.iter().zip(original.iter().zip(&today)) {
        let both = [both.0, both.1].map(|circle| circle.on(&frame, measured.radius_mm));
        add_rows(&mut rows, measured, &both);
        made.push(both);
    }
    let mut parameters = parameters(&shop.screws);
    parameters.extend(frame.parameters());
    parameters.push(Parameter::new(
        "feed",
        format!("{:.3} mm/min", feed_mm_per_min()),
        "fitted to the three times",
    ));
    let table = Table {
        number: "15",
        title: "concentric circles with a take-up of 204 um in X and 178 um in Y",
        spread: "diameters: the standard deviation of the circle; its mean: this through the root \
                 of 8; its sigma: this through the root of 14; ends: 33 um in X and 27 um in Y, \
                 which is what the original says remained; times: 1 min",
        rows,
        parameters,
        notes: notes(),
    };
    Ok((table, made))
}

fn notes() -> Vec<String> {
    [
        "The original prints the ends without sign. With these signs the play of X falls steadily \
         from left to right. Of all signs, and of all ends from which the thirds of table 13 may \
         count, this choice leaves least of the diameters, of the plays and of the parts of tables \
         16 to 20 together. The circles alone allow other signs nearly as well.",
        "The means of the circles are smaller than programmed by 42, 18 and 9 um. The step of \
         139.51 nm explains 21, 14 and 7 um of it.",
        "Today, the map removes the play and the true step the scale. The error of squareness \
         remains: the controller of the mill does not correct it.",
        "Unexplained: the over-compensation of 1 to 5 um that the text reports at some ends beside \
         the play left, as one end has one value in the simulation; and of the smallest circle, \
         whose diameters differ more than the play and the squareness make them.",
    ]
    .map(str::to_owned)
    .into()
}

fn add_rows(rows: &mut Vec<Row>, measured: &measured::Circle, [original, today]: &[Circle; 2]) {
    let programmed = 2.0 * measured.radius_mm;
    let sigma_mm = measured.sigma_um / 1e3;
    for index in 0..8 {
        let name = format!("{}: D{}", measured.name, index + 1);
        rows.push(
            Row::new(name, "mm", measured.diameters_mm[index], sigma_mm)
                .rebuilt(original.diameters_mm[index])
                .today(today.diameters_mm[index], programmed),
        );
    }
    let [(mean, sigma), (mean_today, sigma_today)] = [original, today].map(Circle::mean_and_sigma);
    let name = |what: &str| format!("{}: {what}", measured.name);
    rows.push(
        Row::new(
            name("mean"),
            "mm",
            measured.mean_mm,
            sigma_mm / 8_f64.sqrt(),
        )
        .rebuilt(mean)
        .today(mean_today, programmed),
    );
    let spread = measured.sigma_um / 14_f64.sqrt();
    rows.push(
        Row::new(name("sigma"), "um", measured.sigma_um, spread)
            .rebuilt(sigma)
            .today(sigma_today, 0.0),
    );
    for (end, words) in ENDS.into_iter().enumerate() {
        let left = SIGNS[end] * measured.ends_um[end];
        rows.push(
            Row::new(name(words), "um", left, LEFT_UM[end / 2])
                .rebuilt(original.ends_um[end])
                .today(today.ends_um[end], 0.0),
        );
    }
    rows.push(Row::new(name("time"), "min", measured.minutes, CLOCK_MIN).rebuilt(original.minutes));
}

/// The feed that fits the times of the three circles, by the mean of the times per length.
fn feed_mm_per_min() -> f64 {
    let [x, y] = LAST_TAKE_UP_UM.map(|um| um * 1e3 / nm(super::NOMINAL_STEP));
    let take_up_min = 2.0 * (x + y) / TAKE_UP_HZ / 60.0;
    let slowness = CIRCLES.iter();
    let slowness = slowness.map(|circle| (circle.minutes - take_up_min) / (TAU * circle.radius_mm));
    CIRCLES.len() as f64 / slowness.sum::<f64>()
}

/// Cuts a circle clockwise. `scale` is the calculated length per true length.
fn cut_circle(bench: &mut dyn Bench, radius_mm: f64, scale: f64) -> Result<Circle, String> {
    let [x, y] = MIDDLE_MM;
    let reach = radius_mm * FRAC_1_SQRT_2;
    // There a clockwise circle moves X and Y forward.
    let start = [x - reach, y + reach];
    approach(bench, start)?;
    let moments = cut(
        bench,
        &format!(
            "G2 X{:.5} Y{:.5} I{reach:.5} J{:.5} F{:.3}",
            start[0],
            start[1],
            -reach,
            feed_mm_per_min()
        ),
    )?;
    let (first, last) = moments.first().zip(moments.last()).ok_or("no steps")?;
    let around: Vec<Point> = moments
        .iter()
        .filter(|moment| !moment.is_take_up)
        .map(|moment| Point::of(moment, scale))
        .collect();
    let directions = (0..DIRECTIONS).map(|index| TAU * index as f64 / DIRECTIONS as f64);
    Ok(Circle {
        diameters_mm: [2.0 * radius_mm; 8],
        ends_um: [PI, 0.0, PI / 2.0, 1.5 * PI].map(|end| left_at(&around, end)),
        minutes: (last.at_s - first.at_s) / 60.0,
        radii_mm: directions.map(|at| radius_at(&around, at)).collect(),
    })
}

/// A point of a circle, seen from its centre.
struct Point {
    /// Direction in which the tool was and was sent, radians from +X anticlockwise.
    at: f64,
    sent_at: f64,
    radius_mm: f64,
    /// The tool less where it was sent, um.
    off_um: [f64; 2],
}

impl Point {
    fn of(moment: &Moment, scale: f64) -> Self {
        let centre = MIDDLE_MM.map(|mm| mm / scale);
        let tool = [0, 1].map(|axis| moment.tool_nm[axis] / 1e6 - centre[axis]);
        let sent = [0, 1].map(|axis| moment.sent_nm[axis] / 1e6 / scale - centre[axis]);
        Self {
            at: tool[1].atan2(tool[0]),
            sent_at: sent[1].atan2(sent[0]),
            radius_mm: tool[0].hypot(tool[1]),
            off_um: [0, 1].map(|axis| (tool[axis] - sent[axis]) * 1e3),
        }
    }
}

/// Angle from one direction to another, radians, without sign.
fn between(from: f64, to: f64) -> f64 {
    let turn = (to - from).rem_euclid(TAU);
    turn.min(TAU - turn)
}

/// Radius of the cut in a direction, mm.
fn radius_at(around: &[Point], at: f64) -> f64 {
    let near = |a: &&Point, b: &&Point| between(a.at, at).total_cmp(&between(b.at, at));
    around
        .iter()
        .min_by(near)
        .map_or(0.0, |point| point.radius_mm)
}

/// Play that is left at an end: the error on the negative flank less that on the positive one.
fn left_at(around: &[Point], end: f64) -> f64 {
    let axis = usize::from(end.cos().abs() < 0.5);
    let off = |at: f64| {
        let near =
            |a: &&Point, b: &&Point| between(a.sent_at, at).total_cmp(&between(b.sent_at, at));
        around
            .iter()
            .min_by(near)
            .map_or(0.0, |point| point.off_um[axis])
    };
    // Clockwise, the angle falls.
    let change = off(end - BEHIND) - off(end + BEHIND);
    // At the right and at the top the axis goes on to its negative flank.
    if end < 0.75 * PI { change } else { -change }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_feed_is_that_of_the_times() {
        let feed = feed_mm_per_min();
        assert!((0.8..0.9).contains(&feed), "{feed}");
    }
}
