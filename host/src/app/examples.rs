//! `husillo examples`.

mod inside;

use super::{Failure, OK, write};
use crate::cli::ExamplesAction;
use crate::console;
use crate::console::shown;
use husillo_simulator::text::name;
use inside::EXAMPLES;
use std::io::Write;
use std::path::Path;

/// Lists, shows and writes the examples in the program.
pub fn examples(action: &Option<ExamplesAction>) -> Result<u8, Failure> {
    match action {
        None => {
            for example in &EXAMPLES {
                let (name, title) = (example.name, example.title);
                writeln!(console::stdout(), "{name:<28}{title}")?;
            }
        }
        Some(ExamplesAction::Show { name }) => {
            let Some(example) = EXAMPLES.iter().find(|example| example.name == name) else {
                let why = format!("no example `{name}`: `husillo examples` lists them");
                return Err(Failure::Usage(why));
            };
            console::stdout().write_all(example.text.as_bytes())?;
        }
        Some(ExamplesAction::Write { folder }) => write_all(folder)?,
    }
    Ok(OK)
}

/// Writes all examples below `folder`. Where one exists, nothing is written.
fn write_all(folder: &str) -> Result<(), Failure> {
    let files = EXAMPLES.map(|example| format!("{folder}/{}", example.name));
    let exists = |file: &&String| std::fs::symlink_metadata(name::path(Path::new(file))).is_ok();
    if let Some(file) = files.iter().find(exists) {
        let why = "exists already, and nothing is written: name another folder";
        return Err(Failure::Usage(format!("{file} {why}")));
    }
    for (file, example) in files.iter().zip(&EXAMPLES) {
        let path = name::path(Path::new(file));
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent)?;
        }
        write(file, example.text.as_bytes())?;
    }
    let count = EXAMPLES.len();
    writeln!(
        console::stdout(),
        "Wrote      {count} files to {}",
        shown(folder)
    )?;
    Ok(())
}
