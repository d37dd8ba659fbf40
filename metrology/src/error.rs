//! Errors of actions on a machine.

use crate::heads::End;
use husillo_transports::nmc;
use std::fmt;
use std::io;

/// Why an action failed. Lengths and positions are texts with their unit.
#[derive(Debug)]
pub enum Error {
    /// The port failed.
    Port(io::Error),
    /// The link failed.
    Link {
        /// The module to which the command was sent: its axis, if it is known, and its address.
        module: String,
        /// How it failed.
        failure: nmc::Failure,
    },
    /// The link refused to send the command.
    Refused(nmc::Refused),
    /// No module answers.
    NoModules,
    /// The line has fewer modules than the machine.
    NoModule {
        /// Highest address of a module that the machine has.
        wanted: u8,
        /// Modules on the line.
        modules: u8,
    },
    /// The module of an axis is of another kind.
    NotServo {
        /// Its address.
        module: u8,
        /// The kind that it reports: 2 for inputs and outputs, 3 for a stepper.
        kind: u8,
    },
    /// The line is disturbed, or two modules answer at once.
    Doubtful,
    /// A motor has no supply.
    NoPower {
        /// Its letter.
        axis: char,
    },
    /// The machine does not have this axis.
    NoAxis {
        /// Its letter.
        axis: char,
    },
    /// The modules of the axes have profiles of different periods.
    Periods,
    /// Not all modules have begun a move.
    NotTogether,
    /// A module has not detected the event that the others have detected.
    NotSeen {
        /// Its letter.
        axis: char,
    },
    /// The position error was beyond its limit.
    PositionError {
        /// The position.
        at: String,
    },
    /// The motor's current was beyond its limit.
    OverCurrent {
        /// The position.
        at: String,
    },
    /// An axis has not come to rest in the permitted time.
    StillMoving {
        /// The position.
        at: String,
    },
    /// The operator has requested a stop.
    Interrupted,
    /// A calibration found an impossible pre-travel.
    PreTravel {
        /// The pre-travel that was found.
        found: String,
        /// The largest possible pre-travel.
        most: String,
    },
    /// The move did not end at its goal.
    NotThere {
        /// The goal.
        goal: String,
        /// The position.
        at: String,
    },
    /// The table of errors of an axis counts from its index, and the axis is not homed.
    NotHomed {
        /// Its letter.
        axis: char,
    },
    /// The goal is not within the travel.
    OutsideTravel {
        /// The goal.
        goal: String,
        /// Both ends of the travel.
        travel: [String; 2],
    },
    /// A contact outside of a search.
    Collision {
        /// Letters of the axes that moved.
        axes: String,
        /// The position.
        at: String,
        /// Their speed, from the last readings before the contact. `None`: they had just begun to
        /// move.
        speed: Option<String>,
        /// Distance of the axes beyond the contact. `None`: the contact was not latched.
        beyond: Option<String>,
    },
    /// An end switch has closed, or an axis at its end switch would move farther.
    EndSwitch {
        /// Letter of the axis.
        axis: char,
        /// The end. `None`: it is not known.
        end: Option<End>,
        /// The position.
        at: String,
        /// The speed of the axes, from the last readings before. `None`: nothing moved.
        speed: Option<String>,
    },
    /// An axis at an end switch would move far, and it is not known at which end it is.
    UnknownEnd {
        /// Letter of the axis.
        axis: char,
        /// The position.
        at: String,
        /// The longest move until the switch opens.
        most: String,
    },
    /// The end switch of an axis did not change over the whole distance of its search.
    NoEndSwitch {
        /// Its letter.
        axis: char,
        /// The distance.
        length: String,
    },
    /// A contact that a second reading does not confirm.
    DoubtfulContact,
    /// The move did not pass an index.
    NoIndex {
        /// Its letter.
        axis: char,
    },
    /// The move ended without a contact.
    NoContact {
        /// Where the move began.
        from: String,
        /// Where it ended.
        to: String,
    },
    /// The contact for touches in the other direction closed.
    OtherSense {
        /// The position.
        at: String,
    },
    /// A search for the end of a contact began without contact.
    NotTouching,
    /// The contact changed only after the search had ended.
    NotLatched {
        /// The position.
        at: String,
    },
    /// The contact did not open until the end of the move.
    Kept {
        /// Where the move began.
        from: String,
        /// Where it ended.
        to: String,
    },
    /// Another failure of the probing cycle.
    Probe(husillo_probe::Failure),
    /// An impossible plan of the probing cycle.
    Plan(husillo_probe::PlanError),
    /// The touches do not lie on the body.
    Fit(husillo_probe::FitError),
}

