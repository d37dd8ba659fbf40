//! From a contact to a point. An event is a sample of debounce or latch, a tick of a cycle, or a
//! point.

use core::hint::black_box;

use husillo_probe::{
    Cycle, Debounce, Edge, Input, Latch, Plan, PreTravel, Request, Tip, UnitVector,
};

use crate::Count;

const EVENTS: u32 = 1000;

#[inline(never)]
pub fn all(count: Count<'_>) {
    // The contact bounces at every fourth sample, so that runs begin and are interrupted.
    let pin = |sample: u32| black_box(sample & 3 == 0);
    count("debounce_sample", EVENTS, &mut || {
        let mut contact = black_box(Debounce::new(4, false));
        for sample in 0..EVENTS {
            black_box(contact.sample(pin(sample)));
        }
    });
    count("latch_sample_1_axis", EVENTS, &mut || {
        let contact = Debounce::new(4, false);
        let Ok(mut latch) = black_box(Latch::<[i32; 1], 16>::new(contact, 2, [0])) else {
            return;
        };
        for sample in 0..EVENTS {
            black_box(latch.sample(pin(sample), black_box([7])).is_some());
        }
    });
    count("latch_sample_3_axes", EVENTS, &mut || {
        let contact = Debounce::new(4, false);
        let Ok(mut latch) = black_box(Latch::<[i32; 3], 16>::new(contact, 2, [0; 3])) else {
            return;
        };
        for sample in 0..EVENTS {
            black_box(latch.sample(pin(sample), black_box([7, 8, 9])).is_some());
        }
    });
    let plan = Plan {
        approach: [0; 3],
        direction: UnitVector::X,
        search: 1_000_000,
        over_travel: 100_000,
        back_off: 10_000,
        touches: 3,
        travel_speed: 1000,
        probing_speed: 100,
        slow_speed: 10,
        back_off_speed: 100,
        until: Edge::Made,
    };
    count("cycle_tick_searching", EVENTS, &mut || {
        let Ok(mut cycle) = black_box(Cycle::new(&plan)) else {
            return;
        };
        let mut input = Input {
            position: [5, 6, 7],
            contact: false,
            latched: [0; 3],
            still: true,
        };
        // The move to the approach point, and the start of the search.
        cycle.tick(black_box(&input));
        cycle.tick(black_box(&input));
        input.still = false;
        for _ in 0..EVENTS {
            black_box(cycle.tick(black_box(&input)) == Request::Wait);
        }
    });
    count("compensate_6_directions", EVENTS, &mut || {
        let axes = [UnitVector::X, UnitVector::Y, UnitVector::Z];
        let [x, y, z] = axes.map(|axis| (axis, 4_000));
        let [left, back, down] = axes.map(|axis| (axis.reversed(), 6_000));
        let tip = black_box(Tip {
            radius_nm: 1_000_000,
            pre_travel: PreTravel::new([x, y, z, left, back, down]),
        });
        let Some(travel) = UnitVector::new([1, 2, -2]) else {
            return;
        };
        for _ in 0..EVENTS {
            black_box(tip.surface_nm(black_box([1, 2, 3]), black_box(&travel), &travel.reversed()));
        }
    });
}
