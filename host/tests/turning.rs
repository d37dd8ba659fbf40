//! A shaft roughed and finished along a contour.

mod common;

use common::husillo;
use predicates::str::contains;
use std::path::PathBuf;

/// The radius of the shaft of `examples/turning.nc` at a Z, mm.
fn radius(z: f64) -> f64 {
    match -z {
        ..0.0 => 0.0,
        z @ ..1.0 => 5.0 + z,
        ..12.0 => 6.0,
        z @ ..15.0 => 9.0 - (9.0 - (z - 12.0).powi(2)).max(0.0).sqrt(),
        z @ ..18.0 => 12.0 + (9.0 - (18.0 - z).powi(2)).max(0.0).sqrt(),
        ..28.0 => 15.0,
        z @ ..33.0 => 15.0 + (z - 28.0) * 0.6,
        _ => 21.0,
    }
}

#[test]
fn the_tool_leaves_the_shaft() {
    let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("turning.csv");
    std::fs::create_dir_all(env!("CARGO_TARGET_TMPDIR")).unwrap();
    husillo()
        .args([
            "run",
            "../examples/turning.nc",
            "-m",
            "../machines/lathe.toml",
        ])
        .args(["--format", "json", "--trace"])
        .arg(&file)
        .assert()
        .success();
    let text = std::fs::read_to_string(file).unwrap();
    // Least radius the tool has come to at each tenth of a millimetre.
    let mut least = vec![f64::MAX; 330];
    for row in text.lines().skip(1) {
        let fields: Vec<&str> = row.split(',').collect();
        let [x, z] = [2, 4].map(|index: usize| fields[index].parse::<f64>().unwrap() / 1e6);
        // Within two steps of the contour, never below.
        assert!(x >= radius(z + 0.002) - 0.002, "X{x} Z{z}");
        let place = (-z * 10.0).round();
        if place >= 0.0 && (-z * 10.0 - place).abs() < 0.02 {
            if let Some(entry) = least.get_mut(place as usize) {
                *entry = entry.min(x);
            }
        }
    }
    for (place, least) in least.iter().enumerate().skip(1) {
        let z = -(place as f64) / 10.0;
        let most = radius(z - 0.004) + 0.004;
        assert!(*least <= most, "X{least} at Z{z}, not {most}");
    }
}

#[test]
fn pockets_and_missing_contours_are_shown_at_their_lines() {
    let check = |program: &str| {
        husillo()
            .args(["check", "-m", "lathe", "--format", "short", "-"])
            .write_stdin(program.to_owned())
            .assert()
            .failure()
    };
    let program = "G0 X40 Z2\nF100\nG71 P1 Q2 D1\nN1 G0 X10\nG1 Z-5\nX8 Z-9\nN2 X40\nM2\n";
    check(program).stdout(contains("<input>:6:1: error[E0330]: contour goes back in X").count(1));
    check("G0 X40 Z2\nG70 P1 Q2\n").stdout(contains("<input>:2:5: error[E0218]"));
}

#[test]
fn cycles_stand_beside_parameters() {
    let program = "#1=1.5\nG0 X40 Z2\nF100\nG71 U#1 R[#1/3]\nG71 P1 Q2\nN1 G0 X36\nN2 G1 Z-5\nG70 \
         P1 Q2\n#2=7\nG0 Z#2\n";
    let output = husillo()
        .args(["commands", "-m", "lathe", "--dialect", "lathe-a", "-"])
        .write_stdin(program)
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("     5  rapid X18.5 Y0 Z2\n     5  linear X18.5 Y0 Z-5 F100\n"),
        "{text}"
    );
    assert!(text.ends_with("    10  rapid X20 Y0 Z7\n"), "{text}");
}

#[test]
fn pictures_lie_in_the_plane_of_the_machine() {
    for (machine, program, heading) in [
        ("lathe", "../examples/turning.nc", "Tool path in Z and X"),
        (
            "microfactory",
            "../examples/microfactory/square.nc",
            "Tool path in X and Z",
        ),
    ] {
        let page =
            std::env::temp_dir().join(format!("husillo-{machine}-{}.html", std::process::id()));
        husillo()
            .args(["run", "-m", machine, program, "-o"])
            .arg(&page)
            .assert()
            .success();
        let text = std::fs::read_to_string(&page).unwrap();
        std::fs::remove_file(page).unwrap();
        assert!(text.contains(heading), "{machine}");
    }
}
