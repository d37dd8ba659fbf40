//! Entries in memory: each in six bytes, with the machine at every 1024th.

use super::{Begin, Instant};
use crate::simulation::mechanics::Mechanics;
use husillo_machine::StepEvent;
use husillo_sim::observers::AXES;

/// Entries between two marks.
const SPACING: usize = 1024;
/// Bits of an axis in the deltas of an entry: whether it steps, and whether forward.
const BITS: u32 = 2;
/// The step takes up backlash.
const TAKE_UP: u16 = 1 << 14;
/// There is no step.
const WAIT: u16 = 1 << 15;

/// A step event, or a wait without one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    wait_ticks: u32,
    bits: u16,
}

impl Entry {
    /// A step.
    pub fn step(step: &StepEvent<AXES>, is_take_up: bool) -> Self {
        let mut bits = if is_take_up { TAKE_UP } else { 0 };
        for (axis, delta) in (0..).zip(step.delta) {
            let own = match delta {
                0 => 0,
                1.. => 0b11,
                _ => 0b01,
            };
            bits |= own << (BITS * axis);
        }
        Self {
            wait_ticks: step.wait_ticks,
            bits,
        }
    }

    /// A wait.
    pub const fn wait(wait_ticks: u32) -> Self {
        Self {
            wait_ticks,
            bits: WAIT,
        }
    }

    const fn is_step(self) -> bool {
        self.bits & WAIT == 0
    }

    const fn is_take_up(self) -> bool {
        self.bits & TAKE_UP != 0
    }

    fn delta(self) -> [i8; AXES] {
        std::array::from_fn(|axis| match self.bits >> (BITS * axis as u32) & 0b11 {
            0b11 => 1,
            0b01 => -1,
            _ => 0,
        })
    }

    /// Makes it on the simulated machine.
    #[inline]
    pub fn make(self, mechanics: &mut Mechanics, commanded: &mut [i32; AXES]) {
        if !self.is_step() {
            return mechanics.rest(self.wait_ticks);
        }
        let delta = self.delta();
        mechanics.step(&StepEvent {
            wait_ticks: self.wait_ticks,
            delta,
        });
        if !self.is_take_up() {
            for (at, delta) in commanded.iter_mut().zip(delta) {
                *at += i32::from(delta);
            }
        }
    }
}

/// The machine before an entry.
#[derive(Clone, Debug)]
struct Mark {
    at: Begin,
    mechanics: Mechanics,
    commanded: [i32; AXES],
}

/// Entries as columns.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rows {
    /// Ticks between the entry before and this one.
    pub wait_ticks: Vec<u32>,
    /// Step of each axis, -1, 0 or 1: the axes of the first entry, then those of the second. A wait
    /// has zeros.
    pub delta: Vec<i8>,
}

/// Entries that follow each other.
#[derive(Debug)]
pub struct Window {
    marks: Vec<Mark>,
    waits: Vec<u32>,
    bits: Vec<u16>,
}

impl Window {
    /// No entry, with the machine before the first one.
    pub fn new(mechanics: Mechanics, commanded: [i32; AXES], at: Begin) -> Self {
        Self {
            marks: vec![Mark {
                at,
                mechanics,
                commanded,
            }],
            waits: Vec::new(),
            bits: Vec::new(),
        }
    }

    /// Where it begins.
    pub fn begin(&self) -> Begin {
        self.marks[0].at
    }

    /// Adds an entry, with the machine before it.
    #[inline]
    pub fn push(&mut self, entry: Entry, mechanics: &Mechanics, commanded: [i32; AXES], at: Begin) {
        if self.bits.len().is_multiple_of(SPACING) && !self.bits.is_empty() {
            self.marks.push(Mark {
                at,
                mechanics: mechanics.clone(),
                commanded,
            });
        }
        self.waits.push(entry.wait_ticks);
        self.bits.push(entry.bits);
    }

    fn entry(&self, index: usize) -> Option<Entry> {
        Some(Entry {
            wait_ticks: *self.waits.get(index)?,
            bits: *self.bits.get(index)?,
        })
    }

    /// The machine after the step event of this number.
    pub fn at_event(&self, event: u64) -> Instant {
        let mark = self.marks.partition_point(|mark| mark.at.event < event);
        self.walk(mark, |mechanics, entry| {
            mechanics.events() < event && entry.is_some()
        })
    }

    /// The machine at a time.
    pub fn at_ticks(&self, ticks: u64) -> Instant {
        let mark = self.marks.partition_point(|mark| mark.at.ticks <= ticks);
        let mut instant = self.walk(mark, |mechanics, entry| {
            entry.is_some_and(|entry| mechanics.ticks() + u64::from(entry.wait_ticks) <= ticks)
        });
        instant.ticks = ticks;
        instant
    }

    /// Makes entries again from the mark before number `mark` on, while there is one to make.
    fn walk(&self, mark: usize, is_to_make: impl Fn(&Mechanics, Option<Entry>) -> bool) -> Instant {
        let index = mark.saturating_sub(1);
        let Mark {
            mut mechanics,
            mut commanded,
            ..
        } = self.marks[index].clone();
        let mut next = index * SPACING;
        let mut is_take_up = next
            .checked_sub(1)
            .and_then(|before| self.entry(before))
            .is_some_and(Entry::is_take_up);
        while is_to_make(&mechanics, self.entry(next)) {
            let Some(entry) = self.entry(next) else { break };
            entry.make(&mut mechanics, &mut commanded);
            is_take_up = entry.is_take_up();
            next += 1;
        }
        Instant {
            event: mechanics.events(),
            ticks: mechanics.ticks(),
            commanded,
            tool: mechanics.tool(),
            levels: mechanics.levels().each_ref().map(|levels| levels.0),
            is_take_up,
        }
    }

    /// Up to `count` entries from number `from` of the program on.
    pub fn rows(&self, from: u64, count: usize, axes: usize) -> Rows {
        let from = from.saturating_sub(self.begin().entry) as usize;
        let from = from.min(self.bits.len());
        let end = from.saturating_add(count).min(self.bits.len());
        let entries = (from..end).filter_map(|index| self.entry(index));
        Rows {
            wait_ticks: self.waits[from..end].to_vec(),
            delta: entries
                .flat_map(|entry| entry.delta().into_iter().take(axes))
                .collect(),
        }
    }
}
