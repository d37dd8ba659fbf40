//! The microfactory behind its link, and a figure that comes in.

use heapless::{Vec, spsc::Queue};
use husillo_controllers::Microfactory;
use husillo_controllers::MicrofactoryConfig;
use husillo_transports::microfactory::{ByteTable, Device, Order, REJECTED};

/// Moves of a figure that there is room for.
const ROOM: usize = 500;
type Figure = Vec<[i16; 2], ROOM, u16>;

/// As the simulated one of `husillo` is: a jog ends half a second after it was said last.
const CONFIG: MicrofactoryConfig = MicrofactoryConfig {
    dead_man_ticks: Some(500_000),
    ..MicrofactoryConfig::ORIGINAL
};

/// The link's end of the controller.
pub struct Link {
    bytes: Device,
    /// The controller.
    pub machine: Microfactory<Figure>,
    loading: Figure,
    /// Answers; a status is the longest.
    out: Queue<u8, 64>,
}

impl Link {
    /// Without a figure.
    pub fn new() -> Self {
        Link {
            bytes: Device::new(ByteTable::DEFAULT)
                .acknowledging()
                .storing(ROOM as u16),
            machine: Microfactory::new(CONFIG, Vec::new()),
            loading: Vec::new(),
            out: Queue::new(),
        }
    }

    /// Takes a byte of the line.
    pub fn receive(&mut self, byte: u8) {
        let received = self.bytes.receive(byte, self.machine.is_moving());
        let is_taken = match received.command {
            Some(command) if command.is_a_motion() => self.machine.command(command),
            _ => true,
        };
        if let Some(reply) = received.reply {
            self.answer(&[if is_taken { reply } else { REJECTED }]);
        }
        // Nothing moves while a figure comes in, so the machine takes it; the link counts its moves.
        match received.command {
            Some(Order::Ask) => {
                let status = self.machine.status();
                self.answer(&status.bytes());
            }
            Some(Order::Clear) => {
                self.loading.clear();
                self.machine.set_figure(Vec::new()).ok();
            }
            Some(Order::Line(way)) => {
                self.loading.push(way).ok();
            }
            Some(Order::Keep) => {
                self.machine
                    .set_figure(core::mem::take(&mut self.loading))
                    .ok();
            }
            _ => {}
        }
    }

    /// An axis has closed its switch.
    pub fn leave_mode(&mut self) {
        self.bytes.leave_mode();
    }

    /// The next byte for the line.
    pub fn transmit(&mut self) -> Option<u8> {
        self.out.dequeue()
    }

    /// What finds no room is lost: the host asks again.
    fn answer(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.out.enqueue(*byte).ok();
        }
    }
}
