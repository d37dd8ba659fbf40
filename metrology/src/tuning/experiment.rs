//! An experiment from its start to checked gains.

use super::fit::fit;
use super::moves;
use super::outcome::{Outcome, RuleRow, UltimateFigures};
use super::relay::{NoRelay, RelaySettings, note, relay};
use super::stand::{Stand, Trace};
use super::step::step;
use super::stepwise::stepwise;
use super::ultimate::ultimate;
use crate::error::Error;
use husillo_pid::tuning::{Rule, Ultimate};
use husillo_transports::nmc::Gains;
use std::fmt;

/// The method that finds the gains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// No method: only a step with the gains of the axis.
    Step,
    /// The proportional gain is raised until the axis oscillates steadily.
    Ultimate,
    /// A relay replaces the controller.
    Relay,
    /// One gain after the other, as in manual tuning.
    Stepwise,
}

/// Settings of an experiment with an axis.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// The method that finds the gains.
    pub method: Method,
    /// The rule that computes gains from an ultimate point. It is a rule for a PID controller.
    pub rule: Rule,
    /// Length of steps, counts. It must be below the `error_limit` of the axis, and the travel must
    /// have room for twice this length.
    pub size: i32,
    /// Settings of the relay, for [`Method::Relay`].
    pub relay: RelaySettings,
    /// Number of moves that check the gains.
    pub moves: u32,
}

/// Why an experiment failed.
#[derive(Debug)]
pub enum Failed {
    /// A limit was passed, or the link failed.
    Machine(Error),
    /// The axis does not oscillate steadily, even with the largest gain and the slowest servo.
    NoUltimate,
    /// The relay found no ultimate point.
    NoRelay(NoRelay),
    /// The gains that follow from the ultimate point are out of the range of the module.
    NoGains,
}

impl From<Error> for Failed {
    fn from(error: Error) -> Self {
        Self::Machine(error)
    }
}

impl fmt::Display for Failed {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Machine(error) => error.fmt(out),
            Self::NoUltimate => out.write_str(
                "not even p = 32767 and a rate divisor of 32 make the axis oscillate steadily: no \
                 ultimate gain was found",
            ),
            Self::NoRelay(none) => none.fmt(out),
            Self::NoGains => out.write_str("the ultimate point gives no gains that a module has"),
        }
    }
}

impl std::error::Error for Failed {}

/// Rules for a position loop, which needs a derivative gain: name and source of each.
const RULES: [(Rule, &str, &str); 2] = [
    (
        Rule::ZieglerNicholsPid,
        "Ziegler-Nichols",
        "Trans. ASME 64 (1942)",
    ),
    (
        Rule::TyreusLuybenPid,
        "Tyreus-Luyben",
        "Luyben and Luyben, Essentials of Process Control (1997)",
    ),
];

impl Experiment {
    /// Finds gains, makes a step with them, and checks them with moves. Adds each result to
    /// `outcome` when it is found, and the traces for the pictures to the stand.
    ///
    /// # Errors
    ///
    /// [`Failed`]. The results before it are in `outcome`.
    pub fn run(&self, stand: &mut Stand, outcome: &mut Outcome) -> Result<(), Failed> {
        let size = self.size;
        let gains = match self.method {
            Method::Step => {
                let gains = stand.settings.gains;
                let (figures, trace) = step(stand, &gains, size)?;
                outcome.step = Some(figures);
                stand.traces.push(titled(trace, &gains));
                gains
            }
            Method::Ultimate => {
                let found = ultimate(stand, &mut outcome.trials)?;
                let (found, divisor) = found.ok_or(Failed::NoUltimate)?;
                self.by_rules(found, divisor, stand, outcome)?
            }
            Method::Relay => {
                let (figures, found) = relay(stand, self.relay).map_err(|none| match none {
                    NoRelay::Machine(error) => Failed::Machine(error),
                    none => Failed::NoRelay(none),
                })?;
                outcome.relay = Some(figures);
                outcome.notes.extend(note(&figures));
                self.by_rules(found, 1, stand, outcome)?
            }
            Method::Stepwise => stepwise(stand, size, &mut outcome.trials, &mut outcome.notes)?,
        };
        if self.method != Method::Step {
            outcome.conclude(&gains);
            // The step with the result is drawn first.
            let (figures, trace) = step(stand, &gains, size)?;
            outcome.step = Some(figures);
            stand.traces.insert(0, titled(trace, &gains));
        }
        if self.moves > 0 {
            outcome.check = Some(moves::check(stand, &gains, self.moves)?);
        }
        Ok(())
    }

    /// Computes the gains of all rules and returns those of the chosen one.
    fn by_rules(
        &self,
        found: Ultimate,
        divisor: u8,
        stand: &Stand,
        outcome: &mut Outcome,
    ) -> Result<Gains, Failed> {
        outcome.ultimate = Some(UltimateFigures::new(found, divisor));
        let mut chosen = None;
        for (rule, title, source) in RULES {
            let rates = found.gains(rule);
            let Some((gains, notes)) = fit(rates, &stand.settings.gains) else {
                continue;
            };
            let row = RuleRow::new(title, source, rates, &gains);
            outcome.rules.push(row);
            if rule == self.rule {
                outcome.notes.extend(notes);
                chosen = Some(gains);
            }
        }
        chosen.ok_or(Failed::NoGains)
    }
}

fn titled(trace: Trace, gains: &Gains) -> Trace {
    let title = format!(
        "Step with p = {}, i = {}, d = {}",
        gains.proportional, gains.integral, gains.derivative
    );
    Trace { title, ..trace }
}
