//! Gives lines to a Grbl controller, and prints its answers and the steps that it makes.
//!
//! `cargo run -p husillo-controllers --example grbl_lines -- "G0 X2" "?"`

use husillo_controllers::{
    Controller, Grbl, GrblEvent, GrblInputs, GrblMemory, GrblOptions, Timed,
};

fn main() {
    let mut lines: Vec<String> = std::env::args().skip(1).collect();
    if lines.is_empty() {
        lines = ["G0 X2", "?", "G1 Y1 F600", "?"].map(String::from).to_vec();
    }
    lines.insert(0, String::new()); // prints the banner
    let mut grbl: Grbl = Grbl::new(GrblOptions::FULL, Some(&GrblMemory::FACTORY));
    for line in lines {
        for byte in line.bytes().chain([b'\n']) {
            if grbl.receive(byte) {
                grbl.halted(); // nothing is in a queue here
            }
        }
        let (mut us, mut steps, mut answers) = (0_u64, [0; 3], Vec::new());
        // Nothing is connected, so all inputs are high.
        let inputs = GrblInputs {
            limits: [true; 3],
            probe: true,
            ..GrblInputs::default()
        };
        while let Some(event) = grbl.next_event(0, &inputs) {
            if let Some(wait_ticks) = event.wait_ticks() {
                us += u64::from(wait_ticks);
                grbl.made(0, 1);
            }
            if let GrblEvent::Step { delta, .. } = event {
                steps
                    .iter_mut()
                    .zip(delta)
                    .for_each(|(steps, delta)| *steps += i32::from(delta));
            }
            answers.extend(std::iter::from_fn(|| grbl.transmit()));
        }
        answers.extend(std::iter::from_fn(|| grbl.transmit()));
        println!("> {line}");
        print!("{}", String::from_utf8_lossy(&answers).replace('\r', ""));
        println!("  {:.3} s, steps {steps:?}", us as f64 / 1e6);
    }
}
