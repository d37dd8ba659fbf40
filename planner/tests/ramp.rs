//! Ramps by pieces beside the exact ramp in floating point.

use husillo_planner::{Limits, LookAhead, Piece, Ramp, Stretch};
use proptest::prelude::*;

/// Largest error of an event, in intervals, and largest acceleration seen: what `Ramp` promises.
const LATE: f64 = 0.04;
const SEEN: f64 = 1.036;
/// The acceleration seen from 300 events on.
const SEEN_LATER: f64 = 1.02;

/// A line of equal events.
#[derive(Copy, Clone, Debug)]
struct Line {
    events: u32,
    event_nm: u64,
    top: u32,
    acceleration: u64,
}

impl Line {
    fn stretch(&self) -> Stretch {
        Stretch {
            length_nm: self.event_nm * u64::from(self.events),
            top_nm_per_s: self.top,
            ceiling_nm_per_s: self.top,
            obeys_override: true,
            acceleration_nm_per_s2: self.acceleration,
            start_nm_per_s: 0,
            upper: None,
            entry_limit_nm_per_s: 0,
        }
    }

    fn begin(&self, ramp: &mut Ramp, hz: u32) {
        let ticks = (u128::from(self.stretch().length_nm) * u128::from(hz)) << 16;
        let ticks = ticks / u128::from(self.top);
        ramp.begin(&self.stretch(), self.events.into(), 1, ticks as u64);
    }

    /// The waits of the whole line, from rest to rest.
    fn waits(&self, hz: u32) -> Vec<u64> {
        let mut moves = LookAhead::<(), 1>::new();
        moves.push(self.stretch(), ()).unwrap();
        let mut ramp = Ramp::new(hz);
        self.begin(&mut ramp, hz);
        (0..self.events)
            .map(|_| ramp.wait(1, moves.limits()).unwrap())
            .collect()
    }

    /// Gain of the square of the speed over an event.
    fn gain(&self) -> f64 {
        2.0 * self.acceleration as f64 * self.event_nm as f64
    }

    /// Time of an event in seconds, and the speed there, by the exact trapezoid.
    fn exact(&self, event: u32) -> (f64, f64) {
        let (gain, a, top) = (self.gain(), self.acceleration as f64, f64::from(self.top));
        let half = f64::from(self.events) / 2.0;
        let up = (top * top / gain).min(half);
        let peak = (gain * up).sqrt();
        let total = 2.0 * peak / a + 2.0 * (half - up) * self.event_nm as f64 / peak;
        let from_start = |event: f64| {
            if event <= up {
                let speed = (gain * event).sqrt();
                (speed / a, speed)
            } else {
                let level = (event - up) * self.event_nm as f64 / peak;
                (peak / a + level, peak)
            }
        };
        let event = f64::from(event);
        if event <= half {
            from_start(event)
        } else {
            let (time, speed) = from_start(f64::from(self.events) - event);
            (total - time, speed)
        }
    }
}

fn lines() -> impl Strategy<Value = Line> {
    (1_u32..4000, 100_u64..20_000, 5.0..8.3_f64, 7.5..10.0_f64).prop_map(
        |(events, event_nm, top, acceleration)| Line {
            events,
            event_nm,
            top: 10_f64.powf(top) as u32,
            acceleration: 10_f64.powf(acceleration) as u64,
        },
    )
}

