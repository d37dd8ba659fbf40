//! Machine files: TOML to a checked description, with every mistake at its place.

use crate::diagnostics::{Finding, Place};
use crate::machines::bytes_file;
use crate::machines::encoder_file::EncoderFile;
use crate::machines::lash_file::LashFile;
use crate::machines::power::Power;
use crate::machines::table::{Table, document};
use husillo_gcode::Dialect;
use husillo_metrology::quantity::{self, Fraction, Quantity};
use husillo_stepper::PulseNanoseconds;
use husillo_transports::microfactory::ByteTable;
use std::ops::Range;

/// Name, path and text of the machines that need no file.
const BUILT_IN: [(&str, &str, &str); 6] = [
    (
        "micromill",
        "machines/micromill.toml",
        include_str!("../../../machines/micromill.toml"),
    ),
    (
        "free",
        "machines/free.toml",
        include_str!("../../../machines/free.toml"),
    ),
    (
        "router",
        "machines/router.toml",
        include_str!("../../../machines/router.toml"),
    ),
    (
        "lathe",
        "machines/lathe.toml",
        include_str!("../../../machines/lathe.toml"),
    ),
    (
        "drill",
        "machines/drill.toml",
        include_str!("../../../machines/drill.toml"),
    ),
    (
        "microfactory",
        "machines/microfactory.toml",
        include_str!("../../../machines/microfactory.toml"),
    ),
];

/// A machine as its file describes it.
#[allow(dead_code)] // all of a file is checked; homing is not simulated yet
#[derive(Clone, Debug)]
pub struct MachineFile {
    /// Path of the file, or `machines/NAME.toml` for one that is built in.
    pub path: String,
    /// Short name.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// The language of its programs; `None`: RS-274.
    pub dialect: Option<Dialect>,
    /// Ticks a second of the timer that counts the waits.
    pub timer_hz: u32,
    /// The axes X, Y, Z.
    pub axes: [AxisFile; 3],
    /// Path speed of rapid moves in nm/min; `None`: as fast as the axes go.
    pub rapid: Option<i64>,
    /// Largest path speed of feed moves in nm/min; `None`: as fast as the axes go.
    pub top_feed: Option<i64>,
    /// Largest |r_start - r_end| of an arc in nm; `None`: the rule of the arc verdict alone.
    pub arc_tolerance: Option<i64>,
    /// The largest distance of the path from a corner, in nm. `None`: only the junction rates of
    /// the axes set the speed.
    pub corner_deviation: Option<i64>,
    /// Counts a turn of the spindle's encoder; `None`: it has none.
    pub spindle_counts: Option<u32>,
    /// Axes that may move at once; more are warned about.
    pub simultaneous_axes: u32,
    /// Lash by place.
    pub lash: LashFile,
    /// The bytes of a link of byte commands, which a microfactory has.
    pub bytes: Option<ByteTable>,
    /// What the motors do when nothing moves.
    pub idle: Idle,
    /// The axes of pictures, by index: to the right and up.
    pub view: [usize; 2],
}

/// One axis.
#[allow(dead_code)]
#[derive(Clone, Debug)]
pub struct AxisFile {
    /// `X`, `Y` or `Z`.
    pub letter: u8,
    /// Nanometres a motor step.
    pub step: Fraction,
    /// Limits of the machine coordinate.
    pub travel: Travel,
    /// Where in the file the travel stands, for messages.
    pub travel_span: Range<usize>,
    /// Lash in whole motor steps.
    pub lash_steps: u32,
    /// Rate at which a move may start, steps/s.
    pub start_rate: u32,
    /// Largest rate, steps/s.
    pub max_rate: u32,
    /// Rate above which the motor loses steps, steps/s; `None`: never.
    pub pull_out_rate: Option<u32>,
    /// Acceleration in steps/s^2; `None`: no ramps.
    pub acceleration: Option<u32>,
    /// Jerk in steps/s^3; `None`: no limit.
    pub jerk: Option<u32>,
    /// Largest step of the rate at a corner, steps/s; `None`: no limit.
    pub junction: Option<u32>,
    /// Driver between the controller and the coils.
    pub driver: Driver,
    /// Times of the pulses of a step and direction driver.
    pub pulse: PulseNanoseconds,
    /// Step mode of that driver.
    pub mode: StepMode,
    /// Homing, when the axis has a switch.
    pub home: Option<Home>,
    /// Winding, chopper and load, when they are known.
    pub power: Option<Power>,
    /// Encoder on the motor, if there is one.
    pub encoder: Option<EncoderFile>,
}

