//! Hints for the user when a measurement fails.

use husillo_metrology::Error;
use husillo_metrology::routine::Failure;
use husillo_transports::nmc;

const SILENT: &str = "is it the right port, are the modules powered, is ADDR_IN of the farthest \
                      one low? After power off and on the modules accept group commands again. \
                      --raw shows the bytes";

const FIT: &str = "touch more points, farther apart";

/// The hint for a failure of the link.
const fn link(failure: nmc::Failure) -> &'static str {
    match failure {
        nmc::Failure::Silent => SILENT,
        nmc::Failure::Garbled => {
            "the line is disturbed, or two modules have one address. Check the termination and the \
             shield; --raw shows the bytes"
        }
        nmc::Failure::NotExecuted => {
            "the module reported damaged commands, so nothing has moved. Check the line and repeat \
             the command"
        }
        nmc::Failure::Uncertain => {
            "read the position of the axis with `status` before the next command"
        }
        nmc::Failure::Unsteady => {
            "the axis moves or vibrates although it should be at rest: check `gains`"
        }
    }
}

/// The hint for an error.
pub const fn help(error: &Error) -> Option<&'static str> {
    Some(match error {
        Error::Link { failure, .. } => link(*failure),
        Error::NoModules => SILENT,
        Error::NoModule { .. } | Error::NotServo { .. } => {
            "`module` of an axis in the machine file is its address; the farthest one has address 1"
        }
        Error::Doubtful => "switch the modules off and on; --raw shows the bytes",
        Error::NoPower { .. } => "switch on the supply of the motor",
        Error::NoAxis { .. } => "the axes are those of the machine file",
        Error::Periods => "give all axes the same `rate_divisor`",
        Error::NotHomed { .. } => {
            "`home` it first, on the index that the table was made with. Scale and squareness need \
             no home: `calibrate axis --no-table`"
        }
        Error::NoIndex { .. } => {
            "is the index of the encoder connected? Some linear scales have none"
        }
        Error::NotTogether => "the line is disturbed: all axes have been stopped",
        Error::NotSeen { .. } => {
            "wire the contact of the probe to limit 1 of every module. All axes have been stopped"
        }
        Error::PositionError { .. } => {
            "something blocks the axis, or `gains` and `rate` do not suit the motor"
        }
        Error::OverCurrent { .. } => "something blocks the axis, or `current_limit` is too low",
        Error::StillMoving { .. } => {
            "`gains` do not suit the motor, or `acceleration` is more than the motor can make. All \
             axes have been stopped"
        }
        Error::PreTravel { .. } => {
            "is --reference the position of this face, in the unit of the machine?"
        }
        Error::NotThere { .. } => {
            "`gains` do not suit the motor: friction holds it, or it oscillates"
        }
        Error::NoContact { .. } => {
            "is there a work piece in this direction, and is the probe plugged in? A simulated \
             machine needs --contact or --piece"
        }
        Error::Collision { .. } => {
            "look at the stylus, move back along the same path (slowly, until the contact opens), \
             and calibrate the probe again. With `safe` a routine moves over the part"
        }
        Error::EndSwitch { .. } => {
            "move in the opposite direction, slowly, until the switch opens. Then `home` the axis. \
             Check that `travel` lies within the switches"
        }
        Error::UnknownEnd { .. } => {
            "jog it a little in one direction. If the switch does not open, jog it in the other \
             one; or `home` it, which tries both"
        }
        Error::NoEndSwitch { .. } => {
            "does the switch stick? Is it wired to the input that `limit_2` of the axis says, and \
             is `travel` as long as the axis? A simulated machine needs --end"
        }
        Error::DoubtfulContact => "the line is disturbed; --raw shows the bytes",
        Error::OtherSense { .. } => {
            "a touch in the positive direction closes limit 1, and one in the negative direction \
             limit 2: are the two contacts exchanged, or was the probe pushed from behind?"
        }
        Error::NotTouching => "touch the surface first: G38.2 stops at the contact and stays there",
        Error::NotLatched { .. } => {
            "the contact changed while the axes came to rest at the end of the search. Search \
             farther"
        }
        Error::Kept { .. } => "does this direction lead off the surface? The probe may also stick",
        Error::Probe(husillo_probe::Failure::ContactAtStart) => {
            "move away from the contact first: goto, or G38.4 in a program"
        }
        Error::Probe(husillo_probe::Failure::OverTravel) => {
            "lower `rate` of [probe], or raise `over_travel`"
        }
        Error::Probe(_) => "the probe is loose, or vibrates: lower the rates of [probe]",
        Error::Fit(_) => FIT,
        _ => return None,
    })
}

/// The hint for a failed line of a routine.
pub const fn of_failure(failure: &Failure) -> Option<&'static str> {
    match failure {
        Failure::Machine(error) => help(error),
        Failure::Fit(_) => Some(FIT),
        Failure::BothSides => {
            Some("touch the points of a hole from inside, those of a pin from outside")
        }
        Failure::NoFrame => Some("the line must not be at right angles to the plane"),
        Failure::Parallel
        | Failure::NoDirection
        | Failure::NoPosition(_)
        | Failure::NotMeasured(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_of_the_line_names_the_axis_and_what_to_do() {
        for failure in [
            nmc::Failure::Silent,
            nmc::Failure::Garbled,
            nmc::Failure::NotExecuted,
            nmc::Failure::Uncertain,
            nmc::Failure::Unsteady,
        ] {
            let module = "axis Y (module 2)".to_owned();
            let error = Error::Link { module, failure };
            assert!(error.to_string().starts_with("axis Y (module 2): "));
            assert!(help(&error).is_some(), "{error}");
        }
    }
}
