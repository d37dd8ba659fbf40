//! `[backlash_map]` and `[simulated_backlash]` of machine files.

use crate::machines::table::Table;
use husillo_metrology::calibration::backlash::{BacklashTable, Map};
use husillo_metrology::quantity::Fraction;
use husillo_sim::BacklashField;
use husillo_sim::text::shortest;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::ops::Range;
use std::sync::Arc;
use toml::de::DeValue;

/// The text of the table of an axis in a machine file.
pub fn section(table: &BacklashTable, letter: u8) -> String {
    let list = |values: &[f64]| {
        let texts = values.iter().map(|value| shortest(*value, 2));
        format!("[{}]", texts.collect::<Vec<_>>().join(", "))
    };
    let mut text = format!(
        "[backlash_map.{}]\n",
        char::from(letter).to_ascii_lowercase()
    );
    let mut is_grid = true;
    for (index, positions) in table.positions_mm.iter().enumerate() {
        if index == 1 && table.axes[0] == table.axes[1] {
            is_grid = false;
            break;
        }
        let name = char::from(b"xyz"[table.axes[index]]);
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{name}_mm = {}", list(positions));
    }
    if is_grid {
        text.push_str("um = [\n");
        for row in table.backlash_um.chunks(table.positions_mm[0].len()) {
            let _ = writeln!(text, "    {},", list(row));
        }
        text.push_str("]\n");
    } else {
        let _ = writeln!(text, "um = {}", list(&table.backlash_um));
    }
    text
}

/// Backlash of a simulated screw: `mean + swing sin(2 pi own / sine) cos(2 pi other / cosine)` over
/// the positions of X and Y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Mean, um.
    pub mean_um: f64,
    /// Amplitude around the mean, um.
    pub swing_um: f64,
    /// Period along the own axis, mm.
    pub sine_mm: f64,
    /// Period along the other axis, mm.
    pub cosine_mm: f64,
}

impl Wave {
    /// Backlash in um at a position in mm.
    pub fn backlash_um(&self, own_mm: f64, other_mm: f64) -> f64 {
        let (sine, cosine) = (TAU * own_mm / self.sine_mm, TAU * other_mm / self.cosine_mm);
        self.mean_um + self.swing_um * sine.sin() * cosine.cos()
    }

    fn read(table: &mut Table<'_, '_>) -> Option<Wave> {
        // Reads all keys before it returns: an unread key would be reported as unknown.
        let mean_um = table.required_number("mean_um", 0.0..=1e4);
        let swing_um = table.required_number("swing_um", 0.0..=1e3);
        let sine_mm = table.required_number("sine_mm", 0.1..=1e5);
        let cosine_mm = table.required_number("cosine_mm", 0.1..=1e5);
        Some(Wave {
            mean_um: mean_um?,
            swing_um: swing_um?,
            sine_mm: sine_mm?,
            cosine_mm: cosine_mm?,
        })
    }
}

/// Former names of the two tables, each with the present one.
const FORMER_NAMES: [(&str, &str); 2] = [
    ("lash", "backlash_map"),
    ("simulated_lash", "simulated_backlash"),
];

/// Backlash by position in a machine file.
#[derive(Clone, Debug, Default)]
pub struct BacklashFile {
    /// The backlash that the controller takes up on X, Y and Z, if it depends on the position.
    pub maps: [Option<Map>; 3],
    /// The backlash of the simulated screws of X and Y, if the file describes them.
    pub simulated: Option<[Wave; 2]>,
}

impl BacklashFile {
    /// Reads both tables of the file.
    pub fn read(root: &mut Table<'_, '_>, steps: [Fraction; 3]) -> BacklashFile {
        let names = ["x", "y", "z"];
        let tables = root.optional_table("backlash_map", |backlash| {
            names.map(|name| backlash.optional_table(name, read_positions).flatten())
        });
        let simulated = root.optional_table("simulated_backlash", |table| {
            let x = table.table("x", Wave::read).flatten();
            let y = table.table("y", Wave::read).flatten();
            Some([x?, y?])
        });
        for (old, new) in FORMER_NAMES {
            if let Some((_, span)) = root.value(old) {
                let message = format!("`{old}` is now called `{new}`");
                root.wrong(span, &message, &format!("write `{new}`"));
            }
        }
        let mut file = BacklashFile {
            simulated: simulated.flatten(),
            ..BacklashFile::default()
        };
        let tables = tables.into_iter().flatten();
        for ((axis, table), own) in file.maps.iter_mut().zip(tables).zip(steps) {
            if let Some((table, span)) = table {
                match table.map(own, steps) {
                    Ok(map) => *axis = Some(map),
                    Err(why) => root.wrong(span, "the backlash map is invalid", &why.to_string()),
                }
            }
        }
        file
    }

    /// The backlash of the simulated screws, in steps.
    pub fn field(&self, steps: [Fraction; 3]) -> Option<Arc<dyn BacklashField<3>>> {
        let [wave_x, wave_y] = self.simulated?;
        let [x_nm, y_nm, _] = steps.map(|step| step.num as f64 / step.den as f64);
        Some(Arc::new(move |[x, y, _]: [f64; 3]| {
            let (x, y) = (x * x_nm / 1e6, y * y_nm / 1e6);
            [
                wave_x.backlash_um(x, y) * 1e3 / x_nm,
                wave_y.backlash_um(y, x) * 1e3 / y_nm,
                0.0,
            ]
        }))
    }
}

