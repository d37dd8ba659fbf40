//! The command line: what can be asked, and the help texts.

use crate::diagnostics::Format;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::ffi::OsString;

/// Check, simulate and draw programs for small machines
#[derive(Debug, Parser)]
#[command(
    name = "husillo",
    version,
    after_help = "Start here:\n  \
        husillo run examples/circles.nc     simulate a part and look at the report\n  \
        husillo check part.nc               find all errors without running it\n\n\
        Exit status: 0 ok, 1 the program has errors, 2 bad command line or file"
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Simulate a program down to the motor coils and report path, time and error
    #[command(after_help = "Examples:\n  \
        husillo run examples/circles.nc\n  \
        husillo run part.nc -o part.html --no-compensation\n  \
        husillo run part.nc -m free --format json")]
    Run(Run),
    /// Find errors in programs without running them
    #[command(after_help = "Examples:\n  \
        husillo check part.nc\n  \
        husillo check part.nc -m micromill --format short\n  \
        husillo check - < part.nc")]
    Check(Check),
    /// Write programs in one form, with nothing lost: capitals, one space between words, plain numbers
    #[command(after_help = "Examples:\n  \
        husillo format part.nc\n  \
        husillo format part.nc -o part.nc\n  \
        husillo format --check *.nc")]
    Format(FormatArgs),
    /// Print the commands a program means
    #[command(after_help = "Examples:\n  \
        husillo commands part.nc\n  \
        husillo commands part.nc --format json")]
    Commands(Commands),
    /// Write the step events of a program as CSV
    #[command(after_help = "Example:\n  \
        husillo steps examples/circles.nc -o circles.csv")]
    Steps(Steps),
    /// List the holes of a drill file (Excellon), or make G-code or drill records of them
    #[command(after_help = "Examples:\n  \
        husillo holes board.drl\n  \
        husillo holes board.drl --order shortest --format json\n  \
        husillo holes board.drl --as gcode --depth 1.8 --feed 120 -o board.nc\n  \
        husillo holes board.drl --as drill --only 1 --shift corner -o board.cod")]
    Holes(Holes),
    /// Translate a program or a drill file for a controller that has no interpreter: records of the circuit-board drill, strings of the micro mill
    #[command(after_help = "Examples:\n  \
        husillo compile board.drl -m drill -o board.cod\n  \
        husillo compile board.drl -m drill --order shortest --shift corner --report board.html\n  \
        husillo compile holes.nc -m drill -o holes.cod\n  \
        husillo compile part.nc -m micromill -o part.mm\n  \
        husillo commands board.cod --format gcode")]
    Compile(Compile),
    /// Send a program to the drill or the micro mill and see it made
    #[command(after_help = "Examples:\n  \
        husillo send board.drl -m drill --shift corner --port /dev/ttyUSB0\n  \
        husillo send board.toml -m drill --port tcp:192.168.1.5:4001\n  \
        husillo send board.cod -m drill --port /dev/ttyUSB0 --detach\n  \
        husillo send board.drl -m drill --from 37\n\n\
        It pauses between tools, spindle off, and asks for the diameter of the next one; Ctrl-C stops behind the hole that is being\n\
        drilled. After a fault it says which hole is next: --from goes on there.\n\n  \
        husillo send part.nc -m micromill --port /dev/ttyUSB0\n  \
        husillo send examples/circles.nc -m micromill --port tcp:127.0.0.1:7000\n\n\
        The micro mill homes first; the steps that its controller tells are compared with the simulator's: exit status 1 where they differ.")]
    Send(Send),
    /// Walk one move on the bare integer grid
    #[command(after_help = "Examples:\n  \
        husillo interpolate line --to 10,4,3\n  \
        husillo interpolate line --to 10,4 --method dda-printed\n  \
        husillo interpolate arc --from 30,0 --to 30,0 --centre 0,0 --direction ccw --format json")]
    Interpolate(Interpolate),
    /// Compare all interpolation methods on one move or on a program
    #[command(after_help = "Examples:\n  \
        husillo compare circle --radius 30\n  \
        husillo compare circle --radius 1000 --only dda,direct-search -o circle.html\n  \
        husillo compare line --to 1000,500 --format json\n  \
        husillo compare examples/gear.nc -m micromill --weights 5,1,3,1")]
    #[command(after_long_help = COMPARE_HELP)]
    Compare(Compare),
    /// List the machines, or show one: resolution, rates, motor current, chopper and filter
    #[command(after_help = "Examples:\n  \
        husillo machines\n  \
        husillo machines show micromill")]
    Machines(Machines),
    /// Move a microfactory by hand: home, counted steps, jogs, figures, emergency stop
    #[command(after_help = "Actions, done in turn:\n  \
        home         X, Y and Z to their switches and 200 steps back\n  \
        x -25        steps of a motor: x, y, z, or c for the spindle\n  \
        y+ 1.5s      turn a motor for a while\n  \
        figure       feed Y until the tool touches, then cut the stored figure\n  \
        stop, emergency\n  \
        2: ACTION..  for the second --port alone; all: for all again\n\n\
        Examples:\n  \
        husillo jog home x 400 figure\n  \
        husillo jog --port /dev/ttyUSB0 home y+ 1s\n  \
        husillo jog --port /dev/ttyUSB0 --port /dev/ttyUSB1 home 1: x 400 2: z -60 all: figure")]
    Jog(crate::cell::Jog),
    /// Measure with a contact probe and correct for pre-travel
    #[command(after_help = "Actions, done in turn:\n  \
        goto POSITION         straight to X10 Y-2.5 Z0; in mm where the machine file has a `count`, otherwise in counts\n  \
        zero                  call the present place 0\n  \
        home [x|y|z]          search the index of the encoder and call it 0\n  \
        jog DIRECTION TIME    run for a time as 2s at the speed of moves, or with `slow` of a search\n  \
        touch DIRECTION       search the work piece, touch it slowly, correct for pre-travel\n  \
        calibrate DIRECTION   touch a face that is at --reference: its pre-travel\n  \
        calibrate sphere|ring X.. Y.. Z.. R..  touch a body of this radius with about this centre: pre-travel by direction\n  \
        run FILE              a measuring routine, or a G-code program (.nc, .ngc, ...); exit status 1 out of tolerance
                        (routines: programs have none), 3 in trouble\n  \
        record FILE           statements from the standard input are carried out and written as a routine\n  \
        status                position, version and status of the module\n\n\
        A DIRECTION is +x, -z, a vector as 1,0,-1, or + or - of --axis; a POSITION without a letter is one of --axis.\n\
        The modules are reset first, so positions count from where the axes are.\n\
        Ctrl-C stops all axes smoothly: exit status 130.\n\n\
        Examples:\n  \
        husillo measure -m cmm goto 1200 touch + --contact 1:3018 --pretravel 18\n  \
        husillo measure -m cmm3 goto X1 Y2 Z-3 touch -z touch 1,1,0 --contact 1:2000 --contact 3:..-2000\n  \
        husillo measure -m cmm3 --piece examples/piece.toml goto X20 Y20 Z-15 touch -z\n  \
        husillo measure -m cmm3 --piece examples/piece.toml --ball 1 --pretravel \"8 um\" run examples/piece.routine -o piece.html\n  \
        husillo measure -m cmm --port /dev/ttyUSB0 touch - --repeat 5 -o touches.csv\n  \
        husillo measure -m cmm calibrate + --reference 3000 --contact 1:3018")]
    Measure(Measure),
    /// Simulated modules behind a pseudo-terminal, for any client of their protocol
    #[command(after_help = "Examples:\n  \
        husillo emulate cmm --link ./cmm\n  \
        husillo emulate cmm --modules servo:4,servo:4 --link ./cmm --contact 1:3000 --contact 1:..-3000\n  \
        husillo emulate cmm3 --link ./cmm --piece examples/piece.toml")]
    Emulate(Emulate),
    /// Find the gains of a servo
    #[command(after_help = TUNE_HELP)]
    Tune(Tune),
    /// Find the errors of a machine from measurements, as lines for its file
    Calibrate(crate::calibrate::Calibrate),
}

