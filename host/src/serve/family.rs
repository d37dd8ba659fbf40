//! The families of controllers that the pages operate.

use super::drill_program::millimetres;
use super::figure_program::Factory;
use husillo_machine::Config;
use husillo_metrology::heads;
use husillo_metrology::simulated::SimulatedNetwork;
use husillo_simulator::machines::machine_file::MachineFile;
use husillo_transports::drill::Table;
use husillo_transports::grbl::Settings;
use std::sync::Arc;

/// A family of controllers: those with one protocol, and with one panel in the page.
#[derive(Clone, Debug)]
pub enum Family {
    /// Controllers that speak Grbl's protocol. The settings are those of a simulated one.
    Grbl(Box<Settings>),
    /// The micro mill.
    Micromill {
        /// Its description.
        file: Arc<MachineFile>,
        /// Its steps.
        config: Box<Config<3>>,
    },
    /// The circuit-board drill.
    Drill,
    /// The desktop microfactory.
    Microfactory(Arc<Factory>),
    /// A measuring machine.
    Measuring(Box<MeasuringMachine>),
}

/// A measuring machine.
#[derive(Clone, Debug)]
pub struct MeasuringMachine {
    /// Its name, or the path of its file.
    pub name: String,
    /// Its description.
    pub machine: heads::Machine,
    /// Its modules in a simulation.
    pub network: SimulatedNetwork,
}

impl Family {
    /// Its name, as pages get it.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Grbl(_) => "grbl",
            Self::Micromill { .. } => "micromill",
            Self::Drill => "drill",
            Self::Microfactory(_) => "microfactory",
            Self::Measuring(_) => "measuring",
        }
    }

    /// What the pages can do with it, besides moving it by hand.
    pub const fn offers(&self) -> &'static [&'static str] {
        match self {
            Self::Grbl(_) => &[
                "program", "from", "report", "probing", "heights", "settings", "macros",
            ],
            Self::Micromill { .. } | Self::Drill => &["program", "from", "report"],
            // The controller cuts a figure from its begin to its end.
            Self::Microfactory(_) => &["program", "report"],
            Self::Measuring(_) => &["routine", "report"],
        }
    }

    /// The letters of its axes.
    pub fn axes(&self) -> Vec<char> {
        match self {
            Self::Measuring(measuring) => {
                let axes = measuring.machine.axes.iter();
                axes.map(|axis| axis.letter).collect()
            }
            Self::Grbl(_) | Self::Micromill { .. } | Self::Drill | Self::Microfactory(_) => {
                vec!['X', 'Y', 'Z']
            }
        }
    }

    /// The travel of its axes from machine zero, mm, as far as it is known without the controller.
    pub fn travel_mm(&self) -> Option<[Option<[f64; 2]>; 3]> {
        match self {
            // That of the microfactory is not documented.
            Self::Grbl(_) | Self::Microfactory(_) | Self::Measuring(_) => None,
            Self::Micromill { config, .. } => Some(config.axes.map(|axis| {
                let travel = axis.travel?;
                Some(travel.map(|nm| nm.0 as f64 / 1e6))
            })),
            // Z is moved by the machine, from sensor to sensor.
            Self::Drill => Some([
                Some([0.0, millimetres(Table::DRILL.x)]),
                Some([0.0, millimetres(Table::DRILL.y)]),
                None,
            ]),
        }
    }

    /// Rate of its serial line, bits/s.
    pub const fn baud(&self) -> u32 {
        match self {
            Self::Grbl(_) => husillo_clients::grbl::BAUD,
            Self::Micromill { .. } => husillo_clients::micromill::BAUD,
            Self::Drill => husillo_clients::drill::BAUD,
            Self::Microfactory(_) => husillo_clients::microfactory::BAUD,
            Self::Measuring(measuring) => measuring.machine.baud.bits_per_s(),
        }
    }
}
