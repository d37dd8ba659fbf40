//! A command as a JSON object.

use crate::programs::check::fed_length;
use crate::text::json::decimal;
use husillo_gcode::{
    Axes, Command, Direction, Feed, HeatWait, Heater, Nm, Plane, Side, SpindleDirection,
};
use husillo_sim::observers::AXES;
use serde::Serialize;
use serde_json::value::RawValue;

/// A command with its line number.
#[derive(Serialize)]
pub struct Line {
    line: usize,
    #[serde(flatten)]
    object: Object,
}

/// The content of a command; lengths and positions in nm.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Object {
    Rapid {
        to_nm: Vec<i64>,
    },
    Linear {
        to_nm: Vec<i64>,
        #[serde(flatten)]
        feed: PathFeed,
    },
    Arc {
        to_nm: Vec<i64>,
        centre_nm: Vec<i64>,
        plane: &'static str,
        direction: &'static str,
        turns: u32,
        #[serde(flatten)]
        feed: PathFeed,
    },
    Dwell {
        micros: u64,
    },
    Spindle {
        direction: &'static str,
        rpm: Box<RawValue>,
    },
    Coolant {
        mist: bool,
        flood: bool,
    },
    Tool {
        number: u32,
    },
    Stop {
        optional: bool,
    },
    End {
        rewind: bool,
    },
    Spline {
        to_nm: Vec<i64>,
        points_nm: Vec<[i64; 2]>,
        #[serde(flatten)]
        feed: PathFeed,
    },
    NurbsBegin {
        order: u8,
        micro_weight: u64,
        #[serde(flatten)]
        feed: PathFeed,
    },
    NurbsPoint {
        at_nm: [i64; 2],
        micro_weight: u64,
    },
    NurbsEnd {
        to_nm: Vec<i64>,
    },
    Thread {
        to_nm: Vec<i64>,
        lead_nm: i64,
    },
    Tap {
        bottom_nm: Vec<i64>,
        to_nm: Vec<i64>,
        lead_nm: i64,
    },
    Probe {
        to_nm: Vec<i64>,
        away: bool,
        must: bool,
        #[serde(flatten)]
        feed: PathFeed,
    },
    ToolIs {
        number: u32,
    },
    ToolLength {
        number: u32,
        offset_nm: Vec<i64>,
    },
    Compensation {
        side: &'static str,
        plane: &'static str,
        radius_nm: i64,
    },
    Heat {
        heater: String,
        celsius: Box<RawValue>,
        wait: &'static str,
    },
    Fan {
        number: u8,
        per_mille: u16,
    },
    MotorsOff,
    Drill,
    Other {
        text: String,
    },
}

/// The feed along a path.
#[derive(Serialize)]
enum PathFeed {
    #[serde(rename = "feed_nm_per_min")]
    PerMinute(i64),
    #[serde(rename = "feed_nm_per_rev")]
    PerRevolution(i64),
}

impl Line {
    /// The object of a command that begins at `from`. `None` for a command that only sets a mode.
    pub fn new(
        line: usize,
        command: &Command<AXES>,
        from: [Nm; AXES],
        axes: &Axes,
    ) -> Option<Self> {
        let object = motion(command, from, axes).or_else(|| tool(command, axes));
        Some(Self {
            line,
            object: object.or_else(|| other(command))?,
        })
    }
}

fn nm<const N: usize>(at: [Nm; N]) -> [i64; N] {
    at.map(|Nm(nm)| nm)
}

/// The coordinates of the axes that the machine has.
fn of_axes(at: [Nm; AXES], axes: &Axes) -> Vec<i64> {
    at.into_iter().take(axes.len()).map(|Nm(nm)| nm).collect()
}

/// The object of a command that moves.
fn motion(command: &Command<AXES>, from: [Nm; AXES], axes: &Axes) -> Option<Object> {
    let nm = |at: [Nm; AXES]| of_axes(at, axes);
    let along = |feed: &Feed| path_feed(feed, command, from, axes);
    Some(match command {
        Command::Rapid { to } => Object::Rapid { to_nm: nm(*to) },
        Command::Linear { to, feed } => Object::Linear {
            to_nm: nm(*to),
            feed: along(feed),
        },
        Command::Arc { arc, feed } => Object::Arc {
            to_nm: nm(arc.to),
            centre_nm: nm(arc.centre),
            plane: match arc.plane {
                Plane::Xy => "xy",
                Plane::Zx => "zx",
                Plane::Yz => "yz",
            },
            direction: match arc.direction {
                Direction::Clockwise => "cw",
                Direction::CounterClockwise => "ccw",
            },
            turns: arc.turns,
            feed: along(feed),
        },
        Command::Spline { spline, feed } => Object::Spline {
            to_nm: nm(spline.to),
            points_nm: spline.points.iter().map(|at| self::nm(*at)).collect(),
            feed: along(feed),
        },
        Command::NurbsBegin {
            order,
            micro_weight,
            feed,
        } => Object::NurbsBegin {
            order: *order,
            micro_weight: *micro_weight,
            feed: along(feed),
        },
        Command::NurbsPoint { at, micro_weight } => Object::NurbsPoint {
            at_nm: self::nm(*at),
            micro_weight: *micro_weight,
        },
        Command::NurbsEnd { to } => Object::NurbsEnd { to_nm: nm(*to) },
        Command::Thread { to, lead } => Object::Thread {
            to_nm: nm(*to),
            lead_nm: lead.0,
        },
        Command::Tap { bottom, to, lead } => Object::Tap {
            bottom_nm: nm(*bottom),
            to_nm: nm(*to),
            lead_nm: lead.0,
        },
        Command::Probe {
            to,
            feed,
            away,
            must,
        } => Object::Probe {
            to_nm: nm(*to),
            away: *away,
            must: *must,
            feed: along(feed),
        },
        _ => return None,
    })
}

