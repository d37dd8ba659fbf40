//! A line to an emulated controller on which each byte takes a long time.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

/// A line for one client.
pub struct SlowLine {
    /// What the client opens.
    pub port: String,
    requests: Arc<AtomicU32>,
}

impl SlowLine {
    /// A line to the device at `tcp:HOST:PORT` that delays each byte, in both directions.
    pub fn to(device: &str, delay: Duration) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = format!("tcp:{}", listener.local_addr().unwrap());
        let device = TcpStream::connect(device.trim_start_matches("tcp:")).unwrap();
        let requests = Arc::new(AtomicU32::new(0));
        let counted = Arc::clone(&requests);
        std::thread::spawn(move || {
            let (client, _) = listener.accept().unwrap();
            let back = (device.try_clone().unwrap(), client.try_clone().unwrap());
            carry(back.0, back.1, delay, |_| {});
            carry(client, device, delay, move |bytes| {
                let count = bytes.iter().filter(|byte| **byte == b'?').count();
                counted.fetch_add(count as u32, Ordering::SeqCst);
            });
        });
        Self { port, requests }
    }

    /// How many reports the client has requested.
    pub fn requests(&self) -> u32 {
        self.requests.load(Ordering::SeqCst)
    }
}

/// Carries bytes until one end closes, each after a delay.
fn carry(
    mut from: TcpStream,
    mut to: TcpStream,
    delay: Duration,
    seen: impl Fn(&[u8]) + Send + 'static,
) {
    to.set_nodelay(true).unwrap();
    let (sender, receiver) = channel::<(Instant, Vec<u8>)>();
    std::thread::spawn(move || {
        let mut bytes = [0; 256];
        while let Ok(count @ 1..) = from.read(&mut bytes) {
            let bytes = &bytes[..count];
            seen(bytes);
            if sender
                .send((Instant::now() + delay, bytes.to_vec()))
                .is_err()
            {
                return;
            }
        }
    });
    std::thread::spawn(move || {
        for (at, bytes) in receiver {
            std::thread::sleep(at.saturating_duration_since(Instant::now()));
            if to.write_all(&bytes).is_err() {
                return;
            }
        }
    });
}
