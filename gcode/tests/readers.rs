//! The byte-wise readers compared with the readers of slices.

use husillo_gcode::{
    Error, Framing, LineReader, LineTooLong, Receiver, Rule, Token, Word, WordReader, tokens, words,
};
use proptest::prelude::*;

/// Text of several lines with many faults: numbers of every length, blanks inside, all line ends.
fn text() -> impl Strategy<Value = Vec<u8>> {
    let piece = prop_oneof![
        4 => "[XYZGMNFxyn]",
        4 => "[+-]?[0-9]{0,4}(\\.[0-9]{0,4})?",
        1 => "[0-9]{7,22}(\\.[0-9]{0,22})?",
        2 => "[ \t]{1,2}",
        2 => "\r|\n|\r\n",
        1 => "\\([a-z ;%]{0,3}\\)?|;[a-z(]{0,3}",
        1 => "[/%#\\[\\],.+*-]",
        1 => "\0|\x0c|\u{e9}",
    ];
    prop::collection::vec(piece, 0..24).prop_map(|pieces| pieces.concat().into_bytes())
}

/// The lines of a text, without their ends.
fn lines(text: &[u8]) -> Vec<Vec<u8>> {
    let text = String::from_utf8_lossy(text)
        .replace("\r\n", "\n")
        .replace('\r', "\n");
    let mut lines: Vec<_> = text
        .split('\n')
        .map(|line| line.as_bytes().to_vec())
        .collect();
    if lines.last().is_some_and(Vec::is_empty) {
        lines.pop();
    }
    lines
}

/// The expected words of a line, and whether it is deleted.
fn expected(line: &[u8]) -> (Vec<Result<Word, Error>>, bool) {
    let mut words = words(line);
    let found = words.by_ref().collect();
    (found, words.is_deleted())
}

/// The byte-wise readers skip NUL and form feed before a line.
fn without_padding(line: &[u8]) -> &[u8] {
    let start = line.iter().position(|byte| !matches!(byte, 0 | 0x0c));
    start.map_or(&[], |start| &line[start..])
}

