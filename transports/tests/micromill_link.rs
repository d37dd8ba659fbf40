//! The micro mill's link: the strings of its description, both ends on one line, and that line with
//! faults.

use husillo_transports::micromill::{
    Answer, Axis, AxisState, Device, Host, HostTiming, Line, Order, Outcome, Point, Progress,
    Report, State, StateDigits,
};
use proptest::prelude::*;

const ARC: &str = "G02X02969.00Y03400.00I03012.00J03040.00F08;";

/// Everything the device sends for these bytes, and the orders it gives.
fn hear(device: &mut Device<64>, bytes: &[u8]) -> (Vec<u8>, Vec<Order>) {
    let (mut out, mut orders) = (Vec::new(), Vec::new());
    for byte in bytes {
        orders.extend(device.push(*byte));
        while let Some(byte) = device.transmit() {
            out.push(byte);
        }
    }
    (out, orders)
}

fn ready() -> Device<64> {
    let mut device = Device::new();
    assert_eq!(device.transmit(), Some(0x88));
    device
}

/// Each example of the description, and what it means.
#[test]
fn examples_of_the_description() {
    use Axis::{X, Y, Z};
    let examples: [(&str, Order); 23] = [
        ("JX+;", Order::Jog([1, 0, 0])),
        ("JZ-;", Order::Jog([0, 0, -1])),
        ("&X+Y-Z+;", Order::Jog([1, -1, 1])),
        ("&Z+Y-;", Order::Jog([0, -1, 1])),
        ("PX+1000;", Order::Steps(X, 1000)),
        ("PY-0028;", Order::Steps(Y, -28)),
        ("FX+250;", Order::Run(X, 250)),
        ("FZ-001;", Order::Run(Z, -1)),
        ("BX200;", Order::Backlash(X, 200)),
        ("H;", Order::Home),
        ("A;", Order::Stop),
        ("W;", Order::Faster),
        ("V;", Order::Slower),
        ("Q;", Order::Zero),
        (
            ARC,
            Order::Line(Line::Arc {
                clockwise: true,
                to: [296_900, 340_000],
                centre: [301_200, 304_000],
                feed: 8,
            }),
        ),
        (
            "G00X01000Y-00500.5;",
            Order::Line(Line::Rapid(Point::Xy([Some(100_000), Some(-50_050)]))),
        ),
        (
            "G01Z-00100.25F08;",
            Order::Line(Line::Linear(Point::Z(-10_025), 8)),
        ),
        ("G28X0Y0;", Order::Line(Line::MachineZero { z: false })),
        ("G28Z0;", Order::Line(Line::MachineZero { z: true })),
        ("G04P03;", Order::Line(Line::Dwell(3))),
        (
            "M03S800;",
            Order::Line(Line::Spindle {
                clockwise: true,
                rpm: 800,
            }),
        ),
        ("M06T02;", Order::Line(Line::Tool(2))),
        ("I;", Order::Report),
    ];
    for (string, order) in examples {
        let mut device = ready();
        let (echo, orders) = hear(&mut device, string.as_bytes());
        assert_eq!(echo, string.as_bytes(), "every byte is echoed");
        assert_eq!(orders, [order], "{string}");
    }
    // The strings that need no motion.
    for (string, line) in [
        ("G54;", Line::Zero),
        ("G90;", Line::Absolute),
        ("M05;", Line::SpindleOff),
        ("M30;", Line::End),
    ] {
        assert_eq!(hear(&mut ready(), string.as_bytes()).1, [Order::Line(line)]);
    }
}

