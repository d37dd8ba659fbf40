//! Hints in the comments of layout programs.

use crate::format::{Digits, Units, Zeros};
use crate::scanner::Scanner;

/// A comment with a known meaning.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(crate) enum Hint {
    /// The format of coordinates, as far as it is given: `FILE_FORMAT=2:4` (Altium, EasyEDA,
    /// P-CAD), `FORMAT={3:3/ absolute / metric / suppress leading zeros}` (KiCad),
    /// `Format : 3.3 / Absolute / MM / Leading` (Mentor).
    Format {
        units: Option<Units>,
        zeros: Option<Zeros>,
        digits: Option<Digits>,
        incremental: bool,
    },
    /// `TYPE=PLATED` (Altium), `TA.AperFunction,Plated`, `TF.FileFunction,NonPlated` (KiCad),
    /// `Contents: Thru / Drill / Non-Plated` (Mentor); `None` for mixed plating.
    Plated(Option<bool>),
    /// `T01 Holesize 1. = 13.000000 Tolerance = +0.0/-0.0 PLATED MILS Quantity = 20` (Allegro).
    Size {
        tool: u16,
        diameter_nm: i64,
        units: Units,
        plated: Option<bool>,
    },
}

impl Hint {
    /// Parses the text of a comment. Returns `None` for a text that is unknown or malformed.
    pub(crate) fn parse(text: Scanner<'_>) -> Option<Hint> {
        file_format(text)
            .or_else(|| format(text))
            .or_else(|| plating(text))
            .or_else(|| size(text))
    }
}

fn digits(scanner: &mut Scanner<'_>, between: u8) -> Option<Digits> {
    let whole = digit(scanner)?;
    if !scanner.take(between) {
        return None;
    }
    Digits::new(whole, digit(scanner)?)
}

fn digit(scanner: &mut Scanner<'_>) -> Option<u8> {
    match scanner.peek() {
        Some(digit @ b'0'..=b'9') => {
            scanner.next();
            Some(digit.wrapping_sub(b'0'))
        }
        _ => None,
    }
}

fn file_format(mut text: Scanner<'_>) -> Option<Hint> {
    if !(text.take_name(b"FILE_FORMAT") && text.take(b'=')) {
        return None;
    }
    let digits = digits(&mut text, b':')?;
    text.peek().is_none().then_some(Hint::Format {
        units: None,
        zeros: None,
        digits: Some(digits),
        incremental: false,
    })
}

/// Parses the lists of KiCad and Mentor, whose parts are separated by slashes.
fn format(mut text: Scanner<'_>) -> Option<Hint> {
    if !text.take_name(b"FORMAT") {
        return None;
    }
    let braces = text.take_name(b"={");
    if !braces && !text.take(b':') {
        return None;
    }
    let digits = digits(&mut text, if braces { b':' } else { b'.' });
    let (mut units, mut zeros, mut incremental) = (None, None, false);
    loop {
        while !matches!(text.peek(), None | Some(b'/')) {
            text.next();
        }
        if !text.take(b'/') {
            break;
        }
        if text.take_name(b"INCR") {
            incremental = true;
        } else if text.take_name(b"INCH") {
            units = Some(Units::Inches);
        } else if text.take_name(b"METRIC") || text.take_name(b"MM") {
            units = Some(Units::Millimetres);
        } else if text.take_name(b"SUPPRESSLEADING") || text.take_name(b"LEADING") {
            // Both programs name the omitted zeros.
            zeros = Some(Zeros::Trailing);
        } else if text.take_name(b"SUPPRESSTRAILING") || text.take_name(b"TRAILING") {
            zeros = Some(Zeros::Leading);
        }
    }
    Some(Hint::Format {
        units,
        zeros,
        digits,
        incremental,
    })
}

fn plating(mut text: Scanner<'_>) -> Option<Hint> {
    let named = text.take_name(b"TYPE=")
        || text.take_name(b"#@!TF.FILEFUNCTION,")
        || text.take_name(b"#@!TA.APERFUNCTION,");
    if !named && text.take_name(b"CONTENTS:") {
        return last_part(text);
    }
    if !named {
        return None;
    }
    if text.take_name(b"MIXEDPLATING") {
        return Some(Hint::Plated(None));
    }
    plated(&mut text).map(|plated| Hint::Plated(Some(plated)))
}

fn last_part(mut text: Scanner<'_>) -> Option<Hint> {
    while let Some(byte) = text.next() {
        if byte == b'/' {
            if let Some(plated) = plated(&mut text) {
                return Some(Hint::Plated(Some(plated)));
            }
        }
    }
    None
}

