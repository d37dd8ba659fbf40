//! Collisions: contacts outside of a search.

use super::approach::Approach;
use super::head::{Head, is_done};
use super::port::Port;
use super::search::{Search, searches};
use super::straight_move::FinishedMove;
use crate::error::Error;
use crate::scale::Scale;
use husillo_transports::nmc::{Homing, Reply, StopMode};
use std::collections::VecDeque;

/// A pressed probe counts as free after this number of consecutive readings without a contact. One
/// is not enough, because contacts bounce.
const FREE_READINGS: u32 = 2;

/// Number of readings from which a speed is computed. One period is not enough, because a module is
/// read at any instant of its period.
const SPEED_READINGS: usize = 8;

/// A move outside of a search, and its readings.
pub(super) struct Watch {
    /// Letters of the axes that move.
    axes: String,
    /// Its reaction to a contact.
    approach: Approach,
    /// Whether the modules watch the contact by themselves. While the probe is pressed they do not.
    is_armed: bool,
    free_readings: u32,
    /// Start of the move, counts.
    from: Vec<i32>,
    /// The last readings before a collision: time in us, and counts.
    readings: VecDeque<(u64, Vec<i32>)>,
}

impl Watch {
    /// The axes that move now, by their letters.
    pub(super) fn follow(&mut self, axes: String) {
        self.axes = axes;
    }

    fn note(&mut self, now_us: u64, replies: &[Reply]) {
        if self.readings.len() == SPEED_READINGS {
            self.readings.pop_front();
        }
        self.readings.push_back((now_us, counts(replies)));
    }

    /// The speed as text.
    pub(super) fn speed(&self, scale: Scale) -> Option<String> {
        // Rates are far below 2^53 counts/s.
        self.rate()
            .map(|rate| scale.text_of_rate(rate.round() as i64))
    }

    /// Speed over the last readings, counts/s. `None`: the axes did not move.
    fn rate(&self) -> Option<f64> {
        let ((before_us, before), (last_us, last)) =
            self.readings.front().zip(self.readings.back())?;
        let length = distance(before, last);
        // Below 2^53 us.
        let seconds = last_us.saturating_sub(*before_us) as f64 * 1e-6;
        (length > 0.0 && seconds > 0.0).then(|| length / seconds)
    }
}

impl<P: Port> Head<P> {
    /// The search that detects a collision. In a move that is not a touch, each module stops its
    /// own axis when a contact changes. It does so within a servo period and without the host.
    pub(super) const fn contact_watch(&self, approach: Approach) -> Search {
        Search {
            events: self.probe.switches.events(),
            stop: match approach {
                Approach::Rapid => Homing::ABRUPT,
                Approach::Guarded => Homing::SMOOTH,
            },
            only: None,
        }
    }

    /// Whether a contact of the probe is closed.
    pub(super) fn is_closed(&self, replies: &[Reply]) -> bool {
        let switches = self.probe.switches;
        replies.iter().any(|reply| switches.is_closed(reply))
    }

    /// Whether there was a collision since the start, or since
    /// [`forget_collisions`](Self::forget_collisions).
    pub const fn has_collided(&self) -> bool {
        self.has_collided
    }

    /// Forgets the collisions so far, because what follows is measured apart from what they have
    /// spoiled.
    pub const fn forget_collisions(&mut self) {
        self.has_collided = false;
    }

    /// Moves outside of a search. A pressed probe first leaves the contact slowly.
    pub(super) fn go_clear(
        &mut self,
        goal: &[i32],
        rate: Option<u32>,
        approach: Approach,
    ) -> Result<FinishedMove, Error> {
        if !self.is_touching()? {
            return Ok(self.go_free(goal, rate, false, approach)?.0);
        }
        let slow = self.probe.rate;
        let clear = if rate.is_some_and(|rate| rate <= slow) {
            goal.to_vec()
        } else {
            self.beginning_of(goal)
        };
        let slow = rate.map_or(slow, |rate| rate.min(slow));
        let (finished, watch) = self.go_free(&clear, Some(slow), true, approach)?;
        if clear == goal {
            return Ok(finished);
        }
        if self.is_touching()? {
            return Err(self.collision(&watch));
        }
        Ok(self.go_free(goal, rate, false, approach)?.0)
    }

    /// Retracts after a touch, which may have ended in contact or just before it.
    pub(super) fn retract(&mut self, goal: &[i32], rate: u32) -> Result<FinishedMove, Error> {
        self.supervised(|head| Ok(head.go_free(goal, Some(rate), true, Approach::Rapid)?.0))
    }

