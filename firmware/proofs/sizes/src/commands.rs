//! Reads a line into words, a block and commands.
#![no_std]
#![no_main]

use husillo_gcode::{Block, Command, Commands, Dialect, Modal, Nm};

mod port;

#[cortex_m_rt::entry]
fn main() -> ! {
    let dialect = Dialect::GRBL;
    let (mut block, mut modal, mut commands) =
        (Block::new(), Modal::<3>::new(dialect), Commands::new());
    let mut line = [0; 64];
    loop {
        for byte in &mut line {
            *byte = port::receive();
        }
        let done = block
            .read(&line, &dialect)
            .and_then(|()| modal.apply(&block, &mut commands));
        if let Err(error) = done {
            port::send(error.kind.code().into());
        }
        for command in &mut commands {
            send(command);
        }
    }
}

fn position(at: [Nm; 3]) {
    for axis in at {
        port::send(axis.0 as u32);
    }
}

#[inline(never)]
fn send(command: Command<3>) {
    match command {
        Command::Rapid { to } | Command::Linear { to, .. } => position(to),
        Command::Arc { arc, .. } => position(arc.to),
        Command::Dwell { micros } => port::send(micros as u32),
        Command::Spindle { milli_rpm, .. } => port::send(milli_rpm as u32),
        _ => {}
    }
}
