//! Lengths as readable text.

use crate::text::shortest;

/// Millimetres with six decimals, which show nanometres.
pub fn millimetres(nm: f64) -> String {
    let nm = nm.round();
    format!("{:.6}", if nm == 0.0 { 0.0 } else { nm / 1e6 })
}

/// A length in nm, um or mm, whichever suits its size.
pub fn length(nm: f64) -> String {
    match nm.abs() {
        below if below < 1_000.0 => format!("{} nm", shortest(nm, 3)),
        below if below < 1_000_000.0 => format!("{} um", shortest(nm / 1e3, 3)),
        _ => format!("{} mm", shortest(nm / 1e6, 3)),
    }
}
