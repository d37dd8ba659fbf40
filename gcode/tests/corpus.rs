//! Programs from real CAM systems compared with the results and end points of reference
//! interpreters.
//!
//! The programs are not part of this repository. `HUSILLO_CORPUS` names their folder (with
//! `programs/`, `reference/`, `MANIFEST.tsv` and `AGREE.txt`). Without it `../shared/gcode` next to
//! the workspace is tried; if that is missing the tests pass with a message.

#![cfg(all(feature = "program", feature = "extended"))]

use flate2::read::GzDecoder;
use husillo_gcode::parameters::Program;
use husillo_gcode::{Block, Command, Compensation, Dialect, Error, ErrorKind, Modal, Nm};
use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

fn corpus() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/gcode");
    let folder = std::env::var_os("HUSILLO_CORPUS").map_or(beside, PathBuf::from);
    let found = folder.join("MANIFEST.tsv").is_file();
    if !found {
        println!(
            "no corpus in {}: set HUSILLO_CORPUS to run this test",
            folder.display()
        );
    }
    found.then_some(folder)
}

/// One row of a reference: error code and machine position in mm after an input line.
struct Row {
    error: u32,
    at: [f64; 3],
}

/// The rows of `reference/<program>.<name>.gz` by line number; empty when there are none.
fn rows(folder: &Path, program: &str, name: &str) -> BTreeMap<usize, Row> {
    let path = folder
        .join("reference")
        .join(format!("{program}.{name}.gz"));
    let mut text = String::new();
    let read = fs::File::open(path).and_then(|file| GzDecoder::new(file).read_to_string(&mut text));
    if read.is_err() {
        return BTreeMap::new();
    }
    text.lines().filter_map(row).collect()
}

fn row(line: &str) -> Option<(usize, Row)> {
    let mut fields = line.split_whitespace();
    let number = fields.next()?.parse().ok()?;
    let error = fields.next()?.strip_prefix('e')?.parse().ok()?;
    let mut at = [0.0; 3];
    for axis in &mut at {
        *axis = fields.next()?.parse().ok()?;
    }
    Some((number, Row { error, at }))
}

/// The text of `reference/<program>.<name>.gz`.
fn reference(folder: &Path, program: &str, name: &str) -> Option<String> {
    let path = folder
        .join("reference")
        .join(format!("{program}.{name}.gz"));
    let mut text = String::new();
    let read = fs::File::open(path).and_then(|file| GzDecoder::new(file).read_to_string(&mut text));
    read.is_ok().then_some(text)
}

/// The ends of all moves that LinuxCNC makes of a program, in mm and degrees of the work frame.
/// `None` for probes, which it does not report.
fn canon(text: &str) -> Option<Vec<[f64; 6]>> {
    let (mut scale, mut plane) = (1.0, "XY");
    let mut ends = Vec::new();
    for line in text.lines() {
        let Some(call) = line.get(13..) else { continue };
        let Some((name, rest)) = call.split_once('(') else {
            continue;
        };
        let values: Vec<f64> = rest
            .trim_end_matches(')')
            .split([',', ' '])
            .filter_map(|value| value.parse().ok())
            .collect();
        match name.trim() {
            "USE_LENGTH_UNITS" => scale = if rest.contains("INCHES") { 25.4 } else { 1.0 },
            "SELECT_PLANE" => {
                plane = rest
                    .trim_end_matches(')')
                    .trim_start_matches("CANON_PLANE_")
            }
            "STRAIGHT_PROBE" => return None,
            "STRAIGHT_TRAVERSE" | "STRAIGHT_FEED" => {
                let [x, y, z, a, b, c] = values.try_into().ok()?;
                ends.push([x * scale, y * scale, z * scale, a, b, c]);
            }
            "ARC_FEED" => {
                let [first, second, _, _, _, third, a, b, c] = values.try_into().ok()?;
                let [x, y, z] = match plane {
                    "XY" => [first, second, third],
                    "XZ" => [second, third, first],
                    _ => [third, first, second],
                };
                ends.push([x * scale, y * scale, z * scale, a, b, c]);
            }
            _ => {}
        }
    }
    Some(ends)
}

