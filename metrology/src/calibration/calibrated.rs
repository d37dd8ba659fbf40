//! A machine whose known errors are corrected. Positions and goals are true positions.

use crate::error::Error;
use crate::heads::{
    AxisPosition, Deflection, Errors, Head, Memory, Port, Probed, Prober, Touched, View,
};
use husillo_backlash::{ErrorTable, Flank};
use husillo_probe::{Edge, Measurement, UnitVector};
use std::cmp::Ordering;
use std::rc::Rc;

/// A prober whose errors are corrected. Its goals and positions are true positions on square axes.
/// The prober behind it works with readings and keeps its own zero.
#[derive(Debug)]
pub struct Calibrated<P> {
    prober: P,
    errors: Errors,
    /// The errors in use. The table of an axis is used only after homing.
    view: View,
    /// The readings of the last goal, while the machine is there. If an axis has the same goal
    /// again, it does not move, even if it stands slightly off. So it does not reverse.
    sent: Option<[i64; 3]>,
}

impl<P: Prober> Calibrated<P> {
    /// Creates a prober with these errors. It has not moved yet and is not homed.
    pub fn new(prober: P, errors: Errors) -> Self {
        let mut in_force = errors.clone();
        for axis in &mut in_force.axes {
            // The same scale without entries. The scale is valid, because it comes from a table.
            *axis = ErrorTable::new(axis.scale_ppb(), Vec::new()).unwrap_or_default();
        }
        Self {
            prober,
            errors,
            view: View::new(in_force),
            sent: None,
        }
    }

    /// Returns the prober without corrections.
    pub const fn inner(&mut self) -> &mut P {
        &mut self.prober
    }

    /// Returns the readings of the last goal, or of the present position if there is none.
    fn from(&mut self) -> Result<[i64; 3], Error> {
        match self.sent {
            Some(sent) => Ok(sent),
            None => self.prober.position(),
        }
    }

    /// Begins to use the table of an axis, because its readings now count from its index.
    pub fn set_homed(&mut self, coordinate: usize) {
        let in_force = Rc::make_mut(&mut self.view.errors);
        in_force.axes[coordinate].clone_from(&self.errors.axes[coordinate]);
        self.view.zero[coordinate] = 0;
    }

    /// Checks before a move that positions are known on all axes.
    ///
    /// # Errors
    ///
    /// [`Error::NotHomed`].
    fn begin(&mut self) -> Result<(), Error> {
        let tables = self.errors.axes.iter().zip(&self.view.errors.axes);
        for (axis, (whole, in_force)) in "XYZ".chars().zip(tables) {
            if whole != in_force {
                return Err(Error::NotHomed { axis });
            }
        }
        self.prober.see_as(&self.view);
        Ok(())
    }

    /// Returns the readings of a goal for a move that begins at `from`, and the flanks after the
    /// move.
    fn reading_of(&self, from: [i64; 3], goal: [i64; 3]) -> ([i64; 3], [Flank; 3]) {
        let goal = [0, 1, 2].map(|axis: usize| goal[axis].saturating_add(self.view.zero[axis]));
        // If axes are not square, a move along one coordinate also moves other axes. So only the
        // readings show which axes reverse.
        let there = self.view.errors.reading_nm(goal, self.view.flanks);
        let mut flanks = self.view.flanks;
        for (flank, (from, to)) in flanks.iter_mut().zip(from.into_iter().zip(there)) {
            *flank = match to.cmp(&from) {
                Ordering::Greater => Flank::Positive,
                Ordering::Less => Flank::Negative,
                Ordering::Equal => *flank,
            };
        }
        (self.view.errors.reading_nm(goal, flanks), flanks)
    }

    /// After a failure the direction of the last move of the axes is unknown.
    fn lost(&mut self, error: Error) -> Error {
        if error.has_moved() {
            self.view.flanks = [Flank::Unknown; 3];
        }
        error
    }

    /// Makes a move. `go` receives the prober and the readings of the goal.
    fn go_with(
        &mut self,
        goal: [i64; 3],
        go: impl FnOnce(&mut P, [i64; 3]) -> Result<Probed, Error>,
    ) -> Result<Probed, Error> {
        self.begin()?;
        let from = self.from()?;
        let (reading, flanks) = self.reading_of(from, goal);
        // A move that fails leaves the axes at any position.
        self.sent = None;
        let ended = go(&mut self.prober, reading).map_err(|error| self.lost(error))?;
        self.view.flanks = flanks;
        if ended.changed_nm.is_none() {
            self.sent = Some(reading);
        }
        let position_of = |readings| self.view.position_from(readings, flanks);
        Ok(Probed {
            changed_nm: ended.changed_nm.map(position_of),
            at_nm: position_of(ended.at_nm),
        })
    }

