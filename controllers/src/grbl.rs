//! Grbl 1.1 on the motion engine of `husillo-machine`.

mod accidents;
mod block;
mod checked;
mod dollar;
mod door;
#[cfg(feature = "drivers")]
mod driver;
mod event;
#[cfg(feature = "grblhal")]
mod hal;
#[cfg(feature = "height-map")]
mod height;
mod homing;
mod lines;
mod memory;
mod motion;
mod options;
mod outputs;
mod probe;
mod realtime;
mod recovery;
mod report;
mod spindle;
mod words;

use husillo_backlash::Backlash;
use husillo_gcode::{Command, Commands, Dialect, Modal, Nm};
use husillo_interp::Path;
use husillo_machine::{Axis, AxisRamp, Config, Equipment, Machine, Scale};
use husillo_transports::grbl::{Feedback, LineReader, Message, Receiver, Settings, Text, Units};

use crate::Controller;
use crate::ring::Ring;

#[cfg(feature = "drivers")]
pub use driver::GrblDriver;
pub use event::{GrblEvent, GrblInputs, GrblStops};
pub use memory::GrblMemory;
pub use options::{GrblOptions, Protocol};

use accidents::Accidents;
use checked::Checks;
use door::DoorStep;
#[cfg(feature = "grblhal")]
use hal::Hal;
#[cfg(feature = "height-map")]
use height::Height;
use homing::Homing;
use lines::{Origin, Task};
use memory::StoredLine;
use motion::Tag;
use outputs::Driven;
use realtime::Flags;
use recovery::Recovery;
use spindle::Outputs;

/// One step per millimetre.
const MILLIMETRE: Scale = Scale::new(1_000_000, 1).expect("both are above 0");
/// Ticks of the events per second.
const TIMER_HZ: u32 = 1_000_000;
/// Longest wait of an event in microseconds. The inputs are read at least this often.
const LONGEST_WAIT_US: u32 = 1000;
/// A line is executed only if the output has this many free bytes. The longest list needs fewer.
const ROOM_FOR_LINE: usize = 640;
/// A status report is sent only if the output has this many free bytes.
const ROOM_FOR_REPORT: usize = 256;
/// A message about a request is sent only if the output has this many free bytes. The answer of a
/// probe move, which follows without a further check, needs fewer.
const ROOM_FOR_NOTE: usize = 96;

/// State of the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Idle,
    Run,
    /// Feed hold. `true` while the motors still brake.
    Hold(bool),
    Jog,
    Alarm,
    Door(DoorStep),
    Check,
    Home,
    Sleep,
    /// The operator changes the tool.
    #[cfg(feature = "grblhal")]
    Tool,
}

/// Characters of the present line.
#[cfg(feature = "grblhal")]
const LINE: usize = hal::LINE;
#[cfg(not(feature = "grblhal"))]
const LINE: usize = husillo_transports::grbl::LINE_CHARACTERS;

