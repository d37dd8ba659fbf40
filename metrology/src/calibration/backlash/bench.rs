//! A machine whose tool is watched while it moves.

/// Where things are after a step.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Where the controller has the tool, nm.
    pub sent_nm: [f64; 3],
    /// Where it is, nm.
    pub tool_nm: [f64; 3],
    /// The step takes up backlash: the tool is not to move.
    pub is_take_up: bool,
}

/// A homed machine that makes blocks of G-code, with something that sees where its tool is.
pub trait Bench {
    /// Makes a block; `each` sees every step of it.
    ///
    /// # Errors
    ///
    /// A sentence: the machine refuses the block, or loses steps.
    fn make(&mut self, block: &str, each: &mut dyn FnMut(&Moment)) -> Result<(), String>;
}
