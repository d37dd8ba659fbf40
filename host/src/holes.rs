//! Drill files: read, checked, listed.

pub mod drill_code;
pub mod drill_file;
pub mod placement;
pub mod step_and_repeat;
pub mod visiting_order;

use crate::cli::{self, Layout};
use crate::diagnostics::{Finding, Findings, Place, Severity};
use crate::holes::placement::{Fit, Placement};
use crate::holes::step_and_repeat::{Panel, Refused};
use crate::holes::visiting_order::Metric;
use crate::machines::machine_file::{MachineFile, Travel};
use crate::machines::quantity::{self, Quantity};
use crate::programs::source::BYTE_ORDER_MARK;
use husillo_excellon::{
    Digits, Doubt, Error, ErrorKind, Feature, Hole, Inference, Overrides, Path, Profile, Reader,
    Reason, Settings, Slot, Tool, Units, Warning, WarningKind, Zeros, lines,
};
use husillo_gcode::Nm;
use std::io::{self, Write};

/// Tools that one file may have.
const MOST_TOOLS: usize = 1000;
/// Holes and slots that one file may have: repeats can make many of a short text.
const MOST_FEATURES: usize = 2_000_000;

/// Names of files that hold drill programs.
const ENDS: [&str; 6] = [".drl", ".xln", ".exc", ".drd", ".ncd", ".drill"];

/// Whether a file is a drill file, by what was asked for or by its name.
pub fn is_drill_file(dialect: Option<&str>, file: &str) -> bool {
    let lower = file.to_ascii_lowercase();
    match dialect {
        Some(dialect) => dialect == "excellon",
        None => ENDS.iter().any(|end| lower.ends_with(end)),
    }
}

/// A drill file, read.
#[derive(Debug)]
pub struct Board {
    /// How its coordinates are read, and why.
    pub settings: Settings,
    /// Its tools in the order of the file.
    pub tools: Vec<Tool>,
    /// Its holes.
    pub holes: Vec<Hole>,
    /// Its slots.
    pub slots: Vec<Slot>,
}

/// What the command line says about the file.
#[derive(Debug, Default)]
pub struct Options {
    overrides: Overrides,
    tools: Vec<(u16, Nm)>,
    only: Vec<u16>,
    placement: Placement,
}

impl Options {
    /// Reads the options.
    ///
    /// # Errors
    ///
    /// A sentence about the option that is wrong.
    pub fn new(args: &Layout) -> Result<Self, String> {
        let digits = args.format_digits.as_deref().map(|text| {
            digits(text).ok_or_else(|| {
                format!("--format-digits {text}: two digits with a point between, as in 2.4")
            })
        });
        Ok(Self {
            overrides: Overrides {
                units: args.units.map(|units| match units {
                    cli::DrillUnits::Inch => Units::Inches,
                    cli::DrillUnits::Mm => Units::Millimetres,
                }),
                zeros: args.zeros.map(|zeros| match zeros {
                    cli::DrillZeros::Leading => Zeros::Leading,
                    cli::DrillZeros::Trailing => Zeros::Trailing,
                }),
                digits: digits.transpose()?,
                profile: match args.profile {
                    cli::DrillProfile::Excellon => Profile::Excellon,
                    cli::DrillProfile::Tango => Profile::Tango,
                },
            },
            tools: args
                .tool
                .iter()
                .map(|text| tool(text))
                .collect::<Result<_, _>>()?,
            only: args.only.clone(),
            placement: Placement::new(args)?,
        })
    }
}

fn digits(text: &str) -> Option<Digits> {
    let (whole, places) = text.split_once(['.', ':'])?;
    Digits::new(whole.parse().ok()?, places.parse().ok()?)
}

fn tool(text: &str) -> Result<(u16, Nm), String> {
    let refused = || format!("--tool {text}: a number and a diameter, as in 1=0.8 or 1=0.031in");
    let (number, diameter) = text.split_once('=').ok_or_else(refused)?;
    let number = number.trim_start_matches(['T', 't']);
    let number = number.parse().map_err(|_| refused())?;
    match length(diameter) {
        Some(diameter) if diameter.0 > 0 => Ok((number, diameter)),
        _ => Err(refused()),
    }
}

/// A length of the command line: millimetres, unless it has a unit.
pub fn length(text: &str) -> Option<Nm> {
    let with_unit = quantity::parse(text).or_else(|_| quantity::parse(&format!("{text} mm")));
    match with_unit {
        Ok(Quantity::Length(value)) => Some(Nm(value.rounded())),
        _ => None,
    }
    .filter(|nm| nm.0.abs() <= Nm::LIMIT.0)
}