/// Compares a line with the exact one at 1 GHz. Returns the largest error in intervals, and the
/// largest accelerations seen up to 300 events from standstill and later.
///
/// The event in which the ramp meets the top speed, and those next to it, are left out: it takes
/// the mean of its end speeds.
fn compare(line: &Line) -> [f64; 3] {
    const HZ: u32 = 1_000_000_000;
    let waits = line.waits(HZ);
    let up = f64::from(line.top).powi(2) / line.gain();
    let half = f64::from(line.events) / 2.0;
    let (mut clock, mut worst) = (0_u64, [0.0_f64; 3]);
    let mut last: Option<(f64, f64)> = None;
    // The time that the corners cost.
    let mut shift = 0.0;
    for (event, wait) in (1..).zip(&waits) {
        clock += wait;
        let from_end = f64::from(event).min(f64::from(line.events) - f64::from(event));
        let is_corner = (from_end - up.min(half)).abs() <= 1.5 || up <= 3.0;
        let (exact, _) = line.exact(event);
        let exact = exact * f64::from(HZ);
        let speed = line.event_nm as f64 * f64::from(HZ) / *wait as f64;
        let error = clock as f64 - exact - shift;
        if is_corner {
            shift += error;
            last = None;
            continue;
        }
        // The clock counts whole ticks, and speeds have 32 bits.
        let rounding = 1.0 + exact * 1e-9;
        worst[0] = worst[0].max((error.abs() - rounding) / *wait as f64);
        if let Some((before, before_wait)) = last {
            // The first and the last event end or begin at rest: their mean is half the speed.
            let seconds = (before_wait + *wait as f64) / 2.0 / f64::from(HZ);
            let tick = 2.0 * (speed / *wait as f64 + before / before_wait);
            let seen = ((speed - before).abs() - tick) / seconds / line.acceleration as f64;
            let place = if from_end < 300.0 { 1 } else { 2 };
            worst[place] = worst[place].max(seen);
        }
        last = Some((speed, *wait as f64));
    }
    worst
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// No event is more than 0.04 of its interval off, and the acceleration seen from event to
    /// event stays within its bound.
    #[test]
    fn events_are_those_of_the_exact_ramp(line in lines()) {
        let [late, seen, later] = compare(&line);
        prop_assert!(late <= LATE, "{late}");
        prop_assert!(seen <= SEEN, "{seen}");
        prop_assert!(later <= SEEN_LATER, "{later}");
    }

    /// The whole move takes the time of the exact one, whatever the timer: nothing drifts. Only the
    /// two events that meet the top speed take longer.
    #[test]
    fn moves_take_their_time(line in lines(), hz in 1_000_000_u32..100_000_000) {
        let clock = line.waits(hz).iter().sum::<u64>() as f64;
        let (exact, _) = line.exact(line.events);
        let exact = exact * f64::from(hz);
        let up = f64::from(line.top).powi(2) / line.gain();
        let half = f64::from(line.events) / 2.0;
        // An event of the length ds in which the speed rises from v less than the top.
        let interval = line.event_nm as f64 / (line.gain() * up.min(half)).sqrt() * f64::from(hz);
        let corner = interval / (1.0 + up.min(half).floor());
        prop_assert!(clock <= exact + 2.0 * corner + 1.0 + exact * 1e-8, "{clock} {exact}");
        prop_assert!(clock >= exact - 2.0 * corner - 1.0 - exact * 1e-8, "{clock} {exact}");
    }

    /// An interrupt that runs the pieces alone makes the same events.
    #[test]
    fn an_interrupt_runs_pieces_alone(line in lines(), most in 1_u32..300) {
        let hz = 32_000_000;
        let mut moves = LookAhead::<(), 1>::new();
        moves.push(line.stretch(), ()).unwrap();
        let mut ramp = Ramp::new(hz);
        line.begin(&mut ramp, hz);
        let (mut waits, mut owed) = (Vec::new(), 0);
        while waits.len() < line.events as usize {
            let mut piece: Piece = ramp.take_piece(most, moves.limits()).unwrap();
            prop_assert!(piece.count >= 1 && piece.count <= most);
            while let Some(wait) = piece.next(&mut owed) {
                waits.push(u64::from(wait));
            }
        }
        prop_assert_eq!(waits, line.waits(hz));
    }
}

/// A request before an event.
#[derive(Copy, Clone, Debug)]
enum Wish {
    Hold,
    Resume,
    Top(u32),
    /// Raises the speed at the end to this part of the highest.
    Exit(u32),
}

fn wishes() -> impl Strategy<Value = Vec<(u32, Wish)>> {
    let wish = prop_oneof![
        Just(Wish::Hold),
        Just(Wish::Resume),
        (10_u32..=200).prop_map(Wish::Top),
        (1_u32..=100).prop_map(Wish::Exit),
    ];
    prop::collection::vec((0_u32..2000, wish), 0..12)
}

/// The ramp event by event in floating point: the exact square, and the exact time of constant
/// acceleration.
struct Exact {
    square: f64,
    left: u32,
    gain: f64,
    acceleration: f64,
    event_nm: f64,
}

