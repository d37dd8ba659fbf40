//! The page of `husillo compare`: tables, the matrix with adjustable weights, the picture.

use super::picture;
use super::text::{ORIGINAL, instructions};
use crate::frame;
use husillo_methods::trial::{Speed, WINDOWS};
use husillo_methods::{CRITERIA, Comparison, Row};
use std::fmt::Write;

/// Styles of the methods. A colour marks a family. Width and dashes mark the printed methods.
const METHODS: &str = "\
:root{--staircase:#9a6700;--dda:#8a2fa3;--direct-search:#0b5cad}\
@media(prefers-color-scheme:dark){:root{--staircase:#f0c419;--dda:#d795ee;--direct-search:#5aa9ff}}\
.m-staircase,.m-staircase-printed{stroke:var(--staircase)}.m-dda,.m-dda-printed{stroke:var(--dda)}\
.m-direct-search,.m-direct-search-printed,.m-bresenham{stroke:var(--direct-search)}\
.m-staircase,.m-dda,.m-direct-search,.m-bresenham{stroke-width:4.5;stroke-opacity:.55;\
stroke-linejoin:round}\
.m-staircase-printed,.m-dda-printed,.m-direct-search-printed{stroke-width:1.6}\
.m-staircase-printed{stroke-dasharray:7 3}.m-dda-printed{stroke-dasharray:2 \
3}.m-direct-search-printed{stroke-dasharray:9 3 2 3}\
.exact{stroke:var(--ink);stroke-width:1}\
.zooms{display:grid;grid-template-columns:repeat(auto-fit,minmax(26rem,1fr));gap:1rem}\
.zooms figure{margin:0}.zooms figure:first-child{grid-column:1/-1;max-width:52rem}\
figcaption{color:var(--soft);font-size:.9rem}\
.show label{display:inline-block;margin-right:1.2rem;white-space:nowrap}.show \
svg{display:inline;width:2.5rem;height:.5rem;border:0}\
input[type=number]{width:4.5rem;font:inherit;color:inherit;background:var(--panel);border:1px \
solid var(--line);text-align:right}\
.best{font-weight:700}table{margin:.6rem 0 1.2rem}";

/// Computes the totals of every matrix from its weights.
const SCRIPT: &str = "\
for(const table of document.querySelectorAll('table.matrix')){\
const inputs=[...table.querySelectorAll('input')],\
rows=[...table.querySelectorAll('tr[data-points]')];\
const sum=()=>{const w=inputs.map(i=>Math.max(0,+i.value||0)),all=w.reduce((a,b)=>a+b,0);\
const totals=rows.map(r=>all?r.dataset.points.split(' \
').reduce((a,p,i)=>a+p*w[i],0)/all:0),best=Math.max(...totals);\
rows.forEach((r,i)=>{const \
c=r.lastElementChild;c.textContent=totals[i].toFixed(1);c.className=totals[i]===best?'best':''})};\
inputs.forEach(i=>i.addEventListener('input',sum));sum()}";

/// Writes the page.
pub fn html(of: &Comparison) -> String {
    let mut style = METHODS.to_owned();
    for row in &of.rows {
        // Writing to a String cannot fail.
        let _ = write!(
            style,
            "body:has(#show-{0}:not(:checked)) figure .m-{0}{{display:none}}",
            row.method
        );
    }
    let title = format!("{}: methods compared", of.title);
    let line = "Interpolation methods compared; 1 BLU is one motor step";
    let mut page = frame::open(&title, &of.title, line, &style);
    for shape in ["line", "arc"] {
        let rows: Vec<&Row> = of.rows.iter().filter(|row| row.shape == shape).collect();
        if !rows.is_empty() {
            figures(&mut page, &rows);
            speeds(&mut page, &rows);
            matrix(&mut page, of, &rows);
        }
    }
    if let Some(one) = of.one.as_ref().filter(|one| picture::is_flat(one)) {
        picture::section(&mut page, one, &of.rows);
    }
    frame::notes(&mut page, &of.notes);
    frame::close(page, Some(SCRIPT))
}

fn head(page: &mut String, columns: &[&str]) {
    page.push_str("<thead><tr>");
    for column in columns {
        let _ = write!(page, "<th scope=\"col\">{column}</th>");
    }
    page.push_str("</tr></thead>\n");
}

