//! The drill's link, both ends in virtual time, on good lines and bad ones.

use husillo_transports::drill::{
    AT_WORK, Axis, COUNT, Device, ENDING, EXPIRED, FAULT, Failure, Host, MEMORY_BYTES,
    MachineState, Order, Outcome, Progress, Reading, Refused, Rules, Step, Timing, WORKING,
};
use oorandom::Rand64;

/// A character at 2400 baud.
const CHARACTER_US: u32 = 4167;

/// An order takes this long.
const ORDER_US: u32 = 20_000;

/// What happens to one byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fault {
    Lost,
    Doubled,
    Flipped(u8),
    /// A delay longer than the wait for an echo and shorter than the wait for a late one, and a
    /// delay longer than that.
    Late(u32),
}

/// When something happens: at this byte, counted in both directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Event {
    Byte(Fault),
    /// The reset button.
    Reset,
    /// From here on no byte gets through.
    Unplugged,
}

/// A device with a machine of a few numbers, and the line.
struct Bench<const N: usize> {
    rules: Rules,
    device: Device<N>,
    host: Host,
    now_us: u32,
    /// Of both directions: when it arrives, whether at the host, and what.
    flying: Vec<(u32, bool, u8)>,
    carried: u64,
    event: Option<(u64, Event)>,
    is_unplugged: bool,
    busy_until_us: u32,
    order_us: u32,
    is_busy: bool,
    free_us: [u32; 2],
    position: [u16; 2],
    /// Places that were drilled.
    holes: Vec<[u16; 2]>,
    orders: Vec<Order>,
}

impl<const N: usize> Bench<N> {
    fn new(rules: Rules, timing: Timing) -> Self {
        let mut bench = Bench {
            rules,
            device: Device::new(rules),
            host: Host::new(timing, N as u32),
            now_us: 0,
            flying: Vec::new(),
            carried: 0,
            event: None,
            is_unplugged: false,
            busy_until_us: 0,
            order_us: ORDER_US,
            is_busy: false,
            free_us: [0; 2],
            position: [0; 2],
            holes: Vec::new(),
            orders: Vec::new(),
        };
        assert_eq!(bench.run(Step::AwaitBoot), Ok(Outcome::Done));
        bench
    }

    fn fixed() -> Self {
        Self::new(Rules::FIXED, Timing::of(2400, 60_000_000))
    }

    fn send(&mut self, to_host: bool, byte: u8) {
        let number = self.carried;
        self.carried += 1;
        let free_us = &mut self.free_us[usize::from(to_host)];
        let begin_us = self.now_us.max(*free_us);
        *free_us = begin_us + CHARACTER_US;
        let arrives_us = begin_us + CHARACTER_US;
        let event = match self.event {
            Some((at, event)) if at == number => Some(event),
            _ => None,
        };
        if event == Some(Event::Unplugged) {
            self.is_unplugged = true;
        }
        if event == Some(Event::Reset) {
            self.device = Device::new(self.rules);
            self.is_busy = false;
            self.flying.clear();
            return;
        }
        if self.is_unplugged {
            return;
        }
        let mut fly = |us, byte| self.flying.push((us, to_host, byte));
        match event {
            Some(Event::Byte(Fault::Lost)) => {}
            Some(Event::Byte(Fault::Doubled)) => {
                fly(arrives_us, byte);
                fly(arrives_us + CHARACTER_US, byte);
                self.free_us[usize::from(to_host)] += CHARACTER_US;
            }
            Some(Event::Byte(Fault::Flipped(bit))) => fly(arrives_us, byte ^ (1 << bit)),
            Some(Event::Byte(Fault::Late(us))) => fly(arrives_us + us, byte),
            _ => fly(arrives_us, byte),
        }
    }

    /// A millisecond of everything.
    fn tick(&mut self) {
        self.now_us += 1000;
        let now_us = self.now_us;
        let mut arrived: Vec<_> = self
            .flying
            .iter()
            .copied()
            .filter(|one| one.0 <= now_us)
            .collect();
        arrived.sort_by_key(|one| one.0);
        self.flying.retain(|one| one.0 > now_us);
        for (_, to_host, byte) in arrived {
            if to_host {
                self.host.push(byte, now_us);
            } else {
                self.device.push(byte);
            }
        }
        if self.is_busy && now_us >= self.busy_until_us {
            self.is_busy = false;
            self.device.done();
        }
        if !self.is_busy {
            if let Some(order) = self.device.take() {
                (self.is_busy, self.busy_until_us) = (true, now_us + self.order_us);
                self.orders.push(order);
                match order {
                    Order::Home | Order::Zero => self.position = [0; 2],
                    Order::Move(Axis::X, to) => self.position[0] = to,
                    Order::Move(_, to) => self.position[1] = to,
                    Order::Drill(_) => self.holes.push(self.position),
                    Order::Teach => self.device.teach(self.position),
                    Order::Jog(..) | Order::Spindle(_) => {}
                }
            }
        }
        while let Some(byte) = self.device.transmit() {
            self.send(true, byte);
        }
    }

