//! The status report.

mod flags;
mod state;

pub use flags::{Accessories, Pins};
pub use state::State;

use crate::grbl::place::{Place, Units};
use crate::grbl::text::{Text, decimal, whole};

/// Position of a status report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Position {
    /// From machine zero: `MPos`.
    Machine(Place),
    /// From the work zero: `WPos`.
    Work(Place),
}

/// One status report, `<Idle|MPos:0.000,0.000,0.000|FS:0,0>`.
///
/// # Examples
///
/// ```
/// use husillo_transports::grbl::{Message, State};
///
/// let Some(Message::Status(status)) = Message::parse(b"<Run|MPos:1.500,0.000,0.000|FS:600,0>")
/// else {
///     panic!("no status report");
/// };
/// assert_eq!(status.state, State::Run);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status {
    /// State of the controller.
    pub state: State,
    /// Position of the axes.
    pub position: Position,
    /// `Bf`: free slots of the queue, and free bytes of the receive buffer.
    pub free: Option<(u16, u16)>,
    /// `Ln`: N word of the present block.
    pub line: Option<u32>,
    /// `FS`: present speed, in nm/min.
    pub feed_nm_per_min: u64,
    /// `FS`: spindle speed in rpm.
    pub rpm: u32,
    /// `Pn`: closed inputs.
    pub pins: Pins,
    /// `WCO`: the work zero.
    pub work_zero: Option<Place>,
    /// `Ov`: overrides of feed, rapids and spindle in percent.
    pub overrides: Option<[u8; 3]>,
    /// `A`: accessories that are on.
    pub accessories: Accessories,
}

impl Status {
    /// Creates a status without optional fields.
    pub const fn new(state: State, position: Position) -> Self {
        Status {
            state,
            position,
            free: None,
            line: None,
            feed_nm_per_min: 0,
            rpm: 0,
            pins: Pins(0),
            work_zero: None,
            overrides: None,
            accessories: Accessories(0),
        }
    }

    pub(crate) fn put(&self, text: &mut Text, units: Units) {
        text.put(b"<");
        text.put(self.state.name().as_bytes());
        let (name, place): (&[u8], _) = match &self.position {
            Position::Machine(place) => (b"|MPos:", place),
            Position::Work(place) => (b"|WPos:", place),
        };
        text.put(name);
        place.put(text, units);
        if let Some((blocks, bytes)) = self.free {
            text.put(b"|Bf:");
            text.put_number(blocks.into());
            text.put(b",");
            text.put_number(bytes.into());
        }
        if let Some(line) = self.line {
            text.put(b"|Ln:");
            text.put_number(line.into());
        }
        text.put(b"|FS:");
        text.put_feed(self.feed_nm_per_min, units);
        text.put(b",");
        text.put_number(self.rpm.into());
        self.pins.put(text);
        if let Some(zero) = &self.work_zero {
            text.put(b"|WCO:");
            zero.put(text, units);
        }
        if let Some([feed, rapid, spindle]) = self.overrides {
            text.put(b"|Ov:");
            text.put_number(feed.into());
            text.put(b",");
            text.put_number(rapid.into());
            text.put(b",");
            text.put_number(spindle.into());
        }
        self.accessories.put(text);
        text.put(b">");
    }

    /// Reads a report without its `<` and `>`. Unknown fields are skipped.
    pub(crate) fn parse(text: &[u8]) -> Option<(Status, Units)> {
        let mut fields = text.split(|byte| *byte == b'|');
        let state = State::parse(fields.next()?)?;
        let mut status = None;
        let mut units = Units::Millimetres;
        for field in fields {
            let at = field.iter().position(|byte| *byte == b':')?;
            let (name, value) = field.split_at_checked(at)?;
            let (_, value) = value.split_first()?;
            if let b"MPos" | b"WPos" = name {
                let (place, found) = Place::parse(value)?;
                units = found;
                let position = if name == b"MPos" {
                    Position::Machine(place)
                } else {
                    Position::Work(place)
                };
                status = Some(Status::new(state, position));
            } else {
                status.as_mut()?.parse_field(name, value, units)?;
            }
        }
        Some((status?, units))
    }

    fn parse_field(&mut self, name: &[u8], value: &[u8], units: Units) -> Option<()> {
        let mut values = value.split(|byte| *byte == b',');
        match name {
            b"Bf" => self.free = Some((whole(values.next()?)?, whole(values.next()?)?)),
            b"Ln" => self.line = Some(whole(value)?),
            b"FS" | b"F" => {
                self.feed_nm_per_min = feed(values.next()?, units)?;
                self.rpm = match values.next() {
                    Some(rpm) => whole(rpm)?,
                    None => 0,
                };
            }
            b"Pn" => self.pins = Pins::parse(value),
            b"WCO" => self.work_zero = Some(Place::parse(value)?.0),
            b"Ov" => {
                let mut next = || whole(values.next()?);
                self.overrides = Some([next()?, next()?, next()?]);
            }
            b"A" => self.accessories = Accessories::parse(value),
            _ => {}
        }
        Some(())
    }
}

/// Reads a feed in nm/min.
pub(crate) fn feed(text: &[u8], units: Units) -> Option<u64> {
    let (places, unit) = match units {
        Units::Millimetres => (0, 1_000_000),
        Units::Inches => (1, 2_540_000),
    };
    let (value, rest) = decimal(text, places)?;
    let feed = u64::try_from(value).ok()?.checked_mul(unit)?;
    rest.is_empty().then_some(feed)
}
