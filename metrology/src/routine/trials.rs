//! Routines on ideal solids: the results are the true figures.

use super::dimension::Figure;
use super::failure::Failure;
use super::feature::Feature;
use super::frame::Frame;
use super::parser::Parser;
use super::program::{ProgramError, ProgramFault};
use super::record::Refusal;
use super::runner::Runner;
use super::site::Site;
use super::solid::{Body, Ideal};
use crate::heads::Stylus;
use husillo_probe::{PreTravel, Tip, UnitVector};

const MM: i64 = 1_000_000;

/// A tip with a radius of 1 mm, and with a different pre-travel in every direction.
fn tip() -> Stylus {
    let six = [UnitVector::X, UnitVector::Y, UnitVector::Z];
    let all = [six, six.map(|axis| axis.reversed())].concat();
    let entries: Vec<_> = (0..)
        .map(|n| 4_000 + 700 * n)
        .zip(all)
        .map(|(nm, axis)| (axis, nm))
        .collect();
    Tip {
        radius_nm: 1_000_000,
        pre_travel: PreTravel::of(&entries).unwrap(),
    }
}

fn ideal(bodies: Vec<Body>, place: Frame) -> Ideal {
    Ideal {
        bodies,
        place,
        tip: tip(),
        at: [0, 0, 50 * MM],
        moves: 0,
        guarded: 0,
        speeds: Vec::new(),
    }
}

/// A plate of 60 x 40 x 10 mm with a bore, a pin and a pocket.
fn plate(place: Frame) -> Ideal {
    ideal(
        vec![
            Body::Block([0, 0, -10 * MM], [60 * MM, 40 * MM, 0]),
            Body::Hole {
                centre: [15 * MM, 20 * MM],
                radius: 6 * MM,
                floor: -8 * MM,
            },
            Body::Pocket([25 * MM, 10 * MM, -6 * MM], [35 * MM, 30 * MM, 0]),
            Body::Pin {
                centre: [48 * MM, 20 * MM],
                radius: 4 * MM,
                top: 8 * MM,
            },
        ],
        place,
    )
}

fn run(text: &str, machine: &mut Ideal) -> Result<Vec<Feature>, Failure> {
    let statements = Parser::file(text).unwrap_or_else(|mistakes| panic!("{mistakes:#?}"));
    let tip = machine.tip;
    let mut runner = Runner::new(Site::new(machine, tip));
    for statement in &statements {
        runner.run(statement)?;
    }
    Ok(runner.features)
}

fn figure(feature: &Feature, figure: Figure) -> Option<i64> {
    let mut dimensions = feature.dimensions.iter();
    let found = dimensions.find(|dimension| dimension.figure == figure);
    found.map(|dimension| dimension.actual_micro)
}

fn feature<'a>(features: &'a [Feature], name: &str) -> &'a Feature {
    let mut found = features.iter().filter(|feature| feature.name == name);
    found.next().unwrap()
}

/// Expects figures in nm or millionths of a degree, with an error of at most 3, which comes from
/// the rounding of touches.
fn expect(features: &[Feature], name: &str, figures: &[(Figure, i64)]) {
    let feature = feature(features, name);
    for (which, wanted) in figures {
        let actual = figure(feature, *which);
        let is_near = actual.is_some_and(|actual| actual.abs_diff(*wanted) <= 3);
        assert!(is_near, "{name} {which:?}: {actual:?} for {wanted}");
    }
}

use Figure::{Angle, Diameter, Form, Length, Width, X, Y, Z};

