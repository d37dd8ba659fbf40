//! Tests of each kind of line, and properties.

use husillo_excellon::{
    Digits, Error, ErrorKind, Feature, Format, Inference, LIMIT_NM, Overrides, Path, Pattern,
    Reader, Repeat, Settings, Units, Warning, WarningKind, Zeros, lines,
};
use proptest::prelude::*;

/// Features, and errors with their lines.
type Outcome = (Vec<Feature>, Vec<(usize, Error)>, Vec<(usize, Warning)>);

fn settings(text: &[u8], overrides: &Overrides) -> Settings {
    let mut inference = Inference::new();
    for (_, line) in lines(text) {
        inference.observe(line);
    }
    inference.settle(overrides)
}

/// Reads a file and asserts that every error or warning lies inside its line.
fn read_with(text: &[u8], overrides: &Overrides) -> Outcome {
    let mut reader = Reader::<8>::new(&settings(text, overrides));
    let (mut features, mut errors, mut warnings) = (Vec::new(), Vec::new(), Vec::new());
    for (number, line) in lines(text) {
        match reader.read(line) {
            Ok(made) => {
                let count = made.len();
                let before = features.len();
                features.extend(made);
                assert_eq!(features.len(), before + count);
            }
            Err(error) => {
                assert!(
                    error.at <= error.end && error.end <= line.len(),
                    "{error:?}"
                );
                assert!(error.kind.code() > 100 && !error.to_string().is_empty());
                errors.push((number, error));
            }
        }
        if let Some(warning) = reader.warning() {
            assert!(warning.at <= warning.end && warning.end <= line.len());
            assert!(warning.kind.code() > 900 && !warning.to_string().is_empty());
            warnings.push((number, warning));
        }
    }
    (features, errors, warnings)
}

fn read(text: &str) -> Outcome {
    read_with(text.as_bytes(), &Overrides::default())
}

/// Returns the holes of a file without errors: x, y and diameter in um.
fn holes(text: &str) -> Vec<[i64; 3]> {
    let (features, errors, _) = read(text);
    assert_eq!(errors, [], "{text}");
    let of_hole = |feature: &Feature| match feature {
        Feature::Hole(hole) => {
            let diameter = hole.tool.diameter_nm.unwrap_or(0);
            Some([hole.at_nm[0], hole.at_nm[1], diameter].map(|nm| nm / 1000))
        }
        Feature::Slot(_) => None,
    };
    features.iter().filter_map(of_hole).collect()
}

/// A position in whole millimetres.
fn millimetres(at_nm: [i64; 2]) -> [i64; 2] {
    assert_eq!(at_nm.map(|nm| nm % 1_000_000), [0; 2]);
    at_nm.map(|nm| nm / 1_000_000)
}

fn kinds(text: &str) -> Vec<(usize, ErrorKind)> {
    let (_, errors, _) = read(text);
    errors
        .iter()
        .map(|(line, error)| (*line, error.kind))
        .collect()
}

#[test]
fn headers_and_tools() {
    let wanted = [[1000, 2000, 800]];
    for text in [
        "M48\nMETRIC,TZ\nT1C0.8\n%\nT1\nX1000Y2000\nM30",
        "M48\nM71,TZ\nT01F00S00C.8\nM95\nT1\nX1000Y2000",
        "METRIC\nT1C0.8F200S100\nX1000Y2000",
        "G90\nM71\nM48\nT0C0.8\n%\nG90\nM71\nM48\n%\nT0\nX+1000Y+2000\nM30",
        "%\nM48\nMETRIC,000.000\nT100C0.80\n%\nT100\n x 10 00 y2.0\nM30",
        "M48\nFMAT,2\nICI,OFF\nR,T\nVER,1\nMETRIC\nT1C0.8\n%\nG93X0Y0\nG05\nT1\nX1000Y2000M30",
        "M48\nMETRIC,LZ\nT1C0.8\n%\nT1\nX001Y002M30\n",
        ";T01 Holesize 1. = 0.8 Tolerance = +0.0/-0.0 PLATED MM Quantity = 1\n%\n\
         T01\nX1.0Y2.0\nM30",
        "; FORMAT={-:-/ absolute / metric / decimal}\nT1C0.8\n%\nT1\nX1.0Y2.0\nT0\nM30",
    ] {
        assert_eq!(holes(text), wanted, "{text}");
    }
}

