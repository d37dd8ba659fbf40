//! `husillo interpolate`: makes one move on the bare integer grid, and prints it.

use crate::cli::{ArcShape, LineShape, Output};
use husillo_interp::{ArcMove, Rim};
use husillo_methods::method::{self, AXES};
use husillo_methods::{Steps, Walk, nominal};
use husillo_sim::text::counted;
use std::io::{self, Write};

/// Prints a move.
///
/// # Errors
///
/// Standard output is closed.
pub fn print(walk: &Walk, format: Output) -> io::Result<()> {
    let mut out = crate::console::stdout();
    if format == Output::Json {
        return husillo_simulator::text::json::write_line("husillo.interpolate/1", walk, &mut out);
    }
    let end: Vec<String> = walk.end.iter().map(i64::to_string).collect();
    writeln!(out, "iterations     {}", walk.iterations)?;
    writeln!(out, "moving         {}", walk.moving)?;
    writeln!(out, "largest error  {:.5} BLU", walk.max_error_blu)?;
    writeln!(out, "RMS error      {:.5} BLU", walk.rms_error_blu)?;
    writeln!(out, "end            {}", end.join(","))?;
    match &walk.steps {
        Steps::Code(code) => writeln!(out, "steps          {code}"),
        Steps::Signs(signs) => writeln!(out, "steps          {}", signs.join(" ")),
    }
}

/// Makes a line.
///
/// # Errors
///
/// A message about a wrong argument.
pub fn line(shape: &LineShape) -> Result<Walk, String> {
    let method = method::by_name(&method::LINES, &shape.method, "lines")?;
    let (delta, axes) = delta(&shape.to)?;
    Walk::line(method, delta, axes)
}

/// Makes an arc.
///
/// # Errors
///
/// A message about a wrong argument.
pub fn arc(shape: &ArcShape) -> Result<Walk, String> {
    let method = method::by_name(&method::ARCS, &shape.method, "arcs")?;
    if shape.centre_bits > 16 {
        return Err("--centre-bits is at most 16".to_owned());
    }
    let mut arc = ArcMove {
        from: pair(&shape.from, "--from")?,
        to: pair(&shape.to, "--to")?,
        centre: centre(&shape.centre, shape.centre_bits)?,
        fraction_bits: shape.centre_bits,
        direction: shape.direction.into(),
        turns: shape.turns,
        rim: Rim::Spiral,
    };
    let mut radius = None;
    if let Some(radius_squared) = shape.radius_squared {
        let too_large = || "--radius-squared does not fit these points".to_owned();
        arc.rim = nominal(&arc, radius_squared).ok_or_else(too_large)?;
        radius = Some((radius_squared as f64).sqrt() / f64::from(1_u32 << shape.centre_bits));
    }
    Walk::arc(method, arc, radius)
}

/// Reads the end of a line from zero, `X,Y[,Z..]`. Also returns its number of axes.
///
/// # Errors
///
/// The text is not two to six whole numbers.
pub fn delta(text: &str) -> Result<([i32; AXES], usize), String> {
    let to = integers(text, "--to")?;
    if !(2..=AXES).contains(&to.len()) {
        return Err(format!(
            "--to has {}; two to six are possible",
            counted(to.len(), "axis")
        ));
    }
    let mut delta = [0; AXES];
    delta[..to.len()].copy_from_slice(&to);
    Ok((delta, to.len()))
}

/// Reads a centre `X,Y` in units of 2^-bits.
///
/// # Errors
///
/// The text is not two decimals, or they are not multiples of 2^-bits.
pub fn centre(text: &str, bits: u8) -> Result<[i64; 2], String> {
    let centre: Vec<i64> = text
        .split(',')
        .map(|text| scaled(text, bits))
        .collect::<Result<_, _>>()?;
    let centre: Result<[i64; 2], _> = centre.try_into();
    centre.map_err(|_| "--centre takes two numbers, as in 0,0.5".to_owned())
}

/// Reads two whole numbers. `name` is the option, for messages.
///
/// # Errors
///
/// The text is not two whole numbers.
pub fn pair(text: &str, name: &str) -> Result<[i32; 2], String> {
    <[i32; 2]>::try_from(integers(text, name)?)
        .map_err(|_| format!("{name} takes two numbers, as in 30,0"))
}

/// Reads whole numbers, separated by commas. `name` is the option, for messages.
///
/// # Errors
///
/// A message about the first part that is not a whole number.
fn integers(text: &str, name: &str) -> Result<Vec<i32>, String> {
    text.split(',')
        .map(|number| {
            number
                .trim()
                .parse()
                .map_err(|_| format!("{name}: `{number}` is not a whole number of steps"))
        })
        .collect()
}

/// Reads a decimal number in units of 2^-bits.
///
/// # Errors
///
/// The text is not a decimal number of at most 28 digits, or not a multiple of 2^-bits.
fn scaled(text: &str, bits: u8) -> Result<i64, String> {
    let wrong = || format!("--centre: `{text}` is not a decimal number");
    let text = text.trim();
    let (negative, body) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let (whole, part) = body.split_once('.').unwrap_or((body, ""));
    let digits = format!("{whole}{part}");
    if digits.is_empty() || digits.len() > 28 || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return Err(wrong());
    }
    // 28 digits are below 2^94, so 16 more bits fit.
    let value = digits.parse::<i128>().map_err(|_| wrong())? << bits;
    let power = 10_i128.pow(u32::try_from(part.len()).map_err(|_| wrong())?);
    if value % power != 0 {
        return Err(format!("--centre: {text} is not a multiple of 2^-{bits}"));
    }
    let value = i64::try_from(value / power).map_err(|_| wrong())?;
    Ok(if negative { -value } else { value })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centres_are_exact() {
        assert_eq!(scaled("-3.5", 1), Ok(-7));
        assert_eq!(scaled("0.0625", 4), Ok(1));
        assert!(scaled("0.1", 16).is_err());
        assert!(scaled("1.2.3", 4).is_err());
    }
}