/// The ends of all our moves in the same form. `None` when a block is refused, or a move has no
/// counterpart there.
fn ends(program: &[u8]) -> Option<Vec<[f64; 6]>> {
    let dialect = Dialect::RS274;
    let mut modal = Modal::<6>::new(dialect);
    let mut stage = Compensation::new([Nm(0); 6]);
    let mut ends = Vec::new();
    let mut program: Program = Program::new(program, dialect);
    while let Some(line) = program.next_line(&modal) {
        let (next, commands) = modal.plan(&line.block.ok()?).ok()?;
        let (after, commands) = stage.plan(commands).ok()?;
        stage = after;
        // The frame of the moves, which M2 resets.
        let ended = commands
            .clone()
            .any(|command| matches!(command, Command::End { .. }));
        let frame = if ended { &modal } else { &next };
        let mut frame = frame.clone();
        for command in commands {
            match command {
                Command::Spline { .. } | Command::Probe { .. } => return None,
                // The reference has no coordinates of these.
                Command::NurbsEnd { .. } | Command::Tap { .. } => continue,
                _ => {}
            }
            if let Some(end) = command.end() {
                frame.set_position(end);
                ends.push(frame.work_position().map(|at| at.0 as f64 / 1e6));
            }
        }
        modal = next;
        if ended {
            break;
        }
    }
    Some(ends)
}

/// Largest difference of two points, in any axis.
fn apart(ours: &[f64; 6], theirs: &[f64; 6]) -> f64 {
    ours.iter()
        .zip(theirs)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

/// The largest difference between two lists of ends, or the position of the first one beyond 0.002
/// mm, which is four printed places, in inches at worst. Moves without distance are skipped:
/// LinuxCNC makes one for a G0 without axis words.
fn compare(ours: &[[f64; 6]], theirs: &[[f64; 6]]) -> Result<f64, (usize, usize)> {
    const TOLERANCE: f64 = 0.002;
    let (mut i, mut j, mut at, mut worst) = (0, 0, [0.0; 6], 0.0_f64);
    loop {
        match (ours.get(i), theirs.get(j)) {
            (Some(a), Some(b)) if apart(a, b) <= TOLERANCE => {
                worst = worst.max(apart(a, b));
                (at, i, j) = (*a, i + 1, j + 1);
            }
            (_, Some(b)) if apart(&at, b) <= TOLERANCE => j += 1,
            (Some(a), _) if apart(&at, a) <= TOLERANCE => i += 1,
            (None, None) => return Ok(worst),
            _ => return Err((i, j)),
        }
    }
}

/// Programs on which LinuxCNC is wrong: its G84 feeds along the wrong axes outside G17 (see
/// docs/agreement.md).
const LINUXCNC_IS_WRONG: [&str; 3] = [
    "linuxcnc-interp/tests/interp/g84/g18/g99/g18-g99-g84.ngc",
    "linuxcnc-interp/tests/interp/g84/g19/g98/g19-g98-g84.ngc",
    "nist-rs274ngc/references/c3.ngc",
];

/// Every move of every program that both LinuxCNC and this crate accept completely: same number of
/// moves, same ends.
#[test]
fn moves_agree_with_linuxcnc() {
    let Some(folder) = corpus() else { return };
    let manifest = fs::read_to_string(folder.join("MANIFEST.tsv")).expect("MANIFEST.tsv");
    let (mut programs, mut moves, mut wrong, mut worst) = (0, 0, 0, 0.0_f64);
    let mut faults = Vec::new();
    for entry in manifest.lines().skip(1) {
        let mut fields = entry.split('\t');
        let (Some(name), Some("ok")) = (fields.next(), fields.nth(1)) else {
            continue;
        };
        let text = fs::read(folder.join("programs").join(name)).expect("a program of the manifest");
        let theirs = reference(&folder, name, "canon").and_then(|text| canon(&text));
        let (Some(theirs), Some(ours)) = (theirs, ends(&text)) else {
            continue;
        };
        programs += 1;
        moves += theirs.len();
        match compare(&ours, &theirs) {
            Ok(off) => worst = worst.max(off),
            Err(_) if LINUXCNC_IS_WRONG.contains(&name) => wrong += 1,
            Err((i, j)) => faults.push(format!(
                "{name}: move {i} of {}: {:?}, LinuxCNC {j} of {}: {:?}",
                ours.len(),
                ours.get(i),
                theirs.len(),
                theirs.get(j)
            )),
        }
    }
    println!(
        "{programs} programs, {moves} moves as LinuxCNC has them, \
         largest difference {worst:.4} mm; in {wrong} it is wrong"
    );
    faults.iter().for_each(|line| println!("  {line}"));
    assert!(faults.is_empty(), "{} programs differ", faults.len());
    assert!(programs >= 342, "too few programs compared: {programs}");
}

/// Whether an error means that the program uses codes beyond those of this crate.
fn is_outside(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::UnknownCode(..) | ErrorKind::NotOfDialect(..) | ErrorKind::UnknownWord(_)
    )
}

/// Line ends as counted by the references: after `\n`, or (two rows for CR LF) after `\r` as well.
#[derive(Copy, Clone)]
enum Ends {
    Newline,
    Either,
}

