//! What holds for any motion of the encoder.

use husillo_encoder::{
    Byte, CountDirection, Extended, Index, Passage, Quadrature, Scale, Skipped, VelocityByCount,
    VelocityByPeriod, levels, read_running, running_value,
};
use proptest::collection::vec;
use proptest::prelude::*;

/// The levels of an encoder at a place given in quarters of a line.
fn levels_at(quarters: i64) -> u8 {
    [0b00, 0b01, 0b11, 0b10][quarters.rem_euclid(4) as usize]
}

const SCALES: [(Scale, i64); 3] = [(Scale::X1, 4), (Scale::X2, 2), (Scale::X4, 1)];

#[test]
fn every_change_of_every_state_counts_as_drawn() {
    // Rows: from 00, 01, 11, 10; columns: to the same.
    let skipped = Err(Skipped);
    let x4 = [
        [Ok(0), Ok(1), skipped, Ok(-1)],
        [Ok(-1), Ok(0), Ok(1), skipped],
        [skipped, Ok(-1), Ok(0), Ok(1)],
        [Ok(1), skipped, Ok(-1), Ok(0)],
    ];
    // The edges that count: of the four between neighbours, from 00 to 01 on.
    let counting = [
        (Scale::X1, [true, false, false, false]),
        (Scale::X2, [true, false, true, false]),
        (Scale::X4, [true; 4]),
    ];
    for (scale, edges) in counting {
        for (from, row) in x4.iter().enumerate() {
            for (to, full) in row.iter().enumerate() {
                let edge = if *full == Ok(1) { from } else { to };
                let expected = full.map(|counts| if edges[edge] { counts } else { 0 });
                let mut encoder = Quadrature::new(scale, levels_at(from as i64));
                assert_eq!(
                    encoder.sample(levels_at(to as i64)),
                    expected,
                    "{scale:?} from {from} to {to}"
                );
            }
        }
    }
}

#[test]
fn pins_and_other_bits_of_the_port() {
    assert_eq!([levels(true, false), levels(false, true)], [1, 2]);
    let mut encoder = Quadrature::new(Scale::X4, 0xfc);
    assert_eq!(encoder.sample(0xfd), Ok(1));
}

