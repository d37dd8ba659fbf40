//! A figure: it is stored in the controller, which feeds Y until the tool touches, and cuts it.

use super::Driver;
use super::cutting::Cutting;
use crate::serve::console_lines::From;
use crate::serve::driver::course::{Course, Progress};
use crate::serve::driver::phase::Phase;
use crate::serve::loaded::Loaded;
use crate::serve::reply::Reply;
use crate::serve::tool_path::Motion as Drawn;
use husillo_clients::microfactory::Motion;
use husillo_sim::text::counted;
use husillo_transports::microfactory::Report;
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Duration;

/// Moves that are stored before requests are looked at: 45 ms.
const AT_ONCE: usize = 4;
/// What happens before the first move.
const APPROACH: &str = "Y is fed until the tool touches the work piece, then the figure is cut";
/// Tries to store a figure on a noisy line.
const TRIES: u8 = 3;

/// The figure of a microfactory.
#[derive(Debug, Default)]
pub(super) struct Running {
    pub(super) course: Course,
    pub(super) cutting: Cutting,
    storing: Option<Storing>,
    /// Steps of the motors at its begin; those of Y at the contact.
    begin: [i32; 4],
    /// Time of the link when the run was looked at.
    looked_at: Duration,
    /// Time of the link at the last position.
    placed_at: Duration,
}

/// A figure that is being stored.
#[derive(Debug)]
struct Storing {
    /// Moves that the controller has got. None: it has not forgotten the figure before.
    sent: Option<usize>,
    attempt: u8,
}

impl Running {
    /// Moves that the controller has got, while it gets them.
    pub(super) fn stored(&self) -> Option<usize> {
        self.storing.as_ref().map(|one| one.sent.unwrap_or(0))
    }

    /// Steps of the motors at the begin of the figure; those of Y at the contact.
    pub(super) const fn begin_steps(&self) -> [i32; 4] {
        self.begin
    }

    /// The moves of the loaded figure.
    fn moves(&self) -> &[[i16; 2]] {
        let program = self.course.program();
        let figure = program.and_then(|program| program.figure.as_deref());
        figure.unwrap_or_default()
    }

    /// The line of the program whose move is cut.
    pub(super) fn line(&self) -> Option<usize> {
        let program = self.course.program().filter(|_| self.course.is_active())?;
        let (line, _) = program.lines.get(self.cutting.made())?;
        Some(*line)
    }

    /// The first move that is not cut to its end.
    fn next(&self) -> Option<usize> {
        let made = self.cutting.made();
        (made < self.cutting.count()).then_some(made + 1)
    }
}

