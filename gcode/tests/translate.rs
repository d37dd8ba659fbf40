//! Programs written for another dialect make the same commands.
#![cfg(all(feature = "program", feature = "extended"))]

use husillo_gcode::parameters::Program;
use husillo_gcode::{
    Block, Command, Compensation, Dialect, Modal, Translated, Translator, Untranslated,
};
use std::fs;
use std::path::{Path, PathBuf};

/// A program in another dialect, and what was not translated: lines and reasons.
fn translated(text: &[u8], from: Dialect, to: Dialect) -> (Vec<u8>, Vec<String>) {
    let mut program: Program<'_, 4096, 512, 16> = Program::new(text, from).with_steps(200_000);
    let mut translator = Translator::<3>::new(from, to);
    let (mut made, mut left) = (Vec::new(), Vec::new());
    while let Some(line) = program.next_line(translator.modal()) {
        let block = match line.block {
            Ok(block) => block,
            Err(error) => {
                left.push(format!("{}: {error}", line.number));
                continue;
            }
        };
        let mut out = |piece: &[u8]| made.extend_from_slice(piece);
        match translator.line(line.text, &block, &mut out) {
            Ok(_) => {}
            Err(Untranslated::Error(error)) => left.push(format!("{}: {error}", line.number)),
            Err(Untranslated::Command(command)) => {
                left.push(format!("{}: {command}", line.number));
            }
        }
        if translator.modal().motion().is_some() && is_end(&block) {
            break;
        }
    }
    let mut out = |piece: &[u8]| made.extend_from_slice(piece);
    if let Err(error) = translator.finish(&mut out) {
        left.push(format!("{error:?}"));
    }
    (made, left)
}

fn is_end(block: &Block) -> bool {
    let modal = Modal::<3>::new(Dialect::RS274);
    let planned = modal.plan(block);
    planned.is_ok_and(|(_, mut made)| made.any(|command| matches!(command, Command::End { .. })))
}

/// The commands of a program that count: those that move, and those that switch something.
fn commands(text: &[u8], dialect: Dialect, compensates: bool) -> Result<Vec<String>, String> {
    let mut program: Program<'_, 4096, 512, 16> = Program::new(text, dialect).with_steps(200_000);
    let mut modal = Modal::<3>::new(dialect);
    let mut stage = Compensation::new(modal.position());
    let mut at = modal.position();
    let mut made = Vec::new();
    let mut length = [husillo_gcode::Nm(0); 3];
    let mut push = |command: Command<3>,
                    at: &mut [husillo_gcode::Nm; 3],
                    made: &mut Vec<String>| {
        let from = *at;
        *at = command.end().unwrap_or(from);
        match command {
            Command::Rapid { to } | Command::Linear { to, .. } if to == from => {}
            Command::Path { .. } => {}
            Command::Compensation { .. } if !compensates => {}
            // States between two awaited states are not compared.
            Command::Coolant { .. } if made.last().is_some_and(|last| last.starts_with("cool")) => {
                made.pop();
                made.push(command.to_string());
            }
            // The numbers of tools, and a length that stays, are not compared.
            Command::ToolLength { offset, .. } => {
                if core::mem::replace(&mut length, offset) != offset {
                    made.push(format!("length {offset:?}"));
                }
            }
            // The centre of an arc by its radius is rounded.
            Command::Arc { arc, feed } => made.push(format!(
                "arc {:?} {:?} {:?} {} {feed}",
                arc.to, arc.plane, arc.direction, arc.turns
            )),
            command => made.push(command.to_string()),
        }
    };
    while let Some(line) = program.next_line(&modal) {
        let text = || String::from_utf8_lossy(line.text).into_owned();
        let block = line
            .block
            .clone()
            .map_err(|error| format!("{}: {error}", text()))?;
        let (next, given) = modal
            .plan(&block)
            .map_err(|error| format!("{}: {error}", text()))?;
        modal = next;
        let mut ended = false;
        if compensates {
            for command in given {
                ended |= matches!(command, Command::End { .. });
                push(command, &mut at, &mut made);
            }
        } else {
            let (after, given) = stage.plan(given).map_err(|error| error.to_string())?;
            stage = after;
            for command in given {
                ended |= matches!(command, Command::End { .. });
                push(command, &mut at, &mut made);
            }
        }
        if ended {
            return Ok(made);
        }
    }
    if !compensates && stage.is_active() {
        stage
            .finish()
            .for_each(|command| push(command, &mut at, &mut made));
    }
    Ok(made)
}

const TARGETS: [Dialect; 3] = [Dialect::GRBL, Dialect::RS274, Dialect::ISO];

