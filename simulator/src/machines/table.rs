//! A TOML table that is read key by key. Unknown, missing and wrong keys become findings.

use crate::diagnostics::{Finding, Place};
use husillo_metrology::quantity::{self, Fraction, Quantity};
use std::ops::{Range, RangeInclusive};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Parses the text of a machine file.
///
/// # Errors
///
/// The text is not TOML. The finding has the position and the reason.
pub fn document<'a>(path: &str, text: &'a str) -> Result<Spanned<DeTable<'a>>, Vec<Finding>> {
    DeTable::parse(text).map_err(|error| {
        let place = Place::in_text(path, text, error.span().unwrap_or(0..0));
        vec![Finding::error("E0800", error.message(), place)]
    })
}

/// One table of a machine file.
#[derive(Debug)]
pub struct Table<'a, 'f> {
    path: &'a str,
    text: &'a str,
    name: String,
    span: Range<usize>,
    table: &'a DeTable<'a>,
    known: Vec<String>,
    /// Whether quantities are those of a rotary axis, in degrees instead of lengths.
    is_rotary: bool,
    findings: &'f mut Vec<Finding>,
}

impl<'a, 'f> Table<'a, 'f> {
    /// Starts reading `table`. Messages call it `name`.
    pub fn new(
        path: &'a str,
        text: &'a str,
        name: &str,
        span: Range<usize>,
        table: &'a DeTable<'a>,
        findings: &'f mut Vec<Finding>,
    ) -> Self {
        Self {
            path,
            text,
            name: name.to_owned(),
            span,
            table,
            known: Vec::new(),
            is_rotary: false,
            findings,
        }
    }

    /// The value of a key and its span.
    pub fn value(&mut self, key: &str) -> Option<(&'a DeValue<'a>, Range<usize>)> {
        self.known.push(key.to_owned());
        self.table
            .get(key)
            .map(|value| (value.get_ref(), value.span()))
    }

    /// Reads a string.
    pub fn string(&mut self, key: &str) -> Option<String> {
        let (value, span) = self.value(key)?;
        let string = value.as_str().map(str::to_owned);
        if string.is_none() {
            self.wrong(
                span,
                &format!("`{key}` is not a string"),
                "expected text in quotes",
            );
        }
        string
    }

    /// Reads the name of the machine, which must not be empty.
    pub fn name(&mut self) -> String {
        let name = self.string("name").unwrap_or_default();
        if let (Some((value, span)), true) = (self.value("name"), name.trim().is_empty()) {
            // `string` has reported a value that is not a string.
            if value.as_str().is_some() {
                self.wrong(span, "`name` is empty", "expected a name");
            }
        }
        name
    }

    /// Reads `true` or `false`.
    pub fn flag(&mut self, key: &str) -> Option<bool> {
        let (value, span) = self.value(key)?;
        let flag = value.as_bool();
        if flag.is_none() {
            let message = format!("`{key}` is not a flag");
            self.wrong(span, &message, "expected true or false");
        }
        flag
    }

    /// Reads an integer within a range.
    pub fn integer(&mut self, key: &str, range: RangeInclusive<i64>) -> Option<i64> {
        let (value, span) = self.value(key)?;
        let integer = value
            .as_integer()
            .and_then(|integer| i64::from_str_radix(integer.as_str(), integer.radix()).ok())
            .filter(|integer| range.contains(integer));
        if integer.is_none() {
            let expected = format!(
                "expected an integer from {} to {}",
                range.start(),
                range.end()
            );
            self.wrong(span, &format!("`{key}` is out of range"), &expected);
        }
        integer
    }

    /// Reads a required number within a range. The name of the key has its unit.
    pub fn required_number(&mut self, key: &str, range: RangeInclusive<f64>) -> Option<f64> {
        let Some((value, span)) = self.value(key) else {
            self.missing(key);
            return None;
        };
        let written = match (value.as_float(), value.as_integer()) {
            (Some(float), _) => float.as_str().parse().ok(),
            (_, Some(integer)) => integer.as_str().parse().ok(),
            _ => None,
        };
        let number = written.filter(|number| range.contains(number));
        if number.is_none() {
            let expected = format!(
                "expected a number from {} to {}",
                range.start(),
                range.end()
            );
            self.wrong(span, &format!("`{key}` is out of range"), &expected);
        }
        number
    }

