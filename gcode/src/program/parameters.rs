//! Parameters, expressions and O-words of RS-274/NGC programs.
//!
//! ```text
//! text &[u8] ──► Program ──► Line { number, block } ──► Modal::plan, as for any block
//!                  ▲  loops and calls jump in the text
//!                  └── System: positions, tool, ... (a Modal)
//! ```
//!
//! Numbers are decimals with up to 18 places ([`Value`]): `[0.1 + 0.2]` is 0.3. There is no
//! floating point, no recursion and no allocation.
//!
//! # Operators
//!
//! From the highest precedence: `**`; `*` `/` `MOD`; `+` `-`; `EQ NE GT GE LT LE`; `AND OR XOR`.
//! Equal ones, including powers, are evaluated from left to right. A leading sign belongs to its
//! number, so `-2**2` is 4. `MOD` is never negative. Truth is 1 or 0, and every value other than 0
//! is true.
//!
//! # Functions and their errors
//!
//! | function | error at most |
//! | --- | --- |
//! | `ABS FIX FUP ROUND EXISTS` | none |
//! | `+ - *` | none while 63 bits hold the digits, then half of the last place kept |
//! | `/`, `SQRT` | half of the 18th place or digit; none where they end before |
//! | `SIN COS` | 10^-15, none at quarter turns |
//! | `TAN` | 10^-15 + 10^-17 (1 + tan^2) |
//! | `ASIN ACOS ATAN` | 10^-14 degrees |
//! | `LN` | 10^-15 |
//! | `EXP` | 10^-15 or 10^-16 of itself, whichever is more |
//! | `**` | n 10^-18 of itself and 10^-18 for a whole exponent n; otherwise as EXP with the factor 1 + the logarithm |
//!
//! Words take a rounded value with 12 places.

mod value;

mod elementary;
mod function;

mod system;
mod table;

mod cursor;
mod expression;
mod extent;
mod line;
mod statement;

mod program;

pub use crate::error::parameters::Fault;
#[cfg(feature = "extended")]
pub use crate::modal::saved::SavedModes;
pub use crate::program::line::Line;
pub(crate) use extent::{extent, is_plain, program_words};
pub use program::Program;
pub use program::files::{File, Library};
pub(crate) use statement::is_flow;
pub use statement::needs_program;
pub use system::{NoMachine, System};
pub use value::Value;
