//! Commands that damage could change into another command, or into half a command that a flush of
//! the line completes.

use super::frame::HEADER;
use super::{Command, Frame, Receiver, Verdict};

/// Bytes of a flush. At most 18 bytes of a packet are missing.
pub const FLUSH_LENGTH: usize = 20;

/// Returns the byte that completes a half-received packet after `request` may have been damaged. It
/// is nearly always 0.
///
/// A module that missed a byte takes the flush as the rest of its packet. Once in 256 cases the
/// checksum is right, and half a command would be executed. This function therefore tries on a
/// receiver every damage that leaves a packet incomplete: any byte lost, any byte doubled, all
/// bytes lost from any byte on, a length with one wrong bit. It chooses a byte that completes no
/// such packet. There is one special case: a packet with a wrong length whose checksum is right for
/// any byte, because the last byte is added and compared. Such a packet may only be completed to
/// something that is no command in any version.
///
/// Cost: 62 receptions of up to 40 bytes for each byte tried. The line then rests for a millisecond
/// anyway.
pub fn flush_byte(request: &Frame) -> u8 {
    let safe = |is_harmful: fn(&Receiver) -> bool| {
        (0..HEADER).find(|byte| is_safe(request.bytes(), *byte, is_harmful))
    };
    safe(|_| true)
        .or_else(|| safe(|whole| Command::decode(whole.code(), whole.data(), 10).is_some()))
        .unwrap_or(0)
}

/// Whether one wrong bit makes a shorter packet with a command that a module of `version` would
/// execute.
///
/// The checksum detects any wrong bit except one in the length, which moves the position of the
/// checksum. The modules accept only exact lengths, so they refuse nearly all such packets. The
/// exception is Reset Position relative to home at address 1, `AA 01 10 01 12`. With a wrong length
/// it is `AA 01 00 01`, a reset to zero.
pub(super) fn is_fragile(request: &Frame, version: u8) -> bool {
    [0x10, 0x20, 0x40, 0x80].into_iter().any(|bit| {
        let mut receiver = Receiver::new();
        (0..).zip(request.bytes()).any(|(place, sent)| {
            let heard = if place == 2 { sent ^ bit } else { *sent };
            receiver.push(heard) == Some(Verdict::Sound)
                && Command::decode(receiver.code(), receiver.data(), version).is_some()
        })
    })
}

fn is_safe(request: &[u8], byte: u8, is_harmful: fn(&Receiver) -> bool) -> bool {
    let lengths = [0x10, 0x20, 0x40, 0x80]
        .into_iter()
        .map(|bit| Damage::Length { bit });
    let places = 0..request.len();
    places
        .flat_map(|at| {
            [
                Damage::Lost { at },
                Damage::Doubled { at },
                Damage::Cut { at },
            ]
        })
        .chain(lengths)
        .all(|damage| !completes(request, damage, byte, is_harmful))
}

#[derive(Clone, Copy)]
enum Damage {
    Lost { at: usize },
    Doubled { at: usize },
    Cut { at: usize },
    Length { bit: u8 },
}

/// Whether a flush with `byte` completes the damaged request to a valid and harmful packet.
fn completes(request: &[u8], damage: Damage, byte: u8, is_harmful: fn(&Receiver) -> bool) -> bool {
    let mut receiver = Receiver::new();
    for (place, sent) in (0..).zip(request) {
        let heard = match damage {
            Damage::Lost { at } if at == place => continue,
            Damage::Cut { at } if at == place => break,
            Damage::Length { bit } if place == 2 => sent ^ bit,
            Damage::Doubled { at } if at == place => {
                receiver.push(*sent);
                *sent
            }
            _ => *sent,
        };
        receiver.push(heard);
    }
    (0..FLUSH_LENGTH).any(|_| receiver.push(byte) == Some(Verdict::Sound) && is_harmful(&receiver))
}
