//! Compares the public functions of the `no_std` crates with those that the panic proof names. The
//! proof does not cover a function that it does not link. The exit status is 1 if a function is
//! missing.
//!
//! The sources must be formatted by rustfmt: items in column 0, methods in column 4, tests last.
//! Functions that a macro generates are not found, and neither are the default methods of a trait.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::{fs, process};

const CRATES: [&str; 13] = [
    "gcode",
    "excellon",
    "interp",
    "planner",
    "stepper",
    "backlash",
    "encoder",
    "pid",
    "probe",
    "transports",
    "store",
    "machine",
    "controllers",
];

/// Traits whose implementations need not be in the proof. They are derived, print text, or only
/// call functions that are in the proof.
const EXCUSED_TRAITS: [&str; 15] = [
    "Clone",
    "Copy",
    "Debug",
    "Default",
    "Display",
    "Eq",
    "Error",
    "From",
    "Hash",
    "Ord",
    "PartialEq",
    "PartialOrd",
    "ErrorType",
    "ExactSizeIterator",
    // A private trait of interp, whose functions the iterators call.
    "Method",
];

/// Functions that need not be in the proof, as `crate Type::function`, each with the reason.
const EXCUSED_FUNCTIONS: [(&str, &str); 7] = [
    ("controllers GrblMemory::driver", PRODUCT),
    ("interp Helix::fill", PLACES),
    ("interp Line::fill", PLACES),
    ("planner JerkRamp::fill", PLACES),
    ("planner Ramp::fill", PLACES),
    ("planner Ramp::fill_swept", PLACES),
    ("planner Timer::fill", PLACES),
];
const PLACES: &str = "takes any iterator of places: a function of the proof calls it with a slice";
const PRODUCT: &str = "the product grbl with the feature tmc2209 links it, without a panic";

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..");
    let mut missing = 0;
    for name in CRATES {
        let public = public_functions(&root.join(name).join("src"));
        let probe = read(&root.join(format!("firmware/proofs/panics/src/{name}.rs")));
        let named = named_functions(&probe);
        println!("{name}: {} public functions", public.len());
        for function in public.difference(&named) {
            let key = format!("{name} {function}");
            if EXCUSED_FUNCTIONS.iter().any(|(excused, _)| *excused == key) {
                continue;
            }
            println!("    not in the panic proof: {function}");
            missing += 1;
        }
    }
    if missing > 0 {
        process::exit(1);
    }
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Every function that a crate exports, as `Type::function` or `function`.
fn public_functions(source: &Path) -> BTreeSet<String> {
    let library = read(&source.join("lib.rs"));
    let mut exported = exported_names(&library, "pub use ");
    let mut files = Vec::new();
    rust_files(source, &mut files);
    for file in &files {
        if let Some(module) = public_module(file, source, &library) {
            exported.extend(exported_names(&read(&module), "pub use crate::"));
        }
    }
    let mut found = BTreeSet::new();
    for file in files {
        let exported = match public_module(&file, source, &library) {
            Some(module) => exported_names(&read(&module), "pub use "),
            None => exported.clone(),
        };
        let open = file.ends_with("lib.rs");
        for function in functions_of(&read(&file)) {
            let item = function.split("::").next().unwrap_or_default();
            if open || exported.contains(item) {
                found.insert(function);
            }
        }
    }
    found
}

fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) {
    let entries =
        fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    for entry in entries {
        let path = entry.expect("a folder entry").path();
        if path.is_dir() {
            rust_files(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
}

/// The file whose exports determine which items of `file` are public. There is one only if `file`
/// is in a module that the library declares with `pub mod` or exports with `pub use`.
fn public_module(file: &Path, source: &Path, library: &str) -> Option<PathBuf> {
    let inside = file.strip_prefix(source).expect("a file of this crate");
    let module = inside.with_extension("");
    let parents = module
        .ancestors()
        .filter(|path| !path.as_os_str().is_empty());
    let path = parents.into_iter().find(|path| {
        let names: Vec<_> = path.iter().map(|name| name.to_string_lossy()).collect();
        let path = names.join("::");
        let exports = [format!("pub mod {path};"), format!("pub use {path};")];
        library
            .lines()
            .any(|line| exports.iter().any(|export| line == export))
    })?;
    Some(source.join(path).with_extension("rs"))
}

/// Every word of the statements that begin with `begin`, which is `pub use` or `pub use` with a
/// path.
fn exported_names(library: &str, begin: &str) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for statement in library.split(begin).skip(1) {
        let end = statement.find(';').unwrap_or(statement.len());
        let words = statement[..end].split(|character: char| !is_word(character));
        names.extend(words.filter(|word| !word.is_empty()).map(String::from));
    }
    names
}

fn is_word(character: char) -> bool {
    character.is_alphanumeric() || character == '_'
}

/// The public functions of one file.
fn functions_of(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut header = String::new();
    // The type of the current `impl` block, and whether its functions need `pub` to be public.
    let mut block: Option<(String, bool)> = None;
    for line in text.lines() {
        if line.starts_with("mod tests") {
            break;
        }
        if line.starts_with("impl") || !header.is_empty() {
            header.push_str(line.trim());
            header.push(' ');
            if line.ends_with('{') || line.ends_with('}') {
                block = block_of(&header);
                header.clear();
            }
            continue;
        }
        if line.starts_with('}') {
            block = None;
        } else if let Some(name) = function_name(line, "pub ") {
            found.push(name);
        } else if let (Some((item, inherent)), Some(method)) = (&block, line.strip_prefix("    ")) {
            let visibility = if *inherent { "pub " } else { "" };
            if let Some(name) = function_name(method, visibility) {
                found.push(format!("{item}::{name}"));
            }
        }
    }
    found
}

/// The name in `VISIBILITY [const] fn NAME`.
fn function_name(line: &str, visibility: &str) -> Option<String> {
    let rest = line.strip_prefix(visibility)?;
    let rest = rest.strip_prefix("const ").unwrap_or(rest);
    let rest = rest.strip_prefix("fn ")?;
    Some(
        rest.chars()
            .take_while(|character| is_word(*character))
            .collect(),
    )
}

/// The type of an `impl` header, and whether the block is inherent. `None` for an excused trait.
fn block_of(header: &str) -> Option<(String, bool)> {
    let head = without_generics(header.strip_prefix("impl")?);
    let head = head.split(" where ").next().unwrap_or_default();
    let head = head.trim_end_matches(['{', '}', ' ']).trim();
    match head.split_once(" for ") {
        Some((implemented, item)) => {
            let name = last_segment(implemented);
            let excused = EXCUSED_TRAITS.contains(&name.as_str());
            (!excused).then(|| (last_segment(item), false))
        }
        None => Some((last_segment(head), true)),
    }
}

/// The text without everything between `<` and `>`.
fn without_generics(text: &str) -> String {
    let mut depth = 0_u32;
    let mut kept = String::new();
    for character in text.chars() {
        match character {
            '<' => depth += 1,
            '>' => depth = depth.saturating_sub(1),
            _ if depth == 0 => kept.push(character),
            _ => {}
        }
    }
    kept
}

fn last_segment(path: &str) -> String {
    let path = path
        .trim()
        .trim_start_matches("&mut ")
        .trim_start_matches('&');
    path.rsplit("::").next().unwrap_or(path).trim().to_string()
}

/// The functions whose address a file of the proof takes.
fn named_functions(probe: &str) -> BTreeSet<String> {
    let text: Vec<&str> = probe.split_whitespace().collect();
    let text = text.join(" ");
    let mut parts: Vec<&str> = text.split(" as *const ()").collect();
    parts.pop();
    parts
        .into_iter()
        .map(|part| named(last_entry(part)))
        .collect()
}

/// The text after the last comma or bracket that is not inside generics.
fn last_entry(text: &str) -> &str {
    let mut depth = 0_i32;
    for (index, character) in text.char_indices().rev() {
        match character {
            '>' => depth += 1,
            '<' => depth -= 1,
            ',' | '[' | '(' if depth == 0 => return text[index + 1..].trim(),
            _ => {}
        }
    }
    text.trim()
}

/// Reduces `<Type<..> as Trait>::function` and `Type::<..>::function::<..>` to `Type::function`.
fn named(entry: &str) -> String {
    let entry = match entry.rsplit_once("::<") {
        Some((function, generics)) if generics.ends_with('>') && !generics.contains("::") => {
            function
        }
        _ => entry,
    };
    let (item, function) = match entry.rsplit_once("::") {
        Some((item, function)) => (item, function),
        None => return entry.to_string(),
    };
    // Modules before the type are not part of its name.
    let is_module = |path: &str| path.starts_with(|first: char| first.is_ascii_lowercase());
    let mut item = item.trim_start_matches('<');
    while let Some((module, rest)) = item.split_once("::") {
        if !is_module(module) {
            break;
        }
        item = rest;
    }
    let item: String = item
        .chars()
        .take_while(|character| is_word(*character))
        .collect();
    format!("{item}::{function}")
}
