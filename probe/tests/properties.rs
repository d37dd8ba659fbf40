//! Properties for every contact, direction, axis and point.

use husillo_probe::{
    Circle, Cycle, Debounce, Edge, Failure, Input, Latch, Plan, Plane, PreTravel, Repeatability,
    Request, Sphere, Tip, UnitVector,
};
use proptest::prelude::*;

fn vector(most: i64) -> impl Strategy<Value = [i64; 3]> {
    [-most..=most, -most..=most, -most..=most]
}

fn direction() -> impl Strategy<Value = UnitVector> {
    vector(1 << 31).prop_filter_map("zero", UnitVector::new)
}

/// Components of a direction in 2^-30.
fn bits(direction: &UnitVector) -> [f64; 3] {
    direction.components().map(|c| f64::from(c.to_bits()))
}

proptest! {
    /// Edges alternate. An edge is reported exactly where a run of equal samples is complete.
    #[test]
    fn debounce_reports_runs(
        samples in 1_u8..9,
        pin in proptest::collection::vec(any::<bool>(), 0..300),
    ) {
        let mut contact = Debounce::new(samples, false);
        let mut level = false;
        for (index, &closed) in pin.iter().enumerate() {
            let run = pin[..=index].iter().rev().take_while(|&&c| c == closed).count();
            let edge = contact.sample(closed);
            prop_assert_eq!(edge.is_some(), closed != level && run >= usize::from(samples));
            if let Some(edge) = edge {
                prop_assert_eq!(edge.level(), closed);
                level = closed;
            }
            prop_assert_eq!(contact.level(), level);
        }
    }

    /// The latched position is that of the first sample of the run, minus the look-back, for every
    /// debounce that fits.
    #[test]
    fn latch_looks_back(
        samples in 1_u8..20,
        look_back in 0_u8..20,
        pin in proptest::collection::vec(any::<bool>(), 0..300),
    ) {
        let contact = Debounce::new(samples, false);
        let Ok(mut latch) = Latch::<i64, 24>::new(contact, look_back, 0) else {
            prop_assert!(usize::from(samples) + usize::from(look_back) > 24);
            return Ok(());
        };
        for (index, &closed) in (0_i64..).zip(&pin) {
            if let Some(latched) = latch.sample(closed, index) {
                let then = index - i64::from(samples) + 1 - i64::from(look_back);
                prop_assert_eq!(latched.position, then.max(0));
            }
        }
    }

    /// Components are within the documented bound: 0.63 x 2^-30 for integers below 2^31, 2 x 2^-30
    /// for any.
    #[test]
    fn unit_vectors_keep_their_bound(
        v in vector(1 << 31),
        large in vector(i64::MAX),
        shrink in 0_u32..31,
    ) {
        for (vector, bound) in [(v.map(|c| c >> shrink), 0.63), (large, 2.0)] {
            let Some(unit) = UnitVector::new(vector) else {
                prop_assert_eq!(vector, [0; 3]);
                continue;
            };
            let floats = vector.map(|c| c as f64);
            let length = floats.iter().map(|c| c * c).sum::<f64>().sqrt();
            for (found, component) in bits(&unit).into_iter().zip(floats) {
                let error = found - component / length * f64::from(1 << 30);
                prop_assert!(error.abs() <= bound, "{:?}: {}", vector, error);
            }
            prop_assert_eq!(UnitVector::new(vector.map(|c| -c)), Some(unit.reversed()));
        }
    }

    /// Compensation is within 1 nm of M = p - ed d - r n, and its inverse returns the same
    /// position.
    #[test]
    fn compensation_is_the_formula(
        p in vector(1 << 40), d in direction(), n in direction(),
        radius_nm in -10_000_000..10_000_000, nm in -100_000..100_000,
    ) {
        let tip = Tip { radius_nm, pre_travel: PreTravel::uniform(nm) };
        let surface = tip.surface_nm(p, &d, &n);
        for axis in 0..3 {
            let scale = f64::from(1 << 30);
            let exact =
                bits(&d)[axis] / scale * f64::from(nm)
                    + bits(&n)[axis] / scale * f64::from(radius_nm);
            prop_assert!(((p[axis] - surface[axis]) as f64 - exact).abs() <= 1.0);
        }
        prop_assert_eq!(tip.position_nm(surface, &d, &n), p);
    }

    /// An interpolated pre-travel equals the entry in each direction of the table and is between
    /// the extremes in all other directions.
    #[test]
    fn pre_travel_is_within_its_table(
        entries in proptest::array::uniform6((vector(1000), any::<i32>())), d in direction(),
    ) {
        let Some(directions) = entries.iter().map(
            |(v, _)| UnitVector::new(*v)
        ).collect::<Option<Vec<_>>>() else {
            return Ok(());
        };
        let table = [0, 1, 2, 3, 4, 5].map(|k| (directions[k], entries[k].1));
        let pre_travel = PreTravel::new(table);
        let (low, high) = (
            table.iter().map(|e| e.1).min().unwrap(),
            table.iter().map(|e| e.1).max().unwrap(),
        );
        prop_assert!((low..=high).contains(&pre_travel.along(&d)));
        for (direction, _) in &table {
            // Takes the first of directions that are equal within rounding.
            let first = table.iter().find(
                |(other, _)| other.cosine(direction).to_bits() >= (1 << 30) - 4
            );
            prop_assert_eq!(Some(pre_travel.along(direction)), first.map(|e| e.1));
        }
        let mut turned = table;
        turned.reverse();
        prop_assert_eq!(PreTravel::new(turned).along(&d), pre_travel.along(&d));
    }

    /// Statistics equal their definition for all readings.
    #[test]
    fn statistics(
        base in any::<i64>(),
        readings in proptest::collection::vec(-5_000_i64..5_000, 1..50),
    ) {
        let base = base / 2;
        let statistics: Repeatability = readings.iter().map(|r| base + r).collect();
        let n = readings.len() as f64;
        let mean = readings.iter().sum::<i64>() as f64 / n;
        prop_assert!(((statistics.mean().unwrap() - base) as f64 - mean).abs() <= 0.5);
        let variance = readings.iter().map(|&r| (r as f64 - mean).powi(2)).sum::<f64>() / (n - 1.0);
        prop_assert_eq!(statistics.standard_deviation().is_none(), readings.len() < 2);
        if let Some(deviation) = statistics.standard_deviation() {
            prop_assert!((deviation as f64 - variance.sqrt()).abs() <= 0.5 + 1e-6);
        }
        let (low, high) = (readings.iter().min().unwrap(), readings.iter().max().unwrap());
        prop_assert_eq!(statistics.range(), Some(high - low));
        prop_assert!((statistics.largest_deviation().unwrap() as f64
            - (*high as f64 - mean).max(mean - *low as f64)).abs() <= 0.5);
    }

    /// Every cycle ends for any behaviour of contact and axes. A result lies within the planned
    /// search.
    #[test]
    fn cycles_end(
        touches in 0_u8..5,
        back_off in 0_u32..500,
        over_travel in 0_u32..500,
        until in any::<bool>(),
        wall in -1500_i64..3000, noise in proptest::collection::vec(
            any::<(u8, bool)>(),
            1..200,
        ), is_noisy in any::<bool>(),
    ) {
        let plan = Plan {
            approach: [100, 0, 0],
            direction: UnitVector::X,
            search: 2000,
            over_travel,
            back_off,
            touches,
            travel_speed: 90, probing_speed: 20, slow_speed: 3, back_off_speed: 50,
            until: if until { Edge::Made } else { Edge::Broken },
        };
        let Ok(mut cycle) = Cycle::new(&plan) else {
            prop_assert!(touches > 0 && back_off == 0);
            return Ok(());
        };
        let (mut x, mut target, mut step) = (-1000_i64, -1000_i64, 0_i64);
        let mut end = None;
        for ((random, flips), _) in noise.iter().copied().cycle().zip(0..100_000) {
            x += (target - x).clamp(-step, step);
            let contact = (x >= wall) == until;
            let contact = if is_noisy && random < 20 { flips } else { contact };
            let input = Input {
                position: [x, 0, 0],
                contact,
                latched: [x, 0, 0],
                still: x == target,
            };
            match cycle.tick(&input) {
                Request::Move { target: to, speed } => {
                    prop_assert_eq!([to[1], to[2]], [0, 0]);
                    (target, step) = (to[0], i64::from(speed));
                }
                Request::Stop => target = x + (target - x).clamp(-step, step),
                Request::Wait => {}
                Request::Done(result) => { end = Some(Ok(result)); break }
                Request::Failed(failure) => { end = Some(Err(failure)); break }
            }
        }
        let end = end.expect("an end");
        prop_assert!(cycle.is_over());
        if is_noisy {
            return Ok(());
        }
        match end {
            Ok(result) => {
                prop_assert_eq!(result.touches, touches.max(1));
                let way = result.touch.position[0] - wall;
                prop_assert!((0..20).contains(&way), "{}", way);
                prop_assert!(result.spread < 3 && result.over_travel <= i64::from(over_travel));
            }
            Err(Failure::NoContact) => prop_assert!(wall > 2100),
            Err(Failure::ContactAtStart) => prop_assert!(wall <= -1000),
            Err(Failure::ContactInApproach) => prop_assert!((-1000..=100).contains(&wall)),
            // The search can be 20 beyond the wall and brakes within 20 more.
            Err(Failure::OverTravel) => prop_assert!(over_travel <= 20),
            Err(Failure::StuckContact) => prop_assert!(back_off < 20),
            // If the search saw the wall late, the slow touch searches within the over-travel of
            // that position.
            Err(failure @ (Failure::LostContact | Failure::NotLatched)) => prop_assert!(
                false,
                "{}",
                failure,
            ),
        }
    }

    /// Fits recover a plane, a circle and a sphere from points on them, within the rounding of the
    /// points.
    #[test]
    fn features_are_found_again(
        centre in vector(1 << 30), radius in 1_000_000_i64..100_000_000, normal in direction(),
        rays in proptest::collection::vec(vector(1 << 20), 8..30),
    ) {
        let rays: Vec<UnitVector> = rays.into_iter().filter_map(UnitVector::new).collect();
        let on_sphere: Vec<[i64; 3]> = rays.iter()
            .map(|ray| { let r = ray.scaled(radius); [0, 1, 2].map(|i| centre[i] + r[i]) })
            .collect();
        if let Ok(sphere) = Sphere::fit(on_sphere.iter().copied()) {
            prop_assert!((sphere.radius_nm - radius).abs() <= 60, "{}", sphere.radius_nm - radius);
            prop_assert!(sphere.residuals.largest_nm <= 3);
        }
        // Seen along the normal.
        let across: Vec<[i64; 3]> = rays.iter()
            .map(|ray| {
                let ray = ray.scaled(radius);
                let off = normal.scaled(normal.length_along(ray));
                [0, 1, 2].map(|i| centre[i] + ray[i] - off[i])
            })
            .collect();
        if let Ok(plane) = Plane::fit(across.iter().copied(), &normal) {
            prop_assert!(plane.residuals.largest_nm <= 3);
            for point in &across {
                prop_assert!(plane.distance_nm(*point).abs() <= 3);
            }
            let flat: Option<Vec<UnitVector>> = across.iter()
                .map(|p| UnitVector::new([0, 1, 2].map(|i| p[i] - centre[i])))
                .collect();
            let ring = flat.unwrap_or_default().into_iter()
                .map(|ray| { let r = ray.scaled(radius); [0, 1, 2].map(|i| centre[i] + r[i]) })
                .collect::<Vec<_>>();
            if let Ok(circle) = Circle::fit(ring, &normal) {
                prop_assert!(
                    (circle.radius_nm - radius).abs() <= 60,
                    "{}",
                    circle.radius_nm - radius,
                );
            }
        }
    }
}
