//! Expressions, and programs with control flow.

#![cfg(feature = "program")]

use husillo_gcode::parameters::{NoMachine, Program, System, Value, needs_program};
use husillo_gcode::{Block, Dialect, Error, Modal};
use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};

/// The value of an expression, or its error with columns from the start of the expression.
fn value(expression: &str) -> Result<Value, (u16, usize, usize)> {
    let text = format!("#1={expression}");
    let mut program: Program = Program::new(text.as_bytes(), Dialect::RS274);
    let line = program.next_line(&NoMachine).expect("a line");
    match line.block {
        Ok(_) => Ok(program.parameter(1)),
        Err(error) => Err((
            error.kind.code(),
            error.at.wrapping_sub(3),
            error.end.wrapping_sub(3),
        )),
    }
}

fn shown(expression: &str) -> String {
    value(expression).map_or_else(|error| format!("{error:?}"), |value| value.to_string())
}

/// Digits at 19 places, truncated.
fn at_19(text: &str) -> i128 {
    let (sign, text) = text.strip_prefix('-').map_or((1, text), |rest| (-1, rest));
    let (whole, places) = text.split_once('.').unwrap_or((text, ""));
    let places: String = places
        .chars()
        .chain("0".repeat(19).chars())
        .take(19)
        .collect();
    let whole: i128 = whole.parse().expect("digits");
    sign * (whole * 10_i128.pow(19) + places.parse::<i128>().expect("digits"))
}

/// Every function stays within its documented error, compared with 45 digits of another library
/// (mpmath).
#[test]
fn functions_keep_their_bounds() {
    let mut worst = std::collections::BTreeMap::new();
    for line in include_str!("data/functions.tsv").lines() {
        let fields: Vec<&str> = line.split('\t').collect();
        let (expression, expected) = match fields[..] {
            ["**", a, b, expected] => (format!("[{a}**{b}]"), expected),
            ["ATAN", a, b, expected] => (format!("ATAN[{a}]/[{b}]"), expected),
            [name, a, expected] => (format!("{name}[{a}]"), expected),
            _ => panic!("{line}"),
        };
        let result = value(&expression).unwrap_or_else(|error| panic!("{line}: {error:?}"));
        let real: f64 = expected.parse().expect("a number");
        let unit = |exponent: i32| 10_f64.powi(exponent);
        let bound = match fields[0] {
            "SIN" | "COS" | "LN" => unit(-15),
            "TAN" => unit(-15) + unit(-17) * (1.0 + real * real),
            "ASIN" | "ACOS" | "ATAN" => unit(-14),
            "EXP" => unit(-15).max(unit(-16) * real),
            "SQRT" => 0.51 * unit(-18).max(unit(-17) * real),
            _ => (1.0 + real.ln().abs()) * unit(-16) * real + unit(-15),
        };
        let expected = if expected.contains('e') {
            "0"
        } else {
            expected
        };
        let off = (at_19(&result.to_string()) - at_19(expected)).unsigned_abs() as f64 * unit(-19);
        let share = off / bound;
        let entry = worst
            .entry(fields[0].to_owned())
            .or_insert((0.0, String::new()));
        if share > entry.0 {
            *entry = (share, format!("{expression} = {result}, off by {off:.1e}"));
        }
    }
    let mut faults = 0;
    for (name, (share, text)) in &worst {
        println!("{name:>5}: {share:.2} of the bound: {text}");
        faults += usize::from(*share > 1.0);
    }
    assert_eq!(faults, 0, "{worst:#?}");
}

