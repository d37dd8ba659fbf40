//! Tests of probing cycles on an axis that brakes.

use husillo_probe::{
    Cycle, Debounce, Edge, Failure, Input, Latch, Measurement, Plan, PlanError, Request, UnitVector,
};

/// Carries out requests in three axes with limited acceleration, tick by tick, with a solid in the
/// path.
struct Rig {
    position: [f64; 3],
    speed: f64,
    target: [f64; 3],
    limit: f64,
    stopping: bool,
    acceleration: f64,
    latch: Latch<[i64; 3], 32>,
    latched: [i64; 3],
    contact: Box<dyn Fn([f64; 3]) -> bool>,
    said: String,
}

const SAMPLES: u8 = 4;

impl Rig {
    fn new(contact: impl Fn([f64; 3]) -> bool + 'static) -> Rig {
        let closed = contact([0.0; 3]);
        Rig {
            position: [0.0; 3],
            speed: 0.0,
            target: [0.0; 3],
            limit: 0.0,
            stopping: false,
            acceleration: 1.0,
            latch: Latch::new(Debounce::new(SAMPLES, closed), 0, [0; 3]).unwrap(),
            latched: [0; 3],
            contact: Box::new(contact),
            said: String::new(),
        }
    }

    fn is_still(&self) -> bool {
        self.speed == 0.0 && (self.stopping || self.position == self.target)
    }

    /// One tick: moves, samples the contact, reports.
    fn tick(&mut self) -> Input {
        let way: Vec<f64> = (0..3).map(|a| self.target[a] - self.position[a]).collect();
        let left = way.iter().map(|w| w * w).sum::<f64>().sqrt();
        self.speed = if self.stopping {
            (self.speed - self.acceleration).max(0.0)
        } else {
            // Limits the speed so that the axis can brake within the remaining distance.
            (self.speed + self.acceleration)
                .min(self.limit)
                .min((2.0 * self.acceleration * left).sqrt())
        };
        if self.speed >= left {
            (self.position, self.speed) = (self.target, 0.0);
        } else if left > 0.0 {
            for (position, way) in self.position.iter_mut().zip(way) {
                *position += way / left * self.speed;
            }
        }
        let position = self.position.map(|p| p.round() as i64);
        let closed = (self.contact)(self.position);
        if let Some(edge) = self.latch.sample(closed, position) {
            self.latched = edge.position;
        }
        Input {
            position,
            contact: self.latch.level(),
            latched: self.latched,
            still: self.is_still(),
        }
    }

    fn run(&mut self, plan: &Plan) -> Result<Measurement, Failure> {
        let mut cycle = Cycle::new(plan).unwrap();
        for _ in 0..1_000_000 {
            let input = self.tick();
            match cycle.tick(&input) {
                Request::Move { target, speed } => {
                    self.said += &format!("{speed} ");
                    self.target = target.map(|t| t as f64);
                    self.limit = f64::from(speed);
                    self.stopping = false;
                }
                Request::Stop => {
                    self.said += "stop ";
                    self.stopping = true;
                }
                Request::Wait => {}
                Request::Done(result) => {
                    assert!(cycle.is_over() && self.is_still());
                    assert_eq!(cycle.tick(&input), Request::Done(result));
                    return Ok(result);
                }
                Request::Failed(failure) => {
                    assert!(cycle.is_over() && self.is_still());
                    assert_eq!(cycle.tick(&input), Request::Failed(failure));
                    return Err(failure);
                }
            }
        }
        panic!("no end: {}", self.said);
    }
}

const PLAN: Plan = Plan {
    approach: [1000, 0, 0],
    direction: UnitVector::X,
    search: 100_000,
    over_travel: 4_000,
    back_off: 3_000,
    touches: 3,
    travel_speed: 200,
    probing_speed: 50,
    slow_speed: 2,
    back_off_speed: 40,
    until: Edge::Made,
};

