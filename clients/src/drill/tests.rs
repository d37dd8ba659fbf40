//! Boards over the simulated line in virtual time, on good lines and bad ones.

use super::client::{Client, ClientError, Going};
use super::duration::seconds;
use super::end::{End, Failed, sentence};
use super::part::Part;
use super::place::Place;
use super::sender::{Operator, Sender};
use crate::{StopRequests, Wire};
use husillo_gcode::Nm;
use husillo_sim::Random;
use husillo_sim::device::Emulation;
use husillo_sim::device::LineFault as Fault;
use husillo_sim::device::drill::Device;
use husillo_transports::drill::{Failure, Record, Step, record_bytes};
use std::time::Duration;

/// An operator who types the given lines.
#[derive(Default)]
struct Script {
    answers: Vec<&'static str>,
    told: Vec<String>,
    shares: Vec<[f64; 2]>,
    /// Presses Ctrl-C after a message with these words.
    stops_at: Option<(&'static str, StopRequests)>,
}

impl Operator for Script {
    fn show(&mut self, line: &str) {
        self.told.push(line.to_owned());
        if let Some((words, stop)) = &self.stops_at {
            if line.contains(words) {
                stop.request();
            }
        }
    }

    fn change(&mut self, tool: &str, _: Option<Nm>) -> Option<String> {
        self.told.push(format!("change to {tool}"));
        (!self.answers.is_empty()).then(|| self.answers.remove(0).to_owned())
    }

