//! A controller from outside the project, run by the code that runs any controller.

use husillo_controllers::{Controller, Timed};
use husillo_sim::{Emulated, Plant};

// ANCHOR: controller
/// One axis. `R` and a byte move it by that many steps, `S` stops it. It answers `.` at the end.
#[derive(Default)]
struct Slide {
    begun: bool,
    left: u8,
    given: usize,
    out: Vec<u8>,
}

/// A step, or the lamp that shows standstill.
enum SlideEvent {
    Step,
    Lamp,
}

impl Timed for SlideEvent {
    fn wait_ticks(&self) -> Option<u32> {
        matches!(self, SlideEvent::Step).then_some(1000)
    }
}

impl Controller for Slide {
    /// The end switch.
    type Inputs = bool;
    type Event = SlideEvent;
    type Stops = ();

    fn receive(&mut self, byte: u8) -> bool {
        match byte {
            _ if self.begun => (self.begun, self.left) = (false, byte),
            b'R' => self.begun = true,
            b'S' => return true,
            _ => {}
        }
        false
    }

    fn stops(&self) {}

    fn halted(&mut self) {
        (self.left, self.given) = (0, 0);
        self.out.push(b'!');
    }

    fn next_event(&mut self, machine: u8, is_at_end: &bool) -> Option<SlideEvent> {
        if machine > 0 || self.left == 0 {
            return None;
        }
        if *is_at_end {
            self.left = 0;
            self.out.push(b'E');
            return Some(SlideEvent::Lamp);
        }
        self.left -= 1;
        self.given += 1;
        Some(SlideEvent::Step)
    }

    fn made(&mut self, _: u8, events: usize) {
        self.given -= events;
        if self.left == 0 && self.given == 0 {
            self.out.push(b'.');
        }
    }

    fn transmit(&mut self) -> Option<u8> {
        (!self.out.is_empty()).then(|| self.out.remove(0))
    }

    fn reset(&mut self) {
        *self = Self::default();
    }
}
// ANCHOR_END: controller

// ANCHOR: plant
/// Steps of the slide, and whether its lamp is lit. The end switch closes at 40.
#[derive(Default)]
struct Rail {
    at: i32,
    is_lit: bool,
}

impl Plant for Rail {
    type Inputs = bool;
    type Event = SlideEvent;

    fn inputs(&self) -> bool {
        self.at >= 40
    }

    fn apply(&mut self, event: &SlideEvent) {
        match event {
            SlideEvent::Step => self.at += 1,
            SlideEvent::Lamp => self.is_lit = true,
        }
    }
}
// ANCHOR_END: plant

fn answers(emulated: &mut Emulated<Slide, Rail>) -> String {
    std::iter::from_fn(|| emulated.transmit().map(char::from)).collect()
}

// ANCHOR: emulated
#[test]
fn a_foreign_controller_is_emulated() {
    let mut emulated = Emulated::new(Slide::default(), vec![Rail::default()]);
    let mut times = Vec::new();
    emulated.receive(b'R');
    emulated.receive(3);
    for _ in 0..5 {
        emulated.pass(1000, |machine, at_us, _, _| times.push((machine, at_us)));
    }
    assert_eq!(times, [(0, 1000), (0, 2000), (0, 3000)]);
    assert_eq!(answers(&mut emulated), ".");
    assert_eq!(emulated.plant(0).map(|rail| rail.at), Some(3));
}
// ANCHOR_END: emulated

#[test]
fn a_stop_drops_the_event_that_waits() {
    let mut emulated = Emulated::new(Slide::default(), vec![Rail::default()]);
    emulated.receive(b'R');
    emulated.receive(9);
    emulated.pass(2500, |_, _, _, _| {});
    emulated.receive(b'S');
    emulated.pass(9000, |_, _, _, _| panic!("it has stopped"));
    assert_eq!(answers(&mut emulated), "!");
    assert_eq!(emulated.plant(0).map(|rail| rail.at), Some(2));
}

#[test]
fn inputs_are_those_after_the_last_event() {
    let mut emulated = Emulated::new(Slide::default(), vec![Rail::default()]);
    emulated.receive(b'R');
    emulated.receive(200);
    emulated.pass(1_000_000, |_, _, _, _| {});
    let rail = emulated.plant(0).map(|rail| (rail.at, rail.is_lit));
    assert_eq!(rail, Some((40, true)));
    assert_eq!(answers(&mut emulated), "E");
}
