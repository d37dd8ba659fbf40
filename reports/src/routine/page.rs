//! The measuring report: one self-contained HTML file without scripts.

use super::Heading;
use super::listing::{limits, summary};
use super::picture::{self, ABOVE, FRONT};
use crate::frame;
use crate::text::escape;
use crate::text::length;
use husillo_metrology::routine::{Dimension, Feature, Site, Verdict, decimal, signed};
use std::fmt::Write;

/// Styles that only this page has.
const LOOK: &str = "\
:root{--good:#116329}@media(prefers-color-scheme:dark){:root{--good:#56d364}}\
.good{stroke:var(--feed);stroke-width:1.6}path.bad,circle.bad{stroke:var(--limit);stroke-width:2}\
text.bad{fill:var(--limit);font-weight:600}\
circle{fill:none;vector-effect:non-scaling-stroke}circle.dot{fill:var(--ink);stroke:none}\
.face{stroke-dasharray:7 4}.size{stroke:var(--soft);stroke-width:1;stroke-dasharray:2 3}\
.off{stroke:var(--rapid);stroke-width:2.4}.bar{stroke:var(--rapid);stroke-width:5}\
td.ok{color:var(--good)}td.out{color:var(--limit);font-weight:700}tr.first td{border-top:2px solid \
var(--line)}\
td:nth-child(n+8),th:nth-child(n+8),td:nth-child(2),th:nth-child(2),td:nth-child(3),\
th:nth-child(3){text-align:left}\
figure{margin:.8rem 0}figcaption{color:var(--soft);font-size:.9rem}\
.verdict{font-size:1.15rem;font-weight:600}.verdict.ok{color:var(--good)}\
.verdict.out{color:var(--limit)}";

/// Writes the page.
pub fn html(
    heading: &Heading<'_>,
    features: &[Feature],
    site: &Site<'_>,
    trouble: Option<&str>,
) -> String {
    let name = heading.routine;
    let of = heading
        .part
        .map_or(String::new(), |part| format!("part {part}, "));
    let line = format!("{of}{}, measured {}", heading.machine, heading.measured);
    let mut page = frame::open(&format!("{name}: measured"), name, &line, LOOK);
    let is_good = features.iter().all(Feature::is_good) && trouble.is_none();
    // Writing to a String cannot fail.
    let _ = writeln!(
        page,
        "<p class=\"verdict {}\">{}</p>",
        if is_good { "ok" } else { "out" },
        escape(&verdict(features, trouble))
    );
    figures(&mut page, features, site);
    table(&mut page, features);
    views(&mut page, features, site);
    residuals(&mut page, features);
    points(&mut page, features);
    frame::close(page, None)
}

fn verdict(features: &[Feature], trouble: Option<&str>) -> String {
    match trouble {
        Some(trouble) => format!("Stopped: {trouble}. Before that: {}.", summary(features)),
        None => format!("{}.", summary(features)),
    }
}

fn figures(page: &mut String, features: &[Feature], site: &Site<'_>) {
    let touches: u32 = features.iter().map(Feature::touches).sum();
    let spread = features.iter().filter_map(Feature::spread_nm).max();
    let form = features.iter().map(Feature::form_nm).max();
    let points: usize = features.iter().map(|feature| feature.contacts.len()).sum();
    let nm = |nm: i64| length(nm as f64);
    page.push_str("<dl>\n");
    for (term, value) in [
        ("features", features.len().to_string()),
        ("points touched", points.to_string()),
        ("touches averaged", touches.to_string()),
        (
            "largest spread of a point",
            spread.map_or("one touch per point".into(), nm),
        ),
        ("largest form error", nm(form.unwrap_or_default())),
        ("radius of the tip", length(site.radius_nm() as f64)),
        ("pre-travel", pre_travel(site)),
    ] {
        let _ = writeln!(page, "<div><dt>{term}</dt><dd>{value}</dd></div>");
    }
    page.push_str("</dl>\n");
}

/// The pre-travel that was subtracted: one for all directions, or its range.
fn pre_travel(site: &Site<'_>) -> String {
    let entries = site.tip.pre_travel.entries().iter().map(|(_, nm)| *nm);
    let ends = entries.clone().min().zip(entries.max());
    match ends {
        None => "none".into(),
        Some((least, most)) if least == most => length(least.into()),
        Some((least, most)) => {
            format!("{} to {}", length(least.into()), length(most.into()))
        }
    }
}

