//! The state that a session leaves in the modules. The next session continues from it without a
//! reset.

use super::approach::Approach;
use super::head::{Head, READ, is_done, stop};
use super::line::Line;
use super::machine::Machine;
use super::port::Port;
use super::settling::SETTLING_US;
use super::wiring::End;
use crate::error::Error;
use husillo_backlash::Flank;
use husillo_transports::nmc::{Auxiliary, Baud, Command, Items, Reply, StopMode};

/// The items of a reading that show whether a module is unchanged.
const LEFT: Items = READ.with(Items::AUXILIARY);

/// The status items that a session defines in its modules. A reset clears them, and other programs
/// define different items. So these items show that the modules still count from the same position.
pub(super) const MARK: Items = Items::AUXILIARY.with(Items::CURRENT);

/// The state of the axes of a machine at the end of a session. Modules keep their counts until they
/// are reset or lose their supply.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Memory {
    /// Rate of the modules.
    pub baud: Baud,
    /// Whether the session did not end, because its program was killed. The axes may then be at any
    /// position, and may move.
    pub in_use: bool,
    /// The axes, in the order of the machine file.
    pub axes: Vec<AxisMemory>,
}

/// The state of an axis at the end of a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisMemory {
    /// `X`, `Y` or `Z`.
    pub letter: char,
    /// Address of its module.
    pub module: u8,
    /// Its position, counts.
    pub counts: i32,
    /// The last counts that the module latched. They are 0 after a reset.
    pub latched: i32,
    /// Whether its servo is on and holds it.
    pub is_held: bool,
    /// Whether it has been homed.
    pub is_homed: bool,
    /// The counts at which the reading is 0. After homing this is home.
    pub origin: i32,
    /// The position that counts as 0, an amount of the scale.
    pub zero: i64,
    /// Direction of its last move.
    pub flank: Flank,
    /// The end switch at which it stands, if it is known.
    pub end: Option<End>,
}

impl AxisMemory {
    /// Whether the module is unchanged. Positions may differ by `in_position` counts.
    fn is_still_true(&self, reply: &Reply, in_position: u32) -> bool {
        let readings = &reply.readings;
        readings.position.abs_diff(self.counts) <= in_position
            && readings.home == self.latched
            && readings.auxiliary.contains(Auxiliary::SERVO_ON) == self.is_held
            && is_done(reply)
    }
}

/// The result of [`Head::rejoin`].
#[derive(Debug)]
pub enum Rejoined<P> {
    /// The modules are unchanged: the head continues.
    AsLeft(Box<Head<P>>),
    /// A module was reset, moved, or does not answer. The line needs a start-up.
    Changed(Box<Line<P>>),
}

impl<P: Port> Head<P> {
    /// Continues from the state in which an earlier session has left the modules. It reads them
    /// without a reset, and compares the answers with the memory. If they agree, origins and homes
    /// are still valid. If the program of the session was killed, all axes are first stopped
    /// smoothly, and only the status items that the session defined in their modules are compared.
    ///
    /// # Errors
    ///
    /// The machine has no axes, its periods differ, or an unchanged axis has a fault.
    pub fn rejoin(
        line: Line<P>,
        machine: &Machine,
        touches: u8,
        memory: &Memory,
    ) -> Result<Rejoined<P>, Error> {
        let mut head = Self::of(line, machine, touches)?;
        let axes = machine.axes.iter().map(|axis| (axis.letter, axis.module));
        let left = memory.axes.iter().map(|axis| (axis.letter, axis.module));
        if !axes.eq(left) {
            return Ok(Rejoined::Changed(Box::new(head.line)));
        }
        let Ok(versions) = head.versions_if_as_left(memory) else {
            return Ok(Rejoined::Changed(Box::new(head.line)));
        };
        head.set_period(&versions)?;
        head.lead_group()?;
        // A program that was killed may have left the modules watching the contact.
        head.disarm(head.contact_watch(Approach::Rapid))?;
        for (index, left) in memory.axes.iter().enumerate() {
            let axis = &mut head.axes[index];
            axis.origin = left.origin;
            axis.is_homed = left.is_homed;
            axis.heading = left.end.filter(|_| !memory.in_use);
            // The gains in the machine file may have been changed since.
            let module = axis.settings.module;
            let gains = axis.settings.gains;
            head.line.command(module, Command::SetGain(gains))?;
            if !left.is_held {
                head.line.command(module, stop(StopMode::Abrupt))?;
            }
            head.line.command(module, Command::ClearBits)?;
            head.hold_checked(index)?;
        }
        Ok(Rejoined::AsLeft(Box::new(head)))
    }

