//! Measured features as text, JSON and a table.

use super::Heading;
use crate::text::length;
use husillo_metrology::routine::{Dimension, Feature, Verdict, decimal, number, signed};
use husillo_sim::text::counted;
use serde_json::{Value, json};
use std::fmt::Write;

/// The columns of [`csv`].
pub const CSV_HEAD: &str =
    "feature,kind,line,figure,unit,actual,nominal,least,most,deviation,result";

/// Text for the operator. The last line has no line end.
pub fn text(feature: &Feature) -> String {
    let mut text = format!("{} {}", feature.keyword, feature.name);
    for dimension in &feature.dimensions {
        let Dimension {
            figure,
            actual_micro,
            wanted,
        } = dimension;
        // Writing to a String cannot fail.
        let _ = write!(
            text,
            "\n    {:<9}{:>11} {:<3}",
            figure.name(),
            decimal(*actual_micro),
            figure.unit()
        );
        if let Some(wanted) = wanted {
            let tolerance = wanted.tolerance_micro.map(limits).unwrap_or_default();
            let _ = write!(
                text,
                " nominal {:>10} {tolerance:<17} deviation {:>8}{}",
                decimal(wanted.nominal_micro),
                signed(dimension.deviation_micro().unwrap_or_default()),
                match feature.verdict(dimension) {
                    Some(Verdict::Good) => "  ok",
                    Some(Verdict::Out) => "  OUT OF TOLERANCE",
                    Some(Verdict::Spoiled) => "  spoiled by a collision",
                    None => "",
                }
            );
        }
    }
    let text = text
        .lines()
        .map(str::trim_end)
        .collect::<Vec<_>>()
        .join("\n");
    match feature.marks.len() {
        0 => text,
        1 => format!("{text}\n    1 point"),
        points => format!(
            "{text}\n    {points} points, form {}",
            length(feature.form_nm() as f64)
        ),
    }
}

/// Limits as text: `+0.03 -0.01`, `+-0.02`, or `0 to +0.01`.
pub fn limits([least, most]: [i64; 2]) -> String {
    let plain = |micro: i64| {
        let text = format!("{:+}", number(micro));
        if micro == 0 { "0".to_owned() } else { text }
    };
    match (least, most) {
        (0, most) => format!("0 to {}", plain(most)),
        (least, most) if least == -most => format!("+-{}", number(most)),
        (least, most) => format!("{} {}", plain(most), plain(least)),
    }
}

/// The last line of the text: the number of features, and the number of tolerances kept.
pub fn summary(features: &[Feature]) -> String {
    let judged = features.iter().flat_map(|feature| &feature.dimensions);
    let verdicts: Vec<bool> = judged.filter_map(Dimension::is_good).collect();
    let out = verdicts.iter().filter(|is_good| !**is_good).count();
    let is_spoiled = features.iter().any(|feature| feature.is_spoiled);
    let features = counted(features.len(), "feature");
    match (verdicts.len(), out) {
        (0, _) if is_spoiled => format!("{features}, spoiled by a collision"),
        (_, _) if is_spoiled => {
            format!("{features}, spoiled by a collision: no tolerance counts as kept")
        }
        (0, _) => features,
        (all, 0) => format!("{features}, {all} of {} kept", counted(all, "tolerance")),
        (all, out) => format!(
            "{features}, {out} of {} not kept",
            counted(all, "tolerance")
        ),
    }
}

/// One JSON object for all features. It also contains the failure that ended the routine, and
/// whether there was a collision.
pub fn json(
    heading: &Heading<'_>,
    features: &[Feature],
    trouble: Option<&str>,
    has_collided: bool,
) -> Value {
    let all: Vec<Value> = features.iter().map(object).collect();
    json!({
        "routine": heading.routine,
        "part": heading.part,
        "machine": heading.machine,
        "measured": heading.measured,
        "trouble": trouble,
        "collision": has_collided,
        "in_tolerance": trouble.is_none() && !has_collided && features.iter().all(Feature::is_good),
        "features": all,
    })
}

fn object(feature: &Feature) -> Value {
    let dimensions: Vec<Value> = feature
        .dimensions
        .iter()
        .map(|dimension| figure(feature, dimension))
        .collect();
    let point = |nm: [i64; 3]| feature.frame.to_part(nm).map(number);
    let points: Vec<Value> = feature
        .marks
        .iter()
        .map(|mark| {
            let [x, y, z] = point(mark.surface_nm);
            json!({"x": x, "y": y, "z": z, "residual": number(mark.residual_nm)})
        })
        .collect();
    json!({
        "feature": feature.name,
        "kind": feature.keyword,
        "frame": feature.frame_name,
        "line": feature.line,
        "in_tolerance": feature.is_good(),
        "dimensions": dimensions,
        "points": points,
        "form": number(feature.form_nm()),
        "touches": feature.touches(),
        // `null`: one touch of each point shows no spread.
        "spread": feature.spread_nm().map(number),
    })
}

fn figure(feature: &Feature, dimension: &Dimension) -> Value {
    let mut value = json!({
        "figure": dimension.figure,
        "unit": dimension.figure.unit(),
        "actual": number(dimension.actual_micro),
    });
    if let Some(wanted) = dimension.wanted {
        value["nominal"] = number(wanted.nominal_micro).into();
        value["deviation"] = dimension.deviation_micro().map(number).into();
        if let Some([least, most]) = wanted.tolerance_micro {
            value["least"] = number(least).into();
            value["most"] = number(most).into();
            // `null` after a collision: the result is unknown.
            let verdict = feature.verdict(dimension);
            let judged = verdict.filter(|verdict| *verdict != Verdict::Spoiled);
            value["in_tolerance"] = judged.map(|verdict| verdict == Verdict::Good).into();
        }
    }
    value
}

/// A table with one figure per line.
pub fn csv(features: &[Feature]) -> String {
    let mut table = format!("{CSV_HEAD}\n");
    for feature in features {
        for dimension in &feature.dimensions {
            let wanted = dimension.wanted;
            let [least, most] = match wanted.and_then(|wanted| wanted.tolerance_micro) {
                Some(ends) => ends.map(|end| number(end).to_string()),
                None => [String::new(), String::new()],
            };
            let text = |micro: Option<i64>| micro.map(|micro| number(micro).to_string());
            let nominal = text(wanted.map(|wanted| wanted.nominal_micro));
            let deviation = text(dimension.deviation_micro());
            let result = match feature.verdict(dimension) {
                Some(Verdict::Good) => "ok",
                Some(Verdict::Out) => "out",
                Some(Verdict::Spoiled) => "spoiled",
                None => "",
            };
            // Names are letters, digits, `_` and `-`: nothing to quote.
            let _ = writeln!(
                table,
                "{},{},{},{},{},{},{},{least},{most},{},{result}",
                feature.name,
                feature.keyword,
                feature.line,
                dimension.figure.name(),
                dimension.figure.unit(),
                number(dimension.actual_micro),
                nominal.unwrap_or_default(),
                deviation.unwrap_or_default(),
            );
        }
    }
    table
}
