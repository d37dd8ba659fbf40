//! Drill files on the simulated drill.

use crate::holes;
use husillo_clients::drill::{Client, End, Operator, Part, Sender, lean};
use husillo_clients::{StopRequests, Wire};
use husillo_gcode::Nm;
use husillo_sim::device::drill::Device;
use husillo_simulator::diagnostics::Findings;
use husillo_transports::drill::Table;

/// Says nothing and changes no tool.
struct Absent;

impl Operator for Absent {
    fn show(&mut self, _: &str) {}

    fn change(&mut self, _: &str, _: Option<Nm>) -> Option<String> {
        None
    }

    fn progress(&mut self, _: f64, _: f64) {}
}

/// From the file to the holes in the simulated board: no drilling is farther off than half a step,
/// 4.673 um, on either axis.
#[test]
fn holes_of_a_drill_file_are_drilled_within_half_a_step() {
    let text = std::fs::read("../examples/board.drl").unwrap();
    let mut findings = Findings::new(1);
    let board = holes::read(
        &text,
        "board.drl",
        &holes::Options::default(),
        &mut findings,
    );
    let wanted: Vec<[i64; 2]> = board.holes.iter().map(|hole| hole.at_nm).collect();
    let records = wanted.iter().flat_map(|at| Table::DRILL.hole(*at).unwrap());
    let part = Part {
        tool: 1,
        diameter: None,
        records: lean(&records.collect::<Vec<_>>()),
    };
    let wire = Wire::simulated(Device::quick(false));
    let mut sender = Sender {
        client: Client::new(wire, 2400, StopRequests::default()),
        operator: &mut Absent,
        parts: &[part],
        from: 0,
        byte_s: 0.0085,
        is_homed: false,
        is_sure: true,
        diameter: |_| None,
    };
    assert_eq!(sender.send(false), Ok(End::Drilled));
    let drilled = sender
        .client
        .device()
        .unwrap()
        .rig(0)
        .unwrap()
        .holes()
        .iter();
    let whole = drilled.filter(|hole| hole.depth == 6);
    let found: Vec<[i32; 2]> = whole.map(|hole| hole.at).collect();
    assert_eq!(found.len(), wanted.len());
    for (steps, wanted) in found.iter().zip(&wanted) {
        for (steps, nm) in steps.iter().zip(wanted) {
            let off_nm = f64::from(*steps) * 1e6 / 107.0 - *nm as f64;
            assert!(
                off_nm.abs() <= 0.5e6 / 107.0 + 1e-6,
                "{steps} steps for {nm} nm"
            );
        }
    }
}
