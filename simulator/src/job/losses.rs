//! The messages about steps that the motors did not follow.

use super::Job;
use crate::simulation::run::Run;
use husillo_machine::OnLoss;
use husillo_sim::text::{counted, duration, millimetres};

/// A sentence for each axis that lost steps without correction: number, first position, remedy.
pub fn sentences(job: &Job, run: &Run) -> Vec<String> {
    let mut sentences = Vec::new();
    let axes = job.machine.axes.iter().zip(run.mechanics.losses().lost());
    let axes = axes.zip(run.encoders.behind);
    for (((axis, lost), is_behind), first) in axes.zip(run.mechanics.losses().first()) {
        let corrects = axis
            .encoder
            .is_some_and(|file| file.encoder.on_loss == OnLoss::Correct);
        let is_made_good = corrects && !is_behind;
        if lost == 0 || is_made_good {
            continue;
        }
        let place = first.map_or(String::new(), |first| {
            let letters = job.machine.letters.letters().map(char::from);
            let place: Vec<String> = letters
                .zip(first.at_nm.map(millimetres))
                .map(|(letter, at)| format!("{letter}{at}"))
                .collect();
            format!(
                "; the first at step event {}, after {}, near {} mm of the machine",
                first.event,
                duration(first.time_s),
                place.join(" ")
            )
        });
        let advice = match axis.pull_out_rate {
            Some(rate) => format!(
                "the motor follows up to {rate} Hz: lower the feed, or `max_rate` or `start_rate` \
                 of the axis"
            ),
            None => "lower the feed or `max_rate` of the axis".to_owned(),
        };
        let letter = char::from(axis.letter);
        let steps = counted(lost, "step");
        sentences.push(format!("axis {letter} lost {steps}{place}: {advice}"));
    }
    sentences
}
