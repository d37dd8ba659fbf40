//! An experiment from its beginning to checked gains.

use super::fit::fit;
use super::moves;
use super::outcome::{Outcome, RuleRow, UltimateFigures};
use super::relay::{NoRelay, RelaySettings, note, relay};
use super::stand::{Stand, Trace};
use super::step::step;
use super::stepwise::stepwise;
use super::ultimate::ultimate;
use crate::trouble::Trouble;
use husillo_pid::tuning::{Rule, Ultimate};
use husillo_transports::nmc::Gains;
use std::fmt;

/// How gains are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Not at all: a step with those of the axis.
    Step,
    /// The proportional gain is raised until the axis swings for ever.
    Ultimate,
    /// A relay in the place of the controller.
    Relay,
    /// One gain after the other, as by hand.
    Stepwise,
}

/// What is done with an axis.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// How gains are found.
    pub method: Method,
    /// The rule that makes gains of an ultimate point, one of those for a PID controller.
    pub rule: Rule,
    /// Length of steps, counts; below the `error_limit` of the axis, and twice within its travel.
    pub size: i32,
    /// The relay, where there is one.
    pub relay: RelaySettings,
    /// Moves that check the gains.
    pub moves: u32,
}

/// Why an experiment has no end.
#[derive(Debug)]
pub enum Failed {
    /// A limit was passed, or the link failed.
    Trouble(Trouble),
    /// Not even the largest gain and the slowest servo make the axis swing for ever.
    NoUltimate,
    /// The relay found nothing.
    NoRelay(NoRelay),
    /// The ultimate point gives no gains that a module has.
    NoGains,
}

impl From<Trouble> for Failed {
    fn from(trouble: Trouble) -> Self {
        Self::Trouble(trouble)
    }
}

impl fmt::Display for Failed {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Trouble(trouble) => trouble.fmt(out),
            Self::NoUltimate => out.write_str(
                "not even p = 32767 and a rate divisor of 32 make the axis swing for ever: \
                 there is no ultimate gain to be found",
            ),
            Self::NoRelay(none) => none.fmt(out),
            Self::NoGains => out.write_str("the ultimate point gives no gains that a module has"),
        }
    }
}

impl std::error::Error for Failed {}

/// The rules for a position loop, which needs its derivative: name and source of each.
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
    /// Finds gains, makes a step with them, and checks them with moves. What is found goes to
    /// `outcome` as it comes, what is worth a picture to the stand's traces.
    ///
    /// # Errors
    ///
    /// [`Failed`]; what was found before is in `outcome`.
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
                    NoRelay::Trouble(trouble) => Failed::Trouble(trouble),
                    none => Failed::NoRelay(none),
                })?;
                outcome.relay = Some(figures);
                outcome.notes.extend(note(&figures));
                self.by_rules(found, 1, stand, outcome)?
            }
            Method::Stepwise => stepwise(stand, size, &mut outcome.trials)?,
        };
        if self.method != Method::Step {
            outcome.conclude(&gains);
            // The picture of the result.
            let (figures, trace) = step(stand, &gains, size)?;
            outcome.step = Some(figures);
            stand.traces.insert(0, titled(trace, &gains));
        }
        if self.moves > 0 {
            outcome.check = Some(moves::check(stand, &gains, self.moves)?);
        }
        Ok(())
    }

    /// The gains of all rules; those of the chosen one are returned.
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
