//! A simulated measuring machine: servo modules on a line, DC motors, a work piece and a touch
//! probe.

mod contact;
mod emulation;
mod machines;
mod network;
mod piece;
mod port;

pub use contact::Contact;
pub use emulation::{IO_PANEL, PANEL};
pub use machines::{one_axis, three_axes};
pub use network::{PERIOD_NS, SimulatedNetwork};
pub use piece::{Mounted, Piece};
pub use port::SimulatedPort;

pub use husillo_sim::{
    Bore, DcMotorModel, NetworkModule, Place, PointMm, Shape, Solid, TouchProbe, TouchProbeModel,
    WorkPiece,
};
