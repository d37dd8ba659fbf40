//! The result of one action, as text, JSON or a line of a table.

use husillo_metrology::Scale;
use serde::{Serialize, Serializer};
use std::fmt;

/// A number, or one for each of several axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Numbers(pub Vec<f64>);

impl Serialize for Numbers {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self.0[..] {
            [number] => number.serialize(to),
            _ => self.0.serialize(to),
        }
    }
}

impl fmt::Display for Numbers {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, gap) in self
            .0
            .iter()
            .zip([""].into_iter().chain(std::iter::repeat(" ")))
        {
            match out.precision() {
                Some(places) => write!(out, "{gap}{number:.places$}")?,
                None => write!(out, "{gap}{number}")?,
            }
        }
        Ok(())
    }
}

/// What came of an action, in the machine's unit.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ResultRow {
    /// Name of the action.
    pub action: &'static str,
    /// `X`, `Y`, `Z` or several of them.
    pub axis: String,
    /// `mm` or `counts`.
    pub unit: &'static str,
    /// Where the axes stand.
    pub position: Numbers,
    /// Of a touch.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub touch: Option<TouchFigures>,
    /// Of a calibration on a body of known size.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration: Option<CalibrationFigures>,
    /// Of a status.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub status: Option<StatusFigures>,
}

/// What the module of an axis says of itself.
#[derive(Clone, Debug, Serialize)]
pub struct StatusFigures {
    /// Where the axis is told to be.
    pub held: f64,
    /// The same less where it is.
    pub position_error: f64,
    /// Motor current, units of the module's converter.
    pub current: u8,
    /// The names of the bits that are set.
    pub bits: Vec<&'static str>,
    /// Those of the auxiliary status.
    pub auxiliary: Vec<&'static str>,
    /// Version of the module.
    pub version: u8,
}

/// The figures of a touch.
#[derive(Clone, Debug, Serialize)]
pub struct TouchFigures {
    /// `+` or `-` of an axis, or a unit vector.
    pub direction: String,
    /// What was latched, mean of the touches.
    pub trigger: Numbers,
    /// Less pre-travel and ball: the place of the face, taken as across the direction.
    pub corrected: Numbers,
    /// The pre-travel used, or found by a calibration.
    pub pre_travel: f64,
    /// Touches averaged.
    pub touches: u8,
    /// The farthest of them less the nearest.
    pub spread: f64,
    /// The longest way beyond the contact.
    pub over_travel: f64,
    /// Of a calibration that changed a table of pre-travel by direction: what it is now.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table: Option<Vec<Entry>>,
}

/// What a calibration on a body found.
#[derive(Clone, Debug, Serialize)]
pub struct CalibrationFigures {
    /// `sphere` or `ring`.
    pub body: &'static str,
    /// Its centre.
    pub centre: Numbers,
    /// Touches that were fitted.
    pub touches: u32,
    /// The farthest distance minus the nearest, with one pre-travel for all directions: the error
    /// that the table corrects.
    pub form: f64,
    /// Radius of the ball, as it was given.
    pub ball_radius: f64,
    /// The same less the mean pre-travel: what the ball measures like.
    pub effective_radius: f64,
    /// The pre-travel by direction.
    pub table: Vec<Entry>,
}

/// One direction of travel and its pre-travel.
#[derive(Clone, Debug, Serialize)]
pub struct Entry {
    /// As whole numbers.
    pub direction: [i64; 3],
    /// From touch to signal.
    pub length: f64,
}

/// Pre-travel by direction as lines of a machine file.
fn pre_travel(table: &[Entry], unit: &str) -> String {
    let entry = |Entry { direction, length }: &Entry| {
        format!("\n        {{ direction = {direction:?}, length = \"{length} {unit}\" }},")
    };
    let entries: String = table.iter().map(entry).collect();
    format!("pre_travel = [{entries}\n    ]")
}