    /// Reads a quantity with its unit, if `accept` takes it. `form` describes it in messages.
    pub fn quantity<T>(
        &mut self,
        key: &str,
        form: &str,
        accept: impl Fn(Quantity) -> Option<T>,
    ) -> Option<T> {
        let (value, span) = self.value(key)?;
        let parsed = match value.as_str() {
            Some(text) => self.parsed(text),
            None => Err("a quantity is text with a unit".to_owned()),
        };
        match parsed.map(accept) {
            Ok(Some(value)) => Some(value),
            Ok(None) => {
                self.wrong(
                    span,
                    &format!("`{key}` does not fit"),
                    &format!("expected {form}"),
                );
                None
            }
            Err(reason) => {
                self.wrong(
                    span,
                    &format!("`{key}` is not understood: {reason}"),
                    &format!("expected {form}"),
                );
                None
            }
        }
    }

    /// Sets whether the next quantities are those of a rotary axis, in degrees instead of lengths.
    pub const fn set_rotary(&mut self, on: bool) {
        self.is_rotary = on;
    }

    /// Reads a quantity. An angle of a rotary axis becomes a length: a degree becomes a millimetre.
    ///
    /// # Errors
    ///
    /// The text is not understood, or it is a length for a rotary axis or an angle for a linear
    /// one.
    pub fn parsed(&self, text: &str) -> Result<Quantity, String> {
        let scaled = |value: Fraction| {
            Fraction::new(i128::from(value.num) * 1_000_000, i128::from(value.den))
                .ok_or_else(|| format!("`{text}` is out of range"))
        };
        Ok(match (quantity::parse(text)?, self.is_rotary) {
            (
                Quantity::Length(_)
                | Quantity::Speed(_)
                | Quantity::AxisAcceleration(_)
                | Quantity::AxisJerk(_),
                true,
            ) => return Err("a rotary axis has degrees".to_owned()),
            (Quantity::Angle(value), true) => Quantity::Length(scaled(value)?),
            (Quantity::RotarySpeed(value), true) => Quantity::Speed(scaled(value)?),
            (Quantity::RotaryAcceleration(value), true) => {
                Quantity::AxisAcceleration(scaled(value)?)
            }
            (Quantity::RotaryJerk(value), true) => Quantity::AxisJerk(scaled(value)?),
            (quantity, _) => quantity,
        })
    }

    /// Reads `true` or `false`.
    pub fn boolean(&mut self, key: &str) -> Option<bool> {
        let (value, span) = self.value(key)?;
        let boolean = value.as_bool();
        if boolean.is_none() {
            let message = format!("`{key}` is not true or false");
            self.wrong(span, &message, "expected true or false");
        }
        boolean
    }

    /// Reads one of several names.
    pub fn choice<T: Copy>(&mut self, key: &str, choices: &[(&str, T)]) -> Option<T> {
        let (value, span) = self.value(key)?;
        let name = value.as_str().unwrap_or_default();
        let found = choices
            .iter()
            .find(|(choice, _)| *choice == name)
            .map(|(_, value)| *value);
        if found.is_none() {
            let names: Vec<_> = choices.iter().map(|(choice, _)| *choice).collect();
            self.wrong(
                span,
                &format!("unknown {key} `{name}`"),
                &format!("one of {}", names.join(", ")),
            );
        }
        found
    }

    /// Reads a required table.
    pub fn table<T>(&mut self, key: &str, read: impl FnOnce(&mut Table<'a, '_>) -> T) -> Option<T> {
        let found = self.optional_table(key, read);
        if found.is_none() && self.table.get(key).is_none() {
            self.missing(key);
        }
        found
    }