/// Reads a drill file; everything that is to be said about it goes to `findings`.
pub fn read(text: &[u8], file: &str, options: &Options, findings: &mut Findings) -> Board {
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    let mut inference = Inference::new();
    for (_, line) in lines(text) {
        inference.observe(line);
    }
    let settings = inference.settle(&options.overrides);
    let mut reader = Reader::<MOST_TOOLS>::new(&settings).with_patterns();
    for (number, diameter) in &options.tools {
        reader.set_tool(*number, diameter.0);
    }
    let (mut holes, mut slots) = (Vec::new(), Vec::new());
    let mut panel = Panel::default();
    let errors_before = findings.errors;
    let mut warned_diameters = Vec::new();
    for (number, line) in lines(text) {
        let read = reader.read(line);
        if let Some(warning) = reader.warning() {
            // Once for each tool is enough.
            let again = matches!(warning.kind, WarningKind::NoDiameter(_))
                && warned_diameters.contains(&warning.kind);
            if !again {
                warned_diameters.push(warning.kind);
                findings.add(warned(&warning, file, number, line));
            }
        }
        let features = match read {
            Ok(features) => features,
            Err(error) => {
                findings.add(refused(&error, file, number, line));
                if matches!(error.kind, ErrorKind::Gerber | ErrorKind::NotText(_)) {
                    break; // Nothing of such a file is a drill program.
                }
                continue;
            }
        };
        if holes.len() + slots.len() + features.len() > MOST_FEATURES {
            let place = Place::new(file, number, line, 0..line.len());
            let message = format!("more than {MOST_FEATURES} holes");
            findings.add(Finding::error("E0910", message, place));
            break;
        }
        for feature in features {
            match feature {
                Feature::Hole(hole) => holes.push(hole),
                Feature::Slot(slot) => slots.push(slot),
            }
        }
        let Some(pattern) = reader.pattern() else {
            continue;
        };
        if let Err(why) = panel.take(&pattern, &mut holes, &mut slots, MOST_FEATURES) {
            let place = Place::new(file, number, line, 0..line.len());
            let (code, message) = match why {
                Refused::Reach => ("E0103", "the copy is out of reach".to_owned()),
                Refused::Many => ("E0910", format!("more than {MOST_FEATURES} holes")),
            };
            findings.add(Finding::error(code, message, place));
            break;
        }
    }
    let board = Board {
        settings,
        tools: reader.tools().iter().copied().collect(),
        holes,
        slots,
    };
    if findings.errors == errors_before {
        doubts(&board, file, findings);
    }
    board
}

fn span(at: usize, end: usize) -> std::ops::Range<usize> {
    at..end.max(at + 1)
}

fn refused(error: &Error, file: &str, number: usize, line: &[u8]) -> Finding {
    let place = Place::new(file, number, line, span(error.at, error.end));
    let code = format!("E{:04}", error.kind.code());
    let finding = Finding::error(&code, error.to_string(), place);
    match error.kind {
        ErrorKind::NotALetter(_) => finding.label("a word is a letter and a number"),
        ErrorKind::NotText(_) => finding
            .label("no text from here on")
            .note("old Protel programs write binary (EIA) drill files beside the text ones"),
        ErrorKind::Gerber => finding
            .label("a command of Gerber")
            .help("take the drill file of the layout, often .drl, .xln, .exc or .txt"),
        ErrorKind::MissingNumber(_) => finding.label("a number must follow the letter"),
        ErrorKind::MalformedNumber => finding.label("the number goes wrong here"),
        ErrorKind::TooManyDigits => finding.label("at most 18 digits"),
        ErrorKind::NumberTooLarge => finding
            .label("too large")
            .help("other units or digits? See --units and --format-digits"),
        ErrorKind::UnknownCode(..) | ErrorKind::UnknownName | ErrorKind::UnknownWord(_) => {
            finding.label("not in the list of what a drill file has")
        }
        ErrorKind::RepeatedWord(_) => finding.label("given a second time"),
        ErrorKind::NoTool => finding
            .label("with which tool is not said")
            .help("choose a tool before, as in `T1`"),
        ErrorKind::NoDiameter => finding.label("must be above zero"),
        ErrorKind::StepAndRepeat => finding
            .label("a pattern is repeated by M02 between M01 and M08")
            .help(
                "see the order of step and repeat: M25, holes, M01, M02X..Y.. for each copy, M08",
            ),
        ErrorKind::PatternOrder => finding
            .label("not here")
            .help("the order is M25, the pattern, M01, M02X..Y.. for each copy, M08"),
        ErrorKind::TooManyTools => finding.label(format!("at most {MOST_TOOLS}")),
        ErrorKind::HalfSlot => finding.label("needs a point before it and one behind it"),
        ErrorKind::Origin => finding.help("let the layout program write absolute coordinates"),
        ErrorKind::NoCentre => finding.label("needs `A`, or `I` and `J`"),
        _ => finding,
    }
}

