//! Any text as words, blocks and commands.

use husillo_gcode::{
    Block, Command, Commands, Compensation, Dialect, Error, Modal, Plane, Words, words,
};

/// Words, blocks and plans of any text, in every dialect.
///
/// - Words: in order, inside the line; printed and read again they are the same.
/// - Blocks: each is a part of its line, and an error has its columns inside it. The words of a
///   block, printed and parsed, give the same block: same values, and the same plan or error.
/// - Modal: planning on a copy and applying in place give the same state, commands or error. A
///   refused block leaves the state unchanged. A plan has as many commands as it reports.
/// - Cutter compensation: without it commands pass unchanged. With it every point is at least a
///   radius from its corner. A block releases at most a move, a corner and the waiting commands.
pub fn gcode(data: &[u8]) {
    for line in data.split(|byte| matches!(byte, b'\n' | b'\r')) {
        check_words(line);
    }
    for dialect in Dialect::ALL {
        let mut states = States::new(dialect);
        for line in data.split(|byte| matches!(byte, b'\n' | b'\r')) {
            for (at, text) in dialect.blocks(line) {
                assert_eq!(
                    line.get(at..at + text.len()),
                    Some(text),
                    "a block is a part of its line"
                );
                states.take(text);
            }
        }
    }
}

/// Cycles make up to 2^21 moves. Only the first ones are compared, and they are counted in one
/// dialect.
const MANY: usize = 300;

/// The same program read in two ways.
struct States {
    aside: Modal<3>,
    in_place: Modal<3>,
    block: Block,
    commands: Commands<3>,
    contour: Contour,
}

impl States {
    fn new(dialect: Dialect) -> States {
        let aside = Modal::new(dialect);
        States {
            in_place: aside.clone(),
            block: Block::new(),
            commands: Commands::new(),
            contour: Contour::new(&aside),
            aside,
        }
    }

    fn take(&mut self, text: &[u8]) {
        let dialect = *self.aside.dialect();
        let parsed = Block::parse(text, &dialect);
        check_printed(text, &parsed, &self.aside);
        let planned = parsed.and_then(|block| self.aside.plan(&block));
        self.commands.clear();
        let applied = self
            .block
            .read(text, &dialect)
            .and_then(|()| self.in_place.apply(&self.block, &mut self.commands));
        match planned {
            Ok((next, commands)) => {
                assert_eq!(applied, Ok(()));
                assert!(
                    commands
                        .clone()
                        .take(MANY)
                        .eq(self.commands.by_ref().take(MANY)),
                    "commands in place"
                );
                if commands.clone().take(MANY).count() < MANY {
                    check_count(&commands);
                    if !self.contour.take(&self.aside, &next, commands) {
                        // A block that the stage refuses is refused as a whole.
                        self.in_place = self.aside.clone();
                        return;
                    }
                } else {
                    if dialect == Dialect::RS274 {
                        check_count(&commands);
                    }
                    self.contour = Contour::new(&next);
                }
                self.aside = next;
            }
            Err(error) => {
                assert_eq!(applied, Err(error));
                check_place(&error, text);
            }
        }
        assert!(
            self.aside == self.in_place,
            "states in place, also behind an error"
        );
    }
}

fn check_count(commands: &Commands<3>) {
    let (least, most) = commands.size_hint();
    let count = commands.clone().count();
    assert!(
        least <= count && most.is_none_or(|most| count <= most) && count <= 1 << 21,
        "{count} of {least} to {most:?} commands"
    );
}

fn check_words(line: &[u8]) {
    let (mut end, mut printed, mut values) = (0, String::new(), Vec::new());
    for word in words(line) {
        match word {
            Ok(word) => {
                assert!(
                    end <= word.at && word.at < word.end && word.end <= line.len(),
                    "words in order"
                );
                let is_polar = matches!(word.letter, b'@' | b'^');
                assert!(
                    word.letter.is_ascii_uppercase() || is_polar,
                    "letters are capitals, or signs of polar coordinates"
                );
                end = word.end;
                printed += &format!("{}{}", char::from(word.letter), word.value);
                values.push((word.letter, word.value));
            }
            Err(error) => check_place(&error, line),
        }
    }
    let again: Result<Vec<_>, _> = words(printed.as_bytes())
        .map(|word| word.map(|word| (word.letter, word.value)))
        .collect();
    assert_eq!(again, Ok(values), "{printed}");
}

/// The printed words of a block; `None` where there are none.
fn printed(mut words: Words<'_>) -> Option<String> {
    let mut text = String::new();
    for word in words.by_ref() {
        let word = word.ok()?;
        text += &format!("{}{} ", char::from(word.letter), word.value);
    }
    (!words.is_deleted()).then_some(text)
}

