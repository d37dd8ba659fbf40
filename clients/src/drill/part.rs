//! The holes of one tool.

use husillo_gcode::Nm;
use husillo_transports::drill::{Record, record_bytes};

/// Records for one tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Number of the tool; 0 if it has none.
    pub tool: u32,
    /// Its diameter, if known.
    pub diameter: Option<Nm>,
    /// The moves and drillings.
    pub records: Vec<Record>,
}

/// A drilling of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stop {
    /// Steps of X and Y.
    pub at: [u16; 2],
    /// Depth in steps below the upper sensor; 0 is the full stroke.
    pub depth: u16,
}

impl Part {
    /// The number of holes. A drilling that deepens the hole before it does not count.
    pub fn holes(&self) -> usize {
        self.pecks().filter(|is_peck| !is_peck).count()
    }

    /// For each drilling: whether it deepens the hole of the drilling before it.
    pub fn pecks(&self) -> impl Iterator<Item = bool> {
        let mut before: Option<u16> = None;
        self.records.iter().filter_map(move |record| {
            let Record::Drill(depth) = *record else {
                before = None;
                return None;
            };
            let is_peck = before.is_some_and(|before| before > 0 && (depth == 0 || depth > before));
            before = Some(depth);
            Some(is_peck)
        })
    }

    /// The holes in their order, from home, each with its last drilling.
    pub fn places(&self) -> impl Iterator<Item = Stop> {
        let next = self.pecks().skip(1).chain([false]);
        let stops = self.stops().zip(next);
        stops.filter_map(|(stop, goes_on)| (!goes_on).then_some(stop))
    }

    /// The drillings in their order, from home.
    pub fn stops(&self) -> impl Iterator<Item = Stop> {
        let mut at = [0; 2];
        self.records.iter().filter_map(move |record| {
            match *record {
                Record::X(x) => at[0] = x,
                Record::Y(y) => at[1] = y,
                Record::Drill(depth) => return Some(Stop { at, depth }),
            }
            None
        })
    }

    /// The part without its first holes. It begins at the position of the last of these.
    pub fn rest_behind(&self, holes: usize) -> Part {
        let (mut found, mut drillings) = (0, 0);
        for is_peck in self.pecks() {
            found += usize::from(!is_peck);
            if found > holes {
                break;
            }
            drillings += 1;
        }
        let (mut at, mut left, mut behind) = ([0; 2], drillings, 0);
        for record in &self.records {
            if left == 0 {
                break;
            }
            match *record {
                Record::X(x) => at[0] = x,
                Record::Y(y) => at[1] = y,
                Record::Drill(_) => left -= 1,
            }
            behind += 1;
        }
        let there = [Record::X(at[0]), Record::Y(at[1])];
        let there = there.iter().filter(|_| behind > 0);
        let rest = self.records.get(behind..).unwrap_or_default();
        Part {
            records: there.chain(rest).copied().collect(),
            ..*self
        }
    }

    /// The first holes, and their number. They are as many as this number of records holds, but at
    /// least one.
    pub fn first_holes(&self, most_records: usize) -> (Part, usize) {
        let mut pecks = self.pecks().skip(1);
        let (mut end, mut holes) = (self.records.len(), self.holes());
        let mut found = 0;
        for (place, record) in self.records.iter().enumerate() {
            // A hole ends at its last drilling.
            let is_end = matches!(record, Record::Drill(_)) && pecks.next() != Some(true);
            if !is_end {
                continue;
            }
            if found > 0 && place >= most_records {
                break;
            }
            found += 1;
            (end, holes) = (place + 1, found);
        }
        let records = self.records.get(..end).unwrap_or_default().to_vec();
        (Part { records, ..*self }, holes)
    }

    /// The bytes of its file.
    pub fn bytes(&self) -> Vec<u8> {
        record_bytes(self.records.iter().copied()).collect()
    }

    /// The name of the part, such as `T1 (0.8 mm)`.
    pub fn name(&self) -> String {
        match self.diameter {
            None if self.tool == 0 => "the program".into(),
            Some(diameter) => format!("T{} ({diameter} mm)", self.tool),
            None => format!("T{}", self.tool),
        }
    }
}

/// The same records from home, without moves of length zero. Each of these moves costs three bytes
/// on a slow line.
pub fn lean(records: &[Record]) -> Vec<Record> {
    let mut at = [0; 2];
    let moves = |record: &&Record| match **record {
        Record::X(x) => std::mem::replace(&mut at[0], x) != x,
        Record::Y(y) => std::mem::replace(&mut at[1], y) != y,
        Record::Drill(_) => true,
    };
    records.iter().filter(moves).copied().collect()
}

/// A position in steps as a length, to the nanometre.
pub fn millimetres(steps: u16) -> Nm {
    let scaled = i64::from(steps) * 1_000_000;
    let per_mm = i64::from(husillo_transports::drill::STEPS_PER_MM);
    Nm((scaled + per_mm / 2) / per_mm)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_of_a_part_drills_the_rest_of_its_holes() {
        let part = Part {
            tool: 3,
            diameter: None,
            records: vec![
                Record::X(10),
                Record::Y(20),
                Record::Drill(0),
                Record::X(30),
                Record::Drill(5),
                Record::Drill(9),
                Record::Y(7),
                Record::Drill(0),
            ],
        };
        let all: Vec<_> = part.stops().collect();
        // The second hole is deepened by a peck.
        assert_eq!((all.len(), part.holes()), (4, 3));
        for (hole, behind) in [0, 1, 3, 4].into_iter().enumerate() {
            let rest: Vec<_> = part.rest_behind(hole).stops().collect();
            assert_eq!(rest, all[behind..], "{hole}");
        }
        let places: Vec<_> = part.places().collect();
        assert_eq!(places, [all[0], all[2], all[3]]);
    }

    /// The pieces together have the holes of the part, with all their drillings.
    #[test]
    fn a_part_is_cut_between_holes() {
        let depths = |place: u16| {
            if place.is_multiple_of(3) {
                vec![4, 9, 0]
            } else {
                vec![0]
            }
        };
        let records = (0..50).flat_map(|place| {
            let drillings = depths(place).into_iter().map(Record::Drill);
            [Record::X(place), Record::Y(place)]
                .into_iter()
                .chain(drillings)
        });
        let part = Part {
            tool: 1,
            diameter: None,
            records: records.collect(),
        };
        for most in [0, 1, 4, 5, 6, 17, 100, 1000] {
            let (mut done, mut stops) = (0, Vec::new());
            while done < part.holes() {
                let rest = part.rest_behind(done);
                let (piece, holes) = rest.first_holes(most);
                assert!(holes > 0 && piece.holes() == holes);
                assert!(piece.records.len() <= most || holes == 1, "{most}");
                stops.extend(piece.stops());
                done += holes;
            }
            assert_eq!(
                (done, stops),
                (part.holes(), part.stops().collect()),
                "{most}"
            );
        }
    }

    #[test]
    fn a_hole_that_is_drilled_twice_is_two() {
        let holes = |depths: &[u16]| {
            let records = depths.iter().map(|depth| Record::Drill(*depth)).collect();
            let part = Part {
                tool: 0,
                diameter: None,
                records,
            };
            part.holes()
        };
        assert_eq!(holes(&[0, 0]), 2);
        assert_eq!(holes(&[100, 100]), 2);
        assert_eq!(holes(&[100, 200, 300, 0]), 1);
        assert_eq!(holes(&[100, 200, 100]), 2);
    }
}
