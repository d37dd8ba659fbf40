//! Lines of a routine, read and checked against those before.

use super::clauses::{Clauses, Spanned};
use super::dimension::{Figure, Wanted};
use super::line_reader::{LineReader, axis_of, twice};
use super::statement::{Fit, Job, Order, Place, Statement, Task};
use super::vector::{Vector, nearest_axis};
use super::wrong::{Mistake, Wrong, code};
use std::collections::HashMap;

/// What a named feature can be used for.
#[derive(Clone, Copy, Debug, Default)]
struct Offer {
    point: bool,
    line: bool,
    plane: bool,
}

/// Reads lines one after another and remembers what was named.
#[derive(Clone, Debug)]
pub struct Parser {
    unit: &'static str,
    has_safe: bool,
    known: HashMap<String, (usize, Offer)>,
    unnamed: usize,
}

/// Statements that are no features.
const ORDERS: [&str; 8] = [
    "units",
    "clearance",
    "search",
    "safe",
    "goto",
    "jog",
    "zero",
    "frame",
];

/// A feature: its word, the clauses it takes, and the figures it has.
type Feature = (&'static str, &'static [&'static str], &'static [Figure]);

use Figure::{Angle, Diameter, Form, Length, Width, X, Y, Z};

const FEATURES: [Feature; 14] = [
    ("touch", &["towards", "within"], &[X, Y, Z]),
    (
        "point",
        &["at", "towards", "clearance", "search"],
        &[X, Y, Z],
    ),
    (
        "edge",
        &["at", "towards", "points", "over", "clearance", "search"],
        &[X, Y, Z, Angle, Form],
    ),
    (
        "corner",
        &["at", "towards", "inset", "inside", "clearance", "search"],
        &[X, Y, Angle],
    ),
    (
        "web",
        &["at", "along", "width", "clearance", "search"],
        &[X, Y, Z, Width],
    ),
    (
        "pocket",
        &["at", "along", "width", "clearance", "search"],
        &[X, Y, Z, Width],
    ),
    (
        "bore",
        &[
            "at",
            "diameter",
            "points",
            "from",
            "to",
            "clearance",
            "search",
        ],
        &[X, Y, Z, Diameter, Form],
    ),
    (
        "boss",
        &[
            "at",
            "diameter",
            "points",
            "from",
            "to",
            "clearance",
            "search",
        ],
        &[X, Y, Z, Diameter, Form],
    ),
    (
        "circle",
        &[
            "of",
            "at",
            "diameter",
            "points",
            "from",
            "to",
            "inside",
            "outside",
            "clearance",
            "search",
        ],
        &[X, Y, Z, Diameter, Form],
    ),
    (
        "plane",
        &["of", "at", "towards", "clearance", "search"],
        &[X, Y, Z, Form],
    ),
    (
        "line",
        &["of", "at", "towards", "clearance", "search"],
        &[X, Y, Z, Angle, Form],
    ),
    (
        "sphere",
        &["of", "at", "diameter", "points", "clearance", "search"],
        &[X, Y, Z, Diameter, Form],
    ),
    ("distance", &["between", "along"], &[Length]),
    ("angle", &["between"], &[Angle]),
];

/// Names that would be read as something else.
const RESERVED: [&str; 20] = [
    "at", "towards", "along", "of", "between", "points", "over", "inset", "inside", "outside",
    "within", "from", "to", "x", "y", "z", "diameter", "width", "form", "length",
];

impl Default for Parser {
    fn default() -> Self {
        Self::new()
    }
}

impl Parser {
    /// At the first line.
    pub fn new() -> Self {
        Self {
            unit: "mm",
            has_safe: false,
            known: HashMap::new(),
            unnamed: 0,
        }
    }

    /// Reads a whole file.
    ///
    /// # Errors
    ///
    /// Every line that is wrong.
    pub fn file(text: &str) -> Result<Vec<Statement>, Vec<Mistake>> {
        let mut parser = Self::new();
        let mut mistakes = Vec::new();
        let mut statements = Vec::new();
        for (number, line) in (1..).zip(text.lines()) {
            match parser.line(number, line) {
                Ok(statement) => statements.extend(statement),
                Err(wrong) => mistakes.push(Mistake {
                    line: number,
                    wrong,
                }),
            }
        }
        if mistakes.is_empty() {
            Ok(statements)
        } else {
            Err(mistakes)
        }
    }

    /// Reads a line; `None` where it says nothing.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong with it.
    pub fn line(&mut self, number: usize, text: &str) -> Result<Option<Statement>, Wrong> {
        let mut reader = LineReader::new(text, self.unit);
        let Some(word) = reader.next() else {
            return Ok(None);
        };
        let keyword = word.text.to_ascii_lowercase();
        let order = match keyword.as_str() {
            "units" => {
                self.unit = unit(&mut reader)?;
                reader.finish()?;
                return Ok(None);
            }
            "clearance" => Order::Clearance(reader.positive("clearance")?),
            "search" => Order::Search(reader.positive("search")?),
            "safe" => self.safe(&mut reader)?,
            "goto" => Order::GoTo(place(&mut reader, "goto")?),
            "jog" => {
                let way = place(&mut reader, "jog")?;
                Order::Jog(way.map(Option::unwrap_or_default))
            }
            "zero" => Order::Zero(zero(&mut reader)?),
            "frame" => self.frame(&mut reader)?,
            _ => match FEATURES.iter().find(|(name, ..)| *name == keyword) {
                Some(feature) => self.feature(number, feature, &mut reader)?,
                None => {
                    let names = ORDERS.iter().chain(FEATURES.iter().map(|(name, ..)| name));
                    let names: Vec<_> = names.copied().collect();
                    return Err(Wrong::new(
                        code::WORD,
                        format!("unknown word `{}`", word.text),
                        word.span,
                    )
                    .label("no statement of a routine")
                    .help(format!("there are {}", names.join(", "))));
                }
            },
        };
        reader.finish()?;
        Ok(Some(Statement {
            line: number,
            order,
        }))
    }

    fn safe(&mut self, reader: &mut LineReader<'_>) -> Result<Order, Wrong> {
        if reader.take("off").is_some() {
            self.has_safe = false;
            return Ok(Order::Safe(None));
        }
        let span = reader.here();
        match reader.axis() {
            Some((2, _)) => {
                self.has_safe = true;
                Ok(Order::Safe(Some(reader.length("safe")?)))
            }
            _ => Err(Wrong::new(code::MISSING, "safe at which height?", span)
                .help("as in `safe z 30`, or `safe off`")),
        }
    }

    /// `frame machine`, or `frame plane A line B point C at x 0 y 0 z 0`.
    fn frame(&mut self, reader: &mut LineReader<'_>) -> Result<Order, Wrong> {
        if reader.take("machine").is_some() {
            return Ok(Order::MachineFrame);
        }
        let mut of: [String; 3] = Default::default();
        for (slot, word) in of.iter_mut().zip(["plane", "line", "point"]) {
            if reader.take(word).is_none() {
                return Err(Wrong::new(
                    code::MISSING,
                    format!("a frame needs a {word}"),
                    reader.here(),
                )
                .label(format!("`{word}` and its name belong here"))
                .help("as in `frame plane top line front point left`, or `frame machine`"));
            }
            *slot = self.used(reader, word)?;
        }
        let called = match reader.take("at") {
            Some(_) => place(reader, "at")?,
            None => [None; 3],
        };
        Ok(Order::Frame {
            of,
            called_nm: called.map(Option::unwrap_or_default),
        })
    }

    /// The name of a feature that was measured before and can be used so.
    fn used(&self, reader: &mut LineReader<'_>, as_what: &str) -> Result<String, Wrong> {
        let span = reader.here();
        let Some(word) = reader.next() else {
            return Err(Wrong::new(code::MISSING, "a name is missing", span).label("belongs here"));
        };
        let Some((line, offer)) = self.known.get(&word.text.to_ascii_lowercase()) else {
            let message = format!("nothing is named `{}` yet", word.text);
            let help = match self.known.is_empty() {
                true => "measure it in a line before".to_owned(),
                false => {
                    let mut names: Vec<_> = self.known.iter().collect();
                    names.sort_by_key(|(_, (line, _))| *line);
                    let names: Vec<_> = names.iter().map(|(name, _)| name.as_str()).collect();
                    format!("there is {}", names.join(", "))
                }
            };
            return Err(Wrong::new(code::NAME, message, word.span).help(help));
        };
        let is_fit = match as_what {
            "plane" => offer.plane,
            "line" => offer.line,
            "feature" => offer.point || offer.line || offer.plane,
            "line or plane" => offer.line || offer.plane,
            _ => offer.point,
        };
        if is_fit {
            return Ok(word.text.to_ascii_lowercase());
        }
        Err(Wrong::new(
            code::NAME,
            format!("`{}` is no {as_what}", word.text),
            word.span,
        )
        .label(format!("measured in line {line}")))
    }

    /// A feature, its name and its clauses.
    fn feature(
        &mut self,
        number: usize,
        &(keyword, allowed, figures): &Feature,
        reader: &mut LineReader<'_>,
    ) -> Result<Order, Wrong> {
        let name = self.name(keyword, reader)?;
        let clauses = Clauses::read(self, keyword, allowed, figures, reader)?;
        let (job, wanted) = self.job(keyword, &clauses, reader)?;
        let offer = offer(&job);
        self.known
            .insert(name.to_ascii_lowercase(), (number, offer));
        Ok(Order::Measure(Box::new(Task {
            keyword,
            name,
            job,
            wanted,
            clearance_nm: clauses.clearance.map(|nm| nm.value),
            search_nm: clauses.search.map(|nm| nm.value),
        })))
    }

    /// The name of a new feature; a touch may go without.
    fn name(
        &mut self,
        keyword: &'static str,
        reader: &mut LineReader<'_>,
    ) -> Result<String, Wrong> {
        let span = reader.here();
        if keyword == "touch" && reader.is_direction() {
            loop {
                self.unnamed += 1;
                let name = format!("P{}", self.unnamed);
                if !self.known.contains_key(&name.to_ascii_lowercase()) {
                    return Ok(name);
                }
            }
        }
        let Some(word) = reader.next() else {
            return Err(Wrong::new(code::MISSING, "a name is missing", span)
                .label("belongs here")
                .help(format!("as in `{keyword} A1 ...`")));
        };
        let is_plain = word.text.starts_with(char::is_alphabetic)
            && word
                .text
                .chars()
                .all(|c| c.is_alphanumeric() || matches!(c, '_' | '-'));
        let lower = word.text.to_ascii_lowercase();
        if !is_plain || RESERVED.contains(&lower.as_str()) {
            return Err(Wrong::new(
                code::NAME,
                format!("`{}` cannot be a name", word.text),
                word.span,
            )
            .help("a name is letters and digits, `_` and `-`, begins with a letter, and is no word of the language and no coordinate like x1"));
        }
        if let Some((line, _)) = self.known.get(&lower) {
            return Err(Wrong::new(
                code::TWICE,
                format!("`{}` a second time", word.text),
                word.span,
            )
            .label(format!("there is one from line {line}")));
        }
        Ok(word.text.to_owned())
    }

    /// What to do, from the clauses.
    fn job(
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
            "edge" => {
                let points = clauses.points.map_or(1, |count| count.value);
                Job::Edge {
                    at: one()?,
                    towards: level(clauses.direction(&needs)?, reader)?,
                    points,
                    over_nm: match clauses.over {
                        Some(over) => over.value,
                        None if points == 1 => 0,
                        None => {
                            return Err(needs.missing("over", "the length they are spread over"));
                        }
                    },
                }
            }
            "corner" => {
                let &[first, second] = clauses.towards.as_slice() else {
                    return Err(needs.missing(
                        "towards",
                        "the directions into both faces, as in `towards +x +y`",
                    ));
                };
                if nearest_axis(first, None).0 == nearest_axis(second, None).0 {
                    return Err(
                        Wrong::new(code::NUMBER, "a corner of one face", reader.whole())
                            .help("two directions across each other, as in `towards +x +y`"),
                    );
                }
                Job::Corner {
                    at: one()?,
                    towards: [level(first, reader)?, level(second, reader)?],
                    inset_nm: needs.given(
                        clauses.inset,
                        "inset",
                        "the way from the corner to the first touch of each face",
                    )?,
                    is_inside: clauses.is_inside == Some(true),
                }
            }
            "web" | "pocket" => Job::Width {
                at: one()?,
                along: level(
                    needs.given(clauses.along, "along", "the direction across the faces")?,
                    reader,
                )?,
                width_nm: needs.given(
                    clauses.width,
                    "width",
                    "the distance of the faces, about",
                )?,
                is_inside: keyword == "pocket",
            },
            "bore" | "boss" | "circle" | "sphere" if clauses.of.is_empty() => {
                let diameter_nm =
                    needs.given(clauses.diameter, "diameter", "about how large it is")?;
                match keyword {
                    "sphere" => Job::Sphere {
                        at: one()?,
                        diameter_nm,
                        points: clauses.points(9, 5, reader)?,
                    },
                    _ => Job::Round {
                        at: one()?,
                        diameter_nm,
                        points: clauses.points(4, 3, reader)?,
                        arc_deg: clauses.arc_deg(&needs)?,
                        is_inside: match keyword {
                            "bore" => true,
                            "boss" => false,
                            _ => needs.choice(clauses.is_inside)?,
                        },
                    },
                }
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
            .label("the tip goes over it")
            .help("write `safe z ...` in a line before"));
        }
        let wanted = clauses.wanted(&job);
        let is_wanted = |figure| wanted.iter().any(|wanted| wanted.figure == figure);
        if let Some((points, least)) = points_of(&job) {
            let figure = match job {
                Job::Edge { .. } if points == 1 && is_wanted(Angle) => Some(Angle),
                _ if points <= least && is_wanted(Form) => Some(Form),
                _ => None,
            };
            if let Some(figure) = figure {
                let (name, least) = (figure.name(), if figure == Form { least + 1 } else { 2 });
                let plural = if points == 1 { "point" } else { "points" };
                return Err(Wrong::new(
                    code::TOLERANCE,
                    format!("`{keyword}` of {points} {plural} has no {name}"),
                    reader.whole(),
                )
                .help(format!("{least} points at least")));
            }
        }
        Ok((job, wanted))
    }

    /// The names behind `of` and `between`.
    pub fn names(
        &self,
        reader: &mut LineReader<'_>,
        as_what: &str,
        stops: &[&str],
    ) -> Result<Vec<String>, Wrong> {
        let mut names = vec![self.used(reader, as_what)?];
        while reader.peek().is_some_and(|word| {
            let is_stop = stops
                .iter()
                .any(|stop| word.text.eq_ignore_ascii_case(stop));
            !is_stop && axis_of(word.text).is_none()
        }) {
            let word = reader.peek().map(|word| (word.text, word.span.clone()));
            let (text, span) = word.unwrap_or_default();
            let name = self.used(reader, as_what)?;
            if names
                .iter()
                .any(|known: &String| known.eq_ignore_ascii_case(&name))
            {
                let message = format!("`{text}` is there twice");
                return Err(Wrong::new(code::NAME, message, span).label("named before"));
            }
            names.push(name);
        }
        Ok(names)
    }
}

