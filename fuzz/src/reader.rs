//! A stream of bytes, cut anywhere.

use husillo_gcode::{
    Block, Commands, Dialect, Framing, LineReader, LineTooLong, Modal, Receiver, Token, WordReader,
    tokens, words,
};

/// Bytes a line may have.
const ROOM: usize = 48;

/// The first byte says how the rest is cut. Where the stream is cut makes no difference; every line comes through or is
/// told to be too long, and its end never stands for a line; words pushed byte by byte are those of the lines; a
/// whole text gives the words of its lines; reading and applying in place is the same as `parse` and `plan`; a line is
/// refused by the receiver or part of what was sent.
pub fn reader(data: &[u8]) {
    let (size, stream) = match data.split_first() {
        Some((size, stream)) => (usize::from(size % 32) + 1, stream),
        None => return,
    };
    let lines = by_byte(stream);
    assert_eq!(lines, by_parts(stream, size), "cuts make no difference");
    check_words(stream);
    let mut receiver = Receiver::new(Framing::PRINTER);
    for line in lines.iter().flatten() {
        let expected = receiver.expected();
        match receiver.check(line) {
            Ok(text) => assert!(line.starts_with(text)),
            Err(error) => {
                assert_eq!(
                    receiver.expected(),
                    expected,
                    "a refused line is not counted"
                );
                assert!(!error.to_string().is_empty());
            }
        }
    }
    for dialect in [Dialect::RS274, Dialect::GRBL] {
        in_place(&lines, dialect);
    }
}

type Line = Result<Vec<u8>, LineTooLong>;

fn by_byte(stream: &[u8]) -> Vec<Line> {
    let mut reader = LineReader::<ROOM>::new();
    let mut lines = Vec::new();
    for &byte in stream {
        lines.extend(reader.push(byte).map(|line| line.map(<[u8]>::to_vec)));
    }
    lines.extend(reader.finish().map(|line| line.map(<[u8]>::to_vec)));
    for line in &lines {
        match line {
            Ok(line) => assert!(line.len() <= ROOM && !line.contains(&b'\n')),
            Err(error) => assert!(error.at == ROOM && error.end > ROOM),
        }
    }
    let kept: usize = lines
        .iter()
        .map(|line| line.as_ref().map_or_else(|error| error.end, Vec::len))
        .sum();
    let dropped = |byte: &&u8| matches!(byte, 0 | 0x0c | b'\r' | b'\n');
    let least = stream.len() - stream.iter().filter(dropped).count();
    assert!(kept >= least, "nothing is lost but padding and line ends");
    lines
}

fn by_parts(stream: &[u8], size: usize) -> Vec<Line> {
    let mut reader = LineReader::<ROOM>::new();
    let mut lines = Vec::new();
    for mut part in stream.chunks(size) {
        while !part.is_empty() {
            let line = reader.read(&mut part);
            lines.extend(line.map(|line| line.map(<[u8]>::to_vec)));
        }
    }
    lines.extend(reader.finish().map(|line| line.map(<[u8]>::to_vec)));
    lines
}

/// Three ways to the same words and errors. Padding before a line is no part of it here.
fn check_words(stream: &[u8]) {
    let mut clean = Vec::new();
    for &byte in stream {
        let at_start = clean
            .last()
            .is_none_or(|last| matches!(last, b'\r' | b'\n'));
        if !(at_start && matches!(byte, 0 | 0x0c)) {
            clean.push(byte);
        }
    }
    let lines = clean.split(|byte| matches!(byte, b'\r' | b'\n'));
    let expected: Vec<_> = lines
        .flat_map(|line| {
            words(line).map(|word| {
                word.map(|word| (word.letter, word.value))
                    .map_err(|error| error.kind)
            })
        })
        .collect();
    let whole: Vec<_> = tokens(&clean)
        .filter(|token| *token != Ok(Token::EndOfLine))
        .filter_map(|token| match token {
            Ok(Token::Word(word)) => Some(Ok((word.letter, word.value))),
            Ok(Token::EndOfLine) => None,
            Err(error) => Some(Err(error.kind)),
        })
        .collect();
    assert_eq!(whole, expected, "words of a text");
    let mut reader = WordReader::new();
    let mut pushed: Vec<_> = clean.iter().filter_map(|&byte| reader.push(byte)).collect();
    pushed.extend(reader.finish());
    let pushed: Vec<_> = pushed
        .into_iter()
        .map(|word| {
            word.map(|word| (word.letter, word.value))
                .map_err(|error| error.kind)
        })
        .collect();
    assert_eq!(pushed, expected, "words pushed");
}

fn in_place(lines: &[Line], dialect: Dialect) {
    let (mut one, mut other) = (Modal::<3>::new(dialect), Modal::<3>::new(dialect));
    let (mut block, mut commands) = (Block::new(), Commands::<3>::new());
    for line in lines.iter().flatten() {
        let planned = Block::parse(line, &dialect).and_then(|block| one.plan(&block));
        let applied = block
            .read(line, &dialect)
            .and_then(|()| other.apply(&block, &mut commands));
        match planned {
            Ok((next, made)) => {
                assert_eq!(applied, Ok(()));
                // Cycles make up to 2^21 moves.
                assert!(
                    made.take(1000).eq(commands.by_ref().take(1000)),
                    "commands in place"
                );
                one = next;
            }
            Err(error) => assert_eq!(applied, Err(error)),
        }
        assert!(one == other, "states in place");
    }
}