    /// Reads an optional table.
    pub fn optional_table<T>(
        &mut self,
        key: &str,
        read: impl FnOnce(&mut Table<'a, '_>) -> T,
    ) -> Option<T> {
        let (value, span) = self.value(key)?;
        let Some(table) = value.as_table() else {
            self.wrong(span, &format!("`{key}` is not a table"), "expected a table");
            return None;
        };
        Some(self.inner(key, span, table, read))
    }

    /// Reads an optional list of tables.
    pub fn optional_tables<T>(
        &mut self,
        key: &str,
        mut read: impl FnMut(&mut Table<'a, '_>) -> T,
    ) -> Option<Vec<T>> {
        let (value, span) = self.value(key)?;
        let tables = value.as_array().and_then(|list| {
            let tables = list
                .iter()
                .map(|item| Some((item.span(), item.get_ref().as_table()?)));
            tables.collect::<Option<Vec<_>>>()
        });
        let Some(tables) = tables else {
            self.wrong(
                span,
                &format!("`{key}` is not a list of tables"),
                "expected tables",
            );
            return None;
        };
        let read = tables
            .into_iter()
            .map(|(span, table)| self.inner(key, span, table, &mut read));
        Some(read.collect())
    }

    fn inner<T>(
        &mut self,
        key: &str,
        span: Range<usize>,
        table: &'a DeTable<'a>,
        read: impl FnOnce(&mut Table<'a, '_>) -> T,
    ) -> T {
        let name = match self
            .name
            .strip_prefix('[')
            .and_then(|name| name.strip_suffix(']'))
        {
            Some(parent) => format!("[{parent}.{key}]"),
            None => format!("[{key}]"),
        };
        let mut inner = Table::new(self.path, self.text, &name, span, table, self.findings);
        inner.is_rotary = self.is_rotary;
        let result = read(&mut inner);
        inner.finish();
        result
    }

    /// Reports a missing key. A key that is present has already been reported as wrong.
    pub fn missing(&mut self, key: &str) {
        if self.table.get(key).is_some() {
            return;
        }
        let (span, name) = (self.span.clone(), &self.name);
        let message = format!("missing key `{key}` in {name}");
        self.findings
            .push(Finding::error("E0802", message, self.place(span)));
    }

    /// The span of the whole table.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// Reports a wrong value.
    pub fn wrong(&mut self, span: Range<usize>, message: &str, label: &str) {
        self.findings
            .push(Finding::error("E0802", message, self.place(span)).label(label));
    }

    /// Reports every key that was not read.
    pub fn finish(&mut self) {
        let mut unknown: Vec<_> = self
            .table
            .keys()
            .filter(|key| !self.known.iter().any(|known| *known == **key.get_ref()))
            .map(|key| (key.get_ref().to_string(), key.span()))
            .collect();
        unknown.sort_by_key(|(_, span)| span.start);
        for (key, span) in unknown {
            let message = format!("unknown key `{key}` in {}", self.name);
            let place = self.place(span.clone());
            let mut finding = Finding::error("E0801", message, place);
            let near = self.known.iter().min_by_key(|known| distance(known, &key));
            match near.filter(|near| distance(near, &key) <= 1 + key.len() / 3) {
                Some(near) => {
                    let column =
                        span.start - self.text[..span.start].rfind('\n').map_or(0, |at| at + 1);
                    finding = finding
                        .help(format!("did you mean `{near}`?"))
                        .fix(column..column + span.len(), near.clone());
                }
                None => {
                    finding =
                        finding.help(format!("keys of {}: {}", self.name, self.known.join(", ")))
                }
            }
            self.findings.push(finding);
        }
    }

    fn place(&self, span: Range<usize>) -> Place {
        Place::in_text(self.path, self.text, span)
    }
}

/// Edit distance of two words: the number of characters to insert, delete or replace. It keeps
/// one row of the usual table.
pub fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replace = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = replace.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::distance;

    #[test]
    fn edits_are_counted() {
        assert_eq!(distance("backlash", "baklash"), 1);
        assert_eq!(distance("step", "steps"), 1);
        assert_eq!(distance("", "abc"), 3);
    }
}
