//! Hands the linker scripts to the linker.
use std::{env, fs, path::PathBuf};

fn main() {
    println!("cargo:rerun-if-changed=../memory");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let is_arm = env::var("CARGO_CFG_TARGET_ARCH").as_deref() == Ok("arm");
    let memory = if is_arm {
        "../memory/arm.x"
    } else {
        "../memory/riscv-virt.x"
    };
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy(memory, out.join("memory.x")).expect("memory.x copied to OUT_DIR");
    println!("cargo:rustc-link-search={}", out.display());
    if is_arm {
        println!("cargo:rustc-link-arg-bins=--nmagic");
    } else {
        // The link.x of riscv-rt does not include it.
        println!("cargo:rustc-link-arg-bins=-Tmemory.x");
    }
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
}