proptest! {
    /// A random walk of at most one edge a sample is counted exactly by X4, and by X2 and X1 as its
    /// half and quarter rounded down, at every sample.
    #[test]
    fn a_walk_is_counted_exactly(start in 0_i64..4, steps in vec(-1_i64..=1, 0..500)) {
        for (scale, divisor) in SCALES {
            let mut encoder = Quadrature::new(scale, levels_at(start));
            // The counting edge of X1 lies between the states 0 and 1, that of X2 also between 2
            // and 3.
            let place = |quarters: i64| (quarters - 1).div_euclid(divisor);
            let (mut quarters, mut last) = (start, None);
            for step in &steps {
                let before = place(quarters);
                quarters += step;
                let counts = place(quarters) - before;
                prop_assert_eq!(encoder.sample(levels_at(quarters)), Ok(counts as i32));
                prop_assert_eq!(i64::from(encoder.position()), place(quarters) - place(start));
                last = match counts {
                    1 => Some(CountDirection::Forward),
                    -1 => Some(CountDirection::Backward),
                    _ => last,
                };
                prop_assert_eq!(encoder.direction(), last);
            }
            prop_assert_eq!(encoder.skipped(), 0);
        }
    }

    /// Every step of two edges is flagged and none else; a position is off by twice the flags at
    /// most, and by an even number.
    #[test]
    fn every_skipped_state_is_flagged(start in 0_i64..4, steps in vec(-2_i64..=2, 0..300)) {
        let mut encoders = SCALES.map(|(scale, _)| Quadrature::new(scale, levels_at(start)));
        let (mut quarters, mut skipped) = (start, 0);
        for step in steps {
            quarters += step;
            skipped += u32::from(step.abs() == 2);
            for encoder in &mut encoders {
                prop_assert_eq!(encoder.sample(levels_at(quarters)).is_err(), step.abs() == 2);
                prop_assert_eq!(encoder.skipped(), skipped);
            }
        }
        let error = (quarters - start - i64::from(encoders[2].position())).unsigned_abs();
        prop_assert!(error % 2 == 0 && error <= 2 * u64::from(skipped));
    }

    /// The extension is exact as long as less than half a range passes between readings.
    #[test]
    fn extension_is_exact_below_half_the_range(
        start in any::<u32>(),
        position in -1_i64 << 40..1 << 40,
        shares in vec(any::<i32>(), 0..300),
    ) {
        fn check<const BITS: u32>(
            start: u32,
            position: i64,
            shares: &[i32],
        ) -> Result<(), TestCaseError> {
            let mut extended = Extended::<BITS>::new(start);
            extended.set_position(position);
            let mut truth = i64::from(start);
            for share in shares {
                // From -2^(BITS - 1) to 2^(BITS - 1) - 1, both included.
                let counts = share >> (32 - BITS);
                truth += i64::from(counts);
                // What is above the counter's bits must not matter.
                prop_assert_eq!(extended.update(truth as u32), counts);
                prop_assert_eq!(extended.position(), truth - i64::from(start) + position);
                prop_assert_eq!(extended.position_32(), extended.position() as i32);
            }
            Ok(())
        }
        check::<8>(start, position, &shares)?;
        check::<16>(start, position, &shares)?;
        check::<12>(start, position, &shares)?;
        check::<32>(start, position, &shares)?;
        check::<1>(start, position, &shares)?;
    }

    /// A reading of a counter that runs is one of the values it had, that of the second low byte,
    /// for any interleaving.
    #[test]
    fn running_counters_are_read_right(
        start: u16,
        gaps in proptest::array::uniform3(0_u16..43),
        backward: bool,
    ) {
        let mut values = Vec::from([start]);
        for gap in gaps {
            let step = if backward { gap.wrapping_neg() } else { gap };
            values.push(values[values.len() - 1].wrapping_add(step));
        }
        let mut readings = values.iter();
        let value = read_running(|byte| {
            let [high, low] = readings.next().unwrap().to_be_bytes();
            match byte {
                Byte::High => high,
                Byte::Low => low,
            }
        });
        prop_assert_eq!(value, Some(values[2]));
    }

    /// The same edge of the index is found from both sides, wherever the walk turns outside it, and
    /// lost counts are reported.
    #[test]
    fn index_is_the_same_from_both_sides(turns in vec(1_i32..1000, 1..20), lost in -30_i32..30) {
        const TURN: i32 = 400;
        const WIDTH: i32 = 4;
        let level = |place: i32| (0..WIDTH).contains(&(place - 100).rem_euclid(TURN));
        let mut index = Index::new(TURN as u32, false, 0);
        let (mut place, mut offset, mut last) = (0_i32, 0, None::<i32>);
        for (number, length) in turns.into_iter().enumerate() {
            let step = if number % 2 == 0 { 1 } else { -1 };
            let mut left = length;
            // Turns outside the mark and its neighbours, where direction and level cannot change
            // together.
            while left > 0 || (0..WIDTH + 8).contains(&(place - 96).rem_euclid(TURN)) {
                let before = level(place);
                place += step;
                left -= 1;
                let edge = match (before, level(place)) {
                    (false, true) if step == 1 => Some(place),
                    (true, false) if step == -1 => Some(place + 1),
                    _ => None,
                };
                let expected = edge.map(|edge| Passage {
                    position: edge + offset,
                    error_counts: last.map_or(0, |last| offset - last),
                });
                if edge.is_some() {
                    last = Some(offset);
                }
                prop_assert_eq!(index.sample(level(place), place + offset), expected);
            }
            // Some counts are lost without a sample of their own.
            if number == 3 {
                offset += lost;
            }
        }
    }

    /// The velocity by count is exact in the mean of its window.
    #[test]
    fn velocity_by_count_is_the_mean_of_the_window(
        start: i32,
        steps in vec(-30_000_i32..30_000, 10..200),
    ) {
        let mut velocity = VelocityByCount::<10>::new(start);
        let mut position = start;
        for (number, step) in steps.iter().enumerate() {
            position = position.wrapping_add(*step);
            let window = &steps[(number + 1).saturating_sub(10)..=number];
            let sum: i64 = window.iter().map(|step| i64::from(*step)).sum();
            prop_assert_eq!(i64::from(velocity.update(position)), sum * 65_536 / 10);
        }
    }

    /// The velocity by period is right to the time of a sample in the time of the counts, at any
    /// constant velocity, both ways and over the wrap of clock and position.
    #[test]
    fn velocity_by_period_is_right_at_constant_velocity(
        period_ticks in 20_u64..50_000,
        sample_ticks in 1_u64..2_000,
        begin: u32,
        position: i32,
        backward: bool,
    ) {
        const KNOWN: usize = 4;
        let mut velocity = VelocityByPeriod::<KNOWN>::new(1_000_000, 200_000, position);
        let exact = 1e9 / period_ticks as f64;
        for sample in 0..2_000_u64 {
            let ticks = sample * sample_ticks;
            let counts = (ticks / period_ticks) as i32;
            let counts = if backward { -counts } else { counts };
            let now = begin.wrapping_add(ticks as u32);
            velocity.update(position.wrapping_add(counts), now);
            if ticks > (KNOWN as u64 + 2) * (period_ticks + sample_ticks) {
                let measured = velocity.millicounts_per_s(now) as f64;
                let measured = if backward { -measured } else { measured };
                // All the counts it knows of took this time at least.
                let taken = (KNOWN as u64 * period_ticks.max(sample_ticks)) as f64;
                let error = (measured - exact).abs() / exact;
                prop_assert!(error <= sample_ticks as f64 / (taken - sample_ticks as f64) + 1e-6,
                    "{measured} instead of {exact}");
            }
        }
    }

    /// No motion and no clock makes a velocity above the counts there were.
    #[test]
    fn velocity_by_period_never_invents_counts(samples in vec((-3_i32..=3, 1_u32..5_000), 1..300)) {
        let mut velocity = VelocityByPeriod::<2>::new(1_000_000, 100_000, 0);
        let (mut position, mut now) = (0_i32, 0_u32);
        for (moved, ticks) in samples {
            position += moved;
            now += ticks;
            velocity.update(position, now);
            let measured = velocity.millicounts_per_s(now);
            // At most 3 counts in the shortest time of a sample, which is a tick.
            prop_assert!(measured.abs() <= 3_000_000_000);
            if moved != 0 && measured != 0 {
                prop_assert_eq!(measured.signum(), i64::from(moved.signum()));
            }
        }
    }
}

