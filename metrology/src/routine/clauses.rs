//! The clauses after the name of a feature.

use super::dimension::{Figure, Wanted};
use super::jobs::Needs;
use super::line_reader::{LineReader, Value, twice};
use super::mistake::{Wrong, code};
use super::parser::Parser;
use super::statement::{Fit, Job, Place};
use super::vector::{Vector, nearest_axis};
use std::ops::Range;

/// A value and its bytes in the line.
#[derive(Clone, Copy, Debug)]
pub struct Spanned<T> {
    pub value: T,
    pub start: usize,
    pub end: usize,
}

impl<T> Spanned<T> {
    fn new(value: T, span: Range<usize>) -> Self {
        Self {
            value,
            start: span.start,
            end: span.end,
        }
    }
}

/// All clauses of a feature. A clause that its statement does not accept is refused during reading.
#[derive(Debug, Default)]
pub struct Clauses {
    at: Vec<[Option<Value>; 3]>,
    at_span: Range<usize>,
    pub towards: Vec<Vector>,
    pub along: Option<Spanned<Vector>>,
    pub of: Vec<String>,
    pub between: Vec<String>,
    pub points: Option<Spanned<u32>>,
    from: Option<Spanned<i64>>,
    to: Option<Spanned<i64>>,
    pub over: Option<Spanned<i64>>,
    pub inset: Option<Spanned<i64>>,
    pub within: Option<Spanned<i64>>,
    pub clearance: Option<Spanned<i64>>,
    pub search: Option<Spanned<i64>>,
    pub is_inside: Option<bool>,
    pub diameter: Option<Spanned<i64>>,
    pub width: Option<Spanned<i64>>,
    figures: Vec<Wanted>,
}

/// Sets a value that may be set once.
fn set<T>(slot: &mut Option<T>, value: T, word: &str, span: Range<usize>) -> Result<(), Wrong> {
    match slot.replace(value) {
        None => Ok(()),
        Some(_) => Err(twice(word, span)),
    }
}

impl Clauses {
    /// Reads to the end of the line.
    pub fn read(
        parser: &Parser,
        keyword: &str,
        allowed: &[&str],
        figures: &[Figure],
        reader: &mut LineReader<'_>,
    ) -> Result<Self, Wrong> {
        let mut clauses = Self::default();
        if keyword == "touch" && reader.is_direction() {
            clauses.towards.push(reader.direction()?);
        }
        let names = figures.iter().map(|figure| figure.name());
        let stops: Vec<&str> = allowed.iter().copied().chain(names).collect();
        while let Some(word) = reader.peek().cloned() {
            let lower = word.text.to_ascii_lowercase();
            let figure = figures.iter().find(|figure| figure.name() == lower);
            if !allowed.contains(&lower.as_str()) && figure.is_none() {
                let mut all = stops.clone();
                all.truncate(allowed.len());
                all.extend(
                    stops[allowed.len()..]
                        .iter()
                        .filter(|name| !allowed.contains(name)),
                );
                return Err(Wrong::new(
                    code::WORD,
                    format!("`{keyword}` takes no `{}`", word.text),
                    word.span,
                )
                .help(format!("it takes {}", all.join(", "))));
            }
            reader.next();
            clauses.clause(parser, &lower, figure.copied(), &stops, reader)?;
        }
        Ok(clauses)
    }

    fn clause(
        &mut self,
        parser: &Parser,
        word: &str,
        figure: Option<Figure>,
        stops: &[&str],
        reader: &mut LineReader<'_>,
    ) -> Result<(), Wrong> {
        let span = reader.before();
        match word {
            "at" => self.place(reader),
            "towards" => {
                loop {
                    self.towards.push(reader.direction()?);
                    // `x 10` after a direction is a figure.
                    let is_over = !reader.is_direction() || reader.peek_axis().is_some();
                    if is_over || self.towards.len() == 2 {
                        return Ok(());
                    }
                }
            }
            "along" => {
                let along = Spanned::new(reader.direction()?, span.clone());
                set(&mut self.along, along, word, span)
            }
            "of" => {
                self.of = parser.names(reader, "point", stops)?;
                Ok(())
            }
            "between" => {
                let as_what = if stops.contains(&"along") {
                    "feature"
                } else {
                    "line or plane"
                };
                self.between = parser.names(reader, as_what, stops)?;
                Ok(())
            }
            "points" => {
                let count = Spanned::new(reader.count("points", 1..1001)?, span.clone());
                set(&mut self.points, count, word, span)
            }
            "from" | "to" => {
                let angle = Spanned::new(reader.angle(word)?, span.clone());
                let slot = if word == "from" {
                    &mut self.from
                } else {
                    &mut self.to
                };
                set(slot, angle, word, span)
            }
            "inside" | "outside" => set(&mut self.is_inside, word == "inside", word, span),
            "over" | "inset" | "within" | "clearance" | "search" => {
                let length = Spanned::new(reader.positive(word)?, span.clone());
                let slot = match word {
                    "over" => &mut self.over,
                    "inset" => &mut self.inset,
                    "within" => &mut self.within,
                    "clearance" => &mut self.clearance,
                    _ => &mut self.search,
                };
                set(slot, length, word, span)
            }
            _ => match figure {
                Some(figure) => self.figure(figure, reader),
                // `diameter` and `width` of features that have this figure as well.
                None => Err(twice(word, span)),
            },
        }
    }

