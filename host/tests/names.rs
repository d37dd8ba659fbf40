//! Names of files that are no UTF-8: every command takes them.
#![cfg(target_os = "linux")]

mod common;

use common::husillo;
use std::ffi::OsString;
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::path::{Path, PathBuf};

/// A name that begins with text in Latin-1.
fn name(end: &str) -> OsString {
    OsString::from_vec([b"caf\xe9 \xff", end.as_bytes()].concat())
}

/// Every command that takes a file. `{END}` stands for such a name with this ending, which exists
/// if it is that of an input, and `<` begins the outputs: the endings of the files that are there
/// afterwards.
const COMMANDS: [&str; 29] = [
    "run {.nc} -m micromill -o {.html} --trace {.csv} < .html .csv",
    "run {.nc} -m {.toml} < .none",
    "check {.nc} -m micromill",
    "check {.drl}",
    "format {.nc} -o {.out} < .out",
    "format {.nc} --to grbl -m {.toml} --include . -o {.grbl} < .grbl",
    "format --check {.out}",
    "commands {.nc}",
    "commands {.cod}",
    "steps {.nc} -m micromill -o {.steps} < .steps",
    "holes {.drl} -o {.txt} < .txt",
    "holes {.drl} --as gcode --depth 1 -o {.made} < .made",
    "compile {.drl} -m drill --shift corner -o {.two.cod} --report {.board} < .two.T1.cod \
     .two.toml .board",
    "compile {.nc} -m micromill -o {.mm} < .mm",
    "compile {.fig.nc} -m microfactory -o {.fig} < .fig",
    "send {.two.toml} -m drill --yes",
    "send {.nc} -m micromill",
    "send {.fig} -m microfactory",
    "compare {.nc} -m micromill -o {.compare.html} < .compare.html",
    "machines show {.toml}",
    "machines write router {.router} < .router",
    "jog load {.fig} --figure {.fig}",
    "jog -m drill home x 300 teach save {.saved} < .saved",
    "measure -m cmm3 --piece {.piece} --ball 1 --pretravel 8um run {.routine} -o {.json} < .json",
    "calibrate axis {.gauge}",
    "calibrate backlash {.lines} -m {.toml} -o {.map} --report {.backlash} < .map .backlash",
    "tune --method step -o {.tune} < .tune",
    "reproduce microfactory 4.3 -o {.tables} < .tables",
    "emulate micromill --link {.link} --steps {.events} --for 0.05 < .events",
];

/// The inputs, by their endings.
const INPUTS: [(&str, &str); 9] = [
    (".drl", "../examples/board.drl"),
    (".toml", "../machines/micromill.toml"),
    (".cod", "tests/data/json/board.cod"),
    (".fig.nc", "../examples/microfactory/square.nc"),
    (".piece", "../examples/piece.toml"),
    (".routine", "../examples/piece.routine"),
    (".gauge", "tests/data/json/gauge.csv"),
    (".lines", "tests/data/json/lines.csv"),
    (".nc", "../examples/circles.nc"),
];

fn folder() -> PathBuf {
    let folder = common::scratch("names");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (end, from) in INPUTS {
        std::fs::copy(root.join(from), folder.join(name(end))).unwrap();
    }
    folder
}

#[test]
fn every_command_takes_a_name_that_is_no_utf_8() {
    let folder = folder();
    for command in COMMANDS {
        let (words, made) = command.split_once(" < ").unwrap_or((command, ""));
        let words = words.split(' ').map(|word| {
            let end = word
                .strip_prefix('{')
                .and_then(|word| word.strip_suffix('}'));
            end.map_or_else(|| word.into(), name)
        });
        let mut husillo = husillo();
        let output = husillo.current_dir(&folder).args(words).output().unwrap();
        let errors = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{command}: {errors}");
        let text = String::from_utf8(output.stdout).unwrap();
        let is_private = |one: char| matches!(one, '\u{10fe00}'..='\u{10feff}');
        assert!(!(text + &errors).contains(is_private), "{command}");
        for end in made.split_whitespace().filter(|end| *end != ".none") {
            let path = folder.join(name(end));
            assert!(path.metadata().unwrap().len() > 0, "{command}: {path:?}");
        }
    }
    // Nothing has another name; the default report is in its folder.
    let names = |folder: &Path| -> Vec<OsString> {
        let all = std::fs::read_dir(folder).unwrap();
        all.map(|file| file.unwrap().file_name()).collect()
    };
    let others = names(&folder).into_iter().filter(|name| name != "out");
    for name in others.chain(names(&folder.join("out"))) {
        assert!(name.as_bytes().starts_with(b"caf\xe9 \xff"), "{name:?}");
    }
    assert!(folder.join("out").join(name(".html")).exists());
}

/// A name is shown with its bytes that are no characters, and JSON stays JSON.
#[test]
fn bytes_of_a_name_are_shown() {
    let folder = common::scratch("shown");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join(name(".nc")), "G1 X1\n").unwrap();
    let printed = |format: &str| {
        let mut husillo = husillo();
        husillo.current_dir(&folder).arg("check").arg(name(".nc"));
        let output = husillo.args(["--format", format]).output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        String::from_utf8([output.stdout, output.stderr].concat()).unwrap()
    };
    for format in ["text", "short"] {
        let text = printed(format);
        assert!(text.contains("caf\\xe9 \\xff.nc:1:1"), "{text}");
    }
    let object: serde_json::Value = serde_json::from_str(&printed("json")).unwrap();
    assert_eq!(object["file"], "caf\\xe9 \\xff.nc");
    assert_eq!(object["findings"][0]["file"], "caf\\xe9 \\xff.nc");
}

/// A missing file is named, and what is no character of it is shown by its byte.
#[test]
fn a_missing_file_is_named() {
    let output = husillo().arg("check").arg(name(".none")).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let errors = String::from_utf8(output.stderr).unwrap();
    assert!(errors.contains("caf\\xe9 \\xff.none"), "{errors}");
}