    fn progress(&mut self, share: f64, left_s: f64) {
        self.shares.push([share, left_s]);
    }
}

/// Millimetres, as an operator types them.
fn diameter(text: &str) -> Option<Nm> {
    let millimetres: f64 = text.trim_end_matches(" mm").parse().ok()?;
    Some(Nm((millimetres * 1e6).round() as i64))
}

fn part(tool: u32, holes: &[[u16; 2]]) -> Part {
    let hole = |[x, y]: &[u16; 2]| [Record::X(*x), Record::Y(*y), Record::Drill(0)];
    Part {
        tool,
        diameter: Some(Nm(800_000)),
        records: holes.iter().flat_map(hole).collect(),
    }
}

fn client(is_original: bool) -> Client {
    client_of(Device::quick(is_original), StopRequests::default())
}

fn client_of(device: Device, stop: StopRequests) -> Client {
    Client::new(Wire::simulated(device), 2400, stop)
}

/// Sends a board, beginning at a given hole. Returns the end of the job and the client.
fn send(
    client: Client,
    parts: &[Part],
    from: usize,
    detach: bool,
    operator: &mut Script,
) -> (Result<End, String>, Client) {
    let mut sender = Sender {
        client,
        operator,
        parts,
        from,
        byte_s: 0.0085,
        is_homed: false,
        is_sure: true,
        diameter,
    };
    let end = sender.send(detach);
    (end, sender.client)
}

fn device(client: &mut Client) -> &mut Device {
    client.device().expect("it is simulated")
}

/// Positions of the complete holes.
fn drilled(client: &mut Client) -> Vec<[i32; 2]> {
    let holes = device(client).rig(0).unwrap().holes().iter();
    holes
        .filter(|hole| hole.depth == 6)
        .map(|hole| hole.at)
        .collect()
}

/// Simulates until the device is at rest.
fn rest(client: &mut Client) {
    for _ in 0..8000 {
        device(client).tick();
    }
}

fn places(parts: &[Part]) -> Vec<[i32; 2]> {
    let stops = parts.iter().flat_map(Part::stops);
    stops.map(|stop| stop.at.map(i32::from)).collect()
}

fn board() -> Vec<Part> {
    vec![
        part(1, &[[0x42, 0x65], [0x77, 0x66]]),
        part(2, &[[0x66, 0x6d], [0x00, 0x00]]),
    ]
}

#[test]
fn a_board_of_two_tools() {
    for is_original in [false, true] {
        let parts = board();
        let mut operator = Script::default();
        let (end, mut client) = send(client(is_original), &parts, 0, false, &mut operator);
        assert_eq!(end, Ok(End::Drilled));
        assert_eq!(drilled(&mut client), places(&parts));
        let rig = device(&mut client).rig(0).unwrap();
        assert_eq!(rig.lost_steps(), [0; 3]);
        assert_eq!(rig.dragged_steps(), 0);
        assert!(!rig.spindle_turns());
        assert!(rig.holes().iter().all(|hole| hole.is_clean));
        // An original drill switches its spindle for each hole. On the other drill `send` switches
        // it for each tool.
        let told = device(&mut client).take_reports();
        let is_on = |line: &&String| line.as_str() == "spindle on";
        let switched = told.iter().filter(is_on).count();
        assert_eq!(switched, if is_original { 4 } else { 2 });
        assert!(
            !operator.told.iter().any(|line| line.contains("by hand")),
            "{:?}",
            operator.told
        );
    }
}

/// The spindle is at rest during a tool change. It is switched off after the last hole of each
/// tool, and on before the first one.
#[test]
fn the_spindle_stands_between_tools() {
    let (end, mut client) = send(client(false), &board(), 0, false, &mut Script::default());
    assert_eq!(end, Ok(End::Drilled));
    let told = device(&mut client).take_reports();
    let mut events: Vec<_> = (told.iter())
        .filter_map(|line| {
            line.split([' ', ':'])
                .find(|word| ["on", "off", "drilled"].contains(word))
        })
        .skip_while(|word| *word == "off")
        .collect();
    events.dedup();
    assert_eq!(events, ["on", "drilled", "off", "on", "drilled", "off"]);
}

/// The reported remaining time is right. The board runs at the rates of the machine and is observed
/// every 20 ms.
#[test]
fn the_remaining_time_is_honest() {
    let parts = [part(1, &[[100, 50], [900, 400], [2000, 10]])];
    let mut operator = Script::default();
    // Without the queries of a lease, each look takes 20 ms.
    let client = client_of(Device::new(2400, false), StopRequests::default()).with_lease(0);
    let (end, _) = send(client, &parts, 0, false, &mut operator);
    assert_eq!(end, Ok(End::Drilled));
    let looks = operator.shares.len();
    let all_s = operator.shares[0][1];
    assert!(all_s > 100.0, "{all_s}");
    let mut before_s = f64::INFINITY;
    for (number, [share, left_s]) in operator.shares.iter().enumerate() {
        let truly_s = (looks - number) as f64 * 0.02;
        assert!(
            (left_s - truly_s).abs() < 0.03 * all_s,
            "{left_s} s said to be left of {all_s}, {truly_s} were"
        );
        assert!((1.0 - left_s / all_s - share).abs() < 0.01, "{share}");
        assert!(*left_s <= before_s);
        before_s = *left_s;
    }
}

/// An original drill reports nothing while it drills. If it is unplugged, the operator gets a
/// message that the drilling takes long. A stop ends the wait.
#[test]
fn an_original_that_is_gone_is_not_waited_for_all_the_time() {
    let holes: Vec<[u16; 2]> = (0..200).map(|n| [100 * n, 7 * n]).collect();
    let parts = [part(1, &holes)];
    let stop = StopRequests::default();
    let new = |stop: &StopRequests| client_of(Device::quick(true), stop.clone());
    let (end, mut good) = send(new(&stop), &parts, 0, false, &mut Script::default());
    assert_eq!(end, Ok(End::Drilled));
    // The last byte is the answer to the run. The byte before it starts the run.
    let place = device(&mut good).line().carried - 1;
    let mut operator = Script {
        stops_at: Some(("longer than estimated", stop.clone())),
        ..Script::default()
    };
    let mut client = new(&stop);
    device(&mut client).line().fault = Some((place, Fault::Unplugged));
    let (end, client) = send(client, &parts, 0, false, &mut operator);
    let Ok(End::Failed(Failed { why, done, begun })) = end else {
        panic!("{end:?}")
    };
    assert!(why.contains("no answer"), "{why}");
    assert_eq!((done, begun), (0, 200));
    let reckoned_s: f64 = seconds(&parts[0], [0; 2]).iter().sum();
    let took_s = client.elapsed().as_secs_f64();
    assert!(
        took_s < 1.3 * reckoned_s + 300.0,
        "{took_s} of {reckoned_s}"
    );
    assert!(took_s < 2.0 * reckoned_s, "{took_s} of {reckoned_s}");
}

/// The drill homes once. After a tool, its axes return to zero by their steps.
#[test]
fn it_does_not_home_between_tools() {
    let (end, mut client) = send(client(false), &board(), 0, false, &mut Script::default());
    assert_eq!(end, Ok(End::Drilled));
    let homed = device(&mut client).take_reports();
    assert_eq!(
        homed.iter().filter(|line| *line == "homed").count(),
        2,
        "after power came on, and before the first tool"
    );
}

#[test]
fn it_asks_for_each_tool() {
    let parts = board();
    let mut operator = Script {
        answers: vec!["0.8", "much", "0.9", "0.8 mm"],
        ..Script::default()
    };
    let mut sender = Sender {
        client: client(false),
        operator: &mut operator,
        parts: &parts,
        from: 0,
        byte_s: 0.0085,
        is_homed: false,
        is_sure: false,
        diameter,
    };
    assert_eq!(sender.send(false), Ok(End::Drilled));
    assert!(
        operator.told.contains(&"0.9 mm is not 0.8 mm".into()),
        "{:?}",
        operator.told
    );
    // No operator inserts the second tool.
    operator.answers = vec!["0.8"];
    let mut sender = Sender {
        client: client(false),
        operator: &mut operator,
        parts: &parts,
        from: 0,
        byte_s: 0.0085,
        is_homed: false,
        is_sure: false,
        diameter,
    };
    let Ok(End::Failed(failed)) = sender.send(false) else {
        panic!()
    };
    assert_eq!((failed.done, failed.begun), (2, 2));
}

/// An original drill switches its spindle itself, so no question comes before a board of one tool.
#[test]
fn nobody_is_asked_to_switch_the_spindle_of_an_original() {
    let parts = [part(1, &[[20, 10]])];
    let mut operator = Script::default();
    let mut sender = Sender {
        client: client(true),
        operator: &mut operator,
        parts: &parts,
        from: 0,
        byte_s: 0.0085,
        is_homed: false,
        is_sure: false,
        diameter,
    };
    assert_eq!(sender.send(false), Ok(End::Drilled));
    let mut client = sender.client;
    assert_eq!(drilled(&mut client), [[20, 10]]);
    assert!(device(&mut client).rig(0).unwrap().holes()[0].is_clean);
    let told = device(&mut client).take_reports();
    let of_hole: Vec<_> = told
        .iter()
        .skip_while(|line| *line != "spindle on")
        .collect();
    assert_eq!(of_hole, ["spindle on", "drilled at 20,10", "spindle off"]);
}

/// A program of three times the size of the memory. It waits at each border and drills every hole
/// once. The progress rises to the end, and the remaining time falls.
#[test]
fn a_long_board_is_done_in_parts() {
    let holes: Vec<[u16; 2]> = (0..2000).map(|n| [n % 40, n / 50]).collect();
    let parts = [part(1, &holes)];
    let mut operator = Script::default();
    let (end, mut client) = send(client(false), &parts, 0, false, &mut operator);
    assert_eq!(end, Ok(End::Drilled));
    assert_eq!(drilled(&mut client), places(&parts));
    let shares = &operator.shares;
    assert!(
        shares
            .windows(2)
            .all(|pair| pair[0][0] <= pair[1][0] + 1e-9)
    );
    let last = shares.last().unwrap();
    assert!(last[0] > 0.98 && last[0] < 1.01, "{last:?}");
    let (end, _) = send(client, &parts, 0, true, &mut operator);
    assert!(end.unwrap_err().contains("8192"));
}

#[test]
fn a_detached_start_is_certain() {
    let parts = [part(1, &[[3000, 10], [5, 400]])];
    let (end, mut client) = send(client(false), &parts, 0, true, &mut Script::default());
    assert_eq!(end, Ok(End::Detached));
    assert!(drilled(&mut client).is_empty());
    rest(&mut client);
    assert_eq!(drilled(&mut client), places(&parts));
    let (end, _) = send(client, &board(), 0, true, &mut Script::default());
    assert!(end.unwrap_err().contains("one tool"));
}

/// Another client ends a program without a host, between two records.
#[test]
fn a_program_left_alone_is_ended_from_elsewhere() {
    let parts = [part(1, &[[3000, 10], [5, 400], [3000, 400]])];
    for is_original in [false, true] {
        let mut client = if is_original {
            let mut first = self::client(true);
            first.reach().unwrap();
            first.run(Step::Clear).unwrap();
            first.run(Step::Begin).unwrap();
            let bytes: Vec<u8> = record_bytes(parts[0].records.clone()).collect();
            for byte in &bytes[..3 * parts[0].records.len()] {
                first.run(Step::Store(*byte)).unwrap();
            }
            first.run(Step::End).unwrap();
            device(&mut first).send(b'e');
            first
        } else {
            let (end, client) = send(client(false), &parts, 0, true, &mut Script::default());
            assert_eq!(end, Ok(End::Detached));
            client
        };
        let running = std::mem::replace(device(&mut client), Device::quick(is_original));
        let mut second = client_of(running, StopRequests::default());
        if !is_original {
            assert_eq!(second.reach(), Err(ClientError::AtWork));
        }
        let mut waits = 0;
        assert_eq!(second.end_program(|_| waits += 1), Ok(()));
        assert_eq!(waits, 1);
        let holes = drilled(&mut second).len();
        rest(&mut second);
        let all = drilled(&mut second).len();
        assert!(holes == all && all < 3, "{is_original}: {holes}, {all}");
        // A drill at rest receives no `E`, and the call returns at once.
        assert_eq!(second.end_program(|_| waits += 1), Ok(()));
        assert_eq!(waits, 1);
    }
}

#[test]
fn a_client_that_falls_silent_stops_the_drill() {
    let mut client = client(false).with_lease(250);
    client.reach().unwrap();
    client.run(Step::Empty).unwrap();
    client.run(Step::Begin).unwrap();
    for byte in Record::X(2000).to_bytes() {
        client.run(Step::Store(byte)).unwrap();
    }
    client.run(Step::End).unwrap();
    let longest = Duration::from_secs(100);
    let result = client.run_while(Step::Execute, longest, |_| Going::Silent);
    assert_eq!(result, Err(ClientError::Link(Failure::Expired)));
    client.find_out().unwrap();
    let place = Place::read(&mut client).unwrap();
    let [x, _] = place.machine.place_steps;
    assert!((1..2000).contains(&x) && place.machine.is_homed, "{place}");
    // What arrives while nothing is sent fails the next step.
    device(&mut client).control("reset");
    client.rest(Duration::from_secs(2)).unwrap();
    let next = client.run(Step::Test);
    assert_eq!(next, Err(ClientError::Link(Failure::Restarted)));
}

/// A start that the device did not receive is reported: nothing has started.
#[test]
fn a_start_that_was_lost_is_reported() {
    let parts = [part(1, &[[2000, 10]])];
    let (end, mut good) = send(client(false), &parts, 0, true, &mut Script::default());
    assert_eq!(end, Ok(End::Detached));
    let carried = device(&mut good).line().carried;
    let (mut unheard, mut unknown) = (0, 0);
    for fault in [Fault::Lost, Fault::Unplugged] {
        for place in carried - 6..carried {
            let mut client = client(false);
            device(&mut client).line().fault = Some((place, fault));
            let mut operator = Script::default();
            let (end, mut client) = send(client, &parts, 0, true, &mut operator);
            rest(&mut client);
            let has_drilled = !drilled(&mut client).is_empty();
            let says_so = end == Ok(End::Detached);
            let context = format!("{fault:?} at {place}: {end:?}");
            assert!(has_drilled || !says_so, "{context}");
            unheard += u32::from(!says_so);
            if fault == Fault::Lost {
                assert_eq!(has_drilled, says_so, "{context}");
                assert!(
                    !device(&mut client).rig(0).unwrap().spindle_turns(),
                    "{context}"
                );
                continue;
            }
            // A client that does not know whether the drill runs reports this.
            unknown += u32::from(has_drilled && !says_so);
            if !says_so {
                let told = operator.told.last().map_or("", String::as_str);
                assert!(
                    told.contains("its spindle may turn")
                        || told.contains("see whether its spindle"),
                    "{context}: {told}"
                );
            }
            // A completed program stops its spindle.
            assert!(
                !has_drilled || !device(&mut client).rig(0).unwrap().spindle_turns(),
                "{context}"
            );
        }
    }
    assert!(unheard >= 3 && unknown >= 1, "{unheard}, {unknown}");
}

/// An original drill does not report its start. So it is not left without a host, and nothing moves
/// except in homing.
#[test]
fn an_original_is_not_left_to_itself() {
    let parts = [part(1, &[[20, 10]])];
    let (end, mut client) = send(client(true), &parts, 0, true, &mut Script::default());
    assert!(end.unwrap_err().contains("--detach is not possible"));
    rest(&mut client);
    assert!(drilled(&mut client).is_empty());
}

/// A fault is reported when it happens, not after the longest time of the board. Here the lower
/// sensor does not work.
#[test]
fn a_fault_is_reported_at_once() {
    let holes: Vec<[u16; 2]> = (0..200).map(|n| [7 * n, n]).collect();
    let mut client = client(false);
    device(&mut client).control("open down");
    let start = client.elapsed();
    let (end, client) = send(client, &[part(1, &holes)], 0, false, &mut Script::default());
    let Ok(End::Failed(Failed { why, done, .. })) = end else {
        panic!("{end:?}")
    };
    assert!(why.contains("has stopped because of a fault"), "{why}");
    assert_eq!(done, 0);
    // 1.8 kB at 2400 baud take 17 s with their echoes. Then the host queries the device.
    let took = client.elapsed() - start;
    assert!(took.as_secs() < 30, "{took:?}");
}

/// A cable that is pulled during a program is detected within seconds, because the drill is queried
/// now and then.
#[test]
fn a_pulled_cable_is_noticed_soon() {
    let holes: Vec<[u16; 2]> = (0..200).map(|n| [7 * n, n]).collect();
    let parts = [part(1, &holes)];
    let (end, mut good) = send(client(false), &parts, 0, true, &mut Script::default());
    assert_eq!(end, Ok(End::Detached));
    let begins = good.elapsed();
    // After the start, two bytes follow here: the query and its answer.
    let place = device(&mut good).line().carried - 2;
    let mut client = client(false);
    device(&mut client).line().fault = Some((place, Fault::Unplugged));
    let (end, mut client) = send(client, &parts, 0, false, &mut Script::default());
    let Ok(End::Failed(Failed { why, done, begun })) = end else {
        panic!("{end:?}")
    };
    assert!(why.contains("no answer"), "{why}");
    let took = client.elapsed() - begins;
    assert!((4..10).contains(&took.as_secs()), "{took:?}");
    rest(&mut client);
    for _ in 0..60 {
        rest(&mut client);
    }
    let count = drilled(&mut client).len();
    assert!((done..=begun).contains(&count), "{done} {count} {begun}");
    assert!(
        !device(&mut client).rig(0).unwrap().spindle_turns(),
        "it has ended"
    );
}

/// A drill with the rates of the machine itself.
fn real(lease_ms: u16) -> Client {
    client_of(Device::new(2400, false), StopRequests::default()).with_lease(lease_ms)
}

/// Sends a board, pulls the cable `after_s` after the start of the run, and lets `passes_s` pass.
/// Returns the client.
fn pulled(parts: &[Part], lease_ms: u16, after_s: u64, passes_s: u64) -> (End, Client) {
    let mut client = real(lease_ms);
    // The bytes up to the start, then two bytes for each query.
    let (_, mut good) = send(real(lease_ms), parts, 0, true, &mut Script::default());
    let start = device(&mut good).line().carried;
    let questions = after_s * 1000 / 62;
    device(&mut client).line().fault = Some((start + 2 * questions, Fault::Unplugged));
    let (end, mut client) = send(client, parts, 0, false, &mut Script::default());
    for _ in 0..passes_s * 1000 {
        device(&mut client).tick();
    }
    (end.unwrap(), client)
}

/// The cable is pulled at different times of a run, at the rates of the machine. The drill does not
/// continue alone. It raises its spindle and comes to rest, and the spindle stops, too. Then
/// `--from` continues without homing.
#[test]
fn a_drill_without_its_host_stops_and_goes_on_without_homing() {
    let parts = [part(1, &[[300, 100], [500, 100], [500, 300], [400, 90]])];
    let all = places(&parts);
    let mut seen = Vec::new();
    for after_s in [1, 9, 20, 33, 36, 45, 70, 90] {
        let (end, mut client) = pulled(&parts, 250, after_s, 20);
        let End::Failed(Failed { why, done, begun }) = end else {
            panic!("{after_s} s: {end:?}")
        };
        assert!(why.contains("no answer"), "{why}");
        let holes = |client: &mut Client| -> Vec<[i32; 2]> {
            let holes = device(client).rig(0).unwrap().holes().iter();
            let whole = holes.filter(|hole| hole.depth == 3745);
            whole.map(|hole| hole.at).collect()
        };
        let drilled = holes(&mut client).len();
        assert!((done..=begun).contains(&drilled), "{after_s} s");
        assert!(drilled < all.len(), "{after_s} s: it went on");
        let place = device(&mut client).control("where");
        assert!(
            place.contains("from home, z 0 below"),
            "{after_s} s: {place}"
        );
        assert!(place.contains("spindle off"), "{after_s} s: {place}");
        let [x, y, _] = device(&mut client).rig(0).unwrap().place();
        assert!(place.contains(&format!("x {x} y {y} steps")), "{place}");
        // Nothing moves any more.
        (0..5000).for_each(|_| drop(device(&mut client).tick()));
        assert_eq!(device(&mut client).control("where"), place);
        device(&mut client).line().plug(true);
        device(&mut client).take_reports();
        let mut operator = Script::default();
        let mut sender = Sender {
            client,
            operator: &mut operator,
            parts: &parts,
            from: drilled,
            byte_s: 0.0085,
            is_homed: true,
            is_sure: true,
            diameter,
        };
        assert_eq!(sender.send(false), Ok(End::Drilled), "{after_s} s");
        let mut client = sender.client;
        assert_eq!(holes(&mut client), all, "{after_s} s");
        let told = device(&mut client).take_reports();
        assert!(!told.contains(&"homed".into()), "{told:?}");
        assert_eq!(device(&mut client).rig(0).unwrap().lost_steps(), [0; 3]);
        seen.push(drilled);
    }
    seen.dedup();
    assert!(seen.len() > 2, "{seen:?}");
}

/// Without a lease the drill continues to the end of its program.
#[test]
fn a_drill_without_a_lease_goes_on_alone() {
    let parts = [part(1, &[[300, 100], [320, 100]])];
    let mut client = real(0);
    let (_, mut good) = send(real(0), &parts, 0, true, &mut Script::default());
    let start = device(&mut good).line().carried;
    device(&mut client).line().fault = Some((start + 4, Fault::Unplugged));
    let (end, mut client) = send(client, &parts, 0, false, &mut Script::default());
    assert!(matches!(end, Ok(End::Failed(_))), "{end:?}");
    (0..120_000).for_each(|_| drop(device(&mut client).tick()));
    assert_eq!(device(&mut client).rig(0).unwrap().holes().len(), 2);
}

/// An original has no lease. If a lease is requested, nothing moves.
#[test]
fn an_original_is_not_driven_with_a_lease() {
    let parts = [part(1, &[[20, 10]])];
    for (lease_ms, drills) in [(250, false), (0, true)] {
        let client = client(true).with_lease(lease_ms);
        let (end, mut client) = send(client, &parts, 0, false, &mut Script::default());
        assert_eq!(end == Ok(End::Drilled), drills, "{end:?}");
        assert_eq!(drilled(&mut client).len(), usize::from(drills));
        let told = sentence(&end.unwrap(), "", 1);
        assert_eq!(told.contains("does not confirm a lease"), !drills, "{told}");
    }
}

/// The host was late, but it was not gone. The end of the lease is not the end of the program.
#[test]
fn a_late_host_is_told_and_knows_the_holes() {
    let parts = [part(1, &[[300, 100], [500, 100], [500, 300]])];
    let (_, mut good) = send(real(250), &parts, 0, true, &mut Script::default());
    let start = device(&mut good).line().carried;
    for after_s in [2, 33, 36, 45] {
        let mut client = real(250);
        let place = start + 2 * (after_s * 1000 / 62);
        device(&mut client).line().fault = Some((place, Fault::Late(300_000)));
        let (end, mut client) = send(client, &parts, 0, false, &mut Script::default());
        let Ok(End::Failed(Failed { why, done, begun })) = end else {
            panic!("{end:?}")
        };
        assert!(why.contains("for the time of its lease"), "{why}");
        assert!(why.contains("--no-home continues"), "{why}");
        let holes = device(&mut client).rig(0).unwrap().holes().iter();
        let whole = holes.filter(|hole| hole.depth == 3745).count();
        assert_eq!((done, begun), (whole, whole), "{after_s} s");
        assert!(!device(&mut client).rig(0).unwrap().spindle_turns());
    }
}

/// A drill that was left alone with a board is at work, then done. `--from` with the hole where its
/// host was lost drills no hole twice.
#[test]
fn a_hole_that_was_drilled_alone_is_not_drilled_again() {
    let parts = [
        part(1, &[[7, 3]]),
        part(2, &[[300, 100], [500, 100], [500, 300], [600, 300]]),
    ];
    let alone = [parts[1].clone()];
    let (end, mut first) = send(client(false), &alone, 1, true, &mut Script::default());
    assert_eq!(end, Ok(End::Detached));
    let running = std::mem::replace(device(&mut first), Device::quick(false));
    let second = client_of(running, StopRequests::default());
    let again = |client, from| {
        let (end, client) = send(client, &parts, from, false, &mut Script::default());
        let end = end.unwrap();
        (sentence(&end, "husillo send b.drl", 5), end, client)
    };
    // While the drill is at work nothing is known, and the message does not repeat the number.
    let (told, end, mut second) = again(second, 2);
    assert!(matches!(end, End::Unreached(_)), "{told}");
    assert!(
        told.contains("runs its program") && told.contains("nothing was sent"),
        "{told}"
    );
    assert!(!told.contains("--from 3"), "{told}");
    rest(&mut second);
    assert_eq!(drilled(&mut second).len(), 3, "it has ended");
    // At rest its count shows what is drilled.
    let (told, _, mut second) = again(second, 2);
    assert!(told.contains("by its own count"), "{told}");
    assert!(
        told.contains("5 of 5 holes drilled; nothing is left to do"),
        "{told}"
    );
    assert_eq!(drilled(&mut second).len(), 3, "nothing was drilled again");
    // Another program, or a cleared memory, shows nothing about this board.
    second.reach().unwrap();
    second.run(Step::Clear).unwrap();
    let (told, end, _) = again(second, 3);
    assert_eq!(end, End::Drilled, "{told}");
}

/// An original at work does not answer. Nothing is sent, and the number of holes is not guessed.
#[test]
fn an_original_at_work_is_left_alone() {
    let parts = [part(1, &[[3000, 10], [5, 400], [3000, 400]])];
    let mut first = client(true);
    for step in [Step::Resync, Step::Clear, Step::Begin] {
        first.run(step).unwrap();
    }
    let bytes: Vec<u8> = record_bytes(parts[0].records.clone()).collect();
    for byte in &bytes[..3 * parts[0].records.len()] {
        first.run(Step::Store(*byte)).unwrap();
    }
    first.run(Step::End).unwrap();
    device(&mut first).send(b'e');
    let running = std::mem::replace(device(&mut first), Device::quick(true));
    let second = client_of(running, StopRequests::default());
    let (end, mut second) = send(second, &parts, 2, false, &mut Script::default());
    let told = sentence(&end.unwrap(), "husillo send b.drl", 3);
    assert!(told.contains("Is it still at work?"), "{told}");
    assert!(told.contains("count the holes in the board"), "{told}");
    assert!(
        !told.contains("--from 3") && !told.contains("holes drilled;"),
        "{told}"
    );
    rest(&mut second);
    rest(&mut second);
    assert_eq!(
        drilled(&mut second),
        places(&parts),
        "it went on undisturbed"
    );
}

/// Holes that are drilled in pecks. Each counts once, and a resumed job begins with a whole hole.
#[test]
fn pecks_are_one_hole() {
    let hole = |[x, y]: [u16; 2]| {
        let pecks = [4, 5, 0].map(Record::Drill);
        [Record::X(x), Record::Y(y)].into_iter().chain(pecks)
    };
    let parts = [Part {
        tool: 1,
        diameter: None,
        records: [[3, 3], [9, 4], [5, 8]]
            .into_iter()
            .flat_map(hole)
            .collect(),
    }];
    assert_eq!(parts[0].holes(), 3);
    let mut operator = Script::default();
    let (end, mut one) = send(client(false), &parts, 1, false, &mut operator);
    assert_eq!(end, Ok(End::Drilled));
    assert!(operator.told.contains(&"T1: 2 holes drilled".into()));
    let depths = |client: &mut Client| -> Vec<([i32; 2], i32)> {
        let holes = device(client).rig(0).unwrap().holes().iter();
        holes.map(|hole| (hole.at, hole.depth)).collect()
    };
    let pecks = |at| [(at, 4), (at, 5), (at, 6)];
    assert_eq!(depths(&mut one), [pecks([9, 4]), pecks([5, 8])].concat());
    // The job stops at any point. A hole that is reported as done is drilled to its last peck.
    for fault_at in 0..60 {
        let mut client = client(false);
        let (_, mut good) = send(
            self::client(false),
            &parts,
            0,
            false,
            &mut Script::default(),
        );
        let carried = device(&mut good).line().carried;
        device(&mut client).line().fault = Some((carried - 60 + fault_at, Fault::Reset));
        let (end, mut client) = send(client, &parts, 0, false, &mut Script::default());
        rest(&mut client);
        let whole = drilled(&mut client).len();
        match end {
            Ok(End::Drilled) => assert_eq!(whole, 3),
            Ok(End::Failed(Failed { done, begun, .. })) => {
                assert!((done..=begun).contains(&whole), "{done} {whole} {begun}");
            }
            other => panic!("{other:?}"),
        }
    }
}

fn faults() -> impl Iterator<Item = Fault> {
    (0..8).map(Fault::Flipped).chain([
        Fault::Lost,
        Fault::Doubled,
        Fault::Late(30_000),
        Fault::Late(200_000),
        // Longer than the lease.
        Fault::Late(400_000),
        Fault::Unplugged,
        Fault::Reset,
    ])
}

/// Sends a board with a fault. Then continues as the operator does: with the next hole of the
/// report, or with the first hole that is missing in the board. Returns `false` if nothing was
/// reported. At the end every hole is there once.
fn goes_on(client: Client, parts: &[Part], fault: Fault, context: &str) -> bool {
    let expected = places(parts);
    let mut from = 0;
    let mut client = client;
    for round in 0..4 {
        let (end, back) = send(client, parts, from, false, &mut Script::default());
        client = back;
        match end.expect("it can be asked for") {
            End::Drilled => {
                assert_eq!(drilled(&mut client), expected, "{context}");
                assert_eq!(
                    device(&mut client).rig(0).unwrap().dragged_steps(),
                    0,
                    "{context}"
                );
                return round > 0;
            }
            End::Detached => panic!("{context}"),
            // Nothing was sent, so there is no new hole.
            End::Unreached(_) => {
                rest(&mut client);
                let count = drilled(&mut client).len();
                assert_eq!(count, from, "{context}");
                device(&mut client).line().plug(true);
            }
            End::Failed(Failed { why, done, begun }) => {
                rest(&mut client);
                let count = drilled(&mut client).len();
                assert!(
                    (done..=begun).contains(&count),
                    "{context}: {why}; {count} holes, {done} said done, {begun} begun"
                );
                assert_eq!(drilled(&mut client), expected[..count], "{context}");
                if count == expected.len() {
                    return true;
                }
                from = count;
                device(&mut client).line().plug(true);
            }
        }
    }
    panic!("{context}: {fault:?} never ends");
}

/// Every fault at every byte of a board of two tools, on both kinds of device.
#[test]
fn any_fault_at_any_byte_is_survived_or_reported() {
    for is_original in [false, true] {
        let parts = board();
        let (end, mut good) = send(
            client(is_original),
            &parts,
            0,
            false,
            &mut Script::default(),
        );
        assert_eq!(end, Ok(End::Drilled));
        let carried = device(&mut good).line().carried;
        let (mut reported, mut unharmed) = (0, 0);
        for place in 0..carried {
            for fault in faults() {
                let mut client = client(is_original);
                device(&mut client).line().fault = Some((place, fault));
                let context = format!("original {is_original}, {fault:?} at {place} of {carried}");
                if goes_on(client, &parts, fault, &context) {
                    reported += 1;
                } else {
                    unharmed += 1;
                }
            }
        }
        println!("{reported} reported, {unharmed} without harm");
        assert!(reported > 500 && unharmed > 50, "{reported}, {unharmed}");
    }
}

/// Random faults in long boards, which include the border of the device's memory.
#[test]
fn faults_in_long_boards_are_survived_or_reported() {
    let (mut numbers, mut reported) = (Random::new(5), 0);
    let mut random = |below: u64| numbers.below(below);
    let faults: Vec<_> = faults().collect();
    for round in 0..12 {
        let holes: Vec<[u16; 2]> = (0..950)
            .map(|_| [random(60) as u16, random(60) as u16])
            .collect();
        let parts = [part(1, &holes)];
        let mut client = client(false);
        // Half of the faults are near the border, where a full memory is run.
        let place = if round % 2 == 0 {
            random(17_000)
        } else {
            2 * 8192 + random(80)
        };
        let fault = faults[random(faults.len() as u64) as usize];
        device(&mut client).line().fault = Some((place, fault));
        let context = format!("round {round}, {fault:?} at {place}");
        reported += u32::from(goes_on(client, &parts, fault, &context));
    }
    assert!(reported > 5, "{reported}");
}
