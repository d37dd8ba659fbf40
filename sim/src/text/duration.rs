//! Durations as readable text.

/// A duration as in `2 min 08 s`.
pub fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match (whole / 3600, whole / 60 % 60, whole % 60) {
        (0, 0, _) => format!("{seconds:.2} s"),
        (0, minutes, rest) => format!("{minutes} min {rest:02} s"),
        (hours, minutes, rest) => format!("{hours} h {minutes:02} min {rest:02} s"),
    }
}