    fn run(&mut self, step: Step) -> Result<Outcome, Refused> {
        self.host.start(step, self.now_us)?;
        for _ in 0..400_000 {
            if let Some(byte) = self.host.transmit(self.now_us) {
                self.send(false, byte);
            }
            if let Progress::Done(outcome) = self.host.poll(self.now_us) {
                return Ok(outcome);
            }
            self.tick();
        }
        panic!("the host hangs in {step:?}");
    }

    /// Homes, clears, stores, runs; the first failure ends it.
    fn program(&mut self, bytes: &[u8]) -> Result<(), (Step, Outcome)> {
        let head = [Step::Home, Step::Clear, Step::Begin];
        let body = bytes.iter().map(|byte| Step::Store(*byte));
        let steps = head
            .into_iter()
            .chain(body)
            .chain([Step::End, Step::Execute, Step::Test]);
        for step in steps {
            match self
                .run(step)
                .unwrap_or_else(|refused| panic!("{step:?}: {refused}"))
            {
                Outcome::Done => {}
                outcome => return Err((step, outcome)),
            }
        }
        Ok(())
    }
}

/// Records of holes at these places.
fn drill(holes: &[[u16; 2]]) -> Vec<u8> {
    let hole = |[x, y]: &[u16; 2]| {
        let ([x0, x1], [y0, y1]) = (x.to_le_bytes(), y.to_le_bytes());
        [b'X', x0, x1, b'Y', y0, y1, b'Z', 0, 0]
    };
    holes.iter().flat_map(hole).collect()
}

#[test]
fn the_examples_of_the_protocol() {
    let mut bench = Bench::<MEMORY_BYTES>::new(Rules::FAITHFUL, Timing::of(2400, 60_000_000));
    assert_eq!(bench.run(Step::Test), Ok(Outcome::Done));
    let hole = drill(&[[1070, 535]]);
    assert_eq!(hole, [0x58, 0x2e, 0x04, 0x59, 0x17, 0x02, 0x5a, 0x00, 0x00]);
    assert_eq!(bench.program(&hole), Ok(()));
    assert_eq!(bench.holes, [[1070, 535]]);
    assert_eq!((bench.host.done_bytes(), bench.host.begun_bytes()), (9, 9));
    // The same again.
    assert_eq!(bench.run(Step::Execute), Ok(Outcome::Done));
    assert_eq!(bench.holes.len(), 2);
}

/// The memory of the original, and a program of three times its size: every hole once, in its
/// position, with records across both borders, and a byte `w` as data elsewhere.
#[test]
fn a_long_program_is_done_in_parts() {
    for rules in [Rules::FAITHFUL, Rules::FIXED] {
        let holes: Vec<[u16; 2]> = (0..2000).map(|number| [0x7777 + number, number]).collect();
        let mut bench = Bench::<MEMORY_BYTES>::new(rules, Timing::of(2400, 2_000_000_000));
        assert_eq!(bench.program(&drill(&holes)), Ok(()));
        assert_eq!(bench.holes, holes);
        assert_eq!(bench.host.done_bytes(), 18_000);
        // The device holds no more than the end.
        assert_eq!(bench.run(Step::Execute), Err(Refused::Incomplete));
    }
}

#[test]
fn what_must_not_be_sent_is_refused() {
    let mut bench = Bench::<64>::fixed();
    let mut refused = |step| bench.run(step).expect_err("refused");
    assert_eq!(refused(Step::Begin), Refused::NotCleared);
    assert_eq!(refused(Step::Manual(1)), Refused::NotCleared);
    assert_eq!(refused(Step::Execute), Refused::Incomplete);
    assert_eq!(refused(Step::Store(1)), Refused::Mode);
    assert_eq!(refused(Step::Key(b'D')), Refused::Mode);
    assert_eq!(bench.run(Step::Clear), Ok(Outcome::Done));
    assert_eq!(bench.run(Step::Begin), Ok(Outcome::Done));
    assert_eq!(bench.run(Step::End), Err(Refused::Incomplete));
    for byte in [b'X', b'f', b'f'] {
        assert_eq!(bench.run(Step::Store(byte)), Ok(Outcome::Done));
    }
    assert_eq!(bench.run(Step::Store(b'f')), Err(Refused::Incomplete));
    assert_eq!(bench.run(Step::End), Ok(Outcome::Done));
    assert_eq!(bench.run(Step::Manual(1)), Err(Refused::NotCleared));
}

