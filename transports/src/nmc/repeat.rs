//! Which commands may be sent again after a missing reply, and how readings show that a command
//! must not be sent again.
//!
//! A reply can be lost after the command was executed, and a packet does not show whether it is a
//! repetition. A command that does harm when executed twice is therefore never repeated without a
//! check. Readings before and after it decide.

use super::{Auxiliary, Command, Items, Mode, Reply, Reset, Status, Trajectory};

/// An axis at rest moves by less than this. Servo jitter and settling are smaller.
const STILL_COUNTS: u32 = 64;

/// When a command may be repeated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Repeat {
    /// At any time, because a second execution has no further effect.
    Free,
    /// Only if readings of these items, before and after, show that it was not executed: see
    /// [`Command::finding`].
    AfterReading(Items),
    /// Only if no module answers at this new address.
    AfterSilenceAt(u8),
    /// The command is sent once, because no module answers it.
    Never,
}

/// What two readings show about a command between them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Finding {
    /// It was executed.
    Executed,
    /// It was not executed.
    NotExecuted,
    /// It is not known, but a second execution has no further effect.
    Harmless,
    /// It is not known, and a repetition could do harm.
    Unknown,
}

impl Command {
    /// Returns when the command may be repeated to `address`.
    pub fn repeat(&self, address: u8) -> Repeat {
        const STANDING: Items = Items::POSITION.with(Items::VELOCITY);
        const MOTION: Items = STANDING.with(Items::AUXILIARY).with(Items::HOME);
        match self {
            Command::NoOperation
            | Command::DefineStatus(_)
            | Command::ReadStatus(_)
            | Command::SetGain(_)
            | Command::StopMotor(_)
            | Command::IoControl(_) => Repeat::Free,
            // In the buffer the second trajectory replaces the first.
            Command::LoadTrajectory(trajectory) if !trajectory.start_now => Repeat::Free,
            Command::SetHoming(homing) if homing.is_cancel() => Repeat::Free,
            Command::SetAddress { address: new, .. } if *new == address => Repeat::Free,
            // The next module of the daisy chain would take the same address.
            Command::SetAddress { address: new, .. } => Repeat::AfterSilenceAt(*new),
            Command::ResetPosition(Reset::Home) => Repeat::AfterReading(MOTION),
            Command::ResetPosition(_) => Repeat::AfterReading(STANDING),
            Command::LoadTrajectory(_) | Command::StartMotion | Command::SetHoming(_) => {
                Repeat::AfterReading(MOTION)
            }
            Command::SaveHome => Repeat::AfterReading(STANDING.with(Items::HOME)),
            Command::ClearBits => Repeat::AfterReading(Items::AUXILIARY),
            Command::AddPathPoints(_) => {
                Repeat::AfterReading(Items::PATH_POINTS.with(Items::AUXILIARY))
            }
            Command::SetBaud(_) | Command::HardReset(_) => Repeat::Never,
        }
    }

    /// Returns what readings of the items of [`repeat`](Self::repeat) before and after show. The
    /// motion that Start Motion started is not known here, so the worst case is assumed.
    /// [`Host`](super::Host) knows what it loaded.
    pub fn finding(&self, before: &Reply, after: &Reply) -> Finding {
        match self {
            Command::ResetPosition(Reset::Zero) => reset(0, before, after),
            Command::ResetPosition(Reset::To(position)) => reset(*position, before, after),
            // The home position becomes 0. It is unchanged only if it was 0.
            Command::ResetPosition(Reset::Home) => match (before.home(), after.home()) {
                (Some(0), Some(0)) => Finding::Harmless,
                (Some(_), Some(0)) => Finding::Executed,
                (Some(was), Some(is)) if was == is => Finding::NotExecuted,
                _ => Finding::Unknown,
            },
            Command::LoadTrajectory(trajectory) => start(Some(trajectory), before, after),
            Command::StartMotion => start(None, before, after),
            Command::SetHoming(_) => homing(before, after),
            Command::SaveHome => save_home(before, after),
            Command::ClearBits => clear_bits(before, after),
            Command::AddPathPoints(points) => {
                let added = points.points().len() as u8; // 7 at most
                let (was, is) = (before.readings.path_points, after.readings.path_points);
                let runs = |reply: &Reply| reply.readings.auxiliary.contains(Auxiliary::PATH_MODE);
                if added == 0 {
                    started_path(runs(before), runs(after))
                } else if runs(before) || runs(after) {
                    Finding::Unknown // points are used while others are added
                } else if is == was.wrapping_add(added) {
                    Finding::Executed
                } else if is == was {
                    Finding::NotExecuted
                } else {
                    Finding::Unknown
                }
            }
            _ => match self.repeat(0) {
                Repeat::Free => Finding::Harmless,
                _ => Finding::Unknown,
            },
        }
    }
}

fn started_path(was: bool, is: bool) -> Finding {
    match (was, is) {
        (false, true) => Finding::Executed,
        (true, true) => Finding::Harmless,
        _ => Finding::Unknown, // a short path is over already
    }
}

/// Whether the motion is done and the speed is 0.
fn stands(reply: &Reply) -> bool {
    reply.status.contains(Status::MOVE_DONE) && reply.velocity().unwrap_or_default() == 0
}

