//! End switches. If an axis reaches one, all axes stop.

use super::collision::Watch;
use super::head::Head;
use super::port::Port;
use super::search::{Search, searches};
use super::wiring::End;
use crate::error::Error;
use husillo_transports::nmc::{Homing, Reply};

/// An end switch counts as open after this number of consecutive readings. One is not enough,
/// because contacts bounce.
const OPEN_READINGS: u32 = 2;

impl<P: Port> Head<P> {
    /// Whether an axis has reached an end switch since the start.
    pub const fn has_met_end(&self) -> bool {
        self.has_met_end
    }

    /// Checks a reading of all axes for an end switch that has closed. A closed switch is reported
    /// only once, so that the axis can leave it.
    ///
    /// # Errors
    ///
    /// [`Error::EndSwitch`].
    pub(super) fn look_at_ends(&mut self, replies: &[Reply]) -> Result<(), Error> {
        let mut met = None;
        for (index, (axis, reply)) in self.axes.iter_mut().zip(replies).enumerate() {
            if !axis.settings.is_end_closed(reply) {
                axis.open_readings = axis.open_readings.saturating_add(1);
                axis.is_at_end &= axis.open_readings < OPEN_READINGS;
                continue;
            }
            axis.open_readings = 0;
            let was_at_end = axis.is_at_end;
            if !was_at_end {
                axis.meet_end(reply);
            }
            if !was_at_end && !axis.is_end_sought {
                // The module has latched the position if it watched the switch.
                let has_latched = axis.is_end_armed && !searches(reply);
                let readings = &reply.readings;
                let counts = match has_latched {
                    true => readings.home,
                    false => readings.position,
                };
                met = met.or(Some((index, counts)));
            }
        }
        let Some((index, counts)) = met else {
            return Ok(());
        };
        self.has_met_end = true;
        Err(self.end_switch(index, counts))
    }

    fn end_switch(&self, index: usize, counts: i32) -> Error {
        let axis = &self.axes[index];
        Error::EndSwitch {
            axis: axis.settings.letter,
            end: axis.end,
            at: self.axis_text(index, counts),
            speed: None,
        }
    }

    /// Reads moving axes. The error of an end switch contains their speed.
    pub(super) fn read_moving(&mut self, watch: &Watch) -> Result<Vec<Reply>, Error> {
        self.read().map_err(|error| match error {
            Error::EndSwitch { axis, end, at, .. } => Error::EndSwitch {
                axis,
                end,
                at,
                speed: watch.speed(self.scale),
            },
            other => other,
        })
    }

