//! A figure out of a G-code program.

use crate::diagnostics::{Findings, Format};
use crate::program;
use crate::source::Source;
use husillo_gcode::{Command, Dialect, Nm};

/// A step of the machine, nm.
const STEP_NM: i64 = 1870;

/// The straight moves of a program in X and Z, in steps. Positions are rounded, not moves, so that nothing adds up.
///
/// # Errors
///
/// The program's first error; a move that is no straight one in X and Z, or too long.
pub fn load(file: &str) -> Result<Vec<[i16; 2]>, String> {
    let mut source = Source::open(file).map_err(|error| format!("{file}: {error}"))?;
    let mut findings = Findings::new(Vec::new(), Format::Text, false, 1);
    let mut moves = Vec::new();
    let mut at = [0_i64; 2];
    let mut refused = None;
    program::walk(
        &mut source,
        file,
        Dialect::RS274,
        &mut findings,
        |meaning, command, from, _| {
            if refused.is_none() {
                let line = meaning.at.line;
                match straight(command, from, &mut at) {
                    Ok(Some(way)) => moves.push(way),
                    Ok(None) => {}
                    Err(reason) => refused = Some(format!("{file}:{line}: {reason}")),
                }
            }
            Ok(())
        },
    )
    .map_err(|error| format!("{file}: {error}"))?;
    if findings.errors > 0 {
        return Err(format!(
            "{file}: the program has errors: see `husillo check {file}`"
        ));
    }
    match refused {
        Some(refused) => Err(refused),
        None if moves.is_empty() => Err(format!("{file}: nothing in it moves X or Z")),
        None => Ok(moves),
    }
}

/// The move of a command in steps, if it has one.
fn straight(
    command: &Command<3>,
    from: [Nm; 3],
    at: &mut [i64; 2],
) -> Result<Option<[i16; 2]>, String> {
    let to = match command {
        Command::Rapid { to } | Command::Linear { to, .. } => *to,
        _ if command.end().is_some() => {
            return Err("a figure of this machine is made of straight moves".into());
        }
        _ => return Ok(None),
    };
    let [x, y, z] = to;
    if from[1] != y {
        return Err("a figure is in X and Z: Y is fed to the work piece by the machine".into());
    }
    let goal = [x, z].map(|Nm(nm)| (nm + STEP_NM / 2).div_euclid(STEP_NM));
    let mut way = [0; 2];
    for ((way, at), goal) in way.iter_mut().zip(at).zip(goal) {
        *way = i16::try_from(goal - *at)
            .map_err(|_| "a move of a figure has 32767 steps at most, 61 mm".to_owned())?;
        *at = goal;
    }
    Ok((way != [0; 2]).then_some(way))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn from(text: &str) -> Result<Vec<[i16; 2]>, String> {
        let path = std::env::temp_dir().join(format!(
            "husillo-figure-{}-{}.nc",
            std::process::id(),
            text.len()
        ));
        std::fs::write(&path, text).unwrap();
        let figure = load(path.to_str().unwrap());
        std::fs::remove_file(path).unwrap();
        figure
    }

    #[test]
    fn positions_are_rounded_not_moves() {
        // 0.001 mm is 0.53 steps: after three of them the tool is at 1.6 steps.
        let figure = from("G91 G1 F1 X0.001\nX0.001\nX0.001\nZ-1.87\n").unwrap();
        assert_eq!(figure, [[1, 0], [1, 0], [0, -1000]]);
    }

    #[test]
    fn what_the_machine_cannot_cut_is_refused_with_its_line() {
        for (text, line) in [
            ("G1 F1 X1\nY1\n", ":2: "),
            ("G18 G1 F1 X1\nG2 X2 I0.5\n", ":2: "),
            ("G0 X70\n", ":1: "),
            ("G1 X1\n", "errors"),
            ("M0\n", "nothing"),
        ] {
            let refused = from(text).unwrap_err();
            assert!(refused.contains(line), "{text}: {refused}");
        }
    }
}
