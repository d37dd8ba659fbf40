//! Mutations of a program by words and lines; those of libFuzzer are by bytes.

/// Numbers at limits: of digits, places, ranges.
const NUMBERS: [&str; 16] = [
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "0.5",
    ".1",
    "9",
    "10",
    "90",
    "-90",
    "360",
    "1125899.906842624",
    "9223372036854775807",
    "0.000000000000000001",
    "99999",
];

/// Mutates the text `data[..size]`: a few words or lines are deleted, doubled, swapped, moved,
/// taken from `dictionary`, or get another number. Returns the new length, at most `most`. The same
/// `seed` gives the same result.
pub fn mutate(data: &mut [u8], size: usize, most: usize, seed: u32, dictionary: &str) -> usize {
    let mut chance = Chance(u64::from(seed) << 1 | 1);
    let mut pieces = pieces(&data[..size], chance.below(4) == 0);
    let known: Vec<&str> = dictionary.lines().filter_map(entry).collect();
    for _ in 0..=chance.below(3) {
        let (from, to) = (chance.below(pieces.len()), chance.below(pieces.len() + 1));
        match chance.below(7) {
            0 if pieces.len() > 1 => {
                pieces.remove(from);
            }
            1 if from < pieces.len() => pieces.insert(to, pieces[from].clone()),
            2 if to < pieces.len() => pieces.swap(from, to),
            3 if from < pieces.len() => {
                let piece = pieces.remove(from);
                pieces.insert(to.min(pieces.len()), piece);
            }
            4 if from < pieces.len() => {
                let number = NUMBERS[chance.below(NUMBERS.len())];
                let letter = pieces[from].first().copied();
                pieces[from] = letter.into_iter().chain(number.bytes()).collect();
            }
            _ if !known.is_empty() => {
                let word = known[chance.below(known.len())];
                pieces.insert(to, word.as_bytes().to_vec());
            }
            _ => pieces.insert(to, b"\n".to_vec()),
        }
    }
    let text = pieces.concat();
    let length = text.len().min(most).min(data.len());
    data[..length].copy_from_slice(&text[..length]);
    length
}

/// The text of a line of a dictionary: the part between its quotes. Entries with escapes are left
/// to libFuzzer.
fn entry(line: &str) -> Option<&str> {
    let text = line.strip_prefix('"')?.strip_suffix('"')?;
    (!text.contains('\\')).then_some(text)
}

/// The lines of a text with their ends, or its words: a letter, sign or line end with the text
/// after it. Consecutive letters are one word.
fn pieces(text: &[u8], lines: bool) -> Vec<Vec<u8>> {
    let mut pieces: Vec<Vec<u8>> = Vec::new();
    let mut last = b'\n';
    for &byte in text {
        let begins = if lines {
            last == b'\n'
        } else {
            match byte {
                b'0'..=b'9' | b'.' | b' ' | b'>' => false,
                letter if letter.is_ascii_alphabetic() => !last.is_ascii_alphabetic(),
                _ => true,
            }
        };
        match pieces.last_mut() {
            Some(piece) if !begins => piece.push(byte),
            _ => pieces.push(vec![byte]),
        }
        last = byte;
    }
    pieces
}

/// Pseudo-random numbers (xorshift; the state is never zero).
struct Chance(u64);

impl Chance {
    /// A number below `end`; 0 for an `end` of 0.
    fn below(&mut self, end: usize) -> usize {
        // The first values for small seeds are small, so two rounds are used.
        for _ in 0..2 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
        }
        (self.0 >> 20) as usize % end.max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_fall_into_words_or_lines() {
        let text = b"G1 X-1.5\no<a> call [#2]";
        let found = |lines| -> Vec<String> {
            pieces(text, lines)
                .iter()
                .map(|piece| String::from_utf8_lossy(piece).into_owned())
                .collect()
        };
        assert_eq!(found(true), ["G1 X-1.5\n", "o<a> call [#2]"]);
        assert_eq!(found(false).concat().as_bytes(), text);
        assert_eq!(found(false)[..3], ["G1 ", "X", "-1.5"]);
    }

    #[test]
    fn every_change_fits() {
        for seed in 0..2000 {
            let mut data = *b"G1 X1 Y2\nG2 I3\n______";
            let most = seed as usize % 21;
            let length = mutate(&mut data, 15, most, seed, "\"G81\"\n# no\n\"\\x0a\"");
            assert!(length <= most);
        }
        assert!(mutate(&mut [0; 8], 0, 8, 3, "") <= 8);
    }
}
