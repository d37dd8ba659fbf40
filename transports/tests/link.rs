//! The frame link in virtual time: payloads arrive once and in order, or the link goes down.

use std::collections::VecDeque;

use husillo_transports::link::{
    Event, Frame, Kind, Lost, Master, PAYLOAD_BYTES, Peer, Received, Receiver, Refused, Station,
    Timing, WINDOW_FRAMES,
};
use proptest::prelude::*;

const BITS_PER_S: u32 = 115_200;

/// What a line does with a byte on its way to one receiver: `None` loses it.
type Fault<'a> = dyn FnMut(To, u8) -> Vec<u8> + 'a;

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum To {
    Master,
    Station(usize),
}

/// A master and three stations on two wires. Each station keeps its payloads and sends a count back
/// for each.
struct Shared {
    master: Master<3>,
    stations: [Station; 3],
    now_us: u32,
    got: [Vec<Vec<u8>>; 3],
    heard: [Vec<Vec<u8>>; 3],
    calls: [usize; 3],
    replies: [Vec<Vec<u8>>; 3],
    events: Vec<Event<'static>>,
}

impl Shared {
    fn new() -> Shared {
        let timing = Timing::of(BITS_PER_S);
        Shared {
            master: Master::new(timing, [1, 2, 3]),
            stations: [1, 2, 3].map(|address| Station::new(address, timing)),
            now_us: u32::MAX - 50_000,
            got: Default::default(),
            heard: Default::default(),
            calls: [0; 3],
            replies: Default::default(),
            events: Vec::new(),
        }
    }

    fn up() -> Shared {
        let mut line = Shared::new();
        for station in 0..3 {
            line.master.call(station).unwrap();
        }
        line.run(20_000, &mut |_, byte| vec![byte]);
        assert!((0..3).all(|station| line.master.is_up(station)));
        line.events.clear();
        line
    }

    /// A character's time: who speaks is heard by all others; two at once are heard as neither.
    fn character(&mut self, fault: &mut Fault<'_>) {
        let timing = Timing::of(BITS_PER_S);
        self.now_us = self.now_us.wrapping_add(timing.character_us);
        let now_us = self.now_us;
        let mut spoken = Vec::new();
        spoken.extend(self.master.transmit(now_us).map(|byte| (None, byte)));
        for (place, station) in self.stations.iter_mut().enumerate() {
            spoken.extend(station.transmit(now_us).map(|byte| (Some(place), byte)));
        }
        let byte = spoken.iter().fold(0xFF, |all, (_, byte)| all & byte);
        if let &[(speaker, _), ..] = &spoken[..] {
            let alone = spoken.len() == 1;
            if !(alone && speaker.is_none()) {
                for byte in fault(To::Master, byte) {
                    self.master_hears(byte);
                }
            }
            for place in 0..3 {
                if !(alone && speaker == Some(place)) {
                    for byte in fault(To::Station(place), byte) {
                        self.station_hears(place, byte);
                    }
                }
            }
        }
        while let Some(event) = self.master.poll(now_us) {
            self.events.push(event);
        }
        for station in &mut self.stations {
            station.poll(now_us);
        }
    }

    fn master_hears(&mut self, byte: u8) {
        match self.master.push(byte, self.now_us) {
            Some(Event::Data { station, payload }) => self.replies[station].push(payload.to_vec()),
            Some(Event::Up { station }) => self.events.push(Event::Up { station }),
            Some(Event::Down {
                station,
                why,
                unacknowledged,
            }) => self.events.push(Event::Down {
                station,
                why,
                unacknowledged,
            }),
            _ => {}
        }
    }

    fn station_hears(&mut self, place: usize, byte: u8) {
        let station = &mut self.stations[place];
        match station.push(byte, self.now_us) {
            Some(Received::Up) => self.calls[place] += 1,
            Some(Received::Data(payload)) => {
                self.got[place].push(payload.to_vec());
                let count = self.got[place].len() as u8;
                let _ = station.send(&[0, count]);
            }
            Some(Received::Broadcast(payload)) => self.heard[place].push(payload.to_vec()),
            None => {}
        }
    }

