//! Machine files of measuring machines.

use super::{calibration_file, motor_file};
use husillo_metrology::Scale;
use husillo_metrology::heads::{
    AxisSettings, End, Errors, Machine, PRE_TRAVEL_ENTRIES, ProbeSettings, Switches, Wiring,
    pre_travel_by_sign,
};
use husillo_metrology::quantity::{self, Quantity};
use husillo_probe::{PreTravel, Tip, UnitVector};
use husillo_sim::text::counted;
use husillo_simulator::diagnostics::Finding;
use husillo_simulator::machines::machine_file::{LoadError, MEASURING, read_text};
use husillo_simulator::machines::table::{Table, document};
use husillo_transports::nmc::{Baud, Gains, LAST_ADDRESS};
use toml::de::DeValue;

/// Loads a measuring machine by its name or the path of its file.
///
/// # Errors
///
/// The file cannot be read, or has mistakes.
pub fn load(name: &str) -> Result<Machine, LoadError> {
    match MEASURING.iter().find(|(known, ..)| *known == name) {
        Some((_, path, text)) => parse(path, text),
        None => parse(
            name,
            &read_text(
                name,
                "measuring machine",
                "cmm and cmm3",
                crate::input::read_to_string,
            )?,
        ),
    }
    .map_err(LoadError::Findings)
}

/// Reads the text of a machine file.
///
/// # Errors
///
/// All mistakes of the text.
pub fn parse(path: &str, text: &str) -> Result<Machine, Vec<Finding>> {
    let mut findings = Vec::new();
    let document = document(path, text)?;
    let (span, table) = (document.span(), document.get_ref());
    let mut root = Table::new(path, text, "the file", span, table, &mut findings);
    root.integer("schema", 1..=1);
    let name = root.name();
    let title = root.string("title").unwrap_or(name);
    if root.choice("kind", &[("cmm", ())]).is_none() {
        root.missing("kind");
    }
    let scale = Scale::new(
        root.quantity("count", "a length as in \"2 um\"", |q| match q {
            Quantity::Length(length) if length.num > 0 => Some(length),
            _ => None,
        }),
    );
    let mut errors = Errors::default();
    let [x_errors, y_errors, z_errors] = &mut errors.axes;
    let mut axes = root.table("axis", |axes| {
        let mut taken = Vec::new();
        let mut read = |axis: &mut Table<'_, '_>, letter, errors: &mut _| {
            *errors = calibration_file::read_axis(axis, scale);
            let read = read_axis(axis, letter, scale);
            // 0 stands for a missing module, which is reported separately.
            let is_taken = read.module > 0 && taken.contains(&read.module);
            if let (true, Some((_, span))) = (is_taken, axis.value("module")) {
                let message = format!("module {} belongs to another axis", read.module);
                axis.wrong(span, &message, "each axis needs its own address");
            }
            taken.push(read.module);
            read
        };
        let x = axes.table("x", |axis| read(axis, 'X', x_errors));
        let y = axes.optional_table("y", |axis| read(axis, 'Y', y_errors));
        let z = axes.optional_table("z", |axis| read(axis, 'Z', z_errors));
        [x, y, z].into_iter().flatten().collect::<Vec<_>>()
    });
    let probe = root.table("probe", |probe| {
        let read = read_probe(probe, scale);
        let count = axes.as_deref().map_or(0, <[AxisSettings]>::len);
        if let (Switches::PerSense, 2.., Some((_, span))) =
            (read.switches, count, probe.value("switches"))
        {
            let message = "two contacts have the two senses of one axis";
            probe.wrong(
                span,
                message,
                &format!("this machine has {}", counted(count, "axis")),
            );
        }
        check_limits(probe, read.switches, axes.as_deref().unwrap_or_default());
        check_braking(probe, &read, axes.as_deref().unwrap_or_default(), scale);
        read
    });
    let baud = root.table("link", read_link);
    if let (Some(axes), Some(Switches::PerSense)) = (&mut axes, probe.map(|probe| probe.switches)) {
        axes.iter_mut()
            .for_each(|axis| axis.limits = [Wiring::Probe; 2]);
    }
    let letters: &[AxisSettings] = axes.as_deref().unwrap_or_default();
    let letters: String = letters.iter().map(|axis| axis.letter).collect();
    errors.squareness = calibration_file::read_squareness(&mut root, &letters);
    root.finish();
    match (axes, probe, baud) {
        (Some(axes), Some(probe), Some(baud)) if findings.is_empty() => Ok(Machine {
            title,
            scale,
            axes,
            probe,
            baud,
            errors,
        }),
        _ => Err(findings),
    }
}

