//! What a page asks for.

use super::axes::Axes;
use super::drill_program::Placing;
use super::loaded::{Loaded, Surroundings};
use serde::de::{Error, Unexpected};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::mpsc::SyncSender;

/// A request about one machine.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case")]
pub enum Request {
    /// Stop everything.
    Stop,
    /// The emergency stop of a microfactory: nothing moves until the reset of its panel.
    Emergency,
    /// Take control.
    Take {
        /// Also from another client.
        #[serde(default)]
        force: bool,
    },
    /// Give control back.
    Give,
    /// Hold the feed.
    Hold,
    /// Go on after a hold.
    Resume,
    /// Reset the controller.
    Reset,
    /// Unlock the controller without homing.
    Unlock,
    /// Home all axes, or one.
    Home {
        /// Letter of the axis.
        #[serde(default)]
        axis: Option<char>,
    },
    /// Begin a jog that goes on while it is renewed.
    Jog {
        /// Number of the jog. It grows.
        jog: u64,
        /// Direction.
        axes: Axes,
        /// Speed along the path, mm/min. A micro mill has none.
        #[serde(default)]
        feed: f64,
        /// Steps per second of the axis of a micro mill, instead of its jog speed.
        #[serde(default)]
        hz: Option<u16>,
    },
    /// Make the present jog of a micro mill faster or slower.
    Pace {
        /// Or slower.
        faster: bool,
    },
    /// Renew the lease of a jog.
    Renew {
        /// Its number.
        jog: u64,
    },
    /// End a jog.
    Release {
        /// Its number.
        jog: u64,
    },
    /// Move by a distance.
    Step {
        /// Distance, mm.
        move_mm: Axes,
        /// Speed along the path, mm/min. A micro mill has none.
        #[serde(default)]
        feed: f64,
    },
    /// Move the motors of a micro mill by whole steps, one axis after the other.
    Steps {
        /// Steps, with the sign of their direction.
        steps: Axes,
    },
    /// Set the backlash that a micro mill takes up.
    Backlash {
        /// Backlash, um.
        um: Axes,
    },
    /// Enter the manual mode of a drill, which homes it, or leave it.
    Manual {
        /// Enter it.
        on: bool,
    },
    /// Switch the spindle of a drill by hand.
    Spindle {
        /// Or off.
        on: bool,
    },
    /// Make the present position of a drill a hole of the program in its memory.
    Teach,
    /// Load the program in the memory of a drill.
    Taught,
    /// Test the link to a drill.
    LinkTest,
    /// Place the loaded drill file on the table.
    Place {
        /// How.
        placing: Placing,
    },
    /// Move to a position.
    Goto {
        /// Position, mm.
        to_mm: Axes,
        /// Its coordinates.
        #[serde(default)]
        frame: Frame,
        /// Speed along the path, mm/min. A micro mill has none.
        #[serde(default)]
        feed: f64,
        /// A measuring machine moves fast, and stops abruptly at a contact.
        #[serde(default)]
        rapid: bool,
    },
    /// Give the present position new work coordinates.
    Zero {
        /// Work coordinates, mm.
        at_mm: Axes,
    },
    /// Restore the work zero before the last [`Zero`](Self::Zero).
    UndoZero,
    /// Send a line.
    Line {
        /// The line.
        text: String,
    },
    /// Set an override.
    Override {
        /// Which.
        what: Overridden,
        /// Its new value.
        percent: u8,
    },
    /// Switch an accessory while a program runs.
    Toggle {
        /// Which.
        what: Accessory,
    },
    /// Run the loaded program, or tell what would happen.
    Run {
        /// Run it.
        #[serde(default)]
        confirmed: bool,
        /// From this line on.
        #[serde(default)]
        from: Option<usize>,
    },
    /// Wait after each line of the program.
    SingleBlock {
        /// Or no more.
        on: bool,
    },
    /// Wait before these lines.
    Breakpoints {
        /// Their numbers.
        lines: Vec<usize>,
    },
    /// Forget the loaded program.
    Unload,
    /// Move an axis until the probe touches.
    Probe(Probe),
    /// End the present motion or routine of a measuring machine.
    Cancel,
    /// Touch the part with a measuring machine.
    Touch(Touch),
    /// Set the tip of a measuring machine.
    Tip(Tip),
    /// Check a routine, and sketch its features.
    Routine {
        /// Its name. The ending of a program marks G-code.
        name: String,
        /// Its lines.
        text: String,
    },
    /// Run a routine.
    RoutineRun {
        /// Its name.
        name: String,
        /// Its lines.
        text: String,
        /// Name or number of the part, for the report.
        #[serde(default)]
        part: Option<String>,
    },
    /// Tell what the last routine has measured.
    Measured,
    /// List the macros.
    Macros,
    /// Add or replace a macro.
    MacroSave {
        /// Its name.
        name: String,
        /// Its lines.
        text: String,
    },
    /// Remove a macro.
    MacroDelete {
        /// Its name.
        name: String,
    },
    /// Send the lines of a macro, one after the other.
    MacroRun {
        /// Its name.
        name: String,
    },
    /// List the settings.
    Settings,
    /// Tell what these settings would change.
    SettingsDiff {
        /// Values by number.
        #[serde(deserialize_with = "by_number")]
        values: BTreeMap<u16, String>,
    },
    /// Change settings.
    SettingsSave {
        /// Values by number.
        #[serde(deserialize_with = "by_number")]
        values: BTreeMap<u16, String>,
    },
    /// Load a program that was checked. Pages cannot ask for this.
    #[serde(skip)]
    Load(Arc<Loaded>),
    /// Tell what a program is checked against. Pages cannot ask for this.
    #[serde(skip)]
    Surroundings(SyncSender<Surroundings>),
}

