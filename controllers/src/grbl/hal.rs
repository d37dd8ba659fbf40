//! The protocol of grblHAL: what it adds to that of Grbl, and where it differs.
//!
//! ```text
//!  byte ─► realtime       0x80 to 0x8A, 0x19, 0xA3
//!      └─► line           raw lines of up to 255 characters
//!            ├─► dollar   settings by number, information, switches, tool length
//!            ├─► list     lists that are sent one line at a time
//!            └─► code     codes beyond those of Grbl
//!  report                 status reports by fields, modal state
//!  tool                   change of a tool, length by probe; table: what is kept
//! ```

mod code;
mod dollar;
mod line;
mod list;
mod memory;
mod realtime;
mod report;
mod row;
mod setting;
mod table;
mod tool;

use husillo_gcode::Modal;
use husillo_transports::grbl::{Accessories, ErrorCode, Receiver};

use super::{Grbl, Protocol};

pub(super) use code::{Extra, extra_code, extra_m, extra_motion};
pub(super) use line::{RawLine, RawReader};
pub(super) use list::Listing;
pub(super) use memory::HalMemory;
pub(super) use tool::Change;

use realtime::HalFlags;

/// Characters of the present line.
pub(super) const LINE: usize = 255;

/// State that only this protocol has.
#[derive(Clone, Debug)]
pub(super) struct Hal {
    pub(super) reader: RawReader,
    /// The error that refuses all further blocks until an empty line or a `$` command.
    pub(super) refusal: Option<ErrorCode>,
    flags: HalFlags,
    /// M1 has no effect (0x88).
    ignores_optional_stop: bool,
    /// The machine holds after each block that moves (0x89).
    is_single_block: bool,
    /// A hold follows the present motion.
    holds_next: bool,
    /// Lines that begin with `/` are dropped.
    deletes_blocks: bool,
    /// Overrides of feed and spindle that M49 to M51 have switched off.
    is_fixed: [bool; 2],
    shown: Shown,
    /// Canned cycles return to R (G99).
    returns_to_r: bool,
    /// The axes were homed.
    pub(super) is_homed: bool,
    /// Position of Z at the contact of the reference tool, in nanometres.
    reference: Option<i64>,
    pub(super) change: Change,
    /// Bytes that wait until a tool is changed.
    stash: Option<Receiver<256>>,
    /// The modes that M70 has saved.
    saved: Option<Modal<3>>,
    /// The controller has started before, and its present start is the first one.
    has_started: bool,
    is_power_on: bool,
    /// Microseconds until the next report without a request.
    report_us: u32,
}

/// What the last status report has shown.
#[derive(Clone, Copy, Debug, Default)]
struct Shown {
    overrides: [u8; 3],
    accessories: Accessories,
    frame: u8,
    /// Reports until the work zero and the overrides are due again.
    left: [u8; 2],
    /// Fields of the next report.
    with_accessories: bool,
    with_home: bool,
    with_tool: bool,
    with_reference: bool,
}

impl Hal {
    pub(super) const fn new() -> Self {
        Hal {
            reader: RawReader::new(),
            refusal: None,
            flags: HalFlags::NONE,
            ignores_optional_stop: false,
            is_single_block: false,
            holds_next: false,
            deletes_blocks: false,
            is_fixed: [false; 2],
            returns_to_r: false,
            shown: Shown {
                overrides: [100; 3],
                accessories: Accessories(0),
                frame: 0,
                left: [0; 2],
                with_accessories: true,
                with_home: false,
                with_tool: false,
                with_reference: true,
            },
            is_homed: false,
            reference: None,
            change: Change::NONE,
            stash: None,
            saved: None,
            has_started: false,
            is_power_on: false,
            report_us: 0,
        }
    }

    /// Whether the sender works while the operator changes the tool.
    pub(super) const fn is_acknowledged(&self) -> bool {
        self.stash.is_some()
    }

    /// Whether the operator changes the tool, and the sender works meanwhile.
    pub(super) fn is_changing_by_hand(&self) -> bool {
        self.is_acknowledged() && self.change.is_waiting()
    }

    /// Returns the state after a soft reset.
    fn after_reset(&self) -> Self {
        Hal {
            ignores_optional_stop: self.ignores_optional_stop,
            is_single_block: self.is_single_block,
            deletes_blocks: self.deletes_blocks,
            is_homed: self.is_homed,
            reference: self.reference,
            has_started: true,
            shown: Shown {
                with_home: self.shown.with_home,
                ..Hal::new().shown
            },
            ..Hal::new()
        }
    }
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Whether the controller speaks the protocol of grblHAL.
    pub(super) const fn is_hal(&self) -> bool {
        matches!(self.options.protocol, Protocol::GrblHal)
    }
}
