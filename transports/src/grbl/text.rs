//! Text of one line, and the numbers in it.

use crate::buffer::Buffer;

/// A line of text under construction, of up to 240 bytes. Further bytes are dropped. Every message
/// is shorter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Text(Buffer<240>);

impl Default for Text {
    fn default() -> Self {
        Text::new()
    }
}

impl Text {
    /// Creates an empty line.
    pub const fn new() -> Self {
        Text(Buffer::new())
    }

    /// Returns the text.
    pub fn bytes(&self) -> &[u8] {
        self.0.bytes()
    }

    /// Appends bytes.
    pub fn put(&mut self, bytes: &[u8]) {
        self.0.extend(bytes);
    }

    /// Appends a whole number.
    pub fn put_number(&mut self, number: u64) {
        let mut digits = [b'0'; 20];
        let (mut rest, mut count) = (number, 0_usize);
        for digit in digits.iter_mut().rev() {
            // A remainder is below 10.
            *digit = b'0'.wrapping_add((rest % 10) as u8);
            rest /= 10;
            count = count.wrapping_add(1);
            if rest == 0 {
                break;
            }
        }
        let first = digits.len().saturating_sub(count);
        self.put(digits.get(first..).unwrap_or_default());
    }

    /// Appends `value / 10^places` with all its places.
    pub fn put_decimal(&mut self, value: i64, places: u8) {
        if value < 0 {
            self.put(b"-");
        }
        let one = power_of_ten(places);
        let size = value.unsigned_abs();
        self.put_number(size.checked_div(one).unwrap_or(0));
        if places == 0 {
            return;
        }
        self.put(b".");
        let mut rest = size.checked_rem(one).unwrap_or(0);
        let mut unit = one;
        for _ in 0..places {
            unit /= 10;
            let digit = rest.checked_div(unit).unwrap_or(0);
            // A digit is below 10.
            self.put(&[b'0'.wrapping_add(digit as u8)]);
            rest = rest.checked_rem(unit).unwrap_or(0);
        }
    }
}

/// Returns `10^places`. The result saturates.
pub(crate) const fn power_of_ten(places: u8) -> u64 {
    10_u64.saturating_pow(places as u32)
}

/// Returns `value / divisor`, rounded to the nearest. Halves round away from zero. The divisor is
/// above 0.
pub(crate) fn rounded(value: i64, divisor: u64) -> i64 {
    let size = value.unsigned_abs().saturating_add(divisor >> 1);
    let size = size.checked_div(divisor).unwrap_or(0);
    // The quotient is below 2^63 for a divisor above 1, and saturates otherwise.
    let size = i64::try_from(size).unwrap_or(i64::MAX);
    if value < 0 { size.wrapping_neg() } else { size }
}

/// Reads a number at the start of a text. A number has an optional sign and digits with an optional
/// point, but no exponent. Returns the number as `value / 10^places`, rounded to the nearest, and
/// the rest of the text.
///
/// Returns `None` if there is no digit, or if the value exceeds 2^62.
pub fn decimal(text: &[u8], places: u8) -> Option<(i64, &[u8])> {
    let (is_negative, mut rest) = match text.split_first() {
        Some((b'-', rest)) => (true, rest),
        Some((b'+', rest)) => (false, rest),
        _ => (false, text),
    };
    let (mut value, mut digits, mut decimals) = (0_u64, 0_u32, None);
    let mut rounds_up = false;
    while let Some((byte, next)) = rest.split_first() {
        match byte {
            b'.' if decimals.is_none() => decimals = Some(0_u8),
            b'0'..=b'9' => {
                digits = digits.saturating_add(1);
                let digit = byte.wrapping_sub(b'0');
                match &mut decimals {
                    Some(count) if *count >= places => {
                        if *count == places {
                            rounds_up = digit >= 5;
                        }
                        *count = count.saturating_add(1).max(places.saturating_add(1));
                    }
                    count => {
                        value = value.checked_mul(10)?.checked_add(digit.into())?;
                        if let Some(count) = count {
                            *count = count.saturating_add(1);
                        }
                    }
                }
            }
            _ => break,
        }
        rest = next;
    }
    if digits == 0 {
        return None;
    }
    let missing = places.saturating_sub(decimals.unwrap_or(0));
    let value = value
        .checked_mul(power_of_ten(missing))?
        .checked_add(rounds_up.into())?;
    let value = i64::try_from(value)
        .ok()
        .filter(|value| *value >> 62 == 0)?;
    // The value is below 2^62.
    let value = if is_negative {
        value.wrapping_neg()
    } else {
        value
    };
    Some((value, rest))
}

/// Reads a whole number that is the entire text.
pub(crate) fn whole<T: TryFrom<i64>>(text: &[u8]) -> Option<T> {
    if text.contains(&b'.') {
        return None;
    }
    match decimal(text, 0)? {
        (value, []) => T::try_from(value).ok(),
        _ => None,
    }
}
