//! Columns of whole numbers: each number as its difference from the one before, in as few bytes
//! as it needs.

/// Columns, one after the other.
#[derive(Debug, Default)]
pub struct Columns {
    /// Name and count of each column.
    names: Vec<(String, usize)>,
    bytes: Vec<u8>,
}

impl Columns {
    /// Adds a column.
    pub fn add(&mut self, name: impl Into<String>, values: impl Iterator<Item = i64>) {
        let (mut last, mut count) = (0_i64, 0);
        for value in values {
            self.number(value.wrapping_sub(last));
            last = value;
            count += 1;
        }
        self.names.push((name.into(), count));
    }

    /// Name and count of each column.
    pub fn names(&self) -> &[(String, usize)] {
        &self.names
    }

    /// Their numbers.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Small numbers of both signs become small numbers, then seven bits per byte.
    fn number(&mut self, value: i64) {
        let mut rest = ((value << 1) ^ (value >> 63)) as u64;
        while rest > 0x7f {
            self.bytes.push(rest as u8 | 0x80);
            rest >>= 7;
        }
        self.bytes.push(rest as u8);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_take_few_bytes() {
        let mut columns = Columns::default();
        columns.add("a", [5, 5, 4, -60, 140_000].into_iter());
        columns.add("b", std::iter::empty());
        let names = columns
            .names()
            .iter()
            .map(|(name, count)| (name.as_str(), *count));
        assert!(names.eq([("a", 5), ("b", 0)]));
        assert_eq!(columns.bytes(), [10, 0, 1, 0x7f, 0xb8, 0x8c, 0x11]);
    }
}
