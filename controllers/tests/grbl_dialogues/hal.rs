//! Compares a played dialogue with a recording of grblHAL.
//!
//! Lists of settings, alarms, errors and help differ between controllers. Each line of them that
//! both have must agree in its numbers and types. All other lines are compared byte by byte, apart
//! from version, options, and sizes of buffers.

use crate::compare::{is_near, peak};
use crate::player::{Deed, Played};
use serde_json::Value;

/// Lines of recordings that are not compared. `docs/grbl.md` has the reasons.
const DECIDED: &[(&str, &str)] = &[
    ("hal_errors", "G5X1Y1I1J1P1Q1\n"),
    ("hal_errors", "?"),
    ("hal_errors", "$G\n"),
    ("hal_jog", "$J=G53X0F1000\n"),
    ("hal_realtime", "\u{a2}"),
    ("hal_settings", "$10=1x\n"),
];

/// What was sent, and what came back until the next text was sent.
struct Part<'a> {
    sent: &'a str,
    lines: Vec<(&'a str, bool)>,
}

fn wanted(records: &[Value]) -> Vec<Part<'_>> {
    let mut parts = vec![Part {
        sent: "",
        lines: Vec::new(),
    }];
    for record in records {
        if let Some(sent) = record["send"].as_str() {
            parts.push(Part {
                sent,
                lines: Vec::new(),
            });
        } else if let Some(line) = record["recv"].as_str() {
            let varies = record["varies"] == true;
            parts.last_mut().unwrap().lines.push((line, varies));
        }
    }
    parts
}

fn got(played: &Played) -> Vec<Part<'_>> {
    let mut parts = vec![Part {
        sent: "",
        lines: Vec::new(),
    }];
    for (_, deed) in &played.deeds {
        match deed {
            Deed::Sent(sent) => parts.push(Part {
                sent,
                lines: Vec::new(),
            }),
            Deed::Line(line) => parts.last_mut().unwrap().lines.push((line, false)),
            Deed::Output(..) => {}
        }
    }
    parts
}

/// Differences of a played dialogue.
pub fn differences(records: &[Value], played: &Played) -> Vec<String> {
    let mut found = Vec::new();
    let name = records[0]["dialogue"].as_str().unwrap();
    let peak = peak(records).max(50.0);
    let (wanted, got) = (wanted(records), got(played));
    assert_eq!(wanted.len(), got.len());
    // A motion was cut short by time, or a line was answered differently by a decision.
    let (mut is_loose, mut is_changed) = (false, false);
    // Lines of all parts that are not lists, in one sequence.
    let (mut first, mut second) = (Vec::new(), Vec::new());
    for (wanted, got) in wanted.iter().zip(&got) {
        assert_eq!(wanted.sent, got.sent);
        let is_cut = ['!', '\u{18}', '\u{85}']
            .iter()
            .any(|byte| wanted.sent.contains(*byte));
        is_loose |= is_cut;
        if DECIDED.contains(&(name, wanted.sent)) {
            // The state behind it differs as well.
            is_changed = true;
            continue;
        }
        if is_list(wanted.sent) {
            list(wanted, got, is_changed, &mut found);
        } else {
            let lines = wanted.lines.iter();
            first.extend(
                lines.map(|(line, varies)| {
                    (wanted.sent, (*line, *varies || is_loose || is_changed))
                }),
            );
            second.extend(got.lines.iter().map(|(line, _)| *line));
        }
    }
    let mut next = 0;
    for (sent, (line, varies)) in first {
        let Some(other) = second.get(next).copied() else {
            found.push(format!("{sent:?}: missing {line:?}"));
            break;
        };
        if !is_same(line, other, varies, peak) {
            let later = second.get(next + 1).copied();
            let swaps = later.is_some_and(|later| {
                is_same(line, later, varies, peak)
                    && (line.starts_with('<') || other.starts_with('<'))
            });
            if swaps {
                second.swap(next, next + 1);
            } else {
                found.push(format!("{sent:?}: {line:?}, not {other:?}"));
            }
        }
        next += 1;
        if found.len() > 12 {
            return found;
        }
    }
    for line in second.iter().skip(next).take(5) {
        found.push(format!("superfluous {line:?}"));
    }
    found
}

fn is_list(sent: &str) -> bool {
    ["$$", "$+", "$E", "$HELP", "$I"]
        .iter()
        .any(|start| sent.starts_with(start))
}

/// Key of a line of a list, and what must agree.
fn entry(line: &str) -> Option<(String, Vec<&str>)> {
    let line = line.trim_end();
    if let Some(rest) = line.strip_prefix("[SETTING:") {
        let fields: Vec<&str> = rest.split('|').collect();
        return Some((format!("setting {}", fields[0]), vec![fields[1]]));
    }
    for start in ["[SETTINGGROUP:", "[ALARMCODE:", "[ERRORCODE:"] {
        if let Some(rest) = line.strip_prefix(start) {
            let fields: Vec<&str> = rest.split('|').collect();
            return Some((format!("{start}{}", fields[0]), vec![fields[1]]));
        }
    }
    if let Some((number, value)) = line.strip_prefix('$').and_then(|rest| rest.split_once('=')) {
        return Some((format!("${number}"), vec![value]));
    }
    if line == "ok" || line.starts_with("error:") {
        return Some(("answer".into(), vec![line]));
    }
    let tabs: Vec<&str> = line.split('\t').collect();
    if tabs.len() > 5 {
        return Some((format!("row {}", tabs[0]), vec![]));
    }
    None
}