    fn run(&mut self, us: u32, fault: &mut Fault<'_>) {
        let begin_us = self.now_us;
        while self.now_us.wrapping_sub(begin_us) < us {
            self.character(fault);
        }
    }

    /// Sends these payloads to a station in turn, and stops if it goes down. Returns how many the
    /// master has taken.
    fn feed(&mut self, station: usize, payloads: &[Vec<u8>], fault: &mut Fault<'_>) -> usize {
        let mut begun = 0;
        for _ in 0..40_000 {
            if !self.master.is_up(station) {
                break;
            }
            match payloads.get(begun) {
                Some(payload) => begun += usize::from(self.master.send(station, payload).is_ok()),
                None if self.master.unacknowledged(station) == 0 => break,
                None => {}
            }
            self.character(fault);
        }
        begun
    }
}

fn payloads(count: usize) -> Vec<Vec<u8>> {
    (0..count)
        .map(|n| vec![n as u8, 0, 0xFF, n as u8 ^ 0x55])
        .collect()
}

/// Every byte lost, doubled, or with one wrong bit, for its receiver alone: all payloads arrive
/// once and in order, and the link stays up.
#[test]
fn any_single_fault_is_mended() {
    let sent = payloads(3);
    let mut clean = 0;
    Shared::up().feed(1, &sent, &mut |_, byte| {
        clean += 1;
        vec![byte]
    });
    assert!(clean > 100, "{clean}");
    for place in 0..clean {
        for kind in 0..10 {
            let mut line = Shared::up();
            let mut count = 0;
            let mut fault = |_: To, byte: u8| {
                count += 1;
                match kind {
                    _ if count - 1 != place => vec![byte],
                    8 => vec![],
                    9 => vec![byte, byte],
                    bit => vec![byte ^ 1 << bit],
                }
            };
            let begun = line.feed(1, &sent, &mut fault);
            line.run(200_000, &mut |_, byte| vec![byte]);
            let at = format!("fault {kind} at {place}: {:?}", line.events);
            assert_eq!(begun, sent.len(), "{at}");
            assert_eq!(line.got[1], sent, "{at}");
            assert_eq!(line.replies[1], [[0, 1], [0, 2], [0, 3]], "{at}");
            assert!(line.master.is_up(1), "{at}");
            assert!(line.got[0].is_empty() && line.got[2].is_empty());
        }
    }
}

/// A station that restarts at any moment takes nothing more until it is called, the master reports
/// it, and at most one payload is in doubt. The same holds for a cable that is unplugged and stays
/// so.
#[test]
fn a_restart_or_an_unplugged_cable_at_any_moment_is_reported() {
    let sent = payloads(3);
    let mut clean = 0;
    Shared::up().feed(1, &sent, &mut |_, byte| {
        clean += 1;
        vec![byte]
    });
    for place in 0..clean {
        for restarts in [false, true] {
            let mut line = Shared::up();
            let mut count = 0;
            let mut begun = 0;
            let mut was_down = false;
            for _ in 0..4_000 {
                if let Some(payload) = sent.get(begun) {
                    begun += usize::from(line.master.send(1, payload).is_ok());
                }
                let (mut here, unplugged) = (count, !restarts && count >= place);
                line.character(&mut |to, byte| {
                    here += 1;
                    let is_cut = unplugged && to != To::Station(0) && to != To::Station(2);
                    if is_cut { vec![] } else { vec![byte] }
                });
                if restarts && count <= place && here > place {
                    line.stations[1] = Station::new(2, Timing::of(BITS_PER_S));
                    was_down = true;
                }
                count = here;
            }
            let at = format!("{restarts} at {place}: {:?}", line.events);
            assert!(was_down || !restarts);
            let lost = line.events.iter().find_map(|event| match event {
                Event::Down {
                    station: 1,
                    why,
                    unacknowledged,
                } => Some((*why, *unacknowledged)),
                _ => None,
            });
            let why = if restarts {
                Lost::Restarted
            } else {
                Lost::NoAnswer
            };
            let (told, doubt) = lost.unwrap_or_else(|| panic!("{at}"));
            assert_eq!(told, why, "{at}");
            assert!(!line.master.is_up(1), "{at}");
            let got = line.got[1].len();
            assert_eq!(line.got[1], sent[..got], "{at}");
            assert!(
                got <= begun && begun <= got + doubt,
                "{begun} {got} {doubt} {at}"
            );
            let others = line.master.is_up(0) && line.master.is_up(2);
            assert!(others || !restarts, "{at}");
            // Called again it begins anew.
            line.master.call(1).unwrap();
            line.run(100_000, &mut |_, byte| vec![byte]);
            assert!(line.master.is_up(1), "{at}");
        }
    }
}

