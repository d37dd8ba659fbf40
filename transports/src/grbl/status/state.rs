//! States of a controller.

/// State of a controller. A number after it is printed as `Hold:0`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum State {
    /// Waits for lines.
    Idle,
    /// Executes moves.
    Run,
    /// Feed hold: `true` while it still brakes (`Hold:1`).
    Hold(bool),
    /// Executes jogs.
    Jog,
    /// Locked.
    Alarm,
    /// The safety door: 0 closed again, 1 open, 2 braking, 3 restoring the outputs.
    Door(u8),
    /// Checks lines without executing them.
    Check,
    /// Homing.
    Home,
    /// All outputs are off until a reset.
    Sleep,
    /// The operator changes the tool. Only grblHAL has this state.
    Tool,
}

impl State {
    /// All states.
    pub const ALL: [State; 14] = [
        State::Idle,
        State::Run,
        State::Hold(false),
        State::Hold(true),
        State::Jog,
        State::Alarm,
        State::Door(0),
        State::Door(1),
        State::Door(2),
        State::Door(3),
        State::Check,
        State::Home,
        State::Sleep,
        State::Tool,
    ];

    /// Returns its name in a report.
    pub const fn name(self) -> &'static str {
        match self {
            State::Idle => "Idle",
            State::Run => "Run",
            State::Hold(false) => "Hold:0",
            State::Hold(true) => "Hold:1",
            State::Jog => "Jog",
            State::Alarm => "Alarm",
            State::Door(0) => "Door:0",
            State::Door(1) => "Door:1",
            State::Door(2) => "Door:2",
            State::Door(_) => "Door:3",
            State::Check => "Check",
            State::Home => "Home",
            State::Sleep => "Sleep",
            State::Tool => "Tool",
        }
    }

    pub(crate) fn parse(text: &[u8]) -> Option<State> {
        let mut states = State::ALL.into_iter();
        states.find(|state| state.name().as_bytes() == text)
    }
}
