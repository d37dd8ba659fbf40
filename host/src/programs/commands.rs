//! `husillo commands`: the commands a program means, one a line.

use crate::diagnostics::Findings;
use crate::geometry::path::Path;
use crate::programs::program::{self, Start};
use crate::programs::source::Source;
use husillo_gcode::{Command, Direction, Feed, Nm, Plane, Side, SpindleDirection};
use std::io::{self, Write};

/// Prints the commands of a program.
///
/// # Errors
///
/// Reading or writing fails.
pub fn print(
    source: &mut Source,
    file: &str,
    start: Start,
    json: bool,
    findings: &mut Findings,
    out: &mut impl Write,
) -> io::Result<()> {
    let mut line = Vec::with_capacity(512);
    program::walk(
        source,
        file,
        start,
        findings,
        |meaning, command, from, _| {
            if json {
                line.clear();
                if object(&mut line, meaning.at.line, command, from) {
                    out.write_all(&line)?;
                }
                Ok(())
            } else {
                writeln!(out, "{:>6}  {command}", meaning.at.line)
            }
        },
    )?;
    Ok(())
}

/// Writes one JSON object and its newline; `false` for a command that is only a mode.
fn object(out: &mut Vec<u8>, line: usize, command: &Command<3>, from: [Nm; 3]) -> bool {
    let start = |out: &mut Vec<u8>, kind: &str| {
        out.extend_from_slice(b"{\"line\":");
        integer(out, line as i64);
        out.extend_from_slice(b",\"kind\":\"");
        out.extend_from_slice(kind.as_bytes());
        out.push(b'"');
    };
    match command {
        Command::Rapid { to } => {
            start(out, "rapid");
            point(out, "to_nm", to);
        }
        Command::Linear { to, feed } => {
            start(out, "linear");
            point(out, "to_nm", to);
            path_feed(out, feed, command, from);
        }
        Command::Arc { arc, feed } => {
            start(out, "arc");
            point(out, "to_nm", &arc.to);
            point(out, "centre_nm", &arc.centre);
            let plane = match arc.plane {
                Plane::Xy => "xy",
                Plane::Zx => "zx",
                Plane::Yz => "yz",
            };
            text(out, "plane", plane);
            let clockwise = arc.direction == Direction::Clockwise;
            text(out, "direction", if clockwise { "cw" } else { "ccw" });
            number(out, "turns", i64::from(arc.turns));
            path_feed(out, feed, command, from);
        }
        Command::Dwell { micros } => {
            start(out, "dwell");
            number(out, "micros", i64::try_from(*micros).unwrap_or(i64::MAX));
        }
        Command::Spindle {
            direction,
            milli_rpm,
        } => {
            start(out, "spindle");
            let name = match direction {
                SpindleDirection::Off => "off",
                SpindleDirection::Clockwise => "cw",
                SpindleDirection::CounterClockwise => "ccw",
            };
            text(out, "direction", name);
            // Thousandths of a turn, exact.
            let rpm = format!(",\"rpm\":{}.{:03}", milli_rpm / 1000, milli_rpm % 1000);
            out.extend_from_slice(rpm.trim_end_matches('0').trim_end_matches('.').as_bytes());
        }
        Command::Coolant { mist, flood } => {
            start(out, "coolant");
            flag(out, "mist", *mist);
            flag(out, "flood", *flood);
        }
        Command::Tool { number: tool } => {
            start(out, "tool");
            number(out, "number", i64::from(*tool));
        }
        Command::Stop { optional } => {
            start(out, "stop");
            flag(out, "optional", *optional);
        }
        Command::End { rewind } => {
            start(out, "end");
            flag(out, "rewind", *rewind);
        }
        Command::Spline { spline, feed } => {
            start(out, "spline");
            point(out, "to_nm", &spline.to);
            key(out, "points_nm");
            for (place, [x, y]) in spline.points.iter().enumerate() {
                out.extend_from_slice(if place == 0 { b"[[" } else { b",[" });
                integer(out, x.0);
                out.push(b',');
                integer(out, y.0);
                out.push(b']');
            }
            out.push(b']');
            path_feed(out, feed, command, from);
        }
        Command::Thread { to, lead } => {
            start(out, "thread");
            point(out, "to_nm", to);
            number(out, "lead_nm", lead.0);
        }
        Command::Probe {
            to,
            feed,
            away,
            must,
        } => {
            start(out, "probe");
            point(out, "to_nm", to);
            flag(out, "away", *away);
            flag(out, "must", *must);
            path_feed(out, feed, command, from);
        }
        Command::ToolIs { number: tool } => {
            start(out, "tool_is");
            number(out, "number", i64::from(*tool));
        }
        Command::ToolLength {
            number: tool,
            offset,
        } => {
            start(out, "tool_length");
            number(out, "number", i64::from(*tool));
            point(out, "offset_nm", offset);
        }
        Command::Compensation {
            side,
            radius,
            plane,
        } => {
            start(out, "compensation");
            let side = match side {
                None => "off",
                Some(Side::Left) => "left",
                Some(Side::Right) => "right",
            };
            text(out, "side", side);
            text(out, "plane", plane.name());
            number(out, "radius_nm", radius.0);
        }
        Command::Drill => start(out, "drill"),
        Command::Surface { .. }
        | Command::Orient { .. }
        | Command::Switch { .. }
        | Command::Output { .. }
        | Command::Analog { .. }
        | Command::Wait { .. }
        | Command::Pallet => {
            start(out, "other");
            text(out, "text", &command.to_string());
        }
        _ => return false,
    }
    out.extend_from_slice(b"}\n");
    true
}

fn key(out: &mut Vec<u8>, name: &str) {
    out.extend_from_slice(b",\"");
    out.extend_from_slice(name.as_bytes());
    out.extend_from_slice(b"\":");
}

fn integer(out: &mut Vec<u8>, value: i64) {
    out.extend_from_slice(itoa::Buffer::new().format(value).as_bytes());
}

fn number(out: &mut Vec<u8>, name: &str, value: i64) {
    key(out, name);
    integer(out, value);
}

fn text(out: &mut Vec<u8>, name: &str, value: &str) {
    key(out, name);
    out.push(b'"');
    out.extend_from_slice(value.as_bytes());
    out.push(b'"');
}

fn flag(out: &mut Vec<u8>, name: &str, value: bool) {
    key(out, name);
    out.extend_from_slice(if value { b"true" } else { b"false" });
}

fn point(out: &mut Vec<u8>, name: &str, at: &[Nm; 3]) {
    key(out, name);
    for (axis, nm) in at.iter().enumerate() {
        out.push(if axis == 0 { b'[' } else { b',' });
        integer(out, nm.0);
    }
    out.push(b']');
}

/// The feed along the path; under inverse time it follows from the length of the move.
fn path_feed(out: &mut Vec<u8>, feed: &Feed, command: &Command<3>, from: [Nm; 3]) {
    let nm_per_min = match *feed {
        Feed::PerMinute(rate) => rate.0,
        Feed::InverseTime { micro_per_minute } => {
            let length = Path::programmed(from, command, 0.0).map_or(0.0, |path| path.length());
            (length * micro_per_minute as f64 / 1e6).round() as i64
        }
        Feed::PerRevolution(rate) => return number(out, "feed_nm_per_rev", rate.0),
    };
    number(out, "feed_nm_per_min", nm_per_min);
}