#[test]
fn operators_bind_as_they_should() {
    for (expression, expected) in [
        ("[0.1+0.2]", "0.3"),
        ("[1+2*3**2]", "19"),
        ("[2**3**2]", "64"),
        ("[-2**2]", "4"),
        ("[10-4-3]", "3"),
        ("[7 mod 3 * 2]", "2"),
        ("[-7 MOD 3]", "2"),
        ("[1 lt 2 and 3 ge 3]", "1"),
        ("[1 or 0 xor 1]", "0"),
        ("[1 EQ 1.000]", "1"),
        ("[1+1 EQ 2 AND 2 NE 3]", "1"),
        ("[[1/3]*3 EQ 1]", "1"),
        ("FIX[[1/3]*3]", "1"),
        ("FIX[-2.5]", "-3"),
        ("FUP[-2.5]", "-2"),
        ("ROUND[-2.5]", "-3"),
        ("ABS[-2.5]", "2.5"),
        ("SIN[30]", "0.500000000000000"),
        ("SIN[450]", "1"),
        ("SQRT[2.25]", "1.5"),
        ("ATAN[1]/[-1]", "135.00000000000000"),
        ("ATAN[0]/[-1]", "180"),
        ("- [1 - -3]", "-4"),
        ("exists[#<a>]", "0"),
        ("EXISTS[#5]", "1"),
        ("EXISTS[#99999]", "0"),
        ("EXISTS[#[-1]]", "0"),
        ("#[1+#[1]]", "0"),
        ("[ 1 2 . 5 + S I N [ 0 ] ]", "12.5"),
        ("[1 and 0]", "0"),
        ("[0 and 1]", "0"),
        ("[0 or 2]", "1"),
        ("[0 xor 2]", "1"),
        ("[2 xor 1]", "0"),
        ("[0**2]", "0"),
        ("[0**0]", "1"),
        ("TAN[0]", "0"),
        ("TAN[180]", "0"),
        ("ATAN[1]/[0]", "90"),
        ("ATAN[-1]/[0]", "-90"),
        ("EXP[-100]", "0"),
        ("[0.25**0.5]", "0.500000000000000"),
        ("[4**-0.5]", "0.500000000000000"),
        ("0.1000000000000000000000", "0.100000000000000000"),
    ] {
        assert_eq!(shown(expression), expected, "{expression}");
    }
}

#[test]
fn errors_have_their_place() {
    for (expression, code, at, end) in [
        ("[1/0]", 620, 1, 4),
        ("[5 MOD [2-2]]", 620, 1, 12),
        ("[2+SQRT[-1]]", 621, 3, 11),
        ("TAN[90]", 621, 0, 7),
        ("ATAN[0]/[0]", 621, 0, 11),
        ("ATAN[1]", 610, 0, 7),
        ("ASIN[1.1]", 621, 0, 9),
        ("[1+2", 611, 0, 4),
        ("[1 2 3", 611, 0, 6),
        ("[1+]", 610, 3, 4),
        ("[1 & 2]", 610, 3, 4),
        ("SINE[3]", 612, 0, 4),
        ("SIN 3", 610, 4, 5),
        ("[1+#<nobody>]", 624, 3, 12),
        ("#<nobody", 613, 0, 8),
        ("#9999", 623, 0, 5),
        ("#1.5", 623, 0, 4),
        ("[9000000000000000000*2]", 622, 1, 22),
        ("--5", 102, 1, 2),
        ("1.2.3", 102, 0, 4),
        ("[[[[[[[[[[[[[[[[[[[[[[[[[1", 614, 24, 25),
        ("", 610, 0, 0),
        (".", 610, 0, 1),
        ("0.12345678901234567891", 103, 0, 21),
        ("92233720368547758070", 103, 0, 20),
        ("92233720368547758071", 103, 0, 20),
        ("[0**-1]", 620, 1, 6),
        ("LN[0]", 621, 0, 5),
        ("LN[-2]", 621, 0, 6),
        ("EXP[100]", 622, 0, 8),
        ("[100**9000.5]", 622, 1, 12),
    ] {
        assert_eq!(
            value(expression).map(|v| v.to_string()),
            Err((code, at, end)),
            "{expression}"
        );
    }
}

/// Runs a program up to M2: its commands with their line numbers, and its errors.
fn run(text: &str) -> (Vec<String>, Vec<String>) {
    run_in(Dialect::RS274, text)
}

