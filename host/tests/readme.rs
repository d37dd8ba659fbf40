//! The sessions of `host/README.md` and of its pages are what the program prints.

mod common;

use common::{husillo, printed};

/// A command line of a page, and the lines it shows below it.
struct Shown<'a> {
    command: String,
    lines: Vec<&'a str>,
}

fn shown(text: &str) -> Vec<Shown<'_>> {
    let mut all: Vec<Shown<'_>> = Vec::new();
    let mut is_session = false;
    let mut text_lines = text.lines();
    while let Some(line) = text_lines.next() {
        if line.starts_with("```") {
            is_session = false;
        } else if let Some(command) = line.strip_prefix("$ husillo ") {
            is_session = true;
            let mut command = command.to_owned();
            // A backslash continues the command on the next line.
            while command.ends_with('\\') {
                command.pop();
                command += text_lines.next().unwrap_or_default();
            }
            let lines = Vec::new();
            all.push(Shown { command, lines });
        } else if let (true, Some(last)) = (is_session, all.last_mut()) {
            last.lines.push(line);
        }
    }
    all
}

/// Words, quotation marks keeping some together.
fn words(command: &str) -> Vec<String> {
    let mut words = Vec::new();
    for (index, part) in command.split('"').enumerate() {
        if index % 2 == 1 {
            words.push(part.to_owned());
        } else {
            words.extend(part.split_whitespace().map(str::to_owned));
        }
    }
    words
}

/// Whether a line is as it is shown: numbers to two counts of 2 um, or one of a machine in counts.
fn is_same(shown: &str, printed: &str) -> bool {
    let (shown, printed) = (shown.split_whitespace(), printed.split_whitespace());
    let is_number = |(shown, printed): (&str, &str)| {
        let most = if shown.contains('.') { 0.0045 } else { 1.0 };
        let numbers = shown.parse::<f64>().ok().zip(printed.parse::<f64>().ok());
        shown == printed || numbers.is_some_and(|(a, b)| (a - b).abs() <= most)
    };
    shown.clone().count() == printed.clone().count() && shown.zip(printed).all(is_number)
}

#[test]
fn every_session_is_what_is_printed() {
    let package = env!("CARGO_MANIFEST_DIR");
    let pages = std::fs::read_dir("docs").unwrap();
    let pages = pages.map(|page| page.unwrap().path());
    let texts: Vec<_> = pages
        .chain(["README.md".into()])
        .map(|page| std::fs::read_to_string(page).unwrap())
        .collect();
    let all: Vec<_> = texts.iter().flat_map(|text| shown(text)).collect();
    assert!(all.len() >= 8);
    for Shown { command, lines } in all {
        let words = words(&command).into_iter();
        let examples = format!("{package}/../examples/");
        let words = words.map(|word| match word.strip_prefix("examples/") {
            Some(example) => format!("{examples}{example}"),
            None => word,
        });
        let mut program = husillo();
        program.args(words).current_dir(env!("CARGO_TARGET_TMPDIR"));
        let output = program.output().unwrap();
        let text = [output.stdout, output.stderr].concat();
        let text = String::from_utf8(text)
            .unwrap()
            .replace(&examples, "examples/");
        // `...` stands for any lines.
        let mut printed = text.lines();
        let mut is_gap = false;
        for line in lines {
            if line == "..." {
                is_gap = true;
                continue;
            }
            let found = match is_gap {
                true => printed.any(|printed| is_same(line, printed)),
                false => printed.next().is_some_and(|printed| is_same(line, printed)),
            };
            assert!(found, "{command}: `{line}` in\n{text}");
            is_gap = false;
        }
        assert!(is_gap || printed.next().is_none(), "{command}:\n{text}");
    }
}

/// The names that a help text lists under a heading, without `help`.
fn listed(help: &str) -> Vec<String> {
    let lines = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let rows = lines.take_while(|line| !line.is_empty());
    let names = rows.filter_map(|row| {
        let name = row.strip_prefix("  ")?;
        (!name.starts_with(' ')).then(|| name.split(' ').next().unwrap().to_owned())
    });
    names.filter(|name| name != "help").collect()
}

/// Every command, with those below it, and its help.
fn commands() -> Vec<(String, String)> {
    let help = |words: &str| {
        let words: Vec<_> = words.split(' ').filter(|word| !word.is_empty()).collect();
        printed(&[&words[..], &["--help"]].concat())
    };
    let mut all = Vec::new();
    for name in listed(&help("")) {
        let text = help(&name);
        for below in listed(&text) {
            let name = format!("{name} {below}");
            all.push((name.clone(), help(&name)));
        }
        all.push((name, text));
    }
    all
}

/// The README, and the pages of the program.
fn pages() -> [String; 2] {
    let readme = std::fs::read_to_string("../README.md").unwrap();
    let pages = std::fs::read_dir("docs").unwrap();
    let pages = pages.map(|page| page.unwrap().path());
    let own = pages.chain(["README.md".into()]);
    [
        readme,
        own.map(|page| std::fs::read_to_string(page).unwrap())
            .collect(),
    ]
}

#[test]
fn the_tables_have_every_command() {
    let [readme, own] = pages();
    let table: String = readme
        .lines()
        .filter(|line| line.starts_with("| `husillo "))
        .map(|line| format!("{line}\n"))
        .collect();
    let commands = commands();
    assert!(commands.len() > 25, "{}", commands.len());
    let mut missing = Vec::new();
    for (name, _) in &commands {
        let is_there = match name.split_once(' ') {
            None => {
                table.contains(&format!("`husillo {name}")) && own.contains(&format!("{name}`"))
                    || table.contains(&format!("`husillo {name}"))
                        && own.contains(&format!("husillo {name}"))
            }
            // A row names the commands below its own by their last word.
            Some((above, below)) => {
                table
                    .lines()
                    .filter(|row| row.contains(&format!("`husillo {above}")))
                    .any(|row| row.contains(below) || row.contains("KIND") || row.contains("..."))
                    && own.contains(&format!("{above} {below}"))
            }
        };
        if !is_there {
            missing.push(name);
        }
    }
    assert!(
        missing.is_empty(),
        "missing in a table or a page: {missing:?}"
    );
}

/// A command line in a text names a command that there is, and options that it has.
#[test]
fn the_pages_have_no_other_command() {
    let commands = commands();
    let mut wrong = Vec::new();
    for page in pages() {
        let page = page.replace('\n', " ");
        for span in page.split('`').skip(1).step_by(2) {
            let Some(line) = span.strip_prefix("husillo ") else {
                continue;
            };
            let first = line.split([' ', ',']).next().unwrap_or_default();
            let own: Vec<_> = commands
                .iter()
                .filter(|(name, _)| name.split(' ').next() == Some(first))
                .collect();
            if own.is_empty() && !first.starts_with('-') && first != "COMMAND" {
                wrong.push(line.to_owned());
            }
            let options = line
                .split_whitespace()
                .filter(|word| word.starts_with("--"));
            let options = options.map(|word| word.split('=').next().unwrap_or(word));
            for option in options.filter(|_| !own.is_empty()) {
                if !own.iter().any(|(_, help)| help.contains(option)) {
                    wrong.push(format!("{line}: {option}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The help of every command says what its exit statuses mean.
#[test]
fn the_help_has_exit_statuses() {
    for (name, help) in commands() {
        assert!(help.contains("Exit status: 0 "), "{name}: {help}");
        assert!(help.contains("2 bad command line or file"), "{name}");
    }
}
