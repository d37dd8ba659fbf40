//! The command line: commands, options and their help texts.

mod calibrate;
mod cell;
mod compare;
mod drilling;
mod emulate;
mod exit_status;
mod interpolate;
mod jog;
mod measure;
mod reproduce;
mod serve;
mod stop;
mod tune;

pub use calibrate::{AxisArgs, BacklashArgs, Calibrate, CirclesArgs, SquarenessArgs, What};
pub use cell::Cell;
use clap::{Args, Parser, Subcommand, ValueEnum};
use compare::COMPARE_HELP;
pub use compare::Compare;
pub use drilling::{
    Compile, DrillOrder, DrillOutput, DrillProfile, DrillUnits, DrillZeros, Drilling, Holes,
    Layout, Send,
};
pub use emulate::Emulate;
pub use exit_status::command;
use husillo_simulator::diagnostics::Format;
pub use husillo_simulator::job::Zero;
pub use interpolate::{ArcShape, Interpolate, LineShape, Shape};
pub use jog::Jog;
pub use measure::{Measure, words};
use reproduce::REPRODUCE_HELP;
pub use reproduce::{Original, Reproduce};
pub use serve::Serve;
pub use stop::Stop;
use tune::TUNE_HELP;
pub use tune::{Tune, TuneMethod, TuneRule};

