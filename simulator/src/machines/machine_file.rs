//! Machine files: reads TOML into a checked description. Every mistake is reported with its
//! position in the file.

mod axis_file;
mod built_in;
mod driver;
mod equipment;
mod home;
mod idle;
mod load_error;
mod motion;
mod pulse;
mod rates;
mod step;
mod step_mode;
mod travel;
pub mod work;

pub use axis_file::AxisFile;
pub use driver::Driver;
pub use equipment::Probe;
pub use idle::Idle;
pub use load_error::{LoadError, read_text};
pub use step_mode::StepMode;
pub use travel::Travel;

use crate::diagnostics::{Finding, Place};
use crate::machines::backlash_file::BacklashFile;
use crate::machines::bytes_file;
use crate::machines::table::{Table, document};
use crate::programs::program::Frames;
use built_in::BUILT_IN;
pub use built_in::MEASURING;
use husillo_gcode::{Axes, Dialect, Tool};
use husillo_machine::Equipment;
use husillo_metrology::quantity::Fraction;
use husillo_sim::observers::AXES;
use husillo_transports::microfactory::ByteTable;
use motion::Motion;
use std::io;
use std::sync::Arc;

/// The description of a machine.
#[derive(Clone, Debug)]
pub struct MachineFile {
    /// Path of the file; `machines/NAME.toml` for a built-in machine.
    pub path: String,
    /// The text of the file.
    pub text: Arc<str>,
    /// Short name.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// The language of its programs; `None`: RS-274.
    pub dialect: Option<Dialect>,
    /// Ticks per second of the timer that counts the waits between steps.
    pub timer_hz: u32,
    /// The axes: X, Y, Z, and up to three others.
    pub axes: Vec<AxisFile>,
    /// The letters of the axes.
    pub letters: Axes,
    /// The zeros of work frames.
    pub work: Frames,
    /// Path speed of rapid moves, nm/min; `None`: only the axes limit it.
    pub rapid: Option<i64>,
    /// Largest path speed of feed moves, nm/min; `None`: only the axes limit it.
    pub top_feed: Option<i64>,
    /// Largest |r_start - r_end| of an arc, nm; `None`: only the built-in rule for arcs applies.
    pub arc_tolerance: Option<i64>,
    /// Largest distance from a corner to the circle that limits the speed there, nm; `None`: only
    /// the junction rates of the axes set the speed.
    pub corner_deviation: Option<i64>,
    /// Counts per turn of the spindle's encoder; `None`: it has no encoder.
    pub spindle_counts: Option<u32>,
    /// Its equipment besides the axes.
    pub equipment: Equipment,
    /// Its probe.
    pub probe: Option<Probe>,
    /// Its tools, by number.
    pub tools: Vec<(u32, Tool<AXES>)>,
    /// Axes that may move at once; more give a warning.
    pub simultaneous_axes: u32,
    /// Backlash by position.
    pub backlash: BacklashFile,
    /// The bytes of the link of a microfactory, which takes byte commands.
    pub bytes: Option<ByteTable>,
    /// Motor current at standstill.
    pub idle: Idle,
    /// The axes of pictures, by index: the one to the right and the one up.
    pub view: [usize; 2],
}

impl MachineFile {
    /// A built-in machine by its name.
    pub fn built_in(name: &str) -> Option<Self> {
        let (_, path, text) = BUILT_IN.iter().find(|(known, ..)| *known == name)?;
        Self::parse(path, text).ok()
    }

    /// Loads a machine by its name or the path of its file, which `read` reads.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or has mistakes.
    pub fn load(
        name: &str,
        read: impl FnOnce(&str) -> io::Result<String>,
    ) -> Result<Self, LoadError> {
        if Self::is_measuring(name) {
            return Err(LoadError::File(format!(
                "{name} is a measuring machine and runs no programs: see `husillo measure`"
            )));
        }
        let built_in = BUILT_IN.iter().find(|(known, ..)| *known == name);
        match built_in {
            Some((_, path, text)) => Self::parse(path, text),
            None => Self::parse(
                name,
                &read_text(name, "machine", &Self::names().join(", "), read)?,
            ),
        }
        .map_err(LoadError::Findings)
    }

