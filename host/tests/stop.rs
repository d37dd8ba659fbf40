//! `husillo stop` from a second terminal.

#![cfg(unix)]

mod common;
mod emulated;

use common::{husillo, scratch};
use emulated::Emulated;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A command on a machine; `stop` finds it in this folder.
fn begin(folder: &Path, words: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_husillo"))
        .env("XDG_RUNTIME_DIR", folder)
        .env("XDG_STATE_HOME", common::state())
        .args(words)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn stop(folder: &Path, words: &[&str]) -> Output {
    let mut stop = husillo();
    stop.env("XDG_RUNTIME_DIR", folder).arg("stop").args(words);
    stop.output().unwrap()
}

fn text(output: &Output) -> String {
    let [out, error] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    format!("{out}{error}")
}

/// The folder of the sockets of one test.
fn sockets(name: &str) -> PathBuf {
    let folder = scratch(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Waits until a program holds its port.
fn held(folder: &Path, ports: usize) {
    let end = Instant::now() + Duration::from_secs(20);
    let folder = folder.join("husillo");
    while std::fs::read_dir(&folder).map_or(0, Iterator::count) < ports {
        assert!(Instant::now() < end, "no program holds a port");
        std::thread::sleep(Duration::from_millis(10));
    }
    // It sets the machine in motion meanwhile.
    std::thread::sleep(Duration::from_millis(700));
}

/// The first number of a text after a name.
fn number_after(text: &str, name: &str) -> f64 {
    let rest = text
        .split(name)
        .nth(1)
        .unwrap_or_else(|| panic!("{name}: {text}"));
    let words = rest.split(|c: char| c.is_whitespace() || c == ',' || c == ';');
    let mut numbers = words.filter_map(|word| word.parse().ok());
    numbers.next().unwrap_or_else(|| panic!("{name}: {text}"))
}

#[test]
fn a_measuring_machine_is_stopped_while_held_and_after_a_kill() {
    let Some(network) = Emulated::new("cmm3", "stop-cmm", &[]) else {
        return;
    };
    let folder = sockets("stop-cmm");
    let halt = ["-m", "cmm3", "--port", network.port()];
    for is_killed in [false, true] {
        let jog = ["--raw", "--port", network.port(), "jog", "+x", "60s"];
        let mut child = begin(&folder, &[&["measure", "-m", "cmm3"], &jog[..]].concat());
        // A trajectory of 60 s at 200 counts/s, which starts at once.
        let lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let mut lines = lines.map(Result::unwrap);
        assert!(lines.any(|line| line.starts_with("> aa 01 d4 97 ")));
        // At 200 counts/s, as it is not homed. The readings follow at the pace of the line.
        let position = lines.find_map(|line| {
            let bytes: Vec<u8> = line
                .strip_prefix("< ")?
                .split(' ')
                .filter_map(|byte| u8::from_str_radix(byte, 16).ok())
                .collect();
            // Status, position, latched position, sum.
            let counts = i32::from_le_bytes(bytes.get(1..5)?.try_into().ok()?);
            (bytes.len() == 10 && (50..99_000).contains(&counts)).then_some(counts)
        });
        assert!(position.is_some());
        let reader = std::thread::spawn(move || lines.count());
        if is_killed {
            child.kill().unwrap();
        }
        let stopped = stop(&folder, &halt);
        assert!(stopped.status.success(), "{}", text(&stopped));
        assert_eq!(text(&stopped).contains("`husillo measure"), !is_killed);
        let at = number_after(&text(&stopped), "X at");
        assert!(at > 40.0, "{}", text(&stopped));
        if !is_killed {
            assert_eq!(child.wait().unwrap().code(), Some(130));
        }
        child.wait().unwrap();
        reader.join().unwrap();
        // It stands, and nothing was reset.
        let again = stop(&folder, &halt);
        assert_eq!(number_after(&text(&again), "X at"), at, "{}", text(&again));
    }
}

#[test]
fn without_a_name_every_machine_stops() {
    let machines = ["micromill", "microfactory"];
    let devices = machines.map(|machine| Emulated::listening(machine, &[]));
    let folder = sockets("stop-all");
    let children = [0, 1].map(|one| {
        let port = devices[one].port();
        begin(
            &folder,
            &[
                "jog",
                "--lease",
                "2550",
                "-m",
                machines[one],
                "--port",
                port,
                "home",
                "x-",
                "60s",
            ],
        )
    });
    held(&folder, 2);
    let stopped = stop(&folder, &[]);
    assert!(stopped.status.success(), "{}", text(&stopped));
    for (device, child) in devices.iter().zip(children) {
        let line = format!("{}: `husillo jog", device.port());
        assert!(text(&stopped).contains(&line), "{}", text(&stopped));
        assert!(!child.wait_with_output().unwrap().status.success());
    }
    let nothing = stop(&folder, &[]);
    assert_eq!(nothing.status.code(), Some(2));
    let why = "no running husillo of this user drives a machine: name its port with --port";
    assert!(text(&nothing).contains(why), "{}", text(&nothing));
}

#[test]
fn an_emergency_stop_lasts_until_the_panels_reset() {
    let mut device = Emulated::listening("microfactory", &[]);
    let folder = sockets("stop-emergency");
    let child = begin(
        &folder,
        &[
            "jog",
            "--lease",
            "2550",
            "--port",
            device.port(),
            "home",
            "x+",
            "60s",
        ],
    );
    held(&folder, 1);
    let stopped = stop(&folder, &["-m", "microfactory", "--emergency"]);
    assert!(
        text(&stopped).contains("is stopping the machine"),
        "{}",
        text(&stopped)
    );
    let output = child.wait_with_output().unwrap();
    assert!(!output.status.success(), "{}", text(&output));
    device.type_line("where", "emergency");
}

/// The stop finds the program by its port, whatever the machine is called, and from any folder.
#[test]
fn a_port_is_found_from_another_folder_and_by_another_name() {
    let Some(mut device) = Emulated::new("drill", "stop-names", &[]) else {
        return;
    };
    let folder = sockets("stop-names");
    let port = Path::new(device.port());
    let (place, name) = (port.parent().unwrap(), port.file_name().unwrap());
    let child = Command::new(env!("CARGO_BIN_EXE_husillo"))
        .env("XDG_RUNTIME_DIR", &folder)
        .current_dir(place)
        .args([
            "jog",
            "-m",
            "drill",
            "--port",
            name.to_str().unwrap(),
            "--lease",
            "9999",
            "x+",
            "60s",
        ])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    held(&folder, 1);
    let stopped = stop(&folder, &["-m", "drill", "--port", device.port()]);
    assert!(stopped.status.success(), "{}", text(&stopped));
    assert!(
        text(&stopped).contains("is stopping the machine"),
        "{}",
        text(&stopped)
    );
    assert!(!child.wait_with_output().unwrap().status.success());
    device.type_line("where", "spindle off");
}

/// An emulated drill whose line is called `drill` in a folder.
struct Drill {
    folder: PathBuf,
    emulation: Child,
}

impl Drill {
    fn start(folder: &str) -> Self {
        let folder = sockets(folder);
        let emulation = Command::new(env!("CARGO_BIN_EXE_husillo"))
            .current_dir(&folder)
            .args(["emulate", "drill", "--link", "./drill", "--speed", "8"])
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let end = Instant::now() + Duration::from_secs(20);
        while !folder.join("drill").exists() {
            assert!(Instant::now() < end, "no link");
            std::thread::sleep(Duration::from_millis(20));
        }
        Self { folder, emulation }
    }

    /// What a command prints in the folder, and whether it succeeds.
    fn told(&self, words: &[&str]) -> (bool, String) {
        let mut command = husillo();
        let folder = &self.folder;
        command.current_dir(folder).env("XDG_RUNTIME_DIR", folder);
        command.timeout(Duration::from_secs(60)).args(words);
        let output = command.output().unwrap();
        (output.status.success(), text(&output))
    }

    fn write(&self, program: &str) {
        std::fs::write(self.folder.join("p.nc"), program).unwrap();
    }
}

impl Drop for Drill {
    fn drop(&mut self) {
        let _ = self.emulation.kill();
        let _ = self.emulation.wait();
    }
}

const SEND_TO_DRILL: [&str; 7] = ["send", "p.nc", "-m", "drill", "--yes", "--port", "./drill"];
/// 1.25 s at the speed of that drill.
const LEASE: [&str; 2] = ["--lease", "9999"];

/// A device beside the program may have the name of its machine, as in the README's example.
#[test]
fn a_link_may_be_called_as_its_machine() {
    let drill = Drill::start("stop-same-name");
    drill.write("%\nG21\nG90\nX1 Y0.5\n%\n");
    let (_, sent) = drill.told(&[&SEND_TO_DRILL[..], &LEASE].concat());
    assert!(sent.contains("1 hole drilled"), "{sent}");
    let mut jog = Command::new(env!("CARGO_BIN_EXE_husillo"))
        .current_dir(&drill.folder)
        .env("XDG_RUNTIME_DIR", &drill.folder)
        .args(["jog", "-m", "drill", "--port", "./drill", "x+", "60s"])
        .args(LEASE)
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    held(&drill.folder, 1);
    let (is_ok, stopped) = drill.told(&["stop", "-m", "drill"]);
    assert!(is_ok, "{stopped}");
    jog.wait().unwrap();
}

/// A drill that runs a program without a host reports that it runs, and is stopped.
#[test]
fn a_drill_left_alone_is_stopped() {
    let drill = Drill::start("stop-left-alone");
    let holes: String = (0..60)
        .map(|hole| format!("X{} Y0\n", hole % 2 * 100))
        .collect();
    drill.write(&format!("%\nG21\nG90\n{holes}%\n"));
    let (is_ok, left) = drill.told(&[&SEND_TO_DRILL[..], &["--detach"]].concat());
    assert!(is_ok, "{left}");
    let (_, busy) = drill.told(&SEND_TO_DRILL);
    assert!(busy.contains("the drill runs its program"), "{busy}");
    for is_first in [true, false] {
        let (is_ok, stopped) = drill.told(&["stop", "-m", "drill", "--port", "./drill"]);
        assert!(is_ok, "{stopped}");
        let ends = stopped.contains("completes its present");
        assert_eq!(ends, is_first, "{stopped}");
    }
}

/// A lease that a machine does not have is not silently left out.
#[test]
fn a_lease_that_a_machine_lacks_is_refused() {
    let long = "--lease 2560: the lease of a microfactory is at most 2550 ms";
    let mute = "--lease needs a device that answers";
    for (machine, ms, more, why) in [
        ("microfactory", "2560", &[][..], long),
        ("microfactory", "250", &["--without-answers"], mute),
    ] {
        let jog = ["jog", "-m", machine, "--lease", ms, "home"];
        let output = husillo().args(jog).args(more).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output).contains(why), "{}", text(&output));
    }
    let send = ["send", "p.nc", "-m", "drill", "--lease", "100", "--detach"];
    let output = husillo().args(send).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output).contains("cannot be used with"),
        "{}",
        text(&output)
    );
}

#[test]
fn a_port_that_is_free_needs_the_machine_at_it() {
    let folder = sockets("stop-usage");
    let unknown = stop(&folder, &["--port", "/dev/null"]);
    assert_eq!(unknown.status.code(), Some(2));
    let why = "/dev/null: no running husillo has this port: name the machine at it with -m";
    assert!(text(&unknown).contains(why), "{}", text(&unknown));
}
