//! The move that `husillo compare` is asked for.

use crate::cli::Compare;
use crate::methods::interpolate::{centre, delta, pair};
use husillo_interp::{ArcMove, Rim};
use husillo_methods::Move;

/// The move of `circle`, `arc` or `line`, and its title. `None` for the name of a file.
///
/// # Errors
///
/// A message about a wrong option.
pub fn one_move(args: &Compare) -> Result<Option<(Move, String)>, String> {
    let needs = |option: &Option<String>, name: &str| {
        option
            .clone()
            .ok_or_else(|| format!("{} needs {name}", args.job))
    };
    let refuse = |given: bool, name: &str| match given {
        true => Err(format!("{} takes no {name}", args.job)),
        false => Ok(()),
    };
    let made = match args.job.as_str() {
        "line" => {
            refuse(args.radius.is_some(), "--radius")?;
            refuse(
                args.from.is_some() || args.centre.is_some(),
                "--from or --centre",
            )?;
            let (delta, axes) = delta(&needs(&args.to, "--to X,Y")?)?;
            let line = Move::line(delta).ok_or("--to is the start of the line")?;
            (line, format!("Line to {}", list(&delta[..axes])))
        }
        "circle" => {
            refuse(args.from.is_some() || args.to.is_some(), "--from or --to")?;
            refuse(args.centre.is_some(), "--centre")?;
            let radius = args.radius.unwrap_or(30);
            let circle = Move::circle(radius, args.direction.into());
            (circle, format!("Circle of radius {radius}"))
        }
        "arc" => {
            refuse(args.radius.is_some(), "--radius")?;
            let from = pair(&needs(&args.from, "--from X,Y")?, "--from")?;
            let to = pair(&needs(&args.to, "--to X,Y")?, "--to")?;
            let fine = centre(&needs(&args.centre, "--centre X,Y")?, 16)?;
            // The published methods take whole centres only.
            let is_whole = fine.iter().all(|at| at & 0xffff == 0);
            let (centre, fraction_bits) = match is_whole {
                true => (fine.map(|at| at >> 16), 0),
                false => (fine, 16),
            };
            let arc = Move::arc(ArcMove {
                from,
                to,
                centre,
                fraction_bits,
                direction: args.direction.into(),
                turns: 0,
                rim: Rim::Spiral,
            });
            (arc, format!("Arc from {} to {}", list(&from), list(&to)))
        }
        _ => {
            let given = args.radius.is_some() || args.to.is_some() || args.from.is_some();
            refuse(
                given || args.centre.is_some(),
                "--radius, --from, --to or --centre: it is a program",
            )?;
            return Ok(None);
        }
    };
    Ok(Some(made))
}

fn list(numbers: &[i32]) -> String {
    let numbers: Vec<String> = numbers.iter().map(i32::to_string).collect();
    numbers.join(",")
}