#[test]
fn every_cycle_finds_the_true_figures() {
    let text = "
        safe z 15
        point P1 at x 5 y 5 z 0 towards -z
        edge E1 at x 0 y 20 z -3 towards +x points 3 over 20
        edge E2 at x 30 y 40 z -3 towards -y
        corner C1 at x 0 y 0 z -3 towards +x +y inset 5
        corner C2 at x 60 y 40 z -3 towards -x -y inset 5
        corner C3 at x 25 y 10 z -3 towards -x -y inset 3 inside clearance 1
        web W1 at x 30 y 5 z -3 along +x width 60
        pocket K1 at x 30 y 20 z -3 along x width 10
        bore B1 at x 15.1 y 19.9 z -3 diameter 12 points 6
        boss S1 at x 48 y 20 z 4 diameter 8
        circle A1 inside at x 15 y 20 z -3 diameter 12 points 5 from 0 to 180 deg
        plane F1 towards -z at x 5 y 5 z 0 at x 55 y 5 z 0 at x 5 y 35 z 0 at x 55 y 35 z 0
        line L1 towards +y at x 5 y 0 z -3 at x 30 y 0 z -3 at x 55 y 0 z -3
    ";
    let features = run(text, &mut plate(Frame::MACHINE)).unwrap();
    expect(&features, "P1", &[(X, 5 * MM), (Y, 5 * MM), (Z, 0)]);
    expect(
        &features,
        "E1",
        &[(X, 0), (Y, 20 * MM), (Angle, 90_000_000), (Form, 0)],
    );
    expect(&features, "E2", &[(Y, 40 * MM)]);
    expect(&features, "C1", &[(X, 0), (Y, 0), (Angle, 90_000_000)]);
    expect(
        &features,
        "C2",
        &[(X, 60 * MM), (Y, 40 * MM), (Angle, 90_000_000)],
    );
    expect(
        &features,
        "C3",
        &[(X, 25 * MM), (Y, 10 * MM), (Angle, 90_000_000)],
    );
    expect(&features, "W1", &[(X, 30 * MM), (Width, 60 * MM)]);
    expect(&features, "K1", &[(X, 30 * MM), (Width, 10 * MM)]);
    expect(
        &features,
        "B1",
        &[(X, 15 * MM), (Y, 20 * MM), (Diameter, 12 * MM), (Form, 0)],
    );
    expect(
        &features,
        "S1",
        &[(X, 48 * MM), (Y, 20 * MM), (Diameter, 8 * MM), (Form, 0)],
    );
    expect(
        &features,
        "A1",
        &[(X, 15 * MM), (Y, 20 * MM), (Diameter, 12 * MM), (Form, 0)],
    );
    expect(&features, "F1", &[(Z, 0), (Form, 0)]);
    expect(&features, "L1", &[(Y, 0), (Angle, 0), (Form, 0)]);
}

#[test]
fn spheres_and_features_of_features() {
    let ball = |place| ideal(vec![Body::Ball([5 * MM, 6 * MM, 7 * MM], 10 * MM)], place);
    let text = "sphere S at x5.2 y5.9 z7 diameter 20 points 25";
    let features = run(text, &mut ball(Frame::MACHINE)).unwrap();
    expect(
        &features,
        "S",
        &[
            (X, 5 * MM),
            (Y, 6 * MM),
            (Z, 7 * MM),
            (Diameter, 20 * MM),
            (Form, 0),
        ],
    );

    let text = "
        safe z 15
        bore B at x15 y20 z-3 diameter 12
        boss S at x48 y20 z4 diameter 8
        point A at x5 y5 z0 towards -z
        point C at x55 y5 z0 towards -z
        point D at x30 y35 z0 towards -z
        plane F of A C D
        # From inside of the bore.
        goto x15 y20
        goto z-3
        touch K1 +x within 10
        goto x15 y20
        touch K2 x-1 y1 within 10
        goto x15 y20
        touch K3 -y within 10
        goto x15 y20
        circle K of K1 K2 K3 diameter 12 +-0.001
        edge E at x0 y20 z-3 towards +x points 2 over 20
        line G of B S
        distance BS between B S length 33 +-0.001
        distance BX between B S along y
        distance BE between B E length 15 +-0.001
        angle W between E G angle 90 +-0.001
        sphere Q of K1 K2 K3 A C
    ";
    let failed = run(text, &mut plate(Frame::MACHINE)).unwrap_err();
    assert!(
        matches!(failed, Failure::Fit(_) | Failure::BothSides),
        "{failed}"
    );
    let text = text.replace("sphere Q of K1 K2 K3 A C", "");
    let features = run(&text, &mut plate(Frame::MACHINE)).unwrap();
    expect(&features, "F", &[(Z, 0)]);
    expect(
        &features,
        "K",
        &[(X, 15 * MM), (Y, 20 * MM), (Diameter, 12 * MM)],
    );
    expect(&features, "G", &[(Angle, 0), (Y, 20 * MM)]);
    expect(&features, "BS", &[(Length, 33 * MM)]);
    expect(&features, "BX", &[(Length, 0)]);
    expect(&features, "BE", &[(Length, 15 * MM)]);
    expect(&features, "W", &[(Angle, 90_000_000)]);
    assert!(features.iter().all(Feature::is_good));
}

