//! `husillo machines new`: checks a few figures, and makes a machine file of them.

use crate::machines::machine_file::MachineFile;
use std::fmt::Write as _;

/// A figure of an axis that is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// Steps per millimetre or degree.
    Steps,
    /// Highest speed, per minute.
    MaxRate,
    /// Acceleration, per s^2; empty: no ramp.
    Acceleration,
    /// Speed at which it may start and stop; empty: it starts from standstill.
    StartRate,
    /// Speed above which its motor loses steps; empty: not known.
    PullOut,
    /// Lowest and highest position, `0..300`; empty: no limits.
    Travel,
}

impl Figure {
    /// All figures, in the order of the questions.
    pub const ALL: [Figure; 6] = [
        Figure::Steps,
        Figure::MaxRate,
        Figure::Acceleration,
        Figure::StartRate,
        Figure::PullOut,
        Figure::Travel,
    ];

    /// The question for an axis whose lengths have this unit.
    pub fn question(self, axis: char, unit: &str) -> String {
        match self {
            Figure::Steps => format!("{axis}: steps per {unit}"),
            Figure::MaxRate => format!("{axis}: highest speed in {unit}/min"),
            Figure::Acceleration => {
                format!("{axis}: acceleration in {unit}/s^2 (empty: without ramps)")
            }
            Figure::StartRate => {
                format!("{axis}: speed at which it may start and stop, {unit}/min (empty: 0)")
            }
            Figure::PullOut => {
                format!(
                    "{axis}: speed above which its motor loses steps, {unit}/min (empty: not known)"
                )
            }
            Figure::Travel => {
                format!("{axis}: travel in {unit}, as 0..300 (empty: without limits)")
            }
        }
    }

    /// Whether it may be left out.
    pub const fn is_optional(self) -> bool {
        !matches!(self, Figure::Steps | Figure::MaxRate)
    }
}

/// The figures of an axis as the user typed them. One that was left out is empty.
#[derive(Clone, Debug, Default)]
pub struct Axis {
    /// `X`, `A`, ...
    pub letter: char,
    /// In the order of [`Figure::ALL`].
    pub figures: [String; 6],
}

impl Axis {
    /// Whether its lengths are degrees.
    pub const fn is_rotary(&self) -> bool {
        matches!(self.letter, 'A' | 'B' | 'C')
    }

    /// The unit of its lengths in words.
    pub const fn unit(&self) -> &'static str {
        if self.is_rotary() { "degree" } else { "mm" }
    }

    /// Its table in a machine file.
    ///
    /// # Errors
    ///
    /// A figure is not a number.
    fn table(&self) -> Result<String, String> {
        let unit = if self.is_rotary() { "deg" } else { "mm" };
        let [steps, max, acceleration, start, pull_out, travel] = &self.figures;
        let mut text = format!("[axis.{}]\n", self.letter.to_ascii_lowercase());
        if self.is_rotary() {
            text.push_str("kind = \"rotary\"\n");
        }
        let _ = writeln!(text, "{}", self.step(steps)?);
        let travel = match travel.trim() {
            "" => "\"unlimited\"".to_owned(),
            range => {
                let (low, high) = range
                    .split_once("..")
                    .ok_or_else(|| format!("{}: travel `{range}` is not as 0..300", self.letter))?;
                let [low, high] = [self.number(low)?, self.number(high)?];
                format!("[\"{low} {unit}\", \"{high} {unit}\"]")
            }
        };
        let _ = writeln!(text, "travel = {travel}\nbacklash = \"0 steps\"");
        let speeds = [
            ("max_rate", max),
            ("start_rate", start),
            ("pull_out_rate", pull_out),
        ];
        for (key, value) in speeds {
            if !value.trim().is_empty() {
                let _ = writeln!(text, "{key} = \"{} {unit}/min\"", self.number(value)?);
            }
        }
        if !acceleration.trim().is_empty() {
            let value = self.number(acceleration)?;
            let _ = writeln!(text, "acceleration = \"{value} {unit}/s^2\"");
        }
        text.push_str("driver = \"step-direction\"\n");
        Ok(text)
    }

    /// The line with the length of a step, exact for whole steps per unit.
    fn step(&self, steps: &str) -> Result<String, String> {
        let number = self.number(steps)?;
        let value: f64 = number.parse().unwrap_or(0.0);
        if value <= 0.0 {
            return Err(format!(
                "{}: steps per {} are above 0",
                self.letter,
                self.unit()
            ));
        }
        if value.fract() == 0.0 {
            return Ok(format!("steps_per_{} = {value}", self.unit()));
        }
        let unit = if self.is_rotary() { "deg" } else { "mm" };
        Ok(format!("step = \"{:.9} {unit}\"", 1.0 / value))
    }

    /// Returns a number as the user typed it.
    fn number(&self, text: &str) -> Result<String, String> {
        let text = text.trim();
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() && !text.contains(['e', 'E']) => Ok(text.to_owned()),
            _ => Err(format!("{}: `{text}` is no number", self.letter)),
        }
    }

    /// What is wrong with its figures.
    pub fn mistakes(&self) -> Vec<String> {
        let others = ['X', 'Y', 'Z']
            .into_iter()
            .filter(|letter| *letter != self.letter);
        let mut axes: Vec<Axis> = others.map(Axis::plain).collect();
        axes.push(self.clone());
        match text("trial", &axes) {
            Ok(text) => mistakes(&text),
            Err(why) => vec![why],
        }
    }

    /// An axis without a mistake.
    fn plain(letter: char) -> Axis {
        let figures = ["100", "600", "", "", "", ""].map(str::to_owned);
        Axis { letter, figures }
    }
}