/// Each line with all that was read from it, byte by byte.
fn pushed(text: &[u8]) -> Vec<(Vec<Result<Word, Error>>, bool)> {
    let mut reader = WordReader::new();
    let (mut all, mut line, mut carriage, mut open) = (Vec::new(), Vec::new(), false, false);
    for &byte in text {
        line.extend(reader.push(byte));
        let belongs = byte == b'\n' && carriage;
        carriage = byte == b'\r';
        if belongs {
            assert!(line.is_empty(), "the LF of a CR LF gives nothing");
        } else if carriage || byte == b'\n' {
            all.push((std::mem::take(&mut line), reader.is_deleted()));
            open = false;
        } else {
            open = true;
        }
    }
    line.extend(reader.finish());
    if open {
        all.push((line, reader.is_deleted()));
    }
    all
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 2 } else { 2000 }))]

    /// Byte by byte the same words and errors come, at the same positions, as from each single
    /// line.
    #[test]
    fn words_of_a_stream_are_those_of_its_lines(text in text()) {
        let expected: Vec<_> = lines(&text)
            .iter()
            .map(|line| expected(without_padding(line)))
            .collect();
        prop_assert_eq!(pushed(&text), expected);
    }

    /// A whole text gives the words of its lines, and as many ends as it has lines.
    #[test]
    fn tokens_of_a_text_are_the_words_of_its_lines(text in text()) {
        let (mut all, mut line) = (Vec::new(), Vec::new());
        let mut program = tokens(&text);
        while let Some(token) = program.next() {
            match token {
                Ok(Token::EndOfLine) => all.push((std::mem::take(&mut line), program.is_deleted())),
                Ok(Token::Word(word)) => {
                    prop_assert!(text[word.at].eq_ignore_ascii_case(&word.letter));
                    line.push(Ok((word.letter, word.value, word.end - word.at)));
                }
                Err(error) => line.push(Err((error.kind, error.end - error.at))),
            }
        }
        prop_assert!(line.is_empty());
        let expected: Vec<_> = lines(&text).iter().map(|line| {
            let (words, deleted) = expected(line);
            let words: Vec<_> = words.into_iter().map(|word| match word {
                Ok(word) => Ok((word.letter, word.value, word.end - word.at)),
                Err(error) => Err((error.kind, error.end - error.at)),
            }).collect();
            (words, deleted)
        }).collect();
        prop_assert_eq!(all, expected);
    }

    /// Blanks change no word: with a blank after every byte the same values come by another code
    /// path.
    #[test]
    fn blanks_change_no_word(line in "([XYZG][+-]?[0-9]{1,12}(\\.[0-9]{0,12})?){0,6}") {
        let wide: Vec<u8> = line.bytes().flat_map(|byte| [byte, b' ']).collect();
        let values = |line: &[u8]| {
            words(line)
                .map(|word| {
                    word.map(|word| (word.letter, word.value))
                        .map_err(|error| error.kind)
                })
                .collect::<Vec<_>>()
        };
        prop_assert_eq!(values(line.as_bytes()), values(&wide));
    }

    /// The boundaries of the chunks do not matter. Only lines that are too long are lost, and each
    /// of them is reported.
    #[test]
    fn lines_of_a_stream_do_not_depend_on_its_cuts(
        text in text(),
        cuts in prop::collection::vec(0..40_usize, 0..20),
    ) {
        let keep = |line: Result<&[u8], LineTooLong>| line.map(<[u8]>::to_vec);
        let mut expected = Vec::new();
        let mut reader = LineReader::<12>::new();
        for &byte in &text {
            expected.extend(reader.push(byte).map(keep));
        }
        expected.extend(reader.finish().map(keep));

        let (mut seen, mut rest) = (Vec::new(), &text[..]);
        for cut in cuts.into_iter().chain([usize::MAX]) {
            let (mut part, behind) = rest.split_at(cut.min(rest.len()));
            rest = behind;
            while !part.is_empty() {
                seen.extend(reader.read(&mut part).map(keep));
            }
        }
        seen.extend(reader.finish().map(keep));
        prop_assert_eq!(&seen, &expected);

        let lines = String::from_utf8_lossy(&text)
            .into_owned()
            .replace("\r\n", "\n")
            .replace('\r', "\n");
        let mut lines: Vec<_> = lines
            .split('\n')
            .map(|line| without_padding(line.as_bytes()).to_vec())
            .collect();
        if lines.last().is_some_and(Vec::is_empty) {
            lines.pop();
        }
        let lines: Vec<_> = lines
            .into_iter()
            .map(|line| match line.len() {
                ..=12 => Ok(line),
                end => Err(LineTooLong { at: 12, end }),
            })
            .collect();
        prop_assert_eq!(seen, lines);
    }

    /// A numbered line with its checksum is accepted; with any one byte changed it is refused.
    #[test]
    fn one_wrong_byte_is_refused(
        number in 0..1000_u32,
        line in "[A-Z0-9 .-]{0,20}",
        at in any::<prop::sample::Index>(),
        flip in 1..=255_u8,
    ) {
        let text = format!("N{number} {line}");
        let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
        let framed = format!("{text}*{sum}").into_bytes();
        let mut receiver = Receiver::new(Framing {
            checksum: Rule::Always,
            number: Rule::Never,
        });
        prop_assert_eq!(receiver.check(&framed), Ok(text.as_bytes()));
        let mut wrong = framed.clone();
        let at = at.index(text.len());
        wrong[at] ^= flip;
        prop_assert!(receiver.check(&wrong).is_err());
    }
}

