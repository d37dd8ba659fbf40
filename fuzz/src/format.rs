//! Programs in normal form.

use husillo_gcode::parameters::{Program, needs_program};
use husillo_gcode::{Block, Command, Dialect, Error, ErrorKind, Modal, formatted};

/// Number of lines of a program that are compared.
const LINES: usize = 200;

/// Any text in normal form, in every dialect. The normal form is idempotent; a line without one has
/// an error inside it. Words, decimal places and deletion of each block stay, and so does every
/// byte that is not a blank, a sign or a digit. The program has the same commands and errors.
pub fn format(data: &[u8]) {
    for dialect in Dialect::ALL {
        // Line ends after all lines: a last line of blanks is a line too.
        let (mut plain, mut formed) = (Vec::new(), Vec::new());
        for line in data.split(|byte| matches!(byte, b'\n' | b'\r')) {
            plain.extend([line, b"\n"].concat());
            formed.extend([&form(line, &dialect)[..], b"\n"].concat());
        }
        let meant = run(&plain, dialect);
        assert_eq!(run(&formed, dialect), meant, "{}", dialect.name());
    }
}

/// The normal form of a line, or the line itself where it has none.
fn form(line: &[u8], dialect: &Dialect) -> Vec<u8> {
    match formatted(line, dialect) {
        Ok(pieces) => {
            let once = pieces.collect::<Vec<_>>().concat();
            let again = formatted(&once, dialect).map(|pieces| pieces.collect::<Vec<_>>().concat());
            assert_eq!(again.as_ref(), Ok(&once), "the form of a form");
            assert_eq!(marks(line), marks(&once), "nothing is lost");
            if !needs_program(line, dialect) {
                assert_eq!(blocks(line, dialect), blocks(&once, dialect));
            }
            once
        }
        Err(error) => {
            assert!(
                error.at <= error.end && error.end <= line.len(),
                "{error:?}"
            );
            line.to_vec()
        }
    }
}

/// Everything that formatting may neither add nor drop, in capitals.
fn marks(line: &[u8]) -> Vec<u8> {
    line.iter()
        .filter(|byte| !byte.is_ascii_whitespace())
        .filter(|byte| !matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.'))
        .map(u8::to_ascii_uppercase)
        .collect()
}

/// The words of each block of a line without its codes, and whether it is deleted.
fn blocks(line: &[u8], dialect: &Dialect) -> Vec<Result<(String, bool), ErrorKind>> {
    let meaning = |text| {
        let block = Block::parse(text, dialect).map_err(|error| error.kind)?;
        let words = (b'A'..=b'Z').filter_map(|letter| {
            let value = block.word(letter)?.to_string();
            // The normal form keeps the sign of a zero for rotary axes only. A printer stores its E
            // at one of their letters.
            let is_zero = value.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
            let is_rotary = matches!(letter, b'A'..=b'C') && dialect.axes().index(letter).is_some();
            let is_signed = is_rotary || !is_zero;
            let value = if is_signed {
                &value
            } else {
                value.trim_start_matches('-')
            };
            Some(format!("{}{value}", char::from(letter)))
        });
        Ok((words.collect(), block.is_deleted()))
    };
    dialect
        .blocks(line)
        .map(|(_, text)| meaning(text))
        .collect()
}

/// The first commands and the error of each line; columns are not compared.
fn run(text: &[u8], dialect: Dialect) -> Vec<Result<Vec<Command<3>>, (usize, u16)>> {
    let mut modal = Modal::<3>::new(dialect);
    let mut made = Vec::new();
    let add = |made: &mut Vec<_>, modal: &mut Modal<3>, number, block: Result<Block, Error>| {
        let planned = block.and_then(|block| modal.plan(&block));
        made.push(match planned {
            Ok((next, commands)) => {
                *modal = next;
                Ok(commands.take(40).collect())
            }
            Err(error) => Err((number, error.kind.code())),
        });
    };
    let is_program = text
        .split(|byte| matches!(byte, b'\n' | b'\r'))
        .any(|line| needs_program(line, &dialect));
    if is_program {
        let mut program: Box<Program<'_, 64, 64, 8>> = Box::new(Program::new(text, dialect));
        for _ in 0..LINES {
            let Some(line) = program.next_line(&modal) else {
                break;
            };
            add(&mut made, &mut modal, line.number, line.block);
        }
    } else {
        for (number, line) in (1..=LINES).zip(text.split(|byte| matches!(byte, b'\n' | b'\r'))) {
            for (_, text) in dialect.blocks(line) {
                add(&mut made, &mut modal, number, Block::parse(text, &dialect));
            }
        }
    }
    made
}
