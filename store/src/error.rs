//! What can go wrong.

use core::fmt;

/// Why a content was not stored or read. What was stored before is as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StoreError<E> {
    /// The area is empty, beyond the flash, or not a multiple of two erase sizes, or it begins
    /// within a sector.
    Area,
    /// The content is longer than half of the area less the header.
    Full,
    /// Nothing is stored there.
    Nothing,
    /// What was written reads otherwise: the flash is worn, or there is none.
    Differs,
    /// The driver of the flash says so.
    Flash(E),
}

impl<E> From<E> for StoreError<E> {
    fn from(error: E) -> Self {
        StoreError::Flash(error)
    }
}

impl<E: fmt::Debug> fmt::Display for StoreError<E> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StoreError::Area => {
                out.write_str("the area is not two times so many sectors of the flash")
            }
            StoreError::Full => out.write_str("the content is longer than half of the area"),
            StoreError::Nothing => out.write_str("nothing is stored there"),
            StoreError::Differs => out.write_str("what was written reads otherwise"),
            StoreError::Flash(error) => write!(out, "flash: {error:?}"),
        }
    }
}

impl<E: fmt::Debug> core::error::Error for StoreError<E> {}