impl AxisFile {
    /// The shortest interval between two steps that the motor follows, in timer ticks, rounded
    /// down: by its pull-out rate, or by its winding and its load. 0: it follows any.
    pub fn pull_out_ticks(&self, timer_hz: u32) -> u32 {
        let by_winding = || self.power.as_ref().and_then(Power::pull_out_hz);
        match self.pull_out_rate {
            Some(rate) => timer_hz / rate.max(1),
            // At least a tick a step: below 2^32.
            None => by_winding().map_or(0, |hz| (f64::from(timer_hz) / hz) as u32),
        }
    }
}

/// Travel of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Travel {
    /// From and to, in nm of the machine frame.
    Range([i64; 2]),
    /// Nobody knows: nothing is checked, with a warning.
    Unknown,
    /// There is no limit.
    Unlimited,
}

/// Drivers by their name in machine files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Driver {
    /// One PBL3717A a phase.
    Pbl3717a,
    /// A3988, two motors a chip.
    A3988,
    /// L297 sequencer.
    L297,
    /// Four-bit unipolar motor.
    Unipolar,
    /// Step and direction, a pulse a step.
    StepDirection,
    /// Step and direction for drivers that count both edges of STEP.
    StepToggle,
}

/// Step modes by their name in machine files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepMode {
    /// Full step, one phase on.
    Wave,
    /// Full step, two phases on.
    Full,
    /// Half step.
    Half,
    /// Quarter step.
    Quarter,
}

/// Homing of one axis.
#[allow(dead_code)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Home {
    /// Place in the order of axes, from 1.
    pub order: u32,
    /// -1 or +1: the side the switch is on.
    pub direction: i8,
    /// Motor steps back off the switch.
    pub pull_off: u32,
}

/// What the motors do when nothing moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Idle {
    /// Full current.
    Hold,
    /// Reduced current after this many microseconds.
    Reduced(u64),
    /// No current after this many microseconds.
    Off(u64),
}

/// Why there is no machine.
#[derive(Debug)]
pub enum LoadError {
    /// The file cannot be read.
    File(String),
    /// The file has mistakes.
    Findings(Vec<Finding>),
}

/// The text of a file that should be a machine of this kind. `built_in` names the machines that
/// need no file.
pub fn read_text(path: &str, kind: &str, built_in: &str) -> Result<String, LoadError> {
    crate::input::read_to_string(path).map_err(|error| {
        LoadError::File(format!(
            "no {kind} `{path}`: built in are {built_in}; as a file: {error}"
        ))
    })
}

impl MachineFile {
    /// Loads a machine by its name or the path of its file.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or has mistakes.
    pub fn load(name: &str) -> Result<Self, LoadError> {
        if matches!(name, "cmm" | "cmm3") {
            return Err(LoadError::File(format!(
                "{name} runs no programs: see `husillo measure`"
            )));
        }
        let built_in = BUILT_IN.iter().find(|(known, ..)| *known == name);
        match built_in {
            Some((_, path, text)) => Self::parse(path, text),
            None => Self::parse(
                name,
                &read_text(name, "machine", &Self::names().join(", "))?,
            ),
        }
        .map_err(LoadError::Findings)
    }

