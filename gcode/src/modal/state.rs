//! Read access to the modal state, and changes from outside the program.

use crate::codes::code::{Code, Group, Side};
use crate::codes::dialect::Dialect;
use crate::command::arc::Plane;
use crate::command::{PathMode, SpindleDirection};
use crate::features::EXTENDED;
use crate::modal::Modal;
use crate::modal::modes::{Distance, FeedMode, Motion, Units};
use crate::modal::tools::Tool;
use crate::values::nm::Nm;

impl<const N: usize> Modal<N> {
    /// The programmed position in the machine frame.
    pub fn position(&self) -> [Nm; N] {
        self.modes.position
    }

    /// Sets the real position of the tool in the machine frame, after homing, probing, or an abort.
    pub fn set_position(&mut self, at: [Nm; N]) {
        self.modes.position = at;
    }

    /// The active work zero in the machine frame: the offset of G54 to G59.3 and the shift of G92,
    /// without the tool length. In a rotated frame the shift is rotated too.
    pub fn work_offset(&self) -> [Nm; N] {
        let mut offset = [Nm(0); N];
        for (axis, offset) in (0..N).zip(offset.iter_mut()) {
            *offset = self.work_offset_of(axis);
        }
        #[cfg(feature = "extended")]
        if self.modes.is_rotated {
            for (to, at) in offset.iter_mut().zip(self.turned_offset()) {
                *to = at;
            }
        }
        offset
    }

    /// The programmed position in the work frame, without the tool length.
    pub fn work_position(&self) -> [Nm; N] {
        let mut point = self.modes.position;
        for (axis, at) in (0..N).zip(point.iter_mut()) {
            // Each within a few times Nm::LIMIT.
            at.0 = at.0.saturating_sub(self.zero_of(axis).0);
        }
        #[cfg(feature = "extended")]
        if self.modes.is_rotated {
            for (to, at) in point.iter_mut().zip(self.turned_position()) {
                *to = at;
            }
        }
        point
    }

    /// Sets the zero of a work frame, 0 (G54) to 8 (G59.3). Returns `false`, with no effect, for
    /// another number.
    pub fn set_work_zero(&mut self, system: u8, zero: [Nm; N]) -> bool {
        match self.offsets.get_mut(usize::from(system)) {
            Some(offset) => {
                // Copied element by element: a copy of the whole would link a function that nothing
                // else needs.
                for (offset, zero) in offset.iter_mut().zip(zero) {
                    offset.0 = zero.0;
                }
                true
            }
            None => false,
        }
    }

    /// The zero of a work frame, 0 (G54) to 8 (G59.3).
    pub fn work_zero(&self, system: u8) -> Option<[Nm; N]> {
        self.offsets.get(usize::from(system)).copied()
    }

    /// Sets the position of G28 in the machine frame; initially machine zero.
    pub fn set_home(&mut self, home: [Nm; N]) {
        let [first, _] = &mut self.homes;
        *first = home;
    }

    /// The position of G28 in the machine frame.
    pub fn home(&self) -> [Nm; N] {
        self.homes[0]
    }

    /// Sets the position of G30 in the machine frame; initially machine zero.
    pub fn set_second_home(&mut self, home: [Nm; N]) {
        let [_, second] = &mut self.homes;
        *second = home;
    }

    /// The position of G30 in the machine frame.
    pub fn second_home(&self) -> [Nm; N] {
        self.homes[1]
    }

    /// Writes a tool into the table, as G10 L1 does. Returns `false`, with no effect, for tool 0,
    /// or if the table has eight other tools.
    pub fn set_tool(&mut self, number: u32, tool: Tool<N>) -> bool {
        self.tools.set(number, tool)
    }

    /// A tool of the table.
    pub fn tool_data(&self, number: u32) -> Option<Tool<N>> {
        self.tools.get(number)
    }

    /// The tool length in effect (G43, G43.1), part of the position.
    pub fn tool_length(&self) -> [Nm; N] {
        self.modes.length
    }

    /// The tool in the spindle: that of the last M6 or M61.
    pub fn loaded_tool(&self) -> u32 {
        self.modes.loaded
    }

    /// The side of cutter compensation; `None` under G40.
    pub fn compensation(&self) -> Option<Side> {
        #[cfg(feature = "extended")]
        return self.modes.more.compensation;
        #[cfg(not(feature = "extended"))]
        None
    }

    /// Whether X is a diameter (G7).
    pub fn is_diameter(&self) -> bool {
        EXTENDED && self.active(Group::Diameter) == Code::DiameterMode
    }

