//! Runs straight moves of three servo axes on independent modules. Prints the documented bounds and
//! the measured deviations.

use husillo_planner::{ServoLine, ServoMotion, ServoProfile};

fn main() {
    // Counts of 2 um, 1953 periods/s: first 20 mm/s and 50 mm/s^2, then slower and faster.
    let lines = [
        ([10_000, 7_000, -300], 335_544, 430),
        ([10_000, 7_000, -300], 16_777, 107),
        ([2_500, -2_500, 1], 335_544, 4_300),
        ([123, 45, 67], 33_554, 430),
    ];
    println!(
        "counts                   periods   deviation (bound), counts   ends apart (bound), periods"
    );
    for (ways, velocity, acceleration) in lines {
        let line = ServoLine::new(ways, velocity, acceleration).expect("there is a way");
        let mut axes = ways.map(|_| ServoProfile::new(0));
        for (index, axis) in axes.iter_mut().enumerate() {
            axis.start(ServoMotion::Trapezoid {
                goal: ways[index],
                velocity: line.velocities[index],
                acceleration: line.accelerations[index],
            });
        }
        let mut worst = 0.0_f64;
        let mut ends = [0; 3];
        let mut periods = 0;
        while axes.iter().any(|axis| !axis.is_done()) {
            periods += 1;
            for (axis, end) in axes.iter_mut().zip(&mut ends) {
                if !axis.is_done() {
                    axis.tick();
                    *end = periods;
                }
            }
            // The first axis is the longest.
            let share = axes[0].position_48() as f64 / f64::from(ways[0]);
            for (axis, way) in axes.iter().zip(ways) {
                let deviation = axis.position_48() as f64 - share * f64::from(way);
                worst = worst.max(deviation.abs() / 65_536.0);
            }
        }
        let apart = ends.iter().max().unwrap_or(&0) - ends.iter().min().unwrap_or(&0);
        let bound = line.deviation() as f64 / 65_536.0;
        println!(
            "{:<24} {periods:>7}   {worst:>8.3} ({bound:.3}) {apart:>23} ({})",
            format!("{ways:?}"),
            line.skew_ticks()
        );
        assert!(worst <= bound && apart <= line.skew_ticks());
    }
}
