//! Emulated links keep the rate of their wire.
#![cfg(unix)]

mod emulated;

use emulated::Emulated;
use std::io::{Read, Write};
use std::time::{Duration, Instant};

/// So many bytes that are each answered by one, all at once: the last answer comes no sooner than
/// the wire has carried them and it.
fn takes_its_time(device: &Emulated, byte: u8, baud: u32) {
    let mut port = serialport::new(device.port(), baud)
        .timeout(Duration::from_secs(60))
        .open_native()
        .unwrap();
    let count = usize::try_from(baud / 10).unwrap();
    let start = Instant::now();
    port.write_all(&vec![byte; count]).unwrap();
    let mut answers = vec![0; count];
    port.read_exact(&mut answers).unwrap();
    let took_s = start.elapsed().as_secs_f64();
    assert_eq!(answers, vec![byte; count]);
    // A second of ten bits per byte, less the delay of the emulation on a busy computer.
    assert!(took_s > 0.5, "{took_s}");
    println!("{baud} baud: {took_s} s for {count} bytes and their answers");
}

#[test]
fn links_keep_the_rate_of_their_wire() {
    let Some(mut drill) = Emulated::new("drill", "drill-baud", &[]) else {
        return;
    };
    drill.read_until("homed");
    takes_its_time(&drill, b'B', 2400);
    drop(drill);
    let microfactory = Emulated::new("microfactory", "microfactory-baud", &[]).unwrap();
    takes_its_time(&microfactory, b'A', 9600);
    drop(microfactory);
    let quicker = Emulated::new(
        "microfactory",
        "microfactory-baud-fast",
        &["--baud", "19200"],
    )
    .unwrap();
    takes_its_time(&quicker, b'A', 19_200);
}
