//! Homing on the index of an encoder.

use super::head::Head;
use super::port::Port;
use super::search::Search;
use super::straight_move::FinishedMove;
use super::wiring::End;
use crate::error::Error;
use husillo_probe::Failure;
use husillo_transports::nmc::{Auxiliary, Homing};

impl<P: Port> Head<P> {
    /// Searches the index of an axis in the positive direction, first at the speed of a search and
    /// then slowly. Every turn of the encoder has an index. Its edge is always approached from this
    /// side. The index becomes position 0, and the axis moves there. An axis with an end switch
    /// first moves to the switch and off it, so home is always the index next to the switch.
    ///
    /// # Errors
    ///
    /// [`Error::NoIndex`] if there is none up to the end of the travel, a contact at the start, and
    /// those of [`travel`](Self::travel).
    pub fn home(&mut self, coordinate: usize) -> Result<(), Error> {
        let index = self.index(coordinate)?;
        // The operator has requested it, so no message about an axis that is not homed is needed.
        let is_announced = std::mem::replace(&mut self.axes[index].is_announced, true);
        let homed = self.search_home(index);
        self.axes[index].is_announced = is_announced;
        homed
    }

    fn search_home(&mut self, index: usize) -> Result<(), Error> {
        let coordinate = self.axes[index].settings.coordinate();
        let [slow, quick] = [self.probe.slow_rate, self.probe.rate];
        let reply = self.status(coordinate)?;
        if self.is_closed(&[reply]) {
            // While the probe leaves the contact, nothing watches it.
            return Err(Error::Probe(Failure::ContactAtStart));
        }
        if let Some(end) = self.axes[index].settings.end() {
            self.search_end(index, end)?;
            if end == End::High {
                // Finds the next index below the switch. Afterwards it is approached from below, as
                // always.
                self.search_index(index, End::Low, quick)?;
            }
        }
        let reply = self.status(coordinate)?;
        if reply.readings.auxiliary.contains(Auxiliary::INDEX) {
            self.back_from(index, self.axes[index].held)?;
        }
        let found = self.search_index(index, End::High, quick)?;
        self.back_from(index, found)?;
        let found = self.search_index(index, End::High, slow)?;
        self.axes[index].origin = found;
        self.axes[index].is_homed = true;
        self.only(index, found, None, quick).map(drop)
    }

    /// Moves to the back-off distance before a count.
    fn back_from(&mut self, index: usize, count: i32) -> Result<(), Error> {
        let [low, _] = self.axes[index].travel_counts();
        let back_off = i32::try_from(self.probe.back_off).unwrap_or(i32::MAX);
        let before = count.saturating_sub(back_off);
        let before = match self.axes[index].settings.end() {
            // The axis has left its switch. Its travel is unknown before it is homed.
            Some(_) => before,
            None => before.max(low),
        };
        self.only(index, before, None, self.probe.rate).map(drop)
    }

    /// Searches the next index towards an end and returns its count.
    fn search_index(&mut self, index: usize, to: End, rate: u32) -> Result<i32, Error> {
        let axis = &self.axes[index];
        let letter = axis.settings.letter;
        let [low, high] = axis.settings.travel;
        let length = high.saturating_sub(low);
        let goal = match (axis.settings.end(), to) {
            (None, End::High) => axis.travel_counts()[1],
            (None, End::Low) => axis.travel_counts()[0],
            (Some(_), to) => axis.held.saturating_add(to.sign().saturating_mul(length)),
        };
        let search = Search {
            // A contact, which is a collision, ends the search, too.
            events: Homing::INDEX.with(self.probe.switches.events()),
            stop: Homing::ABRUPT,
            only: Some(index),
        };
        let finished = self.only(index, goal, Some(search), rate)?;
        if finished.is_found {
            Ok(finished.replies[index].readings.home)
        } else {
            Err(Error::NoIndex { axis: letter })
        }
    }

    /// Moves one axis.
    pub(super) fn only(
        &mut self,
        index: usize,
        count: i32,
        search: Option<Search>,
        rate: u32,
    ) -> Result<FinishedMove, Error> {
        let mut goal: Vec<i32> = self.axes.iter().map(|axis| axis.held).collect();
        goal[index] = count;
        self.travel(&goal, Some(rate), search)
    }
}
