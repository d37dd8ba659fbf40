//! Drill files, and programs that are sent to a controller.

use super::{Output, Target};
use clap::{Args, Parser, ValueEnum};

/// `husillo holes`.
#[derive(Debug, Args)]
pub struct Holes {
    /// Drill file; - is standard input
    pub file: String,
    /// How to print the holes
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// What to make of the file
    #[arg(long = "as", value_enum, value_name = "KIND", default_value = "list")]
    pub make: DrillOutput,
    /// File to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<String>,
    /// What is made of the file.
    #[command(flatten)]
    pub layout: Layout,
    /// Depth of the holes below the surface, which is Z0
    #[arg(long, value_name = "MM", allow_hyphen_values = true)]
    pub depth: Option<String>,
    /// Height above the surface between holes
    #[arg(long, value_name = "MM", default_value = "2")]
    pub clearance: String,
    /// Height above the surface for tool changes
    #[arg(long, value_name = "MM", default_value = "10")]
    pub safe: String,
    /// Feed into the board, a minute
    #[arg(long, value_name = "MM", default_value = "60")]
    pub feed: String,
    /// Feed along slots, a minute [default: that of --feed]
    #[arg(long, value_name = "MM")]
    pub rout_feed: Option<String>,
    /// Spindle speed
    #[arg(long, value_name = "RPM")]
    pub speed: Option<u32>,
    /// How a hole is drilled
    #[arg(long, value_enum, default_value = "g81")]
    pub cycle: Cycle,
    /// Depth of one peck of --cycle g83
    #[arg(long, value_name = "MM", default_value = "0.5")]
    pub peck: String,
}

/// How a drill file is read, which of its holes are made, in which order, and where.
#[derive(Debug, PartialEq, Args)]
pub struct Layout {
    /// Unit, whatever the file says
    #[arg(long, value_enum)]
    pub units: Option<DrillUnits>,
    /// Zeros that are kept, whatever the file says
    #[arg(long, value_enum)]
    pub zeros: Option<DrillZeros>,
    /// Digits before and behind the point that is not written, whatever the file says, as in 2.4
    #[arg(long, value_name = "I.F")]
    pub format_digits: Option<String>,
    /// Kind of file, for what it does not say
    #[arg(long, value_enum, default_value = "excellon")]
    pub profile: DrillProfile,
    /// Diameter of a tool, whatever the file says; may be repeated
    #[arg(long, value_name = "N=MM")]
    pub tool: Vec<String>,
    /// Order of the holes: as in the file, or tool by tool on a short path (nearest neighbour,
    /// 2-opt and Or-opt)
    #[arg(long, value_enum, default_value = "file")]
    pub order: DrillOrder,
    /// Only the holes and slots of this tool; may be repeated
    #[arg(long, value_name = "N")]
    pub only: Vec<u16>,
    /// Turn the board over: x changes the sign of X, y that of Y
    #[arg(long, value_enum, value_name = "AXIS")]
    pub mirror: Option<Mirror>,
    /// Turn the board counter-clockwise by so many degrees, after --mirror
    #[arg(
        long,
        value_name = "DEGREES",
        default_value = "0",
        hide_default_value = true,
        allow_negative_numbers = true,
        value_parser = degrees
    )]
    pub turn: f64,
    /// Position of a hole in the file, and its measured position; two or more turn and shift the
    /// board onto them (least squares)
    #[arg(long, value_name = "X,Y=X,Y", allow_hyphen_values = true)]
    pub reference: Vec<String>,
    /// Let --reference stretch the board as well, by the scale and the skew it finds
    #[arg(long)]
    pub stretch: bool,
    /// Move the board by X,Y millimetres, after all this; `corner` puts its least X and Y at 0,0
    #[arg(long, value_name = "X,Y|corner", allow_hyphen_values = true)]
    pub shift: Option<String>,
    /// How a slot is made [default: drill; rout with --as gcode]
    #[arg(long, value_enum)]
    pub slots: Option<SlotHandling>,
    /// Let records of the drill go beyond its table of 220 x 45 mm, up to 612 mm
    #[arg(long)]
    pub unbounded: bool,
}

/// `husillo compile`.
#[derive(Debug, Args)]
pub struct Compile {
    /// Program in the drill's language, drill file (Excellon, TANGO), or figure of a microfactory
    pub file: String,
    /// Machine and language.
    #[command(flatten)]
    pub target: Target,
    /// File to write; for a drill file with several tools NAME.T1.cod and so on, and for each drill
    /// file a manifest NAME.toml
    #[arg(short, long, value_name = "NAME.cod")]
    pub output: Option<String>,
    /// Page with a picture of the board: holes, order and travel
    #[arg(long, value_name = "REPORT.html")]
    pub report: Option<String>,
    /// What is made of a program for the drill.
    #[command(flatten)]
    pub drilling: Drilling,
}

