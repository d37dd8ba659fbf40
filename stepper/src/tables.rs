//! The level tables: one electrical cycle in sixteen positions, position k at 22.5 k degrees
//! nominal.
//!
//! Every driver uses the same positions, so a step mode is only a stride: 4 full, 2 half, 1
//! quarter. Two phases are on at 2, 6, 10 and 14, one phase at 0, 4, 8 and 12; odd positions exist
//! for drivers with current levels only.

/// One electrical cycle of levels.
pub(crate) type Cycle = [u8; 16];

/// One cycle from its first quadrant. Each number is the current of a coil: [`FULL`], [`MORE`],
/// [`LESS`] or [`OFF`], negative with PH low.
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

/// 100 %: I1 I0 = 00.
const FULL: i8 = 4;
/// 60 % or 66.7 %: I1 I0 = 01.
const MORE: i8 = 3;
/// 20 % or 33.3 %: I1 I0 = 10.
const LESS: i8 = 2;
/// No current: I1 I0 = 11. It is not 0, because PH has a level here too: that of the previous
/// forward state.
const OFF: i8 = 1;

/// PH, I0 and I1 in bits 0, 1 and 2.
const fn bridge(current: i8) -> u8 {
    // `current` is one of the four above or its negative, so 4 - |current| is 0 to 3.
    (current > 0) as u8 | (4 - current.unsigned_abs()) << 1
}

/// PBL3717A, quarter steps with 60 %.
pub(crate) const PBL3717A: Cycle =
    bridges([[FULL, -OFF], [FULL, MORE], [FULL, FULL], [MORE, FULL]]);

/// PBL3717A, quarter steps with 20 %.
pub(crate) const PBL3717A_LOW: Cycle =
    bridges([[FULL, -OFF], [FULL, LESS], [FULL, FULL], [LESS, FULL]]);

/// The two-phase positions have 2/3 of the current in each coil, so the torque hardly changes.
pub(crate) const A3988: Cycle = bridges([[FULL, -OFF], [FULL, LESS], [MORE, MORE], [LESS, FULL]]);

/// L297: state s at position 2 s + 8. HOME is bit 6; INH1 = A or B, INH2 = C or D, which in
/// two-phase states is both high.
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

/// Eight half-step states. The quarter positions between them repeat the state below and are never
/// reached.
const fn halves(states: [u8; 8]) -> Cycle {
    let mut cycle = [0; 16];
    let mut at = 0;
    while at < 16 {
        cycle[at] = states[at / 2];
        at += 1;
    }
    cycle
}
