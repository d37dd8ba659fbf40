//! The lamps of a drill's panel.

use super::Drill;
use super::task::Task;

/// Lamps of the panel, with their bits at ports A and D of the original.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct DrillLights {
    /// X and Y move: D2 and D3.
    pub moves: [bool; 2],
    /// The axes are being homed: D4.
    pub homes: bool,
    /// The drill motor turns, or Z moves: D5. In the original the lamp is the bit of the motor and
    /// does not show that Z moves.
    pub drills: bool,
    /// The manual mode: A4.
    pub is_manual: bool,
    /// Ready for commands: A5. The lamp blinks with [`DrillConfig::HEARTBEAT_US`].
    ///
    /// [`DrillConfig::HEARTBEAT_US`]: crate::DrillConfig::HEARTBEAT_US
    pub is_ready: bool,
    /// A program is being received: A6.
    pub receives: bool,
    /// The memory of the program is full: A7.
    pub is_full: bool,
}

impl DrillLights {
    /// Names of the lamps, in the order of [`bits`](Self::bits).
    pub const NAMES: [&'static str; 8] = [
        "x", "y", "home", "drill", "manual", "ready", "receive", "full",
    ];

    /// Returns the lamps from bit 0: D2 to D5, then A4 to A7. The lamp A5 is on if `is_on` and the
    /// drill is ready.
    pub fn bits(&self, is_on: bool) -> u8 {
        let [x, y] = self.moves;
        let lamps = [
            x,
            y,
            self.homes,
            self.drills,
            self.is_manual,
            self.is_ready && is_on,
            self.receives,
            self.is_full,
        ];
        let lamps = lamps.into_iter().rev();
        lamps.fold(0, |bits, is_lit| bits << 1 | u8::from(is_lit))
    }
}

impl<const N: usize> Drill<N> {
    /// Returns the lamps of the panel.
    pub fn lights(&self) -> DrillLights {
        let axis_of = |task: &Task| match *task {
            Task::Leave { axis, .. }
            | Task::Search { axis, .. }
            | Task::Open { axis, .. }
            | Task::Go { axis, .. }
            | Task::Beyond { axis, .. }
            | Task::Return { axis, .. } => Some(axis),
            _ => None,
        };
        let axis = axis_of(&self.task);
        let z_moves = matches!(
            self.task,
            Task::Down { .. } | Task::Up { .. } | Task::OpenUp { .. } | Task::JogZ { .. }
        );
        DrillLights {
            moves: [axis == Some(0), axis == Some(1)],
            homes: self.is_homing,
            drills: self.spindle_turns() || z_moves && !self.config.spindle_by_hole,
            is_manual: self.link.is_manual(),
            is_ready: !self.is_working(),
            receives: self.link.is_receiving(),
            is_full: self.link.is_full(),
        }
    }

    /// Whether the lamp of the heartbeat is lit. It needs
    /// [`DrillConfig::blinks`](super::DrillConfig::blinks).
    pub const fn heartbeat(&self) -> bool {
        self.heartbeat
    }
}
