//! Time of the motion of programs on a router, beside the least possible time.
//!
//! `motion FILE...` prints file, lines, seconds and the least seconds of each. `motion write
//! seg|arc|mix` prints a program of 300 kB. `bench/grbl/run motion` compares them with Grbl.

use husillo_bench::{Limits, ROUTER_HZ, Router, router};
use husillo_gcode::Dialect;
use husillo_machine::Event;

/// Length of the generated programs.
const BYTES: usize = 300_000;
/// The limits of the router.
const LIMITS: Limits = Limits {
    mm_per_s: 100.0,
    mm_per_s2: 500.0,
    deviation_mm: 0.01,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [verb, name] = &arguments[..] {
        if verb == "write" {
            print!("{}", generated(name)?);
            return Ok(());
        }
    }
    for file in arguments {
        let program = std::fs::read_to_string(&file)?;
        let (lines, seconds) = (program.lines().count(), seconds(&program)?);
        let least = husillo_bench::least_seconds(&program, Dialect::RS274, &LIMITS)?;
        println!("{file} {lines} {seconds:.1} {least:.1}");
    }
    Ok(())
}

fn generated(name: &str) -> Result<String, &'static str> {
    match name {
        "seg" => Ok(husillo_bench::segments(BYTES)),
        "arc" => Ok(husillo_bench::arcs(BYTES)),
        "mix" => Ok(husillo_bench::mixed(BYTES)),
        _ => Err("programs: seg, arc, mix"),
    }
}

/// The time of all events of a program.
fn seconds(program: &str) -> Result<f64, Box<dyn std::error::Error>> {
    let mut machine = router().ok_or("the scale is 0")?;
    let mut ticks = 0_u64;
    let mut pull = |machine: &mut Router| {
        let event = machine.next_event();
        ticks += match event {
            Some(Event::Step(step)) => step.wait_ticks.into(),
            Some(Event::Dwell { wait_ticks }) => wait_ticks.into(),
            _ => 0,
        };
        event.is_some()
    };
    for line in program.lines() {
        while !machine.has_room() && pull(&mut machine) {}
        machine
            .line(line.as_bytes())
            .map_err(|error| format!("{line}: {error:?}"))?;
    }
    while pull(&mut machine) {}
    Ok(ticks as f64 / f64::from(ROUTER_HZ))
}

#[cfg(test)]
mod tests {
    use super::{LIMITS, seconds};
    use husillo_gcode::Dialect;

    /// The motion takes at most 1.2 % longer than the least time, and no less.
    #[test]
    fn the_time_is_near_the_least() {
        for program in [
            husillo_bench::segments(10_000),
            husillo_bench::arcs(10_000),
            husillo_bench::mixed(10_000),
        ] {
            let least = husillo_bench::least_seconds(&program, Dialect::RS274, &LIMITS).unwrap();
            let ratio = seconds(&program).unwrap() / least;
            assert!((0.9995..1.012).contains(&ratio), "{ratio}");
        }
    }
}
