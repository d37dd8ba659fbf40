//! Many steps a call.

use husillo_backlash::BacklashModel;
use husillo_gcode::Command;
use husillo_interp::{Line, Moves, Step};
use husillo_planner::Waits;

use super::{Machine, Origin};
use crate::lines::extension::Extension;
use crate::lines::guard::{StepGuard, bits};
use crate::lines::path_ramp::PathRamp;
use crate::lines::take_up::TakeUp;
use crate::{Config, Event, MAX_WAIT_TICKS, Segment, StepEvent};

/// What [`Machine::fill`] has returned.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
pub struct Filled<const N: usize> {
    /// Number of steps, from the beginning of the slice.
    pub steps: usize,
    /// The event after these steps, where it is not a step.
    pub then: Option<Event<N>>,
}

impl<
    const N: usize,
    P: Moves<N>,
    L: BacklashModel<N>,
    const QUEUE: usize,
    E: Extension<N>,
    R: PathRamp,
> Machine<N, P, L, QUEUE, E, R>
{
    /// Writes the next step events to a slice, in their order. It ends at an event of another kind,
    /// which is returned as [`Filled::then`], or where [`next_event`](Machine::next_event) returns
    /// `None`. The events are those of `next_event`, and both may be called in turn. With an empty
    /// slice nothing is taken.
    ///
    /// - **Latency.** A hold, a resume, an override, an abort and the inputs of an extended machine
    ///   act on the first event after those that were returned, so the length of the slice is
    ///   their latency in events. Position, speed, origin and executing command are those after
    ///   the last event of the slice.
    /// - **Other events.** Dwells, outputs, pauses, index and following events, awaited inputs and
    ///   alarms end the slice, so they act exactly between the steps before and after them.
    /// - **Probing.** While the level of the probe matters
    ///   ([`needs_probe`](Machine::needs_probe)), a call returns one event. So `set_probe` is
    ///   called before each event, as it is without this function.
    ///
    /// # Cost
    /// A step within a move costs less than with `next_event`, because what holds for the whole
    /// move, or for a part of a ramp, is asked once a call. For the rest see `next_event`.
    ///
    /// # Examples
    /// ```
    /// # use husillo_machine::{Axis, Config, Equipment, Machine, Scale, gcode::{Dialect, Nm}};
    /// # let axis = Axis {
    /// #     scale: Scale::new(2_500, 1).unwrap(),
    /// #     travel: None,
    /// #     max_rate_hz: 20_000,
    /// #     backlash_steps: 0,
    /// #     ramp: None,
    /// # };
    /// # let config = Config {
    /// #     axes: [axis; 2],
    /// #     timer_hz: 1_000_000,
    /// #     dialect: Dialect::RS274,
    /// #     arc_tolerance: None,
    /// #     rapid: None,
    /// #     top_feed: None,
    /// #     spindle_counts: None,
    /// #     corner_deviation: None,
    /// #     equipment: Equipment::NONE,
    /// # };
    /// use husillo_machine::{Event, Filled, StepEvent};
    ///
    /// let mut machine: Machine<2> = Machine::new(config);
    /// machine.line(b"G1 X0.1 Y-0.05 F150").unwrap(); // 40 steps of X, 20 of Y
    /// machine.line(b"M8").unwrap();
    /// let mut steps = [StepEvent::default(); 32];
    /// assert_eq!(machine.fill(&mut steps), Filled { steps: 32, then: None });
    /// assert_eq!(steps[1], StepEvent { wait_ticks: 1118, delta: [1, -1] });
    /// let filled = machine.fill(&mut steps);
    /// assert_eq!(filled.steps, 8);
    /// assert!(matches!(filled.then, Some(Event::Output(_))));
    /// assert_eq!(machine.fill(&mut steps), Filled { steps: 0, then: None }); // all was made
    /// ```
    pub fn fill(&mut self, steps: &mut [StepEvent<N>]) -> Filled<N> {
        let mut made = 0_usize;
        loop {
            let rest = steps.get_mut(made..).unwrap_or_default();
            // At most the length of the slice.
            made = made.wrapping_add(self.steps_of_path(rest));
            let Some(place) = steps.get_mut(made) else {
                break;
            };
            match self.next_event() {
                Some(Event::Step(step)) => *place = step,
                then => return Filled { steps: made, then },
            }
            made = made.wrapping_add(1);
            if E::IS_EXTENDED && self.is_probed() {
                break;
            }
        }
        Filled {
            steps: made,
            then: None,
        }
    }

    /// Whether a probing move is made, or waits for the moves before it.
    fn is_probed(&self) -> bool {
        let is_probing = |state: &crate::lines::state::State<N>| state.probing.is_some();
        self.extension.state().is_some_and(is_probing)
            || matches!(self.waiting, Some(Command::Probe { .. }))
    }

    /// Whether each event has to be looked at: a probing move, or a spindle that follows the
    /// diameter.
    fn is_observed(&self) -> bool {
        let is_surface = |state: &crate::lines::state::State<N>| state.surface.is_some();
        self.is_probed() || self.extension.state().is_some_and(is_surface)
    }

    /// Writes the next steps of the executing move, up to a reversal of an axis with backlash, a
    /// wait of more than one event, or the end of the move. Returns their number; 0 where
    /// [`next_event`](Machine::next_event) has to decide.
    fn steps_of_path(&mut self, to: &mut [StepEvent<N>]) -> usize {
        if L::VARIES
            || self.held.is_some()
            || self.carried_ticks != 0
            || self.take_up.is_under_way()
            || self.ramp.is_held()
            || E::IS_EXTENDED && self.is_observed()
        {
            return 0;
        }
        let Some(run) = &mut self.run else { return 0 };
        if run.follows || run.next.is_some() {
            return 0;
        }
        let to = to.get_mut(..to.len().min(MOST)).unwrap_or_default();
        let mut walk = Walk {
            config: &self.config,
            longest_interval: self.longest_interval,
            guard: &mut self.guard,
            take_up: &mut self.take_up,
            load: &mut self.load,
            held: &mut self.held,
            refused: None,
            made: 0,
            noted: 0,
            moved: 0,
            forth: Lanes::default(),
            back: Lanes::default(),
        };
        let moves = &mut self.schedule.moves;
        let ramp = &mut self.ramp;
        let left = match &run.timer {
            Some(_) => run.path.remaining(),
            None => run.left,
        };
        let room = to.len().min(left as usize);
        let to = to.get_mut(..room).unwrap_or_default();
        let timer = &mut run.timer;
        let has_ramp = timer.is_none();
        if let Some(line) = run
            .path
            .as_line()
            .filter(|line| !walk.may_owe(line.directions()))
        {
            let places = waits_of(to);
            let waits = match timer {
                Some(timer) => timer.fill(places),
                None => ramp.fill(places, moves),
            };
            walk.line(line, &waits, to);
        } else {
            while walk.made < to.len() && walk.held.is_none() && walk.refused.is_none() {
                let before = walk.made;
                if has_ramp {
                    walk.arc_of_ramp(&mut run.path, ramp, moves, to);
                }
                if walk.made == before {
                    let most = if has_ramp {
                        before.wrapping_add(1)
                    } else {
                        to.len()
                    };
                    let to = to.get_mut(..most).unwrap_or_default();
                    walk.steps(&mut run.path, to, |sweep, _| match timer {
                        Some(timer) => Some(timer.wait(sweep)),
                        None => ramp.wait(sweep, moves),
                    });
                }
                if walk.made == before {
                    break;
                }
            }
        }
        if has_ramp {
            // At most the number of events that were left.
            run.left = run.left.wrapping_sub(walk.taken());
        }
        walk.note(to);
        run.next = walk.refused;
        let made = walk.made;
        if made != 0 {
            self.origin = match &self.segment {
                Some(Segment {
                    command: Command::Rapid { .. },
                    ..
                }) => Origin::Rapid,
                _ => Origin::Feed,
            };
        }
        made
    }
}