fn check_printed(text: &[u8], parsed: &Result<Block, Error>, modal: &Modal<3>) {
    let Some(printed) = printed(words(text)) else {
        return;
    };
    let dialect = modal.dialect();
    // For a printer a blank ends the number of some codes. Elsewhere it stands within a number.
    if *dialect == Dialect::PRINTER && has_blank_in_number(text) {
        return;
    }
    // The printed form may be longer than the original, and then too long for the buffer of a link.
    if dialect
        .buffer()
        .is_some_and(|most| text.len().max(printed.len()) >= usize::from(most))
    {
        return;
    }
    let again = Block::parse(printed.as_bytes(), dialect);
    let (parsed, again) = match (parsed, again) {
        (Ok(parsed), Ok(again)) => (parsed, again),
        (Err(error), Err(other)) => return assert_eq!(error.kind, other.kind, "{printed}"),
        (parsed, again) => panic!("{parsed:?} printed as {printed} is {again:?}"),
    };
    for letter in b'A'..=b'Z' {
        assert_eq!(parsed.word(letter), again.word(letter), "{printed}");
    }
    assert_eq!(parsed.is_empty(), again.is_empty(), "{printed}");
    assert_eq!(parsed.is_deleted(), again.is_deleted(), "{printed}");
    match (modal.plan(parsed), modal.plan(&again)) {
        (Ok((next, commands)), Ok((other_next, other))) => {
            assert!(next == other_next, "{printed}");
            assert!(commands.take(MANY).eq(other.take(MANY)), "{printed}");
        }
        (Err(error), Err(other)) => assert_eq!(error.kind, other.kind, "{printed}"),
        (planned, other) => panic!("{planned:?} printed as {printed} is {other:?}"),
    }
}

fn has_blank_in_number(text: &[u8]) -> bool {
    let is_digit = |byte: &u8| byte.is_ascii_digit() || *byte == b'.';
    let mut words = text.split(|byte| matches!(byte, b' ' | b'\t'));
    let mut before = words.next().unwrap_or_default();
    words.filter(|word| !word.is_empty()).any(|word| {
        let is_split = before.last().is_some_and(is_digit) && word.first().is_some_and(is_digit);
        before = word;
        is_split
    })
}

fn check_place(error: &Error, text: &[u8]) {
    assert!(
        error.at <= error.end && error.end <= text.len(),
        "{error:?} in {} bytes",
        text.len()
    );
    assert!(!error.to_string().is_empty());
}

/// Whether a block moves along the plane.
fn moves_in(plane: Plane, before: &Modal<3>, after: &Modal<3>) -> bool {
    let (before, after) = (before.position(), after.position());
    plane.axes().iter().any(|&axis| before[axis] != after[axis])
}

/// The stage of cutter compensation, and its state as known from outside.
struct Contour {
    stage: Compensation<3>,
    /// Radius in nanometres and plane, while compensation is on.
    tool: Option<(i64, Plane)>,
    has_entered: bool,
    /// Largest deviation of the arcs of the contour in nm.
    slack: i64,
}

impl Contour {
    fn new(modal: &Modal<3>) -> Contour {
        Contour {
            stage: Compensation::new(modal.position()),
            tool: None,
            has_entered: false,
            slack: 0,
        }
    }

    /// Passes the commands of a block to the stage; returns whether it accepts them.
    fn take(&mut self, before: &Modal<3>, after: &Modal<3>, commands: Commands<3>) -> bool {
        let Ok((next, compensated)) = self.stage.plan(commands.clone()) else {
            return false;
        };
        let (mut count, mut switched) = (0, false);
        for command in commands.clone() {
            count += 1;
            match command {
                Command::Compensation {
                    side,
                    radius,
                    plane,
                } => {
                    self.tool = side.map(|_| (radius.0, plane));
                    (self.has_entered, self.slack, switched) = (false, 4, true);
                }
                Command::End { .. } => (self.tool, switched) = (None, true),
                Command::Arc { arc, .. } => self.slack = self.slack.max(4 + arc.mismatch.0),
                _ => {}
            }
        }
        assert!(
            compensated.clone().count() <= count * 9,
            "no more than a move, a corner and what waited"
        );
        match self.tool.filter(|(radius, _)| *radius != 0) {
            Some(tool) if !switched && count == 1 => {
                self.check(tool, before, after, compensated);
            }
            Some((_, plane)) => self.has_entered |= !switched && moves_in(plane, before, after),
            // The move after G40 starts at the position of the tool, and ends as programmed.
            None if !switched && !self.stage.is_active() => {
                assert!(
                    compensated.take(MANY).eq(commands.take(MANY)),
                    "nothing to compensate"
                );
            }
            None => {}
        }
        self.stage = next;
        true
    }

    /// Checks a block of one command under compensation.
    fn check(
        &mut self,
        (radius, plane): (i64, Plane),
        before: &Modal<3>,
        after: &Modal<3>,
        compensated: impl Iterator<Item = Command<3>>,
    ) {
        let corner = before.position();
        if self.has_entered {
            for end in compensated.filter_map(|command| command.end()) {
                let [x, y] = plane
                    .axes()
                    .map(|axis| (end[axis].0 - corner[axis].0) as f64);
                let least = (radius - self.slack) as f64;
                assert!(
                    x.hypot(y) >= least,
                    "{end:?} is nearer than {radius} to {corner:?}"
                );
            }
        }
        self.has_entered |= moves_in(plane, before, after);
    }
}