#[test]
fn the_manual_mode() {
    for (rules, most) in [(Rules::FAITHFUL, 256), (Rules::FIXED, 0)] {
        let mut bench = Bench::<64>::new(rules, Timing::of(2400, 60_000_000));
        assert_eq!(bench.run(Step::Clear), Ok(Outcome::Done));
        bench.orders.clear();
        assert_eq!(bench.run(Step::Manual(10)), Ok(Outcome::Done));
        for key in *b"DIFRULOSx" {
            assert_eq!(bench.run(Step::Key(key)), Ok(Outcome::Done), "{key}");
        }
        assert_eq!(bench.run(Step::Advance(0)), Ok(Outcome::Done));
        assert_eq!(bench.run(Step::Key(b'L')), Ok(Outcome::Done));
        assert_eq!(bench.run(Step::Quit), Ok(Outcome::Done));
        assert_eq!(bench.run(Step::Test), Ok(Outcome::Done));
        let mut wanted = vec![
            Order::Home,
            Order::Jog(Axis::X, 10),
            Order::Jog(Axis::X, -10),
            Order::Jog(Axis::Y, 10),
            Order::Jog(Axis::Y, -10),
            Order::Jog(Axis::Z, -10),
            Order::Jog(Axis::Z, 10),
            Order::Spindle(true),
            Order::Spindle(false),
        ];
        if most > 0 {
            wanted.push(Order::Jog(Axis::Z, most));
        }
        assert_eq!(bench.orders, wanted);
    }
}

/// Teach-in, reading back, counting, the spindle and help: one kind of device has them, the other
/// does not answer.
#[test]
fn extras_are_there_or_not() {
    let mut bench = Bench::<27>::fixed();
    let count = |bench: &mut Bench<27>| {
        assert_eq!(bench.run(Step::Read(COUNT)), Ok(Outcome::Done));
        bench.host.record()
    };
    assert_eq!(count(&mut bench), *b"B\0\0", "no `c` since the reset");
    assert_eq!(bench.run(Step::Clear), Ok(Outcome::Done));
    assert_eq!(count(&mut bench), *b"c\0\0");
    assert_eq!(bench.run(Step::Manual(1)), Ok(Outcome::Done));
    for (number, place) in [[7, 9], [0x4262, 0x6666], [65_535, 0]]
        .into_iter()
        .enumerate()
    {
        bench.position = place;
        assert_eq!(bench.run(Step::Teach), Ok(Outcome::Done));
        assert_eq!(bench.host.stored_bytes(), 9 * (number as u32 + 1));
    }
    let full = Outcome::Failed(Failure::Full);
    assert_eq!(
        bench.run(Step::Teach),
        Ok(full),
        "27 bytes hold three holes"
    );
    assert_eq!(bench.run(Step::Key(b'T')), Err(Refused::Mode));
    assert_eq!(bench.run(Step::Quit), Ok(Outcome::Done));
    assert_eq!(bench.run(Step::Execute), Ok(Outcome::Done));
    assert_eq!(bench.holes, [[7, 9], [0x4262, 0x6666], [65_535, 0]]);
    assert_eq!(count(&mut bench), *b"c\x03\0");
    let mut read = Vec::new();
    for number in 0..10 {
        assert_eq!(bench.run(Step::Read(number)), Ok(Outcome::Done));
        read.extend(bench.host.record());
    }
    let mut wanted = drill(&bench.holes);
    wanted.extend(b"f\0\0");
    assert_eq!(read, wanted);
    assert_eq!(bench.run(Step::Spindle(true)), Ok(Outcome::Done));
    assert_eq!(bench.orders.last(), Some(&Order::Spindle(true)));
    assert_eq!(bench.run(Step::Help), Ok(Outcome::Done));
    assert_eq!(bench.run(Step::Test), Ok(Outcome::Done));

    let mut device = idle::<64>(Rules::FAITHFUL);
    assert_eq!(said(&mut device, b"OSn?"), b"");
    assert_eq!(said(&mut device, b"B"), b"B");
}

