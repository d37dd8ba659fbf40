//! Runs each program of the book. What it prints is in `output/`, where the chapters take it from.
//!
//! `HUSILLO_BOOK_WRITE=1 cargo test -p husillo-book` renews these files.

use std::path::Path;
use std::process::Command;

fn prints_its_page(name: &str, program: &str) {
    let run = Command::new(program).output().expect("the program starts");
    let errors = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{name}: {errors}");
    let printed = String::from_utf8(run.stdout).expect("text");
    let page = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("output")
        .join(format!("{name}.txt"));
    if std::env::var_os("HUSILLO_BOOK_WRITE").is_some() {
        std::fs::write(&page, &printed).expect("a writable folder");
    }
    assert_eq!(
        printed,
        std::fs::read_to_string(&page).unwrap_or_default(),
        "{name}"
    );
}

macro_rules! programs {
    ($($name:ident)*) => {
        $(#[test]
        fn $name() {
            prints_its_page(stringify!($name), env!(concat!("CARGO_BIN_EXE_", stringify!($name))));
        })*
    };
}

programs! {
    exact_words arc_to_pins s_curve_with_hold pid_in_three_types mapped_backlash
    quadrature_from_pins probe_cycle servo_network three_stations store_on_flash three_axes
    grbl_board
}
