//! Builds the parts of a machine from its file: limits, motors, the simulated machine.

use crate::machines::machine_file::{AxisFile, Driver, Idle, MachineFile, StepMode, Travel};
use husillo_backlash::{BacklashMap, Flank, MappedBacklash};
use husillo_gcode::{Dialect, Nm};
use husillo_interp::Path;
use husillo_machine::planner::JerkWindow;
use husillo_machine::{
    Axis, AxisEncoder, AxisRamp, ClosedLoop, Config, Extended, Machine, Scale, SmoothRamp,
};
use husillo_metrology::calibration::backlash::Map;
use husillo_probe::{PreTravel, Tip, UnitVector};
use husillo_sim::observers::AXES;
use husillo_sim::observers::phases;
use husillo_sim::{AxisModel, BacklashField, Rig};
use husillo_stepper::{Drive, Mode, Motors, Sequencer, StepDirection, StepToggle};
use std::sync::Arc;

/// The backlash of an axis. A single value is a map with one position.
pub type Screw = MappedBacklash<Arc<[i32]>, Arc<[u32]>>;
/// The engine with all commands, and with the backlash model `L`.
pub type Engine<L> = Machine<AXES, Path<AXES>, L, 16, Extended<AXES>, SmoothRamp>;
/// The engine with backlash maps.
pub type MappedEngine = Engine<Screw>;
/// The engine with backlash maps and encoders.
pub type ClosedEngine = ClosedLoop<AXES, Path<AXES>, Screw, 16, Extended<AXES>, SmoothRamp>;

/// The backlash that the controller takes up: the maps of the file, or one value for an axis
/// without a map.
///
/// # Errors
///
/// A backlash is out of range.
pub fn maps(file: &MachineFile) -> Result<[Map; AXES], String> {
    let one = one_value(file);
    for axis in &file.axes {
        if axis.backlash_steps > MOST_BACKLASH_STEPS {
            let letter = char::from(axis.letter);
            return Err(format!(
                "{}: the backlash of {letter} is out of range",
                file.path
            ));
        }
    }
    let own = file.backlash.maps.iter().cloned();
    let mut all = one;
    for (map, own) in all.iter_mut().zip(own) {
        if let Some(own) = own {
            *map = own;
        }
    }
    Ok(all)
}

/// Largest backlash of an axis, steps.
const MOST_BACKLASH_STEPS: u32 = (1 << 20) - 1;

/// One backlash value per axis. The maps of the file are ignored.
pub fn one_value(file: &MachineFile) -> [Map; AXES] {
    file.each(flat(0), |axis| flat(axis.backlash_steps))
}

/// No backlash.
pub fn no_backlash() -> [Map; AXES] {
    std::array::from_fn(|_| flat(0))
}

/// The same backlash everywhere.
fn flat(steps: u32) -> Map {
    let positions = || Arc::from([0]);
    BacklashMap::new(
        [0, 1],
        [positions(), positions()],
        Arc::from([steps.min(MOST_BACKLASH_STEPS)]),
    )
    .expect("one entry in range, at one position")
}

/// A machine that takes up the backlash of these maps.
pub fn with_maps(config: Config<AXES>, maps: [Map; AXES]) -> MappedEngine {
    MappedEngine::with_backlash(
        config,
        maps.map(|map| MappedBacklash::new(map, Flank::Positive)),
    )
}

/// The dialect of a program. It is the requested one, otherwise that of the file name, otherwise
/// that of the machine.
///
/// # Errors
///
/// The dialect is unknown, or the file is a drill file.
pub fn dialect(
    name: Option<&str>,
    file: &str,
    machine: Option<&MachineFile>,
) -> Result<Dialect, String> {
    let lower = file.to_ascii_lowercase();
    let name = match name {
        Some(name) => name,
        None if lower.ends_with(".mm") => "micromill",
        None if crate::holes::is_drill_file(None, file) => {
            return Err(format!(
                "{file}: a drill file; `husillo holes` makes a program of it"
            ));
        }
        None => match machine.and_then(|machine| machine.dialect) {
            Some(dialect) => return Ok(dialect),
            None => "rs274",
        },
    };
    Dialect::by_name(name).ok_or_else(|| {
        let names = Dialect::ALL.map(|dialect| dialect.name()).join(", ");
        format!("unknown dialect `{name}`: there are {names}")
    })
}