/// The findings of the reader of machine files in a text.
fn mistakes(text: &str) -> Vec<String> {
    let findings = MachineFile::parse("new", text).err().unwrap_or_default();
    let mut messages: Vec<String> = findings
        .into_iter()
        .map(|finding| match finding.label.is_empty() {
            true => finding.message,
            false => format!("{}: {}", finding.message, finding.label),
        })
        .collect();
    messages.dedup();
    messages
}

/// The text of a machine file.
///
/// # Errors
///
/// A figure is no number, or the reader of machine files finds a mistake.
pub fn text(name: &str, axes: &[Axis]) -> Result<String, String> {
    let mut text = format!(
        "# Made by `husillo machines new`; husillo machines show {name}.toml\n\
         schema = 1\nname = \"{name}\"\ntitle = \"{name}\"\ntimer_hz = 8_000_000\n"
    );
    let mut axes: Vec<&Axis> = axes.iter().collect();
    axes.sort_by_key(|axis| "XYZABCUVWE".find(axis.letter));
    for axis in axes {
        text.push('\n');
        text.push_str(&axis.table()?);
    }
    text.push_str("\n[motion]\ncorner_deviation = \"20 um\"\n");
    Ok(text)
}

/// Checks the text of a machine file.
///
/// # Errors
///
/// All mistakes, one per line.
pub fn checked(text: String) -> Result<String, String> {
    match mistakes(&text) {
        found if found.is_empty() => Ok(text),
        found => Err(found.join("\n")),
    }
}

/// Reads values by axis, such as `X80Y80Z400` or `X0..300 Z-45..5`.
///
/// # Errors
///
/// A letter is not an axis, or occurs twice.
pub fn by_axis(text: &str) -> Result<Vec<(char, String)>, String> {
    let mut values: Vec<(char, String)> = Vec::new();
    for letter in text.chars().filter(|letter| !letter.is_whitespace()) {
        let upper = letter.to_ascii_uppercase();
        match values.last_mut() {
            _ if "XYZABCUVWE".contains(upper) => {
                if values.iter().any(|(known, _)| *known == upper) {
                    return Err(format!("`{text}` has {upper} twice: leave one out"));
                }
                values.push((upper, String::new()));
            }
            Some((_, value)) => value.push(letter),
            None => {
                return Err(format!(
                    "`{text}` does not begin with an axis, as in X80Y80"
                ));
            }
        }
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(letter: char, figures: [&str; 6]) -> Axis {
        Axis {
            letter,
            figures: figures.map(str::to_owned),
        }
    }

    #[test]
    fn figures_make_a_machine() {
        let axes = [
            axis('X', ["80", "6000", "500", "60", "9000", "0..300"]),
            axis('Y', ["80", "6000", "500", "", "", "0..180"]),
            axis('Z', ["400", "1800", "", "", "", "-45..5"]),
            axis('A', ["88.888889", "7200", "1000", "", "", ""]),
        ];
        let text = checked(text("mine", &axes).unwrap()).unwrap();
        let file = MachineFile::parse("mine.toml", &text).unwrap();
        assert_eq!(file.axes.len(), 4);
        assert_eq!((file.axes[0].max_rate, file.axes[0].start_rate), (8000, 80));
        assert_eq!(file.axes[0].pull_out_rate, Some(12_000));
        assert_eq!(file.axes[2].acceleration, None);
        assert!(file.axes[3].is_rotary && file.axes[3].max_rate == 10_667);
    }

    #[test]
    fn mistakes_of_an_axis_are_found() {
        for (figures, wrong) in [
            (
                ["80", "6000", "", "", "5000", ""],
                "`max_rate` is above `pull_out_rate`",
            ),
            (
                ["80", "600", "50", "601", "", ""],
                "`start_rate` is above `max_rate`",
            ),
            (["0", "600", "", "", "", ""], "steps per mm are above 0"),
            (["x", "600", "", "", "", ""], "`x` is no number"),
            (["80", "-600", "", "", "", ""], "`max_rate` does not fit"),
            (
                ["80", "600", "", "", "", "300..0"],
                "travel is not understood",
            ),
            (["80", "600", "", "", "", "300"], "is not as 0..300"),
        ] {
            let found = axis('X', figures).mistakes().join("\n");
            assert!(found.contains(wrong), "{figures:?}: {found}");
        }
    }

    #[test]
    fn values_are_given_by_axis() {
        let values = by_axis("X0..300 z-45..5").unwrap();
        assert_eq!(values, [('X', "0..300".into()), ('Z', "-45..5".into())]);
        assert!(by_axis("80X").is_err() && by_axis("X1X2").is_err());
    }
}
