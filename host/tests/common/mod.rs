//! The program as a user calls it, its files, and what it prints.

#![allow(dead_code)] // every test file uses what it needs of it

use assert_cmd::Command;
use serde_json::Value;
use std::path::PathBuf;

/// The program, in the folder of its package. It keeps nothing for the commands of other tests.
pub fn husillo() -> Command {
    let mut command = Command::cargo_bin("husillo").unwrap();
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command.env("XDG_STATE_HOME", state());
    command
}

/// The folder in which the programs of a test keep what they know. Each test has a thread.
pub fn state() -> PathBuf {
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("test").replace(':', "-");
    scratch(&format!("state-{}-{test}", std::process::id()))
}

/// What it prints; it must end well.
pub fn printed(args: &[&str]) -> String {
    let output = husillo().args(args).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{args:?}: {errors}");
    String::from_utf8(output.stdout).unwrap()
}

/// The same as JSON.
pub fn json(args: &[&str]) -> Value {
    serde_json::from_str(&printed(args)).unwrap()
}

/// What actions of `husillo measure` gave, a row each; a routine is one row.
pub fn measured(args: &[&str]) -> Vec<Value> {
    let mut all = json(&[&["measure", "--format", "json"], args].concat());
    match all["results"].take() {
        Value::Array(rows) => rows,
        _ => vec![all],
    }
}

/// The objects of a stream: the commands of a program without the findings at its end.
pub fn objects(text: &[u8]) -> Vec<Value> {
    let text = String::from_utf8(text.to_vec()).unwrap();
    let all = text
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap());
    all.filter(|one| one["kind"] != "findings").collect()
}

/// The findings of a program that `husillo check --format json` printed.
pub fn findings(text: &[u8]) -> Vec<Value> {
    let objects = objects(text).into_iter();
    let all = objects.flat_map(|mut one| match one["findings"].take() {
        Value::Array(findings) => findings,
        _ => Vec::new(),
    });
    all.collect()
}

/// A number of a row.
pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Whether a number is what it should be, and it must.
pub fn near(value: &Value, wanted: f64, tolerance: f64) {
    let value = number(value);
    let off = (value - wanted).abs();
    assert!(off <= tolerance * 1.000_001, "{value} for {wanted}");
}

/// A path for a file of a test.
pub fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    std::fs::create_dir_all(&folder).unwrap();
    folder.join(name)
}

/// A file of a test.
pub fn written(name: &str, text: &str) -> PathBuf {
    let path = scratch(name);
    std::fs::write(&path, text).unwrap();
    path
}

/// Sends a signal to a program: `INT` as Ctrl-C does, `TERM` as a request to end, `HUP` as a
/// terminal that is closed. Tests that were started with `nohup` have programs that ignore `HUP`,
/// so these get `TERM` instead.
#[cfg(unix)]
pub fn signal(child: &std::process::Child, name: &str) {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    let ignores_hup = ignored.is_some_and(|mask| mask & 1 != 0);
    let name = if ignores_hup && name == "HUP" {
        "TERM"
    } else {
        name
    };
    let sent = std::process::Command::new("kill")
        .args([&format!("-{name}"), &child.id().to_string()])
        .status();
    assert!(sent.is_ok_and(|status| status.success()), "{name}");
}
