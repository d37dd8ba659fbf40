//! Makes the linker's memory map from the lines of the board's file that begin with `//:`.
use std::{env, fs, path::PathBuf};

fn main() {
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let is_arm = env::var("CARGO_CFG_TARGET_ARCH").as_deref() == Ok("arm");
    let is_m0 = env::var("TARGET").is_ok_and(|target| target.starts_with("thumbv6m"));
    // As in src/main.rs.
    let board = match (is_arm, is_m0) {
        (true, true) => "microbit",
        (true, false) => "mps2",
        _ => "virt",
    };
    let board = format!("src/board/{board}.rs");
    println!("cargo:rerun-if-changed={board}");
    let text = fs::read_to_string(&board).expect("the board's file");
    let map = text
        .lines()
        .filter_map(|line| line.strip_prefix("//: "))
        .fold(String::new(), |map, line| map + line + "\n");
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::write(out.join("memory.x"), map).expect("memory.x written to OUT_DIR");
    println!("cargo:rustc-link-search={}", out.display());
    if is_arm {
        println!("cargo:rustc-link-arg-bins=--nmagic");
    } else {
        // The link.x of riscv-rt does not include it.
        println!("cargo:rustc-link-arg-bins=-Tmemory.x");
    }
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
}
