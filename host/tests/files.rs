//! Files that commands write: no input is lost, and each is whole or as it was before.

mod common;

use common::husillo;
use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const PROGRAM: &str = "G21 G90\nG0 X1 Y1\nG1 X2 Y1.5 F5\nG2 X3 Y1.5 I0.5 J0\nM2\n";
const ROUTINE: &str = "safe z -10\npoint left towards +x at x10 y30 z-25\n";

/// A folder of one test, with its inputs.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = common::scratch("files").join(name);
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        let folder = Self(folder);
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        folder.put("c.nc", PROGRAM.as_bytes());
        folder.put("r.routine", ROUTINE.as_bytes());
        for (name, from) in [
            ("my.toml", "machines/micromill.toml"),
            ("b.drl", "examples/board.drl"),
            ("piece.toml", "examples/piece.toml"),
            ("square.nc", "examples/microfactory/square.nc"),
            ("zigzag.fig", "examples/microfactory/zigzag.fig"),
        ] {
            folder.put(name, &std::fs::read(root.join(from)).unwrap());
        }
        folder
    }

    fn put(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.0.join(name), bytes).unwrap();
    }

    fn get(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.0.join(name)).unwrap_or_default()
    }

    /// The program in this folder.
    fn husillo(&self, args: &[&str]) -> assert_cmd::Command {
        let mut command = husillo();
        command.current_dir(&self.0).args(args);
        command
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }
}

/// Every command that writes, with one of its inputs; `OUT` stands for the name of an output.
const WRITERS: [(&str, &str); 21] = [
    ("c.nc", "steps c.nc -o OUT"),
    ("my.toml", "steps c.nc -m my.toml -o OUT"),
    ("c.nc", "run c.nc -o OUT"),
    ("c.nc", "run c.nc -o r.html --trace OUT"),
    ("my.toml", "run c.nc -m my.toml -o OUT"),
    ("my.toml", "run c.nc -m my.toml --format json --trace OUT"),
    ("b.drl", "holes b.drl --as gcode --depth 1 -o OUT"),
    (
        "b.drl",
        "holes b.drl --as drill --only 1 --shift corner -o OUT",
    ),
    ("b.drl", "holes b.drl -o OUT"),
    (
        "b.drl",
        "compile b.drl -m drill --only 1 --shift corner -o OUT",
    ),
    (
        "b.drl",
        "compile b.drl -m drill --shift corner --report OUT",
    ),
    ("c.nc", "compile c.nc -m micromill -o OUT"),
    ("square.nc", "compile square.nc -m microfactory -o OUT"),
    ("zigzag.fig", "compile zigzag.fig -o OUT"),
    ("c.nc", "compare c.nc -o OUT"),
    ("my.toml", "compare c.nc -m my.toml -o OUT"),
    (
        "r.routine",
        "measure -m cmm3 --piece piece.toml run r.routine -o OUT",
    ),
    (
        "piece.toml",
        "measure -m cmm3 --piece piece.toml run r.routine -o OUT",
    ),
    (
        "piece.toml",
        "measure -m cmm3 --piece piece.toml record OUT",
    ),
    (
        "my.toml",
        "calibrate backlash --simulate --every 5mm -m my.toml -o OUT",
    ),
    (
        "my.toml",
        "calibrate backlash --simulate --every 5mm -m my.toml --report OUT",
    ),
];

#[test]
fn no_output_takes_the_place_of_an_input() {
    let folder = Folder::new("inputs");
    for (number, (input, args)) in WRITERS.into_iter().enumerate() {
        let before = folder.get(input);
        let beside = format!("./{input}");
        let up = format!("../inputs/{input}");
        let mut names = vec![input, &beside, &up];
        #[cfg(unix)]
        {
            for link in ["soft", "hard", "soft-soft"] {
                let _ = std::fs::remove_file(folder.0.join(link));
            }
            std::os::unix::fs::symlink(input, folder.0.join("soft")).unwrap();
            std::os::unix::fs::symlink("soft", folder.0.join("soft-soft")).unwrap();
            std::fs::hard_link(folder.0.join(input), folder.0.join("hard")).unwrap();
            names.extend(["soft", "hard", "soft-soft"]);
        }
        // By its name, and under one of the others in turn.
        for name in [names[0], names[1 + number % (names.len() - 1)]] {
            let args: Vec<&str> = args
                .split(' ')
                .map(|arg| if arg == "OUT" { name } else { arg })
                .collect();
            folder
                .husillo(&args)
                .assert()
                .code(2)
                .stderr(contains(format!("{name} would replace")).and(contains(input)));
            assert_eq!(folder.get(input), before, "{args:?}");
        }
        #[cfg(unix)]
        for link in ["soft", "hard", "soft-soft"] {
            std::fs::remove_file(folder.0.join(link)).unwrap();
        }
    }
    let litter = |name: &&String| name.ends_with(".new") || *name == "r.html";
    assert_eq!(folder.names().iter().find(litter), None);
}

