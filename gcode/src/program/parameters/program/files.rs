//! Subroutines in files of their own.

use super::{Place, Program};
use crate::error::parameters::Fault;
use crate::program::parameters::statement::Label;
use core::fmt::Debug;

/// A file that contains a subroutine.
#[derive(Copy, Clone, Debug)]
pub struct File<'t> {
    /// Its name in messages: [`Line::file`](super::super::Line::file).
    pub name: &'t [u8],
    /// Its text.
    pub text: &'t [u8],
}

/// The files of subroutines that are not in the text of the program.
///
/// The crate opens no files. The caller decides where a name is searched. A name is text of the
/// program, and may be `../../secret`, so the caller must refuse a name that leads out of its
/// folders.
pub trait Library: Debug {
    /// The file of a subroutine, by its name as written (`bore` of `o<bore> call`), or by its
    /// number in decimal digits (`100` of `o100 call` or `M98 P100`).
    fn file<'t>(&'t self, name: &[u8]) -> Option<File<'t>>;
}

/// The digits of a number, and how many there are.
fn digits(mut number: u32) -> ([u8; 10], usize) {
    let (mut digits, mut count) = ([b'0'; 10], 0);
    for slot in digits.iter_mut().rev() {
        *slot = b'0'.wrapping_add((number % 10) as u8);
        count = usize::wrapping_add(count, 1);
        number /= 10;
        if number == 0 {
            break;
        }
    }
    (digits, count)
}

impl<'t, const GLOBALS: usize, const LOCALS: usize, const DEPTH: usize, const FILES: usize>
    Program<'t, GLOBALS, LOCALS, DEPTH, FILES>
{
    /// Sets the files of subroutines that are not in the text. At most `FILES` of them are used.
    pub const fn with_library(mut self, library: &'t dyn Library) -> Self {
        self.library = Some(library);
        self
    }

    /// The first line of the file of a subroutine.
    pub(super) fn open_file(&mut self, label: Label<'_>) -> Result<Place, Fault> {
        let library = self.library.ok_or(Fault::NoSuchSubroutine)?;
        let file = match label {
            Label::Name(name) => library.file(name.trim_ascii()),
            Label::Number(number) => {
                let (digits, count) = digits(number);
                let start = digits.len().saturating_sub(count);
                library.file(digits.get(start..).unwrap_or_default())
            }
        };
        let file = file.ok_or(Fault::NoSuchSubroutine)?;
        let known = |slot: &Option<File<'_>>| match slot {
            // The same text: a file is opened once.
            Some(known) => known.name == file.name,
            None => true,
        };
        let place = self.files.iter().position(known);
        let place = place.ok_or(Fault::TooManyFiles)?;
        if let Some(slot) = self.files.get_mut(place) {
            slot.get_or_insert(file);
        }
        Ok(Place {
            // At most 255 files.
            file: u8::try_from(place.wrapping_add(1)).map_err(|_| Fault::TooManyFiles)?,
            at: 0,
            number: 1,
        })
    }

    /// The text of a file; 0 is the program itself.
    pub(super) fn text_of(&self, file: u8) -> Option<&'t [u8]> {
        match usize::from(file).checked_sub(1) {
            None => Some(self.text),
            Some(place) => Some(self.files.get(place)?.as_ref()?.text),
        }
    }

    /// The name of a file; `None` for the program itself.
    pub(super) fn name_of(&self, file: u8) -> Option<&'t [u8]> {
        let place = usize::from(file).checked_sub(1)?;
        Some(self.files.get(place)?.as_ref()?.name)
    }
}
