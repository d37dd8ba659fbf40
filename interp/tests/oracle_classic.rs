//! Comparison with the recorded lines and circles of the classic methods, step by step.

use husillo_interp::{
    Arc, ArcDda, ArcMove, DdaRegisters, DirectSearch, DirectSearchPrinted, Direction, Interpolator,
    LineDda, LineDdaExact, Rim, Staircase, Step, TimedDirectSearch,
};
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

fn pair(value: &Value) -> [i32; 2] {
    [number(&value[0]) as i32, number(&value[1]) as i32]
}

fn digit(step: Step) -> char {
    char::from(b'4'.wrapping_add_signed(3 * step.delta(0) + step.delta(1)))
}

fn about_origin(from: [i32; 2], to: [i32; 2], direction: Direction) -> ArcMove {
    ArcMove {
        from,
        to,
        centre: [0, 0],
        fraction_bits: 0,
        direction,
        turns: 0,
        rim: Rim::Spiral,
    }
}

fn direction(record: &Value) -> Direction {
    match record["dir"].as_str() {
        Some("cw") => Direction::Clockwise,
        Some("ccw") => Direction::CounterClockwise,
        other => panic!("no direction: {other:?}"),
    }
}

/// Makes every method by its name in the records.
fn method(name: &str, arc: &ArcMove) -> Vec<Step> {
    fn all(arc: impl Interpolator + ExactSizeIterator) -> Vec<Step> {
        let events = arc.len();
        let steps: Vec<Step> = arc.collect();
        assert_eq!(steps.len(), events);
        steps
    }
    match name {
        "stair" => all(Staircase::printed(arc).unwrap()),
        "stair_opt" => all(Staircase::new(arc).unwrap()),
        "dda" => all(ArcDda::printed(arc).unwrap()),
        "dsm" => {
            let steps = all(DirectSearchPrinted::new(arc).unwrap());
            // The two tests choose the same steps, and so does the general arc.
            let two_tests = all(DirectSearch::new(arc).unwrap());
            assert_eq!(two_tests, all(Arc::new(arc).unwrap()));
            let sides = |steps: &[Step]| -> Vec<(u8, u8)> {
                let sides = |step: &Step| (step.axes, step.negative);
                steps.iter().map(sides).collect()
            };
            assert_eq!(sides(&steps), sides(&two_tests));
            steps
        }
        _ => panic!("no method {name}"),
    }
}

/// Checks steps, end and extreme values of D = x^2 + y^2 - R^2 against the record.
fn check(record: &Value, arc: &ArcMove, squared: i64, steps: &[Step]) {
    let recorded = record["steps"].as_str().unwrap();
    let found: String = steps.iter().map(|&step| digit(step)).collect();
    assert_eq!(found, recorded, "{record}");
    assert_eq!(steps.len() as i64, number(&record["iters"]));
    if let Some(idle) = record["idle"].as_i64() {
        let found = steps.iter().filter(|step| step.axes == 0).count();
        assert_eq!(found as i64, idle, "{record}");
    }
    let (least, most, end) = extremes(arc.from, squared, steps);
    assert_eq!(end, arc.to, "{record}");
    assert_eq!(least, number(&record["Dmin"]), "{record}");
    assert_eq!(most, number(&record["Dmax"]), "{record}");
}

fn extremes(from: [i32; 2], squared: i64, steps: &[Step]) -> (i64, i64, [i32; 2]) {
    let [mut x, mut y] = from;
    let d = |x: i32, y: i32| i64::from(x) * i64::from(x) + i64::from(y) * i64::from(y) - squared;
    let (mut least, mut most) = (d(x, y), d(x, y));
    for step in steps {
        x += i32::from(step.delta(0));
        y += i32::from(step.delta(1));
        least = least.min(d(x, y));
        most = most.max(d(x, y));
    }
    (least, most, [x, y])
}

#[test]
fn circles_step_as_recorded() {
    let oracle = json(include_str!("data/circles.json"));
    assert_eq!(list(&oracle["circles"]).len(), 304);
    for record in list(&oracle["circles"]) {
        let radius = number(&record["R"]);
        let start = pair(&record["start"]);
        let arc = about_origin(start, start, direction(record));
        let steps = method(record["alg"].as_str().unwrap(), &arc);
        check(record, &arc, radius * radius, &steps);
    }
}

/// The table of the original: radius 30.
#[test]
fn radius_30_takes_240_188_and_168() {
    let oracle = json(include_str!("data/circles.json"));
    let arc = about_origin([0, 30], [0, 30], Direction::Clockwise);
    for (name, events) in [("stair", 240), ("dda", 188), ("dsm", 168)] {
        assert_eq!(number(&oracle["thesis_R30"][name]), events);
        assert_eq!(method(name, &arc).len() as i64, events);
    }
}

/// The other variants of the registers: first quadrant recorded, counts of the whole circle.
#[test]
fn dda_variants_step_as_recorded() {
    let oracle = json(include_str!("data/circles.json"));
    let variants = list(&oracle["dda_variants_R30_first_quadrant"]);
    assert_eq!(variants.len(), 16);
    let arc = about_origin([0, 30], [0, 30], Direction::Clockwise);
    for record in variants {
        let registers = DdaRegisters {
            start: number(&record["Q0"]) as u32,
            is_strict: record["test"] == ">",
            is_sequential: record["order"] == "sequential",
        };
        let steps: Vec<Step> = ArcDda::with_registers(&arc, registers).unwrap().collect();
        let quadrant = record["steps"].as_str().unwrap();
        let first: String = steps
            .iter()
            .take(quadrant.len())
            .copied()
            .map(digit)
            .collect();
        assert_eq!(first, quadrant, "{record}");
        assert_eq!(steps.len() as i64, number(&record["iters"]), "{record}");
        let idle = steps.iter().filter(|step| step.axes == 0).count();
        assert_eq!(idle as i64, number(&record["idle"]), "{record}");
        let (least, most, end) = extremes(arc.from, 900, &steps);
        let recorded = [&record["Dmin"], &record["Dmax"]].map(number);
        assert_eq!(([least, most], end), (recorded, arc.to), "{record}");
    }
}

