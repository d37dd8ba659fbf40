//! Names of files as text, with nothing lost.
//!
//! A name is bytes on most systems. Each byte that is no UTF-8 is one private character in the text
//! of a name, so the text gives the same name back. On the terminal and in JSON such a character is
//! shown by the byte, as `caf\xe9.nc`.

use std::borrow::Cow;
use std::ffi::OsStr;
use std::path::Path;
#[cfg(unix)]
use std::path::PathBuf;

/// The private character of byte 0. Those of bytes from 0x80 on stand for bytes of names.
const FIRST: u32 = 0x10_fe00;

/// Whether a character stands for a byte of a name.
pub const fn is_byte(one: char) -> bool {
    matches!(one, '\u{10fe80}'..='\u{10feff}')
}

/// The byte for which a character stands.
pub fn byte(one: char) -> Option<u8> {
    // The lowest eight bits of the character are the byte.
    is_byte(one).then(|| (u32::from(one) - FIRST) as u8)
}

/// The text of a name.
pub fn text(name: &OsStr) -> String {
    let mut text = String::new();
    for part in name.as_encoded_bytes().utf8_chunks() {
        for one in part.valid().chars() {
            match is_byte(one) {
                // Such a character in a name is four bytes like any others.
                true => push(&mut text, one.encode_utf8(&mut [0; 4]).as_bytes()),
                false => text.push(one),
            }
        }
        push(&mut text, part.invalid());
    }
    text
}

fn push(text: &mut String, bytes: &[u8]) {
    let chars = bytes
        .iter()
        .filter_map(|byte| char::from_u32(FIRST + u32::from(*byte)));
    text.extend(chars);
}

/// The path whose text this is.
#[cfg(unix)]
pub fn path(text: &Path) -> Cow<'_, Path> {
    use std::os::unix::ffi::OsStringExt;
    let Some(chars) = text.to_str().filter(|text| text.contains(is_byte)) else {
        return Cow::Borrowed(text);
    };
    let mut bytes = Vec::with_capacity(chars.len());
    for one in chars.chars() {
        match byte(one) {
            Some(byte) => bytes.push(byte),
            None => bytes.extend_from_slice(one.encode_utf8(&mut [0; 4]).as_bytes()),
        }
    }
    Cow::Owned(PathBuf::from(std::ffi::OsString::from_vec(bytes)))
}

/// The path whose text this is. A name on this system is text already.
#[cfg(not(unix))]
pub fn path(text: &Path) -> Cow<'_, Path> {
    Cow::Borrowed(text)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::os::unix::ffi::OsStrExt;

    proptest! {
        /// Any bytes come back, also those of the private characters themselves.
        #[test]
        fn a_name_is_its_text_and_back(
            parts in prop::collection::vec(prop_oneof![
                prop::collection::vec(any::<u8>(), 0..8),
                Just("\u{10fe80}\u{10feff}a\u{e9}".as_bytes().to_vec()),
                Just(b"caf\xe9.nc".to_vec()),
            ], 0..4),
        ) {
            let bytes = parts.concat();
            let text = text(OsStr::from_bytes(&bytes));
            let back = path(Path::new(&text));
            prop_assert_eq!(back.as_os_str().as_bytes(), &bytes[..]);
        }

        /// A name that is text is its own text.
        #[test]
        fn text_stays(name in "[a-zA-Z0-9 ./éµ-]{0,20}") {
            prop_assert_eq!(text(OsStr::new(&name)), name);
        }
    }
}
