//! The changes of tools in a program for Grbl, which has no code for them.

use husillo_gcode::words;

/// A change of the tool, before a line of the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ToolChange {
    /// The line that asks for it.
    pub line: usize,
    /// The tool that was selected last (`T`).
    pub tool: Option<i64>,
    /// The comment of that line.
    pub note: String,
}

impl ToolChange {
    /// What the operator has to do.
    pub fn said(&self) -> String {
        let tool = self.tool.map_or(String::new(), |tool| format!(" T{tool}"));
        let note = match self.note.is_empty() {
            true => String::new(),
            false => format!(" ({})", self.note),
        };
        format!("change the tool: put in{tool}{note}, measure its length, then go on")
    }
}

/// The changes of a program, and its text without the codes that ask for them: M6, or M0 after
/// another `T` in a program without M6.
#[derive(Debug, Default)]
pub struct ToolChanges {
    /// In the order of their lines.
    pub all: Vec<ToolChange>,
    /// The text without them. Each byte keeps its place. `None`: there are none.
    pub text: Option<Vec<u8>>,
}

/// A code that may ask for a change.
struct Code {
    is_change: bool,
    /// Its first and last byte in the text.
    at: [usize; 2],
    change: ToolChange,
}

impl ToolChanges {
    /// Those of a program.
    pub fn of(text: &[u8]) -> Self {
        let mut codes = codes(text);
        let has_change = codes.iter().any(|code| code.is_change);
        let mut last = None;
        codes.retain(|code| match has_change {
            true => code.is_change,
            // A stop is a change only if another tool was selected.
            false => code.change.tool != std::mem::replace(&mut last, code.change.tool),
        });
        if codes.is_empty() {
            return Self::default();
        }
        let mut text = text.to_vec();
        for [from, to] in codes.iter().map(|code| code.at) {
            if let Some(code) = text.get_mut(from..to) {
                code.fill(b' ');
            }
        }
        Self {
            all: codes.into_iter().map(|code| code.change).collect(),
            text: Some(text),
        }
    }
}

/// The codes M6 and M0 of a program, each with the tool that is selected there.
fn codes(text: &[u8]) -> Vec<Code> {
    let mut codes = Vec::new();
    let (mut tool, mut begin) = (None, 0);
    for (number, line) in (1..).zip(text.split(|byte| *byte == b'\n')) {
        let mut found: Option<Code> = None;
        // After a word that cannot be read the check refuses the program.
        for word in words(line).map_while(Result::ok) {
            let is = |value| word.value.whole() == Some(value);
            match word.letter {
                b'T' => tool = word.value.whole(),
                b'M' if is(6) || is(0) => {
                    found = Some(Code {
                        is_change: is(6),
                        at: [begin + word.at, begin + word.end],
                        change: ToolChange {
                            line: number,
                            tool: None,
                            note: note(line),
                        },
                    });
                }
                _ => {}
            }
        }
        if let Some(mut code) = found {
            // `T` takes effect before `M6`, whatever their order in the line.
            code.change.tool = tool;
            codes.push(code);
        }
        begin += line.len() + 1;
    }
    codes
}

/// The first comment of a line.
fn note(line: &[u8]) -> String {
    let line = String::from_utf8_lossy(line);
    let Some((_, rest)) = line.split_once(['(', ';']) else {
        return String::new();
    };
    let text = rest.split(')').next().unwrap_or_default();
    text.trim().chars().take(80).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changes(text: &str) -> Vec<(usize, Option<i64>, String)> {
        let all = ToolChanges::of(text.as_bytes()).all.into_iter();
        all.map(|one| (one.line, one.tool, one.note)).collect()
    }

    #[test]
    fn a_change_has_the_tool_that_was_selected() {
        let text = "T1 M6 (6 mm, flat)\nG1 X1 F100\nT2\nm06 t3 ; V bit\nM0\nG1 X2\n";
        let expected = [
            (1, Some(1), "6 mm, flat".to_owned()),
            (4, Some(3), "V bit".to_owned()),
        ];
        assert_eq!(changes(text), expected);
        let plain = ToolChanges::of(text.as_bytes()).text.unwrap();
        let plain = String::from_utf8(plain).unwrap();
        assert_eq!(
            plain,
            "T1    (6 mm, flat)\nG1 X1 F100\nT2\n    t3 ; V bit\nM0\nG1 X2\n"
        );
    }

    /// As programs for Grbl do, because M6 is an error there.
    #[test]
    fn a_stop_after_another_tool_is_a_change() {
        let text = "T1\nM0 (put in 1)\nG1 X1 F100\nM0\nT2 M0\nX3\n";
        let expected = [
            (2, Some(1), "put in 1".to_owned()),
            (5, Some(2), String::new()),
        ];
        assert_eq!(changes(text), expected);
    }

    #[test]
    fn other_programs_stay_as_they_are() {
        for text in ["G0 X1\nM0\nX2\n", "(M6)\nM60\nG1 X6 F6\n", "", "M2\r\n"] {
            let found = ToolChanges::of(text.as_bytes());
            assert!(found.all.is_empty() && found.text.is_none(), "{text}");
        }
    }
}
