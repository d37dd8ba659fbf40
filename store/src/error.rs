//! Errors of a store.

use core::fmt;

/// Error of storing or reading a content. The content stored before is unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StoreError<E> {
    /// The area is empty, is beyond the flash, is not a multiple of two erase sizes, or does not
    /// begin at a sector.
    Area,
    /// The content is longer than half of the area minus the header.
    Full,
    /// No content is stored, or the read goes beyond its end.
    Nothing,
    /// Written bytes read back differently: the flash is worn or missing.
    Differs,
    /// Error of the flash driver.
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
                out.write_str("the area is not an even number of whole flash sectors")
            }
            StoreError::Full => out.write_str("the content is longer than half of the area"),
            StoreError::Nothing => out.write_str("no content is stored there"),
            StoreError::Differs => out.write_str("written bytes read back differently"),
            StoreError::Flash(error) => write!(out, "flash: {error:?}"),
        }
    }
}

impl<E: fmt::Debug> core::error::Error for StoreError<E> {}
