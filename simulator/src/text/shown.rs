//! Text of others as it is shown: control characters are escaped, long lines are cut.

use crate::text::name;

/// A text in which control characters and changes of its direction are escaped.
pub fn shown(text: &str) -> String {
    let mut all = String::with_capacity(text.len());
    for one in text.chars() {
        push(&mut all, one);
    }
    all
}

/// Appends a character to `all`, escaped where a terminal would act on it.
pub fn push(all: &mut String, one: char) {
    if let Some(byte) = name::byte(one) {
        all.push_str(&format!("\\x{byte:02x}"));
    } else if is_obeyed(one) {
        all.push_str(&format!("\\u{:04x}", u32::from(one)));
    } else {
        all.push(one);
    }
}

/// Whether a terminal acts on a character, other than by a new line or a tab stop.
pub const fn is_obeyed(one: char) -> bool {
    match one {
        '\n' | '\t' => false,
        '\u{200e}' | '\u{200f}' | '\u{61c}' => true,
        '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => true,
        _ => one.is_ascii_control() || matches!(one, '\u{80}'..='\u{9f}'),
    }
}

/// Longest line of a message, characters.
const LONGEST: usize = 1000;

/// The beginning of a text that is too long for a message. It quotes a line of a file, or a name.
pub fn cut(text: &str) -> std::borrow::Cow<'_, str> {
    match text.char_indices().nth(LONGEST) {
        None => text.into(),
        Some((end, _)) => {
            let left_out = text.chars().count() - LONGEST;
            let begin = text.get(..end).unwrap_or_default();
            format!("{begin}... ({left_out} characters left out)").into()
        }
    }
}
