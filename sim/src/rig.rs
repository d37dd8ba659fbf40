//! The machine: axes and a clock.

use husillo_stepper::Levels;

use std::fmt;
use std::sync::Arc;

use crate::axis::Axis;
use crate::{AxisModel, LashField, Loss};

/// How many losses are kept with their place; all are counted.
const KEPT: usize = 16;

/// A simulated machine of `N` axes.
///
/// Starts homed: rotors at rest in the equilibrium of the first levels, every nut on the flank of positive motion, the
/// tool at zero. Costs a comparison an axis and event, and a table look-up where the levels changed.
#[derive(Clone)]
pub struct Rig<const N: usize> {
    axes: [Axis; N],
    now: u64,
    events: u64,
    losses: Vec<Loss>,
    field: Option<Arc<dyn LashField<N>>>,
}

impl<const N: usize> fmt::Debug for Rig<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Rig")
            .field("axes", &self.axes)
            .field("now", &self.now)
            .field("events", &self.events)
            .field("losses", &self.losses)
            .finish_non_exhaustive()
    }
}

impl<const N: usize> Rig<N> {
    /// Axes as modelled, with the levels that hold them at home.
    #[must_use]
    pub fn new(models: [AxisModel; N], levels: [Levels; N]) -> Rig<N> {
        let mut levels = levels.into_iter();
        let axes = models.map(|model| Axis::new(model, levels.next().unwrap_or_default()));
        // The rotors have rested for ever: the first step is never too early.
        Rig {
            axes,
            now: 1 << 32,
            events: 0,
            losses: Vec::new(),
            field: None,
        }
    }

    /// A machine that was moved before: its tool is at these steps of the drives, still on the
    /// flanks of positive motion.
    #[must_use]
    pub fn with_tool_at(mut self, steps: [i32; N]) -> Rig<N> {
        for (axis, steps) in self.axes.iter_mut().zip(steps) {
            axis.call(steps);
        }
        self.follow_field();
        self
    }

    /// Screws whose play is another at every place, instead of the models' one value. Costs a look-up an event.
    #[must_use]
    pub fn with_lash_field(mut self, field: Arc<dyn LashField<N>>) -> Rig<N> {
        self.field = Some(field);
        self.follow_field();
        self
    }

    /// The play where the tools are now.
    fn follow_field(&mut self) {
        if let Some(field) = &self.field {
            let lash = field.lash_steps(self.axes.each_ref().map(Axis::nut_steps));
            for (axis, lash) in self.axes.iter_mut().zip(lash) {
                axis.set_lash(lash);
            }
        }
    }

    /// Waits `wait_ticks` timer ticks, then presents `levels` to all drivers at once.
    #[inline]
    pub fn apply(&mut self, levels: &[Levels; N], wait_ticks: u32) {
        self.now += u64::from(wait_ticks);
        for (index, (axis, levels)) in self.axes.iter_mut().zip(levels).enumerate() {
            if axis.levels() != levels.0 {
                if let Some((steps, cause)) = axis.change(levels.0, self.now) {
                    if self.losses.len() < KEPT {
                        self.losses.push(Loss {
                            event: self.events,
                            axis: index,
                            steps,
                            cause,
                        });
                    }
                }
            }
        }
        self.events += 1;
        self.follow_field();
    }

    /// Holds the rotor of an axis where it is, or lets it go: a chip in the guide, an end stop. While it is held every change of
    /// its field is lost.
    pub fn block(&mut self, axis: usize, is_blocked: bool) {
        if let Some(axis) = self.axes.get_mut(axis) {
            axis.block(is_blocked);
        }
    }

    /// Turns the rotor of an axis by about so many steps against its field, as a load that is stronger does, and returns by how many:
    /// with coils by whole electrical cycles, where it rests again.
    pub fn push(&mut self, axis: usize, steps: i32) -> i32 {
        self.axes.get_mut(axis).map_or(0, |axis| axis.push(steps))
    }

    /// Lets `wait_ticks` timer ticks pass.
    pub fn wait(&mut self, wait_ticks: u64) {
        self.now += wait_ticks;
    }

    /// Where the tool is, in steps of the drives.
    #[inline]
    #[must_use]
    pub fn tool(&self) -> [i32; N] {
        self.axes.each_ref().map(Axis::tool)
    }

    /// Where the rotors are, in steps of the drives; before the lash.
    #[inline]
    #[must_use]
    pub fn motor(&self) -> [i32; N] {
        self.axes.each_ref().map(Axis::motor)
    }

    /// Steps lost by each motor since the start.
    #[must_use]
    pub fn lost_steps(&self) -> [u64; N] {
        self.axes.each_ref().map(|axis| axis.lost_steps)
    }

    /// The first sixteen losses, with event and axis.
    #[must_use]
    pub fn losses(&self) -> &[Loss] {
        &self.losses
    }

    /// Events applied so far.
    #[must_use]
    pub const fn events(&self) -> u64 {
        self.events
    }

    /// Timer ticks passed since the start.
    #[must_use]
    pub const fn elapsed_ticks(&self) -> u64 {
        self.now - (1 << 32)
    }
}