/// Whichever byte of a broadcast a station misses, the station is named, the others heard the
/// broadcast once, and all were asked before the next one may be sent.
#[test]
fn who_misses_a_broadcast_is_named() {
    for lost in 0..12 {
        for deaf in 0..3 {
            let mut line = Shared::up();
            line.master.broadcast(b"start").unwrap();
            let mut count = 0;
            line.run(60_000, &mut |to, byte| {
                if to != To::Station(deaf) {
                    return vec![byte];
                }
                count += 1;
                if count - 1 == lost {
                    vec![]
                } else {
                    vec![byte]
                }
            });
            for station in 0..3 {
                let expected = usize::from(station != deaf);
                assert_eq!(line.heard[station].len(), expected, "{lost} {deaf}");
            }
            let told = [Event::Missed { station: deaf }, Event::Checked];
            assert_eq!(line.events, told, "{lost} {deaf}");
        }
    }
}

/// On a bad line, for minutes. What arrived at a station is the beginning of what was sent since
/// the last call. At most one payload is in doubt when it goes down. A station that is not named
/// heard each broadcast once, the others at most once.
#[test]
fn minutes_of_noise_change_nothing() {
    let mut random = 0x2545_F491_4F6C_DD1D_u64;
    let mut line = Shared::up();
    let (mut sent, mut next, mut downs, mut heard) = ([const { Vec::new() }; 3], 0_u32, 0, 0);
    let (mut calls, mut shouted) = (line.calls, None);
    for _ in 0..1_500_000 {
        for (station, sent) in sent.iter_mut().enumerate() {
            next += 1;
            let payload = next.to_le_bytes().repeat(1 + next as usize % 5);
            if line.master.send(station, &payload).is_ok() {
                sent.push(payload);
            }
        }
        if shouted.is_none() && next % 500 == 0 {
            let before = [0, 1, 2].map(|station| line.heard[station].len());
            let were_up = [0, 1, 2].map(|station| line.master.is_up(station));
            if line.master.broadcast(&next.to_le_bytes()).is_ok() {
                shouted = Some((before, were_up));
            }
        }
        line.character(&mut |_, byte| {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            match random % 4_000 {
                0..8 => vec![byte ^ 1 << (random % 4_000)],
                8 => vec![],
                9 => vec![byte, byte],
                _ => vec![byte],
            }
        });
        for event in std::mem::take(&mut line.events) {
            match event {
                Event::Down {
                    station,
                    unacknowledged,
                    ..
                } => {
                    let (got, all) = (&line.got[station], &sent[station]);
                    assert!(got.len() <= all.len() && all.len() <= got.len() + unacknowledged);
                    assert_eq!(got[..], all[..got.len()]);
                    line.got[station].clear();
                    sent[station].clear();
                    line.master.call(station).unwrap();
                    (downs, calls[station]) = (downs + 1, line.calls[station]);
                    shouted = shouted.map(|(before, mut up): ([usize; 3], [bool; 3])| {
                        up[station] = false;
                        (before, up)
                    });
                }
                Event::Missed { station } => {
                    let (before, up) = shouted.as_mut().unwrap();
                    assert_eq!(line.heard[station].len(), before[station]);
                    up[station] = false;
                }
                Event::Checked => {
                    let (before, up) = shouted.take().unwrap();
                    for station in (0..3).filter(|station| up[*station]) {
                        assert_eq!(line.heard[station].len(), before[station] + 1);
                        heard += 1;
                    }
                }
                Event::Up { station } => assert!(line.calls[station] > calls[station]),
                Event::Data { .. } => unreachable!(),
            }
        }
    }
    assert!(downs > 0 && heard > 100, "{downs} {heard}");
}

