//! A controller and the machines that it drives, in simulated time.

use husillo_controllers::{
    Controller, DrillEvent, DrillInputs, MicrofactoryEvent, MicrofactoryInputs, MicromillEvent,
    MicromillInputs, Timed,
};

use crate::{DrillRig, MicrofactoryRig, MicromillRig};

/// The mechanics that a controller drives: the readings of its sensors, and the effect of an event.
pub trait Plant {
    /// Switches and sensors.
    type Inputs;
    /// The events of the controller.
    type Event;

    /// The present inputs.
    fn inputs(&self) -> Self::Inputs;

    /// Waits for the time of an event, and then carries it out.
    fn apply(&mut self, event: &Self::Event);
}

/// A controller with its machines: bytes in, bytes out, while time passes.
///
/// At most one event of each machine waits for its time. So a stop takes effect before the next
/// step. This is as in a firmware that requests one event at a time.
///
/// # Examples
///
/// ```
/// use husillo_controllers::{Micromill, MicromillConfig};
/// use husillo_sim::{Emulated, MicromillRig};
///
/// let rig = MicromillRig::new(&MicromillConfig::MICROMILL, [500; 3], 2564);
/// let mill: Micromill = Micromill::new(&MicromillConfig::MICROMILL);
/// let mut emulated = Emulated::new(mill, vec![rig]);
/// for byte in *b"PY+0003;" {
///     emulated.receive(byte);
/// }
/// // Three steps at 170 per second.
/// emulated.pass(20_000, |_, _, _, _| {});
/// let answer: Vec<u8> = std::iter::from_fn(|| emulated.transmit()).collect();
/// assert_eq!(answer, b"\x88PY+0003;\x83\x83\x83\x8f");
/// ```
#[derive(Clone, Debug)]
pub struct Emulated<C: Controller, P> {
    controller: C,
    plants: Vec<P>,
    /// The waiting event of each machine, with the time at which it is due, us.
    due: Vec<Option<(u64, C::Event)>>,
    now_us: u64,
    /// When the last byte arrived, us.
    heard_us: u64,
}

impl<C, P> Emulated<C, P>
where
    C: Controller,
    P: Plant<Inputs = C::Inputs, Event = C::Event>,
{
    /// Creates the pair, switched on at time 0, with a plant for each machine. A tick of the
    /// controller is 1 us.
    #[must_use]
    pub fn new(controller: C, plants: Vec<P>) -> Self {
        let due = plants.iter().map(|_| None).collect();
        Emulated {
            controller,
            plants,
            due,
            now_us: 0,
            heard_us: 0,
        }
    }

    /// Returns the controller.
    #[must_use]
    pub const fn controller(&self) -> &C {
        &self.controller
    }

    /// Returns the number of machines.
    #[must_use]
    pub fn plants(&self) -> u8 {
        u8::try_from(self.plants.len()).unwrap_or(u8::MAX)
    }

    /// Returns a machine.
    #[must_use]
    pub fn plant(&self, machine: u8) -> Option<&P> {
        self.plants.get(usize::from(machine))
    }

    /// Returns a machine, so that its switches or its load can be changed.
    pub fn plant_mut(&mut self, machine: u8) -> Option<&mut P> {
        self.plants.get_mut(usize::from(machine))
    }

    /// Returns the time since the start, us.
    #[must_use]
    pub const fn now_us(&self) -> u64 {
        self.now_us
    }

    /// Passes a byte that arrives now to the controller.
    pub fn receive(&mut self, byte: u8) {
        self.heard_us = self.now_us;
        if self.controller.receive(byte) {
            self.halt();
        }
    }

    /// Drops the waiting events, and confirms the stop to the controller.
    fn halt(&mut self) {
        self.due.fill_with(|| None);
        self.controller.halted();
    }

    /// Returns the next byte that the controller sends now.
    pub fn transmit(&mut self) -> Option<u8> {
        self.controller.transmit()
    }

    /// Presses the reset button. Waiting events are not made.
    pub fn reset(&mut self) {
        self.due.fill_with(|| None);
        self.controller.reset();
    }

    /// Lets time pass without power. The machines do nothing.
    pub const fn pass_without_power(&mut self, us: u64) {
        self.now_us += us;
    }

    /// Lets time pass, and carries out the events that are due. `made` receives each event with the
    /// number of its machine, its time in us, and the state of the machine after it.
    pub fn pass(&mut self, us: u64, mut made: impl FnMut(u8, u64, &C::Event, &P)) {
        let end_us = self.now_us + us;
        loop {
            let lease_us = self.controller.lease_us().map(u64::from);
            let over_us = lease_us.map(|lease_us| self.heard_us + lease_us);
            match over_us.filter(|over_us| *over_us < end_us) {
                Some(over_us) => self.pass_until(over_us.max(self.now_us), &mut made),
                None => return self.pass_until(end_us, &mut made),
            }
            // The time of silence restarts for the next motion of the controller.
            let is_over = self.controller.lease_us().is_some();
            self.heard_us = self.now_us;
            if is_over && self.controller.expire() {
                self.halt();
            }
        }
    }

    fn pass_until(&mut self, end_us: u64, made: &mut impl FnMut(u8, u64, &C::Event, &P)) {
        let begin_us = self.now_us;
        self.now_us = end_us;
        for (machine, (plant, due)) in (0_u8..).zip(self.plants.iter_mut().zip(&mut self.due)) {
            let mut from_us = begin_us;
            loop {
                if due.is_none() {
                    let Some(event) = self.controller.next_event(machine, &plant.inputs()) else {
                        break;
                    };
                    let wait_us = event.wait_ticks().unwrap_or(0);
                    *due = Some((from_us + u64::from(wait_us), event));
                }
                let Some((at_us, event)) = due.take_if(|(at_us, _)| *at_us <= self.now_us) else {
                    break;
                };
                from_us = at_us;
                plant.apply(&event);
                if event.wait_ticks().is_some() {
                    self.controller.made(machine, 1);
                }
                made(machine, at_us, &event, plant);
            }
        }
    }
}

impl Plant for DrillRig {
    type Inputs = DrillInputs;
    type Event = DrillEvent;

    fn inputs(&self) -> DrillInputs {
        DrillRig::inputs(self)
    }

    fn apply(&mut self, event: &DrillEvent) {
        DrillRig::apply(self, event);
    }
}

impl Plant for MicrofactoryRig {
    type Inputs = MicrofactoryInputs;
    type Event = MicrofactoryEvent;

    fn inputs(&self) -> MicrofactoryInputs {
        MicrofactoryRig::inputs(self)
    }

    fn apply(&mut self, event: &MicrofactoryEvent) {
        MicrofactoryRig::apply(self, event);
    }
}

impl Plant for MicromillRig {
    type Inputs = MicromillInputs;
    type Event = MicromillEvent;

    fn inputs(&self) -> MicromillInputs {
        MicromillRig::inputs(self)
    }

    fn apply(&mut self, event: &MicromillEvent) {
        MicromillRig::apply(self, event);
    }
}