/// A Grbl 1.1 controller of three axes, with `QUEUE` moves of look-ahead.
///
/// It begins to move when the line has been silent for 3 ms, when the queue is full, or when a line
/// waits for the end of motion. [`Controller`] describes its use. `docs/grbl.md` describes its
/// differences from Grbl.
///
/// # Examples
///
/// ```
/// use husillo_controllers::{Controller, Grbl, GrblEvent, GrblInputs, GrblMemory, GrblOptions};
///
/// let mut grbl: Grbl = Grbl::new(GrblOptions::STOCK, Some(&GrblMemory::FACTORY));
/// let (mut steps, mut replies) = (0, Vec::new());
/// let mut run = |grbl: &mut Grbl, line: &[u8]| {
///     line.iter().for_each(|byte| assert!(!grbl.receive(*byte)));
///     while let Some(event) = grbl.next_event(0, &GrblInputs::default()) {
///         if let GrblEvent::Step { delta, .. } = event {
///             steps += i32::from(delta[0]);
///         }
///         grbl.made(0, 1);
///         replies.extend(std::iter::from_fn(|| grbl.transmit()));
///     }
/// };
/// run(&mut grbl, b"");
/// run(&mut grbl, b"G0 X2\n");
/// assert_eq!(steps, 500);
/// assert_eq!(replies, b"\r\nGrbl 1.1h ['$' for help]\r\nok\r\n");
/// ```
#[derive(Clone, Debug)]
pub struct Grbl<const QUEUE: usize = 15> {
    options: GrblOptions,
    memory: GrblMemory,
    /// No stored memory was found. The first start reports this.
    is_blank: bool,
    machine: Machine<3, Path<3>, Backlash, QUEUE>,
    modal: Modal<3>,
    /// Commands of the present line. `next` is the one that could not be executed yet.
    commands: Commands<3>,
    next: Option<Command<3>>,
    receiver: Receiver<256>,
    reader: LineReader,
    line: StoredLine<LINE>,
    origin: Origin,
    checks: Checks,
    /// Tag of the moves of the present line.
    tag: Tag,
    /// Tags of the moves in the queue, and the slot of the next one.
    tags: [Tag; QUEUE],
    next_tag: u32,
    task: Task,
    output: Ring<u8, 1024>,
    events: Ring<GrblEvent, 8>,
    phase: Phase,
    recovery: Recovery,
    flags: Flags,
    inputs: GrblInputs,
    /// Steps of the program that were made.
    steps: [i32; 3],
    /// An axis has made a step since all were at rest.
    has_stepped: bool,
    /// The event that was returned and is not made yet: its wait, and the steps that it counts.
    pending: Option<(u32, [i8; 3])>,
    /// The rest of a long wait, and the step after it.
    rest: Option<(u32, [i8; 3])>,
    /// Microseconds until queued moves begin.
    start_us: u32,
    /// Microseconds until the motors are switched off. `None`: they are off, or stay on.
    idle_us: Option<u32>,
    dwell_us: u64,
    /// Overrides of feed, rapids and spindle, in percent.
    overrides: [u8; 3],
    /// Numbers of status reports until the next report with the work zero, and until the next
    /// report with the overrides.
    reports: [u8; 2],
    work_zero: [i64; 3],
    outputs: Outputs,
    driven: Driven,
    /// T word of the last block.
    tool: u8,
    #[cfg(feature = "grblhal")]
    hal: Hal,
    #[cfg(feature = "height-map")]
    height: Height,
    /// Position of the last contact, and whether the last probe move found a contact.
    probe: ([i64; 3], bool),
    /// Position in steps at the contact of the present probe move.
    contact: Option<[i32; 3]>,
    homing: Homing,
    /// Microseconds until braking begins.
    brake_us: u32,
    accidents: Accidents,
    /// Microseconds during which further requests for a report are ignored.
    merge_us: u32,
    /// Whether a jog is being cancelled.
    is_cancelling: bool,
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Creates a controller at power-on, with the memory of its last run. `None` means that no
    /// valid memory is stored. The controller then starts with its defaults, and sends `error:7`
    /// and the list of settings.
    pub fn new(options: GrblOptions, memory: Option<&GrblMemory>) -> Self {
        let kept = memory.copied().unwrap_or(GrblMemory::FACTORY);
        let mut grbl = Grbl {
            options,
            memory: kept,
            is_blank: memory.is_none(),
            machine: Machine::new(config(&kept.settings)),
            modal: Modal::new(options.dialect()),
            commands: Commands::new(),
            next: None,
            receiver: Receiver::new(),
            reader: LineReader::new(),
            line: StoredLine::EMPTY,
            origin: Origin::Host,
            checks: Checks::default(),
            tag: Tag::default(),
            tags: [Tag::default(); QUEUE],
            next_tag: 0,
            task: Task::None,
            output: Ring::new(0),
            events: Ring::new(GrblEvent::Store),
            phase: Phase::Idle,
            recovery: Recovery::None,
            flags: Flags::default(),
            inputs: GrblInputs::default(),
            steps: [0; 3],
            has_stepped: false,
            pending: None,
            rest: None,
            start_us: 0,
            idle_us: None,
            dwell_us: 0,
            overrides: [100; 3],
            reports: [0; 2],
            work_zero: [0; 3],
            outputs: Outputs::OFF,
            driven: Driven::default(),
            tool: 0,
            #[cfg(feature = "grblhal")]
            hal: Hal::new(),
            #[cfg(feature = "height-map")]
            height: Height::OFF,
            probe: ([0; 3], false),
            contact: None,
            homing: Homing::default(),
            brake_us: 0,
            accidents: Accidents::default(),
            merge_us: 0,
            is_cancelling: false,
        };
        grbl.power_on();
        grbl
    }