    /// Returns the versions of the modules if all are unchanged.
    fn versions_if_as_left(&mut self, memory: &Memory) -> Result<Vec<u8>, Error> {
        let modules: Vec<u8> = self.axes.iter().map(|axis| axis.settings.module).collect();
        self.line.rejoin(memory.baud, &modules)?;
        for module in &modules {
            // The reply has the items of [`MARK`], or is not understood.
            self.line.command(*module, Command::NoOperation)?;
        }
        if memory.in_use {
            self.stop(StopMode::Smooth)?;
            self.rest()?;
        }
        let pairs: Vec<_> = self.axes.iter().copied().zip(&memory.axes).collect();
        let mut versions = Vec::with_capacity(pairs.len());
        for (axis, left) in pairs {
            let reply = self.read_axis_twice(&axis, LEFT.with(Items::DEVICE))?;
            if !memory.in_use && !left.is_still_true(&reply, axis.settings.in_position) {
                return Err(Error::NoModules);
            }
            versions.push(reply.readings.version);
        }
        Ok(versions)
    }

    /// Waits until the axes are at rest, and returns the state that the session leaves. It has no
    /// zeros and flanks, because a head does not know them. A fault of an axis is not an error
    /// here.
    ///
    /// # Errors
    ///
    /// No answer, or an axis that does not come to rest.
    pub(crate) fn memory(&mut self) -> Result<Memory, Error> {
        self.rest()?;
        let axes = self.axes.clone();
        let axes = axes.iter().map(|axis| {
            let reply = self.read_axis_twice(axis, LEFT)?;
            let readings = &reply.readings;
            Ok(AxisMemory {
                letter: axis.settings.letter,
                module: axis.settings.module,
                counts: readings.position,
                latched: readings.home,
                is_held: readings.auxiliary.contains(Auxiliary::SERVO_ON),
                is_homed: axis.is_homed,
                origin: axis.origin,
                zero: 0,
                flank: Flank::Unknown,
                end: axis.end.filter(|_| axis.is_at_end),
            })
        });
        let axes: Result<Vec<_>, Error> = axes.collect();
        Ok(Memory {
            axes: axes?,
            baud: self.line.baud(),
            in_use: false,
        })
    }

