//! The link of the circuit-board drill: one byte at a time, and each byte is echoed.
//!
//! ```text
//!  host ── b ─►  X lo hi  Y lo hi  Z 00 00 ...  f ─► e ─►        2400 baud, 8 bits, no parity
//!       ◄─ b ──  X lo hi  Y lo hi  Z 00 00 ...  f ◄─ e ◄─ when the program has been done
//! ```
//!
//! | byte | answer | |
//! | --- | --- | --- |
//! | `B` | `B` | link test; also sent after a reset, when the axes are home |
//! | `c` | `c` | the program becomes empty, the present position becomes X 0, Y 0 |
//! | `r` | `r` when done | home Z, Y, X |
//! | `b` | `b`, then every byte, then `f` | records of three bytes; `f` where the second or a later record would begin ends the program |
//! | `e` | `e` when done | run the program; `E` meanwhile stops it after the record in progress |
//! | `m` | `m`, an advance in steps, `m` when home | keys `D I F R U L O S r c B e a`, each echoed when done; `Q` ends the mode with `m` |
//!
//! A device with extras ([`Rules::has_extras`]) has in addition:
//!
//! | byte | answer | |
//! | --- | --- | --- |
//! | `T`, manual | `T`, or `w` if the memory is full | the present position becomes a hole at the end of the program |
//! | `O`, `S` | the same | spindle on, off |
//! | `n` lo hi, also manual | the same, then three bytes and the complement of their sum | the record of that number; after the last one `f` 00 00. The highest numbers read a [`Reading`] instead |
//! | `t` number | the same | a lease of number x 50 ms. It lasts until it expires, a reset, or `t` 00, which ends it: see below |
//! | `0` | `0` | the program becomes empty, the zero stays |
//! | `?` | `?`, text, 04 | help |
//! | `M` | `M`, an advance, `m` when home | as `m`, but no single wrong bit turns it into `e`: the program may be kept |
//! | `p`, while `e` is carried out, or anything with a lease | `*` | it is at work; `;` after the end of a lease, until it rests; `!` after a fault |
//! | a key of the manual mode | `w` | not all of its steps were made: the axis is at its end |
//! | | `>` | instead of any pending answer: the lease expired before the work was done |
//! | | `!` | instead of any pending answer: the device has stopped with a fault until a reset |
//!
//! The device holds 8192 bytes. The next byte (except `f` at the end) gets `w` instead of its echo.
//! The device then runs what it holds, empties its memory, stores the byte and echoes it. A record
//! may be divided by this border. Meanwhile the host must be silent.
//!
//! # Lease
//!
//! With a lease every motion needs its host. Each byte on the line renews the lease. A host that
//! waits for an answer sends `p`. After a silence of the whole lease the device takes no further
//! record. X and Y stop with the present step, and their positions stay known. If a hole is being
//! drilled, Z moves up, and the hole is not counted. Then the spindle stops, and the device sends
//! `>` instead of the answer. It sends nothing if `>` differs from the expected echo by less than
//! two bits. The lease has then ended.
//!
//! A host with a lease does not store beyond the memory of the device ([`Refused::Leased`]),
//! because it must be silent while a full memory is run. The original has no lease.
//!
//! [`Device`] is the controller's end, either as in the original or with its flaws corrected.
//! [`Rules`] has a name for each flaw. [`Host`] is the other end. Its waits and retries are those
//! of the original or corrected ones ([`Timing`]).
//!
//! # Faults
//!
//! An echo shows every wrong bit except one that is inverted again in the echo. With an error rate
//! of p, a rate of p^2 per bit remains undetected. A lost byte has no echo. A doubled byte has two
//! echoes, and the second one does not match the next byte sent. The letters of axes are not
//! commands, so a device that has lost its alignment does not answer them.
//!
//! Nothing runs before `e` or a full memory, and the host knows which bytes were run. After an
//! error, [`Host::done_bytes`] have certainly been done, and at most [`Host::begun_bytes`] may have
//! been done. To continue after an error, use [`Step::Resync`], [`Step::Home`], [`Step::Clear`],
//! and the program from that byte on.
//!
//! Echoes do not detect one error: `m` with one wrong bit is `e`. Therefore the host empties the
//! program before `m`. One wrong bit in the other letters is harmless: it turns `B`, `c` or `r`
//! into `b`, and `b` into `c`, `r` or `B`. `t` and `0` differ from every other command by two bits
//! or more. `*`, `;` and `>` differ from the answers to commands by three or more. A device at work
//! ignores a `p` with one wrong bit, and the host accepts a `*` or `;` with one wrong bit.

mod device;
mod host;
mod order;
mod reading;
mod record;
mod rules;
mod step;
mod timing;

pub use device::Device;
pub use host::Host;
pub use order::{Axis, Order};
pub use reading::{MachineState, Reading};
pub use record::{
    END_OF_PROGRAM, OffTable, Record, RecordBytes, RecordError, RecordErrorKind, Records,
    STEPS_PER_MM, Table, record_bytes, records,
};
pub use rules::Rules;
pub use step::{Failure, Outcome, Progress, Refused, Step};
pub use timing::Timing;

/// The number in [`Step::Read`] of [`Reading::Drillings`].
pub const COUNT: u16 = u16::MAX;
/// Asks a device with extras whether it is at work.
pub const AT_WORK: u8 = b'p';
/// The answer to [`AT_WORK`] of a device that is at work.
pub const WORKING: u8 = b'*';
/// The answer to [`AT_WORK`] of a device whose lease has expired, until the device is at rest.
pub const ENDING: u8 = b';';
/// Sent by a device whose lease expired before its work was done.
pub const EXPIRED: u8 = b'>';
/// Unit of a lease, ms.
pub const LEASE_UNIT_MS: u16 = 50;
/// Sent once by a device that has stopped with a fault.
pub const FAULT: u8 = b'!';
/// The manual mode that keeps the program.
const KEPT: u8 = b'M';
/// Requests a lease.
const LEASE: u8 = b't';
/// Empties the program and keeps the zero.
const EMPTY: u8 = b'0';
/// The answer to a key, or to teach-in, that was not carried out completely.
const NOT_ALL: u8 = b'w';
/// Ends the help text.
pub const END_OF_TEXT: u8 = 4;

/// Bytes that the controller's memory holds.
pub const MEMORY_BYTES: usize = 8192;