/// The waits of steps.
fn waits_of<const N: usize>(steps: &mut [StepEvent<N>]) -> impl ExactSizeIterator<Item = &mut u32> {
    steps.iter_mut().map(|step| &mut step.wait_ticks)
}

/// Most steps that are noted together: counts of a byte per axis hold them.
const MOST: usize = 255;

/// A byte per axis.
#[derive(Copy, Clone, Default)]
struct Lanes {
    /// The first four axes, and the other four.
    words: [u32; 2],
}

impl Lanes {
    /// 1 in the bytes of these axes.
    #[inline(always)]
    const fn of<const N: usize>(axes: u8) -> Lanes {
        // Four bits to the bits 0, 8, 16 and 24; their copies do not overlap.
        const fn spread(bits: u8) -> u32 {
            (bits as u32).wrapping_mul(0x0020_4081) & 0x0101_0101
        }
        let upper = if N > 4 { spread(axes >> 4) } else { 0 };
        Lanes {
            words: [spread(if N > 4 { axes & 15 } else { axes }), upper],
        }
    }

    /// Adds to every byte.
    #[inline(always)]
    const fn add(&mut self, other: Lanes) {
        let ([low, high], [more_low, more_high]) = (self.words, other.words);
        self.words = [low.wrapping_add(more_low), high.wrapping_add(more_high)];
    }