fn warned(warning: &Warning, file: &str, number: usize, line: &[u8]) -> Finding {
    let place = Place::new(file, number, line, span(warning.at, warning.end));
    let code = format!("W{:04}", warning.kind.code());
    let finding = Finding::warning(&code, warning.to_string(), place);
    match warning.kind {
        WarningKind::NoDiameter(tool) => {
            finding.help(format!("give it in millimetres: --tool {tool}=0.8"))
        }
        WarningKind::HeaderNotEnded => finding.label("a `%` or `M95` is missing before this line"),
        WarningKind::ToolUp => finding.help("write `M15` before the rout"),
        _ => finding,
    }
}

/// Warnings about the file as a whole.
fn doubts(board: &Board, file: &str, findings: &mut Findings) {
    let general = |code, message: String| Finding::general(Severity::Warning, code, message);
    let settings = &board.settings;
    let is_empty = board.holes.is_empty() && board.slots.is_empty();
    if is_empty {
        let message = format!("no hole in {file}");
        findings.add(general("W0602", message));
        return;
    }
    if matches!(settings.units.reason, Reason::Default | Reason::Numbers(_)) {
        let message = format!(
            "nothing in {file} says its unit: {} is assumed",
            settings.units.value
        );
        let finding = general("W0928", message).note(because(settings.units.reason));
        findings.add(finding.help("--units inch or --units mm says it"));
    }
    if let (Reason::Numbers(_), true) = (settings.zeros.reason, settings.point_missing) {
        let message = format!(
            "nothing in {file} says which zeros are left out: {} is assumed",
            settings.zeros.value
        );
        let finding = general("W0929", message).note(because(settings.zeros.reason));
        findings.add(finding.help("--zeros leading or --zeros trailing says which are kept"));
    }
    match settings.doubt {
        Some(Doubt::LongNumber(line, digits)) => {
            let format = settings.digits.value;
            let message = format!(
                "line {line} of {file} has a number of {digits} digits, the format {format} has {}",
                format.all()
            );
            let finding = general("W0930", message).note(because(settings.digits.reason));
            let help = "--format-digits says where the point is, as in 4.4";
            findings.add(finding.help(help));
        }
        Some(Doubt::MixedPoints(line)) => {
            let message =
                format!("some coordinates of {file} have a point, and one of line {line} has none");
            let format = settings.digits.value;
            let note = format!("without a point it is read by the digits {format}");
            findings.add(general("W0931", message).note(note));
        }
        None => {}
    }
}

/// A reason as a sentence.
fn because(reason: Reason) -> String {
    match reason {
        Reason::Given => "given on the command line".to_owned(),
        Reason::Declared(line) => format!("said in line {line}"),
        Reason::Comment(line) => format!("said by the comment in line {line}"),
        Reason::Numbers(line) => format!("the numbers look like it, first in line {line}"),
        Reason::Profile => "of the tango profile".to_owned(),
        Reason::Default => "the usual, as nothing says otherwise".to_owned(),
    }
}

impl Board {
    /// Leaves the tools that were asked for, and places the board; what a fit to measured holes
    /// found.
    ///
    /// # Errors
    ///
    /// A tool without holes and slots, or a place that is out of reach.
    pub fn apply(&mut self, options: &Options) -> Result<Option<Fit>, String> {
        let in_use = self.tools_in_use();
        if let Some(tool) = options.only.iter().find(|tool| !in_use.contains(tool)) {
            return Err(format!(
                "--only {tool}: the file makes nothing with that tool"
            ));
        }
        if !options.only.is_empty() {
            self.holes
                .retain(|hole| options.only.contains(&hole.tool.number));
            self.slots
                .retain(|slot| options.only.contains(&slot.tool.number));
            self.tools
                .retain(|tool| options.only.contains(&tool.number));
        }
        options.placement.apply(self)
    }