#[test]
fn a_manifest_and_its_records_are_inputs() {
    let folder = Folder::new("manifest");
    let compile = |input, output| {
        let args = ["compile", input, "-m", "drill", "-o", output];
        let shift: &[&str] = if input == "b.drl" {
            &["--shift", "corner"]
        } else {
            &[]
        };
        folder.husillo(&[&args, shift].concat()).assert()
    };
    compile("b.drl", "b.cod").success();
    let before: Vec<_> = folder.names().iter().map(|name| folder.get(name)).collect();
    compile("b.toml", "b.cod")
        .code(2)
        .stderr(contains("would replace"));
    let after: Vec<_> = folder.names().iter().map(|name| folder.get(name)).collect();
    assert_eq!(before, after);
    compile("b.toml", "other.cod").success();
}

/// Standard input that comes from a file is an input, too.
#[cfg(unix)]
#[test]
fn standard_input_may_be_a_file() {
    let folder = Folder::new("stdin");
    let output = Command::new(env!("CARGO_BIN_EXE_husillo"))
        .current_dir(&folder.0)
        .args(["steps", "-", "-o", "c.nc"])
        .stdin(std::fs::File::open(folder.0.join("c.nc")).unwrap())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert_eq!(folder.get("c.nc"), PROGRAM.as_bytes());
}

#[test]
fn two_outputs_are_two_files() {
    let folder = Folder::new("two");
    folder.put("x", b"old");
    for (report, trace) in [("x", "./x"), ("y", "y")] {
        folder
            .husillo(&["run", "c.nc", "-o", report, "--trace", trace])
            .assert()
            .code(2)
            .stderr(contains("are the same file"));
    }
    assert_eq!(folder.get("x"), b"old");
    assert!(!folder.0.join("y").exists());
}

#[test]
fn format_may_replace_its_input() {
    let folder = Folder::new("format");
    folder.put("f.nc", b"g1x1f5\n");
    folder
        .husillo(&["format", "f.nc", "-o", "f.nc"])
        .assert()
        .success();
    assert_eq!(folder.get("f.nc"), b"G1 X1 F5\n");
}

/// A link stays a link, a file keeps its permissions, and one that may not be written is not.
#[cfg(unix)]
#[test]
fn links_and_permissions_stay() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new("links");
    folder.put("target", b"old");
    let target = folder.0.join("target");
    std::fs::set_permissions(&target, std::fs::Permissions::from_mode(0o640)).unwrap();
    for (link, to) in [("link", "target"), ("dangling", "made")] {
        std::os::unix::fs::symlink(to, folder.0.join(link)).unwrap();
        folder
            .husillo(&["steps", "c.nc", "-o", link])
            .assert()
            .success();
        assert!(folder.0.join(link).is_symlink());
        assert!(folder.get(to).starts_with(b"event,"));
    }
    let mode = target.metadata().unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o640);
}

#[test]
fn one_missing_folder_is_made() {
    let folder = Folder::new("folders");
    folder
        .husillo(&["run", "c.nc", "-o", "no/such/x.html"])
        .assert()
        .code(2)
        .stderr(contains("no/such"));
    assert!(!folder.0.join("no").exists());
    folder.husillo(&["run", "c.nc"]).assert().success();
    assert!(folder.get("out/c.html").starts_with(b"<!"));
    folder
        .husillo(&["steps", "c.nc", "-o", "new/c.csv"])
        .assert()
        .success();
    assert!(folder.get("new/c.csv").starts_with(b"event,"));
}