fn read_axis(table: &mut Table<'_, '_>, letter: char, scale: Scale) -> AxisSettings {
    let module = small(table, "module", 1..=i64::from(LAST_ADDRESS), None);
    let gains = table.table("gains", |gains| Gains {
        proportional: small(gains, "p", 0..=0x7fff, None),
        integral: small(gains, "i", 0..=0x7fff, None),
        derivative: small(gains, "d", 0..=0x7fff, None),
        integration_limit: small(gains, "integral_limit", 0..=0x7fff, Some(0)),
        output_limit: small(gains, "output_limit", 0..=255, Some(255)),
        current_limit: small(gains, "current_limit", 0..=255, Some(0)),
        error_limit: small(gains, "error_limit", 1..=0x3fff, None),
        rate_divisor: small(gains, "rate_divisor", 1..=255, Some(1)),
        dead_band: small(gains, "dead_band", 0..=255, Some(0)),
        step_multiplier: None,
    });
    AxisSettings {
        letter,
        module,
        travel: travel(table, scale),
        in_position: length(table, "in_position", scale),
        rate: rate(table, "rate", scale),
        acceleration: needed(table, "acceleration", "as in \"6000 counts/s^2\"", |q| {
            scale.acceleration(q)
        }),
        limits: read_limits(table),
        gains: gains.unwrap_or_default(),
        motor: motor_file::read(table),
    }
}

/// Reads what the limit inputs of the module of an axis are wired to.
fn read_limits(table: &mut Table<'_, '_>) -> [Wiring; 2] {
    let choices = [
        ("probe", Wiring::Probe),
        ("end-low", Wiring::End(End::Low)),
        ("end-high", Wiring::End(End::High)),
        ("ends", Wiring::Ends),
        ("none", Wiring::Nothing),
    ];
    let first = table.choice("limit_1", &choices).unwrap_or(Wiring::Probe);
    if let (true, Some((_, span))) = (first != Wiring::Probe, table.value("limit_1")) {
        let message = "the probe is wired to limit 1 of every module";
        table.wrong(span, message, "an end switch belongs to `limit_2`");
    }
    let second = table.choice("limit_2", &choices).unwrap_or_default();
    [first, second]
}

/// Checks that limit input 2 has no use that the contacts of the probe exclude.
fn check_limits(probe: &mut Table<'_, '_>, switches: Switches, axes: &[AxisSettings]) {
    let has = |is_it: fn(&Wiring) -> bool| axes.iter().any(|axis| is_it(&axis.limits[1]));
    match switches {
        Switches::One if has(|wiring| *wiring == Wiring::Probe) => {
            let Some((_, span)) = probe.value("switches") else {
                return probe.missing("switches");
            };
            let message = "a single contact is at limit 1";
            probe.wrong(span, message, "`limit_2` of an axis is wired to the probe");
        }
        Switches::PerSense if has(|wiring| matches!(wiring, Wiring::End(_) | Wiring::Ends)) => {
            if let Some((_, span)) = probe.value("switches") {
                let message = "the second contact of the probe is at limit 2";
                probe.wrong(
                    span,
                    message,
                    "`limit_2` of an axis is wired to an end switch",
                );
            }
        }
        Switches::One | Switches::PerSense => {}
    }
}

fn read_probe(table: &mut Table<'_, '_>, scale: Scale) -> ProbeSettings {
    ProbeSettings {
        rate: rate(table, "rate", scale),
        slow_rate: rate(table, "slow_rate", scale),
        back_off: length(table, "back_off", scale),
        over_travel: length(table, "over_travel", scale),
        switches: table
            .choice(
                "switches",
                &[("one", Switches::One), ("per-sense", Switches::PerSense)],
            )
            .unwrap_or_default(),
        stylus: Tip {
            radius_nm: short(table, "ball_radius", scale),
            pre_travel: read_pre_travel(table, scale),
        },
    }
}