/// A routine for a plate. It aligns the frame to its sides, then measures at the coordinates of the
/// drawing.
const ALIGNED: &str = "
    clearance 7
    search 8
    safe z 20
    plane top towards -z at x10 y5 z0 at x50 y5 z0 at x30 y35 z0
    line front towards +y at x8 y0 z-3 at x52 y0 z-3
    point left at x0 y12 z-3 towards +x
    frame plane top line front point left
    clearance 2
    search 1
    bore B at x 15 +-0.01 y 20 +-0.01 z -3 diameter 12 +-0.01
    boss S at x 48 +-0.01 y 20 +-0.01 z 4 diameter 8 +-0.01
    pocket K at x 30 +-0.01 y 20 z -3 along x width 10 +-0.01
    corner C at x 60 +-0.01 y 40 +-0.01 z -3 towards -x -y inset 5 angle 90 +-0.01
    plane F towards -z at x5 y5 z0 +-0.01 at x55 y5 z0 at x5 y35 z0 at x55 y35 z0 form 0.005
    distance BS between B S length 33 +-0.005
";

/// A frame rotated about Z, then about X, by degrees.
fn turned(about_z: f64, about_x: f64, at_mm: [f64; 3]) -> Frame {
    let (z, x) = (about_z.to_radians(), about_x.to_radians());
    let axes = [
        [z.cos(), z.sin(), 0.0],
        [-z.sin() * x.cos(), z.cos() * x.cos(), x.sin()],
        [z.sin() * x.sin(), -z.cos() * x.sin(), x.cos()],
    ];
    Frame::new(axes, at_mm.map(|mm| mm * 1e6), [0; 3])
}

#[test]
fn a_part_may_lie_anywhere() {
    for place in [
        Frame::MACHINE,
        turned(3.0, 0.0, [1.5, -2.0, 1.0]),
        turned(-4.0, 1.5, [-2.0, 1.0, -1.5]),
    ] {
        let features = run(ALIGNED, &mut plate(place)).unwrap();
        // Touches are exact to 1 nm, and directions to 2^-30 of the distance. The frame is computed
        // from points 40 mm apart, which adds some nm.
        for (name, figures) in [
            ("B", vec![(X, 15 * MM), (Y, 20 * MM), (Diameter, 12 * MM)]),
            ("S", vec![(X, 48 * MM), (Y, 20 * MM), (Diameter, 8 * MM)]),
            ("K", vec![(X, 30 * MM), (Width, 10 * MM)]),
            ("C", vec![(X, 60 * MM), (Y, 40 * MM), (Angle, 90_000_000)]),
            ("F", vec![(Z, 0), (Form, 0)]),
            ("BS", vec![(Length, 33 * MM)]),
        ] {
            let feature = feature(&features, name);
            for (which, wanted) in figures {
                let actual = figure(feature, which).unwrap();
                assert!(
                    actual.abs_diff(wanted) <= 40,
                    "{place:?}: {name} {which:?}: {actual} for {wanted}"
                );
            }
            assert!(feature.is_good(), "{name}");
        }
    }
}

#[test]
fn figures_out_of_tolerance_are_found() {
    let text = "
        safe z 15
        bore B at x 15 +-0.02 y 20 z -3 diameter 12.02 +0.01 -0.01
        pocket K at x 30 y 20 z -3 along x width 9.995 +0.005 -0
    ";
    let features = run(text, &mut plate(Frame::MACHINE)).unwrap();
    let verdicts = |name| -> Vec<_> {
        let dimensions = &feature(&features, name).dimensions;
        dimensions
            .iter()
            .filter_map(|dimension| Some((dimension.figure, dimension.is_good()?)))
            .collect()
    };
    assert_eq!(verdicts("B"), [(X, true), (Diameter, false)]);
    assert_eq!(verdicts("K"), [(Width, true)]);
    assert!(!feature(&features, "B").is_good());
}

#[test]
fn a_missing_surface_is_trouble() {
    let failed = run(
        "point P at x -5 y -5 z 0 towards -z",
        &mut plate(Frame::MACHINE),
    );
    assert!(matches!(
        failed,
        Err(Failure::Machine(crate::Error::NoContact { .. }))
    ));
}