    /// A figure with its nominal value and tolerance.
    fn figure(&mut self, figure: Figure, reader: &mut LineReader<'_>) -> Result<(), Wrong> {
        let span = reader.before();
        let word = figure.name();
        let number = reader.here();
        let (nominal_micro, tolerance_micro) = match figure {
            Figure::Angle => reader.toleranced_angle(word)?,
            Figure::Form => (0, Some([0, reader.positive(word)?])),
            _ => reader.toleranced_length(word)?,
        };
        let slot = match figure {
            Figure::Diameter => Some(&mut self.diameter),
            Figure::Width => Some(&mut self.width),
            _ => None,
        };
        if let Some(slot) = slot {
            if nominal_micro <= 0 {
                let message = format!("{word} must be above 0");
                return Err(Wrong::new(code::NUMBER, message, number));
            }
            set(
                slot,
                Spanned::new(nominal_micro, span.clone()),
                word,
                span.clone(),
            )?;
        }
        self.want(
            Wanted {
                figure,
                nominal_micro,
                tolerance_micro,
            },
            span,
        )
    }

    fn want(&mut self, wanted: Wanted, span: Range<usize>) -> Result<(), Wrong> {
        if self
            .figures
            .iter()
            .any(|other| other.figure == wanted.figure)
        {
            return Err(twice(wanted.figure.name(), span)
                .label("a figure is given once, with at most one tolerance"));
        }
        self.figures.push(wanted);
        Ok(())
    }

    /// Reads coordinates with their tolerances.
    fn place(&mut self, reader: &mut LineReader<'_>) -> Result<(), Wrong> {
        let span = reader.before();
        let mut place = [None; 3];
        while place.iter().any(Option::is_none) {
            // The second number for an axis is a figure.
            let is_new = reader.peek_axis().is_some_and(|axis| place[axis].is_none());
            if !is_new {
                break;
            }
            let Some((axis, word)) = reader.axis() else {
                break;
            };
            let value = reader.toleranced_length("at")?;
            if value.1.is_some() {
                let wanted = Wanted {
                    figure: Figure::COORDINATES[axis],
                    nominal_micro: value.0,
                    tolerance_micro: value.1,
                };
                self.want(wanted, word.span)?;
            }
            place[axis] = Some(value);
        }
        if place.iter().all(Option::is_none) {
            return Err(
                Wrong::new(code::MISSING, "`at` without coordinates", reader.here())
                    .label("a coordinate belongs here")
                    .help("as in `at x 10 y 20 z 0`; a missing coordinate is that of the tip"),
            );
        }
        self.at_span = span;
        self.at.push(place);
        Ok(())
    }

    /// The only position.
    pub fn one_place(&self, needs: &Needs<'_, '_>) -> Result<Place, Wrong> {
        match self.at.as_slice() {
            [] => Err(needs.missing("at", "its coordinates, as in `at x 10 y 20 z 0`")),
            [place] => Ok(plain(place)),
            _ => Err(twice("at", self.at_span.clone())),
        }
    }

    /// At least `least` positions.
    pub fn places(&self, least: usize, needs: &Needs<'_, '_>) -> Result<Vec<Place>, Wrong> {
        if self.at.len() >= least {
            return Ok(self.at.iter().map(plain).collect());
        }
        let what = format!(
            "the coordinates of each touch, at least {least}; or `of` and the names of points"
        );
        Err(needs.missing("at", &what))
    }

