//! The JSON of all commands: one object a line, with the name of its schema first. Decimal numbers
//! are exact.

use crate::diagnostics::{Finding, Findings};
use crate::text::name;
use husillo_gcode::Nm;
use serde::Serialize;
use serde_json::value::RawValue;
use std::io::{self, Write};

/// The object of a command.
#[derive(Serialize)]
struct Document<'a, T> {
    schema: &'a str,
    #[serde(flatten)]
    body: &'a T,
    #[serde(skip_serializing_if = "Option::is_none")]
    findings: Option<&'a [Finding]>,
}

/// Writes an object on a line of its own. `schema` is its name, as `husillo.run/1`.
///
/// # Errors
///
/// The writer fails.
pub fn write_line(schema: &str, body: &impl Serialize, out: &mut impl Write) -> io::Result<()> {
    write(schema, body, None, out)
}

/// The same with findings in it.
///
/// # Errors
///
/// The writer fails.
pub fn write_found(
    schema: &str,
    body: &impl Serialize,
    findings: &Findings,
    out: &mut impl Write,
) -> io::Result<()> {
    write(schema, body, Some(findings.kept()), out)
}

fn write(
    schema: &str,
    body: &impl Serialize,
    findings: Option<&[Finding]>,
    out: &mut impl Write,
) -> io::Result<()> {
    let document = Document {
        schema,
        body,
        findings,
    };
    serde_json::to_writer(Names(&mut *out), &document)?;
    out.write_all(b"\n")
}

/// Writes the bytes of names that are no UTF-8 as text: `\xe9`, in JSON `\\xe9`.
struct Names<W>(W);

impl<W: Write> Write for Names<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // The first byte of the characters that stand for them. A character is written as a whole.
        match std::str::from_utf8(bytes) {
            Ok(text) if bytes.contains(&0xf4) => {
                let mut all = String::with_capacity(text.len());
                for one in text.chars() {
                    match name::byte(one) {
                        Some(byte) => all.push_str(&format!("\\\\x{byte:02x}")),
                        None => all.push(one),
                    }
                }
                self.0.write_all(all.as_bytes())?;
            }
            _ => self.0.write_all(bytes)?,
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_schema_comes_first_and_decimals_are_exact() {
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
        write_line("husillo.hole/1", &hole, &mut line).unwrap();
        let expected = "{\"schema\":\"husillo.hole/1\",\"name\":\"a\\\"b\",\
                        \"at\":[12.000001,-0.5],\"tool\":null}\n";
        assert_eq!(String::from_utf8(line).unwrap(), expected);
    }
}