/// What the methods of `husillo tune` do.
const TUNE_HELP: &str = "\
Methods:
  step      a step of --size counts with the gains of the machine file, or those given
  ultimate  the proportional gain is raised until the axis swings for ever: Ku, Tu, and gains by --rule
  relay     a relay in the place of the controller finds the same point in one experiment
  stepwise  as by hand: derivative up to vibration, proportional, integral with its limit at 16000, the limit down

The axis moves by itself, within its travel: by --size counts, and in the moves that check the gains by up to 1000 to each side.
A position error or a current beyond its limit ends it with the motor off.

Examples:
  husillo tune -m cmm --method step --p 100 --i 0 --d 10000 -o step.html
  husillo tune -m cmm --method ultimate --rule ziegler-nichols
  husillo tune -m cmm --method stepwise --port /dev/ttyUSB0 --current 101";

/// What the figures of `husillo compare` mean.
const COMPARE_HELP: &str = "\
Methods:
  lines  bresenham, dda, dda-printed
  arcs   direct-search, dda, staircase and, as their literature prints them,
         direct-search-printed, dda-printed, staircase-printed

Figures (1 BLU = one motor step; JSON: a list with one object a method):
  iterations      passes of the method's loop
  moving          those that step an axis; the others are idle
  max_error_blu   largest distance of the tool from the exact curve after a pass: square to a line, radially
                  to an arc, outside of the band between the radii of a spiral
  rms_error_blu   root mean square of that distance over all passes
  mean_speed      length of the curve by the time of the move, 1 = the programmed feed, when passes come at one
                  rate of one BLU of programmed feed each (equal time; the idle passes of dda-printed take none)
  ripple_percent  the larger deviation of the speed from the mean, in per cent, over any 32 timed passes in a
                  row, speed being the progress along the exact curve by time; a move of fewer passes has 0
  ripple_percent_windows
                  slowest (low) and fastest (high) against the mean over 1, 8, 32 and 128 passes
  vector_feed     the same three when every event takes the time of its own path, timed to 1/1000 of the time of
                  a BLU; null for methods whose passes are a BLU each
  additions, tests
                  of one pass at most, two axes, by the method itself: what the borders of quadrants and the end
                  of the move need comes on top
  instructions    of one event, two axes, on Cortex-M0, Cortex-M4F and RISC-V under QEMU, from
                  firmware/count/golden.txt; direct-search as the kernel for whole-step centres where they are
  points          decision matrix, 0 to 100: error, iterations and work are the best method's value by the
                  method's own, in per cent (work: Cortex-M4F instructions, or additions and tests where not all
                  methods have a count); evenness is 100 less the ripple over 32 events, slowest to fastest, with
                  vector feed where there is one, as printed with equal time; total is the mean by --weights