/// A station that hears no broadcast at all is named every time: numbers come again after seven.
#[test]
fn who_misses_all_broadcasts_is_named_each_time() {
    let mut line = Shared::up();
    for round in 0..20 {
        line.master.broadcast(&[round]).unwrap();
        // The first frame on the line is the broadcast.
        let mut is_broadcast = true;
        line.run(60_000, &mut |to, byte| {
            let is_lost = is_broadcast && to == To::Station(1) && byte == 0;
            is_broadcast &= !is_lost;
            if is_lost { vec![] } else { vec![byte] }
        });
        assert_eq!(line.events, [Event::Missed { station: 1 }, Event::Checked]);
        line.events.clear();
    }
    assert_eq!(
        [20, 0, 20],
        [0, 1, 2].map(|station| line.heard[station].len())
    );
}

/// Many broadcasts, each heard once by all stations, at the same byte of the line. Two stations
/// never send at the same time.
#[test]
fn broadcasts_are_heard_by_all_at_once() {
    let mut line = Shared::up();
    for round in 0..20_u8 {
        line.master.broadcast(&[round]).unwrap();
        assert_eq!(line.master.broadcast(&[round]), Err(Refused::Full));
        loop {
            line.character(&mut |_, byte| vec![byte]);
            let counts = [0, 1, 2].map(|station| line.heard[station].len());
            assert!(counts == [usize::from(round) + 1; 3] || counts == [usize::from(round); 3]);
            if line.events.contains(&Event::Checked) {
                break;
            }
        }
        assert_eq!(line.events, [Event::Checked]);
        line.events.clear();
    }
}

/// A station that is gone does not keep the others waiting for more than its tries.
#[test]
fn the_dead_do_not_hold_up_the_living() {
    let mut line = Shared::up();
    line.stations[0] = Station::new(9, Timing::of(BITS_PER_S));
    let sent = payloads(40);
    assert_eq!(line.feed(2, &sent, &mut |_, byte| vec![byte]), 40);
    assert_eq!(line.got[2], sent);
    line.run(1_000_000, &mut |_, byte| vec![byte]);
    let down = Event::Down {
        station: 0,
        why: Lost::NoAnswer,
        unacknowledged: 0,
    };
    assert_eq!(line.events, [down]);
}

/// A station that is not asked any more says so, once.
#[test]
fn silence_is_noticed() {
    let mut line = Shared::up();
    let now_us = line.now_us;
    let station = &mut line.stations[0];
    assert_eq!(station.poll(now_us.wrapping_add(500_000)), None);
    assert_eq!(
        station.poll(now_us.wrapping_add(1_000_000)),
        Some(Lost::Silence)
    );
    assert_eq!(station.poll(now_us.wrapping_add(1_000_001)), None);
    assert_eq!(station.send(b"x"), Err(Refused::NotUp));
}

#[test]
fn what_cannot_be_sent_is_refused() {
    let mut line = Shared::up();
    let long = [1; PAYLOAD_BYTES + 1];
    assert_eq!(line.master.send(0, &long), Err(Refused::TooLong));
    assert_eq!(line.master.send(3, b"x"), Err(Refused::NoStation));
    assert_eq!(line.master.call(3), Err(Refused::NoStation));
    assert_eq!(line.master.broadcast(&long), Err(Refused::TooLong));
    assert_eq!(line.master.send(0, &long[..PAYLOAD_BYTES]), Ok(()));
    assert_eq!(line.master.send(0, b"x"), Err(Refused::Full));
    let mut down = Shared::new();
    assert_eq!(down.master.send(0, b"x"), Err(Refused::NotUp));
    assert_eq!(down.master.broadcast(b"x"), Err(Refused::NotUp));
    assert_eq!(down.stations[0].send(b"x"), Err(Refused::NotUp));
}

