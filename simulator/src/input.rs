//! Bytes of programs and other texts, with bounds on their number.

use std::io::{self, Read};

/// Some editors write these bytes before a text in UTF-8. They are not part of the program.
pub const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Most bytes of a program or a drill file that is read as a whole, or that comes from a pipe. A
/// device such as `/dev/zero` has no end.
const MOST_BYTES: u64 = 512 << 20;
/// A reader that fails after a number of bytes.
#[derive(Debug)]
pub struct Bounded<R> {
    inner: R,
    left: u64,
    most: u64,
}

/// A reader that fails after 512 MiB.
pub const fn bounded<R>(inner: R) -> Bounded<R> {
    bounded_by(inner, MOST_BYTES)
}

/// A reader that fails after `most` bytes.
pub const fn bounded_by<R>(inner: R, most: u64) -> Bounded<R> {
    Bounded {
        inner,
        left: most,
        most,
    }
}

impl<R: Read> Read for Bounded<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(bytes)?;
        self.left = self.left.checked_sub(count as u64).ok_or_else(|| {
            let mib = self.most >> 20;
            let why = format!("more than {mib} MiB, the most of such a file that is read");
            io::Error::new(io::ErrorKind::FileTooLarge, why)
        })?;
        Ok(count)
    }
}

/// Reads to the end of an input that has one.
///
/// # Errors
///
/// Reading fails, or it is text in UTF-16.
pub fn to_end<R: Read>(mut input: Bounded<R>) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    input.read_to_end(&mut bytes)?;
    expect_bytes_of_text(&bytes)?;
    Ok(bytes)
}

/// Checks that a text does not begin as one in UTF-16 does.
///
/// # Errors
///
/// It does.
pub fn expect_bytes_of_text(begin: &[u8]) -> io::Result<()> {
    // An editor begins such a text with this mark, in one of both orders. Without a mark each
    // second byte of a letter or a digit is zero.
    let is_plain = |byte: &u8| byte.is_ascii_graphic() || byte.is_ascii_whitespace();
    match begin {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => {}
        [a, 0, b, 0, ..] | [0, a, 0, b, ..] if is_plain(a) && is_plain(b) => {}
        _ => return Ok(()),
    }
    let kind = io::ErrorKind::InvalidData;
    Err(io::Error::new(kind, "text in UTF-16: save it as UTF-8"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bound is the last number of bytes that is read, whether there are more or not.
    #[test]
    fn an_input_ends_at_its_bound() {
        let bytes = |count: u64| io::repeat(b' ').take(count);
        let most = 1 << 20;
        assert_eq!(
            to_end(bounded_by(bytes(most), most)).unwrap().len() as u64,
            most
        );
        for error in [
            to_end(bounded_by(bytes(most + 1), most)).unwrap_err(),
            to_end(bounded_by(io::repeat(b' '), most)).unwrap_err(),
        ] {
            let why = "more than 1 MiB, the most of such a file that is read";
            assert_eq!(error.to_string(), why);
        }
    }
}
