//! What a page asks for.

use super::axes::Axes;
use serde::Deserialize;

/// A request about one machine.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(tag = "do", rename_all = "snake_case")]
pub enum Request {
    /// Stop everything.
    Stop,
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
        /// Speed along the path, mm/min.
        feed: f64,
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
        /// Speed along the path, mm/min.
        feed: f64,
    },
    /// Move to a position.
    Goto {
        /// Position, mm.
        to_mm: Axes,
        /// Its coordinates.
        #[serde(default)]
        frame: Frame,
        /// Speed along the path, mm/min.
        feed: f64,
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
    /// Whether a client needs control for it.
    pub const fn needs_control(&self) -> bool {
        !matches!(self, Self::Stop | Self::Take { .. } | Self::Hold)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_read() {
        let read = |text: &str| serde_json::from_str::<Request>(text);
        assert_eq!(
            read(r#"{"do": "take", "id": 4}"#).unwrap(),
            Request::Take { force: false }
        );
        let text = r#"{"do": "jog", "jog": 5, "axes": {"x": 1, "y": -1}, "feed": 600}"#;
        assert!(matches!(read(text), Ok(Request::Jog { jog: 5, .. })));
        for wrong in [
            "{}",
            r#"{"do": "fly"}"#,
            r#"{"do": "jog", "jog": -1, "axes": {}, "feed": 1}"#,
            r#"{"do": "override", "what": "feed", "percent": 256}"#,
            "[]",
            "7",
        ] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
