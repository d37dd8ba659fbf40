//! The meanings of the strings.

use super::{Line, Text, reader::Reader};

/// An axis of the mill.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum Axis {
    /// Interpolates with Y.
    X,
    /// Interpolates with X.
    Y,
    /// Moves alone.
    Z,
}

impl Axis {
    /// All axes: X, Y, Z.
    pub const ALL: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

    /// Returns its letter.
    pub const fn letter(self) -> u8 {
        match self {
            Axis::X => b'X',
            Axis::Y => b'Y',
            Axis::Z => b'Z',
        }
    }
}

/// One string.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Order {
    /// `JX+;`, `&X+Y-Z+;`: jogs these axes, 1, -1 or 0 each, until they are stopped.
    Jog([i8; 3]),
    /// `PX+1000;`: moves an axis by this many steps, -9999 to 9999.
    Steps(Axis, i16),
    /// `FX+250;`: runs an axis at this many steps per second, -999 to 999, not 0, until it is
    /// stopped.
    Run(Axis, i16),
    /// `BX200;`: sets the backlash of an axis in micrometres, 0 to 999.
    Backlash(Axis, u16),
    /// `H;`: homes.
    Home,
    /// `A;`: stops.
    Stop,
    /// `W;`: makes a jog faster.
    Faster,
    /// `V;`: makes a jog slower.
    Slower,
    /// `Q;`: makes the present position the part's zero.
    Zero,
    /// A line of a program.
    Line(Line),
    /// `S1;`, `S0;`: switches the streaming of lines on or off.
    Stream(bool),
    /// `L0250;`: a motion ends when no string has arrived for this many milliseconds, 1 to 9999. 0:
    /// a motion needs no host.
    Lease(u16),
    /// `L;`: the motion continues.
    Renew,
    /// `R010;`: reports one step in this many, 1 to 999. 0: reports none.
    Every(u16),
    /// `I;`: reports the [`State`](super::State).
    Report,
}

impl Order {
    /// Reads a string without its `;`, blanks and line ends. Returns `None` if no such string
    /// exists.
    #[inline(never)] // a caller may be optimized for speed, this function need not be
    pub fn read(string: &[u8]) -> Option<Order> {
        let mut reader = Reader(string);
        let (first, _) = string.split_first()?;
        if matches!(first, b'G' | b'M') {
            return Line::read(string).map(Order::Line);
        }
        reader.takes(*first);
        let order = match first {
            b'J' => {
                let axis = reader.axis()?;
                Order::Jog(way(axis, reader.way()?))
            }
            b'&' => Order::Jog(ways(&mut reader)?),
            b'P' => {
                let axis = reader.axis()?;
                Order::Steps(axis, signed(&mut reader, 4)?)
            }
            b'F' => {
                let axis = reader.axis()?;
                let hz = signed(&mut reader, 3)?;
                if hz == 0 {
                    return None;
                }
                Order::Run(axis, hz)
            }
            b'B' => {
                let axis = reader.axis()?;
                Order::Backlash(axis, reader.digits(3, 3)? as u16)
            }
            b'H' => Order::Home,
            b'A' => Order::Stop,
            b'W' => Order::Faster,
            b'V' => Order::Slower,
            b'Q' => Order::Zero,
            b'S' => match reader.digits(1, 1)? {
                0 => Order::Stream(false),
                1 => Order::Stream(true),
                _ => return None,
            },
            b'L' if reader.is_empty() => Order::Renew,
            b'L' => Order::Lease(reader.digits(4, 4)? as u16),
            b'R' => Order::Every(reader.digits(3, 3)? as u16),
            b'I' => Order::Report,
            _ => return None,
        };
        reader.is_empty().then_some(order)
    }

    /// Returns the string with its `;`. Numbers with too many digits lose their upper digits.
    /// Orders from [`Order::read`] have no such numbers.
    pub fn text(&self) -> Text {
        let mut text = Text::new();
        match *self {
            Order::Jog(ways) => {
                // Not `count`, because the compiler cannot exclude its overflow.
                let moving = ways.iter().filter(|way| **way != 0);
                let is_one = moving.take(2).fold(0_u8, |count, _| count.wrapping_add(1)) == 1;
                text.push(if is_one { b'J' } else { b'&' });
                for (axis, way) in Axis::ALL.into_iter().zip(ways) {
                    if way != 0 {
                        text.push(axis.letter());
                        text.sign(way > 0);
                    }
                }
            }
            Order::Steps(axis, steps) => word(&mut text, b'P', axis, steps, 4),
            Order::Run(axis, hz) => word(&mut text, b'F', axis, hz, 3),
            Order::Backlash(axis, um) => {
                text.push(b'B');
                text.push(axis.letter());
                text.digits(um.into(), 3);
            }
            Order::Home => text.push(b'H'),
            Order::Stop => text.push(b'A'),
            Order::Faster => text.push(b'W'),
            Order::Slower => text.push(b'V'),
            Order::Zero => text.push(b'Q'),
            Order::Line(line) => line.write(&mut text),
            Order::Stream(on) => {
                text.push(b'S');
                text.digits(on.into(), 1);
            }
            Order::Lease(ms) => {
                text.push(b'L');
                text.digits(ms.into(), 4);
            }
            Order::Renew => text.push(b'L'),
            Order::Every(steps) => {
                text.push(b'R');
                text.digits(steps.into(), 3);
            }
            Order::Report => text.push(b'I'),
        }
        text.push(b';');
        text
    }

    /// Whether the controller answers this string. Other strings are only echoed.
    pub const fn is_answered(&self) -> bool {
        !matches!(self, Order::Faster | Order::Slower | Order::Renew)
    }
}

/// One axis with its direction.
fn way(axis: Axis, is_forward: bool) -> [i8; 3] {
    Axis::ALL.map(|other| match (other == axis, is_forward) {
        (false, _) => 0,
        (true, true) => 1,
        (true, false) => -1,
    })
}

/// Reads two or three axes with their directions. Each axis may occur once.
fn ways(reader: &mut Reader<'_>) -> Option<[i8; 3]> {
    let (mut ways, mut count) = ([0_i8; 3], 0_u8);
    while !reader.is_empty() {
        let axis = reader.axis()?;
        let one = way(axis, reader.way()?);
        for (way, one) in ways.iter_mut().zip(one) {
            if *way != 0 && one != 0 {
                return None;
            }
            *way |= one;
        }
        count = count.wrapping_add(1); // three at most
    }
    (count >= 2).then_some(ways)
}

/// Reads a sign and this many digits, at most four.
fn signed(reader: &mut Reader<'_>, digits: u8) -> Option<i16> {
    let is_forward = reader.way()?;
    let value = reader.digits(digits, digits)? as i16;
    Some(if is_forward {
        value
    } else {
        value.wrapping_neg()
    })
}

fn word(text: &mut Text, mode: u8, axis: Axis, value: i16, digits: u8) {
    text.push(mode);
    text.push(axis.letter());
    text.sign(value >= 0);
    text.digits(value.unsigned_abs().into(), digits);
}