impl CalibrationFigures {
    /// For people, and for the machine file.
    fn text(&self, head: &str, unit: &str, places: usize) -> String {
        // The touched half does not separate Z of the centre from the bending of the stylus along
        // Z.
        let doubt = match self.body {
            "sphere" => {
                "\n    its Z and pre-travel along Z cannot be told apart: `calibrate -z` on a face \
                 at a known height does"
            }
            _ => "",
        };
        format!(
            "{head} {}\n    centre     {:.places$} {unit}, effective radius {:.places$} \
             {unit}\n    {} touches, {:.places$} {unit} apart before correction by \
             direction{doubt}\n    for [probe] of the machine file:\n    ball_radius = \"{} \
             {unit}\"\n    {}",
            self.body,
            self.centre,
            self.effective_radius,
            self.touches,
            self.form,
            self.ball_radius,
            pre_travel(&self.table, unit)
        )
    }
}

/// The columns of [`ResultRow::csv`].
pub const CSV_HEAD: &str = "action,axis,unit,position,direction,trigger,corrected,pre_travel,\
     touches,spread,over_travel,held,position_error,current,bits,auxiliary";

impl ResultRow {
    /// A line of a table, without its end.
    pub fn csv(&self) -> String {
        let Self {
            action,
            axis,
            unit,
            position,
            ..
        } = self;
        let touch = match &self.touch {
            Some(t) => format!(
                "{},{},{},{},{},{},{}",
                t.direction,
                t.trigger,
                t.corrected,
                t.pre_travel,
                t.touches,
                t.spread,
                t.over_travel
            ),
            None => ",,,,,,".to_owned(),
        };
        let status = match &self.status {
            Some(s) => format!(
                "{},{},{},{},{}",
                s.held,
                s.position_error,
                s.current,
                s.bits.join(" + "),
                s.auxiliary.join(" + ")
            ),
            None => ",,,,".to_owned(),
        };
        format!("{action},{axis},{unit},{position},{touch},{status}")
    }

    /// Lines for people.
    pub fn text(&self, scale: Scale) -> String {
        let places = if scale.unit() == "mm" { 4 } else { 0 };
        let of = |value: f64| format!("{value:.places$} {}", self.unit);
        let all = |values: &Numbers| format!("{values:.places$} {}", self.unit);
        let head = format!("{} {}", self.axis, self.action);
        if let Some(t) = &self.touch {
            let found = if let Some(table) = &t.table {
                format!(
                    "\n    pre-travel {}, and by direction for [probe] of the machine file:\n    \
                     {}",
                    of(t.pre_travel),
                    pre_travel(table, self.unit)
                )
            } else if self.action == "calibrate" {
                let key = if t.direction == "+" {
                    "positive"
                } else {
                    "negative"
                };
                format!(
                    "\n    pre-travel {}: `{key}` of pre_travel in the machine file",
                    of(t.pre_travel)
                )
            } else {
                format!("\n    pre-travel {}", of(t.pre_travel))
            };
            let times = if t.touches == 1 { "touch" } else { "touches" };
            return format!(
                "{head} {}\n    trigger    {}\n    corrected  {}{found}\n    {} {times}, spread \
                 {}, over-travel {} at most",
                t.direction,
                all(&t.trigger),
                all(&t.corrected),
                t.touches,
                of(t.spread),
                of(t.over_travel)
            );
        }
        if let Some(found) = &self.calibration {
            return found.text(&head, self.unit, places);
        }
        match &self.status {
            Some(status) => {
                let words = |bits: &[&str]| match bits {
                    [] => "none".to_owned(),
                    bits => bits.join(", "),
                };
                format!(
                    "{head}: at {}\n    held at    {}, position error {}\n    current    {} of \
                     255\n    status     {}\n    auxiliary  {}\n    version    {}",
                    all(&self.position),
                    of(status.held),
                    of(status.position_error),
                    status.current,
                    words(&status.bits),
                    words(&status.auxiliary),
                    status.version
                )
            }
            None => format!("{head}: at {}", all(&self.position)),
        }
    }
}
