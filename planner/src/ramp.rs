//! Timing of the events of the executing move.

mod course;
mod piece;
mod root;
mod slowness;
mod standstill;
mod sweeps;

use crate::{
    Limits, Stretch, Timer, Waits,
    quotient::quotient,
    stretch::square,
    timer::{bits, scaled_quotient},
};

use course::{Course, LONGEST, Part, Way};
pub use piece::Piece;
use piece::{Shape, by_differences};
use root::Root;
pub(crate) use root::whole_root;
use slowness::{Slowness, part};
use standstill::{First, MOST};
use sweeps::{Law, Span};

/// Times the events of the executing move, so that the path speed is as high as top speed,
/// acceleration and the end of the move allow.
///
/// The square of the speed is linear in the path, so it is known exactly at every event. The root
/// is computed only at the ends of a *piece* of events. Within a piece a cubic gives the times of
/// the events. It has the exact time and the exact speeds at both ends. Next to standstill a table
/// of square roots is used instead.
///
/// - **Time.** A ramp takes the difference of its end speeds divided by the acceleration, for any
///   division into pieces. So there is no drift. At constant speed the times add up to exactly the
///   programmed ones. The fraction of a tick is carried from event to event and from move to move.
/// - **Within a piece** an event is at most 0.04 of its interval off. The acceleration exceeds its
///   limit by at most 3.6 % in the first 300 events from standstill, and by 2 % later;
///   `course.rs` has the proof.
/// - **A change** of the limits, a hold and its end take effect at the next event. The speed there
///   is exact. The difference between the exact time and the time given so far is added to the next
///   piece.
/// - **Corners of the profile.** An event in which the acceleration changes is timed by the mean of
///   its end speeds.
///
/// # Cost
/// An event takes three 64-bit additions. An event within 64 events of standstill takes two 16-bit
/// products. A piece takes a root and about twenty products, but no long division.
///
/// # Examples
/// ```
/// use husillo_planner::{LookAhead, Ramp, Stretch};
///
/// let stretch = Stretch {
///     length_nm: 100_000, // 100 steps of 1 um
///     top_nm_per_s: 1_000_000,
///     ceiling_nm_per_s: 1_000_000,
///     obeys_override: true,
///     acceleration_nm_per_s2: 50_000_000,
///     start_nm_per_s: 0,
///     upper: None,
///     entry_limit_nm_per_s: 0,
/// };
/// let mut moves = LookAhead::<(), 8>::new();
/// moves.push(stretch, ()).unwrap();
/// let mut ramp = Ramp::new(1_000_000);
/// // At 1 mm/s the whole move takes 100 000 us.
/// ramp.begin(&stretch, 100, 1, 100_000 << 16);
/// let waits: Vec<u64> = (0..100).map_while(|_| ramp.wait(1, moves.limits())).collect();
/// assert_eq!(waits[0], 6_324); // sqrt(2 ds / a)
/// assert_eq!(waits[50], 1_000);
/// assert!(waits[99].abs_diff(6_324) <= 1);
/// ```
#[derive(Clone, Debug)]
pub struct Ramp {
    events: Events,
    /// Fraction of a tick below 2^-32, carried by the timer.
    owed_low: u32,
    span: Span,
    course: Course,
    /// Time by which the given events are too early, in 2^-32 tick.
    late: i64,
    timer_hz: u32,
    /// Whether all events have the sweep 1.
    is_line: bool,
    /// Whether the limits of the move were not applied yet.
    is_new: bool,
    /// The sweep of a grain has this many bits. `grain_rest` is the sweep that is left of a grain.
    grain_bits: u8,
    grain_rest: u64,
    /// Fraction bits of speeds.
    fine_bits: u8,
    /// Timer of the top speed; made when the path reaches it.
    cruise: Timer,
    has_cruise: bool,
    /// Whether all parts of the move at the top speed are below 2^25 ticks. Then an event within
    /// one is less than a quarter of a tick early.
    is_cruise_quick: bool,
    /// Acceleration for which `course.slowness` was computed.
    acceleration: u64,
    /// That of `course.other`; 0 where it is not known.
    upper_acceleration: u64,
    /// Values of the move, kept for a change of the top speed.
    top: u32,
    programmed_top: u32,
    start: u32,
    /// Below this speed the speed may fall at once: the start speed of the move of the last event.
    drop: u32,
    cruise_ticks_q16: u64,
    total_sweep: u64,
    largest_sweep: u32,
}

/// The coming events. What each of them needs is together, within the reach of short instructions.
#[derive(Copy, Clone, Debug, Default)]
struct Events {
    piece: Piece,
    owed: u32,
    /// Version of the limits for which the events were chosen.
    version: u32,
    table: Table,
}

