//! Commands: the meaning of a block in the machine frame. A command is complete without modes,
//! offsets or tables.

pub(crate) mod arc;

use crate::codes::axes::Axes;
use crate::codes::code::Side;
use crate::command::arc::{Arc, Direction, Plane};
use crate::values::nm::Nm;
use core::fmt;

/// Feed of a move.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Feed {
    /// G94: nanometres of path per minute, above zero.
    PerMinute(Nm),
    /// G93: the inverse of the time of this move, above zero (2 000 000: the move takes half a
    /// minute).
    InverseTime {
        /// Moves per minute times 10^6.
        micro_per_minute: u64,
    },
    /// G95: nanometres of path per spindle revolution, above zero.
    PerRevolution(Nm),
}

/// Direction in which a spindle turns to an angle (M19).
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum OrientDirection {
    /// The direction of the shorter turn: `P0`.
    #[default]
    Shorter,
    /// `P1`.
    Clockwise,
    /// `P2`.
    CounterClockwise,
}

impl OrientDirection {
    /// The direction of a `P` word. `None` for another number.
    #[cfg(feature = "extended")]
    pub(crate) const fn of(number: u8) -> Option<Self> {
        match number {
            0 => Some(OrientDirection::Shorter),
            1 => Some(OrientDirection::Clockwise),
            2 => Some(OrientDirection::CounterClockwise),
            _ => None,
        }
    }

    /// `shorter`, `cw` or `ccw`.
    pub const fn name(self) -> &'static str {
        match self {
            OrientDirection::Shorter => "shorter",
            OrientDirection::Clockwise => "cw",
            OrientDirection::CounterClockwise => "ccw",
        }
    }
}

/// Direction of the spindle.
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SpindleDirection {
    /// M5.
    #[default]
    Off,
    /// M3.
    Clockwise,
    /// M4.
    CounterClockwise,
}

impl SpindleDirection {
    /// `off`, `cw` or `ccw`.
    pub const fn name(self) -> &'static str {
        match self {
            SpindleDirection::Off => "off",
            SpindleDirection::Clockwise => "cw",
            SpindleDirection::CounterClockwise => "ccw",
        }
    }

    /// The other direction; off stays off.
    #[cfg(feature = "extended")]
    pub(crate) const fn reversed(self) -> Self {
        match self {
            SpindleDirection::Off => SpindleDirection::Off,
            SpindleDirection::Clockwise => SpindleDirection::CounterClockwise,
            SpindleDirection::CounterClockwise => SpindleDirection::Clockwise,
        }
    }
}

/// Path mode: how moves are joined. A program begins with G64 without a tolerance.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PathMode {
    /// G61: a stop at each corner, none where the path has no corner.
    ExactPath,
    /// G61.1: a stop after each move.
    ExactStop,
    /// G64: corners without a stop, within the tolerance (`P`) if one is given.
    Blend {
        /// Largest distance from the path.
        tolerance: Option<Nm>,
    },
}

impl Default for PathMode {
    /// Of a program without any of these codes: G64 without a tolerance.
    fn default() -> Self {
        Self::Blend { tolerance: None }
    }
}

/// A cubic curve in the XY plane: G5, or G5.1 raised to the third degree.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Spline<const N: usize> {
    /// The end, machine frame.
    pub to: [Nm; N],
    /// Start, two control points and end: X and Y, machine frame. They are exact for G5. The
    /// control points of a quadratic curve are rounded to the nanometre, so the error of the curve
    /// is less than one.
    pub points: [[Nm; 2]; 4],
}

/// The input that M66 waits for.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Input {
    /// `P`: a digital input.
    Digital(u8),
    /// `E`: an analogue input.
    Analog(u8),
}

/// The condition that M66 waits for: its `L`.
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum WaitFor {
    /// L0: only reads the input.
    #[default]
    Nothing,
    /// L1.
    Rise,
    /// L2.
    Fall,
    /// L3.
    High,
    /// L4.
    Low,
}

/// A heater of a printer.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Heater {
    /// M104, M109: that of the extruder of this number.
    Extruder(u8),
    /// M140, M190.
    Bed,
    /// M141, M191.
    Chamber,
}

