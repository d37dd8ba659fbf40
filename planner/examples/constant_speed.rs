//! Prints the waits of a line of seven events that takes 1000 ticks.

use husillo_planner::Timer;

fn main() {
    let mut timer = Timer::new(1000, 7, 1);
    for event in 1..=7 {
        println!("event {event}: wait {} ticks", timer.wait(1));
    }
}
