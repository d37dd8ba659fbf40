//! Planned moves between the lines and the motors.

use husillo_gcode::{Command, Nm, PathMode};
use husillo_interp::{Moves, Step};
use husillo_planner::{Stretch, Tangent, share};

use crate::lines::kept::Kept;
use crate::lines::limits::Limits;
use crate::lines::path_ramp::{MoveQueue, RampParts};
use crate::lines::tangent::tangents;
use crate::lines::tempo::{Pace, Tempo};
use crate::{Config, Segment};

/// A move, or a part of an arc between two stops. Its path is made when it begins.
#[derive(Clone, Debug)]
pub(crate) struct Work<const N: usize, K> {
    pub(crate) kept: K,
    /// Steps of the axes at its end.
    pub(crate) end: [i32; N],
    /// Step direction of each axis over the whole of a straight move.
    pub(crate) heading: [i8; N],
    /// Axes for the guard of the steps, see [`StepGuard`](crate::StepGuard).
    pub(crate) steady: u8,
    pub(crate) events: u32,
    pub(crate) sweep: u64,
    pub(crate) largest_sweep: u32,
    /// Whether it follows the spindle, and whether its first step then waits for the index.
    pub(crate) follows: bool,
    pub(crate) is_indexed: bool,
    /// Time at the programmed speed in ticks, times 2^16; encoder counts, times 2^16, if it follows
    /// the spindle.
    pub(crate) time_q16: u64,
    pub(crate) pace: Pace,
    pub(crate) figure: Figure,
    /// Tag of [`Machine::push`](crate::Machine::push); 0 for the moves of lines.
    pub(crate) tag: u32,
}

/// What a move is, and how its path is made.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Figure {
    Straight,
    /// An arc. Its events and sweeps are the [`Moves::totals_of_arc`] of its path.
    Known,
    /// An arc, or the first part of one, which is walked when it begins.
    Arc,
    /// The path of the part before it continues.
    Continued,
}

/// A stop: no path, no speed.
const STAND: Stretch = Stretch {
    length_nm: 0,
    top_nm_per_s: 1,
    ceiling_nm_per_s: 1,
    obeys_override: false,
    acceleration_nm_per_s2: 1,
    start_nm_per_s: 0,
    upper: None,
    entry_limit_nm_per_s: 0,
};

/// The queue of a machine, and the state at its end.
#[derive(Clone, Debug)]
pub(crate) struct Schedule<const N: usize, P, K: Kept<N>, R: RampParts, const QUEUE: usize> {
    pub(crate) moves: R::Queue<Work<N, K>, QUEUE>,
    limits: Option<Limits<N>>,
    mode: PathMode,
    programmed: [Nm; N],
    /// Start position of the first move in the queue.
    start: [Nm; N],
    lattice: [i32; N],
    /// The steps nearest to a position at which a move may end.
    expected: ([Nm; N], [i32; N]),
    direction: Option<Tangent<N>>,
    /// Whether the last move belongs to a thread.
    is_thread: bool,
    /// Direction of the last step of each axis; 0 where it is unknown.
    heading: [i8; N],
    arc: Option<Parts<N, P, K>>,
    /// Tag of the following moves.
    tag: u32,
}

/// The parts, not yet in the queue, of an arc that is split where an axis with backlash reverses.
#[derive(Clone, Debug)]
struct Parts<const N: usize, P, K> {
    dry: P,
    /// First step of the next part.
    first: Option<Step>,
    kept: K,
    end: [i32; N],
    stretch: Stretch,
    pace: Pace,
    steady: u8,
    ticks_q16: u64,
    total_sweep: u64,
}