/// `husillo send`.
#[derive(Debug, Args)]
pub struct Send {
    /// Program, drill file, records (NAME.cod), a manifest of them (NAME.toml), or a figure
    /// (NAME.fig); of figures one per port; - for standard input, of which the micro mill makes each
    /// line when it arrives
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<String>,
    /// Machine and language.
    #[command(flatten)]
    pub target: Target,
    /// Port: sim, a serial device, or tcp:HOST:PORT; microfactory: several for as many machines at
    /// once, PORT#2 for the second machine of a controller
    #[arg(short, long, value_name = "PORT", default_value = "sim")]
    pub port: Vec<String>,
    /// Bits a second of the link [default: 2400, of the micro mill and the microfactory 9600]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(300..=115_200))]
    pub baud: Option<u32>,
    /// First hole to be drilled, counted through all tools
    #[arg(
        long,
        value_name = "HOLE",
        default_value_t = 1,
        hide_default_value = true,
        value_parser = clap::value_parser!(u32).range(1..),
    )]
    pub from: u32,
    /// End when the start is confirmed, and let the drill continue alone: one tool, up to 8192
    /// bytes
    #[arg(long)]
    pub detach: bool,
    /// Do not ask for tools
    #[arg(short, long)]
    pub yes: bool,
    /// Micro mill: lines go ahead of the motion, without a stop between them
    #[arg(long)]
    pub stream: bool,
    /// Micro mill: each line waits for Enter; q ends the program before it
    #[arg(long, conflicts_with = "stream")]
    pub single_block: bool,
    /// Micro mill: one step in N is reported; 0 for none
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1,
        value_parser = clap::value_parser!(u16).range(0..=999),
    )]
    pub every: u16,
    /// Micro mill: a motion ends this many milliseconds after the last byte of this program; 0: it
    /// needs no host [default: 250]
    #[arg(long, value_name = "MS", value_parser = clap::value_parser!(u16).range(0..=9999))]
    pub lease: Option<u16>,
    /// Micro mill: it is homed, and the program begins where it stands; microfactory: figures begin
    /// at the present positions
    #[arg(long)]
    pub no_home: bool,
    /// Microfactory: the device does not answer; what is sent is not confirmed
    #[arg(long)]
    pub without_answers: bool,
    /// What is made of a program for the drill.
    #[command(flatten)]
    pub drilling: Drilling,
}

impl Send {
    /// The file and the port, for machines that are driven alone.
    ///
    /// # Errors
    ///
    /// There are several.
    pub fn alone(&self) -> Result<(&str, &str), String> {
        match (&self.files[..], &self.port[..]) {
            ([file], [port]) => Ok((file, port)),
            _ => Err("this machine is driven alone: one file, and one --port".into()),
        }
    }
}

/// What is said of a program for the drill.
#[derive(Debug, PartialEq, Args)]
pub struct Drilling {
    /// What is made of the file.
    #[command(flatten)]
    pub layout: Layout,
    /// Depths from Z words and G81 to G83, for a drill with its flaws mended: the program is RS-274
    /// then
    #[arg(long)]
    pub fixed: bool,
    /// Depth of all holes of a drill file below the upper sensor, for a drill with its flaws mended
    /// [default: to the lower sensor]
    #[arg(long, value_name = "MM")]
    pub depth: Option<String>,
    /// Height of the upper sensor above Z 0 of the program, with --fixed
    #[arg(
        long,
        value_name = "MM",
        default_value = "0",
        allow_hyphen_values = true
    )]
    pub home_height: String,
}

impl Drilling {
    /// Whether nothing is said of a program.
    pub fn is_default(&self) -> bool {
        #[derive(Parser)]
        struct Nothing {
            #[command(flatten)]
            drilling: Drilling,
        }
        *self == Nothing::parse_from([""]).drilling
    }
}

/// An angle of at most a whole turn.
fn degrees(text: &str) -> Result<f64, String> {
    let angle = text.parse().ok();
    let angle = angle.filter(|angle: &f64| angle.abs() <= 360.0);
    angle.ok_or_else(|| "expected degrees, from -360 to 360".into())
}

/// What to make of a drill file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DrillOutput {
    /// A list of tools and holes.
    List,
    /// A G-code program.
    Gcode,
    /// The program of the circuit-board drill: three-byte records, one tool a file.
    Drill,
}

/// The axis whose sign changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Mirror {
    /// X.
    X,
    /// Y.
    Y,
}

/// Unit of a drill file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DrillUnits {
    /// Inches.
    Inch,
    /// Millimetres.
    Mm,
}

/// Zeros that are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DrillZeros {
    /// LZ: trailing zeros are left out.
    Leading,
    /// TZ: leading zeros are left out.
    Trailing,
}

/// Kind of drill file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DrillProfile {
    /// Inches 2.4 or millimetres 3.3.
    Excellon,
    /// Inches 2.3, tools without diameters.
    Tango,
}

/// Order of holes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DrillOrder {
    /// As in the file.
    File,
    /// Tool by tool, on a short path.
    Shortest,
}

/// How a hole is drilled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Cycle {
    /// One feed down.
    G81,
    /// In pecks.
    G83,
    /// One feed down, with G0 and G1 only.
    Moves,
}

/// How a slot is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SlotHandling {
    /// The tool goes along it.
    Rout,
    /// Both ends and overlapping holes between.
    Drill,
    /// Not at all: an error.
    Refuse,
}
