//! Macros: kept in a file, and run.

use super::page::Served;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// A file for macros, removed at the end.
struct Kept(PathBuf);

impl Kept {
    fn new(name: &str) -> Self {
        let name = format!("husillo-{name}-{}.toml", std::process::id());
        let path = std::env::temp_dir().join(name);
        let _ = std::fs::remove_file(&path);
        Self(path)
    }

    fn served(&self, options: &[&str]) -> Served {
        let own = ["--macros", self.0.to_str().unwrap()];
        Served::new(&[&own, options].concat())
    }
}

impl Drop for Kept {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

#[test]
fn they_are_kept_and_run() {
    let kept = Kept::new("kept");
    let served = kept.served(&["--speed", "10"]);
    let mut page = served.operator();
    assert_eq!(page.done(json!({"do": "macros"})), json!([]));
    let text = "G21 G90 (all)\nG0 X3\nG0 Y4\n$H\nG0 X-7\n";
    page.done(json!({"do": "macro_save", "name": "To and fro", "text": text}));
    // A line that cannot be sent.
    let why = page.refused(json!({"do": "macro_save", "name": "bad", "text": "G0 X1\nG0 X2?\n"}));
    assert!(why.contains("line 2"), "{why}");
    let why = page.refused(json!({"do": "macro_run", "name": "bad"}));
    assert!(why.contains("no macro"), "{why}");
    page.done(json!({"do": "macro_run", "name": "To and fro"}));
    page.until_state("Idle");
    page.until_at("machine_mm", 0, page.at("zero_mm", 0) - 7.0);
    // Homing came after the moves, not with them.
    let sent: Vec<_> = page
        .lines
        .iter()
        .filter(|line| line["from"] == "host")
        .collect();
    let sent: Vec<_> = sent
        .iter()
        .map(|line| line["text"].as_str().unwrap())
        .collect();
    let at = sent.iter().position(|line| *line == "$H").unwrap();
    assert_eq!(sent[at - 1..=at], ["G4P0", "$H"]);
    // Another server has the same macros.
    drop(served);
    let served = kept.served(&["--watch-only"]);
    let mut page = served.page();
    let all = page.done(json!({"do": "macros"}));
    assert_eq!(all[0]["name"], "To and fro");
    assert!(
        page.refused(json!({"do": "macro_delete", "name": "To and fro"}))
            .contains("control")
    );
}

#[test]
fn they_end_at_the_first_error_and_with_stop() {
    let kept = Kept::new("ended");
    let served = kept.served(&[]);
    let mut page = served.operator();
    let mut save = |name: &str, text: &str| {
        page.done(json!({"do": "macro_save", "name": name, "text": text}));
    };
    save("wrong", "G21 G91\nG1 X30 F900\nG1 Y5 Q\nG1 Y5\n");
    save("long", "G21 G91\nG1 X-30 F900\nG1 X30\n");
    let why = page.refused(json!({"do": "macro_run", "name": "wrong"}));
    assert!(why.contains("G1Y5Q"), "{why}");
    page.until("a stop", |page| {
        page.has_line("the machine has stopped").then_some(())
    });
    page.until_state("Idle");
    let at = page.at("work_mm", 0);
    assert!(at < 29.0, "it has braked: {at}");
    page.say(json!({"do": "macro_run", "name": "long", "id": 77}));
    page.until_state("Run");
    for request in [
        json!({"do": "macro_run", "name": "long"}),
        json!({"do": "line", "text": "G0 X0"}),
        json!({"do": "step", "move_mm": {"x": 1}, "feed": 60}),
    ] {
        let why = page.refused(request);
        assert!(why.contains("runs"), "{why}");
    }
    page.done(json!({"do": "stop"}));
    page.until("a second stop", |page| {
        let is_told = |line: &&serde_json::Value| line["text"] == "the machine has stopped";
        (page.lines.iter().filter(is_told).count() == 2).then_some(())
    });
    page.until_state("Idle");
    let stands = page.at("work_mm", 0);
    page.pass(Duration::from_millis(300));
    assert_eq!(page.at("work_mm", 0), stands);
    assert!(page.has_line("the macro long: stopped"));
}

/// What the program says about a file for macros that it does not take.
fn refused(file: &Path) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_husillo"))
        .args(["serve", "--listen", "127.0.0.1:0", "--for", "1", "--macros"])
        .arg(file)
        .output()
        .unwrap();
    assert!(!output.status.success());
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_file_with_a_mistake_is_said_at_the_start() {
    let kept = Kept::new("wrong");
    std::fs::write(&kept.0, "[[macro]]\nname = \"a\"\ntxt = \"b\"\n").unwrap();
    let said = refused(&kept.0);
    assert!(said.contains("txt"), "{said}");
}

#[test]
fn an_endless_file_is_refused() {
    let said = refused(Path::new("/dev/zero"));
    assert!(said.contains("/dev/zero"), "{said}");
}

#[cfg(unix)]
#[test]
fn a_link_to_the_file_stays_a_link() {
    let (kept, link) = (Kept::new("linked"), Kept::new("link"));
    std::fs::write(&kept.0, "").unwrap();
    std::os::unix::fs::symlink(&kept.0, &link.0).unwrap();
    let served = link.served(&[]);
    let mut page = served.operator();
    page.done(json!({"do": "macro_save", "name": "park", "text": "G53 G0 Z-1"}));
    assert!(std::fs::symlink_metadata(&link.0).unwrap().is_symlink());
    assert!(std::fs::read_to_string(&kept.0).unwrap().contains("park"));
}
