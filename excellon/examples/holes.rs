//! Lists the holes of a drill file: `cargo run -p husillo-excellon --example holes -- FILE
//! [--time]`.

use husillo_excellon::{Feature, Inference, Overrides, Reader, lines};
use std::time::Instant;

/// Runs both passes over the text and passes each feature to `found`.
fn read(text: &[u8], mut found: impl FnMut(&Feature)) {
    let mut inference = Inference::new();
    for (_, line) in lines(text) {
        inference.observe(line);
    }
    let mut reader = Reader::<64>::new(&inference.settle(&Overrides::default()));
    for (number, line) in lines(text) {
        match reader.read(line) {
            Ok(features) => features.for_each(|feature| found(&feature)),
            Err(error) => eprintln!("{number}:{}: {error}", error.at + 1),
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().ok_or("usage: holes FILE [--time]")?;
    let text = std::fs::read(file)?;
    if arguments.next().is_none() {
        read(&text, |feature| match feature {
            Feature::Hole(hole) => {
                let [x, y] = hole.at_nm.map(|nm| nm as f64 / 1e6);
                println!("{x} {y} T{}", hole.tool.number);
            }
            Feature::Slot(slot) => {
                let [[x, y], [to_x, to_y]] =
                    [slot.from_nm, slot.to_nm].map(|at| at.map(|nm| nm as f64 / 1e6));
                println!("{x} {y} to {to_x} {to_y} T{}", slot.tool.number);
            }
        });
        return Ok(());
    }
    let (mut features, mut passes) = (0_u64, 0_u32);
    let begin = Instant::now();
    while begin.elapsed().as_secs() < 2 {
        read(&text, |_| features += 1);
        passes += 1;
    }
    let seconds = begin.elapsed().as_secs_f64();
    let bytes = text.len() as f64 * f64::from(passes);
    println!(
        "{:.1} MB/s, {:.2} million holes/s",
        bytes / seconds / 1e6,
        features as f64 / seconds / 1e6
    );
    Ok(())
}
