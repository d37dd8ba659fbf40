//! Lines in normal form: the same meaning, nothing lost, and idempotent.
#![cfg(all(feature = "program", feature = "extended"))]

use husillo_gcode::{Block, Command, Compensation, Dialect, Error, Modal, formatted};
use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};

/// The normal form of a line, or the line itself where it has none.
fn form(line: &[u8], dialect: &Dialect) -> Vec<u8> {
    match formatted(line, dialect) {
        Ok(pieces) => pieces.collect::<Vec<_>>().concat(),
        Err(_) => line.to_vec(),
    }
}

fn form_program(program: &[u8], dialect: &Dialect) -> Vec<u8> {
    let lines = program.split(|&byte| byte == b'\n');
    let lines = lines.map(|line| form(line, dialect));
    lines.collect::<Vec<_>>().join(&b'\n')
}

/// The meaning of a block, without its columns.
type Meaning = Result<(Vec<String>, bool), u16>;

/// All words of a block in the order of their letters, with their exact decimal places.
fn meaning(text: &[u8], dialect: &Dialect) -> Meaning {
    let block = Block::parse(text, dialect).map_err(|error| error.kind.code())?;
    let letters =
        (b'A'..=b'Z').filter_map(|letter| block.word(letter).map(|value| (letter, value)));
    let mut words: Vec<_> = letters
        .map(|(letter, value)| {
            let text = value.to_string();
            // The sign of a zero has a meaning only where it is a direction.
            let text = match value.is_zero() && !matches!(letter, b'A' | b'B' | b'C') {
                true => text.trim_start_matches('-'),
                false => &text,
            };
            format!("{}{text}", char::from(letter))
        })
        .collect();
    // Codes have no accessor; their effect is compared by commands. Here they are in the order of
    // the text.
    words.extend(husillo_gcode::words(text).filter_map(|word| {
        let word = word
            .ok()
            .filter(|word| matches!(word.letter, b'G' | b'M'))?;
        Some(format!(
            "{}{:?}",
            char::from(word.letter),
            word.value.scaled(1, 1)
        ))
    }));
    Ok((words, block.is_deleted()))
}

/// The bytes of comments and signs, which are all kept.
fn comments(line: &[u8]) -> Vec<u8> {
    let mut kept = Vec::new();
    let mut depth = 0;
    for &byte in line {
        match byte {
            b';' if depth == 0 => depth = 2,
            b'(' if depth == 0 => depth = 1,
            _ => {}
        }
        if depth > 0 || matches!(byte, b'/' | b'%') {
            kept.push(byte);
        }
        if byte == b')' && depth == 1 {
            depth = 0;
        }
    }
    kept
}

/// Every command and error of a program; columns of errors are not compared.
fn run(program: &[u8], dialect: Dialect) -> Vec<Result<Command<3>, (usize, u16)>> {
    if program
        .split(|&byte| byte == b'\n')
        .any(|line| husillo_gcode::parameters::needs_program(line, &dialect))
    {
        return run_whole(program, dialect);
    }
    let mut state = State::new(dialect);
    for (index, line) in program.split(|&byte| byte == b'\n').enumerate() {
        for (_, text) in dialect.blocks(line) {
            state.add(index, Block::parse(text, &dialect));
        }
    }
    state.made
}

fn run_whole(program: &[u8], dialect: Dialect) -> Vec<Result<Command<3>, (usize, u16)>> {
    use husillo_gcode::parameters::Program;
    let mut state = State::new(dialect);
    let mut whole = Box::new(Program::<4096, 2048, 128>::new(program, dialect));
    // Enough for a program that loops.
    for _ in 0..100_000 {
        let Some(line) = whole.next_line(&state.modal) else {
            break;
        };
        state.add(line.number, line.block);
    }
    state.made
}

struct State {
    modal: Modal<3>,
    stage: Compensation<3>,
    made: Vec<Result<Command<3>, (usize, u16)>>,
}

impl State {
    fn new(dialect: Dialect) -> State {
        let modal = Modal::new(dialect);
        let stage = Compensation::new(modal.position());
        State {
            modal,
            stage,
            made: Vec::new(),
        }
    }

    fn add(&mut self, line: usize, block: Result<Block, Error>) {
        let planned = block.and_then(|block| self.modal.plan(&block));
        let planned = planned
            .map_err(|error| error.kind.code())
            .and_then(|(next, commands)| {
                let (after, commands) = self.stage.plan(commands).map_err(|kind| kind.code())?;
                Ok((next, after, commands))
            });
        match planned {
            Ok((next, after, commands)) => {
                self.made.extend(commands.map(Ok));
                (self.modal, self.stage) = (next, after);
            }
            Err(code) => self.made.push(Err((line, code))),
        }
    }
}

