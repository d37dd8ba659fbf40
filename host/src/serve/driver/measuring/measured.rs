//! A routine that the head carries out, and what it has measured.

use super::hands::Hands;
use super::work::{Event, Trouble};
use crate::measuring::{Routine, now};
use husillo_metrology::heads::{Prober, Stylus};
use husillo_metrology::routine::{Feature, Runner, Site};
use husillo_reports::routine::{Heading, html, json, summary};
use serde_json::Value;
use std::time::Duration;

/// Interval of the looks at a program that waits.
const LOOK: Duration = Duration::from_millis(20);

/// What a routine has measured.
#[derive(Clone, Debug)]
pub(super) struct Measured {
    /// Its features, as `husillo measure --format json` prints them.
    pub(super) features: Vec<Value>,
    /// The features and the tolerances kept, in words.
    pub(super) summary: String,
    /// Whether it is complete and everything is within its tolerance.
    pub(super) is_good: bool,
    /// Whether there was a collision, so that nothing counts.
    pub(super) has_collided: bool,
    /// The report.
    pub(super) page: String,
}

/// Carries out a routine. `tell` hears of each statement and of each feature.
///
/// # Errors
///
/// A statement has failed. What was measured before was told.
pub(super) fn run(
    routine: &Routine,
    part: Option<&str>,
    machine: &str,
    prober: &mut dyn Prober,
    tip: Stylus,
    hands: &Hands,
    tell: impl Fn(Event),
) -> Result<(), Trouble> {
    let heading = Heading {
        routine: routine.name(),
        part,
        machine,
        measured: now(),
    };
    let mut runner = Runner::new(Site::new(prober, tip));
    let done = routine.carry_out(
        &mut runner,
        |line| tell(Event::Line(line)),
        |feature| tell(Event::Feature(of(&heading, feature))),
        |line| {
            tell(Event::Waits(Some(line)));
            hands.take_resumed();
            while !hands.take_resumed() && !hands.is_stop_wanted() {
                std::thread::sleep(LOOK);
            }
            tell(Event::Waits(None));
        },
    );
    let has_collided = runner.site.has_collided();
    if has_collided {
        runner.features.iter_mut().for_each(Feature::spoil);
    }
    let features = &runner.features;
    let trouble = done.as_ref().err().map(|finding| finding.message.clone());
    let trouble = trouble.as_deref();
    let is_good = trouble.is_none() && !has_collided && features.iter().all(Feature::is_good);
    tell(Event::Measured(Box::new(Measured {
        features: features.iter().map(|one| of(&heading, one)).collect(),
        summary: summary(features),
        is_good,
        has_collided,
        page: html(&heading, features, &runner.site, trouble),
    })));
    done.map_err(|finding| {
        let (line, _) = finding.line_and_column();
        Trouble::Text(match &finding.help {
            Some(help) => format!("line {line}: {}; {help}", finding.message),
            None => format!("line {line}: {}", finding.message),
        })
    })
}

/// A feature, as pages get it.
fn of(heading: &Heading<'_>, feature: &Feature) -> Value {
    let mut all = json(heading, std::slice::from_ref(feature), None, false);
    all["features"][0].take()
}