/// Two peers with a delay in each direction: payloads offered and payloads received, per session of
/// the called end.
struct Pair {
    ends: [Peer<7>; 2],
    wires: [VecDeque<Option<u8>>; 2],
    now_us: u32,
    /// Offered at this end since the link came up here, received at this end since then.
    offered: [Vec<Vec<u8>>; 2],
    got: [Vec<Vec<u8>>; 2],
    lost: [Vec<Lost>; 2],
    ups: [usize; 2],
}

impl Pair {
    fn new(delay: usize) -> Pair {
        let timing = Timing {
            turnaround_us: 0,
            ..Timing::of(BITS_PER_S)
        };
        let mut caller = Peer::caller(7, timing);
        caller.call();
        Pair {
            ends: [caller, Peer::station(7, timing)],
            wires: [(); 2].map(|()| vec![None; delay].into()),
            now_us: 0,
            offered: Default::default(),
            got: Default::default(),
            lost: Default::default(),
            ups: [0; 2],
        }
    }

    fn character(&mut self, fault: &mut dyn FnMut(usize, u8) -> Vec<u8>) {
        let character_us = Timing::of(BITS_PER_S).character_us;
        self.now_us = self.now_us.wrapping_add(character_us);
        for from in 0..2 {
            let to = 1 - from;
            let spoken = self.ends[from].transmit(self.now_us);
            self.wires[from].push_back(spoken);
            let Some(byte) = self.wires[from].pop_front().flatten() else {
                continue;
            };
            for byte in fault(from, byte) {
                match self.ends[to].push(byte, self.now_us) {
                    Some(Received::Up) => {
                        self.ups[to] += 1;
                        self.got[to].clear();
                        self.offered[to].clear();
                    }
                    Some(Received::Data(payload)) => self.got[to].push(payload.to_vec()),
                    Some(Received::Broadcast(_)) => panic!("a broadcast"),
                    None => {}
                }
            }
        }
        for (end, lost) in self.ends.iter_mut().zip(&mut self.lost) {
            lost.extend(end.poll(self.now_us));
        }
    }

    fn offer(&mut self, end: usize, payload: &[u8]) {
        if self.ends[end].send(payload).is_ok() {
            self.offered[end].push(payload.to_vec());
        }
    }

    /// The payloads received are the beginning of those offered at the other end, and the missing
    /// ones are not acknowledged.
    fn check(&self) {
        for end in 0..2 {
            let (offered, got) = (&self.offered[end], &self.got[1 - end]);
            assert!(got.len() <= offered.len());
            assert_eq!(got[..], offered[..got.len()]);
            assert!(offered.len() - got.len() <= self.ends[end].unacknowledged());
        }
    }
}

/// Both directions full: nearly all bytes of the line are payload, also with a delay of some
/// frames.
#[test]
fn a_window_keeps_the_line_full() {
    for delay in [0, 40, 200] {
        let mut pair = Pair::new(delay);
        let mut number = 0_u32;
        for _ in 0..2_000 {
            pair.character(&mut |_, byte| vec![byte]);
        }
        for _ in 0..100_000 {
            for end in 0..2 {
                number += 1;
                let mut payload = [0x5A; PAYLOAD_BYTES];
                payload[..4].copy_from_slice(&number.to_le_bytes());
                pair.offer(end, &payload);
            }
            pair.character(&mut |_, byte| vec![byte]);
        }
        for got in &pair.got {
            let share = (got.len() * PAYLOAD_BYTES) as f64 / 1e5;
            assert!(share > 0.93, "{share} at a delay of {delay}");
        }
        assert!(pair.lost.iter().all(Vec::is_empty));
    }
}

