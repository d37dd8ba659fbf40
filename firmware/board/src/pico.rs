//! The Raspberry Pi Pico: an RP2040 at 125 MHz with two Cortex-M0+, of which one is used. Its link
//! is USB: a serial port of the class CDC-ACM, `/dev/ttyACM0` at the host.
//!
//! ```sh
//! BOARD=src/pico.rs cargo build --release -p micromill --features board/usb \
//!     --target thumbv6m-none-eabi
//! ```
//!
//! The timer counts microseconds freely and compares its counter with the end of the wait, as that
//! of the micro:bit does. `rp2040-hal` starts the clocks and runs the USB. It may panic. Then
//! everything stops. QEMU does not have this chip, so the firmware is built, but not run.
//: MEMORY
//: {
//:   BOOT2 : ORIGIN = 0x10000000, LENGTH = 256
//:   FLASH : ORIGIN = 0x10000100, LENGTH = 2M - 8K - 256
//:   RAM   : ORIGIN = 0x20000000, LENGTH = 256K
//: }
//: SECTIONS
//: {
//:   .boot2 ORIGIN(BOOT2) : { KEEP(*(.boot2)); } > BOOT2
//: } INSERT BEFORE .text;

#[cfg(feature = "flash")]
mod pico_flash;

#[cfg(feature = "flash")]
pub use pico_flash::{SECTOR_BYTES, UNIT_BYTES, flash_erase, flash_read, flash_write};

use crate::{
    CriticalSection, Pins, Shared,
    nvic::{self, Vector, vectors},
    registers::{read, set},
};
use rp2040_hal::clocks::{ClocksManager, InitError, init_clocks_and_plls};
use rp2040_hal::usb::UsbBus;
use rp2040_hal::{Watchdog, pac};
use usb_device::class_prelude::UsbBusAllocator;
use usb_device::device::{StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbVidPid};
use usbd_serial::{SerialPort, USB_CLASS_CDC};

const CRYSTAL_HZ: u32 = 12_000_000;
const IO_BANK: usize = 0x4001_4000;
const PADS: usize = 0x4001_c000;
const TIMER: usize = 0x4005_4000;
const ALARM: usize = 0x10;
const ARMED: usize = 0x20;
const NOW_US: usize = 0x28;
const INTR: usize = 0x34;
const INTE: usize = 0x38;
const SIO: usize = 0xd000_0000;
const GPIO_IN: usize = 0x04;
const OUT_SET: usize = 0x14;
const OUT_CLR: usize = 0x18;
const OE_SET: usize = 0x24;
/// The function of a pin that the SIO drives.
const BY_SIO: u32 = 5;
/// A pad with input, 4 mA and pull-up.
const PULLED_UP: u32 = 1 << 6 | 1 << 4 | 1 << 3;
/// Motors, from bit 0: GP2 to GP9.
const MOTORS: u32 = 0xff << 2;
/// Other outputs: GP10 to GP13.
const OUTPUTS: u32 = 0xf << 10;
/// Switches to ground: GP14 to GP18.
const INPUTS: [usize; 5] = [14, 15, 16, 17, 18];
/// Three more of them, for the buttons of a Grbl controller: GP19 to GP21.
const BUTTONS: [usize; 3] = [19, 20, 21];
/// The PWM of a spindle: GP22, channel A of slice 3, 1.9 kHz.
const PWM_PIN: usize = 22;
const PWM: usize = 0x4005_0000 + 3 * 0x14;
const PWM_DIVIDER: usize = 0x04;
const PWM_COMPARE: usize = 0x0c;
const PWM_TOP: usize = 0x10;
/// The function of a pin that its PWM drives.
const BY_PWM: u32 = 4;
/// With the feature `wide`: motors at GP2 to GP19, two outputs at GP20 and GP21, three switches at
/// GP22, GP26 and GP27, three jumpers to ground at GP0, GP1 and GP28.
const IS_WIDE: bool = cfg!(feature = "wide");
const WIDE_MOTORS: u32 = 0x3_ffff << 2;
const WIDE_OUTPUTS: u32 = 3 << 20;
const WIDE_INPUTS: [usize; 3] = [22, 26, 27];
#[cfg(feature = "wide")]
const JUMPERS: [usize; 3] = [0, 1, 28];
/// The time in which the pull-up of a pin raises it, us.
#[cfg(feature = "wide")]
const PULL_UP_US: u32 = 10;
/// The motors' pins, the other outputs and the switches with these features.
const MOTORS_NOW: u32 = if IS_WIDE { WIDE_MOTORS } else { MOTORS };
const OUTPUTS_NOW: u32 = if IS_WIDE { WIDE_OUTPUTS } else { OUTPUTS };
const INPUTS_NOW: &[usize] = if IS_WIDE { &WIDE_INPUTS } else { &INPUTS };
const BUTTONS_NOW: &[usize] = if IS_WIDE { &[] } else { &BUTTONS };
/// The timer accepts every wait: none is above 2^31.
pub const LONGEST_US: u32 = u32::MAX;
/// The counter of time counts microseconds.
pub const CLOCKS_PER_US: u32 = 1;
/// The shortest wait: the time that setting it takes.
const LEAST_US: u32 = 2;
/// Numbers of the interrupts.
const TIMER_0: u16 = 0;
const USB: u16 = 5;
/// An identity for tests and examples in a laboratory: <https://pid.codes/1209/0001/>. A product
/// needs its own.
const IDENTITY: UsbVidPid = UsbVidPid(0x1209, 0x0001);

