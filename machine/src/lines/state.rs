//! State of the commands beyond plain moves: a probing move, outputs that wait for a move, an
//! awaited input, a spindle with a constant surface speed, a curve in progress.

use husillo_gcode::{Nm, SpindleDirection};
use husillo_planner::SurfaceSpeed;

use crate::Output;
use crate::lines::curve::{ControlPoints, Curve};

/// Number of outputs that can wait for the moves before them. Further ones wait for standstill.
const SYNCHRONISED: usize = 8;

/// The state; see the module.
#[derive(Clone, Debug)]
pub struct State<const N: usize> {
    pub(crate) probing: Option<Probing<N>>,
    /// Level of the probe's input.
    pub(crate) is_touching: bool,
    pub(crate) probed: Probed<N>,
    /// An input was requested, and its answer has not come.
    pub(crate) is_awaited: bool,
    pub(crate) surface: Option<(SpindleDirection, SurfaceSpeed)>,
    /// Direction and speed of the spindle, in thousandths of a turn per minute.
    pub(crate) spindle: (SpindleDirection, u64),
    pub(crate) tapping: Option<Tapping<N>>,
    /// Control points of a curve that is not complete.
    pub(crate) points: ControlPoints,
    pub(crate) curve: Option<Curve<N>>,
    outputs: [Option<(Output, usize)>; SYNCHRONISED],
    /// Override of the operator, and whether the program permits it.
    pub(crate) percent: u8,
    pub(crate) permits_override: bool,
    /// The operator holds the path.
    pub(crate) operator_holds: bool,
    /// M52: whether an input scales the feed, and its value.
    pub(crate) adapts: bool,
    pub(crate) adaptive_percent: u8,
    /// M53: whether an input may stop the feed, and whether it wants to.
    pub(crate) permits_stop: bool,
    pub(crate) is_stop_active: bool,
}

/// A probing move in progress.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Probing<const N: usize> {
    pub(crate) from: [Nm; N],
    pub(crate) to: [Nm; N],
    pub(crate) is_away: bool,
    pub(crate) must: bool,
    /// Steps of the axes at the contact.
    pub(crate) contact: Option<[i32; N]>,
}

/// A tap in progress (G33.1).
#[derive(Copy, Clone, Debug)]
pub(crate) struct Tapping<const N: usize> {
    #[cfg(feature = "extended")]
    pub(crate) top: [Nm; N],
    /// The farthest positions while the spindle reverses: below the bottom, above the top.
    pub(crate) beyond: [[Nm; N]; 2],
    pub(crate) lead: Nm,
    pub(crate) stage: Stage,
    /// The last step that follows the spindle.
    pub(crate) last: [i8; N],
}

/// The stages of a tap, in their order.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    /// To the bottom.
    Down,
    /// Beyond it, until the spindle has reversed.
    Below,
    /// To the top.
    #[cfg(feature = "extended")]
    Up,
    /// Beyond it, until the spindle has reversed again. A rapid move to the top follows.
    #[cfg(feature = "extended")]
    Above,
}

/// Result of the last probing move.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Probed<const N: usize> {
    /// Position at the contact in the machine frame, or the end of a move without contact. If a tip
    /// is set, it is the point of contact.
    pub at: [Nm; N],
    /// The same in the work frame of the probing move: #5061 to #5069.
    pub in_work: [Nm; N],
    /// Whether the contact changed: #5070.
    pub is_touched: bool,
}

impl<const N: usize> State<N> {
    #[cfg(feature = "extended")]
    pub(crate) const fn new() -> Self {
        State {
            probing: None,
            is_touching: false,
            probed: Probed {
                at: [Nm(0); N],
                in_work: [Nm(0); N],
                is_touched: false,
            },
            is_awaited: false,
            surface: None,
            spindle: (SpindleDirection::Off, 0),
            tapping: None,
            points: ControlPoints::NONE,
            curve: None,
            outputs: [const { None }; SYNCHRONISED],
            percent: 100,
            permits_override: true,
            operator_holds: false,
            adapts: false,
            adaptive_percent: 100,
            permits_stop: false,
            is_stop_active: false,
        }
    }

    /// Drops all that is in progress.
    pub(crate) fn abort(&mut self) {
        self.probing = None;
        self.is_awaited = false;
        self.surface = None;
        self.spindle = (SpindleDirection::Off, 0);
        self.tapping = None;
        self.curve = None;
        self.outputs = [const { None }; SYNCHRONISED];
    }

    /// Whether the operator or an input holds the path.
    pub(crate) const fn holds(&self) -> bool {
        self.operator_holds
            || self.permits_stop && self.is_stop_active
            || self.adapts && self.adaptive_percent == 0
    }

    /// The override of the feed, in percent: that of the operator times that of the input.
    pub(crate) fn effective_percent(&self) -> u8 {
        let percent = if self.permits_override {
            self.percent
        } else {
            100
        };
        let adaptive = if self.adapts {
            self.adaptive_percent
        } else {
            100
        };
        // Both are at most 200.
        let product = u32::from(percent).wrapping_mul(adaptive.into()) / 100;
        product.min(200) as u8
    }

    /// Whether something is in progress that a later line has to wait for.
    pub(crate) const fn is_busy(&self) -> bool {
        self.probing.is_some() || self.tapping.is_some() || self.is_awaited || self.curve.is_some()
    }

    /// Adds an output that acts when `moves` moves of the queue have been made and the next one
    /// begins. Returns `false` if there is no room.
    pub(crate) fn add(&mut self, output: Output, moves: usize) -> bool {
        let place = self.outputs.iter_mut().find(|place| place.is_none());
        place.map(|place| *place = Some((output, moves))).is_some()
    }

    /// A move of the queue has ended.
    pub(crate) fn count(&mut self) {
        for (_, moves) in self.outputs.iter_mut().flatten() {
            *moves = moves.saturating_sub(1);
        }
    }

    /// The next output that acts with the beginning of the first move.
    pub(crate) fn due(&mut self) -> Option<Output> {
        let Some((output, 0)) = self.outputs.first().copied().flatten() else {
            return None;
        };
        // The others move up, so they stay in the order of the program.
        let mut next = None;
        for place in self.outputs.iter_mut().rev() {
            next = core::mem::replace(place, next);
        }
        Some(output)
    }
}