    /// Returns the data to be kept while the power is off.
    pub const fn memory(&self) -> &GrblMemory {
        &self.memory
    }

    /// Returns the positions of the motors, in steps from machine zero. Until the axes are homed,
    /// machine zero is the position at power-on.
    pub const fn position_steps(&self) -> [i32; 3] {
        #[cfg(feature = "height-map")]
        {
            let [x, y, z] = self.steps;
            [x, y, z.wrapping_add(self.height.correction())]
        }
        #[cfg(not(feature = "height-map"))]
        self.steps
    }

    const fn settings(&self) -> &Settings {
        &self.memory.settings
    }

    fn units(&self) -> Units {
        if self.settings().is_set(13) {
            Units::Inches
        } else {
            Units::Millimetres
        }
    }

    /// Appends a message to the output.
    fn send(&mut self, message: &Message) {
        self.send_text(&message.write(self.units()));
    }

    /// Appends a message about a request of the operator, unless an answer may need the room.
    fn tell(&mut self, feedback: Feedback) {
        if self.room() >= ROOM_FOR_NOTE {
            self.send(&Message::Feedback(feedback));
        }
    }

    /// Appends a line to the output.
    fn send_text(&mut self, text: &Text) {
        for byte in text.bytes().iter().chain(b"\r\n") {
            self.output.push(*byte);
        }
    }

    /// Returns the number of free bytes of the output.
    const fn room(&self) -> usize {
        1024_usize.saturating_sub(self.output.len())
    }

    /// Returns the position of the axes in nanometres.
    fn position(&self) -> [Nm; 3] {
        self.position_of(self.steps)
    }

    fn position_of(&self, steps: [i32; 3]) -> [Nm; 3] {
        let mut position = [Nm(0); 3];
        let axes = self.machine.config().axes.iter().zip(steps);
        for (position, (axis, steps)) in position.iter_mut().zip(axes) {
            *position = Nm(axis.scale.position(steps));
        }
        position
    }

    /// Applies new settings. Call it only while nothing moves.
    fn configure(&mut self) {
        #[cfg(not(feature = "height-map"))]
        let config = config(self.settings());
        #[cfg(feature = "height-map")]
        let config = self.config_with_map();
        self.machine = Machine::new(config);
        self.machine.set_feed_override(self.overrides[0]);
        self.machine.set_rapid_override(self.overrides[1]);
        self.drop_moves();
    }

    /// Drops all moves. The axes keep the positions that they have reached.
    fn drop_moves(&mut self) {
        self.machine.abort();
        let position = self.position();
        // The steps that were made fit 31 bits.
        let _ = self.machine.place([Nm(0); 3], position);
        self.modal.set_position(position);
        self.rest = None;
        self.start_us = 0;
        self.brake_us = 0;
    }

    /// Executes everything that can be executed now.
    fn work(&mut self) {
        // Each round takes a byte, a line or a command. The bound covers all bytes of the buffer.
        for _ in 0..2000 {
            if !self.take_turn() {
                return;
            }
        }
    }

    /// Whether no line is executed in the present state.
    fn is_suspended(&self) -> bool {
        #[cfg(feature = "grblhal")]
        if self.phase == Phase::Tool && !self.hal.is_acknowledged() {
            return true;
        }
        matches!(self.phase, Phase::Hold(_) | Phase::Door(_) | Phase::Sleep)
    }

    fn take_turn(&mut self) -> bool {
        if self.recover() {
            return true;
        }
        let is_stopping = self.flags.reset;
        if is_stopping || self.recovery != Recovery::None {
            return false;
        }
        if self.take_flags() {
            return true;
        }
        !self.is_suspended() && self.room() >= ROOM_FOR_LINE && self.continue_line()
    }
}

