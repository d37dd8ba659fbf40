//! Status packets.
//!
//! ```text
//!  status | items in the order of their bits | sum of all before, modulo 256
//! ```
//! There is no header, no address and no length. A reader must know the items that were set.

use crate::buffer::{Buffer, Fields};

use super::frame::sum;
use super::{Auxiliary, Items, Status};

/// Bytes of the longest status packet.
pub const LONGEST_REPLY: usize = 19;

/// All readings of a module. A reply has some of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Readings {
    /// Counts.
    pub position: i32,
    /// Of the converter.
    pub current: u8,
    /// Counts per servo cycle without fraction. The original reports the **negative** of the
    /// motion, see [`reported_velocity`].
    pub velocity: i16,
    /// Auxiliary status.
    pub auxiliary: Auxiliary,
    /// Home position in counts.
    pub home: i32,
    /// Counts; version 5 and later.
    pub position_error: i16,
    /// Points in the buffer; version 5 and later.
    pub path_points: u8,
    /// 0 for a servo; filled in by [`Module`](super::Module).
    pub kind: u8,
    /// 4 for the original's chip; filled in by [`Module`](super::Module).
    pub version: u8,
}

/// Converts a velocity in counts per cycle, 16.16, to the item VELOCITY: negated, in whole counts,
/// saturated.
pub const fn reported_velocity(velocity: i32) -> i16 {
    // An i32 shifted by 16 fits i16. Only the negation of the lowest value must saturate.
    ((velocity >> 16) as i16).saturating_neg()
}

/// A complete status packet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reply {
    /// The status byte.
    pub status: Status,
    /// The items of this reply.
    pub items: Items,
    /// The readings. Those that are not in the reply are 0.
    pub readings: Readings,
}

impl Reply {
    /// Returns the position, if the reply has it.
    pub fn position(&self) -> Option<i32> {
        self.has(Items::POSITION).then_some(self.readings.position)
    }

    /// Returns the velocity, if the reply has it. The sign is as on the line.
    pub fn velocity(&self) -> Option<i16> {
        self.has(Items::VELOCITY).then_some(self.readings.velocity)
    }

    /// Returns the auxiliary status, if the reply has it.
    pub fn auxiliary(&self) -> Option<Auxiliary> {
        self.has(Items::AUXILIARY)
            .then_some(self.readings.auxiliary)
    }

    /// Returns the home position, if the reply has it.
    pub fn home(&self) -> Option<i32> {
        self.has(Items::HOME).then_some(self.readings.home)
    }

    /// Reads a packet with these items. Returns `None` if its length or its sum is wrong.
    pub fn decode(bytes: &[u8], items: Items) -> Option<Reply> {
        let (last, told) = bytes.split_last()?;
        if told.len() != items.length().wrapping_add(1) || *last != sum(told, 0) {
            return None;
        }
        let mut fields = Fields(told);
        let status = Status(fields.u8()?);
        let mut readings = Readings::default();
        let has = |item: Items| items.contains(item);
        if has(Items::POSITION) {
            readings.position = fields.u32()? as i32; // the same bits
        }
        if has(Items::CURRENT) {
            readings.current = fields.u8()?;
        }
        if has(Items::VELOCITY) {
            readings.velocity = fields.u16()? as i16;
        }
        if has(Items::AUXILIARY) {
            readings.auxiliary = Auxiliary(fields.u8()?);
        }
        if has(Items::HOME) {
            readings.home = fields.u32()? as i32;
        }
        if has(Items::DEVICE) {
            readings.kind = fields.u8()?;
            readings.version = fields.u8()?;
        }
        if has(Items::POSITION_ERROR) {
            readings.position_error = fields.u16()? as i16;
        }
        if has(Items::PATH_POINTS) {
            readings.path_points = fields.u8()?;
        }
        Some(Reply {
            status,
            items,
            readings,
        })
    }

    pub(super) fn encode(&self) -> Buffer<LONGEST_REPLY> {
        let mut bytes = Buffer::new();
        bytes.push(self.status.0);
        let (readings, has) = (&self.readings, |item| self.has(item));
        if has(Items::POSITION) {
            bytes.extend(&readings.position.to_le_bytes());
        }
        if has(Items::CURRENT) {
            bytes.push(readings.current);
        }
        if has(Items::VELOCITY) {
            bytes.extend(&readings.velocity.to_le_bytes());
        }
        if has(Items::AUXILIARY) {
            bytes.push(readings.auxiliary.0);
        }
        if has(Items::HOME) {
            bytes.extend(&readings.home.to_le_bytes());
        }
        if has(Items::DEVICE) {
            bytes.extend(&[readings.kind, readings.version]);
        }
        if has(Items::POSITION_ERROR) {
            bytes.extend(&readings.position_error.to_le_bytes());
        }
        if has(Items::PATH_POINTS) {
            bytes.push(readings.path_points);
        }
        bytes.push(sum(bytes.bytes(), 0)); // 1 + 17 + 1 bytes
        bytes
    }

    fn has(&self, item: Items) -> bool {
        self.items.contains(item)
    }
}
