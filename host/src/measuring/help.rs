//! What to look at where nothing was measured.

use husillo_metrology::Trouble;
use husillo_metrology::routine::Failure;
use husillo_transports::nmc;

/// What to look at, in the words of the program.
pub const fn help(trouble: &Trouble) -> Option<&'static str> {
    Some(match trouble {
        Trouble::Link(nmc::Failure::Silent) | Trouble::NoModules => {
            "is it the right port, are the modules powered, is ADDR_IN of the farthest one low? \
             Switching them off and on makes them hear again what all are told. --raw shows the \
             bytes"
        }
        Trouble::NoModule { .. } => {
            "`module` of an axis in the machine file is its address; 1 is the far end"
        }
        Trouble::Doubtful => "switch the modules off and on; --raw shows the bytes",
        Trouble::NoPower { .. } => "switch the supply of the motor on",
        Trouble::NoAxis { .. } => "the axes are those of the machine file",
        Trouble::Periods => "give all axes the same `rate_divisor`",
        Trouble::NotHomed { .. } => {
            "`home` it first, on the index that the table was made from; scale and squareness need \
             no home: `calibrate axis --no-table`"
        }
        Trouble::NoIndex { .. } => "is the index of the encoder connected? A scale may have none",
        Trouble::NotTogether => "the line is disturbed: all axes have been stopped",
        Trouble::NotSeen { .. } => {
            "the contact of the probe is to be wired to limit 1 of every module; all axes have \
             been stopped"
        }
        Trouble::PositionError { .. } => {
            "something blocks the axis, or `gains` and `rate` do not suit the motor"
        }
        Trouble::OverCurrent { .. } => "something blocks the axis, or `current_limit` is too low",
        Trouble::StillMoving { .. } => {
            "`gains` do not suit the motor, or `acceleration` is more than it makes; all axes have \
             been stopped"
        }
        Trouble::PreTravel { .. } => {
            "is --reference the place of this face, and in the unit of the machine?"
        }
        Trouble::NotThere { .. } => {
            "`gains` do not suit the motor: friction holds it, or it oscillates"
        }
        Trouble::NoContact { .. } => {
            "is there a work piece in this direction, and the probe plugged in? In the simulation: \
             --contact"
        }
        Trouble::Collision { .. } => {
            "look at the stylus, go back the way it came (until the contact is open that is slow), \
             and calibrate the probe again. `safe` in a routine leads over the part"
        }
        Trouble::DoubtfulContact => "the line is disturbed; --raw shows the bytes",
        Trouble::NotTouching => "first touch it: G38.2 stops at the contact and stays there",
        Trouble::NotLatched { .. } => {
            "it changed as the axes came to rest at the end of the search: search farther"
        }
        Trouble::Kept { .. } => "is this the way off the surface? A probe may stick, too",
        Trouble::Probe(husillo_probe::Failure::ContactAtStart) => {
            "move away from the contact first: goto, or G38.4 in a program"
        }
        Trouble::Probe(husillo_probe::Failure::OverTravel) => {
            "lower `rate` of [probe], or raise `over_travel`"
        }
        Trouble::Probe(_) => "a loose probe, or vibration: lower the rates of [probe]",
        _ => return None,
    })
}

/// The same for a line of a routine.
pub const fn of_failure(failure: &Failure) -> Option<&'static str> {
    match failure {
        Failure::Machine(trouble) => help(trouble),
        Failure::Fit(_) => Some("touch more points, farther apart"),
        Failure::BothSides => {
            Some("points of a hole are touched from inside, those of a pin from outside")
        }
        Failure::NoFrame => Some("the line must not be at right angles to the plane"),
        Failure::Parallel | Failure::NoDirection | Failure::NotMeasured(_) => None,
    }
}
