//! Conversion of a signed drive to direction and duty.

/// Returns whether `drive` is negative, and its magnitude scaled from `full_drive` to `max_duty`,
/// rounded downwards. A larger drive counts as full. A `full_drive` of 0 gives duty 0.
///
/// # Examples
/// ```
/// use husillo_pid::sign_magnitude;
///
/// assert_eq!(sign_magnitude(-128, 255, 1000), (true, 501));
/// assert_eq!(sign_magnitude(300, 255, 1000), (false, 1000));
/// ```
pub const fn sign_magnitude(drive: i32, full_drive: u16, max_duty: u16) -> (bool, u16) {
    let (size, full) = (drive.unsigned_abs(), full_drive as u32);
    let size = if size > full { full } else { size };
    // Both factors are below 2^16. The quotient is at most `max_duty`.
    let duty = match size.wrapping_mul(max_duty as u32).checked_div(full) {
        Some(duty) => duty as u16,
        None => 0,
    };
    (drive < 0, duty)
}
