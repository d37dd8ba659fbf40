//! Backlash by place as a user meets it: measured, in the machine file, on the work.

use assert_cmd::Command;
use predicates::str::contains;
use serde_json::Value;
use std::path::PathBuf;

fn husillo() -> Command {
    let mut command = Command::cargo_bin("husillo").unwrap();
    command.current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    command
}

fn scratch(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    std::fs::create_dir_all(&folder).unwrap();
    folder.join(name)
}

fn printed(args: &[&str]) -> String {
    let output = husillo().args(args).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    String::from_utf8(output.stdout).unwrap()
}

/// The remaining span in a line of `calibrate backlash`, after these words, um.
fn span(line: &str, behind: &str) -> [f64; 2] {
    let (_, rest) = line.split_once(behind).unwrap();
    let mut numbers = rest.split([' ', ',']).filter_map(|word| word.parse().ok());
    [numbers.next().unwrap(), numbers.next().unwrap()]
}

/// Two-line tests on the simulated machine make a map that leaves less than 2 um, where one value
/// leaves 33 and 27 um. The program is then in its correct position.
#[test]
fn a_map_leaves_less_than_two_micrometres() {
    let (machine, report) = (scratch("mapped.toml"), scratch("backlash.html"));
    let (machine, report) = (machine.to_str().unwrap(), report.to_str().unwrap());
    let text = printed(&[
        "calibrate",
        "backlash",
        "--simulate",
        "-o",
        machine,
        "--report",
        report,
    ]);
    let mut lines = text.lines();
    for (letter, largest) in [("X", 33.0), ("Y", 27.0)] {
        let line = lines.next().unwrap();
        assert!(
            line.starts_with(&format!("# {letter}: 315 positions")),
            "{line}"
        );
        for (before, after) in span(line, "one value")
            .into_iter()
            .zip(span(line, "this map"))
        {
            assert!((largest - before.abs()).abs() < 1.0, "{line}");
            assert!(after.abs() < 2.0, "{line}");
        }
    }
    let page = std::fs::read_to_string(report).unwrap();
    assert_eq!(page.matches("<svg").count(), 4);
    // The same machine file, with what was printed.
    let written = std::fs::read_to_string(machine).unwrap();
    let sections = text.find("[backlash_map.x]").unwrap();
    assert!(written.ends_with(&text[sections..]));

    let deviation = |machine: &str| -> f64 {
        let args = ["run", "examples/head.nc", "--worn", "--format", "json"];
        let json = printed(&[&args[..], &["-m", machine]].concat());
        let results: Value = serde_json::from_str(&json).unwrap();
        assert_eq!(results["lost_steps"], 0);
        results["max_deviation_nm"].as_f64().unwrap()
    };
    assert!(deviation("micromill") > 15_000.0);
    let mapped = deviation(machine);
    assert!(mapped < 2_000.0, "{mapped}");

    let circles = printed(&["calibrate", "circles", "-m", machine]);
    for line in circles
        .lines()
        .filter(|line| line.contains("the file's map"))
    {
        let left: Vec<f64> = line
            .split("map")
            .nth(1)
            .unwrap()
            .split_whitespace()
            .take(4)
            .map(|word| word.parse().unwrap())
            .collect();
        assert!(left.iter().all(|um| *um < 2.0), "{line}");
    }
    let rows = circles.lines().filter(|line| line.contains(" mm  "));
    assert_eq!(rows.count(), 9);
    // Table 15 of the original: top, left, bottom, right.
    let originals: Vec<Vec<&str>> = circles
        .lines()
        .filter_map(|line| {
            Some(
                line.split_once("the original's")?
                    .1
                    .split_whitespace()
                    .collect(),
            )
        })
        .collect();
    let measured = [
        ["8.0", "21.0", "30.0", "51.0"],
        ["9.0", "21.0", "13.0", "25.0"],
        ["9.0", "18.0", "3.0", "12.0"],
    ];
    assert_eq!(originals, measured);
}

