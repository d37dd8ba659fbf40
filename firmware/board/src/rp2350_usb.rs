//! The USB of an RP2350 as a device, for the crate `usb-device`.
//!
//! The buffers are in a memory of their own. Each endpoint has one buffer of 64 bytes for each
//! direction, and a register that passes the buffer between processor and controller.
//!
//! Source: RP2350 datasheet, 12.7.

use usb_device::bus::{PollResult, UsbBus};
use usb_device::endpoint::{EndpointAddress, EndpointType};
use usb_device::{Result, UsbDirection, UsbError};

use crate::{
    Shared,
    registers::{read, set},
};

const MEMORY: usize = 0x5010_0000;
/// Registers of endpoint 1, direction IN; that of OUT follows, then those of the next endpoint.
const ENDPOINTS: usize = MEMORY + 0x08;
/// Registers of the buffers of endpoint 0, in the same order.
const BUFFERS: usize = MEMORY + 0x80;
const REGISTERS_END: usize = MEMORY + 0x100;
/// Where the buffers are: both directions of endpoint 0 use the first one.
const BUFFER_OF_0: usize = 0x100;
const BUFFER_OF_1: usize = 0x180;
const BUFFER_BYTES: usize = 64;

const USB: usize = 0x5011_0000;
const ADDRESS: usize = USB;
const MAIN: usize = USB + 0x40;
const CONTROL: usize = USB + 0x4c;
const STATUS: usize = USB + 0x50;
const DONE: usize = USB + 0x58;
const STALL_ENDPOINT_0: usize = USB + 0x68;
const CONNECTION: usize = USB + 0x74;
const POWER: usize = USB + 0x78;
const INTERRUPT_ENABLE: usize = USB + 0x90;
const INTERRUPTS: usize = USB + 0x98;
/// Bits of `CONTROL`: `DONE` tells each buffer of endpoint 0, and the pull-up is on.
const TELLS_EACH: u32 = 1 << 29;
const IS_ATTACHED: u32 = 1 << 16;
/// Bits of `STATUS`, cleared by a 1.
const WAS_RESET: u32 = 1 << 19;
const HAS_SETUP: u32 = 1 << 17;
const RESUMED: u32 = 1 << 11;
const SUSPENDED: u32 = 1 << 4;
/// Bits of the interrupts.
const ON_DONE: u32 = 1 << 4;
const ON_RESET: u32 = 1 << 12;
const ON_SUSPEND: u32 = 1 << 14;
const ON_RESUME: u32 = 1 << 15;
const ON_SETUP: u32 = 1 << 16;
/// Bits of an endpoint's register.
const ENABLED: u32 = 1 << 31;
const TELLS: u32 = 1 << 29;
const TYPE_AT: u32 = 26;
/// Bits of a buffer's register: has data, DATA1, answers with STALL, belongs to the controller.
const FULL: u32 = 1 << 15;
const DATA_1: u32 = 1 << 13;
const STALLS: u32 = 1 << 11;
const AVAILABLE: u32 = 1 << 10;
const LENGTH: u32 = 0x3ff;
/// The bits of `DONE` that belong to the direction IN.
const ALL_IN: u32 = 0x5555_5555;

/// Endpoints of each direction. A serial port takes three of both.
const COUNT: usize = 4;

/// An endpoint in one direction that is in use.
#[derive(Clone, Copy)]
struct Endpoint {
    kind: u32,
    packet_bytes: u16,
}

struct State {
    /// By number and direction, IN first.
    endpoints: [[Option<Endpoint>; 2]; COUNT],
    has_setup: bool,
}

/// The bus.
pub struct Bus(Shared<State>);

/// The number of a direction.
const fn side(direction: UsbDirection) -> usize {
    match direction {
        UsbDirection::In => 0,
        UsbDirection::Out => 1,
    }
}

/// The register of the buffer of an endpoint.
fn register(address: EndpointAddress) -> usize {
    BUFFERS + 8 * address.index() + 4 * side(address.direction())
}

/// The place of the buffer of an endpoint in the memory.
fn buffer(number: usize, side: usize) -> usize {
    match number.checked_sub(1) {
        Some(before) => BUFFER_OF_1 + BUFFER_BYTES * (2 * before + side),
        None => BUFFER_OF_0,
    }
}

/// Writes the register of a buffer, and then gives the buffer to the controller, which must see
/// the other bits first: three cycles of 48 MHz.
fn give(register: usize, value: u32) {
    set(register, value);
    cortex_m::asm::delay(12);
    set(register, value | AVAILABLE);
}