/// When the program continues after the target of a heater was set.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum HeatWait {
    /// At once.
    None,
    /// When the temperature is at or above the target (`S`).
    Heated,
    /// When the temperature has reached the target, also from above (`R`).
    Reached,
}

/// The functions that M48 to M53 switch.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Switch {
    /// M48 and M49: overrides of feed and spindle.
    Overrides,
    /// M50: the override of the feed.
    FeedOverride,
    /// M51: the override of the spindle.
    SpindleOverride,
    /// M52: feed from an input.
    AdaptiveFeed,
    /// M53: the feed hold input.
    FeedHold,
}

/// One command. Positions are in the machine frame. `Display` prints one line, with lengths in
/// millimetres.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Command<const N: usize> {
    /// A straight move at the highest speed of the machine.
    Rapid {
        /// The end.
        to: [Nm; N],
    },
    /// A straight feed move.
    Linear {
        /// The end.
        to: [Nm; N],
        /// Its speed.
        feed: Feed,
    },
    /// A circular or helical feed move.
    Arc {
        /// Its geometry.
        arc: Arc<N>,
        /// Its speed.
        feed: Feed,
    },
    /// A curved feed move (G5, G5.1).
    Spline {
        /// Its geometry.
        spline: Spline<N>,
        /// Its speed.
        feed: Feed,
    },
    /// Begins a NURBS in the XY plane at the present position (G5.2). Its first control point is
    /// that position; the others follow, each as a [`Command::NurbsPoint`]. Nothing moves before
    /// [`Command::NurbsEnd`]. In between, there are only commands that do not move.
    ///
    /// The knots are those of LinuxCNC. The first and the last knot are repeated as often as the
    /// order, and the distances between knots are equal. So the curve begins and ends at a control
    /// point.
    NurbsBegin {
        /// The order (`L`), the degree plus one, 2 to 16.
        order: u8,
        /// Weight of the first point, in millionths, above zero.
        micro_weight: u64,
        /// The speed along the curve.
        feed: Feed,
    },
    /// A further control point of a NURBS.
    NurbsPoint {
        /// X and Y, exact, machine frame.
        at: [Nm; 2],
        /// Its weight (`P`), in millionths, above zero.
        micro_weight: u64,
    },
    /// The end of a NURBS (G5.3): the curve is complete, and has at least as many control points as
    /// its order.
    NurbsEnd {
        /// The last control point, with the other axes as before.
        to: [Nm; N],
    },
    /// Rigid tapping (G33.1): a move that follows the spindle to the bottom, and back with the
    /// spindle reversed. The spindle then turns as before.
    Tap {
        /// The bottom of the thread.
        bottom: [Nm; N],
        /// The start, to which the tap returns.
        to: [Nm; N],
        /// Distance along the move per spindle revolution.
        lead: Nm,
    },
    /// A straight move synchronised with the spindle (G33, and within G76 and the threading cycles
    /// of lathes).
    Thread {
        /// The end.
        to: [Nm; N],
        /// Distance along the move per spindle revolution.
        lead: Nm,
    },
    /// A straight move that stops when the probe changes (G38.2 to G38.5).
    Probe {
        /// The end if the probe does not change. The modal state assumes this position until
        /// [`Modal::set_position`](crate::Modal::set_position).
        to: [Nm; N],
        /// Its speed.
        feed: Feed,
        /// G38.4, G38.5: until contact is lost.
        away: bool,
        /// G38.2, G38.4: missing the contact is an error.
        must: bool,
    },
    /// A pause.
    Dwell {
        /// Microseconds.
        micros: u64,
    },
    /// Spindle on, off or at another speed.
    Spindle {
        /// Its direction.
        direction: SpindleDirection,
        /// Thousandths of a revolution per minute; 0 when off.
        milli_rpm: u64,
    },
    /// A spindle at constant surface speed (G96).
    Surface {
        /// Its direction; off when the spindle is off.
        direction: SpindleDirection,
        /// Surface speed per minute.
        speed: Nm,
        /// Largest speed in thousandths of a revolution per minute (`D`).
        most_milli_rpm: Option<u64>,
    },
    /// M19: the spindle stops at an angle.
    Orient {
        /// Millionths of a degree, below 360 degrees.
        micro_degrees: u64,
        /// Direction of rotation (`P`).
        direction: OrientDirection,
    },
    /// Coolant: both states after the command.
    Coolant {
        /// M7.
        mist: bool,
        /// M8.
        flood: bool,
    },
    /// M6: change to the tool selected last.
    Tool {
        /// Its number; 0 when none was selected.
        number: u32,
    },
    /// M61: this tool is already in the spindle.
    ToolIs {
        /// Its number.
        number: u32,
    },
    /// G43, G43.1, G49: the tool length in effect, part of all positions from here on.
    ToolLength {
        /// Number in the table; 0 for G43.1 and G49.
        number: u32,
        /// Added to the work frame. Also zero for a tool that is not in the table.
        offset: [Nm; N],
    },
    /// G40, G41, G42: radius compensation from the next move on. The moves in this stream are still
    /// those of the contour.
    Compensation {
        /// The side; `None` for G40.
        side: Option<Side>,
        /// The tool's radius, not negative.
        radius: Nm,
        /// The plane in which it is compensated.
        plane: Plane,
    },
    /// M48 to M53.
    Switch {
        /// What is switched.
        what: Switch,
        /// Whether it is permitted.
        on: bool,
    },
    /// M62 to M65: a digital output.
    Output {
        /// Its number.
        number: u8,
        /// Its level.
        on: bool,
        /// M62, M63: takes effect with the start of the next move.
        with_motion: bool,
    },
    /// M67, M68: an analogue output.
    Analog {
        /// Its number.
        number: u8,
        /// Millionths of its unit.
        micro: i64,
        /// M67: takes effect with the start of the next move.
        with_motion: bool,
    },
    /// M66: read an input, or wait for it.
    Wait {
        /// The input.
        input: Input,
        /// The condition.
        until: WaitFor,
        /// Longest time in microseconds; 0 does not wait.
        timeout_micros: u64,
    },
    /// One drilling cycle at the present position: down to the lower end switch and up to the upper
    /// one (dialect `drill`, whose Z has no coordinate).
    Drill,
    /// M104, M109, M140, M141, M190, M191: a heater of a printer gets a target.
    Heat {
        /// The heater.
        heater: Heater,
        /// The target in thousandths of a degree Celsius; 0 is off.
        milli_celsius: u32,
        /// Whether the program waits for it.
        wait: HeatWait,
    },
    /// M106, M107: a fan of a printer.
    Fan {
        /// Its number.
        number: u8,
        /// Its speed in thousandths of the highest; 0 is off.
        per_mille: u16,
    },
    /// M84: the motors of a printer lose their current.
    MotorsOff,
    /// M60: change the pallet and wait for the operator.
    Pallet,
    /// M0, or M1 when optional: wait for the operator.
    Stop {
        /// M1.
        optional: bool,
    },
    /// M2, or M30 when `rewind` is set. Spindle and coolant go off with it.
    End {
        /// M30.
        rewind: bool,
    },
    /// G61, G61.1, G64, each time one of them is programmed.
    Path {
        /// The mode from here on.
        mode: PathMode,
    },
}

