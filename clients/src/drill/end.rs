//! The end of a job as text.

use super::duration::spoken;
use husillo_sim::text::counted;

/// End of a job.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// All holes are drilled.
    Drilled,
    /// The drill runs the program alone.
    Detached,
    /// The job has failed.
    Failed(Failed),
    /// The drill was not reached, for this reason. Nothing was sent. The number of drilled holes
    /// is unknown.
    Unreached(String),
}

/// Progress of a failed job.
#[derive(Clone, Debug, PartialEq)]
pub struct Failed {
    /// The reason.
    pub why: String,
    /// Holes of the whole job that are done for certain.
    pub done: usize,
    /// Holes that may have been begun, at least `done`. The board shows which.
    pub begun: usize,
}

/// The message about an end and about how to continue. `again` is the command line without --from.
pub fn sentence(end: &End, again: &str, all: usize) -> String {
    match end {
        End::Drilled => format!("{} drilled", counted(all, "hole")),
        End::Detached => "the drill has started, and runs the program alone from here: it has no \
            lease, and does not stop when the cable is pulled"
            .into(),
        End::Unreached(why) => format!(
            "{why}\nnothing was sent. How many holes are drilled is not known here: a drill with \
             extras is asked for it when it answers; for an original count the holes in the board \
             before you use --from"
        ),
        End::Failed(Failed { why, done, begun }) => {
            let next = done + 1;
            let known = if done == begun {
                format!("{done} of {} drilled", counted(all, "hole"))
            } else {
                format!(
                    "{done} of {} drilled for certain, {begun} at most: look at the board",
                    counted(all, "hole")
                )
            };
            let go_on = if *done == all {
                "nothing is left to do".into()
            } else if *begun == 0 {
                format!("begin again with: {again}")
            } else if done == begun {
                format!("go on with: {again} --from {next}")
            } else {
                format!(
                    "go on with --from and the number of the first missing hole, {next} or later"
                )
            };
            format!("{why}\n{known}; {go_on}")
        }
    }
}

/// The remaining time as text, such as `about 3 min 20 s left`.
pub fn left(seconds: f64) -> String {
    if seconds < 1.0 {
        "longer than estimated".into()
    } else {
        format!("about {} left", spoken(seconds))
    }
}
