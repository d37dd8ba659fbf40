//! Any bytes on the project's own link, and any faults between its ends.

use husillo_transports::link::{Event, Master, Received, Receiver, Station, Timing};

use crate::bytes::Bytes;

const TIMING: Timing = Timing::of(115_200);

/// A master and two stations in virtual time, on a line that loses, adds and changes bytes; and the
/// bytes themselves as frames.
///
/// - A station receives the beginning of what was sent since its call, once and in order. When it
///   goes down, at most one payload is in doubt.
/// - A broadcast is received at most once by each station, and by all that are not named in the
///   check.
/// - A frame that was accepted can be written.
pub fn link(data: &[u8]) {
    let mut receiver = Receiver::new();
    for byte in data {
        if let Some(frame) = receiver.push(*byte) {
            assert!(frame.encode().is_some());
        }
    }
    let mut bytes = Bytes::new(data);
    let mut now_us = bytes.i32() as u32;
    let mut master = Master::new(TIMING, [1, 2]);
    let mut stations = [1, 2].map(|address| Station::new(address, TIMING));
    let (mut sent, mut got) = (
        [const { Vec::new() }; 2],
        [const { Vec::<Vec<u8>>::new() }; 2],
    );
    let mut was_up = [false; 2];
    let (mut heard, mut shouts, mut named) = ([0_u32; 2], 0_u32, [false; 2]);
    for _ in 0..300 {
        if bytes.is_empty() {
            break;
        }
        let act = bytes.byte();
        let place = usize::from(act & 1);
        match act >> 1 & 7 {
            0 => {
                let payload = vec![act; usize::from(bytes.byte() % 8)];
                if master.send(place, &payload).is_ok() {
                    sent[place].push(payload);
                }
            }
            1 => {
                let is_up = [0, 1].map(|station| master.is_up(station));
                if master.broadcast(&[act]).is_ok() {
                    shouts += 1;
                    (heard, named) = ([0; 2], is_up.map(|is_up| !is_up));
                }
            }
            2 => {
                master.call(place).expect("it is a station");
                (named[place], was_up[place]) = (true, false);
                sent[place].clear();
            }
            3 => {
                // A restarted station accepts nothing until it is called again.
                stations[place] = Station::new(place as u8 + 1, TIMING);
            }
            _ => {}
        }
        let fault = bytes.byte();
        for character in 0..16_u8 {
            now_us = now_us.wrapping_add(TIMING.character_us);
            let mut spoken = Vec::new();
            spoken.extend(master.transmit(now_us).map(|byte| (2, byte)));
            for (place, station) in stations.iter_mut().enumerate() {
                spoken.extend(station.transmit(now_us).map(|byte| (place, byte)));
            }
            for (speaker, byte) in spoken {
                let carried = match fault {
                    0 => vec![],
                    64..=79 if fault % 16 == character => vec![],
                    80..=95 if fault % 16 == character => vec![byte, byte],
                    96..=223 if fault % 16 == character => vec![byte ^ 1 << (fault / 16 % 8)],
                    _ => vec![byte],
                };
                for byte in carried {
                    let told = if speaker == 2 {
                        None
                    } else {
                        master.push(byte, now_us)
                    };
                    match told {
                        Some(Event::Up { station }) => was_up[station] = true,
                        Some(Event::Down {
                            station,
                            unacknowledged,
                            ..
                        }) => {
                            check(&sent[station], &got[station], unacknowledged);
                            (named[station], was_up[station]) = (true, false);
                        }
                        _ => {}
                    }
                    for (place, station) in stations.iter_mut().enumerate() {
                        match station.push(byte, now_us) {
                            Some(Received::Data(payload)) => got[place].push(payload.to_vec()),
                            Some(Received::Broadcast(_)) => heard[place] += 1,
                            // Data in flight at the time of the call belongs to the time before.
                            Some(Received::Up) => got[place].clear(),
                            None => {}
                        }
                    }
                }
            }
            while let Some(event) = master.poll(now_us) {
                match event {
                    Event::Down {
                        station,
                        unacknowledged,
                        ..
                    } => {
                        if was_up[station] {
                            check(&sent[station], &got[station], unacknowledged);
                        }
                        (named[station], was_up[station]) = (true, false);
                    }
                    Event::Missed { station } => named[station] = true,
                    Event::Checked => {
                        for (heard, named) in heard.iter().zip(&named) {
                            assert!(*named || *heard == 1, "{shouts}");
                        }
                    }
                    Event::Up { .. } | Event::Data { .. } => unreachable!("these come with bytes"),
                }
            }
            assert!(heard.iter().all(|heard| *heard <= 1));
        }
    }
}

fn check(sent: &[Vec<u8>], got: &[Vec<u8>], in_doubt: usize) {
    assert!(got.len() <= sent.len() && sent.len() <= got.len() + in_doubt);
    assert_eq!(*got, sent[..got.len()]);
}