/// All values about a carry, every way to spread up to 127 counts over the three gaps.
#[test]
fn running_counters_are_read_right_about_every_carry() {
    for start in (0_i32..0x300).chain(0xfe00..0x10000) {
        for total in [-127, -126, -64, -3, -2, -1, 0, 1, 2, 3, 64, 126, 127_i32] {
            for first in 0..=total.abs().min(5) {
                for last in [0, 1, total.abs() - first] {
                    let second = total.abs() - first - last;
                    if second < 0 {
                        continue;
                    }
                    let at = |counts: i32| ((start + counts * total.signum()) as u16).to_be_bytes();
                    let values = [at(0), at(first), at(first + second), at(total.abs())];
                    let bytes = [values[0][0], values[1][1], values[2][1], values[3][0]];
                    assert_eq!(
                        running_value(bytes),
                        Some(u16::from_be_bytes(values[2])),
                        "{start} {first} {second} {last} {total}"
                    );
                }
            }
        }
    }
}

#[test]
fn bytes_that_cannot_be_are_refused() {
    // Two carries, low bytes half a range apart without a carry, a carry with the low bytes on the
    // wrong sides.
    for bytes in [
        [3, 0, 0, 5],
        [3, 10, 200, 3],
        [3, 20, 200, 4],
        [4, 200, 20, 3],
    ] {
        assert_eq!(running_value(bytes), None, "{bytes:?}");
    }
}

#[test]
fn velocity_by_period_stands_where_the_encoder_does() {
    let mut velocity = VelocityByPeriod::<2>::new(1_000_000, 10_000, 0);
    let mut now = 0;
    let mut at = |position: i32, ticks: u32| {
        now += ticks;
        velocity.update(position, now);
        velocity.millicounts_per_s(now)
    };
    // The first count has no period; the second one has, and the third.
    assert_eq!(
        [at(1, 1000), at(2, 1000), at(3, 500)],
        [0, 1_000_000, 1_333_333]
    );
    // Slower, as no count comes; then standstill.
    assert_eq!(
        [at(3, 2000), at(3, 3000), at(3, 5000)],
        [500_000, 200_000, 0]
    );
    // Trembling about an edge.
    assert_eq!([at(2, 100), at(3, 100), at(2, 100), at(3, 100)], [0; 4]);
    assert_eq!(at(4, 100), 10_000_000);
    velocity.set_position(-70);
    velocity.update(-69, now + 100);
    assert_eq!(velocity.millicounts_per_s(now + 100), 10_000_000);
}

#[test]
fn only_mark_of_a_scale() {
    let mut index = Index::new(0, false, -5);
    let pass = |index: &mut Index, from: i32, to: i32, mark: i32| {
        let mut found = None;
        let step = (to - from).signum();
        let mut place = from;
        while place != to {
            place += step;
            found = found.or(index.sample(place == mark, place));
        }
        found
    };
    let found = |position, error_counts| {
        Some(Passage {
            position,
            error_counts,
        })
    };
    assert_eq!(pass(&mut index, -5, 5, 0), found(0, 0));
    assert_eq!(pass(&mut index, 5, -5, 0), found(0, 0));
    // Three counts were lost.
    assert_eq!(pass(&mut index, -5, 9, 3), found(3, 3));
    index.set_position(6);
    assert_eq!(pass(&mut index, 6, -5, 0), found(0, 0));
}

/// The sizes of the README, for 32-bit words.
#[test]
fn sizes_are_those_of_the_readme() {
    assert_eq!(size_of::<Quadrature>(), 20);
    assert_eq!(size_of::<Extended<16>>(), 16);
    assert_eq!(size_of::<Index>(), 20);
    // A word of the processor in the one, two in the other.
    let word = size_of::<usize>();
    assert_eq!(size_of::<VelocityByCount<16>>(), 64 + word);
    assert_eq!(
        size_of::<VelocityByPeriod<4>>().next_multiple_of(8),
        64 + 2 * word
    );
}
