//! Host and modules on a line that loses, flips and doubles bytes: nothing is executed twice or by
//! half, and no error is silent.

mod model;

use husillo_transports::nmc::{
    Baud, CYCLE_US, Command, FLUSH_LENGTH, Failure, Group, Homing, Host, Items, LAST_ADDRESS, Mode,
    Next, Outcome, PathPoints, Polling, Receiver, Refused, Repeat, Reply, Reset, Startup, Status,
    Step, Timing, Trajectory, Verdict, flush_byte, unseen_pairs_in_halves,
};
use model::{Fault, Line};
use oorandom::Rand32;

const BAUD: Baud = Baud::B115200;

fn host() -> Host {
    Host::new(Timing::prompt(BAUD, 512))
}

fn request(address: u8, command: Command) -> Step {
    Step::Request { address, command }
}

fn start_up(
    line: &mut Line,
    host: &mut Host,
    fault: &mut impl FnMut(bool, u64) -> Option<Fault>,
) -> husillo_transports::nmc::Network {
    let mut startup = Startup::new(BAUD);
    let mut outcome = None;
    for _ in 0..1000 {
        match startup.next(outcome.as_ref()) {
            Next::Step(step) => outcome = Some(line.run(host, step, fault)),
            Next::Done(network) => return network,
        }
    }
    panic!("the start never ends");
}

/// A line of this many modules, started.
fn started(count: usize, version: u8) -> (Line, Host) {
    let (mut line, mut host) = (Line::new(count, version), host());
    let network = start_up(&mut line, &mut host, &mut |_, _| None);
    assert_eq!(usize::from(network.modules), count);
    (line, host)
}

#[test]
fn a_network_of_any_length_is_addressed_from_its_far_end() {
    for count in [1, 2, 3, 31, 32] {
        let (mut line, mut host) = (Line::new(count, 4), host());
        let network = start_up(&mut line, &mut host, &mut |_, _| None);
        assert_eq!((network.silent, network.is_complete), (0, true));
        for (number, (module, _)) in (1..).zip(&line.modules) {
            assert_eq!(module.address(), number);
            assert_eq!(network.devices[usize::from(number) - 1], (0, 4));
        }
        assert_eq!(host.baud(), BAUD);
    }
    let mut nobody = Line::new(0, 4);
    assert_eq!(
        start_up(&mut nobody, &mut host(), &mut |_, _| None).modules,
        0
    );
}

/// One byte in a hundred is lost, flipped or doubled while the network gets its addresses. In the
/// end every module has its own address, or the start reports a doubt.
#[test]
fn a_noisy_start_gives_no_address_twice() {
    let mut complete = 0;
    for seed in 1..=60 {
        let (mut line, mut host) = (Line::new(8, 4), host());
        let mut random = Rand32::new(seed);
        let network = start_up(&mut line, &mut host, &mut |_, _| noise(&mut random, 100));
        let mut addresses: Vec<u8> = line
            .modules
            .iter()
            .map(|(module, _)| module.address())
            .collect();
        if network.is_complete && network.modules == 8 {
            complete += 1;
            assert_eq!(addresses, [1, 2, 3, 4, 5, 6, 7, 8], "seed {seed}");
        }
        addresses.retain(|address| *address != 0);
        addresses.dedup();
        assert!(addresses.is_sorted(), "seed {seed}: {addresses:?}");
    }
    assert!(complete >= 55, "{complete} of 60");
}

fn noise(random: &mut Rand32, one_in: u32) -> Option<Fault> {
    if random.rand_range(0..one_in) != 0 {
        return None;
    }
    Some(match random.rand_range(0..3) {
        0 => Fault::Lost,
        1 => Fault::Flipped(random.rand_range(0..8) as u8),
        _ => Fault::Doubled,
    })
}

fn absolute(position: i32) -> Trajectory {
    Trajectory {
        position: Some(position),
        velocity: Some(65536),
        acceleration: Some(1000),
        mode: Mode::Trapezoid,
        start_now: true,
        ..Trajectory::default()
    }
}

