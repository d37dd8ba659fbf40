//! Bounds of what the program reads, keeps and prints, whatever it is given.

mod common;
#[cfg(unix)]
mod emulated;

use common::{husillo, scratch, written};
use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;

/// Each kind of input, as the arguments of a command. `IN` stands for a file.
const READERS: [&str; 19] = [
    "check IN",
    "run IN",
    "format IN",
    "commands IN",
    "steps IN -o -",
    "compare IN",
    "check p.nc -m IN",
    "holes IN",
    "check p.nc IN --dialect excellon",
    "compile IN -m drill",
    "compile IN -m micromill",
    "compile IN -m microfactory",
    "jog load IN",
    "measure -m IN status",
    "measure -m cmm3 run IN",
    "measure -m cmm3 --piece IN status",
    "calibrate backlash IN",
    "calibrate axis IN",
    "calibrate squareness IN",
];

/// Runs a reader with a file, and returns what it prints on standard error.
fn refused(reader: &str, file: &str) -> String {
    let program = written("p.nc", "G21\nG0 X1\nM30\n");
    let words = reader.split(' ').map(|word| match word {
        "IN" => file,
        "p.nc" => program.to_str().unwrap(),
        word => word,
    });
    let output = husillo().args(words).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    let all = format!("{errors}{}", String::from_utf8_lossy(&output.stdout));
    assert_eq!(output.status.code(), Some(2), "{reader}: {all}");
    all
}

/// A device without an end is no file. Each bound is stated in the message.
#[cfg(target_os = "linux")]
#[test]
fn every_input_has_a_bound() {
    for reader in READERS {
        let errors = refused(reader, "/dev/zero");
        let is_told = ["more than 512 MiB", "more than 64 MiB"];
        assert!(
            is_told.iter().any(|told| errors.contains(told)),
            "{reader}: {errors}"
        );
    }
}

/// A pipe without an end is read to the bound, and one sentence says so.
#[cfg(target_os = "linux")]
#[test]
fn an_endless_pipe_has_a_bound() {
    for (reader, bound) in [("check -", "512 MiB"), ("calibrate axis -", "64 MiB")] {
        let mut yes = std::process::Command::new("yes")
            .arg("G1 X1")
            .stdout(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_husillo"))
            .args(reader.split(' '))
            .stdin(yes.stdout.take().unwrap())
            .output()
            .unwrap();
        yes.wait().unwrap();
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{reader}: {errors}");
        let told = format!("error: -: more than {bound}, the most of such a file that is read\n");
        assert_eq!(errors, told, "{reader}");
    }
}

/// Text in UTF-16 is named, with a mark at its beginning or without.
#[test]
fn every_input_names_utf_16() {
    let text: Vec<u8> = "G21 G90\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    for (name, mark) in [("marked.nc", &b"\xff\xfe"[..]), ("plain.nc", b"")] {
        let path = scratch(name);
        std::fs::write(&path, [mark, &text].concat()).unwrap();
        for reader in READERS {
            let errors = refused(reader, path.to_str().unwrap());
            assert!(
                errors.contains("text in UTF-16: save it as UTF-8"),
                "{reader}: {errors}"
            );
        }
    }
}

#[test]
fn a_table_of_readings_has_a_bound() {
    let rows = "x,1,1,1,1\n".repeat(250_001);
    let table = written("many.csv", &format!("axis,x,y,programmed,measured\n{rows}"));
    husillo()
        .args(["calibrate", "backlash", table.to_str().unwrap()])
        .assert()
        .code(2)
        .stderr(contains("line 250002: more than 250000 rows"));
}

/// A file that has a tool for each hole is put into order tool by tool.
#[test]
fn many_tools_are_sorted() {
    let mut board = String::from("M48\nMETRIC\n");
    (1..1000).for_each(|tool| board += &format!("T{tool}C0.8\n"));
    board += "%\n";
    (1..1000).for_each(|tool| board += &format!("T{tool}\nX{}.0Y1.0\nX1.0Y1.0\n", tool % 7 + 2));
    let board = written("tools.drl", &(board + "M30\n"));
    let args = [
        "holes",
        board.to_str().unwrap(),
        "--order",
        "shortest",
        "--format",
        "json",
    ];
    let listed = common::json(&args);
    let holes = listed["holes"].as_array().unwrap();
    assert_eq!(holes.len(), 2 * 999);
    // The first tool begins near the origin, the next where that one ends.
    assert_eq!(holes[0][0], 1);
    assert_eq!(holes[1][0], 3);
    assert_eq!(holes[2][0], 4);
}

