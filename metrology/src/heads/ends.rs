//! End switches: an axis that meets one stops, and all others with it.

use super::collision::Watch;
use super::head::Head;
use super::port::Port;
use super::search::{Search, searches};
use super::wiring::End;
use crate::trouble::Trouble;
use husillo_transports::nmc::{Homing, Reply};

/// An end switch counts as open after this number of consecutive readings, as contacts bounce.
const OPEN_READINGS: u32 = 2;

impl<P: Port> Head<P> {
    /// Whether an axis has met an end switch since the start.
    pub const fn has_met_end(&self) -> bool {
        self.has_met_end
    }

    /// Checks a reading of all axes for an end switch that has closed. Each closing is reported
    /// once, so that the axis can leave it.
    ///
    /// # Errors
    ///
    /// [`Trouble::EndSwitch`].
    pub(super) fn look_at_ends(&mut self, replies: &[Reply]) -> Result<(), Trouble> {
        let mut met = None;
        for (index, (axis, reply)) in self.axes.iter_mut().zip(replies).enumerate() {
            let Some(end) = axis.settings.closed_end(reply) else {
                axis.open_readings = axis.open_readings.saturating_add(1);
                axis.is_at_end &= axis.open_readings < OPEN_READINGS;
                continue;
            };
            axis.open_readings = 0;
            let was_at_end = std::mem::replace(&mut axis.is_at_end, true);
            if !was_at_end && !axis.is_end_sought {
                // The module has latched the position if it watched the switch.
                let has_latched = axis.is_end_armed && !searches(reply);
                let readings = &reply.readings;
                let counts = match has_latched {
                    true => readings.home,
                    false => readings.position,
                };
                met = met.or(Some((index, end, counts)));
            }
        }
        let Some((index, end, counts)) = met else {
            return Ok(());
        };
        self.has_met_end = true;
        Err(self.end_switch(index, end, counts))
    }

    fn end_switch(&self, index: usize, end: End, counts: i32) -> Trouble {
        Trouble::EndSwitch {
            axis: self.axes[index].settings.letter,
            end,
            at: self.axis_text(index, counts),
            speed: None,
        }
    }

    /// Reads moving axes. The trouble of an end switch has their speed.
    pub(super) fn read_moving(&mut self, watch: &Watch) -> Result<Vec<Reply>, Trouble> {
        self.read().map_err(|trouble| match trouble {
            Trouble::EndSwitch { axis, end, at, .. } => Trouble::EndSwitch {
                axis,
                end,
                at,
                speed: watch.speed(self.scale),
            },
            other => other,
        })
    }

    /// Checks before a move that no axis is at an end switch and moves farther.
    ///
    /// # Errors
    ///
    /// [`Trouble::EndSwitch`].
    pub(super) fn check_ends(&mut self, goal: &[i32]) -> Result<(), Trouble> {
        if self.axes.iter().all(|axis| axis.settings.end().is_none()) {
            return Ok(());
        }
        let replies = self.read()?;
        for (index, (axis, goal)) in self.axes.iter().zip(goal).enumerate() {
            let ahead = i64::from(*goal) - i64::from(axis.held);
            let closed = axis.settings.closed_end(&replies[index]);
            if let Some(end) = closed.filter(|end| end.is_ahead(ahead) && !axis.is_end_sought) {
                return Err(self.end_switch(index, end, axis.held));
            }
        }
        Ok(())
    }

    /// Goes to the end switch of an axis and off it again until it opens. Then the axis is clear of
    /// it by twice the back-off.
    ///
    /// # Errors
    ///
    /// [`Trouble::NoEndSwitch`] over the length of the travel, and those of a move.
    pub(super) fn search_end(&mut self, index: usize, end: End) -> Result<(), Trouble> {
        let [quick, slow] = [self.probe.rate, self.probe.slow_rate];
        let clear = i32::try_from(self.probe.back_off).unwrap_or(i32::MAX);
        let outwards = end.sign();
        if !self.axes[index].is_at_end {
            self.seek_end(index, outwards, quick)?;
        }
        let open = self.seek_end(index, -outwards, slow)?;
        self.axes[index].is_at_end = false;
        let inside = open.saturating_sub(outwards.saturating_mul(clear.saturating_mul(2)));
        self.only(index, inside, None, quick).map(drop)
    }