/// Both halves from the same start: left and right of a symmetric head differ ten times less.
#[test]
fn mirrored_order_makes_the_sides_alike() {
    let run = |order: &str| -> Value {
        let args = [
            "run",
            "examples/head.nc",
            "--worn",
            "--symmetry",
            "5",
            "--format",
            "json",
            "--order",
            order,
        ];
        serde_json::from_str(&printed(&args)).unwrap()
    };
    let (file, mirrored) = (run("file"), run("mirrored"));
    let left_right = |results: &Value, what: &str| results["left_right"][what].as_f64().unwrap();
    for what in ["rms_nm", "max_nm"] {
        let (before, after) = (left_right(&file, what), left_right(&mirrored, what));
        assert!(before > 10_000.0, "{what}: {before}");
        assert!(after * 10.0 <= before, "{what}: {before} and {after}");
    }
    assert!(left_right(&mirrored, "pairs") > 5_000.0);
    assert_eq!(mirrored["order"]["mirrored"], 1);
    assert!(file["order"].is_null());
    // The same contour, cut once.
    for what in ["min_nm", "max_nm"] {
        for axis in 0..2 {
            let [a, b] = [&file, &mirrored].map(|results| results[what][axis].as_i64().unwrap());
            assert!((a - b).abs() < 40_000, "{what} {axis}: {a} and {b}");
        }
    }
}

/// Contours of lines, arcs and whole circles are divided. A contour without a second crossing, or
/// without a height, is cut unchanged.
#[test]
fn contours_are_divided_where_they_can_be() {
    let cut = |name: &str, program: &str| -> Value {
        let path = scratch(name);
        std::fs::write(&path, program).unwrap();
        let args = ["run", path.to_str().unwrap(), "--order", "mirrored"];
        let json = printed(&[&args[..], &["-m", "free", "--format", "json"]].concat());
        serde_json::from_str(&json).unwrap()
    };
    let square = "G0 Z1\nG0 X5 Y5\nG1 Z-1 F100\nG1 X6 F100\nY3\nX4\nY5\nX5\nG0 Z1\nM30\n";
    let results = cut("square.nc", square);
    assert_eq!(
        (&results["order"]["mirrored"], &results["order"]["whole"]),
        (&1.into(), &0.into())
    );
    assert_eq!(results["max_deviation_nm"].as_f64().unwrap().round(), 0.0);
    assert_eq!(
        [&results["min_nm"][2], &results["max_nm"][2]],
        [-1_000_000, 1_000_000]
    );
    let circle =
        "G0 Z1\nG0 X5 Y5\nG1 Z0 F100\nG3 I0 J-1 F100\nG0 Z1\nG0 X5 Y9\nG1 Z0\nG2 I0 J-1\nM30\n";
    let results = cut("circle.nc", circle);
    assert_eq!(results["order"]["mirrored"], 2);
    let [x, y] = [0, 1].map(|axis| &results["max_nm"][axis]);
    assert_eq!([x, y], [6_000_000, 9_000_000]);
    // It touches the vertical through its start nowhere else; and a contour that is approached
    // along the surface.
    let results = cut(
        "side.nc",
        "G0 Z1\nG0 X6 Y5\nG1 Z0 F100\nG3 I-1 J0 F100\nM30\n",
    );
    assert_eq!(
        (&results["order"]["mirrored"], &results["order"]["whole"]),
        (&0.into(), &1.into())
    );
    // Two passes without a lift: between the halves of the second pass the tool moves above the
    // work.
    let passes = "G0 Z1\nG0 X5 Y6\nG1 Z-0.5 F100\nG3 I0 J-1 F100\nG1 Z-1\nG3 I0 J-1\nG0 Z1\nM30\n";
    let path = scratch("passes.nc");
    let trace = scratch("passes.csv");
    std::fs::write(&path, passes).unwrap();
    let [path, trace] = [&path, &trace].map(|path| path.to_str().unwrap());
    printed(&[
        "run", path, "--order", "mirrored", "-m", "free", "--format", "json", "--trace", trace,
    ]);
    let trace = std::fs::read_to_string(trace).unwrap();
    let mut rows = trace.lines();
    let names: Vec<&str> = rows.next().unwrap().split(',').collect();
    let column = |name: &str| {
        names
            .iter()
            .position(|own| own.contains(name))
            .unwrap_or_else(|| panic!("{names:?}"))
    };
    let (z, kind) = (column("z"), column("kind"));
    let low = rows.filter(|row| {
        let fields: Vec<&str> = row.split(',').collect();
        fields[kind] == "rapid" && fields[z].parse::<f64>().unwrap() < -1e-9
    });
    // Only straight up from the bottom.
    let mut places: Vec<[&str; 2]> = low
        .map(|row| {
            let fields: Vec<&str> = row.split(',').collect();
            [fields[column("x")], fields[column("y")]]
        })
        .collect();
    places.dedup();
    assert!(places.len() <= 4, "{places:?}");
    let results = cut("flat.nc", "G1 X5 Y5 F100\nG3 I0 J-1 F100\nM30\n");
    assert_eq!(results["order"]["whole"], 1);
}

