//! Runs moves through look-ahead and ramp as a machine does.

use husillo_planner::{LookAhead, Ramp};

use crate::moves::Move;

/// One event, as observed.
#[derive(Copy, Clone, Debug)]
pub struct Event {
    /// Index of the move.
    pub of: usize,
    pub sweep: u32,
    pub ticks: u64,
    pub length_nm: f64,
    /// Speed that the ramp reports after the event.
    pub speed_nm_per_s: u32,
    pub percent: u8,
    /// Whether the path was stopped by a hold before this event.
    pub is_after_stop: bool,
}

/// A request before an event.
#[derive(Copy, Clone, Debug)]
pub enum Wish {
    Hold,
    Override(u8),
}

pub struct Run {
    pub events: Vec<Event>,
    /// Number of stops. The carried fraction is below one tick, so the clock is always right to one
    /// tick.
    pub stops: usize,
}

/// Executes all moves with a queue that is kept full. Requests are made before the event with their
/// index. A hold is resumed as soon as the path stands still.
pub fn run<const CAPACITY: usize>(moves: &[Move], hz: u32, wishes: &[(usize, Wish)]) -> Run {
    let mut queue = LookAhead::<usize, CAPACITY>::new();
    let mut ramp = Ramp::new(hz);
    let mut coming = moves.iter().zip(0..);
    let mut waiting = None;
    let (mut events, mut stops) = (Vec::new(), 0);
    let mut is_after_stop = false;
    loop {
        // Pushes as many as fit; a returned move waits.
        while let Some((stretch, number)) = waiting
            .take()
            .or_else(|| coming.next().map(|(next, number)| (next.stretch, number)))
        {
            if let Err(back) = queue.push(stretch, number) {
                assert_eq!(back, (stretch, number));
                waiting = Some(back);
                break;
            }
        }
        let Some((stretch, number)) = queue.front().map(|(stretch, number)| (*stretch, *number))
        else {
            break;
        };
        let now = &moves[number];
        let largest = *now.sweeps.iter().max().unwrap();
        ramp.begin(&stretch, now.total(), largest, now.cruise_ticks_q16(hz));
        for sweep in &now.sweeps {
            for (_, wish) in wishes.iter().filter(|(at, _)| *at == events.len()) {
                match wish {
                    Wish::Hold => ramp.hold(),
                    Wish::Override(percent) => queue.set_override(*percent),
                }
            }
            let ticks = match ramp.wait(*sweep, queue.limits()) {
                Some(ticks) => ticks,
                None => {
                    stops += 1;
                    is_after_stop = true;
                    assert_eq!(ramp.speed_nm_per_s(), 0);
                    assert_eq!(ramp.wait(*sweep, queue.limits()), None, "asked again");
                    ramp.resume();
                    ramp.wait(*sweep, queue.limits()).expect("no hold any more")
                }
            };
            events.push(Event {
                of: number,
                sweep: *sweep,
                ticks,
                length_nm: now.length_of(*sweep),
                speed_nm_per_s: ramp.speed_nm_per_s(),
                percent: queue.percent(),
                is_after_stop: std::mem::take(&mut is_after_stop),
            });
        }
        queue.pop();
    }
    assert!(queue.is_empty());
    Run { events, stops }
}