#[test]
fn modal_incremental_and_repeated() {
    let head = "METRIC\nT1C1\nM95\nT1\n";
    for (body, points) in [
        ("X1.Y1.\nX2.\nY3.", vec![[1, 1], [2, 1], [2, 3]]),
        ("ICI,ON\nX1.Y1.\nX2.\nY-3.", vec![[1, 1], [3, 1], [3, -2]]),
        ("G91\nX1.Y1.\nG90\nX1.\n", vec![[1, 1], [1, 1]]),
        (
            "X1.Y1.\nR3X1.Y-1.\nX1.",
            vec![[1, 1], [2, 0], [3, -1], [4, -2], [1, -2]],
        ),
        ("X1.Y1.\nR2\n", vec![[1, 1], [1, 1], [1, 1]]),
    ] {
        let found: Vec<_> = holes(&format!("{head}{body}"))
            .iter()
            .map(|hole| [hole[0] / 1000, hole[1] / 1000])
            .collect();
        assert_eq!(found, points, "{body}");
    }
}

#[test]
fn units_may_change_and_the_usual_digits_with_them() {
    let text = "M48\nINCH,TZ\nT1C0.1\n%\nT1\nX10000Y0\nM71\nX25400\nM72\nX1.0";
    assert_eq!(
        holes(text),
        [[25_400, 0, 2_540], [25_400, 0, 2_540], [25_400, 0, 2_540]]
    );
    let overrides = Overrides {
        units: Some(Units::Inches),
        zeros: Some(Zeros::Leading),
        digits: Digits::new(1, 3),
        ..Overrides::default()
    };
    let (features, errors, _) = read_with(b"METRIC,TZ,000.000\nT1C0.1\nX1Y02", &overrides);
    assert_eq!(errors, []);
    let Feature::Hole(hole) = features[0] else {
        panic!("a slot")
    };
    assert_eq!(hole.at_nm, [25_400_000, 5_080_000]);
}

#[test]
fn slots_and_routs() {
    let (features, errors, _) = read(
        "METRIC\nT1C1\nX1.Y1.G85X4.\nX9.\nG00X0.Y0.\nM15\nG01X5.\nY5.\nG02X0.A5.\nM16\nG05\nX7.",
    );
    assert_eq!(errors, []);
    let described: Vec<_> = features
        .iter()
        .map(|feature| match feature {
            Feature::Hole(hole) => {
                let [x, y] = millimetres(hole.at_nm);
                format!("hole {x} {y}")
            }
            Feature::Slot(slot) => {
                let path = match slot.path {
                    Path::Straight => "to".to_owned(),
                    Path::Radius {
                        clockwise: true,
                        radius_nm,
                    } => format!("cw {} to", radius_nm / 1_000_000),
                    other => format!("{other:?}"),
                };
                let ([x, y], [to_x, to_y]) = (millimetres(slot.from_nm), millimetres(slot.to_nm));
                format!("{x} {y} {path} {to_x} {to_y}")
            }
        })
        .collect();
    assert_eq!(
        described,
        [
            "1 1 to 4 1",
            "hole 9 1",
            "0 0 to 5 0",
            "5 0 to 5 5",
            "5 5 cw 5 to 0 5",
            "hole 7 5"
        ]
    );
    let (features, _, warnings) = read("METRIC\nT1C1\nG00X0.Y0.\nG01X5.\n");
    assert_eq!(features, []);
    assert_eq!(warnings[0].1.kind, WarningKind::ToolUp);
}

#[test]
fn plating() {
    let text = "M48\nMETRIC\n;TYPE=PLATED\nT1C1\n;TYPE=NON_PLATED\nT2C1\n%\nT1\nX1.\nT2\nX1.\n";
    let (features, ..) = read(text);
    let plated: Vec<_> = features
        .iter()
        .map(|feature| match feature {
            Feature::Hole(hole) => hole.tool.plated,
            Feature::Slot(slot) => slot.tool.plated,
        })
        .collect();
    assert_eq!(plated, [Some(true), Some(false)]);
}

