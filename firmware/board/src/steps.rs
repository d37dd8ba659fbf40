//! The queue between the foreground and the step interrupt.

/// A step that waits for its time; `D` is what the foreground wants back of one that is dropped.
#[derive(Clone, Copy)]
pub struct Step<D> {
    /// Microseconds after the one before.
    pub wait_us: u32,
    /// The motors' pins from then on.
    pub levels: u8,
    /// Of the foreground.
    pub delta: D,
}

/// `PLACES` steps that wait, a power of two up to 128. The foreground fills it; the interrupt writes and pops.
///
/// Of `heapless` the same queue takes twice the instructions in the interrupt.
pub struct Steps<D, const PLACES: usize> {
    places: [Step<D>; PLACES],
    /// Steps queued and made, wrapping: where they are, too.
    queued: u8,
    made: u8,
    /// The wait of the next one runs.
    is_due: bool,
    /// None begins.
    is_held: bool,
}

impl<D: Copy, const PLACES: usize> Steps<D, PLACES> {
    /// None; `delta` fills the places.
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
            is_due: false,
            is_held: false,
        }
    }

    /// The step interrupt: a wait is over.
    #[inline]
    pub fn on_time(&mut self) {
        if self.is_due {
            crate::write(self.place(self.made).levels);
            self.made = self.made.wrapping_add(1);
            self.next();
        }
    }

    /// Begins the wait of the next step.
    #[inline]
    fn next(&mut self) {
        self.is_due = self.made != self.queued;
        if self.is_due {
            crate::wait(self.place(self.made).wait_us);
        }
    }

    /// Queues a step; where none waits its wait begins now. The foreground counts: there is room.
    #[inline]
    pub fn push(&mut self, step: Step<D>) {
        *self.place(self.queued) = step;
        self.queued = self.queued.wrapping_add(1);
        if !self.is_due && !self.is_held {
            self.next();
        }
    }

    /// For an interrupt: no step is made any more until [`release`](Steps::release), or [`stop`](Steps::stop).
    #[inline]
    pub fn hold(&mut self) {
        crate::stop();
        self.is_due = false;
        self.is_held = true;
    }

    /// They go on; the next one with its whole wait.
    #[inline]
    pub fn release(&mut self) {
        if self.is_held {
            self.is_held = false;
            self.next();
        }
    }

    /// How many were made, wrapping.
    #[inline]
    pub fn made(&self) -> u8 {
        self.made
    }

    /// None of those that wait is made: they are given back, the last one first.
    pub fn stop(&mut self) -> impl Iterator<Item = Step<D>> {
        self.hold();
        self.is_held = false;
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