/// Whether this is a setting of the drivers of the motors, which the recorded controller has not.
fn is_of_driver(key: &str) -> bool {
    let number = key.trim_start_matches(|letter: char| !letter.is_ascii_digit());
    matches!(
        number.parse(),
        Ok(140..=142 | 150..=152 | 200..=202 | 339 | 450)
    )
}

fn list(wanted: &Part<'_>, got: &Part<'_>, is_changed: bool, found: &mut Vec<String>) {
    let entries = |part: &Part<'_>| -> Vec<(String, Vec<String>)> {
        let all = part.lines.iter().filter_map(|(line, _)| entry(line));
        all.map(|(key, fields)| (key, fields.into_iter().map(String::from).collect()))
            .collect()
    };
    let (wanted_all, got_all) = (entries(wanted), entries(got));
    let mut shared = 0;
    for (key, fields) in &got_all {
        match wanted_all.iter().find(|(other, _)| other == key) {
            // The level of the enable signal depends on the drivers.
            Some(_) if key == "$4" || is_changed && key == "$10" => {}
            Some(_) if wanted.sent.starts_with("$HELP") => shared += 1,
            Some((_, other)) => {
                shared += 1;
                let near = fields.iter().zip(other).all(|(field, other)| {
                    let numbers = (field.parse::<f64>(), other.parse::<f64>());
                    match numbers {
                        (Ok(field), Ok(other)) => (field - other).abs() <= 0.0005,
                        _ => field == other,
                    }
                });
                if !near {
                    found.push(format!(
                        "{:?}: {key} {other:?}, not {fields:?}",
                        wanted.sent
                    ));
                }
            }
            None if wanted.sent.starts_with("$HELP") => {}
            None if cfg!(feature = "drivers") && is_of_driver(key) => {}
            None => found.push(format!("{:?}: {key} is new", wanted.sent)),
        }
    }
    let last = |part: &Part<'_>| part.lines.last().map(|(line, _)| (*line).to_owned());
    if last(wanted) != last(got) {
        found.push(format!(
            "{:?}: {:?}, not {:?}",
            wanted.sent,
            last(wanted),
            last(got)
        ));
    }
    // More than half of what this controller has.
    if wanted_all.len() > 4 && (shared < 4 || got.lines.len() < 6) {
        found.push(format!("{:?}: {shared} lines in common", wanted.sent));
    }
}

/// Fields of a report.
fn fields(line: &str) -> Option<Vec<(&str, &str)>> {
    let inner = line.trim_end().strip_prefix('<')?.strip_suffix('>')?;
    let pairs = inner.split('|');
    Some(
        pairs
            .map(|part| part.split_once(':').unwrap_or((part, "")))
            .collect(),
    )
}

fn is_same(wanted: &str, line: &str, varies: bool, peak: f64) -> bool {
    if wanted == line {
        return true;
    }
    if let (Some(first), Some(second)) = (fields(wanted), fields(line)) {
        let state = first[0].0;
        let moves = matches!(state, "Run" | "Jog" | "Home" | "Hold") || varies;
        // The time of a recording is approximate, so the place of a stop is as well.
        let near = |first: &str, second: &str| {
            if varies {
                return true;
            }
            let parse = |text: &str| -> Option<Vec<i64>> {
                let numbers = text.split(',').map(|mm| mm.parse::<f64>().ok());
                numbers.map(|mm| Some((mm? * 1e6) as i64)).collect()
            };
            match (parse(first), parse(second)) {
                (Some(first), Some(second)) => is_near(&first, &second, peak),
                _ => false,
            }
        };
        return first.len() == second.len()
            && first
                .iter()
                .zip(&second)
                .all(|((name, value), (other, now))| {
                    name == other
                        && match *name {
                            // Sizes of buffers.
                            "Bf" => true,
                            "MPos" | "WPos" if moves => near(value, now),
                            "FS" if moves => true,
                            _ => value == now,
                        }
                });
    }
    let both = |start: &str| wanted.starts_with(start) && line.starts_with(start);
    if both("[PRB:") && varies {
        return true;
    }
    let place = |line: &str| -> Option<(String, Vec<i64>)> {
        let inner = line.trim_end().strip_prefix('[')?.strip_suffix(']')?;
        let (name, values) = inner.split_once(':')?;
        let micrometres = values
            .split(',')
            .map(|mm| Some((mm.parse::<f64>().ok()? * 1e3) as i64));
        Some((name.to_owned(), micrometres.collect::<Option<_>>()?))
    };
    if let (Some((name, first)), Some((other, second))) = (place(wanted), place(line)) {
        // Numbers of 24 bits round differently.
        return name == other && first.iter().zip(&second).all(|(a, b)| (a - b).abs() <= 1);
    }
    let setting = |line: &str| -> Option<(String, f64)> {
        let (number, value) = line.trim_end().strip_prefix('$')?.split_once('=')?;
        Some((number.to_owned(), value.parse().ok()?))
    };
    if let (Some((name, first)), Some((other, second))) = (setting(wanted), setting(line)) {
        return name == other && (first - second).abs() <= 0.0005;
    }
    let both_banners = both("GrblHAL 1.1f [");
    both_banners || both("[SPINDLE:") || wanted == "0 - simulated PWM spindle\r\n"
}
