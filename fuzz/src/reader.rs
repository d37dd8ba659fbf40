//! A stream of bytes, split at any points.

use husillo_gcode::{
    Framing, LineReader, LineTooLong, Receiver, Token, Word, WordReader, tokens, words,
};

/// Length of a line in bytes.
const ROOM: usize = 48;

/// The first byte determines how the rest is split.
///
/// - The boundaries of the chunks do not matter.
/// - Every line is returned or reported as too long, and its end is never taken for a line.
/// - Words pushed byte by byte are those of the lines, with their positions. A whole text gives the
///   words of its lines.
/// - The receiver refuses a line, which is then not counted, or returns a part of what was sent.
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

/// Compares three ways to the same words and errors. Padding before a line is not part of it here.
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
    let expected: Vec<_> = lines.flat_map(words).collect();
    let mut reader = WordReader::new();
    let mut pushed: Vec<_> = clean.iter().filter_map(|&byte| reader.push(byte)).collect();
    pushed.extend(reader.finish());
    assert_eq!(pushed, expected, "words pushed");

    // Positions there are those in the text, not in the line.
    let value = |word: Word| (word.letter, word.value, word.end - word.at);
    let expected: Vec<_> = expected
        .into_iter()
        .map(|word| word.map(value).map_err(|error| error.kind))
        .collect();
    let whole: Vec<_> = tokens(&clean)
        .filter(|token| *token != Ok(Token::EndOfLine))
        .filter_map(|token| match token {
            Ok(Token::Word(word)) => Some(Ok(value(word))),
            Ok(Token::EndOfLine) => None,
            Err(error) => Some(Err(error.kind)),
        })
        .collect();
    assert_eq!(whole, expected, "words of a text");
}
