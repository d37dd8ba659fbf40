//! The drill as a user drives it: `jog -m drill`, `emulate drill`.

mod common;
mod emulated;

use assert_cmd::Command;
use common::signal;
use emulated::Emulated;
use predicates::prelude::*;
use predicates::str::contains;

fn husillo() -> Command {
    let mut command = Command::cargo_bin("husillo").unwrap();
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

/// A drill 100 times as fast as a real one; `None` where there are no pseudo-terminals.
fn device(name: &str, args: &[&str]) -> Option<Emulated> {
    Emulated::new("drill", name, &[&["--speed", "100"], args].concat())
}

fn jog(device: &Emulated, actions: &[&str]) -> assert_cmd::assert::Assert {
    let port = ["jog", "-m", "drill", "--port", device.port()];
    husillo().args(port).args(NO_LEASE).args(actions).assert()
}

/// A lease of a drill 100 times as fast would be 2.5 ms.
const NO_LEASE: [&str; 2] = ["--lease", "0"];

/// A name in the folder for passing files that is this test's alone.
fn passing(name: &str) -> std::path::PathBuf {
    std::env::temp_dir().join(format!("husillo-drill-{}-{name}", std::process::id()))
}

#[test]
fn a_session_by_hand_in_simulated_time() {
    let file = passing("taught.cod");
    husillo()
        .args(["jog", "-m", "drill", "test", "help", "x", "300", "teach"])
        .args(["x", "-20", "y+", "1s", "teach", "z", "10", "z", "-30"])
        .args(["spindle", "on", "spindle", "off", "save"])
        .arg(&file)
        .arg("run")
        .assert()
        .success()
        .stdout(contains("T teach").and(contains("taught 300,0")))
        .stdout(contains("drilled at 280,").and(contains("6 records")))
        // 300 steps at 247 a second, and homing before them.
        .stdout(contains("spindle on: ").and(contains("homed")));
    let program = std::fs::read(&file).unwrap();
    let _ = std::fs::remove_file(&file);
    assert_eq!(program[..9], *b"X\x2c\x01Y\0\0Z\0\0");
    assert_eq!(program.len(), 19);
}

#[test]
fn the_same_over_a_pseudo_terminal() {
    let Some(mut device) = device("drill-hand", &[]) else {
        return;
    };
    jog(
        &device,
        &["home", "x", "300", "y", "25", "teach", "x+", "0.2s", "run"],
    )
    .success();
    device.read_until("drilled at 300,25");
    let place = device.type_line("where", "lost");
    assert!(
        place.contains("x 300 y 25 steps from home, z 0 "),
        "{place}"
    );
    assert!(
        place.contains("1 hole,") && place.contains("; 0 steps lost"),
        "{place}"
    );
}

/// A switch that does not close, a power failure, a pulled cable, the button: each is reported in a
/// sentence, and the button restores the drill.
#[test]
fn faults_at_the_panel() {
    let Some(mut device) = device("drill-panel", &[]) else {
        return;
    };
    jog(&device, &["home"]).success();
    device.type_line("close x", "held closed");
    device.type_line("reset", "reset");
    device.read_until("fault: home switch x is still closed");
    device.type_line("free x", "free");
    jog(&device, &["home"]).code(1).stderr(contains("button R"));
    device.type_line("reset", "reset");
    jog(&device, &["home", "x", "10"]).success();
    device.type_line("unplug", "unplugged");
    jog(&device, &["home"])
        .code(1)
        .stderr(contains("no answer: the drill is off, unplugged"));
    device.type_line("plug", "plugged");
    device.type_line("power off", "off");
    jog(&device, &["home"])
        .code(1)
        .stderr(contains("no answer"));
    device.type_line("power on", "on");
    jog(&device, &["home", "x", "10"]).success();
}

/// A board in progress, with its first hole drilled.
fn drilling(file: &str, device: &mut Emulated) -> std::process::Child {
    let child = std::process::Command::new(env!("CARGO_BIN_EXE_husillo"))
        .args(["send", file, "-m", "drill", "--port", device.port()])
        .args(NO_LEASE)
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    device.read_until("drilled at 1070,535");
    child
}

/// Steps lost in the middle of a board: the switch shows it on the return home, and the host
/// reports it at once.
#[test]
fn lost_steps_are_reported() {
    let Some(mut device) = device("drill-lost", &[]) else {
        return;
    };
    let file = program("lost.nc", THREE);
    let child = drilling(&file, &mut device);
    device.type_line("push x -60", "pushed");
    device.read_until("steps were lost");
    let output = child.wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("stopped because of a fault"), "{told}");
    assert!(told.contains("look at the board"), "{told}");
    let place = device.type_line("where", "lost");
    assert!(place.contains("spindle off"), "{place}");
    device.type_line("reset", "reset");
    device.read_until("homed");
    jog(&device, &["test"]).success();
    let _ = std::fs::remove_file(file);
}

