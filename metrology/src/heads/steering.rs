//! Steering: the axes follow a joystick.
//!
//! A module of version 4 begins a trapezoid only at rest, and a velocity profile has no end of its
//! own. So this program makes the profile, and commands each module the next position ("stop here")
//! again and again. Without the next command an axis stands. Nothing moves on when the program ends
//! or the line is cut.

use super::head::Head;
use super::port::Port;
use crate::error::Error;

/// Deflection below which a joystick is in its centre.
const DEAD: f64 = 0.1;
/// Deflection from which on an axis is fast.
const FULL: f64 = 0.6;
/// Largest step of a commanded position, counts. On a slow line an axis is slower because of it.
const MOST_STEP: f64 = 50.0;
/// This many of such steps are the largest position error of a module.
const STEPS_OF_ERROR: f64 = 8.0;
/// Longest interval between two steps that counts for the profile, s.
const MOST_INTERVAL_S: f64 = 0.1;

/// The deflection of a joystick along an axis. It has two speeds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Deflection {
    /// The axis stands.
    #[default]
    Centre,
    /// It moves at the speed of a search.
    Slow {
        /// The direction.
        is_positive: bool,
    },
    /// It moves at the speed of moves.
    Fast {
        /// The direction.
        is_positive: bool,
    },
}

impl Deflection {
    /// The deflection of a joystick from -1 to 1: below 0.1 none, from 0.6 on fast.
    #[must_use]
    pub fn of(part: f64) -> Self {
        let is_positive = part > 0.0;
        match part.abs() {
            part if part >= FULL => Self::Fast { is_positive },
            part if part >= DEAD => Self::Slow { is_positive },
            // Also what is no number.
            _ => Self::Centre,
        }
    }

    /// -1, 0 or 1.
    const fn way(self) -> i8 {
        match self {
            Self::Centre => 0,
            Self::Slow { is_positive } | Self::Fast { is_positive } => {
                if is_positive {
                    1
                } else {
                    -1
                }
            }
        }
    }
}

/// The profile of an axis.
#[derive(Clone, Copy, Debug)]
struct Profile {
    /// The commanded position, counts.
    at: f64,
    /// Counts/s.
    rate: f64,
    /// Counts/s^2.
    acceleration: f64,
    /// Ends of the travel, counts.
    ends: [f64; 2],
    /// Largest step, counts.
    most: f64,
}

impl Profile {
    /// Goes on for a time in s towards a speed in counts/s.
    fn advance(&mut self, wanted: f64, seconds: f64) {
        let [low, high] = self.ends;
        // It brakes before the end of the travel. An axis beyond it may only come back.
        let room = if wanted > 0.0 {
            high - self.at
        } else {
            self.at - low
        };
        let most = (2.0 * self.acceleration * room.max(0.0)).sqrt();
        let wanted = wanted.clamp(-most, most);
        let change = self.acceleration * seconds;
        self.rate += (wanted - self.rate).clamp(-change, change);
        let step = (self.rate * seconds).clamp(-self.most, self.most);
        let next = self.at + step;
        let is_inside = (low..=high).contains(&self.at);
        self.at = if is_inside {
            next.clamp(low, high)
        } else {
            next
        };
        if is_inside && self.at != next {
            self.rate = 0.0;
        }
    }
}

impl<P: Port> Head<P> {
    /// Follows a joystick until it returns `None`, and then brakes. Returns the direction of the
    /// last motion of each axis: -1, 0 or 1. Several axes may move at once. The joystick is asked
    /// before each reading of the axes. A contact is a collision, as in a jog; if the probe is
    /// pressed, all axes are slow.
    ///
    /// If nobody calls it any more, an axis stops at its last commanded position.
    ///
    /// # Errors
    ///
    /// [`Error`]. Then all axes are stopped.
    pub fn steer(
        &mut self,
        joystick: impl FnMut() -> Option<[Deflection; 3]>,
    ) -> Result<[i8; 3], Error> {
        self.supervised(|head| head.follow(joystick))
    }