/// The encoders of the axes.
pub fn encoders(file: &MachineFile) -> [Option<AxisEncoder>; AXES] {
    file.each(None, |axis| {
        Some(axis.encoder.as_ref()?.encoder(file.timer_hz))
    })
}

/// Adapts a dialect to this machine: to its axes and its tolerance of arcs. A program of a CAM
/// system may begin with axis words. They are taken as G0, with a warning.
pub fn on_axes(dialect: Dialect, file: &MachineFile) -> Dialect {
    let is_of_cam = [
        Dialect::RS274,
        Dialect::GRBL,
        Dialect::ISO,
        Dialect::LATHE,
        Dialect::LATHE_A,
    ]
    .iter()
    .any(|other| other.name() == dialect.name());
    dialect
        .with_axes(file.letters)
        .with_arc_tolerance(file.arc_tolerance.map(Nm))
        .with_rapid_start(is_of_cam)
}

/// An axis that a machine does not have. It never moves.
const fn absent() -> Axis {
    Axis {
        scale: match Scale::new(1, 1) {
            Some(scale) => scale,
            None => panic!("a nanometre per step"),
        },
        travel: None,
        max_rate_hz: u32::MAX,
        backlash_steps: 0,
        ramp: None,
    }
}

/// The configuration of `husillo_machine`.
///
/// # Errors
///
/// A step is not a ratio of 32-bit numbers, or the jerk does not suit the accelerations.
pub fn config(file: &MachineFile, dialect: Dialect) -> Result<Config<AXES>, String> {
    let mut axes = [absent(); AXES];
    for (axis, own) in axes.iter_mut().zip(&file.axes) {
        *axis = axis_of(file, own)?;
    }
    let config = Config {
        axes,
        timer_hz: file.timer_hz,
        dialect: on_axes(dialect, file),
        arc_tolerance: file.arc_tolerance.map(Nm),
        rapid: file.rapid.map(Nm),
        top_feed: file.top_feed.map(Nm),
        corner_deviation: file.corner_deviation.map(Nm),
        spindle_counts: file.spindle_counts,
        equipment: file.equipment,
    };
    let window = config
        .jerk_limits()
        .map(|limits| JerkWindow::<(), 1>::new(&limits));
    match window {
        Some(Err(why)) => Err(format!("{}: {why}", file.path)),
        _ => Ok(config),
    }
}

/// The tip of the probe, if reported positions are corrected for it.
pub fn tip(file: &MachineFile) -> Option<Tip<6>> {
    let probe = file.probe.as_ref().filter(|probe| probe.corrects)?;
    let narrow = |nm: i64| i32::try_from(nm).unwrap_or(i32::MAX);
    Some(Tip {
        radius_nm: narrow(probe.radius_nm),
        pre_travel: PreTravel::of(&[(UnitVector::X, narrow(probe.pre_travel_nm))])?,
    })
}

fn axis_of(file: &MachineFile, axis: &AxisFile) -> Result<Axis, String> {
    let scale = u32::try_from(axis.step.num)
        .ok()
        .zip(u32::try_from(axis.step.den).ok())
        .and_then(|(nm, steps)| Scale::new(nm, steps))
        .ok_or_else(|| {
            let letter = char::from(axis.letter);
            format!("{}: the step of {letter} is out of range", file.path)
        })?;
    Ok(Axis {
        scale,
        travel: match axis.travel {
            Travel::Range(range) => Some(range.map(Nm)),
            Travel::Unknown | Travel::Unlimited => None,
        },
        max_rate_hz: axis.max_rate,
        backlash_steps: axis.backlash_steps,
        ramp: axis.acceleration.map(|acceleration_hz_per_s| AxisRamp {
            acceleration_hz_per_s,
            start_rate_hz: axis.start_rate,
            jerk_hz_per_s2: axis.jerk,
            junction_hz: axis.junction,
        }),
    })
}

/// X, Y and Z of a configuration.
pub const fn first_three(config: &Config<AXES>) -> Config<3> {
    let [x, y, z, ..] = config.axes;
    Config {
        axes: [x, y, z],
        timer_hz: config.timer_hz,
        dialect: config.dialect,
        arc_tolerance: config.arc_tolerance,
        rapid: config.rapid,
        top_feed: config.top_feed,
        corner_deviation: config.corner_deviation,
        spindle_counts: config.spindle_counts,
        equipment: config.equipment,
    }
}