/// Holes are taught in one session and in the next; a third one runs them, with the spindle on, and
/// stops it.
#[test]
fn teaching_goes_on_in_another_session() {
    let Some(mut device) = device("drill-teach", &[]) else {
        return;
    };
    jog(&device, &["run"])
        .code(1)
        .stderr(contains("holds no program"));
    jog(&device, &["x", "300", "teach"]).success();
    jog(&device, &["y", "25", "teach", "x", "-30"])
        .success()
        .stdout(contains("x is at its end"));
    jog(&device, &["run"])
        .success()
        .stdout(contains("2 drillings, with the spindle on"));
    device.read_until("spindle on");
    device.read_until("drilled at 300,0");
    device.read_until("drilled at 0,25");
    device.read_until("spindle off");
    let holes = device.type_line("holes", "2 holes:");
    assert!(!holes.contains("stood"), "{holes}");
    jog(&device, &["clear", "run"]).code(1);
}

#[test]
fn the_original_teaches_nothing() {
    let Some(mut device) = device("drill-original", &["--faithful"]) else {
        return;
    };
    jog(&device, &["x", "5", "spindle", "on"]).success();
    device.read_until("spindle on");
    jog(&device, &["teach"])
        .code(1)
        .stderr(contains("no teach-in"));
}

#[test]
fn wrong_actions_move_nothing() {
    for (actions, reason) in [
        (&["fly"][..], "unknown action `fly`"),
        (&["home", "x"], "by how many steps"),
        (&["y+", "5"], "how long"),
        (&["save"], "to which file"),
    ] {
        husillo()
            .args(["jog", "-m", "drill"])
            .args(actions)
            .assert()
            .code(2)
            .stdout("")
            .stderr(contains(reason));
    }
    for (option, reason) in [
        (&["--figure", "a.fig"][..], "no figures"),
        (&["--without-answers"], "answers every byte"),
    ] {
        husillo()
            .args(["jog", "-m", "drill", "home"])
            .args(option)
            .assert()
            .code(2)
            .stdout("")
            .stderr(contains(reason));
    }
    husillo()
        .args(["jog", "-m", "lathe", "home"])
        .assert()
        .code(2)
        .stdout("")
        .stderr(contains("name microfactory, drill, micromill"));
}

/// A program of the drill's language, in a file of this test's own.
fn program(name: &str, text: &str) -> String {
    let file = passing(name);
    std::fs::write(&file, text).unwrap();
    file.to_str().unwrap().to_owned()
}

const THREE: &str = "%\nG21\nG90\nX10 Y5\nX12.54\nY7.54\n%\n";

