//! The ports of this program, shared with other programs for one purpose: a stop.

#[cfg(unix)]
use husillo_clients::holder::{Holder, Listening, Urgency, folder};
#[cfg(unix)]
use husillo_simulator::machines::machine_file::MachineFile;
#[cfg(unix)]
use husillo_simulator::text;
#[cfg(unix)]
use std::path::Path;
#[cfg(unix)]
use std::sync::{Mutex, PoisonError};

/// What keeps the ports shared.
#[cfg(unix)]
static SHARED: Mutex<Vec<Listening>> = Mutex::new(Vec::new());

/// From now on `husillo stop` reaches this program by the name of the port, and is a Ctrl-C here.
/// Without it the machine still works, so a failure is a warning.
#[cfg(unix)]
pub fn share(machine: &str, port: &str, bits_per_s: u32) {
    if port == "sim" {
        return;
    }
    let words = std::env::args_os().skip(1);
    let words: Vec<_> = words
        .map(|word| word.to_string_lossy().into_owned())
        .collect();
    let holder = Holder {
        process: std::process::id(),
        command: words.join(" "),
        machine: machine_from_anywhere(machine),
        port: from_anywhere(port),
        bits_per_s,
    };
    let stop = |urgency| {
        let requests = if urgency == Urgency::Emergency { 2 } else { 1 };
        for _ in 0..requests {
            // Two signals that wait at the same time count as one.
            super::stop::request();
        }
    };
    let folder = folder().ok_or_else(|| "no folder of the user for a socket".to_owned());
    match folder.and_then(|folder| {
        holder
            .listen(&folder, stop)
            .map_err(|error| error.to_string())
    }) {
        Ok(listening) => SHARED
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(listening),
        Err(why) => eprintln!("warning: {port}: `husillo stop` cannot reach this program: {why}"),
    }
}

/// [`from_anywhere`] for a machine: a built-in machine has the same name everywhere.
#[cfg(unix)]
pub fn machine_from_anywhere(name: &str) -> String {
    match MachineFile::is_built_in(name) {
        true => name.to_owned(),
        false => from_anywhere(name),
    }
}

/// A name that is also valid in the folders of other programs: the absolute path of a file.
#[cfg(unix)]
fn from_anywhere(name: &str) -> String {
    // `#2` names a machine of the controller at the port.
    let file = name.split('#').next().unwrap_or(name);
    let [file, whole] = [file, name].map(|name| text::name::path(Path::new(name)));
    match std::path::absolute(whole) {
        Ok(path) if file.exists() => text::name::text(path.as_os_str()),
        _ => name.to_owned(),
    }
}

/// No other program can request a stop on this system.
#[cfg(not(unix))]
pub fn share(_machine: &str, _port: &str, _bits_per_s: u32) {}

/// Ends the sharing of all ports, before the program ends.
#[cfg(unix)]
pub fn end() {
    SHARED
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .clear();
}

/// Nothing is shared.
#[cfg(not(unix))]
pub fn end() {}