Of a program every G1, G2 and G3 is made on the machine's grid, rapids and what a helix does across its plane are
not; iterations are sums, errors and ripples the worst of any move, moves counts them. Methods other than
direct-search know whole-step centres only: theirs are rounded, and arcs that one of them cannot make at all are
left out and counted.

Examples:
  husillo compare circle --radius 30
  husillo compare circle --radius 1000 --only dda,direct-search -o circle.html
  husillo compare line --to 1000,500 --format json
  husillo compare examples/gear.nc -m micromill --weights 5,1,3,1";

/// Which machine and which language.
#[derive(Debug, Args)]
pub struct Target {
    /// Machine: micromill, free, router, lathe, drill, or a TOML file
    #[arg(short, long, value_name = "NAME|FILE")]
    pub machine: Option<String>,
    /// Language of the program: rs274, grbl, micromill, lathe, lathe-a, iso, drill, printer [default: that of the machine, or rs274;
    /// micromill for files ending in .mm]
    #[arg(long, value_name = "NAME")]
    pub dialect: Option<String>,
}

/// `husillo run`.
#[derive(Debug, Args)]
pub struct Run {
    /// Program; - is standard input
    pub file: String,
    /// Machine and language.
    #[command(flatten)]
    pub target: Target,
    /// Report to write [default: out/NAME.html; none with --format json]
    #[arg(short, long, value_name = "REPORT.html")]
    pub output: Option<String>,
    /// How to print the results
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// Write the simulated tool after every step as CSV
    #[arg(long, value_name = "FILE.csv")]
    pub trace: Option<String>,
    /// Leave the lash of the machine uncompensated
    #[arg(long)]
    pub no_compensation: bool,
    /// Simulate the screws with the play of the table simulated_lash, which is another at every place
    #[arg(long)]
    pub worn: bool,
    /// In which order closed contours are cut
    #[arg(long, value_enum, default_value = "file")]
    pub order: CuttingOrder,
    /// Compare the left side of the work with the mirror image of its right side, about this machine position of X in mm
    #[arg(long, value_name = "X")]
    pub symmetry: Option<f64>,
    /// Push a motor by STEPS before a step event, as an overload does; may be repeated
    #[arg(long, value_name = "AXIS:EVENT:STEPS")]
    pub lose: Vec<crate::encoder_file::Push>,
}

