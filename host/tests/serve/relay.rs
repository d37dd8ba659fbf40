//! A cable to an emulated device that loses bytes or is slow when a test wants it.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A relay between one client and one device.
pub struct Relay {
    /// What the client opens.
    pub port: String,
    /// Bytes of the device that are still to be lost.
    losses: Arc<AtomicUsize>,
}

impl Relay {
    /// A relay to the device at `tcp:HOST:PORT`.
    pub fn to(device: &str) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = format!("tcp:{}", listener.local_addr().unwrap());
        let device = device.trim_start_matches("tcp:").to_owned();
        let losses = Arc::new(AtomicUsize::new(0));
        let lost = Arc::clone(&losses);
        std::thread::spawn(move || {
            for client in listener.incoming().map_while(Result::ok) {
                let device = TcpStream::connect(&device).unwrap();
                // A serial line does not collect bytes.
                client.set_nodelay(true).unwrap();
                device.set_nodelay(true).unwrap();
                let back = (device.try_clone().unwrap(), client.try_clone().unwrap());
                let lost = Arc::clone(&lost);
                std::thread::spawn(move || carry(client, device, &AtomicUsize::new(0)));
                std::thread::spawn(move || carry(back.0, back.1, &lost));
            }
        });
        Self { port, losses }
    }

    /// Loses the next bytes from the device.
    pub fn lose(&self, bytes: usize) {
        self.losses.store(bytes, Ordering::Relaxed);
    }
}

/// Carries bytes until one end closes.
fn carry(mut from: TcpStream, mut to: TcpStream, losses: &AtomicUsize) {
    let mut bytes = [0; 256];
    while let Ok(count @ 1..) = from.read(&mut bytes) {
        for byte in &bytes[..count] {
            let is_lost = losses
                .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| {
                    left.checked_sub(1)
                })
                .is_ok();
            if !is_lost && to.write_all(&[*byte]).is_err() {
                return;
            }
        }
    }
    let _ = to.shutdown(std::net::Shutdown::Both);
}
