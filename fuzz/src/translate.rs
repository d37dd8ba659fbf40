//! Programs in several files, and programs written for another dialect.

use husillo_gcode::parameters::{File, Library, Program};
use husillo_gcode::{Block, Command, Dialect, Modal, Translator, Untranslated};

/// Number of steps and of lines of every program.
const STEPS: u64 = 300;
const LINES: usize = 200;
/// Most commands of one line that are compared.
const COMMANDS: usize = 40;
/// Longest line of Grbl without blanks and comments.
const GRBL_LINE: usize = 79;

type Small<'t> = Program<'t, 16, 32, 4>;

/// The files of a program: the first line of each is its name.
#[derive(Debug)]
struct Files<'a>(Vec<(&'a [u8], &'a [u8])>);

impl Library for Files<'_> {
    fn file<'t>(&'t self, name: &[u8]) -> Option<File<'t>> {
        let (name, text) = self.0.iter().find(|(known, _)| *known == name)?;
        Some(File { name, text })
    }
}

/// A program and its files, separated by NUL, translated from RS-274 and from Fanuc's form into
/// each of the other dialects. Every line is one of the program or of a file that it has called,
/// and a program with files ends within its steps. The written text has whole lines, which the
/// other dialect takes, and fits the buffer of Grbl. It ends where the translator says. Where
/// every command was translated and the radius of the tool is not compensated, that is the end
/// of the program.
pub fn translate(data: &[u8]) {
    let mut parts = data.split(|&byte| byte == 0);
    let text = parts.next().unwrap_or_default();
    let named = parts.map(|part| {
        let end = part.iter().position(|&byte| byte == b'\n');
        let (name, text) = part.split_at(end.unwrap_or(part.len()));
        (name.trim_ascii(), text.get(1..).unwrap_or_default())
    });
    let files = Files(named.collect());
    for (from, to) in [
        (Dialect::RS274, Dialect::GRBL),
        (Dialect::RS274, Dialect::ISO),
        (Dialect::ISO, Dialect::RS274),
        (Dialect::GRBL, Dialect::RS274),
    ] {
        translated(text, &files, from, to);
    }
}

fn translated(text: &[u8], files: &Files<'_>, from: Dialect, to: Dialect) {
    let mut program = Small::new(text, from).with_steps(STEPS).with_library(files);
    let mut translator = Translator::<3>::new(from, to);
    let (mut made, mut is_whole) = (Vec::new(), true);
    // The tool stands beside the contour while its radius is compensated.
    let mut is_beside = false;
    for _ in 0..LINES {
        let Some(line) = program.next_line(translator.modal()) else {
            break;
        };
        let of = match line.file {
            None => text,
            Some(name) => files.file(name).expect("a file that was asked for").text,
        };
        let place = line.at..line.at + line.text.len();
        assert_eq!(of.get(place), Some(line.text), "a line of its file");
        let Ok(block) = line.block else {
            is_whole = false;
            continue;
        };
        let is_long = many(translator.modal(), &block);
        if is_long {
            return; // a cycle of thousands of holes
        }
        is_beside = beside(translator.modal(), &block).unwrap_or(is_beside);
        let mut out = |piece: &[u8]| made.extend_from_slice(piece);
        match translator.line(line.text, &block, &mut out) {
            Ok(_) => {}
            Err(Untranslated::Error(error)) => {
                assert!(
                    error.at <= error.end && error.end <= line.text.len(),
                    "{error:?}"
                );
                is_whole = false;
            }
            Err(Untranslated::Command(_)) => is_whole = false,
        }
        if ends(&block) {
            break;
        }
    }
    let mut out = |piece: &[u8]| made.extend_from_slice(piece);
    is_whole &= translator.finish(&mut out).is_ok();
    let end = run(&made, to);
    assert_eq!(
        end,
        translator.target().position(),
        "the end of the written text"
    );
    if is_whole && !is_beside {
        assert_eq!(end, translator.modal().position(), "the end of the program");
    }
}

/// Whether a line has many commands.
fn many(modal: &Modal<3>, block: &Block) -> bool {
    let planned = modal.plan(block);
    planned.is_ok_and(|(_, commands)| commands.take(COMMANDS + 1).count() > COMMANDS)
}

/// Whether the radius of the tool is compensated after a block. `None`: as before it.
fn beside(modal: &Modal<3>, block: &Block) -> Option<bool> {
    let side = |command| match command {
        Command::Compensation { side, .. } => Some(side.is_some()),
        _ => None,
    };
    let (_, commands) = modal.plan(block).ok()?;
    commands.filter_map(side).last()
}

fn ends(block: &Block) -> bool {
    let planned = Modal::<3>::new(Dialect::RS274).plan(block);
    let is_end = |command| matches!(command, Command::End { .. });
    planned.is_ok_and(|(_, mut commands)| commands.any(is_end))
}

/// The position after a text that has no errors.
fn run(text: &[u8], dialect: Dialect) -> [husillo_gcode::Nm; 3] {
    let mut modal = Modal::<3>::new(dialect);
    assert!(text.is_empty() || text.ends_with(b"\n"), "whole lines");
    for line in text.split(|&byte| byte == b'\n') {
        let shown = String::from_utf8_lossy(line);
        assert!(
            dialect != Dialect::GRBL || length(line) <= GRBL_LINE,
            "{shown}"
        );
        let block = Block::parse(line, &dialect).unwrap_or_else(|error| panic!("{shown}: {error}"));
        let (next, _) = modal
            .plan(&block)
            .unwrap_or_else(|error| panic!("{shown}: {error}"));
        modal = next;
    }
    modal.position()
}

/// The length of a line without blanks and comments. No comment has parentheses inside.
fn length(line: &[u8]) -> usize {
    let (mut length, mut is_comment) = (0, false);
    for byte in line {
        match byte {
            b'(' => is_comment = true,
            b')' => is_comment = false,
            _ if is_comment => {}
            b';' => break,
            b' ' | b'\t' | b'\r' => {}
            _ => length += 1,
        }
    }
    length
}