/// Copies bytes from the memory.
fn copy_out(place: usize, bytes: &mut [u8]) {
    for (chunk, at) in bytes.chunks_mut(4).zip((MEMORY + place..).step_by(4)) {
        let word = read(at).to_le_bytes();
        for (byte, copied) in chunk.iter_mut().zip(word) {
            *byte = copied;
        }
    }
}

/// Copies bytes into the memory.
fn copy_in(place: usize, bytes: &[u8]) {
    for (chunk, at) in bytes.chunks(4).zip((MEMORY + place..).step_by(4)) {
        let word = chunk.iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte));
        set(at, word);
    }
}

impl Bus {
    /// Connects the controller, which was reset and has its clock, with the pins.
    pub fn new() -> Self {
        for register in (MEMORY..REGISTERS_END).step_by(4) {
            set(register, 0);
        }
        set(CONNECTION, 1 << 3 | 1); // the pins of the USB, whether or not it has power
        set(POWER, 1 << 3 | 1 << 2);
        set(MAIN, 1); // a device, whose pins are no longer isolated
        set(CONTROL, TELLS_EACH);
        Bus(Shared::new(State {
            endpoints: [[None; 2]; COUNT],
            has_setup: false,
        }))
    }
}

impl State {
    fn endpoint(&self, address: EndpointAddress) -> Result<Endpoint> {
        let of_number = self.endpoints.get(address.index());
        let endpoint = of_number.and_then(|sides| sides.get(side(address.direction())));
        endpoint.copied().flatten().ok_or(UsbError::InvalidEndpoint)
    }

    fn allocate(
        &mut self,
        direction: UsbDirection,
        wanted: Option<EndpointAddress>,
        endpoint: Endpoint,
    ) -> Result<EndpointAddress> {
        if usize::from(endpoint.packet_bytes) > BUFFER_BYTES {
            return Err(UsbError::EndpointMemoryOverflow);
        }
        let side = side(direction);
        for (number, sides) in self.endpoints.iter_mut().enumerate() {
            let is_wanted = match wanted {
                Some(address) => address.index() == number,
                None => number > 0,
            };
            if let (true, Some(place @ None)) = (is_wanted, sides.get_mut(side)) {
                *place = Some(endpoint);
                return Ok(EndpointAddress::from_parts(number, direction));
            }
        }
        Err(UsbError::EndpointOverflow)
    }

    /// Starts all endpoints anew: the first packet of each is DATA0.
    fn reset(&mut self) {
        set(STATUS, WAS_RESET);
        set(DONE, u32::MAX);
        set(ADDRESS, 0);
        self.has_setup = false;
        for (number, sides) in self.endpoints.iter().enumerate() {
            for (side, endpoint) in sides.iter().enumerate() {
                let Some(endpoint) = endpoint else { continue };
                if let Some(before) = number.checked_sub(1) {
                    let place = buffer(number, side) as u32;
                    set(
                        ENDPOINTS + 8 * before + 4 * side,
                        ENABLED | TELLS | endpoint.kind << TYPE_AT | place,
                    );
                }
                let register = BUFFERS + 8 * number + 4 * side;
                match side {
                    // The other one than that of the next packet.
                    0 => set(register, DATA_1),
                    _ => give(register, endpoint.packet_bytes.into()),
                }
            }
        }
    }

    fn write(&mut self, address: EndpointAddress, bytes: &[u8]) -> Result<usize> {
        let endpoint = self.endpoint(address)?;
        let register = register(address);
        let state = read(register);
        if state & AVAILABLE != 0 {
            return Err(UsbError::WouldBlock);
        }
        if bytes.len() > endpoint.packet_bytes.into() {
            return Err(UsbError::BufferOverflow);
        }
        copy_in(buffer(address.index(), 0), bytes);
        let kept = state & STALLS | !state & DATA_1;
        give(register, kept | FULL | bytes.len() as u32);
        Ok(bytes.len())
    }

    fn read(&mut self, address: EndpointAddress, bytes: &mut [u8]) -> Result<usize> {
        let endpoint = self.endpoint(address)?;
        let number = address.index();
        if number == 0 && core::mem::take(&mut self.has_setup) {
            return read_setup(endpoint, bytes);
        }
        let register = register(address);
        let state = read(register);
        if state & FULL == 0 {
            return Err(UsbError::WouldBlock);
        }
        let length = (state & LENGTH) as usize;
        let part = bytes.get_mut(..length).ok_or(UsbError::BufferOverflow)?;
        copy_out(buffer(number, 1), part);
        set(DONE, 2 << (2 * number));
        let next = state & STALLS | !state & DATA_1 | u32::from(endpoint.packet_bytes);
        // A short packet of endpoint 0 is the last one until the next request.
        if number != 0 || length == endpoint.packet_bytes.into() {
            give(register, next);
        } else {
            set(register, next);
        }
        Ok(length)
    }
}