impl<const N: usize> Command<N> {
    /// The end of the command, if it moves.
    pub const fn end(&self) -> Option<[Nm; N]> {
        match self {
            Command::Rapid { to }
            | Command::Linear { to, .. }
            | Command::Thread { to, .. }
            | Command::Tap { to, .. }
            | Command::NurbsEnd { to }
            | Command::Probe { to, .. } => Some(*to),
            Command::Arc { arc, .. } => Some(arc.to),
            Command::Spline { spline, .. } => Some(spline.to),
            _ => None,
        }
    }

    /// The command to be printed with the letters of these axes, and only with these axes.
    /// `Display` of the command itself prints its coordinates as X Y Z A B C.
    pub const fn shown(&self, axes: Axes) -> Shown<'_, N> {
        Shown {
            command: self,
            axes,
        }
    }
}

/// The end of a move as ` X1 Y2 Z3`.
struct Point<'a, const N: usize>(&'a [Nm; N], Axes);

impl<const N: usize> fmt::Display for Point<'_, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (letter, at) in self.1.letters().zip(self.0) {
            write!(f, " {}{at}", char::from(letter))?;
        }
        Ok(())
    }
}

/// A command with the letters of the axes of a machine; see [`Command::shown`].
#[derive(Copy, Clone, Debug)]
pub struct Shown<'a, const N: usize> {
    command: &'a Command<N>,
    axes: Axes,
}