/// What must not be executed twice, each from a servo where a second time would be seen.
fn delicate() -> Vec<Command> {
    let relative = Trajectory {
        reverse: true,
        ..absolute(500)
    };
    vec![
        Command::ResetPosition(Reset::Zero),
        Command::ResetPosition(Reset::To(70_000)),
        Command::SaveHome,
        Command::SetHoming(Homing::INDEX),
        Command::LoadTrajectory(absolute(3000)),
        Command::LoadTrajectory(relative),
        Command::AddPathPoints(PathPoints::new(&[4, 8, 12])),
    ]
}

/// Any one fault at any position of any of these conversations: the command is executed once, or
/// not at all and this is reported.
#[test]
fn any_single_fault_executes_nothing_twice() {
    for command in delicate() {
        let (mut line, mut host) = prepared();
        let (sent, told) = (line.sent, line.told);
        let good = line.do_step(&mut host, request(1, command));
        assert!(
            matches!(good, Outcome::Answered(_)),
            "{command:?}: {good:?}"
        );
        let (sent, told) = (line.sent - sent, line.told - told);
        for place in 0..sent + told {
            let faults = (0..8)
                .map(Fault::Flipped)
                .chain([Fault::Lost, Fault::Doubled]);
            for fault in faults {
                let (mut line, mut host) = prepared();
                let (first_sent, first_told) = (line.sent, line.told);
                let outcome = line.run(&mut host, request(1, command), &mut |is_reply, number| {
                    let number = if is_reply {
                        number - first_told + sent
                    } else {
                        number - first_sent
                    };
                    let is_here = number == place && (is_reply || number < sent);
                    is_here.then_some(fault)
                });
                check_once(
                    &line,
                    command,
                    outcome,
                    &format!("{command:?} {fault:?} at {place}"),
                );
                // The line is as good as before.
                let after =
                    line.do_step(&mut host, request(1, Command::ReadStatus(Items::POSITION)));
                assert!(matches!(
                    after,
                    Outcome::Answered(reply) if reply.position() == Some(
                        line.modules[0].1.position
                    ),
                ));
            }
        }
    }
}

/// A byte lost and another doubled in one reply. If they are equal, the length and the checksum are
/// right and the content is wrong. With a byte of the command lost as well, nothing is reported as
/// done that was not.
#[test]
fn a_reply_that_is_wrong_and_looks_right_proves_nothing() {
    for command in [
        Command::SetHoming(Homing::INDEX),
        Command::ResetPosition(Reset::Zero),
    ] {
        let Repeat::AfterReading(items) = command.repeat(1) else {
            panic!("delicate: {command:?}")
        };
        let reading = items.length() as u64 + 2;
        let pairs = (0..reading).flat_map(|a| (0..reading).map(move |b| (a, b)));
        // Of the readings before, or of those after; the packet of a reading has five bytes.
        for ((doubled, lost), number) in pairs.flat_map(|pair| (0..4).map(move |n| (pair, n))) {
            for cut in [5, 10, 13] {
                let (mut line, mut host) = prepared();
                line.modules[0].1.home = 777;
                let sent = line.sent + cut;
                let reply = line.told + number * reading;
                let outcome =
                    line.run(
                        &mut host,
                        request(1, command),
                        &mut |is_reply, place| match is_reply {
                            true if place == reply + doubled => Some(Fault::Doubled),
                            true if place == reply + lost => Some(Fault::Lost),
                            false if place == sent => Some(Fault::Lost),
                            _ => None,
                        },
                    );
                let place = format!("{command:?} {doubled} {lost} of {number}, {cut}");
                check_once(&line, command, outcome, &place);
            }
        }
    }
}

