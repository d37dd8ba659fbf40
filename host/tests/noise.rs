//! `send --checked` over a link that loses and changes bytes.

mod common;
mod emulated;

use common::{husillo, scratch, written};
use emulated::Emulated;
use predicates::str::contains;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// One byte in this number is lost, changed or doubled.
const ONE_IN: u64 = 150;

/// Pseudo-random numbers (xorshift, Marsaglia 2003).
struct Noise {
    state: u64,
    /// Bytes that were lost, changed or doubled.
    wrong: Arc<AtomicUsize>,
}

impl Noise {
    fn next(&mut self) -> u64 {
        self.state ^= self.state << 13;
        self.state ^= self.state >> 7;
        self.state ^= self.state << 17;
        self.state
    }

    /// Passes bytes on. Real-time bytes are neither changed nor made, because no checksum protects
    /// them.
    fn pass(&mut self, bytes: &[u8], is_wrong: bool) -> Vec<u8> {
        let is_realtime = |byte: u8| matches!(byte, b'?' | b'!' | b'~' | 0x18 | 0x80..);
        let mut passed = Vec::new();
        for &byte in bytes {
            if !is_wrong || is_realtime(byte) || !self.next().is_multiple_of(ONE_IN) {
                passed.push(byte);
                continue;
            }
            self.wrong.fetch_add(1, Ordering::Relaxed);
            let changed = byte ^ 1 << (self.next() % 7);
            match self.next() % 3 {
                0 => {}
                1 if !is_realtime(changed) => passed.push(changed),
                _ => passed.extend([byte, byte]),
            }
        }
        passed
    }
}

/// A link to this port, with noise in both directions. Returns its address.
fn noisy(port: &str, state: u64, wrong: &Arc<AtomicUsize>) -> String {
    let wrong = Arc::clone(wrong);
    let target = port.strip_prefix("tcp:").unwrap().to_owned();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", listener.local_addr().unwrap());
    thread::spawn(move || {
        for client in listener.incoming() {
            let (client, server) = (client.unwrap(), TcpStream::connect(&target).unwrap());
            let ends = [
                (client.try_clone().unwrap(), server.try_clone().unwrap()),
                (server, client),
            ];
            for (from, to) in ends {
                let wrong = Arc::clone(&wrong);
                thread::spawn(move || carry(from, to, Noise { state, wrong }));
            }
        }
    });
    address
}

/// A link to this port that loses the first `$L=0`, and the `ok` of the second one.
fn forgetful(port: &str) -> String {
    let target = port.strip_prefix("tcp:").unwrap().to_owned();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", listener.local_addr().unwrap());
    thread::spawn(move || {
        let (mut client, mut server) = (
            listener.accept().unwrap().0,
            TcpStream::connect(&target).unwrap(),
        );
        let (mut to_client, mut to_server) =
            (client.try_clone().unwrap(), server.try_clone().unwrap());
        let ends = Arc::new(AtomicUsize::new(0));
        let seen = Arc::clone(&ends);
        thread::spawn(move || {
            let mut bytes = [0; 256];
            while let Ok(count @ 1..) = client.read(&mut bytes) {
                let is_end = bytes[..count].windows(4).any(|window| window == b"$L=0");
                if is_end && seen.fetch_add(1, Ordering::Relaxed) == 0 {
                    continue;
                }
                to_server.write_all(&bytes[..count]).unwrap();
            }
            let _ = to_server.shutdown(std::net::Shutdown::Both);
        });
        let mut bytes = [0; 1];
        let mut line = Vec::new();
        while let Ok(1) = server.read(&mut bytes) {
            line.push(bytes[0]);
            if bytes == *b"\n" {
                if line == b"ok\r\n" && ends.load(Ordering::Relaxed) == 2 {
                    ends.store(3, Ordering::Relaxed);
                } else {
                    to_client.write_all(&line).unwrap();
                }
                line.clear();
            }
        }
    });
    address
}

/// The first bytes are right: the dialogue before the program is not checked.
fn carry(mut from: TcpStream, mut to: TcpStream, mut noise: Noise) {
    let (mut bytes, mut passed) = ([0; 256], 0);
    while let Ok(count @ 1..) = from.read(&mut bytes) {
        passed += count;
        if to
            .write_all(&noise.pass(&bytes[..count], passed > 1000))
            .is_err()
        {
            break;
        }
    }
    let _ = to.shutdown(std::net::Shutdown::Both);
}

/// 300 lines with arcs. The first lines are the same twice, so a line that is made twice shows.
fn program() -> String {
    let mut text = String::from("G21 G91 G94\nG1 F6000\n");
    for number in 0..100 {
        let size = 1 + number % 7;
        text += &format!("N{number} G1 X0.{size} Y-0.1\nG2 X0.4 I0.2\nG1 Y0.{size}\n");
    }
    text + "M2\n"
}

/// The steps that an emulated mill has made, without their times: `dx,dy,dz`.
fn steps(name: &str, port: impl Fn(&str) -> String, options: &[&str]) -> Vec<String> {
    let recorded = scratch(&format!("{name}.csv"));
    let recorded = recorded.to_str().unwrap();
    let mut device = Emulated::listening("grbl", &["--speed", "20", "--steps", recorded]);
    let file = written(&format!("{name}.nc"), &program());
    husillo()
        .args(["send", file.to_str().unwrap(), "-m", "grbl", "-y"])
        .args(["--port", &port(device.port())])
        .args(options)
        .assert()
        .success()
        .stdout(contains("303 lines made; "));
    device.end();
    let text = std::fs::read_to_string(recorded).unwrap();
    let deltas = text
        .lines()
        .map(|row| row.split(',').skip(3).take(3).collect::<Vec<_>>().join(","));
    deltas.filter(|delta| delta != "0,0,0").collect()
}

#[test]
fn each_line_is_made_once_over_a_link_with_noise() {
    let clean = steps("noise-none", str::to_owned, &[]);
    assert!(clean.len() > 10_000, "{} rows", clean.len());
    for seed in [1, 0xCAFE_F00D] {
        let wrong = Arc::default();
        let name = format!("noise-{seed}");
        let made = steps(&name, |port| noisy(port, seed, &wrong), &["--checked"]);
        assert!(wrong.load(Ordering::Relaxed) > 20, "{wrong:?}");
        let differs = made
            .iter()
            .zip(&clean)
            .position(|(made, clean)| made != clean);
        assert_eq!(differs, None, "seed {seed}");
        assert_eq!(made.len(), clean.len(), "seed {seed}");
    }
}

/// What no checksum protects is repeated.
#[test]
fn the_end_of_checked_lines_may_be_lost() {
    let made = steps("noise-end", forgetful, &["--checked"]);
    assert_eq!(made, steps("noise-end-clean", str::to_owned, &[]));
}

#[test]
fn other_machines_have_no_checked_lines() {
    let file = written("noise-mill.nc", "G1 X1 F100\n");
    husillo()
        .args([
            "send",
            file.to_str().unwrap(),
            "-m",
            "micromill",
            "--checked",
        ])
        .assert()
        .code(2)
        .stderr(contains("--checked is for a Grbl controller"));
}
