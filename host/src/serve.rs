//! `husillo serve`: machines operated from a browser.
//!
//! ```text
//! page ──► site ──► socket ──► machine ══► driver ──► session ──► controller
//!                     ▲            │  state, console
//!                     └────────────┘
//! ```
//!
//! Each machine has a thread with a [`driver`], which owns the link. The pages run in one thread.
//! [`machine`] is what both share. A state replaces the state before it, so a slow page holds
//! nothing up. [`mqtt`] and [`mtconnect`] read the same states for others than pages.

mod access;
mod axes;
mod console_lines;
mod continuation;
mod control;
mod controller_machine;
mod drill_program;
mod driver;
mod family;
mod figure_program;
mod lease;
mod loaded;
mod machine;
mod machine_state;
mod macros;
mod mill_program;
mod mqtt;
mod mtconnect;
mod page;
mod program_file;
mod reply;
mod request;
mod run_record;
mod site;
mod socket;
mod timetable;
mod tool_changes;
mod tool_path;

use crate::app::Failure;
use crate::cli::Serve;
use crate::console::reporter::Reporter;
use crate::console::sharing::share;
use crate::console::stop::{INTERRUPTED, stop_requests, stops_asked};
use access::Access;
use driver::Port;
pub use family::{Family, MeasuringMachine};
pub use figure_program::Factory;
use machine::Machine;
use macros::MacroFile;
use serde_json::json;
use std::io::Write as _;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::net::TcpListener;
use tokio::sync::watch;

/// Interval of the checks for Ctrl-C.
const LOOK: Duration = Duration::from_millis(50);
/// At the end of the program the machines have stopped within this time.
const END: Duration = Duration::from_secs(10);

/// A machine of the command line.
#[derive(Clone, Debug)]
pub struct Served {
    /// Its family.
    pub family: Family,
    /// The port of its controller.
    pub port: String,
}

/// Serves the page of these machines until Ctrl-C.
///
/// # Errors
///
/// A sentence about the address.
pub fn serve(args: &Serve, served: &[Served], out: &mut Reporter<'_>) -> Result<u8, Failure> {
    if args.mtconnect_devices {
        let machines = (1..).zip(served);
        let described: Vec<_> = machines
            .map(|(number, Served { family, port })| machine::described(number, family, port))
            .collect();
        write!(out, "{}", mtconnect::document(&described, &host_name()))?;
        return Ok(super::app::OK);
    }
    stop_requests()?;
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()?;
    let ended = runtime.block_on(serve_pages(args, served, out));
    // The end does not wait for the look-up of a broker's name, or for the check of a program.
    runtime.shutdown_background();
    ended
}

async fn serve_pages(
    args: &Serve,
    served: &[Served],
    out: &mut Reporter<'_>,
) -> Result<u8, Failure> {
    let of_address = |error| Failure::Usage(format!("{}: {error}", args.listen));
    let listener = TcpListener::bind(&args.listen).await.map_err(of_address)?;
    let address = listener.local_addr().map_err(of_address)?;
    let access = Access::new(address, &args.host).map_err(Failure::Usage)?;
    let macros = MacroFile::new(args.macros.as_deref()).map_err(Failure::Usage)?;
    let macros = Arc::new(macros);
    let (news, _) = watch::channel(0);
    let mut machines = Vec::new();
    for (number, Served { family, port }) in (1..).zip(served) {
        let baud = args.baud.unwrap_or(family.baud());
        share(family.name(), port, baud);
        let (machine, requests) = Machine::new(
            number,
            family,
            port,
            args.watch_only,
            Arc::clone(&macros),
            news.clone(),
        );
        let machine = Arc::new(machine);
        let port = Port {
            name: port.clone(),
            baud,
            speed: args.speed,
        };
        driver::start(Arc::clone(&machine), family.clone(), port, requests);
        machines.push(machine);
    }
    if let Some(address) = &args.mtconnect {
        let of_address = |error| Failure::Usage(format!("{address}: {error}"));
        let listener = TcpListener::bind(address).await.map_err(of_address)?;
        tokio::spawn(mtconnect::serve(listener, machines.clone(), news.clone()));
    }
    let broker = match &args.cell.mqtt {
        Some(url) => {
            let link = mqtt::Link::start(url, &args.cell, &machines, &news);
            Some(link.map_err(Failure::Usage)?)
        }
        None => None,
    };
    let link = access.link();
    out.tell(
        format!("Open {link}\nCtrl-C stops the machines and ends"),
        || json!({"kind": "open", "url": link, "address": address.to_string()}),
    );
    let site = site::router(Arc::new(access), machines.clone(), news);
    tokio::select! {
        ended = axum::serve(listener, site) => ended?,
        () = ended(&machines, args.seconds) => {}
    }
    if let Some(broker) = broker {
        broker.end().await;
    }
    Ok(match stops_asked() {
        0 => super::app::OK,
        _ => INTERRUPTED,
    })
}

/// Waits for Ctrl-C or the end of the time, then stops the machines.
async fn ended(machines: &[Arc<Machine>], seconds: Option<f64>) {
    let begun = Instant::now();
    let is_over = || seconds.is_some_and(|most| begun.elapsed().as_secs_f64() >= most);
    while stops_asked() == 0 && !is_over() {
        tokio::time::sleep(LOOK).await;
    }
    for machine in machines {
        machine.end();
    }
    let begun = Instant::now();
    while machines.iter().any(|machine| !machine.is_ended()) && begun.elapsed() < END {
        tokio::time::sleep(LOOK).await;
    }
}

/// The name of this computer.
fn host_name() -> String {
    #[cfg(unix)]
    let name = nix::unistd::gethostname().ok();
    #[cfg(not(unix))]
    let name = std::env::var_os("COMPUTERNAME");
    let name = name.map(|name| name.to_string_lossy().into_owned());
    name.filter(|name| !name.is_empty())
        .unwrap_or_else(|| "husillo".to_owned())
}
