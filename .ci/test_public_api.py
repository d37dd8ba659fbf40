#!/usr/bin/env python3
"""Tests the record of a public API on a small library, with nightly Rust as the record does."""

from __future__ import annotations

import subprocess
import tempfile
import unittest
from pathlib import Path

from public_api import Crate, changes

LIBRARY = """
mod inner {
    pub struct Seen {
        pub wide: u32, // a comment
        narrow: u8,
    }
    impl Seen {
        pub fn long(
            &self,
            first: [u8; 2],
        ) -> u32 {
            self.wide + u32::from(first[0]) + u32::from(self.narrow)
        }
        fn hidden(&self) {}
    }
    pub mod all {
        pub const LIMIT: u32 = 7;
    }
}
pub use inner::Seen;
pub use inner::Seen as Other;
pub use inner::all::*;
#[derive(Clone)]
pub struct Pair(pub u32, pub *const u8);
pub struct Closed(pub u32, u8);
#[non_exhaustive]
pub enum Kind {
    One,
    Two { of: u8 },
    Three(u16),
}
pub trait Work<const N: usize> {
    type Out;
    const COUNT: usize = 3;
    fn work(&self) -> Self::Out;
    fn rest(&self) {}
}
impl Work<2> for Pair {
    type Out = u8;
    fn work(&self) -> u8 {
        1
    }
}
macro_rules! make {
    ($name:ident) => {
        pub fn $name() {}
    };
}
make!(made);
pub fn generic<T: Into<u32>>(value: T) -> u32
where
    T: Copy,
{
    value.into()
}
"""

RECORD = """
tried: mod
tried::Closed: has private fields
tried::Closed: pub struct Closed
tried::Closed::0: pub u32
tried::Kind: non_exhaustive pub enum Kind
tried::Kind::One: One
tried::Kind::Three: Three(u16)
tried::Kind::Two: Two { of: u8 }
tried::LIMIT: pub const LIMIT: u32 = 7
tried::Other: use inner::Seen
tried::Pair: impl Clone
tried::Pair: impl Work<2> for Pair
tried::Pair: impl Work<2> for Pair: type Out = u8
tried::Pair: not Send
tried::Pair: not Sync
tried::Pair: pub struct Pair
tried::Pair::0: pub u32
tried::Pair::1: pub *const u8
tried::Seen: has private fields
tried::Seen: pub struct Seen
tried::Seen::long: pub fn long( &self, first: [u8; 2], ) -> u32
tried::Seen::wide: pub wide: u32
tried::Work: pub trait Work<const N: usize>
tried::Work::COUNT: const COUNT: usize = 3
tried::Work::Out: type Out
tried::Work::rest: fn rest(&self)
tried::Work::work: fn work(&self) -> Self::Out
tried::generic: pub fn generic<T: Into<u32>>(value: T) -> u32 where T: Copy
tried::made: made (of a macro)
"""

# What is changed in the library, and what the comparison prints of it.
EDITS: tuple[tuple[str, str, list[str] | None], ...] = (
    ("    fn rest(&self) {}\n", "", ["- tried::Work::rest: fn rest(&self)"]),
    ("-> u32\nwhere\n    T: Copy,\n{", "-> u32 {", None),
    ("LIMIT: u32 = 7", "LIMIT: u32 = 8", None),
    ("pub struct Pair(pub u32, pub", "pub struct Pair(pub u32, pub(crate)", None),
    ("#[derive(Clone)]\n", "", ["- tried::Pair: impl Clone"]),
    ("#[non_exhaustive]\n", "", None),
    # Not public.
    ("fn hidden(&self) {}", "fn hidden(&self, _: u8) {}", []),
    ("        1\n", "        2\n", []),
    ("// a comment", "// another one", []),
)


def record(folder: Path, library: str) -> str:
    """The record of a library with this source."""
    source = folder / "tried.rs"
    source.write_text(library)
    options = ("--edition", "2024", "-Z", "unstable-options", "--output-format", "json")
    command = ("rustdoc", "+nightly", *options, "-A", "warnings", "-o", folder, source)
    subprocess.run(command, check=True)
    return Crate(folder / "tried.json").record()


class Record(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_each_public_item_is_a_line(self) -> None:
        self.maxDiff = None
        self.assertEqual(record(self.folder, LIBRARY), RECORD.lstrip())

    def test_each_change_of_the_api_is_printed_and_nothing_else(self) -> None:
        for before, after, printed in EDITS:
            with self.subTest(before):
                self.assertEqual(LIBRARY.count(before), 1)
                edited = record(self.folder, LIBRARY.replace(before, after))
                found = changes(RECORD.lstrip(), edited)
                if printed is None:
                    self.assertTrue(found)
                else:
                    self.assertEqual(found, printed)


if __name__ == "__main__":
    unittest.main()
