//! `husillo machines`.

mod new;

use super::job::load;
use super::{Failure, OK, own_output, write};
use crate::cli::{Machines, MachinesAction, Output};
use crate::console;
use crate::console::shown;
use husillo_simulator::machines::listing;
use husillo_simulator::machines::machine_file::{MEASURING, MachineFile};
use husillo_simulator::text::json::write_line;
use husillo_simulator::text::name;
use serde_json::json;
use std::io::Write;
use std::path::Path;

/// Lists, shows and writes machine files.
pub fn show_machines(args: &Machines) -> Result<u8, Failure> {
    let out = &mut console::stdout();
    match &args.action {
        None if args.format == Output::Json => {
            let list = json!({"machines": listing::machines()?});
            write_line("husillo.machines/1", &list, out)?;
        }
        None => out.write_all(listing::list()?.as_bytes())?,
        Some(MachinesAction::New(args)) => return new::make(args),
        Some(MachinesAction::Write {
            machine,
            file,
            format,
        }) => return write_machine(machine, file, *format),
        Some(MachinesAction::Show { machine, format }) if MachineFile::is_measuring(machine) => {
            // Its file contains all that is known of it.
            let text = MachineFile::text_of(machine).unwrap_or_default();
            match format {
                Output::Text => out.write_all(text.as_bytes())?,
                Output::Json => {
                    let file: toml::Table =
                        toml::from_str(text).map_err(|error| error.to_string())?;
                    let shown = json!({"name": machine, "title": file.get("title"), "file": file});
                    write_line("husillo.machines.measuring/1", &shown, out)?;
                }
            }
        }
        Some(MachinesAction::Show { machine, format }) => {
            let shown = listing::show(&load(machine)?);
            match format {
                Output::Text => out.write_all(shown.text().as_bytes())?,
                Output::Json => write_line("husillo.machines.show/1", &shown, out)?,
            }
        }
    }
    Ok(OK)
}

/// Writes the file of a built-in machine. An existing file is not replaced.
fn write_machine(machine: &str, file: &Option<String>, format: Output) -> Result<u8, Failure> {
    let Some(text) = MachineFile::text_of(machine) else {
        let names = MachineFile::names().join(", ");
        let measuring = MEASURING.map(|(name, ..)| name).join(", ");
        let why = format!("no machine `{machine}`: {names}, {measuring} are built in");
        return Err(Failure::Usage(why));
    };
    let file = match file.as_deref() {
        Some(file) => file.to_owned(),
        None => format!("{machine}.toml"),
    };
    write_new(machine, &file, text, format)?;
    Ok(OK)
}

/// Writes a machine file that does not exist yet; `-` is standard output.
fn write_new(machine: &str, file: &str, text: &str, format: Output) -> Result<(), Failure> {
    if own_output(Some(file), format)? == "-" {
        console::stdout().write_all(text.as_bytes())?;
        return Ok(());
    }
    if std::fs::symlink_metadata(name::path(Path::new(file))).is_ok() {
        let why = "exists already, and nothing is written: name another file";
        return Err(Failure::Usage(format!("{file} {why}")));
    }
    write(file, text.as_bytes())?;
    if format == Output::Json {
        let body = json!({"name": machine, "file": file});
        write_line("husillo.machines.file/1", &body, &mut console::stdout())?;
        return Ok(());
    }
    writeln!(
        console::stdout(),
        "Wrote      {} - use it with -m",
        shown(file)
    )?;
    Ok(())
}