#[test]
fn programs_are_compiled_and_listed() {
    let file = program("three.nc", THREE);
    let records = passing("three.cod");
    husillo()
        .args(["compile", &file, "-m", "drill", "-o"])
        .arg(&records)
        .assert()
        .success()
        .stdout(contains("3 holes, 22 bytes, 40.2 mm in X and Y"));
    let listed = |format: &str| {
        let command = ["commands", records.to_str().unwrap(), "--format", format];
        husillo().args(command).assert().success()
    };
    listed("text").stdout(contains("1  X 1070       10 mm").and(contains("drill        to the")));
    listed("json").stdout(contains(
        "\"record\":4,\"kind\":\"x\",\"steps\":1342,\"nm\":12542056}",
    ));
    // There and back: the same bytes.
    let text = String::from_utf8(listed("gcode").get_output().stdout.clone()).unwrap();
    let again = program("again.nc", &text);
    let second = passing("again.cod");
    husillo()
        .args(["compile", &again, "-o"])
        .arg(&second)
        .assert()
        .success();
    assert_eq!(
        std::fs::read(&records).unwrap(),
        std::fs::read(&second).unwrap()
    );
    husillo()
        .args(["compile", &file, "-m", "router"])
        .assert()
        .code(2)
        .stderr(contains("name micromill, drill or microfactory"));
    for file in [file.as_ref(), again.as_ref(), &*records, &*second] {
        let _ = std::fs::remove_file::<&std::path::Path>(file);
    }
}

/// Compiles the example board.
fn board(args: &[&str]) -> assert_cmd::assert::Assert {
    let compile = ["compile", "../examples/board.drl", "-m", "drill"];
    husillo().args(compile).args(args).assert()
}

#[test]
fn a_board_has_a_file_for_each_tool_and_a_manifest() {
    let folder = passing("board");
    let page = folder.join("b.html");
    husillo()
        .args(["compile", "../examples/board.drl", "-m", "drill"])
        .args(["--shift", "corner", "--order", "shortest", "-o"])
        .arg(folder.join("b.cod"))
        .arg("--report")
        .arg(&page)
        .assert()
        .success()
        .stdout(contains("b.T4.cod: T4 (1.5 mm), 7 holes").and(contains("% less")));
    let manifest = std::fs::read_to_string(folder.join("b.toml")).unwrap();
    assert!(manifest.contains("diameter_mm = 3.2\nfile = \"b.T3.cod\"\nholes = 2"));
    let page = std::fs::read_to_string(page).unwrap();
    assert_eq!(page.matches("<circle").count(), 29);
    // A path for each tool and one back to zero, which the travel includes; a bar of 10 mm.
    assert_eq!(page.matches("class=\"way\"").count(), 4);
    assert_eq!(page.matches("class=\"way back\"").count(), 4);
    assert!(page.contains(">10 mm</text>"));
    assert!(page.contains("Travel in X and Y") && !page.contains("<script"));
    let _ = std::fs::remove_dir_all(&folder);
}

#[test]
fn a_manifest_is_sent_as_it_is() {
    let folder = passing("board-manifest");
    let output = folder.join("b.cod");
    board(&["--shift", "corner", "-o", output.to_str().unwrap()]).success();
    let manifest = folder.join("b.toml");
    husillo()
        .args(["send", manifest.to_str().unwrap(), "-m", "drill"])
        .write_stdin("0.8\n1.2\n1\n3.2\n1.5\n")
        .assert()
        .success()
        .stdout(contains("1.2 mm is not 1 mm").and(contains("29 holes drilled")));
    // Records are where they are, and their files those of the manifest.
    let send = ["send", manifest.to_str().unwrap(), "-m", "drill", "--yes"];
    husillo()
        .args(send)
        .args(["--order", "shortest"])
        .assert()
        .code(2)
        .stderr(contains("records have positions"));
    let text = std::fs::read_to_string(&manifest).unwrap();
    for (from, to, why) in [
        (
            "diameter_mm = 3.2",
            "diameter_mm = nan",
            "tool 3 has no diameter",
        ),
        (
            "diameter_mm = 3.2",
            "diameter_mm = -5.0",
            "tool 3 has no diameter",
        ),
        ("bytes = ", "bytes = 1", "compile it again"),
    ] {
        std::fs::write(&manifest, text.replacen(from, to, 1)).unwrap();
        husillo()
            .args(send)
            .assert()
            .failure()
            .stderr(contains(why));
    }
    let _ = std::fs::remove_dir_all(&folder);
}

#[test]
fn the_command_to_go_on_with_is_the_one_that_was_typed() {
    husillo()
        .args([
            "send",
            "../examples/board.drl",
            "-m",
            "drill",
            "--shift",
            "corner",
            "--from",
            "3",
        ])
        .write_stdin("0.8\n")
        .assert()
        .code(1)
        .stderr(contains(
            "husillo send ../examples/board.drl -m drill --shift corner --from 1",
        ));
}