    /// Makes a touch. `touch` receives the prober, and the direction and the distance on its axes.
    /// Returns the result of `touch` and the flanks at the contact.
    fn touch_with<T>(
        &mut self,
        direction: &UnitVector,
        distance: u64,
        touch: impl FnOnce(&mut P, &UnitVector, u64) -> Result<T, Error>,
    ) -> Result<(T, [Flank; 3]), Error> {
        self.begin()?;
        let start = self.from()?;
        let from = self.view.position_from(start, self.view.flanks);
        // A straight line is also straight in readings, except that a table bends it slightly. A
        // distance of 17 m gives the direction accurately enough.
        let part = distance.min(1 << 34);
        let ahead = direction.scaled(part as i64);
        let goal = [0, 1, 2].map(|axis: usize| from[axis].saturating_add(ahead[axis]));
        let (end, flanks) = self.reading_of(start, goal);
        let along = [0, 1, 2].map(|axis: usize| end[axis].saturating_sub(start[axis]));
        let leaned = UnitVector::new(along).unwrap_or(*direction);
        let squares = along.iter().map(|part| (*part as f64).powi(2));
        let length = squares.sum::<f64>().sqrt() / (part.max(1) as f64) * distance as f64;
        self.sent = None;
        let touched = touch(&mut self.prober, &leaned, length.round() as u64)
            .map_err(|error| self.lost(error))?;
        // The probe has backed off, so the axes that moved have reversed.
        let ways = along.into_iter().zip(flanks);
        for (flank, (along, at_contact)) in self.view.flanks.iter_mut().zip(ways) {
            *flank = match (along, at_contact) {
                (0, _) => *flank,
                (_, Flank::Positive) => Flank::Negative,
                (_, Flank::Negative) => Flank::Positive,
                (_, Flank::Unknown) => Flank::Unknown,
            };
        }
        Ok((touched, flanks))
    }
}

impl<P: Prober> Prober for Calibrated<P> {
    fn position(&mut self) -> Result<[i64; 3], Error> {
        let readings = self.prober.position()?;
        Ok(self.view.position_from(readings, self.view.flanks))
    }

    fn go_to(&mut self, goal_nm: [i64; 3]) -> Result<[i64; 3], Error> {
        self.go_with(goal_nm, |prober, goal| Ok(undisturbed(prober.go_to(goal)?)))
            .map(|ended| ended.at_nm)
    }

    fn guarded_to(&mut self, goal_nm: [i64; 3]) -> Result<[i64; 3], Error> {
        self.go_with(goal_nm, |prober, goal| {
            Ok(undisturbed(prober.guarded_to(goal)?))
        })
        .map(|ended| ended.at_nm)
    }

    // The errors of the axes are too small to matter for a speed.
    fn feed_to(&mut self, goal_nm: [i64; 3], nm_per_min: u64) -> Result<[i64; 3], Error> {
        self.go_with(goal_nm, |prober, goal| {
            Ok(undisturbed(prober.feed_to(goal, nm_per_min)?))
        })
        .map(|ended| ended.at_nm)
    }

    fn probe_to(
        &mut self,
        goal_nm: [i64; 3],
        nm_per_min: u64,
        until: Edge,
    ) -> Result<Probed, Error> {
        self.go_with(goal_nm, |prober, goal| {
            prober.probe_to(goal, nm_per_min, until)
        })
    }

    fn has_collided(&self) -> bool {
        self.prober.has_collided()
    }

    fn touch(&mut self, direction: &UnitVector, distance_nm: u64) -> Result<Touched, Error> {
        let (touched, flanks) = self.touch_with(direction, distance_nm, P::touch)?;
        Ok(Touched {
            centre_nm: self.view.position_from(touched.centre_nm, flanks),
            ..touched
        })
    }
}

/// The result of a move that ends at its goal.
const fn undisturbed(at_nm: [i64; 3]) -> Probed {
    Probed {
        changed_nm: None,
        at_nm,
    }
}

impl<P: Port> Calibrated<Head<P>> {
    /// The commanded position.
    pub fn held(&self) -> [i64; 3] {
        let readings = self.sent.unwrap_or(self.prober.held());
        self.view.position_from(readings, self.view.flanks)
    }