    /// Whether a name is that of a built-in machine, measuring machines included. A file of such a
    /// name is not read.
    pub fn is_built_in(name: &str) -> bool {
        Self::is_measuring(name) || Self::names().contains(&name)
    }

    /// Whether a name is that of a built-in measuring machine.
    pub fn is_measuring(name: &str) -> bool {
        MEASURING.iter().any(|(known, ..)| *known == name)
    }

    /// The text of the file of a built-in machine, measuring machines included.
    pub fn text_of(name: &str) -> Option<&'static str> {
        let all = BUILT_IN.iter().chain(&MEASURING);
        let mut texts = all.map(|(known, _, text)| (*known, *text));
        texts
            .find(|(known, _)| *known == name)
            .map(|(_, text)| text)
    }

    /// The names of the built-in machines.
    pub fn names() -> [&'static str; BUILT_IN.len()] {
        BUILT_IN.map(|(name, ..)| name)
    }

    /// Reads the text of a machine file.
    ///
    /// # Errors
    ///
    /// All mistakes of the text.
    pub fn parse(path: &str, text: &str) -> Result<Self, Vec<Finding>> {
        let mut findings = Vec::new();
        let document = document(path, text)?;
        let mut root = Table::new(
            path,
            text,
            "the file",
            document.span(),
            document.get_ref(),
            &mut findings,
        );
        root.integer("schema", 1..=1);
        let name = root.name();
        let title = root.string("title").unwrap_or_else(|| name.clone());
        let timer_hz = root.integer("timer_hz", 1_000..=1_000_000_000);
        let timer_hz = timer_hz.and_then(|hz| u32::try_from(hz).ok());
        let hz = timer_hz.unwrap_or(1_000_000);
        let dialects = Dialect::ALL.map(|dialect| (dialect.name(), dialect));
        let dialect = root.choice("dialect", &dialects);
        let axes = root.table("axis", |axes| read_axes(axes, hz));
        let motion = root
            .optional_table("motion", Motion::read)
            .unwrap_or_default();
        let view = root.optional_table("view", |view| view.choice("plane", &VIEWS));
        let spindle_counts = root.optional_table("spindle", spindle_counts).flatten();
        let equipment = root
            .optional_table("equipment", equipment::equipment)
            .unwrap_or(equipment::PLAIN);
        let probe = root.optional_table("probe", equipment::probe);
        let tools = Self::tools(&mut root);
        let idle = root
            .optional_table("idle", Idle::read)
            .unwrap_or(Idle::Hold);
        let first = axes.as_ref().map(|(first, _)| first);
        let backlash = BacklashFile::read(&mut root, [0, 1, 2].map(|axis| step(first, axis)));
        let bytes = root.optional_table("bytes", bytes_file::read);
        let axes = axes.and_then(all_axes);
        let letters = axes.as_deref().and_then(letters_of);
        let work = root.optional_table("work", |table| {
            work::read(table, &letters.unwrap_or(Axes::XYZABC))
        });
        root.finish();
        if let (Some(axes), None) = (&axes, letters) {
            findings.push(too_many_axes(axes.len(), Place::in_text(path, text, 0..0)));
        }
        let count = axes.as_ref().map_or(0, Vec::len);
        let has_axes = |view: &[usize; 2]| view.iter().all(|axis| *axis < count);
        let view = view.flatten().filter(has_axes);
        match axes.zip(letters) {
            Some((axes, letters)) if findings.is_empty() => Ok(Self {
                path: path.to_owned(),
                text: text.into(),
                name,
                title,
                dialect,
                timer_hz: hz,
                simultaneous_axes: motion.simultaneous_axes.unwrap_or(axes.len() as u32),
                axes,
                letters,
                rapid: motion.rapid,
                top_feed: motion.top_feed,
                arc_tolerance: motion.arc_tolerance,
                corner_deviation: motion.corner_deviation,
                spindle_counts,
                work: work.unwrap_or_default(),
                equipment: Equipment {
                    heaters: dialect == Some(Dialect::PRINTER),
                    probe: probe.is_some(),
                    ..equipment
                },
                probe,
                tools,
                backlash,
                bytes,
                idle,
                view: view.unwrap_or([0, 1]),
            }),
            _ => Err(findings),
        }
    }

    /// Computes a value for each axis, in the order of the coordinates of a command. An axis that
    /// the machine does not have gets `none`.
    pub fn each<T: Clone>(&self, none: T, of: impl Fn(&AxisFile) -> T) -> [T; AXES] {
        std::array::from_fn(|axis| self.axes.get(axis).map_or_else(|| none.clone(), &of))
    }

    /// Computes a value for each of X, Y and Z.
    pub fn xyz<T>(&self, of: impl Fn(&AxisFile) -> T) -> [T; 3] {
        [0, 1, 2].map(|axis| of(&self.axes[axis]))
    }

    /// The letter of an axis.
    pub fn letter(&self, axis: usize) -> u8 {
        self.letters.letter(axis).unwrap_or(b'?')
    }

    /// Reads the tools. Each number is used once, and the table of a controller has eight places.
    fn tools(root: &mut Table<'_, '_>) -> Vec<(u32, Tool<AXES>)> {
        let tools = root.optional_tables("tool", equipment::tool);
        let tools: Vec<_> = tools.unwrap_or_default().into_iter().flatten().collect();
        let number = |tool: &(u32, Tool<AXES>)| tool.0;
        let mut numbers: Vec<_> = tools.iter().map(number).collect();
        numbers.sort_unstable();
        numbers.dedup();
        if let Some((_, span)) = root.value("tool") {
            if numbers.len() < tools.len() {
                root.wrong(span.clone(), "a number of a tool is used twice", "tools");
            }
            if tools.len() > MOST_TOOLS {
                root.wrong(span, "too many tools", "at most eight");
            }
        }
        tools
    }

    /// The position of the travel of an axis in the machine file.
    pub fn travel_place(&self, axis: usize) -> Option<Place> {
        let span = self.axes.get(axis)?.travel_span.clone();
        Some(Place::in_text(&self.path, &self.text, span))
    }
}