impl<const N: usize, P: Moves<N>, K: Kept<N>, R: RampParts, const QUEUE: usize>
    Schedule<N, P, K, R, QUEUE>
{
    pub(crate) fn new(config: &Config<N>) -> Self {
        Schedule {
            moves: R::Queue::new(config.jerk_limits().as_ref()),
            limits: Limits::of(config),
            mode: PathMode::default(),
            programmed: [Nm(0); N],
            start: [Nm(0); N],
            lattice: [0; N],
            expected: ([Nm(0); N], [0; N]),
            direction: None,
            is_thread: false,
            heading: [0; N],
            arc: None,
            tag: 0,
        }
    }

    /// Sets the tag of the following moves.
    pub(crate) const fn set_tag(&mut self, tag: u32) {
        self.tag = tag;
    }

    /// Whether speeds change along the path. Otherwise every move has one speed from first to last
    /// step.
    pub(crate) const fn has_ramps(&self) -> bool {
        self.limits.is_some()
    }

    pub(crate) fn is_full(&self) -> bool {
        self.moves.is_full()
    }

    /// Sets the path mode of the following moves.
    pub(crate) fn set_mode(&mut self, mode: PathMode) {
        self.mode = mode;
    }

    /// A command other than a move has come: the next thread waits for the index again.
    pub(crate) const fn end_thread(&mut self) {
        self.is_thread = false;
    }

    /// The next move is a part of the thread before it.
    #[cfg(feature = "extended")]
    pub(crate) const fn go_on_with_thread(&mut self) {
        self.is_thread = true;
    }

    /// End position of the last move in the queue.
    pub(crate) const fn programmed(&self) -> [Nm; N] {
        self.programmed
    }

    /// The steps of the axes at the end of the last move.
    pub(crate) const fn lattice(&self) -> [i32; N] {
        self.lattice
    }

    /// Keeps the steps nearest to a position, for a move that ends there.
    pub(crate) const fn expect(&mut self, end: [Nm; N], steps: [i32; N]) {
        self.expected = (end, steps);
    }

    /// Whether the last move is completely in the queue.
    pub(crate) const fn is_whole(&self) -> bool {
        self.arc.is_none()
    }

    /// Drops everything; the axes are at `lattice`.
    pub(crate) fn clear(&mut self, programmed: [Nm; N], lattice: [i32; N]) {
        self.moves.clear();
        self.arc = None;
        self.direction = None;
        self.is_thread = false;
        self.heading = [0; N];
        self.programmed = programmed;
        self.start = programmed;
        self.lattice = lattice;
    }

    /// Start position of the first move in the queue.
    pub(crate) const fn start(&self) -> [Nm; N] {
        self.start
    }

    /// The first move has ended at this position.
    pub(crate) const fn set_start(&mut self, end: [Nm; N]) {
        self.start = end;
    }

    /// Plans a move and appends it; the queue has room. `has_backlash` marks the axes that must not
    /// reverse while moving.
    pub(crate) fn push(
        &mut self,
        config: &Config<N>,
        command: &Command<N>,
        has_backlash: [bool; N],
    ) {
        self.push_part_of(None, config, command, has_backlash);
    }

    /// Appends a chord of a curve. Chords follow each other as the curve does: at most the speed of
    /// a circle that is `tolerance` from its chord, and no stop.
    pub(crate) fn push_chord(
        &mut self,
        curve: &Segment<N>,
        tolerance: Option<Nm>,
        config: &Config<N>,
        chord: &Command<N>,
        has_backlash: [bool; N],
    ) {
        let mode = self.mode;
        if tolerance.is_some() {
            self.mode = PathMode::Blend { tolerance };
        }
        self.push_part_of(Some(curve), config, chord, has_backlash);
        self.mode = mode;
    }

    /// Appends a move, which is part of `whole` if there is one.
    fn push_part_of(
        &mut self,
        whole: Option<&Segment<N>>,
        config: &Config<N>,
        command: &Command<N>,
        has_backlash: [bool; N],
    ) {
        let Some(to) = command.end() else { return };
        let segment = Segment {
            from: self.programmed,
            command: *command,
        };
        let end = match self.expected {
            (at, steps) if at == to => steps,
            // `Config::check` has verified that every position has a step.
            _ => config.nearest_steps(&to).unwrap_or(self.lattice),
        };
        let path: P = config.path(&segment, self.lattice, end);
        let mut tempo = config.tempo(&segment, &path);
        if self.has_ramps() {
            tempo = tempo.limited(config.timer_hz);
        }
        let ways = directions(&self.lattice, &end);
        let steady = match &tempo.round {
            Some(round) => config.circle_axes(round.plane),
            None => steady(config, &self.lattice, &end, path.remaining()),
        };
        self.programmed = to;
        self.lattice = end;
        let counts_q16 = config.counts_q16(&segment, &tempo);
        let is_thread = matches!(command, Command::Thread { .. });
        // A thread of several moves continues without waiting for the index.
        let is_indexed = is_thread && !self.is_thread;
        self.is_thread = is_thread;
        let ticks_q16 = match tempo.pace.programmed_q16 {
            0 => tempo.pace.least_q16,
            programmed => programmed,
        };
        if self.has_ramps() && tempo.length_nm == 0 && ticks_q16 == 0 && counts_q16.is_none() {
            // Neither distance nor time: no effect on the path.
            return;
        }
        let mut stretch = match counts_q16 {
            None => self.join(config, &segment, &tempo),
            // The speed of the spindle is not planned, so the path stops before and after the move.
            Some(_) => {
                self.direction = None;
                STAND
            }
        };
        let is_round = tempo.round.is_some();
        if is_round && counts_q16.is_none() && self.has_ramps() && has_backlash.contains(&true) {
            self.arc = Some(Parts {
                total_sweep: path.total_sweep(),
                dry: path,
                first: None,
                kept: K::of(&segment, whole),
                end,
                stretch,
                pace: tempo.pace,
                steady,
                ticks_q16,
            });
            self.push_part(false, has_backlash);
            return;
        }
        if !is_round && self.turns(ways, has_backlash) {
            stretch.entry_limit_nm_per_s = 0;
        }
        let work = Work {
            kept: K::of(&segment, whole),
            end,
            heading: if is_round { [0; N] } else { ways },
            steady,
            events: path.remaining(),
            sweep: path.total_sweep(),
            largest_sweep: path.largest_sweep(),
            follows: counts_q16.is_some(),
            is_indexed,
            time_q16: counts_q16.unwrap_or(ticks_q16),
            pace: tempo.pace,
            figure: match (is_round, path.totals_of_arc()) {
                (false, _) => Figure::Straight,
                (true, Some(_)) => Figure::Known,
                (true, None) => Figure::Arc,
            },
            tag: self.tag,
        };
        // The caller has checked that there is room.
        let _ = self.moves.push(stretch, work);
    }

    /// Stores the directions of a straight move. Returns whether an axis with backlash reverses.
    #[inline]
    fn turns(&mut self, ways: [i8; N], has_backlash: [bool; N]) -> bool {
        let mut turns = false;
        for ((heading, way), has_backlash) in self.heading.iter_mut().zip(ways).zip(has_backlash) {
            turns |= way != 0 && way != *heading && has_backlash;
            *heading = if way == 0 { *heading } else { way };
        }
        turns
    }

    /// The move with its junction to the previous one; its end direction replaces the stored one.
    fn join(&mut self, config: &Config<N>, segment: &Segment<N>, tempo: &Tempo<N>) -> Stretch {
        let Some(limits) = &self.limits else {
            return STAND;
        };
        let Some([first, last]) = tangents(config, segment, tempo, P::HAS_ELLIPSES) else {
            self.direction = None;
            return STAND;
        };
        // The speed of a spiral is not planned at its ends, so the path stops there.
        let is_spiral = tempo.round.is_some_and(|round| round.is_spiral());
        let entry_limit_nm_per_s = match &self.direction {
            Some(before) if !is_spiral => limits.junction(self.mode, before, &first),
            _ => 0,
        };
        self.direction = (!is_spiral).then_some(last);
        Stretch {
            entry_limit_nm_per_s,
            ..limits.stretch(tempo, &first)
        }
    }

    /// Appends the next part of an arc, up to where an axis with backlash reverses. The queue has
    /// room. `is_continued` is whether there is a part before it.
    pub(crate) fn push_part(&mut self, is_continued: bool, has_backlash: [bool; N]) {
        let Some(mut arc) = self.arc.take() else {
            return;
        };
        let (mut events, mut sweep, mut largest_sweep) = (0_u32, 0_u64, 0_u32);
        let mut is_stop = is_continued;
        while let Some(step) = arc.first.take().or_else(|| arc.dry.next()) {
            let ways: [i8; N] = step.deltas();
            let axes = ways.iter().zip(&self.heading).zip(has_backlash);
            let turns = axes
                .into_iter()
                .any(|((way, heading), has_backlash)| *way != 0 && way != heading && has_backlash);
            if turns && events > 0 {
                arc.first = Some(step);
                break;
            }
            is_stop |= turns;
            for (heading, way) in self.heading.iter_mut().zip(ways) {
                *heading = if way == 0 { *heading } else { way };
            }
            // At most 2^31 events, each below 2^32.
            events = events.wrapping_add(1);
            sweep = sweep.wrapping_add(step.sweep.into());
            largest_sweep = largest_sweep.max(step.sweep);
        }
        let mut stretch = arc.stretch;
        stretch.length_nm = share(arc.stretch.length_nm, sweep, arc.total_sweep);
        if is_stop {
            stretch.entry_limit_nm_per_s = 0;
        }
        let ticks_q16 = share(arc.ticks_q16, sweep, arc.total_sweep);
        let work = Work {
            kept: arc.kept.clone(),
            end: arc.end,
            heading: [0; N],
            steady: arc.steady,
            events,
            sweep,
            largest_sweep,
            follows: false,
            is_indexed: false,
            time_q16: ticks_q16,
            pace: arc.pace,
            figure: if is_continued {
                Figure::Continued
            } else {
                Figure::Arc
            },
            tag: self.tag,
        };
        let _ = self.moves.push(stretch, work);
        if arc.first.is_some() {
            self.arc = Some(arc);
        }
    }
}

/// Mask of the axes of a line that are no slower than a longest one: two of their steps are at
/// least an event apart, which is the interval of that axis.
fn steady<const N: usize>(config: &Config<N>, from: &[i32; N], to: &[i32; N], events: u32) -> u8 {
    let axes = || config.axes.iter().zip(from.iter().zip(to));
    let longest = axes().filter(|(_, (from, to))| from.abs_diff(**to) == events);
    let slowest = longest.map(|(axis, _)| axis.max_rate_hz).min();
    let (mut mask, mut bit) = (0, 1_u8);
    for (axis, _) in axes() {
        if Some(axis.max_rate_hz) >= slowest {
            mask |= bit;
        }
        bit = bit.wrapping_shl(1);
    }
    mask
}

/// Sign of the distance of each axis.
fn directions<const N: usize>(from: &[i32; N], to: &[i32; N]) -> [i8; N] {
    let mut signs = [0; N];
    for (sign, (from, to)) in signs.iter_mut().zip(from.iter().zip(to)) {
        // Compared, because the difference may not fit.
        *sign = i8::from(to > from).wrapping_sub(i8::from(to < from));
    }
    signs
}