#[derive(Clone, Debug)]
enum Act {
    Offer(usize, Vec<u8>),
    Run(usize),
    /// The next byte of this direction is lost, doubled or changed, after some.
    Fault(usize, u8, usize),
    Restart,
    Call,
    Unplug(usize),
}

fn acts() -> impl Strategy<Value = Vec<Act>> {
    let payload = prop::collection::vec(prop_oneof![Just(0), any::<u8>()], 0..12);
    prop::collection::vec(
        prop_oneof![
            6 => (0usize..2, payload).prop_map(|(end, payload)| Act::Offer(end, payload)),
            4 => (1usize..400).prop_map(Act::Run),
            4 => (0usize..2, 0u8..10, 0usize..30).prop_map(
                |(end, kind, n)| Act::Fault(end, kind, n)
            ),
            1 => Just(Act::Restart),
            1 => Just(Act::Call),
            1 => (1usize..3000).prop_map(Act::Unplug),
        ],
        1..60,
    )
}

proptest! {
    /// Whatever the line does: the payloads received are, without a gap and once, the beginning of
    /// those offered since the link came up, and the missing ones count as not acknowledged. On a
    /// good line all arrive in the end.
    #[test]
    fn nothing_comes_twice_or_out_of_order(acts in acts(), delay in 0usize..60) {
        let mut pair = Pair::new(delay);
        (0..500).for_each(|_| pair.character(&mut |_, byte| vec![byte]));
        for act in acts {
            match act {
                Act::Offer(end, payload) => pair.offer(end, &payload),
                Act::Run(characters) => (0..characters).for_each(
                    |_| pair.character(&mut |_, byte| vec![byte])
                ),
                Act::Fault(direction, kind, after) => {
                    let mut left = after as isize;
                    for _ in 0..200 {
                        pair.character(&mut |from, byte| {
                            left -= isize::from(from == direction);
                            match kind {
                                _ if from != direction || left != -1 => vec![byte],
                                8 => vec![],
                                9 => vec![byte, byte],
                                bit => vec![byte ^ 1 << bit],
                            }
                        });
                    }
                }
                Act::Restart => {
                    pair.ends[1] = Peer::station(
                        7,
                        Timing { turnaround_us: 0, ..Timing::of(BITS_PER_S) },
                    );
                    let was_up = pair.ends[0].is_up();
                    (0..8_000).for_each(|_| pair.character(&mut |_, byte| vec![byte]));
                    prop_assert!(!(was_up && pair.ends[0].is_up()));
                    pair.ends[0].call();
                }
                Act::Call => pair.ends[0].call(),
                Act::Unplug(characters) => (0..characters).for_each(
                    |_| pair.character(&mut |_, _| vec![])
                ),
            }
            if pair.ends.iter().all(Peer::is_up) && pair.ups[0] > 0 {
                pair.check();
            }
        }
        // The last faults may have been one too many.
        for _ in 0..2 {
            if !pair.ends[0].is_up() {
                pair.ends[0].call();
            }
            (0..8_000).for_each(|_| pair.character(&mut |_, byte| vec![byte]));
        }
        prop_assert!(pair.ends.iter().all(Peer::is_up));
        pair.check();
        prop_assert_eq!(&pair.got[0], &pair.offered[1]);
        prop_assert_eq!(&pair.got[1], &pair.offered[0]);
    }

    /// Frames equal those that the well-known crate makes of their bodies, and are read back
    /// unchanged after any bytes on the line.
    #[test]
    fn frames_come_back(
        (
            address,
            number,
            acknowledged,
            broadcast,
            from_station,
        ) in (any::<u8>(), 0u8..16, 0u8..16, 0u8..8, any::<bool>()),
        kind in prop::sample::select(vec![Kind::Data, Kind::Acknowledge, Kind::Gap, Kind::Call]),
        payload in prop::collection::vec(prop_oneof![Just(0), any::<u8>()], 0..=PAYLOAD_BYTES),
        before in prop::collection::vec(any::<u8>(), 0..300),
    ) {
        let frame = Frame {
            address,
            kind,
            from_station,
            broadcast,
            number,
            acknowledged,
            payload: &payload,
        };
        let sent = frame.encode().unwrap();
        let wire = sent.bytes();
        let (body, end) = (cobs::decode_vec(wire).unwrap(), wire.split_last().unwrap());
        prop_assert_eq!(*end.0, 0);
        prop_assert_eq!(&cobs::encode_vec(&body)[..], end.1);
        prop_assert_eq!(body.len(), payload.len() + 5);
        let mut receiver = Receiver::new();
        for byte in before {
            receiver.push(byte);
        }
        receiver.push(0);
        let (last, others) = wire.split_last().unwrap();
        for byte in others {
            prop_assert_eq!(receiver.push(*byte), None);
        }
        prop_assert_eq!(receiver.push(*last), Some(frame));
    }

    /// Up to three wrong bits in the body of a frame are always found.
    #[test]
    fn three_wrong_bits_are_found(
        payload in prop::collection::vec(1u8..=255, 0..=PAYLOAD_BYTES),
        bits in prop::collection::btree_set(0usize..40, 1..=3),
    ) {
        let frame = Frame {
            address: 1,
            kind: Kind::Data,
            from_station: false,
            broadcast: 0,
            number: 3,
            acknowledged: 1,
            payload: &payload,
        };
        let mut body = cobs::decode_vec(frame.encode().unwrap().bytes()).unwrap();
        for bit in bits {
            body[bit / 8 % 5] ^= 1 << (bit % 8);
        }
        let mut wire = cobs::encode_vec(&body);
        wire.push(0);
        let mut receiver = Receiver::new();
        prop_assert!(wire.into_iter().all(|byte| receiver.push(byte).is_none()));
    }
}