/// Tools in the table of a controller.
const MOST_TOOLS: usize = 8;

/// The axes that a machine may have after X, Y and Z.
const MORE: [(&str, u8); 7] = [
    ("a", b'A'),
    ("b", b'B'),
    ("c", b'C'),
    ("u", b'U'),
    ("v", b'V'),
    ("w", b'W'),
    ("e", b'E'),
];

/// X, Y and Z, and the further axes that the file has. `None`: an axis is missing or wrong.
type AxisTables = ([Option<AxisFile>; 3], [Option<AxisFile>; MORE.len()]);

fn read_axes(axes: &mut Table<'_, '_>, timer_hz: u32) -> AxisTables {
    let first = [("x", b'X'), ("y", b'Y'), ("z", b'Z')].map(|(key, letter)| {
        axes.table(key, |axis| AxisFile::read(axis, letter, timer_hz))
            .flatten()
    });
    let more = MORE.map(|(key, letter)| read_more(axes, key, letter, timer_hz));
    (first, more)
}

/// The axes in the order of their coordinates. `None`: X, Y or Z is missing.
fn all_axes((first, more): AxisTables) -> Option<Vec<AxisFile>> {
    let mut axes = first.into_iter().collect::<Option<Vec<_>>>()?;
    axes.extend(more.into_iter().flatten());
    Some(axes)
}

fn read_more(axes: &mut Table<'_, '_>, key: &str, letter: u8, timer_hz: u32) -> Option<AxisFile> {
    let read = |axis: &mut Table<'_, '_>| AxisFile::read(axis, letter, timer_hz);
    axes.optional_table(key, read).flatten()
}