/// `AA 15 12 49 70` with a wrong bit in its length is `AA 15 32 49 70 f f`: valid with any byte,
/// and no command. A flush with 0 would make a reset to zero of its first byte, for the module that
/// has no address yet.
#[test]
fn a_flush_that_cannot_help_completing_completes_no_command() {
    let frame = Command::DefineStatus(Items(0x49)).frame(21);
    assert_eq!(frame.bytes(), [0xAA, 0x15, 0x12, 0x49, 0x70]);
    let byte = flush_byte(&frame);
    for wrong in [&[0xAA][..], &[0xAA, 0x15, 0x32, 0x49, 0x70]] {
        let mut receiver = Receiver::new();
        for heard in wrong.iter().chain(&[byte; FLUSH_LENGTH]) {
            if receiver.push(*heard) == Some(Verdict::Sound) {
                let command = Command::decode(receiver.code(), receiver.data(), 10);
                assert_eq!(command, None, "{wrong:?}");
            }
        }
    }
}

/// Two modules of version 10, the first away from zero and from its home.
fn prepared() -> (Line, Host) {
    let (mut line, host) = started(2, 10);
    line.modules[0].1 = model::Servo {
        position: 12_345,
        goal: 12_345,
        home: 300,
        servo_on: true,
        ..model::Servo::new()
    };
    (line, host)
}

fn check_once(line: &Line, command: Command, outcome: Outcome, place: &str) {
    let executed = &line.modules[0].1.executed;
    assert!(
        line.modules[1].1.executed.is_empty(),
        "the other module: {place}"
    );
    assert!(
        executed.iter().all(|done| *done == command),
        "half a command: {place} {executed:?}"
    );
    match outcome {
        Outcome::Answered(_) | Outcome::Confirmed(_) => {
            assert_eq!(executed.len(), 1, "{place} {outcome:?}")
        }
        Outcome::Failed(Failure::NotExecuted | Failure::Silent | Failure::Garbled) => {
            assert_eq!(executed.len(), 0, "{place} {outcome:?}");
        }
        Outcome::Failed(_) | Outcome::Sent => assert!(executed.len() <= 1, "{place} {outcome:?}"),
    }
}

/// A command whose reply is always lost ends executed once or reported. Then the line stays silent.
#[test]
fn without_replies_nothing_is_repeated() {
    for command in delicate() {
        let (mut line, mut host) = prepared();
        let reading = command.repeat(1);
        let first = line.told;
        // The readings before come through, nothing after them.
        let Repeat::AfterReading(items) = reading else {
            panic!("delicate: {command:?}")
        };
        let before = 2 * (items.length() as u64 + 2);
        let outcome = line.run(&mut host, request(1, command), &mut |is_reply, number| {
            (is_reply && number >= first + before).then_some(Fault::Lost)
        });
        assert_eq!(outcome, Outcome::Failed(Failure::Uncertain));
        assert_eq!(line.modules[0].1.executed, [command]);
    }
}

/// A touch stops the motor while the reply to the motion is lost. The motion must not be started
/// again.
#[test]
fn a_motion_that_a_contact_stopped_is_not_repeated() {
    let (mut line, mut host) = prepared();
    line.do_step(
        &mut host,
        request(1, Command::SetHoming(Homing::INDEX.with(Homing::SMOOTH))),
    );
    line.finishes = true; // the index is met at once, and the motion over
    let before = line.modules[0].1.executed.len();
    let told = line.told;
    let probing = Trajectory {
        mode: Mode::Velocity,
        position: None,
        ..absolute(0)
    };
    // Each of the readings before has 4 + 2 + 1 + 4 bytes, status and sum.
    let outcome = line.run(
        &mut host,
        request(1, Command::LoadTrajectory(probing)),
        &mut |is_reply, number| {
            (is_reply && (told + 26..told + 28).contains(&number)).then_some(Fault::Lost)
        },
    );
    assert!(
        matches!(
            outcome,
            Outcome::Confirmed(_) | Outcome::Failed(Failure::Uncertain)
        ),
        "{outcome:?}"
    );
    assert_eq!(line.modules[0].1.executed.len(), before + 1);
}

