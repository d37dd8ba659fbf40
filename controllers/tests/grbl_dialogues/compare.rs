//! Compares a played dialogue with its recording, by the rules of the recordings.

use crate::player::{Deed, Played};
use husillo_transports::grbl::{Message, Position, State, Status};
use serde_json::Value;

/// Distance that a move may be ahead or behind, as a time of motion, s.
const TIME_OF_MOTION_S: f64 = 0.06;

/// Dialogues whose motion is cut short by time.
const CUT_SHORT: &[&str] = &[
    "abort_",
    "jog_cancel",
    "jog_hold_reset",
    "probe_interrupt",
    "control_pins",
    "cadence_busy",
    "homing_reset",
    "homing_door",
    "alarm_lines_lost",
    "jog_queue",
    "jog_door",
    "quirk_",
];

/// Differences of a played dialogue.
pub fn differences(records: &[Value], played: &Played) -> Vec<String> {
    let mut found = Vec::new();
    if let Some(text) = &played.missing {
        found.push(format!("no answer to {text:?}"));
    }
    let name = records[0]["dialogue"].as_str().unwrap();
    let peak = peak(records).max(1.0);
    lines(records, played, peak, &mut found);
    outputs(name, records, played, &mut found);
    motion(name, records, played, &mut found);
    found
}

fn end(records: &[Value]) -> &Value {
    records
        .iter()
        .rfind(|record| !record["end"].is_null())
        .map_or(&Value::Null, |record| &record["end"])
}

/// Highest speed of the recording, mm/s.
pub fn peak(records: &[Value]) -> f64 {
    let rates = end(records)["peak_rate_steps_per_s_over_8_steps"].as_array();
    let rates = rates.into_iter().flatten().filter_map(Value::as_f64);
    rates.fold(0.0, f64::max) / 250.0
}

fn lines(records: &[Value], played: &Played, peak: f64, found: &mut Vec<String>) {
    let mut got: Vec<(u64, &str)> = played
        .deeds
        .iter()
        .filter_map(|(at, deed)| match deed {
            Deed::Line(line) => Some((*at, line.as_str())),
            Deed::Output(..) | Deed::Sent(_) => None,
        })
        .collect();
    let mut is_loose = false;
    let mut next = 0;
    let mut ignored = 0;
    for record in records {
        if let Some(text) = record["send"].as_str() {
            is_loose |= text.contains('!') || text.contains('\u{84}') || text.contains('\u{85}');
            ignored = usize::from(is_accident(text));
            is_loose |= ignored > 0;
        }
        is_loose |= !record["pin"].is_null();
        let Some(wanted) = record["recv"].as_str() else {
            continue;
        };
        is_loose |= wanted.starts_with("ALARM:");
        if ignored > 0 && (wanted == "ok\r\n" || wanted.starts_with("error:")) {
            ignored = 0;
            next += 1;
            continue;
        }
        let Some((_, line)) = got.get(next).copied() else {
            found.push(format!("{} ms: missing {wanted:?}", record["t_ms"]));
            return;
        };
        let varies = record["varies"] == true;
        let is_same = |line: &str| is_same(wanted, line, [varies || is_loose, varies], peak);
        if is_same(line) {
            next += 1;
            continue;
        }
        // A report and an answer of the same moment may change places.
        let other = got.get(next + 1).copied();
        if other.is_some_and(|(_, other)| {
            is_same(other) && (other.starts_with('<') || line.starts_with('<'))
        }) {
            got.swap(next, next + 1);
            next += 1;
            continue;
        }
        found.push(format!("{} ms: {wanted:?}, not {line:?}", record["t_ms"]));
        if found.len() > 12 {
            return;
        }
        next += 1;
    }
    for (at, line) in got.iter().skip(next).take(5) {
        found.push(format!("{} ms: superfluous {line:?}", at / 1000));
    }
}

/// Lines whose effect is an accident of the firmware: 8-bit numbers that wrap.
fn is_accident(text: &str) -> bool {
    matches!(
        text,
        "$0=256\n" | "$0=259\n" | "$10=256\n" | "$1=256\n" | "$1=300\n" | "$1.5=30\n"
    )
}

fn is_same(wanted: &str, line: &str, [is_loose, varies]: [bool; 2], peak: f64) -> bool {
    if wanted == line {
        return true;
    }
    let [first, second] = [wanted, line].map(|line| Message::parse(line.trim_end().as_bytes()));
    match (first, second) {
        (Some(Message::Banner(_)), Some(Message::Banner(_)))
        | (Some(Message::Version(..)), Some(Message::Version(..)))
        | (Some(Message::Options(..)), Some(Message::Options(..))) => true,
        (Some(Message::Setting(0 | 1 | 10, _)), Some(Message::Setting(0 | 1 | 10, _))) => is_loose,
        (Some(Message::Status(first)), Some(Message::Status(second))) => {
            is_same_status(&first, &second, [is_loose, varies], peak)
        }
        (Some(Message::Probe(first, _)), Some(Message::Probe(second, _))) => {
            is_loose && is_near(first.nm(), second.nm(), peak)
        }
        _ => false,
    }
}

