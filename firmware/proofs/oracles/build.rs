//! Reads the oracle tests of the crates and turns them into functions that a program can call on a
//! board.

#[path = "../../link.rs"]
mod link;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Crate and test file of plain `#[test]` functions that read oracle data.
const FILES: [(&str, &str); 7] = [
    ("backlash", "oracle"),
    ("interp", "oracle"),
    ("interp", "oracle_classic"),
    ("pid", "oracle"),
    ("planner", "oracle"),
    ("probe", "oracle"),
    ("stepper", "oracle"),
];

fn main() {
    link::main();
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets OUT_DIR"));
    let root = fs::canonicalize("../../..").expect("the folder of all crates");
    let (mut modules, mut list) = (String::new(), String::new());
    for (name, file) in FILES {
        let tests = root.join(name).join("tests");
        let path = tests.join(file).with_extension("rs");
        println!("cargo:rerun-if-changed={}", path.display());
        let text = fs::read_to_string(&path).expect("a test file");
        let (text, functions) = callable(&text, &tests);
        assert!(!functions.is_empty(), "no test in {}", path.display());
        let module = format!("{name}_{file}");
        let made = out.join(&module).with_extension("rs");
        fs::write(&made, text).expect("OUT_DIR is writable");
        writeln!(
            modules,
            "#[allow(unused_imports)] // not every file needs all of its surroundings\n\
             mod {module} {{ use crate::surroundings::*; include!({made:?}); }}"
        )
        .expect("a String takes everything");
        for function in functions {
            writeln!(list, "(\"{module}::{function}\", {module}::{function}),")
                .expect("a String takes everything");
        }
    }
    let all = format!("{modules}\nconst TESTS: &[(&str, fn())] = &[\n{list}];\n");
    fs::write(out.join("tests.rs"), all).expect("OUT_DIR is writable");
}

/// Returns the text with its tests as public functions and with absolute paths to its data, and the
/// names of the tests.
fn callable(text: &str, folder: &Path) -> (String, Vec<String>) {
    let mut names = Vec::new();
    let mut made = String::new();
    let mut is_test = false;
    for line in text.lines().filter(|line| !line.starts_with("//!")) {
        if line.trim() == "#[test]" {
            is_test = true;
            continue;
        }
        if let (true, Some(head)) = (is_test, line.strip_prefix("fn ")) {
            names.push(head.split('(').next().expect("a part").to_owned());
            made.push_str("pub ");
            is_test = false;
        }
        let data = format!("include_str!(\"{}/data/", folder.display());
        made.push_str(&line.replace("include_str!(\"data/", &data));
        made.push('\n');
    }
    (made, names)
}