/// Check, simulate and draw programs for small machines
#[derive(Debug, Parser)]
#[command(
    name = "husillo",
    version,
    after_help = "Start here:\n  \
        husillo run examples/circles.nc     simulate a part and look at the report\n  \
        husillo check part.nc               find all errors without running it\n\n\
        Exit status: 0 ok, 1 the program has errors, 2 bad command line or file,\n\
        3 error in measuring, 4 collision of the probe, 5 end switch, 130 stopped by Ctrl-C"
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
    /// Write programs in one form, with nothing lost: capitals, one space between words, plain
    /// numbers
    #[command(after_help = "Examples:\n  \
        husillo format part.nc\n  \
        husillo format part.nc -o part.nc\n  \
        husillo format --check *.nc")]
    Format(FormatArgs),
    /// Print the commands of a program
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
    /// Translate a program or a drill file for a controller without an interpreter: records of the
    /// circuit-board drill, strings of the micro mill, figures of a microfactory
    #[command(after_help = "Examples:\n  \
        husillo compile board.drl -m drill -o board.cod\n  \
        husillo compile board.drl -m drill --order shortest --shift corner --report board.html\n  \
        husillo compile holes.nc -m drill -o holes.cod\n  \
        husillo compile part.nc -m micromill -o part.mm\n  \
        husillo compile figure.nc -m microfactory -o figure.fig\n  \
        husillo commands board.cod --format gcode")]
    Compile(Compile),
    /// Send a program to a drill, a micro mill, microfactories or a Grbl controller, and report its
    /// progress
    #[command(after_help = "Examples:\n  \
        husillo send board.drl -m drill --shift corner --port /dev/ttyUSB0\n  \
        husillo send board.toml -m drill --port tcp:192.168.1.5:4001\n  \
        husillo send board.cod -m drill --port /dev/ttyUSB0 --detach\n  \
        husillo send board.drl -m drill --from 37\n\n\
        It pauses between tools with the spindle off, and asks for the diameter of the next tool.\n\
        Ctrl-C stops after the present hole. After a fault it reports the next hole: --from\n\
        continues there.\n\n  \
        husillo send part.nc -m micromill --port /dev/ttyUSB0\n  \
        husillo send examples/circles.nc -m micromill --port tcp:127.0.0.1:7000\n\n\
        The micro mill homes first. The steps that its controller reports are compared with those\n\
        of the simulator. If they differ, the exit status is 1.\n\n  \
        husillo send examples/microfactory/square.nc -m microfactory --port /dev/ttyUSB0\n  \
        husillo send square.nc triangle.fig -m microfactory \\\n    \
        --port /dev/ttyUSB0 --port /dev/ttyUSB1\n\n\
        A microfactory homes, stores the figure and cuts it. Several work at once, with one \
        report\n\
        about all of them at the end.")]
    Send(Send),
    /// Make one move on the bare integer grid
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
    /// Explain a finding or a code
    #[command(after_help = "Examples:\n  \
        husillo explain E0302\n  \
        husillo explain G83 M19")]
    Explain(Explain),
    /// Print the JSON schema of what a command prints
    #[command(after_help = "Examples:\n  \
        husillo schema              the names of all schemas\n  \
        husillo schema run          of `husillo run --format json`")]
    Schema {
        /// Name of the schema, as in husillo.NAME/1
        name: Option<String>,
    },
    /// Print the completions of a shell
    #[command(after_help = "Example:\n  \
        husillo completions bash > ~/.local/share/bash-completion/completions/husillo")]
    Completions {
        /// Shell
        #[arg(value_enum)]
        shell: clap_complete::Shell,
    },
    /// Write manual pages
    Man {
        /// Folder to write to
        folder: String,
    },
    /// List the machines, or show one: resolution, rates, motor current, chopper and filter
    #[command(after_help = "Examples:\n  \
        husillo machines\n  \
        husillo machines show micromill")]
    Machines(Machines),
    /// List the examples in this program, show one, or write all of them to a folder
    #[command(after_help = "Examples:\n  \
        husillo examples\n  \
        husillo examples show gear.nc > gear.nc\n  \
        husillo examples write examples")]
    Examples {
        /// What to do with them
        #[command(subcommand)]
        action: Option<ExamplesAction>,
    },
    /// Move a microfactory, a micro mill, a drill or a Grbl machine by hand: home, counted steps,
    /// jogs
    #[command(after_help = "Actions of a microfactory, done in turn:\n  \
        home         X, Y and Z to their switches and 200 steps back\n  \
        x -25        steps of a motor: x, y, z, or c for the spindle\n  \
        y+ 1.5s      turn a motor for a time\n  \
        load FILE    store another figure: straight moves of a program in X and Z, or a list\n  \
        \x20            of them (NAME.fig)\n  \
        figure       feed Y until the tool touches, then cut the stored figure\n  \
        where        report the positions of the axes\n  \
        stop, emergency\n  \
        2: ACTION..  for the second --port alone; all: for all again\n\n\
        The micro mill (-m micromill) has home, where, steps, and\n  \
        x+y- 2s      jog one axis or several; without a host every motion ends in 250 ms\n  \
        faster 1s    continue the jog, 10 steps per second faster; slower 1s\n  \
        run x -250 2s  an axis at this many steps per second\n  \
        backlash x 204, zero\n\n\
        The drill (-m drill) has home, steps, jogs, stop, and\n  \
        spindle on, spindle off, teach, save FILE.cod, run, clear, test, help\n\n\
        Examples:\n  \
        husillo jog home x 400 figure\n  \
        husillo jog --port /dev/ttyUSB0 home y+ 1s\n  \
        husillo jog --port /dev/ttyUSB0 --port /dev/ttyUSB1 home 1: x 400 2: z -60 all: figure")]
    Jog(Jog),
    /// Operate Grbl machines from a browser: position, jog, programs
    #[command(after_help = "Examples:\n  \
        husillo serve                                a simulated machine\n  \
        husillo serve --port /dev/ttyUSB0\n  \
        husillo serve --port /dev/ttyUSB0 --port tcp:192.168.1.5:23 --port sim\n  \
        husillo serve --listen 0.0.0.0:8017 --host mill.lan   other computers too\n\n\
        It prints the address of the page with a token, which whoever may operate the machines\n\
        needs. Ctrl-C stops the machines and ends.")]
    Serve(Serve),
    /// Stop a machine, even if another program drives it
    #[command(after_help = "Examples:\n  \
        husillo stop                                     every machine that a husillo drives\n  \
        husillo stop -m micromill --port /dev/ttyUSB0\n  \
        husillo stop -m microfactory --emergency\n\n\
        The husillo that drives the machine stops it as at Ctrl-C and ends. Then this one opens\n\
        the port, sends the stop itself and waits for the answer.")]
    Stop(Stop),
    /// Measure with a contact probe and correct for pre-travel
    #[command(after_help = "Actions, done in turn:\n  \
        goto POSITION         straight to X10 Y-2.5 Z0; in mm if the machine file has a \
        `count`,\n  \
        \x20                     otherwise in counts; with `guarded` so slowly that the axes \
        stop\n  \
        \x20                     gently at a contact\n  \
        zero [x y z]          make the present position of these axes 0\n  \
        home [x|y|z]          search the index of the encoder and make it 0\n  \
        jog DIRECTION TIME    run for a time such as 2s, at the speed of moves; with `slow` at \
        that\n  \
        \x20                     of a search\n  \
        touch DIRECTION       search the work piece, touch it slowly, correct for pre-travel\n  \
        calibrate DIRECTION   touch a face that is at --reference: its pre-travel\n  \
        calibrate sphere|ring X.. Y.. Z.. R..\n  \
        \x20                     touch a body of this radius with about this centre: pre-travel \
        by\n  \
        \x20                     direction\n  \
        run FILE              a measuring routine, or a G-code program (.nc, .ngc, ...); exit \
        status\n  \
        \x20                     1: out of tolerance (routines only), 3: failed\n  \
        status [x y z]        of these axes or all: position, position error (held less \
        actual),\n  \
        \x20                     current, status and auxiliary bits, version\n  \
        record FILE           carry out statements of the standard input, write them as a \
        routine\n  \
        session               actions from the standard input, line by line, until `end`; a line \
        that\n  \
        \x20                     fails is reported (exit status 3)\n\n\
        `run`, `record` and `session` are the last action: `home x home y run part.routine`.\n\
        A DIRECTION is +x, -z, a vector such as 1,0,-1, or + or - of --axis. A POSITION without a\n\
        letter is one of --axis. Positions count from home or zero, also of the command before;\n\
        with --reset, and after a power-up, from where the axes stand.\n\
        Ctrl-C stops all axes smoothly: exit status 130.\n\n\
        Examples:\n  \
        husillo measure -m cmm goto 1200 touch + --contact 1:3018 --pretravel 18\n  \
        husillo measure -m cmm3 goto X1 Y2 Z-3 touch -z touch 1,1,0 \\\n    \
        --contact 1:2000 --contact 3:..-2000\n  \
        husillo measure -m cmm3 --piece examples/piece.toml goto X20 Y20 Z-15 touch -z\n  \
        husillo measure -m cmm3 --piece examples/piece.toml --ball 1 --pretravel \"8 um\" \\\n    \
        run examples/piece.routine -o piece.html\n  \
        husillo measure -m cmm --port /dev/ttyUSB0 touch - --repeat 5 -o touches.csv\n  \
        husillo measure -m cmm calibrate + --reference 3000 --contact 1:3018")]
    Measure(Measure),
    /// Simulate a machine behind a pseudo-terminal or a socket, for any client of its protocol
    #[command(after_help = "Examples:\n  \
        husillo emulate grbl --link ./grbl\n  \
        husillo emulate cmm --link ./cmm\n  \
        husillo emulate cmm --modules servo:4,servo:4 --link ./cmm \\\n    \
        --contact 1:3000 --contact 1:..-3000\n  \
        husillo emulate cmm3 --link ./cmm --piece examples/piece.toml")]
    Emulate(Emulate),
    /// Find the gains of a servo
    #[command(after_help = TUNE_HELP)]
    Tune(Tune),
    /// Find the errors of a machine from measurements, as lines for its file
    Calibrate(Calibrate),
    /// Rebuild the measured tables of the original machines on the simulated ones
    #[command(after_help = REPRODUCE_HELP)]
    Reproduce(Reproduce),
}