/// Reads a request, after which both directions of endpoint 0 go on with DATA1.
fn read_setup(endpoint: Endpoint, bytes: &mut [u8]) -> Result<usize> {
    let request = bytes.first_chunk_mut::<8>().ok_or(UsbError::BufferOverflow)?;
    copy_out(0, request);
    let [kind, .., low, high] = *request;
    set(BUFFERS, read(BUFFERS) & !DATA_1);
    set(STATUS, HAS_SETUP);
    // A packet that ended the request before.
    set(DONE, 2);
    let next = read(BUFFERS + 4) & STALLS | DATA_1 | u32::from(endpoint.packet_bytes);
    // The host sends data, or an empty packet at the end of data that it has received.
    if kind & 0x80 != 0 || u16::from_le_bytes([low, high]) != 0 {
        give(BUFFERS + 4, next);
    } else {
        set(BUFFERS + 4, next);
    }
    Ok(request.len())
}

impl UsbBus for Bus {
    fn alloc_ep(
        &mut self,
        direction: UsbDirection,
        wanted: Option<EndpointAddress>,
        kind: EndpointType,
        packet_bytes: u16,
        _: u8,
    ) -> Result<EndpointAddress> {
        let kind = match kind {
            EndpointType::Control => 0,
            EndpointType::Isochronous { .. } => return Err(UsbError::Unsupported),
            EndpointType::Bulk => 2,
            EndpointType::Interrupt => 3,
        };
        let endpoint = Endpoint { kind, packet_bytes };
        self.0.with(|state| state.allocate(direction, wanted, endpoint))
    }

    fn enable(&mut self) {
        set(
            INTERRUPT_ENABLE,
            ON_DONE | ON_RESET | ON_SUSPEND | ON_RESUME | ON_SETUP,
        );
        set(CONTROL, TELLS_EACH | IS_ATTACHED);
    }

    fn reset(&self) {
        self.0.with(State::reset);
    }

    fn set_device_address(&self, address: u8) {
        set(ADDRESS, address.into());
    }

    fn write(&self, address: EndpointAddress, bytes: &[u8]) -> Result<usize> {
        self.0.with(|state| state.write(address, bytes))
    }

    fn read(&self, address: EndpointAddress, bytes: &mut [u8]) -> Result<usize> {
        self.0.with(|state| state.read(address, bytes))
    }

    fn set_stalled(&self, address: EndpointAddress, is_stalled: bool) {
        self.0.with(|_| {
            let change = |register, bit: u32| match is_stalled {
                true => set(register, read(register) | bit),
                false => set(register, read(register) & !bit),
            };
            if address.index() == 0 {
                change(STALL_ENDPOINT_0, 1 << side(address.direction()));
            }
            change(register(address), STALLS);
        });
    }

    fn is_stalled(&self, address: EndpointAddress) -> bool {
        read(register(address)) & STALLS != 0
    }

    fn suspend(&self) {}

    fn resume(&self) {}

    fn poll(&self) -> PollResult {
        self.0.with(|state| {
            let happened = read(INTERRUPTS);
            let done = read(DONE);
            if happened & ON_RESET != 0 {
                return PollResult::Reset;
            }
            if done == 0 && happened & ON_SETUP == 0 {
                if happened & ON_SUSPEND != 0 {
                    set(STATUS, SUSPENDED);
                    return PollResult::Suspend;
                }
                if happened & ON_RESUME != 0 {
                    set(STATUS, RESUMED);
                    return PollResult::Resume;
                }
                return PollResult::None;
            }
            // A sent packet is told once, a received one until it is read.
            set(DONE, done & ALL_IN);
            if happened & ON_SETUP != 0 {
                state.has_setup = true;
                // What was to be sent belongs to the request before.
                set(BUFFERS, read(BUFFERS) & !AVAILABLE);
            }
            let of_side = |side: u32| {
                (0..COUNT).fold(0, |all, number| {
                    all | (done >> (2 * number as u32 + side) & 1) << number
                }) as u16
            };
            PollResult::Data {
                ep_out: of_side(1),
                ep_in_complete: of_side(0),
                ep_setup: u16::from(happened & ON_SETUP != 0),
            }
        })
    }
}
