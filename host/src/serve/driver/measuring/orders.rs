//! Motions by hand, touches, the zero and the tip.

use super::{Driver, Job, Purpose};
use crate::serve::axes::Axes;
use crate::serve::reply::Reply;
use crate::serve::request::{Frame, Tip, Touch};
use husillo_metrology::Scale;
use husillo_metrology::calibration::Face;
use husillo_metrology::heads::{Approach, pre_travel_by_sign};
use husillo_probe::UnitVector;

/// Most slow touches in a mean.
const MOST_TOUCHES: u8 = 50;
/// A direction is a whole number of these.
const PARTS: f64 = 1e6;

/// A value of a page as an amount: mm or, where the length of a count is not known, counts.
pub(super) fn amount(scale: Scale, value: f64) -> i64 {
    // The cast saturates far outside of any travel.
    match scale.count_mm() {
        Some(_) => (value * 1e6).round() as i64,
        None => value.round() as i64,
    }
}

impl Driver<'_> {
    /// Values for axes of this machine.
    pub(super) fn checked(&self, axes: &Axes) -> Result<Vec<(usize, f64)>, String> {
        axes.checked(self.config.axes.len())
    }

    /// Homes an axis, or all: Z first, so that the probe rises from the part.
    pub(super) fn home(&mut self, axis: Option<char>, reply: Reply) {
        let axes = match axis {
            Some(letter) => match self.config.axis(letter) {
                Ok(axis) => vec![axis.coordinate()],
                Err(why) => return reply.error(why),
            },
            None => {
                let axes = self.config.axes.iter().map(|axis| axis.coordinate());
                let mut axes: Vec<_> = axes.collect();
                axes.sort_by_key(|axis| if *axis == 2 { 0 } else { axis + 1 });
                axes
            }
        };
        match self.is_free() {
            Ok(()) => self.start(Job::Home(axes), Purpose::Asked(reply), "Home"),
            Err(why) => reply.error(why),
        }
    }

    /// Moves to a position along a straight line.
    pub(super) fn go(&mut self, to: &Axes, frame: Frame, is_rapid: bool, reply: Reply) {
        let checked = self.is_free().and_then(|()| self.checked(to));
        let to: Vec<_> = match checked {
            Ok(to) => {
                let amounts = to.into_iter();
                amounts
                    .map(|(axis, value)| (axis, amount(self.config.scale, value)))
                    .collect()
            }
            Err(why) => return reply.error(why),
        };
        self.place.set_target(Some((&to, frame)));
        let job = Job::GoTo {
            to,
            is_machine: frame == Frame::Machine,
            approach: match is_rapid {
                true => Approach::Rapid,
                false => Approach::Guarded,
            },
        };
        self.start(job, Purpose::Asked(reply), "Run");
    }

    /// Moves by a distance.
    pub(super) fn step(&mut self, by: &Axes, reply: Reply) {
        let checked = self.is_free().and_then(|()| self.checked(by));
        let by = match checked {
            Ok(by) => by,
            Err(why) => return reply.error(why),
        };
        let held = self.place.held();
        let to: Vec<_> = by
            .into_iter()
            .map(|(axis, value)| {
                let from = held.get(axis).copied().unwrap_or_default();
                (axis, from.saturating_add(amount(self.config.scale, value)))
            })
            .collect();
        self.place.set_target(Some((&to, Frame::Work)));
        let job = Job::GoTo {
            to,
            is_machine: false,
            approach: Approach::Guarded,
        };
        self.start(job, Purpose::Asked(reply), "Run");
    }

    /// Makes the present position of axes the zero.
    pub(super) fn zero(&mut self, at: &Axes, reply: Reply) {
        let checked = self.is_free().and_then(|()| self.checked(at));
        match checked {
            Ok(at) if at.iter().all(|(_, value)| *value == 0.0) => {
                let axes = at.into_iter().map(|(axis, _)| axis).collect();
                self.start(Job::Zero(axes), Purpose::Asked(reply), "Run");
            }
            Ok(_) => reply.error("the zero of an axis is set where it stands: send 0"),
            Err(why) => reply.error(why),
        }
    }

    /// Touches the part, and with a reference calibrates the pre-travel.
    pub(super) fn touch(&mut self, asked: &Touch, reply: Reply) {
        match self.is_free().and_then(|()| self.touch_of(asked)) {
            Ok(job) => self.start(job, Purpose::Asked(reply), "Probe"),
            Err(why) => reply.error(why),
        }
    }

    fn touch_of(&self, asked: &Touch) -> Result<Job, String> {
        let scale = self.config.scale;
        let mut parts = [0; 3];
        let towards = self.checked(&asked.towards)?;
        for (axis, part) in &towards {
            if let Some(way) = parts.get_mut(*axis) {
                *way = (part * PARTS).round() as i64;
            }
        }
        let way = UnitVector::new(parts).ok_or("a touch needs a direction")?;
        let within = match asked.within {
            None => u64::MAX,
            Some(within) if within.is_finite() && within > 0.0 => {
                amount(scale, within).unsigned_abs().max(1)
            }
            Some(_) => return Err("the longest distance of a touch is more than 0".into()),
        };
        if !(1..=MOST_TOUCHES).contains(&asked.touches) {
            return Err(format!("1 to {MOST_TOUCHES} slow touches"));
        }
        let moving: Vec<_> = (0..3).filter(|axis| parts[*axis] != 0).collect();
        let face = match (asked.reference, &moving[..]) {
            (None, _) => None,
            (Some(at), [axis]) if at.is_finite() => Some(Face {
                axis: *axis,
                position: amount(scale, at),
            }),
            (Some(_), _) => {
                return Err("the pre-travel is calibrated in the direction of one axis".into());
            }
        };
        Ok(Job::Touch {
            towards: way,
            within,
            touches: asked.touches,
            face,
        })
    }

    /// Sets pre-travel and radius of the tip.
    pub(super) fn set_tip(&mut self, asked: Tip, reply: Reply) {
        if let Err(why) = self.is_free() {
            return reply.error(why);
        }
        let scale = self.config.scale;
        let mut tip = self.place.stylus();
        let small = |value: f64, least: f64| {
            let made = i32::try_from(amount(scale, value)).ok();
            made.filter(|_| value.is_finite() && value >= least)
        };
        if let Some(values) = asked.pre_travel {
            let [Some(plus), Some(minus)] = values.map(|value| small(value, -1e9)) else {
                return reply.error("this pre-travel is out of range");
            };
            tip.pre_travel = pre_travel_by_sign([plus, minus]);
        }
        if let Some(radius) = asked.ball {
            let Some(radius) = small(radius, 0.0) else {
                return reply.error("the radius of the ball is out of range");
            };
            tip.radius_nm = radius;
        }
        self.start(Job::Tip(Box::new(tip)), Purpose::Asked(reply), "Run");
    }
}