/// `F120` in mm/min, or `F2/min` for inverse time.
impl fmt::Display for Feed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Feed::PerMinute(rate) => write!(f, "F{rate}"),
            Feed::PerRevolution(rate) => write!(f, "F{rate}/rev"),
            Feed::InverseTime { micro_per_minute } => {
                write!(f, "F{}/min", Millionths(micro_per_minute))
            }
        }
    }
}

/// A number of millionths (or, shifted, thousandths), printed like a length.
struct Millionths(u64);

impl fmt::Display for Millionths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Nm(i64::try_from(self.0).unwrap_or(i64::MAX)).fmt(f)
    }
}

impl<const N: usize> fmt::Display for Command<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.shown(Axes::XYZABC).fmt(f)
    }
}

impl<const N: usize> fmt::Display for Shown<'_, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let axes = self.axes;
        match self.command {
            Command::Rapid { to } => write!(f, "rapid{}", Point(to, axes)),
            Command::Linear { to, feed } => write!(f, "linear{} {feed}", Point(to, axes)),
            Command::Arc { arc, feed } => {
                let direction = match arc.direction {
                    Direction::Clockwise => "cw",
                    Direction::CounterClockwise => "ccw",
                };
                write!(
                    f,
                    "arc {direction} {}{} centre{}",
                    arc.plane.name(),
                    Point(&arc.to, axes),
                    Point(&arc.centre, axes)
                )?;
                if arc.turns != 0 {
                    write!(f, " turns {}", arc.turns)?;
                }
                write!(f, " {feed}")
            }
            Command::Spline { spline, feed } => {
                write!(f, "spline{} through", Point(&spline.to, axes))?;
                for [x, y] in spline.points.iter().skip(1).take(2) {
                    write!(f, " X{x} Y{y}")?;
                }
                write!(f, " {feed}")
            }
            Command::NurbsBegin {
                order,
                micro_weight,
                feed,
            } => {
                let weight = Millionths(*micro_weight);
                write!(f, "nurbs order {order} weight {weight} {feed}")
            }
            Command::NurbsPoint {
                at: [x, y],
                micro_weight,
            } => {
                let weight = Millionths(*micro_weight);
                write!(f, "nurbs point X{x} Y{y} weight {weight}")
            }
            Command::NurbsEnd { to } => write!(f, "nurbs end{}", Point(to, axes)),
            Command::Thread { to, lead } => write!(f, "thread{} lead {lead}", Point(to, axes)),
            Command::Tap { bottom, lead, .. } => {
                write!(f, "tap{} lead {lead}", Point(bottom, axes))
            }
            Command::Probe {
                to,
                feed,
                away,
                must,
            } => {
                let way = if *away { " away" } else { "" };
                let must = if *must { "" } else { " optional" };
                write!(f, "probe{way}{must}{} {feed}", Point(to, axes))
            }
            Command::Surface {
                direction,
                speed,
                most_milli_rpm,
            } => {
                write!(f, "surface {} {speed} mm/min", direction.name())?;
                match most_milli_rpm {
                    Some(most) => {
                        write!(f, " at most {} rpm", Millionths(most.saturating_mul(1000)))
                    }
                    None => Ok(()),
                }
            }
            Command::Orient {
                micro_degrees,
                direction,
            } => {
                write!(
                    f,
                    "orient {} {}",
                    Millionths(*micro_degrees),
                    direction.name()
                )
            }
            Command::ToolIs { number } => write!(f, "tool is {number}"),
            Command::ToolLength { number, offset } => {
                write!(f, "tool length {number}{}", Point(offset, axes))
            }
            Command::Compensation { side: None, .. } => f.write_str("compensation off"),
            Command::Compensation {
                side: Some(side),
                radius,
                plane,
            } => {
                let side = if *side == Side::Left { "left" } else { "right" };
                write!(f, "compensation {side} {} radius {radius}", plane.name())
            }
            Command::Switch { what, on } => {
                let name = match what {
                    Switch::Overrides => "overrides",
                    Switch::FeedOverride => "feed override",
                    Switch::SpindleOverride => "spindle override",
                    Switch::AdaptiveFeed => "adaptive feed",
                    Switch::FeedHold => "feed hold",
                };
                write!(f, "{name} {}", if *on { "on" } else { "off" })
            }
            Command::Output {
                number,
                on,
                with_motion,
            } => {
                let when = if *with_motion { " with motion" } else { "" };
                write!(
                    f,
                    "output {number} {}{when}",
                    if *on { "on" } else { "off" }
                )
            }
            Command::Analog {
                number,
                micro,
                with_motion,
            } => {
                let when = if *with_motion { " with motion" } else { "" };
                write!(f, "analog {number} {}{when}", Nm(*micro))
            }
            Command::Wait {
                input,
                until,
                timeout_micros,
            } => {
                match input {
                    Input::Digital(number) => write!(f, "wait digital {number}")?,
                    Input::Analog(number) => write!(f, "wait analog {number}")?,
                }
                let until = match until {
                    WaitFor::Nothing => return Ok(()),
                    WaitFor::Rise => "rise",
                    WaitFor::Fall => "fall",
                    WaitFor::High => "high",
                    WaitFor::Low => "low",
                };
                write!(f, " {until} {} s", Millionths(*timeout_micros))
            }
            Command::Heat {
                heater,
                milli_celsius,
                wait,
            } => {
                match heater {
                    Heater::Extruder(number) => write!(f, "heat extruder {number}")?,
                    Heater::Bed => f.write_str("heat bed")?,
                    Heater::Chamber => f.write_str("heat chamber")?,
                }
                let target = u64::from(*milli_celsius).saturating_mul(1000);
                write!(f, " {} C", Millionths(target))?;
                f.write_str(match wait {
                    HeatWait::None => "",
                    HeatWait::Heated => " wait",
                    HeatWait::Reached => " wait reached",
                })
            }
            Command::Fan { number, per_mille } => {
                let share = u64::from(*per_mille).saturating_mul(100_000);
                write!(f, "fan {number} {} %", Millionths(share))
            }
            Command::MotorsOff => f.write_str("motors off"),
            Command::Drill => f.write_str("drill"),
            Command::Pallet => f.write_str("stop pallet"),
            Command::Dwell { micros } => write!(f, "dwell {} s", Millionths(*micros)),
            Command::Spindle {
                direction: SpindleDirection::Off,
                ..
            } => f.write_str("spindle off"),
            Command::Spindle {
                direction,
                milli_rpm,
            } => {
                write!(
                    f,
                    "spindle {} {} rpm",
                    direction.name(),
                    Millionths(milli_rpm.saturating_mul(1000))
                )
            }
            Command::Coolant {
                mist: false,
                flood: false,
            } => f.write_str("coolant off"),
            Command::Coolant { mist, flood } => {
                f.write_str("coolant")?;
                f.write_str(if *mist { " mist" } else { "" })?;
                f.write_str(if *flood { " flood" } else { "" })
            }
            Command::Tool { number } => write!(f, "tool {number}"),
            Command::Stop { optional } => {
                f.write_str(if *optional { "stop optional" } else { "stop" })
            }
            Command::End { rewind } => f.write_str(if *rewind { "end rewind" } else { "end" }),
            Command::Path {
                mode: PathMode::ExactPath,
            } => f.write_str("path exact"),
            Command::Path {
                mode: PathMode::ExactStop,
            } => f.write_str("path exact-stop"),
            Command::Path {
                mode: PathMode::Blend { tolerance: None },
            } => f.write_str("path blend"),
            Command::Path {
                mode: PathMode::Blend {
                    tolerance: Some(by),
                },
            } => write!(f, "path blend {by}"),
        }
    }
}