/// Returns the reading that two readings in a row confirm. Returns `None` if one of them must be
/// wrong, or if something happened in between. Values that the conclusions do not use (switches,
/// the index) may differ.
pub(super) fn agreement(first: &Reply, second: &Reply) -> Option<Reply> {
    const STATUS: u8 = Status::MOVE_DONE.0
        | Status::HOME_IN_PROGRESS.0
        | Status::POSITION_ERROR.0
        | Status::OVERCURRENT.0
        | Status::POWER_ON.0;
    const AUXILIARY: u8 =
        Auxiliary::POSITION_WRAP.0 | Auxiliary::SERVO_OVERRUN.0 | Auxiliary::PATH_MODE.0;
    let (a, b) = (&first.readings, &second.readings);
    let is_moving = !stands(first) || !stands(second);
    let leaves = a.auxiliary.contains(Auxiliary::PATH_MODE); // points, one after another
    let agrees = (first.status.0 ^ second.status.0) & STATUS == 0
        && (a.auxiliary.0 ^ b.auxiliary.0) & AUXILIARY == 0
        && a.home == b.home
        && (is_moving || is_near(a.position, b.position))
        && (leaves || a.path_points == b.path_points);
    // If the axis has a speed in one of the readings, this reading is used, because it gives fewer
    // conclusions.
    agrees.then_some(if stands(second) { *first } else { *second })
}

fn is_near(a: i32, b: i32) -> bool {
    // The difference, where positions wrap.
    a.wrapping_sub(b).unsigned_abs() <= STILL_COUNTS
}

/// Whether no event happened that an operator or a host must know of before anything moves.
fn is_undisturbed(before: &Reply, after: &Reply) -> bool {
    const WATCHED: u8 = Status::HOME_IN_PROGRESS.0
        | Status::POSITION_ERROR.0
        | Status::OVERCURRENT.0
        | Status::POWER_ON.0;
    (before.status.0 ^ after.status.0) & WATCHED == 0 && before.home() == after.home()
}

/// Whether the position became `to`. This can be seen only if the axis is at rest.
fn reset(to: i32, before: &Reply, after: &Reply) -> Finding {
    let (was, is) = (before.readings.position, after.readings.position);
    if !stands(before) || !stands(after) {
        Finding::Unknown
    } else if was == to && is == to {
        Finding::Harmless
    } else {
        match (is_near(is, to), is_near(is, was)) {
            (true, false) => Finding::Executed,
            (false, true) => Finding::NotExecuted,
            _ => Finding::Unknown,
        }
    }
}

/// Returns what the readings show about Start Motion. `trajectory` is `None` if it is not known.
pub(super) fn start(trajectory: Option<&Trajectory>, before: &Reply, after: &Reply) -> Finding {
    let done = |reply: &Reply| reply.status.contains(Status::MOVE_DONE);
    let began = done(before) && !done(after);
    let moved = stands(before) && !is_near(before.readings.position, after.readings.position);
    let known = trajectory.filter(|known| !known.is_relative());
    match known {
        _ if began || moved => Finding::Executed,
        // A trapezoid from standstill to the present position causes no motion. A speed that is
        // already set is kept.
        Some(known)
            if is_undisturbed(before, after)
                && (known.mode != Mode::Trapezoid || (stands(before) && stands(after))) =>
        {
            Finding::Harmless
        }
        _ => Finding::Unknown,
    }
}

/// If homing is armed again after its event, a second event would move the home position.
fn homing(before: &Reply, after: &Reply) -> Finding {
    let waits = |reply: &Reply| reply.status.contains(Status::HOME_IN_PROGRESS);
    let (Some(was), Some(is)) = (before.home(), after.home()) else {
        return Finding::Unknown;
    };
    let (from, to) = (before.readings.position, after.readings.position);
    match (waits(before), waits(after)) {
        (false, true) => Finding::Executed,
        (false, false) if was != is => Finding::Executed,
        // An event during the move would have latched a position on the path. The old home position
        // is not on the path.
        (false, false)
            if !is_near(was, from) && !is_near(was, to) && !is_between(was, from, to) =>
        {
            Finding::NotExecuted
        }
        // Or there was no motion that could have caused an event at the old home position again.
        (false, false) if from == to && stands(before) && stands(after) && was != from => {
            Finding::NotExecuted
        }
        _ => Finding::Unknown,
    }
}

fn is_between(value: i32, from: i32, to: i32) -> bool {
    (from.min(to)..=from.max(to)).contains(&value)
}

fn save_home(before: &Reply, after: &Reply) -> Finding {
    let (Some(was), Some(is)) = (before.home(), after.home()) else {
        return Finding::Unknown;
    };
    let stood = before.readings.position;
    if before.status.contains(Status::HOME_IN_PROGRESS) || !stands(before) || !stands(after) {
        Finding::Unknown
    } else if was != is {
        Finding::Executed
    } else if is == stood && is == after.readings.position {
        Finding::Harmless
    } else if !is_near(was, stood) {
        Finding::NotExecuted
    } else {
        Finding::Unknown
    }
}

fn clear_bits(before: &Reply, after: &Reply) -> Finding {
    let sticky = |reply: &Reply| {
        let status = reply.status.0 & (Status::OVERCURRENT.0 | Status::POSITION_ERROR.0);
        let auxiliary =
            reply.readings.auxiliary.0 & (Auxiliary::POSITION_WRAP.0 | Auxiliary::SERVO_OVERRUN.0);
        status | auxiliary // different bits: 0x14 and 0x22
    };
    let (was, is) = (sticky(before), sticky(after));
    if was != 0 && is == 0 {
        Finding::Executed
    } else if is & !was == 0 {
        Finding::Harmless // bits still set have a lasting cause or were not cleared
    } else {
        Finding::Unknown // a new bit, which must not be cleared before it is read
    }
}
