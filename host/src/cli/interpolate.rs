//! `husillo interpolate`: its arguments.

use super::Output;
use clap::{Args, Subcommand, ValueEnum};

/// `husillo interpolate`.
#[derive(Debug, Args)]
pub struct Interpolate {
    /// The move.
    #[command(subcommand)]
    pub shape: Shape,
}

/// The moves.
#[derive(Debug, Subcommand)]
pub enum Shape {
    /// A straight move from zero
    Line(LineShape),
    /// A circular move
    Arc(ArcShape),
}

/// `husillo interpolate line`.
#[derive(Debug, Args)]
pub struct LineShape {
    /// Target in steps, two to six axes
    #[arg(long, value_name = "X,Y[,Z..]", allow_hyphen_values = true)]
    pub to: String,
    /// Method: bresenham, dda or dda-printed
    #[arg(long, default_value = "bresenham")]
    pub method: String,
    /// How to print the move
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
}

/// `husillo interpolate arc`.
#[derive(Debug, Args)]
pub struct ArcShape {
    /// Start in steps
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub from: String,
    /// End in steps
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub to: String,
    /// Centre in steps, as decimals
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub centre: String,
    /// Turning direction
    #[arg(long, value_enum)]
    pub direction: Turning,
    /// Fraction bits of the centre, 0 to 16
    #[arg(long, value_name = "F", default_value_t = 16)]
    pub centre_bits: u8,
    /// Square of the radius, in units of 2^(-2F) steps^2: a circle of this radius instead of a
    /// spiral
    #[arg(long, value_name = "R2")]
    pub radius_squared: Option<u128>,
    /// Complete extra turns
    #[arg(long, default_value_t = 0)]
    pub turns: u32,
    /// Method: direct-search, dda or staircase; the same with -printed
    #[arg(long, default_value = "direct-search")]
    pub method: String,
    /// How to print the move
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
}

/// Turning direction of an arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Turning {
    /// Clockwise.
    Cw,
    /// Counter-clockwise.
    Ccw,
}

impl From<Turning> for husillo_interp::Direction {
    fn from(turning: Turning) -> Self {
        match turning {
            Turning::Cw => Self::Clockwise,
            Turning::Ccw => Self::CounterClockwise,
        }
    }
}
