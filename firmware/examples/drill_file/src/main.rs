//! Reads a drill file on a microcontroller: finds its unit and its zeros, and gives each hole in
//! steps of the table. No heap: the file stays in flash and is read twice, line by line.
//!
//! On your own board, [`FILE`] is a block of flash or a card, and [`Table::go`] moves the axes.
//! Where bytes arrive at a port and nothing keeps them, the operator sets the format, as in
//! `excellon/examples/bytes.rs`.
#![no_std]
#![no_main]

use husillo_excellon::{Feature, Inference, Overrides, Reader, lines};
use semihosting::println;

const FILE: &[u8] = include_bytes!("../../../../examples/board.drl");

/// Stands in for the axes of a table whose screws make 400 steps per millimetre.
#[derive(Default)]
struct Table {
    at_steps: [i64; 2],
    /// The steps of all moves, of the axis that takes longer.
    travelled: u64,
}

impl Table {
    /// One step in nanometres.
    const STEP_NM: i64 = 2_500;

    /// Moves to a position, rounded to the nearest step.
    fn go(&mut self, to_nm: [i64; 2]) {
        let to = to_nm.map(|nm| (nm + Self::STEP_NM / 2).div_euclid(Self::STEP_NM));
        let [x, y] = [0, 1].map(|axis| to[axis].abs_diff(self.at_steps[axis]));
        self.travelled += x.max(y);
        self.at_steps = to;
    }
}

#[cfg_attr(target_arch = "arm", cortex_m_rt::entry)]
#[cfg_attr(target_arch = "riscv32", riscv_rt::entry)]
fn main() -> ! {
    let mut inference = Inference::new();
    for (_, line) in lines(FILE) {
        inference.observe(line);
    }
    let settings = inference.settle(&Overrides::default());
    println!("{:?}, {:?}", settings.units.value, settings.zeros.value);

    let mut reader = Reader::<16>::new(&settings);
    let mut table = Table::default();
    let (mut holes, mut slots, mut tool) = (0, 0, None);
    for (number, line) in lines(FILE) {
        let features = match reader.read(line) {
            Ok(features) => features,
            Err(error) => panic!("line {number}: {error}"),
        };
        for feature in features {
            match feature {
                Feature::Hole(hole) => {
                    if tool != Some(hole.tool.number) {
                        tool = Some(hole.tool.number);
                        println!("tool {}: {:?} nm", hole.tool.number, hole.tool.diameter_nm);
                    }
                    table.go(hole.at_nm);
                    holes += 1;
                }
                _ => slots += 1,
            }
        }
    }
    println!("{holes} holes, {slots} slot, {} steps", table.travelled);
    assert!(reader.is_ended());
    // `husillo holes examples/board.drl` finds the same on a computer.
    assert_eq!((holes, slots), (22, 1));
    assert_eq!(table.at_steps, [14_600, 10_600]);
    semihosting::process::exit(0)
}
