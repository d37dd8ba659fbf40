//! From text to words. An event is a byte. The texts are the first lines of the programs with which
//! `husillo-bench` compares parsers.

use core::hint::black_box;

use husillo_gcode::{Block, Commands, Dialect, Modal, Token, WordReader, tokens};

use crate::Count;

const LINES: u32 = 50;

const PROGRAMS: [(&str, &str, &str); 4] = [
    ("words_seg", "push_seg", include_str!("../../text/seg.ngc")),
    ("words_arc", "push_arc", include_str!("../../text/arc.ngc")),
    ("words_mix", "push_mix", include_str!("../../text/mix.ngc")),
    (
        "words_print",
        "push_print",
        include_str!("../../text/print.ngc"),
    ),
];

#[inline(never)]
pub fn all(count: Count<'_>) {
    for (slice, push, text) in PROGRAMS {
        let bytes = text.len() as u32;
        count(slice, bytes, &mut || {
            let (mut words, mut sum) = (0_u32, 0_i64);
            for token in tokens(black_box(text).as_bytes()) {
                if let Ok(Token::Word(word)) = token {
                    words = words.wrapping_add(u32::from(word.letter));
                    sum = sum.wrapping_add(word.value.digits() ^ i64::from(word.value.places()));
                }
            }
            black_box((words, sum));
        });
        count(push, bytes, &mut || {
            let (mut words, mut sum) = (0_u32, 0_i64);
            let mut reader = WordReader::new();
            for &byte in black_box(text).as_bytes() {
                if let Some(Ok(word)) = reader.push(byte) {
                    words = words.wrapping_add(u32::from(word.letter));
                    sum = sum.wrapping_add(word.value.digits() ^ i64::from(word.value.places()));
                }
            }
            black_box((words, sum));
        });
    }
}

/// Counts a line from its bytes to its command, in reused memory. An event is a line.
#[inline(never)]
pub fn line(count: Count<'_>) {
    let dialect = Dialect::RS274;
    let mut modal = Modal::<3>::new(dialect);
    let (mut block, mut commands) = (Block::new(), Commands::<3>::new());
    count("line_to_command", LINES, &mut || {
        for _ in 0..LINES {
            let text = black_box(b"G1 X12.345 Y-6.789 F600");
            let done = block
                .read(text, &dialect)
                .and_then(|()| modal.apply(&block, &mut commands));
            black_box((done.is_ok(), &commands));
            commands.clear();
        }
    });
}