#[test]
fn a_board_is_placed_and_has_a_depth() {
    let folder = passing("board-placed");
    let (output, page) = (folder.join("b.cod"), folder.join("c.html"));
    // Mirrored, turned by a right angle, and laid on two holes that were measured.
    let turned = ["--mirror", "x", "--turn", "90"];
    let first = ["--reference", "10,10=30.02,37"];
    let second = ["--reference", "27.78,10=30.03,19.21"];
    let report = ["--report", page.to_str().unwrap()];
    board(&[&turned[..], &first, &second, &report].concat())
        .success()
        .stderr(contains(
            "turned by 0.0322 degrees; longer than the file by 563 um/m",
        ));
    board(&["--depth", "31.5", "-o", output.to_str().unwrap()]).success();
    let deep = std::fs::read(folder.join("b.T3.cod")).unwrap();
    assert!(
        deep.windows(3).any(|record| record == b"Z\x2b\x0d"),
        "3371 steps"
    );
    board(&["--depth", "35.1"])
        .code(2)
        .stderr(contains("the lower sensor"));
    board(&["--shift", "200,0"])
        .code(1)
        .stderr(contains("off the table"));
    let _ = std::fs::remove_dir_all(&folder);
}

fn send(device: &Emulated, file: &str, args: &[&str]) -> assert_cmd::assert::Assert {
    let port = ["send", file, "-m", "drill", "--port", device.port()];
    let lease = match args.contains(&"--detach") || args.contains(&"--lease") {
        true => &[][..],
        false => &NO_LEASE,
    };
    husillo().args(port).args(lease).args(args).assert()
}

#[test]
fn a_program_over_a_pseudo_terminal() {
    let Some(mut device) = Emulated::new("drill", "drill-send", &["--speed", "25"]) else {
        return;
    };
    let file = program("send.nc", THREE);
    send(&device, &file, &[])
        .success()
        .stdout(contains("3 holes drilled"));
    assert_eq!(
        device.type_line("holes", "3 holes:").trim(),
        "3 holes: 1070,535 depth 3745; 1342,535 depth 3745; 1342,807 depth 3745"
    );
    // By itself, and from the second hole on.
    device.type_line("board", "without holes");
    // The drill cannot see that the board is another one.
    send(&device, &file, &["--from", "2", "--detach"])
        .code(1)
        .stderr(contains(
            "For another board: `husillo jog -m drill --port PORT clear`",
        ));
    jog(&device, &["clear"]).success();
    send(&device, &file, &["--from", "2", "--detach"])
        .success()
        .stdout(contains("runs the program alone"));
    device.read_until("drilled at 1342,807");
    device.type_line("holes", "2 holes: 1342,535");
    let _ = std::fs::remove_file(file);
}

#[test]
fn the_original_over_a_pseudo_terminal() {
    let Some(mut device) = device("drill-send-original", &["--faithful", "--baud", "9600"]) else {
        return;
    };
    let file = program("original.nc", THREE);
    husillo()
        .args(["send", &file, "-m", "drill", "--baud", "9600"])
        .args(["--port", device.port()])
        .assert()
        .success()
        .stdout(contains("by hand").not())
        .stdout(contains("3 holes drilled"));
    let holes = device.type_line("holes", "3 holes: 1070,535 depth 3745");
    assert!(!holes.contains("a spindle that stood"), "{holes}");
    // It would drill through where there is a depth.
    device.type_line("board", "without holes");
    let deep = program("deep.nc", "G21 G90\nG0 Z2\nG81 X1 Y2 Z-3 R1 F60\nG80\n");
    send(&device, &deep, &["--baud", "9600", "--fixed"])
        .code(2)
        .stderr(contains("it ignores depths"));
    device.type_line("holes", "0 holes");
    let _ = std::fs::remove_file(deep);
    let _ = std::fs::remove_file(file);
}