/// The step of one of the first three axes; 1 nm if an axis is missing or wrong. Then the tables of
/// backlash are still read, because unread keys would be reported as unknown.
fn step(axes: Option<&[Option<AxisFile>; 3]>, axis: usize) -> Fraction {
    let axis = axes.and_then(|axes| axes[axis].as_ref());
    axis.map_or(Fraction { num: 1, den: 1 }, |axis| axis.step)
}

fn spindle_counts(spindle: &mut Table<'_, '_>) -> Option<u32> {
    let counts = spindle.integer("counts", 1..=1_000_000)?;
    u32::try_from(counts).ok()
}

fn too_many_axes(number: usize, place: Place) -> Finding {
    let message = format!("{number} axes; a machine has at most six");
    Finding::error("E0802", message, place)
}

/// The axes by their letters; `None` for more than six.
fn letters_of(axes: &[AxisFile]) -> Option<Axes> {
    let letters = |is_wrapped: bool| -> Vec<u8> {
        let axes = axes.iter().filter(|axis| axis.is_wrapped || !is_wrapped);
        axes.map(|axis| axis.letter).collect()
    };
    Axes::new(&letters(false))?.with_wrapped(&letters(true))
}

/// The planes of pictures. The first axis after Z, `A` on most machines, is unrolled: a degree is
/// drawn as a millimetre.
const VIEWS: [(&str, [usize; 2]); 5] = [
    ("XA", [0, 3]),
    ("XY", [0, 1]),
    ("XZ", [0, 2]),
    ("ZX", [2, 0]),
    ("YZ", [1, 2]),
];

#[cfg(test)]
mod tests {
    use super::*;