/// What is wrong is echoed, answered by 8e, and asks for nothing.
#[test]
fn wrong_strings_ask_for_nothing() {
    let long = format!("G00X{}1;", "0".repeat(70));
    let wrong = [
        "J;",
        "JX;",
        "JX+Y+;",
        "JA+;",
        "&X+;",
        "&X+X-;",
        "&X+Y-Z+Z-;",
        "PX+100;",
        "PX+10000;",
        "PX1000;",
        "FX+25;",
        "FX+000;",
        "BX20;",
        "BX+200;",
        "H1;",
        "A1;",
        "q;",
        "G00;",
        "G00Y1X1;",
        "G00X1Z1;",
        "G00X1F08;",
        "G01X1;",
        "G01X1F8;",
        "G01X1F00;",
        "G02X1Y1I1F08;",
        "G02X1Y1J1I1F08;",
        "G28X1Y0;",
        "G28X0;",
        "G04;",
        "G04P1.5;",
        "G05;",
        "G0X1;",
        "M03;",
        "M03S10000;",
        "M06T100;",
        "M2;",
        "S2;",
        "L5;",
        "R10;",
        "I1;",
        "G00X123456;",
        "G00X1.234;",
        "G00X.5;",
        "!;",
        "\u{7f};",
        &long,
    ];
    for string in wrong {
        let mut device = ready();
        let (said, orders) = hear(&mut device, string.as_bytes());
        assert_eq!(orders, [], "{string}");
        assert_eq!(
            said.split_last(),
            Some((&0x8e, string.as_bytes())),
            "{string}"
        );
        // And the next one is as good as ever.
        assert_eq!(hear(&mut device, b"H;").1, [Order::Home]);
    }
    // 63 characters and `;` are a string; a lone `;` is none.
    let exact = format!("G00X00001.00Y00001.00{};", "0".repeat(42));
    assert_eq!(exact.len(), 64);
    assert_eq!(hear(&mut ready(), exact.as_bytes()).0.last(), Some(&0x8e));
    assert_eq!(hear(&mut ready(), b" ;\r\n;").0, b" ;\r\n;");
    assert_eq!(hear(&mut ready(), b"G 00 X1\r\n;").1.len(), 1);
}

#[test]
fn any_byte_stops_and_begins_a_string() {
    for byte in 0..=0x7f_u8 {
        let mut device = ready();
        device.set_motion(true, false);
        assert_eq!(device.push(byte), Some(Order::Stop), "{byte:02x}");
    }
    let mut device = ready();
    device.set_motion(true, false);
    let (_, orders) = hear(&mut device, b"P");
    assert_eq!(orders, [Order::Stop]);
    device.set_motion(false, false);
    assert_eq!(hear(&mut device, b"X+0001;").1, [Order::Steps(Axis::X, 1)]);
}

#[test]
fn faster_slower_and_renew_leave_a_jog_alone() {
    let mut device = ready();
    device.set_motion(true, true);
    assert_eq!(
        hear(&mut device, b"W;V;L;").1,
        [Order::Faster, Order::Slower, Order::Renew]
    );
    assert_eq!(hear(&mut device, b"WX").1, [Order::Stop]);
    device.set_motion(true, true);
    assert_eq!(hear(&mut device, b"\n").1, [Order::Stop]);
    // Nothing else than a jog is left alone by them.
    device.set_motion(true, false);
    assert_eq!(hear(&mut device, b"W").1, [Order::Stop]);
}

#[test]
fn streaming_is_asked_for_and_confirmed() {
    let mut device = ready();
    assert_eq!(hear(&mut device, b"S1;").0, b"S1;\x8c");
    device.set_motion(true, false);
    assert_eq!(hear(&mut device, b"G90;").1, [Order::Line(Line::Absolute)]);
    // Not while lines are made.
    assert_eq!(hear(&mut device, b"S0;").0, b"S0;\x8b");
    // A stop in the middle of a string.
    assert_eq!(hear(&mut device, b"G00X1A").1, [Order::Stop]);
    device.set_motion(false, false);
    assert_eq!(hear(&mut device, b";").1, [Order::Stop]);
    assert_eq!(hear(&mut device, b"S0;").0, b"S0;\x8c");
    assert!(!device.is_streaming());
}

#[test]
fn one_step_in_so_many_is_reported() {
    let mut device = ready();
    let told = |device: &mut Device<64>, steps: i32| {
        let mut out = Vec::new();
        for _ in 0..steps.abs() {
            assert!(device.has_room(1));
            device.step(Axis::Y, steps > 0);
            out.extend(device.transmit());
        }
        out
    };
    assert_eq!(told(&mut device, 3), [0x83; 3]);
    assert_eq!(told(&mut device, -2), [0x82; 2]);
    assert_eq!(hear(&mut device, b"R010;").0, b"R010;\x8c");
    assert_eq!(told(&mut device, 25), [0x83; 2]);
    // Five forward are left: fifteen back make ten.
    assert_eq!(told(&mut device, -15), [0x82]);
    hear(&mut device, b"R000;");
    assert!(told(&mut device, 1000).is_empty());
}

