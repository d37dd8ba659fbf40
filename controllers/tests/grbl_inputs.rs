//! Inputs of a Grbl controller that change while nothing moves.

use husillo_controllers::{Controller, Grbl, GrblInputs, GrblMemory, GrblOptions};

/// Runs a controller for some events. Returns what it says.
fn run(grbl: &mut Grbl, inputs: GrblInputs) -> Vec<u8> {
    let mut said = Vec::new();
    for _ in 0..500 {
        if grbl.next_event(0, &inputs).is_some() {
            grbl.made(0, 1);
        }
        said.extend(std::iter::from_fn(|| grbl.transmit()));
    }
    said
}

#[test]
fn a_limit_that_is_touched_at_rest_is_an_alarm() {
    let options = GrblOptions {
        reads_inputs: true,
        ..GrblOptions::FULL
    };
    let mut grbl: Grbl = Grbl::new(options, Some(&GrblMemory::FACTORY));
    let open = GrblInputs::default();
    run(&mut grbl, open);
    for byte in b"$21=1\n" {
        grbl.receive(*byte);
    }
    assert_eq!(run(&mut grbl, open), b"ok\r\n");
    let closed = GrblInputs {
        limits: [false, true, true],
        ..open
    };
    assert!(run(&mut grbl, closed).starts_with(b"ALARM:1\r\n"));
}

#[test]
fn only_a_controller_that_reads_its_inputs_gives_waits_at_rest() {
    for reads_inputs in [false, true] {
        let options = GrblOptions {
            reads_inputs,
            ..GrblOptions::FULL
        };
        let mut grbl: Grbl = Grbl::new(options, Some(&GrblMemory::FACTORY));
        run(&mut grbl, GrblInputs::default());
        let waits = grbl.next_event(0, &GrblInputs::default()).is_some();
        assert_eq!(waits, reads_inputs);
    }
}
