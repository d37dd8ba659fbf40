//! `husillo measure run` and `record`, as a user calls them, on the simulated network, whose work
//! piece has three faces.

mod common;

use assert_cmd::Command;
use common::{husillo, number, scratch, written};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// `husillo measure -m cmm3` with faces at x 5 mm, y 3 mm and z -4 mm.
fn measure() -> Command {
    measure_on("cmm3")
}

fn measure_on(machine: &str) -> Command {
    let mut command = husillo();
    // Faces close by the place of the centre: no ball.
    command.args(["measure", "-m", machine, "--ball", "0"]);
    for face in ["1:2500", "2:1500", "3:..-2000"] {
        command.args(["--contact", face]);
    }
    command.args(HOME);
    command
}

/// `husillo measure -m cmm3` before a piece that a ball of 1 mm touches.
fn measure_piece(piece: impl AsRef<Path>, pre_travel: &str) -> Command {
    let mut command = husillo();
    command.args(["measure", "-m", "cmm3", "--ball", "1"]);
    command
        .args(["--pretravel", pre_travel, "--piece"])
        .arg(piece.as_ref());
    command.args(HOME);
    command
}

/// The index of each axis is where it stands at first.
const HOME: [&str; 6] = ["home", "x", "home", "y", "home", "z"];

const PIECE: &str = "../examples/piece.toml";

/// What a routine gave, all within tolerance.
fn result(mut command: Command, routine: impl AsRef<Path>) -> Value {
    command
        .args(["run", "--format", "json"])
        .arg(routine.as_ref());
    let run = command.assert().success();
    serde_json::from_slice(&run.get_output().stdout).unwrap()
}

/// A dimension of a feature, by their places in the routine.
fn actual(result: &Value, feature: usize, dimension: usize) -> f64 {
    number(&result["features"][feature]["dimensions"][dimension]["actual"])
}

/// A corner of three faces, and where its drawing has it.
const CORNER: &str = "\
safe z 2
plane top towards -z at x0 y0 z-4 at x2 y0 z-4 at x0 y2 z-4
line front towards +y at x0 y3 z-1 at x3 y3 z-1
point left at x5 y1 z-1 towards +x
frame plane top line front point left at x 100 y 50 z 0
point P at x 98 y 47 z 0 +-0.005 towards -z
edge E at x 100 +-0.005 y 48 z 2 towards +x points 2 over 2 angle 90 +-0.1
";

#[test]
fn a_routine_on_the_network() {
    let routine = written("corner.routine", CORNER);
    let page = scratch("corner.html");
    let run = measure()
        .env("SOURCE_DATE_EPOCH", "1700000000")
        .args(["--part", "No. 17 <left>", "--pretravel", "8 um"])
        .args(["run", "--format", "json"])
        .arg(&routine)
        .arg("-o")
        .arg(&page)
        .assert()
        .success();
    let result: Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
    assert_eq!(result["in_tolerance"], true);
    assert_eq!(result["part"], "No. 17 <left>");
    assert_eq!(result["measured"], "2023-11-14 22:13 UTC");
    let frames = [0, 4].map(|feature: usize| &result["features"][feature]["frame"]);
    assert_eq!(frames, ["machine", "top, front, left"]);
    let edge = &result["features"][4];
    assert_eq!(
        (&edge["feature"], &edge["kind"]),
        (&"E".into(), &"edge".into())
    );
    let x = &edge["dimensions"][0];
    assert_eq!((&x["figure"], &x["nominal"]), (&"x".into(), &100.0.into()));
    // Counts are 2 um.
    assert!((x["actual"].as_f64().unwrap() - 100.0).abs() < 0.005, "{x}");
    assert_eq!(edge["points"].as_array().unwrap().len(), 2);
    // One touch of each point shows no spread.
    assert_eq!(edge["spread"], Value::Null);
    let page = fs::read_to_string(page).unwrap();
    assert!(!page.contains("<script") && !page.contains("http"));
    assert_eq!(page.matches("<svg").count(), page.matches("</svg>").count());
    assert!(page.contains("XZ view") && page.contains("3 of 3 tolerances kept"));
    assert!(page.contains("part No. 17 &lt;left&gt;, ") && page.contains("2023-11-14 22:13 UTC"));
    for figure in [
        "<dt>largest spread of a point</dt><dd>one touch per point</dd>",
        "<dt>pre-travel</dt><dd>8 um</dd>",
        "<td>top, front, left</td>",
    ] {
        assert!(page.contains(figure), "{figure}");
    }
    // The result stands beside the name, where a phone shows it.
    assert!(page.contains("<td>E</td><td class=\"ok\">ok</td>"));
}

