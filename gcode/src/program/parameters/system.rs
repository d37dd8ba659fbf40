//! Parameters with values from the state of the machine.

use super::value::Value;
use crate::codes::code::Side;
use crate::command::SpindleDirection;
use crate::command::arc::Plane;
use crate::modal::Modal;
use crate::modal::modes::{Distance, FeedMode, Motion, Units};
#[cfg(feature = "extended")]
use crate::modal::saved::SavedModes;
use crate::values::nm::Nm;

/// The state of the machine that expressions can read: positions, the work system, the tool. It is
/// read when their line is evaluated, so a caller plans each block before it asks for the next
/// line.
///
/// [`Modal`](crate::Modal) implements it; [`NoMachine`] has no values.
pub trait System {
    /// The value of a system parameter (#5061 to #5602) in the units in effect; `None` for other
    /// numbers. They are read-only.
    fn numbered(&self, number: u16) -> Option<Value>;

    /// The value of a predefined name, without its `_` and in any case (`x` of `#<_x>`); `None` for
    /// other names.
    fn named(&self, name: &[u8]) -> Option<Value>;

    /// Whether the caller has a subroutine that is not in the text.
    /// [`Program::outside_call`](super::Program::outside_call) then reports the call. The name is
    /// as written, `bore` of `o<bore> call`.
    fn has_subroutine(&self, name: &[u8]) -> bool {
        let _ = name;
        false
    }

    /// The modes that M70 and M73 save; `None` in a system without modes.
    #[cfg(feature = "extended")]
    fn modes(&self) -> Option<SavedModes> {
        None
    }
}

/// A system without values, for lines without a machine.
#[derive(Copy, Clone, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NoMachine;

impl System for NoMachine {
    fn numbered(&self, _: u16) -> Option<Value> {
        None
    }

    fn named(&self, _: &[u8]) -> Option<Value> {
        None
    }
}

/// A length in the units in effect.
fn length(nm: Nm, units: Units) -> Option<Value> {
    match units {
        Units::Millimetres => Value::new(nm.0, 6),
        Units::Micrometres => Value::new(nm.0, 3),
        // 25.4 mm; the quotient is rounded to 18 places.
        Units::Inches => Value::new(nm.0, 0)?.divided_by(Value::from(25_400_000)),
    }
}

impl<const N: usize> Modal<N> {
    /// The coordinate of the axis of a letter in the units in effect, degrees for a rotary axis; 0
    /// where there is no such axis.
    fn coordinate(&self, letter: u8, lengths: [Nm; N]) -> Option<Value> {
        let axes = self.modes.dialect.axes();
        let axis = axes.index(letter);
        match axis.and_then(|axis| lengths.get(axis)) {
            Some(&angle) if axis.is_some_and(|axis| axes.is_rotary(axis)) => {
                length(angle, Units::Millimetres)
            }
            Some(&nm) => length(nm, self.units()),
            None => Some(Value::ZERO),
        }
    }
}

/// The letters of axes in the order of the numbers of their parameters.
const LETTERS: &[u8; 9] = b"XYZABCUVW";

/// | number | name | what |
/// | --- | --- | --- |
/// | #5021 to #5029 | `_abs_x` ... | machine position |
/// | #5161 to #5169, #5181 to #5189 | | where G28 and G30 go |
/// | #5210 | | 1 while G92 shifts anything |
/// | #5211 to #5219 | | the shift of G92 |
/// | #5220 | `_coord_system` (540 for G54) | the work system, 1 to 9 |
/// | #5221 to #5229, #5241 to #5249, ... | | zeros of G54, G55, ... |
/// | #5230, #5250, ... | | rotations of G54, G55, ... in degrees |
/// | #5400 | `_current_tool`, `_selected_tool` | tool in the spindle |
/// | #5401 to #5409 | | tool length in effect |
/// | #5410 | | diameter of the tool in the spindle |
/// | #5420 to #5428 | `_x` ... | position in the work frame; X is a radius |
/// | | `_metric _imperial _absolute _incremental _inverse_time _units_per_minute _units_per_rev _ijk_absolute_mode _lathe_diameter_mode _lathe_radius_mode _spindle_on _spindle_cw _mist _flood` | 1 or 0 |
/// | | `_plane _ccomp _motion_mode` | ten times the code; not in canned cycles |
/// | | `_feed _rpm` | feed of G94, spindle speed |
impl<const N: usize> System for Modal<N> {
    fn numbered(&self, number: u16) -> Option<Value> {
        // `place` counts in the order X Y Z A B C U V W.
        let in_units = |place: usize, lengths: [Nm; N]| {
            let letter = *LETTERS.get(place)?;
            self.coordinate(letter, lengths)
        };
        let axis_from = |first: u16| usize::from(number.wrapping_sub(first));
        match number {
            5021..=5029 => in_units(axis_from(5021), self.position()),
            5161..=5169 => in_units(axis_from(5161), self.home()),
            5181..=5189 => in_units(axis_from(5181), self.second_home()),
            5210 => Some(Value::truth(self.modes.shift != [Nm(0); N])),
            5211..=5219 => in_units(axis_from(5211), self.modes.shift),
            5220 => Some(Value::from(i32::from(self.work_system()).wrapping_add(1))),
            5221..=5389 => {
                let place = number.wrapping_sub(5221);
                // Below 9.
                let (system, axis) = ((place / 20) as u8, usize::from(place % 20));
                match axis {
                    #[cfg(feature = "extended")]
                    9 => Value::new(i64::from(self.rotation(system)?), 7),
                    axis => in_units(axis, self.work_zero(system)?),
                }
            }
            5400 => Value::new(i64::from(self.loaded_tool()), 0),
            5401..=5409 => in_units(axis_from(5401), self.tool_length()),
            5410 => {
                let radius = self
                    .tool_data(self.loaded_tool())
                    .map_or(Nm(0), |tool| tool.radius);
                length(Nm(radius.0.saturating_mul(2)), self.units())
            }
            5420..=5428 => in_units(axis_from(5420), self.work_position()),
            _ => None,
        }
    }