#[test]
fn what_is_refused() {
    use ErrorKind::{
        Gerber, HalfSlot, MissingNumber, NoDiameter, NoTool, NotALetter, NotText, NotWhole,
        NothingToRepeat, NumberTooLarge, Origin, RepeatOfSlot, RepeatedWord, StepAndRepeat,
        TooManyTools, UnknownCode, UnknownName, UnknownWord,
    };
    for (line, kind) in [
        ("%FSLAX24Y24*%", Gerber),
        ("X1Y1D03*", Gerber),
        ("X1*", Gerber),
        ("\u{1}\u{2}", NotText(1)),
        ("X", MissingNumber(b'X')),
        ("X1X2", RepeatedWord(b'X')),
        ("T1T2", RepeatedWord(b'T')),
        ("X1G85", HalfSlot),
        ("G85X1", HalfSlot),
        ("X1G85X2R2", RepeatOfSlot),
        ("R0M02X1Y1", StepAndRepeat),
        ("M25", StepAndRepeat),
        ("R3X1", NothingToRepeat),
        ("R99999X1", NumberTooLarge),
        ("G82X1Y1", UnknownCode(b'G', 82)),
        ("M52", UnknownCode(b'M', 52)),
        ("G93X1Y0", Origin),
        ("T9C-1", NoDiameter),
        ("T9C0", NoDiameter),
        ("T1.5", NotWhole(b'T')),
        ("T70000", NumberTooLarge),
        ("X9999999999999", NumberTooLarge),
        ("X1A1", UnknownWord(b'A')),
        ("C1", UnknownWord(b'C')),
        ("Q1", UnknownWord(b'Q')),
        ("WHAT,1", UnknownName),
        ("!", NotALetter(b'!')),
    ] {
        let text = format!("METRIC\nT1C1\n{line}\nX5.Y5.");
        let (features, ..) = read(&text);
        assert_eq!(kinds(&text), [(3, kind)], "{line}");
        // The line after the wrong one is read as if the wrong one were missing.
        assert_eq!(features.len(), 1, "{line}");
    }
    assert_eq!(kinds("METRIC\nX1"), [(2, NoTool)]);
    assert_eq!(kinds("METRIC\nT1C1\nT0\nX1"), [(4, NoTool)]);
    let many: String = (1..=9).map(|tool| format!("T{tool}C1\n")).collect();
    assert_eq!(kinds(&many), [(9, TooManyTools)]);
}

#[test]
fn what_is_warned_about() {
    use WarningKind::{AfterEnd, HeaderNotEnded, Ignored, NoDiameter, Redefined, UnknownName};
    for (text, line, kind) in [
        ("M48\nFANCY,1\n%", 2, UnknownName),
        ("M48\nINCH,QZ\n%", 2, UnknownName),
        ("M48\nINCH\nT1C1\nT1\nX1", 5, HeaderNotEnded),
        ("INCH\nT1C1\nT1C2", 3, Redefined(1)),
        ("INCH\nT7", 2, NoDiameter(7)),
        ("G04 anything at all!", 1, Ignored),
        ("M30\n%\n;c\nX1\nX1", 4, AfterEnd),
    ] {
        let (_, errors, warnings) = read(text);
        assert_eq!(errors, [], "{text}");
        let found: Vec<_> = warnings
            .iter()
            .map(|(line, warning)| (*line, warning.kind))
            .collect();
        assert_eq!(found, [(line, kind)], "{text}");
    }
}

#[test]
fn memory_is_as_stated() {
    let tools = size_of::<Reader<100>>() - size_of::<Reader<0>>();
    assert!(tools <= 100 * 40, "{tools}");
    assert!(size_of::<Reader<0>>() <= 256);
}

/// Writes a length, in units of the last decimal place, in a format.
fn written(value: i64, format: &Format, point: bool) -> String {
    let (whole, places) = (format.digits.whole(), format.digits.places());
    let sign = if value < 0 { "-" } else { "" };
    let width = usize::from(whole + places);
    let digits = format!("{:0width$}", value.abs());
    if point {
        let (head, tail) = digits.split_at(digits.len() - usize::from(places));
        return format!("{sign}{head}.{tail}");
    }
    let kept = match format.zeros {
        Zeros::Leading => digits.trim_end_matches('0'),
        Zeros::Trailing => digits.trim_start_matches('0'),
    };
    format!("{sign}{}", if kept.is_empty() { "0" } else { kept })
}

fn formats() -> impl Strategy<Value = Format> {
    let units = prop::sample::select(vec![Units::Inches, Units::Millimetres]);
    let zeros = prop::sample::select(vec![Zeros::Leading, Zeros::Trailing]);
    let digits =
        (1_u8..=4, 0_u8..=6).prop_map(|(whole, places)| Digits::new(whole, places).unwrap());
    (units, zeros, digits).prop_map(|(units, zeros, digits)| Format {
        units,
        zeros,
        digits,
    })
}