/// An output that is no plain file is written directly, and its errors are reported.
#[cfg(unix)]
#[test]
fn devices_are_written_directly() {
    let folder = Folder::new("devices");
    for out in ["-", "/dev/stdout"] {
        let command = folder
            .husillo(&["steps", "c.nc", "-o", out])
            .assert()
            .success();
        assert!(command.get_output().stdout.starts_with(b"event,"));
    }
    folder
        .husillo(&["steps", "c.nc", "-o", "/dev/null"])
        .assert()
        .success();
    if !Path::new("/dev/full").exists() {
        return eprintln!("skipped: no /dev/full here");
    }
    let full: [&[&str]; 6] = [
        &["steps", "c.nc", "-o", "/dev/full"],
        &["run", "c.nc", "-o", "r.html", "--trace", "/dev/full"],
        &["run", "c.nc", "-o", "/dev/full"],
        &["compile", "c.nc", "-m", "micromill", "-o", "/dev/full"],
        &["holes", "b.drl", "-o", "/dev/full"],
        &["compare", "c.nc", "-o", "/dev/full"],
    ];
    for args in full {
        folder
            .husillo(args)
            .assert()
            .code(2)
            .stderr(contains("/dev/full: "));
    }
    assert!(!folder.0.join("r.html").exists());
}

/// The outputs of a command, old as they are before it and new as it makes them.
struct Job {
    line: &'static str,
    outputs: &'static [&'static str],
}

const fn job(line: &'static str, outputs: &'static [&'static str]) -> Job {
    Job { line, outputs }
}

/// Every command that writes files.
const JOBS: [Job; 16] = [
    job("steps long.nc -o o", &["o"]),
    job("run long.nc -o o --trace t", &["o", "t"]),
    job("run long.nc --format json --trace t", &["t"]),
    job("holes b.drl --as gcode --depth 1 -o o", &["o"]),
    job(
        "holes b.drl --as drill --only 1 --shift corner -o o",
        &["o"],
    ),
    job("holes b.drl --format json -o o", &["o"]),
    job(
        "compile b.drl -m drill --shift corner -o o.cod --report p",
        &["o.T1.cod", "o.T2.cod", "o.toml", "p"],
    ),
    job("compile long.nc -m micromill -o o", &["o"]),
    job("compile square.nc -m microfactory -o o", &["o"]),
    job("compare circle --radius 30 -o o.html", &["o.html"]),
    job("format long.nc -o o", &["o"]),
    job("measure -m cmm status -o o", &["o"]),
    job("tune --method step -o o", &["o"]),
    job(
        "calibrate backlash readings.csv -o o --report p",
        &["o", "p"],
    ),
    job("reproduce microfactory 4.3 -o o.html", &["o.html"]),
    job("man pages", &["pages/husillo.1", "pages/husillo-run.1"]),
];

impl Job {
    fn args(&self) -> Vec<&'static str> {
        self.line.split(' ').collect()
    }
}

/// Some work, so that there are instants to be killed at.
fn long() -> String {
    let mut text = String::from("g21 g90 f10\n");
    for turn in 0..40 {
        text += &format!("g1 x1.{:02} y1.{:02}\n", turn % 3, turn % 2);
    }
    text + "m2\n"
}

/// What every output is before a command.
const OLD: &[u8] = b"old, and longer than nothing";

/// A folder with the old outputs of a job.
fn prepared(name: &str, job: &Job) -> Folder {
    let folder = Folder::new(name);
    folder.put("long.nc", long().as_bytes());
    folder.put(
        "readings.csv",
        b"axis,x,programmed,measured\nx,2,1,1.02\nx,8,1,1.03\n",
    );
    std::fs::create_dir(folder.0.join("pages")).unwrap();
    job.outputs.iter().for_each(|name| folder.put(name, OLD));
    folder
}

