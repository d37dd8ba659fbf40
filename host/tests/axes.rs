//! Machines with rotary and further linear axes, and work offsets in machine files, as a user meets
//! them.

mod common;

use common::{husillo, scratch};
use serde_json::Value;
use std::process::Output;

fn run(args: &[&str]) -> Output {
    husillo().args(args).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A file in the scratch folder.
fn file(name: &str, content: &str) -> String {
    let path = scratch(name);
    std::fs::write(&path, content).unwrap();
    path.to_str().unwrap().to_owned()
}

fn commands(args: &[&str]) -> Vec<String> {
    let output = run(&[&["commands"], args].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let lines = text(&output.stdout);
    lines
        .lines()
        .map(|line| line.trim_start().split_once("  ").unwrap().1.to_owned())
        .collect()
}

/// The built-in router with further lines in its machine file.
fn machine(name: &str, base: &str, change: impl Fn(&str) -> String) -> String {
    let path = format!("{}/../machines/{base}.toml", env!("CARGO_MANIFEST_DIR"));
    file(name, &change(&std::fs::read_to_string(path).unwrap()))
}

#[test]
fn a_rotary_axis_turns_in_all_commands() {
    let part = file(
        "turn.nc",
        "G21 G90 G94\nG1 X10 A90 F600\nA450.5\nG93 G1 X0 A0 F2\nM2\n",
    );
    let lines = commands(&[&part, "-m", "router4"]);
    assert_eq!(lines[0], "linear X10 Y0 Z0 A90 F600");
    assert_eq!(lines[1], "linear X10 Y0 Z0 A450.5 F600");
    let output = run(&["run", &part, "-m", "router4", "--format", "json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let results: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        results["max_nm"],
        serde_json::json!([10_000_000, 0, 0, 450_500_000])
    );
    assert_eq!(results["reversals"].as_array().unwrap().len(), 4);
    // 1 s at 600 mm/min, 360.5 degrees at 600 degrees/min, half a minute; the ramps are short.
    let seconds = results["duration_s"].as_f64().unwrap();
    let ideal = 1.0 + 36.05 + 30.0;
    assert!(
        (seconds / ideal - 1.0).abs() < 0.01,
        "{seconds} s, not {ideal}"
    );
    let csv = scratch("turn.csv").to_str().unwrap().to_owned();
    assert!(
        run(&["steps", &part, "-m", "router4", "-o", &csv])
            .status
            .success()
    );
    let steps = std::fs::read_to_string(csv).unwrap();
    let mut rows = steps.lines();
    assert_eq!(rows.next(), Some("event,wait_ticks,dx,dy,dz,da"));
    let turned: i64 = rows
        .map(|row| {
            row.rsplit(',')
                .next()
                .unwrap()
                .parse::<i64>()
                .unwrap()
                .abs()
        })
        .sum();
    assert_eq!(turned, 2 * 450 * 80 + 80);
    let output = run(&["commands", &part, "-m", "router4", "--format", "json"]);
    let first = text(&output.stdout).lines().next().unwrap().to_owned();
    let first: Value = serde_json::from_str(&first).unwrap();
    assert_eq!(
        first["to_nm"],
        serde_json::json!([10_000_000, 0, 0, 90_000_000])
    );
}

#[test]
fn a_machine_without_the_axis_refuses_its_words() {
    let part = file("no-a.nc", "G21 G1 X10 A90 F600\n");
    let output = run(&["check", &part, "-m", "router", "--format", "short"]);
    assert!(
        text(&output.stdout).contains(":1:12: error[E0201]"),
        "{}",
        text(&output.stdout)
    );
    // A machine with the axis is found.
    let output = run(&["run", &part, "-o", scratch("no-a.html").to_str().unwrap()]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("router4 is the first machine"),
        "{}",
        text(&output.stderr)
    );
}

#[test]
fn six_axes_and_a_wrapped_one() {
    let more = |router: &str| {
        let linear = |letter: &str| {
            format!(
                "[axis.{letter}]\nstep = \"5 um\"\ntravel = [\"-10 mm\", \"10 mm\"]\n\
                 max_rate = \"600 mm/min\"\ndriver = \"step-direction\"\n"
            )
        };
        let rotary = "[axis.c]\nkind = \"rotary\"\nwrapped = true\nsteps_per_degree = 100\n\
                      travel = \"unlimited\"\nmax_rate = \"10 rpm\"\n\
                      driver = \"step-direction\"\n";
        format!("{router}\n{}{}{rotary}", linear("u"), linear("w"))
    };
    let machine = machine("six.toml", "router", more);
    let part = file(
        "six.nc",
        "G20 G0 U0.1 C270\nC-90\nC0\nG91 C725\nG90 G28 C0\nG1 W-0.2 F10\nU11\n",
    );
    let output = run(&[
        "check", &part, "-m", &machine, "--format", "short", "--zero", "X0",
    ]);
    let found = text(&output.stdout);
    assert!(found.contains("E0401") && found.contains("U"), "{found}");
    let lines = commands(&[&part, "-m", &machine, "--zero", "C30"]);
    assert_eq!(
        lines,
        [
            "rapid X0 Y0 Z0 C300 U2.54 W0",
            "rapid X0 Y0 Z0 C120 U2.54 W0",
            "rapid X0 Y0 Z0 C390 U2.54 W0",
            "rapid X0 Y0 Z0 C1115 U2.54 W0",
            "rapid X0 Y0 Z0 C1470 U2.54 W0",
            "rapid X0 Y0 Z0 C1440 U2.54 W0",
            "linear X0 Y0 Z0 C1440 U2.54 W-5.08 F254",
            "linear X0 Y0 Z0 C1440 U279.4 W-5.08 F254",
        ]
    );
    let shown = text(&run(&["machines", "show", &machine]).stdout);
    assert!(shown.contains("C  0.0100 degrees per step"), "{shown}");
    assert!(shown.contains("3600.00 degrees/min"), "{shown}");
}

#[test]
fn wrong_axes_are_named() {
    for (name, from, to, message) in [
        (
            "mm.toml",
            "\"0.0125 deg\"",
            "\"0.0125 mm\"",
            "a rotary axis has degrees",
        ),
        ("kind.toml", "kind = \"rotary\"\n", "", "axis A is rotary"),
        ("linear.toml", "[axis.a]", "[axis.u]", "axis U is linear"),
        (
            "wrap.toml",
            "kind = \"rotary\"",
            "kind = \"rotary\"\nwrapped = 1",
            "not true or false",
        ),
        (
            "work.toml",
            "[idle]",
            "[work.g54]\nb = \"1 deg\"\n[idle]",
            "unknown key `b`",
        ),
    ] {
        let machine = machine(name, "router4", |text| text.replacen(from, to, 1));
        let output = run(&["machines", "show", &machine]);
        let told = text(&output.stderr) + &text(&output.stdout);
        assert!(
            !output.status.success() && told.contains(message),
            "{name}: {told}"
        );
    }
}

const WORK: &str = "\n[work.g54]\nx = \"100 mm\"\ny = \"20 mm\"\nz = \"-5 mm\"\n\
                    [work.g59_3]\nx = \"1 in\"\na = \"45 deg\"\n";

#[test]
fn work_offsets_of_a_machine_file_hold() {
    let machine = machine("work-ok.toml", "router4", |text| text.to_owned() + WORK);
    let part = file("frames.nc", "G21 G0 X1 A1\nG59.3 X1 A1\nG55 X2 A0\n");
    assert_eq!(
        commands(&[&part, "-m", &machine]),
        [
            "rapid X101 Y0 Z0 A1",
            "rapid X26.4 Y0 Z0 A46",
            "rapid X2 Y0 Z0 A0",
        ]
    );
    // `--zero` is that of G54, and of the frames without an offset.
    assert_eq!(
        commands(&[&part, "-m", &machine, "--zero", "X3A-90"]),
        [
            "rapid X4 Y0 Z0 A-89",
            "rapid X26.4 Y0 Z0 A46",
            "rapid X5 Y0 Z0 A-90",
        ]
    );
    let output = run(&["run", &part, "-m", &machine, "--format", "json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let csv = scratch("frames.csv").to_str().unwrap().to_owned();
    assert!(
        run(&["steps", &part, "-m", &machine, "-o", &csv])
            .status
            .success()
    );
    let steps = std::fs::read_to_string(csv).unwrap();
    let x: i64 = steps
        .lines()
        .skip(1)
        .map(|row| row.split(',').nth(2).unwrap().parse::<i64>().unwrap())
        .sum();
    assert_eq!(x * 2_500, 2_000_000);
    let shown = text(&run(&["machines", "show", &machine]).stdout);
    assert!(shown.contains("G54    X100 Y20 Z-5 A0"), "{shown}");
    assert!(shown.contains("G59.3  X25.4 Y0 Z0 A45"), "{shown}");
    let output = run(&["check", &part, "-m", &machine, "--zero", "B3"]);
    assert!(
        text(&output.stderr).contains("router4 has no axis B"),
        "{}",
        text(&output.stderr)
    );
}

/// A machine file from figures: by options, or typed with a mistake in between.
#[test]
fn a_new_machine_is_made_and_checked() {
    let path = scratch("new-machine.toml");
    let _ = std::fs::remove_file(&path);
    let file = path.to_str().unwrap();
    let options = [
        "machines",
        "new",
        "mine",
        file,
        "--axes",
        "XYZA",
        "--steps",
        "X80Y80Z400A88.888889",
        "--max-rate",
        "X6000Y6000Z720A3600",
        "--acceleration",
        "X500Y500Z200A900",
        "--start-rate",
        "X60Y60",
        "--travel",
        "X0..300Y0..180Z-45..5",
        "--pull-out",
        "X9000",
    ];
    let output = husillo().args(options).output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let shown = text(&run(&["machines", "show", file]).stdout);
    assert!(
        shown.contains("X  12.5000 um per step, travel 0 to 300 mm"),
        "{shown}"
    );
    assert!(shown.contains("loses steps above 12000 Hz"), "{shown}");
    let again = husillo().args(options).output().unwrap();
    assert!(!again.status.success(), "it is not overwritten");
    let wrong = husillo()
        .args(options.map(|option| match option {
            "X9000" => "X5000",
            other => other,
        }))
        .output()
        .unwrap();
    assert!(!wrong.status.success());
    assert!(text(&wrong.stderr).contains("`max_rate` is above `pull_out_rate`"));
    let typed = "80\n6000\n\n7000\n\n0..300\n80\n6000\n500\n\n\n0..300\n\
                 80\n6000\n\n\n\n\n400\n720\n\n\n\n-45..5\n";
    let output = husillo()
        .args(["machines", "new", "typed", "-"])
        .write_stdin(typed)
        .output()
        .unwrap();
    let told = text(&output.stderr);
    assert!(output.status.success(), "{told}");
    assert!(
        told.contains("error: `start_rate` is above `max_rate`"),
        "{told}"
    );
    let made = text(&output.stdout);
    assert!(made.contains("acceleration = \"500 mm/s^2\""), "{made}");
}

/// A sliced file is checked, timed and drawn; its temperatures are commands.
#[test]
fn a_printer_prints() {
    let part = file(
        "print.gcode",
        "M140 S60\nM109 S205.5\nG28\nG92 E0\nG1 Z0.2 F600\nG1 X100 Y100 F6000\nM106 S255\n\
         G1 X150 E2.5 F1500\nM83\nG1 Y150 E2.5\nG10\nG0 X10 F6000\nG11\nM107\nM84\n",
    );
    let output = run(&["run", &part, "-m", "printer", "--format", "json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let results: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        results["end_nm"],
        serde_json::json!([10_000_000, 150_000_000, 200_000, 5_000_000])
    );
    let output = run(&["commands", &part, "-m", "printer", "--format", "json"]);
    let lines: Vec<Value> = text(&output.stdout)
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(lines[1]["kind"], "heat");
    assert_eq!(lines[1]["heater"], "extruder 0");
    assert_eq!(
        (&lines[1]["celsius"], &lines[1]["wait"]),
        (&205.5.into(), &"heated".into())
    );
    assert!(
        lines
            .iter()
            .any(|line| line["kind"] == "fan" && line["per_mille"] == 1000)
    );
    // Its own words make it the machine of such a program.
    let output = run(&["run", &part, "-o", scratch("print.html").to_str().unwrap()]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("printer is the first machine"),
        "{}",
        text(&output.stderr)
    );
    // A mill with the words of a printer has no heaters.
    let output = run(&["check", &part, "-m", "router", "--dialect", "printer"]);
    assert!(
        text(&output.stdout).contains("E0404"),
        "{}",
        text(&output.stdout)
    );
}
