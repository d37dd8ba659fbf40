//! An oscilloscope: pins, ports and delays that record when they are written.
#![allow(dead_code)]

use core::convert::Infallible;
use core::marker::PhantomData;
use std::cell::{Cell, RefCell};

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{Error, ErrorKind, ErrorType, OutputPin};
use husillo_stepper::{Port, PulseNanoseconds};

/// Nanoseconds, the number of a pin, its level.
pub type Edge = (u64, usize, bool);

#[derive(Default)]
pub struct Scope {
    now_ns: Cell<u64>,
    edges: RefCell<Vec<Edge>>,
    taken: RefCell<Vec<Edge>>,
    failing: Cell<Option<usize>>,
}

impl Scope {
    /// The writes since the last call.
    pub fn take(&self) -> Vec<Edge> {
        let edges = self.edges.take();
        self.taken.borrow_mut().extend(&edges);
        edges
    }

    /// All writes.
    pub fn all(&self) -> Vec<Edge> {
        self.take();
        self.taken.borrow().clone()
    }

    /// Rises of a pin that was low at first.
    pub fn rising_edges(&self, pin: usize) -> usize {
        let levels = self.all().into_iter().filter(|edge| edge.1 == pin);
        let mut before = false;
        levels
            .filter(|(_, _, level)| std::mem::replace(&mut before, *level) != *level && *level)
            .count()
    }

    pub fn pass(&self, ns: u32) {
        self.now_ns.set(self.now_ns.get() + u64::from(ns));
    }

    /// The next write of a pin fails.
    pub fn fail(&self, pin: usize) {
        self.failing.set(Some(pin));
    }

    /// A pin of another type.
    pub fn other_pin(&self, number: usize) -> Pin<'_, Broken> {
        Pin::new(number, self)
    }

    fn write(&self, pin: usize, level: bool) -> Result<(), Broken> {
        if self.failing.get() == Some(pin) {
            self.failing.set(None);
            return Err(Broken);
        }
        let now_ns = self.now_ns.get();
        self.edges.borrow_mut().push((now_ns, pin, level));
        Ok(())
    }
}

#[derive(Debug, PartialEq)]
pub struct Broken;

impl Error for Broken {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

/// A pin with the error type `E`.
pub struct Pin<'a, E>(usize, &'a Scope, PhantomData<E>);

impl<'a, E> Pin<'a, E> {
    pub fn new(number: usize, scope: &'a Scope) -> Self {
        Pin(number, scope, PhantomData)
    }

    pub fn number(&self) -> usize {
        self.0
    }
}

impl<E: Error> ErrorType for Pin<'_, E> {
    type Error = E;
}

impl OutputPin for Pin<'_, Infallible> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.1.write(self.0, false).expect("this pin never fails");
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.1.write(self.0, true).expect("this pin never fails");
        Ok(())
    }
}

impl OutputPin for Pin<'_, Broken> {
    fn set_low(&mut self) -> Result<(), Broken> {
        self.1.write(self.0, false)
    }

    fn set_high(&mut self) -> Result<(), Broken> {
        self.1.write(self.0, true)
    }
}

/// The clock of the scope, as a delay.
pub struct Clock<'a>(pub &'a Scope);

impl DelayNs for Clock<'_> {
    fn delay_ns(&mut self, ns: u32) {
        self.0.pass(ns);
    }
}

/// A port that records its writes.
#[derive(Default)]
pub struct Recorder {
    pub writes: Vec<(u32, u32)>,
    /// The next write fails.
    pub fails: bool,
}

impl Port for Recorder {
    type Error = Broken;

    fn write(&mut self, high: u32, low: u32) -> Result<(), Broken> {
        assert_eq!(high & low, 0);
        if std::mem::take(&mut self.fails) {
            return Err(Broken);
        }
        self.writes.push((high, low));
        Ok(())
    }
}

/// What a driver sees at the pins STEP, DIR and ENABLE (low is on): its position in steps. Panics
/// where a time is too short. Levels before the first write are unknown.
pub fn position(edges: &[Edge], pins: [usize; 3], times: PulseNanoseconds, enable_ns: u32) -> i64 {
    let mut levels = [None; 3];
    let mut since_ns = [0; 3];
    let mut position = 0;
    let mut rise_ns = None;
    for (now_ns, pin, level) in edges {
        let Some(input) = pins.iter().position(|number| number == pin) else {
            continue;
        };
        if levels[input] == Some(*level) {
            continue;
        }
        let before = levels[input].replace(*level);
        let lasted_ns = now_ns - std::mem::replace(&mut since_ns[input], *now_ns);
        match (input, before, *level) {
            (0, None, true) => panic!("the first level of STEP is high"),
            (0, Some(_), true) => {
                assert!(lasted_ns >= times.low.into(), "low for {lasted_ns} ns");
                let stable_ns = now_ns - since_ns[1];
                assert!(stable_ns >= times.setup.into(), "set up for {stable_ns} ns");
                let enabled_ns = now_ns - since_ns[2];
                assert_eq!(levels[2], Some(false), "a step of a disabled driver");
                assert!(enabled_ns >= enable_ns.into(), "on for {enabled_ns} ns");
                position += if levels[1] == Some(true) { 1 } else { -1 };
                rise_ns = Some(*now_ns);
            }
            (0, Some(_), false) => {
                assert!(lasted_ns >= times.high.into(), "high for {lasted_ns} ns");
            }
            (1, Some(_), _) => {
                let held_ns = rise_ns.map_or(u64::MAX, |rise_ns| now_ns - rise_ns);
                assert!(held_ns >= times.hold.into(), "held for {held_ns} ns");
            }
            _ => {}
        }
    }
    position
}