    #[cfg(feature = "extended")]
    fn modes(&self) -> Option<SavedModes> {
        Some(self.saved_modes())
    }

    fn named(&self, name: &[u8]) -> Option<Value> {
        let truth = |value| Some(Value::truth(value));
        let number = |value: u32| Value::new(i64::from(value), 0);
        let (spindle, milli_rpm) = self.spindle();
        let (mist, flood) = self.coolant();
        match name {
            [letter] | [b'A', b'B', b'S', b'_', letter] => {
                if !LETTERS.contains(letter) {
                    return None;
                }
                let lengths = if name.len() == 1 {
                    self.work_position()
                } else {
                    self.position()
                };
                self.coordinate(*letter, lengths)
            }
            b"METRIC" => truth(self.units() == Units::Millimetres),
            b"IMPERIAL" => truth(self.units() == Units::Inches),
            b"ABSOLUTE" => truth(self.distance() == Distance::Absolute),
            b"INCREMENTAL" => truth(self.distance() == Distance::Incremental),
            b"IJK_ABSOLUTE_MODE" => truth(self.centre_distance() == Distance::Absolute),
            b"INVERSE_TIME" => truth(self.feed_mode() == FeedMode::InverseTime),
            b"UNITS_PER_MINUTE" => truth(self.feed_mode() == FeedMode::PerMinute),
            b"UNITS_PER_REV" => truth(self.feed_mode() == FeedMode::PerRevolution),
            b"LATHE_DIAMETER_MODE" => truth(self.is_diameter()),
            b"LATHE_RADIUS_MODE" => truth(!self.is_diameter()),
            b"SPINDLE_ON" => truth(spindle != SpindleDirection::Off),
            b"SPINDLE_CW" => truth(spindle == SpindleDirection::Clockwise),
            b"MIST" => truth(mist),
            b"FLOOD" => truth(flood),
            b"PLANE" => number(match self.plane() {
                Plane::Xy => 170,
                Plane::Zx => 180,
                Plane::Yz => 190,
            }),
            b"CCOMP" => number(match self.compensation() {
                None => 400,
                Some(Side::Left) => 410,
                Some(Side::Right) => 420,
            }),
            b"MOTION_MODE" => number(match self.motion() {
                None => 800,
                Some(Motion::Rapid) => 0,
                Some(Motion::Linear) => 10,
                Some(Motion::Clockwise) => 20,
                Some(Motion::CounterClockwise) => 30,
                Some(Motion::Cubic) => 50,
                Some(Motion::Quadratic) => 51,
                Some(Motion::Nurbs) => 52,
                Some(Motion::Thread) => 330,
                Some(Motion::Tap) => 331,
                Some(_) => return None,
            }),
            b"COORD_SYSTEM" => {
                // G54 is 540, G59 590, G59.1 591.
                let system = u32::from(self.work_system());
                number(match system {
                    0..=5 => system.wrapping_mul(10).wrapping_add(540),
                    _ => system.wrapping_add(585),
                })
            }
            b"FEED" => length(self.feed().unwrap_or(Nm(0)), self.units()),
            b"RPM" => Value::new(i64::try_from(milli_rpm).ok()?, 3),
            b"CURRENT_TOOL" => number(self.loaded_tool()),
            b"SELECTED_TOOL" => number(self.tool()),
            _ => None,
        }
    }
}