fn run_in(dialect: Dialect, text: &str) -> (Vec<String>, Vec<String>) {
    let mut program: Program = Program::new(text.as_bytes(), dialect).with_steps(10_000);
    let mut modal = Modal::<3>::new(dialect);
    let (mut commands, mut errors) = (Vec::new(), Vec::<String>::new());
    while let Some(line) = program.next_line(&modal) {
        if commands
            .last()
            .is_some_and(|last: &String| last.contains(": end"))
        {
            break;
        }
        assert_eq!(
            &text.as_bytes()[line.at..line.at + line.text.len()],
            line.text
        );
        match line.block.and_then(|block| modal.plan(&block)) {
            Ok((next, made)) => {
                modal = next;
                commands.extend(made.map(|command| format!("{}: {command}", line.number)));
            }
            Err(error) => errors.push(format!(
                "{}:{}-{} E{:04} {error}",
                line.number,
                error.at + 1,
                error.end,
                error.kind.code()
            )),
        }
    }
    (commands, errors)
}

fn programs(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/golden/flow")
        .join(folder);
    let entries = fs::read_dir(folder).expect("golden folder");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|name| name == "ngc"));
    paths.sort();
    assert!(!paths.is_empty());
    paths
}

/// `good/*.ngc` give their `.commands`, in the order of execution; `UPDATE_GOLDEN=1` rewrites them.
#[test]
fn good_programs_mean_their_commands() {
    for path in programs("good") {
        let (commands, errors) = run(&fs::read_to_string(&path).expect("a program"));
        assert!(errors.is_empty(), "{}: {errors:#?}", path.display());
        let text = commands.join("\n") + "\n";
        let golden = path.with_extension("commands");
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            fs::write(&golden, &text).expect("write");
        }
        let expected = fs::read_to_string(&golden).unwrap_or_default();
        assert_eq!(text, expected, "{}", path.display());
    }
}

