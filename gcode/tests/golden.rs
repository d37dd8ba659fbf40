//! Golden programs: `good/*.ngc` with files of the expected commands, and `bad/*.ngc` whose first
//! line states the only error.
//!
//! The name contains the dialect: `name.DIALECT.ngc`, or `.mm` for micromill. `UPDATE_GOLDEN=1`
//! rewrites the `.commands` files.
#![cfg(feature = "extended")]

mod in_place;

use husillo_gcode::{Block, Compensation, Dialect, Error, Modal};
use std::fs;
use std::path::{Path, PathBuf};

fn programs(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/golden")
        .join(folder);
    let entries = fs::read_dir(folder).expect("golden folder");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|name| name != "commands"));
    paths.sort();
    assert!(!paths.is_empty());
    paths
}

/// `name.mm` is in the micromill dialect, `name.DIALECT.ngc` in that dialect, `name.ngc` in RS-274.
fn dialect(path: &Path) -> Dialect {
    if path.extension().is_some_and(|name| name == "mm") {
        return Dialect::MICROMILL;
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    match stem.split_once('.') {
        Some((_, name)) => Dialect::by_name(name).expect("a dialect"),
        None => Dialect::RS274,
    }
}

/// `line: command` and `line:column: E0000 message`, columns from 1.
fn run(path: &Path) -> (Vec<String>, Vec<String>) {
    let dialect = dialect(path);
    let program = fs::read(path).expect("program");
    let mut modal = Modal::<3>::new(dialect);
    let mut stage = Compensation::new(modal.position());
    let (mut commands, mut errors) = (Vec::new(), Vec::new());
    for (index, line) in program.split(|&byte| byte == b'\n').enumerate() {
        let number = index + 1;
        for (offset, text) in dialect.blocks(line) {
            let planned =
                Block::parse(text, &dialect).and_then(|block| in_place::plan(&modal, &block));
            // The path of the tool; its errors concern the whole block.
            let compensated = planned.and_then(|(next, made)| {
                let (after, made) = stage.plan(made).map_err(|kind| Error {
                    kind,
                    at: 0,
                    end: text.trim_ascii_end().len(),
                })?;
                Ok((next, after, made))
            });
            match compensated {
                Ok((next, after, made)) => {
                    (modal, stage) = (next, after);
                    commands.extend(made.map(|command| format!("{number}: {command}")));
                }
                Err(error) => {
                    let columns = (offset + error.at + 1, offset + error.end);
                    let code = error.kind.code();
                    errors.push(format!(
                        "{number}:{}-{} E{code:04} {error}",
                        columns.0, columns.1
                    ));
                }
            }
        }
    }
    (commands, errors)
}

#[test]
fn good_programs_mean_their_commands() {
    for path in programs("good") {
        let (commands, errors) = run(&path);
        assert!(errors.is_empty(), "{}: {errors:#?}", path.display());
        let text = commands.join("\n") + "\n";
        let golden = path.with_extension("commands");
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            fs::write(&golden, &text).expect("write");
        }
        let expected = fs::read_to_string(&golden).unwrap_or_default();
        assert_eq!(text, expected, "{}", path.display());
    }
}

#[test]
fn bad_programs_have_their_error() {
    let mut wrong = Vec::new();
    for path in programs("bad") {
        let text = String::from_utf8_lossy(&fs::read(&path).expect("program")).into_owned();
        let first = text.lines().next().unwrap_or_default();
        let expected = first
            .trim_start_matches("; ")
            .trim_end_matches(';')
            .to_owned();
        let (_, mut errors) = run(&path);
        // In micromill strings the first line is not a comment.
        errors.retain(|error| !error.starts_with("1:"));
        if errors != [expected.clone()] {
            wrong.push(format!(
                "{}: expected {expected}, got {errors:#?}",
                path.display()
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
