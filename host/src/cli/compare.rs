//! `husillo compare`: its arguments.

use super::interpolate::Turning;
use super::{Page, Target};
use clap::Args;

/// `husillo compare`.
#[derive(Debug, Args)]
pub struct Compare {
    /// circle, arc, line, or a program; motion compares rules of motion
    #[arg(value_name = "circle|arc|line|motion|FILE")]
    pub job: String,
    /// Program for motion
    #[arg(value_name = "FILE")]
    pub file: Option<String>,
    /// Machine and language.
    #[command(flatten)]
    pub target: Target,
    /// Radius of a circle in steps [default: 30]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(i32).range(1..=1 << 28))]
    pub radius: Option<i32>,
    /// Start of an arc in steps
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub from: Option<String>,
    /// End of an arc or of a line from zero, in steps; a line has two to six axes
    #[arg(long, value_name = "X,Y[,Z..]", allow_hyphen_values = true)]
    pub to: Option<String>,
    /// Centre of an arc in steps, as decimals
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub centre: Option<String>,
    /// Turning direction of a circle or an arc
    #[arg(long, value_enum, default_value = "ccw")]
    pub direction: Turning,
    /// Methods to compare [default: all]
    #[arg(long, value_name = "METHODS")]
    pub only: Option<String>,
    /// Weights of error, iterations, evenness and work in the decision matrix
    #[arg(
        long,
        value_name = "E,I,S,W",
        default_value = "3,3,3,1",
        allow_hyphen_values = true
    )]
    pub weights: String,
    /// Window of limited jerk in ms, for motion: acceleration / jerk [default: that of the machine
    /// file, or 20]
    #[arg(long, value_name = "MS")]
    pub window: Option<f64>,
    /// How to print the results [default: by the name of the output, or text]
    #[arg(long, value_enum)]
    pub format: Option<Page>,
    /// File to write instead of standard output
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<String>,
}

/// What the figures of `husillo compare` mean.
pub(super) const COMPARE_HELP: &str = "\
Methods:
  lines  bresenham, dda, dda-printed
  arcs   direct-search, dda, staircase and, as their literature prints them,
         direct-search-printed, dda-printed, staircase-printed

Figures (1 BLU = one motor step; JSON: `methods` has an object for each):
  iterations      passes of the method's loop
  moving          passes that step an axis; the others are idle
  max_error_blu   largest distance of the tool from the exact curve after a pass: square to a line,
                  radially to an arc, from the band between the radii of a spiral
  rms_error_blu   root mean square of that distance over all passes
  mean_speed      length of the curve per time of the move, 1 = the programmed feed, with passes at
                  the constant rate of one BLU of programmed feed each (equal time; the idle passes
                  of dda-printed take no time)
  ripple_percent  the larger deviation of the speed from the mean, in per cent, over any 32 timed
                  passes in a row; speed is the progress along the exact curve per time; a move of
                  fewer passes has 0
  ripple_percent_windows
                  slowest (low) and fastest (high) relative to the mean over 1, 8, 32 and 128 passes
  vector_feed     the same three if every event takes the time of its own path, timed to 1/1000 of
                  the time of a BLU; null for methods whose passes are a BLU each
  additions, tests
                  of one pass at most, two axes, by the method itself, without the borders of
                  quadrants and the end of the move
  instructions    of one event, two axes, on Cortex-M0, Cortex-M4F and RISC-V under QEMU, from
                  firmware/proofs/counts/golden.txt; direct-search as the kernel for whole-step
                  centres, if the centres are whole
  points          decision matrix, 0 to 100: error, iterations and work are the best method's value
                  divided by the method's own, in per cent (work: Cortex-M4F instructions, or
                  additions and tests if not all methods have a count); evenness is 100 less the
                  ripple over 32 events, slowest to fastest, with vector feed if available, as
                  printed with equal time; total is the mean by --weights

Of a program, every G1, G2 and G3 is made on the machine's grid, without rapids and without the
motion of helices across their plane. Iterations are sums, errors and ripples the worst of any move,
moves counts them. Methods other than direct-search have whole-step centres only: their centres are
rounded, and arcs that one of them cannot make at all are left out and counted.

Motion:
  husillo compare motion FILE makes the whole program under four rules and compares time, speed,
  acceleration, jerk and corners. The rules know all moves ahead:
  trapezoid       the rule of husillo: limited acceleration, also towards the centre of arcs
  jerk            that of a machine with jerk: limited jerk as well, with 0.866 of the least
                  acceleration of all axes
  grbl            Grbl: arcs as chords of 0.002 mm tolerance, corners by 0.01 mm deviation
  klipper         Klipper: arcs as chords of 1 mm, corners by 5 mm/s square corner velocity
  The machine needs axes with ramps. Stops for take-ups count for the first two rules.

Examples:
  husillo compare motion examples/gear.nc -m micromill -o motion.html
  husillo compare circle --radius 30
  husillo compare circle --radius 1000 --only dda,direct-search -o circle.html
  husillo compare line --to 1000,500 --format json
  husillo compare examples/gear.nc -m micromill --weights 5,1,3,1";