    /// Says what is beyond the travel of a machine whose zero is that of the file.
    pub fn check_travel(&self, file: &str, machine: &MachineFile, findings: &mut Findings) {
        let Some([low, high]) = self.extent() else {
            return;
        };
        for (axis, name) in ["X", "Y"].into_iter().enumerate() {
            let Travel::Range([from, to]) = machine.axes[axis].travel else {
                continue;
            };
            let is_off = |at_nm: &[i64; 2]| !(from..=to).contains(&at_nm[axis]);
            let holes = self.holes.iter().filter(|hole| is_off(&hole.at_nm)).count();
            let ends = |slot: &&Slot| is_off(&slot.from_nm) || is_off(&slot.to_nm);
            let slots = self.slots.iter().filter(ends).count();
            let off = match (holes, slots) {
                (0, 0) => continue,
                (_, 0) => count(holes, "hole"),
                (0, _) => count(slots, "slot"),
                _ => format!("{} and {}", count(holes, "hole"), count(slots, "slot")),
            };
            let message = format!("{off} of {file} beyond the travel of {name}");
            let note = format!(
                "{name} {} to {} mm; {} goes from {} to {} mm",
                low[axis],
                high[axis],
                machine.name,
                Nm(from),
                Nm(to)
            );
            let finding = Finding::general(Severity::Error, "E0401", message).note(note);
            let fits = high[axis].0 - low[axis].0 <= to - from;
            findings.add(finding.help(if fits {
                "it fits when it is moved: see --shift of `husillo holes`"
            } else {
                "it cannot fit by moving it"
            }));
        }
    }

    /// Puts the holes of each tool into the order of a short path, tool after tool.
    pub fn sort_shortest(&mut self, metric: Metric) {
        let mut sorted = Vec::with_capacity(self.holes.len());
        let mut at = [0; 2];
        for tool in self.tools_in_use() {
            let of_tool: Vec<_> = self
                .holes
                .iter()
                .filter(|hole| hole.tool.number == tool)
                .copied()
                .collect();
            let points: Vec<_> = of_tool.iter().map(|hole| hole.at_nm).collect();
            let path = visiting_order::shortest(&points, at, metric);
            if metric == Metric::Straight {
                at = path.last().map_or(at, |&last| points[last]);
            } // The drill goes home for another tool.
            sorted.extend(path.iter().map(|&index| of_tool[index]));
        }
        self.holes = sorted;
    }

    /// The numbers of the tools with holes or slots, in the order of their first one.
    pub fn tools_in_use(&self) -> Vec<u16> {
        let holes = self.holes.iter().map(|hole| hole.tool.number);
        let slots = self.slots.iter().map(|slot| slot.tool.number);
        let mut seen = std::collections::HashSet::new();
        holes
            .chain(slots)
            .filter(|tool| seen.insert(*tool))
            .collect()
    }

    /// The way from the origin over all holes in their order, in nm.
    pub fn travel_nm(&self, metric: Metric) -> f64 {
        visiting_order::travel(self.holes.iter().map(|hole| hole.at_nm), [0; 2], metric)
    }

    /// Least and greatest coordinates of the middles of holes and the ends of slots.
    pub fn extent(&self) -> Option<[[Nm; 2]; 2]> {
        let ends = self
            .slots
            .iter()
            .flat_map(|slot| [slot.from_nm, slot.to_nm]);
        self.holes
            .iter()
            .map(|hole| hole.at_nm)
            .chain(ends)
            .map(|at_nm| [at_nm.map(Nm); 2])
            .reduce(|[low, high], [at, _]| {
                [
                    [low[0].min(at[0]), low[1].min(at[1])],
                    [high[0].max(at[0]), high[1].max(at[1])],
                ]
            })
    }

