//! The simulated microfactory.

use super::{Event, Machine, Pair, block, hold};
use crate::text::counted;
use crate::{Emulated, MicrofactoryRig};
use husillo_controllers::{
    MicrofactoryConfig, MicrofactoryEvent, MicrofactoryReport, MicrofactoryStation,
};
use husillo_transports::microfactory::{ByteTable, Device as LinkDevice};

/// Largest number of moves of a figure.
pub const ROOM: u16 = 1000;
/// A jog ends after this number of ticks unless it is repeated. Only devices that answer have this
/// limit.
const DEAD_MAN_TICKS: u32 = 500_000;
/// First positions of the axes in steps above their home switches. `FACE_STEPS` is the distance
/// from the tool to the work piece.
const ABOVE_SWITCHES: [u16; 3] = [420, 380, 900];
const FACE_STEPS: i32 = 1200;

/// The device: a controller of one machine, or of two.
pub type Device = super::Device<EmulatedMicrofactory>;

/// A controller of one or two machines.
type Station = MicrofactoryStation<{ ROOM as usize }, 2>;

/// A microfactory: the moves of the figure of each machine.
#[derive(Debug)]
pub struct EmulatedMicrofactory {
    moves: [usize; 2],
    machines: u8,
}

impl Device {
    /// Creates a device that is switched on, with a figure in its memory. A device that answers
    /// also has a dead-man's time. A device without answers is the original. A second machine is
    /// like the first.
    ///
    /// # Errors
    ///
    /// The figure has too many moves.
    pub fn new(
        config: MicrofactoryConfig,
        table: ByteTable,
        pull_out_ticks: u32,
        figure: &[[i16; 2]],
        answers: bool,
        bits_per_s: u32,
        machines: u8,
    ) -> Result<Self, String> {
        let config = MicrofactoryConfig {
            dead_man_ticks: answers.then_some(DEAD_MAN_TICKS),
            ..config
        };
        let mut link = LinkDevice::new(table);
        if answers {
            link = link.acknowledging().storing(ROOM);
        }
        if machines > 1 {
            link = link.of_two_machines();
        }
        let mut station = Station::new(link, config);
        let mut machine = EmulatedMicrofactory {
            moves: [0; 2],
            machines,
        };
        for (number, moves) in (0..machines).zip(&mut machine.moves) {
            if !station.store(number, figure) {
                let moves = figure.len();
                return Err(format!(
                    "a figure of {}: there is room for {ROOM}",
                    counted(moves, "move")
                ));
            }
            *moves = figure.len();
        }
        let rig = MicrofactoryRig::new(&config, ABOVE_SWITCHES, FACE_STEPS, pull_out_ticks);
        let emulated = Emulated::new(station, vec![rig; machines.into()]);
        Ok(Self::of(machine, emulated, bits_per_s))
    }
}

impl Machine for EmulatedMicrofactory {
    type Controller = Station;
    type Plant = MicrofactoryRig;

    /// The states are the current of the motors, RESET of their sequencers, and the number of the
    /// machine.
    const COLUMNS: &'static str = "dx,dy,dz,dc,current,reset,machine";
    const PANEL: &'static str = "close x|y|z|contact, open x|y|z|contact, \
                                 free x|y|z|contact, block x|y|z, unblock x|y|z; 2: before it for \
                                 the second machine";
    const AT_RESET: MicrofactoryEvent = MicrofactoryEvent::Enable(false);

    fn place(&self, emulated: &Pair<Self>, number: u8) -> String {
        let machine = emulated.controller().machine(number);
        let (Some(machine), Some(rig)) = (machine, emulated.plant(number)) else {
            return String::new();
        };
        let [x, y, z, spindle] = machine.position_steps();
        let frame = if machine.is_homed() {
            "from home"
        } else {
            "not homed"
        };
        let lost: u64 = rig.lost_steps().iter().sum();
        format!("x {x} y {y} z {z} spindle {spindle} steps, {frame}; {lost} lost")
    }

    fn control(&self, rig: &mut MicrofactoryRig, words: &[&str]) -> Option<String> {
        hold(words, &["x", "y", "z", "contact"], |switch, closed| {
            rig.hold(switch, closed);
        })
        .or_else(|| block(words, &["x", "y", "z"], |axis, is| rig.block(axis, is)))
    }

    fn report(event: &MicrofactoryEvent) -> Option<String> {
        match *event {
            MicrofactoryEvent::Report(report) => Some(text(report)),
            _ => None,
        }
    }

    fn row(event: &Event<Self>, rig: &MicrofactoryRig) -> Option<(Vec<i8>, Vec<u8>)> {
        let (delta, is_reset) = match *event {
            MicrofactoryEvent::Step(step) => (step.delta, false),
            MicrofactoryEvent::Dwell { wait_ticks } if wait_ticks > 0 => ([0; 4], false),
            MicrofactoryEvent::Enable(_) => ([0; 4], false),
            MicrofactoryEvent::Reset { .. } => ([0; 4], true),
            MicrofactoryEvent::Dwell { .. }
            | MicrofactoryEvent::Report(_)
            | MicrofactoryEvent::Idle => return None,
        };
        let states = vec![rig.has_current().into(), is_reset.into()];
        Some((delta.to_vec(), states))
    }

    fn heard(&mut self, station: &Station) -> Option<String> {
        let mut report = None;
        for (number, moves) in (0_u8..).zip(&mut self.moves) {
            let figure = station
                .machine(number)
                .map_or(0, |machine| machine.figure().as_ref().len());
            if figure != *moves && figure > 0 {
                let text = format!("a figure of {}", counted(figure, "move"));
                report = Some(super::numbered(self.machines, number, text));
            }
            *moves = figure;
        }
        report
    }
}

/// The text of a report.
pub fn text(report: MicrofactoryReport) -> String {
    let letter = |axis: u8| {
        ["x", "y", "z"]
            .get(usize::from(axis))
            .copied()
            .unwrap_or("?")
    };
    match report {
        MicrofactoryReport::Homed => "homed".into(),
        MicrofactoryReport::Done => "done".into(),
        MicrofactoryReport::Stopped => "stopped".into(),
        MicrofactoryReport::DeadMan => "stopped: the host was silent".into(),
        MicrofactoryReport::Contact => "the tool touches: the figure begins".into(),
        MicrofactoryReport::NoContact => {
            "no contact within the longest approach; the figure was not cut".into()
        }
        MicrofactoryReport::NoFigure => "no figure is stored".into(),
        MicrofactoryReport::Switch { axis } => {
            format!("home switch {} closed: backing off it", letter(axis))
        }
        MicrofactoryReport::NoSwitch { axis } => {
            format!("no home switch {} within the longest search", letter(axis))
        }
        MicrofactoryReport::StillClosed { axis } => format!(
            "home switch {} is still closed after backing off",
            letter(axis)
        ),
        MicrofactoryReport::Emergency => "emergency stop: nothing moves until a reset".into(),
    }
}