    /// The only direction.
    pub fn direction(&self, needs: &Needs<'_, '_>) -> Result<Vector, Wrong> {
        match self.towards.as_slice() {
            [direction] => Ok(*direction),
            _ => Err(needs.missing("towards", "the direction of travel, as in `towards -z`")),
        }
    }

    /// The number of points, at least `least`.
    pub fn points(&self, usual: u32, least: u32, reader: &LineReader<'_>) -> Result<u32, Wrong> {
        match self.points {
            None => Ok(usual),
            Some(count) if count.value >= least => Ok(count.value),
            Some(count) => {
                let message = format!("too few points for this feature: {}", count.value);
                let span = count.start..count.end.max(reader.whole().start);
                Err(Wrong::new(code::NUMBER, message, span).help(format!("at least {least}")))
            }
        }
    }

    /// First and last direction of a circle, degrees.
    pub fn arc_deg(&self, needs: &Needs<'_, '_>) -> Result<[f64; 2], Wrong> {
        let degrees = |angle: Spanned<i64>| angle.value as f64 / 1e6;
        match (self.from.map(degrees), self.to.map(degrees)) {
            (from, None) => {
                let from = from.unwrap_or_default();
                Ok([from, from + 360.0])
            }
            (Some(from), Some(to)) if from < to && to - from <= 360.0 => Ok([from, to]),
            (Some(_), Some(to)) => {
                let span = self.to.map_or(0..0, |to| to.start..to.end);
                Err(
                    Wrong::new(code::NUMBER, format!("an arc cannot end at {to} deg"), span).help(
                        "it runs counter-clockwise: `to` is beyond `from`, by at most 360 deg",
                    ),
                )
            }
            (None, Some(_)) => Err(needs.missing("from", "the direction of the first touch")),
        }
    }

    /// The fit of a feature to existing points.
    pub fn fit(&self, keyword: &str, reader: &LineReader<'_>) -> Result<Fit, Wrong> {
        let shape = match keyword {
            "plane" => Fit::Plane,
            "line" => Fit::Line,
            "sphere" => Fit::Sphere,
            _ => Fit::Circle,
        };
        let surplus = [
            ("at", !self.at.is_empty()),
            ("towards", !self.towards.is_empty()),
            ("points", self.points.is_some()),
        ];
        if let Some((word, _)) = surplus.iter().find(|(_, is_there)| *is_there) {
            return Err(Wrong::new(
                code::WORD,
                format!("`of` together with `{word}`"),
                reader.whole(),
            )
            .label("a feature is fitted to existing points or measured now"));
        }
        if self.of.len() < shape.least_points() {
            return Err(Wrong::new(
                code::MISSING,
                format!("too few points for `{keyword}`: {}", self.of.len()),
                reader.whole(),
            )
            .help(format!("at least {}", shape.least_points())));
        }
        Ok(shape)
    }

    /// The wanted figures: those with a tolerance, and the coordinates that the feature measures.
    pub fn wanted(&self, job: &Job) -> Vec<Wanted> {
        let along = |direction: &Vector| {
            let (axis, _) = nearest_axis(*direction, None);
            let mut axes = [false; 3];
            axes[axis] = true;
            axes
        };
        let measured = match job {
            Job::Touch { towards, .. } | Job::Point { towards, .. } | Job::Edge { towards, .. } => {
                along(towards)
            }
            Job::Width { along: across, .. } => along(across),
            Job::Corner { .. } | Job::Round { .. } => [true, true, false],
            Job::Sphere { .. } => [true; 3],
            _ => [false; 3],
        };
        let mut wanted = self.figures.clone();
        if let [place] = self.at.as_slice() {
            for ((figure, value), is_measured) in
                Figure::COORDINATES.into_iter().zip(place).zip(measured)
            {
                let is_said = wanted.iter().any(|wanted| wanted.figure == figure);
                if let (Some((nominal_micro, None)), true, false) = (*value, is_measured, is_said) {
                    wanted.push(Wanted {
                        figure,
                        nominal_micro,
                        tolerance_micro: None,
                    });
                }
            }
        }
        wanted
    }
}

/// The coordinates without their tolerances.
fn plain(place: &[Option<Value>; 3]) -> Place {
    place.map(|value| value.map(|(nominal, _)| nominal))
}