    /// Writes the tables for people.
    ///
    /// # Errors
    ///
    /// What the writer says.
    pub fn print(&self, file: &str, out: &mut impl Write) -> io::Result<()> {
        let (holes, slots) = (self.holes.len(), self.slots.len());
        writeln!(
            out,
            "{file}: {}, {}",
            count(holes, "hole"),
            count(slots, "slot")
        )?;
        let settings = &self.settings;
        let row = |out: &mut dyn Write, name: &str, value: String, reason: Reason| {
            writeln!(out, "  {name:<8} {value:<26} {}", because(reason))
        };
        row(
            out,
            "units",
            settings.units.value.to_string(),
            settings.units.reason,
        )?;
        if settings.point_missing {
            row(
                out,
                "zeros",
                settings.zeros.value.to_string(),
                settings.zeros.reason,
            )?;
            row(
                out,
                "digits",
                settings.digits.value.to_string(),
                settings.digits.reason,
            )?;
        } else {
            writeln!(
                out,
                "  zeros and digits do not matter: all coordinates have a point"
            )?;
        }
        writeln!(out, "\n  tool   diameter mm  plated    holes    slots")?;
        for tool in &self.tools {
            let holes = self
                .holes
                .iter()
                .filter(|hole| hole.tool.number == tool.number);
            let slots = self
                .slots
                .iter()
                .filter(|slot| slot.tool.number == tool.number);
            let diameter = tool
                .diameter_nm
                .map_or("?".to_owned(), |nm| Nm(nm).to_string());
            let plated = match tool.plated {
                Some(true) => "yes",
                Some(false) => "no",
                None => "?",
            };
            let name = format!("T{}", tool.number);
            let (holes, slots) = (holes.count(), slots.count());
            writeln!(
                out,
                "  {name:<6} {diameter:>11}  {plated:<6} {holes:>8} {slots:>8}"
            )?;
        }
        if let Some([low, high]) = self.extent() {
            let size = [0, 1].map(|axis: usize| Nm(high[axis].0 - low[axis].0));
            writeln!(
                out,
                "\n  extent   X {} to {} mm, Y {} to {} mm ({} x {} mm, middles of holes and ends \
                 of slots)",
                low[0], high[0], low[1], high[1], size[0], size[1]
            )?;
            writeln!(
                out,
                "  travel   {:.1} mm from the origin over all holes",
                self.travel_nm(Metric::Straight) / 1e6
            )?;
        }
        Ok(())
    }

    /// Writes the JSON object for programs: exact millimetres.
    ///
    /// # Errors
    ///
    /// What the writer says.
    pub fn print_json(&self, errors: u64, warnings: u64, out: &mut impl Write) -> io::Result<()> {
        write!(out, "{{\"holes\": [")?;
        for (index, hole) in self.holes.iter().enumerate() {
            let [x, y] = hole.at_nm.map(Nm);
            write!(out, "{}[{x}, {y}, {}]", comma(index), diameter(&hole.tool))?;
        }
        write!(out, "], \"slots\": [")?;
        for (index, slot) in self.slots.iter().enumerate() {
            let [[x, y], [to_x, to_y]] = [slot.from_nm, slot.to_nm].map(|at_nm| at_nm.map(Nm));
            let diameter = diameter(&slot.tool);
            let separator = comma(index);
            let (clockwise, centre) = match slot.path {
                Path::Straight => {
                    write!(out, "{separator}[{x}, {y}, {to_x}, {to_y}, {diameter}]")?;
                    continue;
                }
                Path::Radius {
                    clockwise,
                    radius_nm,
                } => (clockwise, format!("\"radius\": {}", Nm(radius_nm))),
                Path::Centre {
                    clockwise,
                    centre_nm: [x, y],
                } => (clockwise, format!("\"centre\": [{}, {}]", Nm(x), Nm(y))),
            };
            let direction = if clockwise { "cw" } else { "ccw" };
            write!(
                out,
                "{separator}{{\"from\": [{x}, {y}], \"to\": [{to_x}, {to_y}], \"diameter\": \
                 {diameter}, \
                 \"direction\": \"{direction}\", {centre}}}"
            )?;
        }
        write!(out, "], \"tools\": [")?;
        for (index, tool) in self.tools.iter().enumerate() {
            let plated = tool
                .plated
                .map_or("null".to_owned(), |plated| plated.to_string());
            write!(
                out,
                "{}{{\"number\": {}, \"diameter\": {}, \"plated\": {plated}}}",
                comma(index),
                tool.number,
                diameter(tool)
            )?;
        }
        let settings = &self.settings;
        let zeros = match settings.zeros.value {
            Zeros::Leading => "leading",
            Zeros::Trailing => "trailing",
        };
        writeln!(
            out,
            "], \"units\": \"{}\", \"units_reason\": \"{}\", \"zeros\": \"{zeros}\", \
             \"zeros_reason\": \"{}\", \
             \"digits\": \"{}\", \"digits_reason\": \"{}\", \"errors\": {errors}, \"warnings\": \
             {warnings}}}",
            settings.units.value,
            because(settings.units.reason),
            because(settings.zeros.reason),
            settings.digits.value,
            because(settings.digits.reason),
        )
    }
}

fn comma(index: usize) -> &'static str {
    if index == 0 { "" } else { ", " }
}

fn diameter(tool: &Tool) -> String {
    tool.diameter_nm
        .map_or("null".to_owned(), |nm| Nm(nm).to_string())
}

/// `1 hole`, `2 holes`.
pub fn count(number: usize, name: &str) -> String {
    match number {
        1 => format!("1 {name}"),
        _ => format!("{number} {name}s"),
    }
}
