//! The reports of the encoders in a run: axes that are behind, corrected, or stalled.

use crate::observers::AXES;
use crate::text::counted;
use husillo_machine::Followed;

/// The reports of the encoders.
#[derive(Clone, Debug, Default)]
pub struct EncoderReports {
    /// Axes that are behind and not yet corrected.
    pub behind: [bool; AXES],
    /// All reports as sentences.
    pub sentences: Vec<String>,
}

impl EncoderReports {
    /// Takes an entry. `events` is the number of step events before it, and `letters` are the
    /// letters of the axes.
    #[cold]
    pub fn add(&mut self, entry: &Followed<AXES>, letters: [char; AXES], events: u64) {
        let (axis, is_behind, what) = match *entry {
            Followed::Event(_) => return,
            Followed::Lost { axis, steps } => {
                (axis, true, format!("is {} behind", counted(steps, "step")))
            }
            Followed::Corrected { axis } => (axis, false, "is corrected".to_owned()),
            Followed::Stalled { axis, steps } => (
                axis,
                true,
                format!("is stalled, {} behind", counted(steps, "step")),
            ),
        };
        let letter = letters[axis];
        self.behind[axis] = is_behind;
        self.sentences.push(format!(
            "{letter} {what}, after {}",
            counted(events, "step event")
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_is_behind_until_it_is_corrected() {
        let mut reports = EncoderReports::default();
        let mut add = |entry| {
            reports.add(&entry, ['X', 'Y', 'Z', 'A', 'B', 'C'], 12);
            reports.behind
        };
        let lost = Followed::Lost { axis: 1, steps: 4 };
        assert_eq!(add(lost), [false, true, false, false, false, false]);
        assert_eq!(add(Followed::Corrected { axis: 1 }), [false; AXES]);
        let stalled = Followed::Stalled { axis: 0, steps: -9 };
        assert_eq!(add(stalled), [true, false, false, false, false, false]);
        let sentences = [
            "Y is 4 steps behind, after 12 step events",
            "Y is corrected, after 12 step events",
            "X is stalled, -9 steps behind, after 12 step events",
        ];
        assert_eq!(reports.sentences, sentences);
    }
}
