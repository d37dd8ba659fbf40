//! Why a block is refused, before anybody looks up where its words stand.

use crate::code::Group;
use crate::error::ErrorKind;

/// Which words of a block are at fault.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(crate) enum Place {
    /// The word of this letter.
    Word(u8),
    /// The code of this group.
    Code(Group),
    /// All axis words: from the first to the last of them.
    Axes,
    /// The motion code, or where it is modal the first axis word.
    Motion,
}

/// An error with its words in place of their columns, 12 bytes: many functions hand it on, and only the last one looks up
/// the places for an [`Error`](crate::Error).
#[derive(Copy, Clone, Debug)]
pub(crate) struct Fault {
    pub(crate) kind: ErrorKind,
    pub(crate) place: Place,
}

impl Fault {
    pub(crate) const fn at(kind: ErrorKind, letter: u8) -> Fault {
        let place = Place::Word(letter);
        Fault { kind, place }
    }

    pub(crate) const fn at_code(kind: ErrorKind, group: Group) -> Fault {
        let place = Place::Code(group);
        Fault { kind, place }
    }

    pub(crate) const fn at_axes(kind: ErrorKind) -> Fault {
        let place = Place::Axes;
        Fault { kind, place }
    }

    pub(crate) const fn at_motion(kind: ErrorKind) -> Fault {
        let place = Place::Motion;
        Fault { kind, place }
    }
}