fn wall(at: f64) -> impl Fn([f64; 3]) -> bool {
    move |[x, ..]| x >= at
}

#[test]
fn search_touch_and_retouch() {
    let mut rig = Rig::new(wall(20_000.0));
    let result = rig.run(&PLAN).unwrap();
    assert_eq!(rig.said, "200 50 stop 40 2 stop 40 2 stop 40 2 stop 40 ");
    // The latch resolves the distance of one tick at the slow speed.
    let x = result.touch.position[0];
    assert!((20_000..=20_002).contains(&x), "{x}");
    assert!(result.spread <= 2);
    assert_eq!(result.touches, 3);
    // The search brakes from 50 at 1 per tick. It starts to brake when the debounce has counted.
    assert!(
        (1_250..1_500).contains(&result.over_travel),
        "{}",
        result.over_travel
    );
    assert_eq!(
        rig.position[0].round() as i64,
        x - x.rem_euclid(2) - 3_000 + x % 2
    );
}

#[test]
fn oblique_search() {
    let direction = UnitVector::new([2, -3, -6]).unwrap();
    let plan = Plan { direction, ..PLAN };
    let mut rig = Rig::new(|[_, _, z]| z <= -20_000.0);
    let result = rig.run(&plan).unwrap();
    let [x, y, z] = result.touch.position;
    assert!((-20_002..=-20_000).contains(&z), "{z}");
    assert!((x - 1_000 + z / 3).abs() <= 2, "{x}");
    assert!((y - z / 2).abs() <= 2, "{y}");
}

#[test]
fn single_touch_stays_where_it_stops() {
    let plan = Plan {
        touches: 0,
        back_off: 0,
        ..PLAN
    };
    let mut rig = Rig::new(wall(20_000.0));
    let result = rig.run(&plan).unwrap();
    assert_eq!(rig.said, "200 50 stop ");
    assert_eq!(result.touches, 1);
    assert!((20_000..=20_050).contains(&result.touch.position[0]));
    assert!(rig.position[0] > 21_000.0);
}

#[test]
fn the_end_of_a_contact() {
    // G38.4: in contact up to 20000.
    let plan = Plan {
        touches: 0,
        back_off: 0,
        until: Edge::Broken,
        ..PLAN
    };
    let mut rig = Rig::new(|[x, ..]| x < 20_000.0);
    let x = rig.run(&plan).unwrap().touch.position[0];
    assert!((20_000..=20_050).contains(&x), "{x}");
    assert_eq!(
        Rig::new(|_| false).run(&plan),
        Err(Failure::ContactAtStart),
        "free at start"
    );
    assert_eq!(Rig::new(|_| true).run(&plan), Err(Failure::NoContact));
}

#[test]
fn failures_are_named_and_the_probe_backs_off() {
    let mut rig = Rig::new(wall(-5.0));
    assert_eq!(rig.run(&PLAN), Err(Failure::ContactAtStart));
    assert_eq!(rig.said, "");

    let mut rig = Rig::new(wall(500.0));
    assert_eq!(rig.run(&PLAN), Err(Failure::ContactInApproach));
    assert_eq!(
        (rig.said.as_str(), rig.position),
        ("200 stop 40 ", [0.0; 3])
    );

    let mut rig = Rig::new(wall(200_000.0));
    assert_eq!(rig.run(&PLAN), Err(Failure::NoContact));
    assert_eq!(rig.position[0], 101_000.0 - 3_000.0);

    // A thin wall: the probe is through it before the axis stands.
    let mut rig = Rig::new(|[x, ..]| (20_000.0..20_900.0).contains(&x));
    assert_eq!(rig.run(&PLAN), Err(Failure::LostContact));

    // The contact is gone after the search.
    let gone = std::cell::Cell::new(false);
    let mut rig = Rig::new(move |[x, ..]| {
        if x > 21_000.0 {
            gone.set(true);
        }
        x >= 20_000.0 && !(gone.get() && x < 20_900.0) && x < 24_900.0
    });
    let plan = Plan {
        over_travel: 800,
        back_off: 3_000,
        ..PLAN
    };
    assert_eq!(rig.run(&plan), Err(Failure::OverTravel));
    assert!(rig.position[0] < 20_000.0);

    // A work piece that yields: the slow touch searches as far as the over-travel allows.
    let fast = std::cell::Cell::new(true);
    let mut rig = Rig::new(move |[x, ..]| {
        let closed = x >= if fast.get() { 20_000.0 } else { 30_000.0 };
        if x > 21_200.0 {
            fast.set(false);
        }
        closed || (!fast.get() && x > 20_000.0 && x < 21_000.0) // lost on the way back
    });
    assert!(matches!(
        rig.run(&PLAN),
        Err(Failure::LostContact | Failure::StuckContact)
    ));

    // A contact that sticks.
    let made = std::cell::Cell::new(false);
    let mut rig = Rig::new(move |[x, ..]| {
        made.set(made.get() || x >= 20_000.0);
        made.get()
    });
    assert_eq!(rig.run(&PLAN), Err(Failure::StuckContact));
}

