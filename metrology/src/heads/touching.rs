//! Probing by a head: moves that end when the contact changes, and the probing cycle.

use super::head::Head;
use super::port::Port;
use super::prober::Probed;
use super::search::Search;
use super::straight_move::FinishedMove;
use crate::error::Error;
use husillo_probe::{Cycle, Edge, Failure, Input, Measurement, Plan, Request, UnitVector};
use husillo_transports::nmc::{Homing, Reply};

impl<P: Port> Head<P> {
    /// Moves towards a goal along a straight path until the contact is made or broken. It stays
    /// where it comes to rest. The speed is at most `rate` counts/s, and at most that of a search.
    ///
    /// # Errors
    ///
    /// [`Error`]. Nothing moves if the goal is outside of the travel, or if the contact already
    /// has the wanted state at the start.
    pub fn search_to(&mut self, goal: [i64; 3], rate: u32, until: Edge) -> Result<Probed, Error> {
        self.find_again()?;
        let replies = self.read_twice()?;
        // The modules detect any change of the contact, made or broken.
        if self.is_closed(&replies) == until.level() {
            return Err(match until {
                Edge::Made => Error::Probe(Failure::ContactAtStart),
                Edge::Broken => Error::NotTouching,
            });
        }
        let meant = goal;
        let goal = self.counts(goal)?;
        self.check_travel(&goal, meant)?;
        let search = Search {
            events: self.probe.switches.events(),
            stop: Homing::SMOOTH,
            only: None,
        };
        let finished = self.travel(&goal, Some(rate.min(self.probe.rate)), Some(search))?;
        let at_nm = self.place_of(&finished.replies);
        if !finished.is_found {
            if self.is_closed(&finished.replies) == until.level() {
                return Err(Error::NotLatched {
                    at: self.text(at_nm),
                });
            }
            return Ok(Probed {
                changed_nm: None,
                at_nm,
            });
        }
        let changed_nm = self.latched(&finished.replies);
        let beyond = [0, 1, 2].map(|axis: usize| (at_nm[axis] - changed_nm[axis]) as f64);
        let beyond = beyond
            .iter()
            .map(|length| length * length)
            .sum::<f64>()
            .sqrt();
        let over_travel = self.scale.of_counts(self.probe.over_travel.into());
        if until == Edge::Made && beyond > over_travel as f64 {
            return Err(Error::Probe(Failure::OverTravel));
        }
        Ok(Probed {
            changed_nm: Some(changed_nm),
            at_nm,
        })
    }

    /// Searches the work piece from the present position in any direction, within `distance` and
    /// the travel. Then it touches the work piece slowly and returns the mean of the latched
    /// positions. Lengths are amounts of the scale.
    ///
    /// # Errors
    ///
    /// [`Error`], also that of the probing cycle.
    pub fn touch(&mut self, direction: &UnitVector, distance: u64) -> Result<Measurement, Error> {
        self.find_again()?;
        let from = self.held();
        let search = distance.min(self.room(direction)).min(u32::MAX.into());
        // Limited to 32 bits above.
        let plan = self.plan(from, direction, search as u32);
        let mut cycle = Cycle::new(&plan).map_err(Error::Plan)?;
        let mut finished = FinishedMove {
            replies: self.read()?,
            is_found: false,
        };
        // Whether the last move was a search without a contact, and the position of a contact that
        // was not latched.
        let (mut is_in_vain, mut unlatched) = (false, None);
        // The goal of a move of the cycle that is outside of the travel.
        let mut beyond: Option<(Vec<i32>, [i64; 3])> = None;
        loop {
            let position = self.place_of(&finished.replies);
            let is_closed = self.is_closed(&finished.replies);
            if is_in_vain && is_closed {
                // The modules have latched the position of an earlier contact.
                unlatched = Some(position);
            }
            let input = Input {
                position,
                // The latch reports a contact once. The level shows whether it is still closed.
                contact: finished.is_found || (is_closed && !is_in_vain),
                latched: self.latched(&finished.replies),
                // Each request is carried out before the next one.
                still: true,
            };
            finished.is_found = false;
            is_in_vain = false;
            match cycle.tick(&input) {
                Request::Move { target, speed } => {
                    let along = [0, 1, 2].map(|axis| target[axis] - input.position[axis]);
                    let is_search = target != from && direction.length_along(along) > 0;
                    let search = is_search.then_some(Search {
                        events: self.probe.switches.events(),
                        stop: Homing::SMOOTH,
                        only: None,
                    });
                    let wanted = self.counts(target)?;
                    let goal = self.within_travel(&wanted);
                    if goal != wanted {
                        beyond = Some((wanted, target));
                    }
                    finished = match search {
                        Some(search) => self.travel(&goal, Some(speed), Some(search))?,
                        None => self.retract(&goal, speed)?,
                    };
                    is_in_vain = is_search && !finished.is_found;
                    if is_search && finished.is_found {
                        self.check_sense(direction, &finished.replies)?;
                    }
                }
                // The modules stop by themselves.
                Request::Stop | Request::Wait => {}
                Request::Done(measurement) => return Ok(measurement),
                Request::Failed(failure) => {
                    if let (Failure::StuckContact, Some((wanted, target))) = (failure, &beyond) {
                        // Within the travel there was no room to leave the contact.
                        self.check_travel(wanted, *target)?;
                    }
                    // At most 2^32 - 1.
                    let length = direction.scaled(search as i64);
                    let to = [0, 1, 2].map(|axis| from[axis] + length[axis]);
                    return Err(self.failure(failure, unlatched, [from, to]));
                }
            }
        }
    }

