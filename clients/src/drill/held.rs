//! The holes of a job that the drill has drilled by itself.

use super::client::Client;
use super::load::{Load, MEMORY_RECORDS, loads_from};
use super::part::Part;
use husillo_transports::drill::Reading;

/// The number of holes of this board that a drill with extras has done. It follows from the program
/// in the drill's memory and from the drill's own count. `None`: the drill holds another program,
/// no program, or part of one, or it has drilled nothing.
pub(super) fn holes_done(client: &mut Client, parts: &[Part]) -> Option<usize> {
    let count = usize::from(client.drillings().ok()??);
    let (letter, records) = client.read(Reading::Records).ok()?;
    if count == 0 || letter != b'n' {
        return None;
    }
    let load = load_held(client, parts, usize::from(records))?;
    let drillings = count.min(load.seconds.len());
    let [holes, _] = load.holes([drillings; 2]);
    Some(load.before + holes)
}

/// The load that the drill holds, if its number of records is `records`.
fn load_held(client: &mut Client, parts: &[Part], records: usize) -> Option<Load> {
    let all: usize = parts.iter().map(Part::holes).sum();
    for from in 0..all {
        for most in [usize::MAX, MEMORY_RECORDS] {
            let load = loads_from(parts, from, most).into_iter().next()?;
            if load.bytes.len() / 3 == records && is_held(client, &load.bytes) {
                return Some(load);
            }
        }
    }
    None
}

/// Whether the drill holds this program. Compares record 1 and up to 16 others.
fn is_held(client: &mut Client, bytes: &[u8]) -> bool {
    let records: Vec<&[u8]> = bytes.chunks_exact(3).collect();
    let step = records.len().div_ceil(16).max(1);
    // The first two records are the position of the first hole.
    let looked_at = [1].into_iter().chain((0..records.len()).step_by(step));
    looked_at.into_iter().all(|number| {
        let record = client.record(number as u16);
        record.is_ok_and(|record| records.get(number) == Some(&&record[..]))
    })
}