/// The events next to standstill.
#[derive(Copy, Clone, Debug, Default)]
struct Table {
    first: First,
    left: u32,
    /// Number of the next event, counted from standstill.
    number: u32,
    /// 1 after a start, -1 before a stop.
    step: i32,
}

impl Table {
    /// Takes the next event, but not the last one.
    #[inline]
    fn next(&mut self) -> u64 {
        self.left = self.left.wrapping_sub(1);
        let interval = self.first.interval(self.number);
        self.number = self.number.wrapping_add_signed(self.step);
        interval
    }
}

impl Ramp {
    /// Creates a ramp at standstill. Waits are in ticks of `timer_hz`.
    pub fn new(timer_hz: u32) -> Ramp {
        Ramp {
            events: Events::default(),
            owed_low: 0,
            span: Span::default(),
            course: Course::default(),
            late: 0,
            timer_hz,
            is_line: true,
            is_new: true,
            grain_bits: 0,
            grain_rest: 0,
            fine_bits: 0,
            cruise: Timer::new(0, 1, 1),
            has_cruise: false,
            is_cruise_quick: false,
            acceleration: 0,
            upper_acceleration: 0,
            top: 1,
            programmed_top: 1,
            start: 0,
            drop: 0,
            cruise_ticks_q16: 0,
            total_sweep: 1,
            largest_sweep: 1,
        }
    }

    /// Begins a move. The speed continues from the end of the previous move.
    ///
    /// `total_sweep` is the sum over all events of the move, and `largest_sweep` that of the
    /// largest event. `cruise_ticks_q16` is the time of the whole move at `top_nm_per_s`, in ticks
    /// times 2^16. It contains the exact programmed feed. A move without events is begun with a
    /// sweep of 1, and [`wait`](Ramp::wait) is called once. Its ticks are carried to the next
    /// event.
    ///
    /// # Cost
    /// Three 64-bit divisions, or one if acceleration and speeds are those of the previous move.
    pub fn begin(
        &mut self,
        stretch: &Stretch,
        total_sweep: u64,
        largest_sweep: u32,
        cruise_ticks_q16: u64,
    ) {
        self.leave();
        self.total_sweep = total_sweep.max(1);
        self.largest_sweep = largest_sweep.max(1);
        self.cruise_ticks_q16 = cruise_ticks_q16;
        self.programmed_top = stretch.top_nm_per_s.max(1);
        self.start = stretch.start_nm_per_s;
        self.set_scale(stretch);
        self.course.knee = if stretch.upper.is_some() {
            self.scaled(square(stretch.knee()))
        } else {
            u64::MAX
        };
        let highest = square(stretch.entry_limit_nm_per_s);
        // Only a start speed leads to a speed above the limit of a junction. From a start speed the
        // speed may fall at once.
        if self.square_nm() > highest {
            self.course.set_square(self.scaled(highest));
        }
        // An interval at a tenth of the speed is below 2^31 ticks.
        let is_quick = bits(cruise_ticks_q16).saturating_sub(bits(self.total_sweep)) < 42;
        self.is_line = self.largest_sweep == 1
            && is_quick
            && self.total_sweep <= u64::from(u32::MAX)
            && stretch.upper.is_none()
            && self.course.slowness.fraction_bits == 32;
        self.course.stops_whole = self.is_line;
        // An event has up to 64 grains, and a move at most 2^31.
        let event_bits = bits(self.largest_sweep.into()).saturating_sub(1);
        let total_bits = bits(self.total_sweep).saturating_sub(31);
        let grain_bits = event_bits.saturating_sub(6).max(total_bits).min(event_bits);
        self.course.parts = event_bits.wrapping_sub(grain_bits) as u8;
        self.grain_bits = grain_bits as u8;
        self.divide_into_grains(stretch);
        self.is_new = true;
    }

    /// Computes the number of grains, and the change of the squared speed over a grain.
    fn divide_into_grains(&mut self, stretch: &Stretch) {
        let grain = u32::from(self.grain_bits);
        let grains = self.total_sweep.wrapping_shr(grain);
        self.course.left = grains.min(u32::MAX.into()) as u32;
        self.grain_rest = self.total_sweep & 1_u64.wrapping_shl(grain).wrapping_sub(1);
        // The length per sweep has 62 or 63 bits.
        let length = stretch.length();
        let length_bits = 62_u32
            .wrapping_add(bits(self.total_sweep))
            .wrapping_sub(bits(length));
        let (per_sweep, _) = scaled_quotient(length, self.total_sweep, length_bits as u8);
        let double = stretch.double_acceleration();
        let lower = self.gain_of_grain(per_sweep, length_bits, double);
        (self.course.path, self.course.wide) = lower;
        if stretch.upper.is_some() {
            let upper = self.gain_of_grain(per_sweep, length_bits, stretch.double_upper());
            (self.course.other.path, self.course.other.wide) = upper;
        }
    }

