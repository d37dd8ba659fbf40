//! The result of one action, as text, JSON or a line of a table.

use husillo_metrology::Scale;
use husillo_reports::tuning::percent;
use husillo_sim::text::{counted, position};
use serde::{Serialize, Serializer};
use std::fmt;

/// One number, or one for each of several axes.
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

/// The result of an action, in the unit of the machine.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ResultRow {
    /// Name of the action.
    pub action: &'static str,
    /// `X`, `Y`, `Z` or several of them.
    pub axis: String,
    /// `mm` or `counts`.
    pub unit: &'static str,
    /// Position of the axes.
    pub position: Numbers,
    /// Figures of a touch.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub touch: Option<TouchFigures>,
    /// Figures of a calibration on a body of known size.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration: Option<CalibrationFigures>,
    /// Figures of a status.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub status: Option<StatusFigures>,
    /// Coordinates of an axis.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub place: Option<PlaceFigures>,
}

/// The position of an axis, in all coordinates.
#[derive(Clone, Debug, Serialize)]
pub struct PlaceFigures {
    /// From home. `None`: not known.
    pub machine: Option<f64>,
    /// From the last zero.
    pub work: f64,
    /// The counts of the module.
    pub steps: i32,
    /// Whether the axis is homed.
    #[serde(rename = "homed")]
    pub is_homed: bool,
    /// Whether the length of a count is known.
    #[serde(skip)]
    pub has_length: bool,
}

impl PlaceFigures {
    /// Lines for people.
    fn text(&self, head: &str, axis: &str, unit: &str) -> String {
        let places = match unit {
            "mm" => 4,
            "in" => 5,
            _ => 0,
        };
        let machine = match self.machine {
            Some(machine) => format!("{machine:.places$} {unit} from home"),
            None => format!("unknown, as {axis} is not homed"),
        };
        let length = match self.has_length {
            true => "",
            false => "\n    length     unknown, as the machine file has no `count`",
        };
        format!(
            "{head}: work {:.places$} {unit}\n    machine    {machine}\n    steps      {} \
             of the module{length}",
            self.work,
            position(self.steps, "count")
        )
    }
}

/// The state of the module of an axis.
#[derive(Clone, Debug, Serialize)]
pub struct StatusFigures {
    /// The commanded position.
    pub held: f64,
    /// The commanded minus the measured position.
    pub position_error: f64,
    /// Motor current, units of the module's converter.
    pub current: u8,
    /// The names of the status bits that are set.
    pub bits: Vec<&'static str>,
    /// The names of the bits of the auxiliary status that are set.
    pub auxiliary: Vec<&'static str>,
    /// Version of the module.
    pub version: u8,
}

/// The figures of a touch.
#[derive(Clone, Debug, Serialize)]
pub struct TouchFigures {
    /// `+` or `-` along an axis, otherwise a unit vector.
    pub direction: String,
    /// The latched position, mean of the touches.
    pub trigger: Numbers,
    /// The latched position, corrected for pre-travel and ball. It is a point of the face if the
    /// face is perpendicular to the direction.
    pub corrected: Numbers,
    /// The pre-travel that was used, or that a calibration found.
    pub pre_travel: f64,
    /// Number of touches in the mean.
    pub touches: u8,
    /// Distance between the nearest and the farthest touch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spread: Option<f64>,
    /// The longest distance beyond the contact.
    pub over_travel: f64,
    /// The new table, if a calibration changed a table of pre-travel by direction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table: Option<Vec<Entry>>,
}

/// The figures of a calibration on a body.
#[derive(Clone, Debug, Serialize)]
pub struct CalibrationFigures {
    /// `sphere` or `ring`.
    pub body: &'static str,
    /// Its centre.
    pub centre: Numbers,
    /// Number of touches in the fit.
    pub touches: u32,
    /// The farthest minus the nearest distance from the centre, with one pre-travel for all
    /// directions. The table corrects this error.
    pub form: f64,
    /// Given radius of the ball.
    pub ball_radius: f64,
    /// Given radius minus the mean pre-travel. The ball measures as if it had this radius.
    pub effective_radius: f64,
    /// The pre-travel by direction.
    pub table: Vec<Entry>,
}

/// One direction of travel and its pre-travel.
#[derive(Clone, Debug, Serialize)]
pub struct Entry {
    /// A vector of whole numbers; its length has no meaning.
    pub direction: [i64; 3],
    /// Distance from touch to signal.
    pub length: f64,
}

/// The pre-travel by direction, as lines of a machine file.
fn pre_travel(table: &[Entry], unit: &str) -> String {
    let entry = |Entry { direction, length }: &Entry| {
        format!("\n        {{ direction = {direction:?}, length = \"{length} {unit}\" }},")
    };
    let entries: String = table.iter().map(entry).collect();
    format!("pre_travel = [{entries}\n    ]")
}

impl CalibrationFigures {
    /// Lines for people, and lines for the machine file.
    fn text(&self, head: &str, unit: &str, places: usize) -> String {
        // From one half of the body, Z of the centre cannot be separated from the bending of the
        // stylus along Z.
        let doubt = match self.body {
            "sphere" => {
                "\n    its Z and pre-travel along Z cannot be separated: use `calibrate -z` on a \
                 face at a known height"
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
                t.spread
                    .map(|spread| spread.to_string())
                    .unwrap_or_default(),
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
            let spread = t.spread.map(|spread| format!(", spread {}", of(spread)));
            let spread = spread.unwrap_or_default();
            return format!(
                "{head} {}\n    trigger    {}\n    corrected  {}{found}\n    {}{spread}, \
                 over-travel {} at most",
                t.direction,
                all(&t.trigger),
                all(&t.corrected),
                counted(t.touches, "touch"),
                of(t.over_travel)
            );
        }
        if let Some(found) = &self.calibration {
            return found.text(&head, self.unit, places);
        }
        if let Some(place) = &self.place {
            return place.text(&head, &self.axis, self.unit);
        }
        match &self.status {
            Some(status) => {
                let words = |bits: &[&str]| match bits {
                    [] => "none".to_owned(),
                    bits => bits.join(", "),
                };
                format!(
                    "{head}: at {}\n    held at    {}, position error {}\n    current    {:.0} % \
                     of full scale\n    status     {}\n    auxiliary  {}\n    version    {}",
                    all(&self.position),
                    of(status.held),
                    of(status.position_error),
                    percent(status.current),
                    words(&status.bits),
                    words(&status.auxiliary),
                    status.version
                )
            }
            None => format!("{head}: at {}", all(&self.position)),
        }
    }
}
