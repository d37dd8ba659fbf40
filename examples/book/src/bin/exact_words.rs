//! The exact words of a line.

use husillo_gcode::fixed::types::I32F32;
use husillo_gcode::{Block, Dialect, Error, Modal, Nm, Word, words};

fn main() -> Result<(), Error> {
    // ANCHOR: words
    let line = b"N10 G1 X1.250 Y-.5 (a corner) F600";
    let found: Vec<Word> = words(line).collect::<Result<_, _>>()?;
    println!("letter   value   digits  places  columns");
    for word in &found {
        println!(
            "{:6} {:>7} {:>8} {:>7}  {} to {}",
            char::from(word.letter),
            word.value.to_string(),
            word.value.digits(),
            word.value.places(),
            word.at,
            word.end,
        );
    }
    // ANCHOR_END: words

    // ANCHOR: lengths
    let x = found[2].value;
    // 1.250 mm and 1.250 inches, in nanometres. No binary fraction lies between.
    assert_eq!(x.scaled(1, 6), Some(1_250_000));
    assert_eq!(x.scaled(254, 5), Some(31_750_000));
    assert_eq!(Nm(1_250_000).millimetres(), Some(I32F32::lit("1.25")));
    // ANCHOR_END: lengths

    // ANCHOR: commands
    let modal = Modal::<3>::new(Dialect::RS274);
    let block = Block::parse(line, &Dialect::RS274)?;
    let (_, mut commands) = modal.plan(&block)?;
    println!("means: {}", commands.next().expect("one move"));
    assert!(commands.next().is_none());
    // ANCHOR_END: commands

    // ANCHOR: error
    let wrong = b"G1 X2,5";
    let error = words(wrong).find_map(Result::err).expect("a comma");
    println!("{}", String::from_utf8_lossy(wrong));
    println!(
        "{}{} {error}",
        " ".repeat(error.at),
        "^".repeat(error.end - error.at)
    );
    // ANCHOR_END: error
    Ok(())
}
