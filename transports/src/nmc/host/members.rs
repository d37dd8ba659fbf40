//! The state of the modules as the host knows it, and its change by an executed command.

use super::{Host, LAST_ADDRESS};
use crate::nmc::command::is_group;
use crate::nmc::{Command, Group, Items, Reply, Trajectory};

/// The state of a module, as far as the host knows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Member {
    pub(super) is_present: bool,
    pub(super) items: Items,
    pub(super) group: Group,
    pub(super) version: u8,
    /// The motion that was loaded last and waits for Start Motion.
    pub(super) loaded: Option<Trajectory>,
}

impl Member {
    pub(super) const RESET: Member = Member {
        is_present: false,
        items: Items::NONE,
        group: Group::NONE,
        version: 4,
        loaded: None,
    };
}

impl Host {
    /// Applies the change of this state by an executed command.
    pub(super) fn learn(&mut self, reply: Option<&Reply>) {
        let (address, command) = (self.address, self.command);
        match command {
            Command::SetAddress {
                address: new,
                group,
            } => {
                let before = self.member(address).copied().unwrap_or(Member::RESET);
                let before = if address == 0 { Member::RESET } else { before };
                if let Some(member) = self.member_mut(address) {
                    *member = Member::RESET;
                }
                if let Some(member) = self.member_mut(new) {
                    *member = Member {
                        is_present: true,
                        group,
                        ..before
                    };
                }
            }
            Command::DefineStatus(items) => self.change(|member| {
                member.items = items.of_version(member.version);
            }),
            Command::LoadTrajectory(trajectory) => self.change(|member| {
                // In a group only the leader has answered.
                let is_known = !is_group(address) && !trajectory.start_now;
                member.loaded = is_known.then_some(trajectory);
            }),
            Command::HardReset(_) => self.change(|member| *member = Member::RESET),
            _ => {}
        }
        let device = reply.filter(|reply| reply.items.contains(Items::DEVICE));
        if let (Some(reply), Some(member)) = (device, self.member_mut(address)) {
            member.version = reply.readings.version;
        }
    }

    /// Changes the addressed module, or all modules of the group.
    fn change(&mut self, change: impl Fn(&mut Member)) {
        let address = self.address;
        if is_group(address) {
            let of_group = |member: &&mut Member| member.group.address == address;
            self.members.iter_mut().filter(of_group).for_each(change);
        } else if let Some(member) = self.member_mut(address) {
            change(member);
        }
    }

    /// Returns the individual address of the module that answers. Returns `None` for a group
    /// without a leader.
    pub(super) fn answerer(&self) -> Option<u8> {
        if !is_group(self.address) {
            return Some(self.address); // a module with a new address keeps its items
        }
        let leads = |member: &Member| {
            member.is_present && member.group.is_leader && member.group.address == self.address
        };
        (0..=LAST_ADDRESS)
            .zip(&self.members)
            .find_map(|(address, member)| leads(member).then_some(address))
    }

    /// Returns the version of a module, or the lowest version in a group.
    pub(super) fn version(&self, address: u8) -> u8 {
        if is_group(address) {
            let of_group = |member: &&Member| member.is_present && member.group.address == address;
            let versions = self.members.iter().filter(of_group);
            versions.map(|member| member.version).min().unwrap_or(4)
        } else {
            self.member(address).map_or(4, |member| member.version)
        }
    }

    pub(super) fn member(&self, address: u8) -> Option<&Member> {
        self.members.get(usize::from(address))
    }

    pub(super) fn member_mut(&mut self, address: u8) -> Option<&mut Member> {
        self.members.get_mut(usize::from(address))
    }
}