/// A transmitter that stands still delays steps, but no report of a step is lost, and echoes and
/// answers keep their room.
#[test]
fn steps_wait_for_room() {
    let mut device = ready();
    let mut steps = 0;
    while device.has_room(1) {
        device.step(Axis::X, true);
        steps += 1;
    }
    assert!(steps > 40);
    for byte in b"A;" {
        device.push(*byte);
    }
    device.answer(Answer::Taken);
    let mut out = Vec::new();
    while let Some(byte) = device.transmit() {
        out.push(byte);
    }
    assert!(out.ends_with(b"A;\x8c"));
}

/// A host, a device and a machine that makes every motion in ten steps of X. The bytes pass
/// `fault`, which may drop, change or double them.
struct Bench<F> {
    host: Host,
    device: Device<64>,
    fault: F,
    now_us: u32,
    /// Orders that were obeyed, stops excepted.
    obeyed: Vec<Order>,
    left: u32,
    queue: usize,
    reports: Vec<Report>,
}

impl<F: FnMut(bool, u8) -> Vec<u8>> Bench<F> {
    fn new(fault: F) -> Self {
        Bench {
            host: Host::new(HostTiming {
                motion_us: 20_000_000,
                ..HostTiming::of(9600)
            }),
            device: ready(),
            fault,
            now_us: u32::MAX - 1_000_000,
            obeyed: Vec::new(),
            left: 0,
            queue: 0,
            reports: Vec::new(),
        }
    }

    fn order(&mut self, order: Order) {
        match order {
            Order::Stop => {
                if self.left > 0 {
                    (self.left, self.queue) = (0, 0);
                    self.device.answer(Answer::Stopped);
                } else {
                    self.device.answer(Answer::Taken);
                }
            }
            Order::Faster | Order::Slower | Order::Renew => self.obeyed.push(order),
            Order::Line(_) if self.device.is_streaming() => {
                self.obeyed.push(order);
                self.queue += 1;
                self.left += 10;
                self.device.answer(Answer::Taken);
            }
            _ if self.left > 0 => self.device.answer(Answer::Refused),
            Order::Lease(_) => {
                self.obeyed.push(order);
                self.device.answer(Answer::Taken);
            }
            _ => {
                self.obeyed.push(order);
                self.left = 10;
                self.queue = 1;
            }
        }
        self.device.set_motion(
            self.left > 0,
            matches!(
                order,
                Order::Jog(_) | Order::Renew | Order::Faster | Order::Slower
            ),
        );
    }

    /// A millisecond.
    fn tick(&mut self) -> Option<Outcome> {
        self.now_us = self.now_us.wrapping_add(1000);
        if let Some(byte) = self.host.transmit(self.now_us) {
            for byte in (self.fault)(true, byte) {
                if let Some(order) = self.device.push(byte) {
                    self.order(order);
                }
            }
        }
        if self.left > 0 && self.device.has_room(1) {
            self.device.step(Axis::X, true);
            self.left -= 1;
            if self.left.is_multiple_of(10) && self.queue > 0 {
                self.queue -= 1;
                self.device.answer(Answer::Done);
                self.device.set_motion(self.left > 0, false);
            }
        }
        if let Some(byte) = self.device.transmit() {
            for byte in (self.fault)(false, byte) {
                self.reports.extend(self.host.push(byte, self.now_us));
            }
        }
        match self.host.poll(self.now_us) {
            Progress::Over(outcome) => Some(outcome),
            _ => None,
        }
    }

    fn send(&mut self, order: Order) -> Outcome {
        assert!(self.host.start(order, self.now_us));
        (0..60_000).find_map(|_| self.tick()).expect("it ends")
    }
}