/// Machine and language of a program.
#[derive(Clone, Debug, Args)]
pub struct Target {
    /// Machine: a name that `husillo machines` lists, or a TOML file
    #[arg(short, long, value_name = "NAME|FILE")]
    pub machine: Option<String>,
    /// Language of the program: rs274, grbl, micromill, lathe, lathe-a, iso, drill, printer
    /// [default: that of the machine, or rs274; micromill for files ending in .mm]
    #[arg(long, value_name = "NAME")]
    pub dialect: Option<String>,
    /// Folder with files of subroutines, in addition to that of the program. A call of the O-word
    /// NAME reads NAME.ngc, and M98 P100 reads 100.ngc; may be repeated
    #[arg(long, value_name = "DIR")]
    pub include: Vec<String>,
}

/// Position of a program on the machine.
#[derive(Debug, Args)]
pub struct Place {
    /// Position of work zero on the machine. The tool begins there. Axes with mm, as X20Y15Z-3; or
    /// centre or corner: of the table; or fit: puts the part in the middle of the table. These
    /// three words also put the highest Z of the part at the upper end of Z [default: machine zero;
    /// fit if the program does not fit there]
    #[arg(long, value_name = "X..Y..Z..|centre|corner|fit")]
    pub zero: Option<Zero>,
}

