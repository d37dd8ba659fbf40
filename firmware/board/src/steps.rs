//! The queue between the foreground and the step interrupt.

use heapless::spsc::Queue;

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

/// Steps that wait, one less than `PLACES`. The foreground fills it; the interrupt pops and writes.
pub struct Steps<D, const PLACES: usize> {
    queue: Queue<Step<D>, PLACES>,
    /// Its wait runs.
    due: Option<Step<D>>,
    made: u8,
}

impl<D, const PLACES: usize> Steps<D, PLACES> {
    /// None.
    #[expect(clippy::new_without_default, reason = "a static")]
    pub const fn new() -> Self {
        Steps {
            queue: Queue::new(),
            due: None,
            made: 0,
        }
    }

    /// The step interrupt: a wait is over.
    #[inline]
    pub fn on_time(&mut self) {
        if let Some(step) = self.due.take() {
            crate::write(step.levels);
            self.made = self.made.wrapping_add(1);
        }
        self.next();
    }

    /// Begins the wait of the next step.
    #[inline]
    fn next(&mut self) {
        self.due = self.queue.dequeue();
        if let Some(step) = &self.due {
            crate::wait(step.wait_us);
        }
    }

    /// Queues a step; where none waits its wait begins now. The foreground counts: there is room.
    #[inline]
    pub fn push(&mut self, step: Step<D>) {
        let _ = self.queue.enqueue(step);
        if self.due.is_none() {
            self.next();
        }
    }

    /// How many were made, wrapping.
    #[inline]
    pub fn made(&self) -> u8 {
        self.made
    }

    /// No step is made any more: those that waited, in their order.
    #[inline]
    pub fn stop(&mut self) -> impl Iterator<Item = Step<D>> {
        crate::stop();
        let due = self.due.take();
        due.into_iter()
            .chain(core::iter::from_fn(|| self.queue.dequeue()))
    }
}
