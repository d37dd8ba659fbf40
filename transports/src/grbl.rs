//! Grbl 1.1: lines and real-time bytes, for a controller and for a sender.
//!
//! ```text
//!  sender      line ─► Window: may it be sent?          reply line ─► Message::parse
//!  controller  byte ─► Receiver ─► Realtime             Message::write ─► reply line
//!                         └► buffer ─► LineReader ─► line
//! ```
//!
//! Real-time bytes take effect immediately, at any position of the stream. All other bytes wait in
//! the receive buffer. A line ends at a CR or an LF. The controller answers each line with `ok` or
//! `error:N`. All other replies are not answers.
//!
//! Positions are in nanometres. A controller prints millimetres with three decimals, or inches with
//! four. [`Message::parse`] recognises the unit by this number.
//!
//! # Source
//! Grbl 1.1h, observed: recorded dialogues in `controllers/tests/data/grbl`.

mod alarm;
mod error;
mod height_line;
mod line_reader;
mod message;
mod modal_state;
mod place;
mod realtime;
mod receiver;
mod setting;
mod settings;
mod status;
mod text;
mod window;

pub use alarm::Alarm;
pub use error::ErrorCode;
pub use height_line::{HeightLine, MOST_HEIGHTS};
pub use line_reader::{Line, LineReader};
pub use message::{Feedback, Message};
pub use modal_state::ModalState;
pub use place::{Parameter, Place, Units};
pub use realtime::{Adjust, Realtime};
pub use receiver::Receiver;
pub use setting::{SETTINGS, Setting, SettingKind};
pub use settings::{Settings, key_and_value};
pub use status::{Accessories, Pins, Position, State, Status};
pub use text::{Text, decimal};
pub use window::Window;

/// Size of the receive buffer that a controller reports, in bytes.
pub const RECEIVE_BYTES: u8 = 128;

/// Largest number of characters of a line, without blanks and comments.
pub const LINE_CHARACTERS: usize = 79;

/// Largest number of axes of a position.
pub const MOST_AXES: usize = 6;
