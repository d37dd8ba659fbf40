//! Files of CAM systems that are no G-code.

use std::fmt::{self, Display};

/// Bytes from the start of a file that are examined for its language.
pub const HEAD: usize = 4096;

/// The language of a file that is not G-code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// The dialogue language of Heidenhain controllers.
    Heidenhain,
    /// Siemens Sinumerik.
    Sinumerik,
    /// ShopBot part files.
    ShopBot,
    /// HP-GL of plotters.
    Plotter,
    /// Gerber, the layers of circuit boards.
    Gerber,
    /// A drawing, such as DXF or SVG.
    Drawing,
}

impl Display for Language {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, who) = match self {
            Self::Heidenhain => ("a Heidenhain program", POST),
            Self::Sinumerik => ("a Sinumerik program", POST),
            Self::ShopBot => ("a ShopBot program", POST),
            Self::Plotter => ("a plotter file (HPGL)", "let a CAM system read it"),
            Self::Gerber => (
                "a Gerber file",
                "let pcb2gcode or FlatCAM make a program of it",
            ),
            Self::Drawing => (
                "a drawing or a model",
                "let a CAM system make a program of it",
            ),
        };
        write!(f, "this is {what}, no plain G-code: {who}")
    }
}

/// The advice if a CAM system has written for another controller.
const POST: &str = "choose a post-processor for LinuxCNC, Grbl or Mach3 in the CAM system";

/// The language of a file that begins with these bytes. `None`: it is G-code, or unknown.
pub fn of(head: &[u8]) -> Option<Language> {
    let text = String::from_utf8_lossy(head).to_ascii_uppercase();
    let lines = || text.lines().map(str::trim).filter(|line| !line.is_empty());
    let first = lines().next()?;
    let unnumbered = first.trim_start_matches(|one: char| one.is_ascii_digit());
    let begins = |starts: &[&str]| starts.iter().any(|start| first.starts_with(start));
    // Its own language, and DIN/ISO, where `*` ends a block.
    let is_iso = first.starts_with('%') && first.ends_with('*') && first.contains(" G7");
    if unnumbered.trim_start().starts_with("BEGIN PGM") || is_iso {
        return Some(Language::Heidenhain);
    }
    if begins(&["%FS", "%MO"]) || lines().any(|line| line.starts_with("%FSLA")) {
        return Some(Language::Gerber);
    }
    let is_model = begins(&["<", "SOLID ", "ISO-10303", "%PDF", "AUTOCAD", "%!PS"]);
    if is_model || (first == "0" && lines().nth(1) == Some("SECTION")) {
        return Some(Language::Drawing);
    }
    if begins(&["IN;", "SP0;", "SP1;", "PU;", "PU0", "\u{1b}%-"]) {
        return Some(Language::Plotter);
    }
    if begins(&["'"]) || lines().any(is_of_shopbot) {
        return Some(Language::ShopBot);
    }
    (begins(&["%_N_"]) || lines().any(is_of_sinumerik)).then_some(Language::Sinumerik)
}

/// Whether a line is a command of ShopBot: two characters, then a comma.
fn is_of_shopbot(line: &str) -> bool {
    const MOVES: [&str; 9] = ["J2", "J3", "JZ", "M2", "M3", "MZ", "MS", "VS", "JS"];
    line.split_once(',')
        .is_some_and(|(command, _)| MOVES.contains(&command))
}

/// Whether a line has a call or an address with `=`. Only Sinumerik has these.
fn is_of_sinumerik(line: &str) -> bool {
    // A comment may contain them, too. Other controllers have MSG, but without parentheses.
    let commented = line;
    let line = line.split([';', '(']).next().unwrap_or_default();
    if line.ends_with("MSG") && commented.starts_with(&format!("{line}(")) {
        return true;
    }
    let is_call = |word: &str| {
        let number = word.strip_prefix("CYCLE").or(word.strip_prefix("POCKET"));
        number.is_some_and(|number| number.chars().all(|one| one.is_ascii_digit()))
    };
    line.split_whitespace().any(|word| {
        let assigned = word.split_once('=').map(|(name, _)| name);
        let is_address = |name: &str| matches!(name, "X" | "Y" | "Z" | "T" | "S" | "F" | "D");
        assigned.is_some_and(is_address) || is_call(word)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_are_no_g_code() {
        for (text, language) in [
            ("0 BEGIN PGM 14 MM\n", Language::Heidenhain),
            ("BEGIN PGM PLATE INCH\r\n", Language::Heidenhain),
            ("%PART1 G71 *\nN10 G30 G17 X+0*\n", Language::Heidenhain),
            ("%_N_PLATE_MPF\n;$PATH=/_N_WKS_DIR\n", Language::Sinumerik),
            ("N10 G17\nN20 T=\"MILL10\" D1\n", Language::Sinumerik),
            ("G0 X10\nCYCLE83(50,0,2)\n", Language::Sinumerik),
            ("'SHOPBOT FILE\nSA\n", Language::ShopBot),
            ("SA\nMS,2,1\nJZ,0.5\n", Language::ShopBot),
            ("IN;SP1;PU0,0;PD100,100;\n", Language::Plotter),
            ("G04 a comment*\n%FSLAX24Y24*%\n%MOMM*%\n", Language::Gerber),
            ("  0\nSECTION\n  2\nHEADER\n", Language::Drawing),
            ("<?xml version=\"1.0\"?>\n<svg>", Language::Drawing),
            ("solid part\nfacet normal 0 0 1\n", Language::Drawing),
        ] {
            assert_eq!(of(text.as_bytes()), Some(language), "{text}");
        }
    }

    #[test]
    fn programs_of_other_writers_are_g_code() {
        for text in [
            "",
            "%\nO1000 (PLATE)\nN1 G21\n",
            "(T=\"MILL\" X=3)\nG0 X1\n",
            "; Y=5 CYCLE83\n#1=5\n#<_x>=[1+2]\nG0 X#1\n",
            "M3 S1, M5\nG1 X1,5\n",
            "$H\nG0X1\n",
        ] {
            assert_eq!(of(text.as_bytes()), None, "{text}");
        }
    }
}