/// Lines of moves with some of everything between them, right and wrong.
fn line() -> impl Strategy<Value = String> {
    let word = prop::sample::select(vec![
        "G0",
        "G1",
        "G2",
        "G3",
        "X1",
        "Y-2.5",
        "Z3",
        "I1",
        "J0.5",
        "R4",
        "F100",
        "F-1",
        "N7",
        "P1",
        "P-1",
        "A1",
        "U2",
        "G90",
        "G91",
        "G20",
        "G93",
        "G94",
        "G81",
        "G80",
        "G5",
        "S100",
        "M3",
        "T1",
        "M6",
        "G41",
        "G40",
        "D1",
        "G54",
        "G92",
        "G10",
        "L2",
        "G28",
        "G4",
        "G53",
        "M2",
        "X9999999999999",
        "/",
        "G33",
        "K1",
        "G18",
        "G7",
    ]);
    prop::collection::vec(word, 0..6).prop_map(|words| words.join(" "))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 2 } else { 4000 }))]

    /// Reading into one block and applying in place gives the same states, commands and errors as
    /// `parse` and `plan`.
    #[test]
    fn in_place_is_the_same(lines in prop::collection::vec(line(), 0..10)) {
        use husillo_gcode::{Block, Command, Commands, Dialect, Modal};
        for dialect in Dialect::ALL {
            let (mut one, mut other) = (Modal::<3>::new(dialect), Modal::<3>::new(dialect));
            let (mut block, mut commands) = (Block::new(), Commands::<3>::new());
            for line in &lines {
                let planned =
                    Block::parse(line.as_bytes(), &dialect).and_then(|block| one.plan(&block));
                let applied = block
                    .read(line.as_bytes(), &dialect)
                    .and_then(|()| other.apply(&block, &mut commands));
                match planned {
                    Ok((next, made)) => {
                        prop_assert_eq!(applied, Ok(()));
                        let made: Vec<Command<3>> = made.collect();
                        prop_assert_eq!(commands.by_ref().collect::<Vec<_>>(), made);
                        one = next;
                    }
                    Err(error) => prop_assert_eq!(applied, Err(error)),
                }
                prop_assert_eq!(&one, &other);
            }
        }
    }
}

/// Every byte at every position of a line: within a number, after one, before the first word, in
/// comments and after them. All readers find the same, and the next line is intact.
#[test]
fn every_byte_in_every_place() {
    let heads = [
        "",
        "X",
        "X1",
        "X-",
        "X1.",
        "X1.5",
        "X12345678",
        "X123456789",
        "X1234567890",
        "X1234567890.",
        "x1 ",
        "X 1",
        "X1 2",
        "(a",
        "X1(a)",
        ";",
        "N1",
        "N1 ",
        "/",
        "%",
        " ",
        "G1 X1234 Y5678 Z",
        "X+",
        "X1 +",
    ];
    let tails = [
        "",
        "2",
        "2 Y3",
        ".5Y1",
        ") G1",
        " +1",
        "12 Y12345.5 Z1234 F1",
        "+1 Y2",
    ];
    let bytes = (0..128).filter(|byte| !cfg!(miri) || byte % 64 == 10);
    for byte in bytes {
        for head in heads {
            for tail in tails {
                let line = [head.as_bytes(), &[byte], tail.as_bytes()].concat();
                let text = [&line[..], b"\nG2 X3\n"].concat();
                // A byte-wise reader skips padding of a line.
                let found: Vec<_> = lines(&text)
                    .iter()
                    .map(|line| expected(without_padding(line)))
                    .collect();
                let shown = String::from_utf8_lossy(&line);
                assert_eq!(pushed(&text), found, "{shown:?}");

                let mut all = vec![(Vec::new(), false)];
                let mut program = tokens(&text);
                while let Some(token) = program.next() {
                    match token {
                        Ok(Token::EndOfLine) => all.push((Vec::new(), false)),
                        Ok(Token::Word(word)) => {
                            let here = all.last_mut().expect("a line");
                            *here = (std::mem::take(&mut here.0), program.is_deleted());
                            here.0
                                .push(Ok((word.letter, word.value, word.end - word.at)));
                        }
                        Err(error) => {
                            let here = all.last_mut().expect("a line");
                            here.0.push(Err((error.kind, error.end - error.at)));
                        }
                    }
                }
                all.pop();
                let of_lines: Vec<_> = lines(&text)
                    .iter()
                    .map(|line| {
                        let (words, deleted) = expected(line);
                        let is_told = words.iter().any(Result::is_ok);
                        let words: Vec<_> = words
                            .into_iter()
                            .map(|word| {
                                word.map(|word| (word.letter, word.value, word.end - word.at))
                                    .map_err(|error| (error.kind, error.end - error.at))
                            })
                            .collect();
                        (words, deleted && is_told)
                    })
                    .collect();
                assert_eq!(all, of_lines, "{shown:?}");
            }
        }
    }
}

