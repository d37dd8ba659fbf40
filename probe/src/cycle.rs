//! The probing cycle.

use crate::repeatability::Repeatability;
use crate::unit_vector::{minus, plus};
use crate::{Failure, Input, Measurement, Plan, PlanError, Request, Touch};

/// A probing cycle as a state machine. The caller ticks it, and each tick returns a request for the
/// axes.
///
/// The cycle has no axes, no clock and no speeds. It therefore works with stepping axes, servo axes
/// and modules on a line: the machine reports its position and carries out the last [`Request`].
///
/// ```text
///  Start ─► Approach ─► Search ─► Brake ─► BackOff ─► Touch ─► Brake ─► BackOff ─► ... ─► Done
///    │         │          │         │         │         │
///    │         └─ contact └─ none   │ broken  └─ stuck  └─ none
///    │                              │ too far
///    └─► Failed ◄──── Retreat ◄──── Yield (brake) ◄──── each failure
/// ```
///
/// The result is the latched position, so it does not depend on speed or braking. Each request is
/// returned once, and [`Request::Wait`] after it.
///
/// # Cost
/// Additions only, and three multiplications while the axes brake.
///
/// # Examples
/// ```
/// use husillo_probe::{Cycle, Edge, Input, Plan, Request, UnitVector};
///
/// let mut cycle = Cycle::new(&Plan {
///     approach: [0; 3],
///     direction: UnitVector::X,
///     search: 10_000,
///     over_travel: 500,
///     back_off: 300,
///     touches: 2,
///     travel_speed: 9_000,
///     probing_speed: 1_000,
///     slow_speed: 100,
///     back_off_speed: 1_000,
///     until: Edge::Made,
/// })?;
/// // An axis that moves at most 100 counts per tick, and a wall at 4321.
/// let (mut x, mut target, mut step) = (-2_000_i64, -2_000_i64, 0);
/// let result = loop {
///     x += (target - x).clamp(-step, step);
///     let input = Input {
///         position: [x, 0, 0],
///         contact: x >= 4_321,
///         latched: [x.min(4_321), 0, 0],
///         still: x == target,
///     };
///     match cycle.tick(&input) {
///         Request::Move { target: [to, ..], speed } => (target, step) = (
///             to,
///             i64::from(speed) / 100,
///         ),
///         Request::Stop => target = x + step,
///         Request::Wait => {}
///         Request::Done(result) => break result,
///         Request::Failed(failure) => panic!("{failure}"),
///     }
/// };
/// assert_eq!((result.touch.position, result.touches), ([4_321, 0, 0], 2));
/// # Ok::<(), husillo_probe::PlanError>(())
/// ```
#[derive(Copy, Clone, Debug)]
pub struct Cycle {
    plan: Plan,
    state: State,
    /// The contact of the search. Slow touches are stored as differences to it.
    contact: [i64; 3],
    /// Sum of the slow touches, relative to `contact`.
    sum: [i64; 3],
    /// Slow touches along the direction, relative to `contact`.
    along: Repeatability,
    over_travel: i64,
}

#[derive(Copy, Clone, Eq, PartialEq, Debug)]
enum State {
    /// No request yet.
    Start,
    /// Moves from `start` to the approach point.
    Approach { start: [i64; 3] },
    /// Moves at probing speed to the end of the search.
    Search,
    /// Brakes beyond the contact latched at `latched`.
    Brake {
        latched: [i64; 3],
        trouble: Option<Failure>,
    },
    /// Moves away from the contact.
    BackOff,
    /// Moves slowly to the contact again.
    Touch,
    /// Brakes before it moves to the safe position `to` and fails.
    Yield { failure: Failure, to: [i64; 3] },
    /// Moves to a safe position.
    Retreat { failure: Failure },
    /// Over.
    Done(Measurement),
    /// Over.
    Failed(Failure),
}

impl Cycle {
    /// Creates a cycle that carries out `plan`.
    ///
    /// # Errors
    /// Fails with a [`PlanError`] if the plan cannot be carried out.
    pub const fn new(plan: &Plan) -> Result<Cycle, PlanError> {
        if let Err(error) = plan.check() {
            return Err(error);
        }
        Ok(Cycle {
            plan: *plan,
            state: State::Start,
            contact: [0; 3],
            sum: [0; 3],
            along: Repeatability::new(),
            over_travel: 0,
        })
    }