/// A record that is read back wrong is not believed.
#[test]
fn a_wrong_bit_in_a_record_is_seen() {
    for (bit, byte) in (0..8).flat_map(|bit| (3..7).map(move |byte| (bit, byte))) {
        let mut bench = Bench::<64>::fixed();
        // Three bytes there, each echoed, and four back: two of six are of the line there.
        bench.event = Some((bench.carried + 3 + byte, Event::Byte(Fault::Flipped(bit))));
        let outcome = bench.run(Step::Read(COUNT)).expect("idle");
        assert!(
            matches!(outcome, Outcome::Failed(_)),
            "bit {bit} of {byte}: {outcome:?}"
        );
        assert_eq!(bench.run(Step::Resync), Ok(Outcome::Done));
        assert_eq!(bench.run(Step::Read(COUNT)), Ok(Outcome::Done));
        assert_eq!(bench.host.record(), *b"B\0\0");
    }
}

/// A fault while an unknown device is brought to rest. Afterwards the device is at rest, or the
/// host reports that it is not. A device that takes a program echoes every byte, so its answer to a
/// test is no proof: one wrong bit makes a `b` of the first bytes.
#[test]
fn a_device_that_echoes_everything_is_not_at_rest() {
    for rules in [Rules::FIXED, Rules::FAITHFUL] {
        for state in [
            &b""[..],
            b"b",
            b"bX",
            b"bX\x01",
            b"bX\x01\x02",
            b"m\x05",
            b"m\x05D",
        ] {
            let bench = || {
                let mut bench = Bench::<64>::new(rules, Timing::of(2400, 60_000_000));
                for byte in state {
                    bench.send(false, *byte);
                    (0..200).for_each(|_| bench.tick());
                }
                bench
            };
            let mut good = bench();
            let first = good.carried;
            assert_eq!(good.run(Step::Resync), Ok(Outcome::Done), "{state:?}");
            for place in first..good.carried {
                for event in events() {
                    let mut bench = bench();
                    bench.event = Some((place, event));
                    let outcome = bench.run(Step::Resync).expect("at any time");
                    (bench.event, bench.is_unplugged) = (None, false);
                    (0..300).for_each(|_| bench.tick());
                    let mut rounds = 0;
                    let mut outcome = outcome;
                    while outcome != Outcome::Done && rounds < 3 {
                        outcome = bench.run(Step::Resync).expect("at any time");
                        rounds += 1;
                    }
                    assert_eq!(outcome, Outcome::Done, "{state:?} {event:?}");
                    bench.orders.clear();
                    assert_eq!(bench.run(Step::Home), Ok(Outcome::Done));
                    assert_eq!(
                        bench.orders,
                        [Order::Home],
                        "{state:?} {event:?} at {place}"
                    );
                }
            }
        }
    }
}

/// Each flaw by its name: mended in one kind of device, there in the other.
#[test]
fn flaws_are_there_or_mended() {
    // An empty program.
    for (rules, stored) in [(Rules::FAITHFUL, 1), (Rules::FIXED, 0)] {
        let mut device = idle::<64>(rules);
        assert_eq!(said(&mut device, b"bf"), b"bf");
        assert_eq!(device.stored().len(), stored);
    }
    // `b` when the memory is full: a device that holds two programs of three bytes.
    for (rules, says, stored) in [
        (Rules::FAITHFUL, b"wb", &b"b"[..]),
        (Rules::FIXED, b"wb", &b""[..]),
    ] {
        let mut device = idle::<6>(rules);
        said(&mut device, b"bX\x01\x00fbY\x02\x00f");
        assert_eq!(device.stored().len(), 6);
        assert_eq!(said(&mut device, b"b"), says);
        assert_eq!(device.stored(), stored);
    }
    // `E` while a full memory is run.
    for rules in [Rules::FAITHFUL, Rules::FIXED] {
        let mut device = idle::<6>(rules);
        said(&mut device, b"bX\x01\x00Y\x02\x00");
        device.push(b'X');
        assert_eq!(device.transmit(), Some(b'w'));
        assert_eq!(device.take(), Some(Order::Move(Axis::X, 1)));
        device.push(b'E');
        device.done();
        let rest: Vec<u8> = said(&mut device, b"");
        // The original keeps it, behind the byte that waits.
        let wanted: &[u8] = if rules.stops_at_border { b"E" } else { b"XE" };
        assert_eq!(rest, wanted);
    }
    // The Z word.
    for (rules, depth) in [(Rules::FAITHFUL, 0), (Rules::FIXED, 300)] {
        let mut device = idle::<64>(rules);
        said(&mut device, b"bZ\x2c\x01f");
        device.push(b'e');
        assert_eq!(device.take(), Some(Order::Drill(depth)));
    }
}

