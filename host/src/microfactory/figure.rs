//! Reads a figure from a file: a list of moves, or a G-code program.

use crate::input;
use husillo_clients::microfactory::{Figure, Settings, listed};
use husillo_gcode::{Axes, Command, Dialect, Nm};
use husillo_sim::observers::AXES;
use husillo_simulator::diagnostics::{Finding, Findings};
use husillo_simulator::programs::program;
use husillo_simulator::programs::source::Source;
use std::io;

/// End of the name of a list of moves: one move per line, X and Z in steps; `;` begins a comment.
const LIST: &str = ".fig";
/// What is wrong with a figure without moves.
pub const NOTHING: &str = "nothing in it moves X or Z";

/// Moves in steps of X and Z, each with its line in the program.
pub type Moves = Vec<(usize, [i16; 2])>;

/// Reads a list of moves, or a G-code program.
///
/// # Errors
///
/// See [`listed`] and [`programmed`].
pub fn load(file: &str, settings: &Settings) -> Result<Figure, String> {
    let path = std::path::Path::new(file);
    let name = path.file_name().map(|name| name.to_string_lossy());
    let moves = if is_list(file) {
        let text =
            crate::input::read_to_string(file).map_err(|error| format!("{file}: {error}"))?;
        listed(&text).map_err(|(line, reason)| format!("{file}:{line}: {reason}"))?
    } else {
        of_file(file, settings)?
    };
    if moves.is_empty() {
        return Err(format!("{file}: {NOTHING}"));
    }
    Ok(Figure {
        name: name.unwrap_or_default().into_owned(),
        moves,
    })
}

/// The moves of a program in a file.
fn of_file(file: &str, settings: &Settings) -> Result<Vec<[i16; 2]>, String> {
    let mut source = input::program(file).map_err(|error| format!("{file}: {error}"))?;
    let mut findings = Findings::new(1);
    let programmed = programmed(&mut source, file, settings, &mut findings)
        .map_err(|error| format!("{file}: {error}"))?;
    if findings.errors > 0 {
        return Err(format!(
            "{file}: the program has errors: see `husillo check {file}`"
        ));
    }
    match programmed {
        Ok(moves) => Ok(moves.into_iter().map(|(_, delta)| delta).collect()),
        Err(refused) => {
            let (line, _) = refused.line_and_column();
            Err(format!("{file}:{line}: {}", refused.message))
        }
    }
}

/// A list as a program of the same moves, which can be drawn; `None` if the file is no list.
///
/// # Errors
///
/// See [`listed`].
pub fn program(file: &str, settings: &Settings) -> Result<Option<String>, String> {
    if !is_list(file) {
        return Ok(None);
    }
    Ok(Some(drawn(&load(file, settings)?.moves, settings)))
}

/// Moves as a program, which can be drawn.
pub fn drawn(moves: &[[i16; 2]], settings: &Settings) -> String {
    let mut at = [0; 2];
    let places = moves.iter().map(|delta| {
        for (at, steps) in at.iter_mut().zip(delta) {
            *at += i64::from(*steps);
        }
        let [x, z] = settings.place(at);
        format!("X{x} Z{z}\n")
    });
    // Along an axis at its rate.
    let [feed, _] = settings.place([60 * i64::from(settings.config.axis_rate_hz); 2]);
    let places: String = places.collect();
    format!("G21 G90 G94 G1 F{feed}\n{places}M2\n")
}

/// Whether a file is a list of moves, by its name.
pub fn is_list(file: &str) -> bool {
    file.to_ascii_lowercase().ends_with(LIST)
}

/// The straight moves of a program in X and Z, in steps, with their lines. The positions are
/// rounded, so errors do not add up. The inner error is a move that is not straight in X and Z, or
/// too long. `findings` gets the errors of the program.
///
/// # Errors
///
/// The program cannot be read.
pub fn programmed(
    source: &mut Source,
    name: &str,
    settings: &Settings,
    findings: &mut Findings,
) -> io::Result<Result<Moves, Finding>> {
    let mut moves = Vec::new();
    let mut at = [0_i64; 2];
    let mut refused = None;
    program::walk(
        source,
        name,
        Dialect::RS274.with_axes(Axes::XYZ),
        findings,
        |meaning, command, from, _| {
            if refused.is_none() {
                match straight(command, from, &mut at, settings) {
                    Ok(Some(delta)) => moves.push((meaning.at.line, delta)),
                    Ok(None) => {}
                    Err(reason) => {
                        refused = Some(Finding::error("E0401", reason, meaning.at.whole()));
                    }
                }
            }
            Ok(())
        },
    )?;
    Ok(refused.map_or(Ok(moves), Err))
}

/// The move of a command in steps, if it has one.
fn straight(
    command: &Command<AXES>,
    from: [Nm; AXES],
    at: &mut [i64; 2],
    settings: &Settings,
) -> Result<Option<[i16; 2]>, String> {
    let to = match command {
        Command::Rapid { to } | Command::Linear { to, .. } => *to,
        _ if command.end().is_some() => {
            return Err("a figure of this machine is made of straight moves".into());
        }
        _ => return Ok(None),
    };
    let [x, y, z, ..] = to;
    if from[1] != y {
        return Err("a figure is in X and Z: Y is fed to the work piece by the machine".into());
    }
    let goal = settings.nearest([x, z]);
    let mut delta = [0; 2];
    for ((delta, at), goal) in delta.iter_mut().zip(at).zip(goal) {
        *delta = i16::try_from(goal - *at)
            .map_err(|_| "a move of a figure has 32767 steps at most, 61 mm".to_owned())?;
        *at = goal;
    }
    Ok((delta != [0; 2]).then_some(delta))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::microfactory::settings_of;
    use husillo_simulator::machines::machine_file::MachineFile;

    fn settings() -> Settings {
        settings_of(&MachineFile::built_in("microfactory").unwrap()).unwrap()
    }

    fn from(text: &str) -> Result<Vec<[i16; 2]>, String> {
        let path = std::env::temp_dir().join(format!(
            "husillo-figure-{}-{}.nc",
            std::process::id(),
            text.len()
        ));
        std::fs::write(&path, text).unwrap();
        let figure = load(path.to_str().unwrap(), &settings());
        std::fs::remove_file(path).unwrap();
        figure.map(|figure| figure.moves)
    }

    /// The original's triangle is right-angled, with a slope of two.
    #[test]
    fn the_triangle_is_the_originals() {
        let text = include_str!("../../../examples/microfactory/triangle.nc");
        assert_eq!(from(text).unwrap(), [[1000, 500], [0, -500], [-1000, 0]]);
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