/// Checks that a search can brake within the over-travel on every axis: `v^2 / 2a`.
fn check_braking(
    table: &mut Table<'_, '_>,
    probe: &ProbeSettings,
    axes: &[AxisSettings],
    scale: Scale,
) {
    // 0 stands for a missing acceleration, which is reported separately.
    let known = axes.iter().filter(|axis| axis.acceleration > 0);
    let distances = known.map(|axis| {
        // The square of 32 bits fits 64 bits. The distance is rounded up.
        let rate = u64::from(probe.rate.min(axis.rate));
        (rate * rate).div_ceil(2 * u64::from(axis.acceleration))
    });
    let most = distances.max().unwrap_or_default();
    if probe.over_travel == 0 || most <= u64::from(probe.over_travel) {
        return;
    }
    if let Some((_, span)) = table.value("over_travel") {
        let distance = scale.text(scale.of_counts(i64::try_from(most).unwrap_or(i64::MAX)));
        let label = format!("a search at `rate` needs {distance} to brake: v^2 / 2a");
        table.wrong(span, "`over_travel` is too short", &label);
    }
}

/// Reads the pre-travel: one length for the positive and one for the negative direction of every
/// axis, or a list by direction.
fn read_pre_travel(table: &mut Table<'_, '_>, scale: Scale) -> PreTravel<PRE_TRAVEL_ENTRIES> {
    let is_list = |table: &mut Table<'_, '_>| {
        let value = table.value("pre_travel");
        value.is_some_and(|(value, _)| value.as_array().is_some())
    };
    if !is_list(table) {
        let both = table.optional_table("pre_travel", |table| {
            [
                short(table, "positive", scale),
                short(table, "negative", scale),
            ]
        });
        return pre_travel_by_sign(both.unwrap_or_default());
    }
    let entries = table.optional_tables("pre_travel", |entry| {
        let direction = entry.value("direction").and_then(|(value, span)| {
            let parts = value.as_array().filter(|parts| parts.len() == 3);
            let parts = parts.and_then(|parts| {
                let number = |part: &DeValue<'_>| part.as_integer()?.to_string().parse().ok();
                let parts: Option<Vec<i64>> =
                    parts.iter().map(|part| number(part.get_ref())).collect();
                UnitVector::new(parts?.try_into().ok()?)
            });
            if parts.is_none() {
                entry.wrong(
                    span,
                    "`direction` is not understood",
                    "expected whole numbers as in [0, 0, -1]",
                );
            }
            parts
        });
        if direction.is_none() {
            entry.missing("direction");
        }
        Some((direction?, short(entry, "length", scale)))
    });
    let entries: Vec<_> = entries.into_iter().flatten().flatten().collect();
    PreTravel::of(&entries).unwrap_or_else(|| {
        if let Some((_, span)) = table.value("pre_travel") {
            table.wrong(
                span,
                "too many entries",
                &format!("at most {PRE_TRAVEL_ENTRIES}"),
            );
        }
        pre_travel_by_sign([0; 2])
    })
}

/// Reads a short length as an amount of the scale. A missing one is 0.
fn short(table: &mut Table<'_, '_>, key: &'static str, scale: Scale) -> i32 {
    let amount = table.quantity(key, LENGTH, |quantity| {
        i32::try_from(scale.amount(quantity)?).ok()
    });
    amount.unwrap_or_default()
}

fn read_link(table: &mut Table<'_, '_>) -> Baud {
    table.choice("protocol", &[("picservo-nmc", ())]);
    let bits_per_s = table.integer("baud", 9600..=230_400);
    let baud = bits_per_s.and_then(|bits_per_s| {
        let mut rates = Baud::ALL.into_iter();
        rates.find(|baud| i64::from(baud.bits_per_s()) == bits_per_s)
    });
    if let (Some(_), None, Some((_, span))) = (bits_per_s, baud, table.value("baud")) {
        let label = "one of 9600, 19200, 57600, 115200, 230400";
        table.wrong(span, "these modules do not have this rate", label);
    }
    baud.unwrap_or_default()
}

const LENGTH: &str = "a length as in \"60 counts\", or \"0.12 mm\" if the file has a `count`";