    /// The bytes of the first axes.
    #[inline(always)]
    fn bytes<const N: usize>(self) -> [u8; N] {
        let [low, high] = self.words.map(u32::to_le_bytes);
        core::array::from_fn(|axis| {
            let half = if axis < 4 { low } else { high };
            half.get(axis & 3).copied().unwrap_or(0)
        })
    }

    /// The steps of the first axes: -1 where `negative` has a 1 as well.
    #[inline(always)]
    fn deltas<const N: usize>(self, negative: Lanes) -> [i8; N] {
        let ([low, high], [negative_low, negative_high]) = (self.words, negative.words);
        let words = [
            low | negative_low.wrapping_mul(255),
            high | negative_high.wrapping_mul(255),
        ];
        Lanes { words }.bytes().map(u8::cast_signed)
    }
}

/// What the steps of a move change. Positions and times of the axes are not needed between steps,
/// so they are noted for many of them together.
struct Walk<'a, const N: usize, L: BacklashModel<N>> {
    config: &'a Config<N>,
    longest_interval: u32,
    guard: &'a mut StepGuard<N>,
    take_up: &'a mut TakeUp<N, L>,
    load: &'a mut [i32; N],
    held: &'a mut Option<([i8; N], u64)>,
    /// A step that the ramp did not make.
    refused: Option<Step>,
    /// Number of steps, and of those that were noted.
    made: usize,
    noted: usize,
    /// Since then: axes that stepped, steps of each axis, and those of them that went back.
    moved: u8,
    forth: Lanes,
    back: Lanes,
}

