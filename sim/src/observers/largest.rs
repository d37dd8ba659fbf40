//! The largest value in each interval of time. Memory is fixed: the intervals grow with the time.

/// Number of columns: one or two per pixel of a chart.
const COLUMNS: usize = 2048;

/// Largest values over time.
#[derive(Clone, Debug)]
pub struct Largest {
    columns: Vec<f32>,
    column_ticks: u64,
    used: usize,
}

impl Default for Largest {
    /// No values.
    fn default() -> Self {
        Self {
            columns: vec![0.0; COLUMNS],
            column_ticks: 1,
            used: 0,
        }
    }
}

impl Largest {
    /// Takes a value of at least 0, at this time.
    #[inline]
    pub fn take(&mut self, ticks: u64, value: f32) {
        while ticks >= self.column_ticks * COLUMNS as u64 {
            self.fold();
        }
        let column = (ticks / self.column_ticks) as usize;
        self.used = self.used.max(column + 1);
        if let Some(largest) = self.columns.get_mut(column) {
            *largest = largest.max(value);
        }
    }

    /// The columns so far, 0 where there was no value, and the ticks per column.
    pub fn columns(&self) -> (&[f32], u64) {
        (&self.columns[..self.used], self.column_ticks)
    }

    /// Merges pairs of columns, which frees half of them.
    #[cold]
    fn fold(&mut self) {
        for index in 0..COLUMNS / 2 {
            self.columns[index] = self.columns[2 * index].max(self.columns[2 * index + 1]);
        }
        self.columns[COLUMNS / 2..].fill(0.0);
        self.column_ticks *= 2;
        self.used = self.used.div_ceil(2);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_of_each_interval_is_kept() {
        let mut largest = Largest::default();
        for ticks in 0..1_000_000_u64 {
            largest.take(ticks, (ticks % 1000) as f32);
        }
        let (columns, ticks) = largest.columns();
        assert_eq!((columns.len(), ticks), (1954, 512));
        assert!(columns.iter().all(|value| (487.0..=999.0).contains(value)));
    }
}