/// Reads a length above 0, counts.
fn length(table: &mut Table<'_, '_>, key: &'static str, scale: Scale) -> u32 {
    needed(table, key, LENGTH, |quantity| {
        let counts = u32::try_from(scale.counts(quantity)?).ok();
        counts.filter(|counts| *counts > 0)
    })
}

/// Reads a speed, counts/s.
fn rate(table: &mut Table<'_, '_>, key: &'static str, scale: Scale) -> u32 {
    let form = "a speed as in \"1200 counts/s\", or \"2.4 mm/s\" if the file has a `count`";
    needed(table, key, form, |quantity| scale.rate(quantity))
}

/// Reads a required quantity.
fn needed<T: Default>(
    table: &mut Table<'_, '_>,
    key: &'static str,
    form: &str,
    accept: impl Fn(Quantity) -> Option<T>,
) -> T {
    let value = table.quantity(key, form, accept);
    if value.is_none() {
        table.missing(key);
    }
    value.unwrap_or_default()
}

/// Reads a small integer. It is required if it has no default.
fn small<T: TryFrom<i64> + Default>(
    table: &mut Table<'_, '_>,
    key: &'static str,
    range: std::ops::RangeInclusive<i64>,
    default: Option<T>,
) -> T {
    let value = table.integer(key, range);
    if value.is_none() && default.is_none() {
        table.missing(key);
    }
    let value = value.and_then(|value| T::try_from(value).ok());
    value.or(default).unwrap_or_default()
}

