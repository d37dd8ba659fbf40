//! The simulated runs that JavaScript holds.

use husillo_simulator::job::{Job, JobError, Steps};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// A run: its scene, and its steps when they are first asked for.
#[derive(Debug)]
pub struct Held {
    pub job: Job,
    pub scene: Vec<u8>,
    pub compensation: bool,
    pub worn: bool,
    steps: Option<Steps>,
}

impl Held {
    pub const fn new(job: Job, scene: Vec<u8>, compensation: bool, worn: bool) -> Self {
        Self {
            job,
            scene,
            compensation,
            worn,
            steps: None,
        }
    }

    /// Its steps. The first call runs the program.
    pub fn steps(&mut self) -> Result<&mut Steps, JobError> {
        let made = match self.steps.take() {
            Some(steps) => steps,
            None => Steps::new(self.job.clone(), self.compensation, self.worn)?,
        };
        Ok(self.steps.insert(made))
    }
}

thread_local! {
    static RUNS: RefCell<(u32, BTreeMap<u32, Held>)> = const {
        RefCell::new((0, BTreeMap::new()))
    };
}

/// Keeps a run. Returns its number.
pub fn keep(run: Held) -> u32 {
    RUNS.with(|runs| {
        let (last, all) = &mut *runs.borrow_mut();
        *last += 1;
        all.insert(*last, run);
        *last
    })
}

/// Uses a run. `None`: it was closed.
pub fn with<T>(number: u32, of: impl FnOnce(&mut Held) -> T) -> Option<T> {
    RUNS.with(|runs| runs.borrow_mut().1.get_mut(&number).map(of))
}

/// Frees a run.
pub fn close(number: u32) {
    RUNS.with(|runs| runs.borrow_mut().1.remove(&number));
}