    /// Makes the whole move at this rate. `is_touching`: the probe is in contact, or was in contact
    /// immediately before.
    fn go_free(
        &mut self,
        goal: &[i32],
        rate: Option<u32>,
        is_touching: bool,
        approach: Approach,
    ) -> Result<(FinishedMove, Watch), Error> {
        let mut watch = Watch {
            approach,
            ..self.watch(goal)
        };
        let rate = match approach {
            Approach::Rapid => rate,
            Approach::Guarded => {
                let most = self.guarded_rate(goal);
                Some(rate.map_or(most, |rate| rate.min(most)))
            }
        };
        let ended = |replies| FinishedMove {
            replies,
            is_found: false,
        };
        let Some(line) = self.line_to(goal, rate) else {
            return Ok((ended(self.stand(Some(goal))?), watch));
        };
        self.begin_watch(&mut watch, is_touching)?;
        let armed = watch.is_armed.then_some(self.contact_watch(approach));
        self.start_line(goal, &line, armed)?;
        let end_us = self.latest_end_us(&line);
        loop {
            let replies = self.read_moving(&watch)?;
            self.look(&mut watch, &replies)?;
            if replies.iter().all(is_done) {
                let was_armed = self.end_watch(&mut watch)?;
                let replies = self.stand(Some(goal))?;
                if was_armed && self.is_closed(&replies) {
                    return Err(self.collision(&watch));
                }
                return Ok((ended(replies), watch));
            }
            if self.line.elapsed_us() > end_us {
                return Err(self.late(Some(goal), goal, &replies));
            }
        }
    }

    /// Returns the watch of a move from the held positions, without readings.
    pub(super) fn watch(&self, goal: &[i32]) -> Watch {
        let from: Vec<i32> = self.axes.iter().map(|axis| axis.held).collect();
        let moving = self.axes.iter().zip(goal);
        let moving = moving.filter(|(axis, goal)| axis.held != **goal);
        let now = (self.line.elapsed_us(), from.clone());
        Watch {
            axes: moving.map(|(axis, _)| axis.settings.letter).collect(),
            approach: Approach::Rapid,
            is_armed: false,
            free_readings: 0,
            from,
            readings: VecDeque::from([now]),
        }
    }

    /// Lets the modules watch the contact from now on, unless the probe `is_touching`.
    pub(super) fn begin_watch(
        &mut self,
        watch: &mut Watch,
        is_touching: bool,
    ) -> Result<(), Error> {
        watch.is_armed = !is_touching;
        let contacts = self.contact_watch(watch.approach);
        if is_touching {
            self.disarm(contacts)
        } else {
            self.arm(contacts)
        }
    }

    /// Lets the modules stop watching the contact. Returns whether they watched it.
    pub(super) fn end_watch(&mut self, watch: &mut Watch) -> Result<bool, Error> {
        let was_armed = std::mem::take(&mut watch.is_armed);
        if was_armed {
            self.disarm(self.contact_watch(watch.approach))?;
        }
        Ok(was_armed)
    }

    /// Checks a reading of the moving axes for a collision.
    ///
    /// # Errors
    ///
    /// [`Error::Collision`]. Then the axes are stopped.
    pub(super) fn look(&mut self, watch: &mut Watch, replies: &[Reply]) -> Result<(), Error> {
        let is_touching = self.is_closed(replies);
        if watch.is_armed {
            if is_touching || !replies.iter().all(searches) {
                return Err(self.collision(watch));
            }
        } else if is_touching {
            watch.free_readings = 0;
            self.contact_at.get_or_insert_with(|| counts(replies));
            if self.is_pressed_deeper(watch, replies) {
                return Err(self.collision(watch));
            }
        } else {
            watch.free_readings += 1;
            let length = distance(&watch.from, &counts(replies));
            if watch.free_readings >= FREE_READINGS && length > self.slack_counts() {
                self.contact_at = None;
                self.begin_watch(watch, false)?;
            }
        }
        watch.note(self.line.elapsed_us(), replies);
        Ok(())
    }

    /// Checks a reading of a search. If the search is not for a contact, a contact is a collision.
    ///
    /// # Errors
    ///
    /// Those of [`look`](Self::look).
    pub(super) fn look_in_search(
        &mut self,
        search: Search,
        watch: &mut Watch,
        replies: &[Reply],
    ) -> Result<(), Error> {
        if !search.is_touch() && self.is_closed(replies) {
            return Err(self.collision(watch));
        }
        watch.note(self.line.elapsed_us(), replies);
        Ok(())
    }