/// Reads `["-8000 counts", "8000 counts"]`.
fn travel(table: &mut Table<'_, '_>, scale: Scale) -> [i32; 2] {
    let Some((value, span)) = table.value("travel") else {
        table.missing("travel");
        return [0, 0];
    };
    let ends: Option<Vec<i32>> = value.as_array().and_then(|ends| {
        let counts = |text: &str| scale.counts(quantity::parse(text).ok()?);
        ends.iter()
            .map(|end| counts(end.get_ref().as_str()?))
            .collect()
    });
    match ends.as_deref() {
        Some(&[low, high]) if low < high => [low, high],
        _ => {
            let label =
                "expected [\"-8000 counts\", \"8000 counts\"], or mm if the file has a `count`";
            table.wrong(span, "travel is not understood", label);
            [0, 0]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use husillo_metrology::simulated::DcMotorModel;

    const CMM: &str = MEASURING[0].2;
    const CMM3: &str = MEASURING[1].2;

    /// The tests of the library run on the same simulated machines as the program.
    #[test]
    fn the_machines_of_the_library_equal_those_of_the_files() {
        use husillo_metrology::simulated::{one_axis, three_axes};
        assert_eq!(load("cmm").unwrap(), one_axis());
        assert_eq!(load("cmm3").unwrap(), three_axes());
    }

    #[test]
    fn built_in_machines_are_read() {
        let one = load("cmm").unwrap();
        assert_eq!((one.axes.len(), one.scale.unit()), (1, "counts"));
        assert_eq!(one.axes[0].travel, [-8000, 8000]);
        let three = load("cmm3").unwrap();
        assert_eq!((three.modules(), three.scale.unit()), (3, "mm"));
        assert_eq!(
            (three.axes[2].rate, three.axes[2].acceleration),
            (1200, 6000)
        );
        assert_eq!((three.probe.back_off, three.baud), (60, Baud::B115200));
    }

    #[test]
    fn two_axes_on_one_module_and_a_search_that_cannot_brake_are_refused() {
        let text = CMM3.replacen("module = 2", "module = 1", 1);
        let findings = parse("mine.toml", &text).unwrap_err();
        assert_eq!(findings.len(), 1);
        assert_eq!(findings[0].message, "module 1 belongs to another axis");
        // 200 counts/s and 6000 counts/s^2: 3.3 counts.
        for (over_travel, is_enough) in [("4 counts", true), ("3 counts", false)] {
            let text = CMM.replacen("\"100 counts\"", &format!("\"{over_travel}\""), 1);
            let read = parse("mine.toml", &text);
            assert_eq!(read.is_ok(), is_enough);
            for finding in read.err().unwrap_or_default() {
                assert_eq!(finding.message, "`over_travel` is too short");
            }
        }
    }

    #[test]
    fn a_motor_is_that_of_the_prototype_where_nothing_else_is_said() {
        let prototype = load("cmm").unwrap().motor(1);
        assert_eq!(prototype, DcMotorModel::PROTOTYPE);
        let text = "[axis.x.motor]\nsupply_v = 24\ninductance_mh = 1.5\n\
                    counts_per_revolution = 8000\n[probe]";
        let text = CMM.replacen("[probe]", text, 1);
        let motor = parse("mine.toml", &text).unwrap().motor(1);
        assert_eq!(
            motor,
            DcMotorModel {
                supply_v: 24.0,
                inductance_h: 1.5e-3,
                counts_per_revolution: 8000,
                ..DcMotorModel::PROTOTYPE
            }
        );
    }

    #[test]
    fn a_probe_has_two_contacts_on_a_single_axis_only() {
        let with = |text: &str| text.replacen("[probe]", "[probe]\nswitches = \"per-sense\"", 1);
        let prototype = parse("mine.toml", &with(CMM)).unwrap();
        assert_eq!(prototype.probe.switches, Switches::PerSense);
        assert_eq!(load("cmm").unwrap().probe.switches, Switches::One);
        let findings = parse("mine.toml", &with(CMM3)).unwrap_err();
        let message = "two contacts have the two senses of one axis";
        assert_eq!(findings[0].message, message);
    }

    #[test]
    fn limit_2_is_wired_to_an_end_switch_where_the_file_says_so() {
        let with = |line: &str, text: &str| {
            text.replacen("in_position", &format!("{line}\nin_position"), 1)
        };
        assert_eq!(load("cmm3").unwrap().axes[0].end(), None);
        for (name, end) in [("end-low", End::Low), ("end-high", End::High)] {
            let text = with(&format!("limit_2 = \"{name}\""), CMM3);
            let machine = parse("mine.toml", &text).unwrap();
            assert_eq!(machine.axes[0].end(), Some(end));
            assert_eq!(machine.axes[1].end(), None);
        }
        let both = parse("mine.toml", &with("limit_2 = \"ends\"", CMM3)).unwrap();
        assert_eq!(both.axes[0].limits, [Wiring::Probe, Wiring::Ends]);
        let double = CMM.replacen("[probe]", "[probe]\nswitches = \"per-sense\"", 1);
        assert_eq!(
            parse("mine.toml", &double).unwrap().axes[0].limits,
            [Wiring::Probe; 2]
        );
        for (text, message) in [
            (
                with("limit_1 = \"end-low\"", CMM),
                "the probe is wired to limit 1 of every module",
            ),
            (with("limit_2 = \"end\"", CMM), "unknown limit_2 `end`"),
            (
                with("limit_2 = \"probe\"", CMM),
                "missing key `switches` in [probe]",
            ),
            (
                with("limit_2 = \"end-low\"", &double),
                "the second contact of the probe is at limit 2",
            ),
        ] {
            let findings = parse("mine.toml", &text).unwrap_err();
            assert_eq!(findings[0].message, message);
        }
    }

    #[test]
    fn wrong_constants_of_a_motor_are_named() {
        for (line, message) in [
            ("inertia_kg_m2 = 0", "`inertia_kg_m2` is out of range"),
            (
                "counts_per_revolution = 0",
                "`counts_per_revolution` is out of range",
            ),
            (
                "coulomb_nm = 1.0",
                "the friction is larger than the breakaway torque",
            ),
            ("weight = 1", "unknown key `weight` in [axis.x.motor]"),
        ] {
            let text = format!("[axis.x.motor]\n{line}\n[probe]");
            let text = CMM.replacen("[probe]", &text, 1);
            let findings = parse("mine.toml", &text).unwrap_err();
            assert_eq!(findings[0].message, message, "{line}");
        }
    }

    #[test]
    fn a_length_in_mm_needs_a_scale() {
        let text = CMM.replacen("\"60 counts\"", "\"0.1 mm\"", 1);
        let findings = parse("mine.toml", &text).unwrap_err();
        assert_eq!(findings[0].message, "`back_off` does not fit");
        assert_eq!(findings.len(), 1);
    }
}