    fn follow(
        &mut self,
        mut joystick: impl FnMut() -> Option<[Deflection; 3]>,
    ) -> Result<[i8; 3], Error> {
        let is_touching = self.is_touching()?;
        let far = self.leaving();
        let profiles = self.axes.iter().map(|axis| profile(axis, far));
        let mut profiles: Vec<Profile> = profiles.collect();
        let held: Vec<i32> = self.axes.iter().map(|axis| axis.held).collect();
        let mut watch = self.watch(&held);
        self.begin_watch(&mut watch, is_touching)?;
        let (mut ways, mut last) = ([0; 3], [0; 3]);
        let mut before_us = self.line.elapsed_us();
        loop {
            let wanted = joystick();
            let now = wanted.unwrap_or_default().map(Deflection::way);
            if now != ways {
                ways = now;
                self.begin_ways(ways)?;
                let moving =
                    (self.axes.iter()).filter(|axis| ways[axis.settings.coordinate()] != 0);
                watch.follow(moving.map(|axis| axis.settings.letter).collect());
            }
            let replies = self.read_moving(&watch)?;
            self.look(&mut watch, &replies)?;
            let is_slow = self.is_closed(&replies) || self.contact_at.is_some();
            let now_us = self.line.elapsed_us();
            let seconds = (now_us.saturating_sub(before_us) as f64 * 1e-6).min(MOST_INTERVAL_S);
            before_us = now_us;
            let mut is_moving = false;
            for (index, profile) in profiles.iter_mut().enumerate() {
                let axis = &self.axes[index];
                let coordinate = axis.settings.coordinate();
                let rate = match wanted.unwrap_or_default()[coordinate] {
                    Deflection::Centre => 0,
                    Deflection::Fast { .. } if !is_slow => axis.rate(self.probe.rate),
                    _ => self.probe.rate.min(axis.settings.rate),
                };
                profile.advance(f64::from(rate) * f64::from(ways[coordinate]), seconds);
                is_moving |= profile.rate != 0.0;
                // Within the travel, so it fits.
                let counts = profile.at.round() as i32;
                if counts != axis.held {
                    last[coordinate] = (counts - axis.held).signum() as i8;
                    self.hold(index, counts)?;
                }
            }
            if wanted.is_none() && !is_moving {
                break;
            }
        }
        let was_armed = self.end_watch(&mut watch)?;
        let replies = self.settle()?;
        if was_armed && self.is_closed(&replies) {
            return Err(self.collision(&watch));
        }
        Ok(last)
    }

    /// The axes begin to move in these directions.
    fn begin_ways(&mut self, ways: [i8; 3]) -> Result<(), Error> {
        // An axis that stands at an unknown end may leave it by this distance only: its profile
        // ends there.
        let far = self.leaving();
        let goals = self.axes.iter().map(|axis| {
            let way = i32::from(ways[axis.settings.coordinate()]);
            axis.held.saturating_add(way.saturating_mul(far))
        });
        let goals: Vec<i32> = goals.collect();
        self.check_ends(&goals)?;
        self.announce(&goals);
        self.head_for(&goals);
        Ok(())
    }
}