/// The object of a command about the tool.
fn tool(command: &Command<AXES>, axes: &Axes) -> Option<Object> {
    Some(match command {
        Command::Tool { number } => Object::Tool { number: *number },
        Command::ToolIs { number } => Object::ToolIs { number: *number },
        Command::ToolLength { number, offset } => Object::ToolLength {
            number: *number,
            offset_nm: of_axes(*offset, axes),
        },
        Command::Compensation {
            side,
            radius,
            plane,
        } => Object::Compensation {
            side: match side {
                None => "off",
                Some(Side::Left) => "left",
                Some(Side::Right) => "right",
            },
            plane: plane.name(),
            radius_nm: radius.0,
        },
        _ => return None,
    })
}

/// The object of a command that neither moves nor is about the tool.
fn other(command: &Command<AXES>) -> Option<Object> {
    Some(match command {
        Command::Dwell { micros } => Object::Dwell { micros: *micros },
        Command::Spindle {
            direction,
            milli_rpm,
        } => Object::Spindle {
            direction: match direction {
                SpindleDirection::Off => "off",
                SpindleDirection::Clockwise => "cw",
                SpindleDirection::CounterClockwise => "ccw",
            },
            rpm: decimal(thousandths(*milli_rpm)),
        },
        Command::Coolant { mist, flood } => Object::Coolant {
            mist: *mist,
            flood: *flood,
        },
        Command::Stop { optional } => Object::Stop {
            optional: *optional,
        },
        Command::End { rewind } => Object::End { rewind: *rewind },
        Command::Heat {
            heater,
            milli_celsius,
            wait,
        } => Object::Heat {
            heater: match heater {
                Heater::Extruder(number) => format!("extruder {number}"),
                Heater::Bed => "bed".to_owned(),
                Heater::Chamber => "chamber".to_owned(),
            },
            celsius: decimal(thousandths((*milli_celsius).into())),
            wait: match wait {
                HeatWait::None => "none",
                HeatWait::Heated => "heated",
                HeatWait::Reached => "reached",
            },
        },
        Command::Fan { number, per_mille } => Object::Fan {
            number: *number,
            per_mille: *per_mille,
        },
        Command::MotorsOff => Object::MotorsOff,
        Command::Drill => Object::Drill,
        Command::Surface { .. }
        | Command::Orient { .. }
        | Command::Switch { .. }
        | Command::Output { .. }
        | Command::Analog { .. }
        | Command::Wait { .. }
        | Command::Pallet => Object::Other {
            text: command.to_string(),
        },
        _ => return None,
    })
}

/// Thousandths as a decimal number without trailing zeros.
fn thousandths(value: u64) -> String {
    let digits = format!("{}.{:03}", value / 1000, value % 1000);
    digits
        .trim_end_matches('0')
        .trim_end_matches('.')
        .to_owned()
}

/// The feed along the path. An inverse-time feed is converted with the length of the move.
fn path_feed(feed: &Feed, command: &Command<AXES>, from: [Nm; AXES], axes: &Axes) -> PathFeed {
    match *feed {
        Feed::PerMinute(rate) => PathFeed::PerMinute(rate.0),
        Feed::InverseTime { micro_per_minute } => {
            let length = fed_length(command, from, axes);
            PathFeed::PerMinute((length * micro_per_minute as f64 / 1e6).round() as i64)
        }
        Feed::PerRevolution(rate) => PathFeed::PerRevolution(rate.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn json(command: &Command<AXES>) -> String {
        let line = Line::new(7, command, [Nm(0); AXES], &Axes::XYZ);
        line.map_or(String::new(), |line| serde_json::to_string(&line).unwrap())
    }

    #[test]
    fn the_line_comes_first_then_the_kind() {
        let to = [Nm(1), Nm(-2), Nm(3), Nm(0), Nm(0), Nm(0)];
        let feed = Feed::PerMinute(Nm(40));
        let linear = "{\"line\":7,\"kind\":\"linear\",\"to_nm\":[1,-2,3],\"feed_nm_per_min\":40}";
        assert_eq!(json(&Command::Linear { to, feed }), linear);
        assert_eq!(json(&Command::Drill), "{\"line\":7,\"kind\":\"drill\"}");
    }

    #[test]
    fn spindle_speeds_are_exact() {
        for (milli_rpm, rpm) in [(0, "0"), (600_000, "600"), (1_001, "1.001"), (2_500, "2.5")] {
            let spindle = Command::Spindle {
                direction: SpindleDirection::Clockwise,
                milli_rpm,
            };
            let expected = "{\"line\":7,\"kind\":\"spindle\",\"direction\":\"cw\",\"rpm\":";
            assert_eq!(json(&spindle), format!("{expected}{rpm}}}"));
        }
    }
}