/// Returns the configuration of the engine for these settings, without a height map.
fn config(settings: &Settings) -> Config<3> {
    let axis = |index: u8| {
        // Numbers are below 133.
        let number = |first: u8| settings.milli(first.wrapping_add(index));
        let milli_steps = number(100).max(1);
        let per_second = |milli: u32, divisor: u64| {
            let product = u64::from(milli).wrapping_mul(milli_steps.into());
            let hz = product.checked_div(divisor).unwrap_or(0).clamp(1, 1 << 30);
            hz as u32
        };
        let travel_nm = i64::from(number(130)).wrapping_mul(1000);
        Axis {
            // Both are above 0.
            scale: Scale::new(1_000_000_000, milli_steps).unwrap_or(MILLIMETRE),
            travel: settings
                .is_set(20)
                .then_some([Nm(travel_nm.wrapping_neg()), Nm(0)]),
            max_rate_hz: per_second(number(110), 60_000_000),
            backlash_steps: 0,
            ramp: Some(AxisRamp {
                acceleration_hz_per_s: per_second(number(120), 1_000_000),
                start_rate_hz: 0,
                jerk_hz_per_s2: None,
                junction_hz: None,
            }),
        }
    };
    Config {
        axes: [axis(0), axis(1), axis(2)],
        equipment: Equipment::NONE,
        timer_hz: TIMER_HZ,
        dialect: Dialect::GRBL,
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        corner_deviation: Some(Nm(i64::from(settings.milli(11)).wrapping_mul(1000))),
        spindle_counts: None,
    }
}

impl<const QUEUE: usize> Controller for Grbl<QUEUE> {
    type Inputs = GrblInputs;
    type Event = GrblEvent;
    type Stops = GrblStops;

    fn receive(&mut self, byte: u8) -> bool {
        #[cfg(feature = "grblhal")]
        if self.is_hal() && self.hal_takes(byte) {
            return false;
        }
        match self.receiver.push(byte) {
            Some(realtime) => self.take_realtime(realtime),
            None => {
                // A line that follows immediately postpones the motion, unless the motion is about
                // to begin.
                if self.start_us > 0 && !self.is_underway() {
                    self.start_us = motion::START_US;
                }
                false
            }
        }
    }

    fn stops(&self) -> GrblStops {
        GrblStops(self.pending.is_some() && !self.options.brakes_at_reset())
    }

    fn halted(&mut self) {
        self.pending = None;
        #[cfg(feature = "height-map")]
        self.height.dropped();
    }

    fn next_event(&mut self, machine: u8, inputs: &GrblInputs) -> Option<GrblEvent> {
        if machine != 0 || self.pending.is_some() {
            return None;
        }
        self.take_inputs(inputs);
        // A round that ends a motion may begin another one.
        for _ in 0..16 {
            self.work();
            if let Some(event) = self.events.pop() {
                return Some(event);
            }
            match self.motion() {
                motion::Next::Event(event) => return Some(event),
                motion::Next::Stopped => {}
                motion::Next::Nothing => break,
            }
        }
        if let Some(event) = self.events.pop() {
            return Some(event);
        }
        let wait_ticks = self.wait_us()?;
        self.pending = Some((wait_ticks, [0; 3]));
        Some(GrblEvent::Wait { wait_ticks })
    }

    fn made(&mut self, _: u8, events: usize) {
        if events == 0 {
            return;
        }
        if let Some((wait_us, delta)) = self.pending.take() {
            self.has_stepped |= delta != [0; 3];
            for (steps, delta) in self.steps.iter_mut().zip(delta) {
                *steps = steps.wrapping_add(delta.into());
            }
            #[cfg(feature = "height-map")]
            self.height.made(wait_us);
            self.pass(wait_us);
        }
    }

    fn has_event(&self) -> bool {
        self.pending.is_none() && !self.events.is_empty()
    }

    fn transmit(&mut self) -> Option<u8> {
        self.work();
        // What was answered must be kept without power.
        if self.events.contains(GrblEvent::Store) {
            return None;
        }
        self.output.pop()
    }

    fn reset(&mut self) {
        let (options, memory, is_blank) = (self.options, self.memory, self.is_blank);
        *self = Grbl::new(options, (!is_blank).then_some(&memory));
    }
}