fn overrides(format: &Format) -> Overrides {
    Overrides {
        units: Some(format.units),
        zeros: Some(format.zeros),
        digits: Some(format.digits),
        ..Overrides::default()
    }
}

/// Text that resembles a drill file, right or wrong.
fn drill_lines() -> impl Strategy<Value = Vec<String>> {
    let fixed = prop::sample::select(vec![
        "M48",
        "%",
        "M95",
        "INCH,TZ",
        "METRIC,LZ",
        "METRIC,000.000",
        "M71",
        "M72",
        "ICI,ON",
        "ICI,OFF",
        "G90",
        "G91",
        "G05",
        "G00",
        "G01",
        "M15",
        "M16",
        "T1",
        "T2C.5",
        "T1C0.8",
        "T0",
        ";FILE_FORMAT=2:4",
        ";TYPE=PLATED",
        "FMAT,2",
        "R3X01",
        "X01Y02G85X03Y01",
        "G03X1A2",
        "G02X1I1J0",
        ";Holesize 1. = 13.0 PLATED MILS",
    ]);
    let words = prop::collection::vec(
        (
            prop::sample::select(b"XYXYXYRTGMACIJ".to_vec()),
            "[+-]?[0-9]{0,7}(\\.[0-9]{0,4})?",
        ),
        1..4,
    )
    .prop_map(|words| {
        let words = words.iter();
        words
            .map(|(letter, number)| format!("{}{number}", char::from(*letter)))
            .collect()
    });
    prop::collection::vec(prop_oneof![fixed.prop_map(str::to_owned), words], 0..24)
}

proptest! {
    /// A length written in a format is read back exactly, with and without a point, for both kinds
    /// of zeros.
    #[test]
    fn print_and_parse(
        format in formats(),
        points in prop::collection::vec(
            (-9_999_999_i64..9_999_999, -9_999_999_i64..9_999_999),
            1..8,
        ),
        point: bool,
    ) {
        let most = 10_i64.pow(u32::from(format.digits.all()));
        let mut text = String::from("T1C1.0\n");
        for (x, y) in &points {
            let (x, y) = (
                written(x % most, &format, point),
                written(y % most, &format, point),
            );
            text += &format!("X{x}Y{y}\n");
        }
        let (features, errors, _) = read_with(text.as_bytes(), &overrides(&format));
        prop_assert_eq!(errors, vec![]);
        let nm_per_unit = match format.units {
            Units::Inches => 25_400_000_i128,
            Units::Millimetres => 1_000_000,
        };
        let scale = 10_i128.pow(u32::from(format.digits.places()));
        // Rounded to the nearest nanometre, halves away from zero.
        let nm = |value: i64| {
            let product = i128::from(value % most) * nm_per_unit;
            let rounded = (2 * product.abs() + scale) / (2 * scale);
            (rounded * product.signum()) as i64
        };
        let found: Vec<_> = features
            .iter()
            .map(|feature| match feature {
                Feature::Hole(hole) => hole.at_nm,
                Feature::Slot(slot) => slot.to_nm,
            })
            .collect();
        let wanted: Vec<_> = points.iter().map(|(x, y)| [nm(*x), nm(*y)]).collect();
        prop_assert_eq!(found, wanted);
    }

    /// Line ends, blanks inside lines and the case of letters have no effect.
    #[test]
    fn the_way_of_writing_does_not_matter(lines in drill_lines(), blanks: Vec<u8>) {
        let plain = lines.join("\n");
        let (features, errors, _) = read(&plain);
        for end in ["\r\n", "\r"] {
            let (again, same_errors, _) = read(&lines.join(end));
            prop_assert_eq!(&again, &features);
            prop_assert_eq!(&same_errors, &errors);
        }
        let mut blanks = blanks.iter().cycle();
        let mut spaced = String::new();
        for character in plain.to_lowercase().chars() {
            if blanks.next().is_some_and(|blank| blank % 3 == 0) {
                spaced.push(if character == 'x' { '\t' } else { ' ' });
            }
            spaced.push(character);
        }
        let (again, same_errors, _) = read(&spaced);
        prop_assert_eq!(again, features);
        let kinds = |errors: &[(usize, Error)]| -> Vec<_> {
            errors.iter().map(|(line, error)| (*line, error.kind)).collect()
        };
        prop_assert_eq!(kinds(&same_errors), kinds(&errors));
    }

    /// A line with an error has no effect: without it the file has the same meaning.
    #[test]
    fn wrong_lines_leave_the_reader_as_it_was(lines in drill_lines()) {
        let text = lines.join("\n");
        let overrides = overrides(&settings(text.as_bytes(), &Overrides::default()).format());
        let (features, errors, _) = read_with(text.as_bytes(), &overrides);
        let right: Vec<_> = (1..)
            .zip(&lines)
            .filter(|(number, _)| errors.iter().all(|(line, _)| line != number))
            .map(|(_, line)| line.as_str())
            .collect();
        let (again, no_errors, _) = read_with(right.join("\n").as_bytes(), &overrides);
        prop_assert_eq!(again, features);
        prop_assert_eq!(no_errors, vec![]);
    }

    /// For any bytes there is no panic, errors are inside their line, and coordinates are within
    /// the limit.
    #[test]
    fn any_bytes(text: Vec<u8>) {
        let (features, ..) = read_with(&text, &Overrides::default());
        for feature in features {
            let at = match feature {
                Feature::Hole(hole) => hole.at_nm,
                Feature::Slot(slot) => slot.to_nm,
            };
            prop_assert!(at.iter().all(|nm| nm.abs() <= LIMIT_NM));
        }
    }
}

