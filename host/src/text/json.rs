//! JSON with a blank after each comma and colon, and with exact decimal numbers.

use husillo_gcode::Nm;
use serde::Serialize;
use serde_json::ser::{Formatter, Serializer};
use serde_json::value::RawValue;
use std::io::{self, Write};

/// Writes a value and a newline.
///
/// # Errors
///
/// The writer fails.
pub fn write_line(value: &impl Serialize, out: &mut impl Write) -> io::Result<()> {
    value.serialize(&mut Serializer::with_formatter(&mut *out, Spaced))?;
    writeln!(out)
}

/// Nanometres that are written as millimetres, with as many decimals as needed.
#[derive(Clone, Copy, Debug)]
pub struct Millimetres(pub i64);

impl Serialize for Millimetres {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        decimal(Nm(self.0).to_string()).serialize(serializer)
    }
}

/// A number that is written with exactly these digits.
pub fn decimal(digits: String) -> Box<RawValue> {
    // Text that is not a number would become null. The callers pass only numbers.
    RawValue::from_string(digits).unwrap_or_else(|_| RawValue::NULL.to_owned())
}

/// Writes one line with blanks between its parts.
struct Spaced;

impl Spaced {
    fn separate<W: Write + ?Sized>(out: &mut W, is_first: bool) -> io::Result<()> {
        if is_first {
            return Ok(());
        }
        out.write_all(b", ")
    }
}

impl Formatter for Spaced {
    fn begin_array_value<W: Write + ?Sized>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        Self::separate(out, first)
    }

    fn begin_object_key<W: Write + ?Sized>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        Self::separate(out, first)
    }

    fn begin_object_value<W: Write + ?Sized>(&mut self, out: &mut W) -> io::Result<()> {
        out.write_all(b": ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_have_blanks_and_decimals_are_exact() {
        #[derive(Serialize)]
        struct Hole<'a> {
            name: &'a str,
            at: [Millimetres; 2],
            tool: Option<u16>,
        }
        let at = [12_000_001, -500_000].map(Millimetres);
        let hole = Hole {
            name: "a\"b",
            at,
            tool: None,
        };
        let mut line = Vec::new();
        write_line(&hole, &mut line).unwrap();
        let expected = "{\"name\": \"a\\\"b\", \"at\": [12.000001, -0.5], \"tool\": null}\n";
        assert_eq!(String::from_utf8(line).unwrap(), expected);
    }
}