/// Ctrl-C: stops after the hole that is being drilled, and reports the next one.
#[cfg(unix)]
#[test]
fn a_run_is_stopped() {
    let Some(mut device) = device("drill-stop", &[]) else {
        return;
    };
    let file = program("stop.nc", THREE);
    let child = drilling(&file, &mut device);
    signal(&child, "INT");
    let output = child.wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("stopped\n"), "{told}");
    assert!(told.contains("of 3 holes drilled; go on with"), "{told}");
    let where_ = device.type_line("where", "lost");
    assert!(where_.contains("spindle off"), "{where_}");
    let count = where_.split(" hole").next().unwrap();
    let count = count.rsplit(' ').next().unwrap().to_owned();
    assert!(
        told.contains(&format!("\n{count} of 3")),
        "{told}; {where_}"
    );
    if count != "3" {
        let next = (count.parse::<u32>().unwrap() + 1).to_string();
        send(&device, &file, &["--from", &next]).success();
    }
    device.type_line("holes", "3 holes: 1070,535");
    let _ = std::fs::remove_file(file);
}

/// Ctrl-C while it asks for a tool ends the job there.
#[cfg(unix)]
#[test]
fn a_tool_change_is_interrupted() {
    use std::io::BufRead;

    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_husillo"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["send", "../examples/board.drl", "-m", "drill"])
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = std::io::BufReader::new(child.stdout.take().unwrap()).lines();
    let asked = lines.next().unwrap().unwrap();
    assert!(asked.contains("type its diameter"), "{asked}");
    signal(&child, "TERM");
    // Its input stays open until it has ended.
    let input = child.stdin.take();
    let output = child.wait_with_output().unwrap();
    drop(input);
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("T1 (0.8 mm) was not put in"), "{told}");
    assert!(
        told.contains("0 of 29 holes drilled; begin again with"),
        "{told}"
    );
}

/// The button in the middle of a run.
#[test]
fn an_emergency_stop() {
    let Some(mut device) = device("drill-emergency", &[]) else {
        return;
    };
    let file = program("emergency.nc", THREE);
    let child = drilling(&file, &mut device);
    device.type_line("reset", "reset");
    device.read_until("homed");
    let output = child.wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("the drill was reset"), "{told}");
    assert!(told.contains("look at the board"), "{told}");
    let _ = std::fs::remove_file(file);
}

/// The host is killed, or its cable is pulled, behind the first hole: the drill stops in the second
/// one with its lease, comes up, and is not on its own. `--from` goes on without homing.
#[test]
fn a_drill_without_its_host_stops() {
    let file = program("alone.nc", THREE);
    for is_killed in [true, false] {
        // 10 s of the drill, in which it would not complete the hole, are 1.25 s here.
        let Some(mut device) = Emulated::new("drill", "drill-alone", &["--speed", "8"]) else {
            return;
        };
        let lease = ["--lease", "9999"];
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_husillo"))
            .args(["send", &file, "-m", "drill", "--port", device.port()])
            .args(lease)
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        device.read_until("drilled at 1070,535");
        if is_killed {
            child.kill().unwrap();
        } else {
            device.type_line("unplug", "unplugged");
        }
        let output = child.wait_with_output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(is_killed || told.contains("no answer"), "{told}");
        device.read_until("the host is silent: its lease has expired");
        device.read_until("spindle off");
        let place = device.type_line("where", "lost");
        let stands = "x 1342 y 535 steps from home, z 0 below its sensor, spindle off; 1 hole,";
        assert!(place.contains(stands), "{place}");
        device.type_line("plug", "plugged");
        let port = ["jog", "-m", "drill", "--port", device.port(), "where"];
        husillo().args(port).assert().success().stdout(
            contains("state    at rest, homed")
                .and(contains("x        1342 steps, 12.542 mm, 0.4938 in"))
                .and(contains("y        535 steps, 5.000 mm, 0.1969 in"))
                .and(contains("z        up, at its sensor"))
                .and(contains("spindle  off"))
                .and(contains("1 drillings done since")),
        );
        assert_eq!(device.type_line("where", "lost"), place, "it goes on");
        let rest = ["--from", "2", "--no-home"];
        send(&device, &file, &[&lease[..], &rest].concat()).success();
        let holes = device.type_line("holes", "3 holes:");
        assert_eq!(
            holes.trim(),
            "3 holes: 1070,535 depth 3745; 1342,535 depth 3745; 1342,807 depth 3745"
        );
    }
    let _ = std::fs::remove_file(file);
}

