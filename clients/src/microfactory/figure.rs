//! A figure: a list of moves in X and Z.

/// A figure with the name of its file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// The file, without its folder.
    pub name: String,
    /// Steps of X and Z.
    pub moves: Vec<[i16; 2]>,
}

impl Figure {
    /// The figure as a list of moves that the user can edit.
    pub fn text(&self) -> String {
        let lines = self.moves.iter().map(|[x, z]| format!("{x} {z}\n"));
        format!("; {}: X and Z in steps, a move a line\n", self.name) + &lines.collect::<String>()
    }
}

/// The moves of a list.
///
/// # Errors
/// The number of the first line that is no move, and the reason.
pub fn listed(text: &str) -> Result<Vec<[i16; 2]>, (usize, String)> {
    let mut moves = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let line = line.split(';').next().unwrap_or_default();
        let words: Vec<Option<i16>> = line
            .split_whitespace()
            .map(|word| word.parse().ok())
            .collect();
        match words[..] {
            [] | [Some(0), Some(0)] => {}
            [Some(x), Some(z)] => moves.push([x, z]),
            _ => {
                let reason =
                    "a move is two numbers of steps, of X and of Z, each from -32768 to 32767";
                return Err((number + 1, reason.into()));
            }
        }
    }
    Ok(moves)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_read_as_it_is_written() {
        let figure = Figure {
            name: "a".into(),
            moves: vec![[1000, 0], [-32768, 32767]],
        };
        assert_eq!(listed(&figure.text()), Ok(figure.moves));
        assert_eq!(listed("; a\n\n 5 -7 ; b\n0 0\n"), Ok(vec![[5, -7]]));
        for wrong in ["1", "1 2 3", "1 40000", "x 1"] {
            assert_eq!(
                listed(&format!("1 1\n{wrong}\n")).unwrap_err().0,
                2,
                "{wrong}"
            );
        }
    }
}
