//! Test of a touch that waits with `nb::block!`.
#![cfg(feature = "nb")]

use husillo_probe::{Cycle, Edge, Failure, Input, Plan, Request, UnitVector};

fn touch(wall: i64) -> Result<i64, Failure> {
    let plan = Plan {
        approach: [0; 3],
        direction: UnitVector::X,
        search: 10_000,
        over_travel: 500,
        back_off: 300,
        touches: 2,
        travel_speed: 9_000,
        probing_speed: 1_000,
        slow_speed: 100,
        back_off_speed: 1_000,
        until: Edge::Made,
    };
    let mut cycle = Cycle::new(&plan).unwrap();
    let (mut x, mut target, mut step) = (-2_000_i64, -2_000_i64, 0);
    let measured = nb::block!({
        x += (target - x).clamp(-step, step);
        let input = Input {
            position: [x, 0, 0],
            contact: x >= wall,
            latched: [x.min(wall), 0, 0],
            still: x == target,
        };
        cycle.poll(&input, |request| match request {
            Request::Move {
                target: [to, ..],
                speed,
            } => (target, step) = (to, i64::from(speed) / 100),
            Request::Stop => target = x + step,
            request => panic!("nothing to carry out: {request:?}"),
        })
    })?;
    Ok(measured.touch.position[0])
}

#[test]
fn a_touch_is_measured_or_its_failure_is_named() {
    assert_eq!(touch(4_321), Ok(4_321));
    assert_eq!(touch(20_000), Err(Failure::NoContact));
    assert_eq!(touch(-5_000), Err(Failure::ContactAtStart));
}
