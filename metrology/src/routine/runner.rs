//! The runner, which carries out statements one after another.

use super::alignment::align;
use super::failure::Failure;
use super::feature::{Feature, Shape, angle_micro, distance_nm};
use super::fits::{self, Points};
use super::frame::Frame;
use super::site::{Contact, Site};
use super::statement::{Fit, Job, Order, Statement, Task};

/// A machine, and the features measured with it.
#[derive(Debug)]
pub struct Runner<'a> {
    /// The machine.
    pub site: Site<'a>,
    /// The measured features, in order.
    pub features: Vec<Feature>,
}

impl<'a> Runner<'a> {
    /// A runner without features.
    pub const fn new(site: Site<'a>) -> Self {
        Self {
            site,
            features: Vec::new(),
        }
    }

    /// Carries out a statement and returns its feature, if it measures one.
    ///
    /// # Errors
    ///
    /// The reason why the statement has no result. Then no feature is added.
    pub fn run(&mut self, statement: &Statement) -> Result<Option<&Feature>, Failure> {
        let site = &mut self.site;
        match &statement.order {
            Order::Clearance(nm) => site.clearance_nm = *nm,
            Order::Search(nm) => site.search_nm = *nm,
            Order::Safe(nm) => site.safe_nm = *nm,
            Order::Moves(approach) => site.approach = *approach,
            Order::GoTo(place, approach) => {
                let goal = site.place(*place)?;
                site.go_by(approach.unwrap_or(site.approach), goal)?;
            }
            Order::Jog(displacement, approach) => {
                let here = site.position()?;
                let goal = std::array::from_fn(|axis| here[axis] + displacement[axis]);
                site.go_by(approach.unwrap_or(site.approach), goal)?;
            }
            Order::Zero(axes) => site.zero(*axes)?,
            Order::MachineFrame => {
                let here = site.machine_position()?;
                site.change_frame(Frame::MACHINE, here);
                site.frame_name = "machine".into();
            }
            Order::Frame { of, called_nm } => {
                let here = site.machine_position()?;
                let [plane, line, point] = of;
                let of = [self.find(plane)?, self.find(line)?, self.find(point)?];
                let frame = align(of, *called_nm, &self.site.frame, &self.site.tip)?;
                self.site.change_frame(frame, here);
                self.site.frame_name = format!("{plane}, {line}, {point}");
            }
            Order::Measure(task) => {
                let feature = self.measure(task, statement.line)?;
                self.features.push(feature);
                return Ok(self.features.last());
            }
        }
        Ok(None)
    }

    /// Measures a feature.
    ///
    /// # Errors
    ///
    /// The reason why there is no feature.
    pub(super) fn measure(&mut self, task: &Task, line: usize) -> Result<Feature, Failure> {
        let site = &mut self.site;
        let usual = (site.clearance_nm, site.search_nm);
        site.clearance_nm = task.clearance_nm.unwrap_or(site.clearance_nm);
        site.search_nm = task.search_nm.unwrap_or(site.search_nm);
        let contacts = site.contacts(&task.job);
        (site.clearance_nm, site.search_nm) = usual;
        let contacts = contacts?;
        let (shape, marks) = self.fit(task, &contacts)?;
        let feature = Feature {
            keyword: task.keyword,
            name: task.name.clone(),
            line,
            shape,
            contacts,
            marks,
            frame: self.site.frame,
            frame_name: self.site.frame_name.clone(),
            dimensions: Vec::new(),
            is_spoiled: false,
        };
        Ok(feature.with_figures(&task.wanted))
    }

    fn fit(&self, task: &Task, contacts: &[Contact]) -> Result<fits::Fitted, Failure> {
        let (tip, frame) = (&self.site.tip, &self.site.frame);
        let touched = || Points::Touched(contacts.to_vec());
        match &task.job {
            Job::Touch { .. } | Job::Point { .. } => match contacts {
                [contact] => Ok(fits::point(contact, tip)),
                _ => Err(Failure::Fit(husillo_probe::FitError::TooFewPoints)),
            },
            Job::Edge { .. } => fits::edge(contacts, tip, frame),
            Job::Corner { .. } => fits::corner(contacts, tip, frame),
            Job::Width { .. } => fits::width(contacts, tip),
            Job::Round { .. } => fits::circle(&touched(), tip, frame),
            Job::Plane { .. } => fits::plane(&touched(), tip, frame),
            Job::Line { .. } => fits::line(&touched(), tip),
            Job::Sphere { .. } => fits::sphere(&touched(), tip),
            Job::Fit { shape, of } => {
                let points = self.points(of)?;
                match shape {
                    Fit::Plane => fits::plane(&points, tip, frame),
                    Fit::Line => fits::line(&points, tip),
                    Fit::Circle => fits::circle(&points, tip, frame),
                    Fit::Sphere => fits::sphere(&points, tip),
                }
            }
            Job::Distance {
                between: [from, to],
                along,
            } => {
                let along = match along {
                    Some(along) => Some(
                        frame
                            .direction_to_machine(*along)
                            .ok_or(Failure::NoDirection)?,
                    ),
                    None => None,
                };
                let along = along.map(|along| super::vector::components(&along));
                let (a, b) = (&self.find(from)?.shape, &self.find(to)?.shape);
                let upright = super::vector::components(&frame.upright());
                let ends_nm = [position_nm(from, a)?, position_nm(to, b)?];
                let length_nm = distance_nm([a, b], ends_nm, along, upright);
                Ok((Shape::Distance { ends_nm, length_nm }, Vec::new()))
            }
            Job::Angle {
                between: [from, to],
            } => {
                let (a, b) = (&self.find(from)?.shape, &self.find(to)?.shape);
                let directions = a.direction().zip(b.direction());
                let (a, b) = directions.ok_or(Failure::NoDirection)?;
                let angle_micro = angle_micro(&a, &b, &task.wanted);
                Ok((Shape::Angle { angle_micro }, Vec::new()))
            }
        }
    }

    /// The points of a fit: touches if all features are single touches, otherwise positions.
    fn points(&self, of: &[String]) -> Result<Points, Failure> {
        let mut contacts = Vec::new();
        let mut places = Vec::new();
        for name in of {
            let feature = self.find(name)?;
            if let (Shape::Point { .. }, [contact]) = (&feature.shape, feature.contacts.as_slice())
            {
                contacts.push(*contact);
            }
            places.push(position_nm(name, &feature.shape)?);
        }
        Ok(if contacts.len() == of.len() {
            Points::Touched(contacts)
        } else {
            Points::Found(places)
        })
    }

    /// A feature by its name. The parser has checked that there is one, but after a failed line of
    /// a recording it may be missing.
    fn find(&self, name: &str) -> Result<&Feature, Failure> {
        let mut features = self.features.iter();
        features
            .find(|feature| feature.name.eq_ignore_ascii_case(name))
            .ok_or_else(|| Failure::NotMeasured(name.to_owned()))
    }
}

/// The position of a feature.
fn position_nm(name: &str, shape: &Shape) -> Result<[i64; 3], Failure> {
    let position = shape.point_nm();
    position.ok_or_else(|| Failure::NoPosition(name.to_owned()))
}
