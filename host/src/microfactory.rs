//! The desktop microfactory: `husillo jog`, `husillo send` and `husillo emulate microfactory`.
//!
//! ```text
//! actions, figures ─► crew ─┬► client ─► wire ─┬─► device           simulated time
//!                           ├► client ...      └─► serial, socket   real time
//!                           └► client ...              └─► device ◄─ terminal
//! ```

pub mod figure;

pub use figure::{is_list, program};

use crate::cli::Jog;
use crate::console::reporter::{Reporter, action as action_object, report};
use crate::console::sharing::share;
use crate::console::stop::stop_requests;
use husillo_clients::microfactory::crew::{self, What};
use husillo_clients::microfactory::{Action, BAUD, LEASE, Links, Settings, shares};
use husillo_controllers::MicrofactoryConfig;
use husillo_sim::text::counted;
use husillo_simulator::machines::machine_file::MachineFile;

/// The figure of a device without another one: the original's square with its diagonal, 1000 steps
/// wide.
const FIGURE: [[i16; 2]; 5] = [[1000, 0], [0, 1000], [-1000, 0], [0, -1000], [1000, 1000]];

/// The settings of a machine file. `None` without `[bytes]`: it is no microfactory.
pub fn settings_of(machine: &MachineFile) -> Option<Settings> {
    let table = machine.bytes?;
    let [x, y, z] = machine.axes.as_slice() else {
        return None;
    };
    let small = |steps: u32| u16::try_from(steps).unwrap_or(u16::MAX);
    let pull_off = x.home.as_ref().map_or(200, |home| home.pull_off);
    let slowest = x.max_rate.min(y.max_rate).min(z.max_rate);
    Some(Settings {
        config: MicrofactoryConfig {
            axis_rate_hz: small(slowest),
            backlash_steps: [x, y, z].map(|axis| small(axis.backlash_steps)),
            back_off_steps: small(pull_off),
            ..MicrofactoryConfig::ORIGINAL
        },
        table,
        pull_out_ticks: x.pull_out_ticks(MicrofactoryConfig::ORIGINAL.timer_hz),
        steps: [x, y, z].map(|axis| [axis.step.num, axis.step.den].map(i128::from)),
    })
}

/// `husillo jog`: carries out the actions one after the other, on every machine at once.
///
/// # Errors
///
/// A sentence about the actions, before anything moves.
pub fn jog(args: &Jog, settings: &Settings, out: &mut Reporter<'_>) -> Result<bool, String> {
    let load = |file: &str| figure::load(file, settings);
    let shares = shares(&args.actions, args.port.len(), load)?;
    let figure = figure_of(args.figure.as_deref(), settings)?;
    let links = Links {
        settings,
        bits_per_s: args.baud.unwrap_or(BAUD),
        answers: !args.without_answers,
        figure: &figure,
        lease: lease_of(args.lease, !args.without_answers)?,
        stop: stop_requests()?,
    };
    let crew = links.crew(&args.port, shares)?;
    (args.port.iter()).for_each(|port| share(&args.machine, port, links.bits_per_s));
    let shares = work(crew, out)?;
    if shares.len() > 1 {
        crew::report(&shares, out).map_err(|error| error.to_string())?;
    }
    Ok(is_well(&shares, out))
}

/// Lets all machines work, and tells what they do.
fn work(crew: Vec<crew::Worker>, out: &mut Reporter<'_>) -> Result<Vec<crew::Share>, String> {
    let is_alone = crew.len() == 1;
    crew::work(crew, |said| {
        let number = said.machine + 1;
        let name = match is_alone {
            true => String::new(),
            false => format!("{number}: "),
        };
        out.tell(format_args!("{name}{}", said.what), || match &said.what {
            What::Report(line) => report(number, &said.port, line),
            What::Action(row) => {
                let end = row.end.as_deref().map_err(String::as_str);
                action_object(number, &said.port, &row.action, row.took_s, end)
            }
        });
    })
}

/// Whether all machines have done their work. The failures are printed; objects have them already.
fn is_well(shares: &[crew::Share], out: &Reporter<'_>) -> bool {
    let troubles = crew::troubles(shares);
    let count = troubles.map(|(port, error)| {
        if !out.is_json() {
            eprintln!("error: {port}: {error}");
        }
    });
    count.count() == 0
}

/// `husillo send`: stores a figure in every machine and cuts it, all at once.
///
/// # Errors
///
/// A sentence about the figures or the ports, before anything moves.
pub fn send(
    args: &crate::cli::Send,
    settings: &Settings,
    out: &mut Reporter<'_>,
) -> Result<bool, String> {
    let (files, ports) = (&args.files, &args.port);
    if files.len() != 1 && files.len() != ports.len() {
        return Err(format!(
            "{} for {}: give one for all, or one for each --port",
            counted(files.len(), "figure"),
            counted(ports.len(), "machine")
        ));
    }
    let actions_of = |file: &String| {
        let home = (!args.no_home).then_some(Action::Home);
        let figure = figure::load(file, settings)?;
        Ok(home
            .into_iter()
            .chain([Action::Load(figure), Action::Figure])
            .collect::<Vec<_>>())
    };
    let mut shares = files
        .iter()
        .map(actions_of)
        .collect::<Result<Vec<_>, String>>()?;
    if let [one] = &shares[..] {
        shares = vec![one.clone(); ports.len()];
    }
    let links = Links {
        settings,
        bits_per_s: args.baud.unwrap_or(BAUD),
        answers: !args.without_answers,
        figure: &FIGURE,
        lease: lease_of(args.lease, !args.without_answers)?,
        stop: stop_requests()?,
    };
    let crew = links.crew(ports, shares)?;
    let machine = args.target.machine.as_deref().unwrap_or("microfactory");
    (ports.iter()).for_each(|port| share(machine, port, links.bits_per_s));
    let shares = work(crew, out)?;
    crew::report(&shares, out).map_err(|error| error.to_string())?;
    Ok(is_well(&shares, out))
}

/// `husillo compile -m microfactory`: a figure as a list, which can be edited.
///
/// # Errors
///
/// A sentence about the figure.
pub fn list(file: &str, settings: &Settings) -> Result<String, String> {
    Ok(figure::load(file, settings)?.text())
}

/// The lease in the unit of the device, 10 ms.
fn lease_of(lease_ms: Option<u16>, answers: bool) -> Result<u8, String> {
    let Some(ms) = lease_ms else {
        return Ok(LEASE);
    };
    if ms > 0 && !answers {
        return Err("--lease needs a device that answers".into());
    }
    u8::try_from(ms.div_ceil(10))
        .map_err(|_| format!("--lease {ms}: the lease of a microfactory is at most 2550 ms"))
}

/// The figure of a file, or that of a device without one.
///
/// # Errors
///
/// A sentence about the file.
pub fn figure_of(file: Option<&str>, settings: &Settings) -> Result<Vec<[i16; 2]>, String> {
    file.map_or_else(
        || Ok(FIGURE.to_vec()),
        |file| Ok(figure::load(file, settings)?.moves),
    )
}