fn idle<const N: usize>(rules: Rules) -> Device<N> {
    let mut device = Device::new(rules);
    assert_eq!(said(&mut device, b""), b"B");
    device
}

/// What a device says to these bytes, each when it is done with the last.
fn said<const N: usize>(device: &mut Device<N>, bytes: &[u8]) -> Vec<u8> {
    let mut all = Vec::new();
    let mut settle = |device: &mut Device<N>| {
        for _ in 0..100 {
            all.extend(std::iter::from_fn(|| device.transmit()));
            device.done();
            device.take();
        }
    };
    settle(device);
    for byte in bytes {
        device.push(*byte);
        settle(device);
    }
    all
}

/// `E` during a program: it stops after the record, and begins anew the next time.
#[test]
fn a_program_is_stopped() {
    let mut bench = Bench::<64>::fixed();
    for step in [Step::Clear, Step::Begin] {
        assert_eq!(bench.run(step), Ok(Outcome::Done));
    }
    for byte in drill(&[[1, 2], [3, 4]]) {
        assert_eq!(bench.run(Step::Store(byte)), Ok(Outcome::Done));
    }
    assert_eq!(bench.run(Step::End), Ok(Outcome::Done));
    assert_eq!(bench.host.stop(), None, "nothing runs");
    bench
        .host
        .start(Step::Execute, bench.now_us)
        .expect("whole");
    let mut outcome = None;
    for round in 0..10_000 {
        if let Some(byte) = bench.host.transmit(bench.now_us) {
            bench.send(false, byte);
        }
        if round == 40 {
            let byte = bench.host.stop().expect("it runs");
            bench.send(false, byte);
        }
        if let Progress::Done(done) = bench.host.poll(bench.now_us) {
            outcome = Some(done);
            break;
        }
        bench.tick();
    }
    assert_eq!(outcome, Some(Outcome::Stopped));
    assert!(bench.holes.len() < 2, "{:?}", bench.holes);
    assert_eq!((bench.host.done_bytes(), bench.host.begun_bytes()), (0, 18));
    bench.holes.clear();
    assert_eq!(bench.run(Step::Execute), Ok(Outcome::Done));
    assert_eq!(bench.holes, [[1, 2], [3, 4]]);
}

/// The holes of the short program. Its bytes contain letters of commands: 42 is the letter of a
/// reset, 62 begins a program, 66 ends one, 77 is the wait.
const HOLES: [[u16; 2]; 4] = [
    [0x4262, 0x6501],
    [0x7263, 0x6666],
    [0x7777, 0x4242],
    [0x0000, 0x6d63],
];

fn events() -> impl Iterator<Item = Event> {
    let bytes = (0..8).map(Fault::Flipped).chain([
        Fault::Lost,
        Fault::Doubled,
        Fault::Late(30_000),
        Fault::Late(60_000),
        Fault::Late(200_000),
    ]);
    bytes
        .map(Event::Byte)
        .chain([Event::Reset, Event::Unplugged])
}

/// Every event at every byte of a short program that crosses the border of a small memory three
/// times. Either all holes are drilled, each once and in its position, or an error is reported.
/// What is reported as done is done, and what is not reported as begun is not. Afterwards the
/// operator brings the link up and continues at the position where it stopped.
#[test]
fn any_event_at_any_byte_is_survived_or_reported() {
    for rules in [Rules::FIXED, Rules::FAITHFUL] {
        let new = || Bench::<10>::new(rules, Timing::of(2400, 60_000_000));
        let program = drill(&HOLES);
        let mut good = new();
        let first = good.carried;
        assert_eq!(good.program(&program), Ok(()));
        assert_eq!(good.holes, HOLES);
        let (mut reported, mut unharmed) = (0, 0);
        for place in first..good.carried {
            for event in events() {
                let mut bench = new();
                bench.event = Some((place, event));
                let context = format!("{rules:?}, {event:?} at {}", place - first);
                match survives(&mut bench, &HOLES, &context) {
                    true => unharmed += 1,
                    false => reported += 1,
                }
            }
        }
        println!("{reported} reported, {unharmed} without harm");
        assert!(reported > 500 && unharmed > 50, "{reported}, {unharmed}");
    }
}