    /// Checks before a move that no axis at an end switch moves farther.
    ///
    /// # Errors
    ///
    /// [`Error::EndSwitch`].
    pub(super) fn check_ends(&mut self, goal: &[i32]) -> Result<(), Error> {
        if self.axes.iter().all(|axis| axis.settings.end().is_none()) {
            return Ok(());
        }
        let replies = self.read()?;
        for (index, (axis, goal)) in self.axes.iter().zip(goal).enumerate() {
            let ahead = i64::from(*goal) - i64::from(axis.held);
            if axis.is_end_sought || !axis.settings.is_end_closed(&replies[index]) {
                continue;
            }
            match axis.end {
                Some(end) if end.is_ahead(ahead) => {
                    return Err(self.end_switch(index, axis.held));
                }
                None if ahead.unsigned_abs() > u64::from(self.leaving().unsigned_abs()) => {
                    return Err(Error::UnknownEnd {
                        axis: axis.settings.letter,
                        at: self.axis_text(index, axis.held),
                        most: self.scale.text(self.scale.of_counts(self.leaving().into())),
                    });
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Moves an axis to its end switch, and off it until the switch opens. In the end the axis is
    /// twice the back-off away from the switch.
    ///
    /// # Errors
    ///
    /// [`Error::NoEndSwitch`] if the switch does not close over the length of the travel, or does
    /// not open soon afterwards, and the errors of a move.
    pub(super) fn search_end(&mut self, index: usize, end: End) -> Result<(), Error> {
        let [quick, slow] = [self.probe.rate, self.probe.slow_rate];
        let clear = i32::try_from(self.probe.back_off).unwrap_or(i32::MAX);
        let outwards = end.sign();
        let clear = clear.saturating_mul(2);
        self.read_end(index)?;
        if self.axes[index].is_at_end && self.axes[index].end != Some(end) {
            let (open, inwards) = self.leave_end(index)?;
            let inside = open.saturating_add(inwards.saturating_mul(clear));
            self.only(index, inside, None, quick)?;
        }
        let length = self.length(index);
        if !self.axes[index].is_at_end {
            self.seek_end(index, outwards, quick, length)?;
        }
        // The distance is limited. Otherwise a switch that sticks closed would send the axis to the
        // other end, or into a part.
        let open = self.seek_end(index, -outwards, slow, self.off_switch())?;
        self.axes[index].is_at_end = false;
        let inside = open.saturating_sub(outwards.saturating_mul(clear));
        self.only(index, inside, None, quick).map(drop)
    }

    /// Reads an axis at rest until it is certain whether its end switch is open. The switch may
    /// have opened since the last move.
    fn read_end(&mut self, index: usize) -> Result<(), Error> {
        self.axes[index].is_end_sought = true;
        let read = (0..OPEN_READINGS).try_for_each(|_| self.read().map(drop));
        self.axes[index].is_end_sought = false;
        read
    }

    /// Leaves an end switch to which no search has led. Returns the position at which the switch
    /// opens, and the sign of the direction. If it is not known which end it is, the axis tries
    /// both directions, each over a short distance.
    fn leave_end(&mut self, index: usize) -> Result<(i32, i32), Error> {
        let (slow, short) = (self.probe.slow_rate, self.leaving());
        let left = match self.axes[index].end {
            Some(end) => {
                let length = self.off_switch();
                (
                    self.seek_end(index, -end.sign(), slow, length)?,
                    -end.sign(),
                )
            }
            None => match self.seek_end(index, 1, slow, short) {
                Err(Error::NoEndSwitch { .. }) => {
                    // Back to the start, and the same distance to the other side.
                    let twice = short.saturating_mul(2);
                    (self.seek_end(index, -1, slow, twice)?, -1)
                }
                open => (open?, 1),
            },
        };
        self.axes[index].is_at_end = false;
        Ok(left)
    }

    /// The longest move off a switch that the axis has met, counts. It is twice the distance over
    /// which an axis may leave an unknown end: once for this distance, and once for the distance in
    /// which the axis came to rest beyond the switch.
    fn off_switch(&self) -> i32 {
        self.leaving().saturating_mul(2)
    }

    /// Length of the travel of an axis, counts.
    fn length(&self, index: usize) -> i32 {
        let [low, high] = self.axes[index].settings.travel;
        high.saturating_sub(low)
    }

    /// Moves an axis until its end switch changes, at most by `length`. Returns the position of the
    /// change.
    fn seek_end(&mut self, index: usize, sign: i32, rate: u32, length: i32) -> Result<i32, Error> {
        let axis = &mut self.axes[index];
        axis.is_end_sought = true;
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
            false => Err(Error::NoEndSwitch {
                axis: letter,
                length: self.scale.text(self.scale.of_counts(length.into())),
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heads::Deflection;
    use crate::heads::line::Line;
    use crate::heads::machine::Machine;
    use crate::heads::wiring::Wiring;
    use crate::simulated::{SimulatedNetwork, SimulatedPort, three_axes};

    type Simulated = Head<SimulatedPort>;

    const MM: i64 = 1_000_000;

    /// The machine of three axes with an end switch at limit 2 of X.
    fn machine(end: End) -> Machine {
        let mut machine = three_axes();
        machine.axes[0].limits = [Wiring::Probe, Wiring::End(end)];
        machine
    }

    /// A head whose end switch closes at this count.
    fn head(end: End, switch: &str) -> Simulated {
        let machine = machine(end);
        let network = SimulatedNetwork::of_machine(&machine, &[], None).unwrap();
        let network = network.with_ends(&[switch.parse().unwrap()]).unwrap();
        Simulated::start(Line::new(SimulatedPort::new(network)), &machine, 1).unwrap()
    }

    fn motors(head: &mut Simulated) -> [i64; 3] {
        let network = &mut head.line.port().network;
        for _ in 0..2000 {
            network.tick();
        }
        [0, 1, 2].map(|module| network.servo_network().motor(module).unwrap().counts())
    }

    #[test]
    fn an_end_switch_stops_all_axes_and_is_left_the_other_way() {
        for (end, switch, sign) in [(End::Low, "1:..-500", -1), (End::High, "1:500", 1)] {
            let mut head = head(end, switch);
            head.axes.iter_mut().for_each(|axis| axis.is_homed = true);
            let met = head.go_to([sign * 4 * MM, 4 * MM, 0]);
            let Err(Error::EndSwitch {
                axis,
                end: at_end,
                at,
                speed,
            }) = met
            else {
                panic!("{met:?}")
            };
            assert_eq!((axis, at_end), ('X', Some(end)));
            // 500 counts are 1 mm. Both axes at 2.4 mm/s.
            assert!(at == format!("X {}.0000 mm", sign), "{at}");
            let speed: f64 = speed.unwrap().trim_end_matches(" mm/s").parse().unwrap();
            assert!((3.2..3.6).contains(&speed), "{speed}");
            let at = motors(&mut head);
            // The motor runs on by 50 um.
            assert!((sign * at[0]).abs_diff(500) <= 25, "{at:?}");
            assert!((450..600).contains(&at[1]), "{at:?}");
            assert!(head.has_met_end());

            // A move farther out is refused. A move of Y alone is not.
            for goal in [sign * 2 * MM, sign * 40 * MM] {
                let farther = head.go_to([goal, MM, 0]);
                assert!(matches!(farther, Err(Error::EndSwitch { .. })));
            }
            let jog = head.jog(0, sign > 0, 1.0, false);
            assert!(matches!(jog, Err(Error::EndSwitch { .. })), "{jog:?}");
            let held = motors(&mut head);
            assert!(held[0].abs_diff(at[0]) <= 2, "{held:?} {at:?}");
            // The axis leaves the switch slowly, 1 mm at 0.4 mm/s, and then has its full speed.
            let before = head.line.elapsed_us();
            head.go_to([0, 0, 0]).unwrap();
            assert!(head.line.elapsed_us() - before > 2_500_000);
            let before = head.line.elapsed_us();
            head.go_to([-sign * MM, 0, 0]).unwrap();
            assert!(head.line.elapsed_us() - before < 1_500_000);
            // The switch is watched again, also in a search and in a jog.
            let direction = match sign {
                1 => husillo_probe::UnitVector::X,
                _ => husillo_probe::UnitVector::X.reversed(),
            };
            let touch = head.touch(&direction, 4_000_000);
            assert!(matches!(touch, Err(Error::EndSwitch { .. })), "{touch:?}");
            head.go_to([0, 0, 0]).unwrap();
            let jog = head.jog(0, sign > 0, 60.0, false);
            assert!(matches!(jog, Err(Error::EndSwitch { .. })), "{jog:?}");
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
        assert!(matches!(farther, Err(Error::EndSwitch { .. })));
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
            matches!(home, Err(Error::NoEndSwitch { axis: 'X', .. })),
            "{home:?}"
        );
    }

    /// An end switch that sticks closed does not lead the axis through its travel.
    #[test]
    fn homing_with_a_stuck_end_switch_is_short() {
        let mut head = head(End::Low, "1:..-500");
        head.go_to([-MM, 0, 0]).unwrap_err();
        let before = motors(&mut head)[0];
        head.line.port().network.hold_ends(1, Some(true));
        let home = head.home(0);
        let Err(Error::NoEndSwitch { axis: 'X', length }) = home else {
            panic!("{home:?}")
        };
        assert_eq!(length, "0.6400 mm");
        let moved = motors(&mut head)[0] - before;
        assert!((300..=340).contains(&moved), "{moved}");
        head.line.port().network.hold_ends(1, None);
        head.home(0).unwrap();
    }

    /// The machine of three axes with both end switches of X on one input. They close at these
    /// counts.
    fn between(switches: [&str; 2]) -> Simulated {
        let mut machine = three_axes();
        machine.axes[0].limits = [Wiring::Probe, Wiring::Ends];
        let network = SimulatedNetwork::of_machine(&machine, &[], None).unwrap();
        let ends = switches.map(|switch| switch.parse().unwrap());
        let network = network.with_ends(&ends).unwrap();
        Simulated::start(Line::new(SimulatedPort::new(network)), &machine, 1).unwrap()
    }

    #[test]
    fn two_switches_on_one_input_are_told_apart() {
        let mut head = between(["1:..-500", "1:700"]);
        head.axes.iter_mut().for_each(|axis| axis.is_homed = true);
        for (end, sign) in [(End::High, 1), (End::Low, -1), (End::High, 1)] {
            let met = head.go_to([sign * 4 * MM, 0, 0]);
            let Err(Error::EndSwitch {
                end: at_end,
                speed: Some(_),
                ..
            }) = met
            else {
                panic!("{met:?}")
            };
            assert_eq!(at_end, Some(end));
            let farther = head.go_to([sign * 40 * MM, 0, 0]);
            assert!(
                matches!(farther, Err(Error::EndSwitch { speed: None, .. })),
                "{farther:?}"
            );
            let jog = head.jog(0, sign > 0, 1.0, false);
            assert!(matches!(jog, Err(Error::EndSwitch { .. })), "{jog:?}");
            head.go_to([0; 3]).unwrap();
        }
    }

    /// At power-up a closed input does not show which switch it is. The axis moves a little until
    /// the switch opens.
    #[test]
    fn an_axis_at_an_unknown_end_moves_a_little_only() {
        // It stands 40 counts beyond the high switch.
        let mut head = between(["1:..-2000", "1:-40"]);
        let [low, ..] = head.axes[0].travel_counts();
        for goal in [MM, -MM] {
            let far = head.go_to([goal, 0, 0]);
            assert!(
                matches!(far, Err(Error::UnknownEnd { axis: 'X', .. })),
                "{far:?}"
            );
        }
        // 160 counts are the over-travel and the back-off.
        head.jog(0, true, 60.0, true).unwrap();
        assert!(motors(&mut head)[0].abs_diff(160) <= 2);
        let far = head.go_to([MM, 0, 0]);
        assert!(matches!(far, Err(Error::UnknownEnd { .. })), "{far:?}");
        head.jog(0, false, 60.0, true).unwrap();
        head.jog(0, false, 60.0, true).unwrap();
        // The switch is open: the axis is free.
        head.go_to([-2 * MM, 0, 0]).unwrap();
        assert!(low < -2000);
    }

    /// A joystick leads an axis as far as a jog does.
    #[test]
    fn a_joystick_moves_an_axis_at_an_unknown_end_a_little_only() {
        let mut head = between(["1:..-2000", "1:-40"]);
        let steered = |head: &mut Simulated, is_positive| {
            let mut left = 500;
            let slow = Deflection::Slow { is_positive };
            head.steer(|| {
                left -= 1;
                (left > 0).then_some([slow, Deflection::Centre, Deflection::Centre])
            })
            .unwrap();
            motors(head)[0]
        };
        assert!(steered(&mut head, true).abs_diff(160) <= 2);
        assert!(steered(&mut head, false).abs_diff(0) <= 2);
        // Beyond -40 the switch is open. Then the axis has its travel.
        assert!(steered(&mut head, false).abs_diff(-160) <= 2);
        assert!(steered(&mut head, false) < -500);
    }

    /// Wherever the axis is at power-up, even at one of the switches, home is at the low switch.
    #[test]
    fn home_between_two_switches_is_at_the_low_one() {
        // The length of the axis is 1800 counts. It stands at 0.
        for low in [-1700, -900, -120, 10] {
            let switches = [format!("1:..{low}"), format!("1:{}", low + 1800)];
            let mut head = between([&switches[0], &switches[1]]);
            head.home(0).unwrap();
            let above = head.axes[0].origin - low;
            // The next index that is more than two back-offs above the switch.
            assert!((120..=520).contains(&above), "{low}: {above}");
            assert_eq!(head.axes[0].origin.rem_euclid(400) % 399 % 398, 0);
        }
        let mut head = between(["1:..-1850", "1:-50"]);
        head.home(0).unwrap();
        let above = head.axes[0].origin + 1850;
        assert!((120..=520).contains(&above), "{above}");
    }

    /// The next session knows at which end the axis stands.
    #[test]
    fn the_end_is_remembered() {
        use crate::heads::Rejoined;
        let mut head = between(["1:..-500", "1:700"]);
        head.go_to([4 * MM, 0, 0]).unwrap_err();
        head.find_again().unwrap();
        let memory = head.memory().unwrap();
        assert_eq!(memory.axes[0].end, Some(End::High));
        let mut machine = three_axes();
        machine.axes[0].limits = [Wiring::Probe, Wiring::Ends];
        let port = head.line.into_port();
        let rejoined = Simulated::rejoin(Line::new(port), &machine, 1, &memory).unwrap();
        let Rejoined::AsLeft(mut head) = rejoined else {
            panic!("the modules were not recognised");
        };
        let farther = head.go_to([4 * MM, 0, 0]);
        let Err(Error::EndSwitch {
            end: Some(End::High),
            ..
        }) = farther
        else {
            panic!("{farther:?}")
        };
        head.go_to([0; 3]).unwrap();
    }
}
