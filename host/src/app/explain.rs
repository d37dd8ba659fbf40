//! `husillo explain`: the meaning of a finding or a code, from the pages of the documentation.

use super::{Failure, OK};
use crate::cli::{Explain, Output};
use crate::console;
use husillo_simulator::diagnostics::page::FINDINGS;
use husillo_simulator::text::json::write_line;
use std::collections::BTreeMap;
use std::io::Write;

const CODES: &str = include_str!("../../docs/codes.md");

/// A row of a table, with the heads of its columns.
struct Row {
    heads: Vec<&'static str>,
    cells: Vec<&'static str>,
}

/// Prints the row of each name.
///
/// # Errors
///
/// A name is not known. Nothing is printed then.
pub(super) fn explain(args: &Explain) -> Result<u8, Failure> {
    let found: Result<Vec<_>, _> = args.names.iter().map(|name| row(name)).collect();
    let mut out = console::stdout();
    for Row { heads, cells } in found? {
        if args.format == Output::Json {
            let columns = heads
                .iter()
                .zip(cells)
                .map(|(head, cell)| (*head, plain(cell)));
            let columns: BTreeMap<_, _> = columns.collect();
            write_line("husillo.explain/1", &columns, &mut out)?;
            continue;
        }
        let mut pairs = heads.iter().zip(&cells);
        if let (Some((_, code)), Some((_, meaning))) = (pairs.next(), pairs.next()) {
            writeln!(out, "{code}: {}", plain(meaning))?;
        }
        for (head, cell) in pairs.filter(|(_, cell)| !cell.is_empty()) {
            writeln!(out, "  {head}: {}", plain(cell))?;
        }
    }
    Ok(OK)
}

fn row(name: &str) -> Result<Row, Failure> {
    let wanted = normal(name);
    let mut rows = rows(FINDINGS).chain(rows(CODES));
    rows.find(|row| row.cells.first() == Some(&wanted.as_str()))
        .ok_or_else(|| {
            let which = "there are findings as E0302 and W0601, and codes as G83 and M3";
            Failure::Usage(format!("`{name}` is not known: {which}"))
        })
}

/// `g01` is G1, and `e302` is E0302.
fn normal(name: &str) -> String {
    let name = name.trim().to_ascii_uppercase();
    let (letter, number) = name.split_at(name.chars().next().map_or(0, char::len_utf8));
    match letter {
        "G" | "M" if !number.is_empty() => {
            let short = number.trim_start_matches('0');
            let whole = if short.is_empty() || short.starts_with('.') {
                "0"
            } else {
                ""
            };
            format!("{letter}{whole}{short}")
        }
        "E" | "W" => format!("{letter}{number:0>4}"),
        _ => name,
    }
}

/// The rows of all tables of a page.
fn rows(page: &'static str) -> impl Iterator<Item = Row> {
    let mut heads = Vec::new();
    let cells = |line: &'static str| -> Option<Vec<&'static str>> {
        let inner = line.strip_prefix('|')?.strip_suffix('|')?;
        Some(inner.split('|').map(str::trim).collect())
    };
    page.lines().filter_map(move |line| {
        let Some(cells) = cells(line) else {
            heads.clear();
            return None;
        };
        if heads.is_empty() {
            heads = cells;
            return None;
        }
        let is_rule = cells.iter().all(|cell| cell.starts_with("---"));
        (!is_rule).then(|| Row {
            heads: heads.clone(),
            cells,
        })
    })
}

/// The text of a link without its address.
fn plain(cell: &str) -> String {
    match (cell.find('['), cell.find("](")) {
        (Some(open), Some(close)) if open < close => {
            let end = cell[close..]
                .find(')')
                .map_or(cell.len(), |at| close + at + 1);
            format!(
                "{}{}{}",
                &cell[..open],
                &cell[open + 1..close],
                &cell[end..]
            )
        }
        _ => cell.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use husillo_gcode::{Axes, Block, Dialect};
    use husillo_simulator::diagnostics::Findings;
    use husillo_simulator::programs::program;
    use husillo_simulator::programs::source::Source;

    #[test]
    fn names_as_they_are_typed() {
        for (typed, name) in [("g01", "G1"), ("G0", "G0"), ("g00", "G0"), ("m3", "M3")] {
            assert_eq!(normal(typed), name);
        }
        for (typed, name) in [("e302", "E0302"), ("W0601", "W0601"), ("G59.1", "G59.1")] {
            assert_eq!(normal(typed), name);
        }
        assert!(row("G83").is_ok() && row("e0302").is_ok());
        for unknown in ["", "G", "E9999", "G123", "part.nc", "Ä"] {
            assert!(row(unknown).is_err(), "{unknown}");
        }
    }

    /// Each example of the page gives its error.
    #[test]
    fn examples_give_their_errors() {
        let mut examples = 0;
        for row in rows(FINDINGS) {
            let [code, _, example, _] = row.cells[..] else {
                panic!("{:?}", row.cells)
            };
            let Some(line) = example
                .strip_prefix('`')
                .and_then(|text| text.strip_suffix('`'))
            else {
                continue;
            };
            let mut source = Source::from_reader(Box::new(line.as_bytes()));
            let mut findings = Findings::new(9);
            let start = Dialect::RS274.with_axes(Axes::XYZ);
            program::walk(&mut source, "p", start, &mut findings, |_, _, _, _| Ok(())).unwrap();
            let found = findings.short().concat();
            assert!(found.contains(code), "{line}: {found}, not {code}");
            examples += 1;
        }
        assert!(examples > 45, "{examples}");
    }

    /// Every code that the reader takes has a row, and every row is a code that it takes.
    #[test]
    fn the_page_of_codes_is_the_list_of_the_reader() {
        for letter in ['G', 'M'] {
            for tenths in 0..1000 {
                let name = match tenths % 10 {
                    0 => format!("{letter}{}", tenths / 10),
                    tenth => format!("{letter}{}.{tenth}", tenths / 10),
                };
                let takes = |dialect| match Block::parse(name.as_bytes(), dialect) {
                    Ok(_) => true,
                    // It may lack its words.
                    Err(error) => !matches!(error.kind.code(), 202 | 212),
                };
                let (rs274, lathe) = (takes(&Dialect::RS274), takes(&Dialect::LATHE));
                let has_row = row(&name).is_ok();
                assert!(has_row || !rs274, "{name} has no row");
                assert!(
                    rs274 || lathe || !has_row,
                    "{name} has a row, but is not known"
                );
            }
        }
    }
}