/// Bands as they were measured on the original, cut with 204 and 178 um taken up.
#[test]
fn bands_are_read_from_a_table() {
    let path = scratch("bands.csv");
    let readings = "axis;y;programmed;measured\nX;1.2;0.3;0.286\nX;3.5;0.3;0.297\nX;5.8;300 um;283 \
         um\nX;5.8;-0.3;-0.317\n";
    std::fs::write(&path, readings).unwrap();
    let text = printed(&["calibrate", "backlash", path.to_str().unwrap()]);
    // 204 um in whole steps are 203.98 um.
    assert!(
        text.ends_with("[backlash_map.x]\ny_mm = [1.2, 3.5, 5.8]\num = [189.98, 200.98, 186.98]\n"),
        "{text}"
    );
    assert!(
        text.starts_with("# X: 3 positions, backlash 187.0 to 201.0 um; left with one value -17.0"),
        "{text}"
    );

    let fails = |readings: &str, why: &str| {
        std::fs::write(&path, readings).unwrap();
        let mut command = husillo();
        let assert = command
            .args(["calibrate", "backlash", path.to_str().unwrap()])
            .assert();
        assert.failure().stderr(contains(why.to_owned()));
    };
    fails(
        "axis,x,y,programmed,measured\nX,1,1,0.3,0.3\nX,2,1,0.3,0.3\nX,2,2,0.3,0.3\n",
        "no reading at X1.000 Y2.000",
    );
    fails(
        "axis,x,programmed,measured\nX,1,0.3,0.3\nX,1.1,0.3,0.2\n",
        "too steep",
    );
    fails("axis,programmed,measured\nX,0.3,0.3\n", "where it was made");
    fails(
        "axis,x,programmed,measured\nX,1,0.3,-0.4\nX,3,0.3,0.3\n",
        "a backlash of -496 um",
    );
    fails(
        "axis,x,programmed,measured\nX,100,0.3,0.3\n",
        "a reading at X100, and the travel is 0 to 10 mm",
    );
    fails(
        "axis,x,programmed,measured\nA,1,0.3,0.3\n",
        "expected X or Y",
    );
}

/// The listing of a machine, and the cost of reversals on it, are by position if its file has a
/// map.
#[test]
fn maps_are_shown_and_counted() {
    let text = std::fs::read_to_string("../machines/micromill.toml").unwrap();
    let map = "\n[backlash_map.x]\nx_mm = [0, 10]\num = [140, 280]\n";
    let machine = scratch("by-place.toml");
    std::fs::write(&machine, text + map).unwrap();
    let machine = machine.to_str().unwrap();
    let shown = printed(&["machines", "show", machine]);
    assert!(
        shown.contains("backlash by position: 140.0 to 280.0 um, 2 positions along X"),
        "{shown}"
    );
    assert!(shown.contains("backlash 1,271 steps (177.9 um)"), "{shown}");
    let shown = printed(&["machines", "show", machine, "--format", "json"]);
    let shown: Value = serde_json::from_str(&shown).unwrap();
    assert_eq!(shown["axes"][0]["backlash_map"]["most_um"], 280.0);
    // X reverses at 5 mm, where its backlash is 210 um or 1500 steps, and at 0, with 140 um or 1000
    // steps: 7.4 s each time at 170 per second.
    let program = scratch("to-and-fro.nc");
    std::fs::write(&program, "G21 G90 G1 F8\nX5\nX0\nX5\nM2\n").unwrap();
    let said = printed(&["check", program.to_str().unwrap(), "-m", machine]);
    assert!(
        said.contains("2 on X at 7.35 s (140 um to 210 um by position)"),
        "{said}"
    );
}

/// The reader of the output goes at once: the report and the machine file are written.
#[test]
fn a_calibration_outlasts_the_reader_of_its_output() {
    let [report, machine] = ["backlash-unread.html", "backlash-unread.toml"].map(scratch);
    for file in [&report, &machine] {
        let _ = std::fs::remove_file(file);
    }
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_husillo"))
        .args(["calibrate", "backlash", "--simulate", "--report"])
        .arg(&report)
        .arg("-o")
        .arg(&machine)
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert!(report.exists() && machine.exists());
}
