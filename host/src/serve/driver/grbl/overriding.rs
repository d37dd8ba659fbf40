//! Overrides, and accessories during a program.

use super::Driver;
use crate::serve::request::{Accessory, Overridden};
use husillo_transports::grbl::{Adjust, Realtime, State};

/// Reports with overrides after which a wanted override is given up.
const TRIES: u8 = 60;

/// An override that was asked for and is not reported yet.
///
/// Grbl keeps the bytes of overrides as flags. Of equal bytes that arrive together it takes one. So
/// each byte is sent after a report has shown the one before.
#[derive(Debug)]
pub(super) struct Wanted {
    percent: u8,
    /// The override for which the last byte was sent.
    sent_at: Option<u8>,
    tries: u8,
}

impl Wanted {
    const fn new(percent: u8) -> Self {
        Self {
            percent,
            sent_at: None,
            tries: TRIES,
        }
    }

    /// The next change, if this override is reported. A report without the last change may be older
    /// than that, so one of them is skipped.
    fn next(&mut self, now: u8) -> Option<Adjust> {
        if self.sent_at.take_if(|before| *before == now).is_some() {
            return None;
        }
        self.sent_at = Some(now);
        towards(now, self.percent)
    }
}

impl Driver<'_> {
    /// Sets an override. The outer error is a lost controller, the inner one a refusal.
    pub(super) fn set_override(
        &mut self,
        what: Overridden,
        percent: u8,
    ) -> Result<Result<(), &'static str>, String> {
        let name = match what {
            Overridden::Rapid if [25, 50, 100].contains(&percent) => {
                self.session.put(&[Realtime::Rapid(percent).byte()])?;
                "rapids"
            }
            Overridden::Rapid => return Ok(Err("rapids have 25, 50 or 100 %")),
            _ if !(10..=200).contains(&percent) => return Ok(Err("an override is 10 to 200 %")),
            Overridden::Feed => {
                self.wanted[0] = Some(Wanted::new(percent));
                "feed"
            }
            Overridden::Spindle => {
                self.wanted[1] = Some(Wanted::new(percent));
                "spindle"
            }
        };
        self.adjust()?;
        let text = format!("override of the {name}: {percent} %");
        self.machine.tell(super::From::Host, text);
        Ok(Ok(()))
    }

    /// The controller has reported its overrides: the next changes are sent.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn adjust(&mut self) -> Result<(), String> {
        let Some(all) = &self.state.overrides else {
            return Ok(());
        };
        let now = ["feed", "spindle"].map(|name| all[name].as_u64().unwrap_or(100) as u8);
        let kinds = [Realtime::Feed, Realtime::Spindle];
        for ((slot, now), kind) in self.wanted.iter_mut().zip(now).zip(kinds) {
            let Some(wanted) = slot else {
                continue;
            };
            wanted.tries = wanted.tries.saturating_sub(1);
            if wanted.percent == now || wanted.tries == 0 {
                *slot = None;
            } else if let Some(change) = wanted.next(now) {
                self.session.put(&[kind(change).byte()])?;
            }
        }
        Ok(())
    }

    /// Switches an accessory. The outer error is a lost controller, the inner one a refusal.
    pub(super) fn toggle(&mut self, what: Accessory) -> Result<Result<(), &'static str>, String> {
        let is_held = matches!(self.session.state(), Some(State::Hold(false)));
        let byte = match what {
            Accessory::Spindle if !is_held => {
                return Ok(Err("the spindle is switched by a line, or during a hold"));
            }
            Accessory::Spindle => Realtime::SpindleStop,
            Accessory::Flood => Realtime::Flood,
            Accessory::Mist => Realtime::Mist,
        };
        self.put(byte)?;
        Ok(Ok(()))
    }
}

/// The first change on the shortest way from an override to another one: in tens and ones, or first
/// back to 100 %. `None`: they are equal.
fn towards(now: u8, wanted: u8) -> Option<Adjust> {
    let changes = |from: u8| {
        let change = from.abs_diff(wanted);
        change / 10 + change % 10
    };
    match i16::from(wanted) - i16::from(now) {
        0 => None,
        _ if 1 + changes(100) < changes(now) => Some(Adjust::Reset),
        change if change.abs() >= 10 => Some(Adjust::By(10 * change.signum() as i8)),
        change => Some(Adjust::By(change.signum() as i8)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_override_is_reached() {
        for wanted in 10..=200 {
            for begin in 10..=200 {
                let mut now = begin;
                let mut count = 0;
                while let Some(change) = towards(now, wanted) {
                    now = change.apply(now);
                    count += 1;
                }
                assert_eq!(now, wanted, "from {begin}");
                assert!(count <= 19, "{count} from {begin} to {wanted}");
            }
        }
    }

    #[test]
    fn a_report_from_before_a_change_is_skipped_once() {
        let mut wanted = Wanted::new(120);
        assert_eq!(wanted.next(100), Some(Adjust::By(10)));
        assert_eq!(wanted.next(100), None, "it may be older than the change");
        assert_eq!(
            wanted.next(100),
            Some(Adjust::By(10)),
            "the change was lost"
        );
        assert_eq!(wanted.next(110), Some(Adjust::By(10)));
    }
}
