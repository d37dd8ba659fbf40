//! Why nothing was measured.

use husillo_transports::nmc;
use std::fmt;
use std::io;

/// Why an action has no result. Lengths and positions are texts with their unit.
#[derive(Debug)]
pub enum Trouble {
    /// The port failed.
    Port(io::Error),
    /// The link did.
    Link(nmc::Failure),
    /// The link would not send it.
    Refused(nmc::Refused),
    /// Nobody on the line.
    NoModules,
    /// Fewer on the line than the machine has.
    NoModule {
        /// Highest address of a module that the machine has.
        wanted: u8,
        /// Modules on the line.
        modules: u8,
    },
    /// The line is disturbed, or two modules answer at once.
    Doubtful,
    /// A motor has no supply.
    NoPower {
        /// Its letter.
        axis: char,
    },
    /// The machine has no such axis.
    NoAxis {
        /// Its letter.
        axis: char,
    },
    /// The profiles of the axes are not of one time.
    Periods,
    /// Not all modules have begun a move.
    NotTogether,
    /// A module has not seen what the others have.
    NotSeen {
        /// Its letter.
        axis: char,
    },
    /// The servo has given up.
    PositionError {
        /// Where.
        at: String,
    },
    /// The motor's current was beyond its limit.
    OverCurrent {
        /// Where.
        at: String,
    },
    /// An axis has not come to rest in the time that it may take.
    StillMoving {
        /// Where.
        at: String,
    },
    /// Ctrl-C.
    Interrupted,
    /// A calibration found a pre-travel that no probe has.
    PreTravel {
        /// What was found.
        found: String,
        /// The most that is possible.
        most: String,
    },
    /// The move did not end at its goal.
    NotThere {
        /// Where it was to be.
        goal: String,
        /// Where.
        at: String,
    },
    /// What is known of an axis' errors belongs to places of it, and nobody knows where it is.
    NotHomed {
        /// Its letter.
        axis: char,
    },
    /// The goal is not within the travel.
    OutsideTravel {
        /// Where it was to go.
        goal: String,
        /// Both ends of the travel.
        travel: [String; 2],
    },
    /// A contact where nothing was to be touched; the speed is that of the last reading before it.
    Collision {
        /// Letters of the axes that moved.
        axes: String,
        /// Where.
        at: String,
        /// How fast they went; `None`: they began to move.
        speed: Option<String>,
    },
    /// A contact that was told once, and not again.
    DoubtfulContact,
    /// No index on the way.
    NoIndex {
        /// Its letter.
        axis: char,
    },
    /// No contact on the way.
    NoContact {
        /// Where the move began.
        from: String,
        /// Where it ended.
        to: String,
    },
    /// Nothing touched where the end of a contact was to be found.
    NotTouching,
    /// The contact changed only after the search had ended.
    NotLatched {
        /// Where.
        at: String,
    },
    /// The contact lasted all the way.
    Kept {
        /// Where the move began.
        from: String,
        /// Where it ended.
        to: String,
    },
    /// Another end of the probing cycle.
    Probe(husillo_probe::Failure),
    /// A plan that is none.
    Plan(husillo_probe::PlanError),
    /// Touches that are not of the body they should be of.
    Fit(husillo_probe::FitError),
}

impl Trouble {
    /// Whether axes may have moved before it.
    pub const fn has_moved(&self) -> bool {
        !matches!(
            self,
            Self::OutsideTravel { .. }
                | Self::NoAxis { .. }
                | Self::NotHomed { .. }
                | Self::NotTouching
                | Self::Plan(_)
                | Self::Probe(husillo_probe::Failure::ContactAtStart)
        )
    }
}

impl fmt::Display for Trouble {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Port(error) => write!(out, "the port failed: {error}"),
            Self::Link(failure) => failure.fmt(out),
            Self::Refused(refused) => refused.fmt(out),
            Self::NoModules => out.write_str("no answer: no module on the line, at any rate"),
            Self::NoModule { wanted, modules } => {
                write!(out, "no answer of module {wanted}: {modules} on the line")
            }
            Self::Doubtful => {
                out.write_str("no undamaged answer while the modules got their addresses")
            }
            Self::NoPower { axis } => write!(out, "no motor power on {axis}"),
            Self::NoAxis { axis } => write!(out, "the machine has no axis {axis}"),
            Self::Periods => out.write_str("the modules of the axes do not step in one time"),
            Self::NotTogether => out.write_str("not all modules have begun the move"),
            Self::NotSeen { axis } => write!(out, "the module of {axis} has not seen the contact"),
            Self::PositionError { at } => write!(out, "position error at {at}"),
            Self::OverCurrent { at } => write!(out, "current beyond its limit at {at}"),
            Self::StillMoving { at } => write!(out, "still moving, at {at}"),
            Self::Interrupted => out.write_str("interrupted: all axes have been told to stop"),
            Self::PreTravel { found, most } => write!(
                out,
                "a pre-travel of {found}, where 0 to {most} (`over_travel`) is possible"
            ),
            Self::NotThere { goal, at } => write!(out, "stands at {at} instead of {goal}"),
            Self::OutsideTravel { goal, travel } => {
                let [low, high] = travel;
                write!(out, "{goal} is outside the travel, {low} to {high}")
            }
            Self::NotHomed { axis } => write!(
                out,
                "{axis} is not homed: its table of errors belongs to places, and counts begin \
                 anywhere"
            ),
            Self::NoIndex { axis } => write!(out, "no index of {axis} up to the end of the travel"),
            Self::NoContact { from, to } => write!(out, "no contact from {from} to {to}"),
            Self::Collision { axes, at, speed } => {
                write!(
                    out,
                    "collision: a contact at {at}, where nothing was to be touched"
                )?;
                match speed {
                    Some(speed) => write!(out, ", as {axes} went at about {speed}")?,
                    None => write!(out, ", as {axes} began to move")?,
                }
                out.write_str("; all axes have been stopped")
            }
            Self::DoubtfulContact => out.write_str(
                "a contact was told that a second reading does not confirm: all axes have been \
                 stopped",
            ),
            Self::NotTouching => out.write_str("nothing to leave: no contact at start"),
            Self::NotLatched { at } => write!(out, "contact, not latched, at {at}"),
            Self::Kept { from, to } => write!(out, "contact all the way from {from} to {to}"),
            Self::Probe(failure) => failure.fmt(out),
            Self::Plan(error) => error.fmt(out),
            Self::Fit(error) => error.fmt(out),
        }
    }
}

impl std::error::Error for Trouble {}

impl From<io::Error> for Trouble {
    fn from(error: io::Error) -> Self {
        Self::Port(error)
    }
}

impl From<nmc::Refused> for Trouble {
    fn from(refused: nmc::Refused) -> Self {
        Self::Refused(refused)
    }
}
