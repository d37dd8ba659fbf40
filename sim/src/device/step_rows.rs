//! Step events of an emulated device as rows of CSV.

use std::fmt::Write;

/// Rows not yet taken.
#[derive(Debug)]
pub struct StepRows {
    text: String,
    events: u64,
}

impl StepRows {
    /// Creates a table without rows. `columns` are the columns after the number of the step event,
    /// its time and its wait: the steps of the motors, then the states.
    pub fn new(columns: &str) -> Self {
        Self {
            text: format!("event,t_us,wait_ticks,{columns}\n"),
            events: 0,
        }
    }

    /// Appends a row: at `t_us`, after the wait, each motor steps by -1, 0 or 1, and the states
    /// begin to hold. A row without steps has the number of the previous step event. If more time
    /// than the wait has passed since the previous row, the device stood still in between.
    pub fn push(&mut self, t_us: u64, wait_ticks: u32, delta: &[i8], states: &[u8]) {
        self.events += u64::from(delta.iter().any(|step| *step != 0));
        let text = &mut self.text;
        // Writing to a string does not fail.
        let _ = write!(text, "{},{t_us},{wait_ticks}", self.events);
        for step in delta {
            let _ = write!(text, ",{step}");
        }
        for state in states {
            let _ = write!(text, ",{state}");
        }
        text.push('\n');
    }

    /// Returns the rows since the last call. The first call also returns the heading.
    pub fn take(&mut self) -> String {
        std::mem::take(&mut self.text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_numbered_by_steps() {
        let mut rows = StepRows::new("dx,dy,on");
        rows.push(5, 0, &[0, 0], &[1]);
        rows.push(15, 10, &[1, 0], &[1]);
        assert_eq!(
            rows.take(),
            "event,t_us,wait_ticks,dx,dy,on\n0,5,0,0,0,1\n1,15,10,1,0,1\n"
        );
        rows.push(22, 7, &[0, 0], &[1]);
        rows.push(31, 9, &[-1, 1], &[0]);
        assert_eq!(rows.take(), "1,22,7,0,0,1\n2,31,9,-1,1,0\n");
        assert_eq!(rows.take(), "");
    }
}
