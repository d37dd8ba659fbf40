//! The state of a machine, as pages get it.

use husillo_clients::grbl::{Session, alarm};
use husillo_transports::grbl::{
    Accessories, ModalState, Pins, Position, State as GrblState, Status,
};
use serde::Serialize;
use serde_json::{Value, json};

/// The state of the link to a controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Link {
    /// It is being opened.
    #[default]
    Opening,
    /// The controller answers.
    Up,
    /// The port has failed, or the controller does not answer.
    Lost,
}

/// The state of a machine. Lengths are in mm, feeds in mm/min, overrides in percent.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MachineState {
    pub link: Link,
    pub why: Option<String>,
    pub controller: Option<String>,
    pub state: Option<&'static str>,
    pub detail: Option<u8>,
    pub alarm: Option<Value>,
    pub advice: Option<&'static str>,
    pub axes: Vec<char>,
    pub machine_mm: Option<Vec<f64>>,
    pub work_mm: Option<Vec<f64>>,
    pub zero_mm: Option<Vec<f64>>,
    pub feed: f64,
    pub rpm: f64,
    #[serde(rename = "override")]
    pub overrides: Option<Value>,
    pub accessories: Option<Value>,
    pub switches: Vec<&'static str>,
    pub modal: Vec<String>,
    pub offset: Option<String>,
    pub tool: u8,
    /// Length of the tool that is in effect (G43.1).
    pub tool_length_mm: Option<f64>,
    pub programmed: Option<Value>,
    pub queue: Option<Value>,
    pub operator: Option<u64>,
    pub clients: u64,
    pub jog: Option<Value>,
    pub stopping: bool,
    pub undo: usize,
    pub probe: Option<Value>,
    pub program: Option<Value>,
    /// An emergency stop is asked for, and the controller has not confirmed it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub emergency_waits: bool,
    /// What only a micro mill has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mill: Option<MillState>,
    /// What only a drill has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drill: Option<DrillState>,
    /// What only a microfactory has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub factory: Option<FactoryState>,
    /// What only a measuring machine has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measuring: Option<Value>,
}

/// What only a micro mill has.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MillState {
    /// Whether its position is known.
    pub is_homed: bool,
    /// Positions of the motors in steps: from machine zero, or from switching on.
    pub motor_steps: Option<[i32; 3]>,
    /// The backlash that it takes up, um.
    pub backlash_um: Option<[i64; 3]>,
    /// Steps per second of the fastest motor.
    pub step_hz: u32,
    /// Turns per minute of the fastest motor.
    pub motor_rpm: u32,
    /// Steps per second of the present jog.
    pub jog_hz: Option<u16>,
    /// The last string that was sent.
    pub sent: String,
    /// What the controller has echoed of it.
    pub echo: String,
    /// Its result: `moving`, `done`, or why not.
    pub outcome: Option<&'static str>,
}

/// What only a circuit-board drill has.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DrillState {
    /// Whether its position counts from the switches.
    pub is_homed: bool,
    /// Whether it is in the manual mode.
    pub is_manual: bool,
    /// Steps of X and Y from the zero.
    pub steps: [u16; 2],
    /// `up` or `down` at a sensor, or `between` them, at an unknown height.
    pub z: &'static str,
    /// Whether the spindle turns.
    pub spindle: bool,
    /// Names of the lamps of its panel that are lit.
    pub lights: Vec<&'static str>,
    /// Answers to the question that is asked each second at rest.
    pub heartbeats: u64,
    /// Records in its memory. None: the memory holds the end of a longer program.
    pub records: Option<u16>,
    /// Positions that were taught since the memory was cleared, mm.
    pub taught_mm: Vec<[f64; 2]>,
}

/// What only a microfactory has.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FactoryState {
    /// Whether positions count from the home switches.
    pub is_homed: bool,
    /// Whether an emergency stop holds.
    pub is_latched: bool,
    /// Steps of X, Y, Z and of the spindle.
    pub steps: [i32; 4],
    /// Whether the tool has touched the work piece in the present or the last figure.
    pub contact: bool,
    /// How the last motion has ended.
    pub report: Option<String>,
    /// What moves by hand, such as `x +25`.
    pub motion: Option<String>,
    /// The line of the drawn program whose move is cut.
    pub line: Option<usize>,
    /// Moves of the figure that the controller has got, while it gets them.
    pub stored: Option<usize>,
}

impl MachineState {
    /// Takes over the last report of a controller.
    pub fn report(&mut self, session: &Session, last_alarm: Option<u16>) {
        let Some(status) = session.status() else {
            return;
        };
        let (name, detail) = named(status.state);
        self.state = Some(name);
        self.detail = detail;
        self.advice = advice(status.state);
        self.alarm = (status.state == GrblState::Alarm).then(|| described(last_alarm));
        self.place(session, status);
        self.feed = status.feed_nm_per_min as f64 / 1e6;
        self.rpm = f64::from(status.rpm);
        self.switches = closed(status.pins);
        self.queue = status
            .free
            .map(|(moves, bytes)| json!({"moves_free": moves, "bytes_free": bytes}));
        if let Some([feed, rapid, spindle]) = status.overrides {
            self.overrides = Some(json!({"feed": feed, "rapid": rapid, "spindle": spindle}));
            // Grbl reports the accessories together with the overrides.
            self.accessories = Some(accessories(status.accessories));
        }
    }

