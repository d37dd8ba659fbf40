//! A counter of 16 bits on a bus of 8 bits, read while it runs.

/// A byte of a counter of 16 bits.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Byte {
    /// Bits 8 to 15.
    High,
    /// Bits 0 to 7.
    Low,
}

/// Reads a counter that runs while it is read: high, low, low, high byte, in this order.
///
/// The value is exactly that at the second reading of the low byte, if the counter runs in one
/// direction during the four readings and by less than 128 counts. `None` if the bytes contradict
/// that: read again.
///
/// A counter that reverses within the four readings, and passes a carry in both directions, may be
/// read 256 off by any rule: high bytes 0, 0 and low bytes 0, 0 are 0, 0, 0, 0 and also 255, 256,
/// 256, 255. A caller that reads at least every 127 counts needs only the low byte and
/// [`Extended::<8>`](crate::Extended), which does not have this problem.
///
/// # Examples
/// ```
/// use husillo_encoder::{Byte, read_running};
///
/// // Runs from 0x04ff over 0x0500 between the second and the third reading.
/// let mut values = [0x04fe_u16, 0x04ff, 0x0500, 0x0501].into_iter();
/// let value = read_running(|byte| {
///     let [high, low] = values.next().unwrap().to_be_bytes();
///     if byte == Byte::High { high } else { low }
/// });
/// assert_eq!(value, Some(0x0500));
/// ```
pub fn read_running<R: FnMut(Byte) -> u8>(mut read: R) -> Option<u16> {
    // The elements of an array are evaluated in order.
    running_value([
        read(Byte::High),
        read(Byte::Low),
        read(Byte::Low),
        read(Byte::High),
    ])
}

/// Returns the value of a counter from its bytes in the order high, low, low, high. See
/// [`read_running`].
pub const fn running_value([high, low, low_again, high_again]: [u8; 4]) -> Option<u16> {
    // With less than 128 counts before and after a carry, low bytes below 128 belong to the higher
    // value.
    let high_now = match high_again.wrapping_sub(high) {
        // There is no carry if the low bytes are less than half of their range apart.
        0 if low.abs_diff(low_again) < 128 => high,
        // A carry upwards: above it the second high byte is valid.
        1 if low_again < 128 => high_again,
        1 if low >= 128 => high,
        // A carry downwards: below it the second high byte is valid.
        255 if low_again >= 128 => high_again,
        255 if low < 128 => high,
        _ => return None,
    };
    Some(u16::from_be_bytes([high_now, low_again]))
}
