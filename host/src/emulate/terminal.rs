//! `husillo emulate`: a simulated device behind a pseudo-terminal, in real time.

use crate::emulate::emulation::Emulation;
use crate::measuring::read_port;
use serialport::{SerialPort, TTYPort};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// Periods that are made up for at most when the computer was busy; what is beyond is left out.
const MOST_BEHIND: u64 = 2000;

/// How fast and how long an emulation runs.
pub struct Pace {
    /// Multiple of real time.
    pub speed: f64,
    /// End after so long.
    pub limit: Option<Duration>,
    /// End when this is set.
    pub is_over: Arc<AtomicBool>,
}

/// A pseudo-terminal with a name of its own, until it is dropped.
pub struct Terminal {
    master: TTYPort,
    /// Kept open, so that clients may come and go and find it raw.
    _slave: TTYPort,
    link: PathBuf,
    /// What the device makes goes there.
    steps: Option<Box<dyn Write>>,
}

impl Terminal {
    /// Makes one whose client's end is found at `link`.
    ///
    /// # Errors
    ///
    /// There is no pseudo-terminal to be had, or something else has that name.
    pub fn new(link: &Path) -> io::Result<Self> {
        let (mut master, slave) = TTYPort::pair()?;
        // Waiting for a byte is also what paces the simulation.
        master.set_timeout(Duration::from_millis(2))?;
        let name = slave.name().ok_or(ErrorKind::NotFound)?;
        let is_symlink = std::fs::symlink_metadata(link).is_ok_and(|old| old.is_symlink());
        if is_symlink && !link.exists() {
            // It leads nowhere: left by a run that was killed.
            std::fs::remove_file(link)?;
        }
        std::os::unix::fs::symlink(name, link)?;
        Ok(Self {
            master,
            _slave: slave,
            link: link.to_owned(),
            steps: None,
        })
    }

    /// The same; what the device makes goes to a file.
    #[must_use]
    pub fn with_steps(mut self, steps: Option<Box<dyn Write>>) -> Self {
        self.steps = steps;
        self
    }

    /// Runs the device at `speed` times real time until told to stop, or for some time. Lines of standard input are its panel, and what
    /// it tells goes to `out`.
    ///
    /// # Errors
    ///
    /// The terminal fails.
    pub fn run<E: Emulation>(
        &mut self,
        device: &mut E,
        pace: &Pace,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let panel = crate::link::wire::typed_lines();
        let (start, mut done, mut left_out) = (Instant::now(), 0_u64, 0_u64);
        let mut is_plugged = true;
        let is_over = || {
            let is_late = pace.limit.is_some_and(|limit| start.elapsed() >= limit);
            is_late || pace.is_over.load(Ordering::Relaxed)
        };
        while !is_over() {
            for byte in read_port(&mut self.master)? {
                if is_plugged {
                    device.send(byte);
                }
            }
            while let Ok(line) = panel.try_recv() {
                let line = line.trim();
                // The cable is the same for every device.
                let answer = match line {
                    "unplug" | "plug" => {
                        is_plugged = line == "plug";
                        if is_plugged {
                            "plugged in"
                        } else {
                            "unplugged"
                        }
                        .to_owned()
                    }
                    _ => device.control(line),
                };
                writeln!(out, "{answer}")?;
            }
            let periods = start.elapsed().as_secs_f64() * pace.speed * 1e9 / E::PERIOD_NS as f64;
            let behind = (periods as u64).saturating_sub(done + left_out);
            left_out += behind.saturating_sub(MOST_BEHIND);
            for _ in 0..behind.min(MOST_BEHIND) {
                done += 1;
                let bytes = device.tick();
                if !bytes.is_empty() && is_plugged {
                    self.write(&bytes)?;
                }
            }
            let told = device.tell();
            for line in &told {
                writeln!(out, "{line}")?;
            }
            out.flush()?;
            if let Some(steps) = &mut self.steps {
                steps.write_all(device.made().as_bytes())?;
                // Somebody may read it as it grows.
                steps.flush()?;
            }
        }
        Ok(())
    }

    /// What nobody reads is lost, as on a line.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self.master.write_all(bytes) {
            Err(error) if error.kind() != ErrorKind::TimedOut => Err(error),
            _ => Ok(()),
        }
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        // Somebody may have removed it already.
        let _ = std::fs::remove_file(&self.link);
    }
}

/// A flag that Ctrl-C and a request to end set.
///
/// # Errors
///
/// The system does not hand them over.
pub fn stop_flag() -> Result<Arc<AtomicBool>, String> {
    let flag = Arc::new(AtomicBool::new(false));
    let set = Arc::clone(&flag);
    ctrlc::set_handler(move || {
        STOPS_ASKED.fetch_add(1, Ordering::Relaxed);
        set.store(true, Ordering::Relaxed);
    })
    .map_err(|error| error.to_string())?;
    Ok(flag)
}

/// How often that was asked for.
static STOPS_ASKED: AtomicU32 = AtomicU32::new(0);

/// How often Ctrl-C was pressed, or the end was asked for.
pub fn stops_asked() -> u32 {
    STOPS_ASKED.load(Ordering::Relaxed)
}
