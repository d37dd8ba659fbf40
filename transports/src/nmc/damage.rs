//! What a damaged packet could turn into: another command, or half of one when the line is flushed.

use super::frame::HEADER;
use super::{Command, Frame, Receiver, Verdict};

/// Bytes of a flush: the longest packet lacks 18 at most.
pub const FLUSH_LENGTH: usize = 20;

/// The byte to fill a module's half-received packet with after `request` may have been damaged: 0 nearly always.
///
/// A module that missed a byte takes the flush for the rest of its packet. One time in 256 the sum of that is right, and then half
/// a command would be executed. So the damages that leave a packet open are tried on a receiver here (any byte lost, any byte
/// doubled, the rest lost from any byte on, a length with one wrong bit), and a byte is chosen that completes none of them. Where the sum
/// of one with a wrong length comes right with any byte (the last one is added, and compared), that may be completed to what is no command
/// of any version, but nothing else.
///
/// Cost: 62 receptions of up to 40 bytes for each byte tried, on a line that is about to rest for a millisecond.
pub fn flush_byte(request: &Frame) -> u8 {
    let safe = |is_harmful: fn(&Receiver) -> bool| {
        (0..HEADER).find(|byte| is_safe(request.bytes(), *byte, is_harmful))
    };
    safe(|_| true)
        .or_else(|| safe(|whole| Command::decode(whole.code(), whole.data(), 10).is_some()))
        .unwrap_or(0)
}

/// Whether one wrong bit makes a shorter command of this packet, one that a module of `version` would execute.
///
/// The sum shows any wrong bit but one in the length, which moves the place of the sum; the modules' strict lengths refuse what is left of
/// nearly all packets. Not of Reset Position relative to home at address 1, `AA 01 10 01 12`: with its length gone it is `AA 01 00 01`,
/// a reset to zero.
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

/// Whether a flush with `byte` makes a sound packet of what is left of the request, and a harmful one.
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
