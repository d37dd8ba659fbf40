//! The line of an emulated measuring machine behind a pseudo-terminal, byte by byte: rates, byte
//! times, answers that are cut off, modules that are deaf after a reset, modules of other kinds.

#![cfg(unix)]

mod common;
mod emulated;

use common::{husillo, measured, near, written};
use emulated::Emulated;
use predicates::str::contains;
use serialport::{SerialPort, TTYPort};
use std::io::{Read, Write};
use std::time::{Duration, Instant};

/// Longest time for a reply on a busy computer.
const LONGEST: Duration = Duration::from_secs(20);
/// After this time without a byte there is no reply.
const NO_REPLY: Duration = Duration::from_millis(300);

const ADDRESS_1: [u8; 6] = [0xaa, 0x00, 0x21, 0x01, 0xff, 0x21];
const ADDRESS_2: [u8; 6] = [0xaa, 0x00, 0x21, 0x02, 0xff, 0x22];
const RESET: [u8; 4] = [0xaa, 0xff, 0x0f, 0x0e];
/// Position, current, velocity, auxiliary status and home: a reply of 14 bytes.
const READ_ALL: [u8; 5] = [0xaa, 0x01, 0x13, 0x1f, 0x33];
/// Type and version.
const READ_DEVICE: [u8; 5] = [0xaa, 0x01, 0x13, 0x20, 0x34];
const DEVICE: [u8; 4] = [0x19, 0x00, 0x04, 0x1d];

/// The client's end of a line.
struct Client(TTYPort);

impl Client {
    fn open(network: &Emulated) -> Client {
        Client(
            serialport::new(network.port(), 19200)
                .open_native()
                .unwrap(),
        )
    }

    fn rate(&mut self, bits_per_s: u32) {
        self.0.set_baud_rate(bits_per_s).unwrap();
    }

    fn send(&mut self, bytes: &[u8]) {
        self.0.write_all(bytes).unwrap();
    }

    /// Reads this number of bytes.
    fn read(&mut self, count: usize) -> Vec<u8> {
        self.0.set_timeout(LONGEST).unwrap();
        let mut bytes = vec![0; count];
        self.0.read_exact(&mut bytes).unwrap();
        bytes
    }

    /// Reads an answer: until nothing comes any more after its first byte.
    fn read_answer(&mut self) -> Vec<u8> {
        [self.read(1), self.read_rest()].concat()
    }

    /// Reads until nothing comes any more.
    fn read_rest(&mut self) -> Vec<u8> {
        self.0.set_timeout(NO_REPLY).unwrap();
        let mut bytes = Vec::new();
        // It ends with an error: the time is over.
        let _ = self.0.read_to_end(&mut bytes);
        bytes
    }

    fn ask(&mut self, packet: &[u8], count: usize) -> Vec<u8> {
        self.send(packet);
        self.read(count)
    }

    /// Completes what the modules have taken for the beginning of a packet.
    fn flush(&mut self) {
        self.send(&[0; 40]);
        self.read_rest();
    }
}

fn network(name: &str, args: &[&str]) -> Option<(Emulated, Client)> {
    let network = Emulated::new("cmm", name, args)?;
    let client = Client::open(&network);
    Some((network, client))
}

#[test]
fn each_module_has_the_rate_that_it_was_given() {
    let Some((_network, mut client)) = network("wire-rates", &["--modules", "servo:4,servo:4"])
    else {
        return;
    };
    assert_eq!(client.ask(&ADDRESS_1, 2), [0x19, 0x19]);
    assert_eq!(client.ask(&ADDRESS_2, 2), [0x19, 0x19]);
    // Set Baud 57600 to module 1, whose answer is noise at 19200.
    client.send(&[0xaa, 0x01, 0x1a, 0x14, 0x2f]);
    assert_ne!(client.read_rest(), [0x19, 0x19]);
    let no_operation = [[0xaa, 0x01, 0x0e, 0x0f], [0xaa, 0x02, 0x0e, 0x10]];
    for (rate, answers) in [(19200, 1), (57600, 0)] {
        client.rate(rate);
        client.flush();
        assert_eq!(
            client.ask(&no_operation[answers], 2),
            [0x19, 0x19],
            "{rate}"
        );
        client.send(&no_operation[1 - answers]);
        assert!(client.read_rest().is_empty(), "{rate}");
    }
}

/// A busy computer makes a reply late, but never early.
#[test]
fn a_reply_comes_no_sooner_than_its_bytes() {
    let Some((_network, mut client)) = network("wire-times", &[]) else {
        return;
    };
    client.ask(&ADDRESS_1, 2);
    let start = Instant::now();
    for _ in 0..20 {
        client.ask(&READ_ALL, 14);
    }
    // 19 bytes of ten bits, less a period by which a byte may seem to have been sent earlier.
    let least_s = 20.0 * (190.0 / 19200.0 - 0.000_512);
    let took_s = start.elapsed().as_secs_f64();
    assert!(took_s >= least_s, "{took_s} s of {least_s} s");
}