/// Returns the holes of a file with patterns, including copies, in um, and the errors.
fn panel(text: &str) -> (Vec<[i64; 2]>, Vec<(usize, ErrorKind)>) {
    let settings = settings(text.as_bytes(), &Overrides::default());
    let mut reader = Reader::<8>::new(&settings).with_patterns();
    let (mut features, mut errors) = (Vec::new(), Vec::new());
    let (mut before, mut with, mut by) = (0, 0, [0; 2]);
    for (number, line) in lines(text.as_bytes()) {
        match reader.read(line) {
            Ok(made) => features.extend(made),
            Err(error) => {
                assert!(error.at <= error.end && error.end <= line.len());
                assert_eq!(reader.pattern(), None);
                errors.push((number, error.kind));
            }
        }
        match reader.pattern() {
            Some(Pattern::Begin) => before = features.len(),
            Some(Pattern::EndOfSet) => (with, by) = (features.len(), [0; 2]),
            Some(Pattern::Repeat(repeat)) => {
                for _ in 0..repeat.count {
                    for (by, step) in by.iter_mut().zip(repeat.step_nm) {
                        *by += step;
                    }
                    for index in before..with {
                        let copy = repeat.copy(&features[index], by).expect("within reach");
                        features.push(copy);
                    }
                }
            }
            Some(Pattern::End) | None => {}
        }
    }
    let places = features.iter().map(|feature| match feature {
        Feature::Hole(hole) => hole.at_nm.map(|nm| nm / 1000),
        Feature::Slot(slot) => slot.from_nm.map(|nm| nm / 1000),
    });
    (places.collect(), errors)
}

#[test]
fn eight_corners_of_a_frame() {
    // The sample program of the CNC-7's manual: a corner of 13 holes, mirrored and turned to eight
    // corners, 104 holes in all.
    let text = "M48\nINCH,LZ\nT4C.052\n%\nT4\nM25\nX01Y018\nR8Y-001\nR4X001\nM01\n\
                M02X002Y002M70\nM02X043M90M70\nM02X002Y-002M80\nM02X-002Y038M80M90M70\n\
                M02X002Y002M80M90\nM02X-047M90\nM02X002Y-002M80M70\nM02\nM08\nM30\n";
    let (places, errors) = panel(text);
    assert_eq!((places.len(), errors), (104, vec![]));
    let mut all = places.clone();
    all.sort();
    // The frame is symmetrical in both axes about its middle at 2.35, 2 inches.
    for mirror in [
        |[x, y]: [i64; 2]| [119_380 - x, y],
        |[x, y]: [i64; 2]| [x, 101_600 - y],
    ] {
        let mut mirrored: Vec<_> = places.iter().copied().map(mirror).collect();
        mirrored.sort();
        assert_eq!(mirrored, all);
    }
    // The first copy is the corner with X and Y swapped, 0.2 inch further in.
    for (original, copy) in places.iter().zip(&places[13..26]) {
        assert_eq!([copy[0] - 5080, copy[1] - 5080], [original[1], original[0]]);
    }
}