    /// The machines that need no file.
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
        let timer_hz = root
            .integer("timer_hz", 1_000..=1_000_000_000)
            .unwrap_or(1_000_000);
        let dialects = Dialect::ALL.map(|dialect| (dialect.name(), dialect));
        let dialect = root.choice("dialect", &dialects);
        let hz = u32::try_from(timer_hz).unwrap_or(1_000_000);
        let axes = root.table("axis", |axes| {
            let mut read = |key: &str, letter| {
                axes.table(key, |axis| read_axis(axis, letter, hz))
                    .flatten()
            };
            (read("x", b'X'), read("y", b'Y'), read("z", b'Z'))
        });
        let motion = root
            .optional_table("motion", read_motion)
            .unwrap_or_default();
        let view = root.optional_table("view", |view| view.choice("plane", &VIEWS));
        let spindle_counts = root
            .optional_table("spindle", |spindle| {
                spindle
                    .integer("counts", 1..=1_000_000)
                    .and_then(|counts| u32::try_from(counts).ok())
            })
            .flatten();
        let idle = root.optional_table("idle", read_idle).unwrap_or(Idle::Hold);
        // Read where an axis is missing, too: its keys are known all the same.
        let step = |axis: &Option<AxisFile>| {
            let unknown = Fraction { num: 1, den: 1 };
            axis.as_ref().map_or(unknown, |axis| axis.step)
        };
        let steps = match &axes {
            Some((x, y, z)) => [step(x), step(y), step(z)],
            None => [Fraction { num: 1, den: 1 }; 3],
        };
        let lash = LashFile::read(&mut root, steps);
        let bytes = root.optional_table("bytes", bytes_file::read);
        root.finish();
        match axes {
            Some((Some(x), Some(y), Some(z))) if findings.is_empty() => Ok(Self {
                path: path.to_owned(),
                name,
                title,
                dialect,
                timer_hz: u32::try_from(timer_hz).unwrap_or(1_000_000),
                axes: [x, y, z],
                rapid: motion.rapid,
                top_feed: motion.top_feed,
                arc_tolerance: motion.arc_tolerance,
                corner_deviation: motion.corner_deviation,
                spindle_counts,
                simultaneous_axes: motion.simultaneous_axes.unwrap_or(3),
                lash,
                bytes,
                idle,
                view: view.flatten().unwrap_or([0, 1]),
            }),
            _ => Err(findings),
        }
    }

    /// The text of the file.
    ///
    /// # Errors
    ///
    /// A sentence: it is no longer there.
    pub fn text(&self) -> Result<String, String> {
        let built_in = BUILT_IN.iter().find(|(_, path, _)| *path == self.path);
        match built_in {
            Some((.., text)) => Ok((*text).to_owned()),
            None => crate::input::read_to_string(&self.path)
                .map_err(|error| format!("{}: {error}", self.path)),
        }
    }

    /// Where the travel of an axis stands in the machine file.
    pub fn travel_place(&self, axis: usize) -> Option<Place> {
        let text = self.text().ok()?;
        let span = self.axes.get(axis)?.travel_span.clone();
        Some(Place::in_text(&self.path, &text, span))
    }
}

#[derive(Default)]
struct Motion {
    rapid: Option<i64>,
    top_feed: Option<i64>,
    arc_tolerance: Option<i64>,
    corner_deviation: Option<i64>,
    simultaneous_axes: Option<u32>,
}

fn read_motion(table: &mut Table<'_, '_>) -> Motion {
    let speed = |table: &mut Table<'_, '_>, key| {
        table.quantity(
            key,
            "a speed as in \"6000 mm/min\"",
            |quantity| match quantity {
                Quantity::Speed(speed) if speed.num > 0 => Some(speed.rounded()),
                _ => None,
            },
        )
    };
    let length = |table: &mut Table<'_, '_>, key| {
        table.quantity(
            key,
            "a length as in \"0.28 um\"",
            |quantity| match quantity {
                Quantity::Length(length) if length.num >= 0 => Some(length.rounded()),
                _ => None,
            },
        )
    };
    Motion {
        rapid: speed(table, "rapid"),
        top_feed: speed(table, "top_feed"),
        arc_tolerance: length(table, "arc_tolerance"),
        corner_deviation: length(table, "corner_deviation"),
        simultaneous_axes: table
            .integer("simultaneous_axes", 1..=3)
            .and_then(|n| u32::try_from(n).ok()),
    }
}

fn read_idle(table: &mut Table<'_, '_>) -> Idle {
    let after = table
        .quantity(
            "after",
            "a time as in \"30 s\"",
            |quantity| match quantity {
                Quantity::Time(time) => u64::try_from(time.rounded()).ok(),
                _ => None,
            },
        )
        .unwrap_or(0);
    let policy = table.choice(
        "policy",
        &[
            ("hold", Idle::Hold),
            ("reduced", Idle::Reduced(after)),
            ("off", Idle::Off(after)),
        ],
    );
    policy.unwrap_or(Idle::Hold)
}