/// In which order closed contours are cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CuttingOrder {
    /// As they are written
    File,
    /// As two halves from the same start point, so that both sides are cut on the same flank of the screw across
    Mirrored,
}

/// `husillo check`.
#[derive(Debug, Args)]
pub struct Check {
    /// Programs; - is standard input
    #[arg(required = true)]
    pub files: Vec<String>,
    /// Machine and language.
    #[command(flatten)]
    pub target: Target,
    /// How to print findings
    #[arg(long, value_enum, default_value = "text")]
    pub format: Format,
    /// Print no more than this many findings of a file
    #[arg(long, value_name = "N", default_value_t = 50)]
    pub limit: u64,
    /// Treat warnings as errors
    #[arg(long)]
    pub deny_warnings: bool,
}

/// `husillo format`.
#[derive(Debug, Args)]
pub struct FormatArgs {
    /// Program; - is standard input; several with --check
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<String>,
    /// File to write, which may be the program itself [default: standard output]
    #[arg(short, long, value_name = "FILE", conflicts_with = "check")]
    pub output: Option<String>,
    /// Write nothing; print the programs that are not in this form, and exit with 1 if there are any
    #[arg(long)]
    pub check: bool,
    /// End lines with CR LF instead of LF
    #[arg(long)]
    pub crlf: bool,
    /// Language of the programs [default: rs274; micromill for files ending in .mm]
    #[arg(long, value_name = "NAME")]
    pub dialect: Option<String>,
}

/// `husillo machines`.
#[derive(Debug, Args)]
pub struct Machines {
    #[command(subcommand)]
    pub action: Option<MachinesAction>,
}

/// What to do with machines.
#[derive(Debug, Subcommand)]
pub enum MachinesAction {
    /// Show what is known of one
    Show {
        /// A machine that is built in, or the path of a machine file
        machine: String,
        /// How to print it
        #[arg(long, value_enum, default_value = "text")]
        format: Output,
    },
}

/// `husillo commands`.
#[derive(Debug, Args)]
pub struct Commands {
    /// Program; - is standard input
    pub file: String,
    /// Machine and language.
    #[command(flatten)]
    pub target: Target,
    /// How to print the commands; gcode is for records of the drill
    #[arg(long, value_enum, default_value = "text")]
    pub format: Listing,
}

/// `husillo steps`.
#[derive(Debug, Args)]
pub struct Steps {
    /// Program; - is standard input
    pub file: String,
    /// Machine and language.
    #[command(flatten)]
    pub target: Target,
    /// CSV file to write; - is standard output
    #[arg(short, long, value_name = "FILE.csv")]
    pub output: String,
    /// Leave the lash of the machine uncompensated
    #[arg(long)]
    pub no_compensation: bool,
}

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
    #[command(flatten)]
    #[allow(missing_docs)]
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
#[derive(Debug, Args)]
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
    /// Order of the holes: as in the file, or tool by tool on a short path (nearest neighbour and 2-opt)
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
        allow_negative_numbers = true
    )]
    pub turn: f64,
    /// Place of a hole in the file, and where it was measured; two or more turn and move the board onto them (least squares)
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
    /// Program in the drill's language, or drill file (Excellon, TANGO)
    pub file: String,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub target: Target,
    /// File to write; of a drill file with several tools NAME.T1.cod and so on, and of each drill file a manifest NAME.toml
    #[arg(short, long, value_name = "NAME.cod")]
    pub output: Option<String>,
    /// Page with a picture of the board: holes, order and travel
    #[arg(long, value_name = "REPORT.html")]
    pub report: Option<String>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub drilling: Drilling,
}

