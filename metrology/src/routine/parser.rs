//! The parser of the lines of a routine. It checks each line against the lines before it.

use super::clauses::Clauses;
use super::jobs::offer;
use super::line_reader::{LineReader, axis_of, twice};
use super::mistake::{Mistake, Wrong, code};
use super::statement::{Order, Place, Statement, Task};
use super::vocabulary::{FEATURES, Feature, ORDERS, RESERVED};
use crate::heads::Approach;
use std::collections::HashMap;

/// The uses of a named feature.
#[derive(Clone, Copy, Debug, Default)]
pub struct Offer {
    /// As a point.
    pub point: bool,
    /// As a line.
    pub line: bool,
    /// As a face.
    pub plane: bool,
}

/// Reads lines one after another and remembers the names of the features.
#[derive(Clone, Debug)]
pub struct Parser {
    unit: &'static str,
    pub(super) has_safe: bool,
    known: HashMap<String, (usize, Offer)>,
    unnamed: usize,
}

impl Default for Parser {
    fn default() -> Self {
        Self::new()
    }
}

impl Parser {
    /// A parser before the first line.
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
    /// The mistakes of all wrong lines.
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

    /// Reads a line. `None`: it is empty, or sets the unit.
    ///
    /// # Errors
    ///
    /// The first mistake in the line.
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
            "moves" => Order::Moves(approach(&mut reader).ok_or_else(|| {
                Wrong::new(
                    code::MISSING,
                    "`moves` without a word for how",
                    reader.here(),
                )
                .help("as in `moves guarded`, or `moves rapid`")
            })?),
            "goto" => Order::GoTo(place(&mut reader, "goto")?, approach(&mut reader)),
            "jog" => {
                let displacement = place(&mut reader, "jog")?;
                let displacement = displacement.map(Option::unwrap_or_default);
                Order::Jog(displacement, approach(&mut reader))
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
                    .help(format!("the statements are {}", names.join(", "))));
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
            _ => Err(Wrong::new(code::MISSING, "`safe` without a height", span)
                .help("as in `safe z 30`, or `safe off`")),
        }
    }

    /// Reads `frame machine`, or `frame plane A line B point C at x 0 y 0 z 0`.
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

    /// Reads the name of a feature that was measured before and has this use.
    fn used(&self, reader: &mut LineReader<'_>, as_what: &str) -> Result<String, Wrong> {
        let span = reader.here();
        let Some(word) = reader.next() else {
            return Err(
                Wrong::new(code::MISSING, "a name is missing", span).label("it belongs here")
            );
        };
        let Some((line, offer)) = self.known.get(&word.text.to_ascii_lowercase()) else {
            let message = format!("nothing is named `{}` yet", word.text);
            let help = match self.known.is_empty() {
                true => "measure it in an earlier line".to_owned(),
                false => {
                    let mut names: Vec<_> = self.known.iter().collect();
                    names.sort_by_key(|(_, (line, _))| *line);
                    let names: Vec<_> = names.iter().map(|(name, _)| name.as_str()).collect();
                    format!("names so far: {}", names.join(", "))
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

    /// Reads a feature, its name and its clauses.
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

    /// Reads the name of a new feature. A touch without a name gets one.
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
            .help(
                "a name has letters, digits, `_` and `-` and begins with a letter; it is no word \
                 of the language and no coordinate such as x1",
            ));
        }
        if let Some((line, _)) = self.known.get(&lower) {
            return Err(Wrong::new(
                code::TWICE,
                format!("`{}` is named a second time", word.text),
                word.span,
            )
            .label(format!("line {line} has this name")));
        }
        Ok(word.text.to_owned())
    }

    /// Reads the names after `of` and `between`.
    pub(super) fn names(
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
                let message = format!("`{text}` is given a second time");
                return Err(
                    Wrong::new(code::NAME, message, span).label("it is in this list already")
                );
            }
            names.push(name);
        }
        Ok(names)
    }
}

fn unit(reader: &mut LineReader<'_>) -> Result<&'static str, Wrong> {
    let span = reader.here();
    let word = reader.next().map(|word| word.text).unwrap_or_default();
    let known = ["mm", "in", "um", "nm"].into_iter();
    let mut known = known.filter(|unit| *unit == word);
    known.next().ok_or_else(|| {
        Wrong::new(code::NUMBER, "`units` without a known unit", span)
            .help("as in `units mm`; the units are mm, in, um, nm")
    })
}

/// Reads coordinates such as `x 1 y 2`: at least one, and each at most once.
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
        return Err(Wrong::new(
            code::MISSING,
            format!("`{keyword}` without coordinates"),
            span,
        )
        .label("a coordinate belongs here")
        .help(format!("as in `{keyword} x 10 y 20`")));
    }
    Ok(place)
}

/// Reads `guarded` or `rapid`, if it is there.
fn approach(reader: &mut LineReader<'_>) -> Option<Approach> {
    let words = [("guarded", Approach::Guarded), ("rapid", Approach::Rapid)];
    let mut words = words.into_iter();
    words.find_map(|(word, approach)| reader.take(word).map(|_| approach))
}

/// Reads the axes of `zero` or `zero x z`. Without axes all are meant.
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
