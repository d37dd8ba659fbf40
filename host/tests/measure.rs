//! `husillo measure`: moves, zeros and sessions, as a user calls them.

mod common;

use common::{husillo, measured, near, number, printed};
use predicates::str::contains;
use serde_json::Value;

#[test]
fn moves_end_within_a_count() {
    let goals = ["1200", "-777", "3", "7999", "-8000", "-7999", "0", "1"];
    let args: Vec<&str> = goals.iter().flat_map(|goal| ["goto", goal]).collect();
    for (row, goal) in measured(&args).iter().zip(goals) {
        near(&row["position"], goal.parse().unwrap(), 1.0);
    }
    // In millimetres, on any axis.
    let rows = measured(&["-m", "cmm3", "--axis", "z", "goto", "1.5", "goto", "-0.1"]);
    near(&rows[0]["position"], 1.5, 0.002);
    near(&rows[1]["position"], -0.1, 0.002);
    assert_eq!(
        (&rows[0]["unit"], &rows[0]["axis"]),
        (&"mm".into(), &"Z".into())
    );
}

#[test]
fn all_axes_go_in_straight_lines() {
    let rows = measured(&[
        "-m", "cmm3", "goto", "X1.5", "y-2", "Z0.25", "goto", "z-1", "X0", "goto", "Y-2", "status",
    ]);
    let at = |row: &Value, wanted: &[f64]| {
        let position = row["position"].as_array().unwrap();
        assert_eq!(position.len(), wanted.len());
        for (value, wanted) in position.iter().zip(wanted) {
            near(value, *wanted, 0.002);
        }
    };
    at(&rows[0], &[1.5, -2.0, 0.25]);
    at(&rows[1], &[0.0, -1.0]);
    near(&rows[2]["position"], -2.0, 0.002);
    assert_eq!([&rows[0]["axis"], &rows[1]["axis"]], ["XYZ", "XZ"]);
    husillo()
        .args(["measure", "-m", "cmm3", "goto", "X1", "Y250"])
        .assert()
        .code(1)
        .stderr(contains(
            "error: Y 250.0000 mm is outside the travel, -200.0000 mm to 200.0000 mm",
        ));
    husillo()
        .args(["measure", "goto", "X1", "Y2"])
        .assert()
        .code(2)
        .stderr(contains("has no axis Y: there is X"));
}

/// `goto` is rapid on the command line, unless it is to be guarded.
#[test]
fn a_goto_may_be_guarded() {
    for (words, speeds) in [
        (&["goto", "4000"][..], 1150.0..1250.0),
        (&["goto", "4000", "guarded"][..], 740.0..800.0),
    ] {
        let mut command = husillo();
        command.args(["measure", "-m", "cmm", "home", "x", "--contact", "1:3018"]);
        let run = command.args(words).assert().code(4);
        let told = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
        let (_, speed) = told.split_once("moved at about ").expect("a speed");
        let speed: f64 = speed.split(' ').next().unwrap().parse().unwrap();
        assert!(speeds.contains(&speed), "{told}");
    }
}

#[test]
fn zero_moves_what_is_counted_and_not_the_travel() {
    let rows = measured(&["goto", "1000", "zero", "status", "goto", "-1000"]);
    near(&rows[1]["position"], 0.0, 1.0);
    near(&rows[3]["position"], -1000.0, 1.0);
    assert!(rows[2]["bits"].to_string().contains("power on"));
    husillo()
        .args(["measure", "goto", "1000", "zero", "goto", "7100"])
        .assert()
        .code(1)
        .stderr(contains("error: X 7100 counts is outside the travel, -9"));
}

/// The axis is to stand at 1200 and stands a count beside: 0 is where it stands.
#[test]
fn zero_is_where_the_axis_stands() {
    let places = [1200, 300, -777, 2500];
    let mut beside = 0;
    for place in places {
        let goal = place.to_string();
        let rows = measured(&["goto", &goal, "zero", "status"]);
        near(&rows[1]["position"], 0.0, 0.0);
        near(&rows[2]["position"], 0.0, 0.0);
        let [stood, held] = [&rows[0]["position"], &rows[2]["held"]].map(number);
        assert_eq!(held, f64::from(place) - stood);
        beside += i32::from(held != 0.0);
    }
    assert!(
        beside > 0,
        "no axis stands beside its goal: nothing was tried"
    );
}