/// `husillo run`.
#[derive(Debug, Args)]
pub struct Run {
    /// Program; - is standard input
    pub file: String,
    /// Machine and language.
    #[command(flatten)]
    pub target: Target,
    /// Position on the machine.
    #[command(flatten)]
    pub place: Place,
    /// Report to write [default: out/NAME.html; none with --format json]
    #[arg(short, long, value_name = "REPORT.html")]
    pub output: Option<String>,
    /// How to print the results
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// Write the position of the simulated tool after every step as CSV
    #[arg(long, value_name = "FILE.csv")]
    pub trace: Option<String>,
    /// Leave the backlash of the machine uncompensated
    #[arg(long)]
    pub no_compensation: bool,
    /// Simulate the screws with the backlash of the table simulated_backlash, which varies with the
    /// position
    #[arg(long)]
    pub worn: bool,
    /// Order of cutting closed contours
    #[arg(long, value_enum, default_value = "file")]
    pub order: CuttingOrder,
    /// Compare the left side of the work with the mirror image of its right side, about this
    /// machine position of X in mm
    #[arg(long, value_name = "X")]
    pub symmetry: Option<f64>,
    /// Push a motor by STEPS before a step event, as an overload does; may be repeated
    #[arg(long, value_name = "AXIS:EVENT:STEPS")]
    pub lose: Vec<husillo_simulator::machines::encoder_file::Push>,
    /// Print no more than this many findings
    #[arg(long, value_name = "N", default_value_t = 50)]
    pub limit: u64,
}

/// Order of cutting closed contours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CuttingOrder {
    /// As in the file
    File,
    /// As two halves from the same start point, so that both sides are cut on the same flank of the
    /// other axis' screw
    Mirrored,
}

/// The form in which `check` prints its findings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum CheckFormat {
    /// Drawn under the line of the program.
    Text,
    /// `file:line:column: error[E0301]: message`, for editors and screen readers.
    Short,
    /// One JSON object for each program, with its findings.
    Json,
}

impl CheckFormat {
    /// The form of each finding; `None`: it is in the object of its program.
    pub const fn of_finding(self) -> Option<Format> {
        match self {
            Self::Text => Some(Format::Text),
            Self::Short => Some(Format::Short),
            Self::Json => None,
        }
    }
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
    /// Position on the machine.
    #[command(flatten)]
    pub place: Place,
    /// How to print findings
    #[arg(long, value_enum, default_value = "text")]
    pub format: CheckFormat,
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
    /// How to print what was found and written
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// Write nothing; print the programs that are not in this form, and exit with 1 if there are
    /// any
    #[arg(long)]
    pub check: bool,
    /// End lines with CR LF instead of LF
    #[arg(long)]
    pub crlf: bool,
    /// Language of the programs [default: rs274; micromill for files ending in .mm]
    #[arg(long, value_name = "NAME")]
    pub dialect: Option<String>,
    /// Translate the program into this language: lines that it lacks, or reads otherwise, become
    /// the moves that they make
    #[arg(long, value_enum, value_name = "NAME", conflicts_with = "check")]
    pub to: Option<TargetDialect>,
    /// With --to: machine whose axes the program has [default: the axes X, Y, Z, A, B and C]
    #[arg(short, long, value_name = "NAME|FILE", requires = "to")]
    pub machine: Option<String>,
    /// With --to: folder with files of subroutines, in addition to that of the program; may be
    /// repeated
    #[arg(long, value_name = "DIR", requires = "to")]
    pub include: Vec<String>,
}

/// The languages of `husillo format --to`.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum TargetDialect {
    /// Grbl 1.1
    Grbl,
    /// LinuxCNC
    Linuxcnc,
    /// ISO 6983 controls
    Iso,
}

/// `husillo explain`.
#[derive(Debug, Args)]
pub struct Explain {
    /// Findings as E0302, codes as G83
    #[arg(required = true, value_name = "NAME")]
    pub names: Vec<String>,
    /// How to print the explanation
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
}

/// `husillo machines`.
#[derive(Debug, Args)]
pub struct Machines {
    /// How to print the list
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    #[command(subcommand)]
    pub action: Option<MachinesAction>,
}

