//! Quantities of machine files, such as `"0.14 um"`, `"170 Hz"` and `"400 steps"`. The fraction is
//! exactly the number in the text.

/// An exact value in the base unit of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A length in nanometres.
    Length(Fraction),
    /// A number of motor steps, or of encoder counts.
    Steps(Fraction),
    /// A rate in events per second.
    Rate(Fraction),
    /// An acceleration in steps/s^2.
    Acceleration(Fraction),
    /// An acceleration of an axis in nanometres/s^2.
    AxisAcceleration(Fraction),
    /// A jerk in steps/s^3.
    Jerk(Fraction),
    /// A jerk of an axis in nanometres/s^3.
    AxisJerk(Fraction),
    /// A path speed in nanometres per minute.
    Speed(Fraction),
    /// A time in microseconds.
    Time(Fraction),
    /// A length divided by a length, in parts per 10^9.
    Ratio(Fraction),
    /// An angle in degrees.
    Angle(Fraction),
    /// A rotary speed in degrees per minute.
    RotarySpeed(Fraction),
    /// A rotary acceleration in degrees/s^2.
    RotaryAcceleration(Fraction),
    /// A rotary jerk in degrees/s^3.
    RotaryJerk(Fraction),
}

/// A reduced fraction; `den` is at least 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fraction {
    /// Numerator.
    pub num: i64,
    /// Denominator, at least 1.
    pub den: i64,
}

impl Fraction {
    /// Returns the reduced fraction, or `None` if it does not fit 64 bits.
    pub fn new(num: i128, den: i128) -> Option<Self> {
        let divisor = gcd(num.unsigned_abs(), den.unsigned_abs()).max(1) as i128;
        let (num, den) = (num / divisor, den / divisor);
        Some(Self {
            num: i64::try_from(num).ok()?,
            den: i64::try_from(den).ok().filter(|den| *den > 0)?,
        })
    }

    /// Returns the nearest integer, halves away from zero.
    pub fn rounded(self) -> i64 {
        self.over(Self { num: 1, den: 1 }).unwrap_or(0)
    }

    /// Returns the nearest integer of `self / other`, halves away from zero; `None` if `other` is
    /// not positive or the result does not fit.
    pub fn over(self, other: Self) -> Option<i64> {
        let num = i128::from(self.num) * i128::from(other.den);
        let den = i128::from(self.den) * i128::from(other.num);
        if den <= 0 {
            return None;
        }
        let rounded = (2 * num.abs() + den) / (2 * den);
        i64::try_from(rounded * num.signum()).ok()
    }
}

fn gcd(a: u128, b: u128) -> u128 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Reads `number unit`.
///
/// # Errors
///
/// A sentence, lower case: the text is not a number with a known unit.
pub fn parse(text: &str) -> Result<Quantity, String> {
    let text = text.trim();
    let split = text
        .find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | '_')))
        .unwrap_or(text.len());
    let (number, unit) = text.split_at(split);
    let (digits, places) =
        decimal(number).ok_or_else(|| format!("`{number}` is no decimal number"))?;
    let scaled = |num: i128, den: i128| {
        digits
            .checked_mul(num)
            .and_then(|num| Fraction::new(num, 10_i128.pow(places) * den))
            .ok_or_else(|| format!("`{text}` is out of range"))
    };
    Ok(match unit.trim() {
        "nm" => Quantity::Length(scaled(1, 1)?),
        "um" | "\u{b5}m" | "\u{3bc}m" => Quantity::Length(scaled(1_000, 1)?),
        "mm" => Quantity::Length(scaled(1_000_000, 1)?),
        "in" | "inch" => Quantity::Length(scaled(25_400_000, 1)?),
        "step" | "steps" | "count" | "counts" => Quantity::Steps(scaled(1, 1)?),
        "Hz" | "counts/s" => Quantity::Rate(scaled(1, 1)?),
        "kHz" => Quantity::Rate(scaled(1_000, 1)?),
        "Hz/s" | "counts/s^2" => Quantity::Acceleration(scaled(1, 1)?),
        "mm/s^2" => Quantity::AxisAcceleration(scaled(1_000_000, 1)?),
        "Hz/s^2" | "counts/s^3" => Quantity::Jerk(scaled(1, 1)?),
        "mm/s^3" => Quantity::AxisJerk(scaled(1_000_000, 1)?),
        "mm/min" => Quantity::Speed(scaled(1_000_000, 1)?),
        "mm/s" => Quantity::Speed(scaled(60_000_000, 1)?),
        "in/min" => Quantity::Speed(scaled(25_400_000, 1)?),
        "s" => Quantity::Time(scaled(1_000_000, 1)?),
        "um/m" | "\u{b5}m/m" | "\u{3bc}m/m" => Quantity::Ratio(scaled(1_000, 1)?),
        "deg" => Quantity::Angle(scaled(1, 1)?),
        "deg/min" => Quantity::RotarySpeed(scaled(1, 1)?),
        "deg/s" => Quantity::RotarySpeed(scaled(60, 1)?),
        "rpm" => Quantity::RotarySpeed(scaled(360, 1)?),
        "deg/s^2" => Quantity::RotaryAcceleration(scaled(1, 1)?),
        "deg/s^3" => Quantity::RotaryJerk(scaled(1, 1)?),
        "ms" => Quantity::Time(scaled(1_000, 1)?),
        "us" | "\u{b5}s" | "\u{3bc}s" => Quantity::Time(scaled(1, 1)?),
        "ns" => Quantity::Time(scaled(1, 1000)?),
        "" => return Err(format!("`{text}` has no unit")),
        other => return Err(format!("unknown unit `{other}`")),
    })
}

/// Digits and decimal places of a plain number. At most 18 digits, so that the products with all
/// factors above fit 128 bits.
fn decimal(text: &str) -> Option<(i128, u32)> {
    let (sign, body) = match text.strip_prefix('-') {
        Some(rest) => (-1, rest),
        None => (1, text.strip_prefix('+').unwrap_or(text)),
    };
    let (whole, part) = body.split_once('.').unwrap_or((body, ""));
    let digits: String = whole
        .chars()
        .chain(part.chars())
        .filter(|c| *c != '_')
        .collect();
    let places = part.chars().filter(|c| *c != '_').count();
    if digits.is_empty() || digits.len() > 18 || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    Some((
        sign * digits.parse::<i128>().ok()?,
        u32::try_from(places).ok()?,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_exact() {
        let length = |text| match parse(text) {
            Ok(Quantity::Length(value)) => (value.num, value.den),
            other => panic!("{text}: {other:?}"),
        };
        assert_eq!(length("0.14 um"), (140, 1));
        assert_eq!(length("204 um"), (204_000, 1));
        assert_eq!(length("0.0055 in"), (139_700, 1));
        assert_eq!(length("-0.1nm"), (-1, 10));
    }

    #[test]
    fn nonsense_is_refused() {
        for text in [
            "",
            "mm",
            "1.2.3 mm",
            "4",
            "4 parsec",
            "99999999999999999999 mm",
        ] {
            assert!(parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn backlash_in_whole_steps() {
        let step = Fraction { num: 140, den: 1 };
        assert_eq!(
            Fraction {
                num: 204_000,
                den: 1
            }
            .over(step),
            Some(1457)
        );
        assert_eq!(
            Fraction {
                num: 178_000,
                den: 1
            }
            .over(step),
            Some(1271)
        );
    }
}