#[test]
fn a_dead_module_is_distinguished_from_a_living_one() {
    let (mut line, mut host) = started(3, 4);
    line.dead = 0b010;
    let nop = |address| request(address, Command::NoOperation);
    assert!(matches!(
        line.do_step(&mut host, nop(1)),
        Outcome::Answered(_)
    ));
    assert_eq!(
        line.do_step(&mut host, nop(2)),
        Outcome::Failed(Failure::Silent)
    );
    let motion = request(2, Command::LoadTrajectory(absolute(5)));
    assert_eq!(
        line.do_step(&mut host, motion),
        Outcome::Failed(Failure::Silent)
    );
    assert!(matches!(
        line.do_step(&mut host, nop(3)),
        Outcome::Answered(_)
    ));
}

/// Two modules with one address: what they say together is not taken for a position.
#[test]
fn two_modules_that_answer_are_noticed() {
    let (mut line, mut host) = started(2, 4);
    line.modules[0].1.position = 1000;
    line.modules[1].1.position = -77_777;
    // By a packet that is not the host's.
    line.exchange(&[0xAA, 0x02, 0x21, 0x01, 0xFF, 0x23]);
    assert_eq!(line.modules[1].0.address(), 1);
    let outcome = line.do_step(&mut host, request(1, Command::ReadStatus(Items::POSITION)));
    assert_eq!(outcome, Outcome::Failed(Failure::Garbled));
}

#[test]
fn groups_are_started_by_one_packet_and_answered_by_their_leader() {
    let (mut line, mut host) = started(3, 4);
    for (address, is_leader) in [(1, false), (2, true), (3, false)] {
        let group = Group {
            address: 0x81,
            is_leader,
        };
        let outcome = line.do_step(
            &mut host,
            request(address, Command::SetAddress { address, group }),
        );
        assert!(matches!(outcome, Outcome::Answered(_)));
    }
    assert_eq!(host.members_of(0x81), 0b111);
    assert_eq!(host.members_of(0xFF), 0);
    for address in 1..=3 {
        let load = Trajectory {
            start_now: false,
            ..absolute(100 * i32::from(address))
        };
        line.do_step(&mut host, request(address, Command::LoadTrajectory(load)));
    }
    let outcome = line.do_step(&mut host, request(0x81, Command::StartMotion));
    assert!(
        matches!(outcome, Outcome::Answered(reply) if !reply.status.contains(Status::MOVE_DONE))
    );
    line.modules
        .iter_mut()
        .for_each(|(_, servo)| servo.finish());
    let positions: Vec<i32> = line
        .modules
        .iter()
        .map(|(_, servo)| servo.position)
        .collect();
    assert_eq!(positions, [100, 200, 300]);
    // A leader answers, so the rate cannot be changed through this group; nor for one module.
    for address in [0x81, 1] {
        let before = format!("{host:?}");
        let refused = host.send_command(address, Command::SetBaud(Baud::B9600), 0);
        assert_eq!(refused, Err(Refused::WouldAnswer));
        assert_eq!(
            format!("{host:?}"),
            before,
            "a refused command changes nothing"
        );
    }
    // Nobody is left in 0xFF.
    assert_eq!(
        line.do_step(&mut host, request(0xFF, Command::NoOperation)),
        Outcome::Sent
    );
}

#[test]
fn what_no_module_may_get_is_refused() {
    let (_, mut host) = started(1, 4);
    let mut refused =
        |address, command| host.send_command(address, command, 0).expect_err("refused");
    let too_fast = Trajectory {
        velocity: Some(0x8000_0000),
        ..absolute(0)
    };
    assert_eq!(
        refused(1, Command::LoadTrajectory(too_fast)),
        Refused::OutOfRange
    );
    assert_eq!(
        refused(1, Command::LoadTrajectory(absolute(i32::MIN))),
        Refused::OutOfRange
    );
    assert_eq!(
        refused(1, Command::AddPathPoints(PathPoints::new(&[4]))),
        Refused::OutOfRange
    );
    assert_eq!(
        refused(1, Command::SetGain(Default::default())),
        Refused::OutOfRange
    ); // divisor 0
    assert_eq!(
        refused(LAST_ADDRESS + 1, Command::NoOperation),
        Refused::NoSuchAddress
    );
    let address = Command::SetAddress {
        address: 33,
        group: Group::NONE,
    };
    assert_eq!(refused(0, address), Refused::NoSuchAddress);
    host.send_command(1, Command::NoOperation, 0).expect("idle");
    assert_eq!(
        host.send_command(1, Command::NoOperation, 0),
        Err(Refused::Busy)
    );
}

