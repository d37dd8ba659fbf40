//! Any bytes on the link of the microfactory, read by a link alone and by one with a machine.

use husillo_controllers::{
    Microfactory, MicrofactoryConfig, MicrofactoryEvent, MicrofactoryInputs,
};
use husillo_transports::microfactory::{ByteTable, Device, Order, REJECTED, Status};

use crate::bytes::Bytes;

/// Invariants of the link, and of a machine behind it.
///
/// - A byte is answered once: by itself or by `?`. Only an accepted byte gives a command.
/// - During motion only stop, emergency stop and the same jog are accepted.
/// - A figure is accepted only after its start, with at most as many moves as there is room for.
/// - A count of 0 never runs; motor numbers are below four. After an emergency stop nothing is
///   accepted until the reset.
/// - A machine moves no motor of an axis towards a closed switch, and no motor after an emergency
///   stop.
pub fn microfactory(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    check_link(&mut bytes);
    check_microfactory(&mut bytes);
}

fn check_link(bytes: &mut Bytes<'_>) {
    let room = u16::from(bytes.byte() & 3);
    let mut link = Device::new(ByteTable::DEFAULT)
        .acknowledging()
        .storing(room);
    let mut jog = None;
    // Number of moves of the figure being received.
    let mut moves = None;
    let mut is_stopped = false;
    for _ in 0..bytes.byte() {
        let (byte, flags) = (bytes.byte(), bytes.byte());
        if flags == 0xFF {
            link.reset();
            (jog, moves, is_stopped) = (None, None, false);
        }
        let is_moving = flags & 1 != 0;
        let received = link.receive(byte, is_moving);
        let is_taken =
            received.reply == Some(byte) && (byte != REJECTED || received.command.is_some());
        assert!(received.reply == Some(byte) || received.reply == Some(REJECTED));
        let Some(command) = received.command else {
            assert!(!(is_stopped && is_taken), "taken behind an emergency stop");
            continue;
        };
        assert!(received.reply == Some(byte) && (!is_stopped || command == Order::Ask));
        match command {
            Order::Ask | Order::Lease(_) => {}
            Order::Clear => moves = Some(0),
            Order::Line(_) => {
                moves = moves.map(|moves| moves + 1);
                assert!(moves.is_some_and(|moves| moves <= room));
            }
            Order::Keep => assert!(moves.take().is_some()),
            Order::Emergency => is_stopped = true,
            Order::Stop => {}
            Order::Jog { motor, forward } => {
                assert!(motor < 4);
                assert!(!is_moving || jog == Some((motor, forward)));
                jog = Some((motor, forward));
            }
            Order::Steps { motor, count, .. } => {
                assert!(motor < 4 && count > 0 && !is_moving);
            }
            Order::Home | Order::Figure => assert!(!is_moving),
        }
    }
}

fn check_microfactory(bytes: &mut Bytes<'_>) {
    let flags = bytes.byte();
    let config = MicrofactoryConfig {
        backlash_steps: [u16::from(bytes.byte()), 0, u16::from(bytes.byte())],
        back_off_steps: u16::from(bytes.byte() & 31),
        search_steps: 300,
        approach_steps: 200,
        dead_man_ticks: (flags & 1 != 0).then_some(40_000),
        resets_before_moves: flags & 2 != 0,
        spindle_turns_in_figures: flags & 4 != 0,
        ..MicrofactoryConfig::ORIGINAL
    };
    let figure: Vec<[i16; 2]> = (0..bytes.byte() & 3)
        .map(|_| [bytes.byte(), bytes.byte()].map(|way| i16::from(way.cast_signed())))
        .collect();
    let mut link = Device::new(ByteTable::DEFAULT);
    let mut machine = Microfactory::new(config, figure);
    let mut is_stopped = false;
    while !bytes.is_empty() {
        let (byte, switches) = (bytes.byte(), bytes.byte());
        let inputs = MicrofactoryInputs {
            home: [1, 2, 4].map(|bit| switches & bit != 0),
            contact: switches & 8 != 0,
        };
        if let Some(command) = link.receive(byte, machine.is_moving()).command {
            is_stopped |= command == Order::Emergency;
            machine.command(command);
            let told = Status::of(&machine.status().bytes());
            assert!(told.is_some_and(|told| told == machine.status()));
        }
        for _ in 0..switches >> 4 {
            match machine.next_event(&inputs) {
                MicrofactoryEvent::Step(step) => {
                    assert!(!is_stopped, "a step behind an emergency stop");
                    assert!(step.delta.iter().all(|delta| delta.abs() <= 1));
                }
                MicrofactoryEvent::Idle => break,
                _ => {}
            }
        }
        assert!(!(is_stopped && machine.is_moving()));
    }
}
