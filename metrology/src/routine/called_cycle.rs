//! The measuring cycles that a G-code program calls as subroutines.

use super::dimension::{Figure, Wanted};
use super::statement::{Job, Place, Task};

/// A cycle that a program can call, and its arguments.
pub struct Cycle {
    /// Name in the call.
    pub name: &'static str,
    /// Names of its arguments. The first `needed` must be given.
    pub arguments: &'static str,
    needed: usize,
    most: usize,
}

const fn cycle(name: &'static str, needed: usize, most: usize, arguments: &'static str) -> Cycle {
    Cycle {
        name,
        arguments,
        needed,
        most,
    }
}

/// All cycles.
pub const CYCLES: [Cycle; 9] = [
    cycle("point", 6, 6, "[x] [y] [z] [dx] [dy] [dz]"),
    cycle("edge", 5, 7, "[x] [y] [z] [dx] [dy] [points] [over]"),
    cycle("corner", 6, 7, "[x] [y] [z] [dx] [dy] [inset] [inside]"),
    cycle("web", 4, 6, "[x] [y] [z] [width] [dx] [dy]"),
    cycle("pocket", 4, 6, "[x] [y] [z] [width] [dx] [dy]"),
    cycle("bore", 4, 5, "[x] [y] [z] [diameter] [points]"),
    cycle("boss", 4, 5, "[x] [y] [z] [diameter] [points]"),
    cycle("plane", 5, 5, "[x] [y] [z] [dx] [dy]"),
    cycle("sphere", 4, 5, "[x] [y] [z] [diameter] [points]"),
];

/// The cycle of this name, upper or lower case.
pub fn by_name(name: &[u8]) -> Option<&'static Cycle> {
    let mut cycles = CYCLES.iter();
    cycles.find(|cycle| cycle.name.as_bytes().eq_ignore_ascii_case(name))
}

impl Cycle {
    /// The task of the cycle with these arguments. `lengths_nm` are the arguments as lengths, and
    /// `numbers` are the same arguments as numbers. `count` becomes part of the name of the
    /// feature.
    ///
    /// # Errors
    ///
    /// A sentence about the arguments.
    pub fn task(
        &'static self,
        lengths_nm: &[i64],
        numbers: &[f64],
        count: usize,
    ) -> Result<Task, String> {
        let Self { name, .. } = self;
        if !(self.needed..=self.most).contains(&numbers.len()) {
            return Err(format!("o<{name}> call {}", self.arguments));
        }
        let nm = |index: usize| lengths_nm.get(index).copied().unwrap_or_default();
        let part = |index: usize| numbers.get(index).copied().unwrap_or_default();
        let at: Place = [Some(nm(0)), Some(nm(1)), Some(nm(2))];
        let sense = |sign: f64| if sign < 0.0 { -1.0 } else { 1.0 };
        let points = |index: usize, usual: u32, least: u32| {
            let points = numbers
                .get(index)
                .map_or(Some(usual), |points| count_of(*points, least));
            points.ok_or_else(|| format!("o<{name}> takes {least} to 1000 points"))
        };
        let across = if numbers.len() > 4 {
            [part(4), part(5), 0.0]
        } else {
            [1.0, 0.0, 0.0]
        };
        let job = match *name {
            "point" => Job::Point {
                at,
                towards: [part(3), part(4), part(5)],
            },
            "edge" => Job::Edge {
                at,
                towards: [part(3), part(4), 0.0],
                points: points(5, 1, 1)?,
                over_nm: nm(6),
            },
            "corner" => Job::Corner {
                at,
                towards: [[sense(part(3)), 0.0, 0.0], [0.0, sense(part(4)), 0.0]],
                inset_nm: nm(5),
                is_inside: part(6) != 0.0,
            },
            "web" | "pocket" => Job::Width {
                at,
                along: across,
                width_nm: nm(3),
                is_inside: *name == "pocket",
            },
            "bore" | "boss" => Job::Round {
                at,
                diameter_nm: nm(3),
                points: points(4, 4, 3)?,
                arc_deg: [0.0, 360.0],
                is_inside: *name == "bore",
            },
            "sphere" => Job::Sphere {
                at,
                diameter_nm: nm(3),
                points: points(4, 9, 5)?,
            },
            _ => {
                let ends = |at: i64, length: i64| [at, at.saturating_add(length)];
                let ([x0, x1], [y0, y1]) = (ends(nm(0), nm(3)), ends(nm(1), nm(4)));
                let places = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
                Job::Plane {
                    at: places.map(|[x, y]| [Some(x), Some(y), at[2]]).to_vec(),
                    towards: [0.0, 0.0, -1.0],
                }
            }
        };
        check(&job, name)?;
        Ok(Task {
            keyword: self.name,
            name: format!("{name}-{count}"),
            wanted: wanted(&job),
            job,
            clearance_nm: None,
            search_nm: None,
        })
    }
}

/// A number of points from `least` to 1000. `None`: it is not in this range, or not whole.
fn count_of(points: f64, least: u32) -> Option<u32> {
    let is_possible = points.fract() == 0.0 && (f64::from(least)..=1000.0).contains(&points);
    is_possible.then_some(points as u32)
}

/// Refuses directions of length 0 and sizes of at most 0.
fn check(job: &Job, name: &str) -> Result<(), String> {
    let (direction, size) = match job {
        Job::Point { towards, .. } => (Some(towards), 1),
        Job::Edge {
            towards,
            points,
            over_nm,
            ..
        } => (Some(towards), if *points == 1 { 1 } else { *over_nm }),
        Job::Width {
            along, width_nm, ..
        } => (Some(along), *width_nm),
        Job::Corner { inset_nm, .. } => (None, *inset_nm),
        Job::Round { diameter_nm, .. } | Job::Sphere { diameter_nm, .. } => (None, *diameter_nm),
        _ => (None, 1),
    };
    if direction.is_some_and(|direction| *direction == [0.0; 3]) {
        return Err(format!("o<{name}>: a direction of length 0"));
    }
    if size <= 0 {
        return Err(format!("o<{name}>: a size must be above 0"));
    }
    Ok(())
}

/// Nominal values of the figures, from the arguments.
fn wanted(job: &Job) -> Vec<Wanted> {
    let of = |figure, nominal_micro| Wanted {
        figure,
        nominal_micro,
        tolerance_micro: None,
    };
    let places = |at: &Place, axes: [bool; 3]| -> Vec<Wanted> {
        let given = Figure::COORDINATES.into_iter().zip(at).zip(axes);
        given
            .filter_map(|((figure, nm), is_measured)| {
                nm.filter(|_| is_measured).map(|nm| of(figure, nm))
            })
            .collect()
    };
    let flat = [true, true, false];
    match job {
        Job::Round {
            at, diameter_nm, ..
        } => [places(at, flat), vec![of(Figure::Diameter, *diameter_nm)]].concat(),
        Job::Sphere {
            at, diameter_nm, ..
        } => [
            places(at, [true; 3]),
            vec![of(Figure::Diameter, *diameter_nm)],
        ]
        .concat(),
        Job::Width { width_nm, .. } => vec![of(Figure::Width, *width_nm)],
        Job::Corner { at, .. } => places(at, flat),
        _ => Vec::new(),
    }
}
