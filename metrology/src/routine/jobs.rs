//! The job of a feature, from its clauses.

use super::clauses::{Clauses, Spanned};
use super::dimension::Figure::{Angle, Form};
use super::dimension::Wanted;
use super::line_reader::LineReader;
use super::mistake::{Wrong, code};
use super::parser::{Offer, Parser};
use super::statement::{Fit, Job};
use super::vector::{Vector, nearest_axis};
use husillo_sim::text::counted;

impl Parser {
    /// The job and the wanted figures of a feature, from its clauses.
    pub(super) fn job(
        &self,
        keyword: &str,
        clauses: &Clauses,
        reader: &LineReader<'_>,
    ) -> Result<(Job, Vec<Wanted>), Wrong> {
        let needs = Needs { keyword, reader };
        let one = || clauses.one_place(&needs);
        let job = match keyword {
            "touch" => Job::Touch {
                towards: clauses.direction(&needs)?,
                within_nm: clauses.within.map(|nm| nm.value),
            },
            "point" => Job::Point {
                at: one()?,
                towards: clauses.direction(&needs)?,
            },
            "edge" => edge(clauses, &needs)?,
            "corner" => corner(clauses, &needs)?,
            "web" | "pocket" => Job::Width {
                at: one()?,
                along: level(
                    needs.given(clauses.along, "along", "the direction across the faces")?,
                    reader,
                )?,
                width_nm: needs.given(
                    clauses.width,
                    "width",
                    "the approximate distance of the faces",
                )?,
                is_inside: keyword == "pocket",
            },
            "bore" | "boss" | "circle" | "sphere" if clauses.of.is_empty() => {
                round(clauses, &needs)?
            }
            "plane" | "line" if clauses.of.is_empty() => {
                let least = if keyword == "plane" { 3 } else { 2 };
                let at = clauses.places(least, &needs)?;
                let towards = clauses.direction(&needs)?;
                match keyword {
                    "plane" => Job::Plane { at, towards },
                    _ => Job::Line { at, towards },
                }
            }
            "distance" => Job::Distance {
                between: needs.pair(&clauses.between)?,
                along: clauses.along.map(|along| along.value),
            },
            "angle" => Job::Angle {
                between: needs.pair(&clauses.between)?,
            },
            _ => Job::Fit {
                shape: clauses.fit(keyword, reader)?,
                of: clauses.of.clone(),
            },
        };
        if needs_safe(&job) && !self.has_safe {
            return Err(Wrong::new(
                code::MISSING,
                format!("a {keyword} is touched from outside, and no safe height is known"),
                reader.whole(),
            )
            .label("the tip travels over it")
            .help("write `safe z ...` in an earlier line"));
        }
        let wanted = clauses.wanted(&job);
        check_figures(keyword, &job, &wanted, reader)?;
        Ok((job, wanted))
    }
}

/// The job of an `edge`.
fn edge(clauses: &Clauses, needs: &Needs<'_, '_>) -> Result<Job, Wrong> {
    let points = clauses.points.map_or(1, |count| count.value);
    Ok(Job::Edge {
        at: clauses.one_place(needs)?,
        towards: level(clauses.direction(needs)?, needs.reader)?,
        points,
        over_nm: match clauses.over {
            Some(over) => over.value,
            None if points == 1 => 0,
            None => {
                return Err(needs.missing("over", "the length of the row of points"));
            }
        },
    })
}

/// The job of a `corner`.
fn corner(clauses: &Clauses, needs: &Needs<'_, '_>) -> Result<Job, Wrong> {
    let &[first, second] = clauses.towards.as_slice() else {
        return Err(needs.missing(
            "towards",
            "the directions into both faces, as in `towards +x +y`",
        ));
    };
    if nearest_axis(first, None).0 == nearest_axis(second, None).0 {
        return Err(Wrong::new(
            code::NUMBER,
            "both directions are along the same axis",
            needs.reader.whole(),
        )
        .help("one direction into each face, as in `towards +x +y`"));
    }
    Ok(Job::Corner {
        at: clauses.one_place(needs)?,
        towards: [level(first, needs.reader)?, level(second, needs.reader)?],
        inset_nm: needs.given(
            clauses.inset,
            "inset",
            "the distance from the corner to the first touch of each face",
        )?,
        is_inside: clauses.is_inside == Some(true),
    })
}

