//! The link of the micro mill: strings that end with `;`, every byte echoed, every step told in one byte.
//!
//! ```text
//!  host ── G00X01000Y00500; ──►                        8 bits, no parity; 9600 baud unless agreed otherwise
//!       ◄─ G00X01000Y00500; ── 81 83 81 ... 8f         echo; X+ Y+ X+ ... done
//!       ── JX+; ─►  W; ─►  A; ─►                       jog, faster, stop
//!       ◄─ JX+; ── 81 81 W; 81 81 A 8d ; 8c            a stop acts at its first byte
//! ```
//!
//! | string | does | answer |
//! | --- | --- | --- |
//! | `JX+;` | jog one axis | [`Answer::Stopped`] when something ends it |
//! | `&X+Y-;` | jog two or three axes | the same |
//! | `PX+1000;` | steps, four digits | [`Answer::Done`] |
//! | `FX+250;` | run at a frequency, three digits, Hz | [`Answer::Stopped`] |
//! | `BX200;` | backlash of an axis, three digits, micrometres | `Done` |
//! | `H;` | home: Z, X, Y, each to its switch and off it | `Done`, [`Answer::NoSwitch`] |
//! | `A;` | stop | [`Answer::Taken`], after a `Stopped` where something was stopped |
//! | `W;` `V;` | faster, slower: jogs only | none |
//! | `Q;` | the part's zero is here | `Done` |
//! | `G..;` `M..;` | one line of a program: [`Line`] | `Done` |
//! | `S1;` `S0;` | ours: stream lines, or not | `Taken` |
//! | `L0500;` | ours: a jog lasts so many milliseconds, four digits, after the last `L;`; `L0000;`: until it is stopped | `Taken` |
//! | `L;` | ours: the jog goes on | none |
//! | `R010;` | ours: tell every so many steps, three digits; `R000;` none | `Taken` |
//!
//! Any string may be answered by [`Answer::Wrong`] (no such string) or [`Answer::Refused`] (not now, not there): then nothing has changed.
//! Blanks and ends of lines are echoed and are no part of a string. Answers have bit 7 set, echoes have not:
//! a byte with bit 7 is echoed as `?`.
//!
//! **While it moves** any byte stops the machine and begins a new string; `W;`, `V;` and `L;` do not stop a jog. So the host sends the next
//! line when the last one is done, and the machine stands between them.
//!
//! **Streaming** (`S1;`): lines are [`Answer::Taken`] into a queue while the machine moves, [`Answer::Done`] comes as each is made; the host sends the
//! next one when the last one is taken. `A` at any place of a string stops at once and drops the queue.
//!
//! The original gives the strings, the echo and one byte a step, not the values of these bytes nor the baud rate; those, the strings marked
//! as ours and strings of 64 characters instead of 35 (its own example has 43) are this link's.

mod answer;
mod device;
mod host;
mod line;
mod order;
mod reader;
mod stops;
mod text;

pub use answer::Answer;
pub use device::Device;
pub use host::{Host, HostTiming, Outcome, Progress, Report};
pub use line::{Line, Point, XyPoint};
pub use order::{Axis, Order};
pub use stops::Stops;
pub use text::Text;

/// The longest string, its `;` counted.
pub const STRING_BYTES: usize = 64;
