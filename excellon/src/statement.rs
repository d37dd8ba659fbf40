//! Kinds of lines, before their words are read.

use crate::error::{Error, ErrorKind, WarningKind};
use crate::format::{Digits, Units, Zeros};
use crate::scanner::Scanner;

/// A line, classified by its first characters.
#[derive(Copy, Clone, Debug)]
pub(crate) enum Statement<'a> {
    /// Nothing, or a line that has no meaning for holes and needs no warning.
    Nothing,
    /// The text of a comment.
    Comment(Scanner<'a>),
    /// `%`: end of the header, or rewind.
    Percent,
    /// `INCH` or `METRIC` with its parameters. `odd` is the position of an unknown parameter.
    Units {
        units: Units,
        zeros: Option<Zeros>,
        digits: Option<Digits>,
        odd: Option<usize>,
    },
    /// `ICI`.
    Incremental(bool),
    /// A named command that has no meaning for holes or is unknown.
    Name(WarningKind),
    /// Words.
    Words(Scanner<'a>),
}

/// Named commands without a meaning for holes.
const IGNORED: [&[u8]; 28] = [
    b"AFS",
    b"ATC",
    b"BLKD",
    b"CCW",
    b"CP",
    b"DETECT",
    b"DN",
    b"DTMDIST",
    b"EXDA",
    b"FMAT",
    b"FSB",
    b"HBCK",
    b"HPCK",
    b"NCSL",
    b"OM48",
    b"OSTOP",
    b"OTCLMP",
    b"PCKPARAM",
    b"PF",
    b"PPR",
    b"PVS",
    b"SBK",
    b"SG",
    b"SIXM",
    b"TCST",
    b"UP",
    b"VER",
    b"ZC",
];

impl<'a> Statement<'a> {
    /// Classifies a line by its beginning.
    ///
    /// # Errors
    /// Fails for a Gerber command and for text after `%`.
    pub(crate) fn parse(line: &'a [u8]) -> Result<Statement<'a>, Error> {
        let mut scanner = Scanner::new(line);
        let at = scanner.at();
        let Some(first) = scanner.peek() else {
            return Ok(Statement::Nothing);
        };
        let mut ahead = scanner;
        ahead.next();
        let statement = match first {
            b';' | b'(' => Statement::Comment(ahead),
            // Block delete, or "clear tools" in a header.
            b'/' => Statement::Nothing,
            b'%' => return percent(ahead, at),
            b'R' if ahead.peek() == Some(b',') => Statement::Nothing,
            b'M' if scanner.take_name(b"M71,") => units(Units::Millimetres, scanner),
            b'M' if scanner.take_name(b"M72,") => units(Units::Inches, scanner),
            b'A'..=b'Z' if ahead.peek().is_some_and(|byte| byte.is_ascii_alphabetic()) => {
                name(scanner)
            }
            _ => Statement::Words(scanner),
        };
        Ok(statement)
    }
}

fn percent(mut behind: Scanner<'_>, at: usize) -> Result<Statement<'_>, Error> {
    if behind.is_at_end() {
        return Ok(Statement::Percent);
    }
    let kind = match behind.next() {
        Some(letter) if letter.is_ascii_alphabetic() => ErrorKind::Gerber,
        Some(byte @ b' '..=b'~') => ErrorKind::NotALetter(byte),
        Some(byte) => ErrorKind::NotText(byte),
        None => return Ok(Statement::Percent),
    };
    let end = behind.at();
    Err(Error { kind, at, end })
}

fn name(mut scanner: Scanner<'_>) -> Statement<'_> {
    if scanner.take_name(b"INCH") {
        return units(Units::Inches, scanner);
    }
    if scanner.take_name(b"METRIC") {
        return units(Units::Millimetres, scanner);
    }
    if scanner.take_name(b"ICI") {
        scanner.take(b',');
        return Statement::Incremental(!scanner.take_name(b"OFF"));
    }
    let is_known = IGNORED.iter().any(|name| {
        let mut ahead = scanner;
        // `UP1` is the name with a number, `UPON` is another name.
        ahead.take_name(name) && !ahead.peek().is_some_and(|byte| byte.is_ascii_alphabetic())
    });
    Statement::Name(if is_known {
        WarningKind::Ignored
    } else {
        WarningKind::UnknownName
    })
}

/// Parses the parameters of `INCH` or `METRIC`: `,LZ`, `,TZ`, `,000.000` in any order.
fn units(units: Units, mut scanner: Scanner<'_>) -> Statement<'_> {
    let (mut zeros, mut digits, mut odd) = (None, None, None);
    while !scanner.is_at_end() {
        let at = scanner.at();
        scanner.take(b',');
        if scanner.take_name(b"LZ") {
            zeros = Some(Zeros::Leading);
        } else if scanner.take_name(b"TZ") {
            zeros = Some(Zeros::Trailing);
        } else if let Some(pattern) = pattern(&mut scanner) {
            digits = Some(pattern);
        } else if !scanner.is_at_end() {
            odd = odd.or(Some(at));
            scanner.next();
        }
    }
    Statement::Units {
        units,
        zeros,
        digits,
        odd,
    }
}

/// Parses a pattern such as `000.000`: each zero is a digit.
fn pattern(scanner: &mut Scanner<'_>) -> Option<Digits> {
    let mut ahead = *scanner;
    let whole = zeros(&mut ahead);
    if !ahead.take(b'.') {
        return None;
    }
    let digits = Digits::new(whole, zeros(&mut ahead))?;
    *scanner = ahead;
    Some(digits)
}

fn zeros(scanner: &mut Scanner<'_>) -> u8 {
    let mut count = 0_u8;
    while scanner.take(b'0') {
        count = count.saturating_add(1);
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers() {
        let parsed = Statement::parse(b" metric, TZ ,000.00");
        let Ok(Statement::Units {
            units,
            zeros,
            digits,
            odd,
        }) = parsed
        else {
            panic!("{parsed:?}")
        };
        assert_eq!(
            (units, zeros, digits, odd),
            (
                Units::Millimetres,
                Some(Zeros::Trailing),
                Digits::new(3, 2),
                None
            )
        );
        let odd = |line: &'static [u8]| match Statement::parse(line) {
            Ok(Statement::Units { odd, .. }) => odd,
            other => panic!("{other:?}"),
        };
        assert_eq!(odd(b"INCH,LZ;x"), None);
        assert_eq!(odd(b"INCH,QZ"), Some(4));
        assert_eq!(odd(b"M71,TZ"), None);
        assert!(matches!(
            Statement::parse(b"ICI,ON"),
            Ok(Statement::Incremental(true))
        ));
        assert!(matches!(
            Statement::parse(b"ICI,OFF"),
            Ok(Statement::Incremental(false))
        ));
        assert!(matches!(Statement::parse(b"R,H"), Ok(Statement::Nothing)));
        assert!(matches!(
            Statement::parse(b"FMAT,2"),
            Ok(Statement::Name(WarningKind::Ignored))
        ));
        assert!(matches!(
            Statement::parse(b"FMATTER"),
            Ok(Statement::Name(WarningKind::UnknownName))
        ));
        assert!(matches!(Statement::parse(b"X1Y2"), Ok(Statement::Words(_))));
        assert!(matches!(Statement::parse(b"% ;"), Ok(Statement::Percent)));
    }

    #[test]
    fn gerber_is_named() {
        let error = Statement::parse(b"%FSLAX24Y24*%").unwrap_err();
        assert_eq!((error.kind, error.at, error.end), (ErrorKind::Gerber, 0, 2));
    }
}