/// Runs a program; gives the position in mm after each line and the first error with its line.
fn run(program: &[u8], ends: Ends) -> (Vec<[f64; 3]>, Option<(usize, Error)>) {
    let dialect = Dialect::RS274;
    let mut modal = Modal::<6>::new(dialect);
    let (mut positions, mut first) = (Vec::new(), None);
    let is_end = |&byte: &u8| byte == b'\n' || (byte == b'\r' && matches!(ends, Ends::Either));
    for (index, line) in program.split(is_end).enumerate() {
        for (_, text) in dialect.blocks(line) {
            match Block::parse(text, &dialect).and_then(|block| modal.plan(&block)) {
                Ok((next, _)) => modal = next,
                Err(error) => {
                    assert!(
                        error.at <= error.end && error.end <= text.len(),
                        "{error:?} outside its line"
                    );
                    first.get_or_insert((index + 1, error));
                }
            }
        }
        let [x, y, z, ..] = modal.position().map(|axis| axis.0 as f64 / 1e6);
        positions.push([x, y, z]);
    }
    (positions, first)
}

/// The first error of a program in the order of execution, up to M2 or M30, with its line.
fn first_error(text: &[u8]) -> Option<(usize, Error)> {
    let mut modal = Modal::<6>::new(Dialect::RS274);
    let mut program: Program = Program::new(text, Dialect::RS274);
    while let Some(line) = program.next_line(&modal) {
        match line.block.and_then(|block| modal.plan(&block)) {
            Ok((next, mut commands)) => {
                modal = next;
                if commands.any(|command| matches!(command, Command::End { .. })) {
                    return None;
                }
            }
            Err(error) => {
                assert!(
                    error.at <= error.end && error.end <= line.text.len(),
                    "{error:?} outside its line"
                );
                return Some((line.number, error));
            }
        }
    }
    None
}

#[test]
fn end_points_agree_with_the_references() {
    let Some(folder) = corpus() else { return };
    let agree = fs::read_to_string(folder.join("AGREE.txt")).expect("AGREE.txt");
    let (mut programs, mut lines, mut skipped, mut worst) = (0, 0, Vec::new(), 0.0_f64);
    let mut faults = Vec::new();
    for name in agree.lines().filter(|name| !name.is_empty()) {
        let text = fs::read(folder.join("programs").join(name)).expect("a program of the list");
        let (positions, error) = run(&text, Ends::Newline);
        if let Some((line, error)) = error {
            skipped.push(format!("{name}:{line}: {error}"));
            continue;
        }
        let references = ["grbl", "grblhal"].map(|reference| rows(&folder, name, reference));
        let reference = references
            .into_iter()
            .filter(|rows| !rows.is_empty())
            .min_by_key(|rows| rows.values().filter(|row| row.error != 0).count());
        let Some(reference) = reference else { continue };
        let last = reference.keys().last().copied().unwrap_or(0);
        let doubled = last > positions.len() + 1;
        let positions = if doubled {
            run(&text, Ends::Either).0
        } else {
            positions
        };
        programs += 1;
        for (line, row) in &reference {
            let Some(ours) = positions.get(line - 1) else {
                continue;
            };
            // 0.0005 mm and half of the last printed digit (four places); 32-bit floats at large
            // coordinates.
            let off = ours
                .iter()
                .zip(row.at)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            worst = worst.max(off);
            lines += 1;
            if off > 0.0006 {
                faults.push(format!(
                    "{name}:{line}: ours {ours:?}, reference {:?}",
                    row.at
                ));
                break;
            }
        }
    }
    println!(
        "{programs} programs, {lines} lines, largest difference {worst:.4} mm; skipped {}:",
        skipped.len()
    );
    skipped
        .iter()
        .chain(&faults)
        .for_each(|line| println!("  {line}"));
    assert!(faults.is_empty(), "{} programs end elsewhere", faults.len());
    assert!(programs >= 109, "too few programs compared: {programs}");
}