impl Driver<'_> {
    /// Takes over a figure that was checked.
    ///
    /// # Errors
    ///
    /// Another one is cut.
    pub(super) fn load(&mut self, program: Arc<Loaded>) -> Result<(), &'static str> {
        if self.running.course.is_active() {
            return Err("a figure is cut: stop it first");
        }
        let moves = program.figure.as_deref().unwrap_or_default();
        let cutting = Cutting::new(moves, &self.factory.settings.config);
        let mut course = std::mem::take(&mut self.running.course);
        course.load(self.machine, program);
        *self.running = Running {
            course,
            cutting,
            ..Running::default()
        };
        Ok(())
    }

    /// Forgets the figure.
    ///
    /// # Errors
    ///
    /// It is cut.
    pub(super) fn unload(&mut self) -> Result<(), &'static str> {
        if self.running.course.is_active() {
            return Err("a figure is cut: stop it first");
        }
        let mut course = std::mem::take(&mut self.running.course);
        course.unload(self.machine);
        *self.running = Running {
            course,
            ..Running::default()
        };
        Ok(())
    }

    /// Stores and cuts the figure, or tells what would happen.
    pub(super) fn run(&mut self, is_confirmed: bool, reply: Reply) {
        let program = match self.may_run() {
            Ok(program) => program,
            Err(why) => return reply.error(why),
        };
        let cutting = Cutting::new(self.running.moves(), &self.factory.settings.config);
        if !is_confirmed {
            return reply.data(json!({
                "name": program.name,
                "lines": program.count,
                "time_s": cutting.total_s(),
                "from": null,
                "warnings": [APPROACH],
            }));
        }
        let mut course = std::mem::take(&mut self.running.course);
        course.start(self.machine, program, None);
        let storing = Storing {
            sent: None,
            attempt: 1,
        };
        *self.running = Running {
            course,
            cutting,
            storing: Some(storing),
            begin: self.status.position_steps,
            looked_at: self.client.elapsed(),
            ..Running::default()
        };
        self.has_contact = false;
        reply.ok();
    }

    fn may_run(&self) -> Result<Arc<Loaded>, String> {
        self.is_free()?;
        let program = self.running.course.program().cloned();
        let program = program.ok_or("no figure is loaded")?;
        if program.errors > 0 {
            return Err("the figure has errors: correct them first".into());
        }
        match self.status.is_homed {
            true => Ok(program),
            false => Err("home the machine first: the side of its backlash is unknown".into()),
        }
    }

    /// Stores the next moves of the figure, and begins to cut it after the last one.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn store(&mut self) -> Result<(), String> {
        let Some(storing) = &mut self.running.storing else {
            return Ok(());
        };
        let sent = storing.sent;
        match self.store_from(sent) {
            Ok(sent) if sent < self.running.cutting.count() => {
                if let Some(storing) = &mut self.running.storing {
                    storing.sent = Some(sent);
                }
                Ok(())
            }
            Ok(sent) => {
                self.running.storing = None;
                let text = format!("{} stored", counted(sent, "move"));
                self.machine.tell(From::Controller, text);
                self.status = self.client.status()?;
                self.running.begin = self.status.position_steps;
                self.draw(Drawn::Begin);
                self.begin(Motion::Figure, None)
            }
            Err(why) => self.store_again(&why),
        }
    }

    /// Stores a few moves. Returns how many are stored.
    fn store_from(&mut self, sent: Option<usize>) -> Result<usize, String> {
        let Some(sent) = sent else {
            self.client.clear_figure()?;
            return Ok(0);
        };
        let moves = self.running.moves();
        let part = moves.iter().skip(sent).take(AT_ONCE);
        for delta in part {
            self.client.store_move(*delta)?;
        }
        let sent = moves.len().min(sent + AT_ONCE);
        if sent == moves.len() {
            self.client.keep_figure(moves)?;
        }
        Ok(sent)
    }

    /// The line has failed. What was stored half is not cut.
    fn store_again(&mut self, why: &str) -> Result<(), String> {
        self.status = self.client.halt()?;
        if self.look_at_latch()? {
            return Ok(());
        }
        let Some(storing) = &mut self.running.storing else {
            return Ok(());
        };
        storing.sent = None;
        storing.attempt += 1;
        if storing.attempt > TRIES {
            self.running.storing = None;
            let why = format!("the figure is not stored: {why}");
            self.figure_ended(Err(why));
        } else {
            let text = format!("the figure is stored again: {why}");
            self.machine.tell(From::Server, text);
        }
        Ok(())
    }

    /// Looks which move is cut.
    pub(super) fn cut(&mut self) {
        let now = self.client.elapsed();
        let passed = now.saturating_sub(std::mem::replace(&mut self.running.placed_at, now));
        // The report is that of the contact until the figure ends.
        if !self.has_contact && self.status.report == Some(Report::Contact) {
            self.has_contact = true;
            let [_, y, ..] = self.status.position_steps;
            self.running.begin[1] = y;
            self.draw(Drawn::Rapid);
            self.machine
                .tell(From::Controller, "the tool touches: the figure begins");
        }
        if self.has_contact {
            let [x, _, z, _] = self.status.position_steps;
            let [begin_x, _, begin_z, _] = self.running.begin;
            let at = [x.wrapping_sub(begin_x), z.wrapping_sub(begin_z)];
            self.running.cutting.at(at, passed.as_secs_f64());
        }
    }

    /// The figure is cut, or has failed.
    pub(super) fn figure_ended(&mut self, result: Result<(), String>) {
        let running = &mut *self.running;
        match result {
            Ok(()) => {
                // A very short figure may begin and end between two questions.
                self.has_contact = true;
                running.cutting.done();
                let message = format!("{} cut", counted(running.cutting.count(), "move"));
                running.course.done(self.machine, message);
            }
            Err(why) => {
                let next = running.next();
                running.course.fail(self.machine, &why, next);
            }
        }
    }

    /// STOP was pressed.
    pub(super) fn stop_figure(&mut self) {
        self.running.storing = None;
        let next = self.running.next();
        self.running.course.stop(next);
    }

    /// The machine stands after a stop, or the controller is lost.
    pub(super) fn end_figure(&mut self, why: &str) {
        self.running.storing = None;
        let next = self.running.next();
        self.running.course.end(self.machine, why, next);
    }

    /// Notes what has changed in a run, and publishes its record when it has ended.
    pub(super) fn note_run(&mut self) {
        let running = &mut *self.running;
        let (made, count) = (running.cutting.made(), running.cutting.count());
        let number = (made + 1).min(count.max(1));
        let phase = running.course.phase().name();
        let machine = self.machine;
        running
            .course
            .note(machine, phase, [number; 2], [made, count]);
    }

    /// The figure in the state of the machine. Its moves are what others call lines.
    pub(super) fn figure_shown(&mut self) -> Option<Value> {
        let now = self.client.elapsed();
        let running = &mut *self.running;
        let program = Arc::clone(running.course.program()?);
        let passed = now.saturating_sub(std::mem::replace(&mut running.looked_at, now));
        if running.course.phase() == Phase::Running && running.storing.is_none() {
            running.course.elapsed += passed;
        }
        let total_s = running.cutting.total_s();
        let total_s = (program.errors == 0 && total_s > 0.0).then_some(total_s);
        let left_s = running.cutting.left_s();
        let (made, count) = (running.cutting.made(), running.cutting.count());
        let next = running.next();
        running.course.shown(&Progress {
            phase: running.course.phase().name(),
            line: next.or((made > 0).then_some(made)),
            sent: running.stored().unwrap_or(count),
            answered: made,
            of: program.count,
            time_s: total_s,
            remaining_s: total_s.map(|_| left_s),
            progress: total_s.map(|total_s| 1.0 - left_s / total_s),
            next,
        })
    }
}
