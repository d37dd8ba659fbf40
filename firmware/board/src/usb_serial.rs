//! A serial port on USB, of the class CDC-ACM: the link of a board without a UART at the host.
//!
//! The file of the board has the type `UsbBus` of its chip, `bus()`, which starts it, and the
//! number of its interrupt, `USB`.

use usb_device::class_prelude::UsbBusAllocator;
use usb_device::device::{StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbVidPid};
use usbd_serial::{SerialPort, USB_CLASS_CDC};

use super::{USB, UsbBus, bus};
use crate::{Shared, nvic};

/// An identity for tests and examples in a laboratory: <https://pid.codes/1209/0001/>. A product
/// needs its own.
const IDENTITY: UsbVidPid = UsbVidPid(0x1209, 0x0001);

/// The port and its device.
struct Line {
    device: UsbDevice<'static, UsbBus>,
    port: SerialPort<'static, UsbBus>,
}

static LINE: Shared<Option<Line>> = Shared::new(None);

/// Number of the interrupt.
pub const INTERRUPT: usize = USB;

/// Opens the port. Without a bus there is no link.
pub fn start() {
    LINE.with(|line| *line = bus().and_then(line_on));
    nvic::unmask(INTERRUPT as u16);
}

fn line_on(bus: &'static UsbBusAllocator<UsbBus>) -> Option<Line> {
    let port = SerialPort::new(bus);
    let strings = [StringDescriptors::default().product("husillo")];
    let device = UsbDeviceBuilder::new(bus, IDENTITY)
        .strings(&strings)
        .ok()?
        .device_class(USB_CLASS_CDC)
        .build();
    Some(Line { device, port })
}

/// Sends a byte, if the port has room for it. Without a host, the byte is dropped and reported as
/// sent.
pub fn send(byte: u8) -> bool {
    LINE.with(|line| match line {
        Some(line) if line.port.dtr() => {
            let is_taken = line.port.write(&[byte]) == Ok(1);
            // The next interrupt of the port sends the bytes that cannot be sent now.
            line.port.flush().ok();
            is_taken
        }
        _ => true,
    })
}

/// USB has no rate.
pub fn baud(_: u32) {}

/// Always true, because the port buffers the bytes.
pub fn is_sent() -> bool {
    true
}

/// Takes at most one packet from the host. It has only a few bytes if the protocol echoes each
/// byte. The interrupt of the USB calls this.
pub extern "C" fn on_interrupt() {
    let mut bytes = [0; 64];
    let count = LINE.with(|line| {
        let line = line.as_mut()?;
        if !line.device.poll(&mut [&mut line.port]) {
            return None;
        }
        line.port.read(&mut bytes).ok()
    });
    let heard = bytes.iter().take(count.unwrap_or_default());
    heard.for_each(|byte| crate::heard(*byte));
}