/// `husillo send`.
#[derive(Debug, Args)]
pub struct Send {
    /// Program, drill file, records (NAME.cod) or a manifest of them (NAME.toml)
    pub file: String,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub target: Target,
    /// Port: sim, a serial device, or tcp:HOST:PORT
    #[arg(short, long, value_name = "PORT", default_value = "sim")]
    pub port: String,
    /// Bits a second of the link [default: 2400, of the micro mill 9600]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(300..=115_200))]
    pub baud: Option<u32>,
    /// First hole to be drilled, counted through all tools
    #[arg(long, value_name = "HOLE", default_value_t = 1, hide_default_value = true, value_parser = clap::value_parser!(u32).range(1..))]
    pub from: u32,
    /// End when the start is confirmed, and let the drill go on by itself: one tool, up to 8192 bytes
    #[arg(long)]
    pub detach: bool,
    /// Do not ask for tools
    #[arg(short, long)]
    pub yes: bool,
    /// Micro mill: lines go ahead of the motion, without a stop between them
    #[arg(long)]
    pub stream: bool,
    /// Micro mill: one step in so many is told; 0 for none
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(0..=999))]
    pub every: u16,
    /// Micro mill: it is homed, and stands at machine zero
    #[arg(long)]
    pub no_home: bool,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub drilling: Drilling,
}

/// What is said of a program for the drill.
#[derive(Debug, Args)]
pub struct Drilling {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub layout: Layout,
    /// Depths from Z words and G81 to G83, for a drill with its flaws mended: the program is RS-274 then
    #[arg(long)]
    pub fixed: bool,
    /// Depth of all holes of a drill file below the upper sensor, for a drill with its flaws mended [default: to the lower sensor]
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
    /// Square of the radius, in units of 2^(-2F) steps^2: a circle of this radius instead of a spiral
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

/// `husillo compare`.
#[derive(Debug, Args)]
pub struct Compare {
    /// circle, arc, line, or a program
    #[arg(value_name = "circle|arc|line|FILE")]
    pub job: String,
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
    #[arg(long, value_name = "E,I,S,W", default_value = crate::decision::DEFAULT_WEIGHTS, allow_hyphen_values = true)]
    pub weights: String,
    /// How to print the results [default: by the name of the output, or text]
    #[arg(long, value_enum)]
    pub format: Option<Page>,
    /// File to write instead of standard output
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<String>,
}

/// The arguments, with directions of `measure` such as `-z` and `-1,0,0` written so that they are no options: `z-` and `(-1,0,0)`.
pub fn words(args: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut args: Vec<_> = args.collect();
    if args.get(1).is_some_and(|command| command == "measure") {
        for word in &mut args[2..] {
            let Some(rest) = word.to_str().and_then(|word| word.strip_prefix('-')) else {
                continue;
            };
            if matches!(rest, "x" | "y" | "z" | "X" | "Y" | "Z") {
                *word = format!("{rest}-").into();
            } else if rest.contains(',')
                && rest.starts_with(|c: char| c.is_ascii_digit() || c == '.')
            {
                *word = format!("(-{rest})").into();
            }
        }
    }
    args
}

/// `husillo measure`.
#[derive(Debug, Args)]
pub struct Measure {
    /// goto POSITION, zero, home, jog, touch DIRECTION, calibrate DIRECTION, status; several are done in turn. Or run FILE, record FILE
    #[arg(required = true, value_name = "ACTION", allow_negative_numbers = true)]
    pub actions: Vec<String>,
    /// Machine: cmm, cmm3, or a TOML file [default: cmm]
    #[arg(short, long, value_name = "NAME|FILE")]
    pub machine: Option<String>,
    /// Serial device, tcp:HOST:PORT, or sim: simulated modules in simulated time
    #[arg(short, long, value_name = "PORT", default_value = "sim")]
    pub port: String,
    /// Axis that is meant where an action names none
    #[arg(long, value_name = "X|Y|Z", default_value_t = 'x')]
    pub axis: char,
    /// Pre-travel to subtract, instead of the machine's
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    pub pretravel: Option<String>,
    /// Radius of the probe's ball, instead of the machine's
    #[arg(long, value_name = "LENGTH")]
    pub ball: Option<String>,
    /// Where the face is that `calibrate` touches
    #[arg(long, value_name = "POSITION", allow_negative_numbers = true)]
    pub reference: Option<String>,
    /// Slow touches to average
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..))]
    pub repeat: u8,
    /// Work piece of --port sim: the probe closes from COUNT on, or up to ..COUNT; may be repeated
    #[arg(long, value_name = "MODULE:COUNT")]
    pub contact: Vec<crate::cmm::Contact>,
    /// Work piece of --port sim: solids and a probe, as in examples/piece.toml
    #[arg(long, value_name = "FILE.toml")]
    pub piece: Option<String>,
    /// Share of wrong bits on the simulated line, such as 1e-5
    #[arg(long, value_name = "RATE", default_value_t = 0.0, value_parser = share)]
    pub noise: f64,
    /// How to print the results
    #[arg(long, value_enum, default_value = "text")]
    pub format: Results,
    /// File to write the results to: CSV, and of a routine by its name .html or .json
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<String>,
    /// Show the bytes sent (>) and received (<) on standard error
    #[arg(long)]
    pub raw: bool,
}

