//! Figures on the microfactory's link, good ones and damaged ones.

use husillo_transports::microfactory::{
    ByteTable, Device, Order, REJECTED, figure_check, move_bytes,
};

/// The bytes of a figure, from the first to the last.
fn figure(moves: &[[i16; 2]]) -> Vec<u8> {
    let mut bytes = vec![b'<'];
    for way in moves {
        bytes.push(b'3');
        bytes.extend(move_bytes(*way));
    }
    bytes.push(b'6');
    bytes.extend((moves.len() as u16).to_le_bytes());
    bytes.extend(figure_check(moves).to_le_bytes());
    bytes
}

const MOVES: [[i16; 2]; 3] = [[0x4142, -2], [0, 1000], [i16::MIN, 0x2121]];

#[test]
fn a_figure_is_kept_with_every_bit_of_it() {
    let mut link = Device::new(ByteTable::DEFAULT).storing(3);
    let bytes = figure(&MOVES);
    let found = bytes
        .iter()
        .filter_map(|byte| link.receive(*byte, false).command);
    let mut expected = vec![Order::Clear];
    expected.extend(MOVES.map(Order::Line));
    expected.push(Order::Keep);
    assert_eq!(found.collect::<Vec<_>>(), expected);
}

/// The figure that is there at the end.
fn kept(bytes: &[u8]) -> Option<Vec<[i16; 2]>> {
    let mut link = Device::new(ByteTable::DEFAULT).storing(9);
    let (mut lines, mut is_kept) = (Vec::new(), false);
    for byte in bytes {
        match link.receive(*byte, false).command {
            Some(Order::Clear) => (lines, is_kept) = (Vec::new(), false),
            Some(Order::Line(way)) => lines.push(way),
            Some(Order::Keep) => is_kept = true,
            _ => {}
        }
    }
    is_kept.then_some(lines)
}

#[test]
fn no_damaged_figure_is_kept() {
    let good = figure(&MOVES);
    assert_eq!(kept(&good), Some(MOVES.to_vec()));
    for place in 0..good.len() {
        for bit in 0..8 {
            let mut wrong = good.clone();
            wrong[place] ^= 1 << bit;
            assert_eq!(kept(&wrong), None, "bit {bit} of byte {place}");
        }
        let [mut lost, mut doubled] = [good.clone(), good.clone()];
        lost.remove(place);
        assert_eq!(kept(&lost), None, "byte {place} lost");
        doubled.insert(place, good[place]);
        // Behind a whole command a doubled byte may be none, and do nothing.
        let found = kept(&doubled);
        assert!(
            found.is_none_or(|found| found == MOVES),
            "byte {place} doubled"
        );
    }
}

#[test]
fn a_figure_needs_room_and_the_original_has_none() {
    let mut link = Device::new(ByteTable::DEFAULT).acknowledging();
    assert_eq!(link.receive(b'<', false).reply, Some(REJECTED));
    let mut link = link.storing(2);
    let rejected = figure(&MOVES)
        .iter()
        .filter(|byte| link.receive(**byte, false).reply == Some(REJECTED))
        .count();
    assert!(rejected > 0, "three moves in the room of two");
}

/// Four bytes at most are data of a half command: the fifth stop is one.
#[test]
fn five_stops_end_any_half_command() {
    for begun in [
        &b"N"[..],
        b"NX",
        b"<3",
        b"<3\x41",
        b"<3abc",
        b"<6",
        b"<6abc",
        b"J",
        b"NX\x05",
    ] {
        let mut link = Device::new(ByteTable::DEFAULT).acknowledging().storing(9);
        for byte in begun {
            link.receive(*byte, false);
        }
        let stops = [b'A'; 5].map(|byte| link.receive(byte, false).command);
        assert_eq!(stops[4], Some(Order::Stop), "{begun:?}");
        assert_eq!(link.receive(b'H', false).command, Some(Order::Home));
    }
}