/// A latched position before the search, beyond its end or beyond the axes belongs to an earlier
/// contact and is refused.
#[test]
fn a_latch_off_the_way_is_refused() {
    let input = |x, contact, latched| Input {
        position: [x, 0, 0],
        contact,
        latched: [latched, 0, 0],
        still: true,
    };
    for (latched, wanted) in [
        (-3_001, Some(Failure::NotLatched)),
        (-3_000, None),
        (20_000, None),
        (24_000, None),
        (24_001, Some(Failure::NotLatched)),
    ] {
        let mut cycle = Cycle::new(&Plan { touches: 0, ..PLAN }).unwrap();
        cycle.tick(&input(0, false, 0));
        cycle.tick(&input(1_000, false, 0));
        assert_eq!(cycle.tick(&input(20_000, true, latched)), Request::Stop);
        let Request::Move { target, .. } = cycle.tick(&input(20_000, true, latched)) else {
            panic!("{latched}: it does not back off");
        };
        let end = cycle.tick(&input(target[0], false, latched));
        match wanted {
            // The probe backs off from its present position, because the latched position is not
            // usable.
            Some(failure) => {
                assert_eq!(target[0], 17_000);
                assert_eq!(end, Request::Failed(failure));
            }
            None => assert_ne!(end, Request::Failed(Failure::NotLatched), "{latched}"),
        }
    }
    // The same holds in a slow touch.
    let mut cycle = Cycle::new(&PLAN).unwrap();
    cycle.tick(&input(0, false, 0));
    cycle.tick(&input(1_000, false, 0));
    for (x, contact) in [(20_000, true), (20_000, true), (17_000, false)] {
        cycle.tick(&input(x, contact, 20_000));
    }
    cycle.tick(&input(20_000, true, -90_000));
    cycle.tick(&input(20_000, true, -90_000));
    assert_eq!(
        cycle.tick(&input(17_000, false, -90_000)),
        Request::Failed(Failure::NotLatched)
    );
}

#[test]
fn plans_are_checked() {
    let error = |plan: Plan| Cycle::new(&plan).err();
    assert_eq!(error(PLAN), None);
    assert_eq!(error(Plan { search: 0, ..PLAN }), Some(PlanError::NoSearch));
    assert_eq!(
        error(Plan {
            back_off: 0,
            ..PLAN
        }),
        Some(PlanError::NoBackOff)
    );
    for plan in [
        Plan {
            travel_speed: 0,
            ..PLAN
        },
        Plan {
            probing_speed: 0,
            ..PLAN
        },
        Plan {
            slow_speed: 0,
            ..PLAN
        },
        Plan {
            back_off_speed: 0,
            ..PLAN
        },
    ] {
        assert_eq!(error(plan), Some(PlanError::NoSpeed));
    }
}