#[test]
fn several_axes_are_called_0_and_asked() {
    let rows = measured(&[
        "-m", "cmm3", "goto", "X3", "Y2", "Z-1", "zero", "x", "Z", "status",
    ]);
    let axes: Vec<_> = rows.iter().map(|row| row["axis"].as_str()).collect();
    assert_eq!(
        axes,
        ["XYZ", "XZ", "X", "Y", "Z"].map(Some),
        "all axes, one after another"
    );
    for (row, wanted) in rows[2..].iter().zip([0.0, 2.0, 0.0]) {
        near(&row["position"], wanted, 0.002);
        let (held, error) = (number(&row["held"]), number(&row["position_error"]));
        near(&row["position"], held - error, 1e-9);
        assert!(row["current"].is_u64() && row["version"] == 4, "{row}");
        assert_eq!(row["bits"], serde_json::json!(["move done", "power on"]));
        let auxiliary = row["auxiliary"].to_string();
        assert!(auxiliary.contains("servo on"), "{auxiliary}");
    }
    let text = common::printed(&["measure", "-m", "cmm3", "status", "y"]);
    for line in [
        "Y status: at ",
        "    held at    0.0000 mm, position error ",
        "    current    0 % of full scale",
        "    status     move done, power on",
        "servo on",
        "    version    4",
    ] {
        assert!(text.contains(line), "{line}: {text}");
    }
    assert!(!text.contains("X status"), "{text}");
}

#[test]
fn a_session_goes_on_after_a_line_that_fails() {
    let typed = "goto X5\nzero x\ngoto X900\nspin\n\ngoto X1\nstatus x\nend\ngoto X7\n";
    let run = husillo()
        .args(["measure", "-m", "cmm3", "goto", "Y1", "session"])
        .write_stdin(typed)
        .assert()
        .code(3)
        .stderr(contains(
            "error: X 900.0000 mm is outside the travel, -205.0",
        ))
        .stderr(contains("error: unknown action `spin`"));
    let text = String::from_utf8_lossy(&run.get_output().stdout).into_owned();
    let heads: Vec<_> = text.lines().filter(|line| !line.starts_with(' ')).collect();
    assert_eq!(heads.len(), 5, "{text}");
    assert!(heads[0].starts_with("Y goto: at 1.00"), "{text}");
    assert!(heads[2].starts_with("X zero: at "), "{text}");
    assert!(
        heads[4].starts_with("X status: at 1.00") || heads[4].starts_with("X status: at 0.99"),
        "{text}"
    );
    husillo()
        .args(["measure", "session", "goto", "5"])
        .assert()
        .code(2)
        .stderr(contains("`session` is the last action"));
}

/// What is not known is said to be unknown.
#[test]
fn where_tells_all_coordinates() {
    let actions = "-m cmm3 goto X0.2 home x goto X5 Z1 zero x z goto X2.62 Z3 where";
    let args: Vec<&str> = ["measure"].into_iter().chain(actions.split(' ')).collect();
    let text = printed(&args);
    // The second index of X is 0.8 mm from where it stood.
    for wanted in [
        "X where: work 2.62",
        "    machine    7.62",
        " mm from home\n    steps      42",
        "Y where: work 0.0000 mm\n    machine    unknown, as Y is not homed\n    steps      0 ",
        "Z where: work 3.00",
    ] {
        assert!(text.contains(wanted), "{wanted} in {text}");
    }
    let rows = measured(&[&args[1..], &["x", "--inch"]].concat());
    let row = rows.last().unwrap();
    near(&row["machine"], 0.3, 0.000_1);
    near(&row["work"], 2.62 / 25.4, 0.000_1);
    assert_eq!((&row["unit"], &row["homed"]), (&"in".into(), &true.into()));
    let text = printed(&["measure", "goto", "30", "where"]);
    assert!(text.contains("X where: work 30 counts\n    machine    unknown, as X is not homed\n"));
    assert!(text.contains("    length     unknown, as the machine file has no `count`\n"));
}