#[test]
fn sets_of_copies_are_copied() {
    let text = "METRIC\nT1C1\n%\nT1\nX50.Y50.\nM25\nX1.Y2.\nM01\nR2M02XY10.\nM01\n\
                R2M02X20.Y\nM02\nM08\nX60.\n";
    let (places, errors) = panel(text);
    assert_eq!(errors, []);
    let mut grid: Vec<_> = (0..9)
        .map(|at| [1000 + at / 3 * 20_000, 2000 + at % 3 * 10_000])
        .collect();
    grid.insert(0, [50_000, 50_000]);
    grid.push([60_000, 2000]);
    assert_eq!(places, grid);
    // Incremental coordinates restart after the pattern.
    let text =
        "METRIC\nT1C1\nG91\nM25\nX1.Y1.\nX1.\nM01\nM02X0.Y5.\nM08\nX3.\nM25\nX1.\nM01\nM08M30\n";
    assert_eq!(
        panel(text),
        (
            vec![
                [1000, 1000],
                [2000, 1000],
                [1000, 6000],
                [2000, 6000],
                [3000, 0],
                [4000, 0]
            ],
            vec![]
        )
    );
    // A mirrored arc has the opposite direction, and an arc mirrored twice the original one.
    let text = "METRIC\nT1C1\nT1\nM25\nG00X0.Y0.\nM15\nG02X2.Y0.I1.J0.\nM17\nM01\n";
    let settings = settings(text.as_bytes(), &Overrides::default());
    let mut reader = Reader::<8>::new(&settings).with_patterns();
    let mut slot = None;
    for (_, line) in lines(text.as_bytes()) {
        slot = reader.read(line).unwrap().next().or(slot);
    }
    let slot = slot.unwrap();
    let mut repeat = Repeat {
        count: 1,
        step_nm: [0; 2],
        mirror_x: true,
        mirror_y: false,
        swap: false,
    };
    let path = |feature: Option<Feature>| match feature {
        Some(Feature::Slot(slot)) => slot.path,
        other => panic!("{other:?}"),
    };
    assert_eq!(
        path(repeat.copy(&slot, [0, 7])),
        Path::Centre {
            clockwise: false,
            centre_nm: [-1_000_000, 7]
        }
    );
    repeat.swap = true;
    assert_eq!(
        path(repeat.copy(&slot, [0; 2])),
        Path::Centre {
            clockwise: true,
            centre_nm: [0, -1_000_000]
        }
    );
    assert_eq!(repeat.copy(&slot, [LIMIT_NM + 1, 1]), None);
    assert_eq!(repeat.copy(&slot, [i64::MAX, i64::MIN]), None);
}

#[test]
fn patterns_out_of_order() {
    use ErrorKind::{MissingNumber, PatternOrder, RepeatedWord, StepAndRepeat, UnknownWord};
    for (lines, at, kind) in [
        ("M01", 4, PatternOrder),
        ("M02X1.", 4, PatternOrder),
        ("M08", 4, PatternOrder),
        ("M25\nX1.\nM02X1.", 6, PatternOrder),
        ("M25\nM25", 5, PatternOrder),
        ("M25\nX1.\nM01M02X1.", 6, PatternOrder),
        ("M25\nX1.\nM01\nX2.", 7, PatternOrder),
        ("M25\nX1.\nM01\nR3", 7, PatternOrder),
        ("M25\nX1.\nM01\nX1.M02", 7, PatternOrder),
        ("M25\nX1.\nM01\nR0M02X1.", 7, PatternOrder),
        ("M25\nX1.\nM01\nM02X1.M02", 7, PatternOrder),
        ("M25\nX1.\nM01\nM02X1.M08", 7, PatternOrder),
        ("M25\nX1.\nM01\nM02X1.R2", 7, PatternOrder),
        ("M25\nX1.\nM01\nM02X1.M80M80", 7, RepeatedWord(b'M')),
        ("M25\nX1.\nM01\nM02X1.I3.", 7, UnknownWord(b'I')),
        ("M25\nX1.\nM01\nM80", 7, StepAndRepeat),
        ("X", 4, MissingNumber(b'X')),
    ] {
        let (_, errors) = panel(&format!("METRIC\nT1C1\nT1\n{lines}\n"));
        assert_eq!(errors, [(at, kind)], "{lines}");
    }
}

