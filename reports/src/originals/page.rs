//! Rebuilt tables as a page.

use super::Rebuilt;
use super::picture::Picture;
use super::text::{figure, summary, verdict};
use crate::frame;
use crate::text::escape;
use husillo_metrology::originals::Table;
use std::fmt::Write;

const STYLE: &str = "\
.pairs{display:grid;grid-template-columns:repeat(auto-fit,minmax(20rem,1fr));gap:1rem}\
figure{margin:0 0 1rem}figcaption{color:var(--soft);font-size:.9rem}\
circle{fill:none}.nominal{stroke:var(--line)}.measured{fill:var(--ink)}\
.rebuilt{stroke:#c2410c;stroke-width:1.5}.mapped{stroke:#0b5cad;stroke-width:1.5}\
@media(prefers-color-scheme:dark){.rebuilt{stroke:#ff9a4d}.mapped{stroke:#5aa9ff}}\
.outside td{color:var(--limit)}";

/// Writes the page: one self-contained file.
pub fn html(rebuilt: &Rebuilt) -> String {
    let title = format!("{}: the measured tables, rebuilt", rebuilt.machine);
    let mut page = frame::open(&title, &title, &verdict(rebuilt), STYLE);
    for table in &rebuilt.tables {
        let _ = writeln!(
            page,
            "<section><h2>Table {}: {}</h2>",
            table.number,
            escape(table.title)
        );
        for line in summary(table) {
            let _ = writeln!(page, "<p>{}</p>", escape(&line));
        }
        pictures(&mut page, rebuilt, table);
        rows(&mut page, table);
        let _ = writeln!(page, "<p>Spread: {}.</p><ul>", escape(table.spread));
        for parameter in &table.parameters {
            let _ = writeln!(
                page,
                "<li>{}: {} ({})</li>",
                escape(&parameter.name),
                escape(&parameter.value),
                escape(parameter.source)
            );
        }
        page.push_str("</ul>\n");
        for note in &table.notes {
            let _ = writeln!(page, "<p>{}</p>", escape(note));
        }
        page.push_str("</section>\n");
    }
    frame::close(page, None)
}

fn pictures(page: &mut String, rebuilt: &Rebuilt, table: &Table) {
    let own = rebuilt.pictures.iter();
    let own = own.filter(|(number, _)| *number == table.number);
    let own: Vec<&Picture> = own.map(|(_, picture)| picture).collect();
    if let [one] = own[..] {
        figure_of(page, one);
    } else if !own.is_empty() {
        page.push_str("<div class=\"pairs\">\n");
        own.iter().for_each(|picture| figure_of(page, picture));
        page.push_str("</div>\n");
    }
    if let Some(picture) = Picture::unexplained(table) {
        figure_of(page, &picture);
    }
}

fn figure_of(page: &mut String, picture: &Picture) {
    let _ = writeln!(
        page,
        "<figure>{}<figcaption>{}</figcaption></figure>",
        picture.svg,
        escape(&picture.caption)
    );
}

fn rows(page: &mut String, table: &Table) {
    page.push_str(
        "<div class=\"scroll\" tabindex=\"0\">\
         <table><tr><th></th><th>unit</th><th>measured</th><th>rebuilt</th>\
         <th>unexplained</th><th>spread</th><th>today</th></tr>\n",
    );
    for row in &table.rows {
        let value = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| figure(row, v));
        let class = match row.is_within() {
            Some(false) => " class=\"outside\"",
            _ => "",
        };
        let _ = writeln!(
            page,
            "<tr{class}><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>\
             <td>{}</td></tr>",
            escape(&row.name),
            row.unit,
            figure(row, row.measured),
            value(row.rebuilt),
            value(row.unexplained()),
            figure(row, row.spread),
            value(row.today)
        );
    }
    page.push_str("</table></div>\n");
}
