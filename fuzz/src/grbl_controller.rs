//! Any bytes and any switches for a Grbl controller that moves.

use husillo_controllers::{
    Controller, Grbl, GrblEvent, GrblInputs, GrblMemory, GrblOptions, Timed,
};
use husillo_transports::grbl::Message;

/// Longest wait of an event: inputs are read at least as often.
const LONGEST_US: u32 = 1000;
/// Most events that are made between two bytes.
const MOST_EVENTS: u32 = 400;

/// The protocol of Grbl, with the height map.
///
/// Bytes 1 to 15, which are no characters of Grbl's link, change a switch or let time pass. All
/// others are sent.
///
/// - A step changes the reported position by itself, also with inverted directions and with a
///   height map. Nothing else changes it while an event is made.
/// - No axis moves between a limit alarm and the next start.
/// - An event waits for 1 ms at most.
/// - A line has one answer at most, and a controller that is reset with all switches open answers.
/// - The memory that is kept is read back unchanged.
pub fn grbl_controller(data: &[u8]) {
    session(GrblOptions::FULL, data);
}

/// The same with the protocol of grblHAL: tools, lists, and a reset that brakes.
pub fn grblhal_controller(data: &[u8]) {
    session(GrblOptions::HAL, data);
}

fn session(options: GrblOptions, data: &[u8]) {
    let mut run = Run {
        grbl: Grbl::new(options, Some(&GrblMemory::FACTORY)),
        inputs: GrblInputs::default(),
        said: Vec::new(),
        answers: 0,
        is_locked: false,
    };
    run.make(MOST_EVENTS);
    let mut ends = 0;
    for byte in data {
        match byte {
            1..=8 => run.toggle(*byte),
            9 | 11 | 12 | 14 | 15 => run.make(MOST_EVENTS),
            _ => {
                ends += u32::from(matches!(byte, b'\r' | b'\n'));
                run.send(*byte);
                run.make(4);
            }
        }
    }
    assert!(
        run.answers <= ends,
        "{} answers to {ends} lines",
        run.answers
    );
    run.inputs = GrblInputs::default();
    // A door that is closed is seen at the next event. If it was open at the start, `~` is awaited.
    run.make(4);
    run.send(0x18);
    run.said.clear();
    run.is_locked = false;
    run.make(20_000);
    for byte in b"\n$$\n" {
        run.send(*byte);
    }
    run.make(20_000);
    assert!(run.answers > 0, "silent after a reset");
}

struct Run {
    grbl: Grbl<4>,
    inputs: GrblInputs,
    /// The line that is being received from it.
    said: Vec<u8>,
    answers: u32,
    /// A limit alarm was reported, and no start after it.
    is_locked: bool,
}

impl Run {
    fn toggle(&mut self, number: u8) {
        let inputs = &mut self.inputs;
        let [x, y, z] = &mut inputs.limits;
        let pin = match number {
            1 => x,
            2 => y,
            3 => z,
            4 => &mut inputs.probe,
            5 => &mut inputs.door,
            6 => &mut inputs.hold,
            7 => &mut inputs.start,
            _ => &mut inputs.reset,
        };
        *pin = !*pin;
    }

    fn send(&mut self, byte: u8) {
        if self.grbl.receive(byte) {
            self.grbl.halted();
        }
    }

    /// Makes events until nothing is due.
    fn make(&mut self, most: u32) {
        for _ in 0..most {
            self.listen();
            let Some(event) = self.grbl.next_event(0, &self.inputs) else {
                break;
            };
            if event == GrblEvent::Store {
                let memory = self.grbl.memory();
                assert_eq!(GrblMemory::from_bytes(&memory.to_bytes()), Some(*memory));
            }
            self.check(&event);
        }
        self.listen();
    }

    fn check(&mut self, event: &GrblEvent) {
        let Some(wait_us) = event.wait_ticks() else {
            return;
        };
        assert!(wait_us <= LONGEST_US);
        let mut steps = [0_i8; 3];
        if let GrblEvent::Step { delta, .. } = event {
            let inverted = self.grbl.memory().settings().whole(3);
            for (axis, delta) in delta.iter().enumerate() {
                steps[axis] = if inverted >> axis & 1 == 1 {
                    -delta
                } else {
                    *delta
                };
            }
            assert!(!self.is_locked, "a step after a limit alarm");
            assert_ne!(steps, [0; 3], "a step of no axis");
        }
        let before = self.grbl.position_steps();
        self.grbl.made(0, 1);
        let after = self.grbl.position_steps();
        for axis in 0..3 {
            assert_eq!(
                after[axis].wrapping_sub(before[axis]),
                i32::from(steps[axis])
            );
        }
    }

    /// Reads its lines.
    fn listen(&mut self) {
        while let Some(byte) = self.grbl.transmit() {
            if byte != b'\n' {
                self.said.push(byte);
                continue;
            }
            let line = std::mem::take(&mut self.said);
            let line = line.strip_suffix(b"\r").unwrap_or(&line);
            match Message::parse(line) {
                Some(message) if message.is_answer() => self.answers += 1,
                Some(Message::Alarm(alarm)) => self.is_locked = alarm.number() <= 2,
                Some(Message::Banner(_)) => self.is_locked = false,
                _ => {}
            }
        }
    }
}