/// Lines of patterns in any order, some of them wrong.
fn pattern_line() -> impl Strategy<Value = &'static str> {
    prop::sample::select(vec![
        "M25",
        "M01",
        "M02",
        "M08",
        "M02X1.Y2.",
        "R2M02XY3.",
        "M02X1.M80",
        "M02XYM90M70",
        "X1.Y1.",
        "X-3.",
        "R2X0.5",
        "X0Y0G85X2.",
        "G91",
        "G90",
        "M02Q",
        "M25M01",
        "M08M25",
        "R0M02X1.",
        "T2",
        "%",
    ])
}

proptest! {
    /// A line with an error has no effect: without it the features are the same.
    #[test]
    fn wrong_lines_of_patterns_change_nothing(
        program in prop::collection::vec(pattern_line(), 0..24),
    ) {
        // At most seven sets limit the number of copies of copies.
        let mut sets = 0;
        let few = program.iter().filter(|line| {
            sets += usize::from(line.contains("M02"));
            !line.contains("M02") || sets <= 7
        });
        let head = ["METRIC", "T1C1", "T2C2", "T1"];
        let lines: Vec<&str> = head.iter().chain(few).copied().collect();
        let (places, errors) = panel(&lines.join("\n"));
        let wrong: Vec<_> = errors.iter().map(|(line, _)| *line).collect();
        let right: Vec<_> = (1..)
            .zip(&lines)
            .filter(|(number, _)| !wrong.contains(number))
            .map(|(_, line)| *line)
            .collect();
        prop_assert_eq!(panel(&right.join("\n")), (places, vec![]));
    }
}

fn settled(text: &str) -> Settings {
    settings(text.as_bytes(), &Overrides::default())
}

/// Inference from the numbers of a file. Steps of repeats, text after the end and words without a
/// tool have no effect.
#[test]
fn what_numbers_show() {
    use husillo_excellon::Doubt;
    let zeros = |body: &str| settled(&format!("INCH\nT1C.1\n{body}")).zeros.value;
    assert_eq!(zeros("X1000Y100\nX0100\n"), Zeros::Leading);
    assert_eq!(zeros("X1000Y1000\nR2X01\n"), Zeros::Trailing);
    assert_eq!(zeros("X1000Y1000\nM30\nX01\n"), Zeros::Trailing);
    let units = |text: &str| settled(text).units.value;
    assert_eq!(units("M71\nT1C.1\n"), Units::Millimetres);
    assert_eq!(units("M72\nT1C9\n"), Units::Inches);
    assert_eq!(units("T1C0.5\n"), Units::Inches);
    assert_eq!(units("T1C0.500001\n"), Units::Millimetres);
    assert_eq!(units("X1.0C0.9\n"), Units::Inches);
    let doubt = |body: &str| settled(&format!("INCH\n{body}")).doubt;
    assert_eq!(doubt("X12\nX123456\nX123456\n"), None);
    assert_eq!(
        doubt("X12\nX1234567\nX1234567\nX1\n"),
        Some(Doubt::LongNumber(3, 7))
    );
    let format = ";FORMAT={3:3/ incremental / metric / suppress leading zeros}\n";
    assert!(settled(format).incremental);
    assert!(
        settled(&format!(
            "{format}{}",
            format.replace("incremental", "absolute")
        ))
        .incremental
    );
    assert!(!settled(&format.replace("incremental", "absolute")).incremental);
}

/// A change of units, zeros and digits within a file takes effect from there on. Digits that the
/// file declares stay.
#[test]
fn formats_under_way() {
    let at = |text: &str| holes(text).iter().map(|hole| hole[0]).collect::<Vec<_>>();
    assert_eq!(at("METRIC,LZ\nT1C1\nX1.\nINCH,TZ\nX1.\n"), [1_000, 25_400]);
    assert_eq!(at("METRIC,LZ\nT1C1\nX01\nMETRIC,TZ\nX01\n"), [10_000, 1]);
    assert_eq!(
        at("METRIC,TZ,000.00\nT1C1\nX100\nINCH\nX100\n"),
        [1_000, 25_400]
    );
    assert_eq!(at("METRIC,TZ\nT1C1\nM72,LZ\nX01\nX1.\n"), [25_400, 25_400]);
}

