//! Touches an edge obliquely with a simulated axis and prints its position.

use husillo_probe::{
    Cycle, Debounce, Edge, Input, Latch, Plan, PreTravel, Request, Tip, UnitVector,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // An edge with its normal turned by atan(3/4), 20 mm from the origin. The probe travels along
    // X.
    let normal = UnitVector::new([-4, 3, 0]).ok_or("no direction")?;
    let edge_nm = -20_000_000;
    let tip = Tip {
        radius_nm: 1_000_000,
        pre_travel: PreTravel::uniform(5_000),
    };
    let mut cycle = Cycle::new(&Plan {
        approach: [10_000_000, 0, 0],
        direction: UnitVector::X,
        search: 30_000_000,
        over_travel: 500_000,
        back_off: 300_000,
        touches: 3,
        travel_speed: 20_000_000,
        probing_speed: 5_000_000,
        slow_speed: 500_000,
        back_off_speed: 5_000_000,
        until: Edge::Made,
    })?;
    let mut latch: Latch<[i64; 3], 8> = Latch::new(Debounce::new(4, false), 0, [0; 3])?;
    let mut latched = [0; 3];
    // 10 000 ticks per second. This axis starts and stops immediately.
    let (mut x, mut target, mut step) = (0_i64, 0_i64, 0_i64);
    let result = loop {
        x += (target - x).clamp(-step, step);
        // The probe switches when it has travelled the pre-travel beyond the touch.
        let ball = [x - 5_000, 0, 0];
        let closed = normal.length_along(ball) - i64::from(tip.radius_nm) <= edge_nm;
        if let Some(edge) = latch.sample(closed, [x, 0, 0]) {
            latched = edge.position;
        }
        let input = Input {
            position: [x, 0, 0],
            contact: latch.level(),
            latched,
            still: x == target,
        };
        match cycle.tick(&input) {
            Request::Move { target: to, speed } => {
                (target, step) = (to[0], i64::from(speed) / 10_000);
            }
            Request::Stop => target = x,
            Request::Wait => {}
            Request::Done(result) => break result,
            Request::Failed(failure) => return Err(failure.into()),
        }
    };
    let touch = result.touch;
    let surface = tip.surface_nm(touch.position, &touch.direction, &normal);
    println!(
        "latched  {:?} nm, spread {} nm",
        touch.position, result.spread
    );
    println!("surface  {surface:?} nm");
    println!(
        "distance {} nm from the origin",
        normal.length_along(surface)
    );
    let wrong = tip.surface_nm(
        touch.position,
        &touch.direction,
        &touch.direction.reversed(),
    );
    println!(
        "with the normal taken along X: {}",
        normal.length_along(wrong)
    );
    Ok(())
}
