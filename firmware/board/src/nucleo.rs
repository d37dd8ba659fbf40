//! The pins of a Nucleo-64 board with an Arduino CNC shield (version 3), as Grbl 1.1 uses them.
//!
//! | signal | shield | pin | signal | shield | pin |
//! | --- | --- | --- | --- | --- | --- |
//! | X step | D2 | PA10 | X limit | D9 | PC7 |
//! | Y step | D3 | PB3 | Y limit | D10 | PB6 |
//! | Z step | D4 | PB5 | Z limit | D12 | PA6 |
//! | X direction | D5 | PB4 | probe | A5 | PC0 |
//! | Y direction | D6 | PB10 | hold | A1 | PA1 |
//! | Z direction | D7 | PA8 | start | A2 | PA4 |
//! | motors off | D8 | PA9 | reset | A0 | PA0 |
//! | PWM of the spindle | D11 | PA7 | flood coolant | A3 | PB0 |
//! | spindle counter-clockwise | D13 | PA5 | mist coolant | A4 | PC1 |
//! | spindle on | none | PC10 | door | none | PC2 |
//!
//! The link is USART2 at PA2 and PA3, which the ST-LINK of the board makes a port on USB.

use super::lines::Pin;

const A: usize = 0;
const B: usize = 1;
const C: usize = 2;
/// Motors, from bit 0: steps, directions, mist coolant, and one pin that no signal uses.
pub const MOTORS: [Pin; 8] = [
    Pin(A, 10),
    Pin(B, 3),
    Pin(B, 5),
    Pin(B, 4),
    Pin(B, 10),
    Pin(A, 8),
    Pin(C, 1),
    Pin(C, 11),
];
/// Other outputs: motors off, spindle on, its direction, flood coolant.
pub const OUTPUTS: [Pin; 4] = [Pin(A, 9), Pin(C, 10), Pin(A, 5), Pin(B, 0)];
/// Switches to ground: limits of X, Y, Z, probe, hold, start, reset, door.
pub const INPUTS: [Pin; 8] = [
    Pin(C, 7),
    Pin(B, 6),
    Pin(A, 6),
    Pin(C, 0),
    Pin(A, 1),
    Pin(A, 4),
    Pin(A, 0),
    Pin(C, 2),
];
/// The PWM of the spindle, channel 2 of TIM3.
pub const PWM: Pin = Pin(A, 7);