/// The profile of an axis at rest. At an unknown end it leads away by `far` counts only.
fn profile(axis: &super::servo::Servo, far: i32) -> Profile {
    let slack = axis.settings.in_position as i32;
    let [low, high] = axis.travel_counts();
    let mut ends = [low.saturating_add(slack), high.saturating_sub(slack)];
    if axis.is_at_end && axis.end.is_none() {
        // The axis must stay near its switch until the switch opens.
        let [least, most] = [axis.held.saturating_sub(far), axis.held.saturating_add(far)];
        ends = ends.map(|end| end.clamp(least, most));
    }
    Profile {
        at: axis.held.into(),
        rate: 0.0,
        acceleration: f64::from(axis.settings.acceleration),
        ends: ends.map(f64::from),
        most: (f64::from(axis.settings.gains.error_limit) / STEPS_OF_ERROR).clamp(1.0, MOST_STEP),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heads::{Line, Machine};
    use crate::simulated::{SimulatedNetwork, SimulatedPort, one_axis, three_axes};

    type Head = super::Head<SimulatedPort>;

    fn head(machine: &Machine, faces: &[&str]) -> Head {
        let faces: Vec<_> = faces.iter().map(|face| face.parse().unwrap()).collect();
        let network = SimulatedNetwork::of_machine(machine, &faces, None).unwrap();
        let mut head = Head::start(Line::new(SimulatedPort::new(network)), machine, 1).unwrap();
        head.axes.iter_mut().for_each(|axis| axis.is_homed = true);
        head
    }

    fn motors(head: &mut Head) -> Vec<i64> {
        let network = head.line.port().network.servo_network();
        let motors = (0..3).map_while(|module| network.motor(module));
        motors.map(|motor| motor.counts()).collect()
    }

    /// A joystick that is held like this for a time in periods of the loop.
    fn held(axes: [f64; 3], times: usize) -> impl FnMut() -> Option<[Deflection; 3]> {
        let mut left = times;
        move || {
            left = left.checked_sub(1)?;
            Some(axes.map(Deflection::of))
        }
    }

    #[test]
    fn a_deflection_has_two_speeds() {
        use Deflection::{Centre, Fast, Slow};
        let parts = [0.0, 0.09, -0.1, 0.59, 0.6, -1.0, f64::NAN].map(Deflection::of);
        let slow = |is_positive| Slow { is_positive };
        let fast = |is_positive| Fast { is_positive };
        assert_eq!(
            parts,
            [
                Centre,
                Centre,
                slow(false),
                slow(true),
                fast(true),
                fast(false),
                Centre
            ]
        );
    }

    #[test]
    fn several_axes_follow_and_brake() {
        let mut head = head(&three_axes(), &[]);
        let begun = head.line.elapsed_us();
        let last = head.steer(held([1.0, -0.3, 0.0], 100)).unwrap();
        let seconds = (head.line.elapsed_us() - begun) as f64 * 1e-6;
        assert_eq!(last, [1, -1, 0]);
        let at = motors(&mut head);
        let (fast, slow) = (at[0] as f64 / seconds, at[1] as f64 / seconds);
        // 1200 and 200 counts/s, with ramps of 0.2 s at 6000 counts/s^2.
        assert!((700.0..1200.0).contains(&fast), "{at:?} in {seconds} s");
        assert!((-200.0..-130.0).contains(&slow), "{at:?} in {seconds} s");
        assert!(at[2].abs() <= 1);
        // The head knows where the axes are held, so that the next move is straight.
        assert!((at[0] - i64::from(head.axes[0].held)).abs() <= 1);
        head.go_to([0; 3]).unwrap();
    }

    /// On the slow line of one axis, too.
    #[test]
    fn one_axis_reaches_its_speed() {
        let mut head = head(&one_axis(), &[]);
        let begun = head.line.elapsed_us();
        head.steer(held([1.0, 0.0, 0.0], 120)).unwrap();
        let seconds = (head.line.elapsed_us() - begun) as f64 * 1e-6;
        let mean = motors(&mut head)[0] as f64 / seconds;
        assert!((900.0..1200.0).contains(&mean), "{mean} counts/s");
    }

    #[test]
    fn it_ends_before_the_end_of_the_travel() {
        let mut machine = three_axes();
        machine.axes[1].travel = [-500, 300];
        let mut head = head(&machine, &[]);
        head.steer(held([0.0, 1.0, 0.0], 200)).unwrap();
        let at = motors(&mut head)[1];
        // Within the servo's error.
        assert!((295..=302).contains(&at), "{at}");
        head.steer(held([0.0, -1.0, 0.0], 200)).unwrap();
        let at = motors(&mut head)[1];
        assert!((-502..=-495).contains(&at), "{at}");
    }

    /// Nobody asks the joystick any more: the modules hold their last positions.
    #[test]
    fn without_the_program_nothing_moves_on() {
        let mut head = head(&three_axes(), &[]);
        let mut times = 0;
        let killed = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            head.steer(|| {
                times += 1;
                assert!(times < 80, "killed");
                Some([1.0, 0.0, 0.0].map(Deflection::of))
            })
        }));
        assert!(killed.is_err());
        let before = motors(&mut head)[0];
        let held = i64::from(head.axes[0].held);
        for _ in 0..4000 {
            head.line.port().network.tick();
        }
        let after = motors(&mut head)[0];
        // The lag of the servo, and no more.
        assert!(
            before > 300 && (held - after).abs() <= 2,
            "{before} {held} {after}"
        );
        assert!(after - before <= 40, "{} counts", after - before);
    }

    #[test]
    fn a_contact_is_a_collision_and_is_left_slowly() {
        let mut head = head(&three_axes(), &["1:900"]);
        let met = head.steer(held([1.0, 0.0, 0.0], 400));
        let Err(Error::Collision { axes, beyond, .. }) = met else {
            panic!("{met:?}")
        };
        assert_eq!(axes, "X");
        assert!(beyond.is_some() && head.has_collided());
        let at = motors(&mut head)[0];
        assert!((900..960).contains(&at), "{at}");
        head.steer(held([-1.0, 0.0, 0.0], 100)).unwrap();
        assert!(motors(&mut head)[0] < 800);
    }
}