    /// The change of the square over a grain with twice this acceleration, and its unit.
    fn gain_of_grain(&self, per_sweep: u64, length_bits: u32, double: u64) -> (u64, u8) {
        // 63 and 41 bits.
        let product = u128::from(per_sweep).wrapping_mul(double.into());
        let up = u32::from(self.fine_bits)
            .wrapping_mul(2)
            .wrapping_add(self.grain_bits.into());
        // Rounded up, so that braking over the whole move takes no longer than the look-ahead
        // assumes.
        let gain = match length_bits.checked_sub(up) {
            Some(shift) if shift < 128 => product.wrapping_shr(shift),
            Some(_) => 0,
            None => u128::MAX,
        }
        .saturating_add(1);
        let wide = 66_u32.saturating_sub(gain.leading_zeros());
        let mut path = gain.wrapping_shr(wide) as u64;
        if wide != 0 {
            // At most 2^62.
            path = path.wrapping_add(1).min((1 << 62) - 1);
        }
        // At most 62.
        (path, wide as u8)
    }

    /// Chooses the units of speeds, and computes the time per unit of speed.
    fn set_scale(&mut self, stretch: &Stretch) {
        self.course.switch(false);
        let acceleration = stretch.double_acceleration() >> 1;
        let upper = stretch.double_upper() >> 1;
        let highest = stretch
            .ceiling_nm_per_s
            .max(stretch.top_nm_per_s)
            .max(self.speed_nm_per_s())
            .max(1);
        let fine_bits = highest.leading_zeros() as u8;
        if fine_bits != self.fine_bits || acceleration != self.acceleration {
            let [new, old] =
                [fine_bits, self.fine_bits].map(|bits| u32::from(bits).wrapping_mul(2));
            let square = self.course.square;
            let square = if new >= old {
                square.wrapping_shl(new.wrapping_sub(old))
            } else {
                square.wrapping_shr(old.wrapping_sub(new))
            };
            self.fine_bits = fine_bits;
            self.acceleration = acceleration;
            self.course.slowness = Slowness::new(self.timer_hz, acceleration, fine_bits);
            self.course.set_square(square);
            self.upper_acceleration = 0;
        }
        if stretch.upper.is_some() && upper != self.upper_acceleration {
            self.upper_acceleration = upper;
            self.course.other.slowness = Slowness::new(self.timer_hz, upper, fine_bits);
        }
    }

    /// Converts a squared speed from (nm/s)^2 to the units of the course; saturates.
    fn scaled(&self, square: u64) -> u64 {
        let shift = u32::from(self.fine_bits).wrapping_mul(2);
        if square.leading_zeros() < shift {
            u64::MAX
        } else {
            square.wrapping_shl(shift)
        }
    }

    /// Returns the squared speed at the end of the present part, in (nm/s)^2.
    fn square_nm(&self) -> u64 {
        self.course
            .square
            .wrapping_shr(u32::from(self.fine_bits).wrapping_mul(2))
    }

    /// Returns the ticks to wait before an event of this `sweep`, which is at most the largest one.
    ///
    /// `limits` are those of [`LookAhead::limits`](crate::LookAhead::limits) at this moment.
    /// Returns `None` when a hold has stopped the path. The event was then not made. Call again
    /// after [`Ramp::resume`].
    #[inline]
    pub fn wait(&mut self, sweep: u32, limits: &Limits) -> Option<u64> {
        if limits.version == self.events.version {
            if let Some(count) = self.events.piece.count.checked_sub(1) {
                self.events.piece.count = count;
                return Some(self.events.piece.step(&mut self.events.owed).into());
            }
            if self.events.table.left > 1 {
                return Some(self.wait_of_table().into());
            }
        }
        self.wait_with_care(sweep, limits)
    }

