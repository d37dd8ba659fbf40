//! The link of the micro mill: strings that end with `;`. Every byte is echoed, and every step is
//! reported in one byte.
//!
//! ```text
//!  host ── G00X01000Y00500; ──►                 8 bits, no parity; 9600 baud unless agreed
//!       ◄─ G00X01000Y00500; ── 81 83 81 ... 8f  echo; X+ Y+ X+ ... done
//!       ── JX+; ─►  W; ─►  A; ─►                jog, faster, stop
//!       ◄─ JX+; ── 81 81 W; 81 81 A 8d ; 8c     stops at the first byte of `A;`
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
//! | `A;` | stop | [`Answer::Taken`], after a `Stopped` if something was stopped |
//! | `W;` `V;` | faster, slower: jogs only | none |
//! | `Q;` | the present position becomes the part's zero | `Done` |
//! | `G..;` `M..;` | one line of a program: [`Line`] | `Done` |
//! | `S1;` `S0;` | ours: streaming of lines on, off | `Taken` |
//! | `L0250;` | ours: a lease. Every motion ends after this silence of the host, in milliseconds, four digits; `L0000;`: a motion needs no host | `Taken` |
//! | `L;` | ours: the motion continues | none |
//! | `R010;` | ours: report one step in this many, three digits; `R000;` none | `Taken` |
//! | `I;` | ours: report position, backlash, zero and whether it is homed: [`State`] | 73 times [`Answer::Digit`], then `Taken` |
//!
//! Any string may be answered by [`Answer::Wrong`] (unknown string) or [`Answer::Refused`] (not
//! possible now, or not to that position). In this case nothing has changed. Blanks and ends of
//! lines are echoed but are not part of a string. Answers have bit 7 set, and echoes do not. A byte
//! with bit 7 is therefore echoed as `?`.
//!
//! # Motion
//!
//! While the machine moves, any byte stops it and begins a new string. However, `W;`, `V;` and `L;`
//! do not stop a jog or a motion with a lease. The host therefore sends a line when the previous
//! one is done, and the machine is at rest between lines.
//!
//! # Streaming
//!
//! After `S1;`, lines enter a queue while the machine moves, and are answered by [`Answer::Taken`].
//! [`Answer::Done`] follows when a line has been made. The host sends the next line when the last
//! one is in the queue. `A` at any position of a string stops the machine at once and clears the
//! queue.
//!
//! # Source
//!
//! The original defines the strings, the echo and one byte per step. It does not state the values
//! of these bytes or the baud rate. This link adds these values and the strings marked as ours. A
//! string may have 64 characters instead of 35, because an example of the original has 43.

mod answer;
mod device;
mod host;
mod line;
mod order;
mod reader;
mod state;
mod stops;
mod text;

pub use answer::Answer;
pub use device::Device;
pub use host::{Host, HostTiming, Outcome, Progress, Report};
pub use line::{Line, Point, XyPoint};
pub use order::{Axis, Order};
pub use state::{AxisState, State, StateDigits};
pub use stops::Stops;
pub use text::Text;

/// The longest string, including its `;`.
pub const STRING_BYTES: usize = 64;