    /// The active work frame: 0 (G54) to 8 (G59.3).
    pub fn work_system(&self) -> u8 {
        let code = self.active(Group::System);
        if EXTENDED && code > Code::G59 {
            code.since(Code::G59_1).wrapping_add(6)
        } else {
            code.since(Code::G54)
        }
    }

    /// The dialect of the state.
    pub fn dialect(&self) -> &Dialect {
        &self.modes.dialect
    }

    /// The motion mode; `None` initially, after G80, and in the micromill dialect.
    pub fn motion(&self) -> Option<Motion> {
        Some(match self.active(Group::Motion) {
            Code::Rapid => Motion::Rapid,
            Code::Linear => Motion::Linear,
            Code::Clockwise => Motion::Clockwise,
            Code::CounterClockwise => Motion::CounterClockwise,
            Code::Cubic => Motion::Cubic,
            Code::Quadratic => Motion::Quadratic,
            Code::Nurbs => Motion::Nurbs,
            Code::Thread => Motion::Thread,
            Code::RigidTap => Motion::Tap,
            code if code.is_probe() => {
                let (away, must) = code.probe();
                Motion::Probe { away, must }
            }
            code => Motion::Cycle(code.cycle()?),
        })
    }

    /// The plane of arcs.
    pub fn plane(&self) -> Plane {
        match self.active(Group::Plane) {
            Code::PlaneZx => Plane::Zx,
            Code::PlaneYz => Plane::Yz,
            _ => Plane::Xy,
        }
    }

    /// The unit of lengths.
    pub fn units(&self) -> Units {
        match self.active(Group::Units) {
            Code::Inches => Units::Inches,
            Code::Micrometres => Units::Micrometres,
            _ => Units::Millimetres,
        }
    }

    /// Distance mode of coordinates.
    pub fn distance(&self) -> Distance {
        match self.active(Group::Distance) {
            Code::Incremental => Distance::Incremental,
            _ => Distance::Absolute,
        }
    }

    /// Distance mode of arc centres.
    pub fn centre_distance(&self) -> Distance {
        match self.active(Group::CentreDistance) {
            Code::AbsoluteCentres => Distance::Absolute,
            _ => Distance::Incremental,
        }
    }

    /// Meaning of `F`.
    pub fn feed_mode(&self) -> FeedMode {
        match self.active(Group::FeedMode) {
            Code::InverseTime => FeedMode::InverseTime,
            Code::PerRevolution if EXTENDED => FeedMode::PerRevolution,
            _ => FeedMode::PerMinute,
        }
    }

    /// The feed of G94 in nm/min; `None` before the first one, and under G93 and G95.
    pub fn feed(&self) -> Option<Nm> {
        let rate = i64::try_from(self.modes.feed)
            .ok()
            .filter(|&rate| rate > 0 && self.feed_mode() == FeedMode::PerMinute);
        rate.map(Nm)
    }

    /// The last F in millionths of its unit, millimetres (or revolutions, moves) per minute; 0
    /// without one.
    pub fn feed_word(&self) -> u64 {
        self.modes.feed
    }

    /// Switches spindle and coolant off, as M5 and M9 do, for an abort outside the program.
    pub fn stop_outputs(&mut self) {
        self.set_active(Group::Spindle, Code::SpindleOff);
        self.modes.mist = false;
        self.modes.flood = false;
    }

    /// Spindle direction and programmed speed in thousandths of a revolution per minute. The speed
    /// is kept while the spindle is off.
    pub fn spindle(&self) -> (SpindleDirection, u64) {
        (self.spindle_direction(), self.modes.milli_rpm)
    }

    pub(crate) fn spindle_direction(&self) -> SpindleDirection {
        match self.active(Group::Spindle) {
            Code::SpindleClockwise => SpindleDirection::Clockwise,
            Code::SpindleCounterClockwise => SpindleDirection::CounterClockwise,
            _ => SpindleDirection::Off,
        }
    }

    /// Mist coolant (M7) and flood coolant (M8).
    pub fn coolant(&self) -> (bool, bool) {
        (self.modes.mist, self.modes.flood)
    }

    /// The tool selected last.
    pub fn tool(&self) -> u32 {
        self.modes.tool
    }

    /// Path mode: how moves are joined. Initially that of G64 without a tolerance.
    pub fn path(&self) -> PathMode {
        match self.active(Group::Path) {
            Code::ExactPath => PathMode::ExactPath,
            Code::ExactStop => PathMode::ExactStop,
            #[cfg(feature = "extended")]
            _ => PathMode::Blend {
                tolerance: self.modes.more.tolerance,
            },
            #[cfg(not(feature = "extended"))]
            _ => PathMode::default(),
        }
    }
}