    /// Writes the waits before the next events of a line, as [`wait`](Ramp::wait) returns them for
    /// a sweep of 1. There are as many as there are places, and no more events than the move has
    /// left. There are fewer where a hold stops the path or where a wait is longer than 2^31 ticks,
    /// and none if the move has events of different sweep.
    ///
    /// `limits` are those of [`LookAhead::limits`](crate::LookAhead::limits) at this moment.
    ///
    /// # Cost
    /// Less than [`wait`](Ramp::wait) for each event: the state of a piece stays in registers.
    ///
    /// # Examples
    /// ```
    /// # use husillo_planner::{LookAhead, Ramp, Stretch};
    /// # let stretch = Stretch {
    /// #     length_nm: 100_000,
    /// #     top_nm_per_s: 1_000_000,
    /// #     ceiling_nm_per_s: 1_000_000,
    /// #     obeys_override: true,
    /// #     acceleration_nm_per_s2: 50_000_000,
    /// #     start_nm_per_s: 0,
    /// #     upper: None,
    /// #     entry_limit_nm_per_s: 0,
    /// # };
    /// # let mut moves = LookAhead::<(), 8>::new();
    /// # moves.push(stretch, ()).unwrap();
    /// let mut ramp = Ramp::new(1_000_000);
    /// ramp.begin(&stretch, 100, 1, 100_000 << 16);
    /// let mut waits = [0; 100];
    /// let written = ramp.fill(waits.iter_mut(), moves.limits());
    /// assert_eq!((written.count, written.least, waits[0]), (100, 1_000, 6_324));
    /// ```
    pub fn fill<'a>(
        &mut self,
        mut places: impl ExactSizeIterator<Item = &'a mut u32>,
        limits: &Limits,
    ) -> Waits {
        let mut waits = Waits::NONE;
        self.follow(limits);
        while self.is_line && places.len() != 0 {
            let Events {
                piece, owed, table, ..
            } = &mut self.events;
            if piece.count != 0 && piece.is_quick() {
                piece.fill(owed, &mut places, &mut waits);
                continue;
            }
            if table.left > 1 && piece.count == 0 && table.first.is_quick() {
                self.fill_from_table(&mut places, &mut waits);
                continue;
            }
            let has_piece = piece.count != 0;
            let wait = if has_piece {
                piece.count = piece.count.wrapping_sub(1);
                piece.step(owed).into()
            } else {
                match self.single() {
                    None => break,
                    Some(None) => continue,
                    Some(Some(time)) => self.carried(time),
                }
            };
            let Some(place) = places.next() else { break };
            if !waits.add(wait, place) {
                break;
            }
        }
        waits
    }

    /// Sweep up to which [`fill_swept`](Ramp::fill_swept) can time the next events of a move with
    /// events of different sweep. 0 where [`wait`](Ramp::wait) has to be called for the next event.
    ///
    /// `limits` are those of [`LookAhead::limits`](crate::LookAhead::limits) at this moment. At
    /// least one event has to be timed before they change, or before a hold.
    pub fn room(&mut self, limits: &Limits) -> u32 {
        self.follow(limits);
        let is_even = self.late == 0 && self.course.slowness.fraction_bits == 32;
        if self.is_line || self.course.is_held || !is_even {
            return 0;
        }
        if self.span.passed == self.span.sweep {
            self.next_span();
        }
        self.span.room()
    }

    /// Replaces the sweeps of the next events by the waits before them, as [`wait`](Ramp::wait)
    /// returns them. Together the sweeps are at most the [`room`](Ramp::room).
    ///
    /// # Cost
    /// Three 32-bit products per event; one at constant speed.
    pub fn fill_swept<'a>(&mut self, places: impl Iterator<Item = &'a mut u32>) -> Waits {
        self.span.fill(&mut self.events.owed, places)
    }

    /// Writes the waits of events next to standstill, but not of the last one.
    fn fill_from_table<'a>(
        &mut self,
        places: &mut impl Iterator<Item = &'a mut u32>,
        waits: &mut Waits,
    ) {
        let Events { table, owed, .. } = &mut self.events;
        let (mut ticks, mut least) = (waits.ticks, waits.least);
        let (before, mut given) = (table.left, 0_u64);
        while table.left > 1 {
            let Some(place) = places.next() else { break };
            let interval = table.next();
            given = given.wrapping_add(interval);
            let time = interval.wrapping_add((*owed).into());
            *owed = time as u32;
            let wait = (time >> 32) as u32;
            *place = wait;
            ticks = ticks.wrapping_add(wait);
            least = least.min(wait);
        }
        waits.count = waits.count.wrapping_add(before.wrapping_sub(table.left));
        (waits.ticks, waits.least) = (ticks, least);
        self.late = self.late.wrapping_sub(given as i64);
    }

    /// Returns the time of an event of a line that is not in a piece. The other results are those
    /// of [`next_events`](Self::next_events).
    fn single(&mut self) -> Option<Option<u64>> {
        if self.events.table.left != 0 {
            Some(Some(self.next_of_table()))
        } else {
            self.next_events()
        }
    }

    /// Returns the whole ticks of a time in units of 2^-32; the fraction is carried.
    fn carried(&mut self, time: u64) -> u64 {
        let time = time.wrapping_add(self.events.owed.into());
        self.events.owed = time as u32;
        time >> 32
    }

    /// Times an event next to standstill, but not the last one.
    #[inline(never)]
    fn wait_of_table(&mut self) -> u32 {
        let interval = self.events.table.next();
        self.late = self.late.wrapping_sub(interval as i64);
        let time = interval.wrapping_add(self.events.owed.into());
        self.events.owed = time as u32;
        (time >> 32) as u32
    }

    /// Returns up to `most` events of a line, for an interrupt that times them by itself. The
    /// interrupt carries the fraction of a tick.
    ///
    /// Returns `None` when a hold has stopped the path. Events next to standstill and events in
    /// which the acceleration changes are returned one by one. A hold or an override does not
    /// change a piece that was returned, so `most` bounds their delay. Moves other than lines need
    /// [`Ramp::wait`].
    pub fn take_piece(&mut self, most: u32, limits: &Limits) -> Option<Piece> {
        if self.events.piece.count == 0 || limits.version != self.events.version {
            self.follow(limits);
        }
        if self.events.piece.count == 0 {
            let single = if self.events.table.left != 0 {
                Some(self.next_of_table())
            } else {
                self.next_events()?
            };
            if let Some(time) = single {
                return Some(Piece {
                    count: 1,
                    interval_q32: time,
                    ..Piece::default()
                });
            }
        }
        Some(self.events.piece.split(most.max(1)))
    }

    /// Times an event that is not in a piece, or that has new limits.
    #[inline(never)]
    fn wait_with_care(&mut self, sweep: u32, limits: &Limits) -> Option<u64> {
        self.follow(limits);
        if !self.is_line {
            return self.wait_swept(sweep);
        }
        let single = if self.events.piece.count == 0 {
            self.single()?
        } else {
            None
        };
        if let Some(time) = single {
            return Some(self.carried(time));
        }
        self.events.piece.count = self.events.piece.count.wrapping_sub(1);
        Some(self.events.piece.step(&mut self.events.owed).into())
    }

    /// Applies the limits if they are new.
    #[inline]
    fn follow(&mut self, limits: &Limits) {
        if self.is_new || limits.version != self.events.version {
            self.take_over(limits);
        }
    }

    fn take_over(&mut self, limits: &Limits) {
        self.events.version = limits.version;
        let top = limits
            .top_nm_per_s
            .min(u32::MAX.wrapping_shr(self.fine_bits.into()))
            .max(1);
        let exit = self.scaled(limits.exit_squared);
        if self.is_new || top != self.top {
            self.leave();
            self.is_new = false;
            self.set_top(top);
        } else if self.course.way == Way::Down || exit < self.course.exit {
            self.leave();
        }
        self.course.exit = exit;
        self.course.look_again();
    }

    /// Returns the time of the next event of a line, or `Some(None)` after it has begun a piece.
    /// `None`: a hold stops the path before the event.
    #[inline(never)]
    fn next_events(&mut self) -> Option<Option<u64>> {
        self.course.left = self.course.left.max(1);
        let time = match self.course.next(MOST) {
            Part::Stop => return None,
            Part::Corner { from, path, .. } => self.course.corner_time(&from, path),
            Part::Level { count } => {
                self.level(count);
                return Some(None);
            }
            Part::Ramp { count, from, gain } => {
                let speeds = self.course.root.speed.abs_diff(from.speed);
                let time = self.course.slowness.time(speeds);
                let ends_at_rest = from.speed == 0 || self.course.square == 0;
                if count > 1 && !ends_at_rest {
                    let shape = Shape::new(&from, &self.course.root, gain);
                    let (piece, rest) = by_differences(count, self.paid(time), &shape);
                    self.events.piece = piece;
                    self.late = self.late.wrapping_add(rest as i64);
                    return Some(None);
                }
                if count > 1 && self.fill_table(count, time, from.speed == 0) {
                    return Some(Some(self.next_of_table()));
                }
                time
            }
        };
        Some(Some(self.paid(time)))
    }

    /// Returns `time` plus the time that is owed. If events were too late, the next ones are at
    /// most 1/128 faster, so that no speed limit is exceeded by more. The remainder stays owed.
    fn paid(&mut self, time: u64) -> u64 {
        // Times are below 2^63.
        let most = (time >> 7) as i64;
        let late = self.late.max(most.wrapping_neg());
        self.late = self.late.wrapping_sub(late);
        time.saturating_add_signed(late)
    }

    /// Begins a piece at constant speed. Its time is rounded up, so that no event is early. The
    /// excess is below 2^-20 tick and is subtracted later.
    fn level(&mut self, count: u32) {
        if !self.has_cruise {
            self.prepare_cruise();
        }
        let bits = self.cruise_bits();
        let time = up_to_q32(self.cruise.product(count.into()), bits);
        let interval = up_to_q32(self.cruise.rate(), bits);
        let whole = interval.wrapping_mul(count.into());
        let rest = (time.wrapping_sub(whole) as i64).wrapping_add(self.late);
        // Rounded up to a multiple of the count.
        let share = quotient(rest.unsigned_abs(), count);
        let share = if rest > 0 {
            share.wrapping_add(1)
        } else {
            // At most 1/128 faster, as in `paid`.
            share.min(interval >> 7).wrapping_neg()
        };
        self.late = rest.wrapping_sub(share.wrapping_mul(count.into()) as i64);
        self.events.piece = Piece {
            count,
            interval_q32: interval.wrapping_add(share),
            change_q32: 0,
            bend_q32: 0,
        };
    }

    /// Begins the events next to standstill. Returns `false` if the first event takes too long for
    /// the table.
    fn fill_table(&mut self, count: u32, time: u64, is_start: bool) -> bool {
        let one = Root::of(self.course.gain());
        let Some(first) = First::new(self.course.slowness.time(one.speed)) else {
            return false;
        };
        self.events.table = Table {
            first,
            left: count,
            number: if is_start { 0 } else { count.wrapping_sub(1) },
            step: if is_start { 1 } else { -1 },
        };
        self.late = self.late.wrapping_add(time as i64);
        true
    }

    /// Returns the interval of the next event next to standstill. The last event takes the rest of
    /// the time.
    fn next_of_table(&mut self) -> u64 {
        if self.events.table.left == 1 {
            self.events.table.left = 0;
            return self.paid(0);
        }
        let interval = self.events.table.next();
        self.late = self.late.wrapping_sub(interval as i64);
        interval
    }

    /// Times an event of a move with events of different sweep.
    fn wait_swept(&mut self, sweep: u32) -> Option<u64> {
        if self.course.is_held && self.would_stop(sweep) {
            self.leave();
            self.course.set_square(0);
            return None;
        }
        let mut rest = u64::from(sweep);
        if rest < self.span.sweep.wrapping_sub(self.span.passed) {
            return Some(self.pass(rest, false));
        }
        let mut ticks = 0_u64;
        loop {
            let room = self.span.sweep.wrapping_sub(self.span.passed);
            if room == 0 {
                if rest == 0 {
                    return Some(ticks);
                }
                self.next_span();
                continue;
            }
            let pass = rest.min(room);
            ticks = ticks.saturating_add(self.pass(pass, pass == room));
            rest = rest.wrapping_sub(pass);
            if rest == 0 {
                return Some(ticks);
            }
        }
    }

    /// Whether a hold stops the path before an event.
    fn would_stop(&self, sweep: u32) -> bool {
        let square = self.square_now();
        let grain = u32::from(self.grain_bits);
        // Below 2^54 2^32.
        let gain = u128::from(self.course.gain()).wrapping_mul(sweep.into());
        let gain = gain.wrapping_shr(grain);
        u128::from(square) <= gain.wrapping_add(self.course.floor.into())
    }

    /// Returns the ticks of a sweep within the present span.
    fn pass(&mut self, sweep: u64, is_end: bool) -> u64 {
        if let Law::Level = self.span.law {
            // The timer keeps the time.
            self.span.passed = self.span.passed.wrapping_add(sweep);
            let time = self.cruise.product(sweep);
            return self.settle(time, self.cruise_bits());
        }
        let time = if is_end {
            self.span.passed = self.span.sweep;
            self.span.time.saturating_sub(self.span.given)
        } else {
            self.span.pass(sweep, &self.course.slowness)
        };
        self.settle(time, self.course.slowness.fraction_bits.into())
    }

    /// Begins the next part of a move with events of different sweep.
    fn next_span(&mut self) {
        let grain = u32::from(self.grain_bits);
        let mut sweep = self.grain_rest;
        let next = if sweep == 0 {
            self.course.left = self.course.left.max(1);
            self.course.next(4)
        } else {
            self.grain_rest = 0;
            self.course.next_rest(sweep, grain)
        };
        let sweep_of = |count: u32| u64::from(count).wrapping_shl(grain);
        match next {
            Part::Level { count } => {
                if !self.has_cruise {
                    self.prepare_cruise();
                }
                // The rest of a grain is zero.
                sweep = sweep.max(sweep_of(count));
                self.span = if self.is_cruise_quick {
                    let time = self.level_time(sweep);
                    Span::level(sweep, time)
                } else {
                    Span::with(sweep, 0, 0, Law::Level)
                };
            }
            Part::Ramp { count, from, gain } => {
                // The rest of a grain is zero.
                sweep = sweep.max(sweep_of(count));
                let root = self.course.root;
                let is_rising = root.speed > from.speed;
                let time = self.course.slowness.time(root.speed.abs_diff(from.speed));
                let end = self.course.square;
                let start = if is_rising {
                    end.wrapping_sub(gain)
                } else {
                    end.wrapping_add(gain)
                };
                // Next to standstill the cubic would be wrong.
                let is_slow = start.min(end)
                    < self
                        .course
                        .gain()
                        .saturating_mul(4_u64.wrapping_shl(self.course.parts.into()));
                self.span = if is_slow {
                    let law = Law::Exact {
                        from: start,
                        speed: from.speed,
                        is_rising,
                    };
                    Span::with(sweep, time, gain, law)
                } else {
                    Span::cubic(sweep, time, gain, &Shape::new(&from, &root, gain))
                };
            }
            Part::Corner { from, change, path } => {
                sweep = if sweep == 0 { sweep_of(1) } else { sweep };
                self.span = Span::even(sweep, self.course.corner_time(&from, path), change);
            }
            // Only lines stop before a grain.
            Part::Stop => self.span = Span::even(sweep, 0, 0),
        }
    }

    /// Returns the time of a sweep at constant speed in 2^-32 tick. The rest is carried.
    fn level_time(&mut self, sweep: u64) -> u64 {
        let time = self.cruise.product_of_many(sweep);
        let bits = self.cruise_bits();
        let Some(down) = bits.checked_sub(32) else {
            return time.wrapping_shl(32_u32.wrapping_sub(bits));
        };
        let low = (time & 1_u64.wrapping_shl(down).wrapping_sub(1)) as u32;
        // Below 2^32.
        let low = low.wrapping_shl(32_u32.wrapping_sub(down));
        let (owed, carries) = self.owed_low.overflowing_add(low);
        self.owed_low = owed;
        time.wrapping_shr(down).wrapping_add(carries.into())
    }

    /// Ends the present part at the present event.
    fn leave(&mut self) {
        if self.is_line {
            self.leave_piece();
        } else {
            self.leave_span();
        }
        self.course.look_again();
    }

    fn leave_piece(&mut self) {
        let count = self.events.piece.count.wrapping_add(self.events.table.left);
        if count == 0 {
            return;
        }
        let end = self.course.root;
        self.course.set_square(self.square_now());
        let given = self.events.piece.time_of(self.events.piece.count);
        let rest = match self.course.way {
            Way::Level => up_to_q32(self.cruise.product(count.into()), self.cruise_bits()),
            _ => self
                .course
                .slowness
                .time(end.speed.abs_diff(self.course.root.speed)),
        };
        self.late = self.late.wrapping_add(given.wrapping_sub(rest) as i64);
        self.course.left = self.course.left.saturating_add(count);
        self.events.piece.count = 0;
        self.events.table.left = 0;
    }

    fn leave_span(&mut self) {
        let rest = self.span.sweep.wrapping_sub(self.span.passed);
        if rest == 0 {
            return;
        }
        let end = self.course.root;
        let square = self.square_now();
        self.course.set_square(square);
        let grain = u32::from(self.grain_bits);
        let whole = rest.wrapping_shr(grain).min(u32::MAX.into()) as u32;
        self.course.left = self.course.left.saturating_add(whole);
        self.grain_rest = rest & 1_u64.wrapping_shl(grain).wrapping_sub(1);
        if self.span.is_level {
            let rest = self.level_time(rest);
            let given = self.span.time.saturating_sub(self.span.given);
            self.late = self.late.wrapping_add(given.wrapping_sub(rest) as i64);
        } else if let Law::Cubic(_) | Law::Exact { .. } = self.span.law {
            let slowness = &self.course.slowness;
            let rest = slowness.time(end.speed.abs_diff(self.course.root.speed));
            let given = self.span.time.saturating_sub(self.span.given);
            let late = (given.wrapping_sub(rest) as i64)
                .wrapping_shl(32_u32.wrapping_sub(slowness.fraction_bits.into()));
            self.late = self.late.wrapping_add(late);
        }
        self.span = Span::default();
    }

    /// Returns the squared speed after the last event.
    fn square_now(&self) -> u64 {
        let end = self.course.square;
        let gain = if self.is_line {
            let count = self.events.piece.count.wrapping_add(self.events.table.left);
            self.course.gain().wrapping_mul(count.into())
        } else {
            self.span
                .gain
                .wrapping_sub(part(self.span.gain, self.span.share()))
        };
        match self.course.way {
            _ if !self.is_line && self.span.passed == self.span.sweep => end,
            Way::Level => end,
            Way::Up => end.saturating_sub(gain),
            Way::Down => end.saturating_add(gain),
        }
    }

    /// Feed hold: the path brakes from the next event on, through as many moves as necessary.
    pub fn hold(&mut self) {
        if !self.course.is_held {
            self.leave();
            self.course.is_held = true;
        }
    }

    /// Ends a hold, even if it has not yet stopped the path.
    pub fn resume(&mut self) {
        if self.course.is_held {
            self.leave();
            self.course.is_held = false;
        }
    }

    /// Whether a hold is active.
    pub const fn is_held(&self) -> bool {
        self.course.is_held
    }

    /// Sets the speed to 0, after a dwell, a take-up or an abort. The next event starts from rest.
    pub fn stop(&mut self) {
        self.leave();
        self.course.set_square(0);
    }

    /// Path speed after the last event in nm/s, rounded down.
    pub fn speed_nm_per_s(&self) -> u32 {
        let speed = Root::of(self.square_now()).speed;
        speed.wrapping_shr(self.fine_bits.into())
    }

    /// Converts a time with this many fraction bits (0 to 63) to whole ticks. The remainder is
    /// carried.
    fn settle(&mut self, time: u64, fraction_bits: u32) -> u64 {
        let time = self.pay(time, fraction_bits);
        if fraction_bits == 32 {
            // Without shifts, which are calls on a Cortex-M0.
            let (owed, carries) = self.events.owed.overflowing_add(time as u32);
            self.events.owed = owed;
            return (time >> 32).saturating_add(carries.into());
        }
        let fraction = if fraction_bits == 0 {
            0
        } else {
            time.wrapping_shl(64_u32.wrapping_sub(fraction_bits))
        };
        let owed = u64::from(self.events.owed) << 32 | u64::from(self.owed_low);
        let (owed, carries) = owed.overflowing_add(fraction);
        self.events.owed = (owed >> 32) as u32;
        self.owed_low = owed as u32;
        time.wrapping_shr(fraction_bits)
            .saturating_add(carries.into())
    }

    /// Adds the owed time to a time with this many fraction bits.
    fn pay(&mut self, time: u64, fraction_bits: u32) -> u64 {
        if self.late == 0 {
            return time;
        }
        let late = i128::from(self.late).wrapping_shl(fraction_bits) >> 32;
        let late = late.clamp(i64::MIN.into(), i64::MAX.into()) as i64;
        self.late = 0;
        match time.checked_add_signed(late) {
            Some(sum) => sum,
            None => {
                // The remainder stays owed.
                let left = time.wrapping_add_signed(late) as i64;
                let left = i128::from(left)
                    .wrapping_shl(32)
                    .wrapping_shr(fraction_bits);
                self.late = left.clamp(i64::MIN.into(), i64::MAX.into()) as i64;
                0
            }
        }
    }

    /// Returns the number of fraction bits of the times of `cruise`, 16 to 63.
    fn cruise_bits(&self) -> u32 {
        u32::from(self.cruise.fraction_bits()).wrapping_add(16)
    }

    /// Applies another top speed.
    #[cold]
    fn set_top(&mut self, top: u32) {
        self.top = top;
        self.course.top = self.scaled(square(top));
        self.course.floor = self.scaled(square(self.start.min(top)));
        if self.square_nm() <= square(self.drop) && self.course.square > self.course.top {
            self.course.set_square(self.course.top);
        }
        self.drop = self.start;
        self.has_cruise = false;
    }

    /// Prepares the timer of the constant speed. Any part of the move takes its share of the
    /// programmed time.
    #[inline(never)]
    fn prepare_cruise(&mut self) {
        self.has_cruise = true;
        let ticks = scale(self.cruise_ticks_q16, self.programmed_top, self.top);
        let longest = u64::from(self.largest_sweep).wrapping_mul(LONGEST.into());
        // Bits of the ticks in 2^-16 of the longest part, or one less.
        let part_bits = bits(ticks)
            .wrapping_add(bits(longest))
            .saturating_sub(bits(self.total_sweep));
        self.is_cruise_quick = part_bits < 41 && self.course.slowness.fraction_bits == 32;
        let largest = if self.is_line || self.is_cruise_quick {
            longest
        } else {
            self.largest_sweep.into()
        };
        self.cruise = Timer::with_most_bits(ticks, self.total_sweep, largest, 47);
    }
}

/// Converts a time with 16 to 63 fraction bits to 32 fraction bits, rounded up. The result fits.
fn up_to_q32(time: u64, bits: u32) -> u64 {
    match bits.checked_sub(32) {
        Some(shift) => {
            let up = 1_u64.wrapping_shl(shift).wrapping_sub(1);
            // At most 2^62 and a carried part.
            time.wrapping_add(up).wrapping_shr(shift)
        }
        None => time.wrapping_shl(32_u32.wrapping_sub(bits)),
    }
}

/// `ticks` `numerator` / `denominator`, which is not 0, rounded down; saturates.
fn scale(ticks: u64, numerator: u32, denominator: u32) -> u64 {
    if numerator == denominator {
        return ticks;
    }
    let numerator = u64::from(numerator);
    let whole = quotient(ticks, denominator);
    let rest = ticks.wrapping_sub(whole.wrapping_mul(denominator.into()));
    // rest and numerator are below 2^32.
    let part = quotient(rest.wrapping_mul(numerator), denominator);
    whole.saturating_mul(numerator).saturating_add(part)
}
