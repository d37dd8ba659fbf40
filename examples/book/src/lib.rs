//! Stand-ins for a board, so that the programs of the book run on any computer: pins that count
//! their edges, a clock, a flash in RAM, a serial port, a line of servo modules.
//!
//! They implement the traits of `embedded-hal`, `embedded-io` and `embedded-storage`, as the pins
//! and ports of a chip do. The programs know these traits only.

pub mod clock;
pub mod flash;
pub mod module_line;
pub mod pin;
pub mod serial;