#[test]
fn both_ends_agree() {
    let mut bench = Bench::new(|_, byte| vec![byte]);
    for string in [ARC, "PX+0010;", "H;", "L0500;", "W;", "Q;"] {
        let order = Order::read(string.trim_end_matches(';').as_bytes()).unwrap();
        assert_eq!(bench.send(order), Outcome::Done, "{string}");
        assert_eq!(bench.obeyed.last(), Some(&order));
    }
    assert_eq!(bench.send(Order::Stop), Outcome::Done);
    // Stopped on the way, with a stop of the host's.
    assert!(bench.host.start(Order::Jog([1, 0, 0]), bench.now_us));
    for _ in 0..8 {
        assert_eq!(bench.tick(), None);
    }
    assert!(!bench.host.start(Order::Home, bench.now_us));
    assert!(bench.host.start(Order::Stop, bench.now_us));
    assert_eq!((0..100).find_map(|_| bench.tick()), Some(Outcome::Done));
    assert!(bench.reports.contains(&Report::Stopped));
    // Streamed: taken at once, done later.
    assert_eq!(bench.send(Order::Stream(true)), Outcome::Done);
    for _ in 0..3 {
        assert_eq!(bench.send(Order::Line(Line::Absolute)), Outcome::Done);
    }
    assert!(bench.host.lines() > 0);
    bench.reports.clear();
    let taken = bench.host.lines();
    for _ in 0..100 {
        bench.tick();
    }
    assert_eq!(bench.host.lines(), 0);
    let done = bench
        .reports
        .iter()
        .filter(|report| **report == Report::LineDone);
    assert_eq!(done.count() as u32, taken);
}

/// Each byte of the exchange, in both directions, lost, doubled, or with any one bit wrong. The
/// string is obeyed once and `Done`, or not obeyed and not `Done`. What is obeyed is what was sent.
#[test]
fn one_fault_anywhere_obeys_nothing_wrong() {
    let orders = [
        Order::read(&ARC.as_bytes()[..ARC.len() - 1]).unwrap(),
        Order::Steps(Axis::X, 10),
        Order::Lease(500),
        Order::Home,
    ];
    for order in orders {
        let length = order.text().bytes().len();
        for place in 0..2 * length + 12 {
            for kind in 0..10 {
                let mut count = 0;
                let mut bench = Bench::new(|_, byte| {
                    let is_here = count == place;
                    count += 1;
                    match kind {
                        _ if !is_here => vec![byte],
                        0 => vec![],
                        1 => vec![byte, byte],
                        bit => vec![byte ^ (1 << (bit - 2))],
                    }
                });
                let outcome = bench.send(order);
                let what = format!("{order:?} byte {place} kind {kind}: {outcome:?}");
                assert!(bench.obeyed.iter().all(|obeyed| *obeyed == order), "{what}");
                assert!(bench.obeyed.len() <= 1, "{what}");
                match outcome {
                    Outcome::Done => assert_eq!(bench.obeyed, [order], "{what}"),
                    // The answer was lost, or the motion was stopped: the host reports that it does
                    // not know.
                    Outcome::Silent
                    | Outcome::Stopped
                    | Outcome::Refused
                    | Outcome::Restarted
                    | Outcome::NoSwitch
                    | Outcome::Wrong => {}
                    Outcome::Garbled => assert_eq!(bench.obeyed, [], "{what}"),
                }
            }
        }
    }
}

/// A string that was spoilt twice is refused twice. The second refusal and its echo arrive when the
/// next string could be under way, so the next string waits until the line is silent.
#[test]
fn what_was_refused_twice_does_not_spoil_what_follows() {
    let timing = HostTiming::of(9600);
    let mut host = Host::new(timing);
    assert!(host.start(Order::Lease(500), 0));
    assert_eq!(host.transmit(0), Some(b'L'));
    host.push(b'M', 1000); // a wrong echo
    assert_eq!(
        [host.transmit(1000), host.transmit(1000)],
        [Some(b'!'), Some(b';')]
    );
    // Nothing is heard in time: once more.
    let mut now_us = 1000 + timing.answer_us;
    assert_eq!(host.poll(now_us), Progress::Sending);
    assert_eq!(
        [host.transmit(now_us), host.transmit(now_us)],
        [Some(b'!'), Some(b';')]
    );
    for byte in *b"!;\x8e!;\x8e" {
        now_us += 1042;
        host.push(byte, now_us);
        assert!(matches!(host.poll(now_us), Progress::Waiting { .. }));
        assert_eq!(host.transmit(now_us), None);
    }
    now_us += timing.guard_us;
    let mut device = ready();
    let mut outcome = None;
    for _ in 0..40 {
        now_us += 1042;
        if let Progress::Over(over) = host.poll(now_us) {
            outcome = Some(over);
            break;
        }
        if let Some(byte) = host.transmit(now_us) {
            if device.push(byte) == Some(Order::Lease(500)) {
                device.answer(Answer::Taken);
            }
        }
        if let Some(byte) = device.transmit() {
            host.push(byte, now_us);
        }
    }
    assert_eq!(outcome, Some(Outcome::Done));
}

