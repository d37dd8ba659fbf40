//! Step and repeat of drill files: copies of the holes of a pattern.

use husillo_excellon::{Feature, Hole, Pattern, Repeat, Slot};

/// The pattern that is being copied.
#[derive(Debug, Default)]
pub struct Panel {
    /// Number of holes and slots before the pattern.
    before: [usize; 2],
    /// How many there are with it.
    with: [usize; 2],
    /// From the pattern to its last copy.
    by_nm: [i64; 2],
}

/// Why a copy cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refused {
    /// It would be out of reach.
    Reach,
    /// Too many holes and slots.
    Many,
}

impl Panel {
    /// Carries out a line, with room for `most` holes and slots.
    ///
    /// # Errors
    ///
    /// See [`Refused`]. The copies before the refused one are made.
    pub fn take(
        &mut self,
        pattern: &Pattern,
        holes: &mut Vec<Hole>,
        slots: &mut Vec<Slot>,
        most: usize,
    ) -> Result<(), Refused> {
        match pattern {
            Pattern::Begin => self.before = [holes.len(), slots.len()],
            Pattern::EndOfSet => {
                self.with = [holes.len(), slots.len()];
                self.by_nm = [0; 2];
            }
            Pattern::Repeat(repeat) => {
                for _ in 0..repeat.count {
                    self.copy(repeat, holes, slots, most)?;
                }
            }
            Pattern::End => {}
        }
        Ok(())
    }

    fn copy(
        &mut self,
        repeat: &Repeat,
        holes: &mut Vec<Hole>,
        slots: &mut Vec<Slot>,
        most: usize,
    ) -> Result<(), Refused> {
        for (by, step) in self.by_nm.iter_mut().zip(repeat.step_nm) {
            *by = by.checked_add(step).ok_or(Refused::Reach)?;
        }
        let [hole_range, slot_range] = [0, 1].map(|kind: usize| self.before[kind]..self.with[kind]);
        if holes.len() + slots.len() + hole_range.len() + slot_range.len() > most {
            return Err(Refused::Many);
        }
        for index in hole_range {
            match repeat.copy(&Feature::Hole(holes[index]), self.by_nm) {
                Some(Feature::Hole(hole)) => holes.push(hole),
                _ => return Err(Refused::Reach),
            }
        }
        for index in slot_range {
            match repeat.copy(&Feature::Slot(slots[index]), self.by_nm) {
                Some(Feature::Slot(slot)) => slots.push(slot),
                _ => return Err(Refused::Reach),
            }
        }
        Ok(())
    }
}
