//! Simulated machine: axes and a clock.

use husillo_stepper::Levels;

use std::fmt;
use std::sync::Arc;

use crate::axis::Axis;
use crate::{AxisModel, BacklashField, Loss};

/// Number of losses that are recorded in detail; all are counted.
const KEPT: usize = 16;

/// A simulated machine of `N` axes.
///
/// It starts homed: rotors at rest in the equilibrium of the first levels, every nut on the flank
/// of positive motion, the tool at zero.
///
/// # Cost
/// One comparison per axis and event, and a table look-up where the levels changed.
#[derive(Clone)]
pub struct Rig<const N: usize> {
    axes: [Axis; N],
    /// The present levels at the drivers.
    levels: [Levels; N],
    /// Position of the tool.
    tool: [i32; N],
    /// Losses of steps so far.
    loss_count: u64,
    now: u64,
    events: u64,
    losses: Vec<Loss>,
    field: Option<Arc<dyn BacklashField<N>>>,
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
    /// Creates a rig with these axes; `levels` hold them at home.
    #[must_use]
    pub fn new(models: [AxisModel; N], levels: [Levels; N]) -> Rig<N> {
        let mut first = levels.into_iter();
        let axes = models.map(|model| Axis::new(model, first.next().unwrap_or_default()));
        // The rotors have rested indefinitely, so the first step is never too early.
        Rig {
            tool: axes.each_ref().map(Axis::tool),
            axes,
            levels,
            loss_count: 0,
            now: 1 << 32,
            events: 0,
            losses: Vec::new(),
            field: None,
        }
    }

    /// Sets the tool to these drive steps, as after earlier motion; every nut is on the flank of
    /// positive motion.
    #[must_use]
    pub fn with_tool_at(mut self, steps: [i32; N]) -> Rig<N> {
        for (axis, steps) in self.axes.iter_mut().zip(steps) {
            axis.call(steps);
        }
        self.follow_field();
        self.see_tool();
        self
    }

    /// Uses position-dependent backlash instead of the single value of each model. Costs a look-up
    /// per event.
    #[must_use]
    pub fn with_backlash_field(mut self, field: Arc<dyn BacklashField<N>>) -> Rig<N> {
        self.field = Some(field);
        self.follow_field();
        self
    }

    /// Applies the backlash at the present tool position.
    fn follow_field(&mut self) {
        if let Some(field) = &self.field {
            let backlash = field.backlash_steps(self.axes.each_ref().map(Axis::nut_steps));
            for (axis, backlash) in self.axes.iter_mut().zip(backlash) {
                axis.set_backlash(backlash);
            }
            self.see_tool();
        }
    }

    fn see_tool(&mut self) {
        self.tool = self.axes.each_ref().map(Axis::tool);
    }

    /// Waits `wait_ticks` timer ticks, then applies `levels` to all drivers at once.
    #[inline]
    pub fn apply(&mut self, levels: &[Levels; N], wait_ticks: u32) {
        self.now += u64::from(wait_ticks);
        let axes = self.axes.iter_mut().zip(&mut self.tool);
        let changes = self.levels.iter_mut().zip(levels);
        for (index, ((axis, tool), (before, levels))) in axes.zip(changes).enumerate() {
            if before != levels {
                *before = *levels;
                if let Some((steps, cause)) = axis.change(levels.0, self.now) {
                    self.loss_count += 1;
                    if self.losses.len() < KEPT {
                        self.losses.push(Loss {
                            event: self.events,
                            axis: index,
                            steps,
                            cause,
                        });
                    }
                }
                *tool = axis.tool();
            }
        }
        self.events += 1;
        if self.field.is_some() {
            self.follow_field();
        }
    }

    /// Blocks the rotor of an axis, or releases it, as a chip in the guide or an end stop does.
    /// While it is blocked, every change of its field is lost.
    pub fn block(&mut self, axis: usize, is_blocked: bool) {
        if let Some(axis) = self.axes.get_mut(axis) {
            axis.block(is_blocked);
        }
    }

    /// Turns the rotor of an axis by about `steps` against its field, as a stronger load does. With
    /// coils it turns by whole electrical cycles. Returns the steps it turned.
    pub fn push(&mut self, axis: usize, steps: i32) -> i32 {
        let made = self.axes.get_mut(axis).map_or(0, |axis| axis.push(steps));
        self.loss_count += 1;
        self.see_tool();
        made
    }

    /// Lets `wait_ticks` timer ticks pass.
    pub fn wait(&mut self, wait_ticks: u64) {
        self.now += wait_ticks;
    }

    /// Tool position in drive steps.
    #[inline]
    #[must_use]
    pub const fn tool(&self) -> [i32; N] {
        self.tool
    }

    /// Rotor positions in drive steps, before the backlash.
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

    /// How often motors have lost steps, pushes included. While it does not change, neither does
    /// [`lost_steps`](Rig::lost_steps).
    #[inline]
    #[must_use]
    pub const fn loss_count(&self) -> u64 {
        self.loss_count
    }

    /// The first sixteen losses, with event and axis.
    #[must_use]
    pub fn losses(&self) -> &[Loss] {
        &self.losses
    }

    /// Number of events applied so far.
    #[must_use]
    pub const fn events(&self) -> u64 {
        self.events
    }

    /// Timer ticks since the start.
    #[must_use]
    pub const fn elapsed_ticks(&self) -> u64 {
        self.now - (1 << 32)
    }
}
