//! Prints the commands of a program, one per line, and its errors with their columns.
//!
//! `cargo run -p husillo-gcode --example commands -- FILE [DIALECT]`; with `--time` it only counts
//! the commands and measures the time.

use husillo_gcode::{Block, Commands, Dialect, Modal};
use std::io::Write;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let timed = arguments.iter().any(|argument| argument == "--time");
    arguments.retain(|argument| argument != "--time");
    let path = arguments
        .first()
        .ok_or("usage: commands FILE [DIALECT] [--time]")?;
    let name = arguments.get(1).map_or("rs274", String::as_str);
    let dialect = Dialect::by_name(name)
        .ok_or("dialects: rs274, grbl, micromill, lathe, lathe-a, iso, drill, printer")?;
    let program = std::fs::read(path)?;

    let mut output = std::io::BufWriter::new(std::io::stdout().lock());
    let (mut block, mut modal) = (Block::new(), Modal::<3>::new(dialect));
    let mut commands = Commands::new();
    let (mut lines, mut commands_made, mut errors) = (0usize, 0usize, 0usize);
    let start = Instant::now();
    for line in program.split(|&byte| byte == b'\n') {
        lines += 1;
        for (offset, text) in dialect.blocks(line) {
            let planned = block
                .read(text, &dialect)
                .and_then(|()| modal.apply(&block, &mut commands));
            match planned {
                Ok(()) => {
                    for command in &mut commands {
                        commands_made += 1;
                        if !timed {
                            writeln!(output, "{lines}: {command}")?;
                        }
                    }
                }
                Err(error) => {
                    errors += 1;
                    if !timed {
                        let column = offset + error.at + 1;
                        writeln!(
                            output,
                            "{lines}:{column}: E{:04}: {error}",
                            error.kind.code()
                        )?;
                    }
                }
            }
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    if timed {
        let rate = lines as f64 / seconds / 1e6;
        writeln!(
            output,
            "{lines} lines, {commands_made} commands, {errors} errors: {rate:.2} million lines/s"
        )?;
    }
    Ok(())
}
