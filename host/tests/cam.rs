//! Programs in the style of well-known CAM systems run with no option but the machine.

mod common;

use common::{husillo, scratch};
use std::path::Path;

#[test]
fn programs_of_cam_systems_run_on_the_router() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/cam");
    let readme = std::fs::read_to_string(folder.join("README.md")).unwrap();
    let mut programs = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if name == "README.md" {
            continue;
        }
        assert!(readme.contains(&format!("`{name}`")), "{name}");
        let page = scratch(&format!("cam-{name}.html"));
        // One that names its machine needs no option at all.
        let text = std::fs::read_to_string(&path).unwrap();
        let machine = match text.contains("; -m ") {
            true => vec![],
            false => vec!["-m", "router"],
        };
        let output = husillo()
            .args(["run", "--format", "json"])
            .args(machine)
            .arg(&path)
            .arg("-o")
            .arg(&page)
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{name}: {told}");
        let results: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(results["events"].as_u64().unwrap() > 1000, "{name}");
        // Half of the longer step, its rounding at both ends of an arc, and G64 where a program
        // permits it. A printer has steps of 12.5 um.
        let most = if name.ends_with(".gcode") {
            12_500.0
        } else {
            3000.0
        };
        assert!(
            results["max_deviation_nm"].as_f64().unwrap() < most,
            "{name}: {results}"
        );
        assert!(
            std::fs::read_to_string(&page).unwrap().contains("<svg"),
            "{name}"
        );
        programs += 1;
    }
    assert_eq!(programs, 17);
}

#[test]
fn a_program_for_another_kind_of_machine_is_refused_with_its_name() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/cam");
    for (name, machine) in [
        ("cura.gcode", "printer"),
        ("prusaslicer.gcode", "printer"),
        ("wrapped.tap", "router4"),
    ] {
        for command in ["run", "steps"] {
            let output = husillo()
                .args([command, "-m", "router", "-o", "-"])
                .arg(folder.join(name))
                .output()
                .unwrap();
            let printed = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(1), "{printed}");
            let sentence = format!("{machine} accepts this program: -m {machine}");
            assert!(printed.contains(&sentence), "{printed}");
            // Findings that are alike are drawn three times.
            assert!(
                printed.matches("unknown word `A`").count() <= 3,
                "{printed}"
            );
        }
    }
    let output = husillo()
        .args(["run", "-m", "router", "-"])
        .write_stdin("G1 X10 F100\nG77\n")
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        printed.contains("1 error") && !printed.contains("accepts"),
        "{printed}"
    );
}