    /// Moves an axis until its end switch changes, at most by the length of the travel. Returns
    /// where.
    fn seek_end(&mut self, index: usize, sign: i32, rate: u32) -> Result<i32, Trouble> {
        let axis = &mut self.axes[index];
        axis.is_end_sought = true;
        let [low, high] = axis.settings.travel;
        let length = high.saturating_sub(low);
        let goal = axis.held.saturating_add(sign.saturating_mul(length));
        let letter = axis.settings.letter;
        let search = Search {
            events: axis
                .settings
                .end_events()
                .with(self.probe.switches.events()),
            stop: Homing::ABRUPT,
            only: Some(index),
        };
        let finished = self.only(index, goal, Some(search), rate);
        self.axes[index].is_end_sought = false;
        let finished = finished?;
        match finished.is_found {
            true => Ok(finished.replies[index].readings.home),
            false => Err(Trouble::NoEndSwitch { axis: letter }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heads::line::Line;
    use crate::heads::machine::Machine;
    use crate::heads::wiring::Wiring;
    use crate::simulated::{SimulatedChain, SimulatedPort, three_axes};

    type Simulated = Head<SimulatedPort>;

    const MM: i64 = 1_000_000;

    /// The machine of three axes with an end switch at limit 2 of X.
    fn machine(end: End) -> Machine {
        let mut machine = three_axes();
        machine.axes[0].limits = [Wiring::Probe, Wiring::End(end)];
        machine
    }

    /// It stands this far from its end switch, which closes at this count.
    fn head(end: End, switch: &str) -> Simulated {
        let machine = machine(end);
        let chain = SimulatedChain::of_machine(&machine, &[], None).unwrap();
        let chain = chain.with_ends(&[switch.parse().unwrap()]).unwrap();
        Simulated::start(Line::new(SimulatedPort::new(chain)), &machine, 1).unwrap()
    }

    fn motors(head: &mut Simulated) -> [i64; 3] {
        let chain = &mut head.line.port().chain;
        for _ in 0..2000 {
            chain.tick();
        }
        [0, 1, 2].map(|module| chain.chain().motor(module).unwrap().counts())
    }

    #[test]
    fn an_end_switch_stops_all_axes_and_is_left_the_other_way() {
        for (end, switch, sign) in [(End::Low, "1:..-500", -1), (End::High, "1:500", 1)] {
            let mut head = head(end, switch);
            head.axes.iter_mut().for_each(|axis| axis.is_homed = true);
            let met = head.go_to([sign * 4 * MM, 4 * MM, 0]);
            let Err(Trouble::EndSwitch {
                axis,
                end: at_end,
                at,
                speed,
            }) = met
            else {
                panic!("{met:?}")
            };
            assert_eq!((axis, at_end), ('X', end));
            // 500 counts are 1 mm. Both axes at 2.4 mm/s.
            assert!(at == format!("X {}.0000 mm", sign), "{at}");
            let speed: f64 = speed.unwrap().trim_end_matches(" mm/s").parse().unwrap();
            assert!((3.2..3.6).contains(&speed), "{speed}");
            let at = motors(&mut head);
            // The motor runs on by 50 um.
            assert!((sign * at[0]).abs_diff(500) <= 25, "{at:?}");
            assert!((450..600).contains(&at[1]), "{at:?}");
            assert!(head.has_met_end());

            // Farther out nothing moves, and Y alone may.
            for goal in [sign * 2 * MM, sign * 40 * MM] {
                let farther = head.go_to([goal, MM, 0]);
                assert!(matches!(farther, Err(Trouble::EndSwitch { .. })));
            }
            let jog = head.jog(0, sign > 0, 1.0, false);
            assert!(matches!(jog, Err(Trouble::EndSwitch { .. })), "{jog:?}");
            let held = motors(&mut head);
            assert!(held[0].abs_diff(at[0]) <= 2, "{held:?} {at:?}");
            // Off it slowly: 1 mm at 0.4 mm/s, then at full speed.
            let before = head.line.elapsed_us();
            head.go_to([0, 0, 0]).unwrap();
            assert!(head.line.elapsed_us() - before > 2_500_000);
            let before = head.line.elapsed_us();
            head.go_to([-sign * MM, 0, 0]).unwrap();
            assert!(head.line.elapsed_us() - before < 1_500_000);
            // It is watched again, also in a search and in a jog.
            let direction = match sign {
                1 => husillo_probe::UnitVector::X,
                _ => husillo_probe::UnitVector::X.reversed(),
            };
            let touch = head.touch(&direction, 4_000_000);
            assert!(matches!(touch, Err(Trouble::EndSwitch { .. })), "{touch:?}");
            head.go_to([0, 0, 0]).unwrap();
            let jog = head.jog(0, sign > 0, 60.0, false);
            assert!(matches!(jog, Err(Trouble::EndSwitch { .. })), "{jog:?}");
        }
    }

    /// Wherever an axis stands at power-up, home is the same index.
    #[test]
    fn home_at_an_end_switch_is_the_same_after_every_power_up() {
        for (end, switch, wanted) in [(End::Low, "1:..-950", -800), (End::High, "1:950", 800)] {
            for away in [-900, -300, 250, 900] {
                let mut head = head(end, switch);
                head.go_to([away * 2000, 0, 0]).unwrap();
                head.home(0).unwrap();
                let origin = head.axes[0].origin;
                assert!(origin.abs_diff(wanted) <= 2, "{end} from {away}: {origin}");
                assert!(head.held()[0].abs() <= 2_000);
            }
        }
    }

    /// An axis that stands at its end switch at power-up moves away from it only.
    #[test]
    fn an_axis_that_begins_at_its_end_switch_leaves_it() {
        let mut head = head(End::High, "1:-40");
        let farther = head.go_to([MM, 0, 0]);
        assert!(matches!(farther, Err(Trouble::EndSwitch { .. })));
        head.go_to([-MM, 0, 0]).unwrap();
        head.home(0).unwrap();
        assert_eq!(head.axes[0].origin.rem_euclid(400) % 399 % 398, 0);
    }

    #[test]
    fn an_end_switch_that_is_not_there_is_missed() {
        let mut head = head(End::Low, "1:..-500000");
        head.axes[0].settings.travel = [-500, 500];
        let home = head.home(0);
        assert!(
            matches!(home, Err(Trouble::NoEndSwitch { axis: 'X' })),
            "{home:?}"
        );
    }
}
