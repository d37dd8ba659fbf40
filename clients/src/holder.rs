//! The program that holds a port, and the local socket at which other programs ask it to stop.
//!
//! A serial device belongs to one program at a time. The program that holds it listens at a socket
//! of its own in a folder that only its user can open. Every other program of that user finds it
//! there by the name of the port.

use serde::{Deserialize, Serialize};
use std::fs;
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{SocketAddr, ToSocketAddrs};
use std::os::unix::fs::DirBuilderExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A program that does not introduce itself within this time does not count as a holder.
const INTRODUCTION: Duration = Duration::from_secs(1);

/// A program that holds a port.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Holder {
    /// Its process number.
    pub process: u32,
    /// What it does, such as `send board.drl`.
    pub command: String,
    /// The machine at the port: its name, or the absolute path of its machine file.
    pub machine: String,
    /// The port: the absolute path of its device, or `tcp:HOST:PORT`.
    pub port: String,
    /// Rate of the port, bits/s.
    pub bits_per_s: u32,
}

/// How urgent a stop is.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Urgency {
    /// Like Ctrl-C: the machine stops, and the program reports the work done.
    Stop,
    /// Like Ctrl-C twice within a second: an emergency stop if the machine has one.
    Emergency,
}

/// A listener for requests to stop. It ends when this value is dropped.
#[derive(Debug)]
pub struct Listening {
    socket: PathBuf,
}

/// A connection to the program that holds a port.
#[derive(Debug)]
pub struct Held {
    /// The program.
    pub holder: Holder,
    stream: UnixStream,
}

impl Holder {
    /// Listens for requests to stop, in a thread of its own. Calls `stop` at each request.
    ///
    /// # Errors
    ///
    /// The folder of the socket cannot be created, or the system refuses the socket.
    pub fn listen(
        self,
        folder: &Path,
        stop: impl Fn(Urgency) + Send + Sync + 'static,
    ) -> io::Result<Listening> {
        fs::DirBuilder::new()
            .recursive(true)
            .mode(0o700)
            .create(folder)?;
        let mut introduction = serde_json::to_string(&self)?;
        introduction.push('\n');
        let (socket, listener) = bind(folder, self.process)?;
        let stop = Arc::new(stop);
        std::thread::spawn(move || {
            for stream in listener.incoming().map_while(Result::ok) {
                let (introduction, stop) = (introduction.clone(), Arc::clone(&stop));
                std::thread::spawn(move || serve(stream, &introduction, &*stop));
            }
        });
        Ok(Listening { socket })
    }
}

/// Binds a socket to the first free name of this process. A program holds a few ports at most.
fn bind(folder: &Path, process: u32) -> io::Result<(PathBuf, UnixListener)> {
    let mut number = 0;
    loop {
        let socket = folder.join(format!("{process}-{number}"));
        match UnixListener::bind(&socket) {
            Ok(listener) => return Ok((socket, listener)),
            Err(error) if error.kind() == ErrorKind::AddrInUse && number < 1000 => {
                // The socket may remain from a program that was killed.
                if is_abandoned(&socket) {
                    fs::remove_file(&socket)?;
                } else {
                    number += 1;
                }
            }
            Err(error) => return Err(error),
        }
    }
}

fn is_abandoned(socket: &Path) -> bool {
    UnixStream::connect(socket).is_err_and(|error| error.kind() == ErrorKind::ConnectionRefused)
}

/// Introduces the holder and passes the requests on. The connection ends with the process. This
/// shows the other program that the holder has ended.
fn serve(mut stream: UnixStream, introduction: &str, stop: &(impl Fn(Urgency) + ?Sized)) {
    if stream.write_all(introduction.as_bytes()).is_err() {
        return;
    }
    for line in BufReader::new(stream).lines().map_while(Result::ok) {
        match line.as_str() {
            "stop" => stop(Urgency::Stop),
            "emergency" => stop(Urgency::Emergency),
            _ => {}
        }
    }
}

impl Drop for Listening {
    fn drop(&mut self) {
        // If this fails, the next program removes the socket.
        let _ = fs::remove_file(&self.socket);
    }
}

/// The folder of the sockets. It is in the folder of the user's session, or else in the user's
/// cache. `None` if the user has neither.
pub fn folder() -> Option<PathBuf> {
    let variable = |name| std::env::var_os(name).filter(|value| !value.is_empty());
    let base = variable("XDG_RUNTIME_DIR").map(PathBuf::from);
    let base = base.or_else(|| variable("XDG_CACHE_HOME").map(PathBuf::from));
    let base = base.or_else(|| Some(PathBuf::from(variable("HOME")?).join(".cache")));
    Some(base?.join("husillo"))
}

