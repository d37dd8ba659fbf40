//! Real programs: those of a folder that LinuxCNC or grblHAL take are taken by `check`.
//!
//! The programs are not part of this repository. `HUSILLO_CORPUS` names their folder (`programs/`
//! and `MANIFEST.tsv`); without it `../shared/gcode` next to the workspace is tried. If there is
//! none, the test passes with a message. `host/docs/real_programs.md` has the results.

mod common;

use common::{husillo, written};
use flate2::read::GzDecoder;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Folders with the tests of interpreters. All others have programs as CAM systems write them.
const TESTS: [&str; 3] = ["linuxcnc-interp/", "linuxcnc-tp/", "nist-rs274ngc/"];

/// The programs that are refused, with the first error. The page has the reasons.
const REFUSED: [(&str, &str); 7] = [
    ("linuxcnc-interp/tests/interp/crazy-paths/test.ngc", "E0322"),
    (
        "linuxcnc-interp/tests/interp/g71-with-g70/g71-with-g70.ngc",
        "E0212",
    ),
    (
        "linuxcnc-interp/tests/interp/g72-missing-iteration/g72-iterations-missing.ngc",
        "E0212",
    ),
    (
        "linuxcnc-interp/tests/interp/good/good-arc.medium.metric.center-format.ngc",
        "E0302",
    ),
    (
        "linuxcnc-interp/tests/interp/inverse-time-with-comp/inverse.ngc",
        "E0508",
    ),
    ("linuxcnc-nc_files/nc_files/lathe_g70_71_demo.ngc", "E0212"),
    (
        "linuxcnc-nc_files/nc_files/lathe_g7x_quadrants.ngc",
        "E0208",
    ),
];

fn corpus() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/gcode");
    let folder = std::env::var_os("HUSILLO_CORPUS").map_or(beside, PathBuf::from);
    if folder.join("MANIFEST.tsv").is_file() {
        return Some(folder);
    }
    let folder = folder.display();
    println!("no corpus in {folder}: set HUSILLO_CORPUS to run this test");
    None
}

/// The files that a reference takes: column `rs274` is `ok`, or `grblhal_errs` is 0.
fn taken_by_a_reference(manifest: &str) -> Vec<&str> {
    let mut lines = manifest.lines();
    let heads: Vec<_> = lines.next().unwrap().split('\t').collect();
    let column = |name| heads.iter().position(|head| *head == name).unwrap();
    let (file, rs274, grblhal) = (column("file"), column("rs274"), column("grblhal_errs"));
    lines
        .map(|line| line.split('\t').collect::<Vec<_>>())
        .filter(|row| row[rs274] == "ok" || row[grblhal] == "0")
        .map(|row| row[file])
        .collect()
}

/// The machine of the measurement: `free6` with the tool that a program asks for in its comments.
fn machine() -> String {
    let free6 = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines/free6.toml");
    let text = std::fs::read_to_string(free6).unwrap();
    let tool = "\n[[tool]]\nnumber = 4\ndiameter = \"25.4 mm\"\n";
    let path = written("corpus-free6.toml", &(text + tool));
    path.to_str().unwrap().to_owned()
}

#[test]
fn real_programs_are_taken() {
    let Some(folder) = corpus() else {
        return;
    };
    let machine = machine();
    let manifest = std::fs::read_to_string(folder.join("MANIFEST.tsv")).unwrap();
    // Taken and all programs, of CAM systems and of tests.
    let mut counts = [[0_u32; 2]; 2];
    let mut refused = BTreeMap::new();
    for file in taken_by_a_reference(&manifest) {
        let output = husillo()
            .args(["check", "--format", "short", "-m", &machine])
            .arg(folder.join("programs").join(file))
            .output()
            .unwrap();
        let count = &mut counts[usize::from(TESTS.iter().any(|test| file.starts_with(test)))];
        count[1] += 1;
        if output.status.success() {
            count[0] += 1;
            continue;
        }
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let error = text.split("error[").nth(1).and_then(|rest| rest.get(..5));
        println!("{file}: {}", text.lines().next().unwrap_or_default());
        refused.insert(file, error.unwrap_or_default().to_owned());
    }
    let [[cam, all_cam], [tests, all_tests]] = counts;
    println!("CAM: {cam} of {all_cam}; tests of interpreters: {tests} of {all_tests}");
    assert!(cam * 100 >= all_cam * 99, "{cam} of {all_cam}");
    assert!(tests * 100 >= all_tests * 95, "{tests} of {all_tests}");
    let expected = REFUSED.map(|(file, error)| (file, error.to_owned()));
    assert_eq!(refused, BTreeMap::from(expected));
}

/// The error code of Grbl after each line, if the file has as many rows as the program has lines.
fn answers_of_grbl(folder: &Path, file: &str, text: &[u8]) -> Vec<u32> {
    let path = folder.join("reference").join(format!("{file}.grbl.gz"));
    let mut rows = String::new();
    let read = File::open(path).and_then(|file| GzDecoder::new(file).read_to_string(&mut rows));
    let answer = |row: &str| row.split(' ').nth(1)?.strip_prefix('e')?.parse().ok();
    let answers: Vec<u32> = rows.lines().filter_map(answer).collect();
    let lines = text.split(|&byte| byte == b'\n').count();
    let lone = text.split(|&byte| byte == b'\n').any(|line| {
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        line.contains(&b'\r')
    });
    match read.is_ok() && !lone && lines.abs_diff(answers.len()) <= 1 {
        true => answers,
        false => Vec::new(),
    }
}

/// A text that says what Grbl answers is true: compared with the answers of Grbl itself.
#[test]
fn what_is_said_of_grbl_is_true() {
    let Some(folder) = corpus() else {
        return;
    };
    let manifest = std::fs::read_to_string(folder.join("MANIFEST.tsv")).unwrap();
    let (mut told, mut wrong) = (0, Vec::new());
    for file in manifest
        .lines()
        .skip(1)
        .filter_map(|row| row.split('\t').next())
    {
        let path = folder.join("programs").join(file);
        let answers = answers_of_grbl(&folder, file, &std::fs::read(&path).unwrap());
        if answers.iter().all(|&answer| answer == 0) {
            continue;
        }
        let options = ["--dialect", "grbl", "-m", "free", "--limit", "100000"];
        let output = husillo()
            .args(["check", "--format", "json"])
            .args(options)
            .arg(&path)
            .output()
            .unwrap();
        for found in common::findings(&output.stdout) {
            let line = found["line"].as_u64().unwrap_or(0) as usize;
            let notes = found["notes"].as_array().unwrap().iter();
            let claim = notes.filter_map(|note| note.as_str()?.split("grbl: `error:").nth(1));
            for claim in claim.filter_map(|rest| rest.split('`').next()?.parse::<u32>().ok()) {
                let Some(&answer) = line.checked_sub(1).and_then(|at| answers.get(at)) else {
                    continue;
                };
                told += 1;
                if claim != answer {
                    wrong.push(format!("{file}:{line}: error:{claim}, not {answer}"));
                }
            }
        }
    }
    println!("{told} answers");
    assert!(told > 5000, "{told}");
    // A full circle without axis words is refused by Grbl, so the mode before it goes on there.
    wrong.retain(|text| !text.ends_with("error:35, not 0"));
    assert!(wrong.is_empty(), "{wrong:#?}");
}
