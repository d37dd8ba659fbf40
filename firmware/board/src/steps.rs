//! The queue between the foreground and the step interrupt.

use critical_section::CriticalSection;

use crate::{Pins, chosen::LONGEST_US};

/// A queued step. `D` is returned to the foreground if the step is dropped.
#[derive(Clone, Copy)]
pub struct Step<D> {
    /// Microseconds after the previous step.
    pub wait_us: u32,
    /// Levels of the motors' pins after this step.
    pub levels: Pins,
    /// Data for the foreground.
    pub delta: D,
}

/// What is due at the end of the current wait.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Due {
    /// There is no wait.
    Nothing,
    /// The rest of the next step's wait. The whole wait is longer than the board's timer accepts.
    Rest,
    /// The next step.
    Step,
    /// The end of the pulse of that step.
    Fall,
    /// The end of the pulse of that step, after which no wait may begin.
    LastFall,
    /// There is no wait, and none may begin.
    Held,
}

/// A queue of `PLACES` steps, a power of two up to 128. The foreground fills it; the interrupt
/// writes the levels and pops.
///
/// In a step, the pins of `PULSED` are high for the time of [`set_pulse_us`], then low. The wait of
/// the next step counts from the rise.
///
/// [`set_pulse_us`]: Steps::set_pulse_us
///
/// A queue of `heapless` takes twice the instructions in the interrupt. The small fields come
/// first, because the short instructions of a Cortex-M0 reach 32 bytes.
#[repr(C)]
pub struct Steps<D, const PLACES: usize, const PULSED: Pins = 0> {
    /// Numbers of steps queued and made, wrapping. Modulo `PLACES` they are indices of slots.
    queued: u8,
    made: u8,
    due: Due,
    /// The previous step had a pulse, so that part of the next wait is already over.
    has_pulsed: bool,
    /// Pins of `PULSED` whose pulse is low.
    inverted: Pins,
    pulse_us: u32,
    places: [Step<D>; PLACES],
}

impl<D: Copy, const PLACES: usize, const PULSED: Pins> Steps<D, PLACES, PULSED> {
    /// An empty queue; `delta` fills the slots.
    pub const fn new(delta: D) -> Self {
        const {
            assert!(
                PLACES.is_power_of_two() && PLACES <= 128,
                "they wrap with the counters"
            )
        };
        let blank = Step {
            wait_us: 0,
            levels: 0,
            delta,
        };
        Steps {
            places: [blank; PLACES],
            queued: 0,
            made: 0,
            due: Due::Nothing,
            has_pulsed: false,
            inverted: 0,
            // Zero, so that the queue of a firmware takes no flash.
            pulse_us: 0,
        }
    }

    /// Inverts pins of `PULSED`. The queue must be empty.
    pub fn invert(&mut self, pins: Pins) {
        self.inverted = pins & PULSED;
    }

    /// Sets how long the pins of `PULSED` are high in a step, from now on.
    pub fn set_pulse_us(&mut self, us: u32) {
        self.pulse_us = us;
    }

    /// The pins of `PULSED` whose pulse is low.
    pub fn inverted(&self) -> Pins {
        self.inverted
    }

    /// Acts at the end of a wait. The step interrupt calls this.
    #[inline]
    pub fn on_time(&mut self, section: CriticalSection<'_>) {
        if self.due != Due::Step {
            return self.go_on(section);
        }
        let levels = self.place(self.made).levels;
        if PULSED == 0 {
            crate::write(levels);
        } else {
            crate::write(levels ^ self.inverted);
            self.has_pulsed = levels & PULSED != 0;
            if self.has_pulsed {
                self.due = Due::Fall;
                return crate::wait(self.pulse_us, section);
            }
        }
        self.made = self.made.wrapping_add(1);
        self.next(section);
    }

    /// Begins the wait of the next step, or the next part of it.
    #[inline]
    fn next(&mut self, section: CriticalSection<'_>) {
        if self.made == self.queued {
            self.due = Due::Nothing;
            return crate::stop();
        }
        if PULSED != 0 && self.has_pulsed {
            self.has_pulsed = false;
            let pulse_us = self.pulse_us;
            let step = self.place(self.made);
            step.wait_us = step.wait_us.saturating_sub(pulse_us);
        }
        let step = self.place(self.made);
        match step.wait_us.checked_sub(LONGEST_US) {
            Some(rest_us) if rest_us > 0 => {
                step.wait_us = rest_us;
                self.due = Due::Rest;
                crate::wait(LONGEST_US, section);
            }
            _ => {
                let wait_us = step.wait_us;
                self.due = Due::Step;
                crate::wait(wait_us, section);
            }
        }
    }

    #[cold]
    fn go_on(&mut self, section: CriticalSection<'_>) {
        match self.due {
            Due::Rest => self.next(section),
            Due::Fall | Due::LastFall => {
                let levels = self.place(self.made).levels & !PULSED;
                crate::write(levels ^ self.inverted);
                self.made = self.made.wrapping_add(1);
                if self.due == Due::Fall {
                    return self.next(section);
                }
                self.due = Due::Held;
                crate::stop();
            }
            _ => crate::stop(),
        }
    }

    /// Queues a step. If the queue was empty, its wait begins now. The caller counts the steps and
    /// calls this only when there is room.
    #[inline]
    pub fn push(&mut self, step: Step<D>, section: CriticalSection<'_>) {
        *self.place(self.queued) = step;
        self.queued = self.queued.wrapping_add(1);
        if self.due == Due::Nothing {
            self.next(section);
        }
    }

    /// Holds the steps until [`release`](Steps::release) or [`stop`](Steps::stop). A pulse that has
    /// begun still ends. An interrupt may call this.
    #[inline]
    pub fn hold(&mut self) {
        if self.is_pulsing() {
            self.due = Due::LastFall;
        } else {
            crate::stop();
            self.due = Due::Held;
        }
    }

    /// Whether a pulse has begun and not ended, so that its step is not yet counted.
    #[inline]
    pub fn is_pulsing(&self) -> bool {
        PULSED != 0 && matches!(self.due, Due::Fall | Due::LastFall)
    }

    /// Resumes the steps. The next step comes its wait after the previous step, or at once if that
    /// time has passed.
    #[inline]
    pub fn release(&mut self, section: CriticalSection<'_>) {
        match self.due {
            Due::Held => self.next(section),
            Due::LastFall => self.due = Due::Fall,
            _ => {}
        }
    }

    /// Whether another step can be queued.
    #[inline]
    pub fn has_room(&self) -> bool {
        // At most `PLACES` steps are queued, and that is at most 128.
        usize::from(self.queued.wrapping_sub(self.made)) < PLACES
    }

    /// Whether no step is queued.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.made == self.queued
    }

    /// The number of steps made, wrapping.
    #[inline]
    pub fn made(&self) -> u8 {
        self.made
    }

    /// Drops all queued steps and returns them, the last one first. No pulse may have begun: see
    /// [`is_pulsing`](Steps::is_pulsing).
    pub fn stop(&mut self) -> impl Iterator<Item = Step<D>> {
        crate::stop();
        self.due = Due::Nothing;
        core::iter::from_fn(|| {
            if self.queued == self.made {
                return None;
            }
            self.queued = self.queued.wrapping_sub(1);
            Some(*self.place(self.queued))
        })
    }

    #[inline]
    fn place(&mut self, number: u8) -> &mut Step<D> {
        &mut self.places[usize::from(number) % PLACES]
    }
}
