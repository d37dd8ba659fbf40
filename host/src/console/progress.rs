//! A line on the terminal that shows the progress of a long command.

use super::is_smart;
use husillo_simulator::programs::watch::Watch;
use indicatif::{ProgressBar, ProgressStyle};
use std::cell::RefCell;
use std::io;

/// Units of work between two updates.
const UPDATE: u64 = Watch::UPDATE;

/// Shows the progress while a program is read.
pub fn reading() -> Watch {
    let template = "Reading {human_pos} blocks and commands; Ctrl-C ends";
    let progress = RefCell::new(Progress::new(template, None));
    Watch::new(move || progress.borrow_mut().update())
}

/// The progress of a command. It is shown from the first update on.
#[derive(Clone, Debug)]
pub struct Progress {
    template: &'static str,
    /// Approximate number of units, if it is known.
    all: Option<u64>,
    bar: Option<ProgressBar>,
    countdown: u64,
}

impl Progress {
    /// Work that is shown by a template of `indicatif`.
    pub fn new(template: &'static str, all: Option<u64>) -> Self {
        Self {
            template,
            all,
            bar: None,
            countdown: UPDATE,
        }
    }

    /// A unit of work is done.
    #[inline]
    pub fn step(&mut self) {
        self.countdown -= 1;
        if self.countdown == 0 {
            self.countdown = UPDATE;
            self.update();
        }
    }

    #[cold]
    fn update(&mut self) {
        let bar = self.bar.get_or_insert_with(|| {
            let bar = match (is_smart(&io::stderr()), self.all) {
                (true, Some(all)) => ProgressBar::new(all),
                (true, None) => ProgressBar::new_spinner(),
                (false, _) => ProgressBar::hidden(),
            };
            if let Ok(style) = ProgressStyle::with_template(self.template) {
                bar.set_style(style.progress_chars("=> "));
            }
            bar
        });
        bar.inc(UPDATE);
    }
}

impl Drop for Progress {
    /// Removes the line.
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
