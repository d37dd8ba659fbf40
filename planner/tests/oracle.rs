//! Comparison with the recorded waits of five circles.

use husillo_planner::Timer;
use serde_json::Value;

/// Sweeps |P x d| of one quadrant of the nearest-point circle from (0, r), clockwise. By brute
/// force: each step takes the neighbour with the least |x^2 + y^2 - r^2|.
fn quadrant_sweeps(radius: i64) -> Vec<u32> {
    let (mut x, mut y) = (0_i64, radius);
    let mut sweeps = Vec::new();
    while y > 0 {
        let distance = |(dx, dy): &(i64, i64)| {
            ((x + dx) * (x + dx) + (y + dy) * (y + dy) - radius * radius).abs()
        };
        let (dx, dy) = [(1, 0), (1, -1), (0, -1)]
            .into_iter()
            .min_by_key(distance)
            .unwrap();
        sweeps.push((x * dy - y * dx).unsigned_abs() as u32);
        (x, y) = (x + dx, y + dy);
    }
    sweeps
}

#[test]
fn circles_wait_as_recorded() {
    let oracle: Value = serde_json::from_str(include_str!("data/timing.json")).unwrap();
    let cases = oracle["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 5);
    for case in cases {
        let value = |key: &str| case[key].as_u64().unwrap();
        let mut timer = Timer::with_fraction_bits(value("T0"), value("R"), value("q") as u8);
        assert_eq!(timer.rate(), value("k"));
        let sweeps = quadrant_sweeps(value("R") as i64).repeat(4);
        let ticks: Vec<u64> = sweeps.into_iter().map(|sweep| timer.wait(sweep)).collect();
        let recorded: Vec<u64> = case["ticks"]
            .as_array()
            .unwrap()
            .iter()
            .filter_map(Value::as_u64)
            .collect();
        assert_eq!(ticks, recorded, "R = {}", case["R"]);
        assert_eq!(ticks.iter().sum::<u64>(), value("total"));
    }
}