#[test]
fn out_of_tolerance_is_exit_status_1() {
    let text = CORNER.replace("x 100 +-0.005", "x 99.9 +0.05 -0.05");
    let routine = written("off.routine", &text);
    let table = scratch("off.csv");
    let run = measure()
        .arg("run")
        .arg(&routine)
        .arg("-o")
        .arg(&table)
        .assert();
    run.code(1)
        .stdout(contains("OUT OF TOLERANCE").and(contains("1 of 3 tolerances not kept")));
    let table = fs::read_to_string(table).unwrap();
    let head = "feature,kind,line,figure,unit,actual,nominal,least,most,deviation,result\n";
    assert!(table.starts_with(head), "{table}");
    let row = table
        .lines()
        .find(|row| row.starts_with("E,edge,7,x,mm,"))
        .unwrap();
    assert!(
        row.ends_with(",out") && row.contains(",99.9,-0.05,0.05,"),
        "{row}"
    );
    let run = measure()
        .args(["run", "--format", "csv"])
        .arg(&routine)
        .assert();
    run.code(1).stdout(predicate::str::starts_with(head));
}

/// The reader of the output goes at once, as with `| head -0`: the routine is finished, and its
/// report is written.
#[test]
fn a_routine_outlasts_the_reader_of_its_output() {
    let report = scratch("corner-unread.html");
    let _ = fs::remove_file(&report);
    let routine = written("corner-unread.routine", CORNER);
    let mut run = std::process::Command::new(env!("CARGO_BIN_EXE_husillo"));
    run.args(["measure", "-m", "cmm3", "--ball", "0"]);
    run.args([
        "--contact",
        "1:2500",
        "--contact",
        "2:1500",
        "--contact",
        "3:..-2000",
    ]);
    run.arg("-o").arg(&report).arg("run").arg(&routine);
    let mut child = run.stdout(std::process::Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert!(fs::read_to_string(&report).unwrap().contains("</html>"));
}

/// A routine that goes from one side of the block to the other.
const THROUGH: &str = "\
goto x 30 y 2 z -8
goto z -25
point P at x 30 y 10 z -25 +-0.05 towards +y
goto x 30 y 58 z -25
";

#[test]
fn a_collision_is_exit_status_4_and_nothing_is_good() {
    let routine = written("through.routine", THROUGH);
    let run = |format: &str, output: &Path| {
        let mut command = measure_piece(PIECE, "8 um");
        command.args(["--format", format, "-o"]).arg(output);
        command.arg("run").arg(&routine).assert().code(4)
    };
    let page = scratch("through.html");
    // The ball of 1 mm is before the face at y = 10 mm.
    let told = contains("through.routine:4:1")
        .and(contains("]: collision: a contact at X 30.0"))
        .and(contains(", Y 9.0"))
        .and(contains("Y moved at about 1.5").or(contains("YZ moved at about 1.5")))
        .and(contains("mm beyond it"));
    run("text", &page).stderr(told).stdout(
        contains("1 feature, spoiled by a collision: no tolerance counts as kept")
            .and(contains("tolerances kept").not()),
    );
    let page = fs::read_to_string(page).unwrap();
    assert!(page.contains("spoiled by a collision</td>"), "{page}");
    assert!(!page.contains(">ok<") && !page.contains("verdict ok"));

    let table = scratch("through.csv");
    let json = run("json", &table);
    let told: Value = serde_json::from_slice(&json.get_output().stdout).unwrap();
    let feature = &told["features"][0];
    assert_eq!(
        [
            &told["in_tolerance"],
            &told["collision"],
            &feature["in_tolerance"]
        ],
        [&Value::Bool(false), &Value::Bool(true), &Value::Bool(false)]
    );
    assert_eq!(feature["dimensions"][2]["in_tolerance"], Value::Null);
    let table = fs::read_to_string(table).unwrap();
    let rows = table.lines().filter(|row| row.ends_with(",spoiled"));
    assert!(rows.count() == 1 && !table.contains(",ok"), "{table}");

    // The same move over the block is no collision.
    let over = THROUGH.replace("goto x 30 y 58", "goto z -8\ngoto y 58\ngoto x 30 y 58");
    let over = result(measure_piece(PIECE, "8 um"), written("over.routine", &over));
    assert_eq!([&over["collision"], &over["in_tolerance"]], [false, true]);
}

/// Without a word the moves of a routine are guarded, so they are slower than rapid ones. 40 counts
/// of half an over-travel of 100: v^2 = a s is 775 of 1200 counts/s.
#[test]
fn moves_of_a_routine_are_guarded_unless_it_says_so() {
    let moved = |text: &str| {
        let routine = written("approach.routine", text);
        let run = measure_piece(PIECE, "8 um")
            .arg("run")
            .arg(&routine)
            .assert();
        let run = run.code(4).stdout(contains("spoiled by a collision"));
        let told = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
        let (_, speed) = told.split_once("moved at about ").expect("a speed");
        let speed: f64 = speed.split(' ').next().unwrap().parse().unwrap();
        let (_, rest) = told
            .split_once("all axes have been stopped, ")
            .expect("a distance");
        let beyond: f64 = rest.split(' ').next().unwrap().parse().unwrap();
        (speed, beyond)
    };
    let last = "goto x 30 y 58 z -25\n";
    let words = |word: &str| THROUGH.replace(last, &format!("goto x 30 y 58 z -25 {word}\n"));
    let all = |word: &str| format!("moves {word}\n{THROUGH}");
    for guarded in [THROUGH.into(), words("guarded"), all("guarded")] {
        let (speed, beyond) = moved(&guarded);
        assert!((1.45..1.6).contains(&speed), "{speed} mm/s: {guarded}");
        // The over-travel of the probe.
        assert!((0.08..0.2).contains(&beyond), "{beyond} mm: {guarded}");
    }
    for rapid in [words("rapid"), all("rapid")] {
        let (speed, beyond) = moved(&rapid);
        assert!((2.3..2.5).contains(&speed), "{speed} mm/s: {rapid}");
        assert!(beyond < 0.06, "{beyond} mm: {rapid}");
    }
}

#[test]
fn trouble_is_exit_status_3() {
    let routine = written("far.routine", "point P at x 0 y 0 z 10 towards +z\n");
    let run = measure().arg("run").arg(&routine).assert();
    run.code(3)
        .stderr(contains("far.routine:1:1").and(contains("no contact")));
    let routine = written("beyond.routine", "goto x 1000\n");
    measure()
        .arg("run")
        .arg(&routine)
        .assert()
        .code(3)
        .stderr(contains("outside the travel"));
}

#[test]
fn mistakes_are_reported_before_anything_moves() {
    let data = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let wanted = fs::read_to_string(data.join("wrong.routine.told")).unwrap();
    let run = measure()
        .current_dir(&data)
        .args(["run", "wrong.routine"])
        .assert()
        .code(2);
    let told = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
    if std::env::var_os("HUSILLO_BLESS").is_some() {
        fs::write(data.join("wrong.routine.told"), &told).unwrap();
        return;
    }
    assert_eq!(told, wanted);
    assert!(run.get_output().stdout.is_empty());
    // A machine whose counts are no lengths.
    let routine = written("counts.routine", "goto x 1\n");
    let mut command = Command::cargo_bin("husillo").unwrap();
    let run = command
        .args(["measure", "-m", "cmm", "run"])
        .arg(&routine)
        .assert();
    run.code(2).stderr(contains("has no `count`"));
    measure()
        .arg("run")
        .assert()
        .code(2)
        .stderr(contains("`run` is the last action and needs a file"));
}

#[test]
fn recorded_and_run_again() {
    let routine = scratch("recorded.routine");
    let typed = "jog z -1\ntouch -z within 10\njog z 1\njog z 0.5\ntouch corner +x within 10 x 5 \
         +-0.01\n\
                 jog x -2\nedge E at x 4 y 3 z -1 towards +y\n";
    let first = measure()
        .arg("record")
        .arg(&routine)
        .write_stdin(typed)
        .assert()
        .success();
    let shown = String::from_utf8(first.get_output().stdout.clone()).unwrap();
    assert!(
        shown.contains("Z home: at 0.0000 mm\ntouch P1\n"),
        "{shown}"
    );
    let text = fs::read_to_string(&routine).unwrap();
    assert!(
        text.contains("touch P1 -z within 10") && text.contains("touch corner +x"),
        "{text}"
    );
    let again = result(measure(), &routine);
    for (feature, dimension, wanted) in [(0, 2, -4.0), (1, 0, 5.0), (2, 1, 3.0)] {
        let found = actual(&again, feature, dimension);
        assert!((found - wanted).abs() < 0.005, "{found} for {wanted}");
    }
    // A line that fails is reported and not written.
    let run = measure()
        .arg("record")
        .arg(&routine)
        .write_stdin("jog z 500\njog z 1\n")
        .assert();
    run.code(3).stderr(contains("outside the travel"));
    assert!(
        fs::read_to_string(&routine)
            .unwrap()
            .starts_with("goto x 0")
    );
}

/// Scales that read 2 mm/m short: the same counts are 0.2 % more, in routines, recordings and
/// programs.
#[test]
fn what_is_known_of_the_axes_is_taken_off() {
    let machines = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../machines");
    let mut text = fs::read_to_string(machines.join("cmm3.toml")).unwrap();
    text += "\n[axis.x.calibration]\nscale = \"2000 um/m\"\n";
    let machine = written("short.toml", &text);
    let on_it = || measure_on(machine.to_str().unwrap());
    let x_of = |routine: &PathBuf| actual(&result(on_it(), routine), 0, 0);
    // The face is at 2500 counts of 2 um.
    let is_there = |x: f64| (x - 5.01).abs() < 0.0045;
    let x = x_of(&written(
        "short.routine",
        "point P at x 5.01 y 0 z 0 towards +x\n",
    ));
    assert!(is_there(x), "{x}");

    let routine = scratch("short-recorded.routine");
    let typed = "jog x 3\ntouch P +x within 5\n";
    let mut command = on_it();
    let record = command.arg("record").arg(&routine).write_stdin(typed);
    record.assert().success().stdout(contains("5.01"));
    let text = fs::read_to_string(&routine).unwrap();
    assert!(text.starts_with("goto x 3"), "{text}");
    let x = x_of(&routine);
    assert!(is_there(x), "{x}");

    let program = written(
        "short.nc",
        "G21 G90 F24\nG38.2 X6\no1 if [ABS[#5061 - 5.01] ge 0.0045]\nG0 X900\no1 endif\nM2\n",
    );
    on_it().arg("run").arg(&program).assert().success();
}

#[test]
fn a_program_on_the_network() {
    let program = written(
        "probe.nc",
        "G21 G90 F24\nG38.2 Z-10\n#<top> = #5063\nG0 Z[#<top> + 3]\no<edge> call [5] [1] [#<top> + \
         1] [1] [0]\n\
         o1 if [ABS[#<_edge_x> - 5] gt 0.005]\nG0 X900\no1 endif\nG38.3 Z[#<top> + 2]\no2 if \
         [#5070 ne 0]\nG0 X900\no2 endif\nM2\n",
    );
    let run = measure().arg("run").arg(&program).assert().success();
    run.stdout(contains("edge edge-1").and(contains("1 feature")));
    let program = written("arc.nc", "G0 X1\nG2 X2 Y2 R3 F9\n");
    measure()
        .arg("run")
        .arg(&program)
        .assert()
        .code(2)
        .stderr(contains("arc.nc:2:1"));
}

/// Until the contact is made, and until it is broken, as a file between two machines would have it.
#[test]
fn probing_there_and_away() {
    let probe = |lines: &str| {
        let program = written(
            &format!("away{}.nc", lines.len()),
            &format!("G21 G90 F24\nG0 Z-3\n{lines}\nM2\n"),
        );
        measure().arg("run").arg(&program).assert()
    };
    // Faces are sharp and counts 2 um; the head stands where it has braked, less than 20 um on.
    probe(
        "G38.2 Z-10\n\
         o1 if [[ABS[#5063 + 4] gt 0.003] or [#5070 ne 1] or [#5422 gt -4] or [#5422 lt \
         -4.02]]\nG0 X900\no1 endif\n\
         G38.4 Z-3 F6\n\
         o2 if [[ABS[#5063 + 4] gt 0.003] or [#5070 ne 1] or [#5422 lt -4.002]]\nG0 X900\no2 \
         endif\n\
         G20\nF1 G1 Z[-3.5/25.4]\nG38.3 Z[-5/25.4]\nG21\n\
         o3 if [ABS[#5063 + 4] gt 0.003]\nG0 X900\no3 endif\n\
         F24\nG38.5 X1\n\
         o4 if [[#5070 ne 0] or [ABS[#5061 - 1] gt 0.003]]\nG0 X900\no4 endif\n\
         G38.5 Z-3\nG0 Z-3\nG38.3 Z-3.5\n\
         o5 if [#5070 ne 0]\nG0 X900\no5 endif",
    )
    .success();
    probe("G38.2 Z-3.9")
        .code(3)
        .stderr(contains("no contact from X 0.0000 mm, Y 0.0000 mm, Z -3"));
    probe("G38.4 Z-1")
        .code(3)
        .stderr(contains("nothing to leave"));
    probe("G38.2 Z-9\nG38.4 X1")
        .code(3)
        .stderr(contains("the contact lasted from"));
    probe("G38.2 Z-9\nG38.2 Z-9")
        .code(3)
        .stderr(contains("contact at start"));
    probe("G95 M3 S100\nG1 X1 F1")
        .code(3)
        .stderr(contains("not on a measuring machine"));
}

/// The ball of the example on its piece: the face is where it is drawn, in whichever direction the
/// contact is crossed.
#[test]
fn both_ways_on_the_piece() {
    // Axially the stylus takes 1 um, 0.5 um of noise; counts of 2 um.
    let program = written(
        "both.nc",
        "G21 G90 F24\nG0 Z-10\nG0 X16 Y16\nG38.2 Z-24\n#<made> = #5063\nG38.4 Z-18 F4.8\n#<broken> \
         = #5063\n\
         o1 if [[ABS[#<made> + 19] gt 0.0045] or [ABS[#<broken> + 19] gt 0.0045]]\nG0 X900\no1 \
         endif\nM2\n",
    );
    let mut command = measure_piece(PIECE, "1 um");
    command.arg("run").arg(&program).assert().success();
}

/// Results in mm within tolerance, without those of the three features that find the part.
fn judged(result: &Value) -> Vec<f64> {
    let features = result["features"].as_array().unwrap()[3..].iter();
    let figures = features.flat_map(|feature| feature["dimensions"].as_array().unwrap());
    let judged = figures.filter(|figure| figure["in_tolerance"] == true && figure["unit"] == "mm");
    judged.map(|figure| number(&figure["actual"])).collect()
}

/// Shifted along all axes, turned by 2 degrees and tilted by half a degree: the frame of the
/// routine follows.
#[test]
fn the_example_and_the_same_part_elsewhere() {
    let place = "[place]\nat = [\"1.25 mm\", \"-2 mm\", \"-1.5 mm\"]\n";
    let turned = "turn = \"2 deg\"\ntilt = \"0.5 deg\"\n";
    let text = fs::read_to_string(PIECE).unwrap();
    let moved = written("moved.toml", &format!("{text}\n{place}"));
    let turned = written("turned.toml", &format!("{text}\n{place}{turned}"));
    let routine = "../examples/piece.routine";
    let measured = |piece: &Path| judged(&result(measure_piece(piece, "8 um"), routine));
    let here = measured(Path::new(PIECE));
    assert!(here.len() > 12);
    for elsewhere in [moved, turned] {
        let there = measured(&elsewhere);
        assert_eq!(here.len(), there.len());
        for (here, there) in here.iter().zip(&there) {
            // Three counts of 2 um: both were rounded to them, and the noise is another.
            assert!((here - there).abs() <= 0.006, "{here} {there}");
        }
    }
    let mut command = measure_piece(PIECE, "8 um");
    command
        .args(["run", "../examples/piece.nc"])
        .assert()
        .success()
        .stdout(contains("boss boss-2"))
        .stderr(contains("M0").not());
}
