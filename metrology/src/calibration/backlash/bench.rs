//! A machine whose tool is observed while it moves.

/// Positions after a step.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Position of the tool in the controller, nm.
    pub sent_nm: [f64; 3],
    /// True position of the tool, nm.
    pub tool_nm: [f64; 3],
    /// Whether the step takes up backlash. The tool should not move in it.
    pub is_take_up: bool,
    /// Time since the machine was switched on, s.
    pub at_s: f64,
}

/// A homed machine that executes blocks of G-code, with an observer of its tool.
pub trait Bench {
    /// Executes a block and calls `each` after every step.
    ///
    /// # Errors
    ///
    /// A sentence: the machine refuses the block, or loses steps.
    fn make(&mut self, block: &str, each: &mut dyn FnMut(&Moment)) -> Result<(), String>;
}