    fn text_of(wanted: &str) -> &'static str {
        let found = BUILT_IN.iter().find(|(name, ..)| *name == wanted);
        found.unwrap().2
    }

    #[test]
    fn built_in_machines_are_read() {
        let micromill = MachineFile::built_in("micromill").unwrap();
        assert_eq!(micromill.xyz(|axis| axis.backlash_steps), [1457, 1271, 0]);
        assert_eq!(micromill.axes[0].travel, Travel::Range([0, 10_000_000]));
        assert_eq!(micromill.axes[2].travel, Travel::Unknown);
        let free = MachineFile::built_in("free").unwrap();
        assert_eq!(free.rapid, Some(6_000_000_000));
        assert_eq!(free.timer_hz, 32_000_000);
        let drill = MachineFile::built_in("drill").unwrap();
        assert_eq!(
            (drill.axes[0].step.num, drill.axes[0].step.den),
            (1_000_000, 107)
        );
        assert_eq!(
            drill.xyz(|axis| axis.home.map(|home| home.order)),
            [Some(3), Some(2), Some(1)]
        );
    }

    /// The messages of all findings in the micro mill's file after `from` is replaced with `to`.
    fn findings_with(from: &str, to: &str) -> Vec<String> {
        let text = text_of("micromill");
        assert!(text.contains(from), "{from}");
        match MachineFile::parse("mine.toml", &text.replacen(from, to, 1)) {
            Ok(_) => Vec::new(),
            Err(findings) => findings
                .into_iter()
                .map(|finding| finding.message)
                .collect(),
        }
    }

    #[test]
    fn pulses_bound_the_rate_of_a_step_and_direction_driver() {
        let text = include_str!("../../machines/router.toml");
        let findings = |text: &str| match MachineFile::parse("router.toml", text) {
            Ok(_) => Vec::new(),
            Err(findings) => findings
                .iter()
                .map(|finding| finding.message.clone())
                .collect(),
        };
        let file = MachineFile::parse("router.toml", text).unwrap();
        let (hz, rate) = (file.timer_hz, file.axes[0].max_rate);
        // STEP is high and low for half of the shortest interval each. Then one tick longer is too
        // long.
        let half_ns = 500_000_000 / u64::from(rate);
        let tick_ns = 1_000_000_000_u64.div_ceil(hz.into());
        let pulse =
            |ns: u64| format!("{text}\n[axis.x.pulse]\nhigh = \"{ns} ns\"\nlow = \"{ns} ns\"\n");
        assert_eq!(findings(&pulse(half_ns - tick_ns)), [""; 0]);
        let refused = findings(&pulse(half_ns + tick_ns));
        assert_eq!(refused.len(), 1, "{refused:?}");
        assert!(
            refused[0].contains("the pulses of the driver permit at most"),
            "{refused:?}"
        );
        // Coils have no pulses.
        let coils = pulse(1000).replacen("step-direction", "unipolar", 1);
        assert!(
            findings(&coils)[0].contains("pulse"),
            "{:?}",
            findings(&coils)
        );
    }

    #[test]
    fn bad_values_are_refused_once_with_their_key() {
        for (from, to, message) in [
            (
                "\"170 Hz\"",
                "\"391 Hz\"",
                "`max_rate` is above `pull_out_rate`",
            ),
            (
                "\"170 Hz\"",
                "\"170 Hz\"\nstart_rate = \"171 Hz\"",
                "`start_rate` is above `max_rate`",
            ),
            ("name = \"micromill\"", "name = \"\"", "`name` is empty"),
            ("name = \"micromill\"", "name = \" \"", "`name` is empty"),
            ("\"0.14 um\"", "\"0.0000001 um\"", "`step` does not fit"),
            ("\"0.14 um\"", "\"2000 mm\"", "`step` does not fit"),
            ("\"0.14 um\"", "\"-0.14 um\"", "`step` does not fit"),
            ("\"170 Hz\"", "\"-170 Hz\"", "`max_rate` does not fit"),
            ("\"170 Hz\"", "\"0 Hz\"", "`max_rate` does not fit"),
            (
                "mean_um = 204",
                "mean_um = nan",
                "`mean_um` is out of range",
            ),
            (
                "mean_um = 204",
                "mean_um = -inf",
                "`mean_um` is out of range",
            ),
            ("mean_um = 204", "mean_um = -1", "`mean_um` is out of range"),
            (
                "swing_um = 33",
                "swing_um = -1",
                "`swing_um` is out of range",
            ),
            (
                "resistance_ohm = 29.0",
                "resistance_ohm = inf",
                "`resistance_ohm` is out of range",
            ),
        ] {
            assert_eq!(findings_with(from, to), [message], "{to}");
        }
        assert_eq!(findings_with("\"170 Hz\"", "\"390 Hz\""), [""; 0]);
    }

    #[test]
    fn a_missing_axis_makes_no_key_unknown() {
        let found = findings_with("[axis.z]", "[axis.q]");
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(
            found.iter().all(|message| message.contains("axis")),
            "{found:?}"
        );
    }

    #[test]
    fn a_misspelt_key_gets_a_suggestion() {
        let text = text_of("micromill").replacen("backlash", "baklash", 1);
        let findings = MachineFile::parse("mine.toml", &text).unwrap_err();
        assert_eq!(findings.len(), 1);
        assert_eq!(findings[0].message, "unknown key `baklash` in [axis.x]");
        assert_eq!(
            findings[0].help.as_deref(),
            Some("did you mean `backlash`?")
        );
        assert_eq!(&text[text.find("baklash").unwrap()..][..7], "baklash");
    }

    #[test]
    fn all_wrong_values_are_reported() {
        let text = text_of("micromill")
            .replacen("\"0.14 um\"", "\"0.14 parsec\"", 1)
            .replacen("\"390 Hz\"", "390", 1)
            .replacen("\"pbl3717a\"", "\"pbl3717\"", 1);
        let findings = MachineFile::parse("mine.toml", &text).unwrap_err();
        assert!(findings.len() >= 3, "{findings:#?}");
        let text = text_of("drill").replacen(
            "steps_per_mm = 107",
            "steps_per_mm = 107\nstep = \"1 um\"",
            1,
        );
        let findings = MachineFile::parse("mine.toml", &text).unwrap_err();
        assert_eq!(findings[0].message, "`steps_per_mm` as well as `step`");
    }
}
