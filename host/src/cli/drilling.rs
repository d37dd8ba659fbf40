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
    /// Form of the output
    #[arg(long = "as", value_enum, value_name = "KIND", default_value = "list")]
    pub make: DrillOutput,
    /// File to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<String>,
    /// How the file is read and placed.
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
    /// Feed into the board, per minute
    #[arg(long, value_name = "MM", default_value = "60")]
    pub feed: String,
    /// Feed along slots, per minute [default: that of --feed]
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

/// How a drill file is read; which holes are drilled, in which order, and where.
#[derive(Debug, PartialEq, Args)]
pub struct Layout {
    /// Unit, instead of that of the file
    #[arg(long, value_enum)]
    pub units: Option<DrillUnits>,
    /// Zeros that are kept, instead of those of the file
    #[arg(long, value_enum)]
    pub zeros: Option<DrillZeros>,
    /// Digits before and after the omitted point, as in 2.4, instead of those of the file
    #[arg(long, value_name = "I.F")]
    pub format_digits: Option<String>,
    /// Kind of file, for settings that the file does not have
    #[arg(long, value_enum, default_value = "excellon")]
    pub profile: DrillProfile,
    /// Diameter of a tool, instead of that of the file; may be repeated
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
    /// Turn the board counter-clockwise by this angle, after --mirror
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
    /// Let --reference also correct the scale and the skew of the board
    #[arg(long)]
    pub stretch: bool,
    /// Move the board last, by X,Y millimetres; `corner` puts its smallest X and Y at 0,0
    #[arg(long, value_name = "X,Y|corner", allow_hyphen_values = true)]
    pub shift: Option<String>,
    /// How a slot is cut [default: drill; rout with --as gcode]
    #[arg(long, value_enum)]
    pub slots: Option<SlotHandling>,
    /// Allow records of the drill beyond its table of 220 x 45 mm, up to 612 mm
    #[arg(long)]
    pub unbounded: bool,
}

/// `husillo compile`.
#[derive(Debug, Args)]
pub struct Compile {
    /// Program, drill file (Excellon, TANGO), or figure of a microfactory
    pub file: String,
    /// Machine and language.
    #[command(flatten)]
    pub target: Target,
    /// File to write; for a drill file with several tools NAME.T1.cod and so on, and for each drill
    /// file a manifest NAME.toml
    #[arg(short, long, value_name = "NAME.cod")]
    pub output: Option<String>,
    /// How to print what was made
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// Page with a picture of the board: holes, order and travel
    #[arg(long, value_name = "REPORT.html")]
    pub report: Option<String>,
    /// How a program for the drill is compiled.
    #[command(flatten)]
    pub drilling: Drilling,
}

/// `husillo send`.
#[derive(Debug, Args)]
pub struct Send {
    /// Program, drill file, records (NAME.cod), their manifest (NAME.toml), or figure (NAME.fig):
    /// one for all ports, or one per port. - is standard input: a micro mill executes each line as
    /// soon as it arrives
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<String>,
    /// Machine and language.
    #[command(flatten)]
    pub target: Target,
    /// Port: sim, a serial device, or tcp:HOST:PORT; microfactory: repeated, for several machines
    /// at once, and PORT#2 for the second machine of a controller
    #[arg(short, long, value_name = "PORT", default_value = "sim")]
    pub port: Vec<String>,
    /// Bits per second of the link [default: 2400 for a drill, 115200 for Grbl, otherwise 9600]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(300..=4_000_000))]
    pub baud: Option<u32>,
    /// How to print what the machine does
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// Drill: first hole to be drilled, counted over all tools. Micro mill: line of the program at
    /// which to continue after a stop; the mill must be at the start of that line or on its path
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub from: Option<u32>,
    /// End when the start is confirmed, and let the drill continue alone, without a lease: one
    /// tool, up to 8192 bytes
    #[arg(long)]
    pub detach: bool,
    /// Do not ask for the diameter of each tool
    #[arg(short, long)]
    pub yes: bool,
    /// Micro mill: send lines ahead of the motion, without a stop between them
    #[arg(long)]
    pub stream: bool,
    /// Micro mill and Grbl: wait for Enter before each line; q ends the program there
    #[arg(long, conflicts_with = "stream")]
    pub single_block: bool,
    /// Grbl: number each line and add a checksum. A line that the link loses or changes is sent
    /// again. The controller must have checked lines ($L=1), as that of husillo has
    #[arg(long, conflicts_with_all = ["stream", "single_block"])]
    pub checked: bool,
    /// Micro mill: report one step in N; 0 reports none
    #[arg(
        long,
        value_name = "N",
        default_value_t = 1,
        value_parser = clap::value_parser!(u16).range(0..=999),
    )]
    pub every: u16,
    /// A motion of the machine ends if it receives no byte of this program for this time, ms; 0: a
    /// motion continues without this program [default: 250]
    #[arg(
        long,
        value_name = "MS",
        value_parser = clap::value_parser!(u16).range(0..=9999),
        conflicts_with = "detach",
    )]
    pub lease: Option<u16>,
    /// Do not home. Micro mill, microfactory: begin at the present position. Drill: ask it whether
    /// it is homed
    #[arg(long)]
    pub no_home: bool,
    /// Microfactory: the device does not answer, so nothing is confirmed
    #[arg(long)]
    pub without_answers: bool,
    /// How a program for the drill is compiled.
    #[command(flatten)]
    pub drilling: Drilling,
}

impl Send {
    /// The file and the port, for machines of which one command drives only one.
    ///
    /// # Errors
    ///
    /// There are several files or ports.
    pub fn alone(&self) -> Result<(&str, &str), String> {
        match (&self.files[..], &self.port[..]) {
            ([file], [port]) => Ok((file, port)),
            _ => Err("this machine is driven alone: one file, and one --port".into()),
        }
    }
}

/// How a program for the drill is compiled.
#[derive(Debug, PartialEq, Args)]
pub struct Drilling {
    /// How the file is read and placed.
    #[command(flatten)]
    pub layout: Layout,
    /// Depths from Z words and G81 to G83, for a drill without the flaws of the original: the
    /// program is then RS-274
    #[arg(long)]
    pub fixed: bool,
    /// Depth of all holes of a drill file below the upper sensor, for a drill without the flaws of
    /// the original [default: to the lower sensor]
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
    /// Whether no option is given.
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

/// Form of the output of a drill file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DrillOutput {
    /// A list of tools and holes.
    List,
    /// A G-code program.
    Gcode,
    /// The program of the circuit-board drill: three-byte records, one tool per file.
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

/// How a slot is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SlotHandling {
    /// The tool goes along it.
    Rout,
    /// Holes at both ends, and overlapping holes between.
    Drill,
    /// Not at all: an error.
    Refuse,
}

impl From<Mirror> for husillo_holes::Mirror {
    fn from(mirror: Mirror) -> Self {
        match mirror {
            Mirror::X => Self::X,
            Mirror::Y => Self::Y,
        }
    }
}

impl From<Cycle> for husillo_holes::Cycle {
    fn from(cycle: Cycle) -> Self {
        match cycle {
            Cycle::G81 => Self::G81,
            Cycle::G83 => Self::G83,
            Cycle::Moves => Self::Moves,
        }
    }
}

impl From<SlotHandling> for husillo_holes::SlotHandling {
    fn from(handling: SlotHandling) -> Self {
        match handling {
            SlotHandling::Rout => Self::Rout,
            SlotHandling::Drill => Self::Drill,
            SlotHandling::Refuse => Self::Refuse,
        }
    }
}
