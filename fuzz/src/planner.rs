//! Any timer.

use husillo_planner::Timer;

use crate::bytes::Bytes;

/// Waits of any move. They are never ahead of the due time by more than a tick, and a whole move
/// takes exactly its ticks.
pub fn planner(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let (ticks, largest) = (bytes.u64() >> 12, (bytes.u64() >> 33) as u32);
    let mut sweeps = Vec::new();
    while !bytes.is_empty() {
        sweeps.push((bytes.u64() % (u64::from(largest) + 1)) as u32); // largest < 2^31
    }
    let sweep: u64 = sweeps.iter().copied().map(u64::from).sum();
    // No input panics.
    let mut other = Timer::with_fraction_bits(bytes.u64(), sweep, (ticks % 256) as u8);
    let mut timer = Timer::new(ticks, sweep, largest);
    let exact = u128::from(ticks) * u128::from(largest) < 1 << 92
        && u128::from(ticks) * u128::from(largest) < u128::from(sweep.max(1)) << 61;
    let (mut passed, mut swept) = (0_u128, 0_u128);
    for piece in sweeps {
        other.wait(piece);
        passed += u128::from(timer.wait(piece));
        swept += u128::from(piece);
        if exact {
            let due = u128::from(ticks) * swept / u128::from(sweep.max(1));
            assert!(
                passed == due || passed == due + 1,
                "{passed} ticks where {due} are due"
            );
        }
    }
    if exact && sweep > 0 {
        assert_eq!(passed, u128::from(ticks), "the whole move takes its time");
    }
}