/// Reading twice: one byte in thirty is damaged, in pairs of bits that the checksum does not
/// detect. No wrong position is accepted.
#[test]
fn a_position_read_twice_is_right() {
    let (mut line, mut host) = started(1, 4);
    line.modules[0].1.position = 0x0102_0304;
    let mut random = Rand32::new(7);
    let (mut right, mut wrong_once) = (0, 0);
    for _ in 0..3000 {
        // The same bit of two bytes, in opposite directions as often as not.
        let (bit, from) = (random.rand_range(0..8) as u8, line.told);
        let hits = [random.rand_range(0..60), random.rand_range(0..60)]
            .map(|place| from + u64::from(place));
        let mut fault =
            |is_reply, number| (is_reply && hits.contains(&number)).then_some(Fault::Flipped(bit));
        let step = Step::ReadTwice {
            address: 1,
            items: Items::POSITION.with(Items::HOME),
            jitter_counts: 1,
        };
        if let Outcome::Answered(reply) = line.run(&mut host, step, &mut fault) {
            assert_eq!(reply.position(), Some(0x0102_0304));
            right += 1;
        }
        let from = line.told;
        let hits =
            [random.rand_range(0..6), random.rand_range(0..6)].map(|place| from + u64::from(place));
        let mut fault =
            |is_reply, number| (is_reply && hits.contains(&number)).then_some(Fault::Flipped(bit));
        let once = line.run(
            &mut host,
            request(1, Command::ReadStatus(Items::POSITION)),
            &mut fault,
        );
        if once
            .reply()
            .is_some_and(|reply| reply.position() != Some(0x0102_0304))
        {
            wrong_once += 1;
        }
    }
    assert!(right > 2900, "{right}");
    assert!(
        wrong_once > 300,
        "the sum alone lets such through: {wrong_once}"
    );
}

/// Wrong bits at a known rate, far above any real one: the number of wrong replies that pass the
/// checksum is the computed one.
#[test]
fn the_residual_rate_is_as_computed() {
    let items = Items::POSITION;
    let mut random = Rand32::new(99);
    let packets = 400_000_u32;
    let one_in = 500; // bit error rate 2e-3
    let mut unseen = 0_u32;
    for _ in 0..packets {
        let mut bytes = [
            0x09,
            random.rand_u32() as u8,
            random.rand_u32() as u8,
            random.rand_u32() as u8,
            random.rand_u32() as u8,
            0,
        ];
        bytes[5] = bytes[..5]
            .iter()
            .fold(0, |sum: u8, byte| sum.wrapping_add(*byte));
        let good = bytes;
        for byte in &mut bytes {
            for bit in 0..8 {
                if random.rand_range(0..one_in) == 0 {
                    *byte ^= 1 << bit;
                }
            }
        }
        if bytes != good && Reply::decode(&bytes, items).is_some() {
            unseen += 1;
        }
    }
    let pairs = f64::from(unseen_pairs_in_halves(6)) / 2.0;
    assert_eq!(pairs, 67.5);
    let rate = 1.0 / f64::from(one_in);
    let computed = pairs * rate * rate * f64::from(packets) * (1.0 - rate).powi(46);
    let observed = f64::from(unseen);
    // 98 expected; three standard deviations and the triples that cancel.
    assert!(
        (observed - computed).abs() < 35.0,
        "{observed} observed, {computed} computed"
    );
}