/// The length of a step: `step`, or `steps_per_mm`.
fn read_step(table: &mut Table<'_, '_>) -> Fraction {
    let step = table.quantity(
        "step",
        "a length from 1 nm to 1 m as in \"0.14 um\"",
        |quantity| match quantity {
            Quantity::Length(length) if is_step(length) => Some(length),
            _ => None,
        },
    );
    if let (Some(_), Some((_, span))) = (step, table.value("steps_per_mm")) {
        table.wrong(
            span,
            "`steps_per_mm` beside `step`",
            "one of them is enough",
        );
    }
    let per_mm = table.integer("steps_per_mm", 1..=1_000_000);
    let step = step.or(per_mm.and_then(|steps| Fraction::new(1_000_000, i128::from(steps))));
    if step.is_none() {
        table.missing("step");
    }
    step.unwrap_or(Fraction { num: 1, den: 1 })
}

/// The rates of an axis, steps per second.
struct Rates {
    max: u32,
    start: Option<u32>,
    pull_out: Option<u32>,
    junction: Option<u32>,
}

impl Rates {
    fn read(table: &mut Table<'_, '_>, step: Fraction) -> Self {
        let max = rate(table, "max_rate", step);
        if max.is_none() {
            table.missing("max_rate");
        }
        let start = rate(table, "start_rate", step);
        let pull_out = rate(table, "pull_out_rate", step);
        let junction = rate(table, "junction", step);
        check_above(
            table,
            ["max_rate", "pull_out_rate"],
            [max, pull_out],
            "the motor loses steps there",
        );
        check_above(
            table,
            ["start_rate", "max_rate"],
            [start, max],
            "the axis never steps so fast",
        );
        Self {
            max: max.unwrap_or(1),
            start,
            pull_out,
            junction,
        }
    }
}

/// The pulse of the driver, which bounds the rate.
fn read_driver_pulse(
    table: &mut Table<'_, '_>,
    driver: Driver,
    max_rate: u32,
    timer_hz: u32,
) -> PulseNanoseconds {
    let pulse = match driver {
        Driver::StepDirection => table.optional_table("pulse", read_pulse),
        _ => None,
    };
    let pulse = pulse.unwrap_or(PulseNanoseconds::A4988);
    let shortest_ticks = pulse.ticks(timer_hz).shortest_interval_ticks();
    let highest = timer_hz / shortest_ticks.max(1);
    if let (Driver::StepDirection, Some((_, span))) = (driver, table.value("max_rate")) {
        if max_rate > highest {
            let message = format!(
                "`max_rate` is {max_rate} Hz, and the pulses of the driver take at most {highest} \
                 Hz"
            );
            table.wrong(
                span,
                &message,
                "lower it, or give the times of the driver in `pulse`",
            );
        }
    }
    pulse
}

fn read_axis(table: &mut Table<'_, '_>, letter: u8, timer_hz: u32) -> Option<AxisFile> {
    let step = read_step(table);
    let (travel, travel_span) = table.travel("travel", step);
    let lash = table.quantity(
        "backlash",
        "a length as in \"204 um\", or steps",
        |quantity| match quantity {
            Quantity::Length(length) => length
                .over(step)
                .and_then(|steps| u32::try_from(steps).ok()),
            Quantity::Steps(steps) => u32::try_from(steps.rounded()).ok(),
            _ => None,
        },
    );
    let rates = Rates::read(table, step);
    let driver = table
        .choice("driver", &DRIVERS)
        .unwrap_or(Driver::StepDirection);
    let pulse = read_driver_pulse(table, driver, rates.max, timer_hz);
    let acceleration = table.quantity(
        "acceleration",
        "as in \"300 mm/s^2\" or, in steps/s^2, \"2000 Hz/s\"",
        |quantity| match quantity {
            Quantity::Acceleration(value) => positive(value.rounded()),
            Quantity::AxisAcceleration(nm_per_s2) => nm_per_s2.over(step).and_then(positive),
            _ => None,
        },
    );
    Some(AxisFile {
        letter,
        step,
        travel,
        travel_span,
        lash_steps: lash.unwrap_or(0),
        // Without an acceleration there are no ramps.
        start_rate: rates.start.unwrap_or(match acceleration {
            Some(_) => 0,
            None => rates.max,
        }),
        max_rate: rates.max,
        pull_out_rate: rates.pull_out,
        acceleration,
        jerk: table.quantity(
            "jerk",
            "steps/s^3 as in \"5000 Hz/s^2\"",
            |quantity| match quantity {
                Quantity::Jerk(value) => positive(value.rounded()),
                _ => None,
            },
        ),
        junction: rates.junction,
        driver,
        pulse,
        mode: table.choice("mode", &MODES).unwrap_or(StepMode::Full),
        home: table.optional_table("home", |home| read_home(home, step)),
        power: table.optional_table("motor", Power::read).flatten(),
        encoder: table
            .optional_table("encoder", |table| EncoderFile::read(table, step, rates.max))
            .flatten(),
    })
}