#[test]
fn the_sizes_are_as_said() {
    assert_eq!(WINDOW_FRAMES, 7);
    // As 64-bit hosts have them; a microcontroller needs less.
    assert!(size_of::<Receiver>() <= 144);
    assert!(size_of::<Station>() <= 496);
    assert!(size_of::<Master<3>>() <= 504 + 3 * 176);
    assert!(size_of::<Peer<7>>() <= 512 + 6 * 128);
}

/// A window that is full blocks until something is acknowledged; what stays wrong is told at once.
#[cfg(feature = "nb")]
#[test]
fn sending_waits_for_the_window() {
    let timing = Timing::of(BITS_PER_S);
    let mut ends = [Peer::<2>::caller(1, timing), Peer::<2>::station(1, timing)];
    let mut now_us = 0;
    let mut got = Vec::new();
    assert_eq!(
        ends[0].poll_send(b"x"),
        Err(nb::Error::Other(Refused::NotUp))
    );
    ends[0].call();
    let mut exchange = |ends: &mut [Peer<2>; 2]| {
        now_us += 100;
        for from in 0..2 {
            if let Some(byte) = ends[from].transmit(now_us) {
                if let Some(Received::Data(payload)) = ends[1 - from].push(byte, now_us) {
                    got.push(payload[0]);
                }
            }
        }
    };
    while !ends[0].is_up() {
        exchange(&mut ends);
    }
    let mut waits = 0;
    for number in 0..6 {
        nb::block!({
            let result = ends[0].poll_send(&[number]);
            if result.is_err() {
                waits += 1;
                exchange(&mut ends);
            }
            result
        })
        .unwrap();
    }
    while ends[0].unacknowledged() > 0 {
        exchange(&mut ends);
    }
    assert!(waits > 0);
    assert_eq!(got, [0, 1, 2, 3, 4, 5]);
    assert_eq!(
        ends[0].poll_send(&[0; PAYLOAD_BYTES + 1]),
        Err(nb::Error::Other(Refused::TooLong))
    );
}