    /// Holds the axes and returns the commanded position, from which a move of some axes begins.
    /// After a stop or a failure that is where they have come to rest, and [`Self::held`] still the
    /// goal that was not reached.
    ///
    /// # Errors
    ///
    /// No answer, or the stop of the operator.
    pub fn hold(&mut self) -> Result<[i64; 3], Error> {
        if self.prober.is_astray() {
            // The goal was not reached, or is not held any more.
            self.sent = None;
        }
        self.prober.find_again()?;
        Ok(self.held())
    }

    /// Returns the positions of the axes, in all coordinates.
    ///
    /// # Errors
    ///
    /// No answer.
    pub fn axis_positions(&mut self) -> Result<Vec<AxisPosition>, Error> {
        let replies = self.prober.read_twice()?;
        let readings = self.prober.place_of(&replies);
        let place = self.view.errors.position_nm(readings, self.view.flanks);
        let axes = self.prober.axes.iter().zip(&replies);
        let axes = axes.map(|(axis, reply)| {
            let coordinate = axis.settings.coordinate();
            let machine = place[coordinate];
            AxisPosition {
                coordinate,
                machine: axis.is_homed.then_some(machine),
                work: machine.saturating_sub(self.view.zero[coordinate]),
                zero: self.view.zero[coordinate],
                counts: reply.readings.position,
            }
        });
        Ok(axes.collect())
    }

    /// Returns the state that the session leaves in the modules, with zeros and directions of
    /// approach.
    ///
    /// # Errors
    ///
    /// No answer, or an axis that does not come to rest.
    pub fn memory(&mut self) -> Result<Memory, Error> {
        let mut memory = self.prober.memory()?;
        for axis in &mut memory.axes {
            let coordinate = "XYZ".find(axis.letter).unwrap_or_default();
            axis.zero = self.view.zero[coordinate];
            axis.flank = self.view.flanks[coordinate];
        }
        Ok(memory)
    }

    /// Restores zeros, homes and directions of approach of an earlier session. The head must have
    /// rejoined the same modules.
    pub fn recall(&mut self, memory: &Memory) {
        for axis in &memory.axes {
            let coordinate = "XYZ".find(axis.letter).unwrap_or_default();
            if axis.is_homed {
                self.set_homed(coordinate);
            }
            self.view.zero[coordinate] = axis.zero;
            self.view.flanks[coordinate] = axis.flank;
        }
        self.sent = None;
    }

    /// Makes the measured position of an axis 0. The held position may differ from it slightly, and
    /// does not change.
    ///
    /// # Errors
    ///
    /// There is no such axis, or no answer.
    pub fn set_zero(&mut self, coordinate: usize) -> Result<(), Error> {
        self.prober.index(coordinate)?;
        let present = self.position()?;
        self.view.zero[coordinate] += present[coordinate];
        Ok(())
    }

    /// Homes on the index as [`Head::home`] does. The index becomes 0 of the readings, from which
    /// the errors count.
    ///
    /// # Errors
    ///
    /// Those of [`Head::home`].
    pub fn home(&mut self, coordinate: usize) -> Result<(), Error> {
        self.sent = None;
        self.prober.see_as(&self.view);
        self.prober
            .home(coordinate)
            .map_err(|error| self.lost(error))?;
        self.set_homed(coordinate);
        // The axis ran beyond the index and came back.
        self.view.flanks[coordinate] = Flank::Negative;
        Ok(())
    }

    /// Runs an axis as [`Head::jog`] does.
    ///
    /// # Errors
    ///
    /// Those of [`Head::jog`].
    pub fn jog(
        &mut self,
        coordinate: usize,
        is_positive: bool,
        seconds: f64,
        is_slow: bool,
    ) -> Result<(), Error> {
        self.sent = None;
        self.prober.see_as(&self.view);
        self.prober
            .jog(coordinate, is_positive, seconds, is_slow)
            .map_err(|error| self.lost(error))?;
        self.view.flanks[coordinate] = if is_positive {
            Flank::Positive
        } else {
            Flank::Negative
        };
        Ok(())
    }