const VIEWS: [(&str, [usize; 2]); 4] = [
    ("XY", [0, 1]),
    ("XZ", [0, 2]),
    ("ZX", [2, 0]),
    ("YZ", [1, 2]),
];

const DRIVERS: [(&str, Driver); 6] = [
    ("pbl3717a", Driver::Pbl3717a),
    ("a3988", Driver::A3988),
    ("l297", Driver::L297),
    ("unipolar", Driver::Unipolar),
    ("step-direction", Driver::StepDirection),
    ("step-toggle", Driver::StepToggle),
];

const MODES: [(&str, StepMode); 4] = [
    ("wave", StepMode::Wave),
    ("full", StepMode::Full),
    ("half", StepMode::Half),
    ("quarter", StepMode::Quarter),
];

/// Reads `[axis.x.pulse]`; what is left out is the A4988's.
fn read_pulse(table: &mut Table<'_, '_>) -> PulseNanoseconds {
    let mut time = |key, default| {
        let expected = "a time up to 1 ms as in \"200 ns\" or \"1.9 us\"";
        let read = table.quantity(key, expected, |quantity| match quantity {
            Quantity::Time(us) => us
                .over(Fraction { num: 1, den: 1000 })
                .and_then(|ns| u32::try_from(ns).ok())
                .filter(|ns| *ns <= 1_000_000),
            _ => None,
        });
        read.unwrap_or(default)
    };
    let default = PulseNanoseconds::A4988;
    PulseNanoseconds {
        setup: time("setup", default.setup),
        hold: time("hold", default.hold),
        high: time("high", default.high),
        low: time("low", default.low),
    }
}

/// A rate in steps/s, or a speed of the axis.
fn rate(table: &mut Table<'_, '_>, key: &'static str, step: Fraction) -> Option<u32> {
    table.quantity(
        key,
        "a rate as in \"170 Hz\", or a speed as in \"30 mm/min\"",
        |quantity| match quantity {
            Quantity::Rate(value) => positive(value.rounded()),
            Quantity::Speed(nm_per_min) => nm_per_min
                .over(Fraction {
                    num: step.num.checked_mul(60)?,
                    den: step.den,
                })
                .and_then(positive),
            _ => None,
        },
    )
}

/// From a nanometre to a metre: what positions in nanometres can tell apart, and a machine's
/// travel.
fn is_step(length: Fraction) -> bool {
    length.num >= length.den && length.num <= length.den.saturating_mul(1_000_000_000)
}

