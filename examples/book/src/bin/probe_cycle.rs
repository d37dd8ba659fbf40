//! A probing cycle with debounce, latch and compensation, on a simulated axis.

use husillo_probe::{
    Cycle, Debounce, Edge, Input, Latch, Plan, PreTravel, Request, Tip, UnitVector,
};
use std::error::Error;

/// Where the surface is, in nanometres. The cycle has to find it.
const SURFACE_NM: i64 = 4_321_700;
/// The ball of the probe, and the way from the first touch to the contact.
const RADIUS_NM: i32 = 1_000_000;
const PRE_TRAVEL_NM: i32 = 5_000;

/// Z, which moves at a constant deceleration of 1 m/s^2. A tick is 1 ms.
struct Axis {
    z_nm: i64,
    nm_per_tick: i64,
    target_nm: i64,
    top_nm_per_tick: i64,
}

impl Axis {
    const BRAKE: i64 = 1_000; // nm per tick^2

    fn tick(&mut self) {
        let to_go = self.target_nm - self.z_nm;
        let braking = ((2 * Self::BRAKE * to_go.abs()) as f64).sqrt() as i64;
        let wanted = to_go.signum() * braking.min(self.top_nm_per_tick).min(to_go.abs());
        let change = (wanted - self.nm_per_tick).clamp(-Self::BRAKE, Self::BRAKE);
        self.nm_per_tick += change;
        self.z_nm += self.nm_per_tick;
    }

    fn is_still(&self) -> bool {
        self.nm_per_tick == 0 && self.z_nm == self.target_nm
    }

    /// The nearest position at which it can stand.
    fn stop(&mut self) {
        let way = self.nm_per_tick * self.nm_per_tick.abs() / (2 * Self::BRAKE);
        self.target_nm = self.z_nm + way + self.nm_per_tick;
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut axis = Axis {
        z_nm: 20_000_000,
        nm_per_tick: 0,
        target_nm: 20_000_000,
        top_nm_per_tick: 0,
    };
    let down = UnitVector::Z.reversed();
    // ANCHOR: plan
    let mut cycle = Cycle::new(&Plan {
        approach: [0, 0, 10_000_000],
        direction: down,
        search: 8_000_000,
        over_travel: 1_000_000,
        back_off: 500_000,
        touches: 3,
        travel_speed: 20_000_000, // nm/s
        probing_speed: 5_000_000,
        slow_speed: 500_000,
        back_off_speed: 5_000_000,
        until: Edge::Made,
    })?;
    // A contact counts after 3 equal samples. The latch looks back to the first of them.
    let mut latch = Latch::<i64, 8>::new(Debounce::new(3, false), 0, axis.z_nm)?;
    let mut latched_nm = axis.z_nm;
    // ANCHOR_END: plan
    let mut ms = 0;
    // ANCHOR: ticks
    let result = loop {
        ms += 1;
        axis.tick();
        let ball_nm = axis.z_nm - i64::from(RADIUS_NM);
        let is_closed = ball_nm <= SURFACE_NM - i64::from(PRE_TRAVEL_NM);
        if let Some(edge) = latch.sample(is_closed, axis.z_nm) {
            latched_nm = edge.position;
        }
        let input = Input {
            position: [0, 0, axis.z_nm],
            contact: latch.level(),
            latched: [0, 0, latched_nm],
            still: axis.is_still(),
        };
        match cycle.tick(&input) {
            Request::Move {
                target: [.., z_nm],
                speed,
            } => {
                println!(
                    "{ms:5} ms: at {:.3} mm, move to {:.3} mm",
                    mm(axis.z_nm),
                    mm(z_nm)
                );
                (axis.target_nm, axis.top_nm_per_tick) = (z_nm, i64::from(speed) / 1000);
            }
            Request::Stop => {
                println!("{ms:5} ms: at {:.3} mm, stop", mm(axis.z_nm));
                axis.stop();
            }
            Request::Wait => {}
            Request::Done(result) => break result,
            Request::Failed(failure) => return Err(failure.into()),
        }
    };
    // ANCHOR_END: ticks
    // ANCHOR: surface
    let pre_travel = PreTravel::uniform(PRE_TRAVEL_NM);
    let tip = Tip {
        radius_nm: RADIUS_NM,
        pre_travel,
    };
    let surface_nm = tip.surface_nm(result.touch.position, &down, &UnitVector::Z)[2];
    println!(
        "{} touches within {} nm: the surface is at {:.4} mm",
        result.touches,
        result.spread,
        mm(surface_nm),
    );
    // A slow touch moves 500 nm in a sample.
    assert!((surface_nm - SURFACE_NM).abs() <= 500);
    // ANCHOR_END: surface
    Ok(())
}

fn mm(nm: i64) -> f64 {
    nm as f64 / 1e6
}