/// The same anywhere in long programs, in the memory of the original for some.
#[test]
fn events_in_long_programs_are_survived_or_reported() {
    let (mut numbers, mut reported) = (Rand64::new(7), 0);
    let mut random = |below: u64| numbers.rand_range(0..below);
    let events: Vec<Event> = events().collect();
    for round in 0..60 {
        let holes: Vec<[u16; 2]> = (0..150)
            .map(|_| [random(65_536) as u16, random(65_536) as u16])
            .collect();
        let mut bench = Bench::<256>::new(Rules::FIXED, Timing::of(2400, 60_000_000));
        let place = bench.carried + random(2 * 9 * 150);
        let event = events[random(events.len() as u64) as usize];
        bench.event = Some((place, event));
        let context = format!("round {round}, {event:?} at {place}");
        reported += u32::from(!survives(&mut bench, &holes, &context));
    }
    assert!(reported > 30, "{reported}");
}

/// Drills these holes. `false` if an error was reported. Then the drilled holes are those that the
/// host reports, and the rest is drilled after the link is up again.
fn survives<const N: usize>(bench: &mut Bench<N>, holes: &[[u16; 2]], context: &str) -> bool {
    let program = drill(holes);
    if bench.program(&program).is_ok() {
        assert_eq!(bench.holes, holes, "{context}");
        return true;
    }
    let (done, begun) = (
        bench.host.done_bytes() as usize,
        bench.host.begun_bytes() as usize,
    );
    // The device may still be at work.
    let rest = |bench: &mut Bench<N>| (0..4000).for_each(|_| bench.tick());
    rest(bench);
    let count = |bytes: usize| {
        let records = program[..bytes.min(program.len())].chunks(3);
        records.filter(|record| record[0] == b'Z').count()
    };
    let drilled = bench.holes.len();
    assert!(
        (count(done)..=count(begun)).contains(&drilled),
        "{context}: {drilled} holes; {done} bytes reported done, {begun} begun"
    );
    assert_eq!(bench.holes, holes[..drilled], "{context}: in their places");
    // The cable is in again; then from the first hole that is not there.
    (bench.event, bench.is_unplugged) = (None, false);
    for _ in 0..2 {
        bench.run(Step::Resync).expect("idle");
        rest(bench);
    }
    assert_eq!(
        bench.run(Step::Resync),
        Ok(Outcome::Done),
        "{context}: no way back"
    );
    bench.holes.truncate(drilled);
    if drilled < holes.len() {
        assert_eq!(
            bench.program(&drill(&holes[drilled..])),
            Ok(()),
            "{context}"
        );
    }
    assert_eq!(bench.holes, holes, "{context}");
    false
}

/// The host of the original at its own rate stores every byte more than once. That is why it is no
/// default.
#[test]
fn blind_repetition_is_what_it_was() {
    let mut bench = Bench::<64>::new(Rules::FAITHFUL, Timing::original(2400, 60_000_000));
    let result = bench.program(&drill(&[[1, 2]]));
    assert!(result.is_err() || bench.holes != [[1, 2]], "{result:?}");
}

/// A reset is told from a silence when the device says so.
#[test]
fn a_boot_byte_is_heard_at_any_time() {
    let mut bench = Bench::<64>::fixed();
    bench.send(true, b'B');
    for _ in 0..20 {
        bench.tick();
    }
    assert_eq!(
        bench.run(Step::Test),
        Ok(Outcome::Failed(Failure::Restarted))
    );
    assert_eq!(bench.run(Step::Test), Err(Refused::Mode));
    assert_eq!(bench.run(Step::Resync), Ok(Outcome::Done));
    assert_eq!(bench.run(Step::Test), Ok(Outcome::Done));
}

/// A host that sends its next byte as soon as it has the echo. In between the device was asked for
/// nothing else.
#[test]
fn echoes_do_not_pile_up() {
    let mut device = Device::<64>::new(Rules::FIXED);
    // Homed, as it is after power came on.
    assert_eq!(device.take(), Some(Order::Home));
    device.done();
    assert_eq!(device.take(), None);
    assert_eq!(device.transmit(), Some(b'B'));
    for byte in b"bX\x01\x02Y\x03\x04Z\0\0X\x05\x06Y\x07\x08Z\0\0f" {
        device.push(*byte);
        assert_eq!(device.transmit(), Some(*byte));
    }
    assert_eq!(device.transmit(), None);
    assert_eq!(device.stored().len(), 18);
}

