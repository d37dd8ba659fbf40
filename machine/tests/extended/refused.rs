//! A line that the machine refuses after the program was read changes nothing.

use husillo_machine::backlash::Backlash;
use husillo_machine::interp::Path;
use husillo_machine::{Equipment, Extension, Machine, Refused};
use proptest::prelude::*;

use crate::{ExtendedMachine, config};

/// Lines that set values and modes before what a machine without equipment cannot make: an output
/// in time with a move, a pallet, or a move beyond the travel.
const REFUSED: [&str; 12] = [
    "G0 X400",
    "G1 X400 F77",
    "G20 G91 G1 X20 F77",
    "G2 X400 Y0 R500 F5",
    "G28.1 G0 X400",
    "G30.1 G0 X400",
    "G10 L2 P3 X5 Y6 R30 M60",
    "G10 L20 P0 X5 M60",
    "G10 L1 P4 X5 R2 M60",
    "G92 X7 M62 P1",
    "G55 G18 T3 M6 M3 S200 M8 M62 P1",
    "G54 M62 P1 M2",
];

/// Words that change the state in every way, with moves within the travel and beyond it.
fn words() -> impl Strategy<Value = String> {
    let words = prop::sample::select(vec![
        "G0",
        "G1",
        "G2",
        "G3",
        "G5",
        "G7",
        "G10 L2 P1",
        "G10 L2 P9 R45",
        "G10 L20 P2",
        "G10 L1 P1",
        "G10 L10 P2",
        "G17",
        "G18",
        "G20",
        "G21",
        "G28",
        "G28.1",
        "G30",
        "G30.1",
        "G33 K1",
        "G40",
        "G41 D1",
        "G43 H1",
        "G43.1",
        "G49",
        "G54",
        "G55",
        "G59.3",
        "G61",
        "G64 P0.1",
        "G80",
        "G81 R1",
        "G90",
        "G91",
        "G92",
        "G92.1",
        "G92.2",
        "G93",
        "G94",
        "G96 D100",
        "G98",
        "M2",
        "M3 S100",
        "M5",
        "M6 T2",
        "M8",
        "M49",
        "M62 P1",
        "M68 E1 Q1",
        "X0",
        "X0.01",
        "X400",
        "Y0",
        "Y0.02",
        "Y-70",
        "Z0",
        "Z0.01",
        "Z60",
        "I0.01",
        "J0.02",
        "R0.01",
        "F60",
        "F1",
        "P1",
    ]);
    prop::collection::vec(words, 1..5).prop_map(|words| words.join(" "))
}

/// Gives lines to a machine, whose queue runs empty after each. Asserts that a refused one leaves
/// the whole modal state. Returns the lines that the machine itself refused.
fn refusals<'a, E: Extension<3>>(
    machine: &mut Machine<3, Path<3>, Backlash, 16, E>,
    lines: &[&'a str],
) -> Vec<&'a str> {
    let mut refusals = Vec::new();
    for text in lines {
        let before = machine.modal().clone();
        match machine.line(text.as_bytes()) {
            Ok(()) => while machine.next_event().is_some() {},
            Err(refused) => {
                assert!(machine.modal() == &before, "{text}: {refused}");
                assert!(machine.has_room());
                if matches!(refused, Refused::Move(_)) {
                    refusals.push(*text);
                }
            }
        }
    }
    refusals
}

#[test]
fn a_refusal_of_the_machine_takes_the_block_back() {
    let mut bare = config(false);
    bare.equipment = Equipment::NONE;
    let mut plain: Machine<3> = Machine::new(bare);
    assert_eq!(refusals(&mut plain, &REFUSED), REFUSED);
    let mut extended = ExtendedMachine::new(bare);
    assert_eq!(refusals(&mut extended, &REFUSED), REFUSED);
}

proptest! {
    #[test]
    fn a_refused_line_changes_no_mode(lines in prop::collection::vec(words(), 1..12)) {
        let mut bare = config(false);
        bare.equipment = Equipment::NONE;
        let lines: Vec<_> = lines.iter().map(String::as_str).collect();
        let mut plain: Machine<3> = Machine::new(bare);
        refusals(&mut plain, &lines);
        let mut extended = ExtendedMachine::new(config(true));
        refusals(&mut extended, &lines);
    }
}
