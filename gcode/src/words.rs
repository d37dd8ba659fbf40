//! From a line, or from bytes as they arrive, to words: letters with exact numbers.

pub(crate) mod comment;
mod numeral;
mod scanner;
pub(crate) mod word;
pub(crate) mod word_reader;
