//! `Helix::fill` writes the events of the iterator, however the room and the places are divided.

use husillo_interp::{ArcError, ArcMove, Direction, Helix, Rim, Step};
use proptest::prelude::*;

/// Arcs of any size about centres between the steps, with up to three turns.
fn arcs() -> impl Strategy<Value = ArcMove> {
    let near = |reach: i32| [-reach..=reach, -reach..=reach];
    let radius = prop_oneof![2_i32..12, 12_i32..400, 11_000_i32..12_000];
    (
        radius,
        near(1000),
        0.0..std::f64::consts::TAU,
        0.0..std::f64::consts::TAU,
    )
        .prop_flat_map(move |(radius, middle, first, last)| {
            let bits = prop::sample::select(vec![0_u8, 5, 16]);
            let offset = (0.0..1.0_f64, 0.0..1.0_f64);
            (bits, offset, 0_u32..3, any::<bool>(), -3_i32..4).prop_map(
                move |(bits, offset, turns, is_clockwise, grown)| {
                    let one = f64::from(1_u32 << bits);
                    let centre = [
                        f64::from(middle[0]) + (offset.0 * one).floor() / one,
                        f64::from(middle[1]) + (offset.1 * one).floor() / one,
                    ];
                    let point = |radius: i32, angle: f64| {
                        let (sin, cos) = angle.sin_cos();
                        [
                            centre[0] + f64::from(radius) * cos,
                            centre[1] + f64::from(radius) * sin,
                        ]
                        .map(|at| at.round() as i32)
                    };
                    ArcMove {
                        from: point(radius, first),
                        to: point(radius + if radius > 12 { grown } else { 0 }, last),
                        centre: centre.map(|at| (at * one) as i64),
                        fraction_bits: bits,
                        direction: Direction::from_clockwise(is_clockwise),
                        turns: if radius > 1000 { 0 } else { turns },
                        rim: Rim::Spiral,
                    }
                },
            )
        })
}

/// Takes all events: blocks where there are any, and the iterator where it has to be called.
fn in_blocks(
    mut helix: Helix<4>,
    divisions: &[(usize, u32)],
) -> Result<Vec<([i8; 4], u32)>, TestCaseError> {
    let mut events = Vec::new();
    for (places, room) in divisions.iter().cycle() {
        let Some([axes, negative]) = helix.directions() else {
            match helix.next() {
                Some(step) => events.push((step.deltas(), step.sweep)),
                None => break,
            }
            continue;
        };
        let (mut sweeps, mut deltas) = ([0; 600], [[0; 4]; 600]);
        let run = helix.fill(sweeps.iter_mut().zip(&mut deltas).take(*places), *room);
        let count = run.events as usize;
        prop_assert!(count >= 1 && count <= *places);
        let sum: u64 = sweeps[..count].iter().copied().map(u64::from).sum();
        prop_assert_eq!(run.is_beyond, sum > u64::from(*room));
        prop_assert!(sum - u64::from(sweeps[count - 1]) <= u64::from(*room));
        for axis in 0..4 {
            let made = deltas[..count].iter().map(|delta| i32::from(delta[axis]));
            prop_assert_eq!(
                run.steps[axis],
                made.clone().map(i32::unsigned_abs).sum::<u32>()
            );
            let is_negative = negative >> axis & 1 != 0;
            let has_way = made
                .clone()
                .all(|made| made == 0 || (made < 0) == is_negative);
            prop_assert!(has_way && (axes >> axis & 1 != 0 || made.clone().all(|made| made == 0)));
        }
        events.extend(deltas.into_iter().zip(sweeps).take(count));
    }
    Ok(events)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn blocks_are_the_events_of_the_iterator(
        arc in arcs(),
        along in (prop_oneof![Just(0), -90_i32..90, -3000_i32..3000], -20_i32..20),
        plane in prop::sample::select(vec![[0_usize, 1], [1, 0], [2, 1], [0, 3]]),
        divisions in prop::collection::vec(
            (1_usize..=600, prop_oneof![0_u32..1 << 12, 0_u32..1 << 24, Just(u32::MAX)]),
            1..8,
        ),
    ) {
        let mut others = (0..4).filter(|axis| !plane.contains(axis));
        let mut steps = [0; 4];
        steps[others.next().unwrap()] = along.0;
        steps[others.next().unwrap()] = along.1;
        let helix = match Helix::<4>::new(&arc, plane, steps) {
            Err(ArcError::Degenerate | ArcError::OffRim) => return Ok(()),
            helix => helix.unwrap(),
        };
        let event = |step: Step| (step.deltas(), step.sweep);
        let expected: Vec<([i8; 4], u32)> = helix.clone().map(event).collect();
        prop_assert_eq!(in_blocks(helix, &divisions)?, expected);
    }
}

/// Most events of a circle are in blocks: all but those that run off to the last point.
#[test]
fn a_circle_is_made_of_blocks() {
    let arc = ArcMove {
        from: [300, 0],
        to: [300, 0],
        centre: [0, 0],
        fraction_bits: 0,
        direction: Direction::CounterClockwise,
        turns: 0,
        rim: Rim::Spiral,
    };
    let mut helix = Helix::<3>::new(&arc, [0, 1], [0, 0, 100]).unwrap();
    let (mut blocks, mut single) = (0, 0);
    loop {
        let (mut sweeps, mut deltas) = ([0; 255], [[0; 3]; 255]);
        let run = helix.fill(sweeps.iter_mut().zip(&mut deltas), u32::MAX);
        blocks += run.events;
        if run.events == 0 {
            if helix.next().is_none() {
                break;
            }
            single += 1;
        }
    }
    assert_eq!(blocks + single, helix.events());
    assert!(single <= 2, "{single}");
}

/// A block of more than 255 steps of each axis counts all of them, in the plane and across it.
#[test]
fn long_blocks_count_all_steps() {
    let arc = ArcMove {
        from: [1000, 0],
        to: [0, 1000],
        centre: [0, 0],
        fraction_bits: 0,
        direction: Direction::CounterClockwise,
        turns: 0,
        rim: Rim::Spiral,
    };
    let mut helix = Helix::<3>::new(&arc, [0, 1], [0, 0, 900]).unwrap();
    let (mut sweeps, mut deltas) = (vec![0; 2000], vec![[0_i8; 3]; 2000]);
    let run = helix.fill(sweeps.iter_mut().zip(&mut deltas), u32::MAX);
    assert!(run.events > 1000, "{}", run.events);
    let sum = |axis: usize| {
        deltas
            .iter()
            .map(|delta| u32::from(delta[axis].unsigned_abs()))
            .sum()
    };
    let steps: [u32; 3] = [0, 1, 2].map(sum);
    assert!(steps.iter().all(|steps| *steps > 255), "{steps:?}");
    assert_eq!(run.steps, steps);
}