    /// Waits until the axes are at rest. A fault of an axis is not an error here.
    fn rest(&mut self) -> Result<(), Error> {
        let end_us = self.line.elapsed_us() + self.braking_us() + SETTLING_US;
        let mut before: Vec<i32> = Vec::new();
        loop {
            let mut replies = Vec::with_capacity(self.axes.len());
            for axis in &self.axes {
                let read = Command::ReadStatus(READ);
                replies.push(self.line.command(axis.settings.module, read)?);
            }
            let at: Vec<i32> = replies.iter().map(|one| one.readings.position).collect();
            let mut pairs = self.axes.iter().zip(at.iter().zip(&before));
            let is_still = pairs.all(|(axis, (at, before))| axis.is_near(*at, *before));
            if is_still && !before.is_empty() && replies.iter().all(is_done) {
                return Ok(());
            }
            if self.line.elapsed_us() > end_us {
                return Err(self.late(None, &at, &replies));
            }
            before = at;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulated::{SimulatedNetwork, SimulatedPort, three_axes};
    use husillo_transports::nmc::{Reset, Stop};

    type Simulated = Head<SimulatedPort>;

    /// A session that has homed X, moved Y and ended.
    fn ended() -> (SimulatedPort, Memory) {
        let network = SimulatedNetwork::new(&[4; 3], &[], None).unwrap();
        let line = Line::new(SimulatedPort::new(network));
        let mut head = Simulated::start(line, &three_axes(), 1).unwrap();
        head.go_to([100_000, 3_000_000, 0]).unwrap();
        head.home(0).unwrap();
        let memory = head.memory().unwrap();
        (head.line.into_port(), memory)
    }

    fn rejoin(port: SimulatedPort, machine: &Machine, memory: &Memory) -> Rejoined<SimulatedPort> {
        Simulated::rejoin(Line::new(port), machine, 1, memory).unwrap()
    }

    #[test]
    fn the_next_session_goes_on_from_the_same_positions() {
        let (port, memory) = ended();
        assert_eq!((memory.baud, memory.axes.len()), (Baud::B115200, 3));
        assert!(memory.axes[0].is_homed && !memory.axes[1].is_homed);
        assert!(memory.axes.iter().all(|axis| axis.is_held));
        assert_ne!(memory.axes[0].origin, 0);
        let Rejoined::AsLeft(mut head) = rejoin(port, &three_axes(), &memory) else {
            panic!("the modules were not recognised");
        };
        let [x, y, z] = head.held();
        assert!(x.abs() <= 2_000 && z.abs() <= 2_000, "{x} {z}");
        assert!(y.abs_diff(3_000_000) <= 2_000, "{y}");
        assert!(head.axes[0].is_homed && !head.axes[1].is_homed);
        // All axes move together, so the leader of the group is known.
        let there = head.go_to([1_000_000, 1_000_000, 0]).unwrap();
        assert!(there[1].abs_diff(1_000_000) <= 2_000);
    }

    /// A loss of supply, a reset, a motion, and a drive that was switched off: after each of them
    /// the memory is not valid.
    #[test]
    fn modules_that_are_not_as_they_were_left_are_told_apart() {
        type Change = fn(&mut SimulatedPort);
        let changes: [Change; 4] = [
            |port| {
                port.network.set_power(false);
                port.receive(2_000).unwrap();
                port.network.set_power(true);
            },
            |port| {
                let reset = Command::ResetPosition(Reset::Zero);
                port.send(reset.frame(2).bytes()).unwrap();
                port.receive(100_000).unwrap();
            },
            |port| {
                let there = stop(StopMode::Here(20));
                port.send(there.frame(3).bytes()).unwrap();
                port.receive(2_000).unwrap();
                for _ in 0..1000 {
                    port.network.tick();
                }
            },
            |port| {
                let off = Command::StopMotor(Stop {
                    amplifier: false,
                    mode: Some(StopMode::Off),
                });
                port.send(off.frame(1).bytes()).unwrap();
                port.receive(100_000).unwrap();
            },
        ];
        for (index, change) in changes.into_iter().enumerate() {
            let (mut port, memory) = ended();
            change(&mut port);
            let rejoined = rejoin(port, &three_axes(), &memory);
            let Rejoined::Changed(line) = rejoined else {
                panic!("change {index} was not noticed");
            };
            // The start-up finds the modules as usual.
            Simulated::start(*line, &three_axes(), 1).unwrap();
        }
    }

    /// After a fault an axis has no drive. It still counts, so nothing is lost.
    #[test]
    fn an_axis_without_drive_keeps_its_home() {
        let (port, memory) = ended();
        let Rejoined::AsLeft(mut head) = rejoin(port, &three_axes(), &memory) else {
            panic!("the modules were not recognised");
        };
        let off = Command::StopMotor(Stop {
            amplifier: false,
            mode: Some(StopMode::Off),
        });
        head.line.command(1, off).unwrap();
        let memory = head.memory().unwrap();
        assert!(!memory.axes[0].is_held && memory.axes[1].is_held);
        let rejoined = rejoin(head.line.into_port(), &three_axes(), &memory);
        let Rejoined::AsLeft(mut head) = rejoined else {
            panic!("the modules were not recognised");
        };
        assert!(head.axes[0].is_homed);
        head.go_to([500_000, 3_000_000, 0]).unwrap();
    }

    #[test]
    fn another_machine_is_not_the_one_that_was_left() {
        let (port, memory) = ended();
        let mut machine = three_axes();
        machine.axes.swap(0, 1);
        assert!(matches!(
            rejoin(port, &machine, &memory),
            Rejoined::Changed(_)
        ));
    }

    /// A program that was killed in the middle of a move has left the axes moving. They are
    /// stopped, and nothing is lost.
    #[test]
    fn a_killed_program_loses_nothing() {
        use husillo_transports::nmc::{Mode, Trajectory};
        let far = Command::LoadTrajectory(Trajectory {
            position: Some(50_000),
            velocity: Some(30_000),
            acceleration: Some(300),
            mode: Mode::Trapezoid,
            start_now: true,
            ..Trajectory::default()
        });
        let killed = || {
            let (mut port, memory) = ended();
            port.send(far.frame(1).bytes()).unwrap();
            port.receive(100_000).unwrap();
            for _ in 0..600 {
                port.network.tick();
            }
            let memory = Memory {
                in_use: true,
                ..memory
            };
            (port, memory)
        };
        let (port, memory) = killed();
        let origin = memory.axes[0].origin;
        let Rejoined::AsLeft(mut head) = rejoin(port, &three_axes(), &memory) else {
            panic!("the modules were not recognised");
        };
        let counts = head
            .line
            .port()
            .network
            .servo_network()
            .motor(0)
            .unwrap()
            .counts();
        // 2 um per count.
        let wanted = (counts - i64::from(origin)) * 2000;
        let [x, y, _] = head.held();
        assert!(
            wanted > 100_000 && x.abs_diff(wanted) <= 4_000,
            "{x} {wanted}"
        );
        assert!(y.abs_diff(3_000_000) <= 2_000 && head.axes[0].is_homed);
        head.go_to([0, 3_000_000, 0]).unwrap();

        // Since then the supply was off, or another program has set the modules up.
        let (mut port, memory) = killed();
        port.network.set_power(false);
        port.receive(2_000).unwrap();
        port.network.set_power(true);
        let changed = rejoin(port, &three_axes(), &memory);
        assert!(matches!(changed, Rejoined::Changed(_)));
        for items in [Items::NONE, Items::AUXILIARY, LEFT] {
            let (mut port, memory) = killed();
            let define = Command::DefineStatus(items);
            port.send(define.frame(2).bytes()).unwrap();
            port.receive(100_000).unwrap();
            let changed = rejoin(port, &three_axes(), &memory);
            assert!(matches!(changed, Rejoined::Changed(_)), "{items:?}");
        }
    }
}