fn assert_kept(path: &Path, dialect: Dialect) {
    let program = fs::read(path).expect("program");
    let once = form_program(&program, &dialect);
    let shown = path.display();
    assert!(
        form_program(&once, &dialect) == once,
        "{shown}: not the same again"
    );
    for (index, (before, after)) in program
        .split(|&byte| byte == b'\n')
        .zip(once.split(|&byte| byte == b'\n'))
        .enumerate()
    {
        let line = index + 1;
        if formatted(before, &dialect).is_ok() {
            assert_eq!(
                String::from_utf8_lossy(&comments(before)).trim_end(),
                String::from_utf8_lossy(&comments(after)).trim_end(),
                "{shown}:{line}"
            );
        }
    }
    let (before, after) = (run(&program, dialect), run(&once, dialect));
    assert_eq!(before.len(), after.len(), "{shown}");
    for (before, after) in before.iter().zip(&after) {
        assert_eq!(before, after, "{shown}");
    }
}

/// The files of a folder and of its subfolders.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("folder");
    let mut paths = Vec::new();
    for path in entries.map(|entry| entry.expect("entry").path()) {
        if path.is_dir() {
            paths.extend(files(&path));
        } else {
            paths.push(path);
        }
    }
    paths.sort();
    paths
}

#[test]
fn golden_programs_mean_the_same() {
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let programs = files(&golden);
    assert!(programs.len() > 100);
    for path in programs {
        for dialect in Dialect::ALL {
            assert_kept(&path, dialect);
        }
    }
}

#[test]
fn programs_of_cam_systems_mean_the_same() {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/gcode");
    let folder = std::env::var_os("HUSILLO_CORPUS").map_or(beside, PathBuf::from);
    if !folder.join("MANIFEST.tsv").is_file() {
        println!(
            "no corpus in {}: set HUSILLO_CORPUS to run this test",
            folder.display()
        );
        return;
    }
    for path in files(&folder.join("programs")) {
        // The large ones only repeat the others.
        if fs::metadata(&path).expect("metadata").len() < 500_000 {
            assert_kept(&path, Dialect::RS274);
        }
    }
}

/// What follows a message of a printer is its text, and no digits of its code.
#[cfg(feature = "extended")]
#[test]
fn texts_of_printers_are_kept() {
    for line in [
        "M117 100 % done",
        "M117 100",
        "G26 0",
        "M201 X500 Y500",
        "G28 X",
    ] {
        let kept = form(line.as_bytes(), &Dialect::PRINTER);
        assert_eq!(String::from_utf8_lossy(&kept), line);
    }
}

/// Text that looks like G-code, right or wrong.
fn line() -> impl Strategy<Value = String> {
    let part = prop_oneof![
        4 => "[GXYZAIJKFgxyzNTPSM] ?[+-]?[0-9 ]{0,4}\\.?[0-9]{0,4}",
        1 => prop::sample::select(vec![
            "(c ; d)", "( x1 )", ";x (", "/", "%", "\t", "  ",
            "G0", "g01.0", "X+00", "Y-0.0", "A-.0", "Z-.5", "#1=2",
            "x[1 + 2]", "Y-#<a b>", "o100 sub", "z sin[3]", "X--5", "X1,5", "\r",
            "a atan[1]/[2]", "#<_x>=[", "]", "G[90]", "f##2",
        ]).prop_map(str::to_owned),
    ];
    prop::collection::vec(part, 0..7).prop_map(|parts| parts.concat())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 2 } else { 3000 }))]

    /// The normal form is idempotent. A line has one, or an error inside it; its block is the same.
    #[test]
    fn a_form_is_its_own_form(line in line(), dialect in 0..Dialect::ALL.len()) {
        let dialect = Dialect::ALL[dialect];
        match formatted(line.as_bytes(), &dialect) {
            Ok(pieces) => {
                let once = pieces.collect::<Vec<_>>().concat();
                let twice = form(&once, &dialect);
                prop_assert_eq!(String::from_utf8_lossy(&once), String::from_utf8_lossy(&twice));
                prop_assert!(formatted(&once, &dialect).is_ok());
                let blocks = |line: &[u8]| -> Vec<Meaning> {
                    dialect.blocks(line).map(|(_, text)| meaning(text, &dialect)).collect()
                };
                prop_assert_eq!(blocks(line.as_bytes()), blocks(&once));
                prop_assert_eq!(comments(line.as_bytes()), comments(&once));
            }
            Err(error) => prop_assert!(error.at <= error.end && error.end <= line.len() + 1),
        }
    }

    /// No input panics.
    #[test]
    fn any_bytes_are_survived(line in prop::collection::vec(any::<u8>(), 0..40)) {
        for dialect in Dialect::ALL {
            let once = form(&line, &dialect);
            prop_assert_eq!(form(&once, &dialect), once);
        }
    }
}
