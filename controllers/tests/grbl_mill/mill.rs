//! A Grbl controller with its machine, in simulated time, and a record of its events.

use husillo_controllers::{Grbl, GrblEvent, GrblMemory, GrblOptions};
use husillo_sim::{Emulated, GrblRig};
use husillo_transports::grbl::Settings;

/// Time between two readings of what the controller says, us.
const SLICE_US: u64 = 100;

pub struct Mill<const QUEUE: usize = 15> {
    pub emulated: Emulated<Grbl<QUEUE>, GrblRig>,
    /// What the controller has said.
    pub said: String,
    /// The events, without waits, and their times in us.
    pub events: Vec<(u64, GrblEvent)>,
}

impl<const QUEUE: usize> Mill<QUEUE> {
    /// Switches a mill on. Its settings differ from the defaults by these.
    pub fn new(options: GrblOptions, changes: &[(u8, &str)]) -> Self {
        let mut settings = Settings::DEFAULT;
        for (number, value) in changes {
            settings.write(*number, value.as_bytes()).unwrap();
        }
        let memory = GrblMemory::FACTORY.with_settings(settings);
        let grbl = Grbl::new(options, Some(&memory));
        let mut mill = Mill {
            emulated: Emulated::new(grbl, vec![GrblRig::new()]),
            said: String::new(),
            events: Vec::new(),
        };
        mill.pass(1_000_000);
        mill.forget();
        mill
    }

    /// Forgets what was said, and the events.
    pub fn forget(&mut self) {
        self.said.clear();
        self.events.clear();
    }

    pub fn send(&mut self, text: &str) {
        self.send_bytes(text.as_bytes());
    }

    pub fn send_bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.emulated.receive(*byte);
        }
    }

    /// Reads what the controller says.
    pub fn hear(&mut self) {
        let said = std::iter::from_fn(|| self.emulated.transmit());
        self.said.extend(said.map(char::from));
    }

    /// Lets time pass.
    pub fn pass(&mut self, us: u64) {
        let end = self.emulated.now_us() + us;
        while self.emulated.now_us() < end {
            self.hear();
            self.pass_unheard(SLICE_US.min(end - self.emulated.now_us()));
        }
        self.hear();
    }

    /// Lets time pass while nothing is read from the controller.
    pub fn pass_unheard(&mut self, us: u64) {
        let events = &mut self.events;
        self.emulated.pass(us, |_, at_us, event, _| {
            if !matches!(event, GrblEvent::Wait { .. }) {
                events.push((at_us, *event));
            }
        });
    }

    /// Executes lines, and returns what is said within a time.
    pub fn answer(&mut self, text: &str, us: u64) -> String {
        self.said.clear();
        self.send(text);
        self.pass(us);
        self.said.clone()
    }

    /// Returns the state and the fields of a report.
    pub fn report(&mut self) -> String {
        self.answer("?", 1000)
    }

    pub fn rig(&mut self) -> &mut GrblRig {
        self.emulated.plant_mut(0).unwrap()
    }

    /// Returns the number of lines that were accepted.
    pub fn oks(&self) -> usize {
        self.said.lines().filter(|line| *line == "ok").count()
    }

    /// Returns the duty cycles of the spindle that were sent.
    pub fn duties(&self) -> Vec<u8> {
        let duty = |(_, event): &(u64, GrblEvent)| match event {
            GrblEvent::SpindleDuty { duty } => Some(*duty),
            _ => None,
        };
        self.events.iter().filter_map(duty).collect()
    }
}
