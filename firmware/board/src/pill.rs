//! The pins of a Black Pill and of a Blue Pill, which have the same places on both.
//!
//! | signal | pin | signal | pin |
//! | --- | --- | --- | --- |
//! | X step | PA4 | X limit | PB6 |
//! | Y step | PA5 | Y limit | PB7 |
//! | Z step | PA6 | Z limit | PB8 |
//! | X direction | PB12 | probe | PB9 |
//! | Y direction | PB13 | hold | PA1 |
//! | Z direction | PB14 | start | PB4 |
//! | motors off | PA8 | reset | PB3 |
//! | spindle on | PB0 | door | PB5 |
//! | spindle counter-clockwise | PB1 | flood coolant | PA15 |
//! | PWM of the spindle | PA7 | mist coolant | PB15 |

use super::lines::Pin;

const A: usize = 0;
const B: usize = 1;
/// Motors, from bit 0: steps, directions, mist coolant, and one pin that no signal uses.
pub const MOTORS: [Pin; 8] = [
    Pin(A, 4),
    Pin(A, 5),
    Pin(A, 6),
    Pin(B, 12),
    Pin(B, 13),
    Pin(B, 14),
    Pin(B, 15),
    Pin(B, 10),
];
/// Other outputs: motors off, spindle on, its direction, flood coolant.
pub const OUTPUTS: [Pin; 4] = [Pin(A, 8), Pin(B, 0), Pin(B, 1), Pin(A, 15)];
/// Switches to ground: limits of X, Y, Z, probe, hold, start, reset, door.
pub const INPUTS: [Pin; 8] = [
    Pin(B, 6),
    Pin(B, 7),
    Pin(B, 8),
    Pin(B, 9),
    Pin(A, 1),
    Pin(B, 4),
    Pin(B, 3),
    Pin(B, 5),
];
/// The PWM of the spindle, channel 2 of TIM3.
pub const PWM: Pin = Pin(A, 7);
