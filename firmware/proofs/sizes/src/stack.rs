//! Measures the depth of the stack below a call by the memory that the call overwrites.
//! `firmware/check sizes` runs this program.
#![no_std]
#![no_main]

use core::hint::black_box;
use core::ptr::{read_volatile, write_volatile};
use husillo_gcode::{Block, Commands, Dialect, Modal, words};
use semihosting::{println, process};

/// Bytes of stack that are examined.
const DEPTH: usize = 4096;
/// Bytes below the caller that are not overwritten.
const MARGIN: usize = 64;
const PAINT: u32 = 0xa5a5_5a5a;

/// Returns the bytes of stack below this function that `work` uses.
#[inline(never)]
fn depth(work: &mut dyn FnMut()) -> usize {
    let top = cortex_m::register::msp::read() as usize - MARGIN;
    let places = || (top - DEPTH..top).step_by(4);
    for place in places() {
        // SAFETY: the address is below the stack pointer, with a margin, and within the RAM of the
        // board (16 kB, otherwise unused); interrupts are off.
        unsafe { write_volatile(place as *mut u32, PAINT) };
    }
    work();
    // SAFETY: as above.
    let untouched =
        places().take_while(|&place| unsafe { read_volatile(place as *const u32) } == PAINT);
    DEPTH + MARGIN - 4 * untouched.count()
}

/// Lines of every kind, valid and invalid. With them, the stack gets nearly as deep as it can.
/// `bound` is the limit.
const LINES: &[&str] = &[
    "G1 X12.345 Y-6.789 F600",
    "G0 X1.234567891 Y0.1234567895",
    "G2 X10 Y10 I5 J5 F100",
    "G3 X20 Y20 R-8.5",
    "G2 X30 Y20 R1",
    "G17 G20 G90 G94 G54 M3 S1000",
    "G10 L2 P1 X1 Y2 Z3",
    "G10 L20 P0 X0 Y0",
    "G92 X0 Y0 Z0",
    "G92.1",
    "G28 X0 Y0",
    "G28.1",
    "G53 G0 X0 Y0",
    "G38.2 Z-5 F10",
    "G43.1 Z5.5",
    // Numbers of many digits, in every word whose number is read and scaled.
    "G1 X12.3456789012 Y-6.78901234567 Z0.123456789012 F600.123456789",
    "G1 X.0000000000000000001234567891",
    "G53 G1 X1.23456789012",
    "G91 G1 X0.123456789012 Y1",
    "G90 G0 X0 Y0 Z0",
    "G2 X10 Y10 I5.00000001 J4.99999999 P1.0000000000",
    "G90.1 G3 X0 Y0 I5.00000001 J4.99999999 F100.00000001",
    "G91.1 G2 X10 Y0 R4.999999999",
    "G3 X0 Y0 R-8.5000000001",
    "G18 G2 X1.0000000001 Z1 R8.5000000001",
    "G17 G2 X0.0000000001 Y0 I900.00000001 J-600000.12345678",
    "G2 X1.0000000001 I7",
    "G2 X1.0000000001 R0.0000000001",
    "G20 G1 X0.123456789012",
    "G21 S1000.00000001",
    "G4 P0.50000000001",
    "G10 L2 P1 X1.23456789012 Y2.23456789012 Z3.23456789012",
    "G10 L20.00000000 P1.00000000 X0.00000000001",
    "G92 X1.00000000001 Y2.00000000001",
    "G92.1",
    "G28 X1.00000000001 Y2.00000000001",
    "G30 X1 Y1",
    "G43.1 Z5.50000000001",
    "G49",
    "G38.2 Z-5.00000000001 F10",
    "T3.00000000 M6",
    "N1.00000000000 G1 X1",
    "G93 G1 X5 F2.00000000001",
    "G94 F100 M5 M9 M8",
    "G4 P0.5",
    "G81 X1 Y1 Z-3 R2 F100",
    "G83 X1 Y1 Z-3 R2 Q0.5 L2",
    "G87 X1 Y1 Z-3 R2 I1.00000000001 J2 K1",
    "M3 S1000",
    "G87 X1.00000000001 Y1 Z-3.00000000001 R2.00000000001 \
     I1.00000000001 J2.00000000001 K1.00000000001",
    "G91 G83 X1.00000000001 Y1.00000000001 Z-3.00000000001 R2.00000000001 Q0.50000000001 L3",
    "G90 G80",
    "G5 X1.00000000001 Y1 I0.50000000001 J0 P0.50000000001 Q0",
    "G5.1 X2.00000000001 Y1 I0.50000000001 J1.00000000001",
    "G33 Z-1.00000000001 K1.00000000001",
    "G0 X0 Y0 Z0",
    "G10 L1 P1 R5.00000000001 Z10.00000000001",
    "G10 L10 P1 Z10.00000000001",
    "G43 H1.00000000",
    "G49",
    "G41.1 D4.00000000001",
    "G40",
    "G96 S100.00000000001 D1000.00000000001",
    "G97 S1000",
    "M66 P1 L3 Q1.00000000001",
    "M67 E1 Q1.00000000001",
    "M19 R90.00000000001",
    "M3",
    "M61 Q2.00000000",
    "G64 P0.01000000001",
    "G76 P1.00000000001 Z-5.00000000001 I-0.5 J0.10000000001 \
     K0.60000000001 R1.5 Q29.00000000001 H1 L2 E0.50000000001",
    "G76 P1 Z-5 I-0.5 J0.1 K0.6 R1.5 Q29 H1 L2 E0.5",
    "G1 X1 X2",
    "G1 Q5",
    "G2 X1 Y1",
    "M2",
];

#[cortex_m_rt::entry]
fn main() -> ! {
    let dialect = Dialect::RS274;
    let (mut block, mut modal, mut commands) =
        (Block::new(), Modal::<3>::new(dialect), Commands::new());
    let frame = depth(&mut || ());
    let (mut of_words, mut of_blocks, mut of_modal, mut of_commands) = (0, 0, 0, 0);
    for line in LINES {
        let line = black_box(line.as_bytes());
        of_words = of_words.max(depth(&mut || {
            black_box(words(line).last());
        }));
        let mut read = Ok(());
        of_blocks = of_blocks.max(depth(&mut || read = block.read(line, &dialect)));
        if read.is_err() {
            continue;
        }
        of_modal = of_modal.max(depth(&mut || {
            let _ = black_box(modal.apply(&block, &mut commands));
        }));
        of_commands = of_commands.max(depth(&mut || {
            for command in &mut commands {
                let _ = black_box(command);
            }
        }));
    }
    for (call, depth) in [
        ("words", of_words),
        ("Block::read", of_blocks),
        ("Modal::apply", of_modal),
        ("Commands::next", of_commands),
    ] {
        println!("stack {call} {}", depth - frame);
    }
    println!("bytes Block {}", size_of::<Block>());
    println!("bytes Modal<3> {}", size_of::<Modal<3>>());
    println!("bytes Commands<3> {}", size_of::<Commands<3>>());
    process::exit(0)
}