impl<const N: usize, L: BacklashModel<N>> Walk<'_, N, L> {
    /// Whether a take-up may be due before steps in these directions.
    fn may_owe(&self, [axes, negative]: [u8; 2]) -> bool {
        let sweep = 1;
        self.take_up.may_owe(Step {
            axes,
            negative,
            sweep,
        })
    }

    /// Writes steps of a line that owes no take-up. Their waits are written already.
    fn line(&mut self, line: &mut Line<N>, waits: &Waits, to: &mut [StepEvent<N>]) {
        let to = to.get_mut(..waits.count as usize).unwrap_or_default();
        let directions = line.directions();
        let [axes, _] = directions;
        if waits.least < self.longest_interval && self.guard.watches(axes) {
            self.steps(line, to, |_, wait| Some(wait.into()));
        } else {
            let steps = line.fill(to.iter_mut().map(|step| &mut step.delta));
            let steps = steps.map(u32::from);
            self.move_load(directions, &steps);
            self.guard.pass_line(to, &steps, waits.ticks);
            (self.made, self.noted) = (to.len(), to.len());
        }
        if let Some(wait) = waits.long {
            *self.held = line.next().map(|step| (step.deltas(), wait));
        }
    }

    /// Writes steps of an arc up to the end of a quadrant or of a part of the ramp, and times them
    /// after that. Writes none where a step has to be looked at.
    fn arc_of_ramp<P: Moves<N>, R: PathRamp, M: Clone + core::fmt::Debug, const QUEUE: usize>(
        &mut self,
        path: &mut P,
        ramp: &mut R,
        moves: &mut R::Queue<M, QUEUE>,
        to: &mut [StepEvent<N>],
    ) {
        let Some(arc) = path.as_arc() else { return };
        let Some(directions) = arc.directions() else {
            return;
        };
        if self.may_owe(directions) {
            return;
        }
        let room = ramp.room(moves);
        if room == 0 {
            return;
        }
        self.note(to);
        let free = to.get_mut(self.made..).unwrap_or_default();
        let places = free
            .iter_mut()
            .map(|step| (&mut step.wait_ticks, &mut step.delta));
        let run = arc.fill(places, room);
        // Below 256.
        let events = run.events as usize;
        let inside = events.wrapping_sub(run.is_beyond.into());
        let within = free.get_mut(..inside).unwrap_or_default();
        let waits = ramp.fill_swept(waits_of(within));
        let Waits {
            mut ticks,
            mut least,
            ..
        } = waits;
        let (mut steps, mut count) = (run.steps, inside);
        if let (true, Some(last)) = (run.is_beyond, free.get_mut(inside)) {
            match ramp.wait(last.wait_ticks, moves) {
                Some(wait) if wait <= u64::from(MAX_WAIT_TICKS) => {
                    last.wait_ticks = wait as u32;
                    ticks = ticks.wrapping_add(last.wait_ticks);
                    least = least.min(last.wait_ticks);
                    count = events;
                }
                wait => {
                    self.put_off(last, directions, wait);
                    for (steps, delta) in steps.iter_mut().zip(last.delta) {
                        *steps = steps.wrapping_sub(delta.unsigned_abs().into());
                    }
                }
            }
        }
        let end = self.made.wrapping_add(count);
        let [axes, _] = directions;
        self.move_load(directions, &steps);
        if least < self.longest_interval && self.guard.watches(axes) {
            self.look_at(to, end);
        } else {
            let new = to.get(self.made..end).unwrap_or_default();
            self.guard.pass_line(new, &steps, ticks);
            (self.made, self.noted) = (end, end);
        }
    }

    /// Holds a step with a long wait, or gives back one that the ramp refuses.
    #[cold]
    fn put_off(&mut self, step: &StepEvent<N>, [_, negative]: [u8; 2], wait: Option<u64>) {
        match wait {
            Some(wait) => *self.held = Some((step.delta, wait)),
            None => {
                let axes = bits(&step.delta);
                self.refused = Some(Step {
                    axes,
                    negative: negative & axes,
                    sweep: step.wait_ticks,
                });
            }
        }
    }

    /// Compares written steps with the steps of their axes before them, where the axes are watched.
    fn look_at(&mut self, to: &mut [StepEvent<N>], end: usize) {
        let mut moved = 0;
        while self.made < end {
            let Some(step) = to.get(self.made) else { break };
            let axes = bits(&step.delta);
            if self.guard.watches(axes) {
                self.watched(axes, moved, to);
                moved = 0;
            } else {
                moved |= axes;
            }
            self.made = self.made.wrapping_add(1);
        }
        self.moved = moved;
    }

    /// Moves the load in these directions.
    fn move_load(&mut self, [_, negative]: [u8; 2], steps: &[u32; N]) {
        let mut bit = 1_u8;
        for (load, steps) in self.load.iter_mut().zip(steps) {
            *load = if negative & bit == 0 {
                load.wrapping_add_unsigned(*steps)
            } else {
                load.wrapping_sub_unsigned(*steps)
            };
            bit = bit.wrapping_shl(1);
        }
    }

    /// Number of steps taken from the path, the held one included.
    fn taken(&self) -> u32 {
        (self.made as u32).wrapping_add(self.held.is_some().into())
    }

    /// Writes steps to the places that are left. A step that has to be divided, or that waits for a
    /// take-up, is held, and is the last one. `wait` takes the sweep of a step and the wait that is
    /// written in its place.
    fn steps(
        &mut self,
        path: &mut impl Iterator<Item = Step>,
        to: &mut [StepEvent<N>],
        mut wait: impl FnMut(u32, u32) -> Option<u64>,
    ) {
        let (mut moved, mut forth, mut back) = (self.moved, self.forth, self.back);
        let mut made = self.made;
        while let Some(place) = to.get_mut(made) {
            let Some(step) = path.next() else { break };
            let Some(wait) = wait(step.sweep, place.wait_ticks) else {
                self.refused = Some(step);
                break;
            };
            let (axes, negative) = (Lanes::of::<N>(step.axes), Lanes::of::<N>(step.negative));
            place.delta = axes.deltas(negative);
            place.wait_ticks = wait as u32;
            let is_owed = self.take_up.may_owe(step);
            if is_owed || wait > u64::from(MAX_WAIT_TICKS) {
                (self.moved, self.forth, self.back) = (moved, forth, back);
                self.made = made;
                self.hold(wait, is_owed, to);
                return;
            }
            if self.guard.watches(step.axes) {
                self.made = made;
                self.watched(step.axes, moved, to);
                moved = 0;
            } else {
                moved |= step.axes;
            }
            forth.add(axes);
            back.add(negative);
            // Below the length of the slice.
            made = made.wrapping_add(1);
        }
        (self.moved, self.forth, self.back) = (moved, forth, back);
        self.made = made;
    }

    /// Holds a step, already written, that has to be divided or waits for a take-up.
    #[cold]
    #[inline(never)]
    fn hold(&mut self, wait: u64, is_owed: bool, to: &[StepEvent<N>]) {
        self.note(to);
        let Some(place) = to.get(self.made) else {
            return;
        };
        if is_owed {
            self.take_up.turn(&place.delta, *self.load, self.config);
        }
        *self.held = Some((place.delta, wait));
    }

    /// Checks a step, already written, against the steps of its axes before it. `moved` are the
    /// axes of the steps that were not noted.
    #[inline(never)]
    fn watched(&mut self, axes: u8, moved: u8, to: &mut [StepEvent<N>]) {
        let new = to.get(self.noted..self.made).unwrap_or_default();
        if !new.is_empty() {
            self.guard.pass_all(new, moved);
        }
        let Some(place) = to.get_mut(self.made) else {
            return;
        };
        let (longest, wait) = (self.longest_interval, place.wait_ticks);
        place.wait_ticks = self.guard.step_beyond(longest, self.config, wait, axes);
        self.noted = self.made.wrapping_add(1);
    }

    /// Notes the positions and times of the axes after the steps made.
    fn note(&mut self, to: &[StepEvent<N>]) {
        let new = to.get(self.noted..self.made).unwrap_or_default();
        self.guard.pass_all(new, self.moved);
        let (forth, back) = (self.forth.bytes::<N>(), self.back.bytes::<N>());
        for (load, (forth, back)) in self.load.iter_mut().zip(forth.into_iter().zip(back)) {
            let (forth, back) = (i32::from(forth), i32::from(back));
            *load = load.wrapping_add(forth.wrapping_sub(back.wrapping_mul(2)));
        }
        self.noted = self.made;
        (self.moved, self.forth, self.back) = (0, Lanes::default(), Lanes::default());
    }
}