pub fn is_near(first: &[i64], second: &[i64], peak: f64) -> bool {
    let most = peak * TIME_OF_MOTION_S * 1e6 + 4000.0;
    let mut pairs = first.iter().zip(second);
    first.len() == second.len()
        && pairs.all(|(first, second)| (first - second).abs() as f64 <= most)
}

fn is_same_status(
    first: &Status,
    second: &Status,
    [is_loose, varies]: [bool; 2],
    peak: f64,
) -> bool {
    let moves = matches!(
        first.state,
        State::Run | State::Jog | State::Hold(_) | State::Door(_) | State::Home
    );
    let place = |status: &Status| match status.position {
        Position::Machine(place) | Position::Work(place) => place,
    };
    let kind = |status: &Status| matches!(status.position, Position::Machine(_));
    let is_placed = if moves || is_loose {
        is_near(place(first).nm(), place(second).nm(), peak)
    } else {
        place(first) == place(second)
    };
    let is_fast = moves || is_loose || first.feed_nm_per_min == second.feed_nm_per_min;
    let fills = |status: &Status| status.free.is_some();
    let is_full = if moves || is_loose {
        fills(first) == fills(second)
    } else {
        first.free == second.free
    };
    let lines = moves || is_loose || first.line == second.line;
    // The end of a motion may lie before or after the report.
    let ends = |status: &Status| matches!(status.state, State::Idle | State::Run | State::Jog);
    let is_state = first.state == second.state || varies && ends(first) && ends(second);
    is_state
        && kind(first) == kind(second)
        && is_placed
        && is_fast
        && is_full
        && lines
        && (first.rpm == second.rpm || moves && first.rpm.abs_diff(second.rpm) < 400)
        && first.pins == second.pins
        && first.work_zero == second.work_zero
        && first.overrides == second.overrides
        && first.accessories == second.accessories
}

fn outputs(name: &str, records: &[Value], played: &Played, found: &mut Vec<String>) {
    for output in ["spindle_dir", "spindle_pwm", "flood", "mist"] {
        if name.starts_with("laser") && output == "spindle_pwm" {
            continue;
        }
        // The spindle stops for a moment where its range is set while it runs.
        let mut is_skipped = false;
        let wanted: Vec<i64> = records
            .iter()
            .filter(|record| {
                if let Some(text) = record["send"].as_str() {
                    is_skipped = sets_range(text);
                }
                record["out"] == output && !is_skipped
            })
            .filter_map(|record| record["level"].as_i64().or(record["duty"].as_i64()))
            .collect();
        let mut is_skipped = false;
        let got: Vec<i64> = played
            .deeds
            .iter()
            .filter_map(|(_, deed)| match deed {
                Deed::Sent(text) => {
                    is_skipped = sets_range(text);
                    None
                }
                Deed::Output(name, level) if *name == output && !is_skipped => Some(*level),
                _ => None,
            })
            .collect();
        if wanted != got {
            found.push(format!("{output}: {wanted:?}, not {got:?}"));
        }
    }
}

fn sets_range(text: &str) -> bool {
    text.starts_with("$30=") || text.starts_with("$31=")
}

fn motion(name: &str, records: &[Value], played: &Played, found: &mut Vec<String>) {
    let end = end(records);
    let varies = records.iter().any(|record| record["varies"] == true);
    if CUT_SHORT.iter().any(|start| name.starts_with(start)) {
        return;
    }
    let axes = |key: &str| -> Vec<i64> {
        let values = end[key].as_array().into_iter().flatten();
        values.filter_map(Value::as_i64).collect()
    };
    let net = axes("net_steps");
    if net != played.net {
        found.push(format!("net steps {net:?}, not {:?}", played.net));
    }
    let pulses = axes("pulses");
    let got: Vec<i64> = played.pulses.iter().map(|count| *count as i64).collect();
    if pulses != got && !varies && !name.contains("arc") {
        found.push(format!("pulses {pulses:?}, not {got:?}"));
    }
    if records[0]["class"] != "timing" {
        return;
    }
    if let (Some(first), Some(last)) = (end["first_step_ms"].as_f64(), end["last_step_ms"].as_f64())
    {
        let [begin, stop] = played.steps_us.unwrap_or_default();
        let (wanted, got) = (last - first, (stop - begin) as f64 / 1000.0);
        if (wanted - got).abs() > (wanted * 0.03).max(20.0) {
            found.push(format!("{wanted:.0} ms of motion, not {got:.0} ms"));
        }
    }
    for (axis, wanted) in axes("peak_rate_steps_per_s_over_8_steps")
        .iter()
        .enumerate()
    {
        let (wanted, got) = (*wanted as f64, played.peak[axis]);
        if (wanted - got).abs() > wanted * 0.03 {
            found.push(format!(
                "axis {axis}: peak {wanted:.0} steps/s, not {got:.0}"
            ));
        }
    }
}
