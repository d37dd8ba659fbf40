//! Each machine as its owner uses it, over a pseudo-terminal: connect, home, jog, zero, run part of
//! a program, stop from another terminal, go on, lose the supply, connect again, go on.

#![cfg(unix)]

mod common;
mod emulated;

use common::{husillo, signal, state, written};
use emulated::Emulated;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// A machine and its owner.
struct Owner {
    device: Emulated,
    machine: &'static str,
}

impl Owner {
    /// `None` where there are no pseudo-terminals.
    fn of(machine: &'static str, args: &[&str]) -> Option<Self> {
        let name = format!("owner-{machine}");
        let device = Emulated::new(machine, &name, args)?;
        Some(Self { device, machine })
    }

    /// The arguments of a command for this machine.
    fn words<'a>(&'a self, command: &[&'a str]) -> Vec<&'a str> {
        let (name, rest) = command.split_first().unwrap();
        [
            &[*name, "-m", self.machine, "--port", self.device.port()],
            rest,
        ]
        .concat()
    }

    /// Runs a command to its end. Returns its exit status, and all that it prints.
    fn says(&self, command: &[&str]) -> (Option<i32>, String) {
        let output = husillo().args(self.words(command)).output().unwrap();
        let [out, errors] =
            [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        (output.status.code(), out + &errors)
    }

    /// Runs a command that must end with this status and print all of this.
    fn ends(&self, status: i32, command: &[&str], wanted: &[&str]) {
        let (code, text) = self.says(command);
        assert_eq!(code, Some(status), "{command:?}: {text}");
        for wanted in wanted {
            assert!(
                text.contains(wanted),
                "{command:?}: no {wanted:?} in {text}"
            );
        }
    }

    /// Starts a command that lasts.
    fn begins(&self, command: &[&str]) -> Child {
        Command::new(env!("CARGO_BIN_EXE_husillo"))
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .env("XDG_STATE_HOME", state())
            .args(self.words(command))
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    }

    /// Waits until the panel shows what is wanted of the machine.
    fn until(&mut self, wanted: impl Fn(&str) -> bool) {
        let end = Instant::now() + Duration::from_secs(60);
        loop {
            let place = self.device.type_line("where", "lost");
            if wanted(&place) {
                return;
            }
            assert!(Instant::now() < end, "{}: {place}", self.machine);
            sleep(Duration::from_millis(20));
        }
    }

    /// Begins a program, and stops it from another terminal. Returns what the program prints.
    fn is_stopped(&mut self, program: &[&str], part: impl Fn(&str) -> bool) -> String {
        let child = self.begins(program);
        self.until(part);
        self.ends(0, &["stop"], &["stop: "]);
        let output = child.wait_with_output().unwrap();
        assert!(!output.status.success(), "{}", self.machine);
        let [out, errors] =
            [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        out + &errors
    }

    /// The supply fails and comes back. In between nothing answers.
    fn loses_power(&mut self, ask: &[&str], silent: &str) {
        self.device.type_line("power off", "power is off");
        self.ends(1, ask, &[silent]);
        self.device.type_line("power on", "power is on");
    }
}

/// The number after a name on the panel.
fn number(place: &str, name: &str) -> i64 {
    let mut words = place.split([' ', ',', ';']);
    words.find(|word| *word == name);
    words.next().and_then(|word| word.parse().ok()).unwrap_or(0)
}

#[test]
fn the_micro_mill() {
    let Some(mut mill) = Owner::of("micromill", &["--speed", "20"]) else {
        return;
    };
    let part = written(
        "owner-mill.nc",
        "G21 G90\nG1 X0.7 F8\nG1 Y0.14\nG3 X0.56 Y0.28 I-0.14 J0\nM30\n",
    );
    let part = part.to_str().unwrap();
    let unknown = "  machine   unknown: not homed\n  work      unknown: not homed\n";
    mill.ends(0, &["jog", "where"], &["not homed", unknown]);
    mill.ends(
        0,
        &["jog", "--lease", "0", "home", "where"],
        &[" s, homed\n"],
    );
    let zero = [
        "jog", "--lease", "0", "x", "300", "y", "250", "zero", "where",
    ];
    let at_zero = [
        "  machine   X 0.042 Y 0.035 Z 0 mm\n",
        "  work      X 0 Y 0 Z 0 mm\n",
    ];
    mill.ends(0, &zero, &at_zero);

    // 5000 steps in X, 30 s of its time.
    let program = ["send", part, "--no-home", "--lease", "0"];
    let told = mill.is_stopped(&program, |place| number(place, "x") > 400);
    let advice = "line 2 is not completed; go on with --no-home --from 2\n";
    assert!(told.contains(advice), "{told}");
    assert!(
        told.contains("interrupted: the controller has stopped"),
        "{told}"
    );
    // The next line begins elsewhere, so nothing moves.
    let place = mill.device.type_line("where", "lost");
    let from = |line| [&program[..], &["--from", line]].concat();
    mill.ends(
        1,
        &from("3"),
        &["line 3 begins at X0.7 Y0 mm", "move it there"],
    );
    assert_eq!(mill.device.type_line("where", "lost"), place);
    mill.ends(2, &["send", part, "--from", "2"], &["add --no-home"]);
    let same = ["Lines      4 made\n", "each as in the simulator\n"];
    mill.ends(0, &from("2"), &same);

    mill.loses_power(&["jog", "where"], "no answer");
    mill.ends(0, &["jog", "where"], &["not homed", unknown]);
    mill.ends(
        1,
        &program,
        &["the mill is not homed, so its position is unknown"],
    );
    mill.ends(1, &from("2"), &["the mill is not homed"]);
    // Killed while homing: it is not homed.
    let mut homing = mill.begins(&["jog", "--lease", "1000", "home"]);
    mill.until(|place| number(place, "z") < -10);
    homing.kill().unwrap();
    homing.wait().unwrap();
    mill.ends(0, &["jog", "where"], &["not homed", unknown]);
    // A new home and the same zero.
    mill.ends(0, &["jog", "--lease", "0", "home"], &["homed"]);
    mill.ends(0, &zero, &at_zero);
    mill.ends(0, &program, &["each as in the simulator\n"]);
}

#[test]
fn the_drill() {
    let Some(mut drill) = Owner::of("drill", &["--speed", "20"]) else {
        return;
    };
    let holes: String = (1..=6).map(|x| format!("X{x} Y0.5\n")).collect();
    let board = written("owner-drill.nc", &format!("%\nG21\nG90\n{holes}%\n"));
    let board = board.to_str().unwrap();
    // It homes when it is switched on.
    let homed = "homed: positions count from the switches\nx        0 steps, 0.000 mm, 0.0000 in\n";
    drill.ends(
        0,
        &["jog", "--lease", "0", "home", "where"],
        &[homed, "program  none"],
    );
    let moved = [
        "x        107 steps, 1.000 mm",
        "y        54 steps, 0.505 mm",
    ];
    drill.ends(
        0,
        &["jog", "--lease", "0", "x", "1mm", "y", "54", "where"],
        &moved,
    );

    // Its zero is where its program is cleared. A program begins with homing, at the switches.
    let zero = "positions count from a zero at 107 and 54 steps from the switches";
    drill.ends(0, &["jog", "clear", "where"], &[zero]);

    let program = ["send", board, "--lease", "0"];
    let told = drill.is_stopped(&program, |place| drilled(place) > 1);
    let next = told.split("--from ").nth(1).and_then(|text| {
        text.trim_end()
            .split(|letter: char| !letter.is_ascii_digit())
            .next()?
            .parse::<i64>()
            .ok()
    });
    let next = next.unwrap_or_else(|| panic!("{told}"));
    assert!((3..=6).contains(&next), "{told}");
    let done = format!("{} of 6 holes drilled", next - 1);
    assert!(told.contains(&done), "{told}");
    // It knows its position and its holes.
    let counted = format!("{} drillings done", next - 1);
    drill.ends(0, &["jog", "where"], &["at rest, homed", &counted]);
    let from = next.to_string();
    let rest = [&program[..], &["--no-home", "--from", &from]].concat();
    drill.ends(0, &rest, &["6 holes drilled\n"]);
    assert_eq!(drilled(&drill.device.type_line("where", "lost")), 6);

    drill.loses_power(&["jog", "where"], "x        unknown\n");
    // It homes on its own.
    drill.until(|place| place.contains("from home"));
    drill.ends(
        0,
        &["jog", "where"],
        &[homed, "drillings done are unknown since the reset"],
    );
    drill.ends(
        0,
        &[&program[..], &["--no-home"]].concat(),
        &["6 holes drilled\n"],
    );
}

/// The holes that the panel of the drill counts.
fn drilled(place: &str) -> i64 {
    let (before, _) = place.split_once(" hole").unwrap_or_default();
    let last = before.rsplit(' ').next();
    last.and_then(|word| word.parse().ok()).unwrap_or(0)
}

#[test]
fn the_microfactory() {
    let Some(mut machine) = Owner::of("microfactory", &["--speed", "20"]) else {
        return;
    };
    let figure = written("owner.fig", "2000 1000\n0 -1000\n-2000 0\n");
    let figure = figure.to_str().unwrap();
    let unknown = "position unknown: not homed; its counters are at x 0 y 0 z 0 spindle 0 steps\n";
    machine.ends(0, &["jog", "where"], &[unknown]);
    let moved = "x 400 y 0 z 0 spindle 0 steps, from home; x 0.748 ";
    machine.ends(
        0,
        &["jog", "--lease", "0", "home", "x", "400", "where"],
        &[moved],
    );
    // A figure begins where the tool stands: that is its zero.
    let program = ["send", figure, "--no-home", "--lease", "0"];
    let told = machine.is_stopped(&program, |place| number(place, "z") > 100);
    assert!(told.contains("stopped; it stands at x "), "{told}");
    assert!(told.contains(" steps, from home"), "{told}");
    // Back to the start of the figure, by the reported position.
    let place = machine.device.type_line("where", "lost");
    let back = [400 - number(&place, "x"), -number(&place, "z")].map(|steps| steps.to_string());
    let [x, z] = &back;
    let start = "x 400 y ";
    machine.ends(
        0,
        &["jog", "--lease", "0", "x", x, "z", z, "where"],
        &[start],
    );
    machine.ends(0, &program, &["2 of 2 actions"]);
    machine.ends(
        2,
        &["send", figure, "--from", "2"],
        &["--from is for the drill"],
    );

    machine.loses_power(&["jog", "where"], "no answer");
    // Its counters begin at 0 where it stands.
    machine.ends(0, &["jog", "where"], &[unknown]);
    machine.ends(
        1,
        &program,
        &["not homed, so the side of its backlash is unknown"],
    );
    let again = ["send", figure, "--lease", "0"];
    machine.ends(0, &again, &["3 of 3 actions"]);
    machine.ends(
        0,
        &["jog", "where"],
        &["x 0 y ", " steps, from home; x 0.000 "],
    );
}

#[test]
fn the_measuring_machine() {
    let Some(mut cmm) = Owner::of("cmm", &["--speed", "20", "--contact", "1:6018"]) else {
        return;
    };
    let kept = "note: the servos stay on and hold; zero and home are kept\n";
    let unknown = "X where: work 0 counts\n    machine    unknown, as X is not homed\n";
    cmm.ends(0, &["measure", "where"], &[unknown, kept]);
    let moved = "counts from home\n";
    cmm.ends(
        0,
        &["measure", "home", "jog", "+x", "1s", "zero", "where"],
        &[moved, "work 0 "],
    );
    cmm.ends(
        0,
        &["measure", "goto", "300", "where"],
        &[moved, "work 30", kept],
    );
    let before = from_home(&cmm);

    // A program moves to and fro.
    let words = ["goto", "2000", "goto", "0"].repeat(20);
    let program = [&["measure", "--raw"], &words[..]].concat();
    let mut child = cmm.begins(&program);
    // Two moves, and some readings after them. What it prints is read to its end, so that it is
    // never blocked.
    let lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let (tell, told) = std::sync::mpsc::channel();
    let reader = std::thread::spawn(move || {
        let mut moves = 0;
        for line in lines.map_while(Result::ok) {
            moves += usize::from(line.starts_with("> aa 01 d4 "));
            if moves == 2 {
                let _ = tell.send(());
            }
        }
    });
    told.recv().unwrap();
    cmm.ends(0, &["stop"], &["stop: X at "]);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    reader.join().unwrap();
    assert_eq!(from_home(&cmm), before);
    let touch = ["measure", "goto", "300", "touch", "+"];
    cmm.ends(0, &touch, &["    trigger    ", "1 touch, over-travel "]);

    let silent = "no answer: no module on the line";
    cmm.loses_power(&["measure", "where"], silent);
    let lost = "note: the modules were reset or moved, so zero and home are lost\n";
    cmm.ends(0, &["measure", "where"], &[lost, unknown]);
    cmm.ends(0, &["measure", "where"], &[unknown, kept]);
    // The probe stands near the face: back, home, and on.
    cmm.ends(
        0,
        &["measure", "goto", "-2000", "home", "touch", "+"],
        &["    trigger    ", kept],
    );
    // Killed, it keeps zero and home.
    cmm.ends(0, &["measure", "goto", "0", "zero"], &[kept]);
    let before = from_home(&cmm);
    let jog = cmm.begins(&["measure", "jog", "+x", "60s"]);
    sleep(Duration::from_millis(300));
    signal(&jog, "KILL");
    jog.wait_with_output().unwrap();
    assert_eq!(from_home(&cmm), before);
}

/// The zero, from home.
fn from_home(cmm: &Owner) -> i64 {
    let (_, text) = cmm.says(&["measure", "where"]);
    let of = |name: &str| -> i64 {
        let after = text.split(name).nth(1).unwrap_or_else(|| panic!("{text}"));
        after.split_whitespace().next().unwrap().parse().unwrap()
    };
    of("    machine ") - of("X where: work ")
}
