//! Bytes that take effect immediately.

/// A byte that takes effect when it arrives, at any position of the stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Realtime {
    /// 0x18: soft reset.
    Reset,
    /// `?`: status report.
    Status,
    /// `~`: start or resume.
    Resume,
    /// `!`: feed hold.
    Hold,
    /// 0x84: has the effect of an open safety door.
    Door,
    /// 0x85: cancels a jog.
    JogCancel,
    /// 0x90 to 0x94: feed override.
    Feed(Adjust),
    /// 0x95 to 0x97: rapid override of 100, 50 or 25 percent.
    Rapid(u8),
    /// 0x99 to 0x9D: spindle override.
    Spindle(Adjust),
    /// 0x9E: stops the spindle during a hold, or starts it again.
    SpindleStop,
    /// 0xA0: switches flood coolant.
    Flood,
    /// 0xA1: switches mist coolant.
    Mist,
    /// Any other byte from 0x80 on. It has no meaning and is dropped.
    Unknown(u8),
}

/// A change of an override, within 10 to 200 percent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Adjust {
    /// To 100 percent.
    Reset,
    /// Changes by this number of percent: -10, -1, 1 or 10.
    By(i8),
}

impl Adjust {
    const ALL: [Adjust; 5] = [
        Adjust::Reset,
        Adjust::By(10),
        Adjust::By(-10),
        Adjust::By(1),
        Adjust::By(-1),
    ];

    /// Returns the override after the change, in percent.
    pub fn apply(self, percent: u8) -> u8 {
        match self {
            Adjust::Reset => 100,
            Adjust::By(by) => percent.saturating_add_signed(by).clamp(10, 200),
        }
    }

    fn of(byte: u8, first: u8) -> Option<Adjust> {
        let index = byte.checked_sub(first)?;
        Adjust::ALL.get(usize::from(index)).copied()
    }

    fn byte(self, first: u8) -> u8 {
        let index = Adjust::ALL.iter().position(|adjust| *adjust == self);
        // At most 4.
        first.wrapping_add(index.unwrap_or(0) as u8)
    }
}

impl Realtime {
    /// Returns the meaning of a byte. `None`: the byte belongs to a line.
    pub fn of(byte: u8) -> Option<Realtime> {
        Some(match byte {
            0x18 => Realtime::Reset,
            b'?' => Realtime::Status,
            b'~' => Realtime::Resume,
            b'!' => Realtime::Hold,
            0x84 => Realtime::Door,
            0x85 => Realtime::JogCancel,
            0x90..=0x94 => Realtime::Feed(Adjust::of(byte, 0x90)?),
            0x95 => Realtime::Rapid(100),
            0x96 => Realtime::Rapid(50),
            0x97 => Realtime::Rapid(25),
            0x99..=0x9d => Realtime::Spindle(Adjust::of(byte, 0x99)?),
            0x9e => Realtime::SpindleStop,
            0xa0 => Realtime::Flood,
            0xa1 => Realtime::Mist,
            0x80.. => Realtime::Unknown(byte),
            _ => return None,
        })
    }

    /// Returns the byte.
    pub fn byte(self) -> u8 {
        match self {
            Realtime::Reset => 0x18,
            Realtime::Status => b'?',
            Realtime::Resume => b'~',
            Realtime::Hold => b'!',
            Realtime::Door => 0x84,
            Realtime::JogCancel => 0x85,
            Realtime::Feed(adjust) => adjust.byte(0x90),
            Realtime::Rapid(100..) => 0x95,
            Realtime::Rapid(50..=99) => 0x96,
            Realtime::Rapid(_) => 0x97,
            Realtime::Spindle(adjust) => adjust.byte(0x99),
            Realtime::SpindleStop => 0x9e,
            Realtime::Flood => 0xa0,
            Realtime::Mist => 0xa1,
            Realtime::Unknown(byte) => byte,
        }
    }
}