/// A program that works on a job.
fn begun(folder: &Folder, job: &Job, stdout: Stdio) -> std::process::Child {
    Command::new(env!("CARGO_BIN_EXE_husillo"))
        .current_dir(&folder.0)
        .args(job.args())
        .env("SOURCE_DATE_EPOCH", "1700000000") // reports of two runs are equal
        .env("XDG_STATE_HOME", &folder.0)
        .stdin(Stdio::null())
        .stdout(stdout)
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// Kills a command at instants of its run: each output is the old file or the new one.
fn kill(job: &Job, number: usize, times: u32) {
    let folder = prepared(&format!("killed-{number}"), job);
    let start = Instant::now();
    let status = begun(&folder, job, Stdio::null()).wait().unwrap();
    let whole = start.elapsed().as_secs_f64();
    assert_ne!(status.code(), Some(2), "{}", job.line);
    let new: Vec<_> = job.outputs.iter().map(|name| folder.get(name)).collect();
    assert!(
        new.iter().all(|new| !new.is_empty() && new != OLD),
        "{}",
        job.line
    );
    let mut seed = 0x9e37_79b9_u32.wrapping_add(number as u32);
    for _ in 0..times {
        job.outputs.iter().for_each(|name| folder.put(name, OLD));
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let share = f64::from(seed >> 8) / f64::from(1 << 24);
        let mut child = begun(&folder, job, Stdio::null());
        std::thread::sleep(Duration::from_secs_f64(whole * 1.1 * share));
        child.kill().unwrap();
        child.wait().unwrap();
        for (name, new) in job.outputs.iter().zip(&new) {
            let now = folder.get(name);
            assert!(
                now == OLD || now == *new,
                "{} left a piece of {name}",
                job.line
            );
        }
    }
    std::fs::remove_dir_all(&folder.0).unwrap();
}

#[test]
fn killed_commands_leave_the_old_file_or_the_new_one() {
    let next = std::sync::atomic::AtomicUsize::new(0);
    let work = || {
        loop {
            let number = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            let Some(job) = JOBS.get(number) else { break };
            kill(job, number, 100);
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(work);
        }
    });
}

/// So does one whose reader has gone, and it leaves nothing else.
#[cfg(unix)]
#[test]
fn a_closed_pipe_leaves_the_old_file_or_the_new_one() {
    for (number, job) in JOBS.iter().enumerate() {
        let folder = prepared(&format!("closed-{number}"), job);
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let status = begun(&folder, job, writer.into()).wait().unwrap();
        assert_eq!(status.code(), Some(0), "{}", job.line);
        let now: Vec<_> = job.outputs.iter().map(|name| folder.get(name)).collect();
        let is_old = now[0] == OLD;
        assert!(now.iter().all(|now| (now == OLD) == is_old), "{}", job.line);
        assert!(now.iter().all(|now| !now.is_empty()), "{}", job.line);
        assert!(
            !folder.names().iter().any(|name| name.ends_with(".new")),
            "{}",
            job.line
        );
        std::fs::remove_dir_all(&folder.0).unwrap();
    }
}

/// A record of what happens has its name when the command ends, also by Ctrl-C. At a kill the old
/// file stays.
#[cfg(unix)]
#[test]
fn a_record_is_whole_when_its_command_ends() {
    for (signal, is_kept) in [("TERM", false), ("KILL", true)] {
        for (args, input, sign) in [
            (
                &[
                    "emulate",
                    "drill",
                    "--listen",
                    "127.0.0.1:0",
                    "--steps",
                    "o",
                ][..],
                "reset\n",
                "reset",
            ),
            (
                &[
                    "measure",
                    "-m",
                    "cmm3",
                    "--piece",
                    "piece.toml",
                    "record",
                    "o",
                ],
                "safe z -10\npoint left towards +x at x10 y30 z-25\n",
                "left",
            ),
        ] {
            let folder = Folder::new(&format!("record-{signal}-{}", args[0]));
            folder.put("o", OLD);
            let mut child = Command::new(env!("CARGO_BIN_EXE_husillo"))
                .current_dir(&folder.0)
                .args(args)
                .env("XDG_STATE_HOME", &folder.0)
                .stdin(Stdio::piped())
                .stdout(Stdio::piped())
                .spawn()
                .unwrap();
            let mut typed = child.stdin.take().unwrap();
            typed.write_all(input.as_bytes()).unwrap();
            let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
            assert!(lines.any(|line| line.unwrap().contains(sign)), "{args:?}");
            // What was reported is written a little later.
            std::thread::sleep(Duration::from_millis(300));
            assert_eq!(folder.get("o"), OLD);
            let id = child.id().to_string();
            let sent = Command::new("kill").args(["-s", signal, &id]).status();
            assert!(sent.unwrap().success());
            child.wait().unwrap();
            let now = folder.get("o");
            assert_eq!(now == OLD, is_kept, "{args:?} {signal}");
            assert!(now.len() > 20, "{args:?} {signal}");
        }
    }
}