/// `husillo emulate`.
#[derive(Debug, Args)]
pub struct Emulate {
    /// Machine: microfactory, drill, cmm, cmm3, or a TOML file of a measuring machine
    pub machine: String,
    /// Figure of a microfactory: a G-code program of straight moves in X and Z
    #[arg(long, value_name = "FILE")]
    pub figure: Option<String>,
    /// As the original did: a microfactory that does not answer and has no dead-man's time, a drill with the flaws of its link
    #[arg(long)]
    pub faithful: bool,
    /// Bits a second of the link of a drill
    #[arg(long, value_name = "N", default_value_t = 2400, value_parser = clap::value_parser!(u32).range(300..=115_200))]
    pub baud: u32,
    /// Modules from the far end, with their versions [default: servo:4 for each of the machine]
    #[arg(long, value_name = "servo:V,..")]
    pub modules: Option<String>,
    /// Name for clients to open: a symbolic link, removed at the end
    #[arg(long, value_name = "PATH")]
    pub link: String,
    /// Work piece: the probe, at limit 1 of all modules, closes from COUNT on, or up to ..COUNT; may be repeated
    #[arg(long, value_name = "MODULE:COUNT")]
    pub contact: Vec<crate::cmm::Contact>,
    /// Work piece: solids and a probe, as in examples/piece.toml
    #[arg(long, value_name = "FILE.toml")]
    pub piece: Option<String>,
    /// Share of wrong bits on the simulated line, such as 1e-5
    #[arg(long, value_name = "RATE", default_value_t = 0.0, value_parser = share)]
    pub noise: f64,
    /// End after this time instead of at Ctrl-C
    #[arg(long = "for", value_name = "SECONDS", value_parser = positive)]
    pub seconds: Option<f64>,
    /// Multiple of real time, that of the wire too
    #[arg(long, value_name = "N", default_value = "1", value_parser = positive)]
    pub speed: f64,
}