/// What a statement needs, with words for what is not there.
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
        is_inside
            .ok_or_else(|| self.missing("inside", "a hole; or `outside`, a pin; or `of` and names"))
    }

    fn pair(&self, names: &[String]) -> Result<[String; 2], Wrong> {
        let pair = <&[String; 2]>::try_from(names).ok().cloned();
        pair.ok_or_else(|| self.missing("between", "the names of two features"))
    }
}

/// A direction at right angles to Z, for cycles that know no other.
fn level(direction: Vector, reader: &LineReader<'_>) -> Result<Vector, Wrong> {
    if direction[2] == 0.0 {
        return Ok(direction);
    }
    Err(Wrong::new(
        code::NUMBER,
        "the direction leaves the plane of X and Y",
        reader.whole(),
    )
    .help("for faces in Z there are `point` and `plane`"))
}

/// Those that the tip cannot get round at their own height.
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

/// How many points a job's feature has, and how many leave no residuals.
fn points_of(job: &Job) -> Option<(usize, usize)> {
    // 1000 at most.
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

/// What a job's feature can be used for.
fn offer(job: &Job) -> Offer {
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

fn unit(reader: &mut LineReader<'_>) -> Result<&'static str, Wrong> {
    let span = reader.here();
    let word = reader.next().map(|word| word.text).unwrap_or_default();
    let known = ["mm", "in", "um", "nm"].into_iter();
    let mut known = known.filter(|unit| *unit == word);
    known.next().ok_or_else(|| {
        Wrong::new(code::NUMBER, "units of what?", span)
            .help("as in `units mm`; there are mm, in, um, nm")
    })
}

/// `x 1 y 2`, each at most once, one at least.
fn place(reader: &mut LineReader<'_>, keyword: &str) -> Result<Place, Wrong> {
    let span = reader.here();
    let mut place = [None; 3];
    while let Some((axis, word)) = reader.axis() {
        let nm = reader.length(keyword)?;
        if place[axis].replace(nm).is_some() {
            return Err(twice(word.text, word.span));
        }
    }
    if place == [None; 3] {
        return Err(
            Wrong::new(code::MISSING, format!("`{keyword}` where?"), span)
                .label("a coordinate belongs here")
                .help(format!("as in `{keyword} x 10 y 20`")),
        );
    }
    Ok(place)
}

/// `zero`, or `zero x z`.
fn zero(reader: &mut LineReader<'_>) -> Result<[bool; 3], Wrong> {
    let mut axes = [false; 3];
    while let Some(axis) = reader.peek().and_then(|word| axis_of(word.text)) {
        if std::mem::replace(&mut axes[axis], true) {
            return Err(twice("axis", reader.here()));
        }
        reader.next();
    }
    Ok(if axes == [false; 3] { [true; 3] } else { axes })
}
