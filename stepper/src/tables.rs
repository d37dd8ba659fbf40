//! The level tables: one electrical cycle in sixteen positions, position k at 22.5 k degrees nominal.
//!
//! Every driver uses the same positions, so a step mode is only a stride: 4 full, 2 half, 1 quarter. Two phases are on
//! at 2, 6, 10 and 14, one phase at 0, 4, 8 and 12; odd positions exist for drivers with current levels only.

/// One electrical cycle of levels.
pub(crate) type Cycle = [u8; 16];

/// Coil currents of the first quadrant as the two-bit code of the bridges: 3 = 100 %, 2, 1, 0 = off.
const fn bridges(quadrant: [[i8; 2]; 4]) -> Cycle {
    let mut cycle = [0; 16];
    let mut at = 0;
    while at < 16 {
        let [a, b] = quadrant[at % 4];
        let [a, b] = match at / 4 {
            0 => [a, b],
            1 => [-b, a],
            2 => [-a, -b],
            _ => [b, -a],
        };
        cycle[at] = bridge(a) | bridge(b) << 3;
        at += 1;
    }
    cycle
}

/// PH, I0 and I1 for one current code; a phase that is off has PH high (our convention, the data sheets leave it open).
const fn bridge(code: i8) -> u8 {
    let i = 3 - code.unsigned_abs();
    (code >= 0) as u8 | i << 1
}

/// PBL3717A, quarter steps with 60 %.
pub(crate) const PBL3717A: Cycle = bridges([[3, 0], [3, 2], [3, 3], [2, 3]]);

/// PBL3717A, quarter steps with 20 %.
pub(crate) const PBL3717A_LOW: Cycle = bridges([[3, 0], [3, 1], [3, 3], [1, 3]]);

/// A3988: two phases share 2/3 each, so the torque hardly changes over the cycle.
pub(crate) const A3988: Cycle = bridges([[3, 0], [3, 1], [2, 2], [1, 3]]);

/// L297: state s at position 2 s + 8. HOME is bit 6; INH1 = A or B, INH2 = C or D, which in two-phase states is both high.
pub(crate) const L297: Cycle = halves([
    0b01_0001,  // state 4: A
    0b11_0101,  // state 5: A C
    0b10_0100,  // state 6: C
    0b11_0110,  // state 7: B C
    0b01_0010,  // state 8: B
    0b111_1010, // state 1: B D, HOME
    0b10_1000,  // state 2: D
    0b11_1001,  // state 3: A D
]);

/// Four-bit unipolar: 3, 9, 12, 6 with two phases on, 1, 8, 4, 2 with one.
pub(crate) const UNIPOLAR: Cycle = halves([1, 9, 8, 12, 4, 6, 2, 3]);

/// The two PH lines; with both phases always on, only the two-phase positions are real.
pub(crate) const PHASE_PAIR: Cycle = halves([0b01, 0b11, 0b11, 0b10, 0b10, 0b00, 0b00, 0b01]);

/// Eight half-step states; the quarter positions between them repeat the state below and are never reached.
const fn halves(states: [u8; 8]) -> Cycle {
    let mut cycle = [0; 16];
    let mut at = 0;
    while at < 16 {
        cycle[at] = states[at / 2];
        at += 1;
    }
    cycle
}
