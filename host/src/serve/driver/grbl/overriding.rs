//! Overrides, and accessories during a program.

use super::Driver;
use crate::serve::request::{Accessory, Overridden};
use husillo_transports::grbl::{Adjust, Realtime, State};

impl Driver<'_> {
    /// Sets an override. The outer error is a lost controller, the inner one a refusal.
    pub(super) fn set_override(
        &mut self,
        what: Overridden,
        percent: u8,
    ) -> Result<Result<(), &'static str>, String> {
        let bytes: Vec<_> = match what {
            Overridden::Rapid if [25, 50, 100].contains(&percent) => {
                vec![Realtime::Rapid(percent)]
            }
            Overridden::Rapid => return Ok(Err("rapids have 25, 50 or 100 %")),
            _ if !(10..=200).contains(&percent) => return Ok(Err("an override is 10 to 200 %")),
            Overridden::Feed => adjustments(percent).map(Realtime::Feed).collect(),
            Overridden::Spindle => adjustments(percent).map(Realtime::Spindle).collect(),
        };
        for byte in bytes {
            self.session.put(&[byte.byte()])?;
        }
        let name = match what {
            Overridden::Feed => "feed",
            Overridden::Rapid => "rapids",
            Overridden::Spindle => "spindle",
        };
        let text = format!("override of the {name}: {percent} %");
        self.machine.tell(super::From::Host, text);
        Ok(Ok(()))
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

/// The changes that lead from any override to this one: first to 100 %, then in steps.
fn adjustments(percent: u8) -> impl Iterator<Item = Adjust> {
    let change = i16::from(percent) - 100;
    let sign = if change < 0 { -1 } else { 1 };
    let steps = |by: i8, count: i16| {
        std::iter::repeat_n(Adjust::By(by * sign), usize::from(count.unsigned_abs()))
    };
    let (tens, ones) = (change / 10, change % 10);
    std::iter::once(Adjust::Reset)
        .chain(steps(10, tens))
        .chain(steps(1, ones))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_override_is_reached() {
        for percent in 10..=200 {
            let reached = adjustments(percent).fold(57, |now, change| change.apply(now));
            assert_eq!(reached, percent);
        }
        assert_eq!(adjustments(112).count(), 4);
    }
}