/// A position on a machine with more axes than X, Y and Z.
pub const fn padded([x, y, z]: [Nm; 3]) -> [Nm; AXES] {
    [x, y, z, Nm(0), Nm(0), Nm(0)]
}

/// X, Y and Z of a position.
pub const fn three([x, y, z, ..]: [Nm; AXES]) -> [Nm; 3] {
    [x, y, z]
}

/// The output stages of the motors.
///
/// # Errors
///
/// A driver does not have the requested step mode.
pub fn motors(file: &MachineFile) -> Result<Motors<AXES, Drive>, String> {
    let drive = |axis: &AxisFile| match driver(axis.driver) {
        Some(driver) => Sequencer::new(driver, mode(axis.mode))
            .map(Drive::Coils)
            .map_err(|error| format!("{}: axis {}: {error}", file.path, char::from(axis.letter))),
        None if axis.driver == Driver::StepToggle => Ok(Drive::StepToggle(StepToggle::new())),
        None => Ok(Drive::StepDirection(StepDirection::new(
            axis.pulse.ticks(file.timer_hz),
        ))),
    };
    let mut drives = std::array::from_fn(|_| Drive::StepToggle(StepToggle::new()));
    for (entry, axis) in drives.iter_mut().zip(&file.axes) {
        *entry = drive(axis)?;
    }
    let ticks = |micros: u64| micros.saturating_mul(u64::from(file.timer_hz)) / 1_000_000;
    let idle = match file.idle {
        Idle::Hold => husillo_stepper::Idle::Hold,
        Idle::Reduced(after) => husillo_stepper::Idle::Reduced {
            after_ticks: ticks(after),
        },
        Idle::Off(after) => husillo_stepper::Idle::Off {
            after_ticks: ticks(after),
        },
    };
    Ok(Motors::new(drives, idle))
}

/// The simulated machine that these motors drive.
pub fn rig(file: &MachineFile, motors: &Motors<AXES, Drive>) -> Rig<AXES> {
    let models = file.each(AxisModel::step_toggle(), |axis| {
        let model = match driver(axis.driver) {
            Some(driver) => AxisModel::coils(driver, mode(axis.mode)),
            None if axis.driver == Driver::StepToggle => AxisModel::step_toggle(),
            None => AxisModel::step_direction(axis.pulse.ticks(file.timer_hz)),
        };
        let pull_out = axis.pull_out_ticks(file.timer_hz);
        model
            .with_backlash(axis.backlash_steps)
            .with_pull_out_ticks(pull_out)
    });
    Rig::new(models, *motors.levels())
}

/// The backlash of the screws of X, Y and Z, for a machine with more axes.
pub fn field(of_three: Arc<dyn BacklashField<3>>) -> Arc<dyn BacklashField<AXES>> {
    Arc::new(move |[x, y, z, ..]: [f64; AXES]| {
        let [x, y, z] = of_three.backlash_steps([x, y, z]);
        [x, y, z, 0.0, 0.0, 0.0]
    })
}

/// The motors of the report.
pub fn phases(file: &MachineFile) -> Vec<phases::Motor> {
    let motor = |axis: &AxisFile| {
        let name = format!("{:?}, {:?}", axis.driver, axis.mode).to_lowercase();
        phases::Motor::new(char::from(axis.letter), name, driver(axis.driver))
    };
    file.axes.iter().map(motor).collect()
}

/// The coil driver of an axis; `None` for both kinds of step and direction.
const fn driver(driver: Driver) -> Option<husillo_stepper::Driver> {
    match driver {
        Driver::Pbl3717a => Some(husillo_stepper::Driver::Pbl3717a),
        Driver::A3988 => Some(husillo_stepper::Driver::A3988),
        Driver::L297 => Some(husillo_stepper::Driver::L297),
        Driver::Unipolar => Some(husillo_stepper::Driver::Unipolar),
        Driver::StepDirection | Driver::StepToggle => None,
    }
}

const fn mode(mode: StepMode) -> Mode {
    match mode {
        StepMode::Wave => Mode::Wave,
        StepMode::Full => Mode::Full,
        StepMode::Half => Mode::Half,
        StepMode::Quarter => Mode::Quarter,
    }
}
