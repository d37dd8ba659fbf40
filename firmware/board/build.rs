//! Selects the board, and makes the linker's memory map from the lines of its file that begin with
//! `//:`.
use std::{env, fs, path::PathBuf};

fn main() {
    println!("cargo:rerun-if-env-changed=BOARD");
    let target = env::var("TARGET").unwrap_or_default();
    let by_target = match target.as_str() {
        target if target.starts_with("thumbv6m") => "src/microbit.rs",
        target if target.starts_with("thumb") => "src/mps2.rs",
        _ => "src/virt.rs",
    };
    let board = PathBuf::from(env::var("BOARD").unwrap_or_else(|_| by_target.into()));
    println!("cargo:rerun-if-changed={}", board.display());
    let text = fs::read_to_string(&board).expect("BOARD names the board's file");
    let map = text
        .lines()
        .filter_map(|line| line.strip_prefix("//: "))
        .fold(String::new(), |map, line| map + line + "\n");
    let path = fs::canonicalize(&board).expect("it was read just now");
    let module = format!("#[path = {path:?}]\nmod chosen;\n");
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::write(out.join("memory.x"), map).expect("memory.x written to OUT_DIR");
    // The board's file has its own vector table.
    fs::write(out.join("device.x"), "").expect("device.x written to OUT_DIR");
    fs::write(out.join("chosen.rs"), module).expect("chosen.rs written to OUT_DIR");
    // The linker of the firmware needs the folder as well.
    println!("cargo:rustc-link-search={}", out.display());
}