fn figures(page: &mut String, rows: &[&Row]) {
    let moves = rows.first().map_or(0, |row| row.moves);
    let shape = rows.first().map_or("", |row| row.shape);
    let _ = writeln!(
        page,
        "<section><h2>Iterations, error, work{}</h2><div class=\"scroll\" tabindex=\"0\"><table>",
        if moves > 1 {
            format!(": {moves} {shape}s")
        } else {
            String::new()
        }
    );
    head(
        page,
        &[
            "method",
            "iterations",
            "moving",
            "largest error, BLU",
            "RMS error, BLU",
            "additions",
            "tests",
            "instructions M0, M4F, RV32",
        ],
    );
    page.push_str("<tbody>\n");
    for row in rows {
        let _ = writeln!(
            page,
            "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{:.3}</td><td>{:.3}</td><td>{}\
             </td><td>{}</td><td>{}</td></tr>",
            row.method,
            row.iterations,
            row.moving,
            row.max_error_blu,
            row.rms_error_blu,
            row.additions,
            row.tests,
            instructions(row)
        );
    }
    page.push_str("</tbody></table></div></section>\n");
}

fn speeds(page: &mut String, rows: &[&Row]) {
    page.push_str(
        "<section><h2>Speed</h2><p>Mean speed divided by the programmed feed, and the slowest and \
         fastest of all windows of so many events, relative to the mean, in per cent. Equal time: \
         every pass takes the time of a BLU (idle passes of dda-printed take none). \
         Vector feed: every event takes the time of its own path.</p><div \
         class=\"scroll\" tabindex=\"0\"><table>\n",
    );
    let windows = WINDOWS.map(|events| match events {
        1 => "1 event".to_owned(),
        _ => format!("{events} events"),
    });
    let mut columns = vec!["method", "timing", "mean speed"];
    columns.extend(windows.iter().map(String::as_str));
    head(page, &columns);
    page.push_str("<tbody>\n");
    let mut line = |row: &Row, timing: &str, speed: &Speed| {
        let _ = write!(
            page,
            "<tr><th scope=\"row\">{}</th><td>{timing}</td><td>{:.3}</td>",
            row.method, speed.mean_speed
        );
        for ripple in &speed.ripple_percent_windows {
            let _ = write!(page, "<td>{:+.1} {:+.1}</td>", ripple.low, ripple.high);
        }
        page.push_str("</tr>\n");
    };
    for row in rows {
        line(row, "equal time", &row.equal_time);
    }
    for row in rows {
        if let Some(speed) = &row.vector_feed {
            line(row, "vector feed", speed);
        }
    }
    page.push_str("</tbody></table></div></section>\n");
}

fn matrix(page: &mut String, of: &Comparison, rows: &[&Row]) {
    page.push_str(
        "<section><h2>Decision matrix</h2><p>Points from 0 to 100. Error, iterations and work: the \
         value of the best method divided by that of the method. Evenness: 100 minus the ripple \
         over 32 events from slowest to fastest, with vector feed if the method has one; printed \
         methods with equal time. The weights can be changed.</p>\
         <div class=\"scroll\" tabindex=\"0\"><table class=\"matrix\">\n",
    );
    let mut columns = vec!["method"];
    columns.extend(CRITERIA);
    columns.push("total");
    head(page, &columns);
    page.push_str("<tbody>\n<tr><th scope=\"row\">weight</th>");
    for (name, weight) in CRITERIA.iter().zip(of.weights.0) {
        let _ = write!(
            page,
            "<td><input type=\"number\" min=\"0\" step=\"any\" value=\"{weight}\" \
             aria-label=\"weight of {name}\"></td>"
        );
    }
    page.push_str("<td></td></tr>\n");
    for row in rows {
        let values = row.points.values();
        let list: Vec<String> = values.iter().map(|points| format!("{points:.4}")).collect();
        let _ = write!(
            page,
            "<tr data-points=\"{}\"><th scope=\"row\">{}</th>",
            list.join(" "),
            row.method
        );
        for points in values {
            let _ = write!(page, "<td>{points:.1}</td>");
        }
        let _ = writeln!(page, "<td>{:.1}</td></tr>", row.points.total);
    }
    page.push_str("</tbody></table></div>");
    if rows.iter().any(|row| row.shape == "arc") {
        let _ = write!(page, "<p>{ORIGINAL}</p>");
    }
    page.push_str("</section>\n");
}
