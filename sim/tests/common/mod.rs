//! Commands to simulated modules.

#![allow(dead_code, reason = "every test file uses a part of it")]

use husillo_sim::ServoNetwork;
use husillo_transports::nmc::{Command, Gains, Stop, StopMode};

/// Sends a packet.
pub fn send(network: &mut ServoNetwork, address: u8, command: Command) {
    for &byte in command.frame(address).bytes() {
        network.send(byte);
    }
}

/// Sends a packet and returns the bytes received within 50 ms.
pub fn ask(network: &mut ServoNetwork, address: u8, command: Command) -> Vec<u8> {
    send(network, address, command);
    (0..100).flat_map(|_| network.tick()).collect()
}

/// Sets the gains and switches the servo on; returns the last reply.
pub fn switch_on(network: &mut ServoNetwork, address: u8, gains: Gains) -> Vec<u8> {
    ask(network, address, Command::SetGain(gains));
    let on = Stop {
        amplifier: true,
        mode: Some(StopMode::Abrupt),
    };
    ask(network, address, Command::StopMotor(on));
    ask(network, address, Command::ClearBits)
}