/// Names, cells, keys and lines of a file may be long. What is printed about them is not.
#[test]
fn messages_have_readable_lines() {
    let long = |one: &str| one.repeat(66_000);
    let program = format!(
        "G1 X1 F5 ({}\nG0 X{}\n#<{}>=[#<x>]\n",
        long("a"),
        long("9"),
        long("n")
    );
    let program = written("long.nc", &program);
    let machine = written(
        "long.toml",
        &format!("\"{}\" = \"{}\"\n", long("k"), long("v")),
    );
    let cells = format!("axis,x,y,programmed,measured\n{},1,1,1,1\n", long("q"));
    let cells = written("long.csv", &cells);
    let [program, machine, cells] = [&program, &machine, &cells].map(|path| path.to_str().unwrap());
    let name = long("x");
    for args in [
        &["check", program][..],
        &["check", program, "--format", "short"],
        &["check", program, "-m", machine],
        &["measure", "-m", "cmm3", "run", program],
        &["calibrate", "backlash", cells],
        &["compile", program, "-m", "drill"],
        &["holes", cells],
        &["run", &name],
        &["explain", &name],
        &["jog", &name],
        &["tune", "--method", &name],
    ] {
        let output = husillo().args(args).output().unwrap();
        let all = [output.stdout, output.stderr].concat();
        let longest = all.split(|byte| *byte == b'\n').map(<[u8]>::len).max();
        assert!(longest < Some(1200), "{:?}: {longest:?}", &args[..1]);
        assert!(!all.is_empty(), "{:?}", &args[..1]);
    }
}

/// A loop that changes nothing is endless, and is noticed long before the limits.
#[test]
fn endless_programs_end() {
    for (name, text) in [
        ("endless.nc", "o1 while [1]\nG0 X1\nG0 X0\no1 endwhile\n"),
        ("endless-empty.nc", "#1=2\no1 while [#1]\no1 endwhile\n"),
    ] {
        let program = written(name, text);
        for command in ["check", "run", "commands"] {
            husillo()
                .args([command, program.to_str().unwrap()])
                .assert()
                .code(1)
                .stderr(contains("E0638").or(predicates::str::is_empty()));
        }
        let output = husillo().arg("commands").arg(&program).output().unwrap();
        // Far fewer than 10 million lines were carried out.
        assert!(output.stdout.len() < 1_000_000, "{name}");
        assert!(String::from_utf8_lossy(&output.stderr).contains("nothing has changed"));
    }
}

/// Without a reader of its text, or without room for it, a machine goes on, and the status says so.
#[cfg(target_os = "linux")]
#[test]
fn a_full_output_is_an_error_of_every_command() {
    let path = |name: &str| format!("../examples/{name}");
    let (part, board) = (path("circles.nc"), path("board.drl"));
    let square = path("microfactory/square.nc");
    for args in [
        &["jog", "home", "x", "4"][..],
        &["jog", "-m", "drill", "home"],
        &["jog", "-m", "micromill", "home", "where"],
        &["send", &square, "-m", "microfactory"],
        &[
            "send", &board, "-m", "drill", "--shift", "corner", "--yes", "--only", "1",
        ],
        &["run", &part, "--format", "json"],
        &["check", &part],
        &["commands", &part],
        &["format", &part],
        &["holes", &board],
        &["machines"],
        &["machines", "show", "router"],
        &["examples"],
        &["examples", "show", "gear.nc"],
        &["explain", "G83"],
        &["completions", "bash"],
        &["interpolate", "line", "--to", "3,4"],
        &["compare", "circle"],
        &["measure", "-m", "cmm", "status"],
        &["compile", &part, "-m", "micromill"],
    ] {
        let full = std::fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_husillo"))
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .env("XDG_STATE_HOME", common::state())
            .args(args)
            .stdin(std::process::Stdio::null())
            .stdout(full)
            .output()
            .unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {errors}");
        assert!(errors.contains("No space left"), "{args:?}: {errors}");
    }
}

#[cfg(unix)]
mod terminals {
    use super::emulated::Emulated;
    use super::{husillo, scratch};
    use serialport::TTYPort;
    use std::io::{Read, Write};
    use std::net::TcpStream;
    use std::os::fd::AsRawFd;
    use std::process::{Command, Stdio};
    use std::time::Duration;

    /// Noise that comes faster than a device answers waits at the port, not in the program.
    #[test]
    fn an_emulator_takes_no_more_than_its_line_carries() {
        const NOISE: usize = 177_000_000;
        for machine in ["cmm", "drill", "micromill", "microfactory"] {
            let mut device = Emulated::listening(machine, &[]);
            let mut client = TcpStream::connect(&device.port()[4..]).unwrap();
            client
                .set_write_timeout(Some(Duration::from_secs(1)))
                .unwrap();
            let noise = [0x5a; 1 << 16];
            let mut sent = 0;
            while sent < NOISE {
                match client.write(&noise) {
                    Ok(count) => sent += count,
                    Err(_) => break,
                }
            }
            // What two sockets hold.
            assert!(sent < 32_000_000, "{machine} took {sent} bytes");
            let status = std::fs::read_to_string(format!("/proc/{}/status", device.id()));
            if let Ok(status) = status {
                let size = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
                let size = size.unwrap().trim().trim_end_matches(" kB");
                assert!(
                    size.parse::<u32>().unwrap() < 64_000,
                    "{machine}: {size} kB"
                );
            }
            if machine != "cmm" {
                device.type_line("where", "x");
            }
        }
    }