fn table(page: &mut String, features: &[Feature]) {
    page.push_str(
        "<section><h2>Features</h2><div class=\"scroll\" tabindex=\"0\"><table><thead><tr>",
    );
    for head in [
        "feature",
        "result",
        "figure",
        "actual",
        "deviation",
        "nominal",
        "tolerance",
        "kind",
        "frame",
    ] {
        let _ = write!(page, "<th scope=\"col\">{head}</th>");
    }
    page.push_str("</tr></thead><tbody>\n");
    for feature in features {
        let frame = escape(&feature.frame_name);
        let name = escape(&feature.name);
        let mut first = Some([&name, feature.keyword, &frame]);
        for dimension in &feature.dimensions {
            row(page, dimension, feature.verdict(dimension), first.take());
        }
    }
    page.push_str("</tbody></table></div></section>\n");
}

fn row(
    page: &mut String,
    dimension: &Dimension,
    verdict: Option<Verdict>,
    first: Option<[&str; 3]>,
) {
    let class = if first.is_some() {
        " class=\"first\""
    } else {
        ""
    };
    let [name, keyword, frame] = first.unwrap_or_default();
    let wanted = dimension.wanted;
    let nominal = wanted.map(|wanted| decimal(wanted.nominal_micro));
    let tolerance = wanted.and_then(|wanted| wanted.tolerance_micro);
    let tolerance = tolerance.map(|ends| limits(ends).replace("+-", "\u{b1}"));
    let deviation = dimension.deviation_micro().map(signed);
    let (result, colour) = match verdict {
        Some(Verdict::Good) => ("ok", "ok"),
        Some(Verdict::Out) => ("out of tolerance", "out"),
        Some(Verdict::Spoiled) => ("spoiled by a collision", "out"),
        None => ("", ""),
    };
    let _ = writeln!(
        page,
        "<tr{class}><td>{name}</td><td class=\"{colour}\">{result}</td><td>{} {}</td><td>{}</td>\
         <td>{}</td><td>{}</td><td>{}</td><td>{keyword}</td><td>{frame}</td></tr>",
        dimension.figure.name(),
        dimension.figure.unit(),
        decimal(dimension.actual_micro),
        deviation.unwrap_or_default(),
        nominal.unwrap_or_default(),
        tolerance.unwrap_or_default(),
    );
}

fn views(page: &mut String, features: &[Feature], site: &Site<'_>) {
    if features.is_empty() {
        return;
    }
    let part = &site.frame;
    let factor = picture::factor(features, picture::size_nm(features, part));
    let _ = writeln!(
        page,
        "<section><h2>Positions</h2><p>In the frame at the end of the routine. Dots: points \
         of the surface, corrected for \
         tip and pre-travel. Thick strokes: their deviations from the feature, magnified \
         {factor:.0} times. Red: out of tolerance.</p>"
    );
    for plan in [ABOVE, FRONT] {
        let _ = writeln!(page, "<figure><figcaption>{} view</figcaption>", plan.name);
        picture::draw(page, features, part, plan, factor);
        page.push_str("</figure>\n");
    }
    page.push_str("</section>\n");
}

fn residuals(page: &mut String, features: &[Feature]) {
    let has_any = |feature: &&Feature| feature.marks.len() > 1 && feature.form_nm() > 0;
    let mut features = features.iter().filter(has_any).peekable();
    if features.peek().is_none() {
        return;
    }
    page.push_str(
        "<section><h2>Residuals</h2><p>The distance of each point from its feature, in the \
         order of touching. Points outside the feature are up.</p>\n",
    );
    features.for_each(|feature| picture::residuals(page, feature));
    page.push_str("</section>\n");
}

fn points(page: &mut String, features: &[Feature]) {
    page.push_str(
        "<section><h2>Points</h2><details><summary>All points of the surface, mm. Each is given \
         in the frame in which it was measured</summary>\
         <div class=\"scroll\" tabindex=\"0\"><table><thead><tr><th scope=\"col\">feature</th><th \
         scope=\"col\">point</th><th scope=\"col\">x</th>\
         <th scope=\"col\">y</th><th scope=\"col\">z</th><th \
         scope=\"col\">residual</th></tr></thead><tbody>\n",
    );
    for feature in features {
        for (number, mark) in (1..).zip(&feature.marks) {
            let [x, y, z] = feature.frame.to_part(mark.surface_nm).map(decimal);
            let _ = writeln!(
                page,
                "<tr><td>{}</td><td>{number}</td><td>{x}</td><td>{y}</td><td>{z}</td><td>{}</td>\
                 </tr>",
                escape(&feature.name),
                signed(mark.residual_nm)
            );
        }
    }
    page.push_str("</tbody></table></div></details></section>\n");
}
