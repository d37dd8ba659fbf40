//! Events of different sweep: in blocks, one by one, and beside the exact ramp in floating point.

use husillo_planner::{Limits, Ramp, Stretch};
use proptest::prelude::*;

const HZ: u32 = 32_000_000;

/// A move whose events have these sweeps; a unit of sweep is `unit_nm` long.
#[derive(Clone, Debug)]
struct Arc {
    sweeps: Vec<u32>,
    unit_nm: f64,
    top: u32,
    acceleration: u64,
}

impl Arc {
    fn total(&self) -> u64 {
        self.sweeps.iter().copied().map(u64::from).sum()
    }

    fn length_nm(&self) -> u64 {
        (self.total() as f64 * self.unit_nm) as u64
    }

    fn ramp(&self) -> Ramp {
        let stretch = Stretch {
            length_nm: self.length_nm(),
            top_nm_per_s: self.top,
            ceiling_nm_per_s: self.top.saturating_mul(2),
            obeys_override: true,
            acceleration_nm_per_s2: self.acceleration,
            start_nm_per_s: 0,
            upper: None,
            entry_limit_nm_per_s: 0,
        };
        let ticks = (u128::from(self.length_nm()) * u128::from(HZ)) << 16;
        let ticks = (ticks / u128::from(self.top)) as u64;
        let largest = self.sweeps.iter().copied().max().unwrap_or(1);
        let mut ramp = Ramp::new(HZ);
        ramp.begin(&stretch, self.total(), largest, ticks);
        ramp
    }

    const fn limits(&self) -> Limits {
        Limits {
            top_nm_per_s: self.top,
            exit_squared: 0,
            version: 7,
        }
    }
}

/// Sweeps as an arc has them: between 1 and sqrt(2) times a radius with fraction bits, and a few
/// short ones.
fn arcs() -> impl Strategy<Value = Arc> {
    (0_u32..24, 1_usize..3000).prop_flat_map(|(bits, count)| {
        let long = 1_u32 << bits;
        let sweep = prop_oneof![
            20 => long..=long + long / 2,
            1 => 1..=long,
        ];
        let sweeps = prop::collection::vec(sweep, count);
        let event_nm = 100.0..20_000.0_f64;
        (sweeps, event_nm, 5.0..8.3_f64, 7.5..10.0_f64).prop_map(
            move |(sweeps, event_nm, top, acceleration)| Arc {
                sweeps,
                unit_nm: event_nm / f64::from(long),
                top: 10_f64.powf(top) as u32,
                acceleration: 10_f64.powf(acceleration) as u64,
            },
        )
    })
}

/// A request before an event.
#[derive(Copy, Clone, Debug)]
enum Wish {
    Hold,
    Resume,
    Top(u32),
    Exit(u32),
}

impl Wish {
    fn of(self, arc: &Arc, ramp: &mut Ramp, limits: &mut Limits) {
        let ceiling = arc.top.saturating_mul(2);
        match self {
            Wish::Hold => ramp.hold(),
            Wish::Resume => ramp.resume(),
            Wish::Top(percent) => {
                let top = u64::from(arc.top) * u64::from(percent) / 100;
                limits.top_nm_per_s = (top as u32).clamp(1, ceiling);
            }
            Wish::Exit(percent) => {
                let exit = (u64::from(ceiling) * u64::from(percent) / 100).pow(2);
                limits.exit_squared = limits.exit_squared.max(exit);
            }
        }
        limits.version += 1;
    }
}

fn wishes() -> impl Strategy<Value = Vec<(usize, Wish)>> {
    let wish = prop_oneof![
        Just(Wish::Hold),
        Just(Wish::Resume),
        (10_u32..=200).prop_map(Wish::Top),
        (1_u32..=100).prop_map(Wish::Exit),
    ];
    prop::collection::vec((0_usize..2000, wish), 0..12)
}