/// The programs that hold ports, with a connection to each.
pub fn holders(folder: &Path) -> Vec<Held> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    entries
        .filter_map(|entry| {
            let socket = entry.ok()?.path();
            match UnixStream::connect(&socket) {
                Ok(stream) => Held::new(stream).ok(),
                Err(error) => {
                    if error.kind() == ErrorKind::ConnectionRefused {
                        // The socket remains from a program that was killed.
                        let _ = fs::remove_file(&socket);
                    }
                    None
                }
            }
        })
        .collect()
}

/// Whether two addresses such as `localhost:7000` lead to the same socket.
fn is_same_socket(one: &str, other: &str) -> bool {
    let addresses = |name: &str| -> Vec<SocketAddr> {
        name.to_socket_addrs()
            .map(Iterator::collect)
            .unwrap_or_default()
    };
    let others = addresses(other);
    one == other
        || addresses(one)
            .iter()
            .any(|address| others.contains(address))
}

impl Held {
    fn new(stream: UnixStream) -> io::Result<Self> {
        stream.set_read_timeout(Some(INTRODUCTION))?;
        let mut line = String::new();
        BufReader::new(&stream).read_line(&mut line)?;
        let holder = serde_json::from_str(&line)?;
        Ok(Self { holder, stream })
    }

    /// Whether the program holds this port. Follows links to a device, and looks up names of hosts.
    pub fn holds(&self, port: &str) -> bool {
        // `#2` names a machine of the controller at the port.
        let whole = |name: &str| name.split('#').next().unwrap_or(name).to_owned();
        let (ours, theirs) = (whole(port), whole(&self.holder.port));
        match (ours.strip_prefix("tcp:"), theirs.strip_prefix("tcp:")) {
            (Some(ours), Some(theirs)) => is_same_socket(ours, theirs),
            _ => {
                let device = |name: String| fs::canonicalize(&name).unwrap_or_else(|_| name.into());
                device(ours) == device(theirs)
            }
        }
    }

    /// Asks the program to stop the machine.
    ///
    /// # Errors
    ///
    /// The program has ended.
    pub fn ask(&mut self, urgency: Urgency) -> io::Result<()> {
        self.stream.write_all(match urgency {
            Urgency::Stop => b"stop\n",
            Urgency::Emergency => b"emergency\n",
        })
    }

    /// Waits until the program has ended, at most for the time `within`. Returns whether it has
    /// ended.
    pub fn has_ended(&mut self, within: Duration) -> bool {
        let end = Instant::now() + within;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return false;
            }
            let bounded = self.stream.set_read_timeout(Some(left));
            match bounded.and_then(|()| self.stream.read(&mut [0; 64])) {
                Ok(0) => return true,
                Ok(_) => {}
                Err(error) => match error.kind() {
                    ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => {}
                    _ => return true,
                },
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;

    fn holder(port: &str) -> Holder {
        Holder {
            process: std::process::id(),
            command: "send board.drl".into(),
            machine: "drill".into(),
            port: port.into(),
            bits_per_s: 2400,
        }
    }

    fn new_folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("husillo-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        folder
    }

    #[test]
    fn a_holder_is_found_and_asked() {
        let folder = new_folder("asked");
        let (sender, requests) = mpsc::channel();
        let listening = holder("/dev/null")
            .listen(&folder, move |urgency| sender.send(urgency).unwrap())
            .unwrap();
        let second = holder("tcp:127.0.0.1:7000")
            .listen(&folder, |_| {})
            .unwrap();
        let mut found = holders(&folder);
        assert_eq!(found.len(), 2);
        for (port, is_held) in [("tcp:localhost:7000", 1), ("tcp:localhost:7001", 0)] {
            assert_eq!(
                found.iter().filter(|held| held.holds(port)).count(),
                is_held,
                "{port}"
            );
        }
        found.retain(|held| held.holds("/dev/../dev/null#2"));
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].holder, holder("/dev/null"));
        found[0].ask(Urgency::Stop).unwrap();
        found[0].ask(Urgency::Emergency).unwrap();
        let within = Duration::from_secs(5);
        assert_eq!(requests.recv_timeout(within), Ok(Urgency::Stop));
        assert_eq!(requests.recv_timeout(within), Ok(Urgency::Emergency));
        assert!(!found[0].has_ended(Duration::from_millis(20)));
        drop((listening, second));
        assert!(holders(&folder).is_empty());
        fs::remove_dir_all(folder).unwrap();
    }

    /// A killed program leaves its socket, which does no harm.
    #[test]
    fn an_abandoned_socket_is_removed() {
        let folder = new_folder("abandoned");
        fs::create_dir_all(&folder).unwrap();
        let socket = folder.join(format!("{}-0", std::process::id()));
        drop(UnixListener::bind(&socket).unwrap());
        assert!(socket.exists());
        let listening = holder("a").listen(&folder, |_| {}).unwrap();
        assert_eq!(listening.socket, socket);
        drop(listening);
        drop(UnixListener::bind(&socket).unwrap());
        assert!(holders(&folder).is_empty());
        assert!(!socket.exists());
        fs::remove_dir_all(folder).unwrap();
    }
}