/// The job of a bore, a boss, a circle or a sphere.
fn round(clauses: &Clauses, needs: &Needs<'_, '_>) -> Result<Job, Wrong> {
    let diameter_nm = needs.given(clauses.diameter, "diameter", "the approximate diameter")?;
    Ok(match needs.keyword {
        "sphere" => Job::Sphere {
            at: clauses.one_place(needs)?,
            diameter_nm,
            points: clauses.points(9, 5, needs.reader)?,
        },
        _ => Job::Round {
            at: clauses.one_place(needs)?,
            diameter_nm,
            points: clauses.points(4, 3, needs.reader)?,
            arc_deg: clauses.arc_deg(needs)?,
            is_inside: match needs.keyword {
                "bore" => true,
                "boss" => false,
                _ => needs.choice(clauses.is_inside)?,
            },
        },
    })
}

/// Refuses a tolerance on a figure for which there are too few points.
fn check_figures(
    keyword: &str,
    job: &Job,
    wanted: &[Wanted],
    reader: &LineReader<'_>,
) -> Result<(), Wrong> {
    let is_wanted = |figure| wanted.iter().any(|wanted| wanted.figure == figure);
    if let Some((points, least)) = points_of(job) {
        let figure = match job {
            Job::Edge { .. } if points == 1 && is_wanted(Angle) => Some(Angle),
            _ if points <= least && is_wanted(Form) => Some(Form),
            _ => None,
        };
        if let Some(figure) = figure {
            let (name, least) = (figure.name(), if figure == Form { least + 1 } else { 2 });
            let points = counted(points, "point");
            return Err(Wrong::new(
                code::TOLERANCE,
                format!("`{keyword}` of {points} has no {name}"),
                reader.whole(),
            )
            .help(format!("at least {least} points")));
        }
    }
    Ok(())
}

/// The needs of a statement, and the messages about missing clauses.
pub struct Needs<'a, 't> {
    keyword: &'a str,
    reader: &'a LineReader<'t>,
}

impl Needs<'_, '_> {
    pub fn missing(&self, clause: &str, what: &str) -> Wrong {
        let Self { keyword, reader } = self;
        Wrong::new(
            code::MISSING,
            format!("`{keyword}` without `{clause}`"),
            reader.whole(),
        )
        .label(format!("`{clause}` is missing"))
        .help(format!("`{clause}`: {what}"))
    }

    fn given<T: Copy>(
        &self,
        value: Option<Spanned<T>>,
        clause: &str,
        what: &str,
    ) -> Result<T, Wrong> {
        value
            .map(|value| value.value)
            .ok_or_else(|| self.missing(clause, what))
    }

    fn choice(&self, is_inside: Option<bool>) -> Result<bool, Wrong> {
        is_inside.ok_or_else(|| {
            self.missing(
                "inside",
                "for a hole, `outside` for a pin; or `of` and the names of points",
            )
        })
    }

    fn pair(&self, names: &[String]) -> Result<[String; 2], Wrong> {
        let pair = <&[String; 2]>::try_from(names).ok().cloned();
        pair.ok_or_else(|| self.missing("between", "the names of two features"))
    }
}

/// Refuses a direction that is not perpendicular to Z.
fn level(direction: Vector, reader: &LineReader<'_>) -> Result<Vector, Wrong> {
    if direction[2] == 0.0 {
        return Ok(direction);
    }
    Err(Wrong::new(
        code::NUMBER,
        "the direction leaves the plane of X and Y",
        reader.whole(),
    )
    .help("use `point` or `plane` for a face across Z"))
}

/// Whether the tip cannot go around the feature at its height.
fn needs_safe(job: &Job) -> bool {
    matches!(
        job,
        Job::Width {
            is_inside: false,
            ..
        } | Job::Round {
            is_inside: false,
            ..
        }
    )
}

/// The number of points of a feature, and the number of points that leave no residuals.
fn points_of(job: &Job) -> Option<(usize, usize)> {
    // At most 1000.
    let count = |points: u32| points as usize;
    Some(match job {
        Job::Edge { points, .. } => (count(*points), 2),
        Job::Round { points, .. } => (count(*points), 3),
        Job::Sphere { points, .. } => (count(*points), 4),
        Job::Plane { at, .. } => (at.len(), 3),
        Job::Line { at, .. } => (at.len(), 2),
        Job::Fit { shape, of } => (of.len(), shape.least_points()),
        _ => return None,
    })
}

/// The possible uses of the feature of a job.
pub fn offer(job: &Job) -> Offer {
    let shape = |point, line, plane| Offer { point, line, plane };
    match job {
        Job::Edge { points, .. } => shape(true, *points > 1, true),
        Job::Plane { .. }
        | Job::Fit {
            shape: Fit::Plane, ..
        } => shape(true, false, true),
        Job::Line { .. }
        | Job::Fit {
            shape: Fit::Line, ..
        } => shape(true, true, false),
        Job::Distance { .. } | Job::Angle { .. } => Offer::default(),
        _ => shape(true, false, false),
    }
}
