//! Sends a board over the link, tool by tool.

use super::client::{Client, ClientError};
use super::end::{End, Failed};
use super::held::holes_done;
use super::load::{Estimate, Load, MEMORY_RECORDS, loads_from};
use super::part::Part;
use super::place::Place;
use husillo_gcode::Nm;
use husillo_sim::text::counted;
use husillo_transports::drill::{Failure, MEMORY_BYTES, Record, Step};
use std::time::Duration;

/// The operator of the drill.
pub trait Operator {
    /// Shows a line.
    fn show(&mut self, line: &str);

    /// Asks for the next tool, with this diameter, while the spindle is at rest. Returns the
    /// diameter of the tool that is now in the spindle, mm. `None` ends the job.
    fn change(&mut self, tool: &str, diameter: Option<Nm>) -> Option<String>;

    /// Shows the progress: the share of the whole job, and the estimated seconds that remain.
    fn progress(&mut self, share: f64, left_s: f64);
}

/// A job: the holes of a board.
#[derive(Debug)]
pub struct Sender<'a, O> {
    /// The drill.
    pub client: Client,
    /// The person at the machine.
    pub operator: &'a mut O,
    /// The holes by tool, in the order in which they are drilled.
    pub parts: &'a [Part],
    /// The first hole to be drilled, from 0, counted through all parts.
    pub from: usize,
    /// Seconds of a byte and its echo.
    pub byte_s: f64,
    /// Whether homing is left out, because the drill reports that it is homed.
    pub is_homed: bool,
    /// Whether the questions for tools are left out.
    pub is_sure: bool,
    /// Reads a diameter that the operator typed.
    pub diameter: fn(&str) -> Option<Nm>,
}

/// End of a part.
enum Ended {
    /// Drilled, or started and detached.
    Well { is_detached: bool },
    /// Failed before the memory of the device was cleared. Nothing of the part is done. The counts
    /// of the link are those of the part before.
    Before(ClientError),
    /// Failed after the memory was cleared.
    After(ClientError),
}