/// Refuses a rate above the other one, at its own place.
fn check_above(
    table: &mut Table<'_, '_>,
    [key, other]: [&'static str; 2],
    rates: [Option<u32>; 2],
    why: &str,
) {
    let [Some(rate), Some(limit)] = rates else {
        return;
    };
    if rate <= limit {
        return;
    }
    if let Some((_, span)) = table.value(key) {
        table.wrong(
            span,
            &format!("`{key}` is above `{other}`"),
            &format!("{rate} Hz, above {limit} Hz: {why}"),
        );
    }
}

fn positive(value: i64) -> Option<u32> {
    u32::try_from(value).ok().filter(|value| *value > 0)
}

fn read_home(table: &mut Table<'_, '_>, step: Fraction) -> Home {
    Home {
        order: table
            .integer("order", 1..=3)
            .and_then(|order| u32::try_from(order).ok())
            .unwrap_or(1),
        direction: table
            .choice("direction", &[("-", -1), ("+", 1)])
            .unwrap_or(-1),
        pull_off: table
            .quantity("pull_off", "steps or a length", |quantity| match quantity {
                Quantity::Steps(steps) => u32::try_from(steps.rounded()).ok(),
                Quantity::Length(length) => length
                    .over(step)
                    .and_then(|steps| u32::try_from(steps).ok()),
                _ => None,
            })
            .unwrap_or(0),
    }
}

impl Table<'_, '_> {
    /// `["0 mm", "10 mm"]`, `"unknown"` or `"unlimited"`; the span of the value for later messages.
    fn travel(&mut self, key: &'static str, step: Fraction) -> (Travel, Range<usize>) {
        let Some((value, span)) = self.value(key) else {
            return (Travel::Unknown, 0..0);
        };
        let length = |value: &toml::de::DeValue<'_>| match quantity::parse(value.as_str()?) {
            Ok(Quantity::Length(length)) => Some(length.rounded()),
            Ok(Quantity::Steps(steps)) => Fraction::new(
                i128::from(steps.num) * i128::from(step.num),
                i128::from(steps.den) * i128::from(step.den),
            )
            .map(Fraction::rounded),
            _ => None,
        };
        let range =
            value
                .as_array()
                .and_then(|array| match (array.len(), array.first(), array.get(1)) {
                    (2, Some(low), Some(high)) => {
                        Some([length(low.get_ref())?, length(high.get_ref())?])
                    }
                    _ => None,
                });
        match (value.as_str(), range) {
            (Some("unknown"), _) => (Travel::Unknown, span),
            (Some("unlimited"), _) => (Travel::Unlimited, span),
            (_, Some([low, high])) if low < high => (Travel::Range([low, high]), span),
            _ => {
                self.wrong(
                    span.clone(),
                    "travel is not understood",
                    "expected [\"0 mm\", \"10 mm\"], \"unknown\" or \"unlimited\"",
                );
                (Travel::Unknown, span)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text_of(wanted: &str) -> &'static str {
        let found = BUILT_IN.iter().find(|(name, ..)| *name == wanted);
        found.unwrap().2
    }

    #[test]
    fn the_machines_that_are_built_in() {
        let micromill = MachineFile::load("micromill").unwrap();
        assert_eq!(
            micromill.axes.each_ref().map(|axis| axis.lash_steps),
            [1457, 1271, 0]
        );
        assert_eq!(micromill.axes[0].travel, Travel::Range([0, 10_000_000]));
        assert_eq!(micromill.axes[2].travel, Travel::Unknown);
        let free = MachineFile::load("free").unwrap();
        assert_eq!(free.rapid, Some(6_000_000_000));
        assert_eq!(free.timer_hz, 32_000_000);
        let drill = MachineFile::load("drill").unwrap();
        assert_eq!(
            (drill.axes[0].step.num, drill.axes[0].step.den),
            (1_000_000, 107)
        );
        assert_eq!(
            drill
                .axes
                .each_ref()
                .map(|axis| axis.home.map(|home| home.order)),
            [Some(3), Some(2), Some(1)]
        );
    }

    /// Message and marked text of every finding in the micro mill's file with one text replaced.
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
        let text = include_str!("../../../machines/router.toml");
        let findings = |text: &str| match MachineFile::parse("router.toml", text) {
            Ok(_) => Vec::new(),
            Err(findings) => findings
                .iter()
                .map(|finding| finding.message.clone())
                .collect(),
        };
        let file = MachineFile::parse("router.toml", text).unwrap();
        let (hz, rate) = (file.timer_hz, file.axes[0].max_rate);
        // High and low for half of the shortest interval, and a tick more.
        let half_ns = 500_000_000 / u64::from(rate);
        let tick_ns = 1_000_000_000_u64.div_ceil(hz.into());
        let pulse =
            |ns: u64| format!("{text}\n[axis.x.pulse]\nhigh = \"{ns} ns\"\nlow = \"{ns} ns\"\n");
        assert_eq!(findings(&pulse(half_ns - tick_ns)), [""; 0]);
        let refused = findings(&pulse(half_ns + tick_ns));
        assert_eq!(refused.len(), 1, "{refused:?}");
        assert!(
            refused[0].contains("the pulses of the driver take at most"),
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
    fn nonsense_is_refused_once_and_by_its_key() {
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
        let found = findings_with("[axis.z]", "[axis.w]");
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(
            found.iter().all(|message| message.contains("axis")),
            "{found:?}"
        );
    }

    #[test]
    fn a_misspelt_key_is_pointed_at() {
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
    fn wrong_values_are_found_all_at_once() {
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
        assert_eq!(findings[0].message, "`steps_per_mm` beside `step`");
    }
}