    /// Lines at its panel wait as well.
    #[test]
    fn a_panel_takes_no_more_than_it_carries_out() {
        let mut device = Emulated::listening("drill", &[]);
        let line = vec![b'x'; 8 << 20];
        device.type_bytes(&line);
        device.type_bytes(b"\n");
        device.type_line("where", "spindle off");
    }

    #[test]
    fn the_link_of_a_killed_emulator_is_replaced() {
        let Some(device) = Emulated::new("drill", "stale", &[]) else {
            return;
        };
        let link = device.link.clone();
        let beside = link.with_extension("kept");
        // As a kill leaves it.
        std::fs::rename(&link, &beside).unwrap();
        drop(device);
        std::fs::rename(&beside, &link).unwrap();
        let again = Emulated::new("drill", "stale", &[]).unwrap();
        husillo()
            .args(["jog", "-m", "drill", "--port", again.port(), "where"])
            .assert()
            .success();
    }

    /// What a program writes to a terminal as its standard error, until it ends or a text comes.
    fn on_terminal(args: &[&str], variables: &[(&str, &str)], until: &str) -> Option<String> {
        let (mut ours, theirs) = TTYPort::pair().ok()?;
        // Open as long as both ends are.
        let theirs = handle_of(&theirs);
        let mut child = Command::new(env!("CARGO_BIN_EXE_husillo"))
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .args(args)
            .env_remove("NO_COLOR")
            .env("TERM", "xterm")
            .envs(variables.iter().copied())
            .stdin(Stdio::null())
            .stdout(theirs.try_clone().unwrap())
            .stderr(theirs)
            .spawn()
            .unwrap();
        let mut text = String::new();
        let mut bytes = [0; 4096];
        loop {
            match ours.read(&mut bytes) {
                Ok(count) => text += &String::from_utf8_lossy(&bytes[..count]),
                Err(_) if child.try_wait().unwrap().is_some() => break,
                Err(_) => {}
            }
            if !until.is_empty() && text.contains(until) {
                child.kill().unwrap();
                child.wait().unwrap();
                break;
            }
        }
        Some(text)
    }

    /// A handle of a terminal for another program.
    fn handle_of(terminal: &TTYPort) -> std::fs::File {
        let path = format!("/proc/self/fd/{}", terminal.as_raw_fd());
        std::fs::OpenOptions::new()
            .read(true)
            .write(true)
            .open(path)
            .unwrap()
    }

    #[test]
    fn colours_are_for_terminals_that_show_them() {
        let file = scratch("colour.nc");
        std::fs::write(&file, "G0 ?\n").unwrap();
        let file = file.to_str().unwrap();
        for (args, variables, is_coloured) in [
            (&["check", file][..], &[][..], true),
            (&["check", file], &[("TERM", "dumb")], false),
            (&["check", file], &[("NO_COLOR", "1")], false),
            (&["check", file], &[("NO_COLOR", "")], true),
            (&["run", file], &[("TERM", "dumb")], false),
            (
                &["measure", "-m", "cmm3", "run", file],
                &[("TERM", "dumb")],
                false,
            ),
            (&["run", "--nonsense"], &[("TERM", "dumb")], false),
            (&["run", "--nonsense"], &[("NO_COLOR", "1")], false),
            (
                &["run", "--nonsense"],
                &[("TERM", "dumb"), ("CI", "1")],
                false,
            ),
            (&["--help"], &[("TERM", "dumb"), ("CI", "1")], false),
        ] {
            let Some(text) = on_terminal(args, variables, "") else {
                return eprintln!("skipped: no pseudo-terminal here");
            };
            assert_eq!(
                text.contains('\u{1b}'),
                is_coloured,
                "{args:?} {variables:?}: {text}"
            );
        }
    }

    /// A long check shows how far it is.
    #[test]
    fn a_long_check_shows_its_progress() {
        let file = scratch("long-loop.nc");
        std::fs::write(&file, "#1=0\no1 while [1]\n#1=[#1+1]\no1 endwhile\n").unwrap();
        let shown = on_terminal(&["check", file.to_str().unwrap()], &[], "Reading ");
        assert!(shown.is_none_or(|text| text.contains("blocks and commands")));
    }
}