/// The second stage of the boot loader, which the chip runs before the program.
#[used]
#[unsafe(link_section = ".boot2")]
static BOOT2: [u8; 256] = rp2040_boot2::BOOT_LOADER_W25Q080;

/// The port and its device.
struct Line {
    device: UsbDevice<'static, UsbBus>,
    port: SerialPort<'static, UsbBus>,
}

static LINE: Shared<Option<Line>> = Shared::new(None);

/// The end of the last wait.
static LAST_US: Shared<u32> = Shared::new(0);

/// Starts pins, timer, USB and interrupts.
pub fn start() {
    // If the clocks do not start, there is no link.
    LINE.with(|line| *line = open().ok().flatten());
    for pin in (0..32).filter(|pin| (MOTORS_NOW | OUTPUTS_NOW) >> pin & 1 != 0) {
        set(IO_BANK + 8 * pin + 4, BY_SIO);
    }
    for pin in INPUTS_NOW.iter().chain(BUTTONS_NOW) {
        set(IO_BANK + 8 * pin + 4, BY_SIO);
        set(PADS + 4 + 4 * pin, PULLED_UP);
    }
    set(SIO + OE_SET, MOTORS_NOW | OUTPUTS_NOW);
    LAST_US.with(|last| *last = read(TIMER + NOW_US));
    nvic::unmask(TIMER_0);
    nvic::unmask(USB);
}