/// An error with its code or its help.
fn shown(error: &ProgramError) -> String {
    match &error.fault {
        ProgramFault::Code(code) => format!("E{:04}: {error}", code.kind.code()),
        ProgramFault::Call { expected, .. } => {
            format!("{error}: {}", expected.as_deref().unwrap_or_default())
        }
        _ => error.to_string(),
    }
}

fn program(text: &str, machine: &mut Ideal) -> Result<Vec<Feature>, String> {
    super::program::check(text.as_bytes()).map_err(|all| all[0].fault.to_string())?;
    let tip = machine.tip;
    let mut runner = Runner::new(Site::new(machine, tip));
    let mut count = 0;
    super::program::run(text.as_bytes(), &mut runner, |_| {}, |_| count += 1, |_| {})
        .map_err(|error| shown(&error))?;
    assert_eq!(count, runner.features.len());
    Ok(runner.features)
}

#[test]
fn programs_use_their_results() {
    // The second probe move uses the result of the first one. The pin is measured relative to the
    // bore. Results are also read in inches.
    let text = "
        G21 G90 G94 F24
        G0 X5 Y5 Z5
        G38.2 Z-5 (top: the ball's centre, 1 mm above)
        #<top> = [#5063 - 1]
        o1 if [#5070 NE 1]
        G0 X999
        o1 endif
        G38.4 Z5 (off again, at the same place)
        o1 if [ABS[#5063 - 1 - #<top>] + ABS[#<top>] GT 0.000003]
        G0 X999
        o1 endif
        o1 if [#5070 NE 1]
        G0 X999
        o1 endif
        G10 L2 P1 Z#<top>
        G0 Z15
        G38.3 X6 (nothing there)
        o2 if [#5070 NE 0]
        G0 X999
        o2 endif
        #<_clearance> = 1.5
        o<bore> call [15.2] [19.9] [-3] [12] [6]
        G0 Z15
        o<boss> call [#<_bore_x> + 33] [#<_bore_y>] [4] [8]
        o3 if [ABS[#<_boss_diameter> - 8] GT 0.0001]
        G0 X999
        o3 endif
        G20
        o4 if [ABS[#<_bore_x> - 15 / 25.4] GT 0.00001]
        G0 X999
        o4 endif
        G21
        o<web> call [30] [5] [-3] [60]
        G0 Z15
        o<pocket> call [30] [20] [-3] [10]
        G0 Z15
        o<corner> call [0] [0] [-3] [1] [1] [5]
        G0 Z15
        o<edge> call [0] [20] [-3] [1] [0] [2] [20]
        G0 Z15
        o<plane> call [5] [5] [0] [50] [30]
        o<point> call [5] [5] [0] [0] [0] [-1]
        M2
        this is no program
    ";
    let features = program(text, &mut plate(Frame::MACHINE)).unwrap();
    let of = |keyword| {
        features
            .iter()
            .find(|feature| feature.keyword == keyword)
            .unwrap()
            .name
            .clone()
    };
    expect(
        &features,
        &of("bore"),
        &[(X, 15 * MM), (Y, 20 * MM), (Diameter, 12 * MM)],
    );
    expect(
        &features,
        &of("boss"),
        &[(X, 48 * MM), (Y, 20 * MM), (Diameter, 8 * MM)],
    );
    expect(&features, &of("web"), &[(X, 30 * MM), (Width, 60 * MM)]);
    expect(&features, &of("pocket"), &[(X, 30 * MM), (Width, 10 * MM)]);
    expect(&features, &of("corner"), &[(X, 0), (Y, 0)]);
    expect(&features, &of("edge"), &[(X, 0), (Angle, 90_000_000)]);
    expect(&features, &of("plane"), &[(Z, 0), (Form, 0)]);
    expect(&features, &of("point"), &[(Z, 0)]);
}

#[test]
fn programs_move_at_their_feed() {
    let mut machine = plate(Frame::MACHINE);
    // F is read before the units, in the order of the standard. The last move takes half a minute
    // for 20 mm.
    let text = "G21 F30\nG1 Z40\nG20\nF2 G38.3 Z1.2\nG0 Z2\nG21\nG1 Z20 F7.5\nG93 F2 X20";
    program(text, &mut machine).unwrap();
    let wanted = [30_000_000, 50_800_000, 7_500_000, 40_000_000];
    assert_eq!(machine.speeds, wanted);
}

#[test]
fn wrong_programs_are_refused() {
    let error = |text: &str| program(text, &mut plate(Frame::MACHINE)).unwrap_err();
    // Errors before any move.
    assert_eq!(error("G0 X5\nG2 X1 Y1 R5 F9"), "not on a measuring machine");
    assert_eq!(error("G0 Q#"), "E0610: line 1: value missing");
    // Errors at their lines.
    assert!(error("F9\nG38.2 Z30").contains("no contact from"));
    assert!(error("G0 Z20\no<bore> call [1] [2]").contains("o<bore> call [x] [y] [z] [diameter]"));
    assert!(error("o<drill> call").contains("E0633"));
    assert!(error("F9\nG38.4 Z60").contains("nothing to leave"));
    assert!(error("F9\nG38.5 Z60").contains("nothing to leave"));
    let touched = "F9\nG0 X5 Y5\nG38.2 Z-1\n";
    assert!(error(&(touched.to_owned() + "G38.3 Z-1")).contains("contact at start"));
    let along = error(&(touched.to_owned() + "G38.4 X5.1"));
    assert!(along.contains("lasted from"), "{along}");
    assert!(
        program(
            &(touched.to_owned() + "G38.5 X5.1"),
            &mut plate(Frame::MACHINE)
        )
        .is_ok()
    );
    assert!(error("G38.2 Z0").contains("feed"), "{}", error("G38.2 Z0"));
    assert!(error("M3 S100").contains("not on a measuring machine"));
}

#[test]
fn a_recording_gives_the_same_results() {
    let typed = "\
units mm            # remarks stay
safe z 15
jog x 5
jog x 10
jog y 5 rapid
nonsense
goto z 3
touch -z within 20
goto z 15
goto x 15 y 20
goto z -3
bore B at x 15 y 20 z -3 diameter 12 +-0.01
bore B at x 15 y 20 z -3 diameter 12
point far at x -30 y 0 z -3 towards -x
point far at x 0 y 20 z -3 towards +x
goto x -9
end
goto x 99
";
    let mut machine = plate(Frame::MACHINE);
    let tip = machine.tip;
    let (mut routine, mut measured, mut refused) = (Vec::new(), Vec::new(), Vec::new());
    let first = {
        let mut runner = Runner::new(Site::new(&mut machine, tip));
        let count = super::record::record(
            &mut typed.as_bytes(),
            &mut routine,
            &mut runner,
            |feature| {
                measured.push(feature.name.clone());
                Ok(())
            },
            |line| {
                refused.push(match &line.why {
                    Refusal::Wrong(wrong) => wrong.message.clone(),
                    Refusal::Failed(failure) => failure.to_string(),
                });
            },
        );
        assert_eq!(count.unwrap(), 3);
        runner.features
    };
    assert!(
        refused[0].contains("unknown word")
            && refused[1].contains("second time")
            && refused[2].contains("no contact"),
        "{refused:?}"
    );
    let routine = String::from_utf8(routine).unwrap();
    assert_eq!(
        routine,
        "\
units mm            # remarks stay
safe z 15
goto x 15 mm y 0 mm z 50 mm
goto x 15 mm y 5 mm z 50 mm rapid
goto x 15 mm y 5 mm z 3 mm
touch P1 -z within 20
goto x 15 mm y 5 mm z 15 mm
goto x 15 mm y 20 mm z 15 mm
goto x 15 mm y 20 mm z -3 mm
bore B at x 15 y 20 z -3 diameter 12 +-0.01
point far at x 0 y 20 z -3 towards +x
goto x -9 mm y 20 mm z -3 mm
"
    );
    assert_eq!(measured, ["P1", "B", "far"]);
    assert_eq!(figure(&first[0], X), Some(15 * MM));
    let again = run(&routine, &mut plate(Frame::MACHINE)).unwrap();
    let figures = |features: &[Feature]| -> Vec<_> {
        features
            .iter()
            .flat_map(|feature| feature.dimensions.clone())
            .collect()
    };
    assert_eq!(figures(&first), figures(&again));
    assert_eq!(first.len(), 3);
}