/// The waits with these requests. `most` is the length of a block; 0 takes the events one by one.
/// Also returns how many events were in blocks.
fn waits(arc: &Arc, wishes: &[(usize, Wish)], most: usize) -> (Vec<u64>, usize) {
    let (mut ramp, mut limits) = (arc.ramp(), arc.limits());
    let (mut waits, mut in_blocks) = (Vec::new(), 0);
    let mut asked = usize::MAX;
    while waits.len() < arc.sweeps.len() {
        let at = waits.len();
        if std::mem::replace(&mut asked, at) != at {
            for (_, wish) in wishes.iter().filter(|(when, _)| *when == at) {
                wish.of(arc, &mut ramp, &mut limits);
            }
        }
        let next = wishes
            .iter()
            .map(|(when, _)| *when)
            .filter(|when| *when > at)
            .min();
        let end = next
            .unwrap_or(usize::MAX)
            .min(at + most)
            .min(arc.sweeps.len());
        let room = if most == 0 {
            0
        } else {
            u64::from(ramp.room(&limits))
        };
        let mut sum = 0;
        let fits = arc.sweeps[at..end.max(at)].iter().take_while(|sweep| {
            sum += u64::from(**sweep);
            sum <= room
        });
        let mut block: Vec<u32> = fits.copied().collect();
        if block.is_empty() {
            match ramp.wait(arc.sweeps[at], &limits) {
                Some(wait) => waits.push(wait),
                None => {
                    assert_eq!(ramp.speed_nm_per_s(), 0);
                    ramp.resume();
                }
            }
            continue;
        }
        let filled = ramp.fill_swept(block.iter_mut());
        assert_eq!(filled.count as usize, block.len());
        assert_eq!(Some(filled.least), block.iter().copied().min());
        assert_eq!(filled.ticks, block.iter().copied().sum::<u32>());
        in_blocks += block.len();
        waits.extend(block.into_iter().map(u64::from));
    }
    (waits, in_blocks)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// A block has the waits of its events one by one, whatever is asked for between blocks.
    #[test]
    fn blocks_are_the_events_one_by_one(arc in arcs(), wishes in wishes(), most in 1_usize..300) {
        let (one_by_one, _) = waits(&arc, &wishes, 0);
        let (blocks, _) = waits(&arc, &wishes, most);
        prop_assert_eq!(blocks, one_by_one);
    }

    /// The whole move takes the time of the exact trapezoid. Only the events that meet the top
    /// speed take longer.
    #[test]
    fn moves_take_their_time(arc in arcs()) {
        let (waits, _) = waits(&arc, &[], 255);
        let clock = waits.iter().sum::<u64>() as f64;
        let (length, a, hz) = (arc.length_nm() as f64, arc.acceleration as f64, f64::from(HZ));
        let top = f64::from(arc.top).min((a * length).sqrt());
        let exact = (top / a + length / top) * hz;
        // An event of the length ds in which the speed rises from v less than the top.
        let event = arc.unit_nm * f64::from(arc.sweeps.iter().copied().max().unwrap());
        let up = (top * top / 2.0 / a / event).max(1.0);
        let corner = event / top * hz / up.floor();
        let most = 2.0 * corner + 1.0 + exact * 1e-8 + hz / f64::from(arc.top) * 2.0;
        prop_assert!((clock - exact).abs() <= most, "{clock} {exact} {most}");
    }
}

/// Nearly all events of a long arc are in blocks.
#[test]
fn a_long_arc_is_made_of_blocks() {
    let arc = Arc {
        sweeps: vec![1 << 16; 20_000],
        unit_nm: 2_500.0 / 65_536.0,
        top: 50_000_000,
        acceleration: 1_000_000_000,
    };
    let (waits, in_blocks) = waits(&arc, &[], 255);
    assert!(in_blocks > 19_500, "{in_blocks}");
    let exact = f64::from(HZ) * (0.05 + 1.0);
    let clock = waits.iter().sum::<u64>() as f64;
    assert!((clock - exact).abs() < 200.0, "{clock} {exact}");
}