fn any_order() -> impl Strategy<Value = Order> {
    let axis = prop::sample::select(&Axis::ALL[..]);
    let at = -9_999_999..=9_999_999;
    let some = prop::option::of(at.clone());
    let point = prop_oneof![
        (some.clone(), some)
            .prop_filter("one at least", |(x, y)| x.or(*y).is_some())
            .prop_map(|(x, y)| Point::Xy([x, y])),
        at.clone().prop_map(Point::Z),
    ];
    let feed = 1..=9999_u16;
    let line = prop_oneof![
        point.clone().prop_map(Line::Rapid),
        (point, feed.clone()).prop_map(|(point, feed)| Line::Linear(point, feed)),
        (
            any::<bool>(),
            [at.clone(), at.clone()],
            [at.clone(), at],
            feed
        )
            .prop_map(|(clockwise, to, centre, feed)| Line::Arc {
                clockwise,
                to,
                centre,
                feed
            }),
        (0..=9999_u16).prop_map(Line::Dwell),
        any::<bool>().prop_map(|z| Line::MachineZero { z }),
        Just(Line::Zero),
        Just(Line::Absolute),
        (any::<bool>(), 0..=9999_u16).prop_map(|(clockwise, rpm)| Line::Spindle { clockwise, rpm }),
        Just(Line::SpindleOff),
        (0..=99_u8).prop_map(Line::Tool),
        Just(Line::End),
    ];
    prop_oneof![
        [-1..=1_i8, -1..=1, -1..=1]
            .prop_filter("one moves", |ways| *ways != [0; 3])
            .prop_map(Order::Jog),
        (axis.clone(), -9999..=9999_i16).prop_map(|(axis, steps)| Order::Steps(axis, steps)),
        (
            axis.clone(),
            (-999..=999_i16).prop_filter("it runs", |hz| *hz != 0)
        )
            .prop_map(|(axis, hz)| Order::Run(axis, hz)),
        (axis, 0..=999_u16).prop_map(|(axis, um)| Order::Backlash(axis, um)),
        line.prop_map(Order::Line),
        any::<bool>().prop_map(Order::Stream),
        (0..=9999_u16).prop_map(Order::Lease),
        (0..=999_u16).prop_map(Order::Every),
        prop::sample::select(vec![
            Order::Home,
            Order::Stop,
            Order::Faster,
            Order::Slower,
            Order::Zero,
            Order::Renew
        ]),
    ]
}

proptest! {
    /// What is written is read back, and is no longer than a string may be.
    #[test]
    fn strings_are_read_as_written(order in any_order()) {
        let text = order.text();
        let (end, string) = text.bytes().split_last().unwrap();
        prop_assert_eq!(*end, b';');
        prop_assert!(text.bytes().len() <= 64);
        prop_assert_eq!(Order::read(string), Some(order));
    }

    /// Whatever a line answers to each byte of the host: an order that is no motion ends, after a
    /// bounded number of bytes and of polls.
    #[test]
    fn an_order_ends_on_a_line_of_noise(
        noise in prop::collection::vec(any::<u8>(), 0..40),
        order in prop::sample::select(vec![Order::Stop, Order::Report, Order::Lease(250)]),
    ) {
        let mut host = Host::new(HostTiming::of(9600));
        let mut now_us = 0_u32;
        prop_assert!(host.start(order, now_us));
        let (mut bytes, mut polls) = (0, 0);
        while !matches!(host.poll(now_us), Progress::Over(_)) {
            while host.transmit(now_us).is_some() {
                bytes += 1;
                for byte in &noise {
                    host.push(*byte, now_us);
                }
                prop_assert!(bytes < 200, "{} bytes", bytes);
            }
            polls += 1;
            now_us += 10_000;
            prop_assert!(polls < 1000, "{:?}", host);
        }
    }

    /// For any bytes: the device echoes them, never sends more than it has heard and one answer per
    /// string, and understands any string after them.
    #[test]
    fn any_bytes_are_survived(
        bytes in prop::collection::vec(any::<u8>(), 0..300),
        moving in any::<[bool; 2]>(),
        order in any_order(),
    ) {
        let mut device = ready();
        device.set_motion(moving[0], moving[1]);
        let (said, _) = hear(&mut device, &bytes);
        let strings = bytes.iter().filter(|byte| **byte == b';').count();
        prop_assert!(!said.iter().any(|byte| matches!(byte, 0x80..=0x88)));
        prop_assert!(said.len() >= bytes.len() && said.len() <= bytes.len() + strings);
        device.set_motion(false, false);
        hear(&mut device, b";");
        let text = order.text();
        let (_, orders) = hear(&mut device, text.bytes());
        let own = matches!(order, Order::Stream(_) | Order::Every(_));
        let expected = if own { vec![] } else { vec![order] };
        prop_assert_eq!(orders, expected);
    }
}