/// A move until the probe touches.
#[derive(Clone, Debug, Deserialize)]
pub struct Probe {
    /// Letter of the axis.
    pub axis: char,
    /// Longest distance, mm, with the sign of its direction.
    pub by_mm: f64,
    /// Speed, mm/min.
    pub feed: f64,
    /// Distance back after the contact, mm.
    #[serde(default)]
    pub back_mm: f64,
    /// The work coordinate of the contact, mm.
    #[serde(default)]
    pub set_mm: Option<f64>,
    /// No contact is expected: it ends the move where it is, and changes nothing else.
    #[serde(default)]
    pub beside: bool,
}

/// A touch of a measuring machine. Lengths are in mm, or in counts of unknown length.
#[derive(Clone, Debug, Deserialize)]
pub struct Touch {
    /// The direction.
    pub towards: Axes,
    /// The longest distance. Without it the end of the travel.
    #[serde(default)]
    pub within: Option<f64>,
    /// Slow touches in the mean.
    #[serde(default = "one")]
    pub touches: u8,
    /// The true position of the face on its axis: the touch calibrates the pre-travel.
    #[serde(default)]
    pub reference: Option<f64>,
}

const fn one() -> u8 {
    1
}

/// The tip of a measuring machine. Lengths are in mm, or in counts of unknown length.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Tip {
    /// Pre-travel in positive and in negative direction.
    #[serde(default)]
    pub pre_travel: Option<[f64; 2]>,
    /// Radius of the ball.
    #[serde(default)]
    pub ball: Option<f64>,
}

/// Coordinates of a position.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Frame {
    /// From the work zero.
    #[default]
    Work,
    /// From the machine zero.
    Machine,
}

/// What is overridden.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Overridden {
    /// The feed: 10 to 200 %.
    Feed,
    /// Rapids: 25, 50 or 100 %.
    Rapid,
    /// The speed of the spindle: 10 to 200 %.
    Spindle,
}

/// An accessory.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Accessory {
    /// The spindle, during a hold.
    Spindle,
    /// Flood coolant.
    Flood,
    /// Mist coolant.
    Mist,
}

impl Request {
    /// Whether it needs the modes and the work zero of the controller.
    pub const fn needs_modes(&self) -> bool {
        use Request::{Probe, Run, UndoZero, Zero};
        matches!(self, Probe(_) | Run { .. } | Zero { .. } | UndoZero)
    }

    /// Whether a client needs control for it.
    pub const fn needs_control(&self) -> bool {
        use Request::{
            Emergency, Hold, Macros, Measured, Routine, Settings, SettingsDiff, Stop, Take,
        };
        !matches!(
            self,
            Stop | Emergency
                | Take { .. }
                | Hold
                | Macros
                | Measured
                | Routine { .. }
                | Settings
                | SettingsDiff { .. }
        )
    }
}

/// Reads an object whose names are numbers. In a request that is chosen by its `do`, serde reads
/// names as texts only.
fn by_number<'de, D: Deserializer<'de>>(from: D) -> Result<BTreeMap<u16, String>, D::Error> {
    let values = BTreeMap::<String, String>::deserialize(from)?;
    let numbered = values.into_iter().map(|(name, value)| {
        let number = name.parse().map_err(|_| {
            Error::invalid_value(Unexpected::Str(&name), &"the number of a setting")
        })?;
        Ok((number, value))
    });
    numbered.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_read() {
        let read = |text: &str| serde_json::from_str::<Request>(text);
        let take = read(r#"{"do": "take", "id": 4}"#);
        assert!(matches!(take, Ok(Request::Take { force: false })));
        let text = r#"{"do": "jog", "jog": 5, "axes": {"x": 1, "y": -1}, "feed": 600}"#;
        assert!(matches!(read(text), Ok(Request::Jog { jog: 5, .. })));
        for wrong in [
            "{}",
            r#"{"do": "fly"}"#,
            r#"{"do": "load"}"#,
            r#"{"do": "jog", "jog": -1, "axes": {}, "feed": 1}"#,
            r#"{"do": "override", "what": "feed", "percent": 256}"#,
            "[]",
            "7",
        ] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