/// A drill that works alone: its holes are counted by itself. `--from` with the number that was
/// right before is not repeated, and drills no hole twice.
#[test]
fn a_drill_that_worked_alone_is_asked_for_its_holes() {
    let Some(mut device) = device("drill-left", &[]) else {
        return;
    };
    let holes: String = (0..30)
        .map(|hole| format!("X{} Y1\n", 1 + hole % 2 * 60))
        .collect();
    let file = program("left.nc", &format!("%\nG21\nG90\n{holes}%\n"));
    send(&device, &file, &["--detach"])
        .success()
        .stdout(contains("has no lease"));
    device.read_until("drilled at");
    let at_work = send(&device, &file, &["--from", "2"]).code(1);
    let told = String::from_utf8_lossy(&at_work.get_output().stderr).into_owned();
    assert!(told.contains("runs its program"), "{told}");
    assert!(told.contains("nothing was sent"), "{told}");
    assert!(!told.contains("go on with"), "{told}");
    jog(&device, &["where"])
        .success()
        .stdout(contains("runs a program alone").and(contains("x        unknown")));
    device.read_until("spindle off");
    send(&device, &file, &["--from", "2"])
        .code(1)
        .stderr(contains("by its own count").and(contains("30 of 30 holes drilled")));
    device.type_line("holes", "30 holes");
    // Stopped during the program: it goes on with the number that is reported.
    jog(&device, &["clear"]).success();
    device.type_line("board", "without holes");
    send(&device, &file, &["--detach"]).success();
    device.read_until("drilled at");
    device.read_until("drilled at");
    jog(&device, &["stop"]).success();
    let place = device.type_line("where", "lost");
    let drilled = place
        .split(" hole")
        .next()
        .unwrap()
        .rsplit(' ')
        .next()
        .unwrap()
        .to_owned();
    let next = (drilled.parse::<u32>().unwrap() + 1).to_string();
    send(&device, &file, &["--from", "2"])
        .code(1)
        .stderr(contains(format!(
            "{drilled} of 30 holes drilled; go on with"
        )))
        .stderr(contains(format!("--from {next}")));
    send(&device, &file, &["--from", &next]).success();
    device.type_line("holes", "30 holes");
    let _ = std::fs::remove_file(file);
}

/// What a drill says of itself in each state, and that the rest is unknown.
#[test]
fn where_is_answered_in_every_state() {
    let Some(mut device) = device("drill-where", &[]) else {
        return;
    };
    // In the manual mode it goes on from there: it homes once.
    jog(
        &device,
        &[
            "x", "10mm", "where", "y", "0.5in", "spindle", "on", "where", "clear", "where",
        ],
    )
    .success()
    .stdout(contains(
        "x        1070 steps, 10.000 mm, 0.3937 in\ny        0 steps",
    ))
    .stdout(contains("y        1359 steps, 12.701 mm, 0.5000 in"))
    .stdout(contains(
        "z        up, at its sensor\nspindle  on\nprogram  none",
    ))
    .stdout(contains(
        "from a zero at 1070 and 1359 steps from the switches\nx        0 steps",
    ));
    jog(&device, &["z", "25", "where"])
        .success()
        .stdout(contains("z        between its sensors"));
    device.type_line("close x", "held closed");
    device.type_line("reset", "reset");
    device.read_until("fault: home switch x");
    let unknown = "x        unknown\ny        unknown\nz        unknown";
    jog(&device, &["where"])
        .success()
        .stdout(contains("stopped with a fault").and(contains(unknown)));
    jog(&device, &["home"])
        .code(1)
        .stderr(contains("stopped because of a fault"));
    device.type_line("unplug", "unplugged");
    jog(&device, &["where"])
        .code(1)
        .stdout(contains("does not answer").and(contains(unknown)));
    let Some(original) = self::device("drill-where-original", &["--faithful"]) else {
        return;
    };
    jog(&original, &["where"])
        .success()
        .stdout(contains("an original drill, which reports nothing else").and(contains(unknown)));
    // A drill that is asked for a lease which it does not have is not driven.
    let port = [
        "jog",
        "-m",
        "drill",
        "--port",
        original.port(),
        "--lease",
        "250",
        "home",
    ];
    husillo()
        .args(port)
        .assert()
        .code(1)
        .stderr(contains("does not confirm a lease"));
}

