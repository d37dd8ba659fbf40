//! From bytes to lines: line ends, line numbers, checksums.

pub(crate) mod framing;
pub(crate) mod line_reader;
