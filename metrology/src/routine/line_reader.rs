//! A reader that takes the words of a line one after another.

use super::mistake::{Wrong, code};
use super::vector::Vector;
use super::words::{Word, is_number, words};
use crate::quantity::{self, Quantity};
use std::ops::Range;

/// A nominal value and its tolerance, in millionths.
pub type Value = (i64, Option<[i64; 2]>);

/// A line that is being read.
#[derive(Debug)]
pub struct LineReader<'t> {
    text: &'t str,
    words: Vec<Word<'t>>,
    at: usize,
    /// Unit of a number that has no unit of its own.
    unit: &'static str,
}

impl<'t> LineReader<'t> {
    pub fn new(text: &'t str, unit: &'static str) -> Self {
        Self {
            text,
            words: words(text),
            at: 0,
            unit,
        }
    }

    /// The next word.
    pub fn peek(&self) -> Option<&Word<'t>> {
        self.words.get(self.at)
    }

    /// Takes the next word.
    pub fn next(&mut self) -> Option<Word<'t>> {
        let word = self.words.get(self.at).cloned();
        self.at += usize::from(word.is_some());
        word
    }

    /// Takes the next word if it is this one.
    pub fn take(&mut self, text: &str) -> Option<Word<'t>> {
        let is_it = |word: &&Word<'_>| word.text.eq_ignore_ascii_case(text);
        self.peek().filter(is_it)?;
        self.next()
    }

    /// Bytes of the next word, or the end of the line.
    pub fn here(&self) -> Range<usize> {
        match self.peek() {
            Some(word) => word.span.clone(),
            None => {
                let end = self.words.last().map_or(0, |word| word.span.end);
                end..(end + 1).min(self.text.len())
            }
        }
    }

    /// Bytes of the last word that was taken.
    pub fn before(&self) -> Range<usize> {
        let last = self.at.checked_sub(1).and_then(|at| self.words.get(at));
        last.map_or(0..0, |word| word.span.clone())
    }

    /// Bytes of all words.
    pub fn whole(&self) -> Range<usize> {
        let start = self.words.first().map_or(0, |word| word.span.start);
        start..self.words.last().map_or(0, |word| word.span.end)
    }

    /// Refuses any further word.
    pub fn finish(&self) -> Result<(), Wrong> {
        match self.peek() {
            None => Ok(()),
            Some(word) => Err(Wrong::new(
                code::WORD,
                format!("`{}` does not belong here", word.text),
                word.span.clone(),
            )
            .label("the statement is complete before it")),
        }
    }

    /// Reads a signed length, nm.
    pub fn length(&mut self, what: &str) -> Result<i64, Wrong> {
        let word = self.number(what)?;
        self.length_of(word.text, word.span)
    }

    /// Reads a length above 0, nm.
    pub fn positive(&mut self, what: &str) -> Result<i64, Wrong> {
        let span = self.here();
        let nm = self.length(what)?;
        if nm > 0 {
            return Ok(nm);
        }
        Err(Wrong::new(
            code::NUMBER,
            format!("{what} must be above 0"),
            span,
        ))
    }

    /// Reads a length and its tolerance, nm.
    pub fn toleranced_length(&mut self, what: &str) -> Result<Value, Wrong> {
        let nominal = self.length(what)?;
        Ok((nominal, self.tolerance(Self::length_of)?))
    }

    /// Reads an angle and its tolerance, millionths of a degree.
    pub fn toleranced_angle(&mut self, what: &str) -> Result<Value, Wrong> {
        let nominal = self.angle(what)?;
        Ok((nominal, self.tolerance(Self::angle_of)?))
    }

    /// Reads an angle, millionths of a degree.
    pub fn angle(&mut self, what: &str) -> Result<i64, Wrong> {
        let word = self.number(what)?;
        self.angle_of(word.text, word.span)
    }

    /// Reads a whole number within a range.
    pub fn count(&mut self, what: &str, range: Range<u32>) -> Result<u32, Wrong> {
        let word = self.number(what)?;
        let count = word.text.parse().ok().filter(|count| range.contains(count));
        count.ok_or_else(|| {
            let (least, most) = (range.start, range.end - 1);
            Wrong::new(
                code::NUMBER,
                format!("{what}: a whole number from {least} to {most}"),
                word.span,
            )
        })
    }

    /// Takes X, Y or Z, if it is next and a number follows it.
    pub fn axis(&mut self) -> Option<(usize, Word<'t>)> {
        let axis = self.peek_axis()?;
        self.next().map(|word| (axis, word))
    }

    /// The axis that [`LineReader::axis`] would take.
    pub fn peek_axis(&self) -> Option<usize> {
        let axis = self.peek().and_then(|word| axis_of(word.text))?;
        let behind = self.words.get(self.at + 1);
        behind
            .is_some_and(|word| is_number(word.text))
            .then_some(axis)
    }

    /// Reads a direction: `-z`, components such as `x1 y-1`, or all three as in `1,-1,0`.
    pub fn direction(&mut self) -> Result<Vector, Wrong> {
        let span = self.here();
        if let Some(vector) = self.three_numbers() {
            self.at += 3;
            return if vector == [0.0; 3] {
                Err(Wrong::new(code::NUMBER, "no direction", span))
            } else {
                Ok(vector)
            };
        }
        let mut vector: [Option<f64>; 3] = [None; 3];
        while let Some((axis, word)) = self.axis() {
            let number = self.number("a direction")?;
            let twice = || twice(word.text, word.span.clone());
            let part = number
                .text
                .parse()
                .ok()
                .filter(|part: &f64| part.is_finite());
            let part = part.ok_or_else(|| malformed(&number))?;
            if vector[axis].replace(part).is_some() {
                return Err(twice());
            }
        }
        if vector != [None; 3] {
            let vector = vector.map(Option::unwrap_or_default);
            if vector == [0.0; 3] {
                return Err(Wrong::new(code::NUMBER, "no direction", span));
            }
            return Ok(vector);
        }
        let axis = self.peek().and_then(|word| {
            let (sign, letter) = match word.text.as_bytes() {
                [b'+', rest @ ..] => (1.0, rest),
                [b'-', rest @ ..] => (-1.0, rest),
                rest => (1.0, rest),
            };
            Some((axis_of(std::str::from_utf8(letter).ok()?)?, sign))
        });
        let Some((axis, sign)) = axis else {
            return Err(Wrong::new(code::MISSING, "a direction is missing", span)
                .label("belongs here")
                .help("write +x, -z, components as in `x1 y-1`, or all three as in `1,-1,0`"));
        };
        self.next();
        let mut vector = [0.0; 3];
        vector[axis] = sign;
        Ok(vector)
    }

    fn three_numbers(&self) -> Option<Vector> {
        let [x, y, z] = self.words.get(self.at..self.at + 3)? else {
            return None;
        };
        let part = |word: &Word<'_>| -> Option<f64> {
            word.text.parse().ok().filter(|part: &f64| part.is_finite())
        };
        Some([part(x)?, part(y)?, part(z)?])
    }

    /// Whether a direction is next.
    pub fn is_direction(&self) -> bool {
        self.three_numbers().is_some()
            || self.peek().is_some_and(|word| {
                let letter = word.text.strip_prefix(['+', '-']).unwrap_or(word.text);
                axis_of(letter).is_some()
            })
    }

    /// Takes a number.
    fn number(&mut self, what: &str) -> Result<Word<'t>, Wrong> {
        let span = self.here();
        match self.peek() {
            Some(word) if is_number(word.text) && !is_tolerance(word.text) => {
                let word = word.clone();
                self.at += 1;
                Ok(word)
            }
            Some(word) if word.text.starts_with(|c: char| c.is_ascii_digit()) => {
                Err(malformed(word))
            }
            _ => Err(
                Wrong::new(code::MISSING, format!("{what}: a number is missing"), span)
                    .label("belongs here"),
            ),
        }
    }

    /// The length of a number. The unit is the next word, or else the unit of the routine.
    fn length_of(&mut self, number: &str, span: Range<usize>) -> Result<i64, Wrong> {
        let unit = match self.peek() {
            Some(word) if matches!(word.text, "nm" | "um" | "mm" | "in") => {
                let unit = word.text;
                self.at += 1;
                unit
            }
            _ => self.unit,
        };
        match quantity::parse(&format!("{number} {unit}")) {
            // 10 m is longer than any machine. Up to this length nothing overflows.
            Ok(Quantity::Length(length)) if length.rounded().abs() <= 10_000_000_000 => {
                Ok(length.rounded())
            }
            _ => Err(Wrong::new(
                code::NUMBER,
                format!("`{number}` is no length up to 10 m"),
                span,
            )),
        }
    }

    fn angle_of(&mut self, number: &str, span: Range<usize>) -> Result<i64, Wrong> {
        self.take("deg");
        let angle = number.parse().ok().filter(|deg: &f64| deg.abs() <= 360.0);
        angle.map(|deg| (deg * 1e6).round() as i64).ok_or_else(|| {
            Wrong::new(
                code::NUMBER,
                format!("`{number}` is no angle in degrees"),
                span,
            )
        })
    }

    /// Reads a tolerance such as `+-0.02` or `+0.03 -0.01`, if it is next. Returns the lowest and
    /// highest deviation.
    fn tolerance(
        &mut self,
        read: impl Fn(&mut Self, &str, Range<usize>) -> Result<i64, Wrong>,
    ) -> Result<Option<[i64; 2]>, Wrong> {
        let Some(word) = self.peek().filter(|word| is_number(word.text)).cloned() else {
            return Ok(None);
        };
        let both = ["+-", "\u{b1}"];
        if let Some(number) = both.iter().find_map(|sign| word.text.strip_prefix(sign)) {
            self.at += 1;
            let most = read(self, number, word.span)?;
            return Ok(Some([-most, most]));
        }
        if !word.text.starts_with(['+', '-']) {
            return Ok(None);
        }
        self.at += 1;
        let first = read(self, word.text, word.span.clone())?;
        let other = self.peek().filter(|word| is_number(word.text)).cloned();
        let Some(other) = other.filter(|word| word.text.starts_with(['+', '-'])) else {
            return Err(Wrong::new(code::TOLERANCE, "half a tolerance", word.span)
                .label("the other side is missing")
                .help("as in `+0.03 -0.01`, `+0.02 -0`, or `+-0.02`"));
        };
        self.at += 1;
        let second = read(self, other.text, other.span.clone())?;
        let [least, most] = [first.min(second), first.max(second)];
        if least < most {
            return Ok(Some([least, most]));
        }
        Err(Wrong::new(
            code::TOLERANCE,
            "a tolerance of width 0",
            word.span.start..other.span.end,
        ))
    }
}

/// 0, 1, 2 for X, Y, Z, upper or lower case.
pub fn axis_of(text: &str) -> Option<usize> {
    ["x", "y", "z"]
        .iter()
        .position(|axis| text.eq_ignore_ascii_case(axis))
}

/// The mistake of a word that is given a second time.
pub fn twice(word: &str, span: Range<usize>) -> Wrong {
    Wrong::new(
        code::TWICE,
        format!("`{word}` is given a second time"),
        span,
    )
}

fn malformed(word: &Word<'_>) -> Wrong {
    let message = format!("malformed number `{}`", word.text);
    Wrong::new(code::NUMBER, message, word.span.clone())
}

fn is_tolerance(text: &str) -> bool {
    text.starts_with("+-") || text.starts_with('\u{b1}')
}