#[test]
fn a_command_without_a_pause_ends_the_reply_before_it() {
    let Some((_network, mut client)) = network("wire-collision", &[]) else {
        return;
    };
    client.ask(&ADDRESS_1, 2);
    client.send(&[READ_ALL, READ_DEVICE].concat());
    let mut heard = client.read_answer();
    while !heard.ends_with(&DEVICE) {
        heard.extend(client.read_answer());
    }
    assert!(heard.ends_with(&DEVICE), "{heard:02x?}");
    assert!(heard.len() < DEVICE.len() + 3, "{heard:02x?}");
}

#[test]
fn without_byte_times_rates_do_not_matter() {
    let Some((_network, mut client)) = network("wire-fast", &["--fast"]) else {
        return;
    };
    client.rate(115_200);
    assert_eq!(client.ask(&ADDRESS_1, 2), [0x19, 0x19]);
    // Both answers are there.
    let both = client.ask(&[READ_ALL, READ_DEVICE].concat(), 18);
    assert_eq!(both[14..], DEVICE);
}

#[test]
fn modules_are_deaf_after_a_reset_for_the_time_asked_for() {
    let Some((_network, mut client)) = network("wire-reset", &["--reset-ms", "1500"]) else {
        return;
    };
    client.send(&RESET);
    client.send(&ADDRESS_1);
    assert!(client.read_rest().is_empty());
    let end = Instant::now() + LONGEST;
    let heard = loop {
        client.send(&ADDRESS_1);
        let heard = client.read_rest();
        if !heard.is_empty() || Instant::now() > end {
            break heard;
        }
    };
    assert_eq!(heard, [0x19, 0x19]);
}

#[test]
fn a_module_with_inputs_and_outputs_has_its_panel() {
    let Some((mut network, mut client)) = network("wire-io", &["--modules", "servo:4,io:2"]) else {
        return;
    };
    client.ask(&ADDRESS_1, 2);
    assert_eq!(client.ask(&ADDRESS_2, 2), [0, 0]);
    let device = client.ask(&[0xaa, 0x02, 0x13, 0x20, 0x35], 4);
    assert_eq!(device, [0, 2, 2, 4], "type and version");
    network.type_line("pin 2 11 high", "pin 11 of module 2: high");
    network.type_line("analogue 2 1 42", "analogue input 1 of module 2: 42");
    let inputs = client.ask(&[0xaa, 0x02, 0x13, 0x03, 0x18], 5);
    assert_eq!(inputs, [0, 0, 8, 42, 50]);
    // Pins 0 and 1 become outputs, and pin 1 goes high.
    client.ask(&[0xaa, 0x02, 0x20, 0xfc, 0x0f, 0x2d], 2);
    client.ask(&[0xaa, 0x02, 0x26, 0x02, 0x00, 0x2a], 2);
    network.type_line(
        "outputs 2",
        "outputs of module 2: high 1; PWM 0 and 0 of 255",
    );
    network.type_line("pin 1 11 high", "pin MODULE 0..11 high|low");
}

/// A machine with the double switch of the prototype, whose motor has another encoder.
const PER_SENSE: &str = "[axis.x.motor]
counts_per_revolution = 800

[probe]
switches = \"per-sense\"
";

#[test]
fn a_double_switch_closes_the_limit_of_its_sense() {
    let text = std::fs::read_to_string("../machines/cmm.toml").unwrap();
    let file = written("per-sense.toml", &text.replacen("[probe]", PER_SENSE, 1));
    let file = file.to_str().unwrap();
    let faces = [
        "--contact",
        "1:900",
        "--contact",
        "1:..-700",
        "--speed",
        "10",
    ];
    let Some(mut network) = Emulated::new(file, "wire-double", &faces) else {
        return;
    };
    let port = ["-m", file, "--port", network.port()];
    let rows = measured(&[&port[..], &["touch", "+", "goto", "0", "touch", "-"]].concat());
    near(&rows[0]["trigger"], 900.0, 1.0);
    near(&rows[2]["trigger"], -700.0, 1.0);
    // The panel closes that of the positive sense.
    network.type_line("close probe", "probe: close");
    let port = ["-m", file, "--port", network.port()];
    let rows = measured(&[&port[..], &["status"]].concat());
    let bits = rows[0]["bits"].to_string();
    assert!(
        bits.contains("limit 1") && !bits.contains("limit 2"),
        "{bits}"
    );
}

#[test]
fn options_of_the_line_are_for_measuring_machines() {
    for option in [&["--fast"][..], &["--reset-ms", "100"]] {
        let mut command = husillo();
        let link = std::env::temp_dir().join("husillo-never");
        command.args(["emulate", "drill", "--for", "5", "--link"]);
        let refused = command.arg(link).args(option).assert().failure();
        refused.stderr(contains(option[0]));
    }
}

#[test]
fn unknown_modules_are_named() {
    let link = std::env::temp_dir().join("husillo-never");
    let link = link.to_str().unwrap();
    for (args, message) in [
        (
            ["--modules", "servo:4,step:2"],
            "`step:2`: expected servo:4",
        ),
        (
            ["--contact", "3:100"],
            "a contact at module 3, of 1 on the line",
        ),
    ] {
        let mut command = husillo();
        command.args(["emulate", "cmm", "--for", "5", "--link", link]);
        command
            .args(args)
            .assert()
            .failure()
            .stderr(contains(message));
    }
}
