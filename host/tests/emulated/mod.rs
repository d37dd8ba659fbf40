//! `husillo emulate` in the background, until it is dropped.

#![allow(dead_code)] // every test file uses what it needs of it

use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// A device behind a pseudo-terminal.
pub struct Emulated {
    process: Child,
    panel: ChildStdin,
    output: BufReader<ChildStdout>,
    /// What a client opens.
    pub link: PathBuf,
}

impl Emulated {
    /// `None`, with a message, where there are no pseudo-terminals. `name` is for this test alone.
    pub fn new(machine: &str, name: &str, args: &[&str]) -> Option<Emulated> {
        let link = std::env::temp_dir().join(format!("husillo-{name}-{}", std::process::id()));
        let mut process = Command::new(env!("CARGO_BIN_EXE_husillo"))
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .args(["emulate", machine, "--for", "600", "--link"])
            .arg(&link)
            .args(args)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut output = BufReader::new(process.stdout.take().unwrap());
        let mut told = String::new();
        output.read_line(&mut told).unwrap();
        let device = Emulated {
            panel: process.stdin.take().unwrap(),
            process,
            output,
            link,
        };
        if told.is_empty() {
            eprintln!("skipped: no pseudo-terminal here");
            return None;
        }
        Some(device)
    }

    /// One that listens on a socket; what a client opens is `tcp:HOST:PORT`.
    pub fn listening(machine: &str, args: &[&str]) -> Emulated {
        Self::listening_at("127.0.0.1:0", machine, args)
    }

    /// The same at an address.
    pub fn listening_at(address: &str, machine: &str, args: &[&str]) -> Emulated {
        let mut process = Command::new(env!("CARGO_BIN_EXE_husillo"))
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .args(["emulate", machine, "--for", "600", "--listen", address])
            .args(args)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut output = BufReader::new(process.stdout.take().unwrap());
        let mut first = String::new();
        output.read_line(&mut first).unwrap();
        let port = first
            .split([' ', ';'])
            .find(|word| word.starts_with("tcp:"));
        Emulated {
            panel: process.stdin.take().unwrap(),
            link: PathBuf::from(port.unwrap()),
            process,
            output,
        }
    }

    /// The link as an argument.
    pub fn port(&self) -> &str {
        self.link.to_str().unwrap()
    }

    /// The number of its process.
    pub fn id(&self) -> u32 {
        self.process.id()
    }

    /// Types bytes at the panel.
    pub fn type_bytes(&mut self, bytes: &[u8]) {
        self.panel.write_all(bytes).unwrap();
    }

    /// Ends it in order, as Ctrl-C does.
    pub fn end(&mut self) {
        let id = self.process.id().to_string();
        let sent = Command::new("kill").args(["-TERM", &id]).status();
        assert!(sent.unwrap().success());
        self.process.wait().unwrap();
    }

    /// Types a line at the panel and reads until the answer to it.
    pub fn type_line(&mut self, line: &str, answer: &str) -> String {
        writeln!(self.panel, "{line}").unwrap();
        self.read_until(answer)
    }

    /// The next line with something in it.
    pub fn read_until(&mut self, wanted: &str) -> String {
        let mut line = String::new();
        while !line.contains(wanted) {
            line.clear();
            assert_ne!(self.output.read_line(&mut line).unwrap(), 0, "no {wanted}");
        }
        line
    }
}

impl Drop for Emulated {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
        let _ = std::fs::remove_file(&self.link);
    }
}
