//! Numbers as readable text.

/// A number with at most `decimals` decimals, without trailing zeros.
pub fn shortest(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    if decimals == 0 {
        return text;
    }
    let text = text.trim_end_matches('0').trim_end_matches('.');
    match text {
        "-0" => "0".to_owned(),
        text => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_trailing_zeros() {
        assert_eq!(shortest(1200.0, 3), "1200");
        assert_eq!(shortest(0.0625, 3), "0.062");
        assert_eq!(shortest(-0.001, 2), "0");
        assert_eq!(shortest(120.4, 0), "120");
    }
}
