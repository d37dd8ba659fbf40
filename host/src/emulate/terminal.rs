//! `husillo emulate`: a simulated device behind a pseudo-terminal or a socket, in real time.

use crate::cli::Emulate;
use crate::console::reporter::Reporter;
use crate::console::stop::stop_requests;
use crate::console::typed::typed_lines;
use husillo_clients::{StopRequests, read};
use husillo_sim::device::Emulation;
use husillo_simulator::text::name as file_name;
use serde_json::{Value, json};
use serialport::{SerialPort, TTYPort};
use std::io::{self, ErrorKind, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Most periods that are caught up after the computer was busy. The rest is left out.
const MOST_BEHIND: u64 = 2000;
/// The longest time for catching up, so that a busy computer still answers bytes soon.
const CATCH_UP: Duration = Duration::from_millis(5);
/// The wait for a byte paces the simulation.
const LOOK: Duration = Duration::from_millis(2);
/// The same while bytes come and go, so that little is added to their times.
const BUSY_LOOK: Duration = Duration::from_micros(200);
/// Bytes come and go for so long after the last one.
const BUSY: Duration = Duration::from_millis(20);

/// Bytes on the line to the device from which on no more are taken from a client. It waits then, as
/// it does at a serial port. The bytes of one read may come on top.
const MOST_ON_THE_LINE: usize = 1024;
/// Lines of the panel that are carried out at once.
const PANEL_LINES: usize = 16;

/// Rate of a port before a client sets one, bits/s.
const FIRST_RATE: u32 = 19200;

/// Speed and duration of an emulation.
struct Pace {
    /// Multiple of real time.
    speed: f64,
    /// Duration of the emulation.
    limit: Option<Duration>,
    /// End when this is set.
    is_over: StopRequests,
}

/// Runs a device behind the port that the options name, until Ctrl-C or for the time asked for.
///
/// `name` opens the text that is printed first. `hint` is a command that connects, with `{port}` in
/// place of the port. The events that the device makes go to `steps`.
///
/// # Errors
///
/// The port, the file of steps or `out`: each error names what it is about. Its kind is
/// [`ErrorKind::BrokenPipe`] only where the reader of `out` has gone.
pub fn serve<E: Emulation>(
    device: &mut E,
    args: &Emulate,
    steps: Option<Box<dyn Write>>,
    out: &mut dyn Write,
    [name, hint, panel]: [&str; 3],
) -> io::Result<()> {
    let pace = Pace {
        speed: args.speed,
        limit: args.seconds.map(Duration::from_secs_f64),
        is_over: stop_requests().map_err(io::Error::other)?,
    };
    let asked = args.port();
    let outlet = match (&args.link, &args.listen) {
        (Some(link), _) => Outlet::terminal(&file_name::path(Path::new(link))),
        (None, Some(address)) => Outlet::socket(address),
        (None, None) => Err(ErrorKind::InvalidInput.into()),
    };
    let opened = outlet.and_then(|outlet| Ok((outlet.port()?, outlet)));
    let (port, outlet) = opened.map_err(|error| of_port(&asked, &error))?;
    let hint = hint.replace("{port}", &port);
    let out = &mut Reporter::new(out, args.format, "husillo.emulate/1");
    let heading = format!("{name} at {port}; Ctrl-C ends it\nConnect: {hint}\nPanel: {panel}");
    let mut server = Server {
        outlet,
        asked,
        steps,
    };
    let open = json!({
        "kind": "open",
        "machine": args.machine,
        "port": port,
        "connect": hint,
        "panel": panel,
    });
    print(out, &heading, open)?;
    server.run(device, &pace, out)
}

/// Prints a line or its object at once.
fn print(out: &mut Reporter<'_>, line: &str, object: Value) -> io::Result<()> {
    out.tried(line, &object)
        .map_err(|error| io::Error::new(error.kind(), format!("standard output: {error}")))
}

/// The error of a port, with the name that the user gave.
fn of_port(asked: &str, error: &io::Error) -> io::Error {
    let why = match error.kind() {
        ErrorKind::AlreadyExists => "a file has this name: choose another name for the link",
        ErrorKind::NotFound => "there is no folder for this link: choose another name",
        ErrorKind::PermissionDenied => "you may not make this link: choose a folder of yours",
        ErrorKind::AddrInUse => "another program listens there: choose another address",
        ErrorKind::AddrNotAvailable => "this computer has no such address: choose another one",
        _ => return io::Error::other(format!("{asked}: {error}")),
    };
    io::Error::other(format!("{asked}: {why}"))
}

/// Where clients connect.
enum Outlet {
    /// A pseudo-terminal with a name of its own, until it is dropped.
    Terminal {
        master: TTYPort,
        /// Kept open, so that clients may connect one after another and find it in raw mode. It has
        /// the rate that they set.
        slave: TTYPort,
        link: PathBuf,
    },
    /// A socket for one client at a time. It refuses a second one.
    Socket {
        listener: TcpListener,
        client: Option<TcpStream>,
    },
}

impl Outlet {
    /// A pseudo-terminal whose client's end is found at `link`.
    fn terminal(link: &Path) -> io::Result<Self> {
        let leads_nowhere = !link.exists();
        let (master, mut slave) = TTYPort::pair()?;
        // For clients that set no rate.
        slave.set_baud_rate(FIRST_RATE)?;
        let name = slave.name().ok_or(ErrorKind::NotFound)?;
        if let Ok(old) = std::fs::read_link(link) {
            // A killed program has left it: it leads nowhere, or to the number of its terminal,
            // which this one has now.
            if leads_nowhere || old == Path::new(&name) {
                std::fs::remove_file(link)?;
            }
        }
        std::os::unix::fs::symlink(name, link)?;
        Ok(Self::Terminal {
            master,
            slave,
            link: link.to_owned(),
        })
    }

    /// A socket that listens; port 0: a free one.
    fn socket(address: &str) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        Ok(Self::Socket {
            listener,
            client: None,
        })
    }

    /// What a client names as its port.
    fn port(&self) -> io::Result<String> {
        match self {
            Self::Terminal { link, .. } => Ok(file_name::text(link.as_os_str())),
            Self::Socket { listener, .. } => Ok(format!("tcp:{}", listener.local_addr()?)),
        }
    }

    /// The rate that the client has set, bits/s. A socket has none.
    fn rate(&self) -> Option<u32> {
        match self {
            Self::Terminal { slave, .. } => slave.baud_rate().ok(),
            Self::Socket { .. } => None,
        }
    }

    /// The bytes that a client has sent. Waits this time for them.
    fn read(&mut self, look: Duration) -> io::Result<Vec<u8>> {
        match self {
            Self::Terminal { master, .. } => {
                master.set_timeout(look)?;
                read(master)
            }
            Self::Socket { listener, client } => {
                // The last bytes of a client that has left are read before the next one connects.
                let has_bytes = |client: &TcpStream| matches!(peek(client), Ok(1..));
                let accepted = match client.as_ref().is_some_and(has_bytes) {
                    true => Err(ErrorKind::WouldBlock.into()),
                    false => listener.accept(),
                };
                match accepted {
                    // A dropped connection refuses its client.
                    Ok((new, _)) if client.as_ref().is_none_or(has_left) => {
                        new.set_nodelay(true)?;
                        new.set_nonblocking(false)?;
                        new.set_write_timeout(Some(LOOK))?;
                        *client = Some(new);
                    }
                    Ok(_) => {}
                    Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                    Err(error) => return Err(error),
                }
                let Some(connected) = client else {
                    std::thread::sleep(LOOK);
                    return Ok(Vec::new());
                };
                connected.set_read_timeout(Some(look))?;
                match read(connected) {
                    Ok(bytes) => Ok(bytes),
                    // The client has left, so the next one may connect.
                    Err(_) => {
                        *client = None;
                        Ok(Vec::new())
                    }
                }
            }
        }
    }

    /// Bytes without a reader are lost, as on a line.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let written = match self {
            Self::Terminal { master, .. } => master.write_all(bytes),
            Self::Socket { client, .. } => {
                // A read shows that a client has left.
                let _ = client.as_mut().map(|client| client.write_all(bytes));
                Ok(())
            }
        };
        match written {
            Err(error) if error.kind() != ErrorKind::TimedOut => Err(error),
            _ => Ok(()),
        }
    }
}

