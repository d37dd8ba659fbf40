//! The microfactory's controller against its mechanics, chips and coils among them.

use husillo_machine::{Cell, CellConfig, CellEvent, CellReport};
use husillo_sim::CellRig;
use husillo_transports::byte_commands::{ByteCommands, ByteTable};

const TRIANGLE: [[i16; 2]; 3] = [[1000, 0], [-500, 500], [-500, -500]];

/// Bytes to the link, and events until nothing is left to do: the reports.
fn send(
    link: &mut ByteCommands,
    cell: &mut Cell<[[i16; 2]; 3]>,
    rig: &mut CellRig,
    bytes: &[u8],
) -> Vec<CellReport> {
    for byte in bytes {
        if let Some(command) = link.receive(*byte, cell.is_moving()).command {
            assert!(cell.command(command), "{command:?}");
        }
    }
    let mut reports = Vec::new();
    for _ in 0..1_000_000 {
        let event = cell.next_event(&rig.inputs());
        rig.apply(&event);
        match event {
            CellEvent::Report(report) => reports.push(report),
            CellEvent::Idle => return reports,
            _ => {}
        }
    }
    panic!("no end");
}

fn run(config: CellConfig) -> (CellRig, [i32; 4]) {
    let mut link = ByteCommands::new(ByteTable::DEFAULT);
    let mut cell = Cell::new(config, TRIANGLE);
    let mut rig = CellRig::new(&config, [420, 380, 900], 1200);
    let (link, cell_, rig_) = (&mut link, &mut cell, &mut rig);
    assert_eq!(send(link, cell_, rig_, b"H"), [CellReport::Homed]);
    let zero = rig_.tool();
    assert_eq!(send(link, cell_, rig_, b"NX\xc8E"), [CellReport::Done]);
    assert_eq!(send(link, cell_, rig_, b"Nz\x05E"), [CellReport::Done]);
    assert_eq!(send(link, cell_, rig_, b"NX\xc8E"), [CellReport::Done]);
    assert_eq!(
        send(link, cell_, rig_, b"G"),
        [CellReport::Contact, CellReport::Done]
    );
    let tool = rig.tool();
    let moved = std::array::from_fn(|axis| tool[axis] - zero[axis]);
    (rig, moved)
}

/// Every step arrives: X by 400, Z back by 5, a triangle that closes, Y to the work piece, and nothing lost.
#[test]
fn a_session_on_the_bytes() {
    let (rig, [x, y, z, spindle]) = run(CellConfig::ORIGINAL);
    assert_eq!(rig.lost_steps(), [0; 4]);
    assert_eq!([x, z], [400, -5]);
    // Home in Y is 180 below the start, where the work piece is 1200 above it.
    assert_eq!(y, 1380);
    assert!(spindle > 64 * 20);
}

/// RESET before every move, as the original did it: motors that stand elsewhere than in state 1 jump there, and the tool is not
/// where it was told to be.
#[test]
fn the_originals_reset_costs_steps() {
    let (_, [x, _, z, _]) = run(CellConfig {
        resets_before_moves: true,
        ..CellConfig::ORIGINAL
    });
    assert_ne!([x, z], [400, -5]);
    assert!((x - 400).abs() <= 8 && (z + 5).abs() <= 8, "{x} {z}");
}