    fn place(&mut self, session: &Session, status: &Status) {
        let in_mm = |nm: &[i64]| nm.iter().map(|nm| *nm as f64 / 1e6).collect::<Vec<_>>();
        let zero = session.work_zero().map(|zero| zero.nm());
        self.zero_mm = zero.map(in_mm);
        self.work_mm = session.work_position().map(|at| in_mm(&at));
        self.machine_mm = match (status.position, zero) {
            (Position::Machine(at), _) => Some(in_mm(at.nm())),
            (Position::Work(at), Some(zero)) => {
                let sums: Vec<_> = at.nm().iter().zip(zero).map(|(a, b)| a + b).collect();
                Some(in_mm(&sums))
            }
            (Position::Work(_), None) => None,
        };
        let (Position::Machine(at) | Position::Work(at)) = status.position;
        let letters = ['X', 'Y', 'Z', 'A', 'B', 'C'];
        self.axes = letters.into_iter().take(at.nm().len()).collect();
    }

    /// Takes over the modes of a controller.
    pub fn modes(&mut self, modes: &ModalState) {
        let code = |letter: char, tenths: u16| match tenths % 10 {
            0 => format!("{letter}{}", tenths / 10),
            part => format!("{letter}{}.{part}", tenths / 10),
        };
        let frame = code('G', modes.frame);
        self.modal = vec![
            code('G', modes.motion),
            frame.clone(),
            code('G', modes.plane),
            code('G', modes.units),
            code('G', modes.distance),
            code('G', modes.feed_mode),
            code('M', modes.spindle),
        ];
        self.modal.extend(modes.mist.then(|| "M7".to_owned()));
        self.modal.extend(modes.flood.then(|| "M8".to_owned()));
        if !modes.mist && !modes.flood {
            self.modal.push("M9".to_owned());
        }
        self.offset = Some(frame);
        self.tool = modes.tool;
        self.programmed = Some(json!({
            "feed": modes.feed_nm_per_min as f64 / 1e6,
            "rpm": modes.milli_rpm as f64 / 1e3,
        }));
    }

    /// Nothing is known of a controller that does not answer.
    pub fn lost(&mut self, why: &str) {
        *self = Self {
            link: Link::Lost,
            why: Some(why.to_owned()),
            advice: Some("check cable and power; what the axes do is not known"),
            axes: std::mem::take(&mut self.axes),
            program: self.program.take(),
            operator: self.operator,
            clients: self.clients,
            ..Self::default()
        };
    }

    /// The frame of this state.
    pub fn frame(&self, machine: u32, family: &'static str, number: u64) -> String {
        #[derive(Serialize)]
        struct Frame<'a> {
            kind: &'static str,
            machine: u32,
            family: &'static str,
            number: u64,
            #[serde(flatten)]
            state: &'a MachineState,
        }
        let frame = Frame {
            kind: "state",
            machine,
            family,
            number,
            state: self,
        };
        // All of its maps have text as keys.
        serde_json::to_string(&frame).unwrap_or_default()
    }
}

/// The name of a state and the number behind it.
fn named(state: GrblState) -> (&'static str, Option<u8>) {
    match state {
        GrblState::Hold(is_braking) => ("Hold", Some(is_braking.into())),
        GrblState::Door(detail) => ("Door", Some(detail)),
        state => (state.name(), None),
    }
}

fn advice(state: GrblState) -> Option<&'static str> {
    Some(match state {
        GrblState::Alarm => "home the machine, or unlock it if you are sure where it is",
        GrblState::Hold(false) => "resume goes on, STOP ends",
        GrblState::Hold(true) => "the axes brake",
        GrblState::Door(0) => "the door is closed again: resume goes on",
        GrblState::Door(_) => "the door is open: close it",
        GrblState::Check => "lines are checked, nothing moves: $C ends that",
        GrblState::Sleep => "the motors are off: reset, then home",
        GrblState::Tool => "change the tool, then resume",
        _ => return None,
    })
}

/// An alarm as pages get it. Without a number the controller was locked when it was switched on.
fn described(number: Option<u16>) -> Value {
    match number {
        Some(number) => json!({"number": number, "text": alarm(number)}),
        None => json!({"number": 0, "text": "locked: where the axes are is not known"}),
    }
}

fn closed(pins: Pins) -> Vec<&'static str> {
    const LETTERS: [&str; 11] = ["P", "X", "Y", "Z", "A", "B", "C", "D", "H", "R", "S"];
    let letters = LETTERS.into_iter().enumerate();
    letters
        .filter(|(bit, _)| pins.0 & (1 << bit) != 0)
        .map(|(_, letter)| letter)
        .collect()
}

fn accessories(on: Accessories) -> Value {
    let is = |bit: u8| on.0 & bit != 0;
    let spindle = match () {
        () if is(Accessories::CLOCKWISE) => "cw",
        () if is(Accessories::COUNTER_CLOCKWISE) => "ccw",
        () => "off",
    };
    json!({
        "spindle": spindle,
        "flood": is(Accessories::FLOOD),
        "mist": is(Accessories::MIST),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn switches_have_their_letters() {
        assert_eq!(
            closed(Pins(Pins::PROBE | Pins::DOOR | Pins::START)),
            ["P", "D", "S"]
        );
        assert!(closed(Pins(0)).is_empty());
    }

    #[test]
    fn a_lost_controller_has_no_position() {
        let mut state = MachineState {
            machine_mm: Some(vec![1.0]),
            state: Some("Idle"),
            axes: vec!['X'],
            ..MachineState::default()
        };
        state.lost("unplugged");
        assert_eq!((state.machine_mm.clone(), state.state), (None, None));
        let frame: Value = serde_json::from_str(&state.frame(2, "grbl", 9)).unwrap();
        assert_eq!(frame["link"], "lost");
        assert_eq!(frame["machine"], 2);
        assert_eq!(
            (&frame["family"], &frame["number"]),
            (&"grbl".into(), &9.into())
        );
        assert_eq!(frame.get("mill"), None);
        assert_eq!(frame["axes"][0], "X");
    }
}
