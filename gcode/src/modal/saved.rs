//! The modes that M70 and M73 save, and the blocks that restore them.

use crate::blocks::block::Block;
use crate::codes::code::{Code, Group};
use crate::codes::letters::{AXES, axis_letter};
use crate::modal::Modal;
use crate::modal::modes::FeedMode;
use crate::values::decimal::Decimal;
use crate::values::nm::Nm;

/// The modes that M70 and M73 save: plane, units, diameters, work system, distance modes, the level
/// of G98, path mode, feed and its mode, spindle, coolant and tool length.
///
/// As in LinuxCNC, the motion mode, the zeros and the shift of G92 are not saved. Cutter
/// compensation and the switches of M48 to M53 are not saved either.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub struct SavedModes {
    active: [Option<Code>; Group::MODAL],
    mist: bool,
    flood: bool,
    feed: u64,
    milli_rpm: u64,
    surface: Option<(Nm, Option<u64>)>,
    tolerance: Option<Nm>,
    length: [Nm; AXES],
}

impl SavedModes {
    fn code(&self, group: Group) -> Option<Code> {
        self.active.get(group as usize).copied().flatten()
    }

    /// The code of a group if it differs from the present one.
    fn changed(&self, now: &SavedModes, group: Group) -> Option<Code> {
        self.code(group)
            .filter(|_| self.code(group) != now.code(group))
    }

    /// The block of this number, from 0, that restores these modes; `now` are the modes before it.
    /// `None` after the last one. Blocks may be empty.
    ///
    /// Lengths are restored in millimetres, which are exact, so units and diameters come last.
    pub(crate) fn restoring(&self, number: u8, now: &SavedModes) -> Option<Block> {
        match number {
            0 => {
                let codes = [Code::Millimetres, Code::RadiusMode];
                let is_needed = self != now;
                Some(Block::of(codes.into_iter().filter(|_| is_needed), []))
            }
            1 => Some(self.values(now)),
            2 => {
                let is_flood = self.flood && !now.flood;
                Some(Block::of(is_flood.then_some(Code::Flood), []))
            }
            3 => {
                let groups = [
                    Group::Plane,
                    Group::Units,
                    Group::Diameter,
                    Group::System,
                    Group::Distance,
                    Group::CentreDistance,
                    Group::Return,
                ];
                let codes = groups
                    .into_iter()
                    .filter_map(|group| self.changed(now, group));
                let is_mist = self.mist && !now.mist;
                Some(Block::of(codes.chain(is_mist.then_some(Code::Mist)), []))
            }
            _ => None,
        }
    }

    /// Feed, spindle, path mode and tool length; coolant that goes off.
    fn values(&self, now: &SavedModes) -> Block {
        let is_feed =
            (self.feed, self.code(Group::FeedMode)) != (now.feed, now.code(Group::FeedMode));
        let is_path =
            (self.tolerance, self.code(Group::Path)) != (now.tolerance, now.code(Group::Path));
        let is_spindle = (self.milli_rpm, self.surface) != (now.milli_rpm, now.surface);
        let is_length = self.length != now.length;
        let has_length = self.length != [Nm(0); AXES];
        let is_drier = now.mist && !self.mist || now.flood && !self.flood;
        let is_blend = is_path && self.code(Group::Path) == Some(Code::Blend);
        let codes = [
            self.code(Group::FeedMode).filter(|_| is_feed),
            self.code(Group::Path).filter(|_| is_path),
            self.changed(now, Group::Spindle),
            self.code(Group::SpindleMode).filter(|_| is_spindle),
            is_length.then_some(if has_length {
                Code::DirectToolLength
            } else {
                Code::CancelToolLength
            }),
            is_drier.then_some(Code::CoolantOff),
        ];
        let scaled = |value: u64, places| {
            i64::try_from(value)
                .ok()
                .and_then(|digits| Decimal::new(digits, places))
        };
        let length = |nm: Nm, places| Decimal::new(nm.0, places);
        let speed = match self.surface {
            Some((speed, _)) => length(speed, 9),
            None => scaled(self.milli_rpm, 3),
        };
        let most = self.surface.and_then(|(_, most)| scaled(most?, 3));
        // Under G93 each move has its own feed.
        let keeps_feed =
            is_feed && self.feed != 0 && self.code(Group::FeedMode) != Some(Code::InverseTime);
        let words = [
            (b'F', scaled(self.feed, 6).filter(|_| keeps_feed)),
            (b'S', speed.filter(|_| is_spindle)),
            (b'D', most.filter(|_| is_spindle)),
            (
                b'P',
                self.tolerance
                    .and_then(|by| length(by, 6))
                    .filter(|_| is_blend),
            ),
        ];
        let lengths = (0..AXES).zip(self.length.into_iter().zip(now.length));
        let lengths = lengths.filter(|(_, (to, from))| has_length && to != from);
        Block::of(
            codes.into_iter().flatten(),
            words
                .into_iter()
                .filter_map(|(letter, value)| Some((letter, value?)))
                .chain(
                    lengths.filter_map(|(axis, (to, _))| Some((axis_letter(axis), length(to, 6)?))),
                ),
        )
    }
}

impl<const N: usize> Modal<N> {
    /// The modes that M70 and M73 save.
    pub(crate) fn saved_modes(&self) -> SavedModes {
        let mut length = [Nm(0); AXES];
        for (to, from) in length.iter_mut().zip(self.modes.length) {
            *to = from;
        }
        SavedModes {
            active: self.modes.active,
            mist: self.modes.mist,
            flood: self.modes.flood,
            feed: match self.feed_mode() {
                FeedMode::InverseTime => 0,
                _ => self.modes.feed,
            },
            milli_rpm: self.modes.milli_rpm,
            surface: self.modes.more.surface,
            tolerance: self.modes.more.tolerance,
            length,
        }
    }
}
