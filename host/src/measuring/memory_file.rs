//! The file in which a session with a measuring machine keeps what the next one needs: homes, zeros
//! and positions of the axes.

use crate::cli::Measure;
use husillo_backlash::Flank;
use husillo_metrology::heads::{AxisMemory, End, Machine, Memory};
use husillo_simulator::machines::machine_file::MachineFile;
use husillo_transports::nmc::Baud;
use serde::{Deserialize, Serialize};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The contents of the file.
#[derive(Serialize, Deserialize)]
struct Kept {
    port: String,
    machine: String,
    /// The length of a million counts. With another scale the zeros are not valid.
    million_counts: String,
    /// Rate of the line, bits/s.
    baud: u32,
    /// Whether a session uses the machine, or was killed while it did.
    in_use: bool,
    axis: Vec<KeptAxis>,
}

/// An axis in the file.
#[derive(Serialize, Deserialize)]
struct KeptAxis {
    letter: char,
    module: u8,
    counts: i32,
    latched: i32,
    held: bool,
    homed: bool,
    origin: i32,
    /// Nanometres, or counts where the length of a count is not known.
    zero: i64,
    /// Direction of the last move: 1, -1, or 0 if it is not known.
    direction: i8,
    /// The end switch that the axis holds: 1 high, -1 low, 0 none or not known.
    #[serde(default)]
    end: i8,
}

/// The memory of a machine at a port.
#[derive(Clone, Debug)]
pub struct MemoryFile {
    path: PathBuf,
    port: String,
    machine: String,
    million_counts: String,
}

impl MemoryFile {
    /// Finds the file for the port of the arguments. `None`: the port is simulated and has no
    /// memory, or the user has no folder for it.
    pub fn of(args: &Measure, machine: &Machine) -> Option<Self> {
        Self::at(
            args.machine.as_deref().unwrap_or("cmm"),
            &args.port,
            machine,
        )
    }

    /// Finds the file by the names of the machine and of the port.
    pub fn at(name: &str, port: &str, machine: &Machine) -> Option<Self> {
        let (path, port) = place(port)?;
        let scale = machine.scale;
        Some(Self {
            path,
            port,
            machine: match MachineFile::is_built_in(name) {
                true => name.to_owned(),
                false => absolute(name),
            },
            million_counts: scale.text(scale.of_counts(1_000_000)),
        })
    }

    /// Reads the memory of this machine at this port.
    pub fn read(&self) -> Option<Memory> {
        let kept: Kept = toml::from_str(&fs::read_to_string(&self.path).ok()?).ok()?;
        let is_mine = kept.port == self.port
            && kept.machine == self.machine
            && kept.million_counts == self.million_counts;
        let baud = Baud::ALL
            .into_iter()
            .find(|baud| baud.bits_per_s() == kept.baud)?;
        let axes = kept.axis.iter().map(|axis| AxisMemory {
            letter: axis.letter,
            module: axis.module,
            counts: axis.counts,
            latched: axis.latched,
            is_held: axis.held,
            is_homed: axis.homed,
            origin: axis.origin,
            zero: axis.zero,
            flank: match axis.direction {
                1 => Flank::Positive,
                -1 => Flank::Negative,
                _ => Flank::Unknown,
            },
            end: match axis.end {
                1 => Some(End::High),
                -1 => Some(End::Low),
                _ => None,
            },
        });
        let axes = axes.collect();
        is_mine.then_some(Memory {
            baud,
            in_use: kept.in_use,
            axes,
        })
    }

    /// Writes the memory. It is written to a temporary file that is then renamed, so that the file
    /// is always complete.
    ///
    /// # Errors
    ///
    /// The folder or the file cannot be written.
    pub fn write(&self, memory: &Memory) -> io::Result<()> {
        let axes = memory.axes.iter().map(|axis| KeptAxis {
            letter: axis.letter,
            module: axis.module,
            counts: axis.counts,
            latched: axis.latched,
            held: axis.is_held,
            homed: axis.is_homed,
            origin: axis.origin,
            zero: axis.zero,
            direction: match axis.flank {
                Flank::Positive => 1,
                Flank::Negative => -1,
                Flank::Unknown => 0,
            },
            end: match axis.end {
                Some(End::High) => 1,
                Some(End::Low) => -1,
                None => 0,
            },
        });
        let kept = Kept {
            port: self.port.clone(),
            machine: self.machine.clone(),
            million_counts: self.million_counts.clone(),
            baud: memory.baud.bits_per_s(),
            in_use: memory.in_use,
            axis: axes.collect(),
        };
        let text = toml::to_string(&kept).map_err(io::Error::other)?;
        if let Some(folder) = self.path.parent() {
            fs::create_dir_all(folder)?;
        }
        let beside = self
            .path
            .with_extension(format!("{}.new", std::process::id()));
        fs::write(&beside, text)?;
        fs::rename(&beside, &self.path).inspect_err(|_| drop(fs::remove_file(&beside)))
    }

    /// Deletes the memory: the state of the modules is no longer known.
    pub fn forget(&self) {
        // A missing file means the same.
        let _ = fs::remove_file(&self.path);
    }
}

/// Deletes the memory of a port, because its modules are about to be reset.
pub fn forget(port: &str) {
    if let Some((path, _)) = place(port) {
        let _ = fs::remove_file(path);
    }
}

/// The path of the file of a port, and the name of its device, which is the same for every link to
/// it.
fn place(port: &str) -> Option<(PathBuf, String)> {
    if matches!(port, "sim" | "line") {
        return None;
    }
    let name = absolute(port);
    let letter = |letter: char| match letter {
        'a'..='z' | 'A'..='Z' | '0'..='9' | '.' => letter,
        _ => '-',
    };
    let file: String = name.trim_start_matches('/').chars().map(letter).collect();
    Some((folder()?.join(format!("measure-{file}.toml")), name))
}

/// Resolves a path and its links. A name that is not a file stays.
fn absolute(name: &str) -> String {
    let path = fs::canonicalize(husillo_simulator::text::name::path(Path::new(name)));
    path.map_or_else(|_| name.to_owned(), |path| path.display().to_string())
}

/// The folder for what this program remembers: `$XDG_STATE_HOME/husillo`, or
/// `~/.local/state/husillo`.
pub fn folder() -> Option<PathBuf> {
    let absolute = |name| {
        let path = PathBuf::from(std::env::var_os(name)?);
        path.is_absolute().then_some(path)
    };
    let state = absolute("XDG_STATE_HOME").or_else(|| {
        let home = absolute("HOME")?;
        Some(home.join(Path::new(".local/state")))
    });
    Some(state?.join("husillo"))
}
