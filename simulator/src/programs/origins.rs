//! The lines that the moves of a checked program come from.

use crate::programs::explain::At;
use husillo_gcode::{Command, Nm};
use husillo_sim::observers::AXES;
use husillo_sim::observers::recording::MOST_MOVES;

/// Most commands between two moves of a run. They are moves of less than a step.
const MOST_LEFT_OUT: usize = 1000;

/// The lines of the commands that move, in their order.
#[derive(Debug, Default)]
pub struct Origins {
    /// Line, from 1 (0: in the file of a subroutine), and what its end hashes to.
    commands: Vec<(u32, u64)>,
}

impl Origins {
    /// Adds a command of the program `file`.
    pub fn add(&mut self, file: &str, at: &At<'_>, command: &Command<AXES>) {
        let Some(to) = command.end() else { return };
        if self.commands.len() < MOST_MOVES {
            let line = if at.file == file { at.line } else { 0 };
            self.commands
                .push((u32::try_from(line).unwrap_or(0), key(&to)));
        }
    }

    /// The line of each move. A run leaves out moves of less than a step. Moves that the check did
    /// not foresee have line 0: those that depend on a contact.
    pub fn lines<'m>(&self, ends: impl Iterator<Item = &'m [i64; AXES]>) -> Vec<u32> {
        let mut next = 0;
        ends.map(|to| self.line(&mut next, &to.map(Nm))).collect()
    }

    /// The same, one move after the other.
    pub const fn into_lines(self) -> Lines {
        Lines {
            origins: self,
            next: 0,
        }
    }

    /// The line of a move to `to`. It is searched from number `next` on.
    fn line(&self, next: &mut usize, to: &[Nm; AXES]) -> u32 {
        let wanted = key(to);
        let mut ahead = self.commands.iter().skip(*next).take(MOST_LEFT_OUT);
        let Some(distance) = ahead.position(|(_, key)| *key == wanted) else {
            return 0;
        };
        *next += distance + 1;
        self.commands[*next - 1].0
    }
}

/// The lines of the moves of a run, asked for in their order.
#[derive(Debug, Default)]
pub struct Lines {
    origins: Origins,
    next: usize,
}

impl Lines {
    /// The line of the next move, which ends at `to`; 0 as in [`Origins::lines`].
    pub fn line(&mut self, to: &[Nm; AXES]) -> u32 {
        self.origins.line(&mut self.next, to)
    }
}

/// A product and a rotation for each axis: every command has a key, and neighbours have others.
fn key(to: &[Nm; AXES]) -> u64 {
    to.iter().fold(0, |key: u64, Nm(nm)| {
        (key.rotate_left(5) ^ *nm as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use husillo_gcode::Dialect;

    #[test]
    fn moves_find_their_lines_over_gaps() {
        let mut origins = Origins::default();
        let at = |line| At {
            file: "p",
            line,
            bytes: b"",
            block: 0,
            length: 0,
            dialect: Dialect::RS274,
        };
        let end = |x: i64| [x, 0, 0, 0, 0, 0];
        for (line, x) in [(1, 10), (2, 10), (4, 11), (5, 10), (6, 30)] {
            origins.add("p", &at(line), &Command::Rapid { to: end(x).map(Nm) });
        }
        origins.add("p", &at(7), &Command::Dwell { micros: 1 });
        origins.add(
            "o",
            &at(3),
            &Command::Rapid {
                to: end(40).map(Nm),
            },
        );
        let run = [10, 11, 99, 10, 30, 40].map(end);
        assert_eq!(origins.lines(run.iter()), [1, 4, 0, 5, 6, 0]);
        let mut lines = origins.into_lines();
        assert_eq!(run.map(|to| lines.line(&to.map(Nm))), [1, 4, 0, 5, 6, 0]);
    }
}