/// What to do with machines.
#[derive(Debug, Subcommand)]
pub enum MachinesAction {
    /// Show the properties of a machine
    Show {
        /// A built-in machine, or the path of a machine file
        machine: String,
        /// How to print it
        #[arg(long, value_enum, default_value = "text")]
        format: Output,
    },
    /// Make the file of a new machine: asks for its figures, checks them, and writes it
    #[command(after_help = "Examples:\n  \
        husillo machines new mine\n  \
        husillo machines new mine --steps X80Y80Z400 --max-rate X6000Y6000Z720 \\\n    \
            --acceleration X500Y500Z200 --travel X0..300Y0..180Z-45..5 </dev/null")]
    New(NewMachine),
    /// Write the file of a built-in machine, to change it for your own machine
    Write {
        /// A built-in machine
        machine: String,
        /// File to write; - is standard output [default: NAME.toml]
        file: Option<String>,
        /// How to print what was written
        #[arg(long, value_enum, default_value = "text")]
        format: Output,
    },
}

/// What to do with examples.
#[derive(Debug, Subcommand)]
pub enum ExamplesAction {
    /// Print an example
    Show {
        /// Its name, as the list has it
        name: String,
    },
    /// Write all examples; if a file exists, nothing is written
    Write {
        /// Folder to write to; it is made
        folder: String,
    },
}

/// `husillo machines new`. A figure that no option gives is asked for; at the end of the input the
/// optional ones are left out.
#[derive(Debug, Args)]
pub struct NewMachine {
    /// Name of the machine
    pub name: String,
    /// File to write; - is standard output [default: NAME.toml]
    pub file: Option<String>,
    /// How to print what was written
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// Letters of its axes: X, Y, Z, and up to three of A, B, C, U, V, W and E
    #[arg(long, default_value = "XYZ")]
    pub axes: String,
    /// Steps per mm, or per degree of A, B and C, as X80Y80Z400
    #[arg(long, value_name = "BY-AXIS")]
    pub steps: Option<String>,
    /// Highest speeds in mm/min or degrees/min
    #[arg(long, value_name = "BY-AXIS")]
    pub max_rate: Option<String>,
    /// Accelerations in mm/s^2 or degrees/s^2; an axis without one has no ramp
    #[arg(long, value_name = "BY-AXIS")]
    pub acceleration: Option<String>,
    /// Speeds at which the axes may start and stop, per minute
    #[arg(long, value_name = "BY-AXIS")]
    pub start_rate: Option<String>,
    /// Speeds above which the motors lose steps, per minute
    #[arg(long, value_name = "BY-AXIS")]
    pub pull_out: Option<String>,
    /// Lowest and highest positions, as X0..300Z-45..5; an axis without one has no limits
    #[arg(long, value_name = "BY-AXIS")]
    pub travel: Option<String>,
}

/// `husillo commands`.
#[derive(Debug, Args)]
pub struct Commands {
    /// Program; - is standard input
    pub file: String,
    /// Machine and language.
    #[command(flatten)]
    pub target: Target,
    /// Position on the machine.
    #[command(flatten)]
    pub place: Place,
    /// How to print the commands; gcode is for records of the drill
    #[arg(long, value_enum, default_value = "text")]
    pub format: Listing,
    /// Print no more than this many findings
    #[arg(long, value_name = "N", default_value_t = 50)]
    pub limit: u64,
}

/// `husillo steps`.
#[derive(Debug, Args)]
pub struct Steps {
    /// Program; - is standard input
    pub file: String,
    /// Machine and language.
    #[command(flatten)]
    pub target: Target,
    /// Position on the machine.
    #[command(flatten)]
    pub place: Place,
    /// CSV file to write; - is standard output
    #[arg(short, long, value_name = "FILE.csv")]
    pub output: String,
    /// How to print what was written
    #[arg(long, value_enum, default_value = "text")]
    pub format: Output,
    /// Leave the backlash of the machine uncompensated
    #[arg(long)]
    pub no_compensation: bool,
    /// Also write the inputs of the motor drivers after each event: a number per axis, whose bit 0
    /// is the first input
    #[arg(long)]
    pub levels: bool,
    /// Print no more than this many findings
    #[arg(long, value_name = "N", default_value_t = 50)]
    pub limit: u64,
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