/// Starts clocks and peripherals, and opens the serial port.
fn open() -> Result<Option<Line>, InitError> {
    // Safety: `start` is called once, and nothing else owns the peripherals.
    let mut chip = unsafe { pac::Peripherals::steal() };
    let mut watchdog = Watchdog::new(chip.WATCHDOG);
    let ClocksManager { usb_clock, .. } = init_clocks_and_plls(
        CRYSTAL_HZ,
        chip.XOSC,
        chip.CLOCKS,
        chip.PLL_SYS,
        chip.PLL_USB,
        &mut chip.RESETS,
        &mut watchdog,
    )?;
    // The timer's microseconds.
    watchdog.enable_tick_generation((CRYSTAL_HZ / 1_000_000) as u8);
    chip.RESETS.reset().modify(|_, resets| {
        resets.io_bank0().clear_bit();
        resets.pads_bank0().clear_bit();
        resets.pwm().clear_bit();
        resets.timer().clear_bit()
    });
    while !chip.RESETS.reset_done().read().timer().bit() {}
    let bus = UsbBus::new(
        chip.USBCTRL_REGS,
        chip.USBCTRL_DPRAM,
        usb_clock,
        true,
        &mut chip.RESETS,
    );
    let allocator = cortex_m::singleton!(: UsbBusAllocator<UsbBus> = UsbBusAllocator::new(bus));
    Ok(allocator.and_then(|allocator| {
        let port = SerialPort::new(allocator);
        let strings = [StringDescriptors::default().product("husillo")];
        let device = UsbDeviceBuilder::new(allocator, IDENTITY)
            .strings(&strings)
            .ok()?
            .device_class(USB_CLASS_CDC)
            .build();
        Some(Line { device, port })
    }))
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

/// Sets the PWM at GP22. It begins with the first call.
pub fn drive(duty: u8) {
    set(PWM + PWM_DIVIDER, 255 << 4);
    set(PWM + PWM_TOP, 254);
    set(PWM + PWM_COMPARE, duty.into());
    set(PWM, 1);
    set(IO_BANK + 8 * PWM_PIN + 4, BY_PWM);
}

/// This board has no counter for an encoder.
pub fn counts(simulated: u16) -> u16 {
    simulated
}

/// The levels as a register. They are a byte, unless the feature `wide` is on.
#[inline(always)]
fn bits(levels: impl Into<u32>) -> u32 {
    levels.into()
}

/// Sets the motors' pins.
#[inline]
pub fn write(levels: Pins) {
    let high = bits(levels) << 2;
    set(SIO + OUT_CLR, MOTORS_NOW & !high);
    set(SIO + OUT_SET, high & MOTORS_NOW);
}

/// Sets the other outputs.
pub fn switch(outputs: u8) {
    let high = u32::from(outputs) << 10 & OUTPUTS;
    let high = if IS_WIDE { high << 10 } else { high };
    set(SIO + OUT_CLR, OUTPUTS_NOW & !high);
    set(SIO + OUT_SET, high & OUTPUTS_NOW);
}

/// Reads the switches; a closed one is 1.
pub fn inputs(simulated: u8) -> u8 {
    if cfg!(not(feature = "switches")) {
        return simulated;
    }
    closed(INPUTS_NOW) | closed(BUTTONS_NOW) << INPUTS.len()
}

/// Which of these pins are at ground.
fn closed(pins: &[usize]) -> u8 {
    let open = read(SIO + GPIO_IN);
    pins.iter()
        .rev()
        .fold(0, |closed, pin| closed << 1 | (!open >> pin & 1) as u8)
}

/// Reads the jumpers; a closed one is 1.
#[cfg(feature = "wide")]
pub fn jumpers() -> u8 {
    for pin in JUMPERS {
        set(IO_BANK + 8 * pin + 4, BY_SIO);
        set(PADS + 4 + 4 * pin, PULLED_UP);
    }
    let begin = clock();
    while clock().wrapping_sub(begin) < PULL_UP_US {}
    closed(&JUMPERS)
}

/// The counter of time, which wraps: [`CLOCKS_PER_US`] a microsecond.
pub fn clock() -> u32 {
    read(TIMER + NOW_US)
}

/// Calls `on_time` this many microseconds after the end of the previous wait, or at once if that
/// time has passed.
pub fn wait(us: u32, section: CriticalSection<'_>) {
    LAST_US.within(section, |last| {
        // If the previous wait was cut short, its end is later than now. Then this wait counts from
        // now.
        let now = read(TIMER + NOW_US);
        let is_cut = last.wrapping_sub(now) < 1 << 31;
        *last = if is_cut { now } else { *last }.wrapping_add(us);
        loop {
            // If the time has passed, the difference wraps. If it passed long ago, the difference
            // may have any value, but seldom one within the wait.
            let now = read(TIMER + NOW_US);
            let left = last.wrapping_sub(now);
            if left < LEAST_US || left > us {
                *last = now.wrapping_add(LEAST_US);
            }
            set(TIMER + INTR, 1);
            set(TIMER + ALARM, *last);
            // If the time has passed in between, the alarm would come only after 2^32 us.
            let left = last.wrapping_sub(read(TIMER + NOW_US));
            if left.wrapping_sub(1) < 1 << 31 || read(TIMER + ARMED) & 1 == 0 {
                break;
            }
        }
        set(TIMER + INTE, 1);
    });
}

/// Cancels the wait.
pub fn stop() {
    set(TIMER + INTE, 0);
    set(TIMER + ARMED, 1);
    set(TIMER + INTR, 1);
    nvic::unpend(TIMER_0);
}

/// Takes at most one packet from the host. It has only a few bytes if the protocol echoes each
/// byte.
extern "C" fn on_usb() {
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

/// The chip's interrupts by their numbers.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [Vector; 32] = vectors([(0, on_timer_interrupt), (5, on_usb)]);

extern "C" fn on_timer_interrupt() {
    set(TIMER + INTE, 0);
    set(TIMER + INTR, 1);
    // Safety: this is an interrupt's handler.
    crate::on_time(unsafe { crate::section() });
}
