//! Wrong uses: each is answered by one sentence that says what is wrong and what to do.

mod common;

use common::{husillo, scratch};
use std::path::{Path, PathBuf};

/// Commands that read a file, which stands in place of `IN`.
const READERS: [&str; 14] = [
    "run IN",
    "check IN",
    "format IN",
    "commands IN",
    "steps IN -o /dev/null",
    "holes IN",
    "compare IN",
    "compile IN -m micromill",
    "send IN -m micromill",
    "jog load IN",
    "measure -m cmm3 run IN",
    "calibrate axis IN",
    "calibrate backlash IN",
    "calibrate squareness IN",
];

/// Commands that write a file, which stands in place of `OUT`.
const WRITERS: [&str; 8] = [
    "run c.nc -o OUT",
    "steps c.nc -o OUT",
    "format c.nc -o OUT",
    "compile c.nc -m micromill -o OUT",
    "compare circle -o OUT",
    "holes b.drl -o OUT",
    "tune --method step -o OUT",
    "reproduce microfactory 4.3 -o OUT",
];

fn folder(name: &str) -> PathBuf {
    let folder = scratch(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(folder.join("folder")).unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    std::fs::copy(root.join("examples/circles.nc"), folder.join("c.nc")).unwrap();
    std::fs::copy(root.join("examples/board.drl"), folder.join("b.drl")).unwrap();
    folder
}

/// What a command says about its wrong use. Its status is 2.
fn said(folder: &Path, command: &str) -> String {
    let mut husillo = husillo();
    let words = command.split_whitespace();
    let output = husillo.current_dir(folder).args(words).output().unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{command}: {errors}");
    // Findings and progress may come before it.
    let last = errors.lines().last().unwrap_or_default().to_owned();
    assert!(!errors.contains("os error"), "{command}: {errors}");
    last
}

#[test]
fn files_that_cannot_be_read_have_advice() {
    let folder = folder("advice-read");
    for reader in READERS {
        for (file, advice) in [
            (
                "none.nc",
                "there is no such file: check its name and its folder",
            ),
            ("folder", "this is a folder: name a file in it"),
            (
                "c.nc/part.nc",
                "a part of this path is a file and no folder",
            ),
        ] {
            let command = reader.replace("IN", file);
            let last = said(&folder, &command);
            assert!(last.starts_with("error: "), "{command}: {last}");
            assert!(
                last.contains(advice) && last.contains(file),
                "{command}: {last}"
            );
        }
    }
}

#[test]
fn files_that_cannot_be_written_have_advice() {
    let folder = folder("advice-write");
    for writer in WRITERS {
        for (file, advice) in [
            ("folder", "this is a folder: name a file in it"),
            (
                "no/such/out",
                "there is no folder no/such, and none is made",
            ),
            ("c.nc/out", "a part of this path is a file and no folder"),
        ] {
            let command = writer.replace("OUT", file);
            let last = said(&folder, &command);
            assert!(last.contains(advice), "{command}: {last}");
        }
    }
}

#[test]
fn machines_ports_and_values_have_advice() {
    let folder = folder("advice");
    std::fs::write(folder.join("binary.toml"), b"\xff\xfe\x80 \x00\x81").unwrap();
    std::fs::write(folder.join("latin.toml"), b"name = \"caf\xe9\"\n").unwrap();
    std::fs::write(folder.join("empty.cod"), b"").unwrap();
    for (command, advice) in [
        (
            "run c.nc -m nosuch",
            "are built in, and there is no such file",
        ),
        (
            "run c.nc -m latin.toml",
            "save it as UTF-8, or name another file",
        ),
        (
            "run c.nc -m binary.toml",
            "text in UTF-16: save it as UTF-8",
        ),
        ("run c.nc -m folder", "this is a folder: name a file in it"),
        (
            "machines show nosuch",
            "are built in, and there is no such file",
        ),
        (
            "machines write router c.nc",
            "nothing is written: name another file",
        ),
        (
            "jog home --port /dev/nosuch",
            "there is no such port: check its name and its cable",
        ),
        (
            "jog home --port c.nc",
            "this is no serial port: name a device",
        ),
        (
            "jog home --port tcp:127.0.0.1:1",
            "no program listens at this address",
        ),
        ("measure home --port /dev/nosuch", "there is no such port"),
        (
            "tune --method step --port /dev/nosuch",
            "there is no such port",
        ),
        ("stop -m cmm --port /dev/nosuch", "there is no such port"),
        (
            "jog home -m router",
            "name microfactory, drill, micromill, the file of one of them, or grbl",
        ),
        (
            "measure -m cmm goto A1",
            "needs axes with positions, as in `goto 1200`",
        ),
        (
            "commands empty.cod",
            "an empty file, without records: compile it again",
        ),
        (
            "emulate micromill --link c.nc",
            "choose another name for the link",
        ),
        ("emulate micromill --link no/link", "choose another name"),
        (
            "interpolate arc --from 1 --to 2,3 --centre 0,0 --direction ccw",
            "as in 30,0",
        ),
        ("steps c.nc -o - --format json", "name a file with -o"),
        (
            "compile c.nc -m micromill --format json",
            "name a file with -o",
        ),
        ("format c.nc --format json", "name a file with -o"),
    ] {
        let last = said(&folder, command);
        assert!(last.contains(advice), "{command}: {last}");
    }
}
