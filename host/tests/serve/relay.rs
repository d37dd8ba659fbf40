//! A cable to an emulated device. A test makes it lose bytes, blocks it, pulls it, or says
//! something on it.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

/// A relay between one client and one device.
pub struct Relay {
    /// What the client opens.
    pub port: String,
    cable: Arc<Cable>,
}

/// The state of the cable.
#[derive(Default)]
struct Cable {
    /// Bytes of the device that are still to be lost.
    losses: AtomicUsize,
    /// The next byte of the device with this value is lost.
    unwanted: Mutex<Option<u8>>,
    /// No byte passes, in either direction.
    is_blocked: AtomicBool,
    is_pulled: AtomicBool,
    /// The present connection: to the client, and to the device.
    ends: Mutex<Option<[TcpStream; 2]>>,
}

impl Relay {
    /// A relay to the device at `tcp:HOST:PORT`.
    pub fn to(device: &str) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = format!("tcp:{}", listener.local_addr().unwrap());
        let device = device.trim_start_matches("tcp:").to_owned();
        let cable = Arc::new(Cable::default());
        let shared = Arc::clone(&cable);
        std::thread::spawn(move || {
            for client in listener.incoming().map_while(Result::ok) {
                // Without a device, or if one end has gone already, the client is let go.
                let _ = connect(client, &device, &shared);
            }
        });
        Self { port, cable }
    }

    /// Loses the next bytes from the device.
    pub fn lose(&self, bytes: usize) {
        self.cable.losses.store(bytes, Ordering::SeqCst);
    }

    /// Loses the next byte from the device that has this value.
    pub fn lose_next(&self, byte: u8) {
        *self.cable.unwanted.lock().unwrap() = Some(byte);
    }

    /// Lets no byte pass, or all of them again. The connection stays.
    pub fn block(&self, is_blocked: bool) {
        self.cable.is_blocked.store(is_blocked, Ordering::SeqCst);
    }

    /// Pulls the cable: the connection ends, and no other one is made.
    pub fn pull(&self) {
        self.cable.is_pulled.store(true, Ordering::SeqCst);
        for end in self.cable.ends.lock().unwrap().take().iter().flatten() {
            let _ = end.shutdown(Shutdown::Both);
        }
    }

    /// Plugs the cable in again.
    pub fn plug(&self) {
        self.cable.is_pulled.store(false, Ordering::SeqCst);
    }

    /// Says something to the device that the client has not said.
    pub fn say(&self, bytes: &[u8]) {
        let ends = self.cable.ends.lock().unwrap();
        let [_, device] = ends.as_ref().expect("a connection");
        let mut device = device;
        device.write_all(bytes).unwrap();
    }
}

/// Connects a client with the device.
fn connect(client: TcpStream, device: &str, cable: &Arc<Cable>) -> std::io::Result<()> {
    if cable.is_pulled.load(Ordering::SeqCst) {
        return Ok(());
    }
    let device = TcpStream::connect(device)?;
    // A serial line does not collect bytes.
    client.set_nodelay(true)?;
    device.set_nodelay(true)?;
    let ends = [client.try_clone()?, device.try_clone()?];
    *cable.ends.lock().unwrap() = Some(ends);
    let back = (device.try_clone()?, client.try_clone()?);
    let [there, here] = [Arc::clone(cable), Arc::clone(cable)];
    std::thread::spawn(move || carry(client, device, |_| there.is_blocked()));
    std::thread::spawn(move || carry(back.0, back.1, |byte| here.loses(byte)));
    Ok(())
}

impl Cable {
    fn is_blocked(&self) -> bool {
        self.is_blocked.load(Ordering::SeqCst)
    }

    /// Whether this byte of the device is lost.
    fn loses(&self, byte: u8) -> bool {
        let mut unwanted = self.unwanted.lock().unwrap();
        if *unwanted == Some(byte) {
            *unwanted = None;
            return true;
        }
        let one_less = |left: usize| left.checked_sub(1);
        let (set, read) = (Ordering::SeqCst, Ordering::SeqCst);
        self.is_blocked() || self.losses.fetch_update(set, read, one_less).is_ok()
    }
}

/// Carries bytes until one end closes.
fn carry(mut from: TcpStream, mut to: TcpStream, is_lost: impl Fn(u8) -> bool) {
    let mut bytes = [0; 256];
    while let Ok(count @ 1..) = from.read(&mut bytes) {
        for byte in &bytes[..count] {
            if !is_lost(*byte) && to.write_all(&[*byte]).is_err() {
                return;
            }
        }
    }
    let _ = to.shutdown(Shutdown::Both);
}