/// Checks a program in all dialects. Returns how many translations were whole.
fn check(name: &str, text: &[u8], from: Dialect) -> usize {
    let mut whole = 0;
    for to in TARGETS {
        let (made, left) = translated(text, from, to);
        if !left.is_empty() {
            continue;
        }
        let compensates = to != Dialect::GRBL;
        let Ok(wanted) = commands(text, from, compensates) else {
            continue;
        };
        let given = commands(&made, to, compensates).unwrap_or_else(|error| {
            panic!("{name} to {}: {error}", to.name());
        });
        let differs = wanted.iter().zip(&given).position(|(a, b)| a != b);
        if let Some(place) = differs {
            panic!(
                "{name} to {}: {} is {}",
                to.name(),
                wanted[place],
                given[place]
            );
        }
        assert_eq!(wanted.len(), given.len(), "{name} to {}", to.name());
        whole += 1;
    }
    whole
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            files(&path, found);
        } else {
            found.push(path);
        }
    }
}

/// All programs of the repository, and those of the folder of real programs.
#[test]
fn translations_make_the_same_commands() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = Vec::new();
    files(&here.join("tests/golden/good"), &mut paths);
    files(&here.join("../examples"), &mut paths);
    let real = std::env::var_os("HUSILLO_CORPUS").map(PathBuf::from);
    let real = real.unwrap_or_else(|| here.join("../../shared/gcode"));
    files(&real.join("programs"), &mut paths);
    let (mut programs, mut whole) = (0, 0);
    for path in paths {
        let Some(ending) = path.extension().and_then(|ending| ending.to_str()) else {
            continue;
        };
        if !matches!(ending, "ngc" | "nc" | "gcode" | "tap") {
            continue;
        }
        let text = fs::read(&path).expect("a program");
        if text.len() > 300_000 {
            continue;
        }
        let stem = path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let from = stem
            .split('.')
            .find_map(Dialect::by_name)
            .unwrap_or(Dialect::RS274);
        programs += 1;
        whole += check(&path.to_string_lossy(), &text, from);
    }
    println!("{programs} programs, {whole} translations whole");
    // The folder of real programs, if it is there, has 571.
    let least = if programs > 571 { 1170 } else { programs };
    assert!(
        programs > 30 && whole >= least,
        "{programs} programs, {whole} whole"
    );
}

/// The lines of a program in another dialect.
fn lines(text: &str, from: Dialect, to: Dialect) -> (String, Vec<String>) {
    let (made, left) = translated(text.as_bytes(), from, to);
    (String::from_utf8(made).expect("text"), left)
}

#[test]
fn lines_stay_or_are_moves() {
    let text = "%\nO1234 (part)\n g21g90 G64 P0.01 ; start\nT1 M6\nM3 S1000\n\
        G43 H1 G0 Z5 F200\nG98 G83 X1 Y2 Z-2 R1 Q1.5 (deep)\nG80\n\
        #1 = 3\nG1 X[#1 * 2]\nG2 X8 I1 P2\nM8\nM7\nM30\n%\n";
    let (made, left) = lines(text, Dialect::RS274, Dialect::GRBL);
    let wanted = "(part)\n(start)\nM3 S1000\nG0 Z5\nG0 X1 Y2\nG0 Z1\n\
        G1 Z-0.5 F200\nG0 Z1\nG0 Z-0.246\nG1 Z-2\nG0 Z5 (deep)\nG80\nG1 X6\n\
        M8\nM7\nM30\n";
    assert_eq!(made, wanted);
    let unknown = [
        "4: tool 1",
        "11: arc cw xy X8 Y2 Z5 centre X7 Y2 Z5 turns 1 F200",
    ];
    assert_eq!(left, unknown);
    // LinuxCNC and ISO controls have the cycle.
    let (made, left) = lines(text, Dialect::RS274, Dialect::ISO);
    assert!(left.is_empty(), "{left:?}");
    assert!(
        made.contains("G98 G83 X1 Y2 Z-2 R1 Q1.5 (deep)\n"),
        "{made}"
    );
    assert!(made.contains("(start)") && !made.contains(';'), "{made}");
    // A program of Grbl starts with G0, which other controllers lack.
    let (made, left) = lines("X1\nG1 Y2 F3\nM2", Dialect::GRBL, Dialect::RS274);
    assert_eq!((made.as_str(), left.len()), ("G0 X1\nG1 Y2 F3\nM2\n", 0));
}

#[test]
fn what_a_line_becomes() {
    let mut translator = Translator::<3>::new(Dialect::RS274, Dialect::GRBL);
    let mut line = |text: &str| {
        let block = Block::parse(text.as_bytes(), &Dialect::RS274).expect("a block");
        let mut made = Vec::new();
        let done = translator.line(text.as_bytes(), &block, &mut |piece| made.extend(piece));
        (done.map_err(|_| ()), String::from_utf8(made).expect("text"))
    };
    assert_eq!(line("g0x01"), (Ok(Translated::Kept), "G0 X1\n".into()));
    assert_eq!(
        line("G98 (a) ; level (b)"),
        (Ok(Translated::Rewritten), "(a) (level [b])\n".into())
    );
    assert_eq!(line("M66 P1 L3 Q1"), (Err(()), String::new()));
    assert_eq!(line("/G0 X7"), (Ok(Translated::Rewritten), String::new()));
    assert_eq!(line("G28.1"), (Ok(Translated::Kept), "G28.1\n".into()));
    assert_eq!(
        line("G59.1 X2"),
        (Ok(Translated::Rewritten), "G0 X2\n".into())
    );
}
