//! The answers of the controller: bytes with bit 7 set.

use super::Axis;

/// A byte of the controller that is not an echo.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Answer {
    /// `80` to `85`: one motor step, `80 | axis << 1 | forward`.
    Step {
        /// The axis.
        axis: Axis,
        /// Away from machine zero.
        forward: bool,
    },
    /// `88`: ready; sent once after a reset.
    Ready,
    /// `89`: homing found no switch, or could not move off it. The positions are unknown.
    NoSwitch,
    /// `8b`: a correct string that cannot be executed. The mill is not homed, the target is beyond
    /// the travel, the arc is impossible, or the mill is moving.
    Refused,
    /// `8c`: the line is in the queue, one of our modes is confirmed, or the state is reported.
    Taken,
    /// `8d`: a motion ended before it was done.
    Stopped,
    /// `8e`: there is no such string.
    Wrong,
    /// `8f`: done.
    Done,
    /// `90` to `9f`: a digit of a [`State`](super::State), 0 to 15.
    Digit(u8),
}

impl Answer {
    /// Returns its byte.
    pub const fn byte(self) -> u8 {
        match self {
            Answer::Step { axis, forward } => 0x80 | (axis as u8) << 1 | forward as u8,
            Answer::Ready => 0x88,
            Answer::NoSwitch => 0x89,
            Answer::Refused => 0x8b,
            Answer::Taken => 0x8c,
            Answer::Stopped => 0x8d,
            Answer::Wrong => 0x8e,
            Answer::Done => 0x8f,
            Answer::Digit(digit) => 0x90 | digit & 0x0f,
        }
    }

    /// Returns the answer with this byte. Returns `None` for an echo, and for values without a
    /// meaning.
    pub const fn of(byte: u8) -> Option<Answer> {
        Some(match byte {
            0x80..=0x85 => {
                let axis = match byte & 0x7e {
                    0 => Axis::X,
                    2 => Axis::Y,
                    _ => Axis::Z,
                };
                Answer::Step {
                    axis,
                    forward: byte & 1 == 1,
                }
            }
            0x88 => Answer::Ready,
            0x89 => Answer::NoSwitch,
            0x8b => Answer::Refused,
            0x8c => Answer::Taken,
            0x8d => Answer::Stopped,
            0x8e => Answer::Wrong,
            0x8f => Answer::Done,
            0x90..=0x9f => Answer::Digit(byte & 0x0f),
            _ => return None,
        })
    }
}