/// Where there is no more room: here a limit of the size of files, as a quota is.
#[cfg(target_os = "linux")]
#[test]
fn without_room_the_old_files_stay() {
    for (number, job) in JOBS.iter().enumerate() {
        let folder = prepared(&format!("full-{number}"), job);
        // No byte may be written to a file; the signal for it is not obeyed.
        let script = format!(
            "trap '' XFSZ; ulimit -f 0; exec '{}' {}",
            env!("CARGO_BIN_EXE_husillo"),
            job.line
        );
        let output = Command::new("sh")
            .current_dir(&folder.0)
            .env("XDG_STATE_HOME", &folder.0)
            .args(["-c", &script])
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{}: {told}", job.line);
        assert!(told.contains("too large"), "{told}");
        for name in job.outputs {
            assert_eq!(folder.get(name), OLD, "{}: {name}", job.line);
        }
        assert!(
            !folder.names().iter().any(|name| name.ends_with(".new")),
            "{}",
            job.line
        );
    }
}

/// A command that is requested to end removes the file that it has begun.
#[cfg(target_os = "linux")]
#[test]
fn a_requested_end_leaves_nothing() {
    let program = env!("CARGO_BIN_EXE_husillo");
    removes_its_file_at_sigterm(Command::new(program), "ended");
}

/// So does one that was started with SIGHUP ignored. SIGHUP does not end that one.
#[cfg(target_os = "linux")]
#[test]
fn a_requested_end_under_nohup_leaves_nothing() {
    let mut nohup = Command::new("nohup");
    nohup.arg(env!("CARGO_BIN_EXE_husillo"));
    removes_its_file_at_sigterm(nohup, "ended-nohup");
}

#[cfg(target_os = "linux")]
fn removes_its_file_at_sigterm(mut command: Command, name: &str) {
    let folder = Folder::new(name);
    folder.put("long.nc", long().replace("m2\n", "").repeat(900).as_bytes());
    folder.put("o", b"old");
    let mut child = command
        .current_dir(&folder.0)
        .args(["steps", "long.nc", "-o", "o"])
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let begun = |folder: &Folder| folder.names().iter().any(|name| name.ends_with(".new"));
    let start = Instant::now();
    while !begun(&folder) {
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(2));
    }
    // The handler of SIGTERM, signal 15, is installed after the file was begun.
    let listens = || {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        u64::from_str_radix(caught.unwrap().trim(), 16).unwrap() & 1 << 14 != 0
    };
    while !listens() {
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(2));
    }
    let id = child.id().to_string();
    let signal = |name: &str| {
        let sent = Command::new("kill").args([name, &id]).status();
        assert!(sent.unwrap().success());
    };
    if name.ends_with("nohup") {
        signal("-HUP");
        std::thread::sleep(Duration::from_millis(200));
        assert!(begun(&folder), "SIGHUP was ignored before it began");
    }
    signal("-TERM");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(folder.get("o"), b"old");
    assert!(!begun(&folder));
}

/// The examples in the program are those of the checkout, and no file is replaced.
#[test]
fn examples_are_written_whole_or_not_at_all() {
    let folder = Folder::new("examples");
    let write = ["examples", "write", "deep/examples"];
    folder
        .husillo(&write)
        .assert()
        .success()
        .stdout(contains("deep/examples"));
    let origin = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    for name in [
        "gear.nc",
        "piece.toml",
        "cam/fusion.nc",
        "microfactory/zigzag.fig",
    ] {
        let written = folder.get(&format!("deep/examples/{name}"));
        assert_eq!(written, std::fs::read(origin.join(name)).unwrap(), "{name}");
    }
    let part = "deep/examples/piece.routine";
    std::fs::remove_file(folder.0.join("deep/examples/gear.nc")).unwrap();
    folder.put(part, b"mine");
    folder
        .husillo(&write)
        .assert()
        .code(2)
        .stderr(contains("exists already"));
    assert_eq!(folder.get(part), b"mine");
    assert!(folder.get("deep/examples/gear.nc").is_empty());
    let program = folder
        .husillo(&["examples", "show", "gear.nc"])
        .assert()
        .success();
    assert_eq!(
        program.get_output().stdout,
        std::fs::read(origin.join("gear.nc")).unwrap()
    );
    folder
        .husillo(&["examples", "show", "wheel.nc"])
        .assert()
        .code(2);
}
