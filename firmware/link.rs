//! Passes the linker scripts to the linker. A program without a folder `memory/` uses the common
//! scripts.
use std::{
    env, fs,
    path::{Path, PathBuf},
};

/// The whole build script of a program that needs nothing else.
pub fn main() {
    let folder = ["memory", "../../memory", "../../../firmware/memory"]
        .into_iter()
        .map(Path::new)
        .find(|folder| folder.exists())
        .expect("the folder of all");
    println!("cargo:rerun-if-changed={}", folder.display());
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let is_arm = env::var("CARGO_CFG_TARGET_ARCH").as_deref() == Ok("arm");
    let memory = if is_arm { "arm.x" } else { "riscv-virt.x" };
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy(folder.join(memory), out.join("memory.x")).expect("memory.x copied to OUT_DIR");
    println!("cargo:rustc-link-search={}", out.display());
    if is_arm {
        println!("cargo:rustc-link-arg-bins=--nmagic");
    } else {
        // The link.x of riscv-rt does not include memory.x.
        println!("cargo:rustc-link-arg-bins=-Tmemory.x");
    }
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
}
