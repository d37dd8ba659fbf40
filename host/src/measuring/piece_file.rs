//! Files of simulated work pieces and of the probe that touches them.

use husillo_metrology::quantity::{self, Quantity};
use husillo_metrology::simulated::Piece;
use husillo_sim::{Bore, Place, PointMm, Shape, Solid, TouchProbe, TouchProbeModel, WorkPiece};
use husillo_simulator::diagnostics::Finding;
use husillo_simulator::machines::machine_file::LoadError;
use husillo_simulator::machines::table::{Table, document};

const LENGTH: &str = "a length as in \"8 mm\" or \"2 um\"";
const ANGLE: &str = "an angle as in \"3 deg\"";
const POINT: &str = "expected three lengths, as in [\"10 mm\", \"0 mm\", \"-5 mm\"]";

/// Loads a piece from the path of its file.
///
/// # Errors
///
/// The file cannot be read, or has mistakes.
pub fn load(path: &str) -> Result<Piece, LoadError> {
    let text = crate::input::read_to_string(path).map_err(|error| {
        LoadError::File(format!(
            "no work piece `{path}`: {error}; a file such as examples/piece.toml describes one"
        ))
    })?;
    parse(path, &text).map_err(LoadError::Findings)
}

/// The piece of `examples/piece.toml`.
///
/// # Errors
///
/// Never: a test reads the same file.
pub fn to_try() -> Result<Piece, LoadError> {
    const PATH: &str = "examples/piece.toml";
    parse(PATH, include_str!("../../examples/piece.toml")).map_err(LoadError::Findings)
}

fn parse(path: &str, text: &str) -> Result<Piece, Vec<Finding>> {
    let mut findings = Vec::new();
    let document = document(path, text)?;
    let (span, table) = (document.span(), document.get_ref());
    let mut root = Table::new(path, text, "the file", span, table, &mut findings);
    root.integer("schema", 1..=1);
    root.string("title");
    let solids = root.optional_tables("solid", read_solid);
    if solids.as_ref().is_none_or(Vec::is_empty) {
        root.missing("solid");
    }
    let solids = solids.into_iter().flatten().collect();
    let place = root.optional_table("place", read_place).unwrap_or_default();
    let probe = root.table("probe", read_probe);
    root.finish();
    match probe {
        Some(probe) if findings.is_empty() => Ok(Piece {
            work: WorkPiece { solids, place },
            probe,
        }),
        _ => Err(findings),
    }
}

#[derive(Clone, Copy)]
enum Kind {
    Box,
    Cylinder,
    Sphere,
    Plane,
}

fn read_solid(table: &mut Table<'_, '_>) -> Solid {
    let kinds = [
        ("box", Kind::Box),
        ("cylinder", Kind::Cylinder),
        ("sphere", Kind::Sphere),
        ("plane", Kind::Plane),
    ];
    let kind = table.choice("kind", &kinds);
    if kind.is_none() {
        table.missing("kind");
    }
    let shape = match kind.unwrap_or(Kind::Sphere) {
        Kind::Box => Shape::Box {
            from_mm: point(table, "from"),
            to_mm: point(table, "to"),
        },
        Kind::Cylinder => Shape::Cylinder {
            from_mm: point(table, "from"),
            to_mm: point(table, "to"),
            radius_mm: size(table, "radius"),
        },
        Kind::Sphere => Shape::Sphere {
            centre_mm: point(table, "centre"),
            radius_mm: size(table, "radius"),
        },
        Kind::Plane => Shape::Plane {
            point_mm: point(table, "point"),
            // Only the direction matters, not the length or the unit.
            outward: point(table, "outward"),
        },
    };
    let bores = table.optional_tables("bore", |bore| Bore {
        from_mm: point(bore, "from"),
        to_mm: point(bore, "to"),
        radius_mm: size(bore, "radius"),
    });
    Solid {
        shape,
        bores: bores.unwrap_or_default(),
    }
}

/// Reads where the drawing lies, and how it is turned about Z and tilted about X.
fn read_place(table: &mut Table<'_, '_>) -> Place {
    let at_mm = point(table, "at");
    let degrees = |quantity| match quantity {
        Quantity::Angle(deg) => Some(deg.num as f64 / deg.den as f64),
        _ => None,
    };
    let angles = ["turn", "tilt"].map(|key| table.quantity(key, ANGLE, degrees));
    let [turn_deg, tilt_deg] = angles.map(Option::unwrap_or_default);
    Place::new(at_mm, turn_deg, tilt_deg)
}

