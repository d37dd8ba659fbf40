//! Moves and lines by hand, the work zero, and the backlash.

use super::Driver;
use crate::serve::axes::Axes;
use crate::serve::loaded::{Surroundings, Target};
use crate::serve::mill_program;
use crate::serve::reply::Reply;
use crate::serve::request::Frame;
use husillo_transports::micromill::{Axis, Line, Order, Point};
use std::sync::Arc;

/// Largest number of steps of one string.
const MOST_STEPS: i64 = 9999;
/// Largest number of steps of one request: 140 mm.
const MOST: i64 = 1_000_000;
/// Largest backlash of a string, um.
const MOST_UM: f64 = 999.0;
/// Longest line by hand, characters.
const LONGEST: usize = 255;

impl Driver<'_> {
    /// Moves by a distance in mm, one axis after the other.
    pub(super) fn step(&mut self, by: &Axes, reply: Reply) {
        let scales = self.place.config().axes.map(|axis| axis.scale);
        let steps = by.checked(3).and_then(|by| {
            let steps = by.iter().map(|(axis, mm)| {
                let scale = scales.get(*axis).ok_or("there is no such axis")?;
                let steps = scale.nearest((mm * 1e6).round() as i64);
                Ok((*axis, i64::from(steps.ok_or("this is too far")?)))
            });
            steps.collect::<Result<Vec<_>, String>>()
        });
        match steps {
            Ok(steps) => self.move_steps(&steps, reply),
            Err(why) => reply.error(why),
        }
    }

    /// Moves the motors by whole steps, one axis after the other.
    pub(super) fn steps(&mut self, by: &Axes, reply: Reply) {
        let steps = by.checked(3).and_then(|by| {
            let is_whole = by.iter().all(|(_, steps)| steps.fract() == 0.0);
            match is_whole {
                true => Ok(by
                    .iter()
                    .map(|(axis, steps)| (*axis, *steps as i64))
                    .collect()),
                false => Err("steps are whole numbers".to_owned()),
            }
        });
        match steps {
            Ok::<Vec<_>, _>(steps) => self.move_steps(&steps, reply),
            Err(why) => reply.error(why),
        }
    }

    fn move_steps(&mut self, by: &[(usize, i64)], reply: Reply) {
        let mut orders = Vec::new();
        for (axis, steps) in by {
            let Some(axis) = Axis::ALL.get(*axis) else {
                continue;
            };
            if steps.abs() > MOST {
                return reply.error(format!("{MOST} steps at most"));
            }
            let mut left = *steps;
            while left != 0 {
                let part = left.clamp(-MOST_STEPS, MOST_STEPS);
                orders.push(Order::Steps(*axis, part as i16)); // four digits
                left -= part;
            }
        }
        self.by_hand(orders, reply);
    }

    /// Moves to a position at the rapid rate: Z up first, Z down last.
    pub(super) fn go(&mut self, to: &Axes, frame: Frame, reply: Reply) {
        let lines = to.checked(3).and_then(|to| self.ways(&to, frame));
        match lines {
            Ok(lines) => self.by_hand(lines.into_iter().map(Order::Line).collect(), reply),
            Err(why) => reply.error(why),
        }
    }

    fn ways(&self, to: &[(usize, f64)], frame: Frame) -> Result<Vec<Line>, String> {
        let unknown = "the mill is not homed, so its position is not known";
        let zero = self.place.zero_mm().ok_or(unknown)?;
        let at = self.place.machine_mm().ok_or(unknown)?;
        // Strings count in hundredths of um from the work zero.
        let mut points = [None; 3];
        for (axis, mm) in to {
            let from = if frame == Frame::Machine {
                zero.get(*axis)
            } else {
                None
            };
            let units = ((mm - from.unwrap_or(&0.0)) * 1e5).round();
            if units.abs() >= 1e7 {
                return Err("this is farther than a string can say".into());
            }
            if let Some(point) = points.get_mut(*axis) {
                *point = Some(units as i32);
            }
        }
        let [x, y, z] = points;
        let flat = (x.is_some() || y.is_some()).then_some(Line::Rapid(Point::Xy([x, y])));
        let height = z.map(|z| Line::Rapid(Point::Z(z)));
        let rises = z.is_some_and(|z| {
            let now = at
                .get(2)
                .zip(zero.get(2))
                .map_or(0.0, |(at, zero)| at - zero);
            f64::from(z) / 1e5 > now
        });
        let both = if rises {
            [height, flat]
        } else {
            [flat, height]
        };
        Ok(both.into_iter().flatten().collect())
    }

    /// Makes the present position the work zero of all axes.
    pub(super) fn zero(&mut self, at: &Axes, reply: Reply) {
        match at.checked(3) {
            Err(why) => reply.error(why),
            Ok(at) if at.len() == 3 && at.iter().all(|(_, mm)| *mm == 0.0) => {
                if !self.place.is_homed() {
                    return reply.error("home the mill first: it does not know where it is");
                }
                self.by_hand(vec![Order::Zero], reply);
            }
            Ok(_) => reply.error("a mill sets the work zero of X, Y and Z at once, to 0"),
        }
    }

    /// Sets the backlash of axes, um.
    pub(super) fn backlash(&mut self, um: &Axes, reply: Reply) {
        let orders = um.checked(3).and_then(|um| {
            let orders = um.iter().map(|(axis, um)| {
                let axis = Axis::ALL.get(*axis).ok_or("there is no such axis")?;
                match (0.0..=MOST_UM).contains(um) && um.fract() == 0.0 {
                    true => Ok(Order::Backlash(*axis, *um as u16)),
                    false => Err(format!("a backlash is 0 to {MOST_UM} um")),
                }
            });
            orders.collect()
        });
        match orders {
            Ok(orders) => self.by_hand(orders, reply),
            Err(why) => reply.error(why),
        }
    }

    /// Carries out a line that the operator has typed: a string of the mill, or a line of G-code.
    pub(super) fn line(&mut self, text: &str, reply: Reply) {
        match self.orders_of(text) {
            Ok(orders) => self.by_hand(orders, reply),
            Err(why) => reply.error(why),
        }
    }

    fn orders_of(&self, text: &str) -> Result<Vec<Order>, String> {
        if text.len() > LONGEST {
            return Err(format!("a line has at most {LONGEST} characters"));
        }
        let plain: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        let string = plain.trim_end_matches(';').to_ascii_uppercase();
        match Order::read(string.as_bytes()) {
            Some(Order::Jog(_) | Order::Run(..)) => {
                return Err("this motion has no end: hold a button of the page instead".into());
            }
            Some(
                Order::Stream(_)
                | Order::Lease(_)
                | Order::Renew
                | Order::Every(_)
                | Order::Report
                | Order::Faster
                | Order::Slower,
            ) => return Err("this program uses this string itself".into()),
            Some(order) => return Ok(vec![order]),
            None => {}
        }
        self.is_free()?;
        if !self.place.is_homed() {
            return Err("home the mill first: a line needs its position".into());
        }
        let made = mill_program::lines("line", text.as_bytes(), &self.surroundings())?;
        if made.lines.is_empty() {
            return Err(
                "this is no string of the mill, and no line of G-code that moves it".into(),
            );
        }
        Ok(made
            .lines
            .iter()
            .map(|(_, line)| Order::Line(*line))
            .collect())
    }

    /// What a program is checked against.
    pub(super) fn surroundings(&self) -> Surroundings {
        Surroundings {
            target: Target::Micromill(Arc::clone(self.file)),
            zero_mm: self.place.zero_mm().unwrap_or_default(),
            at_mm: self.place.machine_mm().unwrap_or_default(),
        }
    }
}