fn plated(text: &mut Scanner<'_>) -> Option<bool> {
    if [&b"NON_PLATED"[..], b"NON-PLATED", b"NONPLATED", b"NPTH"]
        .iter()
        .any(|name| text.take_name(name))
    {
        Some(false)
    } else if text.take_name(b"PLATED") || text.take_name(b"PTH") {
        Some(true)
    } else {
        None
    }
}

fn size(mut text: Scanner<'_>) -> Option<Hint> {
    let named = if text.take(b'T') {
        Some(text.number().ok()??)
    } else {
        None
    };
    if !text.take_name(b"HOLESIZE") {
        return None;
    }
    let index = text.number().ok()??;
    if !text.take(b'=') {
        return None;
    }
    let written = text.number().ok()??;
    let (mut scale, mut is_plated) = (None, None);
    while text.peek().is_some() {
        if let Some(plated) = plated(&mut text) {
            is_plated = Some(plated);
        } else if text.take_name(b"MIL") {
            scale = Some((Units::Inches, 3));
        } else if text.take_name(b"INCH") {
            scale = Some((Units::Inches, 0));
        } else if text.take_name(b"MM") {
            scale = Some((Units::Millimetres, 0));
        } else {
            text.next();
        }
    }
    let (units, shift) = scale?;
    let tool = named.unwrap_or(index).whole()?;
    let diameter_nm = written.plain_nm(units, shift)?;
    if diameter_nm <= 0 {
        return None;
    }
    Some(Hint::Size {
        tool: u16::try_from(tool).ok()?,
        diameter_nm,
        units,
        plated: is_plated,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hint(text: &str) -> Option<Hint> {
        Hint::parse(Scanner::new(text.as_bytes()))
    }

    fn format(units: Option<Units>, zeros: Option<Zeros>, whole: u8, places: u8) -> Option<Hint> {
        let digits = Digits::new(whole, places);
        Some(Hint::Format {
            units,
            zeros,
            digits,
            incremental: false,
        })
    }

    #[test]
    fn plating_is_recognised_by_a_name() {
        assert_eq!(
            hint("contents:Drill/Plated"),
            Some(Hint::Plated(Some(true)))
        );
        assert_eq!(hint("Drill/Plated"), None);
    }

    #[test]
    fn formats_of_layout_programs() {
        assert_eq!(hint("FILE_FORMAT=2:4"), format(None, None, 2, 4));
        assert_eq!(hint("FILE_FORMAT = 4 : f"), None);
        let (inch, mm) = (Some(Units::Inches), Some(Units::Millimetres));
        let leading_out = Some(Zeros::Trailing);
        assert_eq!(
            hint(" FORMAT={-:-/ absolute / metric / decimal}"),
            format(mm, None, 0, 0)
        );
        assert_eq!(
            hint("FORMAT={2:4/ absolute / inch / keep zeros}"),
            format(inch, None, 2, 4)
        );
        assert_eq!(
            hint("FORMAT={3:3/ absolute / metric / suppress leading zeros}"),
            format(mm, leading_out, 3, 3)
        );
        assert_eq!(
            hint(" Format  : 3.3 / Absolute / MM / Leading"),
            format(mm, leading_out, 3, 3)
        );
        assert_eq!(
            hint(" Format  : 2.4 / Absolute / Inch / Trailing"),
            format(inch, Some(Zeros::Leading), 2, 4)
        );
    }

    #[test]
    fn plating() {
        for (text, plated) in [
            ("TYPE=PLATED", Some(true)),
            ("TYPE=NON_PLATED", Some(false)),
            (" #@! TF.FileFunction,Plated,1,2,PTH", Some(true)),
            (
                " #@! TA.AperFunction,NonPlated,NPTH,ComponentDrill",
                Some(false),
            ),
            (" #@! TF.FileFunction,MixedPlating,1,2", None),
            (" Contents: Thru / Drill / Non-Plated", Some(false)),
        ] {
            assert_eq!(hint(text), Some(Hint::Plated(plated)), "{text}");
        }
        assert_eq!(hint("Layer_Color=9474304"), None);
    }

    #[test]
    fn sizes_in_comments() {
        let text =
            "T01 Holesize 1. = 13.000000 Tolerance = +0.000000/-0.000000 PLATED MILS Quantity = 20";
        assert_eq!(
            hint(text),
            Some(Hint::Size {
                tool: 1,
                diameter_nm: 330_200,
                units: Units::Inches,
                plated: Some(true)
            })
        );
        let text = "   Holesize 12. = 0.300000 Tolerance = +0.0/-0.0 NON_PLATED MM Quantity = 2";
        assert_eq!(
            hint(text),
            Some(Hint::Size {
                tool: 12,
                diameter_nm: 300_000,
                units: Units::Millimetres,
                plated: Some(false)
            })
        );
        assert_eq!(hint("Holesize 1 = 0 inch"), None);
        assert_eq!(hint("Holesize 1 = 1"), None);
    }
}