impl Exact {
    /// Seconds of the next event; `None` where a hold stops. `changes` tells whether the
    /// acceleration changes within it.
    fn next(&mut self, top: f64, exit: f64, is_held: bool) -> Option<(f64, bool)> {
        let top = if is_held { 0.0 } else { top * top };
        let line = exit + self.gain * f64::from(self.left - 1);
        let before = self.square;
        let after = (before + self.gain).min(top).min(line);
        let after = after.max(before - self.gain).max(0.0);
        if is_held && after <= 0.5 {
            self.square = 0.0;
            return None;
        }
        self.square = after;
        self.left -= 1;
        let speeds = before.sqrt() + after.sqrt();
        let change = (after - before).abs();
        let is_ramp = (change - self.gain).abs() < 1e-9 * self.gain;
        let speeds = if before + after < self.gain / 2.0 {
            speeds.max((self.gain / 2.0).sqrt().min(2.0 * top.sqrt()))
        } else {
            speeds
        };
        let seconds = if is_ramp {
            change / speeds / self.acceleration
        } else {
            2.0 * self.event_nm / speeds
        };
        Some((seconds, change < 1e-9 * self.gain || is_ramp))
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// Whatever changes on the way, each event is where the exact ramp with the same calls has it.
    #[test]
    fn changes_act_at_the_next_event(line in lines(), wishes in wishes()) {
        let hz = 32_000_000_u32;
        let line = Line { events: line.events.min(2000), ..line };
        let ceiling = line.top.saturating_mul(2);
        let mut ramp = Ramp::new(hz);
        let stretch = Stretch { ceiling_nm_per_s: ceiling, ..line.stretch() };
        let ticks = (u128::from(stretch.length_nm) * u128::from(hz)) << 16;
        ramp.begin(&stretch, line.events.into(), 1, (ticks / u128::from(line.top)) as u64);
        let mut limits = Limits { top_nm_per_s: line.top, exit_squared: 0, version: 7 };
        let mut exact = Exact {
            square: 0.0,
            left: line.events,
            gain: line.gain(),
            acceleration: line.acceleration as f64,
            event_nm: line.event_nm as f64,
        };
        let (mut clock, mut due, mut is_held, mut at) = (0_u64, 0.0, false, 0);
        let mut asked = u32::MAX;
        while at < line.events {
            let is_again = std::mem::replace(&mut asked, at) == at;
            for (_, wish) in wishes.iter().filter(|(when, _)| *when == at && !is_again) {
                match wish {
                    Wish::Hold => { ramp.hold(); is_held = true; }
                    Wish::Resume => { ramp.resume(); is_held = false; }
                    Wish::Top(percent) => {
                        let top = u64::from(line.top) * u64::from(*percent) / 100;
                        limits.top_nm_per_s = (top as u32).clamp(1, ceiling);
                    }
                    Wish::Exit(percent) => {
                        let exit = (u64::from(ceiling) * u64::from(*percent) / 100).pow(2);
                        limits.exit_squared = limits.exit_squared.max(exit);
                    }
                }
                limits.version += 1;
            }
            let top = f64::from(limits.top_nm_per_s);
            if is_held && (exact.square - exact.gain).abs() <= exact.gain * 1e-6 {
                // Rounding decides whether one more event fits.
                return Ok(());
            }
            let model = exact.next(top, limits.exit_squared as f64, is_held);
            let wait = ramp.wait(1, &limits);
            prop_assert_eq!(wait.is_some(), model.is_some(), "event {}", at);
            let (Some(wait), Some((seconds, _))) = (wait, model) else {
                prop_assert_eq!(ramp.speed_nm_per_s(), 0);
                prop_assert_eq!(ramp.wait(1, &limits), None);
                ramp.resume();
                is_held = false;
                continue;
            };
            clock += wait;
            due += seconds * f64::from(hz);
            at += 1;
            let interval = seconds * f64::from(hz);
            let error = (clock as f64 - due).abs();
            let most = 2.0 + 1.5 * LATE * interval + due * 1e-7;
            prop_assert!(error <= most, "event {at}: {clock} {due} {error} {most}");
            let speed = exact.square.sqrt();
            let reported = f64::from(ramp.speed_nm_per_s());
            // The model loses the last bits of the largest square.
            let lost = f64::from(ceiling).powi(2) * 1e-12;
            let error = (reported - speed).abs() * (reported + speed);
            prop_assert!(
                error <= (3.0 + speed * 2e-7) * (speed + reported + 1.0) + lost,
                "event {at}: {reported} {speed}"
            );
        }
    }
}

/// A long ramp: 100 000 events to 500 kHz and back at 100 MHz.
#[test]
fn a_long_ramp_ends_in_time() {
    let line = Line {
        events: 200_000,
        event_nm: 200,
        top: 100_000_000,
        acceleration: 250_000_000,
    };
    let clock = line.waits(100_000_000).iter().sum::<u64>() as f64;
    let exact = line.exact(line.events).0 * 1e8;
    assert!((clock - exact).abs() < 2.0, "{clock} {exact}");
    let [late, seen, later] = compare(&line);
    assert!(
        late < LATE && seen < SEEN && later < SEEN_LATER,
        "{late} {seen} {later}"
    );
}