    /// Takes the state of the machine and returns the request for it.
    pub fn tick(&mut self, input: &Input) -> Request {
        let touching = input.contact == self.plan.until.level();
        match self.state {
            State::Start if touching => self.fail(Failure::ContactAtStart),
            State::Start => {
                self.state = State::Approach {
                    start: input.position,
                };
                move_to(self.plan.approach, self.plan.travel_speed)
            }
            State::Approach { start } if touching => {
                self.state = State::Yield {
                    failure: Failure::ContactInApproach,
                    to: start,
                };
                Request::Stop
            }
            State::Approach { .. } if input.still => {
                self.state = State::Search;
                let end = self.beyond(self.plan.approach, self.plan.search);
                move_to(end, self.plan.probing_speed)
            }
            State::Search if touching => {
                self.contact = input.latched;
                self.brake(input)
            }
            State::Search if input.still => self.retreat(Failure::NoContact, input.position),
            State::Touch if touching && self.is_on_the_way(input) => {
                let difference = minus(input.latched, self.contact);
                self.sum = plus(self.sum, difference);
                self.along
                    .push(self.plan.direction.length_along(difference));
                self.brake(input)
            }
            State::Touch if touching => self.brake(input),
            State::Touch if input.still => self.retreat(Failure::LostContact, input.position),
            State::Brake { latched, trouble } => self.watch(input, latched, trouble),
            State::BackOff if input.still => {
                if touching {
                    self.fail(Failure::StuckContact)
                } else {
                    self.next_touch()
                }
            }
            State::Yield { failure, to } if input.still => {
                self.state = State::Retreat { failure };
                move_to(to, self.plan.back_off_speed.max(1))
            }
            State::Retreat { failure } if input.still => self.fail(failure),
            State::Done(measurement) => Request::Done(measurement),
            State::Failed(failure) => Request::Failed(failure),
            _ => Request::Wait,
        }
    }

    /// Whether the cycle is over.
    #[must_use]
    pub const fn is_over(&self) -> bool {
        matches!(self.state, State::Done(_) | State::Failed(_))
    }

    /// Returns the plan.
    #[must_use]
    pub const fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Brakes. If the latched position cannot belong to this contact, the cycle then backs off from
    /// the present position and fails.
    fn brake(&mut self, input: &Input) -> Request {
        let is_on_the_way = self.is_on_the_way(input);
        self.state = State::Brake {
            latched: if is_on_the_way {
                input.latched
            } else {
                input.position
            },
            trouble: (!is_on_the_way).then_some(Failure::NotLatched),
        };
        Request::Stop
    }

    /// Whether the latched position can belong to this search. Along the direction it must not be
    /// before the approach point, beyond the end of the search, or beyond the axes. The over-travel
    /// is added as tolerance for axes with a following error.
    fn is_on_the_way(&self, input: &Input) -> bool {
        let along = |from, to| self.plan.direction.length_along(minus(to, from));
        // Both lengths have 32 bits, so the sums fit.
        let slack = i64::from(self.plan.over_travel);
        let distance = along(self.plan.approach, input.latched);
        distance >= slack.wrapping_neg()
            && distance <= i64::from(self.plan.search).wrapping_add(slack)
            && along(input.position, input.latched) <= slack
    }

    /// Watches the braking: the distance beyond the contact, and whether the contact is lost.
    fn watch(&mut self, input: &Input, latched: [i64; 3], trouble: Option<Failure>) -> Request {
        let beyond = self
            .plan
            .direction
            .length_along(minus(input.position, latched));
        self.over_travel = self.over_travel.max(beyond);
        let trouble = if beyond > i64::from(self.plan.over_travel) {
            Some(Failure::OverTravel)
        } else if input.contact != self.plan.until.level() {
            trouble.or(Some(Failure::LostContact))
        } else {
            trouble
        };
        self.state = State::Brake { latched, trouble };
        if !input.still {
            return Request::Wait;
        }
        match trouble {
            Some(failure) => self.retreat(failure, latched),
            None if self.plan.back_off > 0 => {
                self.state = State::BackOff;
                move_to(self.before(latched), self.plan.back_off_speed)
            }
            None => self.next_touch(),
        }
    }

    /// Starts the next touch, or finishes. Called when the back-off is done or not planned.
    fn next_touch(&mut self) -> Request {
        if self.along.readings() < u32::from(self.plan.touches) {
            self.state = State::Touch;
            let end = self.beyond(self.contact, self.plan.over_travel);
            return move_to(end, self.plan.slow_speed);
        }
        let measurement = self.measurement();
        self.state = State::Done(measurement);
        Request::Done(measurement)
    }

    fn measurement(&self) -> Measurement {
        let touches = i64::from(self.plan.touches);
        let mean = self.sum.map(|sum| {
            // Half of at most 255, with the sign of the sum, rounds to the nearest.
            let half = (touches >> 1).wrapping_mul(sum.signum());
            // Without slow touches the sum is 0, and the contact of the search is the result.
            sum.saturating_add(half).checked_div(touches).unwrap_or(0)
        });
        Measurement {
            touch: Touch {
                position: plus(self.contact, mean),
                direction: self.plan.direction,
            },
            touches: self.plan.touches.max(1),
            spread: self.along.range().unwrap_or(0),
            over_travel: self.over_travel,
        }
    }

    /// Backs off from `here`, then fails.
    fn retreat(&mut self, failure: Failure, here: [i64; 3]) -> Request {
        if self.plan.back_off == 0 {
            return self.fail(failure);
        }
        self.state = State::Retreat { failure };
        move_to(self.before(here), self.plan.back_off_speed)
    }

    fn fail(&mut self, failure: Failure) -> Request {
        self.state = State::Failed(failure);
        Request::Failed(failure)
    }

    fn beyond(&self, point: [i64; 3], length: u32) -> [i64; 3] {
        plus(point, self.plan.direction.scaled(i64::from(length)))
    }

    fn before(&self, point: [i64; 3]) -> [i64; 3] {
        minus(
            point,
            self.plan.direction.scaled(i64::from(self.plan.back_off)),
        )
    }
}

const fn move_to(target: [i64; 3], speed: u32) -> Request {
    Request::Move { target, speed }
}
