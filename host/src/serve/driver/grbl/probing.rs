//! A move until a probe touches.

use super::Driver;
use super::sequence::{Sequence, Then};
use crate::serve::axes::{LETTERS, feed, words};
use crate::serve::reply::Reply;
use crate::serve::request::Probe;

/// Longest distance of a search, and back after the contact, mm.
const LONGEST_MM: f64 = 1000.0;

impl Driver<'_> {
    /// Moves one axis until the probe touches, and back. The modes and the feed are then what they
    /// were.
    pub(super) fn probe(&mut self, asked: &Probe, reply: Reply) {
        match self.probing_lines(asked) {
            Ok((axis, lines)) => {
                let then = Then::Contact(axis, asked.set_mm.filter(|_| !asked.beside));
                let name = format!("probing {}", asked.axis);
                self.begin_sequence(Sequence::new(name, lines, then, reply));
            }
            Err(why) => reply.error(why),
        }
    }

    /// The axis, and the lines.
    fn probing_lines(&self, asked: &Probe) -> Result<(usize, Vec<String>), String> {
        self.stands()?;
        let axes = LETTERS.iter().take(self.state.axes.len());
        let axis = axes.into_iter().position(|letter| *letter == asked.axis);
        let axis = axis.ok_or_else(|| format!("this machine has no axis `{}`", asked.axis))?;
        if !(0.001..=LONGEST_MM).contains(&asked.by_mm.abs()) {
            let distance = asked.by_mm.abs();
            return Err(format!(
                "a search of {distance} mm: 0.001 to {LONGEST_MM} mm are possible"
            ));
        }
        if !(0.0..=LONGEST_MM).contains(&asked.back_mm) {
            let distance = asked.back_mm;
            return Err(format!(
                "{distance} mm back after the contact: 0 to {LONGEST_MM} mm are possible"
            ));
        }
        if asked
            .set_mm
            .is_some_and(|set| set.is_nan() || set.abs() > LONGEST_MM)
        {
            return Err("this work coordinate is out of range".into());
        }
        if self.state.switches.contains(&"P") {
            return Err("the probe is closed: move away from what it touches".into());
        }
        if self.modes_are_pending() || self.state.modal.is_empty() {
            return Err("the controller has not reported its modes yet: try again".into());
        }
        let by = words(&[(axis, asked.by_mm)]);
        // Without a contact, G38.2 is an alarm and G38.3 is not.
        let code = if asked.beside { "G38.3" } else { "G38.2" };
        let speed = feed(asked.feed)?;
        let mut lines = vec![format!("G21G91G94{code}{by}F{speed:.1}")];
        let programmed = self.state.programmed.as_ref();
        let programmed = programmed.and_then(|all| all["feed"].as_f64());
        let restored = programmed
            .filter(|feed| *feed > 0.0)
            .map_or(String::new(), |feed| format!("F{feed:.3}"));
        let back = match asked.back_mm > 0.0 && !asked.beside {
            true => words(&[(axis, -asked.by_mm.signum() * asked.back_mm)]),
            false => String::new(),
        };
        let back = if back.is_empty() {
            back
        } else {
            format!("G0{back}")
        };
        lines.extend(Some(format!("{back}{restored}")).filter(|line| !line.is_empty()));
        let is_kept = |code: &&String| {
            let kept = ["G0", "G1", "G20", "G21", "G90", "G91", "G93", "G94"];
            kept.contains(&code.as_str())
        };
        let modes: String = self.state.modal.iter().filter(is_kept).cloned().collect();
        lines.push(modes);
        Ok((axis, lines))
    }
}