/// `husillo tune`.
#[derive(Debug, Args)]
pub struct Tune {
    /// Machine: cmm, cmm3, or a TOML file [default: cmm]
    #[arg(short, long, value_name = "NAME|FILE")]
    pub machine: Option<String>,
    /// Axis to tune
    #[arg(long, value_name = "X|Y|Z", default_value_t = 'x')]
    pub axis: char,
    /// Serial device, tcp:HOST:PORT, line: simulated modules on a simulated line, or sim: the simulated axis itself, read in every servo period
    #[arg(short, long, value_name = "PORT", default_value = "sim")]
    pub port: String,
    /// What to do
    #[arg(long, value_enum)]
    pub method: TuneMethod,
    /// Proportional gain of a step, instead of the machine's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(..=0x7fff))]
    pub p: Option<u16>,
    /// Integral gain of a step
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(..=0x7fff))]
    pub i: Option<u16>,
    /// Derivative gain of a step
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(..=0x7fff))]
    pub d: Option<u16>,
    /// Bound of the sum of errors of a step
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(..=0x7fff))]
    pub integral_limit: Option<u16>,
    /// Dead-band compensation, PWM, instead of the machine's
    #[arg(long, value_name = "PWM")]
    pub dead_band: Option<u8>,
    /// Position error that ends it, counts, instead of the machine's
    #[arg(long, value_name = "COUNTS", value_parser = clap::value_parser!(u16).range(1..=0x3fff))]
    pub error_limit: Option<u16>,
    /// Current that ends it, as the module reads it, odd; instead of the machine's
    #[arg(long, value_name = "N")]
    pub current: Option<u8>,
    /// Steps of step and stepwise
    #[arg(long, value_name = "COUNTS", default_value_t = 100, value_parser = clap::value_parser!(i32).range(1..=0x3fff))]
    pub size: i32,
    /// Output of the relay
    #[arg(long, value_name = "PWM", default_value_t = 200, value_parser = clap::value_parser!(u8).range(1..))]
    pub amplitude: u8,
    /// Error that the relay needs to turn over, counts on both sides
    #[arg(long, value_name = "COUNTS", default_value_t = 0, value_parser = clap::value_parser!(u16).range(..=1000))]
    pub hysteresis: u16,
    /// Rule that makes gains of Ku and Tu
    #[arg(long, value_enum, default_value = "tyreus-luyben")]
    pub rule: TuneRule,
    /// Moves that check the gains, 1 to 1000 counts long [default: 20, none for step]
    #[arg(long, value_name = "N")]
    pub moves: Option<u32>,
    /// How to print the results
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// Page to write, with pictures
    #[arg(short, long, value_name = "REPORT.html")]
    pub output: Option<String>,
    /// Show the bytes sent (>) and received (<) on standard error
    #[arg(long)]
    pub raw: bool,
}

/// Ways to find gains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TuneMethod {
    /// A step response.
    Step,
    /// The ultimate gain.
    Ultimate,
    /// A relay.
    Relay,
    /// One gain after the other.
    Stepwise,
}

impl TuneMethod {
    /// As the command line has it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Step => "step",
            Self::Ultimate => "ultimate",
            Self::Relay => "relay",
            Self::Stepwise => "stepwise",
        }
    }
}

/// Rules for gains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TuneRule {
    /// Fast, with much overshoot.
    ZieglerNichols,
    /// Gentler.
    TyreusLuyben,
}

/// A number from 0 to below 1.
fn share(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let number = number.filter(|number| (0.0..1.0).contains(number));
    number.ok_or_else(|| "expected a number from 0 to below 1".into())
}

/// A number above 0 and below a billion.
fn positive(text: &str) -> Result<f64, String> {
    let number = text
        .parse()
        .ok()
        .filter(|number| *number > 0.0 && *number < 1e9);
    number.ok_or_else(|| "expected a number above 0".into())
}

/// Text for people, JSON for programs, or a page with pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Page {
    /// For people.
    Text,
    /// For programs.
    Json,
    /// For people, with pictures.
    Html,
}

/// Text for people, JSON for programs, or a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Results {
    /// For people.
    Text,
    /// For programs.
    Json,
    /// For spreadsheets.
    Csv,
}

/// Text for people, JSON for programs, or a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Listing {
    /// For people.
    Text,
    /// For programs.
    Json,
    /// A program that compiles to the same.
    Gcode,
}

/// Text for people or JSON for programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Output {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// Turning direction of an arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Turning {
    /// Clockwise.
    Cw,
    /// Counter-clockwise.
    Ccw,
}