/// The first line of `bad/*.ngc` states the only error; `name.DIALECT.ngc` are in that dialect.
#[test]
fn bad_programs_have_their_error() {
    let mut wrong = Vec::new();
    for path in programs("bad") {
        let text = fs::read_to_string(&path).expect("a program");
        let first = text.lines().next().unwrap_or_default().to_owned();
        let stem = path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let dialect = stem.split_once('.').map_or(Dialect::RS274, |(_, name)| {
            Dialect::by_name(name).expect("a dialect")
        });
        let (_, errors) = run_in(dialect, &text);
        let found = format!("; {}", errors.join(" | "));
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            fs::write(&path, text.replacen(&first, &found, 1)).expect("write");
        } else if found != first {
            wrong.push(format!("{}: expected {first}, got {found}", path.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn assignments_wait_for_their_line() {
    let (commands, errors) = run("#1=1\n#1=2 G0 X#1 #2=#1\nG0 X#1 Y#2\n");
    assert_eq!(errors, [""; 0]);
    assert_eq!(commands, ["2: rapid X1 Y0 Z0", "3: rapid X2 Y1 Z0"]);
}

/// Comments may stand wherever a blank may stand in a line with an O-word.
#[test]
fn comments_within_the_line_of_an_o_word() {
    let (commands, errors) = run("\
o1 (a) sub (b)
G0 X#1 Y#2
o1 (c) endsub (d) [#2] (e)
o1 (f) (g) call (h) [3] (i) [4] (j) ; k
o2 (l) if (m) [#<_value> EQ 4] (n)
G0 Z1
o2 (o) endif (p)
");
    assert_eq!(errors, [""; 0]);
    assert_eq!(commands, ["2: rapid X3 Y4 Z0", "6: rapid X3 Y4 Z1"]);
    let (_, errors) = run("o1 (a (b) sub\n");
    assert_eq!(errors.len(), 1, "{errors:?}");
}

#[test]
fn every_hostile_program_ends() {
    for text in [
        "o1 while [1]\no1 endwhile\n",
        "o1 sub\no1 call\no1 endsub\no1 call\n",
        "o1 do\no1 while [1]\n",
        "o1 repeat [9000000000000]\nG4 P0\no1 endrepeat\n",
        "o1 while [1]\no1 continue\no1 endwhile",
    ] {
        let (_, errors) = run(text);
        assert_eq!(errors.len(), 1, "{text}: {errors:?}");
        assert!(
            errors[0].contains("E0638") || errors[0].contains("E0637"),
            "{errors:?}"
        );
    }
}

/// A number with its text.
fn decimal() -> impl Strategy<Value = String> {
    "-?[0-9]{1,4}(\\.[0-9]{1,4})?"
}

/// The exact value as a fraction of integers.
fn fraction(text: &str) -> (i128, i128) {
    let places = text
        .split_once('.')
        .map_or(0, |(_, places)| places.len() as u32);
    (
        text.replace('.', "").parse().expect("digits"),
        10_i128.pow(places),
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 2 } else { 512 }))]

    /// Sums and products of short decimals are exact, also nested; quotients are the nearest number
    /// of 18 places.
    #[test]
    fn short_decimals_stay_exact(a in decimal(), b in decimal(), c in decimal()) {
        let result = value(&format!("[[{a}+{b}]*{c}-{a}]")).expect("a value");
        let ((an, ad), (bn, bd), (cn, cd)) = (fraction(&a), fraction(&b), fraction(&c));
        let (n, d) = ((an * bd + bn * ad) * cn * ad - an * ad * bd * cd, ad * bd * cd * ad);
        let scale = 10_i128.pow(u32::from(result.places()));
        prop_assert!(result.is_exact());
        prop_assert_eq!(i128::from(result.digits()) * d, n * scale);
        if cn != 0 {
            let quotient = value(&format!("[{a}/{c}]")).expect("a value");
            let scale = 10_i128.pow(u32::from(quotient.places()));
            // |q - a/c| <= 1/2 unit of the last place, without rounding.
            let (n, d) = (an * cd, ad * cn);
            let off = (i128::from(quotient.digits()) * d - n * scale).abs();
            prop_assert!(2 * off <= d.abs(), "{} {}", quotient, off);
            prop_assert_eq!(quotient.is_exact(), off == 0);
        }
    }

    /// A value printed and read again is the same.
    #[test]
    fn printed_values_read_the_same(a in decimal(), b in decimal()) {
        if let Ok(result) = value(&format!("[{a}/{b}]")) {
            let again = value(&result.to_string()).expect("a value");
            prop_assert_eq!((again.digits(), again.places()), (result.digits(), result.places()));
        }
    }

    /// Lines without parameters have the same meaning with and without this module.
    #[test]
    fn plain_lines_are_what_they_were(line in "([GXYZFIJM] ?-?[0-9]{1,3}(\\.[0-9]{0,3})? ?){0,6}") {
        let direct = Block::parse(line.as_bytes(), &Dialect::RS274);
        let bracketed = line.split_inclusive(|c: char| c.is_ascii_alphabetic());
        // M70 to M73, M98 and M99 mean more in a program.
        prop_assume!(!line.is_empty() && !needs_program(line.as_bytes(), &Dialect::RS274));
        let mut wrapped = String::new();
        for part in bracketed {
            let letter = part.ends_with(|c: char| c.is_ascii_alphabetic());
            let (number, letter) = part.split_at(part.len() - usize::from(letter));
            if !number.trim().is_empty() {
                wrapped += &format!("[{}]", number.trim());
            }
            wrapped += letter;
        }
        let mut program: Program = Program::new(wrapped.as_bytes(), Dialect::RS274);
        let through = program.next_line(&NoMachine).expect("a line").block;
        match (direct, through) {
            (Ok(direct), Ok(through)) => for letter in b'A'..=b'Z' {
                // An expression has no sign of zero.
                let shown = |block: &Block| block.word(letter).filter(|word| !word.is_zero());
                prop_assert_eq!(shown(&direct), shown(&through));
            },
            (Err(direct), Err(through)) => prop_assert_eq!(direct.kind, through.kind),
            (direct, through) => prop_assert!(false, "{:?} {:?}", direct, through),
        }
    }

    /// No text panics; errors are inside their lines; every program ends within its steps.
    #[test]
    fn any_program_ends(lines in prop::collection::vec(statement(), 0..24)) {
        let text = lines.join("\n");
        let mut program: Program<'_, 8, 12, 4> =
            Program::new(text.as_bytes(), Dialect::RS274).with_steps(500);
        let mut given = 0;
        while let Some(line) = program.next_line(&NoMachine) {
            given += 1;
            prop_assert!(given <= 502);
            prop_assert_eq!(
                text.as_bytes().get(line.at..line.at + line.text.len()),
                Some(line.text)
            );
            if let Err(Error { at, end, kind }) = line.block {
                prop_assert!(
                    at <= end && end <= line.text.len(),
                    "{:?} {}..{} of {:?}",
                    kind,
                    at,
                    end,
                    line.text
                );
                prop_assert!(!kind.to_string().is_empty());
            }
        }
        prop_assert!(program.next_line(&NoMachine).is_none());
    }
}

/// A line of a program with O-words, right or wrong.
fn statement() -> impl Strategy<Value = String> {
    let word = prop::sample::select(vec![
        "sub",
        "endsub",
        "call",
        "return",
        "if",
        "elseif",
        "else",
        "endif",
        "while",
        "endwhile",
        "do",
        "repeat",
        "endrepeat",
        "break",
        "continue",
        "",
    ]);
    let token = prop::sample::select(vec![
        "[",
        "]",
        "#",
        "1",
        "2",
        "30",
        "0.5",
        "<a>",
        "<_b>",
        "+",
        "-",
        "*",
        "**",
        "/",
        "MOD",
        "EQ",
        "LT",
        "SIN[",
        "ATAN[",
        "EXISTS[#",
        "=",
        "X",
        "G1",
        " ",
        "(c)",
        ";",
        "o1",
        "o<p>",
        "[1]",
        "[#1 LT 3]",
        "#1=[#1+1]",
        "FIX[",
    ]);
    let flow = (
        prop::sample::select(vec!["1", "2", "<p>", "#1", "[2]"]),
        word,
        prop::collection::vec(token.clone(), 0..3),
    )
        .prop_map(|(label, word, rest)| format!("o{label} {word} {}", rest.concat()));
    let words = prop::collection::vec(token, 0..8).prop_map(|tokens| tokens.concat());
    prop_oneof![3 => flow, 1 => words]
}

/// A caller with its own subroutine `probe`, and its last result.
struct Outside(i32);

impl System for Outside {
    fn numbered(&self, number: u16) -> Option<Value> {
        (number == 5061).then(|| Value::from(self.0))
    }

    fn named(&self, name: &[u8]) -> Option<Value> {
        (name == b"FOUND").then(|| Value::from(self.0))
    }

    fn has_subroutine(&self, name: &[u8]) -> bool {
        matches!(name, b"probe" | b"mine")
    }
}

/// The outside calls of `program`, each answered by the sum of its arguments, and the error of the
/// last line.
fn calls(text: &str) -> (Vec<String>, Option<u16>) {
    let mut program: Program = Program::new(text.as_bytes(), Dialect::RS274);
    let (mut outside, mut called, mut code) = (Outside(0), Vec::new(), None);
    while let Some(line) = program.next_line(&outside) {
        code = line.block.err().map(|error| error.kind.code());
        if let Some((name, count)) = program.outside_call() {
            let arguments = (1..=count).map(|number| program.parameter(number as u16).to_string());
            let arguments: Vec<_> = arguments.collect();
            outside.0 = arguments
                .iter()
                .map(|text| text.parse::<i32>().unwrap())
                .sum();
            let name = String::from_utf8_lossy(name);
            called.push(format!("{}: {name} {}", line.number, arguments.join(" ")));
        }
    }
    (called, code)
}

#[test]
fn subroutines_outside_of_the_text() {
    // Arguments; results that later lines and conditions read; loops and subroutines around; the
    // subroutine `mine` of the text comes first.
    let text = "\
#1 = 9
o<probe> call [1] [2]
#<sum> = #<_found>
o1 while [#5061 lt 6]
o<probe> call [#5061] [#1 - 7] [#<sum> - 3]
o1 endwhile
o<deep> sub
o<probe> call [#1]
o<deep> endsub [#1]
o<deep> call [70]
o<mine> sub
o<mine> endsub
o<mine> call [5]
o<probe> call [#1] [#<_value>] [#<_found>]
o<probe> call";
    let wanted = [
        "2: probe 1 2",
        "5: probe 3 2 0",
        "5: probe 5 2 0",
        "8: probe 70",
        "14: probe 9 0 70",
        "15: probe ",
    ];
    assert_eq!(calls(text), (wanted.map(String::from).to_vec(), None));
    // In neither place; numbers are never outside.
    assert_eq!(calls("o<other> call"), (Vec::new(), Some(633)));
    assert_eq!(calls("o7 call"), (Vec::new(), Some(633)));
}

#[test]
fn every_kind_of_line_end_ends_one_line() {
    let lines = [
        "#1=2",
        "o1 repeat [2]",
        "",
        "G0 X#1",
        "#1=[#1+1]",
        "o1 endrepeat",
        "Y1",
    ];
    let run = |end: &str| {
        let text = lines.join(end);
        let mut program: Program = Program::new(text.as_bytes(), Dialect::RS274);
        let mut seen = Vec::new();
        while let Some(line) = program.next_line(&NoMachine) {
            line.block.expect("a good line");
            seen.push((line.number, String::from_utf8_lossy(line.text).into_owned()));
        }
        seen
    };
    let expected = run("\n");
    assert_eq!(expected.len(), 11);
    assert_eq!(run("\r\n"), expected);
    assert_eq!(run("\r"), expected);
}

/// The lines that need a program: those with a parameter or a bracket outside comments, and
/// O-words.
#[test]
fn lines_that_need_a_program() {
    let plain = Dialect::RS274;
    let executed = plain.with_block_delete(false);
    for (line, is_needed) in [
        ("G1 X1", false),
        ("G1 X#1", true),
        ("G1 X[1]", true),
        ("(#1 [2])", false),
        ("(a) X#1", true),
        ("(a;) X#1", true),
        ("G1 ;#1", false),
        ("o1 call", true),
        (" O<a> sub", true),
        ("N5 o1 call", true),
        ("N5.0 o1 call", true),
        ("(a)o1 call", true),
        ("N1N2 o1 call", false),
        ("5 o1 call", false),
        ("X1 o1 call", false),
        ("/X#1", false),
        (" /o1 call", false),
    ] {
        assert_eq!(needs_program(line.as_bytes(), &plain), is_needed, "{line}");
    }
    for (line, is_needed) in [("/X#1", true), ("/o1 call", true), ("N1 /o1 call", false)] {
        assert_eq!(
            needs_program(line.as_bytes(), &executed),
            is_needed,
            "{line}"
        );
    }
    assert!(!needs_program(b"X#1", &Dialect::GRBL));
}

/// Parameters that a caller reads from and writes into a program.
#[test]
fn a_program_from_outside() {
    let text = b"#<depth>=5\no1 sub\n#103=[#1+#<_top>]\no1 endsub\no1 call [2]\n#4=1\n#5=1\n";
    let mut program: Program = Program::new(text, Dialect::RS274);
    assert!(program.set_parameter(0, Value::from(1)).is_err());
    program.set_parameter(7, Value::from(70)).expect("room");
    program
        .set_named_parameter(b"_top", Value::from(40))
        .expect("room");
    let shown = |value: Option<Value>| value.map(|value| value.to_string());
    assert_eq!(program.parameter(7).to_string(), "70");
    assert_eq!(
        shown(program.named_parameter(b"_top")).as_deref(),
        Some("40")
    );
    assert!(program.named_parameter(b"depth").is_none());
    let before = program.steps_left();
    let mut levels = Vec::new();
    while let Some(line) = program.next_line(&NoMachine) {
        assert!(line.block.is_ok(), "{line:?}");
        levels.push((line.number, program.call_level()));
        // The line of #4 twice.
        if levels.len() == 6 {
            program.go_to(line.at, line.number);
        }
    }
    assert_eq!(
        shown(program.named_parameter(b"depth")).as_deref(),
        Some("5")
    );
    assert_eq!(
        levels,
        [
            (1, 0),
            (2, 0),
            (5, 1),
            (3, 1),
            (4, 0),
            (6, 0),
            (6, 0),
            (7, 0)
        ]
    );
    assert!(before > program.steps_left() && program.steps_left() > 1);
    assert_eq!(program.parameter(103).to_string(), "42");
}

/// Lines of words and parameters: what ends them, and what is not permitted in them.
#[test]
fn lines_of_words() {
    let executed = Dialect::RS274.with_block_delete(false);
    let (commands, errors) = run_in(executed, "#1=2\n/G0 X#1 ; (Y#1\n(a) / Y[3]\n");
    assert_eq!(errors, [""; 0]);
    assert_eq!(commands, ["2: rapid X2 Y0 Z0", "3: rapid X2 Y3 Z0"]);
    for (line, code, at, end) in [
        ("G0 X#1 /Y1", 101, 7, 8),
        ("G0 X#1 , Y1", 108, 7, 8),
        (", X#1", 101, 0, 1),
        ("(a (b) X#1", 105, 0, 10),
    ] {
        let mut program: Program = Program::new(line.as_bytes(), executed);
        let block = program.next_line(&NoMachine).expect("a line").block;
        let error = block.expect_err(line);
        assert_eq!((error.kind.code(), error.at, error.end), (code, at, end));
    }
}

/// Lines with `/` control the flow only where they are executed, including those read in a search.
#[test]
fn deleted_lines_do_not_steer() {
    let [deleted, executed] = [true, false].map(|on| Dialect::RS274.with_block_delete(on));
    for (text, without, with) in [
        ("/o1 if [0]\nG0 X1\n/o1 endif\n", 1, 0),
        ("o1 if [0]\nG0 X1\n/o1 else\nG0 X2\no1 endif\n", 0, 1),
        ("o1 sub\n/o1 endsub\nG0 X1\no1 endsub\n", 0, 1),
    ] {
        for (dialect, count) in [(deleted, without), (executed, with)] {
            assert_eq!(run_in(dialect, text).0.len(), count, "{text}");
        }
    }
    // In a dialect where an `O` is a program number.
    for on in [true, false] {
        let dialect = Dialect::ISO.with_block_delete(on);
        let codes = ["/O1 sub", "O1 sub", "O1"].map(|line| {
            let mut program: Program = Program::new(line.as_bytes(), dialect);
            let block = program.next_line(&NoMachine).expect("a line").block;
            block.err().map(|error| error.kind.code())
        });
        let deleted = if on { None } else { Some(639) };
        assert_eq!(codes, [deleted, Some(639), None]);
    }
}

/// Whatever a machine answers, the parameters of the program are separate.
#[test]
fn a_machine_that_answers_everything() {
    struct Seven;
    impl System for Seven {
        fn numbered(&self, _: u16) -> Option<Value> {
            Some(Value::from(7))
        }
        fn named(&self, _: &[u8]) -> Option<Value> {
            None
        }
    }
    let text = b"#5=1\n#5000=2\n#6=[#5+#5000*10+#5001*100]\n#5001=3\n";
    let mut program: Program = Program::new(text, Dialect::RS274);
    let mut codes = Vec::new();
    while let Some(line) = program.next_line(&Seven) {
        codes.push(line.block.err().map(|error| error.kind.code()));
    }
    assert_eq!(codes, [None, None, None, Some(625)]);
    assert_eq!(program.parameter(6).to_string(), "721");
    // Numbers that a machine does not answer can be assigned.
    let mut program: Program = Program::new(b"#5001=3\n#6=#5001\n", Dialect::RS274);
    while let Some(line) = program.next_line(&NoMachine) {
        assert!(line.block.is_ok(), "{line:?}");
    }
    assert_eq!(program.parameter(6).to_string(), "3");
}

/// `break` and `continue` of an outer loop end the inner ones; rounds keep counting.
#[test]
fn loops_are_left() {
    for (text, count) in [
        (
            "o1 repeat [3]\nG0 X1\no1 continue\nG0 X2\no1 endrepeat\n",
            3,
        ),
        (
            "o1 do\nG0 X1\n#1=[#1+1]\no1 continue\nG0 X2\no1 while [#1 lt 3]\n",
            3,
        ),
        (
            "o1 while [1]\no2 while [1]\nG0 X1\no1 break\no2 endwhile\nG0 X2\no1 endwhile\nG0 X3\n",
            2,
        ),
        (
            "o1 while [#1 lt 2]\n#1=[#1+1]\no2 while [1]\nG0 X1\no1 continue\no2 endwhile\n\
             o1 endwhile\nG0 X3\n",
            3,
        ),
    ] {
        let (commands, errors) = run(text);
        assert_eq!(errors, [""; 0], "{text}");
        assert_eq!(commands.len(), count, "{text}");
    }
}
