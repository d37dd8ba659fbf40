//! The commands and their packets.

use crate::buffer::{Buffer, Fields};

use super::{Baud, Frame, Gains, Homing, Items, PathPoints, Stop, Trajectory};

/// Group address of a module after reset, and the lowest one.
pub const EVERY_GROUP: u8 = 0xFF;
const GROUPS: u8 = 0x80;

/// Whether the address is that of a group.
pub(super) const fn is_group(address: u8) -> bool {
    address >= GROUPS
}

/// The group of a module, and its role in the group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Group {
    /// 0x80 to 0xFF. The upper bit is always taken as set.
    pub address: u8,
    /// Whether the module answers for the group. At most one module of a group may.
    pub is_leader: bool,
}

impl Group {
    /// The group after reset: 0xFF, member.
    pub const NONE: Group = Group {
        address: EVERY_GROUP,
        is_leader: false,
    };
}

/// The position that Reset Position sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reset {
    /// The present position becomes 0.
    Zero,
    /// The home position becomes 0 (version 10).
    Home,
    /// The present position becomes this (version 10).
    To(i32),
}

/// A command of the servo module, versions 4, 5 and 10.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Command {
    /// 0: sets the counter and the commanded position, so the axis does not jump. Not permitted
    /// during a trapezoid.
    ResetPosition(Reset),
    /// 1: gives the module its own address, 0 to 0x7F, and a group. The first Set Address also
    /// makes its ADDR_OUT low.
    SetAddress {
        /// 1 to 32 are in use. 0: not yet addressed.
        address: u8,
        /// Group, and role in it.
        group: Group,
    },
    /// 2: sets the items of this reply and all later ones.
    DefineStatus(Items),
    /// 3: sets the items of this reply.
    ReadStatus(Items),
    /// 4: loads a motion, to start now or at Start Motion.
    LoadTrajectory(Trajectory),
    /// 5: starts the loaded trajectory.
    StartMotion,
    /// 6: sets gains and limits of the servo.
    SetGain(Gains),
    /// 7: switches the amplifier and stops the motor.
    StopMotor(Stop),
    /// 8: sets outputs (bits 0, 1) and directions (bits 2, 3: 1 = input). Version 10 has other
    /// meanings.
    IoControl(u8),
    /// 9: waits for an event that latches the home position.
    SetHoming(Homing),
    /// A: sets the rate of the line. It is permitted only for a group without a leader.
    SetBaud(Baud),
    /// B: clears the bits of overcurrent, position error, position wrap and servo overrun.
    ClearBits,
    /// C: makes the present position the home position.
    SaveHome,
    /// D: adds points of a path (version 5 and later).
    AddPathPoints(PathPoints),
    /// E: requests a reply only.
    NoOperation,
    /// F: sets the state after power-up. It is never answered. Version 10 takes a configuration
    /// byte.
    HardReset(Option<u8>),
}

impl Command {
    /// Returns the packet for `address`.
    pub fn frame(&self, address: u8) -> Frame {
        let mut data = Buffer::new();
        let code = match self {
            Command::ResetPosition(reset) => {
                match reset {
                    Reset::Zero => {}
                    Reset::Home => data.push(0x01),
                    Reset::To(position) => {
                        data.push(0x02);
                        data.extend(&position.to_le_bytes());
                    }
                }
                0x0
            }
            Command::SetAddress { address, group } => {
                let part = if group.is_leader {
                    group.address & 0x7F
                } else {
                    group.address | GROUPS
                };
                data.extend(&[*address, part]);
                0x1
            }
            Command::DefineStatus(items) => {
                data.push(items.0);
                0x2
            }
            Command::ReadStatus(items) => {
                data.push(items.0);
                0x3
            }
            Command::LoadTrajectory(trajectory) => {
                trajectory.write(&mut data);
                0x4
            }
            Command::StartMotion => 0x5,
            Command::SetGain(gains) => {
                gains.write(&mut data);
                0x6
            }
            Command::StopMotor(stop) => {
                stop.write(&mut data);
                0x7
            }
            Command::IoControl(bits) => {
                data.push(*bits);
                0x8
            }
            Command::SetHoming(homing) => {
                data.push(homing.0);
                0x9
            }
            Command::SetBaud(baud) => {
                data.push(baud.divisor());
                0xA
            }
            Command::ClearBits => 0xB,
            Command::SaveHome => 0xC,
            Command::AddPathPoints(points) => {
                points.write(&mut data);
                0xD
            }
            Command::NoOperation => 0xE,
            Command::HardReset(configuration) => {
                data.extend(configuration.as_slice());
                0xF
            }
        };
        Frame::new(address, code, data.bytes())
    }

    /// Returns the command with this code and data for a module of `version`. Returns `None` for a
    /// command that such a module does not know, for a wrong length, and for a group address as an
    /// individual address.
    pub fn decode(code: u8, data: &[u8], version: u8) -> Option<Command> {
        let mut fields = Fields(data);
        let command = match code {
            0x0 if data.is_empty() => Command::ResetPosition(Reset::Zero),
            0x0 if version >= 10 => match fields.u8()? {
                0x01 => Command::ResetPosition(Reset::Home),
                0x02 => Command::ResetPosition(Reset::To(fields.u32()? as i32)), // the same bits
                _ => return None,
            },
            0x1 => {
                let (address, part) = (fields.u8()?, fields.u8()?);
                if is_group(address) {
                    return None;
                }
                let group = Group {
                    address: part | GROUPS,
                    is_leader: part & GROUPS == 0,
                };
                Command::SetAddress { address, group }
            }
            0x2 => Command::DefineStatus(Items(fields.u8()?)),
            0x3 => Command::ReadStatus(Items(fields.u8()?)),
            0x4 => return Trajectory::read(data).map(Command::LoadTrajectory),
            0x5 => Command::StartMotion,
            0x6 => return Gains::read(data, version).map(Command::SetGain),
            0x7 => return Stop::read(data).map(Command::StopMotor),
            0x8 => Command::IoControl(fields.u8()?),
            0x9 => Command::SetHoming(Homing(fields.u8()?)),
            0xA => Command::SetBaud(Baud::from_divisor(fields.u8()?, version)?),
            0xB => Command::ClearBits,
            0xC => Command::SaveHome,
            0xD if version >= 5 => return PathPoints::read(data).map(Command::AddPathPoints),
            0xE => Command::NoOperation,
            0xF if version >= 10 => Command::HardReset(fields.u8()),
            0xF => Command::HardReset(None),
            _ => return None,
        };
        fields.0.is_empty().then_some(command)
    }

    /// Whether every number is in the range of the data sheet for this version. The host sends only
    /// such commands. The module passes on all values.
    pub fn is_in_range(&self, version: u8) -> bool {
        match self {
            Command::ResetPosition(reset) => {
                *reset == Reset::Zero || (version >= 10 && *reset != Reset::To(i32::MIN))
            }
            Command::SetAddress { address, group } => {
                !is_group(*address) && is_group(group.address)
            }
            Command::LoadTrajectory(trajectory) => trajectory.is_in_range(),
            Command::SetGain(gains) => gains.is_in_range(version),
            Command::StopMotor(stop) => stop.mode != Some(super::StopMode::Here(i32::MIN)),
            Command::SetBaud(baud) => Baud::from_divisor(baud.divisor(), version).is_some(),
            Command::AddPathPoints(_) => version >= 5,
            Command::HardReset(configuration) => version >= 10 || configuration.is_none(),
            _ => true,
        }
    }
}