/// Bytes next to the letters of the alphabet are not letters, however the following number is read.
#[test]
fn bytes_beside_letters() {
    // `@` begins a word of polar coordinates.
    for byte in *b"[`{" {
        for tail in ["1", "1 ", "1 X2 Y3 Z4 A5 B6 C7", "1234567890 X2"] {
            let line = [&[byte], tail.as_bytes()].concat();
            let first = words(&line).next().expect("an error");
            assert_eq!(
                first.map_err(|error| (error.at, error.end)),
                Err((0, 1)),
                "{line:?}"
            );
            let first = tokens(&line).next().expect("an error");
            assert_eq!(
                first.map_err(|error| (error.at, error.end)),
                Err((0, 1)),
                "{line:?}"
            );
            assert_eq!(
                words(&[b"X1 ", &line[..]].concat())
                    .nth(1)
                    .map(|word| word.is_err()),
                Some(true)
            );
        }
    }
}

/// A number of too many digits is reported from its first digit, whatever surrounds it.
#[test]
fn numbers_too_long_begin_at_their_digits() {
    let digits = "12345678901234567890123";
    for (head, at) in [("X", 1), ("X  ", 3), ("(ab)X", 5), ("Y1 X \t", 6)] {
        for blank in ["", " "] {
            // A blank inside of the number, too.
            let line = format!("{head}1{blank}{digits}");
            let by_push = line.bytes().chain([b'\n']);
            let mut reader = WordReader::new();
            let pushed = by_push
                .filter_map(|byte| reader.push(byte))
                .find_map(Result::err);
            let read = words(line.as_bytes()).find_map(Result::err);
            assert_eq!(pushed, read, "{line}");
            assert_eq!(read.map(|error| error.at), Some(at), "{line}");
        }
    }
}

/// A checksum comes after comments and brackets, and before a comment at the end; its digits are
/// digits.
#[test]
fn where_a_checksum_stands() {
    let mut receiver = Receiver::new(Framing {
        checksum: Rule::Always,
        number: Rule::Never,
    });
    for text in ["G1 (a*b) X1", "X[1*2] Y1", "X[[1*2]*3] Y1"] {
        let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
        let line = format!("{text}*{sum}");
        assert_eq!(receiver.check(line.as_bytes()), Ok(text.as_bytes()));
        let line = format!("{text}*{sum};*12");
        assert_eq!(receiver.check(line.as_bytes()), Ok(text.as_bytes()));
    }
    // A colon is not a digit, although it follows the nine. The checksum of two equal bytes is 0.
    assert!(receiver.check(b"AA*0").is_ok());
    assert!(receiver.check(b"AA*:").is_err());
    assert!(receiver.check(b"U_*10").is_ok() && receiver.check(b"U_*:").is_err());
    let mut receiver = Receiver::new(Framing {
        checksum: Rule::Never,
        number: Rule::Always,
    });
    assert!(receiver.check(b"G1 X1").is_err());
    assert!(receiver.check(b"G1 N1").is_err());
    assert!(receiver.check(b"N1 G1").is_ok());
}
