//! Planner and interrupt apart, as in Klipper: the planner hands over pieces, and the interrupt
//! runs each of them by three additions an event.
//!
//! A microcontroller has the queue in RAM and the planner in its main loop, or receives the pieces
//! over a link.

use std::collections::VecDeque;

use husillo_planner::{LookAhead, Piece, Ramp, Stretch};

const TIMER_HZ: u32 = 72_000_000;
/// Pieces that wait for the interrupt, and events of the longest one: how late an override acts.
const WAITING: usize = 4;
const MOST: u32 = 256;

/// All that the interrupt has.
#[derive(Default)]
struct Interrupt {
    piece: Piece,
    owed: u32,
}

impl Interrupt {
    /// Ticks to the next step.
    fn run(&mut self, queue: &mut VecDeque<Piece>) -> Option<u32> {
        while self.piece.count == 0 {
            self.piece = queue.pop_front()?;
        }
        self.piece.next(&mut self.owed)
    }
}

fn main() {
    let line = Stretch {
        length_nm: 20_000_000, // 8000 steps of 2.5 um
        top_nm_per_s: 100_000_000,
        ceiling_nm_per_s: 100_000_000,
        obeys_override: true,
        acceleration_nm_per_s2: 1_000_000_000,
        start_nm_per_s: 0,
        upper: None,
        entry_limit_nm_per_s: 0,
    };
    let mut moves = LookAhead::<(), 4>::new();
    let pushed = moves.push(line, ());
    assert!(pushed.is_ok(), "there is room");
    let mut ramp = Ramp::new(TIMER_HZ);
    // 20 mm at 100 mm/s take 0.2 s.
    ramp.begin(&line, 8000, 1, u64::from(TIMER_HZ / 5) << 16);

    let (mut queue, mut interrupt) = (VecDeque::new(), Interrupt::default());
    let (mut planned, mut pieces, mut ticks, mut shortest) = (0, 0, 0_u64, u32::MAX);
    loop {
        // The main loop.
        while planned < 8000 && queue.len() < WAITING {
            let Some(piece) = ramp.take_piece(MOST, moves.limits()) else {
                break;
            };
            planned += piece.count;
            pieces += 1;
            queue.push_back(piece);
        }
        // The interrupt.
        let Some(wait) = interrupt.run(&mut queue) else {
            break;
        };
        ticks += u64::from(wait);
        shortest = shortest.min(wait);
    }
    let seconds = ticks as f64 / f64::from(TIMER_HZ);
    println!(
        "{planned} steps in {pieces} pieces of {} bytes",
        size_of::<Piece>()
    );
    println!("{seconds:.6} s, shortest interval {shortest} ticks");
    // 0.2 s at top speed, and v / a for the ramps.
    assert!((seconds - 0.3).abs() < 1e-4);
    assert_eq!(shortest, 1800);
}
