//! Any program with the contour cycles of lathes.

use husillo_gcode::contour::{Contours, needs_contours};
use husillo_gcode::{Block, Dialect, Modal};

/// Number of lines after which a program is abandoned: a cycle may have 2^16 cuts.
const LINES: usize = 3000;

/// Any text as a program of a lathe. Every line is one of the text, and every error has its columns
/// inside its line. A line that is not part of a cycle is unchanged. A cycle that was cut
/// completely ends at its start. A program that has ended stays ended.
pub fn contour(data: &[u8]) {
    for dialect in [Dialect::LATHE, Dialect::LATHE_A] {
        run(data, dialect);
    }
}

fn run(text: &[u8], dialect: Dialect) {
    let mut contours: Contours<'_, 8> = Contours::new(text, dialect);
    let mut modal = Modal::<3>::new(dialect);
    // The line of the roughing cycle in progress, its start position, and whether all of it was
    // right.
    let mut cycle: Option<(usize, [i64; 3], bool)> = None;
    for _ in 0..LINES {
        let Some(line) = contours.next_line(&modal) else {
            assert!(
                contours.next_line(&modal).is_none(),
                "what is over stays over"
            );
            break;
        };
        assert_eq!(
            text.get(line.at..line.at + line.text.len()),
            Some(line.text),
            "a line of the text"
        );
        let at = modal.position().map(|nm| nm.0);
        if cycle.is_some_and(|(number, ..)| number != line.number) {
            let (_, begin, is_right) = cycle.take().expect("there is one");
            assert!(!is_right || at == begin, "{at:?} is not {begin:?}");
        }
        let is_cycle = needs_contours(line.text, &dialect);
        if let (false, Ok(block)) = (is_cycle, &line.block) {
            // Otherwise it is the line of a contour at which a cycle failed, or it is wrong itself.
            let plain = Block::parse(line.text, &dialect);
            assert_eq!(
                format!("{block:?}"),
                format!("{:?}", plain.expect("it is right"))
            );
        }
        let planned = line.block.and_then(|block| modal.plan(&block));
        if is_roughing(line.text) {
            let (_, _, is_right) = cycle.get_or_insert((line.number, at, true));
            *is_right &= planned.is_ok();
        }
        match planned {
            Ok((next, _)) => modal = next,
            Err(error) => {
                assert!(
                    error.at <= error.end && error.end <= line.text.len(),
                    "{error:?} in {} bytes",
                    line.text.len()
                );
            }
        }
    }
}

/// G71 or G72 in the usual form, with its contour.
fn is_roughing(line: &[u8]) -> bool {
    [b"G71P", b"G72P"]
        .iter()
        .any(|code| line.starts_with(*code))
}
