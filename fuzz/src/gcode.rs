//! Any line of text.

use husillo_gcode::{Block, Compensation, Dialect, Error, Modal, words};

/// Words, blocks and plans of any text: every place of a word or an error lies inside the text, a refused block leaves the
/// state as it was, and a plan has as many commands as it says. The tool's path of whatever was planned is taken or refused.
pub fn gcode(data: &[u8]) {
    for dialect in Dialect::ALL {
        let mut modal = Modal::<3>::new(dialect);
        let mut stage = Compensation::new(modal.position());
        for line in data.split(|byte| *byte == b'\n') {
            check_words(line);
            for (at, text) in dialect.blocks(line) {
                assert_eq!(
                    line.get(at..at + text.len()),
                    Some(text),
                    "a block is a part of its line"
                );
                let planned = Block::parse(text, &dialect).and_then(|block| modal.plan(&block));
                match planned {
                    Ok((next, commands)) => {
                        let (least, most) = commands.size_hint();
                        let compensated = stage.plan(commands.clone());
                        let count = commands.count();
                        assert!(
                            least <= count
                                && most.is_none_or(|most| count <= most)
                                && count <= 1 << 21,
                            "{count} of {least} to {most:?} commands"
                        );
                        if let Ok((after, commands)) = compensated {
                            stage = after;
                            assert!(
                                commands.count() <= count * 9,
                                "no more than a move and a corner"
                            );
                        }
                        modal = next;
                    }
                    Err(error) => check_place(&error, text),
                }
            }
        }
    }
}

fn check_words(line: &[u8]) {
    let mut end = 0;
    for word in words(line) {
        match word {
            Ok(word) => {
                assert!(
                    end <= word.at && word.at < word.end && word.end <= line.len(),
                    "words in order"
                );
                assert!(word.letter.is_ascii_uppercase(), "letters are capitals");
                end = word.end;
            }
            Err(error) => check_place(&error, line),
        }
    }
}

fn check_place(error: &Error, text: &[u8]) {
    assert!(
        error.at <= error.end && error.end <= text.len(),
        "{error:?} in {} bytes",
        text.len()
    );
    assert!(!error.to_string().is_empty());
}