    /// Checks that not only the contact for the other direction has closed.
    fn check_sense(&self, direction: &UnitVector, replies: &[Reply]) -> Result<(), Error> {
        // A probe with a contact for each direction is on a single axis.
        let (Some(axis), [reply]) = (self.axes.first(), replies) else {
            return Ok(());
        };
        let mut unit = [0; 3];
        unit[axis.settings.coordinate()] = 1 << 20;
        let is_positive = direction.length_along(unit) > 0;
        let [positive, negative] = self.probe.switches.are_closed(reply);
        if positive != negative && positive != is_positive {
            return Err(Error::OtherSense {
                at: self.text(self.place_of(replies)),
            });
        }
        Ok(())
    }

    /// The plan of a touch from a position.
    fn plan(&self, from: [i64; 3], direction: &UnitVector, search: u32) -> Plan {
        let amount = |counts: u32| {
            let amount = self.scale.of_counts(counts.into());
            u32::try_from(amount).unwrap_or(u32::MAX)
        };
        Plan {
            approach: from,
            direction: *direction,
            search,
            over_travel: amount(self.probe.over_travel),
            back_off: amount(self.probe.back_off),
            touches: self.touches,
            travel_speed: self.probe.rate,
            probing_speed: self.probe.rate,
            slow_speed: self.probe.slow_rate,
            back_off_speed: self.probe.rate,
            until: Edge::Made,
        }
    }

    /// The error of a search between two points. `unlatched` is the position of a contact that was
    /// not latched.
    fn failure(
        &self,
        failure: Failure,
        unlatched: Option<[i64; 3]>,
        [from, to]: [[i64; 3]; 2],
    ) -> Error {
        match (failure, unlatched) {
            (Failure::NoContact | Failure::LostContact, Some(at)) => {
                Error::NotLatched { at: self.text(at) }
            }
            (Failure::NoContact, None) => Error::NoContact {
                from: self.text(from),
                to: self.text(to),
            },
            (failure, _) => Error::Probe(failure),
        }
    }
}

impl<P: Port> Head<P> {
    /// The goal, or the point before it at which the travel ends.
    fn within_travel(&self, goal: &[i32]) -> Vec<i32> {
        let parts = self.axes.iter().zip(goal).map(|(axis, goal)| {
            let [low, high] = axis.travel_counts();
            let (held, goal) = (f64::from(axis.held), f64::from(*goal));
            let end = goal.clamp(f64::from(low), f64::from(high));
            if end == goal {
                1.0
            } else {
                // The goal is outside. An axis that is already outside does not move farther out.
                ((end - held) / (goal - held)).clamp(0.0, 1.0)
            }
        });
        let part = parts.fold(1.0, f64::min);
        let pairs = self.axes.iter().zip(goal);
        pairs
            .map(|(axis, goal)| {
                let delta = (f64::from(*goal) - f64::from(axis.held)) * part;
                let [low, high] = axis.travel_counts();
                // Rounding may exceed the travel by half a count.
                (f64::from(axis.held) + delta.round()).clamp(low.into(), high.into()) as i32
            })
            .collect()
    }
}
