//! A simulated measuring machine: servo modules on a line, DC motors, a work piece and a touch
//! probe.

mod chain;
mod contact;
mod emulation;
mod machines;
mod piece;
mod port;

pub use chain::{PERIOD_NS, SimulatedChain};
pub use contact::Contact;
pub use emulation::{IO_PANEL, PANEL};
pub use machines::{one_axis, three_axes};
pub use piece::{Mounted, Piece};
pub use port::SimulatedPort;

pub use husillo_sim::{
    Bore, ChainModule, DcMotorModel, Place, PointMm, Shape, Solid, TouchProbe, TouchProbeModel,
    WorkPiece,
};
