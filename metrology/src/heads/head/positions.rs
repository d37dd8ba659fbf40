//! Conversion of the counts of the axes to positions, and back.

use super::Head;
use crate::error::Error;
use crate::heads::port::Port;
use crate::heads::servo::Servo;
use husillo_probe::UnitVector;
use husillo_transports::nmc::Reply;

impl<P: Port> Head<P> {
    /// The commanded position.
    pub fn held(&self) -> [i64; 3] {
        self.place(|_, axis| axis.held)
    }

    /// The position in these replies.
    pub fn place_of(&self, replies: &[Reply]) -> [i64; 3] {
        self.place(|index, _| replies[index].readings.position)
    }

    /// The position at these counts, one per axis.
    pub(crate) fn place_at(&self, counts: &[i32]) -> [i64; 3] {
        self.place(|index, _| counts[index])
    }

    /// The latched position in these replies, at which the axes found the event of their search.
    pub fn latched(&self, replies: &[Reply]) -> [i64; 3] {
        self.place(|index, _| replies[index].readings.home)
    }

    /// Readings of all axes as text.
    pub fn text(&self, readings: [i64; 3]) -> String {
        let place = self.view.position(readings);
        let numbers = self.axes.iter().map(|axis| {
            let position = place[axis.settings.coordinate()];
            match self.axes.len() {
                1 => self.scale.text(position),
                _ => format!("{} {}", axis.settings.letter, self.scale.text(position)),
            }
        });
        numbers.collect::<Vec<_>>().join(", ")
    }

    /// The position of an axis at these counts as text, such as `X 1200 counts`. The other axes are
    /// at their held positions.
    pub(crate) fn axis_text(&self, index: usize, counts: i32) -> String {
        let axis = &self.axes[index];
        let text = self.scale.text(self.seen(index, self.held(), counts));
        format!("{} {text}", axis.settings.letter)
    }

    /// The position of an axis at these counts. The other axes are at these readings.
    fn seen(&self, index: usize, mut readings: [i64; 3], counts: i32) -> i64 {
        let axis = &self.axes[index];
        let coordinate = axis.settings.coordinate();
        readings[coordinate] = axis.position(self.scale, counts);
        self.view.position(readings)[coordinate]
    }

    fn place(&self, counts: impl Fn(usize, &Servo) -> i32) -> [i64; 3] {
        let mut place = [0; 3];
        for (index, axis) in self.axes.iter().enumerate() {
            place[axis.settings.coordinate()] = axis.position(self.scale, counts(index, axis));
        }
        place
    }

    /// Counts of a position, one per axis.
    ///
    /// # Errors
    ///
    /// A coordinate is not 0, and the machine does not have its axis.
    pub(crate) fn counts(&self, place: [i64; 3]) -> Result<Vec<i32>, Error> {
        for (axis, position) in "XYZ".chars().zip(place) {
            if position != 0 && !self.axes.iter().any(|there| there.settings.letter == axis) {
                return Err(Error::NoAxis { axis });
            }
        }
        let of = |axis: &Servo| axis.counts(self.scale, place[axis.settings.coordinate()]);
        Ok(self.axes.iter().map(of).collect())
    }

    /// Checks that these counts are within the travel of all axes. `meant` has the readings from
    /// which the counts were computed.
    ///
    /// # Errors
    ///
    /// [`Error::OutsideTravel`] of the first axis whose counts are outside.
    pub(crate) fn check_travel(&self, goal: &[i32], meant: [i64; 3]) -> Result<(), Error> {
        for (index, (axis, goal)) in self.axes.iter().zip(goal).enumerate() {
            let [low, high] = axis.travel_counts();
            if !(low..=high).contains(goal) {
                let there = self.view.position(meant)[axis.settings.coordinate()];
                let text = |counts| self.scale.text(self.seen(index, meant, counts));
                return Err(Error::OutsideTravel {
                    goal: format!("{} {}", axis.settings.letter, self.scale.text(there)),
                    travel: axis.travel_counts().map(text),
                });
            }
        }
        Ok(())
    }

    /// Distance in a direction to the end of the travel, an amount of the scale.
    pub fn room(&self, direction: &UnitVector) -> u64 {
        let components = direction.components().map(|part| part.to_num::<f64>());
        let rooms = self.axes.iter().map(|axis| {
            let [low, high] = axis.travel(self.scale);
            let at = axis.position(self.scale, axis.held);
            // Travels are far below 2^53 nm, so the conversions are exact.
            match components[axis.settings.coordinate()] {
                part if part > 0.0 => (high - at) as f64 / part,
                part if part < 0.0 => (low - at) as f64 / part,
                _ => f64::INFINITY,
            }
        });
        // The cast turns a negative distance into 0.
        rooms.fold(f64::INFINITY, f64::min) as u64
    }
}