    /// Follows a joystick as [`Head::steer`] does.
    ///
    /// # Errors
    ///
    /// Those of [`Head::steer`].
    pub fn steer(
        &mut self,
        joystick: impl FnMut() -> Option<[Deflection; 3]>,
    ) -> Result<(), Error> {
        self.sent = None;
        self.prober.see_as(&self.view);
        let last = self
            .prober
            .steer(joystick)
            .map_err(|error| self.lost(error))?;
        for (flank, way) in self.view.flanks.iter_mut().zip(last) {
            *flank = match way {
                1.. => Flank::Positive,
                0 => *flank,
                ..0 => Flank::Negative,
            };
        }
        Ok(())
    }

    /// Touches as [`Head::touch`] does, and returns all its figures.
    ///
    /// # Errors
    ///
    /// Those of [`Head::touch`].
    pub fn measure(&mut self, direction: &UnitVector, distance: u64) -> Result<Measurement, Error> {
        let (mut measurement, flanks) = self.touch_with(direction, distance, Head::touch)?;
        let touch = &mut measurement.touch;
        touch.position = self.view.position_from(touch.position, flanks);
        // If axes are not square, the direction of the readings was different.
        touch.direction = *direction;
        Ok(measurement)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::{AxisFit, Reading, SquareFit};

    /// A machine with wrong scales and angles. It computes true positions from readings, in nm.
    #[derive(Clone, Copy)]
    struct Wrong {
        scales: [f64; 3],
        /// XY, XZ, YZ.
        leans: [f64; 3],
        /// Amplitude of the pitch error of all axes, whose period is 40 mm.
        pitch: f64,
        /// Backlash of all axes.
        play: f64,
        count: i64,
        at: [i64; 3],
        flanks: [Flank; 3],
        /// True position of a face perpendicular to X.
        face: f64,
    }

    impl Wrong {
        /// Scale errors of 50 um/m and leans of 100 um/m, with both signs.
        const ASKED: Wrong = Wrong {
            scales: [50e-6, -50e-6, 50e-6],
            leans: [100e-6, -100e-6, 100e-6],
            pitch: 0.0,
            play: 0.0,
            count: 2000,
            at: [0; 3],
            flanks: [Flank::Unknown; 3],
            face: f64::INFINITY,
        };

        fn truth(&self, reading: [f64; 3], flanks: [Flank; 3]) -> [f64; 3] {
            let along = |axis: usize| {
                let play = match flanks[axis] {
                    Flank::Positive => 0.5 * self.play,
                    Flank::Negative => -0.5 * self.play,
                    Flank::Unknown => 0.0,
                };
                let turn = (reading[axis] / 40e6 * std::f64::consts::TAU).sin();
                reading[axis] * (1.0 + self.scales[axis]) + self.pitch * turn + play
            };
            let [x, y, z] = [along(0), along(1), along(2)];
            let [xy, xz, yz] = self.leans;
            [x + xy * y + xz * z, y + yz * z, z]
        }

        /// Readings at a true position, in whole counts.
        fn reading(&self, truth: [f64; 3], flanks: [Flank; 3]) -> [i64; 3] {
            let mut reading = truth;
            for _ in 0..40 {
                let there = self.truth(reading, flanks);
                for axis in 0..3 {
                    reading[axis] -= there[axis] - truth[axis];
                }
            }
            reading.map(|nm| (nm / self.count as f64).round() as i64 * self.count)
        }

        /// The measured centre of a ball that is touched at 25 points. This averages the rounding
        /// to counts.
        fn ball(&self, truth: [f64; 3], flanks: [Flank; 3]) -> [i64; 3] {
            let mut sum = [0.0; 3];
            for touch in 0..25 {
                let radius =
                    [0.61, 0.38, 0.83].map(|part: f64| (part * f64::from(touch)).fract() * 10e6);
                let place = [0, 1, 2].map(|axis| truth[axis] + radius[axis]);
                let reading = self.reading(place, flanks);
                for axis in 0..3 {
                    sum[axis] += reading[axis] as f64 - radius[axis];
                }
            }
            sum.map(|sum| (sum / 25.0).round() as i64)
        }

        fn real(&self) -> [f64; 3] {
            self.truth(self.at.map(|nm| nm as f64), self.flanks)
        }
    }

    impl Prober for Wrong {
        fn has_collided(&self) -> bool {
            false
        }

        fn position(&mut self) -> Result<[i64; 3], Error> {
            Ok(self.at)
        }

        fn go_to(&mut self, goal: [i64; 3]) -> Result<[i64; 3], Error> {
            for ((at, flank), goal) in self.at.iter_mut().zip(&mut self.flanks).zip(goal) {
                let to = (goal as f64 / self.count as f64).round() as i64 * self.count;
                *flank = Flank::towards((to - *at).signum() as i8).unwrap_or(*flank);
                *at = to;
            }
            Ok(self.at)
        }

        fn guarded_to(&mut self, goal: [i64; 3]) -> Result<[i64; 3], Error> {
            self.go_to(goal)
        }

        fn feed_to(&mut self, goal: [i64; 3], _: u64) -> Result<[i64; 3], Error> {
            self.go_to(goal)
        }

        /// Moves in steps of a count of the longest distance.
        fn probe_to(&mut self, goal: [i64; 3], _: u64, until: Edge) -> Result<Probed, Error> {
            let from = self.at;
            let way = [0, 1, 2].map(|axis: usize| goal[axis] - from[axis]);
            let steps = way.iter().map(|way| way.abs()).max().unwrap_or(0) / self.count;
            let at = |step: i64| [0, 1, 2].map(|axis: usize| from[axis] + way[axis] * step / steps);
            for step in 1..=steps {
                let there = self.go_to(at(step))?;
                if (self.real()[0] >= self.face) == until.level() {
                    return Ok(Probed {
                        changed_nm: Some(there),
                        // The braking distance.
                        at_nm: self.go_to(at(step + 3))?,
                    });
                }
            }
            Ok(undisturbed(self.at))
        }

        fn touch(&mut self, direction: &UnitVector, way: u64) -> Result<Touched, Error> {
            let from = self.at;
            // Bisection of the distance to the face.
            let (mut free, mut beyond) = (0, way as i64);
            while beyond - free > 1 {
                let middle = (free + beyond) / 2;
                let step = direction.scaled(middle);
                self.go_to([0, 1, 2].map(|axis: usize| from[axis] + step[axis]))?;
                let is_free = self.real()[0] < self.face;
                *(if is_free { &mut free } else { &mut beyond }) = middle;
                self.at = from;
            }
            assert!(beyond < way as i64, "no contact");
            let step = direction.scaled(beyond);
            let centre_nm = self.go_to([0, 1, 2].map(|axis: usize| from[axis] + step[axis]))?;
            let back = direction.scaled(beyond - 1_000_000);
            self.go_to([0, 1, 2].map(|axis: usize| from[axis] + back[axis]))?;
            Ok(Touched {
                centre_nm,
                touches: 1,
                spread_nm: 0,
            })
        }
    }

    /// The errors that are found with three passes of reference lengths every 10 mm, and with a bar
    /// of 250 mm.
    fn calibrated(machine: &Wrong) -> Errors {
        let mut errors = Errors::default();
        for axis in 0..3 {
            let mut readings = Vec::new();
            // The passes are shifted, so that their lengths round to different counts.
            let pass = |shift: f64| (-20..20).map(move |step| f64::from(step) * 10.0 + shift);
            for nominal in [0.0, 3.3337, 6.6671].into_iter().flat_map(pass) {
                for flank in [Flank::Positive, Flank::Negative] {
                    let mut truth = [0.0; 3];
                    truth[axis] = nominal * 1e6;
                    // The reference lengths lie along the axis, even if it is not square.
                    let alone = Wrong {
                        leans: [0.0; 3],
                        ..*machine
                    };
                    readings.push(Reading {
                        nominal: (nominal * 1e6).round() as i64,
                        reading: alone.reading(truth, [flank; 3])[axis],
                        flank,
                    });
                }
            }
            let fit = AxisFit::new(&readings, 2000.0, false);
            errors.axes[axis] = fit.unwrap().table;
        }
        // The positions of the machine with its axes corrected.
        let mut places = Vec::new();
        let half = 125e6 / 2.0_f64.sqrt();
        for (a, b) in [(0, 1), (0, 2), (1, 2)] {
            for side in [1.0, -1.0] {
                for place in 0..4 {
                    let centre =
                        [0.37, -0.21, 0.11].map(|part: f64| part * f64::from(place) * 50e6);
                    places.push([-1.0, 1.0].map(|end| {
                        let mut truth = centre;
                        truth[a] += end * half;
                        truth[b] += end * side * half;
                        let flanks = [Flank::Positive; 3];
                        errors.position_nm(machine.ball(truth, flanks), flanks)
                    }));
                }
            }
        }
        errors.squareness = SquareFit::new(&places, None).unwrap().squareness;
        errors
    }

    /// The machine with its known errors. Its present position is its home.
    fn homed(machine: Wrong, errors: Errors) -> Calibrated<Wrong> {
        let mut calibrated = Calibrated::new(machine, errors);
        (0..3).for_each(|axis| calibrated.set_homed(axis));
        calibrated
    }

    /// Largest error of the reported position, and of the goal, over the range of the calibrated
    /// machine, nm. Errors are relative to the first position.
    fn worst(machine: &Wrong, errors: Errors) -> [f64; 2] {
        let mut calibrated = homed(*machine, errors);
        let mut worst = [0.0f64; 2];
        let mut origin = None;
        // These are not the positions of the calibration.
        for x in -5..=5 {
            for y in -5..=5 {
                for z in -5..=5 {
                    let goal = [x, y, z].map(|step: i64| step * 38_300_000 + 4_100_000);
                    let goal = if (x + y + z) % 2 == 0 {
                        goal
                    } else {
                        goal.map(|nm| -nm)
                    };
                    let there = calibrated.go_to(goal).unwrap();
                    let truth = calibrated.inner().real();
                    let errors =
                        |to: [i64; 3]| [0, 1, 2].map(|axis: usize| truth[axis] - to[axis] as f64);
                    // Reference lengths do not determine an absolute position.
                    let origin = *origin.get_or_insert(errors(there));
                    for (worst, to) in worst.iter_mut().zip([there, goal]) {
                        for (error, origin) in errors(to).into_iter().zip(origin) {
                            *worst = worst.max((error - origin).abs());
                        }
                    }
                }
            }
        }
        worst
    }

    #[test]
    fn scale_and_squareness_fall_below_a_micrometre() {
        let machine = Wrong::ASKED;
        let [before, _] = worst(&machine, Errors::default());
        assert!(before > 50_000.0, "{before}");
        let errors = calibrated(&machine);
        let [known, sent] = worst(&machine, errors);
        println!(
            "{before} nm before, {known} nm after, {sent} nm from the goal with its half count"
        );
        assert!(known < 1000.0 && sent < known + 1050.0, "{known} {sent}");
    }

    #[test]
    fn pitch_and_play_as_well() {
        let machine = Wrong {
            pitch: 3000.0,
            play: 4000.0,
            count: 100,
            ..Wrong::ASKED
        };
        let errors = calibrated(&machine);
        assert_eq!(errors.axes[1].knots().len(), 120);
        let [known, _] = worst(&machine, errors);
        println!("{known} nm");
        assert!(known < 1000.0, "{known}");
    }

    #[test]
    fn a_touch_is_where_the_face_is() {
        let mut machine = Wrong {
            face: 31_234_567.0,
            count: 100,
            ..Wrong::ASKED
        };
        machine.go_to([0, 80_000_000, -60_000_000]).unwrap();
        let errors = calibrated(&machine);
        let mut calibrated = homed(machine, errors);
        calibrated
            .go_to([5_000_000, 90_000_000, 70_000_000])
            .unwrap();
        let touched = calibrated.touch(&UnitVector::X, 60_000_000).unwrap();
        let [x, y, z] = touched.centre_nm;
        assert!(x.abs_diff(31_234_567) < 200, "{touched:?}");
        // The touch was perpendicular to the face, not along the axis.
        assert!(
            y.abs_diff(90_000_000) < 200 && z.abs_diff(70_000_000) < 200,
            "{touched:?}"
        );
        // On the way to the face and off it the contact changes at the same position. The machine
        // stops beyond this position.
        for (goal, until) in [
            (32_000_000, Edge::Made),
            (30_000_000, Edge::Broken),
            (31_000_000, Edge::Made),
        ] {
            let goal = [goal, 90_000_000, 70_000_000];
            let probed = calibrated.probe_to(goal, 24_000_000, until).unwrap();
            let [x, y, z] = probed.changed_nm.unwrap_or(probed.at_nm);
            assert_eq!(probed.changed_nm.is_some(), goal[0] != 31_000_000);
            let wanted = if goal[0] == 31_000_000 {
                goal[0]
            } else {
                31_234_567
            };
            assert!(x.abs_diff(wanted) < 250, "{probed:?}");
            assert!(
                y.abs_diff(90_000_000) < 250 && z.abs_diff(70_000_000) < 250,
                "{probed:?}"
            );
            let truth = calibrated.inner().real();
            let off = [0, 1, 2].map(|axis: usize| truth[axis] - probed.at_nm[axis] as f64);
            assert!(off.iter().all(|off| off.abs() < 250.0), "{off:?}");
        }
    }
}