impl<O: Operator> Sender<'_, O> {
    /// Sends the board and waits until it is drilled. With `detach` it returns as soon as the start
    /// is confirmed.
    ///
    /// # Errors
    ///
    /// The job is impossible. Nothing has moved.
    pub fn send(&mut self, detach: bool) -> Result<End, String> {
        let mut loads = self.loads(usize::MAX)?;
        if detach {
            expect_one(&loads)?;
        }
        if let Err(error) = self.client.reach() {
            return Ok(End::Unreached(error.unreached()));
        }
        if let Some(done) = self.already_drilled() {
            let why = format!(
                "the drill has drilled holes up to {done} of this program, by its own count. For \
                 another board: `husillo jog -m drill --port PORT clear` first"
            );
            return Ok(self.failed(why, done, done));
        }
        if self.client.has_lease() && !detach {
            // While a full memory runs, a host has to be silent. A host with a lease is never
            // silent, so each load must fit into the memory.
            loads = self.loads(MEMORY_RECORDS)?;
        }
        if !self.client.has_extras() {
            self.expect_fit_for_original(detach)?;
        }
        if self.is_homed {
            self.expect_homed()?;
        } else if let Err(error) = self.client.run_for(Step::Home, HOMING, |_| {}) {
            return Ok(self.failed(error.text(), self.from, self.from));
        }
        Ok(self.send_loads(&loads, detach))
    }

    /// Checks that an original drill can do the job, and tells the operator how it differs.
    ///
    /// # Errors
    ///
    /// The job needs a drill with extras. Nothing has moved.
    fn expect_fit_for_original(&mut self, detach: bool) -> Result<(), String> {
        if detach {
            return Err(
                "an original drill does not confirm its start: --detach is not possible".into(),
            );
        }
        if self.has_depths() {
            return Err(
                "this is an original drill: it ignores depths, and would drill through every hole"
                    .into(),
            );
        }
        self.operator.show(
            "this is an original drill: it switches its spindle for each hole, does not report \
             its progress, and continues when this program is gone",
        );
        Ok(())
    }

    /// Sends one load after the other.
    fn send_loads(&mut self, loads: &[Load], detach: bool) -> End {
        let mut estimate = Estimate::of(loads, self.byte_s);
        let several = loads.iter().filter(|load| load.is_first).count() > 1;
        let parts = self.parts;
        for (load, part) in loads
            .iter()
            .filter_map(|load| Some((load, parts.get(load.part)?)))
        {
            if several && load.is_first && !self.is_sure && !self.changed(part) {
                let why = format!("{} was not put in", part.name());
                return self.failed(why, load.before, load.before);
            }
            match self.one(load, detach, &mut estimate) {
                Ended::Well { is_detached: false } => {}
                Ended::Well { is_detached: true } => return End::Detached,
                Ended::Before(error) => {
                    return self.failed(error.text(), load.before, load.before);
                }
                Ended::After(error) => return self.stopped(load, error),
            }
            if load.is_last {
                let first = loads.iter().find(|first| first.part == load.part);
                let before = first.map_or(0, |first| first.before);
                let [holes, _] = load.holes([load.seconds.len(); 2]);
                let holes = counted(load.before + holes - before, "hole");
                self.operator
                    .show(&format!("{}: {holes} drilled", part.name()));
            }
        }
        End::Drilled
    }

    /// Checks that the drill reports that it is homed, and that its zero is at the switches.
    ///
    /// # Errors
    ///
    /// It does not report this. Nothing has moved.
    fn expect_homed(&mut self) -> Result<(), String> {
        match Place::read(&mut self.client) {
            Ok(place) if place.machine.is_homed && place.machine.zero_steps == [0; 2] => Ok(()),
            Ok(_) => {
                Err("the drill is not homed, or its zero is elsewhere: leave --no-home out".into())
            }
            Err(error) => Err(format!(
                "the drill does not report that it is homed: leave --no-home out ({})",
                error.text()
            )),
        }
    }

    /// The number of holes that the drill has drilled by itself, if it is greater than
    /// [`from`](Self::from). Then another program has left the drill alone with this job.
    fn already_drilled(&mut self) -> Option<usize> {
        if self.from == 0 || !self.client.has_extras() {
            return None;
        }
        let done = holes_done(&mut self.client, self.parts);
        done.filter(|done| *done > self.from)
    }

    /// The parts that remain, in pieces of at most this number of records.
    fn loads(&self, most_records: usize) -> Result<Vec<Load>, String> {
        let all: usize = self.parts.iter().map(Part::holes).sum();
        if self.from >= all {
            let all = counted(all, "hole");
            return Err(format!("--from {}: the program has {all}", self.from + 1));
        }
        Ok(loads_from(self.parts, self.from, most_records))
    }

    /// Asks until the right tool is in the spindle. `false`: the operator ends the job.
    fn changed(&mut self, part: &Part) -> bool {
        loop {
            let Some(answer) = self.operator.change(&part.name(), part.diameter) else {
                return false;
            };
            let given = (self.diameter)(&answer).filter(|nm| nm.0 > 0);
            match (given, part.diameter) {
                (None, _) => self.operator.show(&format!(
                    "`{answer}` is no diameter: expected millimetres, as in 0.8"
                )),
                // The diameter of a drill is not ground more accurately than to 5 um.
                (Some(given), Some(wanted)) if (given.0 - wanted.0).abs() > 5000 => {
                    self.operator
                        .show(&format!("{given} mm is not {wanted} mm"));
                }
                _ => return true,
            }
        }
    }

    /// Clears the memory, then stores and runs a load.
    fn one(&mut self, load: &Load, detach: bool, estimate: &mut Estimate) -> Ended {
        // Without homing the drill may be at any position, so its zero is kept.
        let clear = if self.is_homed {
            Step::Empty
        } else {
            Step::Clear
        };
        if let Err(error) = self.client.run(clear) {
            return Ended::Before(error);
        }
        match self.store_and_run(load, detach, estimate) {
            Ok(is_detached) => Ended::Well { is_detached },
            Err(error) => Ended::After(error),
        }
    }

    /// Stores and runs a load. `true`: the program was started and detached.
    fn store_and_run(
        &mut self,
        load: &Load,
        detach: bool,
        estimate: &mut Estimate,
    ) -> Result<bool, ClientError> {
        // If the memory is too small, the drill works while the program is stored. Otherwise the
        // spindle is at rest as long as possible.
        let drills_meanwhile = load.bytes.len() > MEMORY_BYTES;
        if drills_meanwhile {
            self.spindle(true)?;
        }
        self.client.run(Step::Begin)?;
        // All bytes except the `f`, which is a step of its own.
        let body = load.bytes.split_last().map_or(&[][..], |(_, body)| body);
        let mut run_s = 0.0;
        for (place, byte) in body.iter().enumerate() {
            if self.client.is_stopping() {
                return Err(ClientError::Stopped);
            }
            let is_border = place > 0 && place % MEMORY_BYTES == 0;
            let part_s = if is_border {
                load.run_s(place) - run_s
            } else {
                0.0
            };
            run_s += part_s;
            self.step(Step::Store(*byte), part_s, estimate)?;
            estimate.behind_s += self.byte_s;
            if place % 64 == 0 {
                self.operator
                    .progress(estimate.share(), estimate.left_s(0.0));
            }
        }
        self.client.run(Step::End)?;
        if !drills_meanwhile {
            self.spindle(true)?;
        }
        if detach {
            return self.client.start();
        }
        let rest_s = load.seconds.iter().sum::<f64>() - run_s + load.back_s;
        self.step(Step::Execute, rest_s, estimate)?;
        self.spindle(false)?;
        Ok(false)
    }

    /// Carries out a step during which the device drills for an estimated time.
    fn step(&mut self, step: Step, run_s: f64, estimate: &mut Estimate) -> Result<(), ClientError> {
        if run_s == 0.0 {
            return self.client.run(step);
        }
        let start = self.client.elapsed();
        // Twice the estimate, because the speed of the motors is not known.
        let longest = Duration::from_secs_f64(60.0 + 2.0 * run_s * estimate.pace.max(1.0));
        // An original reports nothing while it drills, so the operator has to watch it.
        let mut is_watched = self.client.has_extras();
        let overdue_s = 30.0 + 1.25 * run_s * estimate.pace;
        let operator = &mut *self.operator;
        let seen = &*estimate;
        self.client.run_for(step, longest, |passed| {
            if !is_watched && passed.as_secs_f64() > overdue_s {
                is_watched = true;
                operator.show(
                    "it takes longer than estimated, and an original drill reports nothing \
                     meanwhile: if it stands, press Ctrl-C",
                );
            }
            // At most the estimate, so that the progress never decreases.
            let passed_s = (passed.as_secs_f64() / seen.pace).min(run_s);
            operator.progress(
                (seen.behind_s + passed_s) / seen.all_s.max(1e-9),
                seen.left_s(passed_s),
            );
        })?;
        let took_s = (self.client.elapsed() - start).as_secs_f64();
        estimate.behind_s += run_s;
        if run_s > 1.0 {
            estimate.pace = took_s / run_s;
        }
        Ok(())
    }

    /// Switches the spindle. An original switches it by itself, for each hole.
    fn spindle(&mut self, on: bool) -> Result<(), ClientError> {
        if self.client.has_extras() {
            self.client.run(Step::Spindle(on))
        } else {
            Ok(())
        }
    }

    /// Finds out what is known after a failure, from the bytes and from the device if it answers.
    fn stopped(&mut self, load: &Load, error: ClientError) -> End {
        let [done, begun] = self
            .client
            .done_and_begun()
            .map(|bytes| load.drillings(bytes as usize));
        let all = load.seconds.len();
        let (mut done, mut begun) = (done.min(all), begun.min(all));
        let is_reset = error == ClientError::Link(Failure::Restarted);
        let is_expired = error == ClientError::Link(Failure::Expired);
        let is_reached = !matches!(error, ClientError::Port(_)) && self.client.find_out().is_ok();
        let stands = error == ClientError::Link(Failure::Fault);
        let mut why = error.text();
        if is_reached {
            // A reset clears the count.
            if let (Ok(Some(count)), false) = (self.client.drillings(), is_reset) {
                let count = usize::from(count);
                // The device counts modulo 2^16. The true count is the one within the known bounds.
                let laps = done.saturating_sub(count).div_ceil(1 << 16);
                let exact = count + (laps << 16);
                if (done..=begun).contains(&exact) {
                    (done, begun) = (exact, exact);
                }
            }
            // The device is at rest. Its answer here is not the reason of the failure.
            let _ = self.spindle(false);
            if is_expired && self.expect_homed().is_ok() {
                why.push_str(". Its position is known: --no-home continues without homing");
            }
        } else if !stands && !is_reset {
            self.operator.show(if self.client.has_lease() {
                "the drill is not reached: its lease ends what it does; see whether its spindle \
                 stands"
            } else {
                "the drill is not reached: it may be at work, and its spindle may turn"
            });
        }
        let [done, begun] = load.holes([done, begun]);
        self.failed(why, load.before + done, load.before + begun)
    }

    fn has_depths(&self) -> bool {
        let records = self.parts.iter().flat_map(|part| &part.records);
        records
            .into_iter()
            .any(|record| matches!(record, Record::Drill(1..)))
    }

    fn failed(&self, why: String, done: usize, begun: usize) -> End {
        End::Failed(Failed { why, done, begun })
    }
}

/// Longest time of homing from any position on the table.
const HOMING: Duration = Duration::from_secs(300);

/// Checks that there is one load, and that the memory of the drill holds it.
///
/// # Errors
///
/// There are several loads, or the load is longer than the memory.
fn expect_one(loads: &[Load]) -> Result<(), String> {
    let [load] = loads else {
        return Err(format!(
            "--detach is for one tool, and this program has {}: a detached drill does not wait for \
             a tool",
            loads.len()
        ));
    };
    if load.bytes.len() > MEMORY_BYTES {
        return Err(format!(
            "--detach is for programs of up to {MEMORY_BYTES} bytes, the memory of the drill; this \
             one has {}",
            load.bytes.len()
        ));
    }
    Ok(())
}
