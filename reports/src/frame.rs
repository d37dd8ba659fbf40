//! The common parts of all pages: head, style, header, figures, notes.

use crate::text::escape;
use husillo_view::{COLOURS, Page, VIEWER, VIEWER_STYLE};
use std::fmt::{Display, Write};

/// Shapes of all pages. The colours are those of the viewer.
const STYLE: &str = "\
*{box-sizing:border-box}\
body{margin:0 auto;max-width:72rem;padding:1.5rem;background:var(--ground);color:var(--ink);\
font:16px/1.5 system-ui,sans-serif}\
h1{font-size:1.5rem;margin:0}h2{font-size:1.15rem;margin:2rem 0 .5rem}p{margin:.3rem 0;\
color:var(--soft)}\
svg{display:block;width:100%;height:auto;background:var(--ground);border:1px solid var(--line)}\
table{border-collapse:collapse;font-variant-numeric:tabular-nums}\
th,td{padding:.25rem .9rem .25rem 0;text-align:right;border-bottom:1px solid var(--line)}\
th:first-child,td:first-child,.events *{text-align:left}th{font-weight:600;color:var(--soft)}\
dl{display:grid;grid-template-columns:repeat(auto-fill,minmax(11rem,1fr));gap:.8rem;margin:1rem 0}\
dl div{background:var(--panel);border:1px solid var(--line);border-radius:6px;padding:.5rem .8rem}\
dt{color:var(--soft);font-size:.85rem}dd{margin:0;font-size:1.15rem;\
font-variant-numeric:tabular-nums}\
h1,p,dd,li{overflow-wrap:anywhere}.scroll{overflow-x:auto}ul{padding-left:1.2rem}\
code{font-family:ui-monospace,monospace;\
font-size:.9rem}\
path,line,rect{vector-effect:non-scaling-stroke;fill:none}\
.jog{stroke:var(--jog);stroke-width:1.5;stroke-dasharray:1.5 4;stroke-linecap:round}\
.rapid{stroke:var(--rapid);stroke-width:1.5;stroke-dasharray:7 5}\
.feed{stroke:var(--feed);stroke-width:1.8;stroke-linejoin:round}\
.take-up{stroke:var(--take-up);stroke-width:2}\
.ideal{stroke:var(--ideal);stroke-width:5;stroke-opacity:.3}\
.thin{stroke:var(--ideal);stroke-width:1}\
.area{stroke:var(--limit);stroke-width:1.2}.hatch{stroke:var(--limit);stroke-width:1;\
stroke-opacity:.45}\
.grid{stroke:var(--line);stroke-width:1}\
.acceleration{stroke:var(--soft);stroke-width:1.2;stroke-linejoin:round}\
.stop{stroke-width:5}.dwell{stroke:var(--jog);stroke-dasharray:2 2}\
text{fill:var(--soft);font:12px system-ui,sans-serif}";

/// Begins a page: one self-contained HTML file that needs no network.
///
/// `title`, `heading` and `line` are plain text. `style` is added to the style of all pages.
pub fn open(title: &str, heading: &str, line: &str, style: &str) -> String {
    let (title, heading, line) = (escape(title), escape(heading), escape(line));
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n\
         <style>{COLOURS}{STYLE}{style}</style>\n</head>\n<body>\n\
         <header><h1>{heading}</h1><p>{line}</p></header>\n<main>\n"
    )
}

/// Writes figures. Each has a name and a value.
pub fn figures<N: Display>(page: &mut String, figures: impl IntoIterator<Item = (N, String)>) {
    page.push_str("<dl>\n");
    for (name, value) in figures {
        // Writing to a String cannot fail.
        let _ = writeln!(
            page,
            "<div><dt>{name}</dt><dd>{}</dd></div>",
            escape(&value)
        );
    }
    page.push_str("</dl>\n");
}

/// Writes notes, if there are any.
pub fn notes(page: &mut String, notes: &[String]) {
    if notes.is_empty() {
        return;
    }
    page.push_str("<section><h2>Notes</h2><ul>\n");
    for note in notes {
        let _ = writeln!(page, "<li>{}</li>", escape(note));
    }
    page.push_str("</ul></section>\n");
}

/// A page with the viewer: `main` is the content of its element `main`, `scene` the element of the
/// scene. Without scripts, everything but the section of the viewer is there.
pub fn with_viewer(heading: &str, line: &str, main: &str, scene: &str) -> String {
    let body = format!(
        "<header><h1>{}</h1><p>{}</p></header>\n<main>\n{main}</main>\n{scene}",
        escape(heading),
        escape(line)
    );
    let page = Page {
        language: "en",
        title: heading,
        styles: &[COLOURS, STYLE, VIEWER_STYLE],
        body: &body,
        modules: VIEWER,
        entry: "viewer/report.js",
    };
    page.html()
}

/// Ends a page.
pub fn close(mut page: String, script: Option<&str>) -> String {
    page.push_str("</main>\n");
    if let Some(script) = script {
        let _ = writeln!(page, "<script>{script}</script>");
    }
    page.push_str("</body>\n</html>\n");
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_escaped() {
        let page = close(open("</title>", "<b>", "a & b", ""), None);
        assert!(page.contains("<title>&lt;/title&gt;</title>"));
        assert!(page.contains("<h1>&lt;b&gt;</h1><p>a &amp; b</p>"));
        assert!(page.ends_with("<main>\n</main>\n</body>\n</html>\n"));
    }
    /// A line whose colour has no value is not drawn.
    #[test]
    fn every_colour_has_a_value() {
        let page = open("", "", "", VIEWER_STYLE);
        let names = page
            .split("var(")
            .skip(1)
            .filter_map(|rest| rest.split(')').next());
        let missing: Vec<_> = names
            .filter(|name| !page.contains(&format!("{name}:")))
            .collect();
        assert!(missing.is_empty(), "{missing:?}");
    }
}