/// A state of extreme numbers.
fn state() -> State {
    let axis = |load_steps, ahead_steps, backlash_steps, zero_nm| AxisState {
        load_steps,
        ahead_steps,
        backlash_steps,
        zero_nm,
    };
    State {
        axes: [
            axis(i32::MIN, 1456, 1457, 2_147_000_000),
            axis(-1, 0, u16::MAX, i32::MIN),
            axis(71_429, u16::MAX, u16::MAX, -1),
        ],
        is_homed: true,
    }
}

/// A host that asks gets the state. Digits that nobody asked for are noise.
#[test]
fn the_state_is_reported() {
    for is_homed in [false, true] {
        let state = State {
            is_homed,
            ..state()
        };
        let mut device = Device::<80>::new();
        let timing = HostTiming::of(9600);
        let mut host = Host::new(timing);
        assert_eq!(device.transmit(), Some(0x88));
        assert_eq!(host.push(0x95, 0), Some(Report::Noise(0x95)));
        assert!(host.start(Order::Report, 0));
        let (mut digits, mut now_us, mut bytes) = (StateDigits::new(), 0, 0);
        let outcome = loop {
            if let Progress::Over(outcome) = host.poll(now_us) {
                break outcome;
            }
            now_us += 1000;
            if let Some(byte) = host.transmit(now_us) {
                if device.push(byte) == Some(Order::Report) {
                    device.report(&state);
                }
            }
            while let Some(byte) = device.transmit() {
                bytes += 1;
                assert_eq!(digits.state().is_some(), bytes == 76, "after {bytes} bytes");
                match host.push(byte, now_us) {
                    Some(Report::Digit(digit)) => digits.push(digit),
                    None => {}
                    other => panic!("{other:?}"),
                }
            }
        };
        assert_eq!((outcome, bytes), (Outcome::Done, 76));
        assert_eq!(digits.state(), Some(state));
        // One more than all.
        digits.push(0);
        assert_eq!(digits.state(), None);
    }
    let homed = state().homed();
    assert_eq!(homed.motor_steps(), [0; 3]);
    assert_eq!(
        homed.axes.map(|axis| axis.ahead_steps),
        [1457, u16::MAX, u16::MAX]
    );
    assert_eq!(
        homed.axes.map(|axis| axis.zero_nm),
        state().axes.map(|axis| axis.zero_nm)
    );
    let [x, _, z] = state().axes;
    assert_eq!(x.motor_steps(true), i32::MIN.wrapping_sub(1));
    assert_eq!(z.motor_steps(true), 71_429);
    assert_eq!(z.motor_steps(false), 71_429 + 65_535);
}

/// More ahead than the backlash, and a sixteenth of an answer to whether it is homed.
#[test]
fn impossible_states_are_none() {
    for (place, digit) in [(11, 1), (72, 2)] {
        let mut digits = StateDigits::new();
        for count in 0..73 {
            digits.push(if count == place { digit } else { 0 });
        }
        assert_eq!(digits.state(), None, "{place}");
    }
}