impl Error {
    /// Whether axes may have moved before the error.
    pub const fn has_moved(&self) -> bool {
        !matches!(
            self,
            Self::OutsideTravel { .. }
                | Self::NoAxis { .. }
                | Self::NotHomed { .. }
                | Self::UnknownEnd { .. }
                | Self::NotTouching
                | Self::Plan(_)
                | Self::Probe(husillo_probe::Failure::ContactAtStart)
        )
    }
}

impl fmt::Display for Error {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Port(error) => write!(out, "the port failed: {error}"),
            Self::Link { module, failure } => write!(out, "{module}: {failure}"),
            Self::Refused(refused) => refused.fmt(out),
            Self::NoModules => out.write_str("no answer: no module on the line at any baud rate"),
            Self::NoModule { wanted, modules } => {
                write!(out, "no answer of module {wanted}: {modules} on the line")
            }
            Self::NotServo { module, kind } => {
                write!(
                    out,
                    "module {module} is no servo module: it is of type {kind}"
                )
            }
            Self::Doubtful => {
                out.write_str("only damaged answers while the modules got their addresses")
            }
            Self::NoPower { axis } => write!(out, "no motor power on {axis}"),
            Self::NoAxis { axis } => write!(out, "the machine has no axis {axis}"),
            Self::Periods => out.write_str("the modules of the axes have different periods"),
            Self::NotTogether => out.write_str("not all modules have begun the move"),
            Self::NotSeen { axis } => {
                write!(out, "the module of {axis} has not detected the contact")
            }
            Self::PositionError { at } => write!(out, "position error at {at}"),
            Self::OverCurrent { at } => write!(out, "current beyond its limit at {at}"),
            Self::StillMoving { at } => write!(out, "still moving, at {at}"),
            Self::Interrupted => out.write_str("interrupted: all axes have been commanded to stop"),
            Self::PreTravel { found, most } => write!(
                out,
                "a pre-travel of {found}, but only 0 to {most} (`over_travel`) is possible"
            ),
            Self::NotThere { goal, at } => write!(out, "stands at {at} instead of {goal}"),
            Self::OutsideTravel { goal, travel } => {
                let [low, high] = travel;
                write!(out, "{goal} is outside the travel, {low} to {high}")
            }
            Self::NotHomed { axis } => write!(
                out,
                "{axis} is not homed: its table of errors counts from the index"
            ),
            Self::NoIndex { axis } => write!(out, "no index of {axis} up to the end of the travel"),
            Self::NoContact { from, to } => write!(out, "no contact from {from} to {to}"),
            Self::Collision {
                axes,
                at,
                speed,
                beyond,
            } => {
                write!(out, "collision: a contact at {at}, outside of a search")?;
                match speed {
                    Some(speed) => write!(out, ", while {axes} moved at about {speed}")?,
                    None => write!(out, ", when {axes} began to move")?,
                }
                out.write_str("; all axes have been stopped")?;
                match beyond {
                    Some(beyond) => write!(out, ", {beyond} beyond it"),
                    None => Ok(()),
                }
            }
            Self::EndSwitch {
                axis,
                end,
                at,
                speed: Some(speed),
            } => write!(
                out,
                "{} of {axis} has closed at {at}, at about {speed}; all axes have been stopped",
                switch(*end)
            ),
            Self::EndSwitch { axis, end, at, .. } => write!(
                out,
                "{} of {axis} is closed at {at}: the axis moves away from it only",
                switch(*end)
            ),
            Self::UnknownEnd { axis, at, most } => write!(
                out,
                "one of the end switches of {axis} is closed at {at}, and it is not known which: \
                 until it opens, the axis moves by {most} at most"
            ),
            Self::NoEndSwitch { axis, length } => {
                write!(
                    out,
                    "the end switch of {axis} has not changed over {length}"
                )
            }
            Self::DoubtfulContact => out.write_str(
                "a second reading does not confirm a reported contact: all axes have been stopped",
            ),
            Self::OtherSense { at } => {
                write!(
                    out,
                    "the contact for the other direction has closed at {at}"
                )
            }
            Self::NotTouching => {
                out.write_str("no contact at the start, so there is nothing to leave")
            }
            Self::NotLatched { at } => write!(out, "contact, not latched, at {at}"),
            Self::Kept { from, to } => {
                write!(out, "the contact lasted from {from} to {to}")
            }
            Self::Probe(failure) => failure.fmt(out),
            Self::Plan(error) => error.fmt(out),
            Self::Fit(error) => error.fmt(out),
        }
    }
}

/// Returns the name of an end switch.
const fn switch(end: Option<End>) -> &'static str {
    match end {
        Some(End::Low) => "the low end switch",
        Some(End::High) => "the high end switch",
        None => "an end switch",
    }
}

impl std::error::Error for Error {}

impl From<io::Error> for Error {
    fn from(error: io::Error) -> Self {
        Self::Port(error)
    }
}

impl From<nmc::Refused> for Error {
    fn from(refused: nmc::Refused) -> Self {
        Self::Refused(refused)
    }
}
