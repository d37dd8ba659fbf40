//! The simulated work piece before the probe of a simulated machine.

use crate::heads::Machine;
use husillo_sim::{PointMm, ServoNetwork, TouchProbe, WorkPiece};

/// A work piece and the probe that touches it, in the frame of the machine. Its origin is the
/// position of the axes at power-up.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The work piece.
    pub work: WorkPiece,
    /// The probe.
    pub probe: TouchProbe,
}

/// A work piece on a machine.
#[derive(Clone, Debug)]
pub struct Mounted {
    piece: Piece,
    /// Module, from 0, and coordinate of each axis.
    axes: Vec<(usize, usize)>,
    count_mm: f64,
}

impl Mounted {
    /// Puts a work piece on a machine.
    ///
    /// # Errors
    ///
    /// The length of a count of this machine is not known.
    pub fn new(piece: Piece, machine: &Machine) -> Result<Self, String> {
        let count_mm = machine.scale.count_mm().ok_or_else(|| {
            let title = &machine.title;
            format!("--piece is in mm, and {title} has no `count` (the length of one)")
        })?;
        let axes = machine.axes.iter();
        let place = |module: u8, coordinate| (usize::from(module) - 1, coordinate);
        let axes = axes.map(|axis| place(axis.module, axis.coordinate()));
        Ok(Self {
            piece,
            axes: axes.collect(),
            count_mm,
        })
    }

    /// Whether the contact of the probe is closed at the present positions of the motors.
    pub fn is_closed(&mut self, network: &ServoNetwork) -> bool {
        let mut centre: PointMm = [0.0; 3];
        for &(module, coordinate) in &self.axes {
            let motor = network.motor(module);
            centre[coordinate] = motor.map_or(0.0, |motor| motor.position_counts()) * self.count_mm;
        }
        self.piece.probe.is_closed(&self.piece.work, centre)
    }
}
