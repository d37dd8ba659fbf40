//! The lines of a contour as moves.

use super::shape::Segment;
use super::text::{Place, line_at};
use crate::blocks::block::Block;
use crate::command::Command;
use crate::command::arc::{Direction, Plane};
use crate::compensation::offset::Vector;
use crate::error::{Error, ErrorKind};
use crate::modal::Modal;
use crate::modal::commands::Commands;
use crate::values::nm::Nm;

/// X and Z of a position.
pub(super) fn point<const N: usize>(at: &[Nm; N]) -> Vector {
    [0, 2].map(|axis: usize| at.get(axis).map_or(0, |nm| nm.0))
}

/// One move of a contour as read.
#[derive(Copy, Clone, Debug)]
pub(super) struct Read {
    pub(super) from: Vector,
    pub(super) segment: Segment,
    pub(super) is_rapid: bool,
}

/// An error of a line, which may differ from that of the cycle.
#[derive(Copy, Clone, Debug)]
pub(super) struct Refused<'t> {
    pub(super) place: Place,
    pub(super) text: &'t [u8],
    pub(super) error: Error,
}

/// Plans the lines from one position to another, including the line there, on a copy of the state.
/// Every move is passed to `each`. An error is that of a line.
pub(super) fn read<'t, const N: usize>(
    text: &'t [u8],
    first: Place,
    last: Place,
    modal: &Modal<N>,
    mut each: impl FnMut(Read) -> Result<(), ErrorKind>,
) -> Result<(), Refused<'t>> {
    let mut modal = modal.clone();
    let mut commands = Commands::new();
    let mut place = first;
    while let Some((line, after)) = line_at(text, place).filter(|_| place.at <= last.at) {
        let refused = |error| Refused {
            place,
            text: line,
            error,
        };
        let block = Block::parse(line, modal.dialect()).map_err(refused)?;
        let mut from = modal.position();
        modal.apply(&block, &mut commands).map_err(refused)?;
        for command in &mut commands {
            let done = match moved(&from, &command) {
                Ok(None) => Ok(()),
                Ok(Some(read)) => each(read),
                Err(kind) => Err(kind),
            };
            done.map_err(|kind| refused(whole(kind, line)))?;
            from = command.end().unwrap_or(from);
        }
        place = after;
    }
    Ok(())
}

/// The move of a command for a contour; `None` for a command that does not affect it.
fn moved<const N: usize>(from: &[Nm; N], command: &Command<N>) -> Result<Option<Read>, ErrorKind> {
    let (to, arc, is_rapid) = match command {
        Command::Rapid { to } => (to, None, true),
        Command::Linear { to, .. } => (to, None, false),
        Command::Arc { arc, .. } if arc.plane == Plane::Zx && arc.turns == 0 => {
            let clockwise = arc.direction == Direction::Clockwise;
            (&arc.to, Some((point(&arc.centre), clockwise)), false)
        }
        // Commands that a finishing pass executes and roughing ignores.
        Command::Spindle { .. }
        | Command::Surface { .. }
        | Command::Coolant { .. }
        | Command::Compensation { .. }
        | Command::Path { .. } => return Ok(None),
        _ => return Err(ErrorKind::NotOfContour),
    };
    let mut others = (0..N).zip(from.iter().zip(to));
    if others.any(|(axis, (from, to))| !matches!(axis, 0 | 2) && from != to) {
        return Err(ErrorKind::NotOfContour);
    }
    let (from, to) = (point(from), point(to));
    if from == to && arc.is_none() {
        return Ok(None);
    }
    Ok(Some(Read {
        from,
        segment: Segment { to, arc },
        is_rapid,
    }))
}

/// An error about a whole line.
fn whole(kind: ErrorKind, text: &[u8]) -> Error {
    Error {
        kind,
        at: text.len().wrapping_sub(text.trim_ascii_start().len()),
        end: text.trim_ascii_end().len(),
    }
}