/// Reads a list of numbers.
fn numbers(value: &DeValue<'_>) -> Option<Vec<f64>> {
    let number = |value: &DeValue<'_>| -> Option<f64> {
        let text = match (value.as_float(), value.as_integer()) {
            (Some(float), _) => float.as_str(),
            (_, Some(integer)) => integer.as_str(),
            _ => return None,
        };
        text.parse().ok().filter(|number: &f64| number.is_finite())
    };
    value
        .as_array()?
        .iter()
        .map(|item| number(item.get_ref()))
        .collect()
}

fn read_positions(table: &mut Table<'_, '_>) -> Option<(BacklashTable, Range<usize>)> {
    let mut along = Vec::new();
    let mut is_wrong = false;
    for (axis, key) in ["x_mm", "y_mm", "z_mm"].into_iter().enumerate() {
        if let Some((value, span)) = table.value(key) {
            match numbers(value) {
                Some(positions) => along.push((axis, positions)),
                None => {
                    table.wrong(
                        span,
                        &format!("`{key}` is not a list of numbers"),
                        "expected positions in mm",
                    );
                    is_wrong = true;
                }
            }
        }
    }
    let Some((value, span)) = table.value("um") else {
        table.missing("um");
        return None;
    };
    if is_wrong {
        return None;
    }
    // A list, or a list of lists.
    let rows = value.as_array().and_then(|rows| {
        let rows = rows.iter().map(|row| numbers(row.get_ref()));
        rows.collect::<Option<Vec<_>>>()
    });
    let found = match (along.as_slice(), numbers(value), rows) {
        ([(axis, positions)], Some(backlash_um), _) => Some(BacklashTable {
            axes: [*axis; 2],
            positions_mm: [positions.clone(), vec![0.0]],
            backlash_um,
        }),
        ([(first, across), (second, up)], _, Some(rows))
            if rows.len() == up.len() && rows.iter().all(|row| row.len() == across.len()) =>
        {
            Some(BacklashTable {
                axes: [*first, *second],
                positions_mm: [across.clone(), up.clone()],
                backlash_um: rows.concat(),
            })
        }
        _ => None,
    };
    if found.is_none() {
        let form = "positions along one axis need a list of values, along two a list of lists: one \
             for every position of the second";
        table.wrong(
            span.clone(),
            "`um` needs one number for every position",
            form,
        );
    }
    Some((found?, span))
}

#[cfg(test)]
mod tests {
    use crate::machines::machine_file::MachineFile;

    const MICROMILL: &str = include_str!("../../machines/micromill.toml");

    #[test]
    fn bands_and_grids_become_maps() {
        let text = format!(
            "{MICROMILL}\n[backlash_map.x]\ny_mm = [1.2, 3.5, 5.8]\num = [190, 201, 187]\n\
             [backlash_map.y]\nx_mm = [0, 10]\ny_mm = [0, 7]\num = [[178, 178], [178, 164]]\n"
        );
        let file = MachineFile::parse("mine.toml", &text).unwrap();
        let [x, y, z] = file.backlash.maps;
        let x = x.unwrap();
        // 201 um, and halfway to 187 um.
        assert_eq!(x.steps([25_000, 0]), 1436);
        assert_eq!(x.steps([33_214, 0]), 1386);
        let y = y.unwrap();
        assert_eq!(y.steps([0, 0]), 1271);
        assert_eq!(y.steps([71_429, 50_000]), 1171);
        assert!(z.is_none());
    }

    #[test]
    fn former_names_are_refused_with_the_present_ones() {
        let text = MICROMILL.replace("[simulated_backlash.", "[simulated_lash.");
        let text = format!("{text}\n[lash.x]\ny_mm = [1, 2]\num = [190, 190]\n");
        let findings = MachineFile::parse("mine.toml", &text).unwrap_err();
        let messages: Vec<_> = findings
            .iter()
            .map(|finding| &finding.message[..])
            .collect();
        let wanted = [
            "`lash` is now called `backlash_map`",
            "`simulated_lash` is now called `simulated_backlash`",
        ];
        assert_eq!(messages, wanted);
    }

    #[test]
    fn mistakes_are_reported() {
        let wrong = |section: &str| {
            let text = format!("{MICROMILL}\n{section}\n");
            let findings = MachineFile::parse("mine.toml", &text).unwrap_err();
            findings[0].message.clone()
        };
        assert!(wrong("[backlash_map.x]\ny_mm = [1, 2]\num = [190]").contains("map is invalid"));
        assert!(
            wrong("[backlash_map.x]\ny_mm = [1, 2]\nx_mm = [0]\num = [190, 2]")
                .contains("every position")
        );
        assert!(
            wrong("[backlash_map.x]\ny_mm = [2, 1]\num = [190, 190]").contains("map is invalid")
        );
        assert!(
            wrong("[backlash_map.x]\ny_mm = [1, 1.1]\num = [100, 190]").contains("map is invalid")
        );
        assert!(
            wrong("[backlash_map.q]\ny_mm = [1, 1.1]\num = [100, 190]").contains("unknown key")
        );
        assert!(wrong("[backlash_map.x]\ny_mm = \"1\"\num = [100, 190]").contains("not a list"));
    }
}