/// Whether a client has closed its connection.
fn has_left(client: &TcpStream) -> bool {
    match peek(client) {
        Ok(bytes) => bytes == 0,
        Err(error) => error.kind() != ErrorKind::WouldBlock,
    }
}

/// Number of bytes of a client that can be read, 0 or 1, without waiting. 0: it has left.
fn peek(client: &TcpStream) -> io::Result<usize> {
    client.set_nonblocking(true)?;
    let bytes = client.peek(&mut [0]);
    client.set_nonblocking(false)?;
    bytes
}

impl Drop for Outlet {
    fn drop(&mut self) {
        if let Self::Terminal { link, .. } = self {
            // Another program may have removed it already.
            let _ = std::fs::remove_file(link);
        }
    }
}

/// A device that is served.
struct Server {
    outlet: Outlet,
    /// The port, as it was asked for.
    asked: String,
    /// What the device makes goes there.
    steps: Option<Box<dyn Write>>,
}

impl Server {
    /// Runs the device at a multiple of real time. Lines of standard input are its panel, and what
    /// it reports goes to `out`.
    fn run<E: Emulation>(
        &mut self,
        device: &mut E,
        pace: &Pace,
        out: &mut Reporter<'_>,
    ) -> io::Result<()> {
        let panel = typed_lines();
        let (start, mut done, mut left_out) = (Instant::now(), 0_u64, 0_u64);
        let mut is_plugged = true;
        let mut last_byte = start;
        let is_over = || {
            let is_late = pace.limit.is_some_and(|limit| start.elapsed() >= limit);
            is_late || pace.is_over.is_asked()
        };
        while !is_over() {
            let look = if last_byte.elapsed() < BUSY {
                BUSY_LOOK
            } else {
                LOOK
            };
            let received = if device.on_the_line() < MOST_ON_THE_LINE {
                let received = self.outlet.read(look);
                received.map_err(|error| of_port(&self.asked, &error))?
            } else {
                std::thread::sleep(look);
                Vec::new()
            };
            // A client sets its rate before it sends.
            device.set_host_rate(self.outlet.rate());
            if !received.is_empty() {
                last_byte = Instant::now();
            }
            let mut shown = Vec::new();
            for line in panel.try_iter().take(PANEL_LINES) {
                shown.push(typed(device, line.trim(), &mut is_plugged));
            }
            let periods = start.elapsed().as_secs_f64() * pace.speed * 1e9 / E::PERIOD_NS as f64;
            let behind = (periods as u64).saturating_sub(done + left_out);
            let (simulated, has_sent) = self.catch_up(device, behind, is_plugged)?;
            done += simulated;
            left_out += behind - simulated;
            if has_sent {
                last_byte = Instant::now();
            }
            // At the present time of the simulation, so that no reply comes sooner than on a line.
            for byte in received {
                if is_plugged {
                    device.send(byte);
                }
            }
            shown.extend(device.take_reports());
            for line in shown {
                print(out, &line, json!({"kind": "report", "text": line}))?;
            }
            if let Some(steps) = &mut self.steps {
                let written = steps.write_all(device.made().as_bytes());
                // Another program may read it as it grows. The error names the file.
                written
                    .and_then(|()| steps.flush())
                    .map_err(|error| io::Error::other(error.to_string()))?;
            }
        }
        Ok(())
    }

    /// Simulates at most this number of periods, as many as there is time for. Returns their
    /// number, and whether the device has sent anything.
    fn catch_up<E: Emulation>(
        &mut self,
        device: &mut E,
        behind: u64,
        is_plugged: bool,
    ) -> io::Result<(u64, bool)> {
        let start = Instant::now();
        let (mut simulated, mut has_sent) = (0, false);
        while simulated < behind.min(MOST_BEHIND) && start.elapsed() < CATCH_UP {
            simulated += 1;
            let bytes = device.tick();
            if !bytes.is_empty() && is_plugged {
                has_sent = true;
                let written = self.outlet.write(&bytes);
                written.map_err(|error| of_port(&self.asked, &error))?;
            }
        }
        Ok((simulated, has_sent))
    }
}

/// Carries out a line of the panel and returns its answer. The cable is the same for every device.
fn typed<E: Emulation>(device: &mut E, line: &str, is_plugged: &mut bool) -> String {
    match line {
        "plug" => {
            *is_plugged = true;
            "plugged in".to_owned()
        }
        "unplug" => {
            *is_plugged = false;
            "unplugged".to_owned()
        }
        _ => device.control(line),
    }
}