#[test]
fn every_refusal_has_a_reason() {
    let Some(folder) = corpus() else { return };
    let manifest = fs::read_to_string(folder.join("MANIFEST.tsv")).expect("MANIFEST.tsv");
    let (mut taken, mut outside, mut shared) = (0, 0, 0);
    let mut kinds: BTreeMap<u16, usize> = BTreeMap::new();
    let mut alone = Vec::new();
    for entry in manifest.lines().skip(1) {
        let mut fields = entry.split('\t');
        let (Some(name), Some(verdict)) = (fields.next(), fields.nth(1)) else {
            continue;
        };
        let text = fs::read(folder.join("programs").join(name)).expect("a program of the manifest");
        let Some((line, error)) = first_error(&text) else {
            taken += 1;
            continue;
        };
        *kinds.entry(error.kind.code()).or_default() += 1;
        if is_outside(error.kind) {
            outside += 1;
            if std::env::var_os("HUSILLO_CORPUS_LIST").is_some() {
                println!("  outside: {name}:{line}: {error} (LinuxCNC: {verdict})");
            }
            continue;
        }
        // Two rows per line for CR LF.
        let refused = |reference| {
            let rows = rows(&folder, name, reference);
            [line, 2 * line - 1]
                .iter()
                .any(|line| rows.get(line).is_some_and(|row| row.error != 0))
        };
        if verdict == "reject" || refused("grbl") || refused("grblhal") {
            shared += 1;
        } else {
            alone.push(format!("{name}:{line}: {error} (LinuxCNC: {verdict})"));
        }
    }
    println!(
        "{taken} taken whole, {outside} use what is not in the list, \
         {shared} refused by a reference too"
    );
    println!("first refusals by code: {kinds:?}");
    alone.iter().for_each(|line| println!("  {line}"));
    assert!(
        alone.is_empty(),
        "{} refusals that no reference shares",
        alone.len()
    );
    assert!(taken >= 428, "{taken} taken");
    assert!(outside <= 42, "{outside} outside of the list");
}

/// Differences between Grbl 1.1 and [`Dialect::GRBL`]: its answer, and our error code.
const GRBL_DIFFERS: [(u32, u16); 7] = [
    // `$` lines are for the controller itself, and its `/` may be anywhere.
    (0, 101),
    // `%`: a mark of the file, which senders omit.
    (1, 0),
    // R0 of G10 L2.
    (20, 0),
    // G1 alone before any feed rate: it moves nothing.
    (22, 0),
    // A full circle without axis words.
    (26, 0),
    // A radius that is too short because of rounding.
    (34, 0),
    // P, turns of an arc.
    (36, 0),
];

/// Every program line by line as in the check mode of Grbl: the same lines are refused, and the
/// position after each line is the same, until the first line with a different result, a probe, or
/// the end of the program.
#[test]
fn lines_agree_with_grbl() {
    let Some(folder) = corpus() else { return };
    let dialect = Dialect::GRBL;
    let manifest = fs::read_to_string(folder.join("MANIFEST.tsv")).expect("MANIFEST.tsv");
    let (mut programs, mut lines) = (0, 0);
    let mut differing: BTreeMap<(u32, u16), (usize, String)> = BTreeMap::new();
    let mut faults = Vec::new();
    for entry in manifest.lines().skip(1) {
        let name = entry.split('\t').next().expect("a name");
        let reference = rows(&folder, name, "grbl");
        let text = fs::read(folder.join("programs").join(name)).expect("a program of the manifest");
        let split: Vec<&[u8]> = text.split(|&byte| byte == b'\n').collect();
        // Two rows per line for CR LF.
        if reference.is_empty() || reference.keys().last() > Some(&(split.len() + 1)) {
            continue;
        }
        programs += 1;
        let mut modal = Modal::<3>::new(dialect);
        for (number, line) in (1..).zip(split) {
            let Some(row) = reference.get(&number) else {
                continue;
            };
            let planned = Block::parse(line, &dialect).and_then(|block| modal.plan(&block));
            let code = match planned {
                Ok((next, mut commands)) => {
                    let over =
                        |command| matches!(command, Command::End { .. } | Command::Probe { .. });
                    if commands.any(over) {
                        break;
                    }
                    modal = next;
                    0
                }
                Err(error) => error.kind.code(),
            };
            if (row.error == 0) != (code == 0) {
                let seen = differing.entry((row.error, code)).or_default();
                seen.0 += 1;
                if seen.1.is_empty() {
                    seen.1 = format!("{name}:{number}: {}", String::from_utf8_lossy(line));
                }
                break;
            }
            lines += 1;
            let at = modal.position().map(|axis| axis.0 as f64 / 1e6);
            let off = at
                .iter()
                .zip(row.at)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            // 32-bit floating point at large coordinates.
            if off > 0.002 {
                faults.push(format!("{name}:{number}: ours {at:?}, Grbl {:?}", row.at));
                break;
            }
        }
    }
    println!("{programs} programs, {lines} lines as Grbl has them");
    for ((theirs, ours), (count, first)) in &differing {
        println!("  Grbl error:{theirs}, ours E{ours:04}: {count} programs, as {first}");
    }
    faults.iter().for_each(|line| println!("  {line}"));
    assert!(faults.is_empty(), "{} programs end elsewhere", faults.len());
    let unknown: Vec<_> = differing
        .keys()
        .filter(|pair| !GRBL_DIFFERS.contains(pair))
        .collect();
    assert!(unknown.is_empty(), "{unknown:?}");
    assert!(
        programs >= 497 && lines >= 174_745,
        "{programs} programs, {lines} lines"
    );
}