/// One wrong bit makes no other command of the lease, and no other answer of its end.
#[test]
fn no_wrong_bit_is_a_lease_or_its_end() {
    let distance = |one: u8, other: u8| (one ^ other).count_ones();
    for byte in [b't', b'0'] {
        for other in *b"BcrbemMOSn?E" {
            assert!(distance(byte, other) >= 2, "{byte} {other}");
        }
    }
    assert!(distance(b't', b'0') >= 2);
    for answer in [WORKING, ENDING, EXPIRED] {
        for other in *b"ermBEwDIFRULOSTca!" {
            assert!(distance(answer, other) >= 3, "{answer} {other}");
        }
    }
    // A host takes the first two with one wrong bit.
    assert!(distance(WORKING, EXPIRED) >= 2 && distance(ENDING, EXPIRED) >= 2);
    assert!(distance(AT_WORK, b'E') >= 2);
}

/// A device that was asked for a lease of 250 ms, and begins this.
fn leased(rules: Rules, begins: &[u8]) -> Device<64> {
    let mut device = idle(rules);
    let answer = said(&mut device, b"t\x05");
    assert_eq!(answer, if rules.has_extras { &b"t\x05"[..] } else { b"" });
    let (last, first) = begins.split_last().unwrap();
    said(&mut device, first);
    assert_eq!(device.lease_us(), None, "nothing moves");
    device.push(*last);
    device
}

#[test]
fn all_work_of_the_device_has_a_lease() {
    let program = b"bX\x01\0Z\0\0X\x02\0Z\0\0fe";
    let home: &[u8] = b"M\x03";
    for begins in [&program[..], b"r", home, b"M\x03D", b"M\x03r"] {
        let mut device = leased(Rules::FIXED, begins);
        assert_eq!(device.lease_us(), Some(250_000), "{begins:?}");
        assert!(device.take().is_some());
        let drain = |device: &mut Device<64>| -> Vec<u8> {
            std::iter::from_fn(|| device.transmit()).collect()
        };
        drain(&mut device);
        device.push(AT_WORK);
        assert_eq!(drain(&mut device), [WORKING], "{begins:?}");
        device.expire();
        assert_eq!(device.lease_us(), None);
        device.push(AT_WORK);
        assert_eq!(drain(&mut device), [ENDING], "{begins:?}");
        device.done();
        // No further record: the spindle stops.
        assert_eq!(device.take(), Some(Order::Spindle(false)), "{begins:?}");
        device.done();
        assert_eq!(device.take(), None);
        assert_eq!(drain(&mut device), [EXPIRED], "{begins:?}");
        // The lease has ended, and the next work needs no host.
        said(&mut device, b"Q");
        device.push(b'r');
        assert_eq!(
            (device.take(), device.lease_us()),
            (Some(Order::Home), None)
        );
    }
    // The original has none.
    let mut device = leased(Rules::FAITHFUL, program);
    assert_eq!(
        (device.take(), device.lease_us()),
        (Some(Order::Move(Axis::X, 1)), None)
    );
}

/// The end of a lease while a full memory is run is not said where the host could take it for the
/// echo that it waits for.
#[test]
fn the_end_of_a_lease_is_no_echo() {
    for (waits, answer) in [(b'X', &[EXPIRED][..]), (EXPIRED, &[]), (EXPIRED ^ 4, &[])] {
        let mut device = idle::<6>(Rules::FIXED);
        said(&mut device, b"t\x01bX\x01\0Y\x02\0");
        device.push(waits);
        assert_eq!(device.transmit(), Some(b'w'));
        assert_eq!(device.take(), Some(Order::Move(Axis::X, 1)));
        assert_eq!(device.lease_us(), Some(50_000));
        device.expire();
        assert_eq!(said(&mut device, b""), answer, "{waits}");
        assert_eq!(said(&mut device, b"B"), b"B", "it is idle");
    }
}

/// A device that has stopped with a fault does not say that it is at work.
#[test]
fn a_fault_is_said_again() {
    let mut device = leased(Rules::FIXED, b"bX\x01\0fe");
    assert!(device.take().is_some());
    device.fail();
    assert_eq!((device.transmit(), device.lease_us()), (Some(FAULT), None));
    device.push(AT_WORK);
    assert_eq!((device.transmit(), device.transmit()), (Some(FAULT), None));
}

