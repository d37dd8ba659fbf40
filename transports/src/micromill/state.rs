//! The state that only the controller knows.

/// One axis of a [`State`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AxisState {
    /// Position of the load in steps: from machine zero, or from the position at power-on if the
    /// mill is not homed.
    pub load_steps: i32,
    /// Motor steps ahead of the load. It is 0 if the negative flank of the screw is engaged, and
    /// the backlash if the positive flank is engaged. It is always 0 before homing.
    pub ahead_steps: u16,
    /// The backlash that is taken up after homing, in steps.
    pub backlash_steps: u16,
    /// The part's zero, in nanometres from machine zero.
    pub zero_nm: i32,
}

impl AxisState {
    /// Returns the position of the motor in steps. With the positive flank engaged it is the
    /// position of the load. With the negative flank engaged it is less by the backlash.
    pub const fn motor_steps(&self, is_homed: bool) -> i32 {
        let backlash = if is_homed { self.backlash_steps } else { 0 };
        let ahead = self.load_steps.wrapping_add(self.ahead_steps as i32);
        ahead.wrapping_sub(backlash as i32)
    }

    /// Returns the numbers of the link, eight digits each.
    pub(super) const fn words(&self) -> [u32; 3] {
        let backlash = (self.ahead_steps as u32) << 16 | self.backlash_steps as u32;
        [self.load_steps as u32, backlash, self.zero_nm as u32]
    }

    const fn of([load, backlash, zero]: [u32; 3]) -> AxisState {
        AxisState {
            load_steps: load as i32,
            ahead_steps: (backlash >> 16) as u16,
            backlash_steps: backlash as u16,
            zero_nm: zero as i32,
        }
    }
}

/// Position, backlash and zero of all axes, and whether the mill is homed. [`Order::Report`] asks
/// for it.
///
/// The controller sends it in [`Answer::Digit`]s, the highest digit of a number first: for each
/// axis eight digits of `load_steps`, four of `ahead_steps`, four of `backlash_steps` and eight of
/// `zero_nm`, then 1 if the mill is homed, otherwise 0. [`StateDigits`] collects them.
///
/// [`Order::Report`]: super::Order::Report
/// [`Answer::Digit`]: super::Answer::Digit
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct State {
    /// X, Y and Z.
    pub axes: [AxisState; 3],
    /// Whether positions count from machine zero.
    pub is_homed: bool,
}

impl State {
    /// Returns the state after homing: at machine zero, with the positive flanks engaged.
    pub fn homed(self) -> State {
        State {
            axes: self.axes.map(|axis| AxisState {
                load_steps: 0,
                ahead_steps: axis.backlash_steps,
                ..axis
            }),
            is_homed: true,
        }
    }

    /// Returns the positions of the motors: [`AxisState::motor_steps`].
    pub fn motor_steps(&self) -> [i32; 3] {
        self.axes.map(|axis| axis.motor_steps(self.is_homed))
    }
}

/// The digits of a [`State`] as they arrive.
///
/// # Examples
/// ```
/// use husillo_transports::micromill::StateDigits;
///
/// let mut digits = StateDigits::new();
/// for _ in 0..72 {
///     digits.push(0);
/// }
/// assert_eq!(digits.state(), None); // one is missing
/// digits.push(1);
/// assert!(digits.state().is_some_and(|state| state.is_homed));
/// ```
#[derive(Debug, Clone, Default)]
pub struct StateDigits {
    words: [u32; 9],
    last: u8,
    count: u8,
}

impl StateDigits {
    /// No digit has arrived.
    pub const fn new() -> StateDigits {
        StateDigits {
            words: [0; 9],
            last: 0,
            count: 0,
        }
    }

    /// Takes a digit, 0 to 15.
    pub fn push(&mut self, digit: u8) {
        match self.words.get_mut(usize::from(self.count >> 3)) {
            Some(word) => *word = *word << 4 | u32::from(digit & 0x0f),
            None => self.last = digit,
        }
        self.count = self.count.saturating_add(1);
    }

    /// Returns the state. Returns `None` if the number of digits is wrong, or if a number is
    /// impossible.
    pub fn state(&self) -> Option<State> {
        if self.count != 73 || self.last > 1 {
            return None;
        }
        let [x0, x1, x2, y0, y1, y2, z0, z1, z2] = self.words;
        let axes = [[x0, x1, x2], [y0, y1, y2], [z0, z1, z2]].map(AxisState::of);
        let is_possible = axes
            .iter()
            .all(|axis| axis.ahead_steps <= axis.backlash_steps);
        is_possible.then_some(State {
            axes,
            is_homed: self.last == 1,
        })
    }
}
