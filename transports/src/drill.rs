//! The link of the circuit-board drill: one byte at a time, each echoed.
//!
//! ```text
//!  host ── b ─►  X lo hi  Y lo hi  Z 00 00 ...  f ─► e ─►        2400 baud, 8 bits, no parity
//!       ◄─ b ──  X lo hi  Y lo hi  Z 00 00 ...  f ◄─ e ◄─ when the program is done
//! ```
//!
//! | byte | answer | |
//! | --- | --- | --- |
//! | `B` | `B` | link test; also sent after a reset, when the axes are home |
//! | `c` | `c` | the program is empty, the present place is X 0, Y 0 |
//! | `r` | `r` when done | home Z, Y, X |
//! | `b` | `b`, then every byte, then `f` | records of three bytes; `f` where the second or a later one would begin ends the program |
//! | `e` | `e` when done | run the program; `E` meanwhile stops after the record that is being done |
//! | `m` | `m`, an advance in steps, `m` when home | keys `D I F R U L O S r c B e a`, each echoed when done; `Q` ends with `m` |
//!
//! With extras ([`Rules::has_extras`]) also:
//!
//! | byte | answer | |
//! | --- | --- | --- |
//! | `T`, manual | `T`, or `w` where the memory is full | the present place is a hole at the end of the program |
//! | `O`, `S` | the same | spindle on, off |
//! | `n` lo hi | the same, then three bytes and the complement of their sum | the record of that number; behind the last one `f` 00 00. For ff ff instead how many drillings of programs were done since `c`: `c` lo hi, or `B` lo hi where there was no `c` since the reset |
//! | `?` | `?`, text, 04 | help |
//! | `M` | `M`, an advance, `m` when home | as `m`, with no wrong bit that makes `e` of it: the program may be kept |
//! | `p`, while `e` is carried out | `p` | the program runs |
//! | a key of the manual mode | `w` | not all of its steps were made: the axis is at its end |
//! | | `!` | in place of any answer to come: it stands for a fault until a reset |
//!
//! The device holds 8192 bytes. The next byte (but `f` at the end) gets `w` instead of its echo: the device does what it holds, begins anew, keeps the
//! byte and echoes it then; a record may lie across that border. The host has to be silent meanwhile.
//!
//! [`Device`] is the controller's end, as it was or with its flaws mended, each by a name ([`Rules`]); [`Host`] the other, with waits and
//! retries as they were or as they should be ([`Timing`]).
//!
//! # Faults
//!
//! An echo shows every wrong bit but one that the way back undoes, so an error rate p leaves p^2 a bit. A byte that is lost has no echo, one that
//! comes twice has two, and what follows the second is no echo of what was sent; letters of axes are no commands, so a device that has
//! lost its place does not answer them. Nothing is run before `e` or a border, and the host knows which bytes were: after an error what is
//! certainly done is [`Host::done_bytes`], and at most [`Host::begun_bytes`] may be. Going on after an error is
//! [`Step::Resync`], [`Step::Home`], [`Step::Clear`], and the program from there.
//!
//! What echoes cannot show: `m` with one wrong bit is `e`, so the host empties the program before; the same for every other letter
//! is harmless: `b` for `B`, `c`, `r`, and `c`, `r`, `B` for `b`.

mod device;
mod host;
mod order;
mod record;
mod rules;
mod step;
mod timing;

pub use device::Device;
pub use host::Host;
pub use order::{Axis, Order};
pub use record::{
    END_OF_PROGRAM, OffTable, Record, RecordBytes, RecordError, RecordErrorKind, Records,
    STEPS_PER_MM, Table, record_bytes, records,
};
pub use rules::Rules;
pub use step::{Failure, Outcome, Progress, Refused, Step};
pub use timing::Timing;

/// The number of [`Step::Read`] that asks how many drillings of programs were done since `c`, modulo 2^16.
pub const COUNT: u16 = u16::MAX;
/// Asks whether a program runs, and says that it does.
pub const AT_WORK: u8 = b'p';
/// Told once by a device that stands for a fault.
pub const FAULT: u8 = b'!';
/// The manual mode without clearing the program.
const KEPT: u8 = b'M';
/// The answer to a key, or to teach-in, of which not all was done.
const NOT_ALL: u8 = b'w';
/// Ends the help text.
pub const END_OF_TEXT: u8 = 4;

/// Bytes that the controller's memory holds.
pub const MEMORY_BYTES: usize = 8192;