    /// Whether the probe is pressed. Call it while the axes stand still.
    pub(super) fn is_touching(&mut self) -> Result<bool, Error> {
        let mut replies = self.read()?;
        if self.is_closed(&replies) {
            // A single reading may have an undetected error. Two equal readings are right.
            replies = self.read_twice()?;
        }
        // Axes that are held at a contact oscillate around it.
        let is_near =
            |contact: &Vec<i32>| distance(contact, &counts(&replies)) <= self.slack_counts();
        let is_touching = self.is_closed(&replies) || self.contact_at.as_ref().is_some_and(is_near);
        self.contact_at = match self.contact_at.take() {
            _ if !is_touching => None,
            None => Some(counts(&replies)),
            known => known,
        };
        Ok(is_touching)
    }

    /// Stops all axes and returns the reason: a collision if a second reading confirms the contact.
    pub(super) fn collision(&mut self, watch: &Watch) -> Error {
        let has_collided = self.has_collided;
        self.has_collided = true;
        match self.met(watch) {
            Ok(Some(error)) | Err(error) => error,
            Ok(None) => {
                self.has_collided = has_collided;
                Error::DoubtfulContact
            }
        }
    }

    fn met(&mut self, watch: &Watch) -> Result<Option<Error>, Error> {
        self.stop(match watch.approach {
            Approach::Rapid => StopMode::Abrupt,
            Approach::Guarded => StopMode::Smooth,
        })?;
        self.stand(None)?;
        let replies = self.read_twice()?;
        // The contact may have been so short that it has ended already.
        let has_latched = watch.is_armed && !replies.iter().any(searches);
        self.disarm(self.contact_watch(watch.approach))?;
        if !has_latched && !self.is_closed(&replies) {
            return Ok(None);
        }
        let at: Vec<i32> = if has_latched {
            replies.iter().map(|reply| reply.readings.home).collect()
        } else {
            counts(&replies)
        };
        let place = self.place_at(&at);
        // A latched position is the position of the contact.
        let beyond = has_latched.then(|| self.length_text(distance(&at, &counts(&replies))));
        // If the probe was already pressed, the position of the first contact stays.
        if has_latched || self.contact_at.is_none() {
            self.contact_at = Some(at);
        }
        Ok(Some(Error::Collision {
            axes: watch.axes.clone(),
            at: self.text(place),
            speed: watch.speed(self.scale),
            beyond,
        }))
    }

    /// Whether the axes press the probe deeper than permitted: they are farther from the first
    /// contact than the over-travel, and still move away from it.
    fn is_pressed_deeper(&self, watch: &Watch, replies: &[Reply]) -> bool {
        let Some(contact) = &self.contact_at else {
            return false;
        };
        let length = distance(&counts(replies), contact);
        length > f64::from(self.probe.over_travel)
            && length > distance(&watch.from, contact) + self.slack_counts()
    }

    /// A length in counts as text.
    fn length_text(&self, counts: f64) -> String {
        // Lengths are far below 2^53 counts.
        self.scale.text(self.scale.of_counts(counts.round() as i64))
    }

    /// Returns the distance from the surface at which a pressed probe is free, counts.
    fn leaving_counts(&self) -> f64 {
        f64::from(self.probe.over_travel) + f64::from(self.probe.back_off)
    }

    /// The distance of [`leaving_counts`](Self::leaving_counts) as a whole number.
    pub(super) fn leaving(&self) -> i32 {
        // The cast saturates.
        self.leaving_counts() as i32
    }

    /// Returns an upper bound of the deviation of held axes, counts.
    fn slack_counts(&self) -> f64 {
        let most = self.axes.iter().map(|axis| axis.settings.in_position).max();
        4.0 * f64::from(most.unwrap_or_default())
    }

    /// The point on the path to the goal at which a pressed probe is free.
    fn beginning_of(&self, goal: &[i32]) -> Vec<i32> {
        let from: Vec<i32> = self.axes.iter().map(|axis| axis.held).collect();
        let part = self.leaving_counts() / distance(&from, goal);
        if part >= 1.0 {
            return goal.to_vec();
        }
        let pairs = from.iter().zip(goal);
        let between = |(from, goal): (&i32, &i32)| {
            let delta = f64::from(*goal) - f64::from(*from);
            // The point is between two counts.
            (f64::from(*from) + delta * part).round() as i32
        };
        pairs.map(between).collect()
    }
}

/// Positions of the axes in these replies, counts.
fn counts(replies: &[Reply]) -> Vec<i32> {
    let positions = replies.iter().map(|reply| reply.readings.position);
    positions.collect()
}

/// Distance in a straight line, counts.
fn distance(from: &[i32], to: &[i32]) -> f64 {
    let pairs = from.iter().zip(to);
    let squares = pairs.map(|(from, to)| (f64::from(*to) - f64::from(*from)).powi(2));
    squares.sum::<f64>().sqrt()
}