/// A noisy line in virtual time: moves and readings are right or reported. One byte in `ONE_IN` is
/// damaged by one fault.
#[test]
fn hours_of_noise() {
    const ONE_IN: u32 = 300;
    let (mut line, mut host) = started(2, 4);
    let mut random = Rand32::new(2026);
    let (mut moves, mut reported) = (0, 0);
    let mut goal;
    for turn in 0..6000 {
        let next = random.rand_range(0..2_000_000) as i32 - 1_000_000;
        let before = line.modules[0].1.executed.len();
        let mut fault = |_, _| noise(&mut random, ONE_IN);
        let load = request(1, Command::LoadTrajectory(absolute(next)));
        match line.run(&mut host, load, &mut fault) {
            Outcome::Answered(_) | Outcome::Confirmed(_) => {
                goal = next;
                moves += 1;
            }
            Outcome::Failed(_) => {
                reported += 1;
                goal = line.modules[0].1.goal;
                assert!(goal == next || line.modules[0].1.executed.len() == before);
            }
            Outcome::Sent => panic!("an axis answers"),
        }
        line.modules[0].1.finish();
        assert_eq!(line.modules[0].1.position, goal, "turn {turn}");
        assert!(
            line.modules[0].1.executed.len() <= before + 1,
            "turn {turn}"
        );
        let step = Step::ReadTwice {
            address: 1,
            items: Items::POSITION,
            jitter_counts: 1,
        };
        let mut fault = |_, _| noise(&mut random, ONE_IN);
        if let Outcome::Answered(reply) = line.run(&mut host, step, &mut fault) {
            assert_eq!(reply.position(), Some(goal), "turn {turn}");
        }
    }
    assert!(
        moves > 5900 && reported < 100,
        "{moves} moves, {reported} reported"
    );
    assert!(line.modules[1].1.executed.is_empty());
}

/// 32 modules, with the position in every reply: the host reaches the limit of the protocol, with
/// the cost of its guard and its steps.
#[test]
fn thirty_two_modules_are_polled_at_the_limit() {
    let (mut line, mut host) = started(32, 4);
    for address in 1..=32 {
        line.do_step(
            &mut host,
            request(address, Command::DefineStatus(Items::POSITION)),
        );
    }
    let limit = Polling {
        modules: 32,
        baud: BAUD,
        items: Items::POSITION,
        latency_us: 0,
        guard_us: 0,
    };
    assert_eq!(limit.module_us(), 869);
    assert_eq!(limit.rate_mhz(), 35_960);
    let average = Polling {
        latency_us: CYCLE_US / 2,
        ..limit
    };
    assert_eq!(average.rate_mhz(), 27_777);
    let mut timing = host.timing();
    for (guard_us, share) in [(0, 80), (timing.guard_us, 70)] {
        timing.guard_us = guard_us;
        host.set_timing(timing);
        let begin_us = line.now_us;
        for round in 0..10 {
            for address in 1..=32 {
                line.modules[usize::from(address) - 1].1.position =
                    round * 100 + i32::from(address);
                let outcome = line.do_step(&mut host, request(address, Command::NoOperation));
                assert_eq!(
                    outcome.reply().and_then(Reply::position),
                    Some(round * 100 + i32::from(address))
                );
            }
        }
        let round_us = (line.now_us - begin_us) / 10;
        let percent = limit.round_us() * 100 / round_us;
        println!(
            "guard {guard_us} us: a round in {round_us} us, {percent} % of the limit of {} us",
            limit.round_us()
        );
        assert!(percent >= share, "{percent} %");
        // A reply begins at the end of a cycle, so with cycles in step an exchange takes whole
        // cycles: two, without a guard.
        let in_step_us = 32 * 2 * CYCLE_US;
        assert!(
            guard_us > 0 || round_us < in_step_us + in_step_us / 50,
            "{round_us} us"
        );
    }
}

/// Relative to home at address 1: with one wrong bit it is a reset to zero.
#[test]
fn a_packet_that_one_bit_makes_another_is_refused() {
    let (_, mut host) = started(2, 10);
    let home = Command::ResetPosition(Reset::Home);
    assert_eq!(host.send_command(1, home, 0), Err(Refused::Fragile));
    assert_eq!(host.send_command(2, home, 0), Ok(()));
}

#[test]
fn a_host_and_a_module_are_small() {
    assert!(size_of::<Host>() <= 2000, "{}", size_of::<Host>());
    assert!(
        size_of::<husillo_transports::nmc::Module>() <= 120,
        "{}",
        size_of::<husillo_transports::nmc::Module>()
    );
}
