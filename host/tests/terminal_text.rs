//! What files, names and arguments bring to the terminal: nothing that it obeys.

mod common;

use common::husillo;
use proptest::prelude::*;
use std::ffi::OsString;
use std::io::{Read, Write};
use std::net::TcpListener;
use std::path::{Path, PathBuf};

/// Colours, the title of the window, C1, DEL, and what turns text round.
const HOSTILE: &str = "\u{1b}[31m\u{1b}]0;x\u{7}\u{9b}2J\r\u{202e}\u{2066}\u{7f}";

/// What a terminal does more with than to show it.
fn is_obeyed(one: char) -> bool {
    (one.is_control() && !matches!(one, '\n' | '\t'))
        || matches!(one, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

fn written(folder: &Path, name: &str, text: &str) -> String {
    std::fs::write(folder.join(name), text).unwrap();
    name.to_owned()
}

/// A machine of the project with a hostile name.
fn machine(folder: &Path, from: &str, name: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines");
    let text = std::fs::read_to_string(root.join(from)).unwrap();
    let json = serde_json::to_string(HOSTILE)
        .unwrap()
        .replace('\u{7f}', "\\u007f");
    let lines = text.lines().map(|line| match line.split_once(" = ") {
        Some((key @ ("name" | "title"), _)) => format!("{key} = {json}"),
        _ => line.to_owned(),
    });
    written(folder, name, &(lines.collect::<Vec<_>>().join("\n") + "\n"))
}

/// Files with hostile names and contents, in a folder of their own.
struct Files {
    folder: PathBuf,
    good: String,
    errors: String,
    board: String,
    wrong_board: String,
    manifest: String,
    list: String,
    records: String,
    mill: String,
    bad_toml: String,
    /// A name of no file yet.
    output: String,
    none: String,
}

impl Files {
    fn new(name: &str) -> Self {
        let folder: PathBuf = common::scratch(name);
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        let good = "G21 G90\nG0 X1 Y1\nG1 X2 F5\nM2\n";
        let evil = format!("{HOSTILE}good.nc");
        let good = written(&folder, &evil, good);
        let errors = format!(
            "G21 G90\nG1 X9{HOSTILE} F5\nG1 Z{HOSTILE}1\n({HOSTILE}\nG1 X99 F1 ({HOSTILE})\nM2\n"
        );
        let errors = written(&folder, &format!("{HOSTILE}bad.nc"), &errors);
        let board = format!(
            "M48\nMETRIC,TZ\n;{HOSTILE}\nT1C0.8 ;{HOSTILE}\n%\nT1\nX1.0Y1.0\nX2.0Y1.0\nM30\n"
        );
        let board = written(&folder, &format!("{HOSTILE}b.drl"), &board);
        let wrong_board = written(
            &folder,
            &format!("{HOSTILE}wrong.drl"),
            &format!("M48\nMETRIC,TZ\nT1C{HOSTILE}\n%\nT1\nX1{HOSTILE}Y1.0\nM30\n"),
        );
        let manifest = format!(
            "schema = 1\nprogram = \"x\"\n[[tool]]\nnumber = 1\nfile = {}\nholes = 1\nbytes = 1\n",
            serde_json::to_string(HOSTILE)
                .unwrap()
                .replace('\u{7f}', "\\u007f")
        );
        let manifest = written(&folder, &format!("{HOSTILE}m.toml"), &manifest);
        let bad_toml = written(
            &folder,
            "bad.toml",
            &format!("schema = 1\n\"{HOSTILE}\" = \"{HOSTILE}\"\n"),
        );
        let mill = machine(&folder, "micromill.toml", &format!("{HOSTILE}mill.toml"));
        let list = written(&folder, &format!("{HOSTILE}l.fig"), &format!("{HOSTILE}\n"));
        let records = written(&folder, &format!("{HOSTILE}r.cod"), HOSTILE);
        Files {
            good,
            errors,
            board,
            wrong_board,
            manifest,
            list,
            records,
            mill,
            bad_toml,
            output: format!("{HOSTILE}out"),
            none: format!("{HOSTILE}none"),
            folder,
        }
    }

    /// Runs commands, none of which may print what a terminal obeys. Enough of the hostile texts
    /// must come out, escaped.
    fn run(&self, commands: &[Vec<&str>], least_escaped: usize) {
        let (mut escaped, mut wrong) = (0, Vec::new());
        for args in commands {
            let run = husillo().current_dir(&self.folder).args(args).output();
            let output = run.unwrap();
            for (name, bytes) in [("stdout", &output.stdout), ("stderr", &output.stderr)] {
                let text = String::from_utf8(bytes.clone()).unwrap();
                let obeyed: String = text.chars().filter(|one| is_obeyed(*one)).collect();
                if !obeyed.is_empty() {
                    wrong.push(format!("{args:?}, {name}: {text:?}"));
                }
                escaped += text.matches("\\u001b").count();
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
        assert!(escaped > least_escaped, "{escaped}");
    }
}

/// Commands that read programs and drill files.
#[test]
fn programs_print_nothing_that_a_terminal_obeys() {
    let files = Files::new("terminal-text");
    let Files {
        good,
        errors,
        board,
        wrong_board,
        manifest,
        ..
    } = &files;
    let Files {
        list,
        records,
        mill,
        bad_toml,
        output,
        none,
        ..
    } = &files;
    let commands = [
        vec!["run", good, "-o", output],
        vec!["run", good, "-m", mill, "-o", output, "--trace", output],
        vec!["run", good, "-m", mill, "-o", output],
        vec!["run", good, "--format", "json"],
        vec!["run", errors],
        vec!["run", errors, "-m", none],
        vec!["run", none],
        vec!["check", good, errors, "-m", mill],
        vec!["check", errors, "--format", "short"],
        vec!["check", errors, "--format", "json"],
        vec!["check", good, "-m", bad_toml],
        vec!["check", good, "--dialect", none],
        vec!["check", board, wrong_board],
        vec!["format", errors, "--check"],
        vec!["format", none],
        vec!["commands", good],
        vec!["commands", errors],
        vec!["commands", errors, "--format", "json"],
        vec!["commands", records],
        vec!["steps", good, "-o", output],
        vec!["steps", errors, "-o", output],
        vec!["steps", good, "-o", good],
        vec!["holes", board],
        vec!["holes", board, "--format", "json"],
        vec!["holes", wrong_board],
        vec![
            "holes", board, "--as", "gcode", "--depth", "1", "-o", output,
        ],
        vec!["holes", board, "--shift", none],
        vec!["compile", board, "-m", "drill", "-o", output],
        vec!["compile", board, "-m", "drill", "--report", output],
        vec!["compile", manifest, "-m", "drill"],
        vec!["compile", errors, "-m", "micromill", "-o", output],
        vec!["compile", list],
        vec!["send", manifest, "-m", "drill"],
        vec!["send", good, "-m", "micromill", "--port", none],
        vec!["send", good, "-m", "drill", "--port", none],
        vec!["compare", good, "-o", output],
        vec!["compare", good, "-m", mill],
        vec!["compare", errors],
        vec!["interpolate", "line", "--to", none],
    ];
    files.run(&commands, 40);
}

/// Commands for machines.
#[test]
fn machines_print_nothing_that_a_terminal_obeys() {
    let files = Files::new("terminal-text-machines");
    let Files {
        folder,
        mill,
        bad_toml,
        none,
        ..
    } = &files;
    let cells = format!("axis,{HOSTILE}\n{HOSTILE},1\n");
    let cells = written(folder, &format!("{HOSTILE}cells.csv"), &cells);
    let heads = written(
        folder,
        "heads.csv",
        &format!("axis,x_mm,y_mm,forward_um,back_um\n{HOSTILE},1,1,1,{HOSTILE}\n"),
    );
    let cmm = machine(folder, "cmm3.toml", &format!("{HOSTILE}cmm.toml"));
    let routine = written(
        folder,
        &format!("{HOSTILE}r.routine"),
        &format!("safe z -10\npoint {HOSTILE} towards +x at x10 y30 z-25\nfoo{HOSTILE} bar\n"),
    );
    let commands = [
        vec!["machines", "show", mill],
        vec!["machines", "show", mill, "--format", "json"],
        vec!["machines", "show", none],
        vec!["jog", none],
        vec!["jog", "-m", none, "home"],
        vec!["jog", "-m", "drill", "save", none, none],
        vec!["measure", none],
        vec!["measure", "-m", &cmm, "status"],
        vec!["measure", "-m", &cmm, "run", &routine],
        vec!["measure", "-m", "cmm3", "--piece", &cells, "status"],
        vec!["measure", "-m", "cmm3", "--piece", bad_toml, "status"],
        vec!["measure", "--port", none, "status"],
        vec!["emulate", none, "--link", none],
        vec![
            "emulate",
            "cmm",
            "--link",
            "no/such/folder",
            "--contact",
            none,
        ],
        vec!["tune", "-m", &cmm, "-o", none, "--method", none],
        vec!["calibrate", "backlash", &cells],
        vec!["calibrate", "backlash", &heads],
        vec!["calibrate", "axis", &cells],
        vec!["calibrate", "squareness", &cells],
        vec!["calibrate", "circles", "-m", mill],
        vec![none],
        vec!["run", none, "--bogus"],
    ];
    files.run(&commands, 10);
}

/// Random bytes, of which many begin an escape, or are pieces of one.
fn bytes() -> impl Strategy<Value = Vec<u8>> {
    let piece = prop_oneof![
        any::<u8>().prop_map(|byte| vec![byte]),
        prop::sample::select(vec![
            "\u{1b}[31m",
            "\u{1b}]0;x\u{7}",
            "\u{9b}2J",
            "\u{202e}",
            "\u{2066}",
            "\u{200f}",
            "\r",
            "\u{7f}",
            "\n",
            "X1",
            "G1 ",
            "(",
            "\"",
        ])
        .prop_map(|text| text.as_bytes().to_vec()),
    ];
    prop::collection::vec(piece, 1..24).prop_map(|pieces| pieces.concat())
}

/// A name of a file that the system takes.
fn file_name(bytes: &[u8]) -> OsString {
    let taken = bytes.iter().filter(|byte| !matches!(byte, 0 | b'/'));
    let taken: Vec<u8> = taken.copied().take(100).collect();
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStringExt;
        OsString::from_vec([b"n".to_vec(), taken].concat())
    }
    #[cfg(not(unix))]
    {
        format!("n{}", taken.len()).into()
    }
}

/// A device that answers anything with these bytes, for one client, and soon falls silent.
fn device(answer: Vec<u8>) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = format!("tcp:{}", listener.local_addr().unwrap());
    std::thread::spawn(move || {
        let Ok((mut client, _)) = listener.accept() else {
            return;
        };
        let mut question = [0; 256];
        for _ in 0..20 {
            let heard = client.read(&mut question);
            if !matches!(heard, Ok(1..)) || client.write_all(&answer).is_err() {
                return;
            }
        }
    });
    port
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    /// Whatever a program, a name of a file, a machine or a device has in it: the terminal obeys
    /// none of it.
    #[test]
    fn no_bytes_reach_the_terminal_unescaped(
        program in bytes(),
        name in bytes(),
        machine in bytes(),
        answer in bytes(),
    ) {
        let folder: PathBuf = common::scratch("terminal-random");
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        let file = file_name(&name);
        std::fs::write(folder.join(&file), &program).unwrap();
        let title = String::from_utf8_lossy(&machine).into_owned();
        let title = serde_json::to_string(&title).unwrap().replace('\u{7f}', "\\u007f");
        let toml = std::fs::read_to_string("../machines/micromill.toml").unwrap();
        let toml: Vec<String> = toml
            .lines()
            .map(|line| match line.split_once(" = ") {
                Some(("title", _)) => format!("title = {title}"),
                _ => line.to_owned(),
            })
            .collect();
        std::fs::write(folder.join("m.toml"), toml.join("\n")).unwrap();
        let port = device(answer);
        let is_obeyed = |one: &char| {
            is_obeyed(*one) || matches!(one, '\u{200e}' | '\u{200f}' | '\u{61c}')
        };
        let commands: [&[&str]; 8] = [
            &["check", "FILE", "-m", "m.toml"],
            &["check", "FILE", "--format", "json"],
            &["commands", "FILE"],
            &["holes", "FILE"],
            &["machines", "show", "FILE"],
            &["machines", "show", "m.toml"],
            &["calibrate", "axis", "FILE"],
            &["jog", "-m", "micromill", "--port", &port, "where"],
        ];
        for args in commands {
            let args = args.iter().map(|arg| match *arg {
                "FILE" => file.clone(),
                other => other.into(),
            });
            let mut command = husillo();
            let output = command.current_dir(&folder).args(args).output().unwrap();
            for bytes in [output.stdout, output.stderr] {
                let text = String::from_utf8(bytes);
                prop_assert!(text.is_ok(), "{:?}", text);
                // A line of a program may end with CR LF, as it is printed again.
                let text = text.unwrap().replace("\r\n", "\n");
                let obeyed: String = text.chars().filter(is_obeyed).collect();
                prop_assert!(obeyed.is_empty(), "{:?}", text);
            }
        }
    }
}