/// Both ends: the host asks while it waits, and hears that the device was not in time.
#[test]
fn a_host_hears_the_end_of_its_lease() {
    for step in [
        Step::Home,
        Step::Execute,
        Step::ManualKept(3),
        Step::Key(b'D'),
    ] {
        let mut bench = Bench::<64>::fixed();
        let is_manual = matches!(step, Step::Key(_));
        let mut before = vec![Step::Clear, Step::Begin];
        before.extend(drill(&[[1, 2], [3, 4]]).into_iter().map(Step::Store));
        before.extend([Step::End, Step::Lease(5)]);
        before.extend(is_manual.then_some(Step::ManualKept(3)));
        for step in before {
            assert_eq!(bench.run(step), Ok(Outcome::Done), "{step:?}");
        }
        bench.order_us = 100_000;
        bench.host.start(step, bench.now_us).unwrap();
        let (mut asked, mut answered, mut outcome) = (0, 0, None);
        for round in 0..1000 {
            if let Some(byte) = bench.host.transmit(bench.now_us) {
                bench.send(false, byte);
            }
            if round % 25 == 24 && asked < 3 {
                if let Some(byte) = bench.host.ask_at_work() {
                    asked += 1;
                    // One wrong bit in each direction harms nothing.
                    bench.event = Some((bench.carried + asked % 2, Event::Byte(Fault::Flipped(1))));
                    bench.send(false, byte);
                }
            }
            if bench.device.lease_us().is_some() && asked == 3 {
                bench.device.expire();
            }
            answered += u32::from(bench.host.is_at_work());
            if let Progress::Done(done) = bench.host.poll(bench.now_us) {
                outcome = Some(done);
                break;
            }
            bench.tick();
        }
        assert_eq!(outcome, Some(Outcome::Failed(Failure::Expired)), "{step:?}");
        assert!(answered > 0, "{step:?}");
        assert!(bench.host.done_bytes() == 0 && bench.holes.len() < 2);
        assert_eq!(bench.run(Step::Test), Err(Refused::Mode));
        assert_eq!(bench.run(Step::Resync), Ok(Outcome::Done));
        assert_eq!(bench.run(Step::Home), Ok(Outcome::Done), "without a lease");
    }
}

/// With a lease the host is never silent, as it would have to be while a full memory is run.
#[test]
fn a_lease_ends_at_the_border_of_the_memory() {
    let mut bench = Bench::<6>::fixed();
    for step in [Step::Clear, Step::Lease(5), Step::Begin] {
        assert_eq!(bench.run(step), Ok(Outcome::Done));
    }
    for byte in *b"X\x01\0Y\x02\0" {
        assert_eq!(bench.run(Step::Store(byte)), Ok(Outcome::Done));
    }
    assert_eq!(bench.run(Step::Store(b'Z')), Err(Refused::Leased));
    assert_eq!(bench.run(Step::End), Ok(Outcome::Done));
    assert_eq!(bench.run(Step::Execute), Ok(Outcome::Done));
}

/// What a device says of itself, idle and in the manual mode; its program goes, its zero stays.
#[test]
fn a_device_says_where_it_is() {
    let mut bench = Bench::<64>::fixed();
    let state = MachineState {
        place_steps: [0x6262, 0x4272],
        zero_steps: [7, 9],
        is_homed: true,
        is_up: true,
        ..MachineState::UNKNOWN
    };
    bench.device.set_machine(state);
    for step in [Step::Clear, Step::Begin] {
        assert_eq!(bench.run(step), Ok(Outcome::Done));
    }
    for byte in drill(&[[1, 2]]) {
        assert_eq!(bench.run(Step::Store(byte)), Ok(Outcome::Done));
    }
    assert_eq!(bench.run(Step::End), Ok(Outcome::Done));
    for is_manual in [false, true] {
        if is_manual {
            assert_eq!(bench.run(Step::ManualKept(1)), Ok(Outcome::Done));
        }
        let values = Reading::ALL.map(|reading| {
            assert_eq!(bench.run(Step::Read(reading.number())), Ok(Outcome::Done));
            let [letter, low, high] = bench.host.record();
            (char::from(letter), u16::from_le_bytes([low, high]))
        });
        let expected = [
            ('c', 0),
            ('X', 0x6262),
            ('Y', 0x4272),
            ('x', 7),
            ('y', 9),
            ('s', 0b101),
            ('n', 3),
        ];
        assert_eq!(values, expected);
    }
    assert_eq!(
        bench.run(Step::Key(b'D')),
        Ok(Outcome::Done),
        "it is manual still"
    );
    assert_eq!(bench.run(Step::Quit), Ok(Outcome::Done));
    bench.orders.clear();
    assert_eq!(bench.run(Step::Empty), Ok(Outcome::Done));
    assert_eq!(bench.run(Step::Begin), Ok(Outcome::Done), "it is empty");
    assert_eq!((bench.device.stored(), bench.orders.len()), (&b""[..], 0));
    let mut back = MachineState::UNKNOWN;
    back.set_bits(state.bits());
    assert_eq!(
        (back.is_homed, back.spindle_turns, back.is_up),
        (true, false, true)
    );
}
