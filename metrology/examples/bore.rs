//! Measures a bore of a simulated part with a touch probe, and prints each figure beside its
//! tolerance.
//!
//! ```sh
//! cargo run -p husillo-metrology --example bore
//! ```

use husillo_metrology::heads::{Head, Line, PRE_TRAVEL_ENTRIES, Stylus};
use husillo_metrology::routine::{Parser, Runner, Site, decimal};
use husillo_metrology::simulated::{
    Bore, Mounted, Piece, Shape, SimulatedNetwork, SimulatedPort, Solid, TouchProbe,
    TouchProbeModel, WorkPiece, three_axes,
};
use husillo_probe::{PreTravel, UnitVector};

/// What the stylus bends before the contact closes: 8 um across it, 1 um along it.
fn pre_travel() -> Option<PreTravel<PRE_TRAVEL_ENTRIES>> {
    let [x, y, z] = [UnitVector::X, UnitVector::Y, UnitVector::Z];
    let across = [x, x.reversed(), y, y.reversed()].map(|direction| (direction, 8_000));
    let along = [z, z.reversed()].map(|direction| (direction, 1_000));
    PreTravel::of(&[across.as_slice(), along.as_slice()].concat())
}

/// A block whose top is 20 mm below the tip, with a bore of 16.01 mm.
fn piece() -> Piece {
    let block = Solid {
        shape: Shape::Box {
            from_mm: [10.0, 10.0, -40.0],
            to_mm: [50.0, 50.0, -20.0],
        },
        bores: vec![Bore {
            from_mm: [30.0, 30.0, -20.0],
            to_mm: [30.0, 30.0, -50.0],
            radius_mm: 8.005,
        }],
    };
    let model = TouchProbeModel {
        ball_radius_mm: 1.0,
        bend_mm: 0.008,
        lobes_mm: 0.0,
        axial_mm: 0.001,
        noise_mm: 0.0005,
    };
    Piece {
        work: WorkPiece {
            solids: vec![block],
            ..WorkPiece::default()
        },
        probe: TouchProbe::new(model, 1),
    }
}

const ROUTINE: &str = "\
safe z -10
point top at x 20 y 20 z -20 +-0.01 towards -z
bore B at x 30 +-0.02 y 30 +-0.02 z -25 diameter 16 +0.03 -0.01 points 8 form 0.02
";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let machine = three_axes();
    let mounted = Mounted::new(piece(), &machine)?;
    let network = SimulatedNetwork::of_machine(&machine, &[], Some(mounted))?;
    let line = Line::new(SimulatedPort::new(network));
    // One touch for each point.
    let mut head = Head::start(line, &machine, 1)?;
    let routine = Parser::file(ROUTINE).map_err(|mistakes| format!("{mistakes:?}"))?;
    let stylus = Stylus {
        radius_nm: 1_000_000,
        pre_travel: pre_travel().ok_or("more directions than there is room for")?,
    };
    let mut runner = Runner::new(Site::new(&mut head, stylus));
    for statement in &routine {
        let Some(feature) = runner.run(statement)? else {
            continue;
        };
        println!("{} {}", feature.keyword, feature.name);
        for figure in &feature.dimensions {
            let verdict = match figure.is_good() {
                Some(true) => "ok",
                Some(false) => "out of tolerance",
                None => "",
            };
            let (name, value) = (figure.figure.name(), decimal(figure.actual_micro));
            println!(
                "    {name:<10} {value:>10} {:<3} {verdict}",
                figure.figure.unit()
            );
        }
    }
    Ok(())
}