/// Codes without effect, codes ignored with a warning, and unknown lines.
#[test]
fn what_is_passed_over() {
    let body = |line: &str| {
        let (features, errors, warnings) = read(&format!("METRIC\nT1C1\n{line}\nX5.Y5.\n"));
        assert_eq!(errors, [], "{line}");
        (features.len(), warnings.len())
    };
    for (line, warnings) in [
        ("G40", 0),
        ("M06", 1),
        ("M09", 1),
        ("M47,what you like", 1),
        ("M97,*", 1),
        ("/X1.", 0),
    ] {
        assert_eq!(body(line), (1, warnings), "{line}");
    }
    for (line, kind) in [
        ("%1", ErrorKind::NotALetter(b'1')),
        ("R2R3X1.", ErrorKind::RepeatedWord(b'R')),
        ("X1.G85X2.G85X3.", ErrorKind::RepeatedWord(b'G')),
        ("R2X1.G85X2.", ErrorKind::RepeatedWord(b'G')),
        ("R10000X1.", ErrorKind::NumberTooLarge),
    ] {
        let text = format!("METRIC\nT1C1\nX0.\n{line}\n");
        assert_eq!(kinds(&text), [(4, kind)], "{line}");
    }
    let many: String = (1..=8).map(|tool| format!("T{tool}C1\n")).collect();
    assert_eq!(
        kinds(&format!("{many}T9\n")),
        [(9, ErrorKind::TooManyTools)]
    );
}

/// A tool has its own plating, or else the plating in effect where it is used: for holes, their
/// repeats and slots.
#[test]
fn plating_where_a_tool_is_used() {
    let (features, errors, _) = read("METRIC\nT1C1\n;TYPE=PLATED\nX1.\nR1X1.\nX5.G85X6.\n");
    assert_eq!(errors, []);
    for feature in &features {
        let plated = match feature {
            Feature::Hole(hole) => hole.tool.plated,
            Feature::Slot(slot) => slot.tool.plated,
        };
        assert_eq!(plated, Some(true));
    }
    assert_eq!(features.len(), 3);
}

/// Arcs of both directions, by a radius or by one component of a centre.
#[test]
fn arcs_of_routs() {
    let (features, errors, _) =
        read("METRIC\nT1C1\nG00X0.Y0.\nM15\nG03X10.A5.\nG02X0.I-5.\nG03Y10.J5.\nM16\n");
    assert_eq!(errors, []);
    let paths: Vec<_> = features
        .iter()
        .map(|feature| match feature {
            Feature::Slot(slot) => slot.path,
            Feature::Hole(_) => Path::Straight,
        })
        .collect();
    let nm = |mm: i64| mm * 1_000_000;
    assert_eq!(
        paths,
        [
            Path::Radius {
                clockwise: false,
                radius_nm: nm(5)
            },
            Path::Centre {
                clockwise: true,
                centre_nm: [nm(5), nm(0)]
            },
            Path::Centre {
                clockwise: false,
                centre_nm: [nm(0), nm(5)]
            },
        ]
    );
}

/// Every form of a request makes a copy. `M02` alone makes none.
#[test]
fn ways_to_ask_for_a_copy() {
    let count = |line: &str| {
        let (places, errors) = panel(&format!("METRIC\nT1C1\nM25\nX1.Y2.\nM01\n{line}\nM08\n"));
        assert_eq!(errors, [], "{line}");
        places.len()
    };
    assert_eq!(count("M02"), 1);
    for line in [
        "M02X5.",
        "M02Y5.",
        "M02X5.Y5.",
        "M02M70",
        "M02M80",
        "M02M90",
        "R1M02",
        "M02XY",
        "M02X5.M80",
        "M02M80M90",
    ] {
        assert_eq!(count(line), 2, "{line}");
    }
}

/// Messages, and tools that the caller sets.
#[test]
fn words_and_tools_from_outside() {
    let texts = [
        Units::Inches.to_string(),
        Units::Millimetres.to_string(),
        Zeros::Leading.to_string(),
        Zeros::Trailing.to_string(),
        Digits::new(2, 4).expect("digits").to_string(),
    ];
    for (at, text) in texts.iter().enumerate() {
        assert!(!text.is_empty() && !texts[..at].contains(text), "{text}");
    }
    let mut reader = Reader::<2>::new(&settled("METRIC\n"));
    assert!(!reader.set_tool(1, 0) && !reader.set_tool(1, -1));
    assert!(reader.set_tool(1, 1) && reader.set_tool(2, 2));
    assert!(!reader.set_tool(3, 3));
    assert!(reader.read(b"T2X1.").expect("a hole").next().is_some_and(
        |feature| matches!(feature, Feature::Hole(hole) if hole.tool.diameter_nm == Some(2))
    ));
    assert!(!reader.is_ended());
    assert_eq!(reader.read(b"M30").expect("an end").len(), 0);
    assert!(reader.is_ended());
}