fn read_probe(table: &mut Table<'_, '_>) -> TouchProbe {
    let model = TouchProbeModel {
        ball_radius_mm: size(table, "ball_radius"),
        bend_mm: length(table, "bend").unwrap_or_default(),
        lobes_mm: length(table, "lobes").unwrap_or_default(),
        axial_mm: length(table, "axial").unwrap_or_default(),
        noise_mm: length(table, "noise").unwrap_or_default(),
    };
    let seed = table.integer("seed", 0..=i64::MAX).unwrap_or(1);
    // The range excludes negative numbers.
    TouchProbe::new(model, seed as u64)
}

/// Reads a required length above 0, mm.
fn size(table: &mut Table<'_, '_>, key: &'static str) -> f64 {
    let found = length(table, key);
    if found.is_none() {
        table.missing(key);
    }
    if let (Some(0.0), Some((_, span))) = (found, table.value(key)) {
        table.wrong(
            span,
            &format!("`{key}` does not fit"),
            "expected more than 0",
        );
    }
    found.unwrap_or(1.0)
}

/// Reads a length of at least 0, mm.
fn length(table: &mut Table<'_, '_>, key: &'static str) -> Option<f64> {
    table.quantity(key, LENGTH, |quantity| mm(quantity).filter(|mm| *mm >= 0.0))
}

fn mm(quantity: Quantity) -> Option<f64> {
    match quantity {
        Quantity::Length(nm) => Some(nm.num as f64 / nm.den as f64 / 1e6),
        _ => None,
    }
}

/// Reads a required point, mm.
fn point(table: &mut Table<'_, '_>, key: &'static str) -> PointMm {
    let Some((value, span)) = table.value(key) else {
        table.missing(key);
        return [0.0; 3];
    };
    let parts: Option<Vec<f64>> = value.as_array().and_then(|parts| {
        let part = |text: &str| mm(quantity::parse(text).ok()?);
        parts
            .iter()
            .map(|one| part(one.get_ref().as_str()?))
            .collect()
    });
    let point = parts.and_then(|parts| PointMm::try_from(parts).ok());
    if point.is_none() {
        table.wrong(span, &format!("`{key}` is not understood"), POINT);
    }
    point.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXAMPLE: &str = include_str!("../../examples/piece.toml");

    #[test]
    fn the_example_is_read() {
        let piece = parse("piece.toml", EXAMPLE).unwrap();
        assert_eq!(piece.work.solids.len(), 3);
        // The top of the block, the middle of its bore, the top of the reference sphere.
        assert_eq!(piece.work.distance_mm([12.0, 12.0, -19.0]), 1.0);
        assert_eq!(piece.work.distance_mm([30.0, 30.0, -22.0]), 8.0);
        assert_eq!(piece.work.distance_mm([-25.0, 25.0, -8.0]), 2.0);
        assert_eq!(piece.probe.model().ball_radius_mm, 1.0);
    }

    #[test]
    fn a_place_moves_and_turns_the_piece() {
        let place = "[place]\nat = [\"100 mm\", \"0 mm\", \"0 mm\"]\nturn = \"90 deg\"\n\n[probe]";
        let piece = parse("piece.toml", &EXAMPLE.replacen("[probe]", place, 1)).unwrap();
        // The point at X 30, Y 12 of the drawing is at X 100 - 12, Y 30.
        assert!((piece.work.distance_mm([88.0, 30.0, -19.0]) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn mistakes_are_named() {
        let fails = |from: &str, to: &str, message: &str| {
            let findings = parse("piece.toml", &EXAMPLE.replacen(from, to, 1)).unwrap_err();
            assert_eq!(findings[0].message, message);
        };
        fails("\"sphere\"", "\"ball\"", "unknown kind `ball`");
        fails(
            "radius = \"8 mm\"",
            "radius = \"-8 mm\"",
            "`radius` does not fit",
        );
        fails(
            "noise = \"0.5 um\"",
            "noise = 3",
            "`noise` is not understood: a quantity is text with a unit",
        );
        fails(
            "[probe]",
            "[place]\nat = [\"1 mm\", \"1 mm\", \"1 mm\"]\nturn = \"1 mm\"\n[probe]",
            "`turn` does not fit",
        );
        fails(
            "from = [\"10 mm\", ",
            "from = [",
            "`from` is not understood",
        );
    }
}
