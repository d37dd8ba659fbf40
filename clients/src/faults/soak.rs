//! Faults of the machine or of one byte on its line, at random instants. Nothing ends wrong without
//! a report, and no motion lasts longer than stated.

use super::{Fault, LOST, Subject};
use super::{drill::Drill, microfactory::Microfactory, micromill::Micromill};
use husillo_sim::Random;
use husillo_sim::device::LineFault;

/// Latest instant of a fault, in ms after the start of the action.
const LATEST_MS: u64 = 40_000;
/// Number of bytes of an action. A fault hits one of them.
const BYTES: u64 = 400;

/// Counts over all sessions of a soak.
#[derive(Debug, Default)]
struct Tally {
    hours: f64,
    sessions: u32,
    reported: u32,
    carried_out: u32,
    /// Wrong positions that are reported at the next homing.
    at_homing: u32,
    /// Wrong positions that are never reported.
    unseen: u32,
    /// Longest motion after the host was killed, after a reset or after a loss of power, ms.
    longest_ms: u64,
}

/// Runs one session: an action with a fault during it, then the repair and another program.
fn session<S: Subject>(random: &mut Random, tally: &mut Tally) {
    fn one<T>(random: &mut Random, of: &'static [T]) -> &'static T {
        &of[random.below(of.len() as u64) as usize]
    }
    let (state, _) = *one(random, S::STATES);
    let mut machine = S::new(state);
    let begin_ms = machine.bench().now_ms();
    let on_line = random.below(2) > 0;
    let fault: Option<&Fault> = (!on_line).then(|| one(random, S::FAULTS));
    let after_ms = 1 + random.below(LATEST_MS);
    let context = match fault {
        Some(fault) => {
            machine.bench().schedule(after_ms, fault.begins);
            format!(
                "{}, {state:?}: {} after {after_ms} ms",
                S::MACHINE,
                fault.name
            )
        }
        None => {
            let kind = match random.below(6) {
                0 => LineFault::Lost,
                1 => LineFault::Doubled,
                2 => LineFault::Late(1000 * (1 + random.below(2000))),
                3 => LineFault::Reset,
                _ => LineFault::Flipped(random.below(8) as u8),
            };
            let place = random.below(BYTES);
            machine.bench().disturb(Some((place, kind)));
            format!("{}, {state:?}: {kind:?} at byte {place}", S::MACHINE)
        }
    };
    let result = machine.act(state);
    // Simulates until the fault has occurred and every motion that needs no host has ended.
    let left_ms = (begin_ms + after_ms).saturating_sub(machine.bench().now_ms());
    machine.bench().pass(left_ms + 20_000);
    let moved_ms = (machine.bench().last_step_ms()).saturating_sub(begin_ms + after_ms);
    if let Some(most_ms) = fault
        .and_then(|fault| fault.most_ms)
        .filter(|_| result.is_err())
    {
        assert!(moved_ms <= most_ms, "{context}: it moves for {moved_ms} ms");
        tally.longest_ms = tally.longest_ms.max(moved_ms);
    }
    let is_hidden = fault.is_some_and(|fault| fault.is_hidden);
    let is_true = machine.is_true();
    assert!(
        is_true || is_hidden,
        "{context}: {result:?}, and it is elsewhere"
    );
    tally.reported += u32::from(result.is_err());
    tally.carried_out += u32::from(result.is_ok() && is_true);
    machine.bench().disturb(None);
    for line in fault.iter().flat_map(|fault| fault.ends) {
        machine.bench().schedule(0, line);
    }
    // A drill homes when its power returns, and after a reset.
    machine.bench().pass(60_000);
    let again = machine.begin_again();
    let (mut machine, homed) = again.unwrap_or_else(|why| panic!("{context}: {why}"));
    assert!(
        machine.is_true(),
        "{context}: work goes on at a wrong position"
    );
    if result.is_ok() && !is_true {
        tally.at_homing += u32::from(homed.contains(LOST));
        tally.unseen += u32::from(!homed.contains(LOST));
    }
    tally.sessions += 1;
    tally.hours += machine.bench().now_ms() as f64 / 3.6e6;
}

/// Runs sessions until this simulated time has passed.
fn soak<S: Subject>(hours: f64) {
    let mut random = Random::new(72);
    let mut tally = Tally::default();
    while tally.hours < hours {
        session::<S>(&mut random, &mut tally);
    }
    println!("{}: {tally:?}", S::MACHINE);
    assert!(tally.reported > 0 && tally.carried_out > 0, "{tally:?}");
    assert_eq!(tally.unseen, 0, "{tally:?}");
}

#[test]
fn faults_at_random_instants_are_reported() {
    soak::<Micromill>(1.0);
    soak::<Drill>(2.0);
    soak::<Microfactory>(1.0);
}

/// A soak of each machine for a day:
/// `cargo test --release -p husillo-clients -- --ignored --nocapture a_day`.
#[test]
#[ignore = "takes minutes, optimised"]
fn a_day_of_faults_at_random_instants() {
    soak::<Micromill>(24.0);
    soak::<Drill>(24.0);
    soak::<Microfactory>(24.0);
}
