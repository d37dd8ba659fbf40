//! The machines that `husillo serve` operates.

use super::job::load;
use super::{Failure, grbl, milling};
use crate::cli::Serve;
use crate::measuring::{self, Stopped};
use crate::serve::{Factory, Family, MeasuringMachine, Served};
use husillo_gcode::Dialect;
use husillo_simulator::programs::setup;
use std::iter::repeat_n;
use std::sync::Arc;

/// The machines of the command line: one for each port. One machine is that of all ports, and one
/// simulated port is that of all machines.
///
/// # Errors
///
/// The numbers of ports and machines differ, or a machine cannot be read.
pub fn machines(args: &Serve) -> Result<Vec<Served>, Failure> {
    let (names, ports) = (&args.machine, &args.port);
    let pairs: Vec<(&String, &String)> = match (&names[..], &ports[..]) {
        ([name], ports) => repeat_n(name, ports.len()).zip(ports).collect(),
        (names, [port]) if port == "sim" => names.iter().zip(repeat_n(port, names.len())).collect(),
        (names, ports) if names.len() == ports.len() => names.iter().zip(ports).collect(),
        (names, ports) => {
            let (names, ports) = (names.len(), ports.len());
            return Err(format!("{names} machines need as many ports, not {ports}").into());
        }
    };
    let served = pairs.into_iter().map(|(name, port)| {
        Ok(Served {
            family: family(name, port, args.piece.as_deref())?,
            port: port.clone(),
        })
    });
    served.collect()
}

/// The family of a machine.
fn family(name: &str, port: &str, piece: Option<&str>) -> Result<Family, Failure> {
    if measuring::is_measuring(name) {
        let machine =
            measuring::machine_file::load(name).map_err(|error| of(Stopped::File(error)))?;
        let network = measuring::network_to_try(piece, &machine).map_err(of)?;
        return Ok(Family::Measuring(Box::new(MeasuringMachine {
            name: name.to_owned(),
            machine,
            network,
        })));
    }
    if name == "drill" {
        return Ok(Family::Drill);
    }
    if let Some(settings) = super::microfactory(name)? {
        let file = load(name)?;
        return Ok(Family::Microfactory(Arc::new(Factory { file, settings })));
    }
    if !milling::is_mill(name) {
        return Ok(Family::Grbl(Box::new(grbl::simulated(name)?)));
    }
    let file = load(name)?;
    let config = setup::first_three(&setup::config(&file, Dialect::MICROMILL)?);
    milling::expect_a_port(port, &config)?;
    Ok(Family::Micromill {
        file: Arc::new(file),
        config: Box::new(config),
    })
}

/// A machine file or a work piece that cannot be read.
fn of(stopped: Stopped) -> Failure {
    match super::ended(Err(stopped)) {
        Err(failure) => failure,
        // Nothing else is reported by what reads them.
        Ok(_) => Failure::Usage("the machine cannot be read".into()),
    }
}