#[test]
fn arcs_between_lattice_points_step_as_recorded() {
    let oracle = json(include_str!("data/arcs_exact.json"));
    assert_eq!(list(&oracle["arcs"]).len(), 392);
    for record in list(&oracle["arcs"]) {
        let arc = about_origin(
            pair(&record["start"]),
            pair(&record["end"]),
            direction(record),
        );
        let steps = method(record["alg"].as_str().unwrap(), &arc);
        check(record, &arc, number(&record["R2"]), &steps);
    }
}

/// Counts and extreme errors of whole circles, R from 1 to 2000.
#[test]
fn counts_are_as_recorded() {
    let table = include_str!("data/counts_R1_2000.csv");
    let mut lines = table.lines();
    let header = "R,stair_iters,stair_Dmin,stair_Dmax,stairopt_Dmin,stairopt_Dmax,dda_iters,\
                  dda_moving,dda_Dmin,dda_Dmax,dsm_iters,dsm_Dmin,dsm_Dmax,nmin8_iters";
    assert_eq!(lines.next(), Some(header));
    let mut count = 0;
    for line in lines {
        let record: Vec<i64> = line
            .split(',')
            .map(|entry| entry.parse().unwrap())
            .collect();
        let radius = record[0];
        let arc = about_origin([0, radius as i32], [0, radius as i32], Direction::Clockwise);
        let squared = radius * radius;
        let steps = |arc: &mut dyn Iterator<Item = Step>| {
            let steps: Vec<Step> = arc.collect();
            let (least, most, _) = extremes([0, radius as i32], squared, &steps);
            (steps, least, most)
        };
        let (stair, stair_least, stair_most) = steps(&mut Staircase::printed(&arc).unwrap());
        let (best, best_least, best_most) = steps(&mut Staircase::new(&arc).unwrap());
        let (dda, dda_least, dda_most) = steps(&mut ArcDda::printed(&arc).unwrap());
        let (dsm, dsm_least, dsm_most) = steps(&mut DirectSearch::new(&arc).unwrap());
        let moving = dda.iter().filter(|step| step.axes != 0).count();
        // The least s for which a point at the end of an octant is within half a step; four times
        // it is the least count.
        let fewest = (0..).map(|s: i64| [s, (s / 2).pow(2) + (s - s / 2).pow(2)]);
        let near = squared - radius + 1..=squared + radius;
        let fewest = fewest.into_iter().find(|[_, sum]| near.contains(sum));
        let found = [
            radius,
            stair.len() as i64,
            stair_least,
            stair_most,
            best_least,
            best_most,
            dda.len() as i64,
            moving as i64,
            dda_least,
            dda_most,
            dsm.len() as i64,
            dsm_least,
            dsm_most,
            fewest.map_or(0, |[s, _]| 4 * s),
        ];
        assert_eq!(found[..], record[..], "R = {radius}");
        assert_eq!(best.len(), stair.len());
        // The fewest events, or one more per quadrant.
        assert!([0, 4].contains(&(found[10] - found[13])));
        count += 1;
    }
    assert_eq!(count, 2000);
}

#[test]
fn dda_lines_step_as_recorded() {
    let oracle = json(include_str!("data/dda_lines.json"));
    assert_eq!(list(&oracle["lines"]).len(), 96);
    for record in list(&oracle["lines"]) {
        let delta = pair(&record["d"]);
        let steps: Vec<Step> = match record["variant"].as_str() {
            Some("A3_floorL") => LineDda::printed(delta).unwrap().collect(),
            Some("A3_realL") => LineDdaExact::new(delta).unwrap().collect(),
            other => panic!("no variant {other:?}"),
        };
        let found: String = steps.iter().copied().map(digit).collect();
        assert_eq!(found, record["steps"].as_str().unwrap(), "{record}");
        assert_eq!(steps.len() as i64, number(&record["iters"]));
        let idle = steps.iter().filter(|step| step.axes == 0).count();
        assert_eq!(idle as i64, number(&record["idle"]));
    }
}

/// Constant-speed times of whole circles, tick by tick.
#[test]
fn waits_are_as_recorded() {
    let oracle = json(include_str!("data/timing.json"));
    assert_eq!(list(&oracle["cases"]).len(), 5);
    for record in list(&oracle["cases"]) {
        let radius = number(&record["R"]) as i32;
        let arc = about_origin([0, radius], [0, radius], Direction::Clockwise);
        let search = DirectSearch::new(&arc).unwrap();
        // Recorded with `q` fraction bits.
        let factor = (number(&record["k"]) as u64) << (32 - number(&record["q"]));
        let ticks: Vec<i64> = TimedDirectSearch::with_factor(search.clone(), factor)
            .map(|event| event.wait_ticks.into())
            .collect();
        let recorded: Vec<i64> = list(&record["ticks"]).iter().map(number).collect();
        if !recorded.is_empty() {
            assert_eq!(ticks[..recorded.len()], recorded[..], "{record}");
        }
        assert_eq!(ticks.iter().sum::<i64>(), number(&record["total"]));
        // With the factor computed from the ticks per BLU: within a tick.
        let own = TimedDirectSearch::new(search, number(&record["T0"]) as u32);
        let sum: i64 = own.map(|event| i64::from(event.wait_ticks)).sum();
        assert!(
            (sum - number(&record["total"])).abs() <= 1,
            "{sum} {record}"
        );
    }
}