/// Z has no coordinate, so its travel is not checked.
#[test]
fn the_machine_is_shown_without_a_travel_of_z() {
    husillo()
        .args(["machines", "show", "drill"])
        .assert()
        .success()
        .stdout(
            contains("travel 0 to 220 mm").and(contains("Z  9.3458 um per step, moved only by")),
        )
        .stdout(contains("0.001").not());
}

/// Each event of a drill with its time: X goes, Z goes down and up, the spindle turns.
#[test]
fn what_it_makes_is_written_down() {
    let path = passing("made.csv");
    let Some(mut device) = device("drill-made", &["--steps", path.to_str().unwrap()]) else {
        return;
    };
    jog(&device, &["home", "x", "3", "z", "2", "spindle", "on"]).success();
    device.type_line("where", "lost");
    device.end();
    let text = std::fs::read_to_string(&path).unwrap();
    let (heading, rows) = text.split_once('\n').unwrap();
    assert_eq!(heading, "event,t_us,wait_ticks,dx,dy,dz,lx,ly,lz,spindle");
    let rows: Vec<Vec<i64>> = rows
        .lines()
        .map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    // Its first position is above its switches; after homing it ends where it was jogged to.
    let sum = |column: usize| rows.iter().map(|row| row[column]).sum::<i64>();
    assert_eq!([sum(3), sum(4)], [3 - 500, -250]);
    let steps = rows.iter().filter(|row| row[3..6] != [0; 3]);
    assert!(
        steps.clone().all(|row| row[2] == 4048),
        "247 steps a second"
    );
    assert_eq!(steps.count() as i64, rows.last().unwrap()[0]);
    let spindle: Vec<i64> = rows.iter().map(|row| row[9]).collect();
    assert_eq!(spindle.iter().max(), Some(&1));
    // Rows follow one another by their waits where it did not stand.
    assert!(
        rows.windows(2)
            .all(|two| two[1][1] - two[0][1] >= two[1][2])
    );
    std::fs::remove_file(path).unwrap();
}

/// The events of the original: its spindle turns on after X and Y, turns while Z moves down and up,
/// and is off when X moves on.
#[test]
fn the_spindle_of_the_original_is_in_what_it_makes() {
    let path = passing("made-original.csv");
    let steps = path.to_str().unwrap();
    let options = ["--faithful", "--baud", "9600", "--steps", steps];
    let Some(mut device) = device("drill-made-original", &options) else {
        return;
    };
    let file = program("made-original.nc", THREE);
    send(&device, &file, &["--baud", "9600"]).success();
    device.type_line("where", "spindle off");
    device.end();
    let text = std::fs::read_to_string(&path).unwrap();
    let rows: Vec<Vec<i64>> = (text.lines().skip(1))
        .map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    let (dx_dy, dz, spindle) = (3..5, 5, 9);
    let first = rows.iter().position(|row| row[spindle] == 1).unwrap();
    // The spindle is off during homing. After it Z moves with the spindle on, X and Y with it off.
    let mut switched = 0;
    for pair in rows[first - 1..].windows(2) {
        let row = &pair[1];
        switched += usize::from(pair[0][spindle] != row[spindle]);
        assert!(row[dz] == 0 || row[spindle] == 1, "{row:?}");
        assert!(row[dx_dy.clone()] == [0, 0] || row[spindle] == 0, "{row:?}");
    }
    assert_eq!(switched, 6, "on and off for each of three holes");
    std::fs::remove_file(path).unwrap();
    let _ = std::fs::remove_file(file);
}
