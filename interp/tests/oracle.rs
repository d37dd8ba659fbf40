//! Comparison with the recorded lines and arcs, step by step.

use husillo_interp::{Arc, ArcMove, Direction, Line, Rim};
use serde_json::Value;

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("the oracle is JSON")
}

fn list(value: &Value) -> &Vec<Value> {
    value.as_array().expect("a list")
}

fn number(value: &Value) -> i64 {
    value.as_i64().expect("an integer")
}

fn pair(value: &Value) -> [i64; 2] {
    [number(&value[0]), number(&value[1])]
}

fn narrow(value: [i64; 2]) -> [i32; 2] {
    value.map(|entry| entry as i32)
}

fn digit(delta: [i8; 2]) -> char {
    char::from(b'4'.wrapping_add_signed(3 * delta[0] + delta[1]))
}

fn arc_move(record: &Value) -> ArcMove {
    let from = pair(&record["S"]);
    let to = pair(&record["E"]);
    let centre = pair(&record["C"]);
    let bits = number(&record["f"]) as u8;
    let rim = match record["R2"].as_i64() {
        None => Rim::Spiral,
        Some(square) => {
            let residue = |at: [i64; 2]| {
                let [x, y] = [(at[0] << bits) - centre[0], (at[1] << bits) - centre[1]];
                (x * x + y * y - square) >> bits
            };
            Rim::Nominal {
                start: residue(from),
                end: residue(to),
            }
        }
    };
    ArcMove {
        from: narrow(from),
        to: narrow(to),
        centre,
        fraction_bits: bits,
        direction: match record["dir"].as_str() {
            Some("cw") => Direction::Clockwise,
            _ => Direction::CounterClockwise,
        },
        turns: number(&record["turns"]) as u32,
        rim,
    }
}

/// Largest distance outside the band between the two radii, or from the nominal circle.
fn deviation(arc: &ArcMove, record: &Value, points: &[[i64; 2]]) -> f64 {
    let one = f64::from(1_u32 << arc.fraction_bits);
    let radius = |at: [i64; 2]| {
        let x = at[0] as f64 - arc.centre[0] as f64 / one;
        let y = at[1] as f64 - arc.centre[1] as f64 / one;
        x.hypot(y)
    };
    let ends = [arc.from, arc.to].map(|at| radius(at.map(i64::from)));
    let (inner, outer) = match record["R2"].as_f64() {
        Some(square) => (square.sqrt() / one, square.sqrt() / one),
        None => (ends[0].min(ends[1]), ends[0].max(ends[1])),
    };
    points
        .iter()
        .map(|&at| (radius(at) - outer).max(inner - radius(at)))
        .fold(0.0, f64::max)
}

#[test]
fn arcs_step_as_recorded() {
    let oracle = json(include_str!("data/arcs_general.json"));
    let mut count = 0;
    for record in list(&oracle["arcs"]) {
        let arc_move = arc_move(record);
        for arc in [Arc::new(&arc_move), Arc::wide(&arc_move)] {
            let arc = arc.expect("a recorded arc is possible");
            assert_eq!(
                i64::from(arc.events()),
                number(&record["iters"]),
                "{record}"
            );
            assert_eq!(
                arc.quadrants() as i64,
                number(&record["quadrant_changes"]),
                "{record}"
            );
            let mut at = arc_move.from.map(i64::from);
            let mut points = Vec::new();
            let mut steps = String::new();
            for step in arc {
                steps.push(digit(step.deltas()));
                at = [
                    at[0] + i64::from(step.delta(0)),
                    at[1] + i64::from(step.delta(1)),
                ];
                points.push(at);
            }
            assert_eq!(steps, record["steps"].as_str().unwrap(), "{record}");
            assert_eq!(at, arc_move.to.map(i64::from), "{record}");
            let recorded = record["max_dev"].as_f64().unwrap();
            let found = deviation(&arc_move, record, &points);
            // Recorded with five decimals.
            assert!((found - recorded).abs() < 1e-5, "{found} {record}");
        }
        count += 1;
    }
    assert_eq!(count, 169);
}

#[test]
fn plane_lines_step_as_recorded() {
    let oracle = json(include_str!("data/lines.json"));
    assert_eq!(list(&oracle["lines"]).len(), 56);
    for record in list(&oracle["lines"]) {
        let line = Line::new(narrow(pair(&record["d"])));
        assert_eq!(i64::from(line.events()), number(&record["iters"]));
        let steps: String = line.map(|step| digit(step.deltas())).collect();
        assert_eq!(steps, record["steps"].as_str().unwrap(), "{record}");
    }
}

/// A record with fewer axes moves the first ones of six.
#[test]
fn lines_of_many_axes_step_as_recorded() {
    let oracle = json(include_str!("data/lines.json"));
    assert_eq!(list(&oracle["nd"]).len(), 8);
    for record in list(&oracle["nd"]) {
        let mut delta = [0_i32; 6];
        for (delta, value) in delta.iter_mut().zip(list(&record["d"])) {
            *delta = number(value) as i32;
        }
        let axes = list(&record["d"]).len();
        let steps: Vec<String> = Line::new(delta)
            .map(|step| {
                (0..axes)
                    .map(|axis| b"-0+"[(step.delta(axis) + 1) as usize] as char)
                    .collect()
            })
            .collect();
        let recorded: Vec<&str> = list(&record["steps"])
            .iter()
            .filter_map(Value::as_str)
            .collect();
        assert_eq!(steps, recorded, "{record}");
    }
}
